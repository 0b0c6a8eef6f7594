"""The values that a circuit gives: extremes, dead centres, points along it, its rows counted, derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from sevenbar.arrays import Floats, ReadOnly, Words
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
class Trace(ReadOnly, Printed):
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


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(ReadOnly, Printed):
    """Derivatives of a circuit by the k numbers of its linkage's description, on its n rows.

    `names` and `units` (k,) are those of the numbers, as in the file. `position` (n, columns, k) [rad, or
    length, by the number's unit], `velocity` and `acceleration` by time at the circuit's own input, which
    stays as it is; of a ball's turns there is the position only. `points` has each named point's derivative
    (n, 3, k), `point_velocities` that of its velocity. NaN in rows without rates (`status` says why), for
    numbers that open the loop if they change alone (`opening`), and for what spins idly.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    columns: tuple[str, ...]
    position: Floats
    velocity: Floats
    acceleration: Floats
    points: Mapping[str, Floats]
    point_velocities: Mapping[str, Floats]
    opening: tuple[str, ...]
    status: Words
