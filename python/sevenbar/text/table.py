"""Reads text tables of numbers as CSV writers, MATLAB and ADAMS write them, with each row's line number.

Accepted: cells separated by commas, semicolons, tabs or blanks; a decimal point, or a decimal comma where
commas do not separate cells; any lines of text before the first row of numbers, the last of which are the
header and perhaps a line of units; remarks (lines that begin with # or %) anywhere; no header at all, as
MATLAB's `save -ascii` and `writematrix` write. Like ADAMS's own reader, it treats a line before the rows as
text if it does not begin with a number. `law_file` and `measuring.measured` decide what the columns mean.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from sevenbar.errors import TableError, read_start, shown
from sevenbar.text.csv_cells import NUMBER, as_written
from sevenbar.text.encodings import wide_text
from sevenbar.text.units import MeasuredUnit, is_unit, measured_unit

#: Largest file [bytes]: a table of a million rows has some 50 MB, so a larger one is the wrong file.
LARGEST_FILE = 200_000_000

#: Longest line [characters]: a row has some dozen cells, so a longer line is no row of a table.
LONGEST_LINE = 100_000

#: Longest name of a column that may have a unit behind it [characters]: the search for one in a longer text,
#: as of a damaged line, would take minutes.
LONGEST_NAME = 1_000

#: Most lines of a file: a million take ten seconds and a gigabyte, and a thousand are plenty.
MOST_LINES = 1_000_000

#: What ends a line of text.
LINE_ENDS = "\n\r\f\x1c\x1d\x1e\x85\u2028\u2029"

#: Most lines that a message lists.
MOST_NAMED = 3

#: What programs write for a missing number.
NO_NUMBER = frozenset(
    {"", "-", "nan", "+nan", "-nan", "na", "n/a", "#n/a", "null", "none", "inf", "-inf", "+inf"}
)

#: A line of only these characters counts as empty; spreadsheets leave such lines, and \x1a ends files of DOS.
NOTHING = " \t\r\f\x1a,;"

#: A number with a decimal comma.
COMMA_NUMBER = re.compile(r"[-+]?\d+,\d+(?:[eEdD][-+]?\d+)?")
#: The index of the row before, in Craig's convention; in brackets behind a name it is no unit: `a_(i-1)`.
INDEX_BEFORE = re.compile(r"\s*[ijn]\s*[-\u2212]\s*1\s*", re.IGNORECASE)
#: A name of a header with the unit in brackets behind it, where blanks separate the names; or one in quotes.
NAME_AND_UNIT = re.compile(r'"[^"]*"|\S+(?:[ \t]?(?:\[[^\]]*\]|\([^)]*\)))?')


@dataclass(frozen=True)
class TextTable:
    """A table as text cells: `names` and `units` of the columns ("" where not given), and rows of cells."""

    source: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    #: Line of the header, counted from 1; 0 where there is none.
    header_line: int
    #: Line of each row, counted from 1.
    lines: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]
    decimal_comma: bool

    @property
    def labels(self) -> list[str]:
        """The columns as they are quoted in messages."""
        return [shown(name) if name else str(i) for i, name in enumerate(self.names, 1)]

    @property
    def header(self) -> str:
        """The columns as a message lists them."""
        return f"the columns are {', '.join(self.labels)}" if any(self.names) else "the file has no header"

    def wrong(self, message: str, *, row: int | None = None, column: int | None = None) -> TableError:
        """The error of a mistake in this table: at the line of a row, in a column, or as a whole."""
        line = [] if row is None else [f"line {self.lines[row]}"]
        label = [] if column is None else [f"column {self.labels[column]}"]
        return TableError(": ".join([self.source, *filter(None, [", ".join(line + label)]), message]))

    def name_and_unit(self, column: int) -> tuple[str, str]:
        """Name and unit of a column; header and line of units must agree, else `TableError`."""
        name, unit = name_and_unit(self.names[column])
        below = self.units[column]
        if unit and below and measured_unit(unit) != measured_unit(below):
            raise self.wrong(
                f"mixed units: column {self.labels[column]} has {shown(unit)} in its name and {shown(below)} "
                "in the line of units; keep the right one"
            )
        return name, unit or below

    @property
    def plain_names(self) -> list[str]:
        """The columns' names for comparisons, without units."""
        return [plain_name(self.name_and_unit(column)[0]) for column in range(len(self.names))]

    def column(self, *names: str) -> int | None:
        """The column with the first of these names that the table has; `None` if it has none of them."""
        known = self.plain_names
        return next((known.index(plain_name(name)) for name in names if plain_name(name) in known), None)

    def unit(self, column: int) -> MeasuredUnit | None:
        """The unit of a column; `None` where it has none, or an unknown one."""
        return measured_unit(self.name_and_unit(column)[1])

    def columns_of(self, sort: tuple[str, int]) -> list[int]:
        """The columns whose unit is of a kind and an order of time derivative."""
        units = [self.unit(column) for column in range(len(self.names))]
        return [i for i, unit in enumerate(units) if unit is not None and (unit.kind, unit.order) == sort]

    def size(
        self,
        column: int,
        sort: tuple[str, int],
        length_unit: str,
        *,
        what: str,
        example: str,
        asked: str = "",
        option: str = "",
    ) -> float:
        """The factor from a column's unit to s, rad or `length_unit` (rates: by s, s^2 ..).

        `sort` is the kind and the order of time derivative that the unit must have; `what` and `example` name
        it in messages. `asked` is a unit that an `option` gives instead of the header. Raises `TableError`
        where there is no unit, or one of another sort.
        """
        name, written = self.name_and_unit(column)
        if written and asked and measured_unit(written) != measured_unit(asked):
            raise self.wrong(
                f"mixed units: column {self.labels[column]} is in {shown(written)} by its header and in "
                f"{shown(asked)} by {option}; leave that out or mend the header"
            )
        if not (written or asked):
            give = f", or give {option} {what}={example}" if option else ""
            raise self.wrong(f"has no unit; write it as in '{name or what} [{example}]'{give}", column=column)
        where = f"{self.source}: column {self.labels[column]}"
        return unit_size(where, written or asked, sort, length_unit, what=what, example=example)

    def numbers(self, column: int) -> npt.NDArray[np.float64]:
        """The numbers of a column (rows,), NaN where one is missing; `TableError` for other text."""
        return np.array([self._number(row, column) for row in range(len(self.rows))])

    def sized(
        self, column: int, sort: tuple[str, int], length_unit: str, *, what: str, example: str
    ) -> npt.NDArray[np.float64]:
        """The numbers of a column (rows,) in s, rad or `length_unit`, as `size` has it."""
        return self.numbers(column) * self.size(column, sort, length_unit, what=what, example=example)

    def _number(self, row: int, column: int) -> float:
        cell = self.rows[row][column]
        value = number(cell, decimal_comma=self.decimal_comma)
        if value is not None:
            return value
        match = NUMBER.match(cell)
        if match is not None and is_unit(cell[match.end() :]):
            what = "carries a unit of its own; write plain numbers, all in the one unit that the header names"
        else:
            what = "is not a number; mend the cell or leave the row out"
        raise self.wrong(f"{shown(cell)} {what}", row=row, column=column)

    def refuse_gaps(self, numbers: Mapping[int, npt.NDArray[np.float64]], remedy: str) -> None:
        """`TableError` where a row has no finite number in one of these columns, (rows,) each."""
        good = np.all([np.isfinite(values) for values in numbers.values()], axis=0)
        bad = np.flatnonzero(~good)
        if not bad.size:
            return
        first = int(bad[0])
        column = next(column for column, values in numbers.items() if not np.isfinite(values[first]))
        named = ", ".join(str(self.lines[row]) for row in bad[:MOST_NAMED])
        more = f" and {bad.size - MOST_NAMED} more" if bad.size > MOST_NAMED else ""
        cell, them = shown(self.rows[first][column]), "it" if bad.size == 1 else "them"
        raise self.wrong(
            f"line{'s' * (bad.size > 1)} {named}{more}: no number in column {self.labels[column]} ({cell}); "
            f"mend {them}, or {remedy}"
        )

    def refuse_falling(self, times: npt.NDArray[np.float64], rows: npt.NDArray[np.intp]) -> None:
        """`TableError` where the times (n,) of these rows (n,) do not rise."""
        back = np.flatnonzero(np.diff(times) <= 0)
        if not back.size:
            return
        i = int(back[0])
        before, after = times[i : i + 2]
        again = "again, as" if after == before else f"after {before:g}"
        more = f" (and so {back.size - 1} more times)" if back.size > 1 else ""
        raise self.wrong(
            f"time {after:g} {again} in line {self.lines[rows[i]]}{more}; times must rise: sort the rows, "
            "and keep one run only",
            row=int(rows[i + 1]),
        )


