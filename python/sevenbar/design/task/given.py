"""Values of a task file whose unit the linkage decides, and what is read from the files that it names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.named_files import file_below
from sevenbar.description.values import TableForm
from sevenbar.design.task.values import Given
from sevenbar.errors import RequestError, TableError, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.joint_text import joint_value
from sevenbar.text.amounts import amount_in
from sevenbar.text.units import examples_of

T = TypeVar("T")


def reading(key: str, value: Given, linkage: Linkage, column: str) -> float:
    """A value of a joint [rad, or length]; a plain number is in degrees where it turns."""
    text = value if isinstance(value, str) else repr(value)
    return joint_value(text, key, linkage, linkage.columns.index(column))


def reading_span(key: str, ends: tuple[Given, Given], linkage: Linkage, column: str) -> tuple[float, float]:
    """The two ends of a joint's range [rad, or length]."""
    return reading(key, ends[0], linkage, column), reading(key, ends[1], linkage, column)


def amount(key: str, value: Given, unit: str) -> float:
    """A value in a unit; a number stays as it is."""
    result = amount_in(value, unit) if isinstance(value, str) else value
    if result is None:
        raise RequestError(f"{key}: {shown(value)} does not fit; give {examples_of(unit)}")
    return result


def one_of(form: TableForm, *names: str) -> str:
    """The one of some keys that a table has."""
    given = [name for name in names if getattr(form, name) is not None]
    if len(given) != 1:
        how_many = {2: "two", 3: "three"}[len(names)]
        both = "both " if len(names) == 2 else ""
        missing = f"{', '.join(names[:-1])} and {names[-1]} are missing"
        what = f"{' and '.join(given)} are {both}given" if given else missing
        raise RequestError(f"{what}; give one of the {how_many}")
    return given[0]


def timing(given: object, of_table: Floats | None, linkage: Linkage) -> Floats | None:
    """The inputs [rad, or length] of places or poses, those of the table where `given` says so."""
    if given is None:
        return None
    if given is True:
        if of_table is None:
            raise RequestError(
                f"timing: no table has a column for the input '{linkage.drive.joint}'; "
                "give the inputs, as in [0, 10, 20]"
            )
        return of_table
    column = linkage.drive.joint
    assert isinstance(given, tuple)
    return np.array([reading(f"timing[{i + 1}]", value, linkage, column) for i, value in enumerate(given)])


def zero(key: str, value: Given, linkage: Linkage, column: str) -> float | None:
    """The value of a joint at the reading 0; `None` for a free one."""
    return None if value == "free" else reading(key, value, linkage, column)


def read_file(reader: Callable[[Path], T], folder: Path, name: str) -> T:
    """What a reader finds in the table that a file in a folder names; its mistakes are those of the key."""
    try:
        return reader(file_below(folder, name, "wanted.csv"))
    except (TableError, RequestError) as error:
        raise RequestError(f"table: {str(error).removeprefix('table: ')}") from None
