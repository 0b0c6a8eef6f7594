"""What tables and values of a description may be: pydantic types, with messages for values that are none."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, cast

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError

from sevenbar.description.not_covered import not_covered
from sevenbar.description.written import entries, meant_kind
from sevenbar.errors import NAME_TO_GIVE, Problem, RequestError, is_name, shown, suggestion
from sevenbar.kinematics.loop.joint_text import drive_speed
from sevenbar.text.units import ANGLES, unknown_unit

if TYPE_CHECKING:
    from sevenbar.text.amounts import Kind
    from sevenbar.text.quantities import QuantityKind

    #: What a number of a file may be.
    NumberKind = Kind | QuantityKind

#: Dimensions outside this range are slips of the pen, and their powers would overflow.
LARGEST_DIMENSION = 1e100

EXAMPLE_OF_AXES = "as in [[1, 0, 0], [0, 1, 0]]"

#: Sine of the angle below which the two axes of a joint U are one axis to the digits of a drawing.
PARALLEL = 1e-9


class TableForm(BaseModel):
    """A table whose keys are known."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


def key(meaning: str, unit: str = "") -> Any:
    """What a key means, and the unit of its numbers in words: for the JSON schema and the page."""
    return Field(description=meaning, json_schema_extra={"unit": unit} if unit else None)


F = TypeVar("F", bound=TableForm)


def valid_tables(
    raw: Mapping[str, Any], head: str, form: type[F], context: Mapping[str, Any]
) -> list[tuple[str, F]]:
    """The tables of a head that have no wrong value, each with its place; others are reported elsewhere."""
    result = []
    for i, table in enumerate(entries(raw, head), 1):
        try:
            result.append((f"{head}[{i}]", form.model_validate(table, context=dict(context))))
        except ValidationError:
            continue
    return result


def flaws_of_value(place: str, make: Any) -> list[Problem]:
    """What the value that a table stands for says against it."""
    try:
        make()
    except RequestError as error:
        key, _, message = str(error).partition(": ")
        return [Problem(f"{place}.{key}", message)]
    return []


def refuse(message: str) -> PydanticCustomError:
    """The error that says this of a value."""
    # pydantic reads braces in a message as a template
    return PydanticCustomError("sevenbar", "{message}", {"message": message})


def value_in_file(text: str, kind: NumberKind, context: Mapping[str, Any]) -> float:
    """The number of a formula in the units of its file, which the context has by their keys."""
    # a file without formulas needs no reader of them
    from sevenbar.text.amounts import value_of
    from sevenbar.text.quantities import QUANTITY_KINDS, quantity_of

    own = ("length_unit", "mass_unit" if kind in QUANTITY_KINDS else "angle_unit")
    units = {key: str(context[key]) for key in own if key in context}
    if kind in QUANTITY_KINDS:
        return quantity_of(text, cast("QuantityKind", kind), **units)
    return value_of(text, cast("Kind", kind), **units)


def number_for(value: object, info: ValidationInfo, kind: NumberKind = "number") -> float:
    """A finite number that is not beyond all sense, or the number of a text; in the file's own unit."""
    if isinstance(value, str):
        try:
            value = value_in_file(value, kind, info.context or {})
        except RequestError as error:
            raise refuse(str(error)) from None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise refuse(f"{shown(value)} is not a number; give a number")
    if isinstance(value, float) and not math.isfinite(value):
        raise refuse(f"{shown(value)} is not a finite number; give a finite number")
    if abs(value) > LARGEST_DIMENSION:
        raise refuse(f"{shown(value)} is out of range; give a number up to {LARGEST_DIMENSION:g} in size")
    return float(value)


def carried(value: object, info: ValidationInfo, kind: NumberKind) -> float:
    """A number as `number_for` has it, an angle in radians."""
    size = ANGLES[(info.context or {}).get("angle_unit", "rad")] if kind == "angle" else 1.0
    return number_for(value, info, kind) * size


def _length(value: object, info: ValidationInfo) -> float:
    number = number_for(value, info, "length")
    if number <= 0:
        raise refuse(f"{shown(value)} is not a length; give a number > 0")
    if number < 1 / LARGEST_DIMENSION:
        raise refuse(f"{shown(value)} is out of range; give a length of at least {1 / LARGEST_DIMENSION:g}")
    return number


