"""A description as a word: the fixed transforms of its loop as products of steps that hold its numbers.

    F_0 Z_1 F_1 Z_2 .. Z_n F_n = 1                                                                        (1)

with one step Z for each freedom, and each F a product of factors: turns about and slides along an axis by a
number (RSSR, Denavit-Hartenberg rows), frames on drawn lines, constants. A number that changes by dp moves
what stands behind a factor by the twist w dp in the frame there, and that goes through all behind it:

    dF = F w dp,        F = A B:  w = Ad(B^-1) w_A + w_B                                                  (2)

The last joint of a drawing counts the link before it against the ground, right-handed about its axes as they
are written. It moves in a frame that is turned from the drawn one by half, so that its axes are reversed:

    Z_kind(q)^-1 = H Z(q) H,        H = H^-1                                                              (3)

A ball before a link that would spin idly stands here as the two turns that the core holds it to.

Source: docs/theory.md, (1); docs/theory_design.md, (2).
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.kinematics.geometry import Form
from sevenbar.kinematics.joints import KINDS, JointKind, Z
from sevenbar.kinematics.rigid import (
    ON_AXIS,
    about,
    adjoint,
    axis_to_z,
    cross,
    frame_about,
    half_turn,
    inverse,
    pose,
    unit,
)

#: A place in a description: keys of tables, and counts from 0 in lists.
Place = tuple[str | int, ...]

#: Twists (6,) by the places of the numbers that one of moves so.
Moves = dict[Place, Floats]

#: Report frame of Denavit-Hartenberg rows against the frame of the ground link: x is j, y is k, z is i.
I_ALONG_LAST_AXIS = pose([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], np.zeros(3))

#: A point (u, v, w) on a row's link: u along its joint, v along the link, w = u x v.
UVW = pose([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], np.zeros(3))

#: The ground's side of the rocker of an RSSR turns about -x, so that its value is the paper's beta.
ROCKER_GROUND = pose([[0, 0, -1], [-1, 0, 0], [0, 1, 0]], np.zeros(3))

#: Half turns about x and z.
HALF_TURN_X = pose(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
HALF_TURN_Z = pose(np.diag([-1.0, -1.0, 1.0]), np.zeros(3))

#: The table of each form in a file.
TABLES: Mapping[Form, str] = {"rssr": "rssr", "rows": "link", "planar": "link", "drawn": "joint"}

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
    """Motions one after the other, (2)."""

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
                # (2) goes through what lies behind only where something is there to go through it
                for other in passed:
                    behind = behind @ inverse(values.pose(other))
                passed.clear()
            for place, twist in _seen(behind, moves).items():
                found[place] = found.get(place, 0.0) + twist
            passed.append(factor)
        return found


@dataclass(frozen=True)
class WordStep:
    """A step that joints move: a turn (R), a slide (P), a screw (H) along z, or a ball (S).

    `columns` are those of the linkage whose values it takes, `joint` counts from 0. `held`: it stays at zero.
    """

    letter: str
    joint: int
    columns: tuple[int, ...]
    pitch: Place | None = None
    held: bool = False


@dataclass(frozen=True)
class Carried:
    """A point that a link carries, behind so many `steps`, none for the ground.

    `frame` is that of its coordinates there; they stand at a `place` of the description, or are `at`.
    """

    steps: int
    frame: Product
    place: Place | None = None
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Word:
    """The word of a form: base, links between the joints, and ground; and the freedoms of each joint.

    `inner` stands before, between and behind the freedoms of joint i, empty where nothing does. `frames` take
    a point as it is written to its link's own.
    """

    base: Product
    links: tuple[Product, ...]
    ground: Product
    frames: tuple[Product, ...]
    freedoms: tuple[tuple[WordStep, ...], ...]
    inner: tuple[tuple[Product, ...], ...]

    @cached_property
    def steps(self) -> tuple[WordStep, ...]:
        """The Z of (1)."""
        return tuple(freedom for own in self.freedoms for freedom in own)

    @cached_property
    def fixed(self) -> tuple[Product, ...]:
        """The F of (1), one more than there are steps."""
        outer = [*self.links, self.ground.back]
        found = [self.base]
        for freedoms, inside, behind in zip(self.freedoms, self.inner, outer, strict=True):
            parts = inside or (Product(()),) * (len(freedoms) + 1)
            found[-1] = found[-1] + parts[0]
            found += [*parts[1:-1], parts[-1] + behind]
        return tuple(found)

    def carrier(self, link: int) -> tuple[int, Product]:
        """The steps before a link, counted from 1, and the frame there in which its points are written."""
        frame = self.frames[link - 1]
        if link == len(self.freedoms):
            # the ground's own frame is that of the report
            return 0, frame
        behind = self.inner[link - 1][-1:] or (Product(()),)
        return sum(map(len, self.freedoms[:link])), behind[0] + frame

    def point(self, link: int, place: Place) -> Carried:
        """A point of a link, counted from 1, as it is written at a place."""
        return Carried(*self.carrier(link), place)


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


def word_of(form: Form, kinds: Sequence[str], spun: Mapping[int, Floats | None] | None = None) -> Word:
    """The word of a form with joints of these kinds.

    `spun` are the balls, counted from 0, before a link that is held from spinning on to the next ball: they
    stand as two turns, and a third that is held. Each has the axis that holds the spin, in the frame of the
    ball; `None` for that of the joint before.
    """
    spun = spun or {}
    freedoms, inner = [], []
    column = 0
    for i, (kind, row) in enumerate(zip(kinds, _rows_of(form, kinds), strict=True)):
        columns = range(column, column := column + len(row.freedoms))
        if i in spun:
            own = [WordStep("R", i, (c,), held=c == columns[-1]) for c in columns]
            inner.append(_turns_of_spun(form, kinds, i, spun[i]))
        elif row.is_ball or row.is_screw:
            pitch: Place | None = (TABLES[form], i, "pitch") if row.is_screw else None
            own = [WordStep(kind, i, tuple(columns), pitch)]
            inner.append(())
        else:
            own = [WordStep(step.letter, i, (c,)) for c, step in zip(columns, row.steps, strict=True)]
            inner.append(_inner(kinds, i, row))
        freedoms.append(tuple(own))
    shape = {"rssr": _rssr, "rows": _rows, "planar": _planar, "drawn": _drawn}[form]
    return Word(*shape(kinds), tuple(freedoms), tuple(inner))


def _rows_of(form: Form, kinds: Sequence[str]) -> list[JointKind]:
    """The kinds of the joints in loop order: the last one of a drawing counts its link against the ground."""
    rows = [KINDS[kind] for kind in kinds]
    return [*rows[:-1], rows[-1].backwards] if form == "drawn" else rows


def _turned(kinds: Sequence[str], joint: int) -> Product:
    """From the frame of a drawn joint to that in which it moves: by half a turn of the last one, (3)."""
    last = joint + 1 == len(kinds)
    return Product((Still(half_turn(KINDS[kinds[joint]].half_turn)),) if last else ())


def holding_axis(form: Form, kinds: Sequence[str], ball: int, axis: Floats, values: Values) -> Floats | None:
    """The axis that holds the spin beyond a ball, `None` where it is that of the joint before."""
    if form == "rssr":
        return None
    if ball > 0 and not KINDS[kinds[ball - 1]].is_ball:
        before = _drawn_frames(kinds, ball - 1)[1].direction(values)[0]
        if math.hypot(*cross(before, axis)) < SPIN_UNDEFINED:
            return None
    return axis


_Outer = tuple[Product, tuple[Product, ...], Product, tuple[Product, ...]]


def _rssr(kinds: Sequence[str]) -> _Outer:
    def slide(axis: int, key: str) -> TurnAndSlide:
        return TurnAndSlide(axis, slide=("rssr", key))

    turned = Still(HALF_TURN_X)
    links = (
        Product((slide(0, "L1"),)),
        Product((slide(0, "L2"),)),
        Product((slide(0, "L3"), turned)),
    )
    ground = Product((slide(0, "M"), slide(1, "D"), Still(ROCKER_GROUND)))
    return Product((slide(2, "N"),)), links, ground, (Product(()),) * len(kinds)


def _rows(kinds: Sequence[str]) -> _Outer:
    """Rows `Rz(theta) Tz(offset) Tx(length) Rx(twist)`: the joint's own motion, then turn, then span."""
    report = Still(I_ALONG_LAST_AXIS)
    count = range(len(kinds))
    # of a slide the angle is fixed and the offset moves
    turns = [
        TurnAndSlide(2, turn=("link", i, "angle"))
        if "angle" in KINDS[kinds[i]].row_keys
        else TurnAndSlide(2, slide=("link", i, "offset"))
        for i in count
    ]
    spans = [TurnAndSlide(0, turn=("link", i, "twist"), slide=("link", i, "length")) for i in count]
    ground = Product((report, Back(turns[-1])))
    # v of a point goes along the link, so behind the fixed angle; u counts from before the offset
    frames = [Product((TurnAndSlide(2, turn=("link", i, "angle")), Still(UVW))) for i in count]
    frames[-1] = ground + frames[-1]
    links = tuple(Product(pair) for pair in zip(turns[:-1], spans[:-1], strict=True))
    return Product((report, spans[-1])), links, ground, tuple(frames)


