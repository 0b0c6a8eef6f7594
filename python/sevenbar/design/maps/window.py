"""The window of a map: two dimensions of a description and the range of each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.loop.single import check_single
from sevenbar.kinematics.numbers.dimensions import Dimension, check_apart, read_at
from sevenbar.text.ranges import split_grid, split_named, split_range

#: The form of a range, for messages.
EXAMPLE = "as in 'L1=100:400' or 'L1=10:40cm'"

#: A range narrower than this share of its values is lost in their rounding.
NARROWEST = 1e-9


@dataclass(frozen=True)
class MapAxis:
    """A dimension and its range, `low` < `high` [the dimension's unit]."""

    dimension: Dimension
    low: float
    high: float

    @property
    def name(self) -> str:
        """The dimension's name."""
        return self.dimension.name

    @property
    def span(self) -> float:
        """The length of the range [the dimension's unit]."""
        return self.high - self.low

    def value(self, share: Floats | float) -> Floats:
        """Values at shares 0 to 1 of the range."""
        return self.low + self.span * np.asarray(share, dtype=np.float64)

    def share(self, value: Floats | float) -> Floats:
        """Where values lie in the range, 0 at its low end and 1 at its high one."""
        return (np.asarray(value, dtype=np.float64) - self.low) / self.span

    @property
    def label(self) -> str:
        """Its name and unit, as on the axis of a figure."""
        return f"{self.name} [{self.dimension.unit}]" if self.dimension.unit else self.name

    def text(self, value: float, digits: int = 6) -> str:
        """A value with its unit, for people."""
        unit = f" {self.dimension.unit}" if self.dimension.unit else ""
        return f"{value:.{digits}g}{unit}"


Range = str | Sequence[float]


def split_ranges(given: Sequence[str]) -> dict[str, str]:
    """Ranges by dimension from words like 'L1=100:400'; raises `RequestError` for another form."""
    return split_named("over", given, "a range of a dimension", f"give NAME=LOW:HIGH, {EXAMPLE}")


def axes_of(draft: Draft, over: Mapping[str, Range]) -> tuple[MapAxis, MapAxis]:
    """The two axes of a map, the first along x.

    `over` has a range for each of two dimensions of the draft: two numbers in the dimension's unit, or a text
    LOW:HIGH with units. Raises `RequestError` for unknown names, and ranges that are empty, endless or not
    allowed.
    """
    if len(over) != 2:
        count = f"{len(over)} dimension{'s' * (len(over) != 1)}"
        raise RequestError(
            f"over: {count} given where a map has two; give a range for each of two, {EXAMPLE}"
        )
    check_single(draft.linkage)
    first, second = (_axis(draft.dimension(name), span) for name, span in over.items())
    check_apart("over", (first.dimension, second.dimension))
    if first.dimension.place == second.dimension.place:
        raise RequestError(f"over: {first.name} is given twice under two names; give two dimensions")
    return first, second


def _axis(dimension: Dimension, given: Range) -> MapAxis:
    where = f"over: {dimension.name}"
    if isinstance(given, str):
        ends = split_range(given)
        if ends is None:
            if grid := split_grid(given):
                raise RequestError(
                    f"{where}: {shown(given)} has a count, and a map needs none; give {grid[0]}:{grid[1]}"
                )
            raise RequestError(f"{where}: {shown(given)} is not a range; give LOW:HIGH, {EXAMPLE}")
        low, high = (read_at("over", dimension, end) for end in ends)
    else:
        try:
            low, high = (float(end) for end in given)
        except (TypeError, ValueError):
            raise RequestError(
                f"{where}: {shown(given)} is not a range; give two numbers, as in (100, 400)"
            ) from None
    text = f"{low:g}:{high:g}"
    if not (math.isfinite(low) and math.isfinite(high)):
        raise RequestError(f"{where}: {text} has no finite ends; give two finite numbers")
    if low >= high:
        what = "is empty" if low == high else "goes down"
        raise RequestError(f"{where}: {text} {what}; give LOW:HIGH with LOW < HIGH")
    if high - low < NARROWEST * max(abs(low), abs(high)):
        raise RequestError(
            f"{where}: {low!r}:{high!r} is too narrow to distinguish its values; give a wider one"
        )
    if dimension.positive and low <= 0:
        raise RequestError(f"{where}: {text} holds values that are no length; give a range above 0")
    return MapAxis(dimension, low, high)
