"""A synthesis as people and programs read it: printed, as JSON, as a folder of designs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from matplotlib.figure import Figure
from rich.console import RenderableType

from sevenbar.design.candidates import Candidate, tally
from sevenbar.design.closure import NAMES
from sevenbar.design.files import design_files
from sevenbar.design.synthesis.function.figures import function_figure, swing_figure
from sevenbar.design.synthesis.function.generation import Synthesis
from sevenbar.design.tables import columns_table, plain_designs
from sevenbar.reporting.files import Report
from sevenbar.reporting.page import Facts, page
from sevenbar.text.words import retold, retold_parts, say

#: Columns of the printed table, by their names in `Candidate.columns`, those that a task has not left out.
PRINTED = {
    "error_greatest_deg": "greatest\nerror\n[deg]",
    "error_rms_deg": "RMS\nerror\n[deg]",
    "swing_deg": "swing\n[deg]",
    "time_ratio": "time\nratio",
    "transmission_lowest_deg": "least\ntransm.\n[deg]",
    "motion_type": "motion type",
    "input_zero_deg": "input\nzero\n[deg]",
    "output_zero_deg": "output\nzero\n[deg]",
}

#: What the columns of errors are of no use for: a swing that is met.
OF_SWING = ("error_greatest_deg", "error_rms_deg")


def text(result: Synthesis) -> RenderableType:
    """The designs for people."""
    facts = Facts()
    facts.add("wanted", retold(result.wanted), "bold")
    if result.wish is not None and result.wish.dials is not None:
        facts.add("readings", retold(result.wish.dials.text))
    if result.wish is not None:
        facts.add("", say("crank = input zero + reading, rocker = output zero + reading"))
    facts.add("limits", retold_parts(result.limits.text(), "; "))
    counts = {"searched": result.searched, "refined": result.fitted, "seed": result.seed}
    facts.add("searched", say("{searched} designs, {refined} refined, seed {seed}", **counts))
    if result.unfinished:
        facts.add("unfinished", retold(result.unfinished), "bold yellow")
    if result.refusals:
        facts.add("refused", tally(result.refusals, None))
    unit = result.candidates[0].draft.linkage.length_unit
    wanted = {n: head for n, head in PRINTED.items() if result.wish is not None or n not in OF_SWING}
    dimensions = {f"{name}_{unit}": f"{name} [{unit}]" for name in NAMES}
    tables = (columns_table(result.candidates, heads) for heads in (wanted, dimensions))
    return page(say("Synthesis of an RSSR"), facts, *tables)


def as_dict(result: Synthesis) -> dict[str, Any]:
    """The designs as tables and numbers; readings in radians."""
    dials = None if result.wish is None else result.wish.dials
    return {
        "format": 1,
        "wanted": result.wanted,
        "readings": None if dials is None else vars(dials),
        "limits": result.limits.text(),
        "unfinished": result.unfinished or None,
        "seed": result.seed,
        "searched": result.searched,
        "refined": result.fitted,
        "refused": list(map(vars, result.refusals)),
        "designs": plain_designs(result),
    }


def synthesis_report(count: int, command: str, figures: Sequence[str] = ("png",)) -> Report[Synthesis]:
    """How at most `count` designs are reported; the heads of their files name the `command`."""
    files = design_files(count, figures, head=partial(_head, command), figure=_figure, as_dict=as_dict)
    return Report(text, as_dict, files, spoken=True)


def _head(command: str, result: Synthesis) -> list[str]:
    head = [f"wanted: {result.wanted}", f"limits: {result.limits.text()}", f"made by: {command}"]
    if result.unfinished:
        head.append(f"unfinished: {result.unfinished}")
    if result.wish is not None and result.wish.dials is not None:
        head.append(f"readings: {result.wish.dials.text}")
    if result.wish is not None:
        head += [
            "to use it: fix both dials so that they read 0 with the crank at input_zero and the rocker at",
            "output_zero, the angles below; crank = input_zero + reading, rocker = output_zero + reading",
        ]
    return head


def _figure(result: Synthesis, candidate: Candidate) -> Figure:
    return swing_figure(candidate) if result.wish is None else function_figure(candidate, result.wish)
