"""The passes that measured rows run through: where the input turns back, and what may follow there.

An input that rocks goes up on one pass of a circuit and, beyond its dead centre, comes down on the next. Rows
that were measured in order show where it turns back; whether it did so at its dead centre, and so on to the
next pass, or before it, on the same pass, the differences decide: each rule is a candidate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from sevenbar.arrays import Floats, Integers

#: Share of an input's travel by which it goes back where it turns; less is noise.
TURNS_BACK = 0.01


#: Rows of a stretch, on average, below which rows are in no order.
LEAST_ROWS = 4

#: Differences of this share of the measured range are no small ones: something else is wrong.
UNEXPLAINED = 0.1

#: Share of the rows that may lie beyond a limit of the input, which errors of the dimensions move.
MAY_BE_OPEN = 0.1


@dataclass(frozen=True)
class PassFit:
    """A pass of a circuit and its residual: the rms of differences relative to each measured range.

    Where the rows turn back and go on to another pass, `branches` has the pass of each stretch between two
    turns, and `branch` is the first of them.
    """

    circuit: int
    branch: int
    #: Whole turns of the input at which the data begin, for a circuit that closes after several.
    turn: int
    residual: float
    #: Rows whose input does not close the loop on this pass, and what share they are.
    open_rows: int
    open_share: float = 0.0
    phase: float = 0.0
    offset: float = 0.0
    branches: tuple[int, ...] = ()
    #: Whether velocities change their sign where the input goes back; those of `motion.csv` do not.
    signed: bool = False
    #: The residual of the rows that close alone.
    closed_residual: float = 0.0

    @property
    def explains(self) -> bool:
        """Whether it explains the rows: all but few close, and these with small differences."""
        return self.closed_residual <= UNEXPLAINED and self.open_share <= MAY_BE_OPEN

    @property
    def key(self) -> Key:
        """What it is a fit of, whatever its phase and offset."""
        return Key(self.circuit, self.branches or (self.branch,), self.turn)


@dataclass(frozen=True, order=True)
class Key:
    """A way through a circuit: the pass of each stretch of the rows, one for all where they do not change."""

    circuit: int
    branches: tuple[int, ...]
    turn: int


@dataclass(frozen=True)
class Stretches:
    """Rows between turns of their input: `of_row` (n,) counts them, `rising` says how each goes."""

    of_row: Integers
    rising: tuple[bool, ...] = field(default=(True,))

    def __len__(self) -> int:
        return len(self.rising)

    @property
    def in_order(self) -> bool:
        """Whether the rows can be in the order of the motion, which turns back now and then only."""
        return len(self) * LEAST_ROWS <= len(self.of_row)

    @property
    def turns(self) -> list[int]:
        """The last row of each stretch but the last."""
        return np.flatnonzero(np.diff(self.of_row)).tolist()


def stretches_of(inputs: Floats, *, slides: bool) -> Stretches:
    """The stretches of rows at inputs (n,) in the order of their measurement.

    >>> stretches_of(np.array([0.0, 0.5, 1.0, 1.5, 0.8, 0.1]), slides=False).of_row.tolist()
    [0, 0, 0, 0, 1, 1]
    """
    # a jump of half a turn between two rows is one from 180 to -180 degrees
    travel = inputs if slides else np.unwrap(inputs)
    least = TURNS_BACK * float(np.ptp(travel))
    ends: list[int] = []
    rising: list[bool] = []
    low = high = 0
    for row, value in enumerate(travel.tolist()):
        if value > travel[high]:
            high = row
        if value < travel[low]:
            low = row
        up = rising[-1] if rising else None
        # the turn is at the extreme, known once the input has gone back from there
        if up is not False and travel[high] - value > least:
            if up:
                ends.append(high)
            rising.append(False)
            low, high = row, row
        elif up is not True and value - travel[low] > least:
            if up is False:
                ends.append(low)
            rising.append(True)
            low, high = row, row
    of_row = np.searchsorted(np.array(ends, dtype=np.int64), np.arange(len(travel)), side="left")
    return Stretches(of_row.astype(np.int64), tuple(rising) or (True,))


def ways_through(stretches: Stretches, passes: int) -> list[tuple[int, ...]]:
    """The passes that stretches of rows may be of, for a circuit with so many passes.

    One pass for all rows; and, where the input turns back, those on which it goes on to the next pass at its
    upper turns, its lower turns, or both. Rows in no order are of one pass.
    """
    result: list[tuple[int, ...]] = [(branch,) for branch in range(passes)]
    if len(stretches) < 2 or passes < 2 or not stretches.in_order:
        return result
    # beyond two passes the walk along the circuit has a direction
    directions: Sequence[int] = (1,) if passes == 2 else (1, -1)
    for first, direction, goes_on in product(
        range(passes), directions, ((True, True), (True, False), (False, True))
    ):
        way, step = [first], direction
        for rising in stretches.rising[:-1]:
            if goes_on[0] if rising else goes_on[1]:
                way.append((way[-1] + step) % passes)
            else:
                # back along the same pass
                way.append(way[-1])
                step = -step
        if tuple(way) not in result and len(set(way)) > 1:
            result.append(tuple(way))
    return result
