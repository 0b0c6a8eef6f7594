"""Units that people write: lengths, angles, and the speed of a drive."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from sevenbar.errors import RequestError, shown, suggestion

#: Length units and their size in metres.
LENGTHS = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}

#: Angle units and their size in radians.
ANGLES = {"rad": 1.0, "deg": math.pi / 180}

#: Units of turning speed and their size in rad/s.
TURNING_SPEEDS = {"rad/s": 1.0, "deg/s": math.pi / 180, "rpm": math.tau / 60, "rev/s": math.tau}

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")


def unknown_unit(given: object, known: Iterable[str]) -> str:
    """The message for a unit that does not exist."""
    known = list(known)
    return (
        f"{shown(given)} is not a unit known here; {suggestion(str(given), known)}allowed: {', '.join(known)}"
    )


def turning_speed(value: object) -> float:
    """The speed [rad/s] of `"10 rad/s"`, `"60 rpm"`, `"90 deg/s"`, `"1 rev/s"`, or a number in rad/s.

    Raises `RequestError` for anything else, for zero, and for a number that is not finite.
    """
    example = "give a number and a unit, as in '10 rad/s' or '60 rpm'"
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise RequestError(f"{shown(value)} is not a speed; {example}")
    if isinstance(value, str):
        match = _QUANTITY.fullmatch(value)
        if match is None:
            raise RequestError(f"{shown(value)} is not a speed; {example}")
        number, unit = match.groups()
        if unit not in TURNING_SPEEDS:
            raise RequestError(
                unknown_unit(unit, TURNING_SPEEDS) if unit else f"{shown(value)} has no unit; {example}"
            )
        speed = float(number) * TURNING_SPEEDS[unit]
    else:
        try:
            speed = float(value)
        except OverflowError:
            speed = math.inf
    if not 1e-50 <= abs(speed) <= 1e50:
        raise RequestError(
            f"{shown(value)} moves nothing; give a finite speed other than 0, as in '10 rad/s'"
        )
    return speed
