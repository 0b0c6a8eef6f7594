"""Formulas as people write them: "x^2", "pi/2", "sin(90deg)"; read, never run as code.

This is the one reader: of functions of x, whose angles are plain numbers in radians, and, by `amounts`, of
the numbers of dimensions, whose units are checked.
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.text.units import ANGLES, LENGTHS, unknown_unit

Floats = npt.NDArray[np.float64]

#: Longest text of a formula; a parser's depth is bounded with it.
LONGEST = 200

#: An angle this near [deg] to a multiple of 30 deg is meant to be one: its sine and cosine are exact there.
NEAR = 1e-12


def sind(degrees: Any) -> Any:
    """The sine of an angle in degrees, exact at multiples of 30."""
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


#: Functions of an angle in radians, and those of one in degrees by what they are.
TRIGONOMETRIC: dict[str, Callable[[Any], Any]] = {"sin": np.sin, "cos": np.cos, "tan": np.tan}
IN_DEGREES = {f"{name}d": name for name in TRIGONOMETRIC}

FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    **TRIGONOMETRIC,
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

#: Signs of print and of other languages.
_SIGNS = str.maketrans({"\u00b7": "*", "\u00d7": "*", "\u2212": "-", "\u03c0": "pi", "\u00b0": "deg"})

#: A unit, with the number that it follows without a blank: `2/3cm` is two divided by 3 cm, `2/3 cm` is not.
_UNIT = "|".join(sorted((*LENGTHS, *ANGLES), key=len, reverse=True))
_NUMBER_AND_UNIT = re.compile(rf"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)({_UNIT})(?![\w.(])")
_UNIT_ALONE = re.compile(rf"(?<=[\w.)])\s*(?<![\w.])({_UNIT})(?![\w.(])|(?<=\))({_UNIT})(?![\w.(])")

#: A word after a number, which is none of its units.
_NUMBER_AND_WORD = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)\s*([A-Za-z\u00b5\u03bc][\w/]*)")

#: What Python's parser may have a remark on: a word right after a number, a backslash.
_REMARKED = re.compile(r"\d[A-Za-z]|\\")

#: Numbers of programs, not of people: `0x10`, `1_000`.
_NOT_DECIMAL = re.compile(r"(?<![\w.])0[xXoObB]\w|\d_\d")

#: How a unit is called within a formula: `in` is a word of Python's grammar.
CALLED = {unit: f"unit_{unit}" for unit in (*LENGTHS, *ANGLES)}


def function_of(text: str) -> Callable[[Floats], Floats]:
    """The function of x that a text writes down; NaN or infinite where it has no value.

    Numbers, x, pi, e, + - * / ^ (or **), brackets and the functions of `FUNCTIONS`; angles are in radians,
    or have a unit as in 30deg, and sind, cosd and tand take degrees. Raises `RequestError` for anything else.

        >>> function_of("x^2 + 1")(np.array([0.0, 2.0])).tolist()
        [1.0, 5.0]
    """
    return partial(_values, _of_x(text))


def constant_of(text: str) -> float | None:
    """The number that a formula without x writes down, angles in radians; `None` for what is no finite one.

    >>> constant_of("90deg"), constant_of("pi/2"), constant_of("2*x")
    (1.5707963267948966, 1.5707963267948966, None)
    """
    try:
        body = _of_x(text)
    except RequestError:
        return None
    if _holds_x(body):
        return None
    value = float(_values(body, np.zeros(())))
    return value if math.isfinite(value) else None


def calls_in(text: str) -> frozenset[str]:
    """The functions that a formula calls."""
    return frozenset(ast.unparse(node.func) for node in _calls(_of_x(text)))


def greatest_angle(text: str, x: Floats) -> tuple[str, str, float] | None:
    """The sine, cosine or tangent of x whose argument is greatest over values of x: name, argument, its size.

    `None` where a formula has none of them.

        >>> greatest_angle("sin(x) + cos(2*x)", np.array([0.0, 90.0]))
        ('cos', '2 * x', 180.0)
    """
    result = []
    for node in _calls(_of_x(text)):
        name, argument = ast.unparse(node.func), node.args[0]
        if name in TRIGONOMETRIC and _holds_x(argument):
            size = float(np.abs(np.nan_to_num(_values(argument, x))).max())
            result.append((name, ast.unparse(argument).replace("unit_", ""), size))
    return max(result, key=lambda one: one[2], default=None)


def _calls(body: ast.AST) -> list[ast.Call]:
    return [node for node in ast.walk(body) if isinstance(node, ast.Call)]


def _holds_x(body: ast.AST) -> bool:
    return any(isinstance(node, ast.Name) and node.id == "x" for node in ast.walk(body))


def _of_x(text: str) -> ast.AST:
    """A formula of x that was checked; raises `RequestError`."""
    if len(text) > LONGEST:
        raise RequestError(f"y: {len(text)} characters are too long; give a function of at most {LONGEST}")
    try:
        return parsed(text, ("x", *CONSTANTS, *(CALLED[unit] for unit in ANGLES)))
    except WrongFormulaError as error:
        raise RequestError(
            f"y: {shown(text)}: {error}; give a function of x, as in 'x^2', 'log10(x)' or 'sin(pi*x)'"
        ) from None


def _values(body: ast.AST, x: Floats) -> Floats:
    """The value of a formula at each x."""
    names: dict[str, Any] = {name: np.float64(value) for name, value in CONSTANTS.items()}
    names |= {CALLED[unit]: np.float64(size) for unit, size in ANGLES.items()}
    names["x"] = np.asarray(x, dtype=float)
    with np.errstate(all="ignore"):
        value = evaluated(
            body, names, lambda sign, *sides: OPERATORS[sign](*sides), lambda name, x: FUNCTIONS[name](x)
        )
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), np.shape(x)))


class WrongFormulaError(Exception):
    """What is wrong in a formula."""


def parsed(text: str, names: Collection[str]) -> ast.AST:
    """The tree of a formula, with no other part than those allowed."""
    plain = text.strip().translate(_SIGNS).replace("^", "**")
    if number := _NOT_DECIMAL.search(plain):
        raise WrongFormulaError(f"{shown(number[0])} begins no decimal number; write one, as in 16 or 1000")
    plain = _NUMBER_AND_UNIT.sub(lambda match: f"({match[1]}*{CALLED[match[2]]})", plain)
    plain = _UNIT_ALONE.sub(lambda match: f"*{CALLED[match[1] or match[2]]}", plain)
    try:
        with _quiet_parser(plain):
            body = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise WrongFormulaError(_why_no_formula(plain)) from None
    _check(body, names)
    return body


@contextmanager
def _quiet_parser(plain: str) -> Iterator[None]:
    """Parses without Python's own remarks on texts that hardly are formulas, as `1if`: they name no file."""
    if not _REMARKED.search(plain):
        yield
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def _why_no_formula(plain: str) -> str:
    """What is wrong with a text that cannot be parsed: often a word after a number."""
    word = _NUMBER_AND_WORD.search(plain)
    if word is None:
        return "it is not a formula"
    if word[1] in (*FUNCTIONS, *CONSTANTS):
        return f"there is no sign before {shown(word[1])}; write *, as in 2*{word[1]}"
    return unknown_unit(word[1], (*LENGTHS, *ANGLES))


def _check(node: ast.AST, names: Collection[str]) -> None:
    """Raises `WrongFormulaError` for a part of a formula that is none of the allowed ones."""
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
                raise WrongFormulaError(f"no {shown(word)} is known")
            raise WrongFormulaError(
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
                raise WrongFormulaError(
                    f"no function {shown(name)} is known" + (f", {near}?" if near else "")
                )
            if len(args) != 1 or keywords:
                raise WrongFormulaError(f"{name} takes one value")
            _check(args[0], names)
            return
        case ast.Tuple():
            raise WrongFormulaError("it has a comma; write a decimal point, as in 0.5")
    own = "x, " if "x" in names else ""
    raise WrongFormulaError(f"it holds more than numbers, {own}+ - * / ^, brackets and known functions")


def evaluated(
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
            sides = (evaluated(side, names, operate, apply) for side in (left, right))
            return operate(type(op), *sides)
        case ast.UnaryOp(op=op, operand=operand):
            return operate(type(op), evaluated(operand, names, operate, apply))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            return apply(name, evaluated(argument, names, operate, apply))
    raise AssertionError(node)
