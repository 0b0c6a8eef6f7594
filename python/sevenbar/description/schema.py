"""What a linkage description may hold, checked with pydantic: every mistake at once, each with its place.

This is the only model of the file format; `check` turns its errors into the messages that people read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    WithJsonSchema,
)
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import ErrorDetails, core_schema

from sevenbar.description.contradictions import contradictions, grounds
from sevenbar.description.values import (
    EXAMPLE_OF_AXES,
    Angle,
    Direction,
    Length,
    Number,
    Pitch,
    Speed,
    Text,
    Vector,
    crossing,
    one_of,
    one_word,
    refuse,
)
from sevenbar.description.written import (
    RSSR_JOINTS,
    Written,
    drive_of,
    driven,
    joints_of,
    meant_kind,
)
from sevenbar.errors import DescriptionError, Problem, bare, shown, suggestion
from sevenbar.kinematics.geometry import following_coupler
from sevenbar.kinematics.joints import JOINT_KINDS, KINDS, ROW_KINDS, letters_with
from sevenbar.text.units import ANGLES, LENGTHS


def _row_kind(value: object) -> object:
    kind = KINDS.get(value if isinstance(value, str) and value in KINDS else meant_kind(value))
    if kind is not None and kind.as_rows:
        how = f"write {kind.as_rows}, or draw the loop as [[joint]]"
        raise refuse(f"{shown(value)} takes more than one row; {how}")
    return value


class _Form(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


def _key(meaning: str, unit: str = "") -> Any:
    """What a key means, and the unit of its numbers in words: for the JSON schema and the page."""
    return Field(description=meaning, json_schema_extra={"unit": unit} if unit else None)


class RssrForm(_Form):
    """The layout of Sun and Zhou, Figure 2; L2 left out is `|A1 B1|` as in eq. (7)."""

    M: Annotated[Number, _key("the rocker's axis goes along x through (M, D, 0)", "length")]
    N: Annotated[Number, _key("height of the crank's circle, which is about z", "length")]
    L1: Annotated[Length, _key("crank", "length")]
    L3: Annotated[Length, _key("rocker", "length")]
    D: Annotated[Number, _key("the rocker's axis goes along x through (M, D, 0)", "length")]
    L2: Annotated[
        Length | None,
        _key("coupler; left out, that which closes with both joints at zero", "length"),
    ] = None

    @property
    def coupler(self) -> float:
        """L2 [length], given or from `L2^2 = (L1 - M)^2 + L3^2 + N^2`."""
        if self.L2 is not None:
            return self.L2
        return float(following_coupler(self.M, self.N, self.L1, self.L3))


class JointForm(_Form):
    """A joint as drawn in one assembled pose, in ground coordinates."""

    kind: Annotated[
        str,
        one_of("joint kind", JOINT_KINDS),
        WithJsonSchema({"enum": list(JOINT_KINDS)}),
        _key("what the joint lets move"),
    ]
    at: Annotated[Vector, _key("any point of the axis; of U and S the centre", "length")]
    name: Annotated[Text | None, _key("left out, theta_1, theta_2 .. by its place")] = None
    axis: Annotated[
        Direction | None,
        _key(f"of {letters_with('axis')}, which need it: any length but 0"),
    ] = None
    axes: Annotated[
        Annotated[tuple[Direction, Direction], AfterValidator(crossing)] | None,
        _key(
            f"of {letters_with('axes')}, which needs them: held by the link before, by that after; "
            "not parallel"
        ),
    ] = None
    pitch: Annotated[
        Pitch | None,
        _key(
            f"of {letters_with('pitch')}, which needs it: right-handed, left-hand if negative",
            "length per turn",
        ),
    ] = None


class LinkForm(_Form):
    """A Denavit-Hartenberg row: a joint and the link after it, `Rz(theta) Tz(offset) Tx(length) Rx(twist)`.

    Angles are in radians here, whatever unit the file has. The variable of the row is theta of R and H,
    whose `angle` stays 0, and the offset of P, which then stays 0.
    """

    joint: Annotated[
        str,
        one_of("joint kind", ROW_KINDS),
        BeforeValidator(_row_kind),
        WithJsonSchema({"enum": list(ROW_KINDS)}),
        _key("the joint before this link"),
    ] = "R"
    name: Annotated[Text | None, _key("of the joint; left out, theta_1, theta_2 ..")] = None
    length: Annotated[Number, _key("of the link, along x; may be negative", "length")] = 0.0
    twist: Annotated[Angle, _key("of the link, about x", "angle_unit")] = 0.0
    offset: Annotated[Number, _key("of R and H, along the joint's axis (H: at theta = 0)", "length")] = 0.0
    angle: Annotated[Angle, _key("of P: its fixed theta", "angle_unit")] = 0.0
    pitch: Annotated[
        Pitch,
        _key(
            f"of {letters_with('pitch')}, which needs it: right-handed, left-hand if negative",
            "length per turn",
        ),
    ] = 0.0


class PointForm(_Form):
    """A named point carried by a link."""

    name: Annotated[Text, _key("its own among the points")]
    link: Annotated[int, Field(strict=True, ge=1), _key("the link that carries it, counted from 1")]
    at: Annotated[Vector, _key("its place, in the coordinates of the form", "length")]


class DriveForm(_Form):
    """The input and its speed."""

    speed: Annotated[
        Speed,
        _key("of the input, as in 10 or '60 rpm'; not 0", "rad/s, or length/s"),
    ] = 1.0
    joint: Annotated[
        Text | None,
        BeforeValidator(one_word("input")),
        _key("the input; left out, the first joint that is no ball"),
    ] = None
    output: Annotated[
        Text | None,
        BeforeValidator(one_word("output")),
        _key("the output; left out, the last joint that is neither a ball nor the input"),
    ] = None


class LinkageForm(_Form):
    """A whole file of format 1."""

    format: Annotated[Literal[1], _key("of this file")]
    name: Annotated[Text, _key("of the linkage, for reports and figures")] = "linkage"
    length_unit: Annotated[
        str,
        one_of("unit", LENGTHS),
        WithJsonSchema({"enum": list(LENGTHS)}),
        _key("of all lengths; carried into every header, never converted"),
    ] = "mm"
    angle_unit: Annotated[
        str,
        one_of("unit", ANGLES),
        WithJsonSchema({"enum": list(ANGLES)}),
        _key("of the angles written in this file"),
    ] = "deg"
    drive: Annotated[DriveForm, _key("the input, the output, the speed")] = DriveForm()
    rssr: Annotated[RssrForm | None, _key("the RSSR paper's dimensions")] = None
    joint: Annotated[tuple[JointForm, ...] | None, _key("joints as drawn, in loop order")] = None
    link: Annotated[
        tuple[LinkForm, ...] | None,
        _key("Denavit-Hartenberg rows in loop order, the last is the ground"),
    ] = None
    layout: Annotated[
        Literal["dh", "planar"],
        _key("of [[link]] rows: where the frame lies and angles begin"),
    ] = "dh"
    point: Annotated[tuple[PointForm, ...], _key("points to be traced")] = ()

    @property
    def joints(self) -> tuple[tuple[str, str], ...]:
        """Name and kind of each joint, in loop order."""
        if self.rssr is not None:
            return RSSR_JOINTS
        drawn = [(joint.name, joint.kind) for joint in self.joint or ()]
        rows = [(row.name, row.joint) for row in self.link or ()]
        return tuple((name or f"theta_{i}", kind) for i, (name, kind) in enumerate(drawn + rows, 1))

    @property
    def driven(self) -> tuple[str, str]:
        """The columns of input and output."""
        drive = {"joint": self.drive.joint, "output": self.drive.output}
        return driven([Written("", *joint) for joint in self.joints], drive)[:2]


#: The three ways to write a linkage: a file has one of them.
FORMS = ("rssr", "link", "joint")


class _TomlSchema(GenerateJsonSchema):
    """JSON schema of a TOML file, in which a key that is not given is left out: there is no null."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        inner = self.generate_inner(schema["schema"])
        plain = isinstance(schema.get("default"), (str, int, float))
        return {**inner, "default": schema["default"]} if plain else inner


