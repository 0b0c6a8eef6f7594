"""The commands `sevenbar design function` and `sevenbar design swing`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sevenbar.arrays import whole_number
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, command_line, deliver
from sevenbar.commands.given import angle, angles, limits_of, numbers
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError

if TYPE_CHECKING:
    from sevenbar.design.synthesis.function.generation import Synthesis
    from sevenbar.reporting.files import Report

Size = Annotated[
    str | None, typer.Option(help="Shortest link and longest dimension in mm, as in 50:1000 or 5cm:1m.")
]


def function(
    y: Annotated[
        str | None,
        typer.Option(help="The function of x, as in 'x^2', 'log10(x)' or 'sin(x)'; sind takes degrees."),
    ] = None,
    x: options.FunctionX = "0:1",
    table: options.Pairs = None,
    input_range: Annotated[str, typer.Option(help="Readings of the input over the range of x.")] = "0:90deg",
    output_range: Annotated[
        str, typer.Option(help="Readings of the output from the least y to the greatest.")
    ] = "0:90deg",
    points: Annotated[
        int | None,
        typer.Option(help="Meet the function exactly at 3 to 7 Chebyshev points; else the least error."),
    ] = None,
    tolerance: Annotated[str, typer.Option(help="Greatest error of a design that is given.")] = "2deg",
    transmission: options.Transmission = "30deg",
    size: Size = None,
    motion_type: options.MotionType = None,
    designs: options.Designs = 5,
    seed: options.Seed = 0,
    out: options.OutFigures = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """RSSR linkages whose output follows a function, or pairs of angles (extra 'design')."""
    from sevenbar.design.synthesis.function.generation import function_generation
    from sevenbar.design.wish import read_pairs

    report = _before(out, designs, figures, force)
    if (y is None) == (table is None):
        raise RequestError(
            "--y: give a function, as in --y 'x^2', or pairs of angles by --table; one of the two"
        )
    if table is not None and points is not None:
        raise RequestError("--points: pairs of a table are the points themselves; leave it out")
    x_range = numbers("--x", x)
    if y is not None:
        options.check_degrees(y, x, x_range)
    wanted = f"y = {y}" if table is None else f"pairs of {table.name}"
    with progress_bar(f"searching RSSRs for {wanted}") as progress:
        result = function_generation(
            None if table is None else read_pairs(table),
            function=y,
            x_range=x_range,
            input_range=angles("--input-range", input_range),
            output_range=angles("--output-range", output_range),
            precision=points,
            name=None if table is None else wanted,
            limits=limits_of(transmission, size, motion_type, "mm"),
            tolerance=angle("--tolerance", tolerance),
            count=designs,
            seed=whole_number("--seed", seed, 0, None, "a seed"),
            progress=progress,
        )
        # a search that found nothing says why
        result.required()
    deliver(result, report, out, json=json, force=force, unfinished=result.unfinished)


def swing(
    swing: Annotated[str, typer.Option(help="Angle through which the rocker swings.")],
    time_ratio: options.TimeRatio = 1.0,
    transmission: options.Transmission = "30deg",
    size: Size = None,
    designs: options.Designs = 5,
    seed: options.Seed = 0,
    out: options.OutFigures = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """RSSR crank-rockers with a swing and a time ratio, that transmit best (extra 'design')."""
    from sevenbar.design.synthesis.function.swing import swing_generation

    report = _before(out, designs, figures, force)
    with progress_bar(f"searching crank-rockers with a swing of {swing}") as progress:
        result = swing_generation(
            angle("--swing", swing),
            time_ratio,
            limits=limits_of(transmission, size, None, "mm"),
            count=designs,
            seed=whole_number("--seed", seed, 0, None, "a seed"),
            progress=progress,
        )
        # a search that found nothing says why
        result.required()
    deliver(result, report, out, json=json, force=force, unfinished=result.unfinished)


def _before(out: Path | None, designs: int, figures: list[str] | None, force: bool) -> Report[Synthesis]:
    """How the designs are reported, once the folder was looked at, so that long work is not done in vain."""
    from sevenbar.design.synthesis.function.report import synthesis_report

    formats = options.figure_formats(figures, out)
    options.checked_designs(designs)
    report = synthesis_report(designs, command_line(), formats)
    check_out(report, out, force=force)
    return report
