"""The values that a circuit gives: extremes, dead centres, points along it, its rows counted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from sevenbar.arrays import Floats, Words
from sevenbar.text.printing import Printed

#: What a row can hold, by the core's number: all; the pose but no rates (two reasons); nothing; all but the
#: balls' turns, which a row with the pose but no rates may lack, too.
STATUSES = ("ok", "dead-centre", "change-point", "no-solution", "turns-undefined")

#: The status of a row of a trace on the coupler where the spin's rule names no direction.
SPIN_UNDEFINED = "spin-undefined"


@dataclass(frozen=True)
class Extremes:
    """The lowest and the highest value of a quantity, and the input [rad] at which each occurs."""

    lowest: float
    lowest_at: float
    highest: float
    highest_at: float


@dataclass(frozen=True)
class DeadCentre:
    """A pose where the input (`kind` "input") or the output ("output") stands still.

    `input` and `output` are the two angles [rad], `branch` the pass on which it lies, `condition` how much
    a relative change of the squared dimensions is magnified in its place.
    """

    kind: Literal["input", "output"]
    input: float
    output: float
    branch: int
    condition: float


@dataclass(frozen=True, eq=False, repr=False)
class Trace(Printed):
    """A point of a link along a circuit, in the report frame; arrays of shape (n, 3).

    `position` [length], `velocity` [length/s], `acceleration` [length/s^2], `jerk` [length/s^3]. Rows
    without a value are NaN, with a status.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats
    status: Words


@dataclass(frozen=True)
class Tally:
    """How many rows a circuit has, how many of each status, and their greatest closure error [length]."""

    rows: int
    statuses: Mapping[str, int]
    #: NaN where no row has one.
    residual: float
