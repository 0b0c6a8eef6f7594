"""What a linkage shakes its frame with: greatest and mean sizes, and the orders of the input's turning.

Shaking is the wrench (moment about the report origin, force) of all inertia forces. It is linear in each
link's mass m and first moments m c:

    W = W_0 + U (m c_x, m c_y, m c_z, m)                                                                 (17)

with U (6, 4) the link's wrenches for unit first moments and a unit mass at its origin; for the moment the
link's inertia about its origin stays as it is.

Source: docs/theory_forces.md, (17) and (18).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Curve, Peak, mean
from sevenbar.curves.cycle_series import CycleSeries
from sevenbar.curves.timed_rows import TimedRows
from sevenbar.text.printing import Printed

#: Columns of a wrench.
MOMENT, FORCE = (0, 1, 2), (3, 4, 5)


@dataclass(frozen=True, eq=False, repr=False)
class Shaking(Printed):
    """The size of shaking force [N] and moment [N m]: peaks with their inputs, root mean squares.

    `orders` (m, 6) is the amplitude of the wave that goes round k = 0, 1, .. times in the cycle, moment x, y,
    z, then force x, y, z: 1 is the primary, 2 the secondary order of an input that turns once in it; empty
    for rows of a law.
    """

    force: Peak
    moment: Peak
    rms_force: float
    rms_moment: float
    orders: Floats


def shaking_of(wrench: Floats, input: Floats, *, period: float | None, time: Floats) -> Shaking:
    """The shaking of rows (n, 6) at `input` (n,) [rad, or length] and `time` (n,) [s].

    `period` is the way of the input round a closed cycle at constant speed; `None` for a law's rows.
    """
    both: Curve
    orders = np.zeros((0, 6))
    if period is None:
        both = TimedRows(wrench, input, time)
    else:
        both = series = CycleSeries(wrench, float(input[0]), period)
        orders = np.abs(series.spectrum)
    found = []
    for part in (FORCE, MOMENT):
        squares = both.part(part).squared()
        top = squares.highest()
        found.append((Peak(_root(top.value), top.input), _root(mean(squares))))
    (force, rms_force), (moment, rms_moment) = found
    return Shaking(force, moment, rms_force, rms_moment, orders)


def _root(square: float) -> float:
    return math.sqrt(max(0.0, square))
