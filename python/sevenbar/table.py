"""A text table of numbers as other programs write it: CSV, MATLAB's and ADAMS's; cells keep their lines.

What is taken: cells parted by commas, semicolons, tabs or blanks; a decimal point, or a decimal comma where
cells are not parted by commas; any lines of text before the first row of numbers, the last of which are the
header and perhaps a line of units; lines that begin with # or % anywhere; no header at all, as MATLAB's
`save -ascii` and `writematrix` leave it. Like ADAMS's own reader it takes a line that does not begin with a
number, before the rows, for text.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sevenbar.errors import MeasurementError, shown
from sevenbar.units import is_unit

#: A measured table of a million rows has some 50 MB; a larger file [bytes] is a mistake of the name.
LARGEST_FILE = 200_000_000

#: A row of a table has some dozen cells; a longer line [characters] is something else.
LONGEST_LINE = 100_000

#: What programs write where there is no number.
NO_NUMBER = frozenset(
    {"", "-", "nan", "+nan", "-nan", "na", "n/a", "#n/a", "null", "none", "inf", "-inf", "+inf"}
)

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
_COMMA_NUMBER = re.compile(r"[-+]?\d+,\d+(?:[eEdD][-+]?\d+)?")
_NAME_AND_UNIT = re.compile(r'"[^"]*"|\S+(?:[ \t]?(?:\[[^\]]*\]|\([^)]*\)))?')


@dataclass(frozen=True)
class Table:
    """Text cells: `names` and `units` of the columns ("" where not given), rows with their lines."""

    source: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    #: Line of the header, counted from 1; 0 where there is none.
    header_line: int
    lines: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]
    decimal_comma: bool

    @property
    def labels(self) -> list[str]:
        """The columns as they are quoted in messages."""
        return [f"'{name}'" if name else str(i) for i, name in enumerate(self.names, 1)]

    def number(self, row: int, column: int) -> float:
        """The number of a cell; NaN where the file holds none. Raises `MeasurementError` for other text."""
        cell = self.rows[row][column]
        value = number(cell, decimal_comma=self.decimal_comma)
        if value is not None:
            return value
        place = f"{self.source}: line {self.lines[row]}, column {self.labels[column]}"
        match = _NUMBER.match(cell)
        if match is not None and is_unit(cell[match.end() :]):
            raise MeasurementError(
                f"{place}: {shown(cell)} carries a unit of its own; write plain numbers, all in the one unit "
                "that the header names"
            )
        raise MeasurementError(f"{place}: {shown(cell)} is not a number; mend the cell or leave the row out")


def number(cell: str, *, decimal_comma: bool = False) -> float | None:
    """The number that a cell holds, NaN for one of the words for none, `None` for other text."""
    if cell.lower() in NO_NUMBER:
        return float("nan")
    text = cell.replace(",", ".") if decimal_comma else cell
    if _NUMBER.fullmatch(text) is None:
        return None
    return float(text.replace("d", "e").replace("D", "e"))


def read_text(path: Path) -> str:
    """The text of a file in UTF-8, UTF-16 with its mark, or Windows-1252."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise MeasurementError(f"{path}: no such file; give the path of a table of measured values") from None
    except IsADirectoryError:
        raise MeasurementError(f"{path}: is a folder; give the path of a table in it") from None
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise MeasurementError(f"{path}: cannot be read: {reason}; give the path of a table") from None
    if len(content) > LARGEST_FILE:
        raise MeasurementError(
            f"{path}: larger than {LARGEST_FILE} bytes; give a table of fewer rows, a thousand are plenty"
        )
    if not content.strip():
        raise MeasurementError(f"{path}: is empty; give a table with a header and rows of numbers")
    wide = content.startswith((b"\xff\xfe", b"\xfe\xff"))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "cp1252"):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        bad = next((c for c in text if c < " " and c not in "\t\n\r\f\x1a"), None)
        if bad is None:
            return text
        break
    raise MeasurementError(
        f"{path}: not a table of text (it holds bytes that no text has); export it as CSV or text"
    )


def read_table(path: Path) -> Table:
    """The table of a file; `MeasurementError` with the line where it is none."""
    source = str(path)
    lines = read_text(path).splitlines()
    for i, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            raise MeasurementError(
                f"{source}: line {i} has {len(line)} characters, so it is no row of a table; export it as CSV"
            )
    first = next((i for i, line in enumerate(lines) if _begins_with_number(line)), None)
    if first is None:
        what = "has text but no row of numbers" if any(line.strip() for line in lines) else "is empty"
        raise MeasurementError(f"{source}: {what}; give a table with a header and rows of numbers")
    delimiter, decimal_comma = _separation(lines[first])
    width = len(_cells(lines[first], delimiter))
    names, units, header_line = _header(lines[:first], delimiter, width)
    rows, numbers = [], []
    for i, line in enumerate(lines[first:], first + 1):
        if not line.strip(" \t\r\f\x1a") or line.lstrip().startswith(("#", "%")):
            continue
        cells = _cells(line, delimiter)
        if len(cells) != width:
            if len(cells) == 1 and not _begins_with_number(line):
                what = f"{shown(line.strip())} is no row of numbers"
            else:
                what = f"{len(cells)} cell{'s' * (len(cells) != 1)} where line {first + 1} has {width}"
            raise MeasurementError(
                f"{source}: line {i}: {what}; the file is cut or damaged there, or holds a second table: "
                "mend it"
            )
        rows.append(tuple(cells))
        numbers.append(i)
    return Table(source, names, units, header_line, tuple(numbers), tuple(rows), decimal_comma)


def _begins_with_number(line: str) -> bool:
    cells = re.split(r"[\t;, ]+", line.strip().strip('"'), maxsplit=1)
    return bool(cells[0]) and (
        _NUMBER.fullmatch(cells[0].strip('"')) is not None or cells[0].lower() == "nan"
    )


def _separation(line: str) -> tuple[str, bool]:
    """What parts the cells of a row of numbers ("" for blanks), and whether decimals have commas."""
    for delimiter in ("\t", ";"):
        if delimiter in line:
            return delimiter, "," in line and "." not in line
    blank = line.split()
    if len(blank) > 1 and all(_COMMA_NUMBER.fullmatch(cell) for cell in blank):
        return "", True
    return ("," if "," in line else ""), False


def _cells(line: str, delimiter: str) -> list[str]:
    if not delimiter:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]


def _header(
    before: Sequence[str], delimiter: str, width: int
) -> tuple[tuple[str, ...], tuple[str, ...], int]:
    """Names and units of the columns, and the line of the names, from the text before the rows."""
    none = ("",) * width
    units = none
    for i in range(len(before), 0, -1):
        line = before[i - 1].strip().lstrip("#%").strip()
        cells = _header_cells(line, delimiter, width)
        if cells is None:
            continue
        bare = [cell.strip("[]() ") for cell in cells]
        if units == none and all(is_unit(cell) or cell in ("", "-") for cell in bare) and any(bare):
            units = tuple("" if cell == "-" else cell for cell in bare)
            continue
        return tuple(cells), units, i
    return none, units, 0


def _header_cells(line: str, delimiter: str, width: int) -> list[str] | None:
    if not line:
        return None
    ways = [[cell.strip('" ') for cell in _NAME_AND_UNIT.findall(line)], re.split(r"\s{2,}|\t", line)]
    if delimiter:
        cells = _cells(line, delimiter)
        # some programs end each row with a delimiter, but not the header
        ways = [cells, [*cells, ""], *ways]
    return next((cells for cells in ways if len(cells) == width), None)
