"""A survey as people and programs read it: printed, as JSON, as a folder of designs."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

from rich.console import RenderableType

from sevenbar.design.candidates import tally
from sevenbar.design.files import design_files
from sevenbar.design.survey.run import SurveyResult
from sevenbar.design.survey.task import SurveyTask
from sevenbar.design.tables import columns_table, plain_designs
from sevenbar.design.task.report import TaskDesigns
from sevenbar.design.wish import Wish
from sevenbar.kinematics.solvers.batches import NUMBERS
from sevenbar.reporting.files import Report
from sevenbar.reporting.page import Facts, page
from sevenbar.text.words import retold, retold_parts, say

#: Columns of the printed table, by their names in `Candidate.columns`, those that a task has.
PRINTED = {
    "error_greatest_deg": "greatest\nerror\n[deg]",
    "transmission_lowest_deg": "least\ntransm.\n[deg]",
    "ball_crank_deg": "ball at\ncrank\n[deg]",
    "ball_rocker_deg": "ball at\nrocker\n[deg]",
    "motion_type": "motion type",
}

#: Columns of the numbers: ratios, and the angle between the axes.
NUMBER_COLUMNS = {f"{name}_ratio": name for name in NUMBERS[:6]} | {"axes_deg": "axes\n[deg]"}


def survey_report(count: int, command: str) -> Report[SurveyResult]:
    """How a survey is reported with the files of at most `count` designs, whose heads name the `command`."""
    files = design_files(count, (), head=partial(_head, command), as_dict=as_dict)
    return Report(partial(text, count), as_dict, files, spoken=True)


def text(count: int, result: SurveyResult) -> RenderableType:
    """The answer for people, with the first `count` designs."""
    assert isinstance(result.task, SurveyTask)
    facts = Facts()
    facts.add("wanted", retold(result.task.want.title), "bold")
    facts.add("must hold", retold_parts(result.task.text(), "; "))
    ends = {name: _ends(*pair) for name, pair in result.task.table.items()}
    facts.add("drawn", ", ".join(f"{name} {both}" for name, both in ends.items() if name != "angle"))
    facts.add("axes", retold(f"at {_ends(*map(math.degrees, result.task.table['angle']))} deg"))
    if result.unfinished:
        facts.add("unfinished", retold(result.unfinished), "bold yellow")
    for label, words in tally_facts(result):
        facts.add(label, _spoken(words), "bold" if label == "answer" else "")
    facts.add("polished", say("{count} of the best", count=result.polished))
    if result.refusals:
        reasons = tally(result.refusals, None)
        facts.add("of the best", say("{reasons} refused after polishing", reasons=reasons))
    best = result.candidates[:count]
    tables = (columns_table(best, heads) for heads in (PRINTED, NUMBER_COLUMNS)) if best else ()
    return page(say("Survey of RSSRs"), facts, *tables)


def tally_facts(result: SurveyResult) -> list[tuple[str, str]]:
    """How many do it, why the others do not, and what came nearest, by labels."""
    facts = [("answer", result.answer)]
    total = max(result.tally.count, 1)
    refused = sorted(result.tally.refused.items(), key=lambda pair: -pair[1])
    for place, (verdict, number) in enumerate((v, n) for v, n in refused if n):
        facts.append(("" if place else "refused", f"{verdict}: {number} ({100 * number / total:.3g} %)"))
    for place, (verdict, words) in enumerate(result.nearest.items()):
        facts.append(("" if place else "nearest", f"{verdict}: {words}"))
    return facts


def tally_dict(result: SurveyResult) -> dict[str, Any]:
    """The survey and its tally as plain values."""
    return {
        **result.task.request(),
        "judged": result.tally.count,
        "unfinished": result.unfinished or None,
        "answer": result.answer,
        "tally": result.tally.as_dict(),
        "nearest": result.nearest,
    }


def of_task(result: SurveyResult, name: str, source: str) -> TaskDesigns:
    """The designs of a survey of a design task, as that task reports them, with what the survey says."""
    assert result.found is not None
    facts, survey = tally_facts(result), {"survey": tally_dict(result)}
    designs = replace(result.found, unfinished=result.unfinished)
    return TaskDesigns(designs, name, source, result.tally.count, result.task.seed, facts, survey)


def as_dict(result: SurveyResult) -> dict[str, Any]:
    """The answer as plain values: angles in radians but in columns whose names say deg."""
    return {
        **tally_dict(result),
        "polished": result.polished,
        "refused": list(map(vars, result.refusals)),
        "designs": plain_designs(result),
    }


def _spoken(words: str) -> str:
    """A fact of the tally in the language that is spoken: the verdict, then its figures."""
    before, colon, after = words.partition(": ")
    return f"{say(before)}{say(': ')}{retold_parts(after, ': ')}" if colon else retold(words)


def _ends(low: float, high: float) -> str:
    return f"{low:g}" if low == high else f"{low:g}..{high:g}"


def _head(command: str, result: SurveyResult) -> list[str]:
    assert isinstance(result.task, SurveyTask)
    zeros = isinstance(result.task.want, Wish)
    return [
        f"wanted: {result.task.want.title}",
        f"must hold: {result.task.text()}",
        f"made by: {command}",
        "drawn where the readings start"
        + ("; each dial reads zero with its joint at input_zero, output_zero" if zeros else ""),
    ]
