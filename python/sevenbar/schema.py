"""What a linkage description may hold, checked with pydantic: every mistake at once, each with its place.

This is the only model of the file format; `check` turns its errors into the messages that people read.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

from sevenbar.contradictions import contradictions, grounds
from sevenbar.errors import DescriptionError, Problem, shown, suggestion
from sevenbar.units import ANGLES, LENGTHS
from sevenbar.values import (
    EXAMPLE_OF_AXES,
    Angle,
    Direction,
    Length,
    Number,
    Speed,
    Text,
    Vector,
    crossing,
    one_of,
    refuse,
)
from sevenbar.written import (
    JOINT_KINDS,
    ROW_KINDS,
    RSSR_JOINTS,
    Written,
    drive_of,
    driven,
    joints_of,
    meant_kind,
)

#: How the kinds that take more than one Denavit-Hartenberg row are written.
AS_ROWS = {"C": "R and P on one axis", "U": "R and R", "S": "R, R and R through one point"}


def _row_kind(value: object) -> object:
    rows = AS_ROWS.get(value if isinstance(value, str) and value in AS_ROWS else meant_kind(value))
    if rows is not None:
        raise refuse(f"{shown(value)} takes more than one row; write {rows}, or draw the loop as [[joint]]")
    return value


class _Form(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class RssrForm(_Form):
    """The layout of Sun and Zhou, Figure 2; L2 left out is `|A1 B1|` as in eq. (7)."""

    M: Number
    N: Number
    L1: Length
    L3: Length
    D: Number
    L2: Length | None = None

    @property
    def coupler(self) -> float:
        """L2 [length], given or from `L2^2 = (L1 - M)^2 + L3^2 + N^2`."""
        return math.hypot(self.L1 - self.M, self.L3, self.N) if self.L2 is None else self.L2


class JointForm(_Form):
    """A joint as drawn in one assembled pose, in ground coordinates."""

    kind: Annotated[str, one_of("joint kind", JOINT_KINDS)]
    at: Vector
    name: Text | None = None
    axis: Direction | None = None
    axes: Annotated[tuple[Direction, Direction], AfterValidator(crossing)] | None = None
    pitch: Number | None = None


class LinkForm(_Form):
    """A Denavit-Hartenberg row: a joint and the link after it, `Rz(theta) Tz(offset) Tx(length) Rx(twist)`.

    Angles are in radians here, whatever unit the file has. The variable of the row is theta of R and H,
    whose `angle` stays 0, and the offset of P, which then stays 0.
    """

    joint: Annotated[str, one_of("joint kind", ROW_KINDS), BeforeValidator(_row_kind)] = "R"
    name: Text | None = None
    length: Number = 0.0
    twist: Angle = 0.0
    offset: Number = 0.0
    angle: Angle = 0.0
    pitch: Number = 0.0


class PointForm(_Form):
    """A named point carried by a link."""

    name: Text
    link: int = Field(strict=True, ge=1)
    at: Vector


class DriveForm(_Form):
    """The input and its speed."""

    speed: Speed = 1.0
    joint: Text | None = None
    output: Text | None = None


class LinkageForm(_Form):
    """A whole file of format 1."""

    format: Literal[1]
    name: Text = "linkage"
    length_unit: Annotated[str, one_of("unit", LENGTHS)] = "mm"
    angle_unit: Annotated[str, one_of("unit", ANGLES)] = "deg"
    drive: DriveForm = DriveForm()
    rssr: RssrForm | None = None
    joint: tuple[JointForm, ...] | None = None
    link: tuple[LinkForm, ...] | None = None
    point: tuple[PointForm, ...] = ()

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


def check(raw: object, *, source: str = "") -> LinkageForm:
    """The checked form, or `DescriptionError` with every problem in it; `source` is the file it came from."""
    ground_places = grounds(raw) if isinstance(raw, Mapping) else {}
    try:
        form = LinkageForm.model_validate(raw, context=_context(raw) if isinstance(raw, Mapping) else None)
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


def _context(raw: Mapping[str, Any]) -> dict[str, Any]:
    """What a number of the file needs to know of the rest: the unit of angles, and how the input moves."""
    angle_unit, length_unit = raw.get("angle_unit"), raw.get("length_unit")
    joints = joints_of(raw)
    column, _, _ = driven(joints, drive_of(raw))
    slides = any(joint.columns.get(column) == "slide" for joint in joints)
    unit = length_unit if isinstance(length_unit, str) and length_unit in LENGTHS else "mm"
    return {
        "angle": ANGLES.get(angle_unit if isinstance(angle_unit, str) else "deg", ANGLES["deg"]),
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
        path += f"[{part + 1}]" if isinstance(part, int) else f".{shown_key(part)}"
    return path.lstrip(".")


def shown_key(key: str) -> str:
    """A key as it is quoted in a path: cut short, control characters escaped."""
    return key if key.isprintable() and len(key) <= 60 else shown(key)


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
