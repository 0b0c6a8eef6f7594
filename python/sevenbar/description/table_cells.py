"""The cells of a linkage's table: which column is which, numbers in the table's units, and what is wrong."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from sevenbar.description.table_columns import DIMENSIONS, has_dimensions, is_modified, key_of, slip_of
from sevenbar.errors import DescriptionError, Problem, RequestError, shown
from sevenbar.text.amounts import Kind, value_of
from sevenbar.text.grid import CellTable
from sevenbar.text.table import number
from sevenbar.text.units import ANGLES, LENGTHS, MeasuredUnit, measured_unit


class TableCells:
    """The cells of one table; collects what is wrong in them, and the places of what is read."""

    def __init__(self, grid: CellTable, source: str) -> None:
        self.grid, self.source = grid, source
        self.problems: list[Problem] = []
        self.places: dict[str, str] = {}
        self.columns: dict[str, int] = {}
        self.unread: list[str] = []
        self._units_refused: set[int] = set()
        labels = [grid.label(column) for column in range(len(grid.names))]
        self.dimensions = has_dimensions(labels)
        for column, label in enumerate(labels):
            self._take(column, label)
        self.filled = [row for row in range(len(grid.rows)) if any(self.grid.cell(row, c) for c in self._own)]
        self.length_unit = self._first_unit("slide", LENGTHS) or "mm"
        self.angle_unit = self._first_unit("turn", ANGLES) or "deg"

    def _take(self, column: int, label: str) -> None:
        if not label and not any(row[column] for row in self.grid.rows):
            return
        if is_modified(label):
            self.wrong(
                "is of modified (Craig's) Denavit-Hartenberg rows; give classic ones, "
                "A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha): length and twist of the link after joint i",
                column=column,
            )
            return
        key = label if self.dimensions and label in DIMENSIONS else key_of(label)
        if key in self.columns:
            self.wrong(
                f"is {key}, as is {shown(self.grid.names[self.columns[key]])}; leave one out", column=column
            )
        elif key:
            self.columns[key] = column
        elif near := slip_of(label):
            self.wrong(f"is not known here; did you mean {shown(near)}?", column=column)
        else:
            self.unread.append(self.grid.names[column])

    @property
    def _own(self) -> list[int]:
        """The columns that make a row one of the table."""
        marks = ("joint", "order", "input", "output", "speed", "layout")
        own = [column for key, column in self.columns.items() if key not in marks]
        return own or list(self.columns.values())

    def note_place(self, path: str, row: int, key: str) -> None:
        """Notes that a value of the description at a path comes from the cell of a row in a column."""
        self.places[path] = self.grid.place(row, self.columns[key])

    def wrong(self, message: str, row: int | None = None, column: int | None = None) -> None:
        """Notes a mistake, at a cell, a row or a column."""
        self.problems.append(Problem(self.grid.place(row, column), message))

    def finish(self) -> None:
        """Raises `DescriptionError` if something is wrong."""
        if self.problems:
            raise DescriptionError(self.problems, self.source)

    def _first_unit(self, kind: str, known: Mapping[str, float]) -> str:
        """The first unit of lengths or angles that the columns have."""
        units = [measured_unit(self.unit_of_column(column)) for column in self.columns.values()]
        sizes = [u.size for u in units if u is not None and (u.kind, u.order) == (kind, 0)]
        return next((name for size in sizes[:1] for name, own in known.items() if own == size), "")

    def text(self, row: int, key: str) -> str:
        """The cell of a row in a column; empty where there is no such column."""
        return self.grid.cell(row, self.columns[key]) if key in self.columns else ""

    def amount(self, row: int, key: str, kind: Kind) -> float | None:
        """The number of a cell in the units of the table; `None` for an empty one, and one that is wrong."""
        text = self.text(row, key)
        if not text:
            return None
        column = self.columns[key]
        if column in self._units_refused or not self._has_right_unit(column, kind):
            return None
        unit = measured_unit(self.unit_of_column(column)) if kind != "number" else None
        value = number(text)
        own = {"length": self.length_unit, "angle": self.angle_unit}
        try:
            if value is None:
                value = (
                    value_of(text, kind, length_unit=own["length"], angle_unit=own["angle"])
                    if unit is None
                    else value_of(text, kind, **_in(kind, self.unit_of_column(column), unit))
                    * self._scale(unit)
                )
            elif not math.isfinite(value):
                raise RequestError(f"{shown(text)} is not a finite number; give a finite number")
            elif unit is not None:
                value *= self._scale(unit)
            elif kind == "angle" and value != 0:
                name = self.grid.label(column)
                raise RequestError(
                    f"{text} has no unit; write it in the header, as in '{name} [deg]' or '{name} [rad]'"
                )
        except RequestError as error:
            self.wrong(str(error), row, column)
            return None
        return value

    def unit_of_column(self, column: int) -> str:
        """The unit of a column as written; of a pitch without `/turn`."""
        unit = self.grid.unit(column)
        return re.sub(r"/\s*(turn|rev)$", "", unit) if column == self.columns.get("pitch") else unit

    def _has_right_unit(self, column: int, kind: Kind) -> bool:
        """Whether the unit of a column is one of its kind, or none; else it is reported, once."""
        written = self.unit_of_column(column)
        unit = measured_unit(written)
        wanted = {"length": ("slide", 0), "pitch": ("slide", 0), "angle": ("turn", 0)}.get(kind)
        if not written or (unit is not None and (unit.kind, unit.order) == wanted):
            return True
        what = {"number": "directions", "pitch": "pitches"}.get(kind, f"{kind}s")
        give = {"number": "leave it out", "angle": "give one like deg"}.get(kind, "give one like mm")
        self.wrong(f"{shown(written)} is not a unit of {what}; {give}", column=column)
        self._units_refused.add(column)
        return False

    def _scale(self, unit: MeasuredUnit) -> float:
        if unit.kind == "slide":
            return unit.size_in(self.length_unit)
        own = ANGLES[self.angle_unit]
        return 1.0 if unit.size == own else unit.size / own

    def vector(self, row: int, head: str, kind: Kind, letters: str = "xyz") -> list[float]:
        """The numbers of three cells of a row, 0 where there is no column."""
        keys = [f"{head}{letter}" for letter in letters]
        values = [self.amount(row, key, kind) for key in keys]
        missing = [self.columns[key] for key in keys if key in self.columns and not self.text(row, key)]
        if len(missing) > 1:
            names = ", ".join(shown(self.grid.names[column]) for column in missing)
            self.wrong(f"columns {names} are empty; give numbers, 0 where one is none", row)
        for column in missing if len(missing) == 1 else ():
            written = self.grid.rows[row][column]
            what = f"{shown(written)} is no number" if written else "is empty"
            self.wrong(f"{what}; give a number, 0 where it is none", row, column)
        return [value or 0.0 for value in values]

    def span(self, row: int, head: str) -> str:
        """The place of a vector's cells."""
        columns = [self.columns[f"{head}{letter}"] for letter in "xyz" if f"{head}{letter}" in self.columns]
        names = ", ".join(shown(self.grid.names[column]) for column in columns)
        return f"{self.grid.place(row)}, columns {names}" if columns else self.grid.place(row)


def _in(kind: Kind, written: str, unit: MeasuredUnit) -> dict[str, str]:
    """The unit in which a formula of a column is read."""
    known = ANGLES if kind == "angle" else LENGTHS
    name = next((name for name, size in known.items() if size == unit.size), written)
    key = "angle_unit" if kind == "angle" else "length_unit"
    return {key: name} if kind != "number" and name in known else {}
