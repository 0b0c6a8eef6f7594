"""A linkage as the table that `tables` reads: its rows, its joints as drawn, or its dimensions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sevenbar.description.net_table import Cell, net_table
from sevenbar.description.table_columns import DIMENSIONS
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.numbers.dimensions import description_of
from sevenbar.kinematics.numbers.lengths import LONGER


def linkage_table(linkage: Loop) -> tuple[list[str], list[list[Cell]]]:
    """The head and the rows of a linkage's table, each number with its unit in the head.

    >>> import sevenbar as sb
    >>> linkage_table(sb.load("rssr"))
    (['M [mm]', 'N [mm]', 'L1 [mm]', 'L3 [mm]', 'D [mm]', 'input', 'speed'], \
[[700, 700, 250, 550, 0, 'crank', '10.0 rad/s']])
    """
    if linkage.net:
        return net_table(linkage)
    raw = description_of(linkage)
    length, angle = linkage.length_unit, str(raw.get("angle_unit", "deg"))
    if linkage.form == "rssr":
        dimensions = raw["rssr"]
        keys = [key for key in DIMENSIONS if key in dimensions]
        head = [f"{key} [{length}]" for key in keys]
        rows = [[dimensions[key] for key in keys]]
        return [*head, "input", "speed"], [[*rows[0], linkage.drive.joint, _speed(linkage)]]
    drive = ["input", "output", "speed"]
    marks = [_marks(linkage, joint.columns) for joint in linkage.joints]
    names = [joint.name for joint in linkage.joints]
    if linkage.in_rows:
        units = {"length": length, "twist": angle, "offset": length, "angle": angle, "pitch": length}
        tables = raw["link"]
        used = [key for key in units if key in ("length", "twist") or any(key in row for row in tables)]
        head = ["name", "kind", *(f"{key} [{units[key]}]" for key in used), *drive]
        rows = [
            [name, row.get("joint", "R"), *(_of_row(row, key) for key in used), *mark]
            for name, row, mark in zip(names, tables, marks, strict=True)
        ]
        if layout := raw.get("layout"):
            return [*head, "layout"], [[*row, None if i else layout] for i, row in enumerate(rows)]
        return head, rows
    tables = raw["joint"]
    crossed = any("axes" in table for table in tables)
    pitched = any("pitch" in table for table in tables)
    axes = ["axis x", "axis y", "axis z"] + (["axis 2 x", "axis 2 y", "axis 2 z"] if crossed else [])
    head = ["name", "kind", *(f"{letter} [{length}]" for letter in "xyz"), *axes]
    head += [f"pitch [{length}]"] if pitched else []
    longer = any(LONGER in table for table in tables)
    head += [f"{LONGER} [{length}]"] if longer else []
    reads = any("value" in table for table in tables)
    head += ["value"] if reads else []
    units = {"R": angle, "P": length}
    drawn: list[list[Cell]] = []
    for name, table, mark in zip(names, tables, marks, strict=True):
        first, second = table.get("axes", (table.get("axis", (None,) * 3), (None,) * 3))
        row: list[Cell] = [name, table["kind"], *table["at"], *first, *(second if crossed else ())]
        drawn.append([*row, *([table.get("pitch")] if pitched else [])])
        reading = f"{table['value']!r} {units[table['kind']]}" if "value" in table else None
        drawn[-1] += [*([table.get(LONGER)] if longer else []), *([reading] if reads else []), *mark]
    return [*head, *drive], drawn


def points_table(linkage: Loop) -> tuple[list[str], list[list[Cell]]]:
    """The head and the rows of the points that a person has added; no rows where there are none."""
    letters = "uvw" if linkage.in_rows else "xyz"
    head = ["name", "link", *(f"{letter} [{linkage.length_unit}]" for letter in letters)]
    return head, [
        [point.name, linkage.link_name(point.link) if linkage.net else point.link, *point.at]
        for point in linkage.added_points
    ]


def _of_row(row: Mapping[str, Any], key: str) -> Cell:
    value: Cell = row.get(key)
    return 0 if value is None and key in ("length", "twist") else value


def _marks(linkage: Loop, columns: Sequence[str]) -> Sequence[Cell]:
    """Marks of input and output, `x` or the freedom of a joint that has several; the speed at the input."""
    ends = (linkage.drive.joint, linkage.drive.output)
    marked = [(end if len(columns) > 1 else "x") if end in columns else None for end in ends]
    return [*marked, _speed(linkage) if linkage.drive.joint in columns else None]


def _speed(linkage: Loop) -> str:
    return f"{linkage.drive.speed!r} {linkage.unit_of(linkage.drive.joint)}/s"
