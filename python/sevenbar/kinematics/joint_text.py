"""The value of a joint as people write it."""

from __future__ import annotations

from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.geometry import Loop
from sevenbar.text.units import amount, examples_of, sizes_of


def joint_value(text: str, key: str, linkage: Loop, column: int) -> float:
    """The value of a joint [rad, or length] as people write it: "30deg", "0.5rad", "12mm".

    A plain number is in degrees for a turn and in the length unit for a slide. Raises `RequestError`.
    """
    slides = linkage.column_kinds[column] == "slide"
    unit, plain = (linkage.length_unit,) * 2 if slides else ("rad", "deg")
    value = amount(text, sizes_of(unit), plain)
    if value is None:
        kind = "slides" if slides else "turns"
        raise RequestError(
            f"{key}: {shown(text)} is no value of {linkage.columns[column]}, which {kind}; "
            f"give {examples_of(unit)}"
        )
    return value
