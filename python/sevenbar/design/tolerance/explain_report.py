"""An explanation of measured differences, as a page for people and an object for programs."""

from __future__ import annotations

from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.design.tolerance.explain import Change, Explanation
from sevenbar.design.tolerance.tolerances import CLASSES
from sevenbar.measuring.compare import per_cent
from sevenbar.reporting.page import Facts, number_table
from sevenbar.reporting.report import json_text


def explanation_text(explanation: Explanation) -> RenderableType:
    """The explanation for people: what tolerances it takes, one dimension alone, all together."""
    found, before = explanation.found, explanation.comparison
    facts = Facts()
    names = [dimension.name for dimension in explanation.dimensions]
    unit = found.linkage.length_unit
    facts.add("measured", f"{before.source}, lowest and highest values, beside circuit {before.circuit}")
    facts.add("misfit", f"{per_cent(explanation.misfit)} of the measured ranges, root mean square")
    facts.add("lengths", f"{', '.join(names)}")
    most = explanation.differences[explanation.most]
    widest = max(explanation.differences, key=lambda one: one.worst)
    share = 100 * abs(most.error / most.computed)
    facts.add(
        "it takes",
        f"± {most.worst:.3g} {unit} on each ({100 * most.parts:.2g} % of each) for the {share:.3g} % of "
        f"{most.name} as the worst case, ± {most.statistical:.3g} {unit} as 3 sigma; "
        f"± {widest.worst:.3g} {unit} for all differences",
        style="bold",
    )
    for letter in CLASSES:
        least = min(explanation.differences, key=lambda one: one.classes[letter])
        reach = 100 * least.classes[letter]
        enough = (
            "covers every difference" if reach >= 100 else f"causes {reach:.0f} % of {least.name} at worst"
        )
        facts.add("" if letter != "f" else "plausible?", f"ISO 2768-{letter} {enough}")
    if explanation.without_class:
        facts.add(
            "note",
            f"ISO 2768 has no tolerance for {', '.join(explanation.without_class)}; taken for exact there",
        )
    facts.add(
        "below",
        f"worst, 3 sigma: the equal tolerance [{unit}] on each length that comes to the error; f, m, c, v: "
        "what those classes come to at worst, in per cent of it; change: what leaves the least misfit, of "
        "one length alone, and of all together along 1, 2 .. directions; class: the finest that allows it",
    )
    title = Text(found.linkage.name, style="bold underline")
    return Group(
        title,
        facts.grid,
        Text(),
        _differences_table(explanation),
        Text(),
        _alone_table(explanation),
        Text(),
        _together_table(explanation),
    )


def print_explanation(explanation: Explanation, console: Console | None = None) -> None:
    """Prints the explanation for people."""
    (console or Console()).print(explanation_text(explanation))


def explanation_json(explanation: Explanation) -> str:
    """The explanation as one JSON object."""
    return json_text(
        {
            "format": 1,
            "linkage": explanation.found.linkage.name,
            "measured": explanation.comparison.source,
            "circuit": explanation.comparison.circuit,
            "length_unit": explanation.found.linkage.length_unit,
            "misfit": explanation.misfit,
            "differences": [vars(one) | {"error": one.error} for one in explanation.differences],
            "alone": [vars(one) for one in explanation.alone],
            "together": [vars(one) for one in explanation.together],
            "without_class": list(explanation.without_class),
        }
    )


def _differences_table(explanation: Explanation) -> Table:
    """Each difference with the tolerances that would make it up, and how much of it each class does."""
    heads = ("value", "error", "worst", "3 sigma", *CLASSES)
    rows = (
        (
            one.name,
            f"{100 * one.error / abs(one.computed):+.2f} %"
            if one.computed
            else f"{one.error:+.3g} {one.unit}",
            f"{one.worst:.3g}",
            f"{one.statistical:.3g}",
            *(f"{100 * one.classes[letter]:.0f}" for letter in CLASSES),
        )
        for one in explanation.differences
    )
    return number_table(heads, rows)


def _alone_table(explanation: Explanation) -> Table:
    unit = explanation.found.linkage.length_unit
    nominal = {dimension.name: abs(dimension.value) for dimension in explanation.dimensions}
    most = explanation.differences[explanation.most].name
    rows = []
    for one in explanation.alone:
        ((name, change),) = one.changes.items()
        parts = f"{100 * change / nominal[name]:+.2f} %" if nominal[name] else "-"
        cells = parts, f"{100 * one.misfit:.2f} %", _class(one), _change_text(one.needed)
        rows.append((name, _change_text(change), *cells))
    return number_table((f"one alone [{unit}]", "change", "of it", "misfit", "class", f"for {most}"), rows)


def _together_table(explanation: Explanation) -> Table:
    """All lengths together, by one more direction in each line."""
    names = [dimension.name for dimension in explanation.dimensions]
    rows = (
        (
            str(rank),
            *(_change_text(one.changes.get(name, 0.0)) for name in names),
            f"{100 * one.misfit:.2f} %",
            _class(one),
        )
        for rank, one in enumerate(explanation.together, 1)
    )
    unit = explanation.found.linkage.length_unit
    return number_table((f"together [{unit}]", *names, "misfit", "class"), rows)


def _change_text(value: float) -> str:
    return f"{value:+.2f}" if abs(value) < 10 else f"{value:+.1f}"


def _class(change: Change) -> str:
    return change.iso or "none"
