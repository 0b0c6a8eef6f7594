"""The loop of a file, checked with pydantic: the models of its tables, all that most files have.

With what acts on the loop and what stops it they make up the model of a whole file, in `schema`, which says
what is wrong with a file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
)

from sevenbar.description.contradictions import contradictions
from sevenbar.description.formulas import joint_kinds
from sevenbar.description.values import (
    FORMULA,
    Angle,
    Direction,
    Length,
    Number,
    Pitch,
    Speed,
    TableForm,
    Text,
    Vector,
    carried,
    crossing,
    key,
    one_of,
    one_word,
    refuse,
)
from sevenbar.description.written import RSSR_JOINTS, Written, driven, meant_kind
from sevenbar.errors import shown
from sevenbar.kinematics.loop.geometry import following_coupler
from sevenbar.kinematics.loop.joints import JOINT_KINDS, KINDS, READ_KINDS, ROW_KINDS, letters_with
from sevenbar.text.units import ANGLES, LENGTHS


def _row_kind(value: object) -> object:
    kind = KINDS.get(value if isinstance(value, str) and value in KINDS else meant_kind(value))
    if kind is not None and kind.as_rows:
        how = f"write {kind.as_rows}, or draw the loop as [[joint]]"
        raise refuse(f"{shown(value)} takes more than one row; {how}")
    return value


def _reading(value: object, info: ValidationInfo) -> float:
    """What a joint as drawn reads, an angle in radians; `kind` is read before it."""
    return carried(value, info, joint_kinds(info.data, info.context or {})["value"])


class RssrForm(TableForm):
    """The layout of Sun and Zhou, Figure 2; L2 left out is `|A1 B1|` as in eq. (7)."""

    M: Annotated[Number, key("the rocker's axis goes along x through (M, D, 0)", "length")]
    N: Annotated[Number, key("height of the crank's circle, which is about z", "length")]
    L1: Annotated[Length, key("crank", "length")]
    L3: Annotated[Length, key("rocker", "length")]
    D: Annotated[Number, key("the rocker's axis goes along x through (M, D, 0)", "length")]
    L2: Annotated[
        Length | None, key("coupler; left out, that which closes with both joints at zero", "length")
    ] = None

    @property
    def coupler(self) -> float:
        """L2 [length], given or from `L2^2 = (L1 - M)^2 + L3^2 + N^2`."""
        if self.L2 is not None:
            return self.L2
        return float(following_coupler(self.M, self.N, self.L1, self.L3))


class JointForm(TableForm):
    """A joint as drawn in one assembled pose, in ground coordinates."""

    kind: Annotated[str, *one_of("joint kind", JOINT_KINDS), key("what the joint lets move")]
    at: Annotated[Vector, key("any point of the axis; of U and S the centre", "length")]
    name: Annotated[Text | None, key("left out, theta_1, theta_2 .. by its place")] = None
    axis: Annotated[
        Direction | None,
        key(f"of {letters_with('axis')}, which need it: any length but 0"),
    ] = None
    axes: Annotated[
        Annotated[tuple[Direction, Direction], AfterValidator(crossing)] | None,
        key(
            f"of {letters_with('axes')}, which needs them: held by the link before, by that after; "
            "not parallel"
        ),
    ] = None
    pitch: Annotated[
        Pitch | None,
        key(
            f"of {letters_with('pitch')}, which needs it: right-handed, left-hand if negative",
            "length per turn",
        ),
    ] = None
    value: Annotated[
        Annotated[float, BeforeValidator(_reading), WithJsonSchema(FORMULA)] | None,
        key(f"of {' '.join(READ_KINDS)}: what it reads as drawn; left out, 0", "angle_unit, or length"),
    ] = None
    longer: Annotated[
        Number | None,
        key(
            "not of the last: how much longer than drawn the link after it is; shorter if negative", "length"
        ),
    ] = None


class LinkForm(TableForm):
    """A Denavit-Hartenberg row: a joint and the link after it, `Rz(theta) Tz(offset) Tx(length) Rx(twist)`.

    Angles are in radians here, whatever unit the file has. The variable of the row is theta of R and H,
    whose `angle` stays 0, and the offset of P, which then stays 0.
    """

    joint: Annotated[
        str, *one_of("joint kind", ROW_KINDS), BeforeValidator(_row_kind), key("the joint before this link")
    ] = "R"
    name: Annotated[Text | None, key("of the joint; left out, theta_1, theta_2 ..")] = None
    length: Annotated[Number, key("of the link, along x; may be negative", "length")] = 0.0
    twist: Annotated[Angle, key("of the link, about x", "angle_unit")] = 0.0
    offset: Annotated[Number, key("of R and H, along the joint's axis (H: at theta = 0)", "length")] = 0.0
    angle: Annotated[Angle, key("of P: its fixed theta", "angle_unit")] = 0.0
    pitch: Annotated[
        Pitch,
        key(
            f"of {letters_with('pitch')}, which needs it: right-handed, left-hand if negative",
            "length per turn",
        ),
    ] = 0.0


class PointForm(TableForm):
    """A named point carried by a link."""

    name: Annotated[Text, key("its own among the points")]
    link: Annotated[int, Field(strict=True, ge=1), key("the link that carries it, counted from 1")]
    at: Annotated[Vector, key("its place, in the coordinates of the form", "length")]


class DriveForm(TableForm):
    """The input and its speed."""

    speed: Annotated[Speed, key("of the input, as in 10 or '60 rpm'; not 0", "rad/s, or length/s")] = 1.0
    joint: Annotated[
        Text | None,
        BeforeValidator(one_word("input")),
        key("the input; left out, the first joint that is no ball"),
    ] = None
    output: Annotated[
        Text | None,
        BeforeValidator(one_word("output")),
        key("the output; left out, the last joint that is neither a ball nor the input"),
    ] = None


class LoopForm(TableForm):
    """A file of format 1 that has a loop alone: nothing that acts on it, no stops."""

    format: Annotated[Literal[1], key("of this file")]
    name: Annotated[Text, key("of the linkage, for reports and figures")] = "linkage"
    length_unit: Annotated[
        str, *one_of("unit", LENGTHS), key("of all lengths; carried into every header, never converted")
    ] = "mm"
    angle_unit: Annotated[str, *one_of("unit", ANGLES), key("of the angles written in this file")] = "deg"
    drive: Annotated[DriveForm, key("the input, the output, the speed")] = DriveForm.model_construct()
    rssr: Annotated[RssrForm | None, key("the RSSR paper's dimensions")] = None
    joint: Annotated[tuple[JointForm, ...] | None, key("joints as drawn, in loop order")] = None
    link: Annotated[
        tuple[LinkForm, ...] | None, key("Denavit-Hartenberg rows in loop order, the last is the ground")
    ] = None
    layout: Annotated[
        Literal["dh", "planar"], key("of [[link]] rows: where the frame lies and angles begin")
    ] = "dh"
    point: Annotated[tuple[PointForm, ...], key("points to be traced")] = ()

    @property
    def joints(self) -> tuple[tuple[str, str], ...]:
        """Name and kind of each joint, in loop order."""
        if self.rssr is not None:
            return RSSR_JOINTS
        drawn = [(joint.name, joint.kind) for joint in self.joint or ()]
        rows = [(row.name, row.joint) for row in self.link or ()]
        return tuple((name or f"theta_{i}", kind) for i, (name, kind) in enumerate(drawn + rows, 1))

    @property
    def first_columns(self) -> dict[str, str]:
        """The column that the name of a joint means, its first one."""
        return {name: next(iter(Written("", name, kind).columns)) for name, kind in self.joints}

    @property
    def driven(self) -> tuple[str, str]:
        """The columns of input and output."""
        drive = {"joint": self.drive.joint, "output": self.drive.output}
        return driven([Written("", *joint) for joint in self.joints], drive)[:2]


def loop_alone(raw: Mapping[str, Any], context: Mapping[str, Any]) -> LoopForm | None:
    """The checked form of a file that has a loop alone; `None` where it has more, or where it is wrong."""
    if not raw.keys() <= LoopForm.model_fields.keys() or contradictions(raw):
        return None
    try:
        return LoopForm.model_validate(raw, context=context)
    except ValidationError:
        return None
