"""The path of a circuit from rows that cover it, whatever its own are; exact poses, rows, curves along it."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.curves.along import Along
from sevenbar.curves.stationary import nodes_between, series_through
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.loop.rigid import turns_about
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.paths.circuit_path import ENOUGH_ROWS, TERMS, CircuitPath, NotFollowedError, path_of

#: Rows of a circuit beyond which fewer are computed anew: a path wants no more.
MORE_THAN_ENOUGH = 100 * ENOUGH_ROWS


@once_for(1)
def covered_path(linkage: Solvable, circuit: Circuit, numbers: Numbers | None = None) -> CircuitPath:
    """The path of a circuit; raises `RequestError` where it cannot be followed.

    `numbers` are those of the linkage, worked out here where none are given.
    """
    return path_of(Numbers(linkage) if numbers is None else numbers, _covering(linkage, circuit))


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
    best, nearest, turns = None, math.inf, linkage.turning
    for each in motion.circuits:
        off = each.q[:, None] - known[None, :: max(1, len(known) // 8)]
        off[..., turns] -= math.tau * np.round(off[..., turns] / math.tau)
        off = np.abs(off / np.where(turns, 1.0, circuit.size)).max(axis=2)
        farthest = float(np.nanmax(np.nanmin(np.where(np.isfinite(off), off, np.inf), axis=0)))
        if farthest < nearest:
            best, nearest = each, farthest
    assert best is not None
    return best


def grid_of(path: CircuitPath) -> tuple[Floats, Integers]:
    """Chebyshev's nodes on the pieces of a path (m, terms), and the piece of each (m * terms,)."""
    edges = path.poses.edges
    return nodes_between(edges[:-1], edges[1:], TERMS), np.repeat(np.arange(len(edges) - 1), TERMS)


def closed_on(path: CircuitPath, numbers: Numbers, pieces: Integers, s: Floats) -> Floats:
    """Poses of the word (j, columns) at places (j,) on given pieces of a path."""
    poses = path.poses.on(pieces, s)
    spun = {c for joint in numbers.spun for step in numbers.word.freedoms[joint] for c in step.columns}
    # the turns of balls that turn freely may be no polynomials
    if not any(c not in spun for c in np.flatnonzero(numbers.is_ball)):
        return poses
    for driver in np.unique(path.drivers[pieces]):
        mine = np.flatnonzero(path.drivers[pieces] == driver)
        own = poses[mine]
        closed = numbers.driven(int(driver)).closed(own[:, driver], own)
        whole = np.isfinite(closed).all(axis=1)
        poses[mine[whole]] = closed[whole]
    return poses


def rows_of(numbers: Numbers, poses: Floats) -> Floats:
    """Poses of the word (n, columns) as rows of an analysis; see `Numbers.poses`, whose inverse this is."""
    rows = poses.copy()
    values = numbers.values(numbers.nominal)
    for joint in numbers.spun:
        a, b, _ = (axis.pose(values)[:3, 2] for axis in numbers.word.axes_of_spun(joint))
        column = numbers.word.freedoms[joint][0].columns[0]
        turn = turns_about(a, poses[:, column]) @ turns_about(b, poses[:, column + 1])
        middle = -np.arcsin(np.clip(turn[:, 2, 0], -1.0, 1.0))
        first = np.arctan2(turn[:, 1, 0], turn[:, 0, 0])
        rows[:, column : column + 3] = np.stack(
            [first, middle, np.arctan2(turn[:, 2, 1], turn[:, 2, 2])], axis=1
        )
    return rows


def rows_on(path: CircuitPath, numbers: Numbers) -> tuple[Floats, Floats]:
    """The nodes of `grid_of` (m, terms), and the rows of an analysis there (m * terms, columns)."""
    grid, pieces = grid_of(path)
    return grid, rows_of(numbers, closed_on(path, numbers, pieces, grid.ravel()))


def curve_on(path: CircuitPath, values: Floats) -> Along:
    """Quantities along a path by their values (m * terms, k) at these nodes."""
    return Along(path.poses.edges, series_through(values.reshape(len(path.drivers), TERMS, -1)))
