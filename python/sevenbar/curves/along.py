"""Quantities along a path as polynomials on its pieces: values and derivatives anywhere, integrals, zeros.

On the piece from a to b, with x = (2 s - a - b) / (b - a),

    f(s) = sum c_k T_k(x)                                                                                 (3)

passes through the values at Chebyshev's nodes. Where f is analytic the c_k fall geometrically, so the last of
them show what is missing.

Source: docs/theory_free.md, (3).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev, chebyshev

from sevenbar._core import piecewise
from sevenbar.arrays import Floats
from sevenbar.curves.stationary import real_roots

#: Halvings of a bracket, from any length to rounding, if Newton's method never helps.
HALVINGS = 80

#: Two zeros nearer than this part of the path are one, found from two pieces.
SAME = 1e-12


@dataclass(frozen=True, eq=False)
class Along:
    """k quantities on m pieces between `edges` (m + 1,), by the Chebyshev coefficients `series` (m, n, k)."""

    edges: Floats
    series: Floats

    def __post_init__(self) -> None:
        # once here, so that the core need not copy it at each call
        object.__setattr__(self, "series", np.ascontiguousarray(self.series))

    @property
    def length(self) -> float:
        """From the first edge to the last."""
        return float(self.edges[-1] - self.edges[0])

    @cached_property
    def slope(self) -> Along:
        """The derivatives by the path."""
        steps = 2 / np.diff(self.edges)
        series = chebyshev.chebder(self.series, axis=1) * steps[:, None, None]
        return Along(self.edges, series)

    @cached_property
    def integral(self) -> Along:
        """The integrals from the first edge on."""
        half = np.diff(self.edges) / 2
        series = chebyshev.chebint(self.series, lbnd=-1, axis=1) * half[:, None, None]
        gains = series.sum(axis=1)
        series[1:, 0] += np.cumsum(gains[:-1], axis=0)
        return Along(self.edges, series)

    def part(self, *columns: int) -> Along:
        """Some of the quantities."""
        return Along(self.edges, self.series[:, :, list(columns)])

    def at(self, s: Floats) -> Floats:
        """The quantities (j, k) at places (j,); beyond the ends the polynomials of these go on."""
        return piecewise(self.edges, self.series, np.asarray(s, dtype=np.float64))

    def on(self, piece: npt.NDArray[np.int64], s: Floats) -> Floats:
        """The quantities (j, k) by the polynomials of given pieces (j,) at places (j,)."""
        return piecewise(self.edges, self.series, s, piece)

    def stationary(self, column: int) -> Floats:
        """Places (j,) where one quantity has slope zero, or may turn at an edge, in order."""
        slope = self.slope.series[:, :, column]
        # |T_k| <= 1 on a piece: there is no zero where the constant outweighs all other terms
        least_size = np.abs(slope[:, 0]) - np.abs(slope[:, 1]) - np.abs(slope[:, 2:]).sum(axis=1)
        result = []
        for i in np.flatnonzero(least_size <= 0):
            roots = np.sort(real_roots(Chebyshev(slope[i], domain=[-1, 1])))
            a, b = self.edges[i], self.edges[i + 1]
            result.append((a + b) / 2 + (b - a) / 2 * roots)
        places = np.sort(np.concatenate(result)) if result else np.empty(0)
        return places[np.diff(places, prepend=-np.inf) > SAME * self.length]

    def crossings(self, column: int, value: float, marks: Floats, touch: float = 0.0) -> Floats:
        """Places (j,) where one quantity has a value; `marks` are the edges and all stationary places.

        A mark where it is off the value by `touch` at most is such a place.
        """
        quantity = self.part(column)
        heights = quantity.at(marks)[:, 0] - value
        heights[np.abs(heights) <= touch] = 0.0
        # between two marks it only rises or only falls, so it has the value once at most
        result = [marks[heights == 0.0]]
        for i in np.flatnonzero(heights[:-1] * heights[1:] < 0):
            result.append(np.array([zero_between(quantity, value, marks[i], marks[i + 1])]))
        return np.unique(np.concatenate(result))

    @cached_property
    def reach(self) -> Floats:
        """The greatest size (k,) at the middles and ends of the pieces."""
        coefficients = np.moveaxis(self.series, 1, 0)
        sizes = [np.abs(chebyshev.chebval(x, coefficients)).max(axis=0) for x in (-1, 0, 1)]
        return np.asarray(np.max(sizes, axis=0))


def zero_between(one: Along, value: float, low: float, high: float) -> float:
    """Where a single quantity has a value between two places, at one of which it is above the value.

    By Newton's method, halving the bracket where a step would leave it.
    """
    rising = one.at(np.array([high]))[0, 0] > value
    at = (low + high) / 2
    for _ in range(HALVINGS):
        here = np.array([at])
        height, slope = one.at(here)[0, 0] - value, one.slope.at(here)[0, 0]
        if (height > 0) == rising:
            high = at
        else:
            low = at
        newton = at - height / slope if slope else np.inf
        following = newton if low < newton < high else (low + high) / 2
        if abs(following - at) <= 2 * np.spacing(max(abs(low), abs(high))):
            return float(following)
        at = following
    return float(at)
