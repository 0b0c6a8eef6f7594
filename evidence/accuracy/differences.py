"""Derivatives by differences, for references in many digits."""

from collections.abc import Sequence

from mpmath import mp


def central_differences(values: Sequence[mp.mpf], step: mp.mpf) -> list[mp.mpf]:
    """Value and three derivatives from five values a `step` apart."""
    a, b, c, d, e = values
    first = (8 * (d - b) - (e - a)) / (12 * step)
    second = (16 * (b + d) - (a + e) - 30 * c) / (12 * step**2)
    third = (e - a - 2 * (d - b)) / (2 * step**3)
    return [c, first, second, third]
