"""Contour lines of a measure over triangles: where the values known along their sides cross each level.

A side is read at more places while interpolations through two and through three of its values disagree, and
what is read for one level serves all levels that cross the side.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sevenbar.arrays import Booleans, Floats, Integers
from sevenbar.design.maps.outline import joined

#: A contour's points are right to this share of the step between levels; those of forces, each of which takes
#: its time, to the second: less than the width of a line where contours are a finger apart.
EXACT, EXACT_FORCES = 1e-3, 1e-2

#: Most places at which a side is read for one crossing: more are needed only where the measure jumps.
MOST_READ = 8

#: Between ends of one sign that differ by more than this factor a value grows as towards a boundary without
#: bound, and one over its square is even: it goes as one over the root of the distance, below the chord.
STEEP = 2.0


class Net(NamedTuple):
    """Places (n, 2) [shares], their kinds (n,), and triangles between places of one kind (m, 3)."""

    nodes: Floats
    kinds: Integers
    triangles: Integers


@dataclass(frozen=True, eq=False)
class Contour:
    """A line on which a measure has the value `level`: places (n, 2) [shares], within regions of one kind."""

    level: float
    kind: int
    places: Floats


def traced(
    net: Net, values: Floats, levels: Sequence[float], read: Callable[[Floats], Floats], exact: float = EXACT
) -> Iterator[Contour]:
    """The contour lines of a measure with these values at the net's nodes; what is higher is on their left.

    `read` gives the measure at places (n, 2), NaN where it has none; points are right to `exact`, a share of
    the step between levels.
    """
    whole = net.triangles[np.isfinite(values[net.triangles]).all(axis=1)]
    spacing = min(np.diff(levels), default=abs(levels[0]) if levels else 1.0) or 1.0
    ends: list[Integers] = [np.empty((0, 2, 2), dtype=np.int64)]
    of_level: list[Floats] = [np.empty(0)]
    for level in levels:
        high = values >= level
        mixed = whole[(high[whole].sum(axis=1) % 3) > 0]
        # the corner that stands alone, and the other two, anticlockwise
        alone = np.argmax(high[mixed] != (high[mixed].sum(axis=1) == 2)[:, None], axis=1)
        a, b, c = (mixed[np.arange(len(mixed)), (alone + turn) % 3] for turn in range(3))
        sides = np.stack([np.column_stack([a, b]), np.column_stack([a, c])], axis=1)
        ends.append(np.where(high[a][:, None, None], sides, sides[:, ::-1]))
        of_level.append(np.full(len(mixed), level))
    pieces, piece_levels = np.concatenate(ends), np.concatenate(of_level)
    sides = np.sort(pieces, axis=2).reshape(-1, 2)
    places = _crossed(read, exact * spacing, net, values, sides, np.repeat(piece_levels, 2)).reshape(-1, 2, 2)
    lines: dict[tuple[float, int], list[Floats]] = defaultdict(list)
    for level, kind, piece in zip(
        piece_levels.tolist(), net.kinds[pieces[:, 0, 0]].tolist(), places, strict=True
    ):
        lines[level, kind].append(piece)
    for (level, kind), own in sorted(lines.items()):
        for line in joined(own):
            yield Contour(level, kind, line)


def _crossed(
    read: Callable[[Floats], Floats], exact: float, net: Net, values: Floats, sides: Integers, levels: Floats
) -> Floats:
    """Where sides (n, 2) between nodes cross levels (n,): places (n, 2), to `exact` of the measure."""
    own, side = np.unique(sides, axis=0, return_inverse=True)
    side = side.ravel()
    start, along = net.nodes[own[:, 0]], net.nodes[own[:, 1]] - net.nodes[own[:, 0]]
    # the places along each side and their values, rising, NaN after the last
    at, known, ends = np.tile([0.0, 1.0], (len(own), 1)), values[own], values[own]
    least, most = np.abs(known).min(axis=1), np.abs(known).max(axis=1)
    steep = (known.prod(axis=1) > 0) & (most > STEEP * least)
    tries = np.zeros(len(side), dtype=np.int64)
    while True:
        part, off = _interpolated(at[side], known[side], levels, steep[side], exact)
        off[tries >= MOST_READ] = 0.0
        worst = np.full(len(own), -1)
        order = np.argsort(off)
        worst[side[order]] = order
        worst = worst[off[worst] > exact]
        if not worst.size:
            break
        tries[worst] += 1
        where = side[worst]
        new = np.full((2, len(own)), np.nan)
        new[0, where], new[1, where] = part[worst], read(start[where] + part[worst, None] * along[where])
        steep &= ~(np.abs(new[1]) > np.abs(ends[:, 0] + (ends[:, 1] - ends[:, 0]) * new[0]))
        # without a value there is nothing to gain
        without = np.isnan(new[1])
        new[0, without] = np.nan
        tries[np.isin(side, where) & without[side]] = MOST_READ
        at, known = np.column_stack([at, new[0]]), np.column_stack([known, new[1]])
        rank = np.argsort(at, axis=1)
        at, known = (np.take_along_axis(one, rank, axis=1) for one in (at, known))
    return np.asarray(start[side] + part[:, None] * along[side])


def _interpolated(
    at: Floats, known: Floats, levels: Floats, steep: Booleans, exact: float
) -> tuple[Floats, Floats]:
    """Where values (n, m) known at parts of sides pass levels (n,), and by how much they may be off there.

    By inverse interpolation through the two values about the crossing and the one before or after them, on
    steep sides of one over their square. How far both choices differ, or with one third value what two
    values give, is more than either is off where they converge; without any it is infinite.
    """
    rows, level = np.arange(len(at)), levels[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        off = known - level
        off = np.where(steep[:, None] & (known * level > 0), level / 2 * (1 - (level / known) ** 2), off)
        low = np.argmax((off[:, :-1] >= 0) != (off[:, 1:] >= 0), axis=1)
        x, y = np.pad(np.stack([at, off]), ((0, 0), (0, 0), (1, 1)), constant_values=np.nan)
        (a, b, c, d), (ya, yb, yc, yd) = ([one[rows, low + i] for i in range(4)] for one in (x, y))
        two = b - yb * (c - b) / (yc - yb)

        def three(x: Floats, y: Floats) -> Floats:
            part = b * yc * y / ((yb - yc) * (yb - y)) + c * yb * y / ((yc - yb) * (yc - y))
            part += x * yb * yc / ((y - yb) * (y - yc))
            return np.where((part >= b) & (part <= c), part, np.nan)

        before, after = three(a, ya), three(d, yd)
        first = np.where(np.isnan(after) | (two - a < d - two), before, after)
        first = np.where(np.isnan(first), after, first)
        other = np.where(np.isnan(before) | np.isnan(after), two, before + after - first)
        miss = np.abs((first - other) * (yc - yb) / (c - b))
        # where a third value only misleads the middle is safe
        middle = np.where(np.isnan(a) & np.isnan(d), two, (b + c) / 2)
        part, miss = np.where(np.isnan(first), middle, first), np.where(np.isnan(miss), np.inf, miss)
    # a place that was read may have the level as it is
    least = np.fmin(np.abs(yb), np.abs(yc))
    at_end = (least <= exact) & ~(miss <= exact)
    return np.where(at_end, np.where(np.abs(yb) <= np.abs(yc), b, c), part), np.where(at_end, least, miss)
