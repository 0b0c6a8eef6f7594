"""A wanted curve from a table of text: places x, y, z, perhaps with the input at which each shall be met."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from sevenbar.motion import Floats, Motion
from sevenbar.table import Table, read_table
from sevenbar.units import measured_unit


def read_curve(path: str | os.PathLike[str], motion: Motion) -> tuple[Floats, Floats | None]:
    """The places (m, 3) [length] of a table, and its inputs (m,) [rad, or length], `None` where it has none.

    A header names each column and its unit, as in `x [mm],y [mm],z [mm],theta_1 [deg]`: x, y and z in the
    report frame, in any unit of length; the input by the name of its joint, or as `input`.

    Raises `TableError` for a file that is no such table.
    """
    table = read_table(Path(path), "a wanted curve")
    heads = [table.name_and_unit(place)[0].lower() for place in range(len(table.names))]
    places = []
    for letter in "xyz":
        found = [i for i, head in enumerate(heads) if head == letter]
        if len(found) != 1:
            what = "no column" if not found else "several columns"
            raise table.wrong(f"{what} '{letter}'; {table.header}; name them as in 'x [mm],y [mm],z [mm]'")
        places.append(found[0])
    named = [i for i, head in enumerate(heads) if head in ("input", motion.input.lower())]
    if len(named) > 1:
        raise table.wrong(f"several columns of the input {motion.input}; {table.header}; leave one out")
    slides = motion.linkage.column_kinds[motion.linkage.columns.index(motion.input)] == "slide"
    kinds = dict.fromkeys(places, "slide") | dict.fromkeys(named, "slide" if slides else "turn")
    numbers = {
        place: table.numbers(place) * _size(table, place, kind, motion) for place, kind in kinds.items()
    }
    table.refuse_gaps(numbers, "leave such rows out")
    curve = np.column_stack([numbers[place] for place in places])
    return curve, numbers[named[0]] if named else None


def _size(table: Table, place: int, kind: str, motion: Motion) -> float:
    """The size of a column's unit in radians, or in the linkage's length unit."""
    label, unit = table.labels[place], table.name_and_unit(place)[1]
    example = {"slide": "mm", "turn": "deg"}[kind]
    if not unit:
        raise table.wrong(f"column {label} has no unit; write it as in '{table.names[place]} [{example}]'")
    known = measured_unit(unit)
    if known is None or (known.kind, known.order) != (kind, 0):
        what = {"slide": "a length", "turn": "an angle"}[kind]
        raise table.wrong(f"column {label}: '{unit}' is not a unit of {what}; give one, as in [{example}]")
    return known.size_in(motion.linkage.length_unit)
