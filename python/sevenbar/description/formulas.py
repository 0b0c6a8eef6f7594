"""Formulas in the place of numbers of a description, which then holds the number of each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from sevenbar.description.load_tables import folder_of, with_rows
from sevenbar.description.values import value_in_file
from sevenbar.description.written import drive_of, driven, joints_of
from sevenbar.errors import RequestError
from sevenbar.text.units import ANGLES, LENGTHS, MASSES

if TYPE_CHECKING:
    from sevenbar.description.values import NumberKind


def joint_kinds(table: Mapping[str, Any], context: Mapping[str, Any]) -> dict[str, NumberKind]:  # noqa: ARG001
    """What the numbers of a joint as drawn are: what it reads there by how it moves."""
    moves: NumberKind = "length" if _word(table.get("kind")) == "P" else "angle"
    return {
        "at": "length",
        "axis": "number",
        "axes": "number",
        "pitch": "pitch",
        "longer": "length",
        "value": moves,
    }


def spring_kinds(table: Mapping[str, Any], context: Mapping[str, Any]) -> dict[str, NumberKind]:
    """What the numbers of a spring are: between two points, in a joint that slides, or in one that turns."""
    turns = "joint" in table and context.get("freedoms", {}).get(_word(table["joint"])) != "slide"
    return {
        "at": "length",
        "length": "length",
        "free": "angle" if turns else "length",
        "stiffness": "turning stiffness" if turns else "stiffness",
        "damping": "turning damping" if turns else "damping",
    }


def load_kinds(table: Mapping[str, Any], context: Mapping[str, Any]) -> dict[str, NumberKind]:  # noqa: ARG001
    """What the numbers of a load are: those of the input by how it moves."""
    moves: NumberKind = "length" if context.get("slides") else "angle"
    return {"at": "length", "force": "force", "torque": "torque", "between": moves}


def stop_kinds(table: Mapping[str, Any], context: Mapping[str, Any]) -> dict[str, NumberKind]:
    """What the numbers of a stop are: those of a range by how its joint moves."""
    freedom = context.get("freedoms", {}).get(_word(table.get("joint")))
    moves: NumberKind = "length" if freedom == "slide" else "angle"
    return {"range": moves, "cone": "angle", "seat": "number", "stud": "number"}


def _word(value: object) -> str:
    return value.strip() if isinstance(value, str) else ""


#: What the numbers of each table are; a test compares this with the schema.
KINDS_OF_NUMBERS: Mapping[str, Mapping[str, NumberKind]] = {
    "rssr": dict.fromkeys(("M", "N", "L1", "L2", "L3", "D"), "length"),
    "joint": joint_kinds({}, {}),
    "link": {"length": "length", "offset": "length", "pitch": "pitch", "twist": "angle", "angle": "angle"},
    "point": {"at": "length"},
    "forces": {"gravity": "acceleration"},
    "body": {
        "mass": "mass",
        "centre": "length",
        "inertia": "inertia",
        "density": "density",
        "along": "number",
        "side": "number",
        **dict.fromkeys(("diameter", "bore", "ends", "size"), "length"),
    },
    "load": load_kinds({}, {}),
    "spring": spring_kinds({}, {}) | {"free": "angle"},
    "stop": stop_kinds({}, {}),
    "rod": {"radius": "length"},
}

#: Tables in which the kind of a number depends on how a joint moves.
_KINDS_IN = {"joint": joint_kinds, "load": load_kinds, "spring": spring_kinds, "stop": stop_kinds}


def context_of(raw: Mapping[str, Any], source: str = "") -> dict[str, Any]:
    """What a number of the file needs to know of the rest: units, how joints move, the folder of `source`."""
    angle_unit, length_unit = raw.get("angle_unit"), raw.get("length_unit")
    forces = raw.get("forces")
    mass_unit = forces.get("mass_unit") if isinstance(forces, Mapping) else None
    joints = joints_of(raw)
    column, _, _ = driven(joints, drive_of(raw))
    slides = any(joint.columns.get(column) == "slide" for joint in joints)
    unit = length_unit if isinstance(length_unit, str) and length_unit in LENGTHS else "mm"
    return {
        "length_unit": unit,
        "angle_unit": angle_unit if isinstance(angle_unit, str) and angle_unit in ANGLES else "deg",
        "mass_unit": mass_unit if isinstance(mass_unit, str) and mass_unit in MASSES else "kg",
        "slides": unit if slides else None,
        "freedoms": {
            name: freedom
            for joint in joints
            for column, freedom in reversed(joint.columns.items())
            for name in (joint.name, column)
        },
        "folder": folder_of(source),
    }


def with_numbers(raw: Mapping[str, Any], context: Mapping[str, Any]) -> Mapping[str, Any]:
    """A description with the number of each formula in its place, in the units of the file.

    `context` is that of the description. Tables of loads are in it with their rows.
    A text that is no formula stays, for the schema to refuse it.

        >>> raw = {"angle_unit": "deg", "link": [{"twist": "pi/3", "length": "2 cm"}]}
        >>> with_numbers(raw, context_of(raw))["link"]
        [{'twist': 60.0, 'length': 20.0}]
    """
    raw = with_rows(raw, context)
    result = {}
    for key, value in raw.items():
        kinds = KINDS_OF_NUMBERS.get(key)
        if kinds is None:
            result[key] = value
        elif isinstance(value, list):
            result[key] = [_table(row, key, context) for row in value]
        else:
            result[key] = _table(value, key, context)
    return result


def _table(table: Any, head: str, context: Mapping[str, Any]) -> Any:
    if not isinstance(table, Mapping):
        return table
    kinds = _KINDS_IN[head](table, context) if head in _KINDS_IN else KINDS_OF_NUMBERS[head]
    reads = {key: partial(value_in_file, kind=kind, context=context) for key, kind in kinds.items()}
    result = {key: _numbers(value, reads[key]) if key in reads else value for key, value in table.items()}
    if head == "load" and isinstance(result.get("table"), list):
        # each row a value of the input, which may be a formula, and a factor
        result["table"] = [
            [_numbers(row[0], reads["between"]), *row[1:]] if isinstance(row, list) and row else row
            for row in result["table"]
        ]
    return result


def _numbers(value: Any, read: Any) -> Any:
    """A number, or lists of numbers, with formulas read."""
    if isinstance(value, list | tuple):
        return [_numbers(part, read) for part in value]
    if not isinstance(value, str):
        return value
    try:
        return read(value)
    except RequestError:  # no formula: the schema has its message
        return value
