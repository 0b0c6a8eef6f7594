"""A table whose cells hold words and numbers: named columns, each cell with its place for messages.

`table` reads rows of numbers; this one reads a list of parts, where a cell may be a name or a kind. It takes
CSV, tabs, semicolons, blanks, decimal commas, UTF-16, sheets of a workbook, and data frames.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from io import StringIO
from typing import Any

from sevenbar.errors import shown
from sevenbar.text.csv_cells import as_written
from sevenbar.text.listed import listed
from sevenbar.text.table import (
    COMMA_NUMBER,
    NAME_AND_UNIT,
    NO_NUMBER,
    has_decimal_commas,
    name_and_unit,
    units_in,
)
from sevenbar.text.workbook import WorkbookSheet, cell_name

#: Whether a line's cells, without their units, may be a header.
IsHeader = Callable[[Sequence[str]], bool]


@dataclass(frozen=True)
class CellTable:
    """Cells of text under a header: `names` and `units` of the columns, `rows` with their lines from 1.

    `title` is a line of one cell above the header. `word` is what a line is called: a row
    of a sheet or of a data frame.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    lines: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]
    title: str = ""
    word: str = "line"
    decimal_comma: bool = False

    def place(self, row: int | None = None, column: int | None = None) -> str:
        """Where a cell, a row or a column is, as messages name it."""
        parts = [] if row is None else [f"{self.word} {self.lines[row]}"]
        parts += [] if column is None else [f"column {shown(self.names[column])}"]
        cell = row is not None and column is not None and self.word == "row"
        return ", ".join(parts) + (f" (cell {cell_name(self.lines[row or 0], column or 0)})" if cell else "")

    def label(self, column: int) -> str:
        """The name of a column without its unit."""
        return name_and_unit(self.names[column])[0]

    def unit(self, column: int) -> str:
        """The unit of a column, in its name or in the line below; empty where it has none."""
        return name_and_unit(self.names[column])[1] or self.units[column]

    def cell(self, row: int, column: int) -> str:
        """A cell; empty for one of the words for none, with a decimal point in a number."""
        text = self.rows[row][column]
        if text.lower() in NO_NUMBER:
            return ""
        return text.replace(",", ".") if self.decimal_comma and COMMA_NUMBER.fullmatch(text) else text


def grid_of_text(text: str, is_header: IsHeader) -> CellTable | None:
    """The table of a text; `None` where no line of it is a header."""
    for delimiter in ("\t", ";", ",", ""):
        cells = list(_cells(text, delimiter))
        result = _grid(cells, is_header, decimal_comma=delimiter != ",")
        if result is not None:
            return result
    return None


def grid_of_sheet(sheet: WorkbookSheet, is_header: IsHeader) -> CellTable | None:
    """The table of a sheet; `None` where no row of it is a header."""
    # a remark has a row to itself: with more cells it is a name that begins as a remark does
    lines = ((line, list(row)) for line, row in enumerate(sheet.rows, 1))
    rows = [(line, cells) for line, cells in lines if any(cells[1:]) or not _is_remark(cells)]
    return _grid(rows, is_header, word="row", remarks=False)


def grid_of_frame(frame: Any) -> CellTable:
    """The table of a data frame, or of a mapping of names to columns of equal length."""
    keys = list(frame.columns if hasattr(frame, "columns") else frame)
    columns = [[_of_python(value) for value in listed(frame[key])] for key in keys]
    rows = list(zip(*columns, strict=True))
    names, none = tuple(map(str, keys)), ("",) * len(keys)
    return CellTable(names, none, tuple(range(1, len(rows) + 1)), tuple(rows), word="data row")


def _of_python(value: object) -> str:
    return "" if value is None or value != value else str(value).strip()


def _cells(text: str, delimiter: str) -> Iterable[tuple[int, list[str]]]:
    """Lines with their cells; remarks and empty lines are left out."""
    if delimiter:
        plain = text.replace("\r\n", "\n").replace("\r", "\n")
        reader = csv.reader(StringIO(plain), delimiter=delimiter, skipinitialspace=True)
        start = 1
        for row in reader:
            # a cell in quotes may go over several lines
            yield start, [as_written(" ".join(cell.split())) for cell in row]
            start = reader.line_num + 1
    else:
        for number, line in enumerate(text.splitlines(), 1):
            yield number, [cell.strip('"') for cell in NAME_AND_UNIT.findall(line)]


def _grid(
    lines: Sequence[tuple[int, list[str]]],
    is_header: IsHeader,
    *,
    word: str = "line",
    decimal_comma: bool = False,
    remarks: bool = True,
) -> CellTable | None:
    selected = [(n, cells) for n, cells in lines if any(cells) and not (remarks and _is_remark(cells))]
    heads = [[name_and_unit(cell)[0] for cell in cells] for _, cells in selected]
    first = next((i for i, head in enumerate(heads) if is_header(head)), None)
    if first is None:
        return None
    above = [[cell for cell in cells if cell] for _, cells in selected[:first]]
    title = next((cells[0] for cells in above if len(cells) == 1), "")
    names = list(selected[first][1])
    while names and not names[-1]:
        names.pop()
    width = len(names)
    body = selected[first + 1 :]
    units = [""] * width
    if body and (below := units_in(body[0][1])) is not None:
        units = (below + units)[:width]
        body = body[1:]
    rows = [tuple((cells + [""] * width)[: max(width, len(cells))]) for _, cells in body]
    comma = decimal_comma and has_decimal_commas(rows)
    lines_of = tuple(number for number, _ in body)
    return CellTable(tuple(names), tuple(units), lines_of, tuple(rows), title, word, comma)


def _is_remark(cells: Sequence[str]) -> bool:
    return bool(cells) and cells[0].startswith(("#", "%"))
