"""Formulas in the place of numbers of a description, which keeps the number of each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from sevenbar.description.schema import context_of
from sevenbar.description.values import value_in_file
from sevenbar.errors import RequestError
from sevenbar.text.amounts import Kind

#: What the numbers of each table are; a test compares this with the schema.
KINDS_OF_NUMBERS: Mapping[str, Mapping[str, Kind]] = {
    "rssr": dict.fromkeys(("M", "N", "L1", "L2", "L3", "D"), "length"),
    "joint": {"at": "length", "axis": "number", "axes": "number", "pitch": "pitch"},
    "link": {"length": "length", "offset": "length", "pitch": "pitch", "twist": "angle", "angle": "angle"},
    "point": {"at": "length"},
}


def with_numbers(raw: Mapping[str, Any]) -> Mapping[str, Any]:
    """A description with the number of each formula in its place, in the units of the file.

    A text that is no formula stays, for the schema to refuse it.

        >>> with_numbers({"angle_unit": "deg", "link": [{"twist": "pi/3", "length": "2 cm"}]})["link"]
        [{'twist': 60.0, 'length': 20.0}]
    """
    context = context_of(raw)
    found = {}
    for key, value in raw.items():
        kinds = KINDS_OF_NUMBERS.get(key)
        if kinds is None:
            found[key] = value
        elif isinstance(value, list):
            found[key] = [_table(row, kinds, context) for row in value]
        else:
            found[key] = _table(value, kinds, context)
    return found


def _table(table: Any, kinds: Mapping[str, Kind], context: Mapping[str, Any]) -> Any:
    if not isinstance(table, Mapping):
        return table
    return {
        key: _numbers(value, partial(value_in_file, kind=kinds[key], context=context))
        if key in kinds
        else value
        for key, value in table.items()
    }


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
