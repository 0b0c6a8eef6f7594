"""Formulas as people write them: "x^2", "50*sin(100deg)/sin(30deg)"; read, never run as code.

One reader for both: `function_of` gives a function of x, whose angles are plain numbers in radians, and
`value_of` the number of a dimension, with its units checked.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.text.units import ANGLES, LENGTHS, length_sizes, unknown_unit

Floats = npt.NDArray[np.float64]

#: Longest text of a formula; a parser's depth is bounded with it.
LONGEST = 200

#: An angle this near [deg] to a multiple of 30 deg is meant to be one: its sine and cosine are exact there.
NEAR = 1e-12


def sind(degrees: Any) -> Any:
    """The sine of an angle in degrees, exact at multiples of 30.

    >>> float(sind(30)), float(sind(180))
    (0.5, 0.0)
    """
    turn = np.remainder(np.asarray(degrees, dtype=float), 360.0)
    sine = np.sin(np.radians(turn))
    for angle, exact in ((0, 0.0), (30, 0.5), (90, 1.0), (150, 0.5), (180, 0.0), (210, -0.5), (270, -1.0),
                         (330, -0.5), (360, 0.0)):  # fmt: skip
        sine = np.where(np.abs(turn - angle) <= NEAR, exact, sine)
    return sine


def cosd(degrees: Any) -> Any:
    """The cosine of an angle in degrees, exact at multiples of 30."""
    return sind(np.asarray(degrees, dtype=float) + 90.0)


def tand(degrees: Any) -> Any:
    """The tangent of an angle in degrees, infinite where there is none."""
    return np.divide(sind(degrees), cosd(degrees))


FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "sind": sind,
    "cosd": cosd,
    "tand": tand,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "ln": np.log,
    "log10": np.log10,
    "log2": np.log2,
    "sqrt": np.sqrt,
    "abs": np.abs,
}
CONSTANTS = {"pi": math.pi, "e": math.e}
OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.USub: np.negative,
    ast.UAdd: np.positive,
}

#: The functions of an angle by what they are in degrees, and those that give one.
OF_ANGLES = {"sin": sind, "cos": cosd, "tan": tand}
TO_ANGLES = ("asin", "acos", "atan")

#: Signs of print and of other languages.
_SIGNS = str.maketrans({"\u00b7": "*", "\u00d7": "*", "\u2212": "-", "\u03c0": "pi", "\u00b0": "deg"})

#: A unit, with the number that it follows without a blank: `2/3cm` is two divided by 3 cm, `2/3 cm` is not.
_UNIT = "|".join(sorted((*LENGTHS, *ANGLES), key=len, reverse=True))
_NUMBER_AND_UNIT = re.compile(rf"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)({_UNIT})(?![\w.(])")
_UNIT_ALONE = re.compile(rf"(?<=[\w.)])\s*(?<![\w.])({_UNIT})(?![\w.(])|(?<=\))({_UNIT})(?![\w.(])")

#: A word after a number, which is none of its units.
_NUMBER_AND_WORD = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)\s*([A-Za-z\u00b5\u03bc][\w/]*)")

#: How a unit is called within a formula: `in` is a word of Python's grammar.
_CALLED = {unit: f"unit_{unit}" for unit in (*LENGTHS, *ANGLES)}


def function_of(text: str) -> Callable[[Floats], Floats]:
    """The function of x that a text writes down; NaN or infinite where it has no value.

    Numbers, x, pi, e, + - * / ^ (or **), brackets and the functions of `FUNCTIONS`; angles are in radians,
    except those of sind, cosd and tand. Raises `RequestError` for anything else.

        >>> function_of("x^2 + 1")(np.array([0.0, 2.0])).tolist()
        [1.0, 5.0]
    """
    if len(text) > LONGEST:
        raise RequestError(f"y: {len(text)} characters are too long; give a function of at most {LONGEST}")
    try:
        body = _parsed(
            text, {"x": None, **CONSTANTS, **{_CALLED[unit]: size for unit, size in ANGLES.items()}}
        )
    except _WrongFormulaError as error:
        raise RequestError(
            f"y: {shown(text)}: {error}; give a function of x, as in 'x^2', 'log10(x)' or 'sin(pi*x)'"
        ) from None
    return partial(_values, body)


def _values(body: ast.AST, x: Floats) -> Floats:
    """The value of a formula at each x."""
    names: dict[str, Any] = {name: np.float64(value) for name, value in CONSTANTS.items()}
    names |= {_CALLED[unit]: np.float64(size) for unit, size in ANGLES.items()}
    names["x"] = np.asarray(x, dtype=float)
    with np.errstate(all="ignore"):
        value = _value(
            body, names, lambda sign, *sides: OPERATORS[sign](*sides), lambda name, x: FUNCTIONS[name](x)
        )
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), np.shape(x)))


#: What a dimension is: it says which unit its formula may have, and what a formula without one means.
Kind = Literal["length", "angle", "number"]


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
    sizes = length_sizes(length_unit)
    names = {name: _Amount(value, turns=name == "pi") for name, value in CONSTANTS.items()}
    names |= {_CALLED[unit]: _Amount(size, length=Fraction(1)) for unit, size in sizes.items()}
    # angles are carried in the file's own unit, so that what is written in it stays as it is
    own = ANGLES[angle_unit]
    for unit, size in ANGLES.items():
        same = unit == angle_unit
        names[_CALLED[unit]] = _Amount(1.0 if same else size / own, angle=1, turns=not same)
    try:
        body = _parsed(text, names)
        with np.errstate(all="ignore"):
            found = _value(body, names, partial(_operated, own=own), partial(_applied, own=own))
        number = _fitting(found, kind, own)
    except _WrongFormulaError as error:
        remedy = "" if "; " in str(error) else f"; give {_EXAMPLES[kind]}"
        raise RequestError(f"{shown(text)}: {error}{remedy}") from None
    if not math.isfinite(number):
        raise RequestError(f"{shown(text)} has no finite value; give {_EXAMPLES[kind]}")
    return number


#: What a dimension may look like, for messages.
_EXAMPLES: Mapping[Kind, str] = {
    "length": "a length, as in 250, '25 cm' or '50*sin(30deg)'",
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


class _WrongFormulaError(Exception):
    """What is wrong in a formula."""


def _parsed(text: str, names: Mapping[str, object]) -> ast.AST:
    """The tree of a formula, with no other part than those allowed."""
    plain = text.strip().translate(_SIGNS).replace("^", "**")
    plain = _NUMBER_AND_UNIT.sub(lambda match: f"({match[1]}*{_CALLED[match[2]]})", plain)
    plain = _UNIT_ALONE.sub(lambda match: f"*{_CALLED[match[1] or match[2]]}", plain)
    try:
        body = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _WrongFormulaError(_why_no_formula(plain)) from None
    _check(body, names)
    return body


def _why_no_formula(plain: str) -> str:
    """What is wrong with a text that cannot be parsed: often a word after a number."""
    word = _NUMBER_AND_WORD.search(plain)
    if word is None:
        return "it is not a formula"
    if word[1] in (*FUNCTIONS, *CONSTANTS):
        return f"there is no sign before {shown(word[1])}; write *, as in 2*{word[1]}"
    return unknown_unit(word[1], (*LENGTHS, *ANGLES))


def _check(node: ast.AST, names: Mapping[str, object]) -> None:
    """Raises `_WrongFormulaError` for a part of a formula that is none of the allowed ones."""
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float()):
            return
        case ast.Name(id=name):
            if name in names:
                return
            word = name.removeprefix("unit_")
            if "x" not in names:
                raise _WrongFormulaError(f"no {shown(word)} is known")
            raise _WrongFormulaError(
                f"no {shown(word)} is known; {suggestion(word, ['x', *CONSTANTS, *FUNCTIONS])}".rstrip("; ")
            )
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            _check(left, names)
            _check(right, names)
            return
        case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
            _check(operand, names)
            return
        case ast.Call(func=ast.Name(id=name), args=args, keywords=keywords):
            if name not in FUNCTIONS:
                near = suggestion(name, FUNCTIONS).removesuffix("? ")
                raise _WrongFormulaError(
                    f"no function {shown(name)} is known" + (f", {near}?" if near else "")
                )
            if len(args) != 1 or keywords:
                raise _WrongFormulaError(f"{name} takes one value")
            _check(args[0], names)
            return
        case ast.Tuple():
            raise _WrongFormulaError("it has a comma; write a decimal point, as in 0.5")
    own = "x, " if "x" in names else ""
    raise _WrongFormulaError(f"it holds more than numbers, {own}+ - * / ^, brackets and known functions")


def _value(
    node: ast.AST,
    names: Mapping[str, Any],
    operate: Callable[..., Any],
    apply: Callable[[str, Any], Any],
) -> Any:
    """The value of a formula that was checked: of its names, by these operators and functions."""
    match node:
        case ast.Constant(value=value) if isinstance(value, int | float):
            number = np.float64(value) if abs(value) < 1e300 else np.float64(math.inf)
            return operate(ast.UAdd, number)
        case ast.Name(id=name):
            return names[name]
        case ast.BinOp(left=left, op=op, right=right):
            sides = (_value(side, names, operate, apply) for side in (left, right))
            return operate(type(op), *sides)
        case ast.UnaryOp(op=op, operand=operand):
            return operate(type(op), _value(operand, names, operate, apply))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            return apply(name, _value(argument, names, operate, apply))
    raise AssertionError(node)


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
            raise _WrongFormulaError(f"it {verb} {first.what} and {second.what}; give each its unit")
        length, angle = first.length, first.angle
        mixed |= first.plain and first.turns != second.turns and 0.0 not in (first.number, second.number)
    elif sign is ast.Pow:
        if not second.plain:
            raise _WrongFormulaError(f"{second.what} is no exponent; give a number without a unit")
        power = Fraction(second.number).limit_denominator(12) if abs(second.number) < 100 else Fraction(0)
        if not first.plain and float(power) != second.number:
            raise _WrongFormulaError(
                f"{first.what} to the power {second.number:g} has no unit; give a whole exponent"
            )
        length, turned = first.length * power, first.angle * power
        if turned.denominator != 1:
            raise _WrongFormulaError("the root of an angle has no unit; give a number without a unit")
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
            raise _WrongFormulaError(f"{name} of {x.what}; {unit}")
        near = 30.0 * round(degrees / 30.0) if math.isfinite(degrees) else 0.0
        exact = abs(degrees - near) <= NEAR
        return _Amount(float(OF_ANGLES[name](near) if exact else FUNCTIONS[name](math.radians(degrees))))
    if name == "abs":
        return replace(x, number=abs(x.number))
    if name == "sqrt":
        return _operated(ast.Pow, x, 0.5, own=own)
    if not x.plain:
        raise _WrongFormulaError(f"{name} of {x.what}; give a number without a unit")
    number = float(FUNCTIONS[name](np.float64(x.number)))
    return _Amount(number / own, angle=1, turns=True) if name in TO_ANGLES else _Amount(number)


def _fitting(found: Any, kind: Kind, own: float) -> float:
    """The number of an amount that has the unit of its dimension, or none."""
    amount = found if isinstance(found, _Amount) else _Amount(float(found))
    number = float(amount.number)
    if kind == "angle" and amount.plain and amount.mixed:
        raise _WrongFormulaError(
            "it adds a number of pi and another; give each its unit, as in 'pi/3 rad + 5deg'"
        )
    if kind == "angle" and amount.turns and amount.plain:
        amount = _Amount(number / own, angle=1, turns=True)
    wanted = {"length": (1, 0), "angle": (0, 1), "number": (0, 0)}[kind]
    if not amount.plain and not amount.has(*wanted):
        belongs = {"length": "a length", "angle": "an angle", "number": "a number without a unit"}[kind]
        raise _WrongFormulaError(f"is {amount.what} where {belongs} belongs")
    # 60, not 59.99999999999999, of pi/3
    short = float(f"{amount.number:.13g}")
    return short if amount.turns and abs(short - amount.number) <= 2e-15 * abs(short) else amount.number
