"""What a task file may hold, checked with pydantic: the one model of it, and of the page of its keys.

Angles are in degrees where no unit is given, lengths in the linkage's own unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, get_args

from pydantic import BeforeValidator, Field, StrictBool, ValidationError, WithJsonSchema

from sevenbar.description.mistakes import FileForms
from sevenbar.description.values import (
    Angle,
    Direction,
    Length,
    TableForm,
    Text,
    Vector,
    key,
    one_of,
    refuse,
)
from sevenbar.design.limits import MOTION_TYPES
from sevenbar.design.task.file.values import (
    Goal,
    Link,
    Links,
    Matrix,
    Numbers,
    Pairs,
    Places,
    Points,
    Samples,
    Span,
    Timing,
    Unit,
    Value,
    WantNumber,
    Weight,
    Zero,
)
from sevenbar.errors import DescriptionError, shown

GOALS = ("least squares", "minimax")
PLACEMENTS = ("fixed", "free", "free with scale")

_OF_INPUT = "degrees, or length"


def _words(value: object) -> tuple[str, ...]:
    found = [value] if isinstance(value, str) else value
    if not isinstance(found, list) or not found or not all(isinstance(word, str) and word for word in found):
        raise refuse(f"{shown(value)} are no names; give some in quotes, as in ['A', 'P']")
    return tuple(found)


def _flat(value: object) -> object:
    """Tables in tables as one: TOML reads a name with a dot and no quotes, as in P.x, as a table."""
    if not isinstance(value, dict):
        return value
    found: dict[str, object] = {}
    for name, own in value.items():
        inner = _flat(own)
        found |= (
            {f"{name}.{key}": one for key, one in inner.items()} if isinstance(inner, dict) else {name: own}
        )
    return found


_Words = Annotated[
    tuple[str, ...], BeforeValidator(_words), WithJsonSchema({"type": "array", "items": {"type": "string"}})
]


class FunctionForm(TableForm):
    """The output as a function of the input."""

    kind: Annotated[Literal["function"], key("this want")]
    y: Annotated[Text | None, key("a function of x, as in 'x^2'; or pairs, or a table")] = None
    x: Annotated[Numbers, key("of y: the range of x; an angle with a unit counts in radians")] = (0.0, 1.0)
    input: Annotated[
        Span | None,
        key("of y: readings of the input over the range of x; left out with output, x itself", _OF_INPUT),
    ] = None
    output: Annotated[
        Span | None, key("of y: readings of the output from the least y to the greatest; y itself", _OF_INPUT)
    ] = None
    points: Annotated[
        Points | None,
        key("of y: so many points by Chebyshev's spacing are wanted, not all of the range"),
    ] = None
    pairs: Annotated[Pairs | None, key("readings of input and output, row by row", _OF_INPUT)] = None
    table: Annotated[
        Text | None, key("a CSV file or workbook of pairs: two columns, their units in the header")
    ] = None
    input_zero: Annotated[Zero, key("the input's value at the reading 0, or free", _OF_INPUT)] = "free"
    output_zero: Annotated[Zero, key("the output's value at the reading 0, or free", _OF_INPUT)] = "free"
    exact: Annotated[StrictBool, key("whether all points must be met exactly")] = False
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0


class PathForm(TableForm):
    """The path of a named point."""

    kind: Annotated[Literal["path"], key("this want")]
    point: Annotated[Text, key("the name of the linkage's point")]
    places: Annotated[
        Places | None,
        key("x, y, z row by row, z perhaps left out; closed where the last repeats the first", "length"),
    ] = None
    table: Annotated[Text | None, key("a CSV file or workbook of places: columns x, y, z with units")] = None
    timing: Annotated[
        Timing | None,
        key("inputs at which the places are reached; true: those of the table; left out, any", _OF_INPUT),
    ] = None
    phase: Annotated[StrictBool, key("whether the inputs count from a free start")] = False
    exact: Annotated[StrictBool, key("whether all places must be met exactly")] = False
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0


class PoseForm(TableForm):
    """A pose of a link: the place of its frame's origin, and how the frame is turned."""

    at: Annotated[Vector, key("the place of the origin of the link's frame", "length")]
    axis: Annotated[Direction, key("about which the frame is turned")] = (0.0, 0.0, 1.0)
    angle: Annotated[Angle, key("by which it is turned about the axis", "degrees")] = 0.0
    matrix: Annotated[Matrix | None, key("the rotation, row by row; in place of axis and angle")] = None


