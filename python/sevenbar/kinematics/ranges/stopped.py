"""A linkage with other stops, which its description keeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from sevenbar.arrays import finite_number
from sevenbar.errors import RequestError, check_kind, shown
from sevenbar.kinematics.dynamics.link_bodies import refuse_no_link
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.stops import Cone, Stops, check_range
from sevenbar.kinematics.ranges.ball_angle import joint_at
from sevenbar.text.given import given_number
from sevenbar.text.units import ANGLES, as_written

L = TypeVar("L", bound=Loop)

Ranges = Mapping[str, tuple[float | str, float | str]]
Cones = Mapping[str, Cone | float | str]
Radii = Mapping[int, float | str]


def stopped(
    linkage: L, *, ranges: Ranges | None = None, cones: Cones | None = None, radii: Radii | None = None
) -> L:
    """The linkage with what is given in the place of its own; raises `RequestError`."""
    own = linkage.stops
    for key, value in (("ranges", ranges), ("cones", cones), ("radii", radii)):
        if value is not None:
            check_kind(key, value, Mapping, "a mapping; give one, as in {'crank': (-1, 1)}")
    given = Stops(
        own.ranges if ranges is None else _ranges(linkage, ranges),
        own.cones if cones is None else _cones(linkage, cones),
        own.radii if radii is None else _radii(linkage, radii),
    )
    selected = {key: value for key, value in linkage.description.items() if key not in ("stop", "rod")}
    if linkage.description:
        selected |= {key: rows for key, rows in tables_of(linkage, given).items() if rows}
    return replace(linkage, stops=given, description=selected)


def tables_of(linkage: Loop, stops: Stops) -> dict[str, list[dict[str, Any]]]:
    """Stops as the tables of a file have them, angles in the file's unit."""
    angle = ANGLES[str(linkage.description.get("angle_unit", "deg"))]
    rows: list[dict[str, Any]] = []
    for name, ends in stops.ranges.items():
        size = angle if linkage.turns(name) else 1.0
        rows.append({"joint": name, "range": [as_written(end / size) for end in ends]})
    for name, cone in stops.cones.items():
        row: dict[str, Any] = {"joint": name}
        row |= {} if cone.angle is None else {"cone": as_written(cone.angle / angle)}
        row |= {key: list(way) for key in ("seat", "stud") if (way := getattr(cone, key)) is not None}
        rows.append(row)
    rods = [{"link": int(link), "radius": radius} for link, radius in stops.radii.items()]
    return {"stop": rows, "rod": rods}


def _ranges(linkage: Loop, given: Ranges) -> dict[str, tuple[float, float]]:
    result = {}
    for name, ends in given.items():
        key = f"ranges[{shown(name)}]"
        column = linkage.column(name, key)
        unit = linkage.unit_of(column)
        several = isinstance(ends, Sequence | np.ndarray) and not isinstance(ends, str)
        if not several or getattr(ends, "ndim", 1) != 1 or len(ends) != 2:
            raise RequestError(f"{key}: {shown(ends)} is not a range; give two values, low and high")
        low, high = (finite_number(key, given_number(key, end, unit)) for end in ends)  # type: ignore[arg-type]
        result[linkage.columns[column]] = check_range(key, low, high, turns=unit == "rad")
    return result


def _cones(linkage: Loop, given: Cones) -> dict[str, Cone]:
    result = {}
    for name, cone in given.items():
        place = joint_at(linkage, name)
        if not isinstance(cone, Cone):
            key = f"cones[{shown(name)}]"
            cone = Cone(finite_number(key, given_number(key, cone, "rad")))  # type: ignore[arg-type]
        result[linkage.joints[place].name] = cone
    return result


def _radii(linkage: Loop, given: Radii) -> dict[int, float]:
    result = {}
    for link, radius in given.items():
        refuse_no_link("radii", link, linkage, or_ground=True)
        key = f"radii[{link}]"
        value = finite_number(key, given_number(key, radius, linkage.length_unit))  # type: ignore[arg-type]
        if value <= 0:
            raise RequestError(f"{key}: {shown(radius)} is not a radius; give a number > 0")
        result[int(link)] = value
    return result
