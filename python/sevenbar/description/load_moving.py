"""Bodies, loads and springs of a drawn linkage that is moved as a whole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.bodies import entries_of, tensor_of


def moved_loads(
    description: Mapping[str, Any], put: Callable[[Floats], Floats], rotation: Floats
) -> dict[str, list[dict[str, Any]]]:
    """The tables [[body]], [[load]] and [[spring]] of a description with numbers, moved.

    `put` moves places (.., 3), `rotation` (3, 3) directions. Forces along the axes of the ground stay, as
    gravity does; those along the axes of their link turn with it.
    """
    return {
        head: [_moved(table, put, rotation) for table in description[head]]
        for head in ("body", "load", "spring")
        if head in description
    }


def _moved(table: Mapping[str, Any], put: Callable[[Floats], Floats], rotation: Floats) -> dict[str, Any]:
    """A table with its places, its tensor and what lies along the axes of its link."""
    result = dict(table)
    for key in table.keys() & {"centre", "at"}:
        result[key] = put(np.array(table[key], dtype=np.float64)).tolist()
    # that across the plane turns with it
    if isinstance(table.get("inertia"), (list, tuple)):
        result["inertia"] = entries_of(rotation @ tensor_of(table["inertia"]) @ rotation.T)
    for key in table.keys() & {"force", "torque"} if table.get("axes") == "link" else ():
        result[key] = (rotation @ np.array(table[key], dtype=np.float64)).tolist()
    return result
