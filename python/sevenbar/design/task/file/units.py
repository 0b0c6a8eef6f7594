"""Values of a task file whose unit the linkage decides: readings of joints, measures, lengths."""

from __future__ import annotations

from sevenbar.design.task.file.values import Given
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.joint_text import joint_value
from sevenbar.kinematics.measures import measures_named
from sevenbar.text.amounts import amount_in
from sevenbar.text.units import examples_of


def reading(key: str, value: Given, linkage: Linkage, column: str) -> float:
    """A value of a joint [rad, or length]; a plain number is in degrees where it turns."""
    text = value if isinstance(value, str) else repr(value)
    return joint_value(text, key, linkage, linkage.columns.index(column))


def reading_span(key: str, ends: tuple[Given, Given], linkage: Linkage, column: str) -> tuple[float, float]:
    """The two ends of a joint's range [rad, or length]."""
    return reading(key, ends[0], linkage, column), reading(key, ends[1], linkage, column)


def figure_value(key: str, value: Given, linkage: Linkage, name: str) -> float:
    """A value of a measure in the unit that it is read in; a number stays as it is."""
    if not isinstance(value, str):
        return value
    try:
        (measure,) = measures_named([name])
    except RequestError:
        # the name is checked with the task
        return 0.0
    unit = measure.unit(linkage, linkage.drive.output)
    return amount(key, value, unit if unit in ("deg", linkage.length_unit) else "")


def amount(key: str, value: Given, unit: str) -> float:
    """A value in a unit; a number stays as it is."""
    found = amount_in(value, unit) if isinstance(value, str) else value
    if found is None:
        raise RequestError(f"{key}: {shown(value)} does not fit; give {examples_of(unit)}")
    return found
