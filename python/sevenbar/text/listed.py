"""Columns as callers have them, as lists, and what a result has by its own names."""

from __future__ import annotations

from typing import Any


def listed(values: Any) -> Any:
    """A column of a data frame, an array or a tuple as a list; others as they are."""
    for way in ("tolist", "to_list"):
        if hasattr(values, way):
            return getattr(values, way)()
    return list(values) if isinstance(values, tuple) else values


def named(result: object, *keys: str) -> dict[str, Any]:
    """Attributes of a result by their names, arrays and tuples as lists.

    >>> named(1 + 2j, "real", "imag")
    {'real': 1.0, 'imag': 2.0}
    """
    return {key: listed(getattr(result, key)) for key in keys}
