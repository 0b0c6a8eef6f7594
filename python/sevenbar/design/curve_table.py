"""A wanted curve from a table of text: columns x, y, z with their units, perhaps the input at each place."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.table import TextTable, plain_name, read_table


def read_curve(
    path: str | os.PathLike[str], linkage: Loop, input_joint: str, *, point: str = ""
) -> tuple[Floats, Floats | None]:
    """The places (n, 3) [length] of a table in the report frame, and its inputs (n,) [rad, or length].

    A header names the columns and their units: `x [mm], y [mm], z [mm]`, or `P_x_mm, P_y_mm, P_z_mm` as in
    Sevenbar's own tables (those of `point` where there are several); z may be left out: then it is 0. The
    input's column has the name of its joint, or `input`; the inputs are `None` where there is none.

    Raises `TableError` with the line and what is wrong.
    """
    table = read_table(Path(path), "a wanted curve")
    unit = linkage.length_unit
    numbers: dict[int, Floats] = {}
    columns = []
    for letter in "xyz":
        place = _place(table, letter, point, unit)
        if place is not None:
            numbers[place] = table.sized(place, ("slide", 0), unit, what=letter, example=unit)
            columns.append(numbers[place])
        elif letter == "z":
            columns.append(np.zeros(len(table.rows)))
        else:
            raise table.wrong(
                f"no column for {letter}; {table.header}; "
                f"name them as in 'x [{unit}], y [{unit}], z [{unit}]'"
            )
    inputs = None
    place = _input(table, input_joint)
    if place is not None:
        kind = linkage.column_kinds[linkage.columns.index(input_joint)]
        example = "deg" if linkage.turns(input_joint) else unit
        inputs = numbers[place] = table.sized(place, (kind, 0), unit, what="input", example=example)
    table.refuse_gaps(numbers, "leave the row out")
    return np.column_stack(columns), inputs


def _place(table: TextTable, letter: str, point: str, unit: str) -> int | None:
    """The column of a coordinate: of the point where it is named, else the one that is called so."""
    names = table.plain_names
    if not any(names) and len(names) >= len("xyz"):
        example = f"x [{unit}], y [{unit}], z [{unit}]"
        raise table.wrong(
            f"has no header, so the unit of its numbers is not known; write '{example}' above them"
        )
    place = table.column(f"{point} {letter}", letter)
    if place is not None:
        return place
    # turn_x and the like are of a rotation
    found = [
        place
        for place, name in enumerate(names)
        if name.endswith(f" {letter}") and not name.startswith("turn ")
    ]
    if len(found) > 1:
        both = " and ".join(table.labels[place] for place in found[:2])
        raise table.wrong(
            f"line {table.header_line}: {both} both hold {letter}; leave one out, "
            "or name the point that is meant"
        )
    return found[0] if found else None


def _input(table: TextTable, joint: str) -> int | None:
    """The column of the input; not that of its velocity, which has its name too."""
    names = table.plain_names
    for wanted in (plain_name(joint), "input"):
        for place, name in enumerate(names):
            unit = table.unit(place)
            if name == wanted and (unit is None or unit.order == 0):
                return place
    return None
