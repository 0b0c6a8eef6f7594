"""Poses of a link from a table of text: a place, and an axis times its angle, row by row."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.curve_table import read_curve
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rigid import pose
from sevenbar.text.table import plain_name, read_table

#: The columns of a rotation: its axis times its angle.
TURNS = ("turn_x", "turn_y", "turn_z")


def read_poses(path: Path, linkage: Linkage) -> tuple[Floats, Floats | None]:
    """The poses (n, 4, 4) of a table, and its inputs (n,) [rad, or length], `None` where it has none.

    Columns x, y, z [length] as `read_curve` has them, and turn_x, turn_y, turn_z [deg, rad]; of these, those
    that are left out are 0. Raises `TableError`.
    """
    from scipy.spatial.transform import Rotation

    places, inputs = read_curve(path, linkage, linkage.drive.joint)
    table = read_table(path, "poses of a link")
    names = [plain_name(table.name_and_unit(column)[0]) for column in range(len(table.names))]
    turns = np.zeros((len(places), 3))
    numbers = {}
    for axis, name in enumerate(TURNS):
        if plain_name(name) in names:
            column = names.index(plain_name(name))
            size = table.size(column, ("turn", 0), linkage.length_unit, what=name, example="deg")
            numbers[column] = turns[:, axis] = table.numbers(column) * size
    if not numbers:
        raise table.wrong(f"no column for a rotation; {table.header}; name them as in 'turn_z [deg]'")
    table.refuse_gaps(numbers, "leave the row out")
    return pose(Rotation.from_rotvec(turns).as_matrix(), places), inputs
