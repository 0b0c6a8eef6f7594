"""What acts on a linkage and what follows, in words: facts of a report and lines that results print."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Peak
from sevenbar.curves.timed_rows import shares_of
from sevenbar.forces.bodies import Body
from sevenbar.forces.loading import Load, Loading, Spring
from sevenbar.forces.result import COMPONENTS, Forces
from sevenbar.forces.shaking import Shaking, shaking_of
from sevenbar.forces.sizing import Bearing, Sizing
from sevenbar.reporting.shown import Shown
from sevenbar.text.words import say

#: The moment of an idle spin below this part of the greatest moment in a joint is rounding.
ROUNDING = 1e-9

#: The parts of a bearing's load that are listed, with their units.
LISTED = {"force": "N", "radial": "N", "axial": "N", "tilting": "N m", "turning": "N m", "in_plane": "N"}

#: What a cell says of a part that rigid bodies leave open.
OPEN = "open"

#: What a file without anything that acts lacks.
NOTHING_ACTS = """nothing in it has a mass and nothing acts; write a body, a load or a spring into it, as in
  [forces]
  gravity = [0, 0, -9.80665]

  [[body]]
  link = 2
  mass = 1.3
  solid = "rod\""""

#: Digits of forces, torques and what follows from them.
DIGITS = 4


def number(value: float) -> str:
    """A force or torque to the digits that matter, without a power of ten where it is not far from 1.

    >>> number(12612.3), number(-0.58712), number(3.1e-7)
    ('12610', '-0.5871', '3.1e-07')
    """
    short = f"{value + 0.0:.{DIGITS}g}"
    return f"{float(short):.0f}" if 1e4 <= abs(value) < 1e7 else short


class Places:
    """How an input is written at which something is met: in degrees, or the length unit."""

    def __init__(self, forces: Forces) -> None:
        #: A value of the input as it is, turns and all.
        self.plain = self._show = Shown(forces.length_unit if forces.slides else "rad")
        # of a cycle of several turns the place says which turn
        self._whole = not forces.slides and abs(forces.period or 0.0) < 1.5 * math.tau

    def __call__(self, input: float) -> str:
        """An input with its unit."""
        return self._show(input, whole=self._whole)

    def at(self, peak: Peak, unit: str) -> str:
        """A peak with its place: `20.3 N m @ 123.400°`."""
        return f"{number(peak.value)} {unit} @ {self(peak.input)}"


def body_text(body: Body, mass: float | None) -> str:
    """A body by its mass, and where centre and inertia come from; `mass` [kg] of one that is drawn."""
    shown = f"{body.mass or mass or math.nan:.6g} kg"
    if body.solid == "rod":
        return f"{shown}, a uniform rod between its joints"
    if body.solid == "drawn":
        return f"{shown}, the solids that exports draw" + ("" if body.mass else ", of steel")
    centre = f"{shown}, centre {triple_text(body.centre or ())}"
    return centre + ("" if body.tensor.any() else ", a point")


def bodies_texts(loading: Loading, resolved: Mapping[int, Body]) -> list[tuple[str, str]]:
    """A line for each body: its link, and what it is."""
    found = []
    for link in sorted(loading.bodies):
        for body in loading.bodies[link]:
            own = resolved[link].mass if len(loading.bodies[link]) == 1 else None
            found.append((f"link {link}", body_text(body, own)))
    return found


def load_text(load: Load, shown: Callable[[float], str]) -> str:
    """A load in words; `shown` writes a value of the input."""
    axes = "" if load.axes == "ground" else ", turning with the link"
    parts = []
    if any(load.force):
        parts.append(f"force {triple_text(load.force)} N at {triple_text(load.at or ())}")
    if any(load.torque):
        parts.append(f"torque {triple_text(load.torque)} N m")
    when = ""
    if load.between is not None:
        when = f", from {shown(load.between[0])} to {shown(load.between[1])} of the input"
    elif load.table is not None:
        inputs = load.table[0]
        when = f", by a table of {len(inputs)} rows from {shown(inputs[0])} to {shown(inputs[-1])}"
    name = f"{load.name}: " if load.name else ""
    return f"{name}{' and '.join(parts)} on link {load.link}{axes}{when}"


def spring_text(spring: Spring, unit: str, *, slides: bool) -> str:
    """A spring in words; `unit` that of lengths, `slides` whether its joint does."""
    force, by = ("N", unit) if spring.links is not None or slides else ("N m", "rad")
    if spring.links is not None:
        where, free = f"links {spring.links[0]} and {spring.links[1]}", f"{spring.length:.6g} {unit}"
    else:
        where = f"joint {spring.joint}"
        free = f"{spring.length:.6g} {unit}" if slides else Shown("rad")(spring.length)
    parts = [f"{spring.stiffness:.6g} {force}/{by}, free at {free}"] if spring.stiffness else []
    if spring.damping:
        parts.append(f"damping {spring.damping:.6g} {force} s/{by}")
    name = f"{spring.name}: " if spring.name else ""
    return f"{name}{where}: {', '.join(parts)}"


