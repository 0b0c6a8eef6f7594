"""Poses of a link from a table of text: a place, and an axis times its angle, row by row."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.curve_table import read_curve
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rigid import pose
from sevenbar.text.table import TextTable, read_table

#: The columns of a rotation: its axis times its angle.
TURNS = ("turn_x", "turn_y", "turn_z")


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
            found = table.sized(column, ("turn", 0), "m", what=name, example="deg")
            numbers[column] = turns[:, axis] = found
    if not numbers:
        raise table.wrong(f"no column for a rotation; {table.header}; name them as in 'turn_z [deg]'")
    table.refuse_gaps(numbers, "leave the row out")
    return turns


def rotations(turns: Floats) -> Floats:
    """The rotations (n, 3, 3) of axes times their angles (n, 3) [rad]."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(turns).as_matrix()
