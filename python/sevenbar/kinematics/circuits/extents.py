"""How far a circuit takes its joints, balls and links, and what part of it lies within the stops."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from sevenbar.curves.curve import Peak
from sevenbar.kinematics.loop.stops import Three

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class JointRange:
    """The lowest and highest value of a column [rad, or length], each with the input at which it occurs.

    `turns`: it is an angle. Both are `None` for a joint that turns, or runs as a nut does, on and on.
    """

    column: str
    turns: bool
    low: Peak | None
    high: Peak | None

    @property
    def endless(self) -> bool:
        """Whether the joint comes back whole turns on when the circuit closes."""
        return self.low is None

    @property
    def extent(self) -> float | None:
        """High less low [rad, or length]; `None` where it is endless."""
        return None if self.low is None or self.high is None else self.high.value - self.low.value


@dataclass(frozen=True)
class BallCone:
    """How far a ball or universal joint is bent along a circuit.

    `least` and `greatest` [rad] are the extremes of the angle between `seat`, on the link before, and `stud`,
    on the link after, as points of these are written. `middle` is the direction from which the greatest
    angle is least, `spread` [rad]: the axis of the smallest cone about the other one, and the seat (of a
    ball after an idle link the stud) where none is given. `limit` is the cone of the file.
    """

    joint: str
    seat: Three
    stud: Three
    least: Peak
    greatest: Peak
    middle: Three
    middle_of: Literal["seat", "stud"]
    spread: float
    limit: float | None = None


@dataclass(frozen=True)
class Clearance:
    """The least distance [length] of two links as rods, and what is left of it between their `radii`.

    It may be less by `missed`: more than 0 where the distance rests near its least over much of the circuit.
    """

    links: tuple[int, int]
    distance: Peak
    radii: float = 0.0
    missed: float = 0.0

    @property
    def gap(self) -> float:
        """The distance less both radii [length]; negative where the links would meet."""
        return self.distance.value - self.radii


@dataclass(frozen=True)
class AllowedSpan:
    """A part of a circuit within all stops, from an input to an input along it.

    `first_stop` and `last_stop` say what ends it: "range of crank", "cone of ball_a", "links 1 and 3"; empty
    where the circuit itself ends. `share` is its part of the circuit by length; at so many `dead_centres` on
    the way the input turns back.
    """

    start: float
    end: float
    first_stop: str
    last_stop: str
    share: float
    dead_centres: int = 0


@dataclass(frozen=True, eq=False)
class Allowed:
    """The parts of a circuit within its stops, in order; all of it, one span without stops, has share 1.

    `within` (n,) says it of each row of the circuit, `stopped_by` (n,) which stops forbid a row, else "".
    """

    spans: tuple[AllowedSpan, ...]
    within: Flags = field(repr=False)
    stopped_by: npt.NDArray[np.str_] = field(repr=False)

    @property
    def share(self) -> float:
        """What part of the circuit they are by length, 0 to 1."""
        return float(min(1.0, sum(span.share for span in self.spans)))

    @property
    def whole(self) -> bool:
        """Whether nothing ends it."""
        return len(self.spans) == 1 and not (self.spans[0].first_stop or self.spans[0].last_stop)