def json_schema() -> dict[str, Any]:
    """The JSON schema (draft 2020-12) of a file of format 1, for editors that complete and check TOML.

    It tells keys, kinds of values and allowed words. What belongs together is told by `load` alone.

        >>> json_schema()["properties"]["length_unit"]["enum"]
        ['um', 'mm', 'cm', 'm', 'in', 'ft']
    """
    schema = LinkageForm.model_json_schema(schema_generator=_TomlSchema)
    one_form = [{"required": [form]} for form in FORMS]
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "oneOf": one_form}


def check(raw: object, *, source: str = "") -> LinkageForm:
    """The checked form, or `DescriptionError` with every problem in it; `source` is the file it came from."""
    ground_places = grounds(raw) if isinstance(raw, Mapping) else {}
    try:
        form = LinkageForm.model_validate(raw, context=context_of(raw) if isinstance(raw, Mapping) else None)
        problems = []
    except ValidationError as error:
        details = [(tuple(detail["loc"]), detail) for detail in error.errors(include_url=False)]
        problems = [
            Problem(_path(place), ground_places[place]) if place in ground_places else _problem(detail)
            for place, detail in details
            # an entry that is nothing but a second ground is told of once
            if place in ground_places or place[:2] not in ground_places
        ]
    if isinstance(raw, Mapping):
        problems += contradictions(raw)
    if problems:
        raise DescriptionError(problems, source)
    return form


