"""A description as a word: the fixed transforms of its loop as products of steps that hold its numbers.

    F_0 Z_1 F_1 Z_2 .. Z_n F_n = 1                                                                        (1)

with one step Z for each freedom, and each F a product of factors: turns about and slides along an axis by a
number (RSSR, Denavit-Hartenberg rows), frames on drawn lines, constants. The core has the factors and moves
them by their numbers (`crates/sevenbar-core/src/loops/numbers/factors.rs`).

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
from itertools import accumulate
from types import MappingProxyType
from typing import Any

import numpy as np

import sevenbar._core as _core
from sevenbar._core import Product
from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Form, Place
from sevenbar.kinematics.loop.joints import KINDS, JointKind, Z
from sevenbar.kinematics.loop.rigid import axis_to_z, cross, half_turn, inverse, pose, unit
from sevenbar.kinematics.numbers.lengths import LONGER, axis_at

#: A point that a link carries.
Carried = _core.Carried

#: Where the three numbers of a vector stand among those of a description.
Three = tuple[int, int, int]

#: Below this sine another axis than that of the joint before holds a spin.
ANOTHER_AXIS = 1e-8

#: Report frame of Denavit-Hartenberg rows against the frame of the ground link: x is j, y is k, z is i.
I_ALONG_LAST_AXIS = pose([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], np.zeros(3))

#: A point (u, v, w) on a row's link: u along its joint, v along the link, w = u x v.
UVW = pose([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], np.zeros(3))

#: The ground's side of the rocker of an RSSR turns about -x, so that its value is the paper's beta.
ROCKER_GROUND = pose([[0, 0, -1], [-1, 0, 0], [0, 1, 0]], np.zeros(3))

#: Half turns about x and z.
HALF_TURN_X = half_turn((1, 0, 0))
HALF_TURN_Z = half_turn((0, 0, 1))

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
    pitch: int | None = None
    held: bool = False


class Slots(dict[Place, int]):
    """Where numbers of a description stand among all, by their places; what it leaves out is 0.

    `across` are the directions of `lengths.across`. `to_drawn` (4, 4) are those of joints, by their number
    from 0, that do not read 0 as drawn: no number that can be changed moves anything by them.
    """

    across: Mapping[int, Floats] = MappingProxyType({})
    to_drawn: Mapping[int, Floats] = MappingProxyType({})

    def read_zero(self, joint: int) -> Product:
        """From a joint's frame as drawn to that where it reads 0."""
        return Product.still(inverse(self.to_drawn[joint])) if joint in self.to_drawn else Product()

    def three(self, place: Place) -> Three:
        """Where the numbers of a vector stand."""
        return self[*place, 0], self[*place, 1], self[*place, 2]

    def slide(self, axis: int, place: Place) -> Product:
        """A slide along an axis by a number."""
        return Product.slide(axis, self[place]) if place in self else Product()

    def turn(self, axis: int, place: Place) -> Product:
        """A turn about an axis by a number."""
        return Product.turn(axis, self[place]) if place in self else Product()


@dataclass(frozen=True)
class Word:
    """The word of a form: base, links between the joints, and ground; and the freedoms of each joint.

    `inner` stands before, between and behind the freedoms of joint i, empty where nothing does. `frames` take
    a point as it is written to its link's own.
    """

    slots: Slots

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
        result = [self.base]
        for freedoms, inside, behind in zip(self.freedoms, self.inner, outer, strict=True):
            parts = inside or (Product(),) * (len(freedoms) + 1)
            result[-1] = result[-1] + parts[0]
            result += [*parts[1:-1], parts[-1] + behind]
        return tuple(result)

    def carrier(self, link: int) -> tuple[int, Product]:
        """The steps before a link, counted from 1, and the frame there in which its points are written."""
        frame = self.frames[link - 1]
        if link == len(self.freedoms):
            # the ground's own frame is that of the report
            return 0, frame
        return sum(map(len, self.freedoms[:link])), self._behind(link) + frame

    def _behind(self, link: int) -> Product:
        """What stands behind the freedoms of the joint before a link."""
        inner = self.inner[link - 1]
        return inner[-1] if inner else Product()

    def beyond(self, joint: int) -> Product | None:
        """What is between a joint and the next one; `None` behind those that lead to the ground."""
        return self.links[joint] if joint + 1 < len(self.links) else None

    def axes_of_spun(self, joint: int) -> list[Product]:
        """The frames of the axes about which a ball that holds a spin turns, both and the held one."""
        return list(accumulate(self.inner[joint][:3]))

    def rod(self, link: int) -> tuple[Carried, Carried]:
        """The places of the joints before and behind a link, counted from 1, the ground being the last."""
        first, last = (self.slots.read_zero(i).back for i in (0, len(self.freedoms) - 1))
        if link == len(self.freedoms):
            return Carried(0, self.ground + last), Carried(0, self.base + first)
        steps = sum(map(len, self.freedoms[:link]))
        behind, after = self._behind(link), self.links[link - 1]
        if link < len(self.freedoms) - 1:
            after += self.slots.read_zero(link).back
        return Carried(steps, behind), Carried(steps, behind + after)

    def axis(self, column: int, length: float) -> tuple[Carried, Carried]:
        """Two points on the axis of the joint of a column, so far apart."""
        count = next(k for k, step in enumerate(self.steps, 1) if column in step.columns)
        first, second = (Carried(count, Product(), None, (0.0, 0.0, end)) for end in (0.0, length))
        return first, second

    def place(self, link: int, at: tuple[float, float, float]) -> Carried:
        """A point of a link, counted from 1, that no number moves on it."""
        return Carried(*self.carrier(link), None, at)

    def point(self, link: int, place: Place) -> Carried:
        """A point of a link, counted from 1, as it is written at a place."""
        return Carried(*self.carrier(link), self.slots.three(place))


