"""One pose of a circuit with joint values and rates, points, links, forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.link_motion import LinkMotion
from sevenbar.kinematics.loop.columns import column_named
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.printing import Printed

if TYPE_CHECKING:
    from sevenbar.forces.result import Forces, Reaction
    from sevenbar.kinematics.circuits.extents import Allowed


class AnsweringRows(Protocol):
    """The circuit whose row a pose is: what it answers by row."""

    @property
    def transmission_angle(self) -> Floats | None:
        """On each row (n,) [rad]."""

    @property
    def mechanical_advantage(self) -> Floats:
        """On each row (n,)."""

    @property
    def allowed(self) -> Allowed:
        """Which rows are within the stops."""

    def point(self, link: int | str, at: Sequence[float] | None = None) -> Trace:
        """A point along the rows."""

    def link_motion(self, link: int) -> LinkMotion:
        """How a link turns along the rows."""

    def forces(self, *, at_rest: bool = False) -> Forces:
        """What acts on the rows."""


@dataclass(frozen=True, eq=False, repr=False)
class OnePose(Printed):
    """One pose on a circuit, with the rates of all joints; rates without a value are NaN, with a `status`.

    `q` (columns,) [rad in (-pi, pi], or length], `dq`, `ddq`, `dddq` its derivatives by time where the input
    has this `speed` and `acceleration` [rad/s, rad/s^2, or lengths]. `circuit` and `branch` are the numbers
    of the circuit and of the pass on which it lies, `residual` the closure error [length].
    """

    columns: tuple[str, ...]
    input: str
    output: str
    speed: float
    acceleration: float
    circuit: int
    branch: int
    status: str
    q: Floats
    dq: Floats
    ddq: Floats
    dddq: Floats
    residual: float
    #: Freedoms that move no other link, held by convention.
    idle: tuple[str, ...]
    _linkage: Loop = field(repr=False)
    _rows: AnsweringRows = field(repr=False)
    _row: int = field(repr=False)

    def __getitem__(self, name: str) -> float:
        """The value of a joint [rad in (-pi, pi], or length] by its column."""
        return float(self.q[column_named(self.columns, name)])

    def point(self, link: int | str, at: Sequence[float] | None = None) -> Trace:
        """A point by its name, or of a link; see `Circuit.point`: a trace of one row."""
        result = self._rows.point(link, at)
        rows = slice(self._row, self._row + 1)
        return Trace(
            result.position[rows], result.velocity[rows], result.acceleration[rows], result.jerk[rows],
            result.status[rows],
        )  # fmt: skip

    @cached_property
    def points(self) -> Mapping[str, Trace]:
        """The named points, traces of one row each."""
        return {point.name: self.point(point.name) for point in self._linkage.points}

    @cached_property
    def links(self) -> Mapping[int, LinkMotion]:
        """How each moving link turns, by its number, one row each: rotation and angular rates."""
        rows, result = slice(self._row, self._row + 1), {}
        for link in self._linkage.graph.moving:
            whole = self._rows.link_motion(link)
            result[link] = LinkMotion(whole.rotation[rows], whole.velocity[rows], whole.acceleration[rows])
        return result

    @property
    def transmission_angle(self) -> float | None:
        """The transmission angle [rad]; `None` where it is not defined."""
        angles = self._rows.transmission_angle
        return None if angles is None else float(angles[self._row])

    @property
    def mechanical_advantage(self) -> float:
        """Torque or force of the output over that of the input; see `Circuit.mechanical_advantage`."""
        return float(self._rows.mechanical_advantage[self._row])

    @property
    def stopped_by(self) -> str:
        """The stops of the linkage that the pose lies beyond, as "range of crank"; empty within them."""
        if not self._linkage.stops.stops:
            return ""
        return str(self._rows.allowed.stopped_by[self._row])

    def forces(self, *, at_rest: bool = False) -> Forces | None:
        """The forces in this pose, of one row; `None` where the linkage has no body, load or spring.

        With `at_rest` nothing has inertia and dampers do nothing.
        """
        if self._linkage.loading.is_empty:
            return None
        return self._rows.forces(at_rest=at_rest).on(slice(self._row, self._row + 1))

    @cached_property
    def _acting(self) -> Forces | None:
        return self.forces()

    @property
    def torque(self) -> float | None:
        """What the input has to give [N m, of a slide N]; `None` where nothing acts."""
        return None if self._acting is None else float(self._acting.torque[0])

    @property
    def reactions(self) -> Mapping[str, Reaction]:
        """What each joint bears, by its name, of one row; empty where nothing acts."""
        return {} if self._acting is None else self._acting.reactions