def context_of(raw: Mapping[str, Any]) -> dict[str, Any]:
    """What a number of the file needs to know of the rest: the units, and how the input moves."""
    angle_unit, length_unit = raw.get("angle_unit"), raw.get("length_unit")
    joints = joints_of(raw)
    column, _, _ = driven(joints, drive_of(raw))
    slides = any(joint.columns.get(column) == "slide" for joint in joints)
    unit = length_unit if isinstance(length_unit, str) and length_unit in LENGTHS else "mm"
    return {
        "length_unit": unit,
        "angle_unit": angle_unit if isinstance(angle_unit, str) and angle_unit in ANGLES else "deg",
        "slides": unit if slides else None,
    }


def _problem(detail: ErrorDetails) -> Problem:
    location = [part for part in detail["loc"] if part != "tuple"]
    value = shown(detail["input"])
    owner = _form_at(location[:-1])
    keys = ", ".join(owner.model_fields) if owner else ""
    match detail["type"]:
        case "sevenbar":
            message = str(detail["ctx"]["message"])
        case "missing":
            message = _missing(location, owner)
        case "extra_forbidden":
            near = suggestion(str(location[-1]), owner.model_fields if owner else ())
            home = "" if near else _home(str(location[-1]))
            message = home or f"is not known here; {near}allowed: {keys}"
        case "literal_error" | "int_parsing_size":
            message = f"{value} is not a format of this version; give format = 1"
        case "model_type" | "dict_type":
            message = f"{value} is not a table; give keys with values"
        case "tuple_type" | "too_short" | "too_long":
            message = f"{value} does not fit here; {_array_hint(location)}"
        case "int_type" | "int_from_float" | "greater_than_equal":
            message = f"{value} is not a link; give its number, counted from 1"
        case _:
            message = f"{value} is not allowed; {detail['msg'].lower()}"
    return Problem(_path(location), message)


def _path(location: Sequence[int | str]) -> str:
    path = ""
    for part in location:
        path += f"[{part + 1}]" if isinstance(part, int) else f".{bare(part)}"
    return path.lstrip(".")


def _missing(location: list[int | str], owner: type[_Form] | None) -> str:
    if location[-1] == "format":
        return "is missing; give format = 1"
    if isinstance(location[-1], int):
        return f"is missing; {_array_hint(location[:-1])}"
    needed = [name for name, field in owner.model_fields.items() if field.is_required()] if owner else []
    return f"is missing; needed here: {', '.join(needed)}"


def _array_hint(location: list[int | str]) -> str:
    if location and location[-1] == "axes":
        return f"give two directions, {EXAMPLE_OF_AXES}"
    return f"write [[{location[-1] if location else 'joint'}]] before each one"


#: The form of each table, by its head without brackets.
TABLES: dict[str, type[_Form]] = {
    "rssr": RssrForm,
    "joint": JointForm,
    "link": LinkForm,
    "point": PointForm,
    "drive": DriveForm,
}


def _form_at(location: list[int | str]) -> type[_Form] | None:
    """The form that owns a place: the file's own, or that of the table that the path enters."""
    words = [part for part in location if isinstance(part, str)]
    if not words:
        return LinkageForm
    return TABLES.get(words[0]) if len(words) == 1 else None


def _home(key: str) -> str:
    """Where a key belongs that stands elsewhere, if it can belong to one place only."""
    homes = [table for table, form in TABLES.items() if key in form.model_fields]
    if key in LinkageForm.model_fields and not homes:
        return "is a key of the whole file; write it above the first table"
    if len(homes) != 1 or key in LinkageForm.model_fields:
        return ""
    (table,) = homes
    head = f"[{table}]" if table in ("rssr", "drive") else f"[[{table}]]"
    return f"is a key of {head}; write it below that head"
