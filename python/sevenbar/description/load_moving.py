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
    change: dict[str, Callable[[Mapping[str, Any]], dict[str, Any]]] = {
        "body": lambda body: _body(body, put, rotation),
        "load": lambda load: _load(load, put, rotation),
        "spring": lambda spring: _placed(spring, "at", put),
    }
    return {
        head: [own(table) for table in description[head]]
        for head, own in change.items()
        if head in description
    }


def _placed(table: Mapping[str, Any], key: str, put: Callable[[Floats], Floats]) -> dict[str, Any]:
    if key not in table:
        return dict(table)
    return {**table, key: put(np.array(table[key], dtype=np.float64)).tolist()}


def _body(body: Mapping[str, Any], put: Callable[[Floats], Floats], rotation: Floats) -> dict[str, Any]:
    found = _placed(body, "centre", put)
    if "inertia" in body:
        found["inertia"] = entries_of(rotation @ tensor_of(body["inertia"]) @ rotation.T)
    return found


def _load(load: Mapping[str, Any], put: Callable[[Floats], Floats], rotation: Floats) -> dict[str, Any]:
    found = _placed(load, "at", put)
    for key in ("force", "torque") if load.get("axes") == "link" else ():
        if key in load:
            found[key] = (rotation @ np.array(load[key], dtype=np.float64)).tolist()
    return found
