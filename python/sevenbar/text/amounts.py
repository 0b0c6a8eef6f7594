"""The number of a dimension that a formula writes down, "50*sin(100deg)/sin(30deg)", its units checked."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any, Literal

import numpy as np

from sevenbar.errors import RequestError, shown
from sevenbar.text.expression import (
    CALLED,
    CONSTANTS,
    FUNCTIONS,
    LONGEST,
    NEAR,
    OPERATORS,
    WrongFormulaError,
    cosd,
    evaluated,
    parsed,
    sind,
    tand,
)
from sevenbar.text.units import ANGLES, LENGTHS, TURNING_SPEEDS, amount, length_sizes, sizes_of

#: The functions of an angle by what they are in degrees, and those that give one.
OF_ANGLES = {"sin": sind, "cos": cosd, "tan": tand}
TO_ANGLES = ("asin", "acos", "atan")

#: What may end a pitch, which is a length per turn.
_A_TURN = re.compile(r"\s*/\s*turn\s*$")

#: What a dimension is: it says which unit its formula may have, and what a formula without one means.
Kind = Literal["length", "pitch", "angle", "number"]


def value_of(text: str, kind: Kind, *, length_unit: str = "mm", angle_unit: str = "deg") -> float:
    """The number of a dimension that a text writes down, in `length_unit` or `angle_unit`.

    Numbers with or without a unit, pi, e, + - * / ^, brackets, sqrt, abs, and the functions of angles. A
    length or an angle without a unit is in the file's; an angle of pi, or of asin, acos, atan, is in radians.
    The angle of sin, cos and tan needs a unit, or pi. Raises `RequestError` where units do not fit.

        >>> value_of("50*sin(100deg)/sin(30deg)", "length")
        98.4807753012208
        >>> value_of("pi/3", "angle"), value_of("1in + 2 cm", "length")
        (60.0, 45.4)
    """
    if len(text) > LONGEST:
        raise RequestError(f"{len(text)} characters are too long; give a formula of at most {LONGEST}")
    own = ANGLES[angle_unit]
    try:
        number = _fitting(_computed(text, kind, length_unit, angle_unit), kind, own)
    except WrongFormulaError as error:
        remedy = "" if "; " in str(error) else f"; give {_EXAMPLES[kind]}"
        raise RequestError(f"{shown(text)}: {error}{remedy}") from None
    if not math.isfinite(number):
        raise RequestError(f"{shown(text)} has no finite value; give {_EXAMPLES[kind]}")
    return number


def amount_in(text: str, unit: str, plain: str = "") -> float | None:
    """The number in "rad", "mm", "s", "rad/s" or "" that a text writes down; `None` for what is none.

    The text is a number with or without a unit, or a formula. Without a unit it is in `plain`, the same unit
    where none is given; an angle of pi is in radians.

        >>> amount_in("180", "rad", "deg"), amount_in("pi/6", "deg"), amount_in("2*1 in", "mm")
        (3.141592653589793, 30.0, 50.8)
    """
    plain = plain or unit
    sizes = sizes_of(unit)
    value = amount(text, sizes, plain)
    if value is not None:
        return value
    try:
        if plain in ANGLES:
            return value_of(text, "angle", angle_unit=plain) * sizes[plain]
        if plain == "":
            return value_of(text, "number")
        length, slash, per = plain.partition("/")
        if length in LENGTHS and per in ("", "turn"):
            return value_of(text, "pitch" if slash else "length", length_unit=length) * sizes[plain]
        return amount(plain_speed(text), sizes, plain)
    except RequestError:
        return None


def lacks_unit(text: str, kind: Kind) -> bool:
    """Whether an angle or a length is written without a unit; not so for 0, for pi, for what is no formula.

    >>> [lacks_unit(text, "angle") for text in ("30", "2*15", "0", "pi/6", "2*15deg", "wide")]
    [True, True, False, False, False, False]
    """
    try:
        result = _computed(text, kind, "mm", "deg")
    except WrongFormulaError:
        return False
    return result.plain and result.number != 0 and not (kind == "angle" and result.turns)


def _computed(text: str, kind: Kind, length_unit: str, angle_unit: str) -> _Amount:
    """What a formula gives, in these units; raises `WrongFormulaError`."""
    if kind == "pitch":
        text = _A_TURN.sub("", text)
    sizes = length_sizes(length_unit)
    names = {name: _Amount(value, turns=name == "pi") for name, value in CONSTANTS.items()}
    names |= {CALLED[unit]: _Amount(size, length=Fraction(1)) for unit, size in sizes.items()}
    # angles are carried in the file's own unit, so that what is written in it stays as it is
    own = ANGLES[angle_unit]
    for unit, size in ANGLES.items():
        same = unit == angle_unit
        names[CALLED[unit]] = _Amount(1.0 if same else size / own, angle=1, turns=not same)
    body = parsed(text, names)
    with np.errstate(all="ignore"):
        result = evaluated(body, names, partial(_operated, own=own), partial(_applied, own=own))
    return result if isinstance(result, _Amount) else _Amount(float(result))


#: What a dimension may look like, for messages.
_EXAMPLES: Mapping[Kind, str] = {
    "length": "a length, as in 250, '25 cm' or '50*sin(30deg)'",
    "pitch": "a length per turn, as in 8, '8 mm/turn' or '2*4mm'",
    "angle": "an angle, as in 30, '30deg' or 'pi/6'",
    "number": "a number, as in 0.5 or 'cos(60deg)'",
}


@dataclass(frozen=True)
class _Amount:
    """A number with the powers of length and angle in its unit.

    `turns`: it comes of pi, of radians or of an inverse function. `mixed`: such a number and another one were
    added, neither with a unit.
    """

    number: float
    length: Fraction = Fraction(0)
    angle: int = 0
    turns: bool = False
    mixed: bool = False

    @property
    def plain(self) -> bool:
        return not (self.length or self.angle)

    @property
    def what(self) -> str:
        if self.plain:
            return "a number without a unit"
        known = {(1, 0): "a length", (0, 1): "an angle", (2, 0): "an area"}
        return next((what for power, what in known.items() if self.has(*power)), "neither length nor angle")

    def has(self, length: int, angle: int) -> bool:
        """Whether its unit has these powers of length and angle."""
        return self.length == length and self.angle == angle


def _operated(sign: type[ast.AST], *sides: Any, own: float) -> _Amount:
    """Amounts added, multiplied and so on; `own` is the size [rad] of the file's unit of angles."""
    first, *rest = [side if isinstance(side, _Amount) else _Amount(float(side)) for side in sides]
    if not rest:
        return replace(first, number=float(OPERATORS[sign](first.number)))
    (second,) = rest
    mixed = first.mixed or second.mixed
    if sign in (ast.Add, ast.Sub):
        first, second = _in_radians(first, second, own), _in_radians(second, first, own)
        if (first.length, first.angle) != (second.length, second.angle):
            verb = "adds" if sign is ast.Add else "subtracts"
            raise WrongFormulaError(f"it {verb} {first.what} and {second.what}; give each its unit")
        length, angle = first.length, first.angle
        mixed |= first.plain and first.turns != second.turns and 0.0 not in (first.number, second.number)
    elif sign is ast.Pow:
        if not second.plain:
            raise WrongFormulaError(f"{second.what} is no exponent; give a number without a unit")
        power = Fraction(second.number).limit_denominator(12) if abs(second.number) < 100 else Fraction(0)
        if not first.plain and float(power) != second.number:
            raise WrongFormulaError(
                f"{first.what} to the power {second.number:g} has no unit; give a whole exponent"
            )
        length, turned = first.length * power, first.angle * power
        if turned.denominator != 1:
            raise WrongFormulaError("the root of an angle has no unit; give a number without a unit")
        angle = int(turned)
    else:
        turn = 1 if sign is ast.Mult else -1
        length, angle = first.length + turn * second.length, first.angle + turn * second.angle
    number = float(OPERATORS[sign](np.float64(first.number), second.number))
    return _Amount(number, length, angle, first.turns or second.turns, mixed)


