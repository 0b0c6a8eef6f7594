"""Rigid motions that depend on numbers of a description, with the twists by which each number moves them.

A number that changes by dp moves what stands behind a factor by the twist w dp in the frame there, and that
goes through all behind it:

    dF = F w dp,        F = A B:  w = Ad(B^-1) w_A + w_B                                                  (1)

Source: docs/theory_design.md, (2).
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Protocol

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.kinematics.rigid import ON_AXIS, about, adjoint, cross, frame_about, inverse, pose, unit

#: A place in a description: keys of tables, and counts from 0 in lists.
Place = tuple[str | int, ...]

#: Twists (6,) by the places of the numbers that one of moves so.
Moves = dict[Place, Floats]

#: Axes of a frame, and unit twists.
_AXES, _TWISTS = np.eye(3), np.eye(6)

#: Below this sine of the angle between a coupler and the axis before it another axis holds its spin.
SPIN_UNDEFINED = 1e-8


class Values(dict[Place, float]):
    """The numbers of a description by their places, angles in radians; what it leaves out is 0."""

    def __init__(self, numbers: Mapping[Place, float]) -> None:
        super().__init__(numbers)
        self._poses: dict[Factor, Floats] = {}

    def pose(self, factor: Factor) -> Floats:
        """The motion (4, 4) of a factor, worked out once."""
        if factor not in self._poses:
            self._poses[factor] = factor.pose(self)
        return self._poses[factor]


class Factor(Protocol):
    """A rigid motion that depends on numbers of a description."""

    def pose(self, values: Values) -> Floats:
        """The motion (4, 4)."""
        ...

    def moves(self, values: Values) -> Moves:
        """The twists (6,) in the frame behind it by one of each number."""
        ...


@dataclass(frozen=True, eq=False)
class Still:
    """A motion that depends on nothing."""

    matrix: Floats

    def pose(self, values: Values) -> Floats:  # noqa: ARG002
        """The motion (4, 4)."""
        return self.matrix

    def moves(self, values: Values) -> dict[Place, Floats]:  # noqa: ARG002
        """None."""
        return {}


@dataclass(frozen=True)
class TurnAndSlide:
    """A turn about and a slide along an axis 0, 1, 2, each by a number."""

    axis: int
    turn: Place | None = None
    slide: Place | None = None

    def pose(self, values: Values) -> Floats:
        """The motion (4, 4)."""
        origin = np.zeros(3)
        origin[self.axis] = 0.0 if self.slide is None else values.get(self.slide, 0.0)
        angle = 0.0 if self.turn is None else values.get(self.turn, 0.0)
        return pose(about(self.axis, angle), origin)

    def moves(self, values: Values) -> dict[Place, Floats]:  # noqa: ARG002
        """The twists (6,) by one of each number."""
        places = {self.turn: self.axis, self.slide: self.axis + 3}
        return {place: _TWISTS[k] for place, k in places.items() if place is not None}


@dataclass(frozen=True)
class DrawnFrame:
    """The frame on a joint as drawn, its z along the first or second axis, x towards another joint.

    Its numbers move the line; a turn about the line itself, before and behind the joint, changes nothing,
    unless the joint slides in a plane.
    """

    joint: int
    #: "axis", "axes" (U), or "" (S).
    key: str
    which: int = 0
    towards: int = 0
    #: Whether x of the frame counts: that of a joint that slides across its line.
    has_plane: bool = False

    @property
    def at(self) -> Place:
        """Where the numbers of its place stand."""
        return ("joint", self.joint, "at")

    def direction(self, values: Values) -> tuple[Floats, Moves]:
        """The direction of its line, and the angular velocities by its numbers."""
        place: Place = ("joint", self.joint, self.key, *([self.which] if self.key == "axes" else []))
        written = vector(values, place)
        axis = unit(written)
        return axis, {(*place, k): cross(axis, _AXES[k]) / math.hypot(*written) for k in range(3)}

    def pose(self, values: Values) -> Floats:
        """The motion (4, 4)."""
        at = vector(values, self.at)
        if self.key == "":
            return pose(np.eye(3), at)
        if self.key == "axis":
            towards = vector(values, ("joint", self.towards, "at")) - at
            return pose(frame_about(vector(values, ("joint", self.joint, "axis")), towards), at)
        first, second = (vector(values, ("joint", self.joint, "axes", k)) for k in (0, 1))
        z, x = unit(first), unit(cross(unit(first), unit(second)))
        frame = pose(np.column_stack([x, cross(z, x), z]), at)
        return frame @ pose(about(0, between(first, second)), np.zeros(3)) if self.which else frame

    def _turns(self, values: Values) -> dict[Place, float]:
        """By each number, how far x turns about the line beside the spin of the line: y . dx."""
        other: Place = ("joint", self.towards, "at")
        towards = vector(values, other) - vector(values, self.at)
        z, spins = self.direction(values)
        across = towards - (towards @ z) * z
        length = float(np.linalg.norm(across))
        ways: list[tuple[Place, float]]
        if length <= ON_AXIS * np.linalg.norm(towards):
            # x goes across towards an axis of the report, which stays
            towards = _AXES[np.argmin(np.abs(z))]
            length, ways = math.sqrt(1.0 - float(towards @ z) ** 2), []
        else:
            ways = [(self.at, -1.0), (other, 1.0)]
        y = self.pose(values)[:3, 1]
        found = {place: -float(towards @ z) * float(y @ cross(spin, z)) for place, spin in spins.items()}
        for place, sign in ways:
            found |= {(*place, k): sign * float(y[k]) for k in range(3)}
        return {place: turn / length for place, turn in found.items()}

    def moves(self, values: Values) -> Moves:
        """The twists (6,) by one of each number."""
        found = {(*self.at, k): _TWISTS[k + 3] for k in range(3)}
        if self.key:
            at = vector(values, self.at)
            for place, spin in self.direction(values)[1].items():
                found[place] = np.concatenate([spin, cross(at, spin)])
            for place, turn in self._turns(values).items() if self.has_plane else ():
                z = self.direction(values)[0]
                found[place] = found.get(place, 0.0) + turn * np.concatenate([z, cross(at, z)])
        return _seen(inverse(values.pose(self)), found)


@dataclass(frozen=True)
class Held:
    """The frame of an axis, seen from a drawn ball, about which it turns as its link's spin is held.

    `which` is 0 for that of the joint before, or the `given` one, 1 for one square to it and to the line to
    the next ball, 2 for the one square to both, about which it does not turn.
    """

    ball: int
    which: int
    before: DrawnFrame | None = None
    given: tuple[float, ...] = ()

    def _axes(self, values: Values) -> tuple[Floats, Floats, Floats, float]:
        """The first and second axis (3,), the line, and the length of axis x line; 0 where they are one."""
        line = vector(values, ("joint", self.ball + 1, "at")) - vector(values, ("joint", self.ball, "at"))
        other = _AXES[np.argmin(np.abs(line))]
        axis = np.array(self.given) if self.before is None else self.before.direction(values)[0]
        second = cross(axis, line)
        length = math.hypot(*second)
        if length > SPIN_UNDEFINED * math.hypot(*line):
            return axis, second / length, line, length
        return axis, unit(cross(other, line)), line, 0.0

    def _spins(self, values: Values) -> Moves:
        """The angular velocities of the first or second axis by each number."""
        axis, second, line, length = self._axes(values)
        if not length:
            return {}
        spins = {} if self.before is None else self.before.direction(values)[1]
        if self.which == 0:
            return spins
        ways = {place: cross(cross(spin, axis), line) for place, spin in spins.items()}
        for ball, sign in ((self.ball, -1.0), (self.ball + 1, 1.0)):
            for k in range(3):
                place = ("joint", ball, "at", k)
                ways[place] = ways.get(place, 0.0) + cross(axis, sign * _AXES[k])
        return {place: cross(second, way / length) for place, way in ways.items()}

    def pose(self, values: Values) -> Floats:
        """The motion (4, 4)."""
        first, second, *_ = self._axes(values)
        z = (first, second, cross(first, second))[self.which]
        return pose(frame_about(z, second if self.which == 0 else first), np.zeros(3))

    def moves(self, values: Values) -> Moves:
        """The twists (6,) by one of each number."""
        if self.which == 2:
            # nothing turns about it, so where it is does not matter
            return {}
        turning = {place: np.concatenate([spin, np.zeros(3)]) for place, spin in self._spins(values).items()}
        return _seen(inverse(values.pose(self)), turning)


@dataclass(frozen=True)
class Back:
    """Another motion, backwards."""

    of: Factor

    def pose(self, values: Values) -> Floats:
        """The motion (4, 4)."""
        return inverse(values.pose(self.of))

    def moves(self, values: Values) -> Moves:
        """The twists (6,) by one of each number."""
        return {k: -twist for k, twist in _seen(values.pose(self.of), self.of.moves(values)).items()}


@dataclass(frozen=True)
class Product:
    """Motions one after the other, (1)."""

    factors: tuple[Factor, ...]

    def __add__(self, other: Product) -> Product:
        return Product(self.factors + other.factors)

    @property
    def back(self) -> Product:
        """It backwards."""
        return Product(tuple(one.of if isinstance(one, Back) else Back(one) for one in self.factors[::-1]))

    def pose(self, values: Values) -> Floats:
        """The motion (4, 4)."""
        if not self.factors:
            return np.eye(4)
        return reduce(np.matmul, (values.pose(factor) for factor in self.factors))

    def moves(self, values: Values, only: Container[Place] | None = None) -> Moves:
        """The twists (6,) by one of each number, or of some alone."""
        found: Moves = {}
        behind, passed = np.eye(4), list[Factor]()
        for factor in reversed(self.factors):
            moves = factor.moves(values)
            if only is not None:
                moves = {place: twist for place, twist in moves.items() if place in only}
            if moves:
                # (1) goes through what lies behind only where something is there to go through it
                for other in passed:
                    behind = behind @ inverse(values.pose(other))
                passed.clear()
            for place, twist in _seen(behind, moves).items():
                found[place] = found.get(place, 0.0) + twist
            passed.append(factor)
        return found


def _seen(frame: Floats, moves: Moves) -> Moves:
    """Twists of a frame (4, 4) in the frame in which that is given."""
    if not moves:
        return moves
    turned = adjoint(frame) @ np.stack(list(moves.values()), axis=1)
    return dict(zip(moves, turned.T, strict=True))


def vector(values: Values, place: Place) -> Floats:
    """The vector (3,) whose numbers stand at a place."""
    return np.array([values[*place, k] for k in range(3)])


def between(first: npt.ArrayLike, second: npt.ArrayLike) -> float:
    """The angle [rad] from one axis to another."""
    a, b = unit(first), unit(second)
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
