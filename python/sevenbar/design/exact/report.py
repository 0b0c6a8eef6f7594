"""Exact answers as people and programs read them: printed, as JSON, as a folder of linkages."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from sevenbar.design.exact.answers import ExactAnswers
from sevenbar.design.exact.dyads import Line
from sevenbar.design.exact.given import place_text
from sevenbar.design.exact.table import ExactTask
from sevenbar.design.files import design_files
from sevenbar.design.tables import design_table, plain_designs
from sevenbar.reporting.files import Report
from sevenbar.reporting.page import Facts, number_table, page
from sevenbar.text.listed import named
from sevenbar.text.printing import lines, text_of

#: Closure errors, relative to the size of the linkage, below which nothing is to be seen but rounding.
ROUNDING = 1e-9


def exact_report(task: ExactTask, source: str, count: int, command: str) -> Report[ExactAnswers]:
    """How answers to the task of a table are reported, with files of at most `count` linkages.

    `source` names the table; the heads of the files name the `command`.
    """

    def head(result: ExactAnswers) -> list[str]:
        return [f"answer to: {result.task} of {source}", f"made by: {command}"]

    as_dict = partial(_as_dict, source)
    text = partial(_text, source, task.length_unit, count)
    return Report(text, as_dict, design_files(count, (), head=head, as_dict=as_dict))


def _text(source: str, unit: str, count: int, result: ExactAnswers) -> RenderableType:
    """The answers for people, with the first `count` linkages."""
    facts = Facts()
    facts.add("task", f"{result.task} of {source}", "bold")
    facts.add_all(_answer_facts(result))
    parts: list[RenderableType] = []
    if result.dyads:
        size = max(float(abs(line.at).max()) for dyad in result.dyads for line in (dyad.ground, dyad.body))
        plane = all(_flat(line, size) for dyad in result.dyads for line in (dyad.ground, dyad.body))
        rows = [
            [str(i), dyad.kind, *(_place(line, size, plane) for line in (dyad.ground, dyad.body))]
            for i, dyad in enumerate(result.dyads, 1)
        ]
        heads = ["dyad", "joints", f"at the ground\n[{unit}]", f"at the link in pose 1\n[{unit}]"]
        parts.append(number_table(heads, rows, words=[1, 2, 3]))
    if result.candidates:
        rows = [
            [answer.linkage.name, str(answer.columns["motion_type"]), answer.defect, f"{answer.error:.1e}"]
            for answer in result.candidates[:count]
        ]
        heads = ["linkage", "motion type", "defect", "closure\nerror"]
        parts.append(design_table(heads, rows, words=heads[:3]))
    left = len(result.candidates) - count
    if left > 0:
        parts.append(Text(f"and {left} more; --json lists them all"))
    return page("All answers", facts, *parts)


def _answer_facts(result: ExactAnswers) -> list[tuple[str, str]]:
    """How many answers there are and what they do, by labels."""
    faults = ", ".join(f"{count} by {fault}" for fault, count in result.faults.items())
    unjudged = sum(a.verdict is None for a in result.answers)
    number = "a family" if result.theory is None else f"{result.found} of {result.theory} {result.counted}"
    return [
        ("over the complex numbers", number),
        ("real", f"{result.real}"),
        ("linkages", f"{len(result.answers)}"),
        ("assemblable", f"{len(result.assemblable)}"),
        ("free of defects", f"{len(result.defect_free)}"),
        ("defects", faults or "none"),
        *([("without a verdict", f"{unjudged}: two freedoms")] if unjudged else []),
        ("how", result.how),
    ]


def _as_dict(source: str, result: ExactAnswers) -> dict[str, Any]:
    """The answers as plain values; inputs and outputs at the wanted poses [rad, or length]."""
    return {
        "format": 1,
        "task": result.task,
        "source": source,
        **named(result, "counted", "theory", "found", "real", "how"),
        "dyads": [
            {
                "joints": dyad.kind,
                "ground": dyad.ground.written("ground", np.zeros(3)),
                "link": dyad.body.written("link", np.zeros(3)),
            }
            for dyad in result.dyads
        ],
        "designs": [
            {**own, "inputs": one.claim.inputs.tolist(), "outputs": one.claim.outputs.tolist()}
            for own, one in zip(plain_designs(result), result.candidates, strict=True)
        ],
    }


def _flat(line: Line, size: float) -> bool:
    """Whether a joint moves its link in the plane of x and y."""
    lies = abs(line.axis[2]) <= ROUNDING if line.kind == "P" else abs(line.axis[2]) >= 1 - ROUNDING
    return bool(lies and abs(line.at[2]) <= ROUNDING * size)


def _place(line: Line, size: float, plane: bool) -> str:
    """Where a joint is: "(10, -2.5)" for a turning one in a plane, else with its direction, too."""
    if plane and line.kind == "R":
        return place_text(line.at[:2], size)
    if plane:
        return f"{place_text(line.at[:2], size)} along {place_text(line.axis[:2], 1.0)}"
    return f"{place_text(line.at, size)} along {place_text(line.axis, 1.0)}"


@text_of.register(ExactAnswers)
def _(result: ExactAnswers) -> str:
    return lines(f"Answers to {result.task}", _answer_facts(result))
