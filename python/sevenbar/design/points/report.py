"""The report of points that were found, and of masses: printed, as JSON, and as files in a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from rich.console import RenderableType

from sevenbar.arrays import Floats
from sevenbar.design.points.cycle import Cycle, input_text, shown_inputs
from sevenbar.design.points.figures import inertia_figure, least_figure, nearest_figure
from sevenbar.design.points.inertia import Inertia
from sevenbar.design.points.least import LeastPoint
from sevenbar.design.points.nearest import NearestPath
from sevenbar.design.points.poles import poles_of
from sevenbar.drawing.figure import slides
from sevenbar.kinematics.loop.columns import joint_column, unit_in_column
from sevenbar.reporting.files import Report, columns_file, figure_files, json_file, text_file
from sevenbar.reporting.page import Facts, number_table, opening, page
from sevenbar.reporting.shown import drive_text
from sevenbar.text.printing import text_of
from sevenbar.text.words import retold, say

#: Most inputs that are listed; more are a rate that is as great at all of them.
MOST_LISTED = 6


def least_text(found: LeastPoint) -> RenderableType:
    """A point of least rate as a page."""
    facts, unit = Facts(), found.unit
    rate = say(found.of)
    word = (
        say("root mean square {rate}", rate=rate)
        if found.measure == "rms"
        else say("greatest {rate}", rate=rate)
    )
    facts.add("link", f"{found.link}{say(', ')}{_whose(found.cycle)}")
    sides = zip("uvw", found.low, found.high, strict=True)
    box = ", ".join(f"{letter} {a:g}{say(' to ')}{b:g}" for letter, a, b in sides)
    facts.add("box", box + _length(found.cycle))
    facts.add("point", _place(found.at) + _length(found.cycle), style="bold")
    facts.add(word, f"{found.value:.9g} {unit}", style="bold")
    bound = f"{found.bound:.9g} {unit}"
    facts.add("lower bound", say("{bound}: no point of the box has less", bound=bound))
    whole = (
        say("over the whole cycle, between the rows too")
        if found.cycle.closed
        else say("over the law's rows")
    )
    gap = say(
        "{gap:.2g} {unit}, {share:.2g} of the value", gap=found.gap, unit=unit, share=found.relative_gap
    )
    facts.add("duality gap", say(", ").join([gap, whole]))
    if len(found.inputs):
        facts.add("met at", _met(found))
    if found.sides:
        facts.add("on the box", ", ".join(found.sides))
    for direction in found.free:
        facts.add(
            "free",
            say("along ({direction}) nothing changes; the middle is taken", direction=_numbers(direction)),
        )
    if found.solver is not None:
        solver = found.solver
        facts.add(
            "Clarabel",
            say(
                "{status} in {steps} steps, round {round}: primal {primal:.7g}, dual {dual:.7g} {unit} at "
                "{rows} rows; then Newton's method",
                status=solver.status,
                steps=solver.steps,
                round=found.rounds,
                primal=solver.primal,
                dual=solver.dual,
                unit=unit,
                rows=len(solver.weights),
            ),
        )
    for note in notes(found.cycle):
        facts.add("note", note)
    tables = []
    if found.before:
        rows = [[p.name, _place(p.at), f"{p.value:.6g}", _times(p.value, found)] for p in found.before]
        rows.append([say("found"), _place(found.at), f"{found.value:.6g}", ""])
        size = say("root mean square") if found.measure == "rms" else say("greatest")
        head = ["point", "at", f"{size} [{unit}]", "times"]
        tables.append(number_table(head, rows, words=[1]))
    return page(_heading(found.cycle), facts, *tables)


def _met(found: LeastPoint) -> str:
    pairs = zip(found.inputs[:MOST_LISTED], found.weights, strict=False)
    text = say(", ").join(
        say("{input} (weight {weight:.3f})", input=input_text(found.cycle.motion, float(x)), weight=w)
        for x, w in pairs
    )
    text = f"{found.cycle.motion.input} = {text}"
    more = len(found.inputs) - MOST_LISTED
    return say("{inputs} and {count} more", inputs=text, count=more) if more > 0 else text


def _times(value: float, found: LeastPoint) -> str:
    """How many times the least a value is; nothing where that is zero."""
    return f"{value / found.value:.3f}" if found.value > 1e-9 * found.scale else ""


def nearest_text(found: NearestPath) -> RenderableType:
    """A point with a nearest path as a page."""
    facts, length = Facts(), _length(found.cycle)
    facts.add("link", f"{found.link}{say(', ')}{_whose(found.cycle)}")
    places = len(found.wanted)
    timed = (
        say("{count} places, each at its input", count=places)
        if found.bound is not None
        else say("{count} places, at any inputs", count=places)
    )
    facts.add("curve", timed)
    facts.add("point", _place(found.at) + length, style="bold")
    distance = say("rms {rms:.6g}, greatest {greatest:.6g}", rms=found.rms, greatest=found.greatest)
    facts.add("distance", distance + length, style="bold")
    if found.bound is not None:
        bound = f"{say(found.measure)} {found.bound:.6g}{length}"
        facts.add("lower bound", say("{bound}: no point of the box is nearer", bound=bound))
    else:
        best = say(
            "local: the best of {starts} starts, {count} of which ended there",
            starts=found.starts, count=found.agreeing,
        )  # fmt: skip
        facts.add("optimum", best)
    for note in notes(found.cycle):
        facts.add("note", note)
    return page(_heading(found.cycle), facts)


def inertia_text(found: Inertia) -> RenderableType:
    """What masses do as a page."""
    facts, motion = Facts(), found.cycle.motion
    what = say("force") if found.slides else say("torque")
    facts.add("circuit", _whose(found.cycle))
    facts.add("rows", say("{count} over {time:.6g} s", count=len(found.input), time=found.cycle.period))
    if any(found.gravity):
        facts.add("gravity", f"({_numbers(found.gravity)}) m/s^2")
    for word, row in (("highest", int(found.torque.argmax())), ("lowest", int(found.torque.argmin()))):
        at = input_text(motion, float(found.input[row]))
        value = f"{found.torque[row]:.6g} {found.unit}"
        label = say("highest {what}", what=what) if word == "highest" else say("lowest {what}", what=what)
        facts.add(label, say("{value} at {input}", value=value, input=f"{motion.input} = {at}"))
    facts.add(say("mean {what}", what=what), f"{found.mean:.2g} {found.unit}")
    rms = float(np.sqrt(found.cycle.mean(found.torque**2)))
    facts.add(say("rms {what}", what=what), f"{rms:.6g} {found.unit}")
    for note in notes(found.cycle, [mass.link for mass in found.masses]):
        facts.add("note", note)
    rows = []
    for mass, sizes in zip(found.masses, found.sizes, strict=True):
        cells = [mass.name, str(mass.link), f"{mass.mass:g}"]
        for place in (int(sizes.argmax()), int(sizes.argmin())):
            cells += [f"{sizes[place]:.6g}", input_text(motion, float(found.input[place]))]
        rows.append(cells)
    head = ["mass", "link", "kg", "greatest force [N]", "at", "least force [N]", "at"]
    return page(_heading(found.cycle), facts, number_table(head, rows))


def notes(cycle: Cycle, links: Sequence[int] = ()) -> list[str]:
    """What a reader has to know besides: a spin that the linkage leaves open."""
    text = []
    for freedom in cycle.motion.idle:
        if any(f"link {link})" in freedom or f"link {link} " in freedom for link in links or [cycle.link]):
            text.append(
                say(
                    "the {freedom} is open in the linkage; points off that line move as the convention for "
                    "it says",
                    freedom=retold(freedom),
                )
            )
    return text


def _heading(cycle: Cycle) -> str:
    return cycle.motion.linkage.heading


def _whose(cycle: Cycle) -> str:
    motion = cycle.motion
    unit = motion.linkage.unit_of(motion.input)
    drive = drive_text(motion.input, None if motion.law is not None else motion.speed, unit)
    parts = [say("circuit {number}", number=cycle.circuit.index)]
    if not cycle.circuit.goes_round:
        parts.append(say("branch {number}", number=cycle.branch))
    return say(", ").join([*parts, drive])


def _numbers(values: Sequence[float] | Floats) -> str:
    # no minus before a zero
    return ", ".join(f"{float(value) + 0.0:.6g}" for value in values)


def _place(at: Sequence[float] | Floats) -> str:
    return f"({_numbers(np.round(np.asarray(at, dtype=float), 9))})"


def _length(cycle: Cycle) -> str:
    return f" {cycle.motion.linkage.length_unit}"


def as_dict(found: LeastPoint | NearestPath | Inertia) -> dict[str, Any]:
    """What was found as plain values: inputs in radians or lengths."""
    cycle = found.cycle
    motion = cycle.motion
    common = {
        "format": 1,
        "linkage": motion.linkage.name,
        "units": {"length": motion.linkage.length_unit, "angle": "rad", "time": "s", "mass": "kg"},
        "drive": {"input": motion.input, "speed": None if motion.law is not None else motion.speed},
        "circuit": cycle.circuit.index,
        "branch": cycle.branch,
        "notes": notes(cycle, [mass.link for mass in found.masses] if isinstance(found, Inertia) else ()),
    }
    if isinstance(found, LeastPoint):
        return common | _least_dict(found)
    if isinstance(found, NearestPath):
        return common | _nearest_dict(found)
    return common | _inertia_dict(found)


def _least_dict(found: LeastPoint) -> dict[str, Any]:
    solver = found.solver
    return {
        "link": found.link,
        "of": found.of,
        "measure": found.measure,
        "box": np.stack([found.low, found.high], axis=1).tolist(),
        "at": found.at.tolist(),
        "value": found.value,
        "lower_bound": found.bound,
        "gap": found.gap,
        "relative_gap": found.relative_gap,
        "optimal": found.optimal,
        "whole_cycle": found.cycle.closed,
        "unit": found.unit,
        "inputs": found.inputs.tolist(),
        "weights": found.weights.tolist(),
        "sides": list(found.sides),
        "free": found.free.tolist(),
        "before": [{"name": p.name, "at": list(p.at), "value": p.value} for p in found.before],
        "rounds": found.rounds,
        "clarabel": None
        if solver is None
        else {
            "status": solver.status,
            "steps": solver.steps,
            "primal": solver.primal,
            "dual": solver.dual,
            "residual": solver.residual,
        },
    }


def _nearest_dict(found: NearestPath) -> dict[str, Any]:
    return {
        "link": found.link,
        "measure": found.measure,
        "at": found.at.tolist(),
        "places": len(found.wanted),
        "rms": found.rms,
        "greatest": found.greatest,
        "lower_bound": found.bound,
        "starts": found.starts,
        "agreeing": found.agreeing,
    }


def _inertia_dict(found: Inertia) -> dict[str, Any]:
    high, low = int(found.torque.argmax()), int(found.torque.argmin())
    return {
        "gravity": list(found.gravity),
        "unit": found.unit,
        "period": found.cycle.period,
        "highest": {"value": float(found.torque[high]), "at": float(found.input[high])},
        "lowest": {"value": float(found.torque[low]), "at": float(found.input[low])},
        "mean": found.mean,
        "masses": [
            {
                "name": mass.name,
                "link": mass.link,
                "at": list(mass.at),
                "mass": mass.mass,
                "greatest_force": float(sizes.max()),
                "least_force": float(sizes.min()),
            }
            for mass, sizes in zip(found.masses, found.sizes, strict=True)
        ],
    }


def least_report(
    toml: Callable[[LeastPoint], str], name: str, figures: Sequence[str] = ("png",)
) -> Report[LeastPoint]:
    """How a point of least rate is reported, which has a name in the file that `toml` makes."""
    return Report(
        least_text,
        as_dict,
        {
            "point.toml": text_file(toml),
            "point.json": json_file(as_dict),
            "rates.csv": columns_file(partial(_rate_columns, name=name)),
            "poles.csv": columns_file(_pole_columns),
            **figure_files(
                "point", figures, lambda found: least_figure(found, poles_of(found.cycle, found.at), name)
            ),
        },
        spoken=True,
    )


def nearest_report(
    toml: Callable[[NearestPath], str], name: str, figures: Sequence[str] = ("png",)
) -> Report[NearestPath]:
    """How a point with a nearest path is reported, which has a name in the file that `toml` makes."""
    return Report(
        nearest_text,
        as_dict,
        {
            "point.toml": text_file(toml),
            "point.json": json_file(as_dict),
            "path.csv": columns_file(_path_columns),
            **figure_files("point", figures, lambda found: nearest_figure(found, name)),
        },
        spoken=True,
    )


def inertia_report(figures: Sequence[str] = ("png",)) -> Report[Inertia]:
    """How inertia forces are reported."""
    return Report(
        inertia_text,
        as_dict,
        {
            "inertia.json": json_file(as_dict),
            "inertia.csv": columns_file(_inertia_columns),
            **figure_files("inertia", figures, inertia_figure),
        },
        spoken=True,
    )


def _input_head(cycle: Cycle) -> str:
    motion = cycle.motion
    length = motion.linkage.length_unit
    return joint_column(
        motion.input, slides=slides(motion, motion.input), order=0, length=length, angle="deg"
    )


def _row_columns(cycle: Cycle) -> dict[str, Floats]:
    return {"time_s": cycle.rates.time, _input_head(cycle): shown_inputs(cycle, cycle.rates.input)}


def _rate_columns(found: LeastPoint, name: str) -> dict[str, Floats]:
    columns = _row_columns(found.cycle)
    unit = unit_in_column(found.unit)
    for point, at in [*((p.name, np.array(p.at)) for p in found.before), (name, found.at)]:
        sizes = np.linalg.norm(found.cycle.rates.of(found.of, at), axis=1)
        columns[f"{point}_{found.of}_{unit}"] = sizes
    return columns


def _path_columns(found: NearestPath) -> dict[str, Floats]:
    unit = found.cycle.motion.linkage.length_unit
    columns = {_input_head(found.cycle): shown_inputs(found.cycle, found.inputs)}
    for who, places in (("wanted", found.wanted), ("path", found.path)):
        for i, letter in enumerate("xyz"):
            columns[f"{who}_{letter}_{unit}"] = places[:, i]
    return columns | {f"distance_{unit}": found.distances}


def _inertia_columns(found: Inertia) -> dict[str, Floats]:
    columns = _row_columns(found.cycle)
    columns["force_N" if found.slides else "torque_Nm"] = found.torque
    columns |= {"power_W": found.power, "kinetic_energy_J": found.kinetic}
    for mass, force in zip(found.masses, found.force, strict=True):
        for i, letter in enumerate("xyz"):
            columns[f"{mass.name}_f{letter}_N"] = force[:, i]
    return columns


def _pole_columns(found: LeastPoint) -> dict[str, Any]:
    poles = poles_of(found.cycle, found.at)
    unit = poles.cycle.motion.linkage.length_unit
    columns: dict[str, Any] = _row_columns(poles.cycle) | {"status": poles.status}
    for letters, values in (("uvw", poles.at), ("xyz", poles.place)):
        for i, letter in enumerate(letters):
            columns[f"{letter}_{unit}"] = values[:, i]
    return columns | {f"remaining_{unit}_s2": poles.remaining, "condition": poles.condition}


@text_of.register(LeastPoint)
def _(found: LeastPoint) -> str:
    return opening("Least point", least_text(found))


@text_of.register(NearestPath)
def _(found: NearestPath) -> str:
    return opening("Nearest path", nearest_text(found))


@text_of.register(Inertia)
def _(found: Inertia) -> str:
    return opening("Inertia", inertia_text(found))
