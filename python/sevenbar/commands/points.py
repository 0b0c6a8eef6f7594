"""The commands `sevenbar design point` and `sevenbar design inertia`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

import typer

import sevenbar as sb
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import check_law, drafted, law_of, link_of, opened
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError, check_word, shown
from sevenbar.text.amounts import amount_in
from sevenbar.text.ranges import split_list, split_named, split_range, three_numbers
from sevenbar.text.units import amount

if TYPE_CHECKING:
    from sevenbar.design.points.least import LeastPoint, Rate
    from sevenbar.design.points.nearest import NearestPath
    from sevenbar.kinematics.circuits.motion import Motion
    from sevenbar.reporting.files import Report

ChosenCircuit = Annotated[int, typer.Option(help="The circuit whose cycle counts.")]
ChosenBranch = Annotated[int, typer.Option(help="The pass of a circuit that rocks; it needs a law.")]

#: What `--least` offers.
LEAST = ("acceleration", "velocity", "jerk", "rms")


def point(
    linkage: options.Source,
    link: Annotated[
        str, typer.Option(help="The link that carries the point, counted from 1; of a net, or its name.")
    ],
    box: Annotated[
        str, typer.Option(help="Where on the link, as points are written: '-200:200,-200:200,0:50'.")
    ],
    least: Annotated[
        str | None,
        typer.Option(help=f"What is to be least over the cycle: {', '.join(LEAST)} (of the acceleration)."),
    ] = None,
    curve: Annotated[
        Path | None,
        typer.Option(help="CSV file of a curve, x, y, z, perhaps the input: the nearest path is searched."),
    ] = None,
    name: Annotated[str | None, typer.Option(help="The name of the point in the new file.")] = None,
    circuit: ChosenCircuit = 0,
    branch: ChosenBranch = 0,
    input_joint: options.InputJoint = None,
    speed: options.Speed = None,
    law: options.Law = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for point.toml, point.json, the rows and the figure.")
    ] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Find the point of a link with the least acceleration, or with a wanted path (extra 'design')."""
    from sevenbar.design.curve_table import read_curve
    from sevenbar.design.points import least_point, nearest_path_point
    from sevenbar.design.points.report import least_report, nearest_report

    formats = options.figure_formats(figures, out)
    check_law(law, speed)
    if least is not None and curve is not None:
        raise RequestError("--least: a path near a curve is looked for with --curve; leave one of them out")
    draft = drafted(linkage, agree)
    loaded = draft.linkage
    carrier = link_of("--link", link, loaded)
    sides = parsed_box(box, loaded.length_unit)
    called = name or ("nearest_path" if curve is not None else f"least_{least or 'acceleration'}")
    if out is not None and called in [point.name for point in draft.linkage.points]:
        raise RequestError(f"--name: {linkage} has a point {shown(called)} already; give another name")

    def toml(result: LeastPoint | NearestPath) -> str:
        longer = draft.with_point(called, carrier, result.at.tolist())
        # a name that no file may have is refused here
        _ = longer.linkage
        return longer.toml()

    report: Report[Any] = (least_report if curve is None else nearest_report)(toml, called, formats)
    check_out(report, out, force=force)
    motion = _motion(loaded, 360, input_joint, speed, law)
    search: Callable[..., Any]
    if curve is not None:
        places, inputs = read_curve(curve, motion.linkage, motion.input)
        search = partial(nearest_path_point, motion, carrier, places, sides, inputs=inputs)
    else:
        of, measure = _least(least or "acceleration")
        search = partial(least_point, motion, carrier, sides, of=of, measure=measure)
    with progress_bar(f"searching a point of {loaded.link_name(carrier)} of {loaded.heading}") as progress:
        result = search(circuit=circuit, branch=branch, progress=progress)
    deliver(result, report, out, json=json, force=force)


def inertia(
    linkage: options.Source,
    mass: Annotated[
        list[str], typer.Option(help="A mass in kg at a point of the linkage, as in P=2.5; may be repeated.")
    ],
    gravity: Annotated[
        str | None,
        typer.Option(help="Gravity along x, y, z in m/s^2, as in '0,0,-9.80665'; none by default."),
    ] = None,
    circuit: ChosenCircuit = 0,
    branch: ChosenBranch = 0,
    samples: options.Samples = 360,
    input_joint: options.InputJoint = None,
    speed: options.Speed = None,
    law: options.Law = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for inertia.json, inertia.csv and the figure.")
    ] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Inertia forces of masses at points over the cycle, and the torque that the input needs for them."""
    from sevenbar.design.points import inertia as of_masses
    from sevenbar.design.points.report import inertia_report

    report = inertia_report(options.figure_formats(figures, out))
    check_law(law, speed)
    masses = parsed_masses(mass)
    pull = None if gravity is None else three_numbers("--gravity", gravity, "an acceleration", "0,0,-9.80665")
    loaded = opened(linkage, agree)
    check_out(report, out, force=force)
    motion = _motion(loaded, samples, input_joint, speed, law)
    result = of_masses(motion, masses, gravity=pull, circuit=circuit, branch=branch)
    deliver(result, report, out, json=json, force=force)


def parsed_box(text: str, unit: str) -> list[tuple[float, float]]:
    """The sides [unit] of a box like '-200:200,0:5cm,7'; a length alone is given. Raises `RequestError`."""
    from sevenbar.design.points.cycle import box_of

    ends = [amount_in(end, unit) for side in split_list(text) for end in split_range(side) or (side, side)]
    if len(ends) != 6 or None in ends:
        raise RequestError(
            f"--box: {shown(text)} is no box; give three sides low:high, as in '-200:200,-200:200,0:50'"
        )
    values = [value for value in ends if value is not None]
    low, high = box_of(list(zip(values[::2], values[1::2], strict=True)), name="--box")
    return list(zip(low.tolist(), high.tolist(), strict=True))


def parsed_masses(given: list[str]) -> dict[str, float]:
    """Masses written NAME=KILOGRAMS; `RequestError` for others, and for a point given twice."""
    what, hint = "a mass", "give a point and kilograms, as in P=2.5"
    result = {}
    for name, text in split_named("--mass", given, what, hint).items():
        kilograms = amount(text, {"kg": 1.0}, "kg")
        if kilograms is None:
            raise RequestError(f"--mass: {shown(f'{name}={text}')} is not {what}; {hint}")
        result[name] = kilograms
    return result


def _motion(
    linkage: sb.Linkage, samples: int, input_joint: str | None, speed: str | None, law: Path | None
) -> Motion:
    read = law_of(law, linkage, input_joint)
    return linkage.motion(samples, input=input_joint, speed=speed, law=read)


def _least(least: str) -> tuple[Rate, Literal["greatest", "rms"]]:
    """The rate of a word of --least, and whether its greatest or its mean counts."""
    check_word("--least", least, LEAST)
    return ("acceleration", "rms") if least == "rms" else (cast("Rate", least), "greatest")
