"""Path designs in words, as comments of their files, and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from matplotlib.figure import Figure
from rich.console import RenderableType

from sevenbar.design.candidates import Candidate
from sevenbar.design.files import design_files
from sevenbar.design.synthesis.path.figures import path_figure
from sevenbar.design.synthesis.path.task import PathTask
from sevenbar.design.tables import cell, columns_table, plain_designs, sheets
from sevenbar.design.task.search import DesignsFound
from sevenbar.reporting.files import Report
from sevenbar.reporting.page import Facts, page
from sevenbar.text.words import retold, retold_parts, say

#: Dimensions below this part of the path's extent are printed as 0.
TINY = 1e-9

#: Dimensions in a printed table.
ACROSS = 6


def _facts(task: PathTask, source: str) -> list[tuple[str, str]]:
    """What was wanted, by labels."""
    unit = task.draft.linkage.length_unit
    count = len(task.dimensions)
    names = ", ".join(dimension.name for dimension in task.dimensions)
    size = f"{task.extent:.4g} {unit}"
    want = task.want
    places = {"source": source, "count": len(want.places), "size": size}
    wanted = (
        say("{source}: {count} points of a closed path, {size} across", **places)
        if want.closed
        else say("{source}: {count} points of an open path, {size} across", **places)
    )
    if want.timing is not None:
        wanted = say("{path}, at given inputs", path=wanted)
        wanted = say("{path} from a free start", path=wanted) if want.phase else wanted
    fixed = task.design.placement == "fixed"
    where = say("where the description has it") if fixed else say("anywhere in space")
    return [
        ("wanted", wanted),
        ("point", say("{point} on link {link}", point=task.point.name, link=task.point.link)),
        ("varied", say("{count} dimension{s}: {names}", count=count, s="s" * (count != 1), names=names)),
        *([("held", task.held.text)] if task.held.left_to_the_program else []),
        ("ground", where),
        ("limits", retold_parts(task.design.limits.text(), "; ")),
    ]


def path_report(
    task: PathTask, source: str, seed: int, count: int, command: str, figures: Sequence[str] = ("png",)
) -> Report[DesignsFound]:
    """How at most `count` designs of a task are reported; the heads of their files name the `command`.

    `source` is that of the wanted points, `seed` that of the search.
    """
    as_dict = partial(_as_dict, task, source, seed)
    head, figure = partial(_head, task, source, command), partial(_figure, task)
    files = design_files(count, figures, head=head, figure=figure, as_dict=as_dict)
    return Report(partial(_text, task, source, seed), as_dict, files, spoken=True)


def _figure(task: PathTask, result: DesignsFound, candidate: Candidate) -> Figure:
    return path_figure(task, next(one for one in result.designs if one.candidate is candidate))


def _head(task: PathTask, source: str, command: str, result: DesignsFound) -> list[str]:
    lines = [f"{label}: {text}" for label, text in _facts(task, source)]
    if task.design.placement != "fixed" and "joint" not in task.draft.raw:
        lines.append(
            "placed: turned by turn_x, turn_y, turn_z (axis times angle), then shifted, it makes the path"
        )
    if result.unfinished:
        lines.append(f"unfinished: {result.unfinished}")
    return [*lines, f"made by: {command}"]


def _text(task: PathTask, source: str, seed: int, result: DesignsFound) -> RenderableType:
    """The designs for people."""
    candidates, linkage = result.candidates, task.draft.linkage
    unit = linkage.length_unit
    facts = Facts()
    facts.add_all([*_facts(task, source), ("seed", str(seed))], bold=["wanted"])
    if result.unfinished:
        facts.add("unfinished", retold(result.unfinished), "bold yellow")
    transmits = any(c.transmission_lowest is not None for c in candidates)
    heads = {
        f"error_greatest_{unit}": say("greatest\nerror\n[{unit}]", unit=unit),
        f"error_rms_{unit}": say("RMS\nerror\n[{unit}]", unit=unit),
        **({"transmission_lowest_deg": say("least\ntransm.\n[deg]")} if transmits else {}),
        f"size_{unit}": say("size\n[{unit}]", unit=unit),
        "motion_type": "motion type",
        "circuit": "circuit",
    }
    columns = []
    for d in task.dimensions:
        values = (c.draft.dimension(d.name).value for c in candidates)
        cells = [cell(value, TINY * task.extent) for value in values]
        columns.append((f"{d.name}\n[{d.unit}]" if d.unit else d.name, cells))
    tables = [columns_table(candidates, heads), *sheets(columns, ACROSS)]
    return page(say("Path generation: {linkage}", linkage=linkage.heading), facts, *tables)


def _as_dict(task: PathTask, source: str, seed: int, result: DesignsFound) -> dict[str, Any]:
    """The designs as plain values; what has a unit has it in its name."""
    errors = f"errors_{task.draft.linkage.length_unit}"
    designs = [
        {**own, errors: c.claim.errors.tolist(), "inputs": c.claim.inputs.tolist()}
        for own, c in zip(plain_designs(result), result.candidates, strict=True)
    ]
    return {
        "format": 1,
        **dict(_facts(task, source)),
        "seed": seed,
        "unfinished": result.unfinished or None,
        "designs": designs,
    }
