"""Formulas as people write them: "x^2", "sin(pi*x)/2", "pi/2", "90deg"; read, never run as code."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.text.units import ANGLES

#: Longest text of a function; a parser's depth is bounded with it.
LONGEST = 200

Floats = npt.NDArray[np.float64]

#: Functions of an angle in radians, and those of one in degrees.
TRIGONOMETRIC: dict[str, Callable[[Any], Any]] = {"sin": np.sin, "cos": np.cos, "tan": np.tan}
IN_DEGREES = {f"{name}d": name for name in TRIGONOMETRIC}

FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    **TRIGONOMETRIC,
    "sind": lambda x: _in_degrees(np.sin, x, 0.0),
    "cosd": lambda x: _in_degrees(np.cos, x, 90.0),
    "tand": lambda x: _in_degrees(np.sin, x, 0.0) / _in_degrees(np.cos, x, 90.0),
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


#: A number with an angle unit, as in 90deg.
_ANGLE = re.compile(r"(?<![\w.])(\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)\s*(" + "|".join(ANGLES) + r")\b")


def _in_degrees(function: Callable[[Any], Any], x: Any, zero: float) -> Any:
    """A sine or cosine of degrees, exactly 0 at its zeros, half turns from `zero`."""
    return np.where((np.asarray(x) - zero) % 180.0 == 0.0, 0.0, function(np.radians(x)))


def function_of(text: str) -> Callable[[Floats], Floats]:
    """The function of x that a text writes down; NaN or infinite where it has no value.

    Numbers, x, pi, e, + - * / ^ (or **), brackets and the functions of `FUNCTIONS`; angles are in radians, or
    have a unit as in 30deg, and sind, cosd and tand take degrees. Raises `RequestError` for anything else.

        >>> function_of("x^2 + 1")(np.array([0.0, 2.0])).tolist()
        [1.0, 5.0]
    """
    return partial(_values, _parsed(text))


def number_of(text: str) -> float | None:
    """The number that a formula without x writes down, angles in radians; `None` for what is no finite one.

    >>> number_of("90deg"), number_of("pi/2"), number_of("2*x")
    (1.5707963267948966, 1.5707963267948966, None)
    """
    try:
        body = _parsed(text)
    except RequestError:
        return None
    if _holds_x(body):
        return None
    value = float(_values(body, np.zeros(())))
    return value if math.isfinite(value) else None


def calls_in(text: str) -> frozenset[str]:
    """The functions that a formula calls."""
    return frozenset(ast.unparse(node.func) for node in _calls(_parsed(text)))


def greatest_angle(text: str, x: Floats) -> tuple[str, str, float] | None:
    """The sine, cosine or tangent of x whose argument is greatest over values of x: name, argument, its size.

    `None` where a formula has none of them.

        >>> greatest_angle("sin(x) + cos(2*x)", np.array([0.0, 90.0]))
        ('cos', '2 * x', 180.0)
    """
    found = []
    for node in _calls(_parsed(text)):
        name, argument = ast.unparse(node.func), node.args[0]
        if name in TRIGONOMETRIC and _holds_x(argument):
            size = float(np.abs(np.nan_to_num(_values(argument, x))).max())
            found.append((name, ast.unparse(argument), size))
    return max(found, key=lambda one: one[2], default=None)


def _calls(body: ast.AST) -> list[ast.Call]:
    return [node for node in ast.walk(body) if isinstance(node, ast.Call)]


def _holds_x(body: ast.AST) -> bool:
    return any(isinstance(node, ast.Name) and node.id == "x" for node in ast.walk(body))


def _parsed(text: str) -> ast.AST:
    """A formula that was checked."""
    if len(text) > LONGEST:
        raise RequestError(f"y: {len(text)} characters are too long; give a function of at most {LONGEST}")
    # "90deg" is a product, and binds as a number does
    plain = _ANGLE.sub(lambda match: f"({match[1]}*{ANGLES[match[2]]!r})", text.replace("\u00b0", "deg"))
    try:
        body = ast.parse(plain.strip().replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _not_understood(text, "it is not a formula") from None
    _look_at(body, text)
    return body


def _values(body: ast.AST, x: Floats) -> Floats:
    """The value of a formula at each x."""
    with np.errstate(all="ignore"):
        value = _value(body, np.asarray(x, dtype=float))
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), np.shape(x)))


def _not_understood(text: str, why: str) -> RequestError:
    return RequestError(
        f"y: {shown(text)}: {why}; give a function of x, as in 'x^2', 'log10(x)' or 'sin(pi*x)'"
    )


def _look_at(node: ast.AST, text: str) -> None:
    """Raises `RequestError` for a part of a formula that is none of the allowed ones."""
    if (
        isinstance(node, ast.Constant)
        and isinstance(node.value, (int, float))
        and not isinstance(node.value, bool)
    ):
        return
    if isinstance(node, ast.Name):
        if node.id not in ("x", *CONSTANTS):
            known = ["x", *CONSTANTS, *FUNCTIONS]
            raise _not_understood(
                text, f"no {shown(node.id)} is known; {suggestion(node.id, known)}".rstrip("; ")
            )
        return
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        _look_at(node.left, text)
        _look_at(node.right, text)
        return
    if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
        _look_at(node.operand, text)
        return
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        if node.func.id not in FUNCTIONS:
            near = suggestion(node.func.id, FUNCTIONS).removesuffix("? ")
            why = f"no function {shown(node.func.id)} is known" + (f", {near}?" if near else "")
            raise _not_understood(text, why)
        if len(node.args) != 1 or node.keywords:
            raise _not_understood(text, f"{node.func.id} takes one value")
        _look_at(node.args[0], text)
        return
    raise _not_understood(text, "it holds more than numbers, x, + - * / ^, brackets and known functions")


def _value(node: ast.AST, x: Floats) -> Any:
    """The value of a formula that was looked at."""
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return np.float64(node.value) if abs(node.value) < 1e300 else np.float64(math.inf)
    if isinstance(node, ast.Name):
        return x if node.id == "x" else np.float64(CONSTANTS[node.id])
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](_value(node.left, x), _value(node.right, x))
    if isinstance(node, ast.UnaryOp):
        return OPERATORS[type(node.op)](_value(node.operand, x))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return FUNCTIONS[node.func.id](_value(node.args[0], x))
    raise AssertionError(node)
