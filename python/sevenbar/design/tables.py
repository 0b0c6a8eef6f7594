"""Tables with a line for each design, numbered as their files are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.table import Table

from sevenbar.design.files import DesignSet, Writable
from sevenbar.reporting.page import number_table
from sevenbar.text.words import say


def design_table(heads: Sequence[str], rows: Iterable[Sequence[str]], *, words: Sequence[str] = ()) -> Table:
    """A table with a line for each design; `words` are the heads of columns that hold no numbers."""
    numbered = ([str(i), *row] for i, row in enumerate(rows, 1))
    return number_table(["design", *heads], numbered, words=[1 + heads.index(word) for word in words])


def sheets(
    columns: Sequence[tuple[str, Sequence[str]]], across: int, *, words: Sequence[str] = ()
) -> list[Table]:
    """Tables of columns, each a head and a cell of every design, so many of them side by side."""
    result = []
    for begin in range(0, len(columns), across):
        heads, cells = zip(*columns[begin : begin + across], strict=True)
        result.append(design_table(heads, zip(*cells, strict=True), words=[w for w in words if w in heads]))
    return result


def columns_table(designs: Sequence[Writable], heads: Mapping[str, str]) -> Table:
    """The columns of designs that are in `heads`, those that they have, under these heads."""
    rows = [design.columns for design in designs]
    names = [name for name in heads if name in rows[0]]
    words = [heads[name] for name in names if name == "motion_type"]
    return design_table(
        [heads[name] for name in names], [[cell(row[name]) for name in names] for row in rows], words=words
    )


def cell(value: object, tiny: float = 0.0) -> str:
    """A cell: a number, 0 below `tiny`; a word as it is spoken; "-" for none."""
    if value is None:
        return "-"
    if not isinstance(value, float):
        return say(str(value))
    return "0" if abs(value) < tiny else f"{value:.5g}"


def plain_designs(result: DesignSet) -> list[dict[str, Any]]:
    """What is reported of each design, as plain values."""
    return [
        {"design": i, "name": one.draft.linkage.name, **one.columns}
        for i, one in enumerate(result.candidates, 1)
    ]
