"""Sheets of an Excel workbook as cells of text (openpyxl, extra `excel`)."""

from __future__ import annotations

import datetime
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

from sevenbar.errors import TableError, of_extra, shown

#: How an .xlsx file begins: it is a zip archive, as the files of LibreOffice and others are.
ZIP = b"PK\x03\x04"
#: How an .xls file begins.
OLD = b"\xd0\xcf\x11\xe0"


@dataclass(frozen=True)
class WorkbookSheet:
    """A sheet that is not empty: its title, and its rows, each as long as it has cells."""

    title: str
    rows: tuple[tuple[str, ...], ...]

    @property
    def width(self) -> int:
        """The number of its columns."""
        return max(map(len, self.rows))

    def text(self) -> str:
        """Its cells with tabs between them, a line for each row."""
        lines = (
            [" ".join(cell.split()) for cell in row] + [""] * (self.width - len(row)) if any(row) else []
            for row in self.rows
        )
        return "".join("\t".join(line) + "\n" for line in lines)


def refuse_old(content: bytes, source: str) -> None:
    """`TableError` for a workbook of Excel 2003 and before."""
    if content.startswith(OLD):
        raise TableError(f"{source}: is a workbook of the old kind (.xls); save it as .xlsx or CSV")


def sheets_of(content: bytes, source: str) -> list[WorkbookSheet]:
    """The sheets of a workbook that are not empty, in its order; `source` is its name in messages.

    Raises `TableError` for another file, and for a formula whose value the file does not hold;
    `MissingExtraError` without openpyxl.
    """
    values = _open(content, source, data_only=True)
    sheets, formulas = [], None
    for sheet in values.worksheets:
        rows, has_empty = _rows(sheet)
        if has_empty:
            formulas = formulas or _open(content, source, data_only=False)
            _refuse_unknown_values(
                rows, _rows(formulas[sheet.title])[0], f"{source}: sheet {shown(sheet.title)}"
            )
        cells = tuple(tuple(map(_text, row)) for row in rows)
        if any(any(row) for row in cells):
            sheets.append(WorkbookSheet(sheet.title, cells))
    if not sheets:
        raise TableError(f"{source}: is empty; give a workbook with a table")
    return sheets


def _open(content: bytes, source: str, *, data_only: bool) -> Any:
    needs = f"{source}: an Excel workbook needs openpyxl"
    with of_extra("excel", needs, ", or export the table as CSV"):
        import openpyxl
    try:
        with warnings.catch_warnings():
            # openpyxl warns of charts and styles, which are not read
            warnings.simplefilter("ignore")
            return openpyxl.load_workbook(BytesIO(content), data_only=data_only)
    except Exception:  # openpyxl lets through whatever zip, XML and missing entries raise
        raise TableError(
            f"{source}: is no Excel workbook that can be read; save it again as .xlsx, or export it as CSV"
        ) from None


def _rows(sheet: Any) -> tuple[list[list[Any]], bool]:
    """The values of all cells, rows without the empty cells at their end, and whether a cell is empty."""
    rows = [list(row) for row in sheet.iter_rows(values_only=True)]
    has_empty = any(cell is None for row in rows for cell in row)
    for row in rows:
        while row and row[-1] is None:
            row.pop()
    while rows and not rows[-1]:
        rows.pop()
    return rows, has_empty


def _refuse_unknown_values(
    rows: Sequence[Sequence[Any]], written: Sequence[Sequence[Any]], where: str
) -> None:
    for i, row in enumerate(written):
        for j, cell in enumerate(row):
            known = i < len(rows) and j < len(rows[i]) and rows[i][j] is not None
            if isinstance(cell, str) and cell.startswith("=") and not known:
                raise TableError(
                    f"{where}, cell {cell_name(i + 1, j)}: {shown(cell)} is a formula whose value the file "
                    "does not hold; open the file in Excel or LibreOffice and save it"
                )


def cell_name(row: int, column: int) -> str:
    """The name of a cell: of a row counted from 1, a column counted from 0.

    >>> cell_name(3, 2), cell_name(1, 26)
    ('C3', 'AA1')
    """
    letters = ""
    column += 1
    while column:
        column, place = divmod(column - 1, 26)
        letters = chr(ord("A") + place) + letters
    return f"{letters}{row}"


def _text(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, datetime.date | datetime.time):
        return value.isoformat()
    return str(value).strip()
