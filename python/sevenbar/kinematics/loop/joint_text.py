"""The value of a joint as people write it: on the command line, and in calls."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array, finite_number, real_array
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.given import given_number
from sevenbar.text.units import examples_of, sliding_speed, turning_speed, usable_speed


def joint_value(text: str, key: str, linkage: Loop, column: int) -> float:
    """The value of a joint [rad, or length] as people write it: "30deg", "0.5rad", "12mm".

    A plain number is in degrees for a turn and in the length unit for a slide. Raises `RequestError`.
    """
    slides = not linkage.turns(column)
    unit, plain = (linkage.length_unit,) * 2 if slides else ("rad", "deg")
    # `import sevenbar` needs no reader of formulas
    from sevenbar.text.amounts import amount_in

    value = amount_in(text, unit, plain)
    if value is None:
        kind = "slides" if slides else "turns"
        raise RequestError(
            f"{key}: {shown(text)} is no value of {linkage.columns[column]}, which {kind}; "
            f"give {examples_of(unit)}"
        )
    return value


def check_own_unit(key: str, angle: str) -> None:
    """Refuses the text of an angle without a unit, as in Python a number alone is in radians."""
    # `import sevenbar` needs no reader of formulas
    from sevenbar.text.amounts import lacks_unit

    if lacks_unit(angle, "angle"):
        raise RequestError(
            f"{key}: {shown(angle)} has no unit; give one as in '30 deg', or a number in radians"
        )


def joint_number(key: str, value: npt.ArrayLike, linkage: Loop, column: int) -> float:
    """The value of a joint [rad, or length] that a caller gives: a number, or a text as in "30 deg"."""
    if isinstance(value, str):
        return finite_number(key, given_number(key, value, linkage.unit_of(column)))  # type: ignore[arg-type]
    return finite_number(key, value)


def joint_numbers(key: str, values: npt.ArrayLike, linkage: Loop, column: int) -> Floats:
    """Values of a joint (n,) [rad, or length] that a caller gives: numbers, or texts; finite or not."""
    return real_array(key, _read(key, values, lambda _: linkage.unit_of(column)))


def drive_speed(value: object, length_unit: str | None = None) -> float:
    """The speed of a drive that turns [rad/s], or that slides [length_unit/s]; its number may be a formula.

    Raises `RequestError` as `turning_speed` and `sliding_speed` do.

        >>> drive_speed("2*3 rad/s"), drive_speed("2*3 cm/s", "mm")
        (6.0, 60.0)
    """

    def read(given: object) -> float:
        return turning_speed(given) if length_unit is None else sliding_speed(given, length_unit)

    try:
        return read(value)
    except RequestError:
        # most speeds, as `import sevenbar`, need no reader of formulas
        from sevenbar.text.amounts import plain_speed

        return read(plain_speed(value))


def joint_speed(speed: object, linkage: Loop, column: int) -> float:
    """The speed of a joint [rad/s, or length/s] that a caller gives: a number, or a text as in "60 rpm"."""
    # most calls give this, and the reader takes as long as some poses
    if isinstance(speed, float) and usable_speed(speed):
        return float(speed)
    try:
        plain = float(speed) if isinstance(speed, np.number) else speed
        return drive_speed(plain, None if linkage.turns(column) else linkage.length_unit)
    except RequestError as error:
        raise RequestError(f"speed: {error}") from None


def pose_numbers(key: str, values: npt.ArrayLike, linkage: Loop) -> Floats:
    """The values of all columns (columns,) [rad, or length] that a caller gives: finite numbers, or texts."""
    last = len(linkage.columns) - 1
    return finite_array(key, _read(key, values, lambda i: linkage.unit_of(min(i, last))))


def _read(key: str, values: npt.ArrayLike, unit_of: Callable[[int], str]) -> npt.ArrayLike:
    """Values with texts read, each in the unit of its place."""
    if isinstance(values, str):
        return given_number(key, values, unit_of(0))  # type: ignore[return-value]
    if not isinstance(values, (list, tuple)) or not any(isinstance(value, str) for value in values):
        return values
    return [given_number(f"{key}[{i}]", value, unit_of(i)) for i, value in enumerate(values)]  # type: ignore[return-value]
