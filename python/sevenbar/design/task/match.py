"""The best order-keeping match of wanted points with a curve of rows, as it is and placed in space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task.placing import Placing, placed, turns

#: Places along the wanted path, and along a curve, at which shapes are compared.
SHAPE, CURVE = 24, 96

#: Shares of a curve that an open path may take where the scale is free.
SHARES = (0.1, 0.15, 0.2, 0.27, 0.35, 0.45, 0.6, 0.8)

#: A closed curve may be entered at each of its rows of this number: the first match lies within as many.
BEGIN_EVERY = 2

#: How often an order-keeping match and the best place are found in turn.
ROUNDS = 3


@dataclass(frozen=True, eq=False)
class Match:
    """Rows (n,) of a curve matched with the wanted points, the mean square left, and the placing."""

    rows: Integers
    error: float
    placing: Placing


def _with_lengths(curve: Floats, *, closed: bool) -> tuple[Floats, Floats]:
    """The places of a curve, a closed one to its first place again, and the lengths along it."""
    whole = np.concatenate([curve, curve[:1]]) if closed else curve
    return whole, np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(whole, axis=0), axis=1))])


def in_order(curve: Floats, wanted: Floats, *, closed: bool) -> tuple[Integers, float]:
    """Rows (n,) of a curve (rows, 3) nearest to wanted points while they follow each other, either way.

    A closed curve may be entered anywhere and is gone round once at most. With the mean square distance.
    """
    best, least = np.zeros(len(wanted), dtype=np.int64), math.inf
    count = len(curve)
    if count < len(wanted):
        return best, least
    square = ((wanted[:, None, :] - curve[None]) ** 2).sum(axis=2)
    begins = np.arange(0, count, BEGIN_EVERY) if closed else np.zeros(1, dtype=np.int64)
    order = (begins[:, None] + np.arange(count)) % count
    for way in (1, -1):
        cost = np.moveaxis(square[:, ::way][:, order], 1, 0)
        places, errors = _followed(cost)
        first = int(errors.argmin())
        if errors[first] < least:
            rows = order[first][places[first]]
            best, least = (rows if way == 1 else count - 1 - rows), float(errors[first])
    return best, least


def _followed(cost: Floats) -> tuple[Integers, Floats]:
    """The rising columns (m, n) of least mean cost (m, n, columns), by dynamic programming; and that (m,)."""
    sets, count, columns = cost.shape
    before = np.zeros((count, sets, columns), dtype=np.int64)
    total = cost[:, 0]
    every = np.arange(columns)
    for j in range(1, count):
        least = np.minimum.accumulate(total, axis=1)
        at = np.maximum.accumulate(np.where(total == least, every, 0), axis=1)
        before[j, :, 1:] = at[:, :-1]
        total = np.concatenate([np.full((sets, 1), math.inf), least[:, :-1]], axis=1) + cost[:, j]
    rows = np.empty((sets, count), dtype=np.int64)
    rows[:, -1] = total.argmin(axis=1)
    for j in range(count - 1, 0, -1):
        rows[:, j - 1] = before[j, np.arange(sets), rows[:, j]]
    return rows, total.min(axis=1) / count


def matched(curve: Floats, wanted: Floats, *, curve_closed: bool, closed: bool, scaled: bool) -> Match | None:
    """The best order-keeping match of a curve with the wanted points, placed where it is best in space."""
    if closed and not curve_closed:
        return None
    placing = _by_shape(curve, wanted, curve_closed=curve_closed, closed=closed, scaled=scaled)
    if placing is None:
        return None
    best: Match | None = None
    for _ in range(ROUNDS):
        rows, error = in_order(placing.put(curve), wanted, closed=curve_closed)
        if not math.isfinite(error):
            break
        if best is None or error < best.error:
            best = Match(rows, error, placing)
        placing = placed(wanted, curve[rows], scaled=scaled)
    return best


def by_length(curve: Floats, wanted: Floats, *, curve_closed: bool, closed: bool) -> Integers | None:
    """Rows (n,) of a curve (rows, 3), as placed, at the lengths along it that wanted points have.

    Near a sharp turn, where the nearest rows of points before and after it are the same, lengths tell which
    side is which. The best of all begins, both ways; `None` where the curve is too short.
    """
    _, along = _with_lengths(wanted, closed=False)
    _, length = _with_lengths(curve, closed=curve_closed)
    if closed:
        # the lengths of a closed path are those of the curve, from its first point to its first again
        along *= length[-1] / (along[-1] + float(np.linalg.norm(wanted[-1] - wanted[0])))
    count = len(curve)
    best, least = None, math.inf
    for way in (1, -1):
        for begin in range(count):
            at = length[begin] + way * along
            if curve_closed and along[-1] < length[-1]:
                at = at % length[-1]
            elif at.min() < 0 or at.max() > length[-1]:
                continue
            rows = np.searchsorted(length, at).clip(0, len(length) - 1) % count
            error = float(((curve[rows] - wanted) ** 2).sum())
            if error < least:
                best, least = rows, error
    return best


def _by_shape(
    curve: Floats, wanted: Floats, *, curve_closed: bool, closed: bool, scaled: bool
) -> Placing | None:
    """The placing that brings some stretch of a curve, either way along, nearest to the wanted path."""
    own, long = _evenly(wanted, SHAPE, closed=closed)
    other, whole = _evenly(curve, CURVE, closed=curve_closed)
    if not whole > 0:
        return None
    if closed:
        shares: tuple[float, ...] = (1.0,)
    elif scaled:
        shares = SHARES
    else:
        shares = (min(long / whole, 1.0 if not curve_closed else (CURVE - 1) / CURVE),)
    last = SHAPE if closed else SHAPE - 1
    along = np.arange(SHAPE) / last
    stretches = []
    for share in shares:
        length = share * (CURVE if curve_closed else CURVE - 1)
        begins = np.arange(CURVE) if curve_closed else np.arange(max(int(CURVE - 1 - length) + 1, 1))
        places = begins[:, None] + along * length
        low = np.floor(places).astype(np.int64)
        part = (places - low)[:, :, None]
        high = low + 1
        low, high = (low % CURVE, high % CURVE) if curve_closed else (low, np.minimum(high, CURVE - 1))
        stretch = (1 - part) * other[low] + part * other[high]
        stretches += [stretch, stretch[:, ::-1]]
    every = np.concatenate(stretches)
    middle = every.mean(axis=1, keepdims=True)
    far = own.mean(axis=0)
    rotation, scale, left = turns((own - far)[None], every - middle, scaled=scaled)
    i = int(left.argmin())
    turn, size = rotation[i], float(scale[i])
    return Placing(turn, far - size * turn @ middle[i, 0], size)


def _evenly(curve: Floats, count: int, *, closed: bool) -> tuple[Floats, float]:
    """Places (count, 3) at even lengths along a curve (rows, 3), and its length."""
    whole, length = _with_lengths(curve, closed=closed)
    at = np.linspace(0.0, length[-1], count, endpoint=not closed)
    return np.column_stack([np.interp(at, length, whole[:, k]) for k in range(3)]), float(length[-1])
