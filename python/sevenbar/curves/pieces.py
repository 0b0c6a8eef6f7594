"""A quantity that jumps or kinks at known inputs: polynomials between these, each as exact as rounding.

Between two breaks the quantity is smooth. Every stretch is divided until the Chebyshev series through values
at 16 nodes of each piece ends in rounding, so pieces are small where the quantity is sharp. Nodes never lie
on a break, so nobody has to say what the value there is: the two polynomials give the limits from both sides.

Source: docs/theory_forces.md, (13).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import Chebyshev, chebyshev, legendre

from sevenbar.arrays import Floats, Integers
from sevenbar.curves.along import Along
from sevenbar.curves.curve import Peak, highest_of
from sevenbar.curves.cycle_series import ENOUGH, CycleSeries, cycle_series
from sevenbar.curves.stationary import AT_END, nodes, nodes_between, real_roots, series_through

#: Pieces of a cycle before any is halved.
FIRST_PIECES = 12

#: A piece is fine enough where the last terms of its series are below this part of the greatest value.
RESOLVED = 1e-12

#: Most halvings of a piece, and most values in all; what is left then is the tail.
HALVINGS, MOST_VALUES = 40, 60_000

#: Below this part of the greatest value the last terms of a piece may be noise: next to a limit of the input
#: values have lost digits. They are where halving does not bring them below `FALLS` of what they were; of a
#: smooth quantity it does by far.
NOISY, FALLS = 1e-6, 0.25

#: Points of Gauss's rule on each piece for the mean of a power.
GAUSS = 32

#: Two breaks nearer than this part of the cycle are one; a reach lower than a value by less is rounding.
SAME = 1e-12


@dataclass(frozen=True, eq=False)
class Pieces:
    """A quantity along a cycle from the input `first` by `period` [rad, or length], in polynomials.

    `along` has them between shares of the cycle, a column for each number of a vector; `breaks` are the edges
    at which the quantity may jump; `rows` (n,) or (n, k) as the caller has them, `off` how far the pieces are
    from these, as a part of the greatest value.
    """

    rows: Floats
    along: Along
    first: float
    period: float
    breaks: Floats
    off: float = 0.0

    @cached_property
    def scale(self) -> float:
        """The greatest size at the middles and ends of the pieces."""
        return float(self.along.reach.max())

    @property
    def tail(self) -> float:
        """The greatest of the last two terms of a piece, or `off`, as a part of the greatest value."""
        last = float(np.abs(self.along.series[:, -2:]).max() / self.scale) if self.scale else 0.0
        return max(last, self.off)

    def at(self, inputs: Floats) -> Floats:
        """The quantity at inputs (j,) of the cycle: (j,) or (j, k)."""
        values = self.along.at((np.asarray(inputs, dtype=np.float64) - self.first) / self.period % 1.0)
        return values[:, 0] if self.rows.ndim == 1 else values

    def part(self, columns: int | tuple[int, ...]) -> Pieces:
        """One column of a vector as a number, or some as a vector."""
        return replace(self, rows=self.rows[:, columns], along=self.along.part(*np.atleast_1d(columns)))

    def extremes(self) -> tuple[Floats, Floats]:
        """Inputs and values (j,) of the local extremes, along the cycle; at a break those of both sides.

        Where the slope is zero without a change of its sign is among them, too.
        """
        return self._extremes(np.arange(len(self.along.series)), self.breaks)

    def _extremes(self, pieces: Integers, breaks: Floats) -> tuple[Floats, Floats]:
        """Those of some pieces, with such breaks."""
        edges = self.first + self.period * self.along.edges
        inputs, values = [], []
        joined = False
        for i in pieces:
            curve = Chebyshev(self.along.series[i, :, 0], domain=[-1, 1])
            inside = np.sort(real_roots(curve.deriv()))
            if joined and inside.size and inside[0] < -1 + 2 * AT_END:
                # the piece before has it
                inside = inside[1:]
            # that after the last is the first
            after = (i + 1) % len(self.along.series)
            jumps, ends = (bool((breaks == self.along.edges[edge]).any()) for edge in (i, after))
            joined = not ends and bool(inside.size) and inside[-1] > 1 - 2 * AT_END
            at = np.concatenate([[-1.0] * jumps, inside, [1.0] * ends])
            start, end = edges[i : i + 2]
            inputs.append((start + end) / 2 + (end - start) / 2 * at)
            values.append(curve(at))
        places, heights = np.concatenate(inputs), np.concatenate(values)
        if not places.size:
            # a constant
            return edges[:1], chebyshev.chebval(-1.0, self.along.series[0])
        return places, heights

    def highest(self) -> Peak:
        """The highest value."""
        series = self.along.series[:, :, 0]
        # no piece reaches higher than the sum of the sizes of its terms
        ends = chebyshev.chebval(np.array([-1.0, 0.0, 1.0]), series.T)
        reach = series[:, 0] + np.abs(series[:, 1:]).sum(axis=1)
        selected = np.flatnonzero(reach >= ends.max() - SAME * self.scale)
        return highest_of(*self._extremes(selected, self.along.edges))

    def lowest(self) -> Peak:
        """The lowest value."""
        top = replace(self, along=Along(self.along.edges, -self.along.series)).highest()
        return Peak(-top.value, top.input)

    def mean_of(self, function: Callable[[Floats], Floats]) -> float:
        """The mean of a function of the values, by Gauss's rule on every piece."""
        at, weights = _gauss()
        values = function(np.asarray(chebyshev.chebval(at, self.along.series[:, :, 0].T)))
        return float(np.diff(self.along.edges) @ values @ weights / 2)

    def running(self) -> Pieces:
        """The integral by the input of the quantity less its mean, 0 at the first piece's start."""
        series = self.along.series.copy()
        series[:, 0] -= self.mean_of(lambda values: values)
        sums = Along(self.along.edges, series).integral.series
        return replace(self, along=Along(self.along.edges, self.period * sums), off=0.0)

    def squared(self) -> Pieces:
        """The squared size: twice the degree."""
        values = chebyshev.chebval(
            nodes(2 * self.along.series.shape[1]), np.moveaxis(self.along.series, 1, 0)
        )
        series = series_through((values**2).sum(axis=1)[:, :, None])
        rows = (self.rows**2).reshape(len(self.rows), -1).sum(axis=1)
        return replace(self, rows=rows, along=Along(self.along.edges, series), off=0.0)


