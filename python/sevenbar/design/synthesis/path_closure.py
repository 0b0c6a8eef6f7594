"""Where a point of any loop is, and how it follows inputs and dimensions: exact derivatives by screws.

Each form of description becomes a word of steps, each a turn about and a slide along one line,

    C_1 C_2 .. C_m = 1,        C = exp(S t)                                                               (1)

with its line S as it lies with all joints at zero, and its amount t a joint value, a dimension or a constant.
With W the product of the steps before a step, its joint value or dimension moves all that comes after by the
screw `Ad_W S`; a dimension that moves the line itself, by a twist X (a drawn place or axis), does by

    Ad_W X - Ad_(W C) X                                                                                   (2)

since `exp(X) C exp(-X)` is the step about the moved line. So one walk along the word gives the closure, the
point, and the derivatives of both by every joint value q and every dimension p; those of the passive joints
come from `F_u du = -F_x dx - F_p dp`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from sevenbar.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.linkage import Linkage, Point
from sevenbar.motion import Floats

#: Newton's steps on the closure: the most, the longest [rad, or parts of the size], the error that ends.
MOST_STEPS, LONGEST, CLOSED = 12, 0.25, 1e-13

#: An error [rad, or parts of the size] that rounding leaves where the loop is ill conditioned.
NEARLY_CLOSED = 1e-9

#: Singular values below this part of the greatest belong to idle freedoms, which stand still.
IDLE = 1e-9

#: Part of a dimension's screw that no joint can follow: the dimension opens the loop.
OPENING = 1e-7

#: Below this sine of the angle between a coupler and the axis before it another axis holds its spin.
SPIN_UNDEFINED = 1e-8

_UVW = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
_X, _Y, _Z = np.eye(3)


@dataclass(frozen=True)
class Amount:
    """How far a step goes: a constant, and what one of a joint value and of dimensions add to it."""

    constant: float = 0.0
    column: int | None = None
    #: By the number of a dimension, what one of it adds.
    dimensions: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Step:
    """A turn about and a slide along the line of unit direction `axis` through `place`, both (3,).

    `pitch` is (number of the dimension, column) of a screw's: its slide is both multiplied, over a full turn.
    `moves` are the twists (6,), direction first, by which one of a dimension moves the line.
    """

    axis: Floats
    place: Floats
    turn: Amount = field(default_factory=Amount)
    slide: Amount = field(default_factory=Amount)
    pitch: tuple[int, int] | None = None
    moves: Mapping[int, Floats] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Word:
    """The steps of a loop from `start` (4, 4) on, and a point.

    `carried` is the number of steps that carry the point, `at` (3,) where it is after them, `at_moves` what
    one of a dimension moves it by, (3,) each.
    """

    start: Floats
    steps: tuple[Step, ...]
    carried: int
    at: Floats
    at_moves: Mapping[int, Floats]


@dataclass(frozen=True, eq=False)
class Reached:
    """A point (n, 3) at closed poses, its derivative by the input (n, 3), and by dimensions (n, 3, k)."""

    position: Floats
    by_input: Floats
    by_dimension: Floats


class Walked(NamedTuple):
    """The closure error F (n, 6), in radians and parts of the size, and the point (n, 3).

    Each with its derivatives by all columns (.., columns) and by the varied dimensions (.., k).
    """

    error: Floats
    by_column: Floats
    by_dimension: Floats
    point: Floats
    point_by_column: Floats
    point_by_dimension: Floats


class PointClosure:
    """The closure of a draft with one point: `values` (k,) are those of its dimensions in the file's units.

    `varied` are the numbers, among `names`, of the dimensions by which derivatives are wanted.
    """

    def __init__(self, draft: Draft, point: Point, varied: Sequence[int] = ()) -> None:
        linkage = draft.linkage
        self._raw = draft.raw
        self._linkage = linkage
        self._point = point
        self.dimensions = tuple(d for d in draft.dimensions if d.name != "speed")
        self.start = np.array([d.value for d in self.dimensions])
        self.varied = tuple(varied)
        self.input = linkage.columns.index(linkage.drive.joint)
        self.size = linkage._general.size
        self._slides = np.array([kind == "slide" for kind in linkage.column_kinds])
        self._numbers = {d.place: i for i, d in enumerate(self.dimensions)}
        self._spun = _spun_balls(linkage)
        self._passive = [k for k in range(len(linkage.columns)) if k != self.input]
        if point.link > len(linkage.links):
            raise RequestError(
                f"point: '{point.name}' is on link {point.link}, the ground, which stands still; "
                f"give a point of link 1 to {len(linkage.links)}"
            )

    def word(self, values: Floats) -> Word:
        """The word of the dimensions' values (k,)."""
        if "rssr" in self._raw:
            return self._rssr_word(values)
        return self._rows_word(values) if "link" in self._raw else self._drawn_word(values)

    def _amount(self, values: Floats, *place: str | int, rate: float = 1.0) -> Amount:
        """The amount of a step that is one dimension; `rate` makes radians of its unit."""
        number = self._numbers.get(place)
        if number is None:
            return Amount()
        scale = rate * self.dimensions[number].scale
        return Amount(scale * values[number], dimensions={number: scale})

    def _rssr_word(self, values: Floats) -> Word:
        def dimension(key: str, rate: float = 1.0) -> Amount:
            number = self._numbers["rssr", key]
            if key == "L2" and self.dimensions[number].follows and number not in self.varied:
                return self._following_coupler(values)
            return self._amount(values, "rssr", key, rate=rate)

        zero = np.zeros(3)
        turns = [
            Step(axis, zero, Amount(column=k)) for k, axis in enumerate((_Z, _Z, _Y, _X, _Z, _Y, _X, _Z))
        ]
        steps = [
            Step(_Z, zero, slide=dimension("N")),
            turns[0],
            Step(_X, zero, slide=dimension("L1")),
            # the spin is held: the first ball turns about z and y only
            *turns[1:3],
            Step(_X, zero, slide=dimension("L2")),
            *turns[4:7],
            Step(_X, zero, slide=dimension("L3")),
            Step(_X, zero, Amount(math.pi)),
            turns[7],
            *_fixed_turn(self._linkage.ground[:3, :3].T),
            Step(_Y, zero, slide=dimension("D", -1.0)),
            Step(_X, zero, slide=dimension("M", -1.0)),
        ]
        at, moves = self._own_place(values, np.eye(3))
        if (self._point.name, self._point.link) == ("A", 1) and not moves:
            number = self._numbers["rssr", "L1"]
            at, moves = values[number] * _X, {number: _X}
        return Word(np.eye(4), tuple(steps), {1: 2, 2: 5, 3: 9}[self._point.link], at, moves)

    def _following_coupler(self, values: Floats) -> Amount:
        """The coupler where a file leaves it out: `L2^2 = (L1 - M)^2 + L3^2 + N^2`."""
        numbers = {key: self._numbers["rssr", key] for key in ("M", "N", "L1", "L3")}
        m, n, crank, rocker = (values[number] for number in numbers.values())
        length = math.sqrt((crank - m) ** 2 + rocker**2 + n**2)
        parts = {"M": m - crank, "N": n, "L1": crank - m, "L3": rocker}
        return Amount(length, dimensions={numbers[key]: part / length for key, part in parts.items()})

    def _own_place(self, values: Floats, turn: Floats) -> tuple[Floats, dict[int, Floats]]:
        """Where the point is in its link's frame; `turn` (3, 3) takes the axes of the file to its own."""
        for i, table in enumerate(self._raw.get("point", ())):
            if table["name"] == self._point.name:
                at, ways = self._vector(values, "point", i, "at")
                return turn @ at, {number: turn @ way for number, way in ways.items()}
        return turn @ np.array(self._point.at, dtype=np.float64), {}

    def _rows_word(self, values: Floats) -> Word:
        rows = self._raw["link"]
        kinds = [joint.kind for joint in self._linkage.joints]
        zero = np.zeros(3)
        report = np.eye(4)
        # the report's axes are those of the last link's frame renamed: i along its joint's axis
        report[:3, :3] = _UVW.T
        steps: list[Step] = []
        carried = 0
        at, moves = self._own_place(values, _UVW)
        last = len(rows) - 1

        def span(i: int) -> list[Step]:
            return [
                Step(_X, zero, slide=self._amount(values, "link", i, "length")),
                Step(_X, zero, turn=self._amount(values, "link", i, "twist")),
            ]

        steps += span(last)
        for i, kind in enumerate(kinds):
            if kind == "P":
                steps.append(Step(_Z, zero, slide=Amount(column=i)))
                steps.append(Step(_Z, zero, turn=self._amount(values, "link", i, "angle")))
            else:
                pitch = None
                if kind == "H":
                    number = self._numbers["link", i, "pitch"]
                    pitch = (number, i)
                steps.append(Step(_Z, zero, turn=Amount(column=i), pitch=pitch))
            if i + 1 == self._point.link:
                carried = len(steps)
            if kind != "P":
                steps.append(Step(_Z, zero, slide=self._amount(values, "link", i, "offset")))
            if i != last:
                steps += span(i)
        steps += _fixed_turn(report[:3, :3].T)
        return Word(report, tuple(steps), carried, at, moves)

    def _drawn_word(self, values: Floats) -> Word:
        steps: list[Step] = []
        carried = column = 0
        joints = self._linkage.joints
        places = [self._vector(values, "joint", i, "at") for i in range(len(joints))]
        for i, joint in enumerate(joints):
            place, ways = places[i]
            shifts = {number: np.concatenate([np.zeros(3), way]) for number, way in ways.items()}
            lines: list[tuple[Floats, dict[int, Floats]]]
            if joint.kind == "S" and i in self._spun:
                before = steps[-1] if i > 0 and joints[i - 1].kind != "S" else None
                lines = _spin_lines(before, places[i], places[i + 1])
            elif joint.kind == "S":
                lines = [(axis, {}) for axis in (_Z, _Y, _X)]
            elif joint.kind == "U":
                lines = [_turned_line(*self._vector(values, "joint", i, "axes", k), place) for k in (0, 1)]
            else:
                lines = [_turned_line(*self._vector(values, "joint", i, "axis"), place)]
            pitch = (self._numbers["joint", i, "pitch"], column) if joint.kind == "H" else None
            for k, (axis, turns) in enumerate(lines):
                own, moves = Amount(column=column + k), _sum(shifts, turns)
                turn, slide = (Amount(), own) if joint.kind == "P" else (own, Amount())
                steps.append(Step(axis, place, turn, slide, pitch, moves))
            if joint.kind == "C":
                steps.append(replace(steps[-1], turn=Amount(), slide=Amount(column=column + 1)))
            column += len(joint.columns)
            if i + 1 == self._point.link:
                carried = len(steps)
        at, moves = self._own_place(values, np.eye(3))
        ball = {"A": 1, "B": 2}.get(self._point.name) if self._linkage.kind == "RSSR" else None
        if ball is not None and not moves:
            at, moves = places[ball]
        return Word(np.eye(4), tuple(steps), carried, at, moves)

    def _vector(self, values: Floats, *place: str | int) -> tuple[Floats, dict[int, Floats]]:
        """A vector of the description, and what one of each of its numbers adds."""
        numbers = [self._numbers[(*place, axis)] for axis in range(3)]
        return values[numbers], dict(zip(numbers, np.eye(3), strict=True))

    def walk(self, values: Floats, q: Floats, *, sensitive: bool = True) -> Walked:
        """Along the word at poses q (n, columns); not `sensitive`: without derivatives by dimensions."""
        word = self.word(values)
        own = {number: place for place, number in enumerate(self.varied)} if sensitive else {}
        rows, columns = q.shape
        by_column = np.zeros((rows, 6, columns))
        by_dimension = np.zeros((rows, 6, len(own)))
        turn = np.broadcast_to(word.start[:3, :3], (rows, 3, 3))
        origin = np.broadcast_to(word.start[:3, 3], (rows, 3))
        point = point_by_column = point_by_dimension = np.empty(0)
        for count, step in enumerate((*word.steps, None)):
            if count == word.carried:
                point = turn @ word.at + origin
                point_by_column = _carried(by_column, point)
                point_by_dimension = _carried(by_dimension, point)
                for number, way in word.at_moves.items():
                    if number in own:
                        point_by_dimension[:, :, own[number]] += turn @ way
            if step is None:
                break
            axis = turn @ step.axis
            angle: Floats | float = step.turn.constant
            length: Floats | float = step.slide.constant
            column = step.turn.column
            if column is not None or own.keys() & step.turn.dimensions.keys():
                screw = np.concatenate([axis, _cross(turn @ step.place + origin, axis)], axis=1)
                if column is not None:
                    by_column[:, :, column] += screw
                    angle = angle + q[:, column]
                for number, rate in step.turn.dimensions.items():
                    if number in own:
                        by_dimension[:, :, own[number]] += rate * screw
            if step.slide.column is not None:
                by_column[:, 3:, step.slide.column] += axis
                length = length + q[:, step.slide.column]
            for number, rate in step.slide.dimensions.items():
                if number in own:
                    by_dimension[:, 3:, own[number]] += rate * axis
            if step.pitch is not None:
                number, column = step.pitch
                by_column[:, 3:, column] += values[number] / math.tau * axis
                length = length + values[number] / math.tau * q[:, column]
                if number in own:
                    by_dimension[:, 3:, own[number]] += (q[:, column] / math.tau)[:, None] * axis
            moves = {number: twist for number, twist in step.moves.items() if number in own}
            for number, twist in moves.items():
                by_dimension[:, :, own[number]] += _adjoined(turn, origin, twist)
            turn, origin = _after(turn, origin, step, angle, length)
            for number, twist in moves.items():
                by_dimension[:, :, own[number]] -= _adjoined(turn, origin, twist)
        skew = np.stack(
            [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]],
            axis=1,
        )
        # half a turn has no skew part either
        far = (3.0 - np.trace(turn, axis1=1, axis2=2) > 2.0)[:, None]
        error = np.concatenate([np.where(far, 1.0, skew / 2), origin / self.size], axis=1)
        by_column[:, 3:] /= self.size
        by_dimension[:, 3:] /= self.size
        return Walked(error, by_column, by_dimension, point, point_by_column, point_by_dimension)

    @property
    def units(self) -> Floats:
        """What is 1 of each column (columns,): a radian, or the size."""
        return np.where(self._slides, self.size, 1.0)

    def poses(self, values: Floats, q: Floats) -> Floats:
        """Rows of the analysis (n, columns) as poses of the word.

        A ball whose link is held from spinning has two turns here, about the axis before and square to it.
        """
        q = q.copy()
        column = carried = 0
        steps = self.word(values).steps if self._spun and "joint" in self._raw else ()
        for i, joint in enumerate(self._linkage.joints):
            if i in self._spun and steps:
                first, second = steps[carried].axis, steps[carried + 1].axis
                turns = [_turning(axis, q[:, column + k]) for k, axis in enumerate((_Z, _Y, _X))]
                turn = turns[0] @ turns[1] @ turns[2]
                square = np.cross(first, second)
                q[:, column] = np.arctan2(turn @ second @ square, turn @ second @ second)
                rest = _turning(first, -q[:, column]) @ turn @ first
                q[:, column + 1] = np.arctan2(rest @ -square, rest @ first)
                q[:, column + 2] = 0.0
                carried += 2
            else:
                carried += len(joint.columns)
            column += len(joint.columns)
        return q

    def position(self, values: Floats, q: Floats) -> Floats:
        """The point (n, 3) at poses (n, columns)."""
        return self.walk(values, q, sensitive=False).point

    def closed(self, values: Floats, x: Floats, q: Floats) -> Floats:
        """The poses (n, columns) at inputs x (n,), by Newton's method from those nearby.

        NaN where it leads nowhere, or over a dead centre of the input.
        """
        q = q.copy()
        q[:, self.input] = x
        good = np.isfinite(q).all(axis=1)
        error = np.full(len(q), np.inf)
        scales = self.units[self._passive]
        for _ in range(MOST_STEPS):
            if not good.any():
                break
            walked = self.walk(values, q[good], sensitive=False)
            residual, by_column = walked.error, walked.by_column
            error[good] = np.abs(residual).max(axis=1)
            if error[good].max() < CLOSED:
                break
            step = (_inverse(by_column[:, :, self._passive] * scales) @ residual[:, :, None])[:, :, 0]
            step *= np.minimum(1.0, LONGEST / np.maximum(np.abs(step).max(axis=1, keepdims=True), LONGEST))
            rows = np.flatnonzero(good)
            q[rows[:, None], self._passive] -= step * scales
            good &= np.isfinite(q).all(axis=1)
        q[~(error < NEARLY_CLOSED)] = np.nan
        return q

    def reached(self, values: Floats, q: Floats) -> Reached:
        """The point at closed poses (n, columns), with its exact derivatives."""
        _, by_column, by_dimension, point, point_by_column, point_by_dimension = self.walk(values, q)
        scales = self.units[self._passive]
        back = -_inverse(by_column[:, :, self._passive] * scales) * scales[:, None]
        carried = point_by_column[:, :, self._passive] @ back
        by_input = point_by_column[:, :, self.input] + (carried @ by_column[:, :, self.input, None])[:, :, 0]
        return Reached(point, by_input, point_by_dimension + carried @ by_dimension)

    def openings(self, values: Floats, q: Floats) -> tuple[int, ...]:
        """The varied dimensions that cannot change without opening the loop, at closed poses (n, columns)."""
        _, by_column, by_dimension, *_ = self.walk(values, q)
        scaled = by_column * self.units
        left, sizes, _ = np.linalg.svd(scaled, full_matrices=False)
        left = left * (sizes > 1e-7 * sizes[:, :1])[:, None, :]
        aside = by_dimension - left @ (np.swapaxes(left, 1, 2) @ by_dimension)
        whole = np.abs(by_dimension).max(axis=(0, 1))
        worst = np.abs(aside).max(axis=(0, 1))
        opening = worst > OPENING * np.maximum(whole, 1e-300)
        return tuple(number for number, opens in zip(self.varied, opening, strict=True) if opens)


