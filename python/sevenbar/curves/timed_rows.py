"""A quantity at rows in time, nothing known between them: the greatest row, means by trapezoids."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Peak, highest_of


def shares_of(time: Floats) -> Floats:
    """The share of each row (n,) in a mean by time, by trapezoids: `(t_(j+1) - t_(j-1)) / 2` of the whole.

    >>> shares_of(np.array([0.0, 1.0, 4.0])).tolist()
    [0.125, 0.5, 0.375]
    """
    if len(time) < 2:
        return np.full(len(time), 1.0)
    steps = np.diff(time, prepend=time[0], append=time[-1])
    shares: Floats = (steps[:-1] + steps[1:]) / (2 * (time[-1] - time[0]))
    return shares


@dataclass(frozen=True, eq=False)
class TimedRows:
    """A quantity of which nothing is known between its rows in time.

    `rows` (n,) or (n, k) at `time` (n,) [s] and `input` (n,) [rad, or length].
    """

    rows: Floats
    input: Floats
    time: Floats

    @property
    def tail(self) -> float:
        """NaN: what lies between rows of a law nobody knows."""
        return float("nan")

    def part(self, columns: int | tuple[int, ...]) -> TimedRows:
        """One column of a vector as a number, or some as a vector."""
        return TimedRows(self.rows[:, columns], self.input, self.time)

    def extremes(self) -> tuple[Floats, Floats]:
        """Inputs and values (m,) of the rows that no neighbour exceeds to either side, both ends too."""
        steps = np.sign(np.diff(self.rows))
        selected = np.ones(len(self.rows), dtype=bool)
        selected[1:-1] = steps[:-1] * steps[1:] <= 0
        return self.input[selected], self.rows[selected]

    def highest(self) -> Peak:
        """The greatest row."""
        return highest_of(self.input, self.rows)

    def lowest(self) -> Peak:
        """The least row."""
        top = highest_of(self.input, -self.rows)
        return Peak(-top.value, top.input)

    def mean_of(self, function: Callable[[Floats], Floats]) -> float:
        """The mean by time of a function of the rows."""
        return float(shares_of(self.time) @ function(self.rows))

    def running(self) -> TimedRows:
        """The integral by time of the quantity less its mean, by trapezoids."""
        centred = self.rows - self.mean_of(lambda values: values)
        gains = np.diff(self.time) * (centred[:-1] + centred[1:]) / 2
        return TimedRows(np.concatenate([[0.0], np.cumsum(gains)]), self.input, self.time)

    def squared(self) -> TimedRows:
        """The squared size of every row."""
        return TimedRows((self.rows**2).reshape(len(self.rows), -1).sum(axis=1), self.input, self.time)
