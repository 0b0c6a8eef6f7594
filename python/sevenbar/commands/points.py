"""The commands `sevenbar design point` and `sevenbar design inertia`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import sevenbar as sb
from sevenbar.commands.options import (
    Figures,
    Force,
    InputJoint,
    Samples,
    Source,
    Speed,
    figure_formats,
    tell_written,
)
from sevenbar.errors import RequestError, shown
from sevenbar.reporting.folder import check_targets
from sevenbar.text.ranges import split_name, split_range

if TYPE_CHECKING:
    from sevenbar.design.points.least import LeastPoint
    from sevenbar.kinematics.motion import Motion

ChosenCircuit = Annotated[int, typer.Option(help="The circuit whose cycle counts.")]
ChosenBranch = Annotated[int, typer.Option(help="The pass of a circuit that rocks; it needs a law.")]
LawFile = Annotated[
    Path | None, typer.Option(help="CSV file of an input law: time, value of the input, perhaps its rates.")
]

#: What `--least` offers.
LEAST = ("acceleration", "velocity", "jerk", "rms")


def point(
    linkage: Source,
    link: Annotated[int, typer.Option(help="The link that carries the point, counted from 1.")],
    box: Annotated[
        str, typer.Option(help="Where on the link, as points are written: '-200:200,-200:200,0:50'.")
    ],
    least: Annotated[
        str | None,
        typer.Option(help=f"What is to be least over the cycle: {', '.join(LEAST)} (of the acceleration)."),
    ] = None,
    curve: Annotated[
        Path | None,
        typer.Option(help="CSV file of a curve, x, y, z, perhaps the input: the nearest path is looked for."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="The name of the point in the new file.")] = None,
    circuit: ChosenCircuit = 0,
    branch: ChosenBranch = 0,
    input_joint: InputJoint = None,
    speed: Speed = None,
    law: LawFile = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for point.toml, point.json, the rows and the figure.")
    ] = None,
    figures: Figures = None,
    force: Force = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print what was found as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Find the point of a link with the least acceleration, or with a wanted path (extra 'design')."""
    from sevenbar.design.curve_table import read_curve
    from sevenbar.design.points import nearest_path_point, report

    endings = figure_formats(figures, out)
    if least is not None and curve is not None:
        raise RequestError("--least: a path near a curve is looked for with --curve; leave one of them out")
    sides = parsed_box(box)
    loaded = sb.load(linkage)
    check_targets([out / "point.toml"] if out is not None else [], force=force)
    motion = _motion(loaded, 360, input_joint, speed, law)
    if curve is not None:
        places, inputs = read_curve(curve, motion.linkage, motion.input)
        called = name or "nearest_path"
        nearest = nearest_path_point(
            motion, link, places, sides, inputs=inputs, circuit=circuit, branch=branch
        )
        written = []
        if out is not None:
            toml = _with_point(linkage, called, link, nearest.at.tolist())
            written = report.write_nearest(nearest, toml, called, out, endings, force=force)
        _tell(nearest, written, json=json)
        return
    found = _least(motion, link, sides, least or "acceleration", circuit, branch)
    called = name or f"least_{least or 'acceleration'}"
    written = []
    if out is not None:
        toml = _with_point(linkage, called, link, found.at.tolist())
        written = report.write_least(found, toml, called, out, endings, force=force)
    _tell(found, written, json=json)