def _spun_balls(linkage: Linkage) -> frozenset[int]:
    """Balls, counted from 0, whose link is held from spinning on to a second ball."""
    kinds = [joint.kind for joint in linkage.joints]
    spun: set[int] = set()
    for i in range(len(kinds) - 1):
        # as the core takes them: a ball that ends such a pair begins none
        if kinds[i] == kinds[i + 1] == "S" and i not in spun:
            spun.add(i)
    return frozenset(spun)


def _fixed_turn(rotation: Floats) -> list[Step]:
    """A fixed rotation (3, 3) as steps: turns about z, y and x."""
    y = math.atan2(-rotation[2, 0], math.hypot(rotation[0, 0], rotation[1, 0]))
    if math.hypot(rotation[0, 0], rotation[1, 0]) < 1e-12:
        z, x = 0.0, math.atan2(-rotation[1, 2], rotation[1, 1])
    else:
        z, x = math.atan2(rotation[1, 0], rotation[0, 0]), math.atan2(rotation[2, 1], rotation[2, 2])
    zero = np.zeros(3)
    return [Step(axis, zero, Amount(angle)) for axis, angle in ((_Z, z), (_Y, y), (_X, x))]


def _turned_line(
    vector: Floats, ways: Mapping[int, Floats], place: Floats
) -> tuple[Floats, dict[int, Floats]]:
    """The unit direction of a vector, and the twists about `place` by which its numbers turn it."""
    length = float(np.linalg.norm(vector))
    axis = vector / length
    moves = {}
    for number, way in ways.items():
        spin = np.cross(axis, way) / length
        moves[number] = np.concatenate([spin, np.cross(place, spin)])
    return axis, moves


