"""What a circuit is asked of how far it takes its joints, balls and links."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

from sevenbar.arrays import Floats
from sevenbar.errors import ends_here
from sevenbar.kinematics.loop.stops import Cone

if TYPE_CHECKING:
    from sevenbar.kinematics.circuits.extents import Allowed, BallCone, Clearance, JointRange


class ExtentAnswers(Protocol):
    """What a circuit asks its linkage of it."""

    def joint_ranges(self, circuit: Any) -> Mapping[str, JointRange]:
        """Of every column but a ball's."""

    def ball_cones(self, circuit: Any) -> Mapping[str, BallCone]:
        """Of balls and universal joints."""

    def ball_cone(self, circuit: Any, joint: str, given: Cone | None) -> BallCone:
        """Of one, between directions that are given."""

    def bends(self, circuit: Any) -> Mapping[str, Floats]:
        """Of each on its rows (n,) [rad]."""

    def clearances(self, circuit: Any) -> tuple[Clearance, ...]:
        """Of links that share no joint."""

    def allowed(self, circuit: Any) -> Allowed:
        """What is within the stops."""


class WithExtents:
    """What a circuit says of how far it takes its joints and links: found exactly, where rates are zero."""

    if TYPE_CHECKING:

        @property
        def _answers(self) -> ExtentAnswers: ...

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
        return self._answers.joint_ranges(self.fleeting())

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
        return self._answers.ball_cones(self.fleeting())

    @property
    def bends(self) -> Mapping[str, Floats]:
        """The bend [rad] of each ball and universal joint on each row (n,), by its name.

        The angle between seat and stud of `ball_cones`; NaN on rows in which a ball's turns are undefined.
        """
        return self._answers.bends(self.fleeting())

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
        given = None if seat is None and stud is None else Cone(None, seat, stud)
        return self._answers.ball_cone(self.fleeting(), joint, given)

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
        return self._answers.clearances(self.fleeting())

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
        return self._answers.allowed(self.fleeting())