def word_of(
    form: Form, kinds: Sequence[str], slots: Slots, spun: Mapping[int, Floats | None] | None = None
) -> Word:
    """The word of a form with joints of these kinds, whose numbers stand in `slots`.

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
            inner.append(_turns_of_spun(form, kinds, slots, i, spun[i]))
        elif row.is_ball or row.is_screw:
            pitch = slots.get((TABLES[form], i, "pitch")) if row.is_screw else None
            own = [WordStep(kind, i, tuple(columns), pitch)]
            inner.append(())
        else:
            own = [WordStep(step.letter, i, (c,)) for c, step in zip(columns, row.steps, strict=True)]
            inner.append(_inner(kinds, slots, i, row))
        freedoms.append(tuple(own))
    return Word(slots, *outer_of(form, kinds, slots), tuple(freedoms), tuple(inner))


def _rows_of(form: Form, kinds: Sequence[str]) -> list[JointKind]:
    """The kinds of the joints in loop order: the last one of a drawing counts its link against the ground."""
    rows = [KINDS[kind] for kind in kinds]
    return [*rows[:-1], rows[-1].backwards] if form == "drawn" else rows


def _turned(kinds: Sequence[str], joint: int) -> Product:
    """From the frame of a drawn joint to that in which it moves: by half a turn of the last one, (2)."""
    last = joint + 1 == len(kinds)
    return Product.still(half_turn(KINDS[kinds[joint]].half_turn)) if last else Product()


def holding_axis(
    form: Form, kinds: Sequence[str], slots: Slots, values: Floats, ball: int, axis: Floats
) -> Floats | None:
    """The axis that holds the spin beyond a ball, `None` where it is that of the joint before."""
    if form == "rssr":
        return None
    if ball > 0 and not KINDS[kinds[ball - 1]].is_ball:
        before = unit(values[list(_axes(kinds, slots, ball - 1)[-1])])
        if math.hypot(*cross(before, axis)) < ANOTHER_AXIS:
            return None
    return axis


_Outer = tuple[Product, tuple[Product, ...], Product, tuple[Product, ...]]


def outer_of(form: Form, kinds: Sequence[str], slots: Slots) -> _Outer:
    """What is fixed in the word of a form: `base`, `links`, `ground` and `frames` of points."""
    shape = {"rssr": _rssr, "rows": _rows, "planar": _planar, "drawn": _drawn}[form]
    return shape(kinds, slots)


def _rssr(kinds: Sequence[str], slots: Slots) -> _Outer:
    m, n, d, crank, coupler, rocker = (
        slots.slide(axis, ("rssr", key))
        for axis, key in ((0, "M"), (2, "N"), (1, "D"), (0, "L1"), (0, "L2"), (0, "L3"))
    )
    ground = m + d + Product.still(ROCKER_GROUND)
    return n, (crank, coupler, rocker + Product.still(HALF_TURN_X)), ground, (Product(),) * len(kinds)


def _rows(kinds: Sequence[str], slots: Slots) -> _Outer:
    """Rows `Rz(theta) Tz(offset) Tx(length) Rx(twist)`: the joint's own motion, then turn, then span."""
    report = Product.still(I_ALONG_LAST_AXIS)
    count = range(len(kinds))
    # of a slide the angle is fixed and the offset moves
    turns = [
        slots.turn(2, ("link", i, "angle"))
        if "angle" in KINDS[kinds[i]].row_keys
        else slots.slide(2, ("link", i, "offset"))
        for i in count
    ]
    spans = [slots.turn(0, ("link", i, "twist")) + slots.slide(0, ("link", i, "length")) for i in count]
    ground = report + turns[-1].back
    # v of a point goes along the link, so behind the fixed angle; u counts from before the offset
    frames = [slots.turn(2, ("link", i, "angle")) + Product.still(UVW) for i in count]
    frames[-1] = ground + frames[-1]
    links = tuple(turn + span for turn, span in zip(turns[:-1], spans[:-1], strict=True))
    return report + spans[-1], links, ground, tuple(frames)


def _planar(kinds: Sequence[str], slots: Slots) -> _Outer:
    """The rows as planar textbooks lay them out: x runs along the ground, from the first joint to the last.

    The first angle counts from x, half a turn off that of the rows; the last one is that of the link before
    the ground, which the ground's in the rows is backwards.
    """
    base, links, ground, frames = _rows(kinds, slots)
    # in place of the report frame of the rows
    start = Product.still(HALF_TURN_Z) + base.back
    under = Product.still(HALF_TURN_X)
    links = (*links[:-1], links[-1] + under)
    return Product(), links, start + ground + under, (*frames[:-1], start + frames[-1])


