"""Measured values of a linkage, read from a table: time, input, output angle, velocity, acceleration.

Columns are found by their names and units, or named by the caller; values come out in seconds, radians and
the linkage's length unit, each row with its line in the file. Nothing is guessed: a column whose
unit is not known, a row without a number and times that do not rise are reported.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import RequestError, TableError, shown, suggestion
from sevenbar.text.printing import Printed
from sevenbar.text.ranges import split_name
from sevenbar.text.table import TextTable, name_and_unit, plain_name, read_table, read_text, unit_size
from sevenbar.text.units import MeasuredUnit

#: What the tables hold, as messages say it.
HELD = "measured values"

#: What a table can hold; "angle" is the output's position, a length where it slides.
QUANTITIES = ("time", "input", "angle", "velocity", "acceleration")

#: Those that are compared, in the order of how often they are differentiated by time.
OUTPUTS = ("angle", "velocity", "acceleration")

#: Words of a column's name that identify what it holds, without a word for the joint.
_WORDS = {
    "time": {"time", "t"},
    "input": {"input", "alpha", "drive", "driver"},
    "angle": {"output", "angle", "position", "beta", "theta", "displacement"},
    "velocity": {"velocity", "speed", "omega", "vel"},
    "acceleration": {"acceleration", "acc", "accel"},
}


@dataclass(frozen=True)
class Ends:
    """The joints that a table speaks of: their names, whether each slides, the linkage's length unit."""

    input: str
    output: str
    input_slides: bool = False
    output_slides: bool = False
    length_unit: str = "mm"

    def kind(self, quantity: str) -> tuple[str, int]:
        """The kind of unit that a quantity has, and how often it is differentiated by time."""
        if quantity == "time":
            return "time", 0
        slides = self.input_slides if quantity == "input" else self.output_slides
        return "slide" if slides else "turn", max(OUTPUTS.index(quantity), 0) if quantity in OUTPUTS else 0

    def extent(self, quantity: str, values: Floats) -> float:
        """The range of measured values (n,), of an angle a turn at most; 1 where they are all the same."""
        extent = float(np.ptp(values)) or 1.0
        return min(extent, math.tau) if quantity == "angle" and not self.output_slides else extent

    def turns(self, quantity: str) -> bool:
        """Whether a quantity is that of a joint that turns."""
        return self.kind(quantity)[0] == "turn"

    def word(self, quantity: str) -> str:
        """A quantity of the output by its name."""
        return "position" if quantity == "angle" and self.output_slides else quantity

    def unit(self, quantity: str) -> str:
        """The unit in which a quantity comes out."""
        kind, order = self.kind(quantity)
        base = {"time": "s", "turn": "rad", "slide": self.length_unit}[kind]
        return base + ("", "/s", "/s\u00b2")[order]

    def example(self, quantity: str) -> str:
        """A unit that a table may have for a quantity."""
        kind, order = self.kind(quantity)
        return {"time": "s", "turn": "deg", "slide": "mm"}[kind] + ("", "/s", "/s^2")[order]


class _Values(Printed):
    """What was measured, by quantity."""

    values: Mapping[str, Any]

    @property
    def outputs(self) -> tuple[str, ...]:
        """The quantities of the output that were measured."""
        return tuple(quantity for quantity in OUTPUTS if quantity in self.values)


@dataclass(frozen=True, eq=False, repr=False)
class Measured(_Values):
    """Measured rows: `values` (n,) by quantity, in s, rad (or the length unit) and their derivatives.

    `line` (n,) is the line of the file of each row; `labels` name the column of each quantity.
    """

    source: str
    line: Integers
    values: Mapping[str, Floats]
    labels: Mapping[str, str] = field(default_factory=dict)
    #: Rows that were left out since a cell held no number.
    left_out: int = 0

    def __len__(self) -> int:
        return len(self.line)


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredExtremes(_Values):
    """The lowest and the highest measured value of each quantity, as the paper's Table 1 has them."""

    source: str
    values: Mapping[str, tuple[float, float]]


