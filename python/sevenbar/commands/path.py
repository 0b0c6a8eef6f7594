"""The command `sevenbar design path`."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sevenbar.commands.options import (
    Figures,
    Force,
    Source,
    figure_formats,
    place_of,
    progress_bar,
    tell_written,
    words,
)
from sevenbar.errors import RequestError, shown
from sevenbar.reporting.folder import check_targets
from sevenbar.text.ranges import split_name, split_range

if TYPE_CHECKING:
    from sevenbar.design.synthesis.candidates import Candidate
    from sevenbar.design.synthesis.limits import Limits
    from sevenbar.design.synthesis.path.task import PathTask, Where


def path(
    linkage: Source,
    wanted: Annotated[Path, typer.Option("--path", help="Table of wanted points in order: x, y, z.")],
    point: Annotated[str | None, typer.Option(help="A named point of the linkage.")] = None,
    link: Annotated[int | None, typer.Option(help="The link of a point given by --at.")] = None,
    at: Annotated[str | None, typer.Option(help="Where on the link, as in '-100,-90,-80'.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(help="A dimension that may change, or a pattern; may be repeated. All by default."),
    ] = None,
    bound: Annotated[
        list[str] | None,
        typer.Option(help="Bounds of a dimension, as in L1=100:400 or L1=10:40cm; may be repeated."),
    ] = None,
    place: Annotated[bool, typer.Option("--place", help="The linkage may stand anywhere in space.")] = False,
    timing: Annotated[
        bool, typer.Option("--timing", help="Reach each point at the input that the table has for it.")
    ] = False,
    phase: Annotated[
        bool, typer.Option("--phase", help="With --timing: inputs count from an unknown start.")
    ] = False,
    transmission: Annotated[
        str | None, typer.Option(help="Least transmission angle of an RSSR, as in '40deg'.")
    ] = None,
    size: Annotated[
        str | None, typer.Option(help="Shortest link and longest dimension, as in 50:1000 or 5cm:1m.")
    ] = None,
    motion_type: Annotated[str | None, typer.Option(help="Motion type, as in crank-rocker.")] = None,
    designs: Annotated[int, typer.Option(help="How many designs that differ.")] = 5,
    starts: Annotated[int, typer.Option(help="Linkages within the bounds that are tried.")] = 256,
    seed: Annotated[int, typer.Option(help="Seed of the starts.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Folder for design_1.toml, .., summary.csv and a figure of each.")
    ] = None,
    figures: Figures = None,
    force: Force = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the designs as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Linkages of a type whose point goes through wanted points in order (extra 'design')."""
    from sevenbar.description.draft import Draft
    from sevenbar.description.files import text_of
    from sevenbar.design.curve_table import read_curve
    from sevenbar.design.synthesis.function.report import targets
    from sevenbar.design.synthesis.path import report
    from sevenbar.design.synthesis.path.generation import check_counts, generated, path_task

    endings = figure_formats(figures, out)
    draft = Draft.of(text_of(linkage), linkage)
    check_targets([] if out is None else targets(out, designs, endings), force=force)
    drive = draft.linkage.drive.joint
    points, inputs = read_curve(wanted, draft.linkage, drive, point=point or "")
    if timing and inputs is None:
        raise RequestError(
            f"--timing: {wanted} has no column for the input '{drive}'; add one, or leave --timing out"
        )
    if phase and not timing:
        raise RequestError("--phase: inputs have no say without --timing; give both, or leave --phase out")
    task = path_task(
        draft,
        points,
        _where(point, link, at),
        vary=words(vary) if vary is not None else None,
        bounds=dict(_bound(word) for word in words(bound or [])),
        timing=inputs if timing else None,
        phase=phase,
        place=place,
        limits=_limits(transmission, size, motion_type, draft.linkage.length_unit),
    )
    check_counts(designs, starts, seed)
    with progress_bar("designing") as progress:
        found = generated(task, count=designs, starts=starts, seed=seed, progress=progress)
    written = [] if out is None else _written(task, found, (str(wanted), seed), out, endings, force=force)
    if json:
        typer.echo(report.as_json(task, found, str(wanted), seed))
        return
    report.print_text(task, found, str(wanted), seed)
    tell_written(written)


def _written(
    task: PathTask,
    found: tuple[Candidate, ...],
    asked: tuple[str, int],
    out: Path,
    endings: tuple[str, ...],
    *,
    force: bool,
) -> list[Path]:
    from sevenbar.design.synthesis.candidates import write
    from sevenbar.design.synthesis.path.figures import path_figure
    from sevenbar.design.synthesis.path.report import as_json, head
    from sevenbar.drawing import plot

    def also(folder: Path) -> None:
        (folder / "summary.json").write_text(as_json(task, found, *asked) + "\n", encoding="utf-8")
        for i, candidate in enumerate(found, 1):
            figure = path_figure(task, candidate)
            for ending in endings:
                plot.save(figure, folder / f"design_{i}.{ending}")

    command = shlex.join(["sevenbar", *sys.argv[1:]])
    return write(found, out, head(task, asked[0], command), also=also, force=force)


def _where(name: str | None, link: int | None, at: str | None) -> Where:
    """The point that was asked for."""
    if name is not None:
        if link is not None or at is not None:
            raise RequestError("--point: a name or --link with --at, not both; give one of them")
        return name
    if link is None or at is None:
        missing = "--point" if link is None and at is None else "--at" if at is None else "--link"
        raise RequestError(f"{missing}: missing; give --point NAME, or --link with --at")
    return link, place_of(at)


def _bound(word: str) -> tuple[str, tuple[str, str]]:
    """Name and bounds of words like "L1=100:400" and "L1=10:40cm"."""
    parts = split_name(word)
    ends = split_range(parts[1]) if parts else None
    if parts is None or ends is None:
        example = "L1=100:400 or L1=10:40cm"
        raise RequestError(f"--bound: {shown(word)} is not understood; give the two ends, as in {example}")
    return parts[0], ends


def _limits(transmission: str | None, size: str | None, motion_type: str | None, unit: str) -> Limits:
    """What a design must keep; a size without a unit is in the file's."""
    from sevenbar.commands.function import angle, lengths
    from sevenbar.design.synthesis.limits import Limits

    least = 0.0 if transmission is None else angle("--transmission", transmission)
    return Limits(least, None if size is None else lengths("--size", size, unit), motion_type)
