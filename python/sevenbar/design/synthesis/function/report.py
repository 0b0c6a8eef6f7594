"""A synthesis as people and programs read it: printed, as JSON, as a folder of designs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from matplotlib.figure import Figure
from rich.console import Group, RenderableType
from rich.text import Text

from sevenbar.design.candidates import Candidate, spoken_tally
from sevenbar.design.files import design_files
from sevenbar.design.synthesis.function.figures import function_figure, swing_figure
from sevenbar.design.synthesis.function.generation import Synthesis
from sevenbar.reporting.files import Report
from sevenbar.reporting.page import Facts, number_table
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


def text(found: Synthesis) -> RenderableType:
    """The designs for people."""
    facts = Facts()
    facts.add("wanted", retold(found.wanted), "bold")
    if found.wish is not None and found.wish.dials is not None:
        facts.add("readings", retold(found.wish.dials.text))
    if found.wish is not None:
        facts.add("", say("crank = input zero + reading, rocker = output zero + reading"))
    facts.add("limits", retold_parts(found.limits.text(), "; "))
    facts.add("searched", _searched(found))
    if found.unfinished:
        facts.add("unfinished", retold(found.unfinished), "bold yellow")
    if found.refusals:
        facts.add("refused", spoken_tally(found.refusals))
    rows = [candidate.columns for candidate in found.candidates]
    names = [name for name in PRINTED if name in rows[0] and not (found.wish is None and name in OF_SWING)]
    table = number_table(
        ["design", *(PRINTED[name] for name in names)],
        [[str(i), *(_cell(row[name]) for name in names)] for i, row in enumerate(rows, 1)],
        words=[1 + names.index("motion_type")],
    )
    unit = found.candidates[0].draft.linkage.length_unit
    keys = ("M", "N", "L1", "L2", "L3", "D")
    dimensions = number_table(
        ["design", *(f"{key} [{unit}]" for key in keys)],
        [[str(i), *(_cell(row[f"{key}_{unit}"]) for key in keys)] for i, row in enumerate(rows, 1)],
    )
    parts: list[RenderableType] = [
        Text(say("Synthesis of an RSSR"), style="bold underline"),
        facts.grid,
        Text(),
        table,
        Text(),
        dimensions,
    ]
    return Group(*parts)


def _searched(found: Synthesis) -> str:
    return say(
        "{searched} designs, {refined} refined, seed {seed}",
        searched=found.searched, refined=found.fitted, seed=found.seed,
    )  # fmt: skip


def _cell(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else say(str(value))


def as_dict(found: Synthesis) -> dict[str, Any]:
    """The designs as tables and numbers; readings in radians."""
    dials = None if found.wish is None else found.wish.dials
    return {
        "format": 1,
        "wanted": found.wanted,
        "readings": None if dials is None else vars(dials),
        "limits": found.limits.text(),
        "unfinished": found.unfinished or None,
        "seed": found.seed,
        "searched": found.searched,
        "refined": found.fitted,
        "refused": [{"fault": r.fault, "detail": r.detail} for r in found.refusals],
        "designs": [{"design": i, "name": c.name, **c.columns} for i, c in enumerate(found.candidates, 1)],
    }


def synthesis_report(count: int, command: str, figures: Sequence[str] = ("png",)) -> Report[Synthesis]:
    """How at most `count` designs are reported; the heads of their files name the `command`."""
    files = design_files(count, figures, head=partial(_head, command), figure=_figure, as_dict=as_dict)
    return Report(text, as_dict, files, spoken=True)


def _head(command: str, found: Synthesis) -> list[str]:
    head = [f"wanted: {found.wanted}", f"limits: {found.limits.text()}", f"made by: {command}"]
    if found.unfinished:
        head.append(f"unfinished: {found.unfinished}")
    if found.wish is not None and found.wish.dials is not None:
        head.append(f"readings: {found.wish.dials.text}")
    if found.wish is not None:
        head += [
            "to use it: fix both dials so that they read 0 with the crank at input_zero and the rocker at",
            "output_zero, the angles below; crank = input_zero + reading, rocker = output_zero + reading",
        ]
    return head


def _figure(found: Synthesis, candidate: Candidate) -> Figure:
    return swing_figure(candidate) if found.wish is None else function_figure(candidate, found.wish)
