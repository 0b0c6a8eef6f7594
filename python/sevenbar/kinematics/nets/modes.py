"""All modes of a net at one value of its input, block by block, or searched for.

Source: docs/theory_nets.md, (7) and (10) to (22).
"""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.nets.parts import parts_of
from sevenbar.kinematics.nets.tree import Tree

#: Poses nearer than this [rad, or relative to the size] are one; where modes meet a search ends less near.
NEAR = 1e-5
NEAR_SINGULAR = 5e-5


def net_modes(linkage: Loop, tree: Tree, column: int, value: float) -> Modes:
    """Every assembly mode at one value of a column [rad, or length] of a net whose blocks have a solver.

    The joint of the column begins the tree.

    Of any other net those that are found from many places, and these besides where some are not certain.
    """
    parts = parts_of(linkage, tree)
    if parts is None:
        return _searched(linkage, tree, column, value)
    scale = 1.0 if linkage.turns(column) else linkage.size
    q, residual, on_curve, word = tree.core.modes(parts, tree.columns[tree.first[0]][0], value / scale)
    residual = residual * linkage.size
    curve = q[on_curve][0] if on_curve.any() else None
    q, residual = q[~on_curve], residual[~on_curve]
    if word == "searched":
        more = _searched(linkage, tree, column, value)
        curve = more.on_curve if curve is None else curve
        place = _apart(linkage, np.vstack([q, more.q]))
        q, residual = np.vstack([q, more.q])[place], np.append(residual, more.residual)[place]
    elif word == "closed-form" and curve is not None:
        word = "algebraic"
    rank = _ranked(q)
    return Modes(q[rank], residual[rank], word, linkage.columns, value, on_curve=curve)


def _searched(linkage: Loop, tree: Tree, column: int, value: float) -> Modes:
    q, residual, isolated, on_curve = tree.followed(lambda core: core.searched_modes(column, value))
    meeting = np.flatnonzero(~isolated & ~on_curve)
    meeting = meeting[_apart(linkage, q[meeting], NEAR_SINGULAR)]
    curve = q[on_curve][0] if on_curve.any() else None
    place = np.append(np.flatnonzero(isolated), meeting)
    rank = place[_ranked(q[place])]
    residual = residual[rank] * linkage.size
    return Modes(q[rank], residual, "searched", linkage.columns, value, on_curve=curve)


def _apart(linkage: Loop, q: Floats, near: float = NEAR) -> Integers:
    """Those of modes (m, columns) that are not near one before them."""
    turning, unit = linkage.turning, np.where(linkage.turning, 1.0, linkage.size)
    result: list[int] = []
    for place, one in enumerate(q):
        off = (q[result] - one) / unit
        off = np.where(turning, (off + np.pi) % (2 * np.pi) - np.pi, off)
        if not (np.abs(off) < near).all(axis=1).any():
            result.append(place)
    return np.array(result, dtype=np.int64)


def _ranked(q: Floats) -> Integers:
    """The order of modes (m, columns) by their joint values."""
    order: Integers = np.lexsort(q.round(9).T[::-1])
    return order
