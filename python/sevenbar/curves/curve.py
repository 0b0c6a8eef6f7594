"""A quantity along a cycle of the input: what each kind of curve can say of it, and its greatest values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sevenbar.arrays import Floats


@dataclass(frozen=True)
class Peak:
    """A value of a quantity, and the input [rad, or length] at which it occurs."""

    value: float
    input: float


class Curve(Protocol):
    """A quantity along one cycle: a number, or a vector in the last axis."""

    @property
    def rows(self) -> Floats:
        """Its values (n,) or (n, k) at the rows from which it is made."""

    def squared(self) -> Curve:
        """The square of a number, the squared length of a vector."""

    @property
    def tail(self) -> float:
        """What may lie between the rows unseen, as a part of the greatest value; NaN where nobody knows."""

    def part(self, columns: int | tuple[int, ...]) -> Curve:
        """One column of a vector as a number, or some as a vector."""

    def extremes(self) -> tuple[Floats, Floats]:
        """Inputs and values (m,) of all local extremes of a number, in order; at jumps of both sides."""

    def highest(self) -> Peak:
        """The highest value of a number."""

    def lowest(self) -> Peak:
        """The lowest value of a number."""

    def mean_of(self, function: Callable[[Floats], Floats]) -> float:
        """The mean over the cycle of a function of the values, which takes and gives (m,)."""

    def running(self) -> Curve:
        """The integral along the cycle of a number less its mean: it ends where it begins."""


def mean(curve: Curve) -> float:
    """The mean of a number over the cycle."""
    return curve.mean_of(lambda values: values)


def greatest(curve: Curve) -> Peak:
    """The value of a number that is farthest from zero, with its sign."""
    top, bottom = curve.highest(), curve.lowest()
    return top if top.value >= -bottom.value else bottom


def highest_of(inputs: Floats, values: Floats) -> Peak:
    """The highest of values (m,) at inputs (m,)."""
    top = int(np.argmax(values))
    return Peak(float(values[top]), float(inputs[top]))