@cache
def _gauss() -> tuple[Floats, Floats]:
    """Places and weights of Gauss's rule."""
    return legendre.leggauss(GAUSS)


def pieces(
    evaluate: Callable[[Floats], Floats],
    rows: Floats,
    first: float,
    period: float,
    breaks: Sequence[float] = (),
) -> Pieces:
    """A quantity along the cycle from `first` by `period`, which may jump at the inputs `breaks`.

    `evaluate` takes inputs (j,) and gives values (j,) or (j, k); it is never called at a break. Breaks lie
    anywhere; they are brought into the cycle by whole periods.
    """
    shares = np.sort((np.asarray(breaks, dtype=np.float64) - first) / period % 1.0)
    shares = shares[np.diff(shares, prepend=-1.0) > SAME]
    # a cycle may be cut anywhere: at its first break, so that no piece leads over the end
    cut = float(shares[0]) if shares.size else 0.0
    marks = np.append(shares - cut, 1.0) if shares.size else np.array([0.0, 1.0])
    marks = marks[np.append(np.diff(marks) > SAME, True)]
    edges = np.concatenate(
        [np.linspace(a, b, max(1, round(FIRST_PIECES * (b - a))), endpoint=False) for a, b in pairwise(marks)]
        + [marks[-1:]]
    )
    origin = first + cut * period
    todo = np.column_stack([edges[:-1], edges[1:]])
    result: list[tuple[float, float, Floats]] = []
    scale, count = float(np.abs(rows).max()), 0
    # the last terms of the piece that was halved
    before = np.full(len(todo), math.inf)
    for halving in range(HALVINGS + 1):
        middle, grid = todo.mean(axis=1), nodes_between(todo[:, 0], todo[:, 1])
        values = evaluate(origin + period * grid.ravel())
        values = values.reshape(*grid.shape, *values.shape[1:])
        scale = max(scale, float(np.abs(values).max()))
        series = series_through(values)
        last = np.abs(series[:, -2:]).reshape(len(todo), -1).max(axis=1)
        noise = (last <= NOISY * scale) & (last > FALLS * before)
        rough = (last > RESOLVED * scale) & ~noise
        count += grid.size
        if halving == HALVINGS or count + 2 * rough.sum() * grid.shape[1] > MOST_VALUES:
            rough[:] = False
        result += [(a, b, own) for (a, b), own in zip(todo[~rough], series[~rough], strict=True)]
        halves = [np.column_stack([todo[:, 0], middle]), np.column_stack([middle, todo[:, 1]])]
        todo, before = np.concatenate(halves)[np.tile(rough, 2)], np.tile(last[rough], 2)
        if not len(todo):
            break
    result.sort(key=lambda piece: piece[0])
    edges = np.array([piece[0] for piece in result] + [result[-1][1]])
    series = np.stack([piece[2] for piece in result]).reshape(len(result), len(result[0][2]), -1)
    jumps = edges[np.isin(edges[:-1], marks[:-1]).nonzero()] if shares.size else np.empty(0)
    return Pieces(rows, Along(edges, series), origin, period, jumps)


def smooth_pieces(evaluate: Callable[[Floats], Floats], rows: Floats, first: float, period: float) -> Pieces:
    """A quantity without jumps along the cycle, compared with its rows (n,) or (n, k) at equal steps."""
    made = pieces(evaluate, rows, first, period)
    inputs = first + period * np.arange(len(rows)) / len(rows)
    scale = max(made.scale, float(np.abs(rows).max()))
    off = float(np.abs(made.at(np.asarray(inputs)) - rows).max()) / scale if scale else 0.0
    return replace(made, off=off)


def cycle_curve(
    evaluate: Callable[[Floats], Floats] | None, rows: Floats, first: float, period: float
) -> CycleSeries | Pieces:
    """The series through rows (n,) or (n, k) of a cycle, or pieces where they are too sharp for it."""
    series = cycle_series(evaluate, rows, first, period)
    if evaluate is None or series.tail <= ENOUGH:
        return series
    finer = smooth_pieces(evaluate, rows, first, period)
    return finer if finer.tail < series.tail else series
