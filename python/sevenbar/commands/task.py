"""The command `sevenbar design task`: designs of any loop for what a task file asks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
import typer.core

from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, command_line, deliver
from sevenbar.commands.given import agreed
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError


class TaskGroup(typer.core.TyperGroup):
    """The commands of `sevenbar design`; a TOML file in place of a command is a task."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """As usual; `design my_task.toml ..` is `design task my_task.toml ..`."""
        if args and args[0] not in self.commands and args[0].lower().endswith(".toml"):
            args = ["task", *args]
        return super().resolve_command(ctx, args)


def task(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="TASK",
            help="A task file (TOML); [limits] transmission holds for any loop that has the angle.",
        ),
    ],
    designs: options.Designs = 5,
    starts: options.Starts = 256,
    seed: options.Seed = 0,
    pareto: Annotated[
        str | None,
        typer.Option(help="Two wants to trade off, by number or measure, as in 1,2 or 1,peak_torque."),
    ] = None,
    points: Annotated[int, typer.Option(help="With --pareto: how many points of the front.")] = 9,
    agree: options.Agree = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for design_1.toml, .., figures of wants and musts, summary.csv and summary.json."
        ),
    ] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Designs of any loop for what a task file asks (extra 'design')."""
    from sevenbar.design.exact.starts import exact_starts
    from sevenbar.design.extra import need_scipy
    from sevenbar.design.synthesis.path.generation import check_counts
    from sevenbar.design.task.file.reader import task_file
    from sevenbar.design.task.report import TaskDesigns, task_report
    from sevenbar.design.task.search import designed

    need_scipy()
    formats = options.figure_formats(figures, out)
    check_counts(designs, starts, seed)
    read = task_file(file, agree=agreed(agree))
    for hint in read.hints:
        typer.echo(f"{read.source}: {hint}", err=True)
    if pareto is not None:
        from sevenbar.design.task.front import pareto as front_of
        from sevenbar.design.task.front_report import FrontFound, front_report

        pair = options.words([pareto])
        if len(pair) != 2:
            raise RequestError(f"--pareto: '{pareto}' are not two wants; give two, as in 1,2")
        report = front_report(read.task, points, command_line(), formats)
        check_out(report, out, force=force)
        with progress_bar(f"searching a front of {read.name}") as progress:
            front = front_of(read.task, *pair, points=points, starts=starts, seed=seed, progress=progress)
        whole = FrontFound(front.found, read.name, read.source, starts, seed, front=front)
        deliver(whole, report, out, json=json, force=force, unfinished=front.unfinished)
        return
    single = task_report(read.task, designs, command_line(), formats)
    check_out(single, out, force=force)
    given = exact_starts(read.task, starts // 2, seed)
    with progress_bar(f"searching designs of {read.name}") as progress:
        drawn = starts - len(given)
        search = designed(read.task, count=designs, starts=drawn, seed=seed, given=given, progress=progress)
        # a search that found nothing says why
        search.required(starts)
    result = TaskDesigns(search, read.name, read.source, starts, seed)
    deliver(result, single, out, json=json, force=force, unfinished=result.unfinished)
