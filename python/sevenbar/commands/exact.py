"""The command `sevenbar design exact`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sevenbar.arrays import whole_number
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, command_line, deliver
from sevenbar.commands.given import angle
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError, shown
from sevenbar.text.ranges import split_list
from sevenbar.text.units import amount, sizes_of

if TYPE_CHECKING:
    from sevenbar.design.exact.table import ExactTask


def exact(
    table: Annotated[
        Path,
        typer.Argument(
            metavar="TABLE",
            help="CSV of pairs of angles (input_deg, output_deg), or of poses of a link: x_mm, y_mm, z_mm "
            "with turn_x_deg, turn_y_deg, turn_z_deg, an axis times its angle; what is left out is 0.",
        ),
    ],
    linkage: Annotated[
        str | None,
        typer.Option(
            help="rssr, planar, spherical, bennett, rccc or cccc; by the columns and how many rows they have."
        ),
    ] = None,
    twist: Annotated[
        str | None, typer.Option(help="Angle between the axes of an RSSR: 7 pairs at most then.")
    ] = None,
    zeros: Annotated[
        str | None,
        typer.Option(help="Angles of crank and rocker where an RSSR's dials read zero, as in 30deg,90deg."),
    ] = None,
    samples: Annotated[
        int | None, typer.Option(help="How many members of a family are drawn, where fewer rows leave one.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of these draws.")] = None,
    moving: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PLACE",
            help="A moving pivot of three poses, in ground coordinates at the first: -1,0 or 5mm,2cm; of "
            "three orientations an axis x,y,z. Give two or more, each with an option of its own; else they "
            "are drawn.",
        ),
    ] = None,
    designs: Annotated[int, typer.Option(help="How many linkages are printed and written, at most.")] = 50,
    out: options.OutDesigns = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """All linkages that take pairs of angles, or poses of a link (extra 'design')."""
    from sevenbar.design.exact.report import exact_report
    from sevenbar.design.exact.table import read_exact_task
    from sevenbar.design.extra import need_scipy

    need_scipy()
    options.checked_designs(designs)
    arguments: dict[str, Any] = {
        "twist": None if twist is None else angle("--twist", twist),
        "zeros": None if zeros is None else _zeros(zeros),
        "samples": samples,
        "seed": None if seed is None else whole_number("--seed", seed, 0, None, "a seed"),
    }
    task = read_exact_task(table)
    arguments["moving"] = [_pivot(text, task) for text in moving] if moving else None
    report = exact_report(task, table.name, designs, command_line())
    check_out(report, out, force=force)
    with progress_bar(f"all answers to {table.name}"):
        result = task.answers(
            linkage, **{name: value for name, value in arguments.items() if value is not None}
        )
    deliver(result, report, out, json=json, force=force)


def _pivot(text: str, task: ExactTask) -> list[float]:
    """A moving pivot in the table's unit, or the direction of a moving axis."""
    count = {"poses in a plane": 2, "orientations": 3}.get(task.what)
    if count is None:
        raise RequestError(f"--moving: is for poses in a plane or orientations; the table has {task.what}")
    unit = task.length_unit if count == 2 else ""
    values = [amount(word, sizes_of(unit), unit) for word in split_list(text)]
    if len(values) != count or None in values:
        what = (
            "a pivot; give x and y, as in -1,0 or 5mm,2cm"
            if count == 2
            else "an axis; give x,y,z, as in 0,0,1"
        )
        raise RequestError(f"--moving: {shown(text)} is not {what}")
    return [value for value in values if value is not None]


def _zeros(text: str) -> tuple[float, float]:
    parts = split_list(text)
    if len(parts) != 2:
        raise RequestError(
            f"--zeros: {shown(text)} is not two angles; give those of crank and rocker, as in 30deg,90deg"
        )
    first, second = (angle("--zeros", part) for part in parts)
    return first, second