def _spin_lines(
    before: Step | None,
    place: tuple[Floats, Mapping[int, Floats]],
    to: tuple[Floats, Mapping[int, Floats]],
) -> list[tuple[Floats, dict[int, Floats]]]:
    """The two axes of a ball whose link's spin is held, each with the twists by which dimensions turn it.

    They are that of the joint before, and one square to it and to the line to the next ball.
    """
    here, own = place
    line = to[0] - here
    axis = np.eye(3)[np.argmin(np.abs(line))] if before is None else before.axis
    second = np.cross(axis, line)
    length = float(np.linalg.norm(second))
    if not length > SPIN_UNDEFINED * float(np.linalg.norm(line)):
        second = np.cross(np.eye(3)[np.argmin(np.abs(line))], line)
        return [(axis, {}), (second / np.linalg.norm(second), {})]
    second /= length
    first_moves: dict[int, Floats] = {}
    second_moves: dict[int, Floats] = {}
    spins = {} if before is None else {number: twist[:3] for number, twist in before.moves.items()}
    line_ways = _sum(to[1], {number: -way for number, way in own.items()})
    for number in {*spins, *line_ways}:
        turned = np.cross(spins.get(number, np.zeros(3)), axis)
        way = np.cross(turned, line) + np.cross(axis, line_ways.get(number, np.zeros(3)))
        for moves, direction, changed in ((first_moves, axis, turned), (second_moves, second, way / length)):
            spin = np.cross(direction, changed)
            moves[number] = np.concatenate([spin, np.cross(here, spin)])
    return [(axis, first_moves), (second, second_moves)]