def unit_size(
    where: str, unit: str, sort: tuple[str, int], length_unit: str, *, what: str, example: str
) -> float:
    """The factor from a unit to s, rad or `length_unit`; `TableError` if it is not a unit of this `sort`."""
    result = measured_unit(unit)
    if result is None or (result.kind, result.order) != sort:
        fault = "known here" if result is None else f"of the {what}"
        raise TableError(f"{where}: {shown(unit)} is not a unit {fault}; give one like {example}")
    return result.size_in(length_unit)


def plain_name(name: str) -> str:
    """A column's name for comparisons: lower case, words separated by single blanks.

    >>> plain_name("Rocker_velocity")
    'rocker velocity'
    """
    return " ".join(re.sub(r"[^\w.]+|_", " ", name).lower().split())


def name_and_unit(text: str) -> tuple[str, str]:
    """Name and unit of a header: `theta [deg]`, `theta (deg)`, `rocker_rad_s2`, `time_s`, `angle, deg`.

    >>> name_and_unit("rocker_rad_s2")
    ('rocker', 'rad/s2')
    """
    if len(text) > LONGEST_NAME:
        return text.strip(), ""
    bracket = re.fullmatch(r"(.*?)\s*[\[(]([^\])]*)[\])]\s*", text)
    # Craig's a_(i-1) and a [i-1] have an index there
    if bracket is not None and not INDEX_BEFORE.fullmatch(bracket[2]):
        return bracket[1].strip(), bracket[2].strip()
    comma = re.fullmatch(r"(.+?)\s*[,/]\s*(\S+)", text)
    if comma is not None and is_unit(comma[2]):
        return comma[1].strip(), comma[2]
    words = text.split("_")
    for start in range(1, len(words)):
        unit = "/".join(words[start:])
        if is_unit(unit):
            return "_".join(words[:start]).strip(), unit
    return text.strip(), ""


