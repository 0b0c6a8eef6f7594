"""Numbers and arrays that callers give: finite reals, or one clear message."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sized
from numbers import Real
from types import MappingProxyType
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt

from sevenbar.errors import RequestError, shown

#: An array of real numbers; each docstring says of what shape and unit.
Floats = npt.NDArray[np.float64]

#: An array of whole numbers: indices, counts.
Integers = npt.NDArray[np.int64]

#: An array of truth values.
Booleans = npt.NDArray[np.bool_]

#: An array of words, such as the status of each row.
Words = npt.NDArray[np.str_]


#: An angle [rad] short of a full turn by less is zero.
ROUNDING = 1e-12


class ReadOnly:
    """A result whose arrays cannot be written, nor those of its copies: they are what was computed."""

    def __post_init__(self) -> None:
        for value in self.__dict__.values():
            # some results take no longer than to recognise an abstract Mapping, or to read an argument's name
            kind = type(value)
            if kind is np.ndarray:
                value.setflags(False)
            elif kind is dict or kind is MappingProxyType:
                for array in value.values():
                    if type(array) is np.ndarray:
                        array.setflags(False)  # type: ignore[call-arg]

    def __setstate__(self, state: dict[str, Any]) -> None:
        # arrays come out of a pickle, and out of a deep copy, as writable ones
        self.__dict__.update(state)
        ReadOnly.__post_init__(self)


def finite_array(name: str, values: npt.ArrayLike) -> Floats:
    """A one-dimensional array of finite numbers, or `RequestError` naming the first that is none."""
    array = real_array(name, values)
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise RequestError(f"{name}[{bad[0]}]: {array[bad[0]]} is not a finite number; give a finite one")
    return array


def spread_array(name: str, values: npt.ArrayLike, count: int, whose: str) -> Floats:
    """Finite numbers (count,), from as many as `whose` or from one for all, or `RequestError`."""
    array = finite_array(name, values)
    if array.size not in (1, count):
        raise RequestError(
            f"{name}: {array.size} values where {whose} has {count}; give {count}, or one number"
        )
    return np.broadcast_to(array, (count,))


def triple(name: str, values: npt.ArrayLike) -> tuple[float, float, float]:
    """Three finite numbers, or `RequestError`."""
    if isinstance(values, tuple) and [*map(type, values)] == [float] * 3 and all(map(math.isfinite, values)):
        return values
    array = finite_array(name, values)
    if array.size != 3:
        raise RequestError(f"{name}: {array.size} numbers; give three")
    return float(array[0]), float(array[1]), float(array[2])


def place_of_link(name: str, values: npt.ArrayLike) -> tuple[float, float, float]:
    """Three finite numbers that are a place on a link as its points are written, or `RequestError`."""
    array = finite_array(name, values)
    if array.size == 2:
        raise RequestError(
            f"{name}: 2 numbers; give three, as points are written in files: places of the drawing where "
            "joints are drawn, as by slider_crank; (0, u, v) in rows, as of four_bar"
        )
    return triple(name, array)


def finite_number(name: str, value: npt.ArrayLike) -> float:
    """One finite number, or `RequestError`."""
    if isinstance(value, float) and math.isfinite(value):
        return float(value)
    array = real_array(name, value)
    if array.size != 1:
        raise RequestError(f"{name}: {array.size} values where one belongs; give one number")
    number = float(array[0])
    if not math.isfinite(number):
        raise RequestError(f"{name}: {number} is not a finite number; give a finite one")
    return number


def positive_length(name: str, value: npt.ArrayLike) -> float:
    """One finite number greater than 0, or `RequestError`."""
    number = finite_number(name, value)
    if number <= 0:
        raise RequestError(f"{name}: {number:g} is not a length; give a number > 0")
    return number


def real_array(name: str, values: npt.ArrayLike) -> Floats:
    """A one-dimensional array of real numbers, finite or not, or `RequestError`; a number is an array of one.

    NumPy alone would take texts, truth values and `None` for numbers.
    """
    try:
        given = np.asarray(values)
        array = np.ascontiguousarray(given, dtype=np.float64) if _is_real(given) else None
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        wanted = (
            "an array of numbers" if isinstance(values, Sized) and not isinstance(values, str) else "a number"
        )
        raise RequestError(f"{name}: {shown(values)} is not {wanted}; give {wanted}")
    if given.ndim > 1:
        raise RequestError(f"{name}: an array of shape {given.shape} does not fit; give one dimension")
    return array


def places_array(name: str, values: npt.ArrayLike) -> Floats:
    """Places (..., 3), numbers or NaN, or `RequestError`."""
    try:
        given = np.asarray(values)
        array = given.astype(np.float64) if given.shape[-1:] == (3,) and _is_real(given) else None
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        raise RequestError(f"{name}: {shown(values)} is no array of places; give three numbers for each")
    return array


def truth(name: str, value: object) -> bool:
    """Whether a switch is on, or `RequestError` for what is neither on nor off."""
    try:
        return bool(value)
    except (TypeError, ValueError):
        raise RequestError(f"{name}: {shown(value)} is neither true nor false; give one of them") from None


def whole_number(name: str, value: object, low: int, high: int | None, what: str, hint: str = "") -> int:
    """A whole number within bounds, or `RequestError` saying that it is not `what`.

    >>> whole_number("circuit", np.int64(1), 0, 3, "a circuit")
    1
    """
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or not low <= value or not (high is None or value <= high):  # type: ignore[operator]
        allowed = f"{low} or more" if high is None else f"{low} to {high}" if low < high else f"{low}"
        raise RequestError(f"{name}: {shown(value)} is not {what}; give {allowed}{hint}")
    return int(value)  # type: ignore[call-overload, no-any-return]


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is one real number; truth values are none."""
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def counted(words: Words) -> dict[str, int]:
    """How often each word is there, by the words in order of the alphabet.

    >>> counted(np.array(["ok", "dead-centre", "ok"]))
    {'dead-centre': 1, 'ok': 2}
    """
    # the usual case, several times as quick
    if len(words) and (words == words[0]).all():
        return {str(words[0]): len(words)}
    return dict(sorted(Counter(words.tolist()).items()))


def within_turn(angles: npt.ArrayLike) -> Floats:
    """Angles [rad] in [0, 2 pi); what is short of a full turn by rounding is 0.

    >>> within_turn([-math.pi / 2, -1e-17]).round(4).tolist()
    [4.7124, 0.0]
    """
    within = np.mod(np.asarray(angles, dtype=np.float64), math.tau)
    return np.where(within > math.tau - ROUNDING, 0.0, within)


def short_way(angles: npt.ArrayLike) -> Floats:
    """Angles [rad] by the short way round, in [-pi, pi): `(a + pi) mod 2 pi - pi`.

    >>> short_way([-math.pi, 0.0, 1.5 * math.pi]).round(4).tolist()
    [-3.1416, 0.0, -1.5708]
    """
    return np.asarray(np.remainder(np.asarray(angles, dtype=np.float64) + math.pi, math.tau) - math.pi)


def _is_real(array: npt.NDArray[Any]) -> bool:
    # integers beyond 64 bits come as objects, as do a caller's own kinds of numbers
    if array.dtype.kind != "O":
        return array.dtype.kind in "iuf"
    # few callers have them
    from decimal import Decimal

    return all(isinstance(x, Real | Decimal) and not isinstance(x, bool) for x in array.flat)
