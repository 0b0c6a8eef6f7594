"""The command `sevenbar design survey`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, command_line, deliver
from sevenbar.commands.given import angle, angles, numbers
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError
from sevenbar.text.ranges import split_named

if TYPE_CHECKING:
    from sevenbar.design.survey.task import SwingWish, Travel
    from sevenbar.design.wish import Wish

#: An example of a bound, in messages.
EXAMPLE = "as in L1=0.2:1, D=0 or angle=60:120deg"


#: Options of an RSSR; a task file says the same of any loop.
OF_RSSRS = (
    "y", "x", "table", "input_range", "output_range", "swing", "time_ratio", "bounds", "tolerance",
    "transmission", "ball_angle", "motion_type", "ratio", "rank",
)  # fmt: skip


def survey(
    ctx: typer.Context,
    file: Annotated[
        Path | None,
        typer.Argument(metavar="[TASK]", help="A design task (TOML) for any loop, in place of an RSSR."),
    ] = None,
    y: Annotated[str | None, typer.Option(help="The function of x, as in 'x^2'; sind takes degrees.")] = None,
    x: options.FunctionX = "0:1",
    table: options.Pairs = None,
    input_range: Annotated[
        str,
        typer.Option(help="Readings of the input; without --y any one-way motion between the ends will do."),
    ] = "0:90deg",
    output_range: Annotated[str, typer.Option(help="Readings of the output.")] = "0:90deg",
    swing: Annotated[
        str | None, typer.Option(help="In place of readings: the angle through which the rocker swings.")
    ] = None,
    time_ratio: options.TimeRatio = 1.0,
    bounds: Annotated[
        list[str] | None,
        typer.Option(
            "--bound",
            help="Range of a number relative to the others: M, N, L1, L2, L3, D or angle (of the axes), "
            "as in L1=0.2:1 or angle=90deg; may be repeated.",
        ),
    ] = None,
    count: Annotated[
        int | None,
        options.count_option(
            "--count", "How many linkages are drawn, as in 1e8: 1e6 by default, 1e5 of a task."
        ),
    ] = None,
    tolerance: Annotated[str, typer.Option(help="Greatest error of one that does what is wanted.")] = "1deg",
    transmission: options.Transmission = "30deg",
    ball_angle: Annotated[
        str, typer.Option(help="Furthest that a ball may turn from its best seat; 180deg for any.")
    ] = "180deg",
    motion_type: options.MotionType = None,
    ratio: Annotated[
        float, options.number_option("--ratio", "10", "Longest length over shortest link.")
    ] = 20.0,
    rank: Annotated[
        str, typer.Option(help="What the best are best in: error, transmission, ball angle.")
    ] = "error",
    designs: Annotated[int, typer.Option(help="How many designs are shown and written.")] = 10,
    seed: Annotated[int, typer.Option(help="Seed of the sequence.")] = 0,
    out: options.OutDesigns = None,
    journal: Annotated[
        Path | None, typer.Option(help="Folder that keeps every finished part, for surveys of minutes.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the parts that the journal has.")
    ] = False,
    mixed: options.Mixed = False,
    threads: options.Threads = None,
    scheduler: options.Scheduler = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Judge millions of RSSRs, or linkages of a task; the best are polished and checked (extra 'design')."""
    from sevenbar.design.survey import LoopSurvey, SurveyTask, SwingWish, Travel
    from sevenbar.design.survey import survey as carried_out
    from sevenbar.design.survey.report import of_task, survey_report
    from sevenbar.design.task.file.reader import task_file
    from sevenbar.design.task.report import task_report

    options.checked_designs(designs, 100)
    if resume and journal is None:
        raise RequestError("--resume: of no folder; give --journal too, as in '--journal survey'")
    selected = options.kept_in(journal)
    settings: dict[str, Any] = {
        "out": journal, "resume": resume, "mixed": mixed, "threads": threads, "scheduler": scheduler,
    }  # fmt: skip
    if file is not None:
        for name in OF_RSSRS:
            if getattr(ctx.get_parameter_source(name), "name", "") == "COMMANDLINE":
                option = "bound" if name == "bounds" else name.replace("_", "-")
                raise RequestError(f"--{option}: is of an RSSR, and {file} is a task; leave one out")
        read = task_file(file)
        loops = LoopSurvey(read.task, 10**5 if count is None else count, seed)
        of_loops = task_report(read.task, designs, command_line(), ())
        check_out(of_loops, out, force=force)
        with progress_bar(f"surveying linkages of {read.name}", rate=True, kept=selected) as progress:
            result = carried_out(loops, designs_wanted=designs, **settings, progress=progress)
        deliver(
            of_task(result, read.name, read.source),
            of_loops,
            out,
            json=json,
            force=force,
            unfinished=result.unfinished,
        )
        return
    if [y is not None, table is not None, swing is not None].count(True) > 1:
        raise RequestError("--y: a function, a --table or a --swing; give one of the three")
    want: Wish | Travel | SwingWish
    if swing is not None:
        want = SwingWish(angle("--swing", swing), time_ratio)
    elif y is None and table is None:
        ends = angles("--input-range", input_range), angles("--output-range", output_range)
        want = Travel(abs(ends[0][1] - ends[0][0]), ends[1][1] - ends[1][0])
    else:
        want = _readings(y, x, table, input_range, output_range)
    task = SurveyTask(
        want,
        _bounds(bounds or []),
        10**6 if count is None else count,
        seed,
        tolerance=angle("--tolerance", tolerance),
        transmission_lowest=angle("--transmission", transmission),
        ball_angle=angle("--ball-angle", ball_angle),
        motion_type=motion_type,
        ratio=ratio,
        rank=rank,
    )
    report = survey_report(designs, command_line())
    check_out(report, out, force=force)
    with progress_bar(f"surveying RSSRs for {want.title}", rate=True, kept=selected) as progress:
        result = carried_out(task, **settings, progress=progress)
    deliver(result, report, out, json=json, force=force, unfinished=result.unfinished)


def _readings(y: str | None, x: str, table: Path | None, input_range: str, output_range: str) -> Wish:
    """The wish for a function or the pairs of a table."""
    from sevenbar.design.wish import read_pairs, wish_of_function, wish_of_pairs

    if table is not None:
        return wish_of_pairs(*read_pairs(table), title=f"pairs of {table.name}")
    assert y is not None
    options.check_degrees(y, x, numbers("--x", x))
    ends = angles("--input-range", input_range), angles("--output-range", output_range)
    return wish_of_function(y, numbers("--x", x), *ends)


def _bounds(given: list[str]) -> dict[str, tuple[float, float]]:
    """The ranges of --bound: of ratios, and of the angle between the axes [rad]."""
    result: dict[str, tuple[float, float]] = {}
    for name, text in split_named("--bound", given, "a range of a number", f"give one {EXAMPLE}").items():
        both = text if ":" in text or ".." in text else f"{text}:{text}"
        result[name] = angles("--bound", both) if name == "angle" else numbers("--bound", both)
    if "angle" in result and not all(math.isfinite(end) for end in result["angle"]):
        raise RequestError(f"--bound: angle is no angle; give one {EXAMPLE}")
    return result
