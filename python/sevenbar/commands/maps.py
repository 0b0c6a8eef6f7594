"""The command `sevenbar map`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import opened
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError

if TYPE_CHECKING:
    from sevenbar.design.maps.plane import Take


def map_(
    linkage: options.Source,
    over: Annotated[
        list[str] | None,
        typer.Option(help="A dimension and its range, as in L1=100:400 or L1=10:40cm; give it twice."),
    ] = None,
    measure: Annotated[
        list[str] | None, typer.Option(help="Draw contours of this measure too; may be repeated.")
    ] = None,
    take: Annotated[
        str, typer.Option(help="Which circuit's value is drawn: highest, lowest, or a circuit's index.")
    ] = "highest",
    levels: Annotated[
        str | None, typer.Option(help="Values of the contours, as in '20,40,60'; round ones by default.")
    ] = None,
    grid: Annotated[
        int | None,
        typer.Option(
            help="Lines of the grid along each range; 61 for an RSSR, 25 with measures of forces and else."
        ),
    ] = None,
    input_joint: options.InputJoint = None,
    follow: options.Follow = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for map.json, boundaries.csv, contours.csv and the figures.")
    ] = None,
    figures: options.Figures = None,
    size: Annotated[
        str | None, typer.Option(help="Sheet of the figures: A4 (the default), A3, A2 or A1.")
    ] = None,
    no_key: Annotated[
        bool, typer.Option("--no-key", help="Leave out the key and the numbers at the side.")
    ] = False,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Map motion types over two dimensions, with exact boundaries, and contours of any measure."""
    from sevenbar.design.maps.atlas import motion_map
    from sevenbar.design.maps.figures import sheet
    from sevenbar.design.maps.heights import (
        check_take,
        levels_of,
        measure_heights,
        usual_lines,
        with_contours,
    )
    from sevenbar.design.maps.report import MapFindings, map_report
    from sevenbar.design.maps.window import split_ranges

    formats = options.figure_formats(figures, out)
    sheet(size or "A4")
    ranges = split_ranges(over or [])
    at = None if levels is None else levels_of(levels, "--levels")
    which = cast("Take", int(take) if take.isdecimal() else take)
    check_take(which, "--take")
    names = options.words(measure, "--measure")
    if levels is not None and not names:
        raise RequestError("--levels: of no measure; give --measure too, as in '--measure swing'")
    chosen = with_contours(names) if names else ()
    loaded = opened(linkage, agree)
    report = map_report(names, formats, size=size, side=not no_key)
    check_out(report, out, force=force)
    with progress_bar(f"mapping {loaded.heading}") as progress:
        result = motion_map(
            loaded,
            ranges,
            grid=usual_lines(chosen) if grid is None else grid,
            input=input_joint,
            follow=options.words(follow, "--follow"),
            progress=progress,
        )
        heights = (
            measure_heights(result, chosen, take=which, levels=at, ahead=progress.ahead) if chosen else ()
        )
    deliver(MapFindings(result, heights), report, out, json=json, force=force)
