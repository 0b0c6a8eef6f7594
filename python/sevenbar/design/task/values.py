"""What one value of a task file may be: pydantic types; those whose unit a joint decides stay as written."""

from __future__ import annotations

import math
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from sevenbar.description.values import POSITIVE, number_for, refuse, three
from sevenbar.errors import shown
from sevenbar.kinematics.loop.rigid import flaw_of_rotation
from sevenbar.text.expression import constant_of
from sevenbar.text.ranges import split_range

#: The unit of values that belong to the input or the output, in words.
OF_INPUT = "degrees, or length"

#: A number, or a text with a unit, as it is written: what it belongs to decides its unit.
Given = str | float


def _given(value: object, *, what: str = "a value", example: str = "30, '30deg' or '12mm'") -> Given:
    if isinstance(value, str) and value.strip():
        return value.strip()
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise refuse(f"{shown(value)} is not {what}; give one as in {example}")
    return float(value)


def _span(value: object) -> tuple[Given, Given]:
    ends: Any = split_range(value) if isinstance(value, str) else value
    if not isinstance(ends, (list, tuple)) or len(ends) != 2:
        raise refuse(f"{shown(value)} is not a range; give the two ends, as in '0:90deg' or [0, 90]")
    first, last = (_given(end, what="an end of a range", example="'0:90deg' or [0, 90]") for end in ends)
    return first, last


def _numbers(value: object) -> tuple[float, float]:
    ends = _span(value)
    result = [constant_of(end) if isinstance(end, str) else end for end in ends]
    if None in result:
        raise refuse(f"{shown(value)} is not a range; give two values, as in '0:1', '0:pi/2' or '0:90deg'")
    first, last = (float(one) for one in result if one is not None)
    return first, last


def _positive(value: object, info: ValidationInfo, what: str) -> float:
    number = number_for(value, info)
    if not number > 0:
        raise refuse(f"{shown(value)} is not {what}; give a number > 0")
    return number


def _whole(value: object, least: int, most: int, what: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise refuse(f"{shown(value)} is not {what}; give a whole number from {least} to {most}")
    return value


def _zero(value: object) -> Given:
    return "free" if value == "free" else _given(value, example="'free', 30 or '30deg'")


def _pairs(value: object) -> tuple[tuple[Given, Given], ...]:
    rows: list[Any] = value if isinstance(value, list) else [value]
    if not all(isinstance(row, list) and len(row) == 2 for row in rows):
        raise refuse(f"{shown(value)} are no pairs; give rows of input and output, as in [[0, 10], [30, 25]]")
    return tuple((_given(a), _given(b)) for a, b in rows)


def _places(value: object, info: ValidationInfo) -> tuple[tuple[float, float, float], ...]:
    if not isinstance(value, list) or not all(isinstance(row, list) and len(row) in (2, 3) for row in value):
        raise refuse(f"{shown(value)} are no places; give rows of x, y and z, as in [[0, 10, 0], [5, 12, 0]]")
    # a path in the plane needs no z
    return tuple(three([*row, 0.0][:3], info, "length") for row in value)


def _timing(value: object) -> tuple[Given, ...] | Literal[True]:
    if value is True:
        return True
    if not isinstance(value, list) or not value:
        raise refuse(
            f"{shown(value)} are no inputs; give one for each place, as in [0, 10, 20], or true for the "
            "input's column of the table"
        )
    return tuple(map(_given, value))


def _matrix(value: object, info: ValidationInfo) -> tuple[tuple[float, float, float], ...]:
    if not isinstance(value, list) or len(value) != 3:
        raise refuse(f"{shown(value)} is no matrix; give three rows of three numbers")
    rows = tuple(three(row, info, "number") for row in value)
    if flaw := flaw_of_rotation(np.array(rows)):
        raise refuse(flaw)
    return rows


def _links(value: object) -> tuple[int, int]:
    if (
        not isinstance(value, list)
        or len(value) != 2
        or not all(isinstance(link, int) and not isinstance(link, bool) and link > 0 for link in value)
    ):
        raise refuse(f"{shown(value)} are no two links; give their numbers, as in [1, 3]")
    return value[0], value[1]


def _goal(value: object) -> Given:
    return value if value in ("small", "great") else _given(value, example="60, '60deg', 'small' or 'great'")


def _words(value: object) -> tuple[str, ...]:
    result = [value] if isinstance(value, str) else value
    if (
        not isinstance(result, list)
        or not result
        or not all(isinstance(word, str) and word for word in result)
    ):
        raise refuse(f"{shown(value)} are no names; give some in quotes, as in ['A', 'P']")
    return tuple(result)


_ANY: dict[str, Any] = {"type": ["number", "string"]}
_ENDS = WithJsonSchema({"type": ["string", "array"]})
_ROWS = WithJsonSchema({"type": "array"})


def _counted(least: int, most: int, what: str) -> tuple[BeforeValidator, WithJsonSchema]:
    """What checks a whole number within ends, and its schema."""
    schema = {"type": "integer", "minimum": least, "maximum": most}
    return BeforeValidator(partial(_whole, least=least, most=most, what=what)), WithJsonSchema(schema)


#: The kinds of values, as the forms of `schema` have them.
Value = Annotated[Given, BeforeValidator(_given), WithJsonSchema(_ANY)]
Zero = Annotated[Given, BeforeValidator(_zero), WithJsonSchema(_ANY)]
Goal = Annotated[Given, BeforeValidator(_goal), WithJsonSchema(_ANY)]
Span = Annotated[tuple[Given, Given], BeforeValidator(_span), _ENDS]
Numbers = Annotated[tuple[float, float], BeforeValidator(_numbers), _ENDS]
Weight = Annotated[float, BeforeValidator(partial(_positive, what="a weight")), POSITIVE]
Unit = Annotated[float, BeforeValidator(partial(_positive, what="a unit")), POSITIVE]
Pairs = Annotated[tuple[tuple[Given, Given], ...], BeforeValidator(_pairs), _ROWS]
Places = Annotated[tuple[tuple[float, float, float], ...], BeforeValidator(_places), _ROWS]
Timing = Annotated[
    tuple[Given, ...] | Literal[True],
    BeforeValidator(_timing),
    WithJsonSchema({"type": ["array", "boolean"]}),
]
Matrix = Annotated[tuple[tuple[float, float, float], ...], BeforeValidator(_matrix), _ROWS]
Links = Annotated[tuple[int, int], BeforeValidator(_links), _ROWS]
Link = Annotated[int, *_counted(1, 1000, "a link")]
Samples = Annotated[int, *_counted(3, 1000, "a number of samples")]
Points = Annotated[int, *_counted(3, 100, "a number of points")]
WantNumber = Annotated[int, *_counted(1, 100, "a want")]
Words = Annotated[
    tuple[str, ...], BeforeValidator(_words), WithJsonSchema({"type": "array", "items": {"type": "string"}})
]
