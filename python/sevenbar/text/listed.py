"""Columns as callers have them, as lists."""

from __future__ import annotations

from typing import Any


def listed(values: Any) -> Any:
    """A column of a data frame, an array or a tuple as a list; others as they are."""
    for way in ("tolist", "to_list"):
        if hasattr(values, way):
            return getattr(values, way)()
    return list(values) if isinstance(values, tuple) else values