def units_in(cells: Sequence[str]) -> list[str] | None:
    """The units in a line of them, "" for "-" and for an empty cell; `None` for any other line.

    >>> units_in(["[deg]", "-", "mm"]), units_in(["name", "mm"])
    (['deg', '', 'mm'], None)
    """
    bare = [re.sub(r"[\[\]()]", "", cell).strip() for cell in cells]
    if not any(bare) or not all(not cell or cell == "-" or is_unit(cell) for cell in bare):
        return None
    return ["" if cell == "-" else cell for cell in bare]


def number(cell: str, *, decimal_comma: bool = False) -> float | None:
    """The number in a cell; NaN for one of `NO_NUMBER`, `None` for any other text."""
    if cell.lower() in NO_NUMBER:
        return float("nan")
    text = cell.replace(",", ".") if decimal_comma else cell
    if NUMBER.fullmatch(text) is None:
        return None
    # Fortran writes 1d5
    return float(text.replace("d", "e").replace("D", "e"))


def read_text(path: Path, of: str) -> str:
    """The text of a file in UTF-8, UTF-16 with its byte order mark, or Windows-1252.

    `of` says in messages what the table is of. An Excel workbook gives its first sheet that is not empty,
    with tabs between the cells.
    """
    return text_of_bytes(read_bytes(path, of), str(path))


def read_bytes(path: Path, of: str) -> bytes:
    """The content of a file, as bytes; `TableError` if it is missing, empty or too large for a table.

    `of` is as for `read_text`.
    """
    content = read_start(
        path,
        LARGEST_FILE + 1,
        "a table",
        lambda message: TableError(f"{path}: {message}"),
        lambda: f"give the path of a table of {of}",
    )
    if len(content) > LARGEST_FILE:
        raise TableError(
            f"{path}: larger than {LARGEST_FILE} bytes; give a table of fewer rows, a thousand are plenty"
        )
    if not content.strip():
        raise TableError(f"{path}: is empty; give a table with a header and rows of numbers")
    return content


def text_of_bytes(content: bytes, path: str) -> str:
    """The text of a file's bytes, as `read_text` gives it."""
    from sevenbar.text.workbook import ZIP, refuse_old, sheets_of

    refuse_old(content, path)
    if content.startswith(ZIP):
        return sheets_of(content, path)[0].text()
    wide = wide_text(content)
    for encoding in (wide,) if wide else ("utf-8-sig", "cp1252"):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if any(c < " " and c not in "\t\n\r\f\x1a" for c in text):
            break
        # for its messages alone: too many lines, or too long ones
        _lines(text, path)
        return text
    raise TableError(
        f"{path}: not a table of text (it holds bytes that no text has); export it as CSV or text"
    )