def _axes(kinds: Sequence[str], slots: Slots, joint: int) -> list[Three]:
    """Where the axes of a drawn joint stand: one, two of U, none of a ball."""
    keys, place = KINDS[kinds[joint]].drawn_keys, ("joint", joint)
    if "axes" in keys:
        return [slots.three((*place, "axes", which)) for which in (0, 1)]
    return [slots.three((*place, "axis"))] if "axis" in keys else []


def _drawn_frames(kinds: Sequence[str], slots: Slots, joint: int) -> tuple[Product, Product]:
    """The frames before and behind a joint."""
    # x goes towards the joint behind, of the last one towards that before
    at, towards = (
        slots.three(("joint", i, "at")) for i in (joint, joint + 1 if joint + 1 < len(kinds) else joint - 1)
    )
    row, axes = KINDS[kinds[joint]], _axes(kinds, slots, joint)
    if row.has_cross:
        first, second = (Product.drawn(at, axes, which, towards, False) for which in (0, 1))
        return first, second
    # the pin is z, and its slot y
    axes = axes[::-1] if row.slot_on_after else axes
    frame = Product.drawn(at, axes, max(len(axes) - 1, 0), towards, row.has_plane)
    return frame, frame


def _drawn(kinds: Sequence[str], slots: Slots) -> _Outer:
    """Joints as drawn: the frames on both sides of each where it reads 0, in ground coordinates."""
    count = len(kinds)
    pairs = [_drawn_frames(kinds, slots, i) for i in range(count)]
    sides = [[side + _turned(kinds, i) for side in pair] for i, pair in enumerate(pairs)]
    before = [side[0] + slots.read_zero(i) for i, side in enumerate(sides[:-1])] + [sides[-1][0]]
    behind = [side[1] for side in sides[:-1]] + [sides[-1][1] + slots.read_zero(count - 1)]
    links = tuple(behind[i].back + _longer(kinds, slots, i) + before[i + 1] for i in range(len(kinds) - 1))
    frames = (*(frame.back for frame in behind[:-1]), Product())
    return before[0], links, behind[-1], frames


def _longer(kinds: Sequence[str], slots: Slots, link: int) -> Product:
    """What a link of a drawing, counted from 0, is longer than drawn, in ground coordinates."""
    place = ("joint", link, LONGER)
    if place not in slots:
        return Product()
    line = [slots.three(("joint", i, "at")) for i in (link, link + 1)]
    result = axis_at(kinds, link)
    if result is None:
        frame = Product.held(line, 3, None, slots.across[link])
    else:
        joint, which = result
        frame = Product.held(line, 3, _axes(kinds, slots, joint)[which], np.zeros(3))
    # its z runs against the line
    return frame + slots.slide(2, place).back + frame.back


def _inner(kinds: Sequence[str], slots: Slots, joint: int, row: JointKind) -> tuple[Product, ...]:
    """What stands before, between and behind the steps of a joint, each about or along z."""
    parts, ahead = [], Product()
    for step in row.steps:
        if step.tilted:
            before, behind = _drawn_frames(kinds, slots, joint)
            turned = _turned(kinds, joint)
            ahead += turned.back + before.back + behind + turned
        if step.axis == Z:
            parts.append(ahead)
            ahead = Product()
        else:
            frame = Product.still(axis_to_z(step.axis))
            parts.append(ahead + frame)
            ahead = frame.back
    return (*parts, ahead)


def _turns_of_spun(
    form: Form, kinds: Sequence[str], slots: Slots, ball: int, axis: Floats | None
) -> tuple[Product, ...]:
    """What stands before, between and behind the turns of a ball that holds a spin."""
    if form == "rssr":
        a, b, c = (Product.still(axis_to_z(k)) for k in (2, 1, 0))
    else:
        written = _axes(kinds, slots, ball - 1)[-1] if axis is None else None
        line = [slots.three(("joint", i, "at")) for i in (ball, ball + 1)]
        a, b, c = (Product.held(line, k, written, np.zeros(3) if axis is None else axis) for k in range(3))
    return a, a.back + b, b.back + c, c.back


def points_of(form: Form, word: Word, description: Mapping[str, Any], kind: str) -> list[Carried]:
    """The points of a linkage: the balls A and B of an RSSR, then those of its description."""
    result: list[Carried] = []
    if form == "rssr":
        result += [
            Carried(1, word.slots.slide(0, ("rssr", "L1"))),
            Carried(len(word.steps) - 1, Product()),
        ]
    elif kind == "RSSR":
        # the crank may be longer than drawn
        steps, frame = word.carrier(1)
        ball = word.slots.three(("joint", 1, "at"))
        result.append(Carried(steps, frame + _longer(kind, word.slots, 0), ball))
        result.append(word.point(3, ("joint", 2, "at")))
    tables = enumerate(description.get("point", ()))
    return result + [word.point(int(table["link"]), ("point", i, "at")) for i, table in tables]
