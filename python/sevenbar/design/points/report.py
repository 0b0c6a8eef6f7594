"""The report of points that were found, and of masses: printed, as JSON, and as files in a folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.points.cycle import Cycle, input_text
from sevenbar.design.points.figures import inertia_figure, least_figure, nearest_figure
from sevenbar.design.points.inertia import Inertia
from sevenbar.design.points.least import LeastPoint
from sevenbar.design.points.nearest import NearestPath
from sevenbar.design.points.poles import poles_of
from sevenbar.drawing.figure import shown_value, slides
from sevenbar.kinematics.loop.columns import joint_column, unit_in_column
from sevenbar.reporting.files import Files, Report, columns_file, figure_files, json_file, text_file
from sevenbar.reporting.page import Facts, Page, number_table, page, prints_its_page
from sevenbar.reporting.shown import drive_text
from sevenbar.text.listed import named
from sevenbar.text.words import retold, say

#: Most inputs that are listed; more are a rate that is as great at all of them.
MOST_LISTED = 6


def least_text(result: LeastPoint) -> Page:
    """A point of least rate as a page."""
    facts, unit = Facts(), result.unit
    rate = say(result.of)
    word = (
        say("root mean square {rate}", rate=rate)
        if result.measure == "rms"
        else say("greatest {rate}", rate=rate)
    )
    facts.add("link", f"{result.link}{say(', ')}{_whose(result.cycle)}")
    sides = zip("uvw", result.low, result.high, strict=True)
    box = ", ".join(f"{letter} {a:g}{say(' to ')}{b:g}" for letter, a, b in sides)
    facts.add("box", box + _length(result.cycle))
    facts.add("point", _place(result.at) + _length(result.cycle), style="bold")
    facts.add(word, f"{result.value:.9g} {unit}", style="bold")
    bound = f"{result.bound:.9g} {unit}"
    facts.add("lower bound", say("{bound}: no point of the box has less", bound=bound))
    whole = (
        say("over the whole cycle, between the rows too")
        if result.cycle.closed
        else say("over the law's rows")
    )
    gap = say(
        "{gap:.2g} {unit}, {share:.2g} of the value", gap=result.gap, unit=unit, share=result.relative_gap
    )
    facts.add("duality gap", say(", ").join([gap, whole]))
    if len(result.inputs):
        facts.add("met at", _met(result))
    if result.sides:
        facts.add("on the box", ", ".join(result.sides))
    for direction in result.free:
        free = _numbers(direction)
        facts.add("free", say("along ({direction}) nothing changes; the middle is taken", direction=free))
    if (solver := result.solver) is not None:
        what = say(
            "{status} in {steps} steps, round {round}: primal {primal:.7g}, dual {dual:.7g} {unit} at "
            "{rows} rows; then Newton's method",
            round=result.rounds, unit=unit, rows=len(solver.duals),
            **named(solver, "status", "steps", "primal", "dual"),
        )  # fmt: skip
        facts.add("Clarabel", what)
    facts.add_all(("note", note) for note in notes(result.cycle))
    tables = []
    if result.before:
        # how many times the least; nothing where that is zero
        times = "{:.3f}" if result.value > 1e-9 * result.scale else ""
        rows = [
            [p.name, _place(p.at), f"{p.value:.6g}", times and times.format(p.value / result.value)]
            for p in result.before
        ]
        rows.append([say("found"), _place(result.at), f"{result.value:.6g}", ""])
        size = say("root mean square") if result.measure == "rms" else say("greatest")
        head = ["point", "at", f"{size} [{unit}]", "times"]
        tables.append(number_table(head, rows, words=[1]))
    return page(result.cycle.motion.linkage.heading, facts, *tables)


def _met(result: LeastPoint) -> str:
    pairs = zip(result.inputs[:MOST_LISTED], result.weights, strict=False)
    text = say(", ").join(
        say("{input} (weight {weight:.3f})", input=input_text(result.cycle.motion, float(x)), weight=w)
        for x, w in pairs
    )
    text = f"{result.cycle.motion.input} = {text}"
    more = len(result.inputs) - MOST_LISTED
    return say("{inputs} and {count} more", inputs=text, count=more) if more > 0 else text


def nearest_text(result: NearestPath) -> Page:
    """A point with a nearest path as a page."""
    facts, length = Facts(), _length(result.cycle)
    facts.add("link", f"{result.link}{say(', ')}{_whose(result.cycle)}")
    places = len(result.wanted)
    timed = (
        say("{count} places, each at its input", count=places)
        if result.bound is not None
        else say("{count} places, at any inputs", count=places)
    )
    facts.add("curve", timed)
    facts.add("point", _place(result.at) + length, style="bold")
    distance = say("rms {rms:.6g}, greatest {greatest:.6g}", rms=result.rms, greatest=result.greatest)
    facts.add("distance", distance + length, style="bold")
    if result.bound is not None:
        bound = f"{say(result.measure)} {result.bound:.6g}{length}"
        facts.add("lower bound", say("{bound}: no point of the box is nearer", bound=bound))
    else:
        best = say(
            "local: the best of {starts} starts, {count} of which ended there",
            starts=result.starts, count=result.agreeing,
        )  # fmt: skip
        facts.add("optimum", best)
    facts.add_all(("note", note) for note in notes(result.cycle))
    return page(result.cycle.motion.linkage.heading, facts)


def inertia_text(result: Inertia) -> Page:
    """What masses do as a page."""
    facts, motion = Facts(), result.cycle.motion
    what = say("force") if result.slides else say("torque")
    facts.add("circuit", _whose(result.cycle))
    facts.add("rows", say("{count} over {time:.6g} s", count=len(result.input), time=result.cycle.period))
    if any(result.gravity):
        facts.add("gravity", f"({_numbers(result.gravity)}) m/s^2")
    for word, row in (("highest", int(result.torque.argmax())), ("lowest", int(result.torque.argmin()))):
        at = input_text(motion, float(result.input[row]))
        value = f"{result.torque[row]:.6g} {result.unit}"
        label = say("highest {what}", what=what) if word == "highest" else say("lowest {what}", what=what)
        facts.add(label, say("{value} at {input}", value=value, input=f"{motion.input} = {at}"))
    facts.add(say("mean {what}", what=what), f"{result.mean:.2g} {result.unit}")
    rms = float(np.sqrt(result.cycle.mean(result.torque**2)))
    facts.add(say("rms {what}", what=what), f"{rms:.6g} {result.unit}")
    facts.add_all(("note", note) for note in notes(result.cycle, [mass.link for mass in result.masses]))
    rows = []
    for mass, sizes in zip(result.masses, result.sizes, strict=True):
        cells = [mass.name, str(mass.link), f"{mass.mass:g}"]
        for place in (int(sizes.argmax()), int(sizes.argmin())):
            cells += [f"{sizes[place]:.6g}", input_text(motion, float(result.input[place]))]
        rows.append(cells)
    head = ["mass", "link", "kg", "greatest force [N]", "at", "least force [N]", "at"]
    return page(result.cycle.motion.linkage.heading, facts, number_table(head, rows))


def notes(cycle: Cycle, links: Sequence[int] = ()) -> list[str]:
    """What a reader has to know besides: a spin that the linkage leaves open."""
    text = []
    for freedom in cycle.motion.idle:
        if any(f"link {link})" in freedom or f"link {link} " in freedom for link in links or [cycle.link]):
            spin = retold(freedom)
            text.append(
                say(
                    "the {freedom} is open in the linkage; points off that line move as the convention for "
                    "it says",
                    freedom=spin,
                )
            )
    return text


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


def as_dict(result: LeastPoint | NearestPath | Inertia) -> dict[str, Any]:
    """What was found as plain values: inputs in radians or lengths."""
    cycle = result.cycle
    motion = cycle.motion
    return {
        "format": 1,
        "linkage": motion.linkage.name,
        "units": {"length": motion.linkage.length_unit, "angle": "rad", "time": "s", "mass": "kg"},
        "drive": {"input": motion.input, "speed": None if motion.law is not None else motion.speed},
        "circuit": cycle.circuit.index,
        "branch": cycle.branch,
        "notes": notes(cycle, [mass.link for mass in result.masses] if isinstance(result, Inertia) else ()),
        **_OWN[type(result)](result),
    }


def _least_dict(result: LeastPoint) -> dict[str, Any]:
    solver = result.solver
    return {
        **named(result, "link", "of", "measure"),
        "box": np.stack([result.low, result.high], axis=1).tolist(),
        **named(result, "at", "value"),
        "lower_bound": result.bound,
        **named(result, "gap", "relative_gap", "optimal"),
        "whole_cycle": result.cycle.closed,
        **named(result, "unit", "inputs", "weights", "sides", "free"),
        "before": [named(point, "name", "at", "value") for point in result.before],
        "rounds": result.rounds,
        "clarabel": solver and named(solver, "status", "steps", "primal", "dual", "residual"),
    }


def _nearest_dict(result: NearestPath) -> dict[str, Any]:
    return {
        **named(result, "link", "measure", "at"),
        "places": len(result.wanted),
        **named(result, "rms", "greatest"),
        "lower_bound": result.bound,
        **named(result, "starts", "agreeing"),
    }


def _inertia_dict(result: Inertia) -> dict[str, Any]:
    ends = {"highest": int(result.torque.argmax()), "lowest": int(result.torque.argmin())}
    return {
        **named(result, "gravity", "unit"),
        "period": result.cycle.period,
        **{
            word: {"value": float(result.torque[row]), "at": float(result.input[row])}
            for word, row in ends.items()
        },
        "mean": result.mean,
        "masses": [
            {
                **named(mass, "name", "link", "at", "mass"),
                "greatest_force": float(sizes.max()),
                "least_force": float(sizes.min()),
            }
            for mass, sizes in zip(result.masses, result.sizes, strict=True)
        ],
    }


_OWN: Mapping[type, Callable[[Any], dict[str, Any]]] = {
    LeastPoint: _least_dict,
    NearestPath: _nearest_dict,
    Inertia: _inertia_dict,
}


def least_report(
    toml: Callable[[LeastPoint], str], name: str, figures: Sequence[str] = ("png",)
) -> Report[LeastPoint]:
    """How a point of least rate is reported, which has a name in the file that `toml` makes."""
    files = {
        "point.toml": text_file(toml),
        "point.json": json_file(as_dict),
        "rates.csv": columns_file(partial(_rate_columns, name=name)),
        "poles.csv": columns_file(_pole_columns),
    }
    drawn: Files[LeastPoint] = figure_files(
        "point", figures, lambda f: least_figure(f, poles_of(f.cycle, f.at), name)
    )
    return Report(least_text, as_dict, {**files, **drawn}, spoken=True)


def nearest_report(
    toml: Callable[[NearestPath], str], name: str, figures: Sequence[str] = ("png",)
) -> Report[NearestPath]:
    """How a point with a nearest path is reported, which has a name in the file that `toml` makes."""
    files = {
        "point.toml": text_file(toml),
        "point.json": json_file(as_dict),
        "path.csv": columns_file(_path_columns),
    }
    drawn: Files[NearestPath] = figure_files("point", figures, lambda result: nearest_figure(result, name))
    return Report(nearest_text, as_dict, {**files, **drawn}, spoken=True)


def inertia_report(figures: Sequence[str] = ("png",)) -> Report[Inertia]:
    """How inertia forces are reported."""
    files = {"inertia.json": json_file(as_dict), "inertia.csv": columns_file(_inertia_columns)}
    drawn = figure_files("inertia", figures, inertia_figure)
    return Report(inertia_text, as_dict, {**files, **drawn}, spoken=True)


def _input_column(cycle: Cycle, inputs: Floats) -> dict[str, Floats]:
    """Inputs as a column, angles in degrees."""
    motion = cycle.motion
    length, slide = motion.linkage.length_unit, slides(motion, motion.input)
    name = joint_column(motion.input, slides=slide, order=0, length=length, angle="deg")
    return {name: shown_value(motion, motion.input, inputs)}


def _row_columns(cycle: Cycle) -> dict[str, Any]:
    return {"time_s": cycle.rates.time, **_input_column(cycle, cycle.rates.input)}


def _coordinates(name: str, places: Floats, letters: str = "xyz") -> dict[str, Floats]:
    """The coordinates of places (n, 3) as columns, by a name with a mark for the letter."""
    return {name.format(letter): places[:, i] for i, letter in enumerate(letters)}


def _rate_columns(result: LeastPoint, name: str) -> dict[str, Floats]:
    columns = _row_columns(result.cycle)
    unit = unit_in_column(result.unit)
    for point, at in [*((p.name, np.array(p.at)) for p in result.before), (name, result.at)]:
        columns[f"{point}_{result.of}_{unit}"] = result.cycle.sizes(result.of, at)
    return columns


def _path_columns(result: NearestPath) -> dict[str, Floats]:
    unit = result.cycle.motion.linkage.length_unit
    return {
        **_input_column(result.cycle, result.inputs),
        **_coordinates(f"wanted_{{}}_{unit}", result.wanted),
        **_coordinates(f"path_{{}}_{unit}", result.path),
        f"distance_{unit}": result.distances,
    }


def _inertia_columns(result: Inertia) -> dict[str, Floats]:
    columns = _row_columns(result.cycle)
    columns["force_N" if result.slides else "torque_Nm"] = result.torque
    columns |= {"power_W": result.power, "kinetic_energy_J": result.kinetic}
    for mass, force in zip(result.masses, result.force, strict=True):
        columns |= {f"{mass.name}_{key}": own for key, own in _coordinates("f{}_N", force).items()}
    return columns


def _pole_columns(result: LeastPoint) -> dict[str, Any]:
    poles = poles_of(result.cycle, result.at)
    unit = poles.cycle.motion.linkage.length_unit
    return {
        **_row_columns(poles.cycle),
        "status": poles.status,
        **_coordinates(f"{{}}_{unit}", poles.at, "uvw"),
        **_coordinates(f"{{}}_{unit}", poles.place),
        f"remaining_{unit}_s2": poles.remaining,
        "condition": poles.condition,
    }


prints_its_page(LeastPoint, "Least point", least_text)
prints_its_page(NearestPath, "Nearest path", nearest_text)
prints_its_page(Inertia, "Inertia", inertia_text)
