"""Sheets of an Excel workbook as cells of text (openpyxl, extra `excel`)."""

from __future__ import annotations

import datetime
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any
from zipfile import BadZipFile, ZipFile

from sevenbar.errors import TableError, of_extra, shown

#: How an .xlsx file begins: it is a zip archive, as the files of LibreOffice and others are.
ZIP = b"PK\x03\x04"
#: How an .xls file begins.
OLD = b"\xd0\xcf\x11\xe0"

#: Most that a workbook holds unpacked [bytes]: openpyxl reads some 5 MB a second, and tables have below 1 MB.
MOST_UNPACKED = 50_000_000

#: Most rows and columns to the last cell that is not empty, and most cells on the way there: each takes
#: memory.
MOST_ROWS, MOST_COLUMNS, MOST_CELLS = 200_000, 1_000, 5_000_000


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
    _refuse_huge(content, source)
    values = _open(content, source, data_only=True)
    sheets, with_formulas = [], None
    for sheet in values.worksheets:
        place = f"{source}: sheet {shown(sheet.title)}"
        rows, has_empty = _rows(sheet, place)
        if has_empty:
            # the file has no value of a formula that was never computed, so such a cell seems empty
            with_formulas = with_formulas or _open(content, source, data_only=False)
            _refuse_unknown_values(rows, _rows(with_formulas[sheet.title], place)[0], place)
        cells = tuple(tuple(map(_text, row)) for row in rows)
        if any(any(row) for row in cells):
            sheets.append(WorkbookSheet(sheet.title, cells))
    if not sheets:
        raise TableError(f"{source}: is empty; give a workbook with a table")
    return sheets


def _refuse_huge(content: bytes, source: str) -> None:
    """`TableError` for a workbook that is too large unpacked, before any of it is."""
    try:
        with ZipFile(BytesIO(content)) as archive:
            # no more than this is unpacked, whatever the archive holds
            unpacked = sum(entry.file_size for entry in archive.infolist())
    except (BadZipFile, OSError, ValueError, NotImplementedError):
        return  # which openpyxl refuses, too
    if unpacked > MOST_UNPACKED:
        raise TableError(
            f"{source}: holds {unpacked:,} bytes unpacked; a workbook with a table has at most "
            f"{MOST_UNPACKED:,}: leave out other sheets and pictures, or export the table as CSV"
        )


def _open(content: bytes, source: str, *, data_only: bool) -> Any:
    needs = f"{source}: an Excel workbook needs openpyxl"
    with of_extra("excel", needs, ", or export the table as CSV"):
        import openpyxl
    try:
        with warnings.catch_warnings():
            # openpyxl warns of charts and styles, which are not read
            warnings.simplefilter("ignore")
            return openpyxl.load_workbook(BytesIO(content), data_only=data_only, read_only=True)
    except Exception:  # openpyxl lets through whatever zip, XML and missing entries raise
        raise _unreadable(source) from None


def _unreadable(source: str) -> TableError:
    return TableError(
        f"{source}: is no Excel workbook that can be read; save it again as .xlsx, or export it as CSV"
    )


def _rows(sheet: Any, place: str) -> tuple[list[list[Any]], bool]:
    """The values of all cells, rows without the empty cells at their end, and whether a cell is empty.

    `TableError` for a cell far out, and for very many; `place` is the sheet in messages.
    """
    # what the file says of its own size is not to be trusted
    sheet.reset_dimensions()
    rows: list[list[Any]] = []
    # empty rows count once others follow
    skipped, cells, has_empty = 0, 0, False
    for number, row in enumerate(_each_row(sheet, place), 1):
        cells += len(row)
        has_empty = has_empty or None in row
        width = next((k for k in range(len(row), 0, -1) if row[k - 1] is not None), 0)
        if width and (number > MOST_ROWS or width > MOST_COLUMNS):
            raise TableError(
                f"{place} has a value in cell {cell_name(number, width - 1)}; a table has at most "
                f"{MOST_ROWS:,} rows and {MOST_COLUMNS:,} columns: delete what lies beyond it, or export it "
                "as CSV"
            )
        if cells > MOST_CELLS:
            raise TableError(
                f"{place} has more than {MOST_CELLS:,} cells; give a sheet with the table alone, "
                "or export it as CSV"
            )
        if not width:
            skipped += 1
            continue
        rows += ([] for _ in range(skipped))
        rows.append(list(row[:width]))
        skipped = 0
    return rows, has_empty


def _each_row(sheet: Any, place: str) -> Iterator[Sequence[Any]]:
    """The values of each row, as they are read."""
    try:
        yield from sheet.iter_rows(values_only=True)
    except Exception:  # as in `_open`: a sheet is read only now
        raise _unreadable(place) from None


def _refuse_unknown_values(
    rows: Sequence[Sequence[Any]], written: Sequence[Sequence[Any]], place: str
) -> None:
    """`TableError` for a formula among the cells as `written` that has no value in `rows`."""
    for i, row in enumerate(written):
        for j, cell in enumerate(row):
            known = i < len(rows) and j < len(rows[i]) and rows[i][j] is not None
            if isinstance(cell, str) and cell.startswith("=") and not known:
                raise TableError(
                    f"{place}, cell {cell_name(i + 1, j)}: {shown(cell)} is a formula whose value the file "
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
