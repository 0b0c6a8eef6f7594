"""The loop as a value: joints, fixed transforms, points, drive, and the names of its columns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property, reduce
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Booleans, Floats, finite_number, triple, truth, whole_number
from sevenbar.errors import RequestError, check_kind, check_name, check_word, no_joint, no_joint_but
from sevenbar.forces.loading import UNLOADED, Loading
from sevenbar.kinematics.loop.column import Column
from sevenbar.kinematics.loop.graph import Graph, loop_graph
from sevenbar.kinematics.loop.joints import (
    ANYWHERE,
    JOINT_KINDS,
    READ_KINDS,
    Freedom,
    JointKind,
    Step,
    X,
    Z,
    columns_apart,
    kind_row,
    no_reading,
)
from sevenbar.kinematics.loop.rigid import about, inverse, pose, product
from sevenbar.kinematics.loop.stops import NO_STOPS, Stops
from sevenbar.text.given import given_number
from sevenbar.text.printing import Drawable
from sevenbar.text.units import LENGTHS

#: How a linkage is written: the RSSR paper's numbers, rows of Denavit-Hartenberg numbers, the same in the
#: layout of planar textbooks, joints as drawn.
Form = Literal["rssr", "rows", "planar", "drawn"]
_FORMS = get_args(Form)

#: A place in a description: keys of tables, and counts from 0 in lists.
Place = tuple[str | int, ...]

#: Lengths below this part of how far off they are drawn are the rounding of places, as for the core.
NO_SIZE = 64 * float(np.finfo(float).eps)

#: What a linkage is called that was made without a name.
UNNAMED = "linkage"


@dataclass(frozen=True)
class Joint:
    """A joint: the letter of its kind, and its name.

    `pitch` [length per turn, right-handed] of H; `angle` [rad] between the two axes of U. `backwards`: its
    values are those of the link before it against the link after it, as of the last joint of a drawing.
    `value` [rad, or length] of R and P: what it reads in the pose that is drawn.
    """

    kind: str
    name: str
    pitch: float = 0.0
    angle: float = 0.0
    backwards: bool = False
    value: float = 0.0

    def __post_init__(self) -> None:
        check_word("kind", self.kind, JOINT_KINDS, "a joint kind")
        check_name("name", self.name)
        object.__setattr__(self, "backwards", truth("backwards", self.backwards))
        for key, turns in (("pitch", False), ("angle", True), ("value", self.kind == "R")):
            number = getattr(self, key)
            # each load comes this way, with numbers that need nothing
            if type(number) is not float or not math.isfinite(number):
                number = given_number(key, number, "rad") if turns else number
                object.__setattr__(self, key, finite_number(key, number))  # type: ignore[arg-type]
        if self.value and self.kind not in READ_KINDS:
            raise RequestError(f"value: {no_reading(self.kind)}")

    @cached_property
    def row(self) -> JointKind:
        """Its kind's row of the table."""
        return kind_row(self.kind, backwards=self.backwards)

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """One name for each of its freedoms, in loop order."""
        return self.row.columns(self.name)

    @property
    def first(self) -> str:
        """The column that its plain name means: its first freedom by number."""
        return self.columns[-1 if self.row.numbered_back else 0]

    @property
    def advance(self) -> float:
        """The slide of a screw [length] for a radian."""
        return self.pitch / math.tau

    def steps(self, q: Floats) -> list[tuple[Step, Floats]]:
        """Each step, and its values (n,) [rad, or length] from those of the joint's columns (n, columns)."""
        result: list[tuple[Step, Floats]] = []
        column = 0
        for step in self.row.steps:
            if step.driven:
                result.append((step, self.advance * result[-1][1]))
            else:
                result.append((step, q[:, column]))
                column += 1
        return result

    def before(self, step: Step) -> Floats:
        """The fixed transform (4, 4) before a step."""
        return about(X, self.angle, 4) if step.tilted else np.eye(4)

    def motion(self, q: Floats) -> Floats:
        """The motion Z (n, 4, 4) of the link after the joint for the values of its columns (n, columns)."""
        parts = []
        for step, values in self.steps(q):
            parts += [self.before(step)] if step.tilted else []
            parts.append(moved_by(step, values))
        return reduce(product, parts)

    @cached_property
    def to_drawn(self) -> Floats:
        """From its frame on the side that holds its zero to that frame as it is drawn (4, 4).

        That is the link before it, of a joint `backwards` the link after it.
        """
        if not self.value:
            return np.eye(4)
        moved: Floats = self.motion(np.array([[self.value]]))[0]
        return inverse(moved) if self.backwards else moved

    def slid(self, q: Floats) -> Floats:
        """How far it has slid along its axis (n,) [length] for the values of its columns (n, columns)."""
        along = [v for step, v in self.steps(q) if step.freedom == "slide" and step.axis == Z]
        return sum(along, np.zeros(len(q)))


