"""The distance of two links as rods: straight lines between the places of their joints.

The nearest points of two rods are at shares t and r of them, and by Danskin's theorem

    d' = (x - y) . (x' - y') / d,       x, y the nearest points, at t and r held                          (14)

Source: docs/theory_measures.md, (14); C. Ericson, Real-time collision detection (2004), 5.1.9, for the
nearest points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.along import Along
from sevenbar.curves.lipschitz import crossings, lowest
from sevenbar.curves.stationary import zeros_between

#: A rod shorter than this part of the longer one is a point; sines below it are parallel.
POINT = 1e-12

#: Parts of a piece with which the search for a least distance begins.
PARTS = 4

#: What may be missed of a least distance, as a part of the size; its place is then found to rounding.
SMALL = 1e-7


@dataclass(frozen=True, eq=False)
class RodPair:
    """Two rods along a path: the places of their four ends, two of each, as 12 quantities."""

    ends: Along
    size: float

    def shares(self, s: Floats) -> tuple[Floats, Floats]:
        """The shares (n,) of the nearest points on both rods at places (n,)."""
        return nearest_shares(*self._ends(s))

    def distance(self, s: Floats) -> Floats:
        """The least distance (n,) at places (n,)."""
        return rod_distance(*self._ends(s))

    def slope(self, s: Floats) -> Floats:
        """Half the derivative (n,) of its square."""
        a, b, c, d = self._ends(s)
        t, r = nearest_shares(a, b, c, d)
        rates = self.ends.slope.at(s).reshape(-1, 4, 3)
        rate = _on(rates[:, 0], rates[:, 1], t) - _on(rates[:, 2], rates[:, 3], r)
        return np.asarray(((_on(a, b, t) - _on(c, d, r)) * rate).sum(axis=1))

    def least(self) -> tuple[float, float, float]:
        """Where the distance is least, how much it is (0 where the rods cross), by how much it may be less.

        That is 0 unless the distance rests near its least, so that the search ends at its limit.
        """
        edges, bounds = self._stretches()
        place, value, missed = lowest(self.distance, edges, bounds, SMALL * self.size, floor=0.0)
        missed = missed if missed > SMALL * self.size else 0.0
        near = np.array([math.sqrt(SMALL) * self.ends.length])
        for _ in range(8):
            low = np.maximum(place - near, self.ends.edges[0])
            high = np.minimum(place + near, self.ends.edges[-1])
            if self.slope(low)[0] < 0 < self.slope(high)[0]:
                at = zeros_between(self._rising, low, high, np.array([False]))
                better = float(self.distance(at)[0])
                if better <= value:
                    place, value = float(at[0]), better
                break
            near = near / 4
        return place, value, missed

    def _rising(self, s: Floats) -> tuple[Floats, Floats]:
        # without a derivative of its own it is found by halves
        return self.slope(s), np.full(len(s), np.nan)

    def reaches(self, value: float) -> Floats:
        """Places (j,) at which the distance passes through a value, rising or falling."""
        edges, bounds = self._stretches()
        return crossings(lambda s: self.distance(s) - value, edges, bounds, SMALL * self.size)

    def _ends(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        places = self.ends.at(s).reshape(-1, 4, 3)
        return places[:, 0], places[:, 1], places[:, 2], places[:, 3]

    def _stretches(self) -> tuple[Floats, Floats]:
        """Edges of stretches (m + 1,), and bounds (m,) of the distance's slope on each."""
        edges = self.ends.edges
        steps = np.arange(PARTS) / PARTS
        fine = (edges[:-1, None] + np.diff(edges)[:, None] * steps).ravel()
        terms = np.abs(self.ends.slope.series).sum(axis=1).reshape(-1, 4, 3)
        speeds = np.linalg.norm(terms, axis=2)
        bounds = np.maximum(speeds[:, 0], speeds[:, 1]) + np.maximum(speeds[:, 2], speeds[:, 3])
        return np.append(fine, edges[-1]), np.repeat(bounds, PARTS)


def nearest_shares(a: Floats, b: Floats, c: Floats, d: Floats) -> tuple[Floats, Floats]:
    """The shares (n,) in [0, 1] of the nearest points of lines from a to b and from c to d, (n, 3) each.

    >>> a, b, c, d = np.array([[[0.0, 0, 0]], [[2, 0, 0]], [[1, 1, 1]], [[1, -1, 1]]])
    >>> [float(x[0]) for x in nearest_shares(a, b, c, d)]
    [0.5, 0.5]
    """
    first, second, apart = b - a, d - c, a - c
    one, two = (first * first).sum(axis=1), (second * second).sum(axis=1)
    least = POINT**2 * np.maximum(np.maximum(one, two), np.finfo(float).tiny)
    points = one <= least, two <= least
    # of a point any length will do
    one, two = np.where(points[0], 1.0, one), np.where(points[1], 1.0, two)
    both = (first * second).sum(axis=1)
    on_one, on_two = (first * apart).sum(axis=1), (second * apart).sum(axis=1)
    # by the normal, since the difference of products of nearly parallel rods is rounding
    normal = np.cross(first, second)
    area = (normal * normal).sum(axis=1)
    skew = area > POINT**2 * one * two
    ahead = (np.cross(second, apart) * normal).sum(axis=1)
    t = np.where(skew, np.clip(ahead / np.where(skew, area, 1.0), 0, 1), 0.0)
    t = np.where(points[0], 0.0, t)
    r = np.where(points[1], 0.0, (both * t + on_two) / two)
    inside = np.clip(r, 0.0, 1.0)
    # an end of the second rod is nearest: its foot on the first
    foot = np.clip((both * inside - on_one) / one, 0.0, 1.0)
    t = np.where((inside != r) | points[1], np.where(points[0], 0.0, foot), t)
    return np.asarray(t), np.asarray(inside)


def rod_distance(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """The least distance (n,) of lines from a to b and from c to d, (n, 3) each."""
    t, r = nearest_shares(a, b, c, d)
    return np.asarray(np.linalg.norm(_on(a, b, t) - _on(c, d, r), axis=1))


def distance_slopes(ends: Floats, by: Floats) -> tuple[Floats, Floats]:
    """The least distance (n,) of two rods by their ends (n, 4, 3), with slopes (n, k) by theirs (n, 4, 3, k).

    The nearest points follow the ends alone, as (14) has it. Where the rods cross the slopes are 0.
    """
    t, r = nearest_shares(*np.moveaxis(ends, 1, 0))
    weights = np.stack([1 - t, t, r - 1, -r], axis=1)
    way = np.einsum("ne,nej->nj", weights, ends)
    size = np.linalg.norm(way, axis=1)
    slopes = np.einsum("ne,nj,nejk->nk", weights, way, by)
    return size, slopes / np.maximum(size, np.finfo(float).tiny)[:, None]


def _on(start: Floats, end: Floats, share: Floats) -> Floats:
    return np.asarray(start + share[:, None] * (end - start))
