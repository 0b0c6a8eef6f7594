"""What a formula of x takes for angles, and formulas without x: the ends of a range."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from sevenbar.errors import RequestError
from sevenbar.text.expression import function_of

#: Functions of an angle in degrees, and what they are called where it is in radians.
IN_DEGREES = {"sind": "sin", "cosd": "cos", "tand": "tan"}

_CALL = re.compile(r"\b([A-Za-z]\w*)\s*\(")
_X = re.compile(r"(?<![\w.])x\b")


def number_of(text: str) -> float | None:
    """The number that a formula without x writes down, angles in radians; `None` for what is no finite one.

    >>> number_of("90deg"), number_of("pi/2"), number_of("2*x")
    (1.5707963267948966, 1.5707963267948966, None)
    """
    if _X.search(text):
        return None
    try:
        value = float(function_of(text)(np.zeros(())))
    except RequestError:
        return None
    return value if math.isfinite(value) else None


def calls_in(text: str) -> frozenset[str]:
    """The names of the functions that a formula calls."""
    return frozenset(_CALL.findall(text))


def greatest_angle(text: str, x: npt.NDArray[np.float64]) -> tuple[str, str, float] | None:
    """The sine, cosine or tangent of x whose argument is greatest over values of x: name, argument, its size.

    `None` where a formula has none of them that takes radians.

        >>> greatest_angle("sin(x) + cos(2*x)", np.array([0.0, 90.0]))
        ('cos', '2*x', 180.0)
    """
    found = []
    for name, argument in _arguments(text):
        if name in IN_DEGREES.values() and _X.search(argument):
            sizes = np.abs(np.nan_to_num(function_of(argument)(x)))
            found.append((name, argument, float(sizes.max())))
    return max(found, key=lambda one: one[2], default=None)


def _arguments(text: str) -> Iterator[tuple[str, str]]:
    """Each function that a formula calls, with the text between its brackets."""
    for call in _CALL.finditer(text):
        depth, end = 1, call.end()
        while depth and end < len(text):
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        yield call[1], text[call.end() : end - 1].strip()
