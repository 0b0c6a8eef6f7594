"""What a dimension takes in a sweep: a grid, a list, or a span that is sampled."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers, whole_number
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.numbers.dimensions import Dimension, read_at
from sevenbar.text.ranges import split_grid, split_list, split_name, split_range

#: Most values of one axis that are listed: the sweep's description holds each of them.
MOST_LISTED = 1_000_000

#: Most values of one axis that are counted; beyond, neighbours would be one number.
MOST_COUNTED = 10**12

#: Two plain numbers with a dash, which people write for a range and which would be a difference.
_DIFFERENCE = re.compile(r"\s*([\d.]+)\s*[-\u2013]\s*([\d.]+)\s*([A-Za-z]*)\s*")

#: How each kind is written, for messages.
FORMS = "LOW:HIGH:COUNT, a list V1,V2,V3, or LOW..HIGH"


@dataclass(frozen=True)
class Grid:
    """`count` values evenly from `low` to `high`, both among them."""

    low: float | str
    high: float | str
    count: int


@dataclass(frozen=True)
class Span:
    """Every value from `low` to `high`, of which samples are drawn."""

    low: float | str
    high: float | str


#: What a caller gives for a dimension.
Given = Grid | Span | Sequence[float | str] | npt.NDArray[np.float64]


def grid(low: float | str, high: float | str, count: int) -> Grid:
    """`count` values evenly from `low` to `high`; numbers in the file's unit, or texts as "25 cm".

    >>> grid(200, "50 cm", 4)
    Grid(low=200, high='50 cm', count=4)
    """
    return Grid(low, high, count)


def span(low: float | str, high: float | str) -> Span:
    """The values from `low` to `high`, to be sampled; numbers in the file's unit, or texts as "25 cm".

    >>> span(200, 500)
    Span(low=200, high=500)
    """
    return Span(low, high)


@dataclass(frozen=True)
class SweepAxis:
    """A dimension of a sweep and its values, in the file's unit: listed, counted, or of a span.

    `listed` are its values; else they lie from `low` to `high`, `count` of them, or any where that is `None`.
    """

    dimension: Dimension
    low: float
    high: float
    count: int | None
    listed: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """The dimension's name."""
        return self.dimension.name

    def at(self, index: Integers) -> Floats:
        """The values (n,) of places on a grid or in a list."""
        if self.listed:
            return np.array(self.listed)[index]
        last = (self.count or 2) - 1
        values = self.low + (self.high - self.low) * (index / last)
        # the end exactly, whatever the rounding of the sum
        return np.where(index == last, self.high, values)

    def within(self, share: Floats) -> Floats:
        """The values (n,) for numbers in [0, 1): along a span, or one of those listed or counted."""
        if self.count is None:
            return self.low + (self.high - self.low) * share
        return self.at(np.minimum((share * self.count).astype(np.int64), self.count - 1))

    @property
    def as_dict(self) -> dict[str, object]:
        """The axis as a sweep's description holds it."""
        values: dict[str, object] = {"low": self.low, "high": self.high}
        if self.listed:
            values = {"values": list(self.listed)}
        elif self.count is not None:
            values["count"] = self.count
        own = self.dimension
        return {"name": own.name, "column": own.column, "unit": own.unit, **values}


def axis_of(dimension: Dimension, given: Given) -> SweepAxis:
    """The axis that a caller gave for a dimension.

    Raises `RequestError` for values that do not fit, an empty range, a count that is none.
    """
    name = dimension.name
    if isinstance(given, Grid | Span):
        low, high = _value(dimension, given.low), _value(dimension, given.high)
        if not low < high:
            raise RequestError(
                f"{name}: {given.low} to {given.high} is an empty range; "
                "give a low end below the high one, or one value"
            )
        if not math.isfinite(high - low):
            raise RequestError(f"{name}: {given.low} to {given.high} is too wide; give ends nearer together")
        _refuse_no_length(dimension, high)
        if isinstance(given, Span):
            return SweepAxis(dimension, low, high, None)
        count = whole_number(name, given.count, 2, MOST_COUNTED, "a count of values", ", or one value alone")
        return SweepAxis(dimension, low, high, count)
    if isinstance(given, str | bytes) or not hasattr(given, "__len__"):
        raise RequestError(
            f"{name}: {shown(given)} is not what a dimension takes; give grid(low, high, count), "
            "span(low, high) or a list of values"
        )
    if not 0 < len(given) <= MOST_LISTED:
        number = "no values are" if len(given) == 0 else f"{len(given)} values are"
        raise RequestError(f"{name}: {number} listed; give 1 to {MOST_LISTED}, or a grid")
    listed = tuple(_value(dimension, one) for one in given)
    _refuse_no_length(dimension, max(listed))
    return SweepAxis(dimension, min(listed), max(listed), len(listed), listed)


def _refuse_no_length(dimension: Dimension, highest: float) -> None:
    """`RequestError` where no value of a length is one."""
    if dimension.positive and highest <= 0:
        raise RequestError(
            f"over: {dimension.name}: no value is a length, the highest is {highest:g}; give values above 0"
        )


def _value(dimension: Dimension, given: object) -> float:
    """A number in the file's unit, from a number or a text with a unit."""
    if isinstance(given, str):
        return read_at("over", dimension, given)
    if isinstance(given, bool | np.bool_) or not isinstance(given, int | float | np.integer | np.floating):
        raise RequestError(
            f"{dimension.name}: {shown(given)} is not a number; give a number or a text as '25 cm'"
        )
    try:
        value = float(given)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise RequestError(f"{dimension.name}: {shown(given)} is not a finite number; give a finite one")
    return value


def axis_from_text(text: str) -> tuple[str, Grid | Span | list[str]]:
    """A dimension's name and what it takes: `L1=200:300:51`, `L3=400,450`, `M=600..800`, with units or not.

    Raises `RequestError` for a text of another form.

        >>> axis_from_text("L1=20:30cm:51")
        ('L1', Grid(low='20cm', high='30cm', count=51))
    """
    parts = split_name(text)
    if parts is None:
        raise RequestError(
            f"over: {shown(text)} names no values; give a name and {FORMS}, as in L1=200:300:51"
        )
    name, values = parts
    if ".." in values:
        if ends := split_range(values):
            return name, Span(*ends)
    elif ":" in values:
        if points := split_grid(values):
            return name, Grid(*points)
    elif listed := split_list(values):
        if difference := _DIFFERENCE.fullmatch(values):
            low, high, unit = difference.groups()
            raise RequestError(
                f"over: {shown(text)} is {low} less {high}; a range is written {name}={low}..{high}{unit}, "
                f"or {name}={low}:{high}{unit}:31 for 31 values of it"
            )
        return name, listed
    raise RequestError(f"over: {shown(text)} is not read; give {name}={FORMS}, as in {name}=200:300:51")
