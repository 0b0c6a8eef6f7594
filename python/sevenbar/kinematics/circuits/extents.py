"""How far a circuit takes its joints, balls and links, and what part of it lies within the stops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Peak
from sevenbar.errors import ends_here
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


class WithExtents:
    """What a circuit says of how far it takes its joints and links: found exactly, where rates are zero."""

    _answers: Any

    if TYPE_CHECKING:

        def fleeting(self) -> Any:
            """The circuit for one look at its rows."""

    @cached_property
    def joint_ranges(self) -> Mapping[str, JointRange]:
        """The range of every column but a ball's [rad, or length], by its name.

        Raises `RequestError` where the circuit cannot be followed, or the linkage has no description.

            >>> import math
            >>> import sevenbar as sb
            >>> rocker = sb.load("planar_4r").motion().circuits[0].joint_ranges["theta_4"]
            >>> round(math.degrees(rocker.extent), 6)
            69.937942
        """
        found: Mapping[str, JointRange] = self._answers.joint_ranges(self.fleeting())
        return found

    @cached_property
    def ball_cones(self) -> Mapping[str, BallCone]:
        """How far each ball and universal joint is bent, by its name: seats are those of the linkage's stops.

        >>> import math
        >>> import sevenbar as sb
        >>> cones = sb.load("rssr").motion().circuits[0].ball_cones
        >>> {name: round(math.degrees(cone.spread), 3) for name, cone in cones.items()}
        {'ball_a': 59.393, 'ball_b': 27.025}

        Source: docs/theory_measures.md, (12) and (13).
        """
        found: Mapping[str, BallCone] = self._answers.ball_cones(self.fleeting())
        return found

    @property
    def bends(self) -> Mapping[str, Floats]:
        """The bend [rad] of each ball and universal joint on each row (n,), by its name.

        The angle between seat and stud of `ball_cones`; NaN on rows in which a ball's turns are undefined.
        """
        found: Mapping[str, Floats] = self._answers.bends(self.fleeting())
        return found

    @ends_here
    def ball_cone(
        self,
        joint: str,
        *,
        seat: tuple[float, float, float] | None = None,
        stud: tuple[float, float, float] | None = None,
    ) -> BallCone:
        """How far one joint is bent between a `seat` on the link before it and a `stud` on the link after.

        Directions are written as points of their links are; with none given they are those of the linkage's
        stops. Left out there, too, the stud is the rod of the link after,
        and the seat the direction from which the greatest angle is least; of a ball after an idle link the
        other way round. Raises `RequestError` for a joint that has no cone, and a direction that an idle spin
        moves.

            >>> import math
            >>> import sevenbar as sb
            >>> circuit = sb.load("rssr").motion().circuits[0]
            >>> cone = circuit.ball_cone("ball_a", seat=(0, 0, -1))  # the coupler against the crank's axis
            >>> round(math.degrees(cone.least.value), 3), round(math.degrees(cone.greatest.value), 3)
            (39.739, 79.047)
        """
        found: BallCone = self._answers.ball_cone(self.fleeting(), joint, {"seat": seat, "stud": stud})
        return found

    @cached_property
    def clearances(self) -> tuple[Clearance, ...]:
        """The least distance of every two links that share no joint, as rods between their joints' places.

        The ground is one of them where it has a radius.

        Source: docs/theory_measures.md, (14) and (15).

            >>> import sevenbar as sb
            >>> one, = sb.load("rssr").motion().circuits[0].clearances
            >>> one.links, round(one.distance.value, 3)
            ((1, 3), 753.55)
        """
        found: tuple[Clearance, ...] = self._answers.clearances(self.fleeting())
        return found

    @cached_property
    def allowed(self) -> Allowed:
        """The parts of the circuit within its linkage's stops: ranges, cones, and links that do not meet.

        All of it where there are none.

            >>> import sevenbar as sb
            >>> linkage = sb.load("rssr").stopped(cones={"ball_b": "20 deg"})
            >>> found = linkage.motion().circuits[0].allowed
            >>> [span.last_stop for span in found.spans], round(found.share, 3)
            (['cone of ball_b', 'cone of ball_b'], 0.545)
        """
        found: Allowed = self._answers.allowed(self.fleeting())
        return found
