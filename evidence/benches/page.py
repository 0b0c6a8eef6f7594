"""docs/benchmarks.md from the results: every number on it is one of the JSON's."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from evidence.benches.figures import drawn
from evidence.benches.outcome import Cell, Outcome
from evidence.circumstances import in_words
from evidence.markdown import table

INTRODUCTION = """\
# Sevenbar beside its peers

`make bench` made this page: the same work in the same process, in turns (each round begins with another
one, so that none always follows the same), a median over the rounds for each, and the median of the
ratios within the rounds. `from` and `to` enclose eight of ten rounds. **Trust the ratios;
absolute times are only a guide**; a ratio above 1 is slower than Sevenbar, one below is faster. One thread
unless a table is about threads. Answers are compared before anything is timed; a peer whose answer
disagrees has that written in its row, and no ratio. The numbers lie in
[evidence/benches/results.json](../evidence/benches/results.json), the code in
[evidence/benches/cases](../evidence/benches/cases).
"""


def write(results: dict[str, Any], page: Path) -> None:
    """Writes the page, and its figures into `images` beside it."""
    images = page.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    outcomes = {
        name: Outcome.of_json({key: value for key, value in raw.items() if key != "made"})
        for name, raw in results["cases"].items()
    }
    for outcome in outcomes.values():
        for plot in outcome.plots:
            drawn(plot, images)
    page.write_text(text(results, outcomes), encoding="utf-8")


def text(results: dict[str, Any], outcomes: dict[str, Outcome]) -> str:
    """The whole page."""
    return "\n".join(
        [INTRODUCTION, *_made(results["made"]), *_peers(results["peers"]), *_cases(results, outcomes)]
    )


def _made(made: dict[str, Any]) -> Iterator[str]:
    if made["kind"] == "quick":
        yield "**A quick look only** (`--quick`): fewer rounds and smaller work than the page's own.\n"
    yield f"Made {in_words(made)}.\n"


def _peers(peers: list[dict[str, str]]) -> Iterator[str]:
    yield "## The peers\n"
    rows = [[peer["name"], peer["version"] or "–", _plain(peer["reason"])] for peer in peers]
    yield table(["package", "version", "note"], rows) + "\n"


def _cases(results: dict[str, Any], outcomes: dict[str, Outcome]) -> Iterator[str]:
    for name, outcome in outcomes.items():
        yield f"## {outcome.title}\n"
        yield f"{outcome.about}\n"
        made = results["cases"][name].get("made")
        if made and made != results["made"]["date"]:
            yield f"Measured {made}.\n"
        if outcome.failure:
            yield f"**This comparison did not come to its end**: {_plain(outcome.failure)}\n"
        for kept in outcome.tables:
            yield f"**{kept.title}**\n"
            yield table(kept.columns, [[cell(value) for value in row] for row in kept.rows]) + "\n"
        for plot in outcome.plots:
            yield f"![{plot.title}: {plot.y_label} over {plot.x_label}](images/{plot.name}.svg)\n"


def cell(value: Cell) -> str:
    """A cell: three digits of a number, a dash for none."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return _plain(value)
    if value == 0 or (value == int(value) and abs(value) < 1e6):
        return f"{int(value):,}"
    if abs(value) < 1e-3 or abs(value) >= 1e7:
        return f"{value:.1e}"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{digits}f}"


def _plain(words: str) -> str:
    """Words within a cell: no bars, no line ends, no folders of the machine."""
    home = str(Path.home())
    return " ".join(words.replace("|", "/").replace(home, "~").split())
