"""Wanted curves and poses from a table of text: places and turns with their units, perhaps the inputs."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import pose
from sevenbar.text.table import TextTable, plain_name, read_table

#: The columns of a rotation: its axis times its angle.
TURNS = ("turn_x", "turn_y", "turn_z")


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
        kind = linkage.column_of(input_joint).kind
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
    result = [
        place
        for place, name in enumerate(names)
        if name.endswith(f" {letter}") and not name.startswith("turn ")
    ]
    if len(result) > 1:
        both = " and ".join(table.labels[place] for place in result[:2])
        raise table.wrong(
            f"line {table.header_line}: {both} both hold {letter}; leave one out, "
            "or name the point that is meant"
        )
    return result[0] if result else None


def _input(table: TextTable, joint: str) -> int | None:
    """The column of the input; not that of its velocity, which has its name too."""
    names = table.plain_names
    for wanted in (plain_name(joint), "input"):
        for place, name in enumerate(names):
            unit = table.unit(place)
            if name == wanted and (unit is None or unit.order == 0):
                return place
    return None


def read_poses(path: Path, linkage: Linkage) -> tuple[Floats, Floats | None]:
    """The poses (n, 4, 4) of a table, and its inputs (n,) [rad, or length], `None` where it has none.

    Columns x, y, z [length] as `read_curve` has them, and turn_x, turn_y, turn_z [deg, rad]; of these, those
    that are left out are 0. Raises `TableError`.
    """
    places, inputs = read_curve(path, linkage, linkage.drive.joint)
    turns = read_turns(read_table(path, "poses of a link"))
    return pose(rotations(turns), places), inputs


def read_turns(table: TextTable) -> Floats:
    """The columns turn_x, turn_y, turn_z (n, 3) [rad], 0 where one is left out; `TableError` without any."""
    turns = np.zeros((len(table.rows), 3))
    numbers = {}
    for axis, name in enumerate(TURNS):
        column = table.column(name)
        if column is not None:
            # an angle: the unit of lengths has no say
            result = table.sized(column, ("turn", 0), "m", what=name, example="deg")
            numbers[column] = turns[:, axis] = result
    if not numbers:
        raise table.wrong(f"no column for a rotation; {table.header}; name them as in 'turn_z [deg]'")
    table.refuse_gaps(numbers, "leave the row out")
    return turns


def rotations(turns: Floats) -> Floats:
    """The rotations (n, 3, 3) of axes times their angles (n, 3) [rad]."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(turns).as_matrix()
