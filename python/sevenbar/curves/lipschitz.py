"""Lowest values and crossings of a quantity of which only a bound of the slope is known.

Between two places a and b, with |f'| <= B there,

    f >= (f(a) + f(b) - B (b - a)) / 2                                                                    (15)

so a stretch on which this is above the lowest value found is done, and any other is halved. A quantity that
rests near the value that is wanted is left on many stretches; the search ends where these are more than
`MOST`, and says by how much it may be lower.

Source: docs/theory_measures.md, (15).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sevenbar.arrays import Floats

#: Most stretches at a time; with more the quantity rests near the value that is wanted.
MOST = 2**14

#: Most halvings of a stretch.
HALVINGS = 40

#: Halvings of a bracket, from any length to rounding.
TO_ROUNDING = 60

Function = Callable[[Floats], Floats]


def lowest(
    function: Function, edges: Floats, bounds: Floats, small: float, *, floor: float
) -> tuple[float, float, float]:
    """Where a quantity is lowest between `edges` (m + 1,), its value, and by how much it may be lower.

    That is `small` at most, but where the search ended at `MOST`. Slopes are within `bounds` (m,); nowhere it
    is below `floor`. Of equal values the first place counts.
    """
    values = function(edges)
    stretches = np.stack([edges[:-1], edges[1:], bounds, values[:-1], values[1:]])
    place, best = edges[int(values.argmin())], float(values.min())
    missed = 0.0
    for _ in range(HALVINGS):
        a, b, slope, low, high = stretches
        reach = np.maximum((low + high - slope * (b - a)) / 2, floor)
        left = reach < best - small
        missed = max(0.0, best - float(reach.min(initial=math.inf)))
        if not left.any() or left.sum() > MOST:
            break
        stretches = _halved(function, stretches[:, left])
        middle, _, _, between, _ = stretches[:, left.sum() :]
        if between.min() < best:
            place, best = middle[int(between.argmin())], float(between.min())
    return float(place), best, missed


def crossings(function: Function, edges: Floats, bounds: Floats, small: float) -> Floats:
    """Places (j,) at which a quantity passes through zero, rising or falling; slopes are within `bounds`.

    A touch from one side, and two crossings between which it reaches less than `small`, are none, or two next
    to each other.
    """
    values = function(edges)
    result: list[Floats] = []
    stretches = np.stack([edges[:-1], edges[1:], bounds, values[:-1], values[1:]])
    for _ in range(HALVINGS):
        a, b, slope, low, high = stretches
        passes = (low > 0) != (high > 0)
        result += [np.column_stack([a[passes], b[passes]])]
        near = (np.abs(low) + np.abs(high) - slope * (b - a)) / 2 < -small
        left = near & ~passes
        if not left.any() or left.sum() > MOST:
            break
        stretches = _halved(function, stretches[:, left])
    brackets = np.concatenate(result)
    if not len(brackets):
        return np.empty(0)
    start, end = brackets.T
    above = function(start) > 0
    for _ in range(TO_ROUNDING):
        middle = (start + end) / 2
        same = (function(middle) > 0) == above
        start, end = np.where(same, middle, start), np.where(same, end, middle)
    return np.sort((start + end) / 2)


def _halved(function: Function, stretches: Floats) -> Floats:
    """Both halves of stretches (5, m), all first halves first: two ends, a bound of the slope, two values."""
    a, b, slope, low, high = stretches
    middle = (a + b) / 2
    between = function(middle)
    return np.concatenate([[a, middle, slope, low, between], [middle, b, slope, between, high]], axis=1)
