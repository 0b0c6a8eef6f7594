"""A linkage in a table: Denavit-Hartenberg rows, joints as drawn, or the RSSR paper's dimensions.

The table becomes the description that a TOML file would hold, and is checked as such; each mistake has its
line and its column.
"""

from __future__ import annotations

import os
from typing import Any

from sevenbar.description.forms import from_description
from sevenbar.description.table_files import table_of
from sevenbar.kinematics.linkage import Linkage


def from_table(
    source: str | os.PathLike[str] | Any,
    *,
    name: str | None = None,
    speed: float | str | None = None,
    ground: str | None = None,
    drive: str | None = None,
) -> Linkage:
    """The linkage of a table: a CSV or Excel file, or a data frame with the same columns.

    Denavit-Hartenberg rows (classic: `A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)`, the ground last) have the
    columns length or a, twist or alpha, offset or d, perhaps kind, name, theta, pitch; joints as drawn have
    name, kind, x, y, z, axis x, axis y, axis z, and perhaps between, the two links that each joins; pins of a
    planar linkage have x, y, links, and perhaps name. Units are written as in `a [mm]`, `alpha [deg]`. A
    column `input` marks the input, or holds its speed; `drive` names another. `ground` names the link that
    stands still where no column does and none is called so. Raises `DescriptionError` with each mistake at
    its line and column.

        >>> import sevenbar as sb
        >>> columns = {"a [mm]": [60, 90.16282937626413] * 2, "alpha [deg]": [40, 75] * 2}
        >>> sb.from_table(columns).motion().motion_type
        'double-crank'
    """
    result, place = table_of(source, ground or "")
    result.raw["name"] = name or result.raw["name"]
    result.drive_by(drive, speed)
    return result.linkage(from_description, place)
