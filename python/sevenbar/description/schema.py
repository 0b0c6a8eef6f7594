"""What a linkage description may hold, checked with pydantic: every mistake at once, each with its place.

This is the only model of the file format; `mistakes` turns its errors into the messages that people read.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from sevenbar.description.contradictions import FORMS, contradictions, grounds, other_file
from sevenbar.description.load_schema import BodyForm, ForcesForm, LoadForm, SpringForm
from sevenbar.description.load_tables import folder_of
from sevenbar.description.mistakes import FileForms, path_of
from sevenbar.description.stop_schema import RodForm, StopForm, stop_contradictions
from sevenbar.description.values import (
    Angle,
    Direction,
    Length,
    Number,
    Pitch,
    Speed,
    TableForm,
    Text,
    Vector,
    crossing,
    key,
    one_of,
    one_word,
    refuse,
)
from sevenbar.description.written import RSSR_JOINTS, Written, drive_of, driven, joints_of, meant_kind
from sevenbar.errors import DescriptionError, Problem, shown
from sevenbar.kinematics.loop.geometry import following_coupler
from sevenbar.kinematics.loop.joints import JOINT_KINDS, KINDS, ROW_KINDS, letters_with
from sevenbar.text.units import ANGLES, LENGTHS, MASSES


def _row_kind(value: object) -> object:
    kind = KINDS.get(value if isinstance(value, str) and value in KINDS else meant_kind(value))
    if kind is not None and kind.as_rows:
        how = f"write {kind.as_rows}, or draw the loop as [[joint]]"
        raise refuse(f"{shown(value)} takes more than one row; {how}")
    return value


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


class LinkageForm(TableForm):
    """A whole file of format 1."""

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
    forces: Annotated[ForcesForm, key("gravity, and the unit of masses")] = ForcesForm.model_construct()
    body: Annotated[tuple[BodyForm, ...], key("masses on links")] = ()
    load: Annotated[tuple[LoadForm, ...], key("forces and torques on links")] = ()
    spring: Annotated[tuple[SpringForm, ...], key("springs and dampers")] = ()
    stop: Annotated[tuple[StopForm, ...], key("how far joints may go")] = ()
    rod: Annotated[tuple[RodForm, ...], key("how thick links are")] = ()

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


class TomlSchema(GenerateJsonSchema):
    """JSON schema of a TOML file, in which a key that is not given is left out: there is no null."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        """Of a key that may be left out, that of its values."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        """With the default where it is a plain value."""
        inner = self.generate_inner(schema["schema"])
        plain = isinstance(schema.get("default"), (str, int, float))
        return {**inner, "default": schema["default"]} if plain else inner


def json_schema() -> dict[str, Any]:
    """The JSON schema (draft 2020-12) of a file of format 1, for editors that complete and check TOML.

    It has keys, kinds of values and allowed words. What belongs together is checked by `load` alone.

        >>> json_schema()["properties"]["length_unit"]["enum"]
        ['um', 'mm', 'cm', 'm', 'in', 'ft']
    """
    schema = LinkageForm.model_json_schema(schema_generator=TomlSchema)
    one_form = [{"required": [form]} for form in FORMS]
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "oneOf": one_form}


def check(raw: Mapping[str, Any], context: Mapping[str, Any], *, source: str = "") -> LinkageForm:
    """The checked form, or `DescriptionError` with every problem in it; `source` is the file it came from."""
    if other := other_file(raw):
        raise DescriptionError.of_all(source, other)
    ground_places = grounds(raw)
    try:
        form = LinkageForm.model_validate(raw, context=context)
        problems = []
    except ValidationError as error:
        details = [(tuple(detail["loc"]), detail) for detail in error.errors(include_url=False)]
        problems = [
            Problem(path_of(place), ground_places[place])
            if place in ground_places
            else _FORMS.problem(detail)
            for place, detail in details
            # an entry that is nothing but a second ground is reported once
            if place in ground_places or place[:2] not in ground_places
        ]
    joints = joints_of(raw)
    problems += contradictions(raw)
    if not raw.keys().isdisjoint(("body", "load", "spring")):
        from sevenbar.description.loads import load_contradictions

        problems += load_contradictions(raw, joints, context)
    problems += stop_contradictions(raw, joints, context)
    if problems:
        raise DescriptionError(problems, source)
    return form


def context_of(raw: Mapping[str, Any], source: str = "") -> dict[str, Any]:
    """What a number of the file needs to know of the rest: units, how joints move, the folder of `source`."""
    angle_unit, length_unit = raw.get("angle_unit"), raw.get("length_unit")
    forces = raw.get("forces")
    mass_unit = forces.get("mass_unit") if isinstance(forces, Mapping) else None
    joints = joints_of(raw)
    column, _, _ = driven(joints, drive_of(raw))
    slides = any(joint.columns.get(column) == "slide" for joint in joints)
    unit = length_unit if isinstance(length_unit, str) and length_unit in LENGTHS else "mm"
    return {
        "length_unit": unit,
        "angle_unit": angle_unit if isinstance(angle_unit, str) and angle_unit in ANGLES else "deg",
        "mass_unit": mass_unit if isinstance(mass_unit, str) and mass_unit in MASSES else "kg",
        "slides": unit if slides else None,
        "freedoms": {
            name: freedom
            for joint in joints
            for column, freedom in reversed(joint.columns.items())
            for name in (joint.name, column)
        },
        "folder": folder_of(source),
    }


#: The form of each table, by its head without brackets.
TABLES: dict[str, type[TableForm]] = {
    "rssr": RssrForm,
    "joint": JointForm,
    "link": LinkForm,
    "point": PointForm,
    "drive": DriveForm,
    "forces": ForcesForm,
    "body": BodyForm,
    "load": LoadForm,
    "spring": SpringForm,
    "stop": StopForm,
    "rod": RodForm,
}

_FORMS = FileForms(LinkageForm, TABLES, once=("rssr", "drive", "forces"))
