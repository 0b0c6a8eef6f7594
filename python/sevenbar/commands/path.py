"""The command `sevenbar design path`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, command_line, deliver
from sevenbar.commands.given import limits_of, point_of
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.ranges import split_named, split_range


def path(
    linkage: options.Source,
    wanted: Annotated[Path, typer.Option("--path", help="Table of wanted points in order: x, y, z.")],
    point: options.PointName = None,
    link: options.PointLink = None,
    at: options.PointPlace = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(help="A dimension that may change, or a pattern; may be repeated. All by default."),
    ] = None,
    bound: Annotated[
        list[str] | None,
        typer.Option(help="Bounds of a dimension, as in L1=100:400 or L1=10:40cm; may be repeated."),
    ] = None,
    follow: options.Follow = None,
    place: Annotated[bool, typer.Option("--place", help="The linkage may stand anywhere in space.")] = False,
    timing: Annotated[
        bool, typer.Option("--timing", help="Reach each point at the input that the table has for it.")
    ] = False,
    phase: Annotated[
        bool, typer.Option("--phase", help="With --timing: inputs count from an unknown start.")
    ] = False,
    transmission: Annotated[str, typer.Option(help="Least transmission angle of an RSSR; 0 for none.")] = "0",
    size: Annotated[
        str | None, typer.Option(help="Shortest link and longest dimension, as in 50:1000 or 5cm:1m.")
    ] = None,
    motion_type: options.MotionType = None,
    designs: options.Designs = 5,
    starts: options.Starts = 256,
    seed: options.Seed = 0,
    out: options.OutFigures = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Linkages of a type whose point goes through wanted points in order (extra 'design')."""
    from sevenbar.description.draft import Draft
    from sevenbar.description.files import toml_text
    from sevenbar.design.curve_table import read_curve
    from sevenbar.design.extra import need_scipy
    from sevenbar.design.synthesis.path.generation import check_counts, generated, path_task
    from sevenbar.design.synthesis.path.report import path_report

    need_scipy()
    formats = options.figure_formats(figures, out)
    draft = Draft.of(toml_text(linkage), linkage)
    drive = draft.linkage.drive.joint
    points, inputs = read_curve(wanted, draft.linkage, drive, point=point or "")
    if timing and inputs is None:
        raise RequestError(
            f"--timing: {wanted} has no column for the input '{drive}'; add one, or leave --timing out"
        )
    if phase and not timing:
        raise RequestError("--phase: inputs have no say without --timing; give both, or leave --phase out")
    asked = point_of(point, link, at, draft.linkage)
    if asked is None:
        raise RequestError(
            f"--point: missing; {missing_point(draft.linkage)}, or a place on a link, as in "
            "--link 2 --at 300,40,0"
        )
    task = path_task(
        draft,
        points,
        asked,
        vary=options.words(vary) if vary is not None else None,
        bounds=parsed_bounds(options.words(bound or [])),
        timing=inputs if timing else None,
        phase=phase,
        place=place,
        limits=limits_of(transmission, size, motion_type, draft.linkage.length_unit),
        follow=options.words(follow or []),
    )
    check_counts(designs, starts, seed)
    report = path_report(task, str(wanted), seed, designs, command_line(), formats)
    check_out(report, out, force=force)
    with progress_bar(f"searching paths of {draft.linkage.name}") as progress:
        result = generated(task, count=designs, starts=starts, seed=seed, progress=progress)
    deliver(result, report, out, json=json, force=force, unfinished=result.unfinished)


def missing_point(linkage: Linkage) -> str:
    """Which point to give where none is."""
    names = [point.name for point in linkage.points if point.link in linkage.graph.moving]
    return f"give --point {' or '.join(names)}" if names else "the file names none, so add one to it"


def parsed_bounds(given: list[str]) -> dict[str, tuple[str, str]]:
    """The two ends of each dimension, of words like "L1=100:400" and "L1=10:40cm"."""
    what, hint = "bounds of a dimension", "give the two ends, as in L1=100:400 or L1=10:40cm"
    result = {name: split_range(text) for name, text in split_named("--bound", given, what, hint).items()}
    for name, ends in result.items():
        if ends is None:
            raise RequestError(f"--bound: {name} has no {what}; {hint}")
    return {name: ends for name, ends in result.items() if ends is not None}
