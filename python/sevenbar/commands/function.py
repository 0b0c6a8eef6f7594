"""The commands `sevenbar design function` and `sevenbar design swing`."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sevenbar.commands.options import Figures, Force, figure_formats, tell_written
from sevenbar.errors import RequestError, shown
from sevenbar.reporting.folder import check_targets
from sevenbar.text.ranges import split_range
from sevenbar.text.units import ANGLES, amount, length_sizes

if TYPE_CHECKING:
    from sevenbar.design.synthesis.function.generation import Synthesis
    from sevenbar.design.synthesis.limits import Limits

Transmission = Annotated[str, typer.Option(help="Least transmission angle; 0 for none.")]
Size = Annotated[
    str | None, typer.Option(help="Shortest link and longest dimension in mm, as in 50:1000 or 5cm:1m.")
]
MotionType = Annotated[
    str | None,
    typer.Option(help="crank-rocker, double-crank, rocker-crank or double-rocker; any by default."),
]
Designs = Annotated[int, typer.Option(help="How many designs, at most.")]
Seed = Annotated[int, typer.Option(help="Seed of the search.")]
Out = Annotated[
    Path | None, typer.Option(help="Folder for design_1.toml, .. with figures, summary.csv and summary.json.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the designs as one JSON object and nothing else.")]


def function(
    y: Annotated[str | None, typer.Option(help="The function of x, as in 'x^2' or 'log10(x)'.")] = None,
    x: Annotated[str, typer.Option(help="Range of x.")] = "0:1",
    table: Annotated[
        Path | None, typer.Option(help="CSV of pairs of angles in place of a function: input_deg,output_deg.")
    ] = None,
    input_range: Annotated[str, typer.Option(help="Readings of the input over the range of x.")] = "0:90deg",
    output_range: Annotated[
        str, typer.Option(help="Readings of the output from the least y to the greatest.")
    ] = "0:90deg",
    points: Annotated[
        int | None,
        typer.Option(help="Meet the function exactly at 3 to 7 Chebyshev points; else the least error."),
    ] = None,
    tolerance: Annotated[str, typer.Option(help="Greatest error of a design that is given.")] = "2deg",
    transmission: Transmission = "30deg",
    size: Size = None,
    motion_type: MotionType = None,
    designs: Designs = 5,
    seed: Seed = 0,
    out: Out = None,
    figures: Figures = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """RSSR linkages whose output follows a function, or pairs of angles (extra 'design')."""
    from sevenbar.design.synthesis.function.generation import function_generation
    from sevenbar.design.synthesis.function.wish import read_pairs

    endings = _before(out, designs, figures, force)
    if (y is None) == (table is None):
        raise RequestError(
            "--y: give a function, as in --y 'x^2', or pairs of angles by --table; one of the two"
        )
    if table is not None and points is not None:
        raise RequestError("--points: pairs of a table are the points themselves; leave it out")
    found = function_generation(
        None if table is None else read_pairs(table),
        function=y,
        x_range=numbers("--x", x),
        input_range=angles("--input-range", input_range),
        output_range=angles("--output-range", output_range),
        precision=points,
        name=None if table is None else f"pairs of {table.name}",
        limits=_limits(transmission, size, motion_type),
        tolerance=angle("--tolerance", tolerance),
        count=designs,
        seed=seed_of(seed),
    )
    _after(found, out, endings, force=force, json=json)


def swing(
    swing: Annotated[str, typer.Option(help="Angle through which the rocker swings.")],
    time_ratio: Annotated[
        float, typer.Option(help="Time of the slower stroke over the quicker, >= 1.")
    ] = 1.0,
    transmission: Transmission = "30deg",
    size: Size = None,
    designs: Designs = 5,
    seed: Seed = 0,
    out: Out = None,
    figures: Figures = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """RSSR crank-rockers with a swing and a time ratio, that transmit best (extra 'design')."""
    from sevenbar.design.synthesis.function.swing import swing_generation

    endings = _before(out, designs, figures, force)
    found = swing_generation(
        angle("--swing", swing),
        time_ratio,
        limits=_limits(transmission, size, None),
        count=designs,
        seed=seed_of(seed),
    )
    _after(found, out, endings, force=force, json=json)


#: Most designs that one command gives.
MOST_DESIGNS = 50


def _before(out: Path | None, designs: int, figures: list[str] | None, force: bool) -> tuple[str, ...]:
    """Formats of figures, once the folder was looked at, so that long work is not done in vain."""
    from sevenbar.design.synthesis.function.report import targets

    endings = figure_formats(figures, out)
    if not 1 <= designs <= MOST_DESIGNS:
        raise RequestError(f"--designs: {designs} designs are not offered; give 1 to {MOST_DESIGNS}")
    check_targets([] if out is None else targets(out, designs, endings), force=force)
    return endings


def _after(found: Synthesis, out: Path | None, endings: tuple[str, ...], *, force: bool, json: bool) -> None:
    """Writes and prints what was found; `RequestError` where that is nothing."""
    from sevenbar.design.synthesis.function import report

    found.required()
    command = shlex.join(["sevenbar", *sys.argv[1:]])
    written = [] if out is None else report.write_synthesis(found, out, command, endings, force=force)
    if json:
        typer.echo(report.as_json(found))
        return
    report.print_synthesis(found)
    tell_written(written)


def _limits(transmission: str, size: str | None, motion_type: str | None) -> Limits:
    from sevenbar.design.synthesis.limits import Limits

    ends = None if size is None else lengths("--size", size, "mm")
    return Limits(angle("--transmission", transmission), ends, motion_type)


def seed_of(seed: int) -> int:
    """A seed >= 0, or `RequestError`."""
    if seed < 0:
        raise RequestError(f"--seed: {seed} is no seed; give a number >= 0")
    return seed


def angle(option: str, text: str) -> float:
    """The angle [rad] of a text; a plain number is in degrees."""
    value = amount(text, ANGLES, "deg")
    if value is None:
        raise RequestError(f"{option}: {shown(text)} is not an angle; give one as in 30, 30deg or 0.5rad")
    return value


def angles(option: str, text: str) -> tuple[float, float]:
    """The two angles [rad] of a range like 0:90deg, whose unit may stand at the end only."""
    return _pair(option, text, ANGLES, "deg", "0:90deg or 30deg:-60deg")


def lengths(option: str, text: str, unit: str) -> tuple[float, float]:
    """The two lengths [unit] of a range like 50:1000 or 5cm:1m, whose unit may stand at the end only."""
    return _pair(option, text, length_sizes(unit), unit, "50:1000 or 5cm:1m")


def numbers(option: str, text: str) -> tuple[float, float]:
    """The two numbers of a range like 0:1."""
    return _pair(option, text, {"": 1.0}, "", "0:1 or 1:10")


def _pair(option: str, text: str, sizes: dict[str, float], plain: str, example: str) -> tuple[float, float]:
    if ends := split_range(text):
        low, high = (amount(end, sizes, plain) for end in ends)
        if low is not None and high is not None:
            return low, high
    raise RequestError(f"{option}: {shown(text)} is not a range; give two values, as in {example}")