def drawn_off_zero(joints: Sequence[Joint]) -> dict[int, Floats]:
    """What takes joints, by their number from 0, to the drawing from where they read 0: of those it moves."""
    return {i: joint.to_drawn for i, joint in enumerate(joints) if joint.value}


def moved_by(step: Step, values: Floats) -> Floats:
    """The motions (n, 4, 4) of a step by its values (n,)."""
    if step.freedom == "turn":
        return about(step.axis, values, 4)
    return pose(np.eye(3), values[:, None] * np.eye(3)[step.axis])


@dataclass(frozen=True)
class Point:
    """A named point: the link that carries it, counted from 1, and where on it [length]."""

    name: str
    link: int
    at: tuple[float, float, float]

    def __post_init__(self) -> None:
        check_name("name", self.name)
        object.__setattr__(self, "link", whole_number("link", self.link, 1, None, "a link"))
        object.__setattr__(self, "at", triple("at", self.at))


@dataclass(frozen=True)
class BallRod:
    """A link with a ball at each end: its name, the links that it joins, counted from 1, and its two ends.

    The ends `at` [length] are places on these links, as drawn.
    """

    name: str
    between: tuple[int, int]
    at: tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class LinkApart:
    """A link of a net that rods alone hold: its number, and the names and places of its six columns.

    These are slides along x, y and z from where it is drawn and turns about z, y and x, as a joint between
    the ground and the frame `at` (4, 4) on it would read.
    """

    link: int
    at: Floats
    columns: tuple[str, ...]
    place: slice

    def poses(self, q: Floats) -> Floats:
        """Its frames (n, 4, 4) in the report frame, from joint values (n, columns)."""
        values = q[:, self.place].T
        moved = reduce(product, map(moved_by, ANYWHERE.steps, values))
        return product(self.at, product(moved, inverse(self.at)))


@dataclass(frozen=True)
class Drive:
    """The columns of the input and the output, and the input's speed [rad/s, or length/s]."""

    joint: str
    output: str
    speed: float = 1.0

    def __post_init__(self) -> None:
        check_name("joint", self.joint)
        check_name("output", self.output)
        object.__setattr__(self, "speed", finite_number("speed", self.speed))


#: What to do in place of making a linkage by hand.
_MADE_WITH = "make linkages with load, from_axes, from_dh, rssr"

#: The parts of a loop, and what each must be.
_PARTS: Mapping[str, tuple[type, str]] = {
    "joints": (tuple, "a tuple of joints"),
    **dict.fromkeys(("frames", "point_frames"), (np.ndarray, "an array")),
    "drive": (Drive, "a drive"),
    "points": (tuple, "a tuple of points"),
    "dimensions": (Mapping, "a mapping of numbers"),
    "description": (Mapping, "a description"),
    "loading": (Loading, "a loading"),
    "stops": (Stops, "the stops"),
    "link_names": (tuple, "a tuple of names"),
    "rods": (tuple, "a tuple of rods"),
}


