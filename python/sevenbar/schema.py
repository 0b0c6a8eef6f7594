"""What a linkage description may hold, checked with pydantic: every mistake at once, each with its place.

This is the only model of the file format; `check` turns its errors into the messages that people read.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from sevenbar.errors import DescriptionError, Problem, RequestError, no_joint, shown, suggestion
from sevenbar.units import ANGLES, LENGTHS, turning_speed, unknown_unit

#: Dimensions outside this range are slips of the pen, and their powers would overflow.
LARGEST_DIMENSION = 1e100

JOINT_KINDS = ("R", "P", "H", "C", "U", "S")

#: Names and kinds of the joints of a linkage written as [rssr].
RSSR_JOINTS = (("crank", "R"), ("ball_a", "S"), ("ball_b", "S"), ("rocker", "R"))


def _refuse(message: str) -> PydanticCustomError:
    # pydantic reads braces in a message as a template
    return PydanticCustomError("sevenbar", "{message}", {"message": message})


def _number(value: object) -> float:
    if isinstance(value, str):
        raise _refuse(f"{shown(value)} is text; give a number without quotes")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise _refuse(f"{shown(value)} is not a number; give a number")
    if isinstance(value, float) and not math.isfinite(value):
        raise _refuse(f"{shown(value)} is not a finite number; give a finite number")
    if abs(value) > LARGEST_DIMENSION:
        raise _refuse(f"{shown(value)} is out of range; give a number up to {LARGEST_DIMENSION:g} in size")
    return float(value)


def _length(value: object) -> float:
    number = _number(value)
    if number <= 0:
        raise _refuse(f"{shown(value)} is not a length; give a number > 0")
    if number < 1 / LARGEST_DIMENSION:
        raise _refuse(f"{shown(value)} is out of range; give a length of at least {1 / LARGEST_DIMENSION:g}")
    return number


def _vector(value: object) -> tuple[float, float, float]:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise _refuse(f"{shown(value)} is not a point or direction; give three numbers, as in [0, 0, 1]")
    x, y, z = (_number(v) for v in value)
    return x, y, z


def _direction(value: object) -> tuple[float, float, float]:
    vector = _vector(value)
    if math.hypot(*vector) < 1 / LARGEST_DIMENSION:
        raise _refuse(f"{shown(value)} has no direction; give three numbers, not all 0")
    return vector


def _one_of(what: str, known: Mapping[str, object] | tuple[str, ...]) -> BeforeValidator:
    def choose(value: object) -> str:
        if isinstance(value, str) and value in known:
            return value
        if what == "unit":
            raise _refuse(unknown_unit(value, known))
        near = suggestion(value, known) if isinstance(value, str) else ""
        raise _refuse(f"{shown(value)} is not a {what}; {near}allowed: {', '.join(known)}")

    return BeforeValidator(choose)


def _text(value: object) -> str:
    if not isinstance(value, str) or not value.strip() or len(value) > 200 or not value.isprintable():
        raise _refuse(f"{shown(value)} is not a name; give some text in quotes, at most 200 characters")
    return value.strip()


def _speed(value: object) -> float:
    try:
        return turning_speed(value)
    except RequestError as error:
        raise _refuse(str(error)) from None


Number = Annotated[float, BeforeValidator(_number)]
Length = Annotated[float, BeforeValidator(_length)]
Vector = Annotated[tuple[float, float, float], BeforeValidator(_vector)]
Direction = Annotated[tuple[float, float, float], BeforeValidator(_direction)]
Text = Annotated[str, BeforeValidator(_text)]


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

    kind: Annotated[str, _one_of("joint kind", JOINT_KINDS)]
    at: Vector
    name: Text | None = None
    axis: Direction | None = None
    axes: tuple[Direction, Direction] | None = None
    pitch: Number | None = None


class PointForm(_Form):
    """A named point carried by a link."""

    name: Text
    link: int = Field(strict=True, ge=1)
    at: Vector


class DriveForm(_Form):
    """The input and its speed."""

    speed: Annotated[float, BeforeValidator(_speed)] = 1.0
    joint: Text | None = None
    output: Text | None = None


class LinkageForm(_Form):
    """A whole file of format 1."""

    format: Literal[1]
    name: Text = "linkage"
    length_unit: Annotated[str, _one_of("unit", LENGTHS)] = "mm"
    angle_unit: Annotated[str, _one_of("unit", ANGLES)] = "deg"
    drive: DriveForm = DriveForm()
    rssr: RssrForm | None = None
    joint: tuple[JointForm, ...] | None = None
    link: tuple[dict[str, Any], ...] | None = None
    point: tuple[PointForm, ...] = ()


def check(raw: object, *, source: str = "") -> LinkageForm:
    """The checked form, or `DescriptionError` with every problem in it; `source` is the file it came from."""
    try:
        form = LinkageForm.model_validate(raw)
        problems = []
    except ValidationError as error:
        problems = [_problem(detail) for detail in error.errors(include_url=False)]
    if isinstance(raw, Mapping):
        problems += _contradictions(raw)
    if problems:
        raise DescriptionError(problems, source)
    return form


def _contradictions(raw: Mapping[str, Any]) -> list[Problem]:
    """What is wrong between keys that may each be right; reads only what has the right form."""
    written = [key for key in ("rssr", "joint", "link") if key in raw]
    if len(written) != 1:
        what = f"{' and '.join(written)} are given together" if written else "no linkage is described"
        return [Problem("", f"{what}; give exactly one of [rssr], [[joint]] or [[link]]")]
    problems = []
    if written == ["rssr"]:
        joints = list(RSSR_JOINTS)
    else:
        tables = [(i, t) for i, t in enumerate(_tables(raw, "joint"), 1) if t.get("kind") in JOINT_KINDS]
        problems = [Problem(f"joint[{i}].{key}", message) for i, t in tables for key, message in _misfits(t)]
        joints = [(str(t.get("name") or f"theta_{i}").strip(), str(t["kind"])) for i, t in tables]
    names = [name for name, _ in joints]
    problems += [
        Problem(f"joint[{i + 1}].name", f"{shown(name)} is taken already; give each joint its own name")
        for i, name in enumerate(names)
        if name in names[:i]
    ]
    points = [(i, t) for i, t in enumerate(_tables(raw, "point"), 1)]
    taken = {"A", "B"}
    for i, table in points:
        link, name = table.get("link"), table.get("name")
        if isinstance(link, int) and link > len(joints) > 0:
            last = f"give 1 to {len(joints)}, the last is the ground"
            problems.append(Problem(f"point[{i}].link", f"{shown(link)} is not a link; {last}"))
        if isinstance(name, str) and name.strip() in taken:
            problems.append(
                Problem(f"point[{i}].name", f"{shown(name)} is taken already; give each point its own name")
            )
        taken.add(str(name).strip())
    drive = raw.get("drive")
    for key in ("joint", "output"):
        name = drive.get(key) if isinstance(drive, Mapping) else None
        if isinstance(name, str) and names and name.strip() not in names:
            problems.append(Problem(f"drive.{key}", no_joint(name, names)))
    return problems


def _tables(raw: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    rows = raw.get(key)
    return [row if isinstance(row, Mapping) else {} for row in rows] if isinstance(rows, list) else []


def _misfits(joint: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Keys that a joint of this kind needs and has not, or has and cannot use."""
    kind = joint["kind"]
    needs = {"R": {"axis"}, "P": {"axis"}, "C": {"axis"}, "H": {"axis", "pitch"}, "U": {"axes"}, "S": set()}[
        kind
    ]
    given = joint.keys() & {"axis", "axes", "pitch"}
    missing = [(key, f"is missing; a joint of kind {kind} needs it") for key in sorted(needs - given)]
    return missing + [
        (key, f"does not belong to a joint of kind {kind}; leave it out") for key in sorted(given - needs)
    ]


