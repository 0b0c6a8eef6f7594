"""The least greatest of many heights by a sequence of linear programs, each within a reach.

    minimise the greatest height,   with slacks >= 0                                                      (1)

Heights and slacks are made straight by their exact slopes; a step may go as far as the reach, which grows and
shrinks with what the last one kept of its promise. A step from which heights bend away is mended once with
what they were at its end (a second-order correction), so that curved valleys are followed. Where at the end
one height more than there are unknowns is equal to the greatest, the solution is a corner, and the steps
converge as Newton's do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats

#: Most programs.
MOST_STEPS = 60

#: Reach of a step [units of the unknowns]: at first, at most, and where it gives up.
FIRST_REACH, MOST_REACH, LEAST_REACH = 0.1, 1.0, 1e-9

#: Gain of a step, relative to the greatest height, below which it is the last.
WORTH = 1e-5

#: Weight of a missed slack relative to the greatest height, at first and at most, and by how much it rises
#: where a slack would be missed for a lower height: its multiplier is greater.
MISSED, MOST_MISSED, RISE = 100.0, 1e8, 10.0

#: A slack missed by more than the least within the reach, relative to what is missed, is missed for a height.
TRADED = 1e-6

#: Least unit of heights: what rounding leaves.
LEAST_UNIT = 1e-13

#: Parts of a promise: below the first a step is not taken, above the second the reach may grow.
KEPT_LITTLE, KEPT_MOST = 0.1, 0.7


@dataclass(frozen=True, eq=False)
class MinimaxValues:
    """Heights (h,) whose greatest is made least, slacks (r,) that must not be negative, and their slopes."""

    height: Floats
    height_slopes: Floats
    slack: Floats
    slack_slopes: Floats

    @property
    def unit(self) -> float:
        """The greatest height or missed slack, which scales a program: solvers have absolute tolerances."""
        return max(float(self.height.max()), self.missed, LEAST_UNIT)

    @property
    def missed(self) -> float:
        """By how much the worst slack is missed."""
        return max(float(-self.slack.min(initial=0.0)), 0.0)

    def merit(self, unit: float, weight: float) -> float:
        """The greatest height and the worst missed slack by its weight, relative to a unit."""
        return (float(self.height.max()) + weight * self.missed) / unit


def lowered(
    heights: Callable[[Floats], MinimaxValues | None],
    start: Floats,
    *,
    worth: float = WORTH,
    mended: Callable[[Floats], Floats] = lambda z: z,
) -> Floats:
    """The unknowns (k,) near a start at which (1) is solved; a gain below `worth` ends it.

    `heights` gives `None` where there is nothing to measure; a step never leads there. `mended` brings the
    end of a step to where slacks are kept that bend away.
    """
    z, reach, weight = start, FIRST_REACH, MISSED
    now = heights(z)
    if now is None:
        return z
    for _ in range(MOST_STEPS):
        weight, program = _weighed(now, reach, weight)
        step, promised = program[0], _promised(now, program, weight)
        if not promised > worth:
            break
        end = mended(z + step)
        then = heights(end)
        gained = _gained(now, then, weight)
        if then is not None and not gained > KEPT_MOST * promised:
            # heights bend: the same program again with what they really were at its end
            bent = _program(_bent(now, then, end - z), reach, weight)[0]
            bent_end = mended(z + bent)
            there = heights(bent_end)
            if _gained(now, there, weight) > gained:
                step, end, then, gained = bent, bent_end, there, _gained(now, there, weight)
        longest = float(np.abs(step).max())
        if then is None or not gained > KEPT_LITTLE * promised:
            reach = min(longest, reach) / 4
            if reach < LEAST_REACH:
                break
            continue
        z, now = end, then
        if gained < worth:
            break
        if gained > KEPT_MOST * promised and longest > 0.9 * reach:
            reach = min(2 * reach, MOST_REACH)
    return z


def _gained(now: MinimaxValues, then: MinimaxValues | None, weight: float) -> float:
    """By how much a place is better than another, relative to its unit."""
    return -np.inf if then is None else now.merit(now.unit, weight) - then.merit(now.unit, weight)


def _bent(now: MinimaxValues, then: MinimaxValues, step: Floats) -> MinimaxValues:
    """The heights and slacks of a place, moved so that its slopes lead to those at the end of a step."""
    return replace(
        now, height=then.height - now.height_slopes @ step, slack=then.slack - now.slack_slopes @ step
    )


#: The step (k,) of a program, its greatest height, and the slack it misses.
_Program = tuple[Floats, float, float]


def _weighed(now: MinimaxValues, reach: float, weight: float) -> tuple[float, _Program]:
    """The weight of a missed slack, raised until a step misses none that another within the reach keeps.

    With the program of that weight.
    """
    program = _program(now, reach, weight)
    if program[2] <= TRADED * now.missed:
        return weight, program
    fewest = _program(now, reach, math.inf)[2]
    while program[2] > fewest + TRADED * now.missed and weight < MOST_MISSED:
        weight *= RISE
        program = _program(now, reach, weight)
    return weight, program


def _promised(now: MinimaxValues, program: _Program, weight: float) -> float:
    """The gain that a program promises, relative to the unit."""
    _, height, missed = program
    return now.merit(now.unit, weight) - (height + weight * missed) / now.unit


def _program(now: MinimaxValues, reach: float, weight: float) -> _Program:
    """The step (k,) of least greatest height and missed slack by its weight, or of slack alone; and both."""
    from scipy.optimize import linprog

    unit, count = now.unit, now.height_slopes.shape[1]
    nothing = np.zeros(count), float(now.height.max()), now.missed
    # rows out of reach of every step are left out
    up, down = (reach * np.abs(by).sum(axis=1) for by in (now.height_slopes, now.slack_slopes))
    tall, near = ~(now.height + up < (now.height - up).max()), ~(now.slack > down)
    matrix = np.block(
        [
            [now.height_slopes[tall] / unit, -np.ones((tall.sum(), 1)), np.zeros((tall.sum(), 1))],
            [-now.slack_slopes[near] / unit, np.zeros((near.sum(), 1)), -np.ones((near.sum(), 1))],
        ]
    )
    sides = np.concatenate([-now.height[tall], now.slack[near]]) / unit
    if not (np.isfinite(matrix).all() and np.isfinite(sides).all()):
        return nothing
    bounds: list[tuple[float, float | None]] = [(-reach, reach)] * count
    # the heaviest counts 1: solvers have absolute tolerances
    ends = [0.0, 1.0] if math.isinf(weight) else [1.0 / max(weight, 1.0), weight / max(weight, 1.0)]
    cost = np.append(np.zeros(count), ends)
    result = linprog(
        cost, A_ub=matrix, b_ub=sides, bounds=[*bounds, (0.0, None), (0.0, None)], method="highs"
    )
    if result.x is None:
        return nothing
    return result.x[:count], float(result.x[-2] * unit), float(result.x[-1] * unit)
