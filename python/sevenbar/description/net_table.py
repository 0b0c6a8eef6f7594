"""A net as the table that `tables` reads: its pins, or its joints and rods, between links by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sevenbar.description.links import NamedLinks
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.numbers.dimensions import description_of

#: A cell: `None` is empty.
Cell = str | float | int | None

#: What is between the names of a cell.
BETWEEN_NAMES = "; "


def net_table(linkage: Loop) -> tuple[list[str], list[list[Cell]]]:
    """The head and the rows of a net's table, each number with its unit in the head."""
    raw = description_of(linkage)
    links = NamedLinks(raw)
    if not links.rods and not raw.get("joint"):
        head, rows = _pins(raw["pin"], linkage.length_unit)
        labels = [
            [edge.name for edge in links.joints if edge.place == f"pin[{i}]"] for i in range(1, len(rows) + 1)
        ]
    else:
        head, rows = _joints(links, linkage.length_unit, str(raw.get("angle_unit", "deg")))
        labels = [list(edge.columns) for edge in links.edges]
    drive = {linkage.drive.joint: "input", linkage.drive.output: "output"}
    speed = f"{linkage.drive.speed!r} {linkage.unit_of(linkage.drive.joint)}/s"
    for i, (row, columns) in enumerate(zip(rows, labels, strict=True)):
        ends = {drive[column]: column for column in columns if column in drive}
        marks = [ends.get(key) if len(columns) > 1 else ends.get(key) and "x" for key in ("input", "output")]
        row += [links.ground if i == 0 else None, *marks, speed if "input" in ends else None]
    return [*head, "ground", "input", "output", "speed"], rows


def _pins(pins: Sequence[Mapping[str, Any]], length: str) -> tuple[list[str], list[list[Cell]]]:
    rows: list[list[Cell]] = [
        [pin.get("name", f"pin_{i}"), *pin["at"], BETWEEN_NAMES.join(pin["links"])]
        for i, pin in enumerate(pins, 1)
    ]
    return ["name", f"x [{length}]", f"y [{length}]", "links"], rows


def _joints(links: NamedLinks, length: str, angle: str) -> tuple[list[str], list[list[Cell]]]:
    """Joints, pins among them, and rods, with the columns that any of them has."""
    tables = [edge.table for edge in links.joints]
    crossed = any("axes" in table for table in tables)
    pitched = any("pitch" in table for table in tables)
    reads = any("value" in table for table in tables)
    ends = bool(links.rods)
    head = ["name", "kind", *(f"{letter} [{length}]" for letter in "xyz")]
    head += [f"{letter} 2 [{length}]" for letter in "xyz"] if ends else []
    head += [f"axis {letter}" for letter in "xyz"]
    head += [f"axis 2 {letter}" for letter in "xyz"] if crossed else []
    head += [f"pitch [{length}]"] if pitched else []
    head += [*(["value"] if reads else []), "between"]
    none: tuple[Cell, ...] = (None, None, None)
    units = {"R": angle, "P": length}
    rows: list[list[Cell]] = []
    for edge in links.edges:
        table = edge.table
        rod = "kind" not in table
        first, second = table["at"] if rod else (table["at"], none)
        axes = table.get("axes", (table.get("axis", none), none))
        row: list[Cell] = [edge.name, "rod" if rod else table["kind"], *first, *(second if ends else ())]
        row += [*axes[0], *(axes[1] if crossed else ())]
        row += [table.get("pitch")] if pitched else []
        if reads:
            row.append(f"{table['value']!r} {units[table['kind']]}" if "value" in table else None)
        rows.append([*row, BETWEEN_NAMES.join(edge.between)])
    return head, rows