def _planar(kinds: Sequence[str]) -> _Outer:
    """The rows as planar textbooks lay them out: x runs along the ground, from the first joint to the last.

    The first angle counts from x, half a turn off that of the rows; the last one is that of the link before
    the ground, which the ground's in the rows is backwards.
    """
    _, links, ground, frames = _rows(kinds)
    # without the report frame of the rows
    (_, *rest), (_, *last) = ground.factors, frames[-1].factors
    span = TurnAndSlide(0, turn=("link", len(kinds) - 1, "twist"), slide=("link", len(kinds) - 1, "length"))
    start = Product((Still(HALF_TURN_Z), Back(span)))
    under = Still(HALF_TURN_X)
    links = (*links[:-1], links[-1] + Product((under,)))
    frames = (*frames[:-1], start + Product(tuple(last)))
    return Product(()), links, start + Product((*rest, under)), frames


def _drawn_frames(kinds: Sequence[str], joint: int) -> tuple[DrawnFrame, DrawnFrame]:
    """The frames before and behind a joint."""
    # x goes towards the joint behind, of the last one towards that before
    towards = joint + 1 if joint + 1 < len(kinds) else joint - 1
    row = KINDS[kinds[joint]]
    key = next((key for key in row.drawn_keys if key in ("axis", "axes")), "")
    before = DrawnFrame(joint, key, 0, towards, row.has_plane)
    return before, DrawnFrame(joint, key, 1, towards) if row.has_cross else before


