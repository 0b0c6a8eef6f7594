"""Dyads of two skew lines, once their directions are known: their places follow from linear equations.

Let a be the fixed direction, l_j that of the body's line at pose j, c = a . l_j, p and q_j = R_j q + d_j
places on the two lines. Their distance and the places of its feet, along the fixed and along the moving
line, are

    (q_j - p) . (a x l_j),    (q_j - p) . (a - c l_j),    (q_j - p) . (l_j - c a)                         (1)

up to factors that do not change with j, as c does not. A C joint lets its foot slide, an R joint holds it.
So each further pose is one equation for a dyad CC, two for RC (R at the ground), three for RR, linear in p
and q, which have two coordinates each, across their lines.

Source: docs/theory_design.md, (33) and (34).
"""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.exact.dyads import Dyad, Line
from sevenbar.design.exact.given import Displacements
from sevenbar.kinematics.loop.rigid import cross, pose, turns_about, unit

#: Singular value, relative to the greatest, below which equations for the places depend on each other.
RANK = 1e-11

#: Closure error of the equations, relative to the task's lengths, above which they contradict each other.
CONTRADICT = 1e-8


def facing(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Two axes at length 1, of the second and its opposite the one that is nearer to the first."""
    a, b = unit(a), unit(b)
    return a, b if a @ b >= 0 else -b


def link_motions(a: Floats, b: Floats, moved: Floats) -> Floats:
    """The rotations (n, 3, 3) about a that bring the direction b to `moved` (n, 3), at the same angle."""
    normal, normals = cross(a, b), np.cross(a, moved)
    return turns_about(a, np.arctan2(np.cross(normal, normals) @ a, normals @ normal))


def places(
    a: Floats, b: Floats, kind: str, task: Displacements, free: Floats | None = None
) -> tuple[Floats, Floats] | None:
    """The places p and q (3,) [relative to the reach] of a dyad of directions a and b; `None` without one.

    `free` (k,) chooses among the dyads of an open system, as steps along its null vectors. Without it
    infinitely many dyads are `None`, too.
    """
    turns, shifts = task.turns, task.shifts
    moved = turns @ b
    cosine = float(a @ b)
    across = [(np.cross(a, moved), cross(a, b))]
    if kind[0] == "R":
        across.append((a - cosine * moved, a - cosine * b))
    if kind[1] == "R":
        across.append((moved - cosine * a, b - cosine * a))
    rows = [np.concatenate([a, np.zeros(3)])[None], np.concatenate([np.zeros(3), b])[None]]
    right = [np.zeros(2)]
    for then, now in across:
        rows.append(np.hstack([now - then, np.einsum("nji,nj->ni", turns, then) - now]))
        right.append(-np.einsum("ni,ni->n", shifts, then))
    sides, values = np.concatenate(rows), np.concatenate(right)
    left, sizes, base = np.linalg.svd(sides)
    rank = int((sizes > RANK * sizes[0]).sum())
    if free is None and rank < 6:
        return None
    solution = base[:rank].T @ ((left.T @ values)[:rank] / sizes[:rank])
    if np.abs(sides @ solution - values).max() > CONTRADICT * max(1.0, float(np.abs(solution).max())):
        return None
    if free is not None:
        solution = solution + base[rank:].T @ free[: 6 - rank]
    return solution[:3], solution[3:]


def found_dyad(
    a: Floats, b: Floats, kind: str, task: Displacements, free: Floats | None = None
) -> Dyad | None:
    """The dyad of two directions, with `places` for the rest; `None` without one."""
    a, b = facing(a, b)
    both = places(a, b, kind, task, free)
    return None if both is None else line_dyad(a, b, *both, kind, task)


def line_dyad(a: Floats, b: Floats, p: Floats, q: Floats, kind: str, task: Displacements) -> Dyad:
    """The dyad of two lines through p and q [relative to the reach], drawn at the feet of their distance."""
    cosine, body = float(a @ b), task.motions
    square = 1 - cosine**2
    p, q = p * task.reach, q * task.reach
    moved = np.einsum("nij,j->ni", body[:, :3, :3], b)
    ways = np.einsum("nij,j->ni", body[:, :3, :3], q) + body[:, :3, 3] - p
    feet = ((a - cosine * moved) * ways).sum(axis=1) / square
    at = p + feet[0] * a
    other = q - ((b - cosine * a) @ ways[0]) / square * b
    turns = link_motions(a, b, moved)
    slides = (feet - feet[0]) * (kind[0] == "C")
    link = pose(turns, at - turns @ at + slides[:, None] * a)
    return Dyad(Line(kind[0], at, a), Line(kind[1], other, b), link)
