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


def least_text(found: LeastPoint) -> Page:
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
        free = _numbers(direction)
        facts.add("free", say("along ({direction}) nothing changes; the middle is taken", direction=free))
    if (solver := found.solver) is not None:
        what = say(
            "{status} in {steps} steps, round {round}: primal {primal:.7g}, dual {dual:.7g} {unit} at "
            "{rows} rows; then Newton's method",
            round=found.rounds, unit=unit, rows=len(solver.duals),
            **named(solver, "status", "steps", "primal", "dual"),
        )  # fmt: skip
        facts.add("Clarabel", what)
    facts.add_all(("note", note) for note in notes(found.cycle))
    tables = []
    if found.before:
        # how many times the least; nothing where that is zero
        times = "{:.3f}" if found.value > 1e-9 * found.scale else ""
        rows = [
            [p.name, _place(p.at), f"{p.value:.6g}", times and times.format(p.value / found.value)]
            for p in found.before
        ]
        rows.append([say("found"), _place(found.at), f"{found.value:.6g}", ""])
        size = say("root mean square") if found.measure == "rms" else say("greatest")
        head = ["point", "at", f"{size} [{unit}]", "times"]
        tables.append(number_table(head, rows, words=[1]))
    return page(found.cycle.motion.linkage.heading, facts, *tables)


def _met(found: LeastPoint) -> str:
    pairs = zip(found.inputs[:MOST_LISTED], found.weights, strict=False)
    text = say(", ").join(
        say("{input} (weight {weight:.3f})", input=input_text(found.cycle.motion, float(x)), weight=w)
        for x, w in pairs
    )
    text = f"{found.cycle.motion.input} = {text}"
    more = len(found.inputs) - MOST_LISTED
    return say("{inputs} and {count} more", inputs=text, count=more) if more > 0 else text


def nearest_text(found: NearestPath) -> Page:
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
    facts.add_all(("note", note) for note in notes(found.cycle))
    return page(found.cycle.motion.linkage.heading, facts)


def inertia_text(found: Inertia) -> Page:
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
    facts.add_all(("note", note) for note in notes(found.cycle, [mass.link for mass in found.masses]))
    rows = []
    for mass, sizes in zip(found.masses, found.sizes, strict=True):
        cells = [mass.name, str(mass.link), f"{mass.mass:g}"]
        for place in (int(sizes.argmax()), int(sizes.argmin())):
            cells += [f"{sizes[place]:.6g}", input_text(motion, float(found.input[place]))]
        rows.append(cells)
    head = ["mass", "link", "kg", "greatest force [N]", "at", "least force [N]", "at"]
    return page(found.cycle.motion.linkage.heading, facts, number_table(head, rows))


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


def as_dict(found: LeastPoint | NearestPath | Inertia) -> dict[str, Any]:
    """What was found as plain values: inputs in radians or lengths."""
    cycle = found.cycle
    motion = cycle.motion
    return {
        "format": 1,
        "linkage": motion.linkage.name,
        "units": {"length": motion.linkage.length_unit, "angle": "rad", "time": "s", "mass": "kg"},
        "drive": {"input": motion.input, "speed": None if motion.law is not None else motion.speed},
        "circuit": cycle.circuit.index,
        "branch": cycle.branch,
        "notes": notes(cycle, [mass.link for mass in found.masses] if isinstance(found, Inertia) else ()),
        **_OWN[type(found)](found),
    }


def _least_dict(found: LeastPoint) -> dict[str, Any]:
    solver = found.solver
    return {
        **named(found, "link", "of", "measure"),
        "box": np.stack([found.low, found.high], axis=1).tolist(),
        **named(found, "at", "value"),
        "lower_bound": found.bound,
        **named(found, "gap", "relative_gap", "optimal"),
        "whole_cycle": found.cycle.closed,
        **named(found, "unit", "inputs", "weights", "sides", "free"),
        "before": [named(point, "name", "at", "value") for point in found.before],
        "rounds": found.rounds,
        "clarabel": solver and named(solver, "status", "steps", "primal", "dual", "residual"),
    }


def _nearest_dict(found: NearestPath) -> dict[str, Any]:
    return {
        **named(found, "link", "measure", "at"),
        "places": len(found.wanted),
        **named(found, "rms", "greatest"),
        "lower_bound": found.bound,
        **named(found, "starts", "agreeing"),
    }


def _inertia_dict(found: Inertia) -> dict[str, Any]:
    ends = {"highest": int(found.torque.argmax()), "lowest": int(found.torque.argmin())}
    return {
        **named(found, "gravity", "unit"),
        "period": found.cycle.period,
        **{
            word: {"value": float(found.torque[row]), "at": float(found.input[row])}
            for word, row in ends.items()
        },
        "mean": found.mean,
        "masses": [
            {
                **named(mass, "name", "link", "at", "mass"),
                "greatest_force": float(sizes.max()),
                "least_force": float(sizes.min()),
            }
            for mass, sizes in zip(found.masses, found.sizes, strict=True)
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
    drawn: Files[NearestPath] = figure_files("point", figures, lambda found: nearest_figure(found, name))
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


def _rate_columns(found: LeastPoint, name: str) -> dict[str, Floats]:
    columns = _row_columns(found.cycle)
    unit = unit_in_column(found.unit)
    for point, at in [*((p.name, np.array(p.at)) for p in found.before), (name, found.at)]:
        columns[f"{point}_{found.of}_{unit}"] = found.cycle.sizes(found.of, at)
    return columns


def _path_columns(found: NearestPath) -> dict[str, Floats]:
    unit = found.cycle.motion.linkage.length_unit
    return {
        **_input_column(found.cycle, found.inputs),
        **_coordinates(f"wanted_{{}}_{unit}", found.wanted),
        **_coordinates(f"path_{{}}_{unit}", found.path),
        f"distance_{unit}": found.distances,
    }


def _inertia_columns(found: Inertia) -> dict[str, Floats]:
    columns = _row_columns(found.cycle)
    columns["force_N" if found.slides else "torque_Nm"] = found.torque
    columns |= {"power_W": found.power, "kinetic_energy_J": found.kinetic}
    for mass, force in zip(found.masses, found.force, strict=True):
        columns |= {f"{mass.name}_{key}": own for key, own in _coordinates("f{}_N", force).items()}
    return columns


def _pole_columns(found: LeastPoint) -> dict[str, Any]:
    poles = poles_of(found.cycle, found.at)
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
