"""A loop with a point as a word of steps, each a turn about and a slide along one line, from its description.

    C_1 C_2 .. C_m = 1,        C = exp(S t)                                                               (1)

with the line S as it lies with all joints at zero, and the amount t a joint value, a dimension or a constant.
In `[rssr]` and in Denavit-Hartenberg rows the lines are axes of one frame and dimensions are amounts; in a
drawing joints are the only steps, and dimensions move their lines.

Source: docs/theory_design.md, (5).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.geometry import Point, following_coupler
from sevenbar.kinematics.linkage import Linkage

#: Below this sine of the angle between a coupler and the axis before it another axis holds its spin.
SPIN_UNDEFINED = 1e-8

#: Axes u, v, w of a row's point in the frame of its link.
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


class PointWord:
    """The word of a draft with one point, for any values of its dimensions.

    `varied` are the numbers, among `dimensions`, of those that may change: a coupler that the file leaves out
    follows from the others unless it is one of them.
    """

    def __init__(self, draft: Draft, point: Point, varied: Sequence[int] = ()) -> None:
        self._raw = draft.raw
        self._linkage = draft.linkage
        if plane := next((joint for joint in self._linkage.joints if joint.row.has_plane), None):
            raise NotCoveredError(
                f"linkage: {plane.name} slides in a plane, and no path is sought with such a joint; "
                "draw it as P, P and R"
            )
        self._point = point
        self.dimensions = tuple(d for d in draft.dimensions if d.name != "speed")
        self.start = np.array([d.value for d in self.dimensions])
        self.varied = tuple(varied)
        self._numbers = {d.place: i for i, d in enumerate(self.dimensions)}
        self._spun = _spun_balls(self._linkage)

    def word(self, values: Floats) -> Word:
        """The word of the dimensions' values (k,)."""
        if self._linkage.form == "rssr":
            return self._rssr_word(values)
        return self._rows_word(values) if self._linkage.form == "rows" else self._drawn_word(values)

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
        length = float(following_coupler(m, n, crank, rocker))
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