def _drawn(kinds: Sequence[str]) -> _Outer:
    """Joints as drawn, all at zero: the frames on both sides of each, in ground coordinates."""
    pairs = [_drawn_frames(kinds, i) for i in range(len(kinds))]
    sides = [[Product((side,)) + _turned(kinds, i) for side in pair] for i, pair in enumerate(pairs)]
    before, behind = zip(*sides, strict=True)
    links = tuple(a.back + b for a, b in zip(behind[:-1], before[1:], strict=True))
    frames = (*(frame.back for frame in behind[:-1]), Product(()))
    return before[0], links, behind[-1], frames


def _inner(kinds: Sequence[str], joint: int, row: JointKind) -> tuple[Product, ...]:
    """What stands before, between and behind the steps of a joint, each about or along z."""
    parts, ahead = [], Product(())
    for step in row.steps:
        if step.tilted:
            before, behind = _drawn_frames(kinds, joint)
            turned = _turned(kinds, joint)
            ahead += turned.back + Product((Back(before), behind)) + turned
        if step.axis == Z:
            parts.append(ahead)
            ahead = Product(())
        else:
            frame = Still(axis_to_z(step.axis))
            parts.append(ahead + Product((frame,)))
            ahead = Product((Back(frame),))
    return (*parts, ahead)


def _turns_of_spun(form: Form, kinds: Sequence[str], ball: int, axis: Floats | None) -> tuple[Product, ...]:
    """What stands before, between and behind the turns of a ball that holds a spin."""
    axes: list[Factor]
    if form == "rssr":
        axes = [Still(pose(frame_about(np.eye(3)[k], np.eye(3)[k - 1]), np.zeros(3))) for k in (2, 1, 0)]
    elif axis is None:
        before = _drawn_frames(kinds, ball - 1)[1]
        axes = [Held(ball, k, before) for k in range(3)]
    else:
        axes = [Held(ball, k, given=tuple(axis.tolist())) for k in range(3)]
    a, b, c = axes
    return Product((a,)), Product((Back(a), b)), Product((Back(b), c)), Product((Back(c),))


def points_of(form: Form, word: Word, description: Mapping[str, Any], kind: str) -> list[Carried]:
    """The points of a linkage: the balls A and B of an RSSR, then those of its description."""
    found: list[Carried] = []
    if form == "rssr":
        found += [
            Carried(1, Product((TurnAndSlide(0, slide=("rssr", "L1")),))),
            Carried(len(word.steps) - 1, Product(())),
        ]
    elif kind == "RSSR":
        found += [word.point(link, ("joint", joint, "at")) for link, joint in ((1, 1), (3, 2))]
    tables = enumerate(description.get("point", ()))
    return found + [word.point(int(table["link"]), ("point", i, "at")) for i, table in tables]