class PosesForm(TableForm):
    """Poses of a link, in order."""

    kind: Annotated[Literal["poses"], key("this want")]
    link: Annotated[Link, key("the link, counted from 1")]
    arm: Annotated[
        Length | None,
        key("the length at which a radian counts as much as it; left out, the linkage's size", "length"),
    ] = None
    frame: Annotated[
        PoseForm | None,
        key(
            "a frame on the link, as its points are written, whose poses are given; left out, the link's own"
        ),
    ] = None
    poses: Annotated[tuple[PoseForm, ...] | None, key("tables of at, axis, angle, or at, matrix")] = None
    table: Annotated[
        Text | None,
        key("a CSV file or workbook: x, y, z [length]; turn_x, turn_y, turn_z: axis times angle [deg, rad]"),
    ] = None
    timing: Annotated[
        Timing | None,
        key("inputs at which the poses are taken; true: those of the table; left out, any", _OF_INPUT),
    ] = None
    phase: Annotated[StrictBool, key("whether the inputs count from a free start")] = False
    exact: Annotated[StrictBool, key("whether all poses must be met exactly")] = False
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0


class FigureForm(TableForm):
    """A measure of the circuit."""

    kind: Annotated[Literal["figure"], key("this want; measure is the same")]
    name: Annotated[Text, key("the measure, as in swing, time_ratio, transmission_lowest, peak_torque")]
    value: Annotated[Goal, key("what it shall be, or 'small', or 'great'", "of the measure")]
    unit: Annotated[Unit, key("what counts as 1", "of the measure")] = 1.0
    weight: Annotated[Weight, key("how much its residual counts")] = 1.0


class DwellForm(TableForm):
    """The output stands still."""

    kind: Annotated[Literal["dwell"], key("this want")]
    range: Annotated[Span, key("of the input", _OF_INPUT)]
    level: Annotated[Zero, key("the output's value, or free", _OF_INPUT)] = "free"
    samples: Annotated[Samples, key("inputs of the range that count")] = 41
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0


class StraightForm(TableForm):
    """A named point goes along a straight line."""

    kind: Annotated[Literal["straight"], key("this want")]
    point: Annotated[Text, key("the name of the linkage's point")]
    range: Annotated[Span, key("of the input", _OF_INPUT)]
    length: Annotated[Length | None, key("how far it must go at least", "length")] = None
    samples: Annotated[Samples, key("inputs of the range that count")] = 41
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0


class RangeMust(TableForm):
    """A joint stays within ends."""

    kind: Annotated[Literal["range"], key("this must")]
    joint: Annotated[Text, key("the joint, or its column")]
    range: Annotated[Span, key("from where to where it may go", _OF_INPUT)]


class ConeMust(TableForm):
    """A ball or a U joint stays within a cone."""

    kind: Annotated[Literal["cone"], key("this must")]
    joint: Annotated[Text, key("a ball or a U joint")]
    angle: Annotated[Angle, key("the greatest angle between seat and stud", "degrees")]
    seat: Annotated[
        Direction | None, key("on the link before the joint, as its points are written; left out, its rod")
    ] = None
    stud: Annotated[
        Direction | None, key("on the link after the joint, as its points are written; left out, its rod")
    ] = None


class BoxMust(TableForm):
    """Points and joints stay in a box."""

    kind: Annotated[Literal["box"], key("this must")]
    low: Annotated[Vector, key("its least x, y, z in the report frame", "length")]
    high: Annotated[Vector, key("its greatest x, y, z", "length")]
    names: Annotated[_Words | None, key("of points and joints; left out, all of them")] = None


class ApartMust(TableForm):
    """Two links keep a distance."""

    kind: Annotated[Literal["apart"], key("this must")]
    links: Annotated[Links, key("their numbers, counted from 1")]
    least: Annotated[Length, key("the least distance of the two as rods between their joints", "length")]