def read_measured(
    path: str | os.PathLike[str],
    ends: Ends,
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    skip_nan: bool = False,
) -> Measured | MeasuredExtremes:
    r"""The measured values of a file: rows, or a table of extremes with the columns `lowest`, `highest`.

    `columns` names the column of a quantity by its header or its number from 1, `units` its unit; both may
    be left out where the header names it. `skip_nan` leaves out rows in which a used cell holds no number.
    Raises `TableError` with the line and what is wrong there, `RequestError` for a wrong argument.

        >>> import tempfile
        >>> from pathlib import Path
        >>> import sevenbar as sb
        >>> from sevenbar.measuring.compare import ends_of
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     table = Path(folder) / "bench.csv"
        ...     _ = table.write_text("crank [deg],rocker [deg]\n0,0.0\n90,12.5\n")
        ...     measured = read_measured(table, ends_of(sb.load("rssr")))
        >>> len(measured), measured.outputs
        (2, ('angle',))
    """
    columns, units = dict(columns or {}), dict(units or {})
    for name, given in (("column", columns), ("unit", units)):
        for quantity in given:
            if quantity not in QUANTITIES:
                raise RequestError(
                    f"{name}: {shown(quantity)} is not measured here; {suggestion(quantity, QUANTITIES)}"
                    f"allowed: {', '.join(QUANTITIES)}"
                )
    file = Path(path)
    if not columns and (extremes := _read_extremes(file, ends, units)) is not None:
        return extremes
    table = read_table(file, HELD)
    places = _places(table, ends, columns)
    _refuse_what_is_missing(table, ends, places)
    sizes = {}
    for q, place in places.items():
        words = {"what": q, "example": ends.example(q), "asked": units.get(q, ""), "option": "--unit"}
        sizes[q] = table.size(place, ends.kind(q), ends.length_unit, **words)
    raw = {quantity: table.numbers(place) for quantity, place in places.items()}
    if not skip_nan:
        table.refuse_gaps({places[q]: raw[q] for q in places}, "leave such rows out with --skip-nan")
    kept = np.flatnonzero(np.all([np.isfinite(numbers) for numbers in raw.values()], axis=0))
    values = {quantity: numbers[kept] * sizes[quantity] for quantity, numbers in raw.items()}
    if len(kept) < 2:
        rows = "no row" if len(kept) == 0 else "one row"
        raise table.wrong(f"{rows} of measured values; give at least two")
    if "time" in values:
        table.refuse_falling(raw["time"][kept], kept)
    labels = {quantity: table.names[place] or f"column {place + 1}" for quantity, place in places.items()}
    lines = np.array(table.lines, dtype=np.int64)[kept]
    return Measured(table.source, lines, values, labels, len(table.rows) - len(kept))


def pairs(given: Iterable[str], option: str) -> dict[str, str]:
    """`{"angle": "deg"}` of words like "angle=deg"; `RequestError` for another word, or one given twice."""
    result: dict[str, str] = {}
    for word in given:
        name, value = split_name(word) or ("", "")
        quantity = name.lower()
        if quantity not in QUANTITIES:
            example = "angle=deg" if option == "--unit" else "angle=2"
            raise RequestError(
                f"{option}: {shown(word)} is not understood; give one of {', '.join(QUANTITIES)} and its "
                f"{option.removeprefix('--')}, as in {example}"
            )
        if quantity in result:
            raise RequestError(f"{option}: {quantity} is given twice; give it once")
        result[quantity] = value
    return result


def _quantity(name: str, unit: MeasuredUnit | None, ends: Ends) -> str | None:
    """What a column holds, by its name and its unit; `None` where neither identifies it."""
    plain = plain_name(name)
    for quantity, joint in (("input", ends.input), ("angle", ends.output)):
        own = plain_name(joint)
        if plain == own or plain.startswith(own + " "):
            rest = set(plain[len(own) :].split())
            order = next((i for i in (1, 2) if rest & _WORDS[OUTPUTS[i]]), unit.order if unit else 0)
            if quantity == "input":
                return "input" if order == 0 else None
            return OUTPUTS[order] if order < len(OUTPUTS) else None
    result = set(plain.split())
    if plain in _WORDS["time"]:
        return "time"
    if result & _WORDS["input"]:
        return "input" if (unit is None or unit.order == 0) and not result & _WORDS["velocity"] else None
    if unit is not None and unit.order >= len(OUTPUTS):
        return None
    for quantity in ("acceleration", "velocity"):
        if result & _WORDS[quantity]:
            return quantity
    if result & _WORDS["angle"]:
        return OUTPUTS[unit.order] if unit is not None and unit.kind != "time" else "angle"
    return None


