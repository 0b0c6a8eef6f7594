"""What a linkage description may hold, checked with pydantic: every mistake at once, each with its place.

This is the only model of the file format; `check` turns its errors into the messages that people read.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from sevenbar.errors import DescriptionError, Problem, RequestError, no_joint, shown, suggestion
from sevenbar.units import ANGLES, LENGTHS, sliding_speed, turning_speed, unknown_unit

#: Dimensions outside this range are slips of the pen, and their powers would overflow.
LARGEST_DIMENSION = 1e100

#: What each freedom of a joint does, in the order of its columns.
FREEDOMS = {
    "R": ("turn",),
    "P": ("slide",),
    "H": ("turn",),
    "C": ("turn", "slide"),
    "U": ("turn", "turn"),
    "S": ("turn", "turn", "turn"),
}
JOINT_KINDS = tuple(FREEDOMS)

#: Kinds that a Denavit-Hartenberg row can hold, and how the others are written as rows.
ROW_KINDS = ("R", "P", "H")
AS_ROWS = {"C": "R and P on one axis", "U": "R and R", "S": "R, R and R through one point"}

#: Words that people use for the ground where a joint's kind should stand.
GROUND_WORDS = ("g", "ground", "fixed", "frame", "base")

FEWEST_JOINTS, MOST_JOINTS = 2, 12

EXAMPLE_OF_AXES = "as in [[1, 0, 0], [0, 1, 0]]"

#: Sine of the angle below which the two axes of a joint U are one axis to the digits of a drawing.
PARALLEL = 1e-9

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


def _angle(value: object, info: ValidationInfo) -> float:
    """An angle [rad], written in the file's unit."""
    return _number(value) * float((info.context or {}).get("angle", 1.0))


def _crossing(axes: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    a, b = ([x / math.hypot(*axis) for x in axis] for axis in axes)
    across = math.hypot(*(a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)))
    if across < PARALLEL:
        apart = math.degrees(math.atan2(across, sum(x * y for x, y in zip(a, b, strict=True))))
        written = shown([list(axis) for axis in axes])
        raise _refuse(f"{written} are {apart:.3g} deg apart; give two axes that cross, {EXAMPLE_OF_AXES}")
    return axes


def _row_kind(value: object) -> object:
    if isinstance(value, str) and value in AS_ROWS:
        rows = AS_ROWS[value]
        raise _refuse(f"{shown(value)} takes more than one row; write {rows}, or draw the loop as [[joint]]")
    return value


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


def _speed(value: object, info: ValidationInfo) -> float:
    slides = (info.context or {}).get("slides")
    try:
        return sliding_speed(value, slides) if slides else turning_speed(value)
    except RequestError as error:
        raise _refuse(str(error)) from None


Number = Annotated[float, BeforeValidator(_number)]
Angle = Annotated[float, BeforeValidator(_angle)]
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
    axes: Annotated[tuple[Direction, Direction], AfterValidator(_crossing)] | None = None
    pitch: Number | None = None


class LinkForm(_Form):
    """A Denavit-Hartenberg row: a joint and the link after it, `Rz(theta) Tz(offset) Tx(length) Rx(twist)`.

    Angles are in radians here, whatever unit the file has. The variable of the row is theta of R and H,
    whose `angle` stays 0, and the offset of P, which then stays 0.
    """

    joint: Annotated[str, _one_of("joint kind", ROW_KINDS), BeforeValidator(_row_kind)] = "R"
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
        return _driven([_Written("", *joint) for joint in self.joints], drive)[:2]


class _Written(NamedTuple):
    """A joint as far as it can be read from an unchecked file: its kind is empty where that is unknown."""

    place: str
    name: str
    kind: str

    @property
    def columns(self) -> dict[str, str]:
        """What each of its freedoms does, by the name of its column."""
        freedoms = FREEDOMS.get(self.kind, ("turn",))
        if len(freedoms) == 1:
            return {self.name: freedoms[0]}
        return {f"{self.name}.{k}": freedom for k, freedom in enumerate(freedoms, 1)}


def check(raw: object, *, source: str = "") -> LinkageForm:
    """The checked form, or `DescriptionError` with every problem in it; `source` is the file it came from."""
    grounds = _grounds(raw) if isinstance(raw, Mapping) else {}
    try:
        form = LinkageForm.model_validate(raw, context=_context(raw) if isinstance(raw, Mapping) else None)
        problems = []
    except ValidationError as error:
        details = [(tuple(detail["loc"]), detail) for detail in error.errors(include_url=False)]
        problems = [
            Problem(_path(place), grounds[place]) if place in grounds else _problem(detail)
            for place, detail in details
            # an entry that is nothing but a second ground is told of once
            if place in grounds or place[:2] not in grounds
        ]
    if isinstance(raw, Mapping):
        problems += _contradictions(raw)
    if problems:
        raise DescriptionError(problems, source)
    return form