def triple_text(values: Sequence[float]) -> str:
    """Three numbers in brackets."""
    return f"({', '.join(f'{value + 0.0:.6g}' for value in values)})"


def acting_text(loading: Loading) -> str:
    """What acts, counted."""
    bodies = sum(map(len, loading.bodies.values()))
    loads, springs = len(loading.loads), len(loading.springs)
    what = [
        (bodies == 1, say("1 body")),
        (bodies > 1, say("{count} bodies", count=bodies)),
        (loads == 1, say("1 load")),
        (loads > 1, say("{count} loads", count=loads)),
        (springs == 1, say("1 spring")),
        (springs > 1, say("{count} springs", count=springs)),
        (any(loading.gravity), say("gravity")),
    ]
    return say(", ").join(text for there, text in what if there)


def acting_facts(forces: Forces, sliding: Sequence[str]) -> list[tuple[str, str]]:
    """What acts, a line each; `sliding` are the joints that slide."""
    loading, place = forces.loading, Places(forces)
    lines = bodies_texts(loading, forces.bodies)
    lines += [(f"load {i}", load_text(load, place.plain)) for i, load in enumerate(loading.loads, 1)]
    for i, spring in enumerate(loading.springs, 1):
        text = spring_text(spring, forces.length_unit, slides=spring.joint in sliding)
        lines.append((f"spring {i}", text))
    pull = f"{triple_text(loading.gravity)} m/s^2" if any(loading.gravity) else "none"
    return [*lines, ("gravity", pull)]


def no_peak(forces: Forces) -> str:
    """Why no peaks are found; empty where there are."""
    lost = ~np.isfinite(forces.torque)
    if forces.through_change_points and forces.periodic and forces.loading.breaks(turns=1):
        return (
            "no peak: loads that set in or end are not sized on a circuit that passes change points; "
            "see the rows"
        )
    if not lost.any():
        return ""
    dead = np.unique(forces.status[lost])
    if "dead-centre" in dead:
        return (
            f"no peak: the {quantity(forces)} grows without bound at the dead centres of {forces.driver}; "
            "drive it by a law that stays off them, or another joint"
        )
    rows = f"{int(lost.sum())} of {len(lost)} rows"
    return (
        f"no peak: {rows} have no value ({', '.join(map(str, dead))}); drive it by a law that stays off them"
    )


def quantity(forces: Forces) -> str:
    """What the input gives: a torque, or as it slides a force."""
    return "force" if forces.slides else "torque"


def drive_facts(forces: Forces, found: Sizing | None) -> list[tuple[str, str]]:
    """What the drive has to give: torque, power, energy, flywheel."""
    what, unit = f"input {quantity(forces)}", forces.unit
    if found is None:
        return [(what, no_peak(forces))]
    place = Places(forces)
    facts = [
        (what, f"peak {place.at(found.peak_torque, unit)}"),
        ("", f"rms {number(found.rms_torque)} {unit}, mean {_mean(found.mean_torque, found)} {unit}"),
    ]
    if forces.at_rest:
        return facts
    braking = "no braking"
    if found.braking_power is not None:
        braking = f"braking {place.at(found.braking_power, 'W')}"
    facts.append(("power", f"peak {place.at(found.peak_power, 'W')}, {braking}"))
    average = _mean_power(forces)
    taken = ": the linkage drives its input" if average < 0 else ""
    facts.append(("", f"mean {number(average)} W{taken}"))
    steady = "torque" if forces.periodic else "power"
    facts.append(
        (
            "energy",
            f"fluctuates by {number(found.fluctuation)} J about a drive of constant {steady}: fastest at "
            f"{place(found.fastest)}, slowest at {place(found.slowest)}",
        )
    )
    if found.flywheel is not None:
        facts.append(
            (
                "flywheel",
                f"{number(found.flywheel)} kg m^2 at the input for an unevenness of {found.unevenness:g}",
            )
        )
    return facts


def _mean_power(forces: Forces) -> float:
    """The mean power [W] by time, 0 where it is rounding."""
    shares = np.full(len(forces.power), 1 / len(forces.power)) if forces.periodic else shares_of(forces.time)
    mean = float(shares @ forces.power)
    return 0.0 if abs(mean) < 1e-12 * np.abs(forces.power).max() else mean


def _mean(mean: float, found: Sizing) -> str:
    """The mean torque, 0 where it is rounding."""
    return number(0.0 if abs(mean) < 1e-12 * abs(found.peak_torque.value) else mean)


def spin_facts(forces: Forces) -> list[tuple[str, str]]:
    """What holds links that spin idly: nothing for a rod, else a moment that no ball gives."""
    facts = []
    moments = [np.abs(r.moment[np.isfinite(r.moment)]).max(initial=0.0) for r in forces.reactions.values()]
    scale = max([*moments, 0.0])
    for link, moment in forces.spin.items():
        most = float(np.nanmax(np.abs(moment), initial=0.0))
        if most <= ROUNDING * scale:
            text = "not held: its body is a rod, symmetric about the line of its balls, or none"
        else:
            text = (
                f"the rule that holds it gives up to {number(most)} N m that no ball gives; without a guide "
                "the link turns about the line of its balls, and these forces are not its own"
            )
        facts.append(("idle spin", f"{link}: {text}"))
    return facts


