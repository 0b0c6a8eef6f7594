"""The command `sevenbar sweep`."""

from __future__ import annotations

from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.commands import options
from sevenbar.commands.deliver import deliver
from sevenbar.commands.given import drafted
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError
from sevenbar.reporting.files import Report
from sevenbar.reporting.folder import check_folder_name
from sevenbar.text.words import say

if TYPE_CHECKING:
    from sevenbar.description.held import HeldDimensions
    from sevenbar.sweep.result import Sweep

#: Most linkages of a sweep that leaves no folder: what is made in minutes may be lost.
MOST_WITHOUT_FOLDER = 100_000


def sweep(
    linkage: options.Source,
    over: Annotated[
        list[str] | None,
        typer.Option(
            help="A dimension and its values: L1=200:300:51 (a grid), L3=400,450 (a list), M=60cm..80cm "
            "(to be sampled); may be repeated."
        ),
    ] = None,
    method: Annotated[
        str | None, typer.Option(help="grid, random or sobol; sobol where a span is to be sampled.")
    ] = None,
    count: Annotated[int | None, typer.Option(help="Linkages of a sample.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of a sample; 0 where none is given.")] = None,
    measure: Annotated[
        list[str] | None,
        typer.Option(help="What is measured: motion_type, limits, swing ..; may be repeated."),
    ] = None,
    samples: Annotated[int, typer.Option(help="Inputs in a full turn.")] = 90,
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for sweep.json and the parts, Parquet files.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the parts that the folder has.")
    ] = False,
    mixed: options.Mixed = False,
    threads: options.Threads = None,
    scheduler: options.Scheduler = None,
    part_size: Annotated[int | None, typer.Option(help="Linkages of a part.")] = None,
    follow: options.Follow = None,
    agree: options.Agree = None,
    json: options.Json = False,
) -> None:
    """Measure many linkages: dimensions over grids, lists and samples, into Parquet (extra 'sweep')."""
    from sevenbar.sweep.axes import axis_from_text
    from sevenbar.sweep.parts import is_finished
    from sevenbar.sweep.plan import SweepPlan
    from sevenbar.sweep.run import USUAL, carry_out

    pairs = [axis_from_text(text) for text in over or ()]
    axes = dict(pairs)
    for name, _ in pairs:
        if [other for other, _ in pairs].count(name) > 1:
            raise RequestError(f"over: dimension '{name}' is given twice; leave one out")
    if out is not None:
        check_folder_name(out)
    for option, given in (("--resume", resume), ("--mixed", mixed)):
        if given and out is None:
            raise RequestError(f"{option}: of no folder; give --out too, as in '--out sweep'")
    draft = drafted(linkage, agree)
    plan = SweepPlan.of(
        draft, axes, options.words(measure or list(USUAL), "--measure"), method=method, count=count,
        seed=seed, samples=samples, input=input_joint, output=output, part_size=part_size,
        follow=options.words(follow, "--follow"),
    )  # fmt: skip
    total = plan.space.count
    if out is None and total > MOST_WITHOUT_FOLDER:
        raise RequestError(
            f"out: missing; {total} linkages are too many to be made for a summary alone "
            f"(at most {MOST_WITHOUT_FOLDER}), so give a folder, as in --out sweep"
        )
    finished = out is not None and is_finished(out)
    with progress_bar(f"sweep of {draft.linkage.name}", rate=True, kept=options.kept_in(out)) as progress:
        result = carry_out(
            plan, out=out, resume=resume, mixed=mixed, threads=threads, scheduler=scheduler,
            progress=progress, ahead=progress.ahead,
        )  # fmt: skip
    deliver(result, Report(partial(_text, plan.held), _as_dict, spoken=True), json=json)
    if out is not None and not json:
        parts = result.description["parts"]
        state = "there already" if finished else "written"
        typer.echo(f"\n{state}: {out} (sweep.json, {parts} part{'s' * (parts != 1)})")


def _as_dict(result: Sweep) -> dict[str, Any]:
    return {**result.description, "totals": asdict(result.totals)}


#: The heads of the table of ranges.
RANGE_HEADS = ("measure", "lowest", "linkage", "highest", "linkage", "rows")


def _text(held: HeldDimensions, result: Sweep) -> RenderableType:
    """Counts by words, ranges of numbers, of all linkages."""
    totals = result.totals
    sampling = result.description["sampling"]
    how = say(sampling["method"])
    if sampling["seed"] is not None:
        how = say("{method}, seed {seed}", method=how, seed=sampling["seed"])
    linkages = say("{count} linkage{s}", count=totals.linkages, s="s" * (totals.linkages != 1))
    rows = say("{count} row{s}", count=totals.rows, s="s" * (totals.rows != 1))
    parts: list[RenderableType] = [Text.assemble((linkages, "bold"), f" ({how}){say(', ')}{rows}")]
    if held.text:
        parts.append(Text.assemble((say("held"), "dim"), f"  {held.text}"))
    if totals.invalid:
        parts.append(
            Text(say("no linkage at all: {count} (their rows say why, in status)", count=totals.invalid))
        )
    for name, counts in totals.words.items():
        table = Table("", say("count"), say("share"), box=None, pad_edge=False)
        table.columns[0].header = say(name.replace("_", " "))
        whole = sum(counts.values())
        for column in table.columns[1:]:
            column.justify = "right"
        for word, number in sorted(counts.items(), key=lambda pair: (-pair[1], pair[0])):
            table.add_row(say(word), str(number), f"{100 * number / whole:.3g} %")
        parts += [Text(), table]
    if totals.ranges:
        table = Table(*map(say, RANGE_HEADS), box=None, pad_edge=False)
        for column in table.columns[1:]:
            column.justify = "right"
        for name, extent in totals.ranges.items():
            if extent is None:
                table.add_row(name, "", "", "", "", "0")
                continue
            low, high = (f"{value:.6g}" for value in (extent.lowest, extent.highest))
            table.add_row(name, low, str(extent.lowest_at), high, str(extent.highest_at), str(extent.rows))
        parts += [Text(), table]
    return Group(*parts)
