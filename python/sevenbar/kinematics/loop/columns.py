"""The names of columns in tables of a motion: each ends in its unit, which readers of tables take from it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import shown
from sevenbar.kinematics.loop.geometry import Loop

#: What the unit of a rate of order 0 to 3 ends in.
RATES = ("", "_s", "_s2", "_s3")

#: What stands before the axis in the name of a point's position, velocity, acceleration.
LETTERS = ("", "v", "a")


def column_named(columns: Sequence[str], name: str) -> int:
    """The place of a column by its name; `KeyError` names those there are.

    >>> column_named(("crank", "rocker"), "rocker")
    1
    """
    # an array is equal to no name, and to each in every place
    if not isinstance(name, str) or name not in columns:
        raise KeyError(f"no column {shown(name)}; there are {', '.join(columns)}")
    return columns.index(name)


def shown_in(linkage: Loop, column: int | str) -> tuple[str, float]:
    """The unit in which people read a column, and what 1 of it is there: degrees for angles."""
    return linkage.column_of(column).shown


def joint_column(name: str, *, slides: bool, order: int, length: str, angle: str, who: str = "") -> str:
    """The column of a joint's value (order 0) or rate; of `who`, where a table has it of several.

    >>> joint_column("crank", slides=False, order=0, length="mm", angle="deg")
    'crank_deg'
    >>> joint_column("crank", slides=False, order=2, length="mm", angle="deg", who="mujoco")
    'crank_mujoco_rad_s2'
    """
    unit = length if slides else "rad" if order else angle
    return f"{_whose(name, who)}_{unit}{RATES[order]}"


def joint_columns(
    linkage: Loop, rates: Sequence[Floats], *, length: str, angle: str, scale: float
) -> dict[str, Floats]:
    """The columns of all joints: values (n, columns), then their rates, in order.

    Slides are multiplied by `scale`, which makes the unit `length` of them; angles are in `angle`, "deg" or
    "rad".
    """
    result: dict[str, Floats] = {}
    for order, values in enumerate(rates):
        for column, own in zip(linkage.each_column, values.T, strict=True):
            slides = not column.turns
            head = joint_column(column.name, slides=slides, order=order, length=length, angle=angle)
            scaled = own * scale if slides else own
            result[head] = np.degrees(scaled) if head.endswith("_deg") else scaled
    return result


def point_column(name: str, axis: str, *, order: int, length: str, who: str = "") -> str:
    """The column of a point's coordinate (order 0) or its rate.

    >>> point_column("P", "x", order=1, length="mm")
    'P_vx_mm_s'
    """
    return f"{_whose(f'{name}_{LETTERS[order]}{axis}', who)}_{length}{RATES[order]}"


def unit_in_column(unit: str) -> str:
    """A unit as it ends a column's name.

    >>> unit_in_column("mm/s^2"), unit_in_column("deg/s²")
    ('mm_s2', 'deg_s2')
    """
    return unit.replace("/", "_").replace("^", "").replace("²", "2")


def _whose(name: str, who: str) -> str:
    return f"{name}_{who}" if who else name