def _in_radians(one: _Amount, other: _Amount, own: float) -> _Amount:
    """A number of pi that is added to an angle is an angle itself."""
    is_angle = one.plain and one.turns and not one.mixed and other.angle == 1
    return _Amount(one.number / own, angle=1, turns=True) if is_angle else one


def _applied(name: str, value: Any, *, own: float) -> _Amount:
    """A function of an amount, which must have the unit that the function takes."""
    x = value if isinstance(value, _Amount) else _Amount(float(value))
    if name in OF_ANGLES:
        if x.has(0, 1):
            degrees = x.number if own == ANGLES["deg"] else math.degrees(x.number)
        elif x.plain and ((x.turns and not x.mixed) or x.number == 0):
            degrees = math.degrees(x.number)
        else:
            unit = (
                f"write {name}({x.number:g}deg), or {name}({x.number:g} rad)" if x.plain else "give an angle"
            )
            raise WrongFormulaError(f"{name} of {x.what}; {unit}")
        near = 30.0 * round(degrees / 30.0) if math.isfinite(degrees) else 0.0
        exact = abs(degrees - near) <= NEAR
        return _Amount(float(OF_ANGLES[name](near) if exact else FUNCTIONS[name](math.radians(degrees))))
    if name == "abs":
        return replace(x, number=abs(x.number))
    if name == "sqrt":
        return _operated(ast.Pow, x, 0.5, own=own)
    if not x.plain:
        raise WrongFormulaError(f"{name} of {x.what}; give a number without a unit")
    number = float(FUNCTIONS[name](np.float64(x.number)))
    return _Amount(number / own, angle=1, turns=True) if name in TO_ANGLES else _Amount(number)


def _fitting(result: _Amount, kind: Kind, own: float) -> float:
    """The number of an found that has the unit of its dimension, or none."""
    number = float(result.number)
    if kind == "angle" and result.plain and result.mixed:
        raise WrongFormulaError(
            "it adds a number of pi and another; give each its unit, as in 'pi/3 rad + 5deg'"
        )
    if kind == "angle" and result.turns and result.plain:
        result = _Amount(number / own, angle=1, turns=True)
    wanted = {"length": (1, 0), "pitch": (1, 0), "angle": (0, 1), "number": (0, 0)}[kind]
    if not result.plain and not result.has(*wanted):
        belongs = {"angle": "an angle", "number": "a number without a unit"}.get(kind, "a length")
        raise WrongFormulaError(f"is {result.what} where {belongs} belongs")
    # 60, not 59.99999999999999, of pi/3
    short = float(f"{result.number:.13g}")
    return short if result.turns and abs(short - result.number) <= 2e-15 * abs(short) else result.number


_SPEED_UNITS = "|".join([*TURNING_SPEEDS, *(f"{unit}/s" for unit in LENGTHS)])
_FORMULA_OF_SPEED = re.compile(rf"(.+?)\s*({_SPEED_UNITS})")


def plain_speed(value: Any) -> Any:
    """A speed whose number is a formula, with the number; any other value as it is.

    >>> plain_speed("2*3 rad/s"), plain_speed("60 rpm"), plain_speed(5)
    ('6.0 rad/s', '60 rpm', 5)
    """
    match = _FORMULA_OF_SPEED.fullmatch(value) if isinstance(value, str) else None
    if match is None or not any(sign in match[1] for sign in "*/(^"):
        return value
    return f"{value_of(match[1], 'number')!r} {match[2]}"
