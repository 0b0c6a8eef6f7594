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
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Curve, Peak, mean
from sevenbar.curves.cycle_series import CycleSeries
from sevenbar.curves.pieces import cycle_curve, pieces
from sevenbar.curves.timed_rows import TimedRows
from sevenbar.forces.sizing import WITHHELD
from sevenbar.text.printing import Printed

if TYPE_CHECKING:
    from sevenbar.forces.result import Forces

#: Columns of a wrench.
MOMENT, FORCE = (0, 1, 2), (3, 4, 5)


@dataclass(frozen=True, eq=False, repr=False)
class Shaking(Printed):
    """The size of shaking force [N] and moment [N m]: peaks with their inputs, root mean squares.

    Row k = 0, 1, .. of `orders` (m, 6) has the amplitudes of the wave that repeats k times in the cycle:
    moment x, y, z, then force x, y, z. Where the input turns once in the cycle, row 1 is the primary and row
    2 the secondary order; there are no rows for a law. `tail` is how much the rows may miss between them, as
    a part of the greatest value.
    """

    force: Peak
    moment: Peak
    rms_force: float
    rms_moment: float
    orders: Floats
    tail: float = math.nan
    input_unit: str = "rad"


def shaking_of(
    wrench: Floats,
    input: Floats,
    *,
    period: float | None,
    time: Floats,
    evaluate: Callable[[Floats], Floats] | None = None,
    ends: tuple[float, float] | None = None,
) -> Shaking:
    """The shaking of rows (n, 6) at `input` (n,) [rad, or length] and `time` (n,) [s].

    `period` is how far the input goes in a closed cycle at constant speed; `None` for a law's rows. With
    `evaluate`, which gives rows (m, 6) at inputs (m,) of such a cycle, rows are added until peaks and mean
    values do not depend on them; for a part between two stops, `ends` are the inputs of both.
    """
    sizes = np.array([np.abs(wrench[:, part]).max(initial=0.0) for part in (MOMENT, FORCE)])
    # moments and forces as parts of their greatest, so that rounding is one size in all
    units = np.repeat(np.where(sizes > 0, sizes, 1.0), 3)
    curve: Curve
    orders = np.zeros((0, 6))
    relative = None if evaluate is None else lambda inputs: np.asarray(evaluate(inputs) / units)
    if ends is not None and relative is not None:
        curve = pieces(relative, wrench / units, ends[0], ends[1] - ends[0], (ends[0],))
    elif period is None:
        curve = TimedRows(wrench / units, input, time)
    else:
        curve = cycle_curve(relative, wrench / units, float(input[0]), period)
        waves = (
            curve if isinstance(curve, CycleSeries) else CycleSeries(wrench / units, float(input[0]), period)
        )
        orders = np.abs(waves.spectrum) * units
    result = []
    for part in (FORCE, MOMENT):
        squares, unit = curve.part(part).squared(), float(units[part[0]])
        top = squares.highest()
        result.append((Peak(unit * _root(top.value), top.input), unit * _root(mean(squares))))
    (force, rms_force), (moment, rms_moment) = result
    return Shaking(force, moment, rms_force, rms_moment, orders, curve.tail)


def shaking_along(forces: Forces) -> Shaking | None:
    """The shaking of the rows of forces; of a whole cycle also what lies between its rows.

    Between stops that of the part on which the linkage is used. `None` where a row has no shaking, or too
    much of it may be missed between the rows.
    """
    used = forces.within_stops
    if used is not forces:
        return None if used is None else shaking_along(used)
    if not len(forces.input) or not np.isfinite(forces.shaking).all():
        return None
    between = None if forces.through_change_points else forces.between
    evaluate = None if between is None else lambda inputs: between(inputs).shaking
    ends = None if forces.part is None or between is None else (forces.part.start, forces.part.end)
    period, time = forces.period, forces.time
    result = shaking_of(forces.shaking, forces.input, period=period, time=time, evaluate=evaluate, ends=ends)
    if result.tail > WITHHELD or not forces.closes:
        return None
    return replace(result, input_unit=forces.length_unit if forces.slides else "rad")


def _root(square: float) -> float:
    return math.sqrt(max(0.0, square))