def read_table(path: Path, of: str) -> TextTable:
    """The table in a file; `TableError` with the line where it is not one. `of` is as for `read_text`."""
    source = str(path)
    lines = _lines(read_text(path, of), source)
    first = next((i for i, line in enumerate(lines) if _begins_with_number(line) or _has_gap(line)), None)
    if first is None:
        what = "has text but no row of numbers" if any(line.strip() for line in lines) else "is empty"
        raise TableError(f"{source}: {what}; give a table with a header and rows of numbers")
    delimiter = _delimiter(lines[first])
    width = len(_cells(lines[first], delimiter))
    names, units, header_line = _header(lines[:first], delimiter, width)
    rows, line_numbers = [], []
    for i, line in enumerate(lines[first:], first + 1):
        if not line.strip(NOTHING) or _is_remark(line):
            continue
        cells = _cells(line, delimiter)
        if len(cells) != width:
            if len(cells) == 1 and not _begins_with_number(line):
                what = f"{shown(line.strip())} is no row of numbers"
            else:
                what = f"{len(cells)} cell{'s' * (len(cells) != 1)} where line {first + 1} has {width}"
            raise TableError(
                f"{source}: line {i}: {what}; the file is cut or damaged there, or holds a second table: "
                "mend it"
            )
        rows.append(tuple(cells))
        line_numbers.append(i)
    decimal_comma = delimiter != "," and has_decimal_commas(rows)
    return TextTable(source, names, units, header_line, tuple(line_numbers), tuple(rows), decimal_comma)


def _lines(text: str, source: str) -> list[str]:
    """The lines of a text; `TableError` where there are too many, or one is no row of a table."""
    # counted before there are as many pieces of text
    count = sum(text.count(end) for end in LINE_ENDS) - text.count("\r\n")
    if count > MOST_LINES:
        raise TableError(
            f"{source}: has {count:,} lines; give a table of at most {MOST_LINES:,} rows, "
            "a thousand are plenty"
        )
    lines = text.splitlines()
    for i, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            raise TableError(
                f"{source}: line {i} has {len(line)} characters, so it is no row of a table; export it as CSV"
            )
    return lines


def _is_remark(line: str) -> bool:
    return line.lstrip().startswith(("#", "%"))


def _begins_with_number(line: str) -> bool:
    cells = re.split(r"[\t;, ]+", line.strip().strip('"'), maxsplit=1)
    return bool(cells[0]) and (NUMBER.fullmatch(cells[0].strip('"')) is not None or cells[0].lower() == "nan")


def _has_gap(line: str) -> bool:
    """Whether a line is a row with missing numbers: at least one number, and otherwise only `NO_NUMBER`."""
    words = [cell.strip(' "') for cell in re.split(r"[\t;,]", line)]
    numbers = [word for word in words if NUMBER.fullmatch(word)]
    return bool(numbers) and all(word in numbers or word.lower() in NO_NUMBER for word in words)


def _delimiter(line: str) -> str:
    """The character that separates the cells of a row of numbers; "" for blanks."""
    for delimiter in ("\t", ";"):
        if delimiter in line:
            return delimiter
    blank = line.split()
    if len(blank) > 1 and all(COMMA_NUMBER.fullmatch(cell) for cell in blank):
        return ""
    return "," if "," in line else ""


def has_decimal_commas(rows: Sequence[Sequence[str]]) -> bool:
    """Whether decimals have commas, judged by the first row with decimals, since 0;0 may precede 0,1;0,5."""
    for row in rows:
        point = any("." in cell and NUMBER.fullmatch(cell) for cell in row)
        comma = any(COMMA_NUMBER.fullmatch(cell) for cell in row)
        if point or comma:
            return comma and not point
    return False


def _cells(line: str, delimiter: str) -> list[str]:
    if not delimiter:
        return line.split()
    row = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    return [as_written(cell.strip()) for cell in row]


def _header(
    before: Sequence[str], delimiter: str, width: int
) -> tuple[tuple[str, ...], tuple[str, ...], int]:
    """Names and units of the columns, and the line of the names, from the text before the rows."""
    none = ("",) * width
    units = none
    # a remark is the header only if no plain line is, as in MATLAB's tables
    from_last = reversed(list(enumerate(before, 1)))
    for line_number, text in sorted(from_last, key=lambda numbered: _is_remark(numbered[1])):
        line = text.strip().lstrip("#%").strip()
        cells = _header_cells(line, delimiter, width)
        if cells is None:
            continue
        below = units_in(cells)
        if units == none and below is not None:
            units = tuple(below)
            continue
        return tuple(cells), units, line_number
    return none, units, 0


def _header_cells(line: str, delimiter: str, width: int) -> list[str] | None:
    """The cells of a header, read in the first way that gives as many as there are columns."""
    if not line:
        return None
    # names with units in brackets separated by blanks, or by two blanks or tabs
    readings = [[cell.strip('" ') for cell in NAME_AND_UNIT.findall(line)], re.split(r"\s{2,}|\t", line)]
    if delimiter:
        cells = _cells(line, delimiter)
        # some programs end each row with a delimiter, but not the header
        readings = [cells, [*cells, ""], *readings]
    return next((cells for cells in readings if len(cells) == width), None)
