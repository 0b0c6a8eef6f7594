"""The path of a circuit by its own length, from rows that cover it whatever its own rows are."""

from __future__ import annotations

import math
from weakref import WeakKeyDictionary

import numpy as np

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.paths.circuit_path import ENOUGH_ROWS, CircuitPath, NotFollowedError, path_of

#: Rows of a circuit beyond which fewer are computed anew: a path wants no more.
MORE_THAN_ENOUGH = 100 * ENOUGH_ROWS

#: A path is followed once and lives as long as its circuit.
_PATHS: WeakKeyDictionary[Circuit, CircuitPath] = WeakKeyDictionary()


def covered_path(linkage: Solvable, circuit: Circuit, numbers: Numbers | None = None) -> CircuitPath:
    """The path of a circuit; raises `RequestError` where it cannot be followed.

    `numbers` are those of the linkage, worked out here where none are given.
    """
    found = _PATHS.get(circuit)
    if found is None:
        own = Numbers(linkage) if numbers is None else numbers
        found = _PATHS[circuit] = path_of(own, _covering(linkage, circuit))
    return found


def _covering(linkage: Solvable, circuit: Circuit) -> Circuit:
    """A circuit with rows all along it."""
    rows = circuit.tally.rows
    if not math.isnan(circuit.speed) and ENOUGH_ROWS <= rows <= MORE_THAN_ENOUGH:
        return circuit.fleeting()
    motion = linkage.motion(2 * ENOUGH_ROWS, input=circuit.columns[circuit.input_column])
    if rows > MORE_THAN_ENOUGH:
        # as many samples or few, the circuits are the same
        return motion.circuits[circuit.index]
    known = circuit.q[np.isfinite(circuit.q).all(axis=1)]
    if not len(known):
        raise NotFollowedError("circuit: none of its rows has a pose")
    best, nearest = None, math.inf
    turns = np.array([kind == "turn" for kind in linkage.column_kinds])
    for each in motion.circuits:
        off = each.q[:, None] - known[None, :: max(1, len(known) // 8)]
        off[..., turns] -= math.tau * np.round(off[..., turns] / math.tau)
        off = np.abs(off / np.where(turns, 1.0, circuit.size)).max(axis=2)
        farthest = float(np.nanmax(np.nanmin(np.where(np.isfinite(off), off, np.inf), axis=0)))
        if farthest < nearest:
            best, nearest = each, farthest
    assert best is not None
    return best
