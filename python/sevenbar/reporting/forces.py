"""The report of forces: printed, as JSON, and as files in a folder."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from rich.console import Group, RenderableType
from rich.text import Text

from sevenbar.curves.curve import Peak
from sevenbar.errors import RequestError
from sevenbar.forces.counterweights import Balance
from sevenbar.forces.result import COMPONENTS, Forces
from sevenbar.forces.shaking import Shaking, shaking_along
from sevenbar.forces.sizing import Burden, Sizing
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.columns import joint_column
from sevenbar.reporting import force_words
from sevenbar.reporting.extents import known
from sevenbar.reporting.figures import FigureLook
from sevenbar.reporting.files import Files, Report, Write, columns_file, figure_files, head_of, json_file
from sevenbar.reporting.page import Facts, number_table, page
from sevenbar.reporting.shown import drive_text, number, rows_text
from sevenbar.text.words import retold, say

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class CircuitForces:
    """The forces on a circuit of a motion, or on one pass of it, with what a designer reads of them."""

    motion: Motion
    circuit: Circuit
    forces: Forces
    sizing: Sizing | None
    shaking: Shaking | None
    balance: Balance | None = None
    #: The forces on the other parts between stops.
    others: tuple[Forces, ...] = ()

    @classmethod
    def of(
        cls, motion: Motion, circuit: Circuit, forces: Forces, *, unevenness: float | None = None
    ) -> CircuitForces:
        """With the sizing for an unevenness, on the part between stops on which the linkage is used.

        Raises `RequestError` where no pose is within the stops.
        """
        own = forces.within_stops
        if own is None:
            raise RequestError(
                f"circuit: no pose of circuit {circuit.index} is within the stops of the linkage; take "
                "another circuit, or leave a [[stop]] out"
            )
        result = own.sizing(unevenness=unevenness)
        shakes = own.bodies and not own.at_rest
        others = tuple(one for one in forces.parts if one is not own)
        return cls(motion, circuit, own, result, shaking_along(own) if shakes else None, others=others)


def forces_report(
    figures: Sequence[str] = ("png",), look: FigureLook | None = None, joints: Sequence[str] = ()
) -> Report[CircuitForces]:
    """How forces are reported, with figures in these formats; reactions of some joints, or of all."""
    files: Files[CircuitForces] = {
        "forces.json": json_file(as_dict),
        "forces.csv": columns_file(lambda result: columns(result.forces)),
    }
    return Report(
        text, as_dict, files, partial(_figures, figures, look or FigureLook(), tuple(joints)), spoken=True
    )


def _figures(
    formats: Sequence[str], look: FigureLook, joints: tuple[str, ...], result: CircuitForces
) -> Files[CircuitForces]:
    """The figures of a result: torque and power, reactions, bearings, shaking, energies."""
    from sevenbar.drawing import force_figures

    forces, sizing = result.forces, result.sizing
    chosen = joints or None
    draw: dict[str, Any] = {
        "torque": partial(force_figures.torque, forces, sizing),
        "reactions": partial(force_figures.reactions, forces, joints=chosen),
        "bearings": partial(force_figures.bearings, forces, joints=chosen),
    }
    if result.shaking is not None:
        draw["shaking"] = partial(force_figures.shaking, forces)
    draw["energies"] = partial(force_figures.energies, forces)
    if not force_figures.drawn_bearings(forces, chosen):
        del draw["bearings"]
    files: dict[str, Write[CircuitForces]] = {}
    for name, one in draw.items():
        files |= figure_files(name, formats, partial(_drawn, one, look))
    return files


def _drawn(draw: Callable[..., Figure], look: FigureLook, _found: CircuitForces) -> Figure:
    return draw(**look.of_curves)


def drive_fact(result: CircuitForces) -> str:
    """Which circuit, and how it is driven."""
    motion, circuit, forces = result.motion, result.circuit, result.forces
    which = say("{number} of {count}", number=circuit.index, count=len(motion.circuits))
    if len(np.unique(circuit.branch)) > 1 and len(np.unique(forces.branch)) == 1:
        which = say("{circuit}, pass {number}", circuit=which, number=int(forces.branch[0]))
    if forces.at_rest:
        return say(
            "{circuit}, at rest at each {joint}: no inertia, no damping", circuit=which, joint=forces.driver
        )
    speed = motion.speed if motion.law is None else None
    unit = motion.linkage.unit_of(motion.input)
    driven = drive_text(motion.input, speed, unit, written=motion.speed_written)
    return say(", ").join([which, driven])


def facts_of_forces(result: CircuitForces) -> list[tuple[str, str]]:
    """All that a report says of forces above the table of joints."""
    forces, linkage = result.forces, result.motion.linkage
    sliding = [column.name for column in linkage.each_column if not column.turns]
    facts = [(say("circuit"), drive_fact(result)), *force_words.acting_facts(forces, sliding)]
    facts += force_words.part_facts(forces, result.others)
    facts += _law_facts(result)
    facts += force_words.drive_facts(forces, result.sizing)
    facts += force_words.shaking_facts(forces, result.shaking)
    facts += force_words.spin_facts(forces)
    facts += force_words.open_facts(forces)
    facts += force_words.unbounded_facts(forces, result.sizing)
    how = {"law": result.motion.law is not None, "part": forces.part is not None}
    facts.append((say("found"), force_words.peaks_text(result.sizing, **how)))
    facts.append((say("checks"), force_words.check_text(forces)))
    facts.append((say("rows"), f"{len(forces.status)}: {rows_text(forces.status)}"))
    return [(label, said) for label, said in facts if said]


def _law_facts(result: CircuitForces) -> list[tuple[str, str]]:
    """How many rows of a law are beyond the stops, which do not end it."""
    circuit = result.circuit
    if result.motion.law is None or not result.motion.linkage.stops.stops:
        return []
    allowed = known(lambda: circuit.allowed)
    if allowed is None:
        return []
    by = allowed.stopped_by[np.isin(circuit.branch, result.forces.branch)]
    beyond = by != ""
    if not beyond.any():
        return []
    stops = sorted({name for row in set(by[beyond]) for name in row.split(", ")})
    text = say(
        "{count} of {rows} rows of the law are beyond them: {stops}",
        count=int(beyond.sum()), rows=len(beyond), stops=say(", ").join(map(retold, stops)),
    )  # fmt: skip
    return [(say("within the stops"), text)]


def text(result: CircuitForces) -> RenderableType:
    """The forces on a circuit as a page."""
    forces = result.forces
    facts = Facts()
    facts.add_all(facts_of_forces(result), bold=[force_words.drive_label(forces)])
    tables = []
    if result.balance is not None:
        # a reader of its own, which knows these pages
        from sevenbar.reporting.force_results import balance_facts

        facts.add(say("counterweights"), say("least squares of the shaking over the cycle"))
        facts.add_all(balance_facts(result.balance))
    if result.sizing is not None:
        planar = result.motion.linkage.is_planar
        head, rows = bearing_rows(forces, result.sizing, planar=planar)
        without = {
            say(IN_PLANE): say("; in plane: the force in the plane of motion"),
            say(KNOWN): say("; known: the force without the component that is not determined"),
        }.get(head[1], "")
        meaning = say(
            "peaks of what the link before puts on the link after, the ground before the first joint and "
            "after the last; radial square to the joint's axis, axial along it, tilting moment square to it, "
            "turning about it"
        )
        cells = {cell for row in rows for cell in row}
        without += say("; -: not determined") if force_words.OPEN in cells else ""
        tables.append(Group(number_table(head, rows), Text(meaning + without, style="dim")))
    return page(result.motion.linkage.heading, facts, *tables)


#: Units in the JSON besides those of every result.
UNITS = {"mass": "kg", "force": "N", "moment": "N m", "power": "W", "energy": "J", "inertia": "kg m^2"}

#: What a sizing has that the JSON has elsewhere.
IN_UNITS = ("bearings", "unit", "input_unit")

#: The head of the column of whole forces.
WHOLE = "force\n[N]"

#: The same where one component of them is open.
IN_PLANE, KNOWN = "in plane\n[N]", "known\n[N]"


def bearing_rows(
    forces: Forces, result: Sizing, *, planar: bool = False
) -> tuple[list[str], list[list[str]]]:
    """The table of joints: what each bears at most, and the force's place and cubic mean.

    Where no joint's whole force is determined, but that in the `planar` loop's plane is, it has the latter.
    """
    place = force_words.Places(forces)
    whole = any(math.isfinite(one.force.peak.value) for one in result.bearings.values())
    partly = not whole and any(math.isfinite(one.in_plane.peak.value) for one in result.bearings.values())
    first = (IN_PLANE if planar else KNOWN) if partly else WHOLE
    head = [
        say("joint"), say(first), "@", say("cubic mean\n[N]"), say("radial\n[N]"), say("axial\n[N]"),
        say("tilting\n[N m]"), say("turning\n[N m]"),
    ]  # fmt: skip
    rows = []
    for name, bearing in result.bearings.items():
        force = bearing.in_plane if partly else bearing.force
        known = math.isfinite(force.peak.value)
        met = [place(force.peak.input), number(force.mean_cube)] if known else ["", ""]
        parts = (bearing.radial, bearing.axial, bearing.tilting, bearing.turning)
        # a ball has no axis
        ball = forces.reactions[name].kind == "S"
        rows.append([name, _peak(force), *met, *("" if ball else _peak(part) for part in parts)])
    # forces, then moments
    for columns in ((1, 4, 5), (6, 7)):
        sizes = {
            (row, i): float(cells[i])
            for row, cells in enumerate(rows)
            for i in columns
            if cells[i] not in (force_words.OPEN, "")
        }
        for (row, i), size in sizes.items():
            # what is left of rounding
            if abs(size) < 1e-12 * max(sizes.values()):
                rows[row][i] = "0"
    return head, rows


def _peak(burden: Burden) -> str:
    return number(burden.peak.value) if math.isfinite(burden.peak.value) else force_words.OPEN


def columns(forces: Forces) -> dict[str, npt.NDArray[Any]]:
    """Every row as a table; what equilibrium does not determine has no value.

    >>> import sevenbar as sb
    >>> circuit = sb.load("rssr").motion(12).circuits[0]
    >>> list(columns(circuit.forces(bodies={2: sb.Body(1.3, solid="rod")})))[:6]
    ['time_s', 'crank_deg', 'branch', 'status', 'torque_Nm', 'power_W']
    """
    slides = forces.slides
    head = joint_column(forces.driver, slides=slides, order=0, length=forces.length_unit, angle="deg")
    result: dict[str, npt.NDArray[Any]] = {} if forces.at_rest else {"time_s": forces.time}
    result |= {
        head: forces.input if slides else np.degrees(forces.input),
        "branch": forces.branch,
        "status": forces.status,
        "force_N" if slides else "torque_Nm": forces.torque,
    }
    if not forces.at_rest:
        result |= {"power_W": forces.power, "supplied_W": forces.supplied, "kinetic_energy_J": forces.kinetic}
    result["potential_energy_J"] = forces.potential
    units = ("Nm",) * 3 + ("N",) * 3
    for name, reaction in forces.reactions.items():
        six = np.concatenate([reaction.moment, reaction.force], axis=1)
        for i in (3, 4, 5, 0, 1, 2):
            result[f"{name}_{COMPONENTS[i]}_{units[i]}"] = six[:, i]
        known = reaction.determinate[3:]
        if known.sum() == 2:
            result[f"{name}_F_in_plane_N"] = np.linalg.norm(reaction.force[:, known], axis=1)
    if not forces.at_rest:
        for i in (3, 4, 5, 0, 1, 2):
            result[f"shaking_{COMPONENTS[i]}_{units[i]}"] = forces.shaking[:, i]
    for link, moment in forces.spin.items():
        result[f"{link.replace(' ', '')}_spin_moment_Nm"] = moment
    return result


def _weights(result: Balance) -> dict[str, Any]:
    """Counterweights: mass times radius [kg length] in a direction, and the shaking [N] before and after."""
    names = ("link", "pivot", "product", "direction", "mass")
    weights = [
        {name: getattr(one, name) for name in names} | {"direction": one.direction.tolist()}
        for one in result.counterweights
    ]
    return {"weights": weights, "before": result.before, "after": result.after, "measure": result.measure}


def as_dict(result: CircuitForces) -> dict[str, Any]:
    """Forces as plain values: inputs in radians or lengths, null where nothing is determined."""
    motion, forces = result.motion, result.forces
    linkage = motion.linkage
    return {
        **head_of(linkage, **UNITS, torque=forces.unit),
        "drive": {
            "input": forces.driver,
            "speed": None if motion.law is not None or forces.at_rest else motion.speed,
            "law": motion.law is not None,
            "at_rest": forces.at_rest,
        },
        "circuit": result.circuit.index,
        "within_stops": None if forces.part is None else vars(forces.part),
        "rows": len(forces.status),
        "acting": _acting(forces),
        **numbers(result),
        "counterweights": None if result.balance is None else _weights(result.balance),
        "not_determined": list(forces.indeterminate),
        "idle_spin": {link: force_words.greatest(moment) for link, moment in forces.spin.items()},
        "checks": force_words.check_values(forces),
    }


def numbers(result: CircuitForces) -> dict[str, Any]:
    """What a designer asks first, as plain values: the drive, the joints, the shaking."""
    forces, sizing, shaken = result.forces, result.sizing, result.shaking
    drive = None
    if sizing is not None:
        drive = {name: value for name, value in vars(sizing).items() if name not in IN_UNITS}
        drive |= {name: _plain(drive[name]) for name in ("peak_torque", "peak_power", "braking_power")}
    joints = {}
    for name, reaction in forces.reactions.items():
        flags = zip(COMPONENTS, reaction.determinate.tolist(), strict=True)
        joints[name] = {"determinate": dict(flags)}
        if sizing is not None:
            bearing = sizing.bearings[name]
            for part in force_words.LISTED:
                burden: Burden = getattr(bearing, part)
                joints[name][part] = {**_plain(burden.peak), "mean_cube": burden.mean_cube}
    return {
        "sizing": drive,
        "no_sizing": force_words.no_peak(forces) if sizing is None else None,
        "joints": joints,
        "shaking": None
        if shaken is None
        else {
            "force": _plain(shaken.force) | {"rms": shaken.rms_force},
            "moment": _plain(shaken.moment) | {"rms": shaken.rms_moment},
        },
    }


def _plain(peak: Peak | None) -> dict[str, float]:
    return {} if peak is None else {"value": peak.value, "at": peak.input}


def _acting(forces: Forces) -> dict[str, Any]:
    """What acts as plain values."""
    loading = forces.loading
    return {
        "gravity": list(loading.gravity),
        "bodies": [
            {
                "link": link,
                "mass": forces.bodies[link].mass,
                "centre": list(forces.bodies[link].centre or ()),
                "from": [body.solid or "given" for body in own],
            }
            for link, own in sorted(loading.bodies.items())
            if own
        ],
        "loads": len(loading.loads),
        "springs": len(loading.springs),
    }
