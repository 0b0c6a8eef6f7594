"""The linkage: joints, fixed transforms, points, drive; a frozen value that asks the core for its motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar import _core
from sevenbar.errors import NotCoveredError, RequestError, no_joint, shown
from sevenbar.motion import (
    SPIN_UNDEFINED,
    STATUSES,
    Circuit,
    DeadCentre,
    Extremes,
    Floats,
    Law,
    Modes,
    Motion,
    Output,
    Trace,
    finite_array,
)
from sevenbar.units import turning_speed

#: Most samples a turn; beyond, the arrays of one motion would not fit into the memory of a desk machine.
MOST_SAMPLES = 1_000_000


@dataclass(frozen=True)
class Joint:
    """A joint: its kind (R P H C U S) and its name."""

    kind: str
    name: str

    @property
    def columns(self) -> tuple[str, ...]:
        """One name for each of its freedoms."""
        freedoms = {"R": 1, "P": 1, "H": 1, "C": 2, "U": 2, "S": 3}[self.kind]
        return (self.name,) if freedoms == 1 else tuple(f"{self.name}.{k}" for k in range(1, freedoms + 1))


@dataclass(frozen=True)
class Point:
    """A named point: the link that carries it, counted from 1, and where on it [length]."""

    name: str
    link: int
    at: tuple[float, float, float]


@dataclass(frozen=True)
class Drive:
    """The input joint, the output joint, and the input's speed [rad/s]."""

    joint: str
    output: str
    speed: float = 1.0


