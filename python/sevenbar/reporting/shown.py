"""How values of joints, speeds and numbers are written in reports."""

from __future__ import annotations

import math

from sevenbar.arrays import Words, counted
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.units import split_quantity
from sevenbar.text.words import say

#: Values below this share of what the linkage's size and its drive make are rounding.
REST = 1e-12

#: A middle so near to half a turn [turns] is there.
SAME_TURN = 1e-9

#: Digits of forces, torques and what follows from them.
DIGITS = 4


class Shown:
    """How a joint's value is written: an angle in degrees, a slide in the length unit."""

    def __init__(self, unit: str) -> None:
        self._unit = unit

    def __call__(self, value: float, *, whole: bool = False) -> str:
        """The value with its unit; `whole` takes an angle into [0, 360)."""
        if self._unit != "rad":
            return f"{value:.6g} {self._unit}".rstrip()
        return degrees(value, whole=whole)

    def range(self, low: float, high: float) -> tuple[str, str]:
        """The ends of a range, angles in [0, 360) as limits are: from 350 to 20 degrees it goes through 0.

        A range of all but a turn keeps its ends apart: from -180 to 180 degrees.
        """
        whole = self._unit == "rad" and high - low <= math.tau and not self.same(low, high)
        return self(low, whole=whole), self(high, whole=whole)

    def same(self, a: float, b: float) -> bool:
        """Whether two values are one place, to the digits that are shown."""
        return self(a, whole=True) == self(b, whole=True)


def turned(low: float, high: float) -> float:
    """The whole turns [rad] that bring the middle of a range of angles into (-pi, pi], as modes are.

    >>> [round(math.degrees(turned(*map(math.radians, ends)))) for ends in ((-266.4, -93.6), (7, 68))]
    [360, 0]
    """
    return -math.tau * math.ceil(((low + high) / 2 - math.pi) / math.tau - SAME_TURN)


def number(value: float) -> str:
    """A force or torque to the digits that matter, without a power of ten where it is not far from 1.

    >>> number(12612.3), number(-0.58712), number(3.1e-7)
    ('12610', '-0.5871', '3.1e-07')
    """
    short = f"{value + 0.0:.{DIGITS}g}"
    return f"{float(short):.0f}" if 1e4 <= abs(value) < 1e7 else short


def value_text(linkage: Loop, column: int, value: float) -> str:
    """The value of a column with its unit; a length that is rounding is 0."""
    if not linkage.turns(column) and abs(value) < REST * linkage.size:
        value = 0.0
    return Shown(linkage.unit_of(column))(value)


def drive_text(input: str, speed: float | None, unit: str, output: str = "", *, written: str = "") -> str:
    """How a linkage is driven, `speed` [unit/s] or `None` for a law, and what is read of it.

    `written` is the speed as a person wrote it, in a unit that may be another.

    >>> drive_text("crank", 10.0, "rad", "rocker")
    'crank at 10 rad/s, output rocker'
    >>> drive_text("crank", 314.159265, "rad", written="3000 rpm")
    'crank at 3000 rpm (314.159 rad/s)'
    """
    if speed is None:
        driven = say("{joint} by a law", joint=input)
    else:
        driven = say("{joint} at {speed}", joint=input, speed=speed_text(speed, f"{unit}/s", written))
    return say("{driven}, output {output}", driven=driven, output=output) if output else driven


def speed_text(speed: float, unit: str, written: str = "") -> str:
    """A speed in the unit of results, after what was `written` where that is another."""
    plain = f"{speed:.6g} {unit}"
    own = " ".join(written.split())
    parts = split_quantity(own)
    if parts is None or parts[1] in ("", unit):
        return plain
    return f"{own} ({plain})"


def six_digits(value: float) -> str:
    """A number to six digits."""
    return f"{value:.6g}"


def degrees(angle: float, *, whole: bool = False) -> str:
    """An angle [rad] in degrees; `whole` takes it into [0, 360)."""
    # rounded first, so that neither -0.000 nor 360.000 is left
    degrees = round(math.degrees(angle), 3)
    return f"{(degrees % 360 if whole else degrees) + 0.0:.3f}\u00b0"


def rows_text(status: Words) -> str:
    """How many rows have each status: "2 dead-centre, 358 ok"."""
    return ", ".join(f"{count} {word}" for word, count in counted(status).items())
