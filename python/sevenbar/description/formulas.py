"""Formulas in the place of numbers of a description, which keeps the number of each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from sevenbar.description.load_schema import load_kinds, spring_kinds
from sevenbar.description.load_tables import with_rows
from sevenbar.description.stop_schema import stop_kinds
from sevenbar.description.values import NumberKind, value_in_file
from sevenbar.errors import RequestError

#: What the numbers of each table are; a test compares this with the schema.
KINDS_OF_NUMBERS: Mapping[str, Mapping[str, NumberKind]] = {
    "rssr": dict.fromkeys(("M", "N", "L1", "L2", "L3", "D"), "length"),
    "joint": {"at": "length", "axis": "number", "axes": "number", "pitch": "pitch"},
    "link": {"length": "length", "offset": "length", "pitch": "pitch", "twist": "angle", "angle": "angle"},
    "point": {"at": "length"},
    "forces": {"gravity": "acceleration"},
    "body": {"mass": "mass", "centre": "length", "inertia": "inertia"},
    "load": load_kinds({}, {}),
    "spring": spring_kinds({}, {}) | {"free": "angle"},
    "stop": stop_kinds({}, {}),
    "rod": {"radius": "length"},
}

#: Tables in which the kind of a number depends on how a joint moves.
_KINDS_IN = {"load": load_kinds, "spring": spring_kinds, "stop": stop_kinds}


def with_numbers(raw: Mapping[str, Any], context: Mapping[str, Any]) -> Mapping[str, Any]:
    """A description with the number of each formula in its place, in the units of the file.

    `context` is that of the description. Tables of loads are in it with their rows.
    A text that is no formula stays, for the schema to refuse it.

        >>> from sevenbar.description.schema import context_of
        >>> raw = {"angle_unit": "deg", "link": [{"twist": "pi/3", "length": "2 cm"}]}
        >>> with_numbers(raw, context_of(raw))["link"]
        [{'twist': 60.0, 'length': 20.0}]
    """
    raw = with_rows(raw, context)
    found = {}
    for key, value in raw.items():
        kinds = KINDS_OF_NUMBERS.get(key)
        if kinds is None:
            found[key] = value
        elif isinstance(value, list):
            found[key] = [_table(row, key, context) for row in value]
        else:
            found[key] = _table(value, key, context)
    return found


def _table(table: Any, head: str, context: Mapping[str, Any]) -> Any:
    if not isinstance(table, Mapping):
        return table
    kinds = _KINDS_IN[head](table, context) if head in _KINDS_IN else KINDS_OF_NUMBERS[head]
    reads = {key: partial(value_in_file, kind=kind, context=context) for key, kind in kinds.items()}
    found = {key: _numbers(value, reads[key]) if key in reads else value for key, value in table.items()}
    if head == "load" and isinstance(found.get("table"), list):
        found["table"] = [_row(row, reads["between"]) for row in found["table"]]
    return found


def _row(row: Any, read: Any) -> Any:
    """A row of a load's table: a value of the input, a factor."""
    return [_numbers(row[0], read), *row[1:]] if isinstance(row, list) and row else row


def _numbers(value: Any, read: Any) -> Any:
    """A number, or lists of numbers, with formulas read."""
    if isinstance(value, list | tuple):
        return [_numbers(part, read) for part in value]
    if not isinstance(value, str):
        return value
    try:
        return read(value)
    except RequestError:
        return value