@dataclass(frozen=True, eq=False)
class Linkage:
    """A closed loop `base Z(q1) G1 Z(q2) G2 .. Z(qn) = ground`.

    `base` (4, 4) is the frame of joint 1 and `ground` (4, 4) that of the ground's side of the last joint,
    both in the report frame. `links` (n - 1, 4, 4) are the G's of the moving links, from each joint's frame
    to the next one's. `point_frames` (n, 4, 4) take a point as it is written to its link's own frame.
    `dimensions` are the named numbers of the form it was written in.
    """

    name: str
    joints: tuple[Joint, ...]
    base: Floats
    ground: Floats
    links: Floats
    point_frames: Floats
    drive: Drive
    length_unit: str = "mm"
    points: tuple[Point, ...] = ()
    dimensions: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for array in (self.base, self.ground, self.links, self.point_frames):
            array.setflags(write=False)

    @property
    def transforms(self) -> Floats:
        """The G's of all links (n, 4, 4), the ground's last: `Z(q1) G1 .. Z(qn) Gn = 1`."""
        return np.concatenate([self.links, [inverse(self.ground) @ self.base]])

    @property
    def kind(self) -> str:
        """The joints' letters in loop order."""
        return "".join(joint.kind for joint in self.joints)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the one-freedom joints, in loop order."""
        return tuple(column for joint in self.joints for column in joint.columns)

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Crank, coupler and rocker [length]."""
        crank, coupler, rocker = self._rssr.lengths
        return crank, coupler, rocker

    @cached_property
    def _rssr(self) -> _core.Rssr:
        if self.kind != "RSSR":
            raise NotCoveredError(
                f"a loop {' '.join(self.kind)} is not analysed by this version; it takes R S S R"
            )
        return _core.Rssr(self.base, self.ground, self.links)

    def side(self, joint: str | None, default: str, key: str) -> str:
        """The core's word for a turning joint named by the caller."""
        name = default if joint is None else joint
        known = [j.name for j in self.joints]
        if name not in known:
            raise RequestError(f"{key}: {no_joint(name, known)}")
        index = known.index(name)
        if index not in (0, len(known) - 1):
            raise RequestError(
                f"{key}: joint '{name}' is a ball; "
                f"give a joint that turns about one axis: {known[0]} or {known[-1]}"
            )
        return "crank" if index == 0 else "rocker"

    def sides(self, input: str | None, output: str | None) -> tuple[str, str, str]:
        """The core's word for the input, and the names of input and output."""
        side = self.side(input, self.drive.joint, "input")
        ends = (self.joints[0].name, self.joints[-1].name)
        names = ends if side == "crank" else ends[::-1]
        # without a word on it, the output is the other turning joint
        if output is not None and self.side(output, output, "output") == side:
            raise RequestError(
                f"output: joint '{output}' is the input; the output is the other one, {names[1]}"
            )
        return side, *names

    def _speed(self, speed: object) -> float:
        if speed is None:
            return self.drive.speed
        try:
            return turning_speed(float(speed) if isinstance(speed, np.number) else speed)
        except RequestError as error:
            raise RequestError(f"speed: {error}") from None

    def output(
        self,
        values: npt.ArrayLike,
        order: int = 0,
        speed: npt.ArrayLike | str | None = None,
        *,
        acceleration: npt.ArrayLike | None = None,
        jerk: npt.ArrayLike | None = None,
        input: str | None = None,
    ) -> Output:
        """Both branches of the other joint at many inputs: the closed form, vectorised.

        `values` (n,) [rad] are inputs; `order` 0 to 3 how many derivatives. The input moves at `speed`
        [rad/s] (the drive's where none is given); `speed`, `acceleration` [rad/s^2] and `jerk` [rad/s^3]
        may also be arrays (n,), an input law. Branch 0 of `beta = f(alpha)` is eq. (8) of Sun and Zhou;
        with `input` the last joint, branch 0 of `alpha = phi(beta)` is eq. (9).

        Raises `RequestError` for values that are not finite, lengths that differ, an order out of range.

            >>> import sevenbar as sb
            >>> linkage = sb.rssr(M=700, N=700, L1=250, L3=550)
            >>> round(float(linkage.output([0.3]).position[0, 0]), 6)
            -0.084963

        Source: Sun and Zhou, eq. (8), (9), and (12), (13) with their signs mended.
        """
        side, _, _ = self.sides(input, None)
        array = np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
        if isinstance(order, bool) or not isinstance(order, (int, np.integer)) or not 0 <= order <= 3:
            raise RequestError(f"order: {shown(order)} is not offered; give 0 to 3")
        law = None
        constant = 1.0
        plain = speed is None or isinstance(speed, str) or np.ndim(speed) == 0
        if plain and acceleration is None and jerk is None:
            constant = self._speed(speed)
        else:
            first = self._speed(speed) if plain else speed
            rates = {"speed": first, "acceleration": acceleration, "jerk": jerk}
            law = tuple(
                _rate(name, 0.0 if value is None else value, array.size) for name, value in rates.items()
            )
        results = [np.empty((2, array.size)) for _ in range(order + 1)]
        try:
            self._rssr.outputs(array, results, side, constant, law)
        except _core.CoreError as error:
            raise RequestError(str(error)) from None
        return Output(*results)

    def assembly_modes(self, theta: float, *, input: str | None = None) -> Modes:
        """Every assembly mode at one input [rad], by the closed form; none where the loop does not close."""
        side, _, _ = self.sides(input, None)
        (value,) = finite_array("theta", theta)
        q, residual = self._rssr.assembly_modes(value, side)
        return Modes(q, residual * self._rssr.size, "closed-form", self.columns, value)

    def motion(
        self,
        samples: int = 360,
        *,
        input: str | None = None,
        output: str | None = None,
        speed: float | str | None = None,
        law: Law | None = None,
    ) -> Motion:
        """Every circuit over the whole input range.

        `samples` inputs in a full turn. The input moves at `speed` [rad/s], the drive's where none is
        given, or by a `law`, whose samples then take the place of the grid: a circuit that rocks holds them
        once for each of its two passes.
        """
        side, input_name, output_name = self.sides(
            input, self.drive.output if output is None and input is None else output
        )
        if (
            isinstance(samples, bool)
            or not isinstance(samples, (int, np.integer))
            or not 4 <= samples <= MOST_SAMPLES
        ):
            raise RequestError(f"samples: {shown(samples)} is not a count; give 4 to {MOST_SAMPLES}")
        rate = self._speed(speed)
        table = None if law is None else np.column_stack([law.q, law.dq, law.ddq, law.dddq])
        raw = self._rssr.motion(side, int(samples), rate, table)
        ends = (0, len(self.columns) - 1)
        columns = ends if side == "crank" else ends[::-1]
        return Motion(
            linkage=self,
            input=input_name,
            output=output_name,
            speed=math.nan if law is not None else rate,
            samples=int(samples),
            motion_type=raw["motion_type"],
            limits=raw["limits"],
            change_points=raw["change_points"],
            circuits=tuple(self._circuit(i, c, columns, rate, law) for i, c in enumerate(raw["circuits"])),
            completeness="closed-form",
            idle=self.idle,
            redundant=(),
            law=law,
        )

    @property
    def idle(self) -> tuple[str, ...]:
        """Freedoms that move no other link."""
        first, second = self.joints[1].name, self.joints[2].name
        return (f"spin of the coupler (link 2) about the line of {first} and {second}",)

    def _circuit(
        self, index: int, raw: Mapping[str, Any], columns: tuple[int, int], speed: float, law: Law | None
    ) -> Circuit:
        q, dq, ddq, dddq = raw["joints"]
        input_column, output_column = columns
        status = np.array(STATUSES)[raw["status"]]
        if law is None:
            time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(q[:, input_column])))]) / abs(speed)
            velocity = _scaled(raw["velocity"], speed)
            acceleration = _scaled(raw["acceleration"], speed * speed)
        else:
            time = np.tile(law.t, len(q) // law.t.size)
            velocity = _sampled(dq[:, output_column], q[:, input_column])
            acceleration = _sampled(ddq[:, output_column], q[:, input_column])
        (least, least_at), (greatest, greatest_at) = raw["transmission"]
        change_point = raw["motion_type"] == "change-point"
        return Circuit(
            index=index,
            motion_type=raw["motion_type"],
            closed=True,
            turns=raw["turns"],
            columns=self.columns,
            q=q,
            dq=dq,
            ddq=ddq,
            dddq=dddq,
            time=time,
            status=status,
            branch=raw["branch"],
            mode=raw["mode"],
            residual=raw["residual"] * self._rssr.size,
            condition=raw["condition"],
            dead_centres=tuple(DeadCentre(*d) for d in raw["dead_centres"]),
            input_range=raw["input"],
            output_range=_followed_range(q[:, output_column]) if change_point else raw["output"],
            transmission=Extremes(least, least_at, greatest, greatest_at),
            velocity=velocity,
            acceleration=acceleration,
            input_column=input_column,
            output_column=output_column,
            _point=self._trace,
        )

    def _trace(self, link: int, at: tuple[float, float, float], rates: Floats) -> Trace:
        """A point along rows of the first and last joint's angles with derivatives, (n, 2, 4)."""
        count = len(self.joints)
        if isinstance(link, bool) or not isinstance(link, (int, np.integer)) or not 1 <= link <= count:
            raise RequestError(
                f"link: {shown(link)} is not a link; give 1 to {count}, the last is the ground"
            )
        place = finite_array("at", at)
        if place.size != 3:
            raise RequestError(f"at: {place.size} numbers; give three")
        frame = self.point_frames[link - 1]
        own = frame[:3, :3] @ place + frame[:3, 3]
        crank, rocker = (np.ascontiguousarray(rates[:, end]) for end in (0, 1))
        position, velocity, acceleration, jerk = self._rssr.point(int(link), own, crank, rocker)
        status = np.full(len(rates), "ok", dtype="<U15")
        status[np.isnan(velocity[:, 0])] = "dead-centre"
        unsolved = np.isnan(rates[:, :, 0]).any(axis=1)
        status[np.isnan(position[:, 0])] = SPIN_UNDEFINED
        status[unsolved] = "no-solution"
        return Trace(position, velocity, acceleration, jerk, status)


def _rate(name: str, value: npt.ArrayLike, count: int) -> Floats:
    array = finite_array(name, value)
    if array.size not in (1, count):
        raise RequestError(
            f"{name}: {array.size} values where the input has {count}; give {count}, or one number"
        )
    return np.ascontiguousarray(np.broadcast_to(array, (count,)))


def _scaled(raw: list[tuple[float, float]] | None, factor: float) -> Extremes | None:
    if raw is None:
        return None
    ends = sorted((value * factor, at) for value, at in raw)
    return Extremes(*ends[0], *ends[1])


def _followed_range(angles: Floats) -> tuple[float, float] | None:
    """The range of an output as sampled along its circuit; `None` where it gains a turn."""
    if not np.isfinite(angles).all() or abs(angles[-1] - angles[0]) > math.pi:
        return None
    return float(angles.min()), float(angles.max())


def _sampled(values: Floats, inputs: Floats) -> Extremes | None:
    """Extremes as sampled: all that a law given by samples can tell."""
    if np.isnan(values).all():
        return None
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return Extremes(float(values[low]), float(inputs[low]), float(values[high]), float(inputs[high]))


def pose(rotation: npt.ArrayLike, origin: npt.ArrayLike) -> Floats:
    """The homogeneous matrix (4, 4) with these columns of axes and this origin."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = origin
    return matrix


def inverse(matrix: Floats) -> Floats:
    """The inverse of a rigid motion."""
    rotation = matrix[:3, :3].T
    return pose(rotation, -rotation @ matrix[:3, 3])
