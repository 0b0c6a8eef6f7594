"""Least squares within bounds by Levenberg and Marquardt's method, the unknowns at their bounds held there.

A step s from z solves  `min |r + J s|^2 + l |D s|^2`  over the unknowns that no bound stops, D the greatest
lengths that the columns of J have had; l falls and rises with what the step before kept of its promise. A
step is tried by its residuals alone; slopes are worked out where one was taken.

Near the minimum the sum is flat to rounding and cannot judge a step, while the step, which the gradient
decides, still can: `settled` takes steps as long as they become shorter. So its unknowns are those of zero
gradient to rounding, not those of a sum that no longer falls visibly.

Source: K. Madsen, H. B. Nielsen, O. Tingleff, Methods for non-linear least squares problems, IMM 2004, (3.14)
to (3.16); J. J. More, Lecture Notes in Mathematics 630 (1978), for D; M. Transtrum, J. Sethna, arXiv
1201.5885 (2012), for the second order of a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from sevenbar.arrays import Booleans, Floats

#: The least and the most of l, and the most that one step may change an unknown [units].
SLIGHTEST, MOST, FARTHEST = 1e-22, 1e16, 0.5

#: The part of its promise that a step must keep.
KEPT = 1e-4

#: Steps before their second order counts; the share of a step at which that is found, and the most of it.
STRAIGHT, SHARE, MOST_BENT = 10, 0.1, 0.4

#: A fall of the squares, relative to them, after which it ends; and a step, relative to the unknowns.
FALL, STEP = 1e-15, 1e-15

#: An unknown whose column is shorter, relative to the longest, does nothing; it is rounding.
LEAST = 1e-8

#: A step that is rounding, and the ratio of one to the last above which steps no longer become shorter.
SETTLED, NO_SHORTER = 1e-13, 0.7

#: Squares that are rounding of residuals of unit size.
NOTHING = 1e-31


#: How a search ended: at the minimum; where no step led on, though slopes promised it; the same, since the
#: last one led to where there are no residuals; or after too many evaluations.
End = Literal["settled", "stuck", "closed", "unsettled"]


class Nearest(NamedTuple):
    """The unknowns (k,) of the least sum of squares, how much it is, the end, and in how many evaluations."""

    z: Floats
    cost: float
    end: End
    evaluations: int


class _Damped:
    """Slopes (r, k) with damping, over the unknowns that are free (k,), in units of a scale (free,)."""

    def __init__(self, by: Floats, free: Booleans, scale: Floats, weight: float) -> None:
        self._by, self._free, self._scale = by, free, scale
        damped = np.concatenate([by[:, free] / scale, np.sqrt(weight) * np.eye(len(scale))])
        self._basis, self._triangle = np.linalg.qr(damped)

    def step(self, sides: Floats) -> Floats:
        """The step (k,) by which the residuals change as nearly as may be by sides (r,)."""
        result = np.zeros(len(self._free))
        along = np.linalg.solve(self._triangle, self._basis[: len(sides)].T @ sides)
        result[self._free] = along / self._scale
        return result

    def bent(self, ahead: Floats | None, left: Floats, step: Floats) -> Floats:
        """A step with its second order, which follows a valley that bends; without it where it is large.

        `left` are the residuals where it begins, `ahead` those after `SHARE` of it.
        """
        if ahead is None:
            return step
        bend = self.step(((left - ahead) / SHARE + self._by @ step) / SHARE)
        longest, length = (np.linalg.norm(one[self._free] * self._scale) for one in (step, bend))
        return step + bend if length <= MOST_BENT * longest else step


def nearest_least(
    residuals: Callable[[Floats], Floats | None],
    slopes: Callable[[Floats], Floats | None],
    start: Floats,
    low: Floats | float = -math.inf,
    high: Floats | float = math.inf,
    *,
    evaluations: int,
    first: float,
    enough: float = 0.0,
    shortest: float = STEP,
    nothing: float = NOTHING,
) -> Nearest | None:
    """The nearest least sum of squares within so many `evaluations`; `None` where there is none at the start.

    `residuals` gives residuals (r,) of unknowns that are tried, `slopes` (r, k) those of unknowns that a step
    has led to; either is `None` where there are none: a step never leads there. `first` is the first l. It
    ends, too, where a step promises no more than a part `enough` of the squares, where after one that led
    nowhere the next is no longer than `shortest`, relative to the unknowns, and where the squares are below
    `nothing`.

    >>> points, heights = np.array([0.0, 1.0, 2.0]), np.array([1.0, 2.7, 7.4])
    >>> found = nearest_least(
    ...     lambda x: np.exp(x[0] * points) - heights,
    ...     lambda x: (points * np.exp(x[0] * points))[:, None],
    ...     np.array([0.5]), evaluations=50, first=1e-3, enough=1e-12)
    >>> found.end, round(float(found.z[0]), 6)
    ('settled', 1.000496)
    """
    z = np.clip(start, low, high)
    left, by = residuals(z), slopes(z)
    if left is None or by is None:
        return None
    cost = float(left @ left)
    sizes = np.linalg.norm(by, axis=0)
    weight, growth = first, 2.0
    steps, tried, closed = 0, 1, False
    while tried < evaluations:
        pull = by.T @ left
        free = ~(((z <= low) & (pull > 0)) | ((z >= high) & (pull < 0)))
        if not free.any() or cost < nothing:
            break
        scale = np.maximum(sizes, LEAST * max(float(sizes.max()), LEAST))[free]
        damped = _Damped(by, free, scale, weight)
        step = damped.step(-left)
        step *= min(1.0, FARTHEST / max(float(np.abs(step).max()), 1e-300))
        straight = -np.inf
        if steps >= STRAIGHT:
            straight = cost - float(((left + by @ step) ** 2).sum())
            step = damped.bent(residuals(z + SHARE * step), left, step)
            tried += 1
        steps += 1
        then_z = np.clip(z + step, low, high)
        step = then_z - z
        if np.abs(step).max() <= (shortest if growth > 2 else STEP) * (1 + float(np.abs(z).max())):
            break
        promised = max(cost - float(((left + by @ step) ** 2).sum()), straight)
        if enough and promised <= enough * cost:
            # also where rounding has refused steps
            growth = growth if closed else 2.0
            break
        then = residuals(then_z) if promised > 0 else None
        tried += 1
        gained = -np.inf if then is None else cost - float(then @ then)
        then_by = slopes(then_z) if gained > KEPT * promised else None
        if then is None or then_by is None:
            closed = then is None and promised > 0
            weight *= growth
            growth *= 2
            if weight > MOST:
                break
            continue
        z, left, by = then_z, then, then_by
        sizes = np.maximum(sizes, np.linalg.norm(by, axis=0))
        weight = max(weight * max(1 / 3, 1 - (2 * gained / promised - 1) ** 3), SLIGHTEST)
        growth = 2.0
        if gained <= FALL * cost:
            break
        cost -= gained
    end: End = "settled" if growth == 2.0 else "closed" if closed else "stuck"
    return Nearest(z, cost, "unsettled" if tried >= evaluations else end, tried)


def settled(
    residuals: Callable[[Floats], Floats | None], slopes: Callable[[Floats], Floats], z: Floats
) -> Floats:
    """The unknowns (k,) near those of a minimum at which the gradient is zero to rounding."""
    last = math.inf
    while True:
        left = residuals(z)
        assert left is not None
        step = np.linalg.lstsq(slopes(z), -left, rcond=None)[0]
        length = float(np.linalg.norm(step))
        if length <= SETTLED or length > NO_SHORTER * last or residuals(z + step) is None:
            return z
        z, last = z + step, length
