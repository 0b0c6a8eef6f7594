"""The value of a joint as people write it."""

from __future__ import annotations

from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.geometry import Loop
from sevenbar.text.units import ANGLES, amount, length_sizes


def joint_value(text: str, key: str, linkage: Loop, column: int) -> float:
    """The value of a joint [rad, or length] as people write it: "30deg", "0.5rad", "12mm".

    A plain number is in degrees for a turn and in the length unit for a slide. Raises `RequestError`.
    """
    slides = linkage.column_kinds[column] == "slide"
    plain = linkage.length_unit if slides else "deg"
    value = amount(text, length_sizes(linkage.length_unit) if slides else ANGLES, plain)
    if value is None:
        kind = "slides" if slides else "turns"
        hint = f"12 or 12{plain}" if slides else "30, 30deg or 0.5rad"
        raise RequestError(
            f"{key}: {shown(text)} is no value of {linkage.columns[column]}, which {kind}; give {hint}"
        )
    return value
