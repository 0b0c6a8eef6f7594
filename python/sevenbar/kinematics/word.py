"""A description as a word: the fixed transforms of its loop as products of steps that hold its numbers.

    F_0 Z_1 F_1 Z_2 .. Z_n F_n = 1                                                                        (1)

with one step Z for each freedom, and each F a product of factors: turns about and slides along an axis by a
number (RSSR, Denavit-Hartenberg rows), frames on drawn lines, constants.

The last joint of a drawing counts the link before it against the ground, right-handed about its axes as they
are written. It moves in a frame that is turned from the drawn one by half, so that its axes are reversed:

    Z_kind(q)^-1 = H Z(q) H,        H = H^-1                                                              (2)

A ball before a link that would spin idly stands here as the two turns that the core holds it to.

Source: docs/theory.md, (1); docs/theory_design.md, (2).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.factors import (
    SPIN_UNDEFINED,
    Back,
    DrawnFrame,
    Factor,
    Held,
    Place,
    Product,
    Still,
    TurnAndSlide,
    Values,
)
from sevenbar.kinematics.geometry import Form
from sevenbar.kinematics.joints import KINDS, JointKind, Z
from sevenbar.kinematics.rigid import (
    axis_to_z,
    cross,
    frame_about,
    half_turn,
    pose,
)

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
    """From the frame of a drawn joint to that in which it moves: by half a turn of the last one, (2)."""
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