def _problem(detail: ErrorDetails) -> Problem:
    location = [part for part in detail["loc"] if part != "tuple"]
    value = shown(detail["input"])
    owner = _form_at(location[:-1])
    keys = ", ".join(owner.model_fields) if owner else ""
    match detail["type"]:
        case "sevenbar":
            message = str(detail["ctx"]["message"])
        case "missing":
            message = _missing(str(location[-1]), owner)
        case "extra_forbidden":
            near = suggestion(str(location[-1]), owner.model_fields if owner else ())
            message = f"is not known here; {near}allowed: {keys}"
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
    path = ""
    for part in location:
        path += f"[{part + 1}]" if isinstance(part, int) else f".{shown_key(part)}"
    return Problem(path.lstrip("."), message)


def shown_key(key: str) -> str:
    """A key as it is quoted in a path: cut short, control characters escaped."""
    return key if key.isprintable() and len(key) <= 60 else shown(key)


def _missing(key: str, owner: type[_Form] | None) -> str:
    if key == "format":
        return "is missing; give format = 1"
    needed = [name for name, field in owner.model_fields.items() if field.is_required()] if owner else []
    return f"is missing; needed here: {', '.join(needed)}"


def _array_hint(location: list[int | str]) -> str:
    if location and location[-1] == "axes":
        return "give two directions, as in [[1, 0, 0], [0, 1, 0]]"
    return f"write [[{location[-1] if location else 'joint'}]] before each one"


def _form_at(location: list[int | str]) -> type[_Form] | None:
    """The form that owns a place: the file's own, or that of the table that the path enters."""
    words = [part for part in location if isinstance(part, str)]
    tables: dict[str, type[_Form]] = {
        "rssr": RssrForm,
        "joint": JointForm,
        "point": PointForm,
        "drive": DriveForm,
    }
    if not words:
        return LinkageForm
    return tables.get(words[0]) if len(words) == 1 else None
