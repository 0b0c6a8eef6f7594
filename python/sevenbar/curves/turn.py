"""Ranges of an angle, which comes again after a turn: what is a whole turn, and what is more than one."""

from __future__ import annotations

import math

#: By this part of a turn a range may be longer than one, or shorter, and still be one: rounding of degrees.
SAME_TURN = 1e-12


def is_a_turn(low: float, high: float) -> bool:
    """Whether a range [rad] is a whole turn.

    >>> is_a_turn(-math.pi, math.pi), is_a_turn(0.0, 6.28)
    (True, False)
    """
    return abs(high - low - math.tau) <= SAME_TURN * math.tau


def is_beyond_a_turn(low: float, high: float) -> bool:
    """Whether a range [rad] is longer than a turn."""
    return high - low > math.tau * (1 + SAME_TURN)