def _sum(one: Mapping[int, Floats], other: Mapping[int, Floats]) -> dict[int, Floats]:
    """Both, added where they share a number."""
    found = dict(one)
    for number, value in other.items():
        found[number] = found[number] + value if number in found else value
    return found


def _after(
    turn: Floats, origin: Floats, step: Step, angle: Floats | float, length: Floats | float
) -> tuple[Floats, Floats]:
    """The frames (n, 3, 3), (n, 3) after a step, by Rodrigues' formula about its line."""
    if np.ndim(length) or length:
        origin = origin + np.reshape(length, (-1, 1)) * (turn @ step.axis)
    if not (np.ndim(angle) or angle):
        return turn, origin
    changed = turn @ _less_one(step.axis, angle)
    if step.place.any():
        origin = origin - changed @ step.place
    return turn + changed, origin


def _less_one(axis: Floats, angle: Floats | float) -> Floats:
    """Rotations (n, 3, 3) about a unit axis (3,), less the identity."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    whole = np.reshape(angle, (-1, 1, 1))
    return np.asarray(np.sin(whole) * cross + 2 * np.sin(whole / 2) ** 2 * (cross @ cross))


def _turning(axis: Floats, angle: Floats) -> Floats:
    """Rotations (n, 3, 3) about a unit axis (3,)."""
    return np.asarray(np.eye(3) + _less_one(axis, angle))


def _adjoined(turn: Floats, origin: Floats, twist: Floats) -> Floats:
    """A twist (6,) of frames (n, 3, 3), (n, 3) as one of the report frame, (n, 6)."""
    spin = turn @ twist[:3]
    return np.concatenate([spin, turn @ twist[3:] + _cross(origin, spin)], axis=1)


def _cross(one: Floats, other: Floats) -> Floats:
    """Cross products of vectors (.., 3)."""
    x, y, z = one[..., 0], one[..., 1], one[..., 2]
    a, b, c = other[..., 0], other[..., 1], other[..., 2]
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=-1)


def _carried(screws: Floats, point: Floats) -> Floats:
    """What screws (n, 6, k) move points (n, 3) by, (n, 3, k)."""
    spin = np.swapaxes(screws[:, :3], 1, 2)
    moved = _cross(spin, point[:, None, :]) + np.swapaxes(screws[:, 3:], 1, 2)
    return np.ascontiguousarray(np.swapaxes(moved, 1, 2))


def _inverse(matrices: Floats) -> Floats:
    """Pseudo-inverses of (n, 6, m); directions of idle freedoms stand still."""
    return np.asarray(np.linalg.pinv(matrices, rcond=IDLE))