def _context(raw: Mapping[str, Any]) -> dict[str, Any]:
    """What a number of the file needs to know of the rest: the unit of angles, and how the input moves."""
    angle_unit, length_unit = raw.get("angle_unit"), raw.get("length_unit")
    joints = _joints(raw)
    column, _, _ = _driven(joints, _drive(raw))
    slides = any(joint.columns.get(column) == "slide" for joint in joints)
    unit = length_unit if isinstance(length_unit, str) and length_unit in LENGTHS else "mm"
    return {
        "angle": ANGLES.get(angle_unit if isinstance(angle_unit, str) else "deg", ANGLES["deg"]),
        "slides": unit if slides else None,
    }


def _drive(raw: Mapping[str, Any]) -> Mapping[str, Any]:
    drive = raw.get("drive")
    return drive if isinstance(drive, Mapping) else {}


def _joints(raw: Mapping[str, Any]) -> list[_Written]:
    """The joints of a file, without entries that are nothing but a ground."""
    if "rssr" in raw:
        return [_Written("", name, kind) for name, kind in RSSR_JOINTS]
    key, kind_key, default = ("joint", "kind", "") if "joint" in raw else ("link", "joint", "R")
    joints = []
    for i, table in enumerate(_tables(raw, key), 1):
        kind, name = table.get(kind_key, default), table.get("name")
        label = name.strip() if isinstance(name, str) else ""
        if not _is_only_ground(table, kind):
            known = kind if isinstance(kind, str) and kind in FREEDOMS else ""
            joints.append(_Written(f"{key}[{i}]", label or f"theta_{i}", known))
    return joints


def _names_ground(kind: object) -> bool:
    return isinstance(kind, str) and kind.strip().lower() in GROUND_WORDS


def _is_only_ground(table: Mapping[str, Any], kind: object) -> bool:
    return _names_ground(kind) and not table.keys() & {"length", "twist", "offset"}


def _grounds(raw: Mapping[str, Any]) -> dict[tuple[int | str, ...], str]:
    """A message for each place that speaks of a ground, which a loop has without a word."""
    last = len(_joints(raw))
    already = f"link {last} is the ground already"
    leave = f"is not known here; {already}; leave it out"
    found: dict[tuple[int | str, ...], str] = {("ground",): leave}
    for key, kind_key in (("joint", "kind"), ("link", "joint")):
        for i, table in enumerate(_tables(raw, key)):
            found[(key, i, "ground")] = leave
            kind = table.get(kind_key)
            if not _names_ground(kind):
                continue
            what = f"{shown(kind)} is not a joint kind; {already}"
            if _is_only_ground(table, kind):
                found[(key, i)] = ""
                found[(key, i, kind_key)] = f"{what} and needs no entry; leave this one out"
            else:
                kinds = ", ".join(ROW_KINDS)
                found[(key, i, kind_key)] = f"{what}, being the last; give the joint before it: {kinds}"
    return found


def _contradictions(raw: Mapping[str, Any]) -> list[Problem]:
    """What is wrong between keys that may each be right; reads only what has the right form."""
    written = [key for key in ("rssr", "joint", "link") if key in raw]
    if len(written) != 1:
        what = f"{' and '.join(written)} are given together" if written else "no linkage is described"
        return [Problem("", f"{what}; give exactly one of [rssr], [[joint]] or [[link]]")]
    (key,) = written
    joints = _joints(raw)
    problems = []
    if key == "joint":
        tables = [(i, t) for i, t in enumerate(_tables(raw, key), 1) if t.get("kind") in JOINT_KINDS]
        problems = [
            Problem(f"joint[{i}].{name}", message) for i, t in tables for name, message in _misfits(t)
        ]
    elif key == "link":
        tables = [(i, t) for i, t in enumerate(_tables(raw, key), 1) if t.get("joint", "R") in ROW_KINDS]
        problems = [Problem(f"link[{i}].{name}", m) for i, t in tables for name, m in _row_misfits(t)]
    countable = FEWEST_JOINTS <= len(joints) <= MOST_JOINTS
    if isinstance(raw[key], list) and not countable:
        count = f"a loop of {len(joints)} joint{'' if len(joints) == 1 else 's'}"
        problems.append(Problem(key, f"{count} is not taken; give {FEWEST_JOINTS} to {MOST_JOINTS}"))
    taken: set[str] = set()
    for joint in joints:
        labels = {joint.name, *joint.columns}
        if labels & taken:
            message = f"{shown(joint.name)} is taken already; give each joint its own name"
            problems.append(Problem(f"{joint.place}.name", message))
        taken |= labels
    problems += _misplaced_points(raw, joints)
    return problems + (_driven(joints, _drive(raw))[2] if countable else [])


