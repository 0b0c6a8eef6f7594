"""A task for exact answers from a table of text: its columns say whether it has pairs of angles, or poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.curve_table import TURNS, read_turns, rotations
from sevenbar.design.exact.answers import ExactAnswers
from sevenbar.design.exact.bennett import bennett_poses
from sevenbar.design.exact.cylinders import cc_dyads, rccc_poses
from sevenbar.design.exact.function import function_pairs
from sevenbar.design.exact.planar import planar_poses
from sevenbar.design.exact.spherical import spherical_orientations
from sevenbar.design.wish import read_pairs
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.loop.rigid import pose
from sevenbar.text.table import read_table
from sevenbar.text.units import LENGTHS

#: Linkages, each with what it is given.
LINKAGES = {
    "rssr": "pairs of angles",
    "planar": "poses in a plane",
    "spherical": "orientations",
    "bennett": "poses in space",
    "rccc": "poses in space",
    "cccc": "poses in space",
}

#: The linkage for so many poses in space where none is named.
OF_SPACE = {3: "bennett", 5: "cccc"}

#: What a table may have, for messages.
COLUMNS = (
    "two columns of angles, as in 'input [deg], output [deg]'; x, y and turn_z for poses in a plane; "
    "turn_x, turn_y, turn_z for orientations; all six for poses in space"
)


@dataclass(frozen=True, eq=False)
class ExactTask:
    """The task of a table: `what` of `LINKAGES`, its arrays, and the unit of its lengths."""

    what: str
    arrays: tuple[Floats, ...]
    length_unit: str = "mm"

    @property
    def linkage(self) -> str:
        """The linkage that takes it where none is named; raises `RequestError` where none takes as many."""
        fitting = [name for name, what in LINKAGES.items() if what == self.what]
        if self.what != "poses in space":
            return fitting[0]
        count = len(self.arrays[0])
        if count not in OF_SPACE:
            raise RequestError(f"poses: {count} in space are given; give 3 (bennett, rccc) or 5 (cccc)")
        return OF_SPACE[count]

    def answers(self, linkage: str | None = None, **given: Any) -> ExactAnswers:
        """All answers by a linkage of `LINKAGES`; `given` as its function in `design.exact` takes it.

        Raises `RequestError` for a linkage of another task, and for what its function does not take.
        """
        name = self.linkage if linkage is None else linkage
        fitting = [key for key, what in LINKAGES.items() if what == self.what]
        if name not in fitting:
            takes = f"takes {LINKAGES[name]}" if name in LINKAGES else "is not known here"
            raise RequestError(
                f"linkage: {shown(name)} {takes}, and the table has {self.what}; give {' or '.join(fitting)}"
            )
        function, options = _FUNCTIONS[name]
        strange = sorted(given.keys() - options)
        if strange:
            raise RequestError(f"{strange[0]}: has no say for linkage {name}; leave it out")
        return function(*self.arrays, **given, length_unit=self.length_unit)


_FUNCTIONS: Mapping[str, tuple[Callable[..., ExactAnswers], frozenset[str]]] = {
    "rssr": (function_pairs, frozenset({"twist", "zeros", "longest", "samples", "seed"})),
    "planar": (planar_poses, frozenset({"moving", "samples", "seed"})),
    "spherical": (spherical_orientations, frozenset({"moving", "samples", "seed", "radius"})),
    "bennett": (bennett_poses, frozenset()),
    "rccc": (rccc_poses, frozenset({"samples", "seed"})),
    "cccc": (cc_dyads, frozenset()),
}


def read_exact_task(path: Path) -> ExactTask:
    """The task of a table; raises `TableError` with the line and what is wrong."""
    table = read_table(path, "pairs of angles, or poses")
    turned = [name for name in TURNS if table.column(name) is not None]
    placed = {letter: place for letter in "xyz" if (place := table.column(letter)) is not None}
    if not turned and not placed and len(table.names) == 2:
        return ExactTask("pairs of angles", read_pairs(path))
    if not turned:
        raise table.wrong(f"neither pairs of angles nor poses; {table.header}; give {COLUMNS}")
    turns = read_turns(table)
    if not placed:
        return ExactTask("orientations", (rotations(turns),))
    # the linkage is written in the unit of the places, if linkages have it
    written = table.name_and_unit(next(iter(placed.values())))[1]
    unit = written if written in LENGTHS else "mm"
    at = np.zeros((len(turns), 3))
    for letter, column in placed.items():
        values = at[:, "xyz".index(letter)] = table.sized(
            column, ("slide", 0), unit, what=letter, example=unit
        )
        table.refuse_gaps({column: values}, "leave the row out")
    if "z" not in placed and turned == ["turn_z"]:
        return ExactTask("poses in a plane", (np.column_stack([at[:, :2], turns[:, 2]]),), unit)
    return ExactTask("poses in space", (pose(rotations(turns), at),), unit)
