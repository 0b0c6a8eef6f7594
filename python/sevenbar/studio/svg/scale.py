"""A scale of a curve: its range, where its ticks stand, and how its numbers are written."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from itertools import count as counting
from typing import Final

from sevenbar.drawing.ticks import DEGREE_STEPS

#: Numbers outside this range are written by a power of ten at the axis.
PLAIN: Final = (1e-2, 1e5)

#: From here on a number is far beyond its axis, and written by three digits and a power of ten.
LONGEST = 1e6

#: A tick so little beyond an end, as a part of the range, is on the end: rounding takes none off.
ON_END: Final = 1e-9

#: A number this near to a whole one, as a part of itself, is whole, apart from rounding.
WHOLE: Final = 1e-6

#: A power of ten as it is written.
EXPONENTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """A range, the step of its ticks, and the power of ten its numbers are written by."""

    low: float
    high: float
    step: float
    power: int

    @property
    def ticks(self) -> tuple[float, ...]:
        """The multiples of the step within the range."""
        return tuple(i * self.step for i in self._multiples)

    @property
    def count(self) -> int:
        """How many ticks there are."""
        return len(self._multiples)

    @property
    def _multiples(self) -> range:
        slack = ON_END * (self.high - self.low)
        first = math.ceil((self.low - slack) / self.step)
        return range(first, math.floor((self.high + slack) / self.step) + 1)

    def word(self, value: float) -> str:
        """A value as it is written at a tick."""
        # the fewest digits by which the step is written whole
        shifted = (self.step / 10.0**self.power * 10**digits for digits in counting())
        needed = next(digits for digits, step in enumerate(shifted) if abs(step - round(step)) < WHOLE * step)
        return self._written(value, needed)

    def reading(self, value: float, unit: str) -> str:
        """A value with its unit, to about a thousandth of the range."""
        word = self._written(value, self.power + math.ceil(3.0 - math.log10(self.high - self.low)))
        if unit == "deg" and not self.power:
            return f"{word}°"
        return f"{word}{'·' if self.power else ' '}{self.unit(unit)}"

    def _written(self, value: float, digits: int) -> str:
        scaled, digits = value / 10.0**self.power, max(0, digits)
        # adding zero takes the sign off a zero
        word = f"{round(scaled, digits) + 0.0:.{digits}f}" if abs(scaled) < LONGEST else f"{scaled:.3g}"
        return word.replace("-", "−")

    def unit(self, unit: str) -> str:
        """The unit with the power of ten."""
        return f"10{str(self.power).translate(EXPONENTS)} {unit}" if self.power else unit


def scale(low: float, high: float, most: int, *, degrees: bool = False) -> Scale:
    """The scale of a range (low < high) with at most so many ticks, at round numbers."""
    needed = (high - low) / most
    tens = 10.0 ** math.floor(math.log10(needed))
    steps: Iterator[float] = (i * tens * 10**k for k in counting() for i in (1, 2, 2.5, 5))
    if degrees and needed > DEGREE_STEPS[0] / 2:
        steps = chain(DEGREE_STEPS, (360.0 * i * 10**k for k in counting() for i in (2, 5, 10)))
    # counted as they are drawn: rounding may put one more on an end
    step = next(step for step in steps if Scale(low, high, step, 0).count <= most)
    largest = max(abs(low), abs(high))
    power = 0 if PLAIN[0] <= largest < PLAIN[1] else 3 * math.floor(math.log10(largest) / 3)
    return Scale(low, high, step, power)