def parts_of(value: object, count: int, otherwise: str) -> Sequence[Any]:
    """The parts of a list of so many; what is wrong with another value says `otherwise`."""
    if not isinstance(value, (list, tuple)) or len(value) != count:
        raise refuse(f"{shown(value)} {otherwise}")
    return value


def three(value: object, info: ValidationInfo, kind: NumberKind) -> tuple[float, float, float]:
    """Three numbers of a kind."""
    parts = parts_of(value, 3, "is not a point or direction; give three numbers, as in [0, 0, 1]")
    x, y, z = (number_for(part, info, kind) for part in parts)
    return x, y, z


def _direction(value: object, info: ValidationInfo) -> tuple[float, float, float]:
    vector = three(value, info, "number")
    if math.hypot(*vector) < 1 / LARGEST_DIMENSION:
        raise refuse(f"{shown(value)} has no direction; give three numbers, not all 0")
    return vector


def crossing(axes: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    """The two axes of a joint U, unless they are one."""
    a, b = ([x / math.hypot(*axis) for x in axis] for axis in axes)
    across = math.hypot(*(a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)))
    if across < PARALLEL:
        apart = math.degrees(math.atan2(across, sum(x * y for x, y in zip(a, b, strict=True))))
        written = shown([list(axis) for axis in axes])
        raise refuse(f"{written} are {apart:.3g} deg apart; give two axes that cross, {EXAMPLE_OF_AXES}")
    return axes


def one_of(what: str, known: Mapping[str, object] | tuple[str, ...]) -> tuple[Any, ...]:
    """Marks of a word that is known, or of a message with the nearest one; `what` it is."""

    def choose(value: object) -> str:
        if isinstance(value, str) and value in known:
            return value
        if what == "unit":
            raise refuse(unknown_unit(value, known))
        meant = meant_kind(value) if what == "joint kind" else ""
        near = f"did you mean '{meant}'? " if meant in known else suggestion(value, known)
        lacking = not_covered(value) if what == "joint kind" else ""
        if lacking:
            raise refuse(f"{shown(value)} is not a {what}: {lacking}; allowed: {', '.join(known)}")
        raise refuse(f"{shown(value)} is not a {what}; {near}allowed: {', '.join(known)}")

    return BeforeValidator(choose), WithJsonSchema({"enum": list(known)})


def _text(value: object) -> str:
    if not is_name(value):
        raise refuse(f"{shown(value)} is not a name; give {NAME_TO_GIVE}")
    return value.strip()


def one_word(end: str) -> Callable[[object], object]:
    """A check that refuses a list where one joint is the input or the output of the linkage."""

    def choose(value: object) -> object:
        if isinstance(value, list) and len(value) != 1:
            what = f"{shown(value)} are {len(value)} {end}s" if value else f"{shown(value)} names no {end}"
            raise refuse(
                f"{what}; a linkage has one {end} here, so give one joint, as in {end_example(value)}"
                + ("; with two inputs lock one of them: leave that joint out" if end == "input" else "")
            )
        return value

    def end_example(value: list[object]) -> str:
        first = next((name for name in value if isinstance(name, str)), "crank")
        return shown(first)

    return choose


def _speed(value: object, info: ValidationInfo) -> float:
    try:
        return drive_speed(value, (info.context or {}).get("slides"))
    except RequestError as error:
        raise refuse(str(error)) from None


#: In a file a number may be a formula in quotes.
FORMULA = {"type": ["number", "string"], "pattern": "[0-9]|pi|\u03c0"}
_OR_TEXT = WithJsonSchema(FORMULA)
POSITIVE = WithJsonSchema({**FORMULA, "exclusiveMinimum": 0})

Number = Annotated[float, BeforeValidator(partial(number_for, kind="length")), _OR_TEXT]
Pitch = Annotated[float, BeforeValidator(partial(number_for, kind="pitch")), _OR_TEXT]
Angle = Annotated[float, BeforeValidator(partial(carried, kind="angle")), _OR_TEXT]
Length = Annotated[float, BeforeValidator(_length), POSITIVE]
Component = Annotated[float, _OR_TEXT]
Vector = Annotated[tuple[Component, Component, Component], BeforeValidator(partial(three, kind="length"))]
Direction = Annotated[tuple[Component, Component, Component], BeforeValidator(_direction)]
Text = Annotated[str, BeforeValidator(_text)]
Speed = Annotated[float, BeforeValidator(_speed), WithJsonSchema({"type": ["number", "string"]})]