@dataclass(frozen=True, eq=False, repr=False)
class Loop(Drawable):
    """A closed loop `base Z(q1) G1 Z(q2) G2 .. Z(qn) = ground`.

    `frames` (n, 2, 4, 4) are those of each joint on the link before it and on the link after it, where it
    reads 0, in the link's own frame: the ground's is that of the report, a moving link's that of the joint
    that it is after. `point_frames` (links, 4, 4) take a point as it is written to its link's own frame.
    `dimensions` are the named numbers of the `form` it was written in, `description` that form itself: the
    tables and keys of a file, from which a linkage with other numbers is made. Redundant constraints `agree`
    up to a closure error [rad, or relative to the size], the usual one where it is `None`;
    `loading` is what acts on it, `stops` what keeps it from moving on: they change no motion. With
    `points_by_two` a circuit takes a place on a link by two numbers only, as the points were given.

    A net of several loops has its graph as `net`, its links' names, the ground's last, and `rods`. There a
    link's own frame is that of the report in the drawn pose.

    Source: docs/theory.md, (1).
    """

    name: str
    joints: tuple[Joint, ...]
    frames: Floats
    point_frames: Floats
    drive: Drive
    length_unit: str = "mm"
    points: tuple[Point, ...] = ()
    dimensions: Mapping[str, float] = field(default_factory=dict)
    form: Form = "drawn"
    description: Mapping[str, Any] = field(default_factory=dict, repr=False)
    loading: Loading = field(default=UNLOADED, repr=False)
    agree: float | None = None
    stops: Stops = field(default=NO_STOPS, repr=False)
    points_by_two: bool = field(default=False, repr=False)
    net: Graph | None = field(default=None, repr=False)
    link_names: tuple[str, ...] = field(default=(), repr=False)
    rods: tuple[BallRod, ...] = ()

    def __post_init__(self) -> None:
        check_name("name", self.name)
        check_word("form", self.form, _FORMS)
        check_word("length_unit", self.length_unit, LENGTHS, "a length unit")
        # a message is made only where it is needed: each load comes this way
        for name, (kind, what) in _PARTS.items():
            if not isinstance(value := getattr(self, name), kind):
                check_kind(name, value, kind, f"{what}; {_MADE_WITH}")
        for name, one in (("joints", Joint), ("points", Point), ("rods", BallRod)):
            for i, part in enumerate(getattr(self, name)):
                if not isinstance(part, one):
                    check_kind(f"{name}[{i}]", part, one, f"a {one.__name__.lower()}; {_MADE_WITH}")
        if self.net is not None:
            check_kind("net", self.net, Graph, f"a graph; {_MADE_WITH}")
        n = len(self.joints)
        links = n if self.net is None else self.net.ground
        shapes = {"frames": (n, 2, 4, 4), "point_frames": (links, 4, 4)}
        for name, shape in shapes.items():
            array = getattr(self, name)
            if array.shape != shape:
                raise RequestError(f"{name}: an array of shape {array.shape}, not {shape}; {_MADE_WITH}")
            array.setflags(write=False)

    def __reduce__(self) -> tuple[type[Loop], tuple[Any, ...]]:
        """Copied and pickled by its fields; what was worked out of them is worked out anew when asked for."""
        return type(self), tuple(getattr(self, field.name) for field in fields(self))

    @property
    def base(self) -> Floats:
        """The frame (4, 4) of joint 1 on the ground."""
        frame: Floats = self.frames[0, 0]
        return frame

    @property
    def ground(self) -> Floats:
        """The frame (4, 4) of the last joint on the ground."""
        frame: Floats = self.frames[-1, 1]
        return frame

    @property
    def links(self) -> Floats:
        """The G's of the moving links (n - 1, 4, 4), from each joint's frame to the next one's."""
        return self.frames[1:, 0]

    @property
    def transforms(self) -> Floats:
        """The G's of all links (n, 4, 4), the ground's last: `Z(q1) G1 .. Z(qn) Gn = 1`."""
        return np.concatenate([self.links, [inverse(self.ground) @ self.base]])

    def joint_on(self, joint: int, link: int) -> Floats:
        """The frame (4, 4) of a joint on one of its links, of the link's own frame, where it reads 0."""
        frame: Floats = self.frames[joint, self.graph.side(joint, link)]
        return frame

    def drawn_joint_on(self, joint: int, link: int) -> Floats:
        """The same as the joint is drawn, whatever it reads there."""
        frame, own = self.joint_on(joint, link), self.joints[joint]
        return frame @ own.to_drawn if own.value and own.backwards == self.graph.side(joint, link) else frame

    @property
    def length(self) -> float:
        """The lengths of all links, from joint to joint, together; of a net between their farthest joints."""
        if self.net is not None:
            return self._length_of_net
        return float(np.linalg.norm(self.transforms[:, :3, 3], axis=1).sum())

    @property
    def _length_of_net(self) -> float:
        ends = [(link, end) for rod in self.rods for link, end in zip(rod.between, rod.at, strict=True)]
        total = sum(math.dist(*rod.at) for rod in self.rods)
        for link in self.graph.links:
            joints = [self.frames[joint, 1, :3, 3] for joint in self.graph.joints_of(link)]
            places = np.array([*joints, *(end for carrier, end in ends if carrier == link)])
            total += float(np.linalg.norm(places[:, None] - places, axis=-1).max())
        return total

    @cached_property
    def size(self) -> float:
        """The size [length], as the core has it: all links' lengths, and pitches by radian; 1 if none."""
        size = self.length + sum(abs(joint.pitch) / math.tau for joint in self.joints)
        reach = max(
            math.hypot(*self.joint_on(joint, self.graph.ground)[:3, 3]) for joint in self.graph.standing
        )
        return size if size > NO_SIZE * reach else 1.0

    @cached_property
    def kind(self) -> str:
        """The joints' letters in loop order; of a net after the word, in the order of the file."""
        letters = "".join(joint.kind for joint in self.joints)
        return letters if self.net is None else f"net {letters}"

    @cached_property
    def graph(self) -> Graph:
        """Its links and joints."""
        return loop_graph(self.joints) if self.net is None else self.net

    def link_name(self, link: int) -> str:
        """What messages call a link, counted from 1."""
        label = self.link_label(link)
        return label if self.link_names else f"link {label}"

    def link_label(self, link: int) -> str:
        """What tables of links call a link, counted from 1: its name, or its number."""
        number = whole_number("link", link, 1, self.graph.ground, "a link")
        return self.link_names[number - 1] if self.link_names else f"{number}"

    @property
    def in_rows(self) -> bool:
        """Whether it is written as rows, a row a link."""
        return self.form in ("rows", "planar")

    @property
    def heading(self) -> str:
        """What reports and figures call it: its name, or what it is where it was given none."""
        if self.name != UNNAMED:
            return self.name
        if self.net is not None:
            return f"net of {self.graph.ground} links"
        letters = self.kind if len(set(self.kind)) > 1 else f"{len(self.kind)}{self.kind[0]}"
        return f"{letters} linkage"

    @cached_property
    def places(self) -> tuple[slice, ...]:
        """Where the columns of each joint stand among all."""
        ends = np.cumsum([len(joint.columns) for joint in self.joints]).tolist()
        return tuple(slice(start, end) for start, end in pairwise([0, *ends]))

    @cached_property
    def each_column(self) -> tuple[Column, ...]:
        """All columns, each with its name, kind, unit and joint."""
        joints = [
            (name, kind, number, not joint.row.is_ball)
            for number, joint in enumerate(self.joints)
            for name, kind in zip(joint.columns, joint.row.freedoms, strict=True)
        ]
        links = [
            (name, kind, None, kind == "slide")
            for apart in self.links_apart
            for name, kind in zip(apart.columns, ANYWHERE.freedoms, strict=True)
        ]
        return tuple(
            Column(place, name, kind, "rad" if kind == "turn" else self.length_unit, number, output)
            for place, (name, kind, number, output) in enumerate([*joints, *links])
        )

    @cached_property
    def links_apart(self) -> tuple[LinkApart, ...]:
        """The links of a net that rods alone hold."""
        names, first = {joint.name for joint in self.joints}, self.places[-1].stop
        result = []
        for link in self.graph.apart:
            rods = (at for rod in self.rods for on, at in zip(rod.between, rod.at, strict=True) if on == link)
            joints = (self.frames[joint, 1, :3, 3] for joint in self.graph.joints_of(link))
            ends = [*map(np.array, rods), *joints]
            at = pose(np.eye(3), np.mean(ends, axis=0))
            columns = columns_apart(self.link_name(link), names)
            result.append(LinkApart(link, at, columns, slice(first, first + len(columns))))
            first += len(columns)
        return tuple(result)

    def joint_of(self, column: int | str) -> int:
        """The joint, counted from 0, of a column by its number or name; `RequestError` if it is of a link."""
        one = self.column_of(column)
        if one.joint is None:
            raise RequestError(f"column: {self._no_end(one.name)}")
        return one.joint

    def column_of(self, column: int | str) -> Column:
        """A column by its number or name; `RequestError` for what is neither."""
        if isinstance(column, str):
            number = self.columns.index(column) if column in self.columns else self.column(column, "column")
        else:
            number = whole_number("column", column, 0, len(self.columns) - 1, "the number of a column")
        return self.each_column[number]

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """The names of the one-freedom joints, in loop order."""
        return tuple(column.name for column in self.each_column)

    @cached_property
    def drawn_pose(self) -> Floats:
        """What the columns (columns,) read in the pose that is drawn [rad, or length]; 0 of other forms."""
        joints = (None if column.joint is None else self.joints[column.joint] for column in self.each_column)
        result = np.array([0.0 if joint is None else joint.value for joint in joints])
        result.setflags(write=False)
        return result

    @cached_property
    def column_kinds(self) -> tuple[Freedom, ...]:
        """What each column is: an angle [rad] or a length."""
        return tuple(column.kind for column in self.each_column)

    @cached_property
    def turning(self) -> Booleans:
        """Whether each column is an angle, not a length, (columns,)."""
        turning = np.array([column.turns for column in self.each_column])
        turning.setflags(write=False)
        return turning

    def turns(self, column: int | str) -> bool:
        """Whether a column, by its number or name, is an angle, not a length."""
        return self.column_of(column).turns

    def unit_of(self, column: int | str) -> str:
        """The unit of a column's values, by its number or name: "rad", or the length unit."""
        return self.column_of(column).unit

    @property
    def added_points(self) -> tuple[Point, ...]:
        """The points that a person has added: all but A and B of an RSSR, which come first."""
        return self.points[2:] if self.kind == "RSSR" else self.points

    def drivable(self, without: int | None = None) -> list[str]:
        """The columns of joints that may drive or be driven: all but those of balls, and but one."""
        left_out = None if without is None else self.column_of(without)
        joints = (one for one in self.each_column if one.is_output and one.joint is not None)
        return [one.name for one in joints if one is not left_out]

    def output_choices(self, without: int | None = None) -> list[str]:
        """The columns that may be the output, but one: those that may drive, places of links on rods."""
        return self.drivable(without) + [one.name for one in self._places_apart]

    @property
    def _places_apart(self) -> list[Column]:
        """The columns that say where links are that rods alone hold."""
        return [one for one in self.each_column if one.is_output and one.joint is None]

    def column(self, name: str, key: str) -> int:
        """The place of a column named by the caller; a joint's name stands for its first one."""
        names = [joint.name for joint in self.joints]
        if key == "output":
            names += [one.name for one in self._places_apart]
        if not isinstance(name, str):
            raise RequestError(f"{key}: {no_joint(name, names)}")
        for joint in self.joints:
            if joint.row.is_ball and name in (joint.name, *joint.columns):
                raise RequestError(
                    f"{key}: joint '{name}' is a ball; "
                    f"give a joint with one freedom: {', '.join(self.drivable())}"
                )
            if name == joint.name:
                return self.columns.index(joint.first)
        if name not in self.columns:
            choices = self.output_choices() if key == "output" else self.drivable()
            raise RequestError(f"{key}: {self._no_column(name, names, choices)}")
        one = self.column_of(name)
        if one.joint is None and not (key == "output" and one in self._places_apart):
            raise RequestError(f"{key}: {self._no_end(name)}")
        return self.columns.index(name)

    def _no_column(self, name: str, names: Sequence[str], choices: Sequence[str]) -> str:
        """What to give in place of a name that no column has: perhaps of a link or of a rod."""
        if name in self.link_names:
            numbers = self.graph.joints_of(self.link_names.index(name) + 1)
            joints = [self.joints[number] for number in numbers]
            of_link = [joint.name for joint in joints if not joint.row.is_ball]
            return no_joint_but(name, choices, of_link)
        if any(name == rod.name for rod in self.rods):
            return no_joint_but(name, choices)
        return no_joint(name, names)

    def _no_end(self, column: str) -> str:
        """What to give in place of a column of a link that rods alone hold."""
        return f"'{column}' is where a link on rods alone is; give a joint: {', '.join(self.drivable())}"

    def input_column(self, name: str | None = None, key: str = "input") -> int:
        """The place of the input's column: that named by the caller under a key, or the drive's."""
        return self.columns.index(self.drive.joint) if name is None else self.column(name, key)

    def end_columns(self, input: str | None = None, output: str | None = None) -> tuple[int, int]:
        """The places of the columns of input and output, those named or the drive's; two different ones."""
        first = self.input_column(input)
        if output is None:
            return first, self.other_column(first)
        second = self.column(output, "output")
        if second == first:
            others = ", ".join(self.output_choices(first))
            raise RequestError(f"output: joint '{output}' is the input; give another: {others}")
        return first, second

    def other_column(self, column: int) -> int:
        """The output where only the input was named: the drive's, else that of the last other joint."""
        column = self.column_of(column).number
        if self.columns[column] != self.drive.output:
            return self.columns.index(self.drive.output)
        last = [
            joint
            for joint in self.joints
            if not joint.row.is_ball and self.columns[column] not in joint.columns
        ]
        name = last[-1].first if last else self.output_choices(column)[-1]
        return self.columns.index(name)

    def driven_alike(self, column: int) -> bool:
        """Whether a column turns or slides as the drive's does, so that the drive's speed can be its own."""
        return self.turns(self.drive.joint) == self.turns(column)

    def speed_of(self, column: int) -> float:
        """The speed [rad/s, or length/s] at which a column drives where none is given: the drive's, or 1."""
        return self.drive.speed if self.driven_alike(column) else 1.0

    def speed_written(self, column: int) -> str:
        """That speed as the description has it, "3000 rpm"; empty where it is a number, or none."""
        drive = self.description.get("drive", {})
        written = drive.get("speed", "") if isinstance(drive, Mapping) else ""
        return written if isinstance(written, str) and self.driven_alike(column) else ""


def loop_frames(base: Floats, links: Floats, ground: Floats) -> Floats:
    """`frames` (n, 2, 4, 4) of a loop by its `base`, `links` and `ground`."""
    result = np.empty((len(links) + 1, 2, 4, 4))
    result[0, 0], result[1:, 0] = base, links
    result[:-1, 1], result[-1, 1] = np.eye(4), ground
    return result


def following_coupler(
    m: npt.ArrayLike, n: npt.ArrayLike, crank: npt.ArrayLike, rocker: npt.ArrayLike
) -> Floats:
    """L2 [length] of an RSSR that leaves it out, numbers or arrays: `L2^2 = (L1 - M)^2 + L3^2 + N^2`.

    Source: Sun and Zhou, eq. (7).
    """
    return np.hypot(np.hypot(np.subtract(crank, m), rocker), n)
