"""The kinds of joints, one row each: the steps it is made of, its words, its keys, how it is drawn and built.

A joint moves the link after it against the link before by `Z(q)`, the product of its steps. A step is a turn
about or a slide along an axis of the frame that the steps before it have moved; the columns of a joint are
the values of its steps, except a slide that a screw's turn drives.

The last joint of a drawing is `backwards`: it counts the link before it against the ground, as the first
joint counts the link after it. So its own motion is taken back,

    Z(q)^-1 = Z_k(-q_k) .. Z_1(-q_1),

which is a product of steps again, in a frame turned by half: about x, where z is the only axis that counts.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

Freedom = Literal["turn", "slide"]

#: What a joint is drawn and built as; `drawing.joint_shapes` has each.
ShapeName = Literal["cylinder", "block", "thread", "arm", "ball", "plate", "slot"]

#: The axes of a frame.
X, Y, Z = 0, 1, 2


@dataclass(frozen=True)
class Step:
    """A part of a joint with one freedom: a turn about or a slide along x, y or z (`axis` 0, 1, 2).

    `tilted`: it stands after the turn about x by the joint's fixed `angle`. `driven`: a slide of `pitch` for
    each turn of the step before, without a column of its own.
    """

    freedom: Freedom
    axis: int = Z
    tilted: bool = False
    driven: bool = False

    @property
    def letter(self) -> str:
        """The kind of joint that is this step alone."""
        return "R" if self.freedom == "turn" else "P"

    @property
    def number(self) -> int:
        """Its place among the six freedoms of a body: slides along x, y, z, then turns about them."""
        return self.axis + 3 * (self.freedom == "turn")


@dataclass(frozen=True)
class JointKind:
    """All that distinguishes a kind of joint from the others.

    `legend` is what figures call it, `words` are those that people write for it. `steps` stand in loop
    order. `drawn_keys` are the keys that it needs as drawn beside its
    place, `row_keys` the numbers of a Denavit-Hartenberg row; a kind without them is written `as_rows`.
    `shape` is how it is drawn and built, `adams` what ADAMS calls it. `numbered_back`: the names of its
    columns count from its last step.
    """

    letter: str
    legend: str
    words: tuple[str, ...]
    steps: tuple[Step, ...]
    drawn_keys: tuple[str, ...]
    shape: ShapeName
    adams: str
    row_keys: tuple[str, ...] = ()
    as_rows: str = ""
    numbered_back: bool = False

    @cached_property
    def freedoms(self) -> tuple[Freedom, ...]:
        """What each of its columns is."""
        return tuple(step.freedom for step in self.steps if not step.driven)

    @cached_property
    def free(self) -> tuple[bool, ...]:
        """Which of the six freedoms of a body it lets go, seen from the frame before it."""
        numbers = {step.number for step in self.steps}
        return tuple(number in numbers for number in range(6))

    @cached_property
    def is_ball(self) -> bool:
        """Whether it turns any way about a place: such a joint is not driven, and its turns are no output."""
        return self.freedoms == ("turn",) * 3

    @cached_property
    def bends(self) -> bool:
        """Whether it turns about more than one axis through one place: its bend is an angle of a cone."""
        return len(self.freedoms) > 1 and set(self.freedoms) == {"turn"}

    @cached_property
    def rides(self) -> bool:
        """Whether it slides along its axis, as on a rail."""
        return any(step.freedom == "slide" and step.axis == Z for step in self.steps)

    @cached_property
    def has_plane(self) -> bool:
        """Whether it slides across its axis, so that x of its frame counts."""
        return any(step.freedom == "slide" and step.axis != Z for step in self.steps)

    @cached_property
    def has_plate(self) -> bool:
        """Whether it slides any way in a plane."""
        return self.has_plane and self.freedoms.count("slide") > 1

    @cached_property
    def slides_on_after(self) -> bool:
        """Whether it slides along axes of the link after it: across a turn that comes first."""
        return self.has_plane and self.steps[0].freedom == "turn"

    @cached_property
    def has_slot(self) -> bool:
        """Whether it slides along one line across its axis."""
        return self.has_plane and not self.has_plate

    @cached_property
    def slot_on_after(self) -> bool:
        """Whether the link after it has its slot."""
        return self.has_slot and self.slides_on_after

    @cached_property
    def has_cross(self) -> bool:
        """Whether a body of its own stands between its steps."""
        return any(step.tilted for step in self.steps)

    @cached_property
    def is_screw(self) -> bool:
        """Whether its slide follows from its turn."""
        return any(step.driven for step in self.steps)

    @cached_property
    def half_turn(self) -> tuple[int, int, int]:
        """The axis of the half turn that takes its frame to that of the joint `backwards`.

        It reverses z. Where several axes of the frame count, two of them change places: reversed, all three
        would make no frame.
        """
        if self.is_ball:
            return (1, 0, -1)
        return (1, -1, 0) if self.has_plate else (1, 0, 0)

    @cached_property
    def backwards(self) -> JointKind:
        """The kind of a joint that counts the link before it against the link after it, in the turned frame.

        A ball turns about the same axes of the turned frame, and a joint in a plane turns first; both are
        numbered from the last step. In other kinds the steps are on one axis, or each has a link of its own
        that holds its axis, as a slot: the order is that of the kind itself.
        """
        if self.has_plate:
            turn, one, other = Step("turn"), Step("slide", X), Step("slide", Y)
            return replace(self, steps=(turn, one, other), numbered_back=True)
        return replace(self, numbered_back=True) if self.is_ball else self

    def columns(self, joint: str) -> tuple[str, ...]:
        """The names of the columns of a joint of this name, in loop order."""
        names = column_names(joint, self.freedoms)
        return names[::-1] if self.numbered_back else names

    def named(self, joint: str) -> list[tuple[str, Step]]:
        """The steps of a joint of this name, each by its column's; a screw's slide has a name of its own."""
        names = iter(self.columns(joint))
        return [(f"{joint}.slide" if step.driven else next(names), step) for step in self.steps]

    @cached_property
    def moving_key(self) -> str:
        """The key of a row that is its variable, and so is not written."""
        return "offset" if "angle" in self.row_keys else "angle"


_AXIS = ("axis",)
_TURN, _SLIDE = Step("turn"), Step("slide")

#: Every kind of joint, by its letter.
KINDS: Mapping[str, JointKind] = {
    row.letter: row
    for row in (
        JointKind(
            "R", "hinge", ("revolute", "hinge", "pin", "turning", "rotary", "rotation"),
            (_TURN,), _AXIS, "cylinder", "revolute",
            row_keys=("length", "offset", "twist"),
        ),
        JointKind(
            "P", "slide", ("prismatic", "slider", "sliding", "slide", "translation"),
            (_SLIDE,), _AXIS, "block", "translational",
            row_keys=("length", "angle", "twist"),
        ),
        JointKind(
            "H", "screw", ("helical", "helix", "screw"),
            (_TURN, Step("slide", driven=True)), ("axis", "pitch"), "thread", "cylindrical",
            row_keys=("length", "offset", "twist", "pitch"),
        ),
        JointKind(
            "C", "cylinder, slides too", ("cylindric", "cylindrical", "cylinder"),
            (_TURN, _SLIDE), _AXIS, "cylinder", "cylindrical",
            as_rows="R and P on one axis",
        ),
        JointKind(
            "U", "universal joint", ("universal", "cardan", "hooke"),
            (_TURN, Step("turn", tilted=True)), ("axes",), "arm", "hooke",
            as_rows="R and R",
        ),
        JointKind(
            "S", "ball", ("spherical", "sphere", "ball"),
            (Step("turn", Z), Step("turn", Y), Step("turn", X)), (), "ball", "spherical",
            as_rows="R, R and R through one point",
        ),
        JointKind(
            "E", "slides in a plane", ("planar", "plane", "flat"),
            (Step("slide", X), Step("slide", Y), _TURN), _AXIS, "plate", "planar",
            as_rows="P, P and R, the slides square to each other and to the turn",
        ),
        JointKind(
            "K", "pin in a slot", ("pin in slot", "pin in a slot", "pin slot", "slot", "slotted"),
            (Step("slide", Y), _TURN), ("axes",), "slot", "planar",
            as_rows="P and R, the slide square to the turn",
        ),
        JointKind(
            "L", "slot on a pin", ("slot on pin", "slot on a pin"),
            (_TURN, Step("slide", Y)), ("axes",), "slot", "planar",
            as_rows="R and P, the slide square to the turn",
        ),
    )
}  # fmt: skip

#: A body that no joint holds: what the columns of such a link are.
ANYWHERE = JointKind(
    "", "free link", (),
    (*(Step("slide", axis) for axis in (X, Y, Z)), *KINDS["S"].steps), (), "ball", "",
)  # fmt: skip

#: Their letters.
JOINT_KINDS = tuple(KINDS)

#: Kinds that a Denavit-Hartenberg row can hold.
ROW_KINDS = tuple(letter for letter, kind in KINDS.items() if kind.row_keys)


#: Kinds of one value, which may read another than 0 as drawn: a screw's slide would follow its pitch.
READ_KINDS = tuple(letter for letter, kind in KINDS.items() if len(kind.steps) == 1)


def no_reading(kind: str) -> str:
    """Why a joint of a kind has no value of its own as drawn."""
    return f"is of joints {' and '.join(READ_KINDS)}; one of kind {kind} reads 0 as drawn, so leave it out"


def column_names(joint: str, freedoms: Sequence[Freedom]) -> tuple[str, ...]:
    """One name for each freedom of a joint: its own, numbered from 1 where it has more than one."""
    return (joint,) if len(freedoms) == 1 else tuple(f"{joint}.{k}" for k in range(1, len(freedoms) + 1))


def columns_apart(link: str, joints: Collection[str]) -> tuple[str, ...]:
    """The names of the columns of a link that rods alone hold: slides along x, y, z, turns about z, y, x."""
    return column_names(f"link {link}" if link in joints else link, ANYWHERE.freedoms)


def letters_with(key: str) -> str:
    """The letters of the kinds that are drawn with a key, as in "R P H C"."""
    return " ".join(letter for letter, kind in KINDS.items() if key in kind.drawn_keys)


def kind_row(letter: str, *, backwards: bool) -> JointKind:
    """The row of a kind; `backwards` for values of the link before the joint against the link after it."""
    return KINDS[letter].backwards if backwards else KINDS[letter]
