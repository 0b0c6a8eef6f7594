"""A smooth quantity round a closed cycle as a Fourier series: values anywhere, extremes, means, integrals.

From n rows at equal steps of the input x, with phi = 2 pi (x - first) / period,

    f(x) = Re sum c_k e^(i k phi),   k = 0, 1, .. floor(n / 2)                                            (10)

passes through the rows. Between neighbouring zeros of f'' the slope f' rises or falls all the way, so each
change of its sign between them is one extreme. The zeros of f'' are found in the same way between those of
the third derivative.

Source: docs/theory_forces.md, (10) to (12).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Peak, highest_of
from sevenbar.curves.stationary import zeros_between

#: Places to each row where signs are compared.
FINE = 16

#: A series whose waves are smaller than this part of its greatest value is constant.
CONSTANT = 1e-13

#: Derivatives whose signs are compared, each between the zeros of that before it.
ORDERS = (3, 2, 1)

#: Waves smaller than this part of the greatest value are rounding.
NOISE = 1e-15

#: Waves in the last of so many equal shares of the spectrum are its tail.
TAIL_PART = 8

#: A greater tail: the rows are too few for figures to their digits.
ENOUGH = 1e-9

#: Rows are doubled where they can be until the tail is below this.
RESOLVED = 1e-12

#: Most rows, of the sharpest quantity.
MOST_ROWS = 6000

#: Rows for each given one where a power of the values is averaged: the third power of a number has a kink in
#: its third derivative where it is zero.
DENSE = 8


@dataclass(frozen=True, eq=False)
class CycleSeries:
    """A quantity with `rows` (n,) or (n, k) at the inputs `first + period j / n`.

    `period` is the way of the input round the cycle [rad, or length], negative where it falls.

        >>> series = CycleSeries(np.sin(np.arange(12) * np.pi / 6), 0.0, 2 * np.pi)
        >>> series.extremes()[0].round(12).tolist()
        [1.570796326795, 4.712388980385]
    """

    rows: Floats
    first: float
    period: float

    @cached_property
    def spectrum(self) -> npt.NDArray[np.complex128]:
        """The complex coefficients c_k, (n // 2 + 1,) or (n // 2 + 1, k)."""
        count = len(self.rows)
        waves = np.asarray(np.fft.rfft(self.rows, axis=0) / count, dtype=np.complex128)
        # every wave is two, except the constant one and that of every other row
        waves[1 : (count + 1) // 2] *= 2
        return waves

    @cached_property
    def waves(self) -> npt.NDArray[np.complex128]:
        """The spectrum without its end, where that is rounding."""
        heard = np.abs(self.spectrum).reshape(len(self.spectrum), -1).max(axis=1) > NOISE * self.scale
        return self.spectrum[: max(1, int(np.flatnonzero(heard).max(initial=0))) + 1]

    @property
    def scale(self) -> float:
        """The greatest of the rows in size."""
        return float(np.abs(self.rows).max())

    @property
    def last_waves(self) -> float:
        """The greatest wave in the last eighth of the spectrum, as a part of the greatest value."""
        return self._waves_in(1)

    @property
    def tail(self) -> float:
        """What the waves that the rows do not show add up to, as a part of the greatest value; 1 at most.

        They are taken to fall on as they do over the last eighth of the spectrum, and to be no more than it
        has: waves that do not fall are those of single rows. Above `ENOUGH` the rows are too few.
        """
        last, before = self._waves_in(1), self._waves_in(2)
        if last <= RESOLVED:
            # rounding, which does not fall
            return last
        fall = (last / before) ** (1 / self._share)
        most = len(self.spectrum)
        return min(1.0, last * (min(most, 1 / (1 - fall)) if fall < 1 else most))

    def rows_to(self, tail: float) -> float:
        """How many rows leave such a tail where the waves fall on as they do; infinity where they do not."""
        last, before = self._waves_in(1), self._waves_in(2)
        if last >= before:
            return math.inf
        more = self._share * math.log(min(1.0, tail / last)) / math.log(last / before) if last else 0.0
        return 2.0 * (len(self.spectrum) + more)

    @property
    def _share(self) -> int:
        """How many waves the last eighth has."""
        return max(2, len(self.spectrum) // TAIL_PART)

    def _waves_in(self, place: int) -> float:
        """The greatest wave of an eighth of the spectrum, from its end, as a part of the greatest value."""
        end = len(self.spectrum) - (place - 1) * self._share
        waves = self.spectrum[max(0, end - self._share) : max(1, end)]
        return float(np.abs(waves).max() / self.scale) if self.scale else 0.0

    @property
    def _is_constant(self) -> bool:
        return float(np.abs(self.waves[1:]).max(initial=0.0)) <= CONSTANT * self.scale

    def part(self, columns: int | tuple[int, ...]) -> CycleSeries:
        """One column of a vector as a number, or some as a vector."""
        return CycleSeries(self.rows[:, columns], self.first, self.period)

    def at(self, inputs: Floats, order: int = 0) -> Floats:
        """The quantity, or its derivative of this order by the input, at inputs (m,): (m,) or (m, k)."""
        numbers = np.arange(len(self.waves))
        turn = math.tau / self.period
        phases = np.exp(1j * turn * np.outer(np.asarray(inputs, dtype=np.float64) - self.first, numbers))
        slopes = (1j * turn * numbers) ** order
        return np.asarray((phases * slopes @ self.waves).real)

    def finer(self, factor: int, order: int = 0) -> Floats:
        """The quantity, or its derivative by the input, at `factor` times as many rows."""
        count, numbers = len(self.rows), np.arange(len(self.waves))
        slopes = (1j * math.tau / self.period * numbers) ** order
        waves = (slopes * self.waves.T).T
        waves[1:] /= 2
        return np.asarray(np.fft.irfft(waves * (factor * count), factor * count, axis=0))

    def extremes(self) -> tuple[Floats, Floats]:
        """Inputs and values (m,) of all local extremes, along the cycle; the first row of a constant."""
        if self._is_constant:
            return np.array([self.first]), self.rows[:1]
        steps = FINE * len(self.rows)
        grid: Floats = np.asarray(self.first + self.period / steps * np.arange(steps), dtype=np.float64)
        places = np.empty(0)
        for order in ORDERS:
            edges = np.concatenate([grid, places])
            values = np.concatenate([self.finer(FINE, order), self.at(places, order)])
            along = np.argsort((edges - self.first) / self.period)
            places = self._zeros(edges[along], values[along], order)
            shares = (places - self.first) / self.period
            places = np.asarray(places - self.period * np.floor(shares))[np.argsort(shares % 1.0)]
        return places, self.at(places)

    def highest(self) -> Peak:
        """The highest value: from each finer row that may be next to it to the place between the rows."""
        grid = self.finer(FINE)
        step = self.period / len(grid)
        turns = math.tau / self.period * np.arange(len(self.waves))
        # nowhere between the finer rows it is higher by more than this
        more = float(np.abs(self.waves) @ turns**2) * (step / 2) ** 2 / 2
        tops = (grid >= np.roll(grid, 1)) & (grid > np.roll(grid, -1)) & (grid >= grid.max() - more)
        if self._is_constant or not tops.any():
            return Peak(float(self.rows[0]), self.first)
        centres = np.asarray(self.first + step * np.flatnonzero(tops), dtype=np.float64)
        places = zeros_between(
            lambda x: (self.at(x, 1), self.at(x, 2)),
            np.asarray(centres - step),
            np.asarray(centres + step),
            np.full(len(centres), self.period > 0),
        )
        places = np.concatenate([places, centres])
        places = places - self.period * np.floor((places - self.first) / self.period)
        return highest_of(places, self.at(places))

    def lowest(self) -> Peak:
        """The lowest value."""
        top = CycleSeries(-self.rows, self.first, self.period).highest()
        return Peak(-top.value, top.input)

    def _zeros(self, edges: Floats, values: Floats, order: int) -> Floats:
        """Zeros of a derivative between edges (m,) round the cycle where its values (m,) change sign."""
        signs = values >= 0
        starts = np.flatnonzero(signs != np.roll(signs, -1))
        # the last bracket leads over the first row
        ends = np.append(edges[1:], edges[0] + self.period)

        def function(x: Floats) -> tuple[Floats, Floats]:
            return self.at(x, order), self.at(x, order + 1)

        if not starts.size:
            return np.empty(0)
        return zeros_between(function, edges[starts], ends[starts], signs[starts])

    def mean_of(self, function: Callable[[Floats], Floats]) -> float:
        """The mean of a function of the values, from `DENSE` times as many rows."""
        return float(function(self.finer(DENSE)).mean())

    def running(self) -> CycleSeries:
        """The integral by the input of the quantity less its mean; its own mean is 0."""
        count, numbers = len(self.rows), np.arange(1, len(self.waves))
        waves = np.zeros_like(self.waves)
        waves[1:] = (self.waves[1:].T / (2j * math.tau / self.period * numbers)).T
        # the integral of the wave of every other row is zero at the rows
        waves[count // 2 + count % 2 :] = 0.0
        return CycleSeries(np.fft.irfft(waves * count, count, axis=0), self.first, self.period)

    def squared(self) -> CycleSeries:
        """The squared size: twice the waves, so twice the rows."""
        dense = self.finer(2).reshape(2 * len(self.rows), -1)
        return CycleSeries((dense**2).sum(axis=1), self.first, self.period)


def cycle_series(
    evaluate: Callable[[Floats], Floats] | None, rows: Floats, first: float, period: float
) -> CycleSeries:
    """The series through rows (n,) or (n, k), and through twice as many as long as these are too few.

    `evaluate` takes inputs (m,) and gives values (m,) or (m, k); without it the rows are all. A series that
    `MOST_ROWS` do not resolve is returned with its tail.
    """
    series = CycleSeries(rows, first, period)
    while evaluate is not None and series.tail > RESOLVED and 2 * len(series.rows) <= MOST_ROWS:
        count = len(series.rows)
        between = evaluate(first + period * (np.arange(count) + 0.5) / count)
        series = CycleSeries(
            np.stack([series.rows, between], axis=1).reshape(2 * count, *rows.shape[1:]), first, period
        )
    return series


def filled(rows: Floats, missing: npt.NDArray[np.bool_]) -> Floats:
    """Rows (n, k) round a cycle, missing ones with values that leave least in the upper half of the waves.

    Of a smooth quantity, of which the upper half is rounding, these are its own values to rounding.
    """
    count = len(rows)
    known = np.where(missing[:, None], 0.0, rows)
    places = np.flatnonzero(missing)
    alone = np.zeros((count, len(places)))
    alone[places, np.arange(len(places))] = 1.0
    upper = slice(count // 4 + 1, None)
    waves, by = (np.fft.rfft(part, axis=0)[upper] for part in (known, alone))
    both = np.concatenate([by.real, by.imag]), np.concatenate([waves.real, waves.imag])
    known[places] = -np.linalg.lstsq(*both, rcond=None)[0]
    return known
