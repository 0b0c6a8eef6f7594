"""Starts of a function's search: RSSRs by the thousand in closed form, the most promising of them chosen.

Exact precision points come in closed form (`precision`); for a whole range designs of least linear closure
error for zeros of a Sobol sequence, and plain Sobol designs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.closure import outputs, transmissions
from sevenbar.design.limits import INPUT_TURNS, Limits
from sevenbar.design.synthesis.function.precision import designs_of, reflected, system, through
from sevenbar.design.wish import Wish

#: Designs of the global search: of each kind.
SEARCHED = 4096

#: Readings, at least, at which the closure error of a linear start is least.
LINEAR = 20

#: Greatest error [rad] at precision points with which a start is on one branch.
ON_BRANCH = 1e-6

#: Two starts are one where no unknown differs by more [parts of L3, rad].
START_APART = 0.15

#: Readings between pairs at which the input must move, too.
BETWEEN = 41


@dataclass(frozen=True, eq=False)
class Start:
    """A design (6,), the zeros of its dials (2,) [rad], its branch."""

    row: Floats
    zeros: Floats
    branch: int


def starts(wish: Wish, seed: int) -> tuple[Floats, Floats]:
    """Designs (n, 6), L3 = 1, and zeros (n, 2) from which fits begin: exact ones, or of a global search."""
    from scipy.stats import qmc

    if wish.exact:
        return through(wish.point_input, wish.point_output, zeros=wish.zeros, samples=4 * SEARCHED, seed=seed)
    draws = qmc.Sobol(7, seed=seed).random(SEARCHED)
    # of least closure error for given zeros: (1) of `precision` is linear
    zeros = draws[:, :2] * math.pi if wish.zeros is None else np.tile(wish.zeros, (1, 1))
    few = slice(None, None, max(wish.input.size // LINEAR, 1))
    sides, right = system(wish.input[few] + zeros[:, :1], wish.output[few] + zeros[:, 1:])
    linear = designs_of(np.einsum("mij,mj->mi", np.linalg.pinv(sides), right), zeros)
    # and any at all, the output's zero where the mean error is none
    rows = np.ones((SEARCHED, 6))
    rows[:, [0, 1, 5]] = 5.0 * draws[:, :3] - 2.5
    rows[:, [2, 3]] = 6.0 ** (2 * draws[:, 3:5] - 1)
    first = draws[:, 5] * math.tau if wish.zeros is None else np.full(SEARCHED, wish.zeros[0])
    branch = (draws[:, 6] < 0.5).astype(int)
    angles = np.where(
        branch[:, None],
        outputs(rows, first[:, None] + wish.input, 1),
        outputs(rows, first[:, None] + wish.input, 0),
    )
    good = np.isfinite(angles).all(axis=1)
    off = np.unwrap(angles[good] - wish.output, axis=1).mean(axis=1)
    second = off if wish.zeros is None else np.full(len(off), wish.zeros[1])
    both = np.concatenate([linear[0], rows[good]])
    pairs = np.concatenate([linear[1], np.column_stack([first[good], second])])
    return (both, pairs) if wish.zeros is not None else reflected(both, pairs)


def chosen(wish: Wish, limits: Limits, rows: Floats, zeros: Floats, most: int) -> list[Start]:
    """The most promising starts that differ: little error, limits nearly kept, all points on one branch."""
    used = wish.input
    if wish.function is None:
        used = np.linspace(wish.input[0], wish.input[-1], BETWEEN)
    square = transmissions(rows, zeros[:, :1] + used).min(axis=1)
    late = math.sin(limits.transmission_lowest) - np.sqrt(np.maximum(square, 0.0))
    ratio = np.abs(rows).max(axis=1) / rows[:, 2:5].min(axis=1)
    missed = np.maximum(late, 0.0) + 0.1 * np.maximum(np.log(ratio / limits.ratio), 0.0)
    if limits.motion_type in INPUT_TURNS:
        turn = np.linspace(0.0, math.tau, 36, endpoint=False)
        missed = missed + np.maximum(-transmissions(rows, turn).min(axis=1), 0.0)
    inputs = np.concatenate([wish.input, wish.point_input])
    wanted = np.concatenate([wish.output, wish.point_output])
    scores: list[Floats] = []
    result: list[Start] = []
    for branch in (0, 1):
        off = short_way(outputs(rows, zeros[:, :1] + inputs, branch) - zeros[:, 1:] - wanted)
        count = wish.input.size
        at_points = np.abs(off[:, count:]).max(axis=1, initial=0.0)
        score = np.sqrt((off[:, :count] ** 2).mean(axis=1)) + missed
        if wish.pairs:
            score = score + 1.0 - square
        good = np.isfinite(off).all(axis=1) & (square > 0) & (at_points < ON_BRANCH)
        scores.append(score[good])
        result += [Start(row, own, branch) for row, own in zip(rows[good], zeros[good], strict=True)]
    places = np.array([[*np.arctan(one.row), *np.cos(one.zeros)] for one in result])
    selected: list[int] = []
    for i in np.argsort(np.concatenate(scores), kind="stable"):
        if len(selected) < most and (np.abs(places[selected] - places[i]).max(axis=1) > START_APART).all():
            selected.append(int(i))
    return [result[i] for i in selected]