def _misplaced_points(raw: Mapping[str, Any], joints: Sequence[_Written]) -> list[Problem]:
    problems = []
    taken = {"A", "B"} if [joint.kind for joint in joints] == ["R", "S", "S", "R"] else set()
    for i, table in enumerate(_tables(raw, "point"), 1):
        link, name = table.get("link"), table.get("name")
        if isinstance(link, int) and not isinstance(link, bool) and link > len(joints) > 0:
            last = f"give 1 to {len(joints)}, the last is the ground"
            problems.append(Problem(f"point[{i}].link", f"{shown(link)} is not a link; {last}"))
        if isinstance(name, str) and name.strip() in taken:
            problems.append(
                Problem(f"point[{i}].name", f"{shown(name)} is taken already; give each point its own name")
            )
        taken.add(str(name).strip())
    return problems


def _driven(joints: Sequence[_Written], drive: Mapping[str, Any]) -> tuple[str, str, list[Problem]]:
    """The columns of input and output, and what is wrong with those that are named.

    The plain name of a joint of two freedoms is its first one. Without a word the input is the first joint
    that is no ball, and the output the last one.
    """
    firsts = [next(iter(joint.columns)) for joint in joints if joint.kind != "S"]
    free = [column for joint in joints if joint.kind != "S" for column in joint.columns]
    if len(free) < 2:
        loop = " ".join(joint.kind for joint in joints)
        count = "one freedom" if free else "no freedom"
        message = f"a loop {loop} has {count} outside its balls; an input and an output need two"
        known_kinds = all(joint.kind for joint in joints)
        return "", "", [Problem("joint", message)] if known_kinds else []
    known = [name for j in joints for name in (j.columns if j.kind in ("C", "U") else [j.name])]
    problems = []
    chosen: dict[str, str] = {}
    for key in ("joint", "output"):
        name = drive.get(key)
        if not isinstance(name, str):
            continue
        name = name.strip()
        owner = next((joint for joint in joints if name == joint.name or name in joint.columns), None)
        if owner is None:
            problems.append(Problem(f"drive.{key}", no_joint(name, known)))
        elif owner.kind == "S":
            ball = f"joint {shown(owner.name)} is a ball; give a joint with one freedom: {', '.join(free)}"
            problems.append(Problem(f"drive.{key}", ball))
        else:
            chosen[key] = next(iter(owner.columns)) if name == owner.name else name
    first = chosen.get("joint", firsts[0])
    others = [column for column in free if column != first]
    # `first` where one name stands for every joint, which is told of elsewhere
    last = chosen.get(
        "output", next((c for c in [*reversed(firsts), *reversed(others)] if c != first), first)
    )
    # an input that is named wrongly may be any other
    if chosen.get("output") == first and not (problems and "joint" not in chosen):
        one = len(others) == 1
        rest = f"the output is the other one, {others[0]}" if one else f"give another: {', '.join(others)}"
        problems.append(Problem("drive.output", f"joint {shown(first)} is the input; {rest}"))
    return first, last, problems


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


def _row_misfits(row: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The same for a Denavit-Hartenberg row, where one number is the variable and is not written."""
    kind = row.get("joint", "R")
    moving = "offset" if kind == "P" else "angle"
    misfits = []
    if kind == "H" and "pitch" not in row:
        misfits.append(("pitch", "is missing; a joint of kind H needs it"))
    if moving in row:
        misfits.append((moving, f"is what moves in a joint of kind {kind}; leave it out"))
    if kind != "H" and "pitch" in row:
        misfits.append(("pitch", f"does not belong to a joint of kind {kind}; leave it out"))
    return misfits


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


def _form_at(location: list[int | str]) -> type[_Form] | None:
    """The form that owns a place: the file's own, or that of the table that the path enters."""
    words = [part for part in location if isinstance(part, str)]
    tables: dict[str, type[_Form]] = {
        "rssr": RssrForm,
        "joint": JointForm,
        "link": LinkForm,
        "point": PointForm,
        "drive": DriveForm,
    }
    if not words:
        return LinkageForm
    return tables.get(words[0]) if len(words) == 1 else None
