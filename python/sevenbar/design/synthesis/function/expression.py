"""A function of one variable as people write it: "x^2", "sin(pi*x)/2"; read, never run as code."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, shown, suggestion

#: Longest text of a function; a parser's depth is bounded with it.
LONGEST = 200

FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
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


def function_of(text: str) -> Callable[[Floats], Floats]:
    """The function of x that a text writes down; NaN or infinite where it has no value.

    Numbers, x, pi, e, + - * / ^ (or **), brackets and the functions of `FUNCTIONS`; angles are in radians.
    Raises `RequestError` for anything else.

        >>> function_of("x^2 + 1")(np.array([0.0, 2.0])).tolist()
        [1.0, 5.0]
    """
    if len(text) > LONGEST:
        raise RequestError(f"y: {len(text)} characters are too long; give a function of at most {LONGEST}")
    try:
        body = ast.parse(text.strip().replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _not_understood(text, "it is not a formula") from None
    _look_at(body, text)
    return partial(_values, body)


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