class FigureMustForm(TableForm):
    """A measure of the circuit stays within ends."""

    kind: Annotated[Literal["figure"], key("this must; measure is the same")]
    name: Annotated[Text, key("the measure")]
    least: Annotated[Value | None, key("the least that it may be", "of the measure")] = None
    most: Annotated[Value | None, key("the most that it may be", "of the measure")] = None


class MostMust(TableForm):
    """The residuals of a want are small."""

    kind: Annotated[Literal["most"], key("this must")]
    want: Annotated[WantNumber, key("its place among [[want]], counted from 1")]
    most: Annotated[
        Value, key("the most that each of its residuals may be, weights left out", "degrees, or length")
    ]


class LimitsForm(TableForm):
    """What the linkage is as a whole."""

    motion_type: Annotated[
        str | None,
        *one_of("motion type", MOTION_TYPES),
        key("seen from its input; left out, any"),
    ] = None
    size: Annotated[Span | None, key("shortest link and longest dimension", "length")] = None
    transmission: Annotated[
        Angle,
        key("the least transmission angle where it is used; of measures alone, over the whole circuit"),
    ] = 0.0


WantForm = FunctionForm | PathForm | PosesForm | FigureForm | DwellForm | StraightForm
MustForm = RangeMust | ConeMust | BoxMust | ApartMust | FigureMustForm | MostMust


def _by_kind(forms: Any) -> dict[str, type[TableForm]]:
    return {get_args(form.model_fields["kind"].annotation)[0]: form for form in get_args(forms)}


#: The forms of the tables by their kinds.
WANTS, MUSTS = _by_kind(WantForm), _by_kind(MustForm)


def _as_figure(value: object) -> object:
    """A table whose kind is the word of the docs, a measure."""
    return (
        {**value, "kind": "figure"} if isinstance(value, dict) and value.get("kind") == "measure" else value
    )


_Want = Annotated[WantForm, Field(discriminator="kind"), BeforeValidator(_as_figure)]
_Must = Annotated[MustForm, Field(discriminator="kind"), BeforeValidator(_as_figure)]


class TaskForm(TableForm):
    """A whole task file."""

    linkage: Annotated[
        str | dict[str, Any],
        key("a file below the folder of this one, a name of the gallery, or tables of a linkage file"),
    ]
    want: Annotated[tuple[_Want, ...], key("what is wanted; one or more")]
    free: Annotated[
        dict[str, Span],
        BeforeValidator(_flat),
        key("numbers that may change and their bounds, by name or pattern", "as in the linkage's file"),
    ]
    must: Annotated[tuple[_Must, ...], key("what must hold")] = ()
    limits: Annotated[LimitsForm, key("motion type, size, transmission")] = LimitsForm()
    goal: Annotated[
        str,
        *one_of("goal", GOALS),
        key("what is made small: the squares of all residuals, or the greatest of them"),
    ] = "least squares"
    placement: Annotated[
        str,
        *one_of("placement", PLACEMENTS),
        key("whether the linkage may stand anywhere, perhaps in any size; paths and poses see it"),
    ] = "fixed"
    follow: Annotated[
        _Words | None, key("dimensions that the file leaves out (L2) and that follow from the others")
    ] = None
    name: Annotated[Text | None, key("of the task, for reports; left out, the linkage's")] = None


TASK_FORMS = FileForms(
    TaskForm,
    {"limits": LimitsForm},
    once=("limits",),
    kinds={"want": WANTS, "must": MUSTS},
)


def check_form(raw: Mapping[str, Any], length_unit: str, source: str) -> TaskForm:
    """The checked form of a file's tables, or `DescriptionError` with every problem in it."""
    try:
        return TaskForm.model_validate(raw, context={"length_unit": length_unit, "angle_unit": "deg"})
    except ValidationError as error:
        problems = [TASK_FORMS.problem(detail) for detail in error.errors(include_url=False)]
        raise DescriptionError(list(dict.fromkeys(problems)), source) from None
