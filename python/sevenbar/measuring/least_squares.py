"""The least sum of squares by steps of Gauss and Newton within a region of trust.

A step solves the linearised problem, no longer than the region's radius,

    (J^T J + c 1) step = -J^T r,     c >= 0 such that |step| <= radius                                    (1)

by singular values of the triangle that J and r leave. It is taken if the sum falls by a fair part of what (1)
promised; the radius follows. Near the minimum the sum is flat to rounding and cannot judge a step, while the
step, which the gradient decides, still can: it is taken as long as steps become shorter. So the parameters
are those of zero gradient to rounding, not those of a sum that no longer falls visibly.

Source: More, "The Levenberg-Marquardt algorithm", Lecture Notes in Mathematics 630 (1978).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats

#: The first radius, of parameters relative to the size, or in radians.
RADIUS = 0.1

#: Fair, good and least part of the promised fall.
FAIR, GOOD, ANY = 0.25, 0.75, 1e-4

#: A promised fall, relative to the sum, below which rounding hides it.
FLAT = 1e-10

#: Error of a parameter [share of the size, rad] that is rounding.
SETTLED = 1e-13

#: Ratio of one step's length to the last above which steps no longer become shorter.
NO_SHORTER = 0.7

#: Share of the sum that is rounding below which there is nothing to gain: the residual to a ten-thousandth.
NOTHING = 1e-8

#: A radius at which the way on is closed.
CLOSED = 1e-8

#: Where there is nothing more to gain, which way it ended: at the minimum, where the loop no longer closes,
#: or after too many steps.
End = Literal["settled", "closed", "unsettled"]


@dataclass(frozen=True)
class Minimum:
    """Parameters (k,), how the search for them ended, and in how many evaluations."""

    x: Floats
    end: End
    evaluations: int


def least_squares(
    residual: Callable[[Floats], Floats | None],
    jacobian: Callable[[Floats], Floats],
    x: Floats,
    *,
    most: int,
    enough: float = 0.0,
    exact: float = 0.0,
) -> Minimum:
    """The parameters near x (k,) at which a residual (n,) has the least sum of squares.

    `residual` gives `None` where it does not exist, and no step goes there; `jacobian` (n, k) is needed
    only where it does. `most` evaluations; the search also ends where no more than a share `enough` of the
    sum is still to be gained. Below the sum `exact` the residual is rounding: one that falls no more is
    least.

    >>> points, heights = np.array([0.0, 1.0, 2.0]), np.array([1.0, 2.7, 7.4])
    >>> found = least_squares(
    ...     lambda x: np.exp(x[0] * points) - heights,
    ...     lambda x: (points * np.exp(x[0] * points))[:, None],
    ...     np.array([0.5]), most=50)
    >>> found.end, round(float(found.x[0]), 6)
    ('settled', 1.000496)
    """
    here = residual(x)
    if here is None:
        return Minimum(x, "closed", 1)
    evaluations, radius, last = 1, RADIUS, math.inf
    while evaluations < most:
        cost = float(here @ here)
        step_of = _Steps(jacobian(x), here)
        while True:
            step, promised = step_of.within(radius)
            length = float(np.linalg.norm(step))
            if promised <= enough * cost or cost <= NOTHING * exact:
                return Minimum(x, "settled", evaluations)
            flat = promised <= FLAT * cost or length <= SETTLED
            if flat and (length <= SETTLED or length > NO_SHORTER * last):
                return Minimum(x, "settled", evaluations)
            trial = residual(x + step)
            evaluations += 1
            if trial is not None:
                fall = cost - float(trial @ trial)
                share = fall / promised if promised > 0 else 0.0
                if flat or share > ANY:
                    break
            # the way is closed, or the promise was not kept
            radius = FAIR * length
            if radius <= CLOSED or evaluations >= most:
                least: End = "settled" if cost <= exact else "unsettled"
                return Minimum(x, "closed" if trial is None else least, evaluations)
        x, here = x + step, trial
        if not flat:
            if share < FAIR:
                radius = FAIR * length
            elif share > GOOD and length > 0.99 * radius:
                radius = 2.0 * length
        elif length * (length / last) <= SETTLED:
            # steps fall by this ratio, so what is left is rounding
            return Minimum(x, "settled", evaluations)
        last = length
    return Minimum(x, "unsettled", evaluations)


class _Steps:
    """The steps of (1) at one place, for any radius."""

    def __init__(self, jacobian: Floats, residual: Floats) -> None:
        count = jacobian.shape[1]
        triangle: Floats = np.asarray(np.linalg.qr(np.column_stack([jacobian, residual]), mode="r"))
        left, self.values, rows = np.linalg.svd(triangle[:, :count], full_matrices=False)
        self.along, self.columns = left.T @ triangle[:, count], rows.T

    def within(self, radius: float) -> tuple[Floats, float]:
        """The step, and the fall of the sum that the linearised problem promises."""
        values, along = self.values, self.along
        safe = np.maximum(values, np.finfo(float).tiny)
        parts = -along / safe
        if np.linalg.norm(parts) > radius:
            parts = self._shortened(radius)
        left = along + values * parts
        return self.columns @ parts, float(along @ along - left @ left)

    def _shortened(self, radius: float) -> Floats:
        """The step of length `radius`, by Newton's method on 1/|step|, which is nearly straight in c."""
        squares, pull = self.values**2, self.values * self.along
        c = 0.0 if squares.min(initial=1.0) > 0 else 1e-12 * float(squares.max(initial=1.0))
        parts: Floats = -pull / np.maximum(squares + c, np.finfo(float).tiny)
        for _ in range(50):
            length = float(np.linalg.norm(parts))
            if abs(length - radius) <= 1e-3 * radius:
                break
            slope = -float(parts @ (parts / (squares + c))) / length
            c = max(c + (1.0 - length / radius) * length / slope, 0.5 * c)
            parts = -pull / (squares + c)
        return parts