def _places(table: TextTable, ends: Ends, columns: Mapping[str, str]) -> dict[str, int]:
    """The column of each quantity, named by the caller or found by its header."""
    places = {quantity: _named(table, quantity, text) for quantity, text in columns.items()}
    taken = set(places.values())
    candidates: dict[str, list[int]] = {}
    for place, name in enumerate(table.names):
        if name and place not in taken:
            quantity = _quantity(table.name_and_unit(place)[0], table.unit(place), ends)
            if quantity is not None and quantity not in places:
                candidates.setdefault(quantity, []).append(place)
    for quantity, result in candidates.items():
        if len(result) > 1:
            names = " and ".join(table.labels[place] for place in result[:2])
            different = len({table.unit(place) for place in result}) > 1
            raise table.wrong(
                f"line {table.header_line}: {'mixed units: ' if different else ''}{names} "
                f"both hold the {quantity}; choose with --column {quantity}=NAME"
            )
    return places | {quantity: result[0] for quantity, result in candidates.items()}


def _named(table: TextTable, quantity: str, text: str) -> int:
    for wanted in (text, text.lower()):
        for place, name in enumerate(table.names):
            if name and wanted in (name, name.lower(), name_and_unit(name)[0]):
                return place
    count = len(table.names)
    if text.isdigit() and 1 <= int(text) <= count:
        return int(text) - 1
    header = f"has {', '.join(table.labels)}" if any(table.names) else "has no header"
    raise table.wrong(
        f"no column {shown(text)} for the {quantity}; the file {header}; "
        f"give one of these or a number from 1 to {count}"
    )


def _refuse_what_is_missing(table: TextTable, ends: Ends, places: Mapping[str, int]) -> None:
    if not any(quantity in places for quantity in OUTPUTS):
        what = f"no column for the angle, velocity or acceleration of the output {shown(ends.output)}"
    elif "time" not in places and "input" not in places:
        what = f"no column for the time or for the input {shown(ends.input)}"
    else:
        return
    quantity = "angle" if "output" in what else "time"
    raise table.wrong(
        f"{what}; {table.header}; name them as in '{quantity} [{ends.example(quantity)}]', "
        f"or say which with --column {quantity}=NAME or its number"
    )


def _read_extremes(path: Path, ends: Ends, units: Mapping[str, str]) -> MeasuredExtremes | None:
    """A table `quantity, lowest, highest`; `None` where the file has no such header."""
    lines = [
        (i, [cell.strip().strip('"') for cell in re.split(r"[,;\t]", line)])
        for i, line in enumerate(read_text(path, HELD).splitlines(), 1)
        if line.strip() and not line.lstrip().startswith(("#", "%"))
    ]
    header = [cell.lower() for cell in lines[0][1]] if lines else []
    if not {"quantity", "lowest", "highest"} <= set(header):
        return None
    values: dict[str, tuple[float, float]] = {}
    for i, cells in lines[1:]:
        where = f"{path}: line {i}"
        if len(cells) < len(header):
            count = f"{len(cells)} cell{'s' * (len(cells) != 1)}"
            raise TableError(f"{where}: {count} where the header has {len(header)}; mend the line")
        row = dict(zip(header, cells, strict=False))
        name, unit = name_and_unit(row["quantity"])
        name = name.lower()
        if name not in OUTPUTS or name in values:
            what = "is there twice" if name in values else "is not measured here"
            raise TableError(f"{where}: {shown(name)} {what}; give each of {', '.join(OUTPUTS)} once")
        unit = unit or row.get("unit", "") or units.get(name, "")
        if not unit:
            raise TableError(f"{where}: {name} has no unit; write '{name} [{ends.example(name)}]'")
        example = ends.example(name)
        size = unit_size(where, unit, ends.kind(name), ends.length_unit, what=name, example=example)
        try:
            low, high = (float(row[end]) * size for end in ("lowest", "highest"))
        except ValueError:
            low = high = math.nan
        if not low <= high:
            raise TableError(f"{where}: lowest and highest are not two rising numbers; mend the line")
        values[name] = (low, high)
    if not values:
        raise TableError(f"{path}: has a header but no row; give a line for each of {', '.join(OUTPUTS)}")
    return MeasuredExtremes(str(path), values)
