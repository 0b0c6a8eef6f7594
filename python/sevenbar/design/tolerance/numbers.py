"""The fixed transforms of a linkage as functions of the numbers of its description.

What `forms` makes of a description, but for many values of its numbers at once and for complex ones, so that
a derivative by a number is a complex step through the construction itself. A loop of one-freedom columns is

    F_0 Z_1 F_1 Z_2 .. Z_n F_n = 1,        F_0 the base, F_n the inverse of the ground's frame             (1)

C is a turn and a slide, U two turns with its angle between them, S turns about z, y and x.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Dimension, Draft
from sevenbar.description.forms import NO_LENGTH
from sevenbar.design.tolerance.rigid import (
    Numbers,
    Rigid,
    about,
    constant,
    cross,
    inverse,
    moved,
    then,
    unit,
)
from sevenbar.kinematics.joints import KINDS
from sevenbar.kinematics.linkage import Linkage

#: The axes of a ball's turns.
BALL_AXES = tuple(step.axis for step in KINDS["S"].steps)

#: Report frame of rows against the ground link's; a point (u, v, w) of a row against its link's frame.
RENAMED = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
UVW = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))

#: The ground's side of the rocker of an RSSR, whose value is the paper's beta.
ROCKER_GROUND = ((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


@dataclass(frozen=True)
class Column:
    """A one-freedom part of a joint: does it turn, and about or along which axis of its frame.

    `joint` counts from 0; `ends` where it is the joint's last column, behind which its link begins.
    """

    joint: int
    turns: bool
    axis: int
    ends: bool
    ball: bool


@dataclass(frozen=True, eq=False)
class Built:
    """The F (n + 1), the advances for a radian (n,), the points on their links (3, ..): for numbers p."""

    fixed: list[Rigid]
    advances: list[Numbers]
    points: list[Numbers]


@dataclass(frozen=True, eq=False)
class Numbered:
    """A linkage with the numbers of its description, all that can be made a little wrong.

    `dimensions` stand in the order of the file, each in its unit there. A length that the file leaves out as
    it follows from others (L2) is a number of its own, as it is of a part that is made.
    """

    linkage: Linkage
    draft: Draft
    dimensions: tuple[Dimension, ...]

    @staticmethod
    def of(linkage: Linkage) -> Numbered:
        """The numbers of a linkage's description; `RequestError` for a linkage made without one."""
        draft = Draft.of_linkage(linkage)
        return Numbered(linkage, draft, tuple(d for d in draft.dimensions if d.kind != "speed"))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the dimensions."""
        return tuple(dimension.name for dimension in self.dimensions)

    @cached_property
    def nominal(self) -> Floats:
        """The numbers (k,) as they stand."""
        return np.array([dimension.value for dimension in self.dimensions])

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The one-freedom columns in loop order."""
        found = []
        for i, joint in enumerate(self.linkage.joints):
            steps = [step for step in joint.row.steps if not step.driven]
            for step in steps:
                turns, ends = step.freedom == "turn", step is steps[-1]
                found.append(Column(i, turns, step.axis, ends, joint.row.is_ball))
        return tuple(found)

    def built(self, p: Numbers) -> Built:
        """The transforms for numbers p (k, ..), analytic in each."""
        made = {"rssr": _rssr, "rows": _rows, "drawn": _drawn}[self.linkage.form]
        return made(_Parts(self, p))

    def changed(self, p: Floats) -> Linkage:
        """The linkage that a file with other numbers (k,) describes."""
        return self.draft.with_values(dict(zip(self.names, p.tolist(), strict=True))).linkage


class _Parts:
    """The numbers of a description by their places in it, as arrays with the same axes behind."""

    def __init__(self, whole: Numbered, p: Numbers) -> None:
        self.whole = whole
        self._p = p
        self._places = {dimension.place: k for k, dimension in enumerate(whole.dimensions)}
        self.trailing = p.ndim - 1
        self.zero = np.zeros(p.shape[1:], dtype=p.dtype)
        self.origin = self.constant((0.0, 0.0, 0.0))
        self.still: Rigid = (self.constant(np.eye(3)), self.origin)

    def constant(self, values: object) -> Numbers:
        return constant(np.asarray(values), self.trailing)

    def number(self, *place: str | int) -> Numbers:
        """The number at a place, angles in radians; 0 where the description has none."""
        k = self._places.get(place)
        return self.zero if k is None else np.asarray(self._p[k] * self.whole.dimensions[k].scale)

    def vector(self, *place: str | int) -> Numbers:
        return np.stack([self.number(*place, axis) for axis in range(3)])

    def along(self, axis: int, length: Numbers) -> Numbers:
        """The vector of a length along an axis."""
        return np.stack([length if k == axis else self.zero for k in range(3)])

    def between(self, outer: Sequence[Rigid], inner: Sequence[Rigid] | None = None) -> list[Rigid]:
        """The F of all columns, from those before, between and behind the joints, and those inside them."""
        fixed = [outer[0]]
        for column in self.whole.columns:
            inside = self.still if inner is None else inner[column.joint]
            fixed.append(outer[column.joint + 1] if column.ends else inside)
        return fixed

    def points(self, frames: Sequence[Rigid]) -> list[Numbers]:
        """The description's points on their links; `frames` take them to their links' own."""
        tables = self.whole.draft.raw.get("point", ())
        return [moved(frames[t["link"] - 1], self.vector("point", i, "at")) for i, t in enumerate(tables)]


