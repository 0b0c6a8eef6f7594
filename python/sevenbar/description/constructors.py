"""A linkage from arguments of Python: the RSSR's numbers, Denavit-Hartenberg columns, axes, pins."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from sevenbar.description.angle_doubts import warn_of_angles
from sevenbar.description.forms import from_description
from sevenbar.errors import (
    DescriptionError,
    Problem,
    RequestError,
    bare,
    check_kind,
    ends_here,
    shown,
    suggestion,
)
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.joint_text import check_own_unit
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.text.listed import listed
from sevenbar.text.units import LENGTHS, measured_unit

#: One number for each joint: a list, an array, a column of a data frame; a text has a unit of its own.
Numbers = Sequence[float | str | None] | npt.NDArray[np.float64] | Any


@ends_here
def rssr(
    M: float | str,
    N: float | str,
    L1: float | str,
    L3: float | str,
    D: float | str | None = None,
    L2: float | str | None = None,
    *,
    name: str = "RSSR",
    length_unit: str = "mm",
    speed: float | str = 1.0,
) -> Linkage:
    """The RSSR in the layout of Sun and Zhou: crank about z at height N, rocker about x at (M, D, 0).

    `A = (L1 cos alpha, L1 sin alpha, N)`, `B = (M, D + L3 cos beta, L3 sin beta)`, `|A - B| = L2`; lengths
    in `length_unit`, texts with a unit of their own, as "25 cm". D is required, as in files. L2 left out is
    `|A1 B1|`, `L2^2 = (L1 - M)^2 + L3^2 + N^2`. Raises `DescriptionError`
    with all that is wrong.

        >>> import sevenbar as sb
        >>> sb.rssr(M=700, N=700, L1=250, L3=550, D=0).motion().motion_type
        'crank-rocker'

    Source: docs/rssr.md, (1) and (2); Sun and Zhou, Figure 2, eq. (5) to (7).
    """
    numbers = {"M": M, "N": N, "L1": L1, "L3": L3, "D": D, "L2": L2}
    dimensions = {key: value for key, value in numbers.items() if value is not None}
    return from_description(head_of(name, length_unit, speed) | {"rssr": _plain(dimensions)})


@ends_here
def from_axes(
    joints: Sequence[Mapping[str, Any]] | Any,
    *,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Sequence[Mapping[str, Any]] = (),
    rods: Sequence[Mapping[str, Any]] = (),
    ground: str | None = None,
    drive: str | None = None,
) -> Linkage:
    """A linkage from its joints as drawn in one assembled pose, in loop order: kind, point, direction.

    Each joint is a mapping with `kind` (a letter), `at` (three coordinates), `axis` (three numbers;
    `axes`, two of them, for U; none for S), `pitch` (length per turn) for H, and perhaps `name`. Link i lies
    between joints i and i + 1, the last is the ground. Every joint reads 0 in this pose, or its `value`, of R
    [deg, or text] and P [`length_unit`, or text]. Coordinates and pitches are in `length_unit`, or texts as
    in "12 mm", "8 mm/turn". A joint at the ground, first or last, counts its link against the ground.

    With links by name joints stand in any order: each has `between`, the names of its two links, `ground`
    names the link that stands still, and points name their `link`. `rods`, with `between` and two places
    `at`, are links with a ball at each end. More than one loop makes a net. `drive` names the input.
    `joints` may be a data frame or the path of a table, as `from_table` takes it.

        >>> import sevenbar as sb
        >>> linkage = sb.from_axes([
        ...     {"kind": "R", "at": (0, 0, 700), "axis": (0, 0, 1)},
        ...     {"kind": "S", "at": (250, 0, 700)},
        ...     {"kind": "S", "at": (700, 550, 0)},
        ...     {"kind": "R", "at": (700, 0, 0), "axis": (1, 0, 0)},
        ... ])
        >>> linkage.motion().motion_type
        'crank-rocker'
    """
    return _drawn(name, length_unit, speed, drive, ground, joints=joints, points=points, rods=rods)


@ends_here
def from_pins(
    pins: Sequence[Mapping[str, Any]] | Any,
    *,
    ground: str | None = None,
    drive: str | None = None,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str = 1.0,
    points: Sequence[Mapping[str, Any]] = (),
    rods: Sequence[Mapping[str, Any]] = (),
) -> Linkage:
    """A planar linkage from its pins as drawn in one assembled pose: links that turn on each, by name.

    Each pin is a mapping with `at` (x, y), `links` (two names or more), and perhaps `name`; a pin of k links
    is k - 1 hinges about z. `ground` names the link that stands still; `drive` the input, the first pin where
    it is left out. Points and rods are those of `from_axes`. `pins` may be a data frame or the path of a
    table with columns x, y, links (names with blanks or `;` between) and perhaps name, as `from_table` takes
    it; there `ground` may be left out.

        >>> import sevenbar as sb
        >>> linkage = sb.from_pins([
        ...     {"name": "crank", "at": (0, 0), "links": ("frame", "crank")},
        ...     {"at": (10, 40), "links": ("crank", "coupler")},
        ...     {"at": (100, 70), "links": ("coupler", "rocker")},
        ...     {"name": "rocker", "at": (90, 0), "links": ("frame", "rocker")},
        ... ], ground="frame")
        >>> linkage.motion().motion_type
        'crank-rocker'
    """
    return _drawn(name, length_unit, speed, drive, ground, pins=pins, points=points, rods=rods)


def _drawn(
    name: str, length_unit: str, speed: float | str, drive: str | None, ground: str | None, **lists: Any
) -> Linkage:
    """The linkage of tables as drawn, those that are not empty; the first may be a data frame or a file."""
    key, first = next(iter(lists.items()))
    # one mapping for each joint, by name, is no mapping of columns, nor is that of one joint
    columns = (
        isinstance(first, Mapping)
        and "at" not in first
        and not any(isinstance(value, Mapping) for value in first.values())
    )
    if isinstance(first, str | os.PathLike) or columns or hasattr(first, "columns"):
        return _of_table(key, first, name, length_unit, speed, drive, ground, lists)
    raw = head_of(name, length_unit, speed)
    if drive is not None:
        raw["drive"] = {**raw.get("drive", {}), "joint": drive}
    if ground is not None:
        raw["ground"] = ground
    for key, values in lists.items():
        rows = _rows_of(key, values)
        if rows or key in ("joints", "pins", "points"):
            raw[key.removesuffix("s")] = rows
    return from_description(raw)


def _rows_of(key: str, values: Any) -> list[Any]:
    """The tables of a list, or `RequestError` for what is none."""
    rows = _plain(values)
    check_kind(key, rows, list, f"a list; give one with a mapping for each of the {key}")
    return cast("list[Any]", rows)


def _of_table(
    key: str,
    source: Any,
    name: str,
    length_unit: str,
    speed: float | str,
    drive: str | None,
    ground: str | None,
    lists: Mapping[str, Any],
) -> Linkage:
    """The linkage of a table as drawn, with points and rods besides."""
    from sevenbar.description.table_files import table_of

    if isinstance(source, str | os.PathLike) and Path(source).suffix.lower() == ".toml":
        raise RequestError(f"{key}: {source} is a linkage file, no table; give it to sevenbar.load")
    if length_unit != "mm":
        raise RequestError("length_unit: is given in addition to a table; write it in the head, as in x [cm]")
    result, place = table_of(source, ground or "")
    if "link" in result.raw or "rssr" in result.raw:
        raise RequestError(f"{key}: the table has no {key} as drawn; give it to sevenbar.from_table")
    if name != "linkage":
        result.raw["name"] = name
    result.drive_by(drive, None if speed == 1.0 else _plain(speed))
    for head in ("point", "rod"):
        if more := _rows_of(f"{head}s", lists.get(f"{head}s", ())):
            result.raw[head] = [*result.raw.get(head, []), *more]
    return result.linkage(from_description, place)


@ends_here
def from_dh(
    joints: Any,
    *,
    length: Numbers | None = None,
    twist: Numbers | None = None,
    offset: Numbers | None = None,
    angle: Numbers | None = None,
    pitch: Numbers | None = None,
    names: Sequence[str] | None = None,
    name: str = "linkage",
    length_unit: str = "mm",
    speed: float | str | None = None,
    points: Sequence[Mapping[str, Any]] = (),
    **others: object,
) -> Linkage:
    """A linkage from classic Denavit-Hartenberg numbers, one of each for a link, the ground last.

    `A_i = Rz(theta_i) Tz(offset_i) Tx(length_i) Rx(twist_i)`, joint i stands before link i, and the product
    of all is the identity. `joints` has a letter R, P or H for each joint. Lengths and offsets are in
    `length_unit` and may be negative, angles in radians; a text has a unit of its own, as in "30 deg". What
    is left out is 0. A twist of more than a turn gets an `AngleUnitWarning`. The last joint turns the ground
    relative to the link before it, as the paper's does. Lists, arrays and columns of a data frame are taken;
    a column whose name has a unit, `alpha [deg]`, is in that. The variable of R and H is theta, that of P the
    offset, its theta being the fixed `angle`; `pitch` is the length per turn of H, whose offset is its value
    at theta = 0. What a joint has not (the offset of P, the angle of R and H, the pitch of R and P) is `None`
    or 0. A point is `{"name": .., "link": .., "at": (u, v, w)}`: from where the link before meets the joint's
    axis, u along that axis, v along the link, w = u x v. `joints` may be a data frame of all columns instead,
    as `from_table` takes it. Raises `DescriptionError` with all that is wrong.

        >>> import sevenbar as sb
        >>> twists = [0.3, 0.6320397, 0.3, 0.6320397]
        >>> bennett = sb.from_dh("RRRR", length=[1, 2, 1, 2], twist=twists)
        >>> bennett.columns
        ('theta_1', 'theta_2', 'theta_3', 'theta_4')
        >>> square = sb.from_dh("RRRR", length=[1] * 4, twist=["30 deg"] * 4, offset=[0] * 4)
        >>> square.dimensions["twist_1_deg"]
        30.0

    Source: docs/conventions.md, (1); the 7R paper's loop and its u, v, w.
    """
    _refuse_others(others)
    columns = {"length": length, "twist": twist, "offset": offset, "angle": angle, "pitch": pitch}
    if hasattr(joints, "columns"):
        also_given = {**columns, "names": names, "length_unit": None if length_unit == "mm" else length_unit}
        if given := [key for key, values in also_given.items() if values is not None]:
            raise RequestError(f"{given[0]}: is given in addition to a data frame; leave one out")
        return _of_frame(joints, name=name, speed=speed, points=points)
    numbers = {key: _in_unit(key, values, length_unit) for key, values in columns.items()}
    rows = _rows(joints, numbers, _plain(names))
    head = head_of(name, length_unit, 1.0 if speed is None else speed)
    linkage = from_description(head | {"angle_unit": "rad", "link": rows, "point": _plain(points)})
    warn_of_angles(linkage.description)
    return linkage


def head_of(name: str, length_unit: str, speed: float | str) -> dict[str, Any]:
    """What the descriptions of all calls begin with."""
    return {"format": 1, "name": name, "length_unit": length_unit, "drive": {"speed": _plain(speed)}}


#: What other books call the arguments of `from_dh`.
_OTHER_NAMES = {
    "a": "length", "r": "length", "alpha": "twist", "d": "offset", "s": "offset", "theta": "angle",
    "lengths": "length", "twists": "twist", "offsets": "offset", "angles": "angle", "kinds": "joints",
    "h": "pitch", "lead": "pitch",
}  # fmt: skip


def _refuse_others(others: Mapping[str, object]) -> None:
    """`RequestError` for an argument of another name."""
    for word in others:
        if word in _OTHER_NAMES:
            ours = "a is length, alpha twist, d offset, theta angle"
            raise RequestError(
                f"{word}: is called {_OTHER_NAMES[word]} here ({ours}); give {_OTHER_NAMES[word]}="
            )
        # of words that are wrong only
        from inspect import signature

        known = list(signature(from_dh).parameters)[1:-1]
        raise RequestError(
            f"{bare(word)}: is no argument; {suggestion(word, known)}allowed: {', '.join(known)}"
        )


def _of_frame(
    frame: Any, *, name: str, speed: float | str | None, points: Sequence[Mapping[str, Any]]
) -> Linkage:
    """The linkage of a data frame of Denavit-Hartenberg rows."""
    from sevenbar.description.table_reader import described_frame

    result = described_frame(frame)
    if "link" not in result.raw:
        raise RequestError("joints: the table has no Denavit-Hartenberg rows; give it to sevenbar.from_table")
    result.raw |= {"name": name, "point": [*result.raw.get("point", []), *_plain(points)]}
    given = {} if speed is None else {"speed": _plain(speed)}
    result.raw["drive"] = {"speed": 1.0, **result.raw.get("drive", {}), **given}
    return result.linkage(from_description, "table")


def _in_unit(key: str, values: Any, length_unit: str) -> Any:
    """A column as a list; one of a data frame is in the unit that its name has."""
    plain = _plain(values)
    name, written = getattr(values, "name", None), ""
    if isinstance(name, str):
        from sevenbar.text.table import name_and_unit

        _, written = name_and_unit(name)
    if isinstance(plain, list) and key in ("twist", "angle"):
        for i, value in enumerate(plain):
            if isinstance(value, str):
                check_own_unit(f"{key}[{i}]", value)
    if not written or not isinstance(plain, list):
        return plain
    unit = measured_unit(written)
    sort = "turn" if key in ("twist", "angle") else "slide"
    if unit is None or (unit.kind, unit.order) != (sort, 0):
        what = {"turn": "angles", "slide": "lengths"}[sort]
        raise RequestError(f"{key}: the unit of column {shown(name)} is not one of {what}; rename the column")
    size = unit.size_in(length_unit) if length_unit in LENGTHS else 1.0
    return [value * size if isinstance(value, int | float) and size != 1.0 else value for value in plain]


def _rows(joints: object, columns: Mapping[str, Any], names: Any) -> list[dict[str, Any]]:
    """The rows that a file would hold, without the zeros that only fill a place."""
    if not isinstance(joints, str):
        raise DescriptionError(
            [Problem("joints", f"{shown(joints)} is not a text; give a letter for each joint, as in 'RRRR'")]
        )
    given = {key: values for key, values in {**columns, "name": names}.items() if values is not None}
    problems = [
        Problem("names" if key == "name" else key, message)
        for key, values in given.items()
        if (message := _miscounted(values, len(joints)))
    ]
    if problems:
        raise DescriptionError(problems)
    rows: list[dict[str, Any]] = []
    for i, letter in enumerate(joints):
        # these keys are refused in a row of this kind, whatever they hold
        own = KINDS[letter].row_keys if letter in KINDS else ()
        idle = {"offset", "angle", "pitch"}.difference(own) if own else ()
        row = {key: values[i] for key, values in given.items() if values[i] is not None}
        numbers = {key: value for key, value in row.items() if not (key in idle and value == 0)}
        rows.append({"joint": letter, **numbers})
    return rows


def _miscounted(values: object, count: int) -> str:
    if not isinstance(values, list):
        return f"{shown(values)} is not a list; give {count}, one for each joint"
    return "" if len(values) == count else f"{len(values)} given for {count} joints; give {count}"


def _plain(value: Any) -> Any:
    """Arrays and NumPy numbers as the lists and numbers that a file would hold; `RequestError` for a nest."""
    try:
        return _listed(value)
    except RecursionError:
        raise RequestError(
            "a list or a mapping is nested without end; give numbers, and lists and mappings of numbers"
        ) from None


def _listed(value: Any) -> Any:
    if not isinstance(value, str | Mapping):
        value = listed(value)
    if isinstance(value, Mapping):
        return {key: _listed(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_listed(v) for v in value]
    return value
