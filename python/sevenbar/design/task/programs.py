"""The least greatest of many heights by a sequence of linear programs, each within a reach.

    minimise the greatest height,   with rooms >= 0                                                      (1)

Heights and rooms are made straight by their exact slopes; a step may go as far as the reach, which grows and
shrinks with what the last one kept of its promise. A step from which heights bend away is mended once with
what they were at its end (a second-order correction), so that curved valleys are followed. Where at the end
one height more than there are unknowns is equal to the greatest, the solution is a corner, and the steps
converge as Newton's do.
"""

from __future__ import annotations

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

#: Weight of a missed room relative to the greatest height: above any multiplier, so that none is missed for a
#: lower height.
MISSED = 100.0

#: Least unit of heights: what rounding leaves.
LEAST_UNIT = 1e-13

#: Parts of a promise: below the first a step is not taken, above the second the reach may grow.
KEPT_LITTLE, KEPT_MOST = 0.1, 0.7


@dataclass(frozen=True, eq=False)
class MinimaxValues:
    """Heights (h,) whose greatest is made least, rooms (r,) that must not be negative, and their slopes."""

    height: Floats
    height_slopes: Floats
    room: Floats
    room_slopes: Floats

    @property
    def unit(self) -> float:
        """The greatest height, by which a program is scaled: solvers have absolute tolerances."""
        return max(float(self.height.max()), LEAST_UNIT)

    def merit(self, unit: float) -> float:
        """The greatest height and the worst missed room, relative to a unit."""
        missed = max(float(-self.room.min()), 0.0)
        return (float(self.height.max()) + MISSED * missed) / unit


def lowered(
    heights: Callable[[Floats], MinimaxValues | None],
    start: Floats,
    *,
    worth: float = WORTH,
    mended: Callable[[Floats], Floats] = lambda z: z,
) -> Floats:
    """The unknowns (k,) near a start at which (1) is solved; a gain below `worth` ends it.

    `heights` gives `None` where there is nothing to measure; a step never leads there. `mended` brings the
    end of a step to where rooms are kept that bend away.
    """
    z, reach = start, FIRST_REACH
    now = heights(z)
    if now is None:
        return z
    for _ in range(MOST_STEPS):
        step, promised = _step(now, reach)
        if not promised > worth:
            break
        end = mended(z + step)
        then = heights(end)
        gained = _gained(now, then)
        if then is not None and not gained > KEPT_MOST * promised:
            # heights bend: the same program again with what they really were at its end
            bent, _ = _step(_bent(now, then, end - z), reach)
            there = heights(mended(z + bent))
            if _gained(now, there) > gained:
                step, end, then, gained = bent, mended(z + bent), there, _gained(now, there)
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


def _gained(now: MinimaxValues, then: MinimaxValues | None) -> float:
    """By how much a place is better than another, relative to its unit."""
    return -np.inf if then is None else now.merit(now.unit) - then.merit(now.unit)


def _bent(now: MinimaxValues, then: MinimaxValues, step: Floats) -> MinimaxValues:
    """The heights and rooms of a place, moved so that its slopes lead to those at the end of a step."""
    return replace(
        now, height=then.height - now.height_slopes @ step, room=then.room - now.room_slopes @ step
    )


def _step(now: MinimaxValues, reach: float) -> tuple[Floats, float]:
    """The step (k,) of one program, and the gain it promises relative to the unit."""
    from scipy.optimize import linprog

    unit, count = now.unit, now.height_slopes.shape[1]
    # rows out of reach of every step are left out
    up, down = (reach * np.abs(by).sum(axis=1) for by in (now.height_slopes, now.room_slopes))
    tall, near = ~(now.height + up < (now.height - up).max()), ~(now.room > down)
    matrix = np.block(
        [
            [now.height_slopes[tall] / unit, -np.ones((tall.sum(), 1)), np.zeros((tall.sum(), 1))],
            [-now.room_slopes[near] / unit, np.zeros((near.sum(), 1)), -np.ones((near.sum(), 1))],
        ]
    )
    sides = np.concatenate([-now.height[tall], now.room[near]]) / unit
    if not (np.isfinite(matrix).all() and np.isfinite(sides).all()):
        return np.zeros(count), 0.0
    bounds: list[tuple[float, float | None]] = [(-reach, reach)] * count
    cost = np.append(np.zeros(count), [1.0, MISSED])
    found = linprog(cost, A_ub=matrix, b_ub=sides, bounds=[*bounds, (0.0, None), (0.0, None)], method="highs")
    if found.x is None:
        return np.zeros(count), 0.0
    return found.x[:count], now.merit(unit) - float(cost @ found.x)