def inertia(
    linkage: Source,
    mass: Annotated[
        list[str], typer.Option(help="A mass in kg at a point of the linkage, as in P=2.5; may be repeated.")
    ],
    gravity: Annotated[
        str | None,
        typer.Option(help="Gravity along x, y, z in m/s^2, as in '0,0,-9.80665'; none by default."),
    ] = None,
    circuit: ChosenCircuit = 0,
    branch: ChosenBranch = 0,
    samples: Samples = 360,
    input_joint: InputJoint = None,
    speed: Speed = None,
    law: LawFile = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for inertia.json, inertia.csv and the figure.")
    ] = None,
    figures: Figures = None,
    force: Force = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print what was found as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Inertia forces of masses at points over the cycle, and the torque that the input needs for them."""
    from sevenbar.design.points import inertia as of_masses
    from sevenbar.design.points import report

    endings = figure_formats(figures, out)
    masses = parsed_masses(mass)
    pull = None if gravity is None else _three(gravity, "--gravity", "0,0,-9.80665")
    loaded = sb.load(linkage)
    check_targets([out / "inertia.json"] if out is not None else [], force=force)
    motion = _motion(loaded, samples, input_joint, speed, law)
    found = of_masses(motion, masses, gravity=pull, circuit=circuit, branch=branch)
    written = [] if out is None else report.write_inertia(found, out, endings, force=force)
    _tell(found, written, json=json)


def parsed_box(text: str) -> list[tuple[float, float]]:
    """The sides of a box written '-200:200,0:50,7'; a number alone is given. Raises `RequestError`."""
    sides = []
    for part in text.split(","):
        low, high = (_number(end) for end in split_range(part) or (part, part))
        if not (math.isfinite(low) and math.isfinite(high)):
            break
        sides.append((low, high))
    if len(sides) != 3 or text.count(",") != 2:
        raise RequestError(
            f"--box: {shown(text)} is no box; give three sides low:high, as in '-200:200,-200:200,0:50'"
        )
    for letter, (low, high) in zip("uvw", sides, strict=True):
        if low > high:
            raise RequestError(
                f"--box: empty along {letter}: lowest {low:g} above highest {high:g}; give the lower first"
            )
    return sides


def parsed_masses(given: list[str]) -> dict[str, float]:
    """Masses written NAME=KILOGRAMS; `RequestError` for others, and for a point given twice."""
    found: dict[str, float] = {}
    for text in given:
        name, value = split_name(text) or ("", "")
        kilograms = _number(value.removesuffix("kg"))
        if not math.isfinite(kilograms):
            raise RequestError(f"--mass: {shown(text)} is no mass; give a point and kilograms, as in P=2.5")
        if name in found:
            raise RequestError(f"--mass: point {shown(name)} is given twice; leave one out")
        found[name] = kilograms
    return found


def _number(word: str) -> float:
    """The number of a text; NaN where it is none."""
    try:
        return float(word)
    except ValueError:
        return math.nan


def _three(text: str, key: str, example: str) -> list[float]:
    values = [_number(word) for word in text.split(",")]
    if len(values) != 3 or not all(math.isfinite(value) for value in values):
        raise RequestError(f"{key}: {shown(text)} is not three numbers; give them as in '{example}'")
    return values


def _motion(
    linkage: sb.Linkage, samples: int, input_joint: str | None, speed: str | None, law: Path | None
) -> Motion:
    if law is not None and speed is not None:
        raise RequestError("--speed: a law gives the speed; leave --speed or --law out")
    read = None if law is None else sb.load_law(law, linkage, input=input_joint)
    return linkage.motion(samples, input=input_joint, speed=speed, law=read)


def _least(
    motion: Motion, link: int, box: list[tuple[float, float]], least: str, circuit: int, branch: int
) -> LeastPoint:
    from sevenbar.design.points import (
        least_acceleration_point,
        least_jerk_point,
        least_rms_point,
        least_velocity_point,
    )

    finders = {
        "acceleration": least_acceleration_point,
        "velocity": least_velocity_point,
        "jerk": least_jerk_point,
        "rms": least_rms_point,
    }
    if least not in finders:
        raise RequestError(f"--least: {shown(least)} is not offered; give one of {', '.join(LEAST)}")
    return finders[least](motion, link, box, circuit=circuit, branch=branch)


def _with_point(source: str, name: str, link: int, at: list[float]) -> str:
    """The file of a linkage with one more point; `RequestError` where it has one of that name."""
    from sevenbar.description.draft import Draft
    from sevenbar.description.files import text_of

    draft = Draft.of(text_of(source), source)
    if name in [point.name for point in draft.linkage.points]:
        raise RequestError(f"--name: {source} has a point {shown(name)} already; give another name")
    longer = draft.with_point(name, link, at)
    # a name that no file may have is told here
    _ = longer.linkage
    return longer.toml()


def _tell(found: object, written: list[Path], *, json: bool) -> None:
    from sevenbar.design.points import report
    from sevenbar.reporting.report import json_text

    if json:
        typer.echo(json_text(report.as_dict(found)))  # type: ignore[arg-type]
        return
    report.print_found(found)  # type: ignore[arg-type]
    tell_written(written)