def _rssr(parts: _Parts) -> Built:
    m, n, l1, l2, l3, d = (parts.number("rssr", key) for key in ("M", "N", "L1", "L2", "L3", "D"))
    one = parts.still[0]
    ground = parts.constant(ROCKER_GROUND), np.stack([m, d, parts.zero])
    outer = [
        (one, parts.along(2, n)),
        (one, parts.along(0, l1)),
        (one, parts.along(0, l2)),
        (parts.constant(np.diag([1.0, -1.0, -1.0])), parts.along(0, l3)),
        inverse(ground),
    ]
    points = [parts.along(0, l1), parts.along(0, parts.zero), *parts.points([parts.still] * 4)]
    return Built(parts.between(outer), [parts.zero] * len(parts.whole.columns), points)


def _rows(parts: _Parts) -> Built:
    """Rows `Rz(theta) Tz(offset) Tx(length) Rx(twist)`: the joint's own motion, then turn, then span."""
    turns, spans, frames, advances = [], [], [], []
    for i, joint in enumerate(parts.whole.linkage.joints):
        length, twist, offset, angle, pitch = (
            parts.number("link", i, key) for key in ("length", "twist", "offset", "angle", "pitch")
        )
        # of a slide the angle is fixed and the offset moves
        fixed_angle, fixed_offset = (angle, parts.zero) if joint.kind == "P" else (parts.zero, offset)
        turn = about(2, fixed_angle)
        turns.append((turn, parts.along(2, fixed_offset)))
        spans.append((about(0, twist), parts.along(0, length)))
        # u of a point counts from before the offset, v goes along the link
        frames.append(then((turn, parts.origin), (parts.constant(UVW), parts.origin)))
        advances.append(pitch / math.tau)
    report = parts.constant(RENAMED), parts.origin
    last = then(turns[-1], inverse(report))
    frames[-1] = then(inverse(last), frames[-1])
    links = [then(turn, span) for turn, span in zip(turns[:-1], spans[:-1], strict=True)]
    return Built([then(report, spans[-1]), *links, last], advances, parts.points(frames))


def _drawn(parts: _Parts) -> Built:
    """As drawn: a turn of a joint's frame about its own axis changes nothing, so x goes anywhere."""
    linkage, tables = parts.whole.linkage, parts.whole.draft.raw["joint"]
    before, after, advances = [], [], []
    for i, joint in enumerate(linkage.joints):
        at = parts.vector("joint", i, "at")
        if joint.kind == "S":
            first = second = parts.still[0]
        elif joint.kind == "U":
            ends = [unit(parts.vector("joint", i, "axes", which)) for which in (0, 1)]
            x = unit(cross(*ends))
            first, second = (np.stack([x, cross(z, x), z], axis=1) for z in ends)
        else:
            z = unit(parts.vector("joint", i, "axis"))
            across = np.eye(3)[np.argmin(np.abs(np.asarray(tables[i]["axis"], dtype=np.float64)))]
            x = unit(cross(parts.constant(across), z))
            if joint.row.has_plane:
                # x counts: as `forms` has it, towards the joint after, of the last joint that before
                beside = i + 1 if i + 1 < len(tables) else i - 1
                towards = parts.vector("joint", beside, "at") - at
                aside = cross(cross(z, towards), z)
                far = np.linalg.norm(aside.real) > NO_LENGTH * np.linalg.norm(towards.real)
                x = unit(aside) if far else unit(cross(cross(z, parts.constant(across)), z))
            first = second = np.stack([x, cross(z, x), z], axis=1)
        before.append((first, at))
        after.append((second, at))
        advance = parts.number("joint", i, "pitch") / math.tau
        advances += [advance for column in parts.whole.columns if column.joint == i]
    links = [then(inverse(a), b) for a, b in zip(after[:-1], before[1:], strict=True)]
    inner = [then(inverse(b), a) for a, b in zip(after, before, strict=True)]
    fixed = parts.between([before[0], *links, inverse(after[-1])], inner)
    frames = [*(inverse(a) for a in after[:-1]), parts.still]
    balls = ((1, 1), (3, 2)) if linkage.kind == "RSSR" else ()
    own = [moved(frames[link - 1], parts.vector("joint", joint, "at")) for link, joint in balls]
    return Built(fixed, advances, own + parts.points(frames))
