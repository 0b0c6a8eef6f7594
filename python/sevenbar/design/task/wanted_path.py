"""Points of a wanted path and their inputs as given, checked."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array
from sevenbar.errors import RequestError

#: Points of a wanted path: fewer say nothing of a curve; more only cost time, each is an unknown.
FEWEST_POINTS, MOST_POINTS = 3, 200

#: A path whose last point is this near to its first, relative to its extent, is closed.
SAME_POINT = 1e-9


def wanted_places(points: npt.ArrayLike) -> tuple[Floats, bool]:
    """The wanted points (n, 3), and whether the last repeats the first."""
    try:
        wanted = np.array(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise RequestError("points: not an array of numbers; give rows of x, y and z") from None
    if wanted.ndim != 2 or wanted.shape[1] != 3:
        raise RequestError(f"points: an array of shape {wanted.shape} does not fit; give rows of x, y and z")
    bad = np.argwhere(~np.isfinite(wanted))
    if bad.size:
        row, axis = bad[0]
        raise RequestError(f"points: {'xyz'[axis]} of point {row + 1} is not a finite number; mend it")
    extent = float(np.ptp(wanted, axis=0).max(initial=0.0))
    closed = len(wanted) > 1 and bool(np.abs(wanted[-1] - wanted[0]).max() <= SAME_POINT * extent)
    count = len(wanted) - closed
    if count < FEWEST_POINTS:
        raise RequestError(f"points: {count} given; a path needs at least {FEWEST_POINTS}")
    if count > MOST_POINTS:
        raise RequestError(f"points: {count} given; give at most {MOST_POINTS}, thinned out evenly")
    if not extent > 0:
        raise RequestError("points: all are one place; give points along a path")
    again = np.flatnonzero(np.abs(np.diff(wanted, axis=0)).max(axis=1) <= SAME_POINT * extent)
    if again.size:
        raise RequestError(f"points: {again[0] + 1} and {again[0] + 2} are one place; leave one out")
    return wanted, closed


def turning_back(values: Floats) -> int | None:
    """The number, from 1, of the first value that goes back; `None` where they rise or fall throughout."""
    steps = np.diff(values)
    back = np.flatnonzero(~(steps * np.sign(steps[:1]) > 0))
    # the first step leads to the second value
    return int(back[0]) + 2 if back.size else None


def wanted_inputs(timing: npt.ArrayLike | None, wanted: Floats, closed: bool) -> Floats | None:
    """The inputs of the points without the closing one, for which an input may be given, too."""
    if timing is None:
        return None
    inputs = finite_array("timing", timing)
    count = len(wanted) - 1 if closed else len(wanted)
    if inputs.size not in (count, len(wanted)):
        raise RequestError(
            f"timing: {inputs.size} inputs for {len(wanted)} points; give one for each, in their order"
        )
    if number := turning_back(inputs):
        raise RequestError(
            f"timing: the input of point {number} turns back; inputs must rise, or fall, from point to point"
        )
    return inputs[:count]
