"""A task in words: what is wanted, what must hold, what may change."""

from __future__ import annotations

from collections.abc import Sequence

from sevenbar.arrays import Floats
from sevenbar.design.task.task import DesignTask
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.columns import shown_in

#: Free numbers that a line names; the others are counted.
MOST_NAMED = 12


def task_facts(task: DesignTask) -> list[tuple[str, str]]:
    """What was asked, by labels."""
    linkage = task.draft.linkage
    facts = []
    for i, want in enumerate(task.wants, 1):
        weight = "" if want.weight == 1 else f", weight {want.weight:g}"
        facts.append(("wanted" if i == 1 else "", f"{i}  {want.words(linkage)}{weight}"))
    for i, must in enumerate(task.musts, 1):
        facts.append(("must hold" if i == 1 else "", f"{i}  {must.words(linkage)}"))
    names = [one.name for one in task.free]
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    count = f"{len(names)} number{'s' * (len(names) != 1)}"
    facts.append(("free", f"{count}: {', '.join(names[:MOST_NAMED])}{more}"))
    ground = {
        "fixed": "where the description has it",
        "free": "anywhere in space",
        "free with scale": "anywhere in space, in any size",
    }
    facts.append(("ground", ground[task.placement]))
    facts.append(("limits", task.limits.text()))
    facts.append(
        ("goal", "the least " + ("squares" if task.goal == "least squares" else "greatest residual"))
    )
    return facts


def ends_in_words(values: Sequence[float] | Floats, linkage: Linkage, column: str) -> str:
    """From the first to the last of some values of a column, or the one that both are."""
    unit, scale = shown_in(linkage, column)
    first, last = (f"{float(value) * scale:.6g}" for value in (values[0], values[-1]))
    return f"{first} to {last} {unit}" if first != last else f"{last} {unit}"