def open_facts(forces: Forces) -> list[tuple[str, str]]:
    """What equilibrium of rigid bodies does not determine, by the redundant constraints."""
    if not forces.indeterminate:
        return []
    parts: dict[tuple[str, ...], list[str]] = {}
    for name, reaction in forces.reactions.items():
        lost = tuple(c for c, known in zip(COMPONENTS, reaction.determinate, strict=True) if not known)
        parts.setdefault(lost, []).append(name)
    everywhere = len(parts) == 1
    listed = [
        f"{', '.join(lost)} {'in every joint' if everywhere else 'of ' + ', '.join(joints)}"
        for lost, joints in parts.items()
        if lost
    ]
    what = "; ".join(forces.indeterminate)
    alone = known_alone(forces)
    return [
        (
            "not determined",
            f"rigid bodies leave open {what}, which all joints bear together: {'; '.join(listed)}",
        ),
        ("", "these depend on clearances and elasticity; one joint with more freedom determines them"),
        *([("", f"known alone, greatest of the rows: {', '.join(alone)}")] if alone else []),
    ]


def unbounded_facts(forces: Forces, found: Sizing | None) -> list[tuple[str, str]]:
    """Joints whose forces have no bound at the circuit's change points."""
    if found is None or not forces.through_change_points:
        return []
    lost = [
        name
        for name, reaction in forces.reactions.items()
        if reaction.determinate.any() and not _any_known(found.bearings[name])
    ]
    if not lost:
        return []
    return [
        (
            "no bound",
            f"forces in {', '.join(lost)} grow without bound at the change points, where a link in line "
            "with its neighbour cannot drive it; the torque does not",
        )
    ]


def _any_known(bearing: Bearing) -> bool:
    return any(math.isfinite(getattr(bearing, part).peak.value) for part in LISTED)


def known_alone(forces: Forces) -> list[str]:
    """Forces square to a joint's axis that are determined while the other one is not."""
    found = []
    for name, reaction in forces.reactions.items():
        x, y = reaction.determinate[3:5]
        if x != y:
            which = 0 if x else 1
            found.append(f"{COMPONENTS[3 + which]} {number(greatest(reaction.force[:, which]))} N of {name}")
    return found


def shaking_found(forces: Forces) -> Shaking | None:
    """How the linkage shakes the ground; `None` at rest and where a row has no rates."""
    if forces.at_rest or not np.isfinite(forces.shaking).all() or not forces.bodies:
        return None
    return shaking_of(forces.shaking, forces.input, period=forces.period, time=forces.time)


def shaking_facts(forces: Forces, found: Shaking | None) -> list[tuple[str, str]]:
    """Shaking force and moment, peaks and root mean squares."""
    if found is None:
        return []
    place = Places(forces)
    return [
        ("shaking force", f"peak {place.at(found.force, 'N')}, rms {number(found.rms_force)} N"),
        (
            "moment",
            f"about the origin: peak {place.at(found.moment, 'N m')}, rms {number(found.rms_moment)} N m",
        ),
    ]


def check_values(forces: Forces) -> dict[str, float | None]:
    """The checks of a result, each an error as a part of a peak; `None` where one cannot be made."""
    work = None
    if forces.periodic and not forces.at_rest and np.isfinite(forces.power).all():
        peak = float(np.abs(forces.power).max())
        work = float(abs(np.mean(forces.power + forces.supplied)) / peak) if peak else 0.0
    return {"power": forces.balance, "ground": forces.ground_balance, "work": work}


def check_text(forces: Forces) -> str:
    """The checks in words."""
    values = check_values(forces)
    kind = "torque is the slope of potential energy" if forces.at_rest else "power closes along the cycle"
    words = {
        "power": kind,
        "ground": "the ground bears weights, loads and shaking",
        "work": "work of a cycle",
    }
    made = [f"{words[key]} to {value:.1e}" for key, value in values.items() if value is not None]
    return ", ".join(made) + " of the peak" if made else ""


def found_text(found: Sizing | None, *, law: bool = False) -> str:
    """How peaks were found; `law`: the rows are those of one."""
    if found is None:
        return ""
    match found.found:
        case "series":
            tail = f"; what the rows may miss is {found.tail:.0e} of the peak"
            return f"by a series through all rows, peaks between them{tail}"
        case "pieces":
            return "between the inputs at which loads set in or end, peaks within and at them"
        case _:
            rows = "of the rows as they are"
            return f"{rows}, those of the law: its accelerations are as good as its table" if law else rows


def greatest(values: Floats) -> float:
    """The greatest size of known values, NaN where none is known."""
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if known.size else math.nan
