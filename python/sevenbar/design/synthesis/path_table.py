"""Wanted points from a table of text: columns x, y, z with their units, perhaps the input's values."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np

from sevenbar.linkage import Linkage
from sevenbar.motion import Floats
from sevenbar.table import Table, read_table
from sevenbar.units import measured_unit

#: What the tables hold, as messages say it.
HELD = "wanted points"


def read_path(
    path: str | os.PathLike[str], linkage: Linkage, *, point: str = "", timed: bool = False
) -> tuple[Floats, Floats | None]:
    """The wanted points (n, 3) in the linkage's length unit, and `timed` the inputs (n,) [rad, or length].

    A header names the columns and their units: `x [mm], y [mm], z [mm]`, `P_x_mm, P_y_mm, P_z_mm` as in
    Sevenbar's own tables (those of `point` where there are several); z may be left out: then it is 0. The
    input's column has the name of its joint, or `input`. Raises `TableError` with the line and what is wrong.
    """
    table = read_table(Path(path), HELD)
    unit = linkage.length_unit
    places = {letter: _place(table, letter, point, unit) for letter in "xyz"}
    numbers: dict[int, Floats] = {}
    columns = []
    for letter, place in places.items():
        if place is None:
            if letter != "z":
                raise table.wrong(
                    f"no column for {letter}; {table.header}; "
                    f"name them as in 'x [{unit}], y [{unit}], z [{unit}]'"
                )
            columns.append(np.zeros(len(table.rows)))
            continue
        numbers[place] = table.numbers(place) * _size(table, place, unit, slides=True)
        columns.append(numbers[place])
    inputs = None
    if timed:
        drive = linkage.drive.joint
        slides = linkage.column_kinds[linkage.columns.index(drive)] == "slide"
        place = _input(table, drive)
        if place is None:
            example = unit if slides else "deg"
            raise table.wrong(
                f"no column for the input '{drive}'; {table.header}; name it as in '{drive} [{example}]', or "
                "leave --timing out"
            )
        inputs = numbers[place] = table.numbers(place) * _size(table, place, unit, slides=slides)
    table.refuse_gaps(numbers, "leave the row out")
    return np.column_stack(columns), inputs


def _plain(name: str) -> str:
    return re.sub(r"[^\w.]+|_", " ", name).lower().strip()


def _place(table: Table, letter: str, point: str, unit: str) -> int | None:
    """The column of a coordinate: of the point where it is named, else the one that is called so."""
    names = [_plain(table.name_and_unit(place)[0]) for place in range(len(table.names))]
    if not any(names) and len(names) >= len("xyz"):
        example = f"x [{unit}], y [{unit}], z [{unit}]"
        raise table.wrong(
            f"has no header, so the unit of its numbers is not known; write '{example}' above them"
        )
    for wanted in (_plain(f"{point} {letter}"), letter):
        if wanted in names:
            return names.index(wanted)
    found = [place for place, name in enumerate(names) if name.endswith(f" {letter}")]
    if len(found) > 1:
        both = " and ".join(table.labels[place] for place in found[:2])
        raise table.wrong(
            f"line {table.header_line}: {both} both hold {letter}; leave one out, "
            "or name the point that is meant"
        )
    return found[0] if found else None


def _input(table: Table, drive: str) -> int | None:
    names = [_plain(table.name_and_unit(place)[0]) for place in range(len(table.names))]
    for wanted in (_plain(drive), "input"):
        for place, name in enumerate(names):
            unit = measured_unit(table.name_and_unit(place)[1])
            if name == wanted and (unit is None or unit.order == 0):
                return place
    return None


def _size(table: Table, place: int, length_unit: str, *, slides: bool) -> float:
    """What one of a column's unit is in the length unit, or in radians."""
    written = table.name_and_unit(place)[1]
    unit = measured_unit(written)
    example = length_unit if slides else "deg"
    if unit is None or unit.order or unit.kind != ("slide" if slides else "turn"):
        what = f"'{written}' is no unit of it" if written else "it has no unit"
        raise table.wrong(f"{what}; write it as in 'name [{example}]'", column=place)
    return unit.size_in(length_unit)
