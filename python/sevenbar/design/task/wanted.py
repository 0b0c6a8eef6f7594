"""What every want is to the search: inputs at which it sees the linkage, and its residuals there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.kinematics.circuits.circuit import Circuit

#: In place of a distance of 0, whose slopes are then 0.
TINY = 1e-300


@dataclass(frozen=True, eq=False)
class Stations:
    """The inputs `fixed + by u` (n,) of a want with own unknowns u (m,), whose units are `scales` (m,).

    They are in their order; `round`: the last leads to the first again; `free`: each is an unknown.
    """

    fixed: Floats
    by: Floats
    scales: Floats
    round: bool = False
    free: bool = False

    def inputs(self, u: Floats) -> Floats:
        """The inputs (n,)."""
        return np.asarray(self.fixed + self.by @ u)


@dataclass(frozen=True, eq=False)
class TaskStart:
    """How a want may start on a pass: its unknowns (m,), the rows of the pass (n,), the mean square error."""

    u: Floats
    rows: Integers
    error: float
    placing: Placing | None = None


@dataclass(frozen=True, eq=False)
class Bound:
    """What a want requires, and not only makes small: slacks (b,) with slopes (b, k + m), and words.

    Slacks, relative to the want's unit, must not be negative.
    """

    slack: Floats
    slack_by: Floats
    missed: str


@dataclass(frozen=True, eq=False)
class Used:
    """What a design does along a want: `inputs` (n,) and their `poses` (n, columns), dense as for a curve.

    `u` (m,) are the want's unknowns, `values` (k,) the free numbers; `station_poses` (s, columns) are the
    poses at its stations.
    """

    loop: TaskLoop
    values: Floats
    u: Floats
    placing: Placing
    inputs: Floats
    poses: Floats
    station_poses: Floats

    def points(self, numbers: Sequence[int], q: Floats) -> Floats:
        """Where points are at poses (n, points, 3), the linkage as it is described."""
        return self.loop.here(self.values, q).points[:, numbers]


@dataclass(frozen=True)
class WantFact:
    """What reports say of a want: a name, a unit, a value; `tabled`: in the printed table, too."""

    name: str
    unit: str
    value: float
    tabled: bool = False


@dataclass(frozen=True, eq=False)
class ReadingsCurve:
    """Readings of the output over those of the input (n,), and those `wanted` (w,) `at` some."""

    inputs: Floats
    outputs: Floats
    at: Floats
    wanted: Floats


@dataclass(frozen=True, eq=False)
class PlacesCurve:
    """A path (n, 3), wanted places (w, 3), how far off (w,); frames (w, 4, 3), wanted and taken."""

    path: Floats
    wanted: Floats
    errors: Floats
    frames: tuple[Floats, Floats] | None = None


class Wanted(Protocol):
    """A want in a loop; one that requires something subclasses it and overrides `bound`."""

    stations: Stations
    weight: float
    #: What residuals are relative to, and whether errors are angles.
    unit: float
    turns: bool
    #: The number of residuals.
    count: int
    #: Whether its places go with the linkage, where that may stand anywhere.
    placeable: bool = False

    def starts(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[TaskStart]:
        """The best starts on a pass, best first; `placing` is `None` where it may stand anywhere."""

    def residuals(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """The residuals (r,) at its stations, and their slopes (r, k + m) by free numbers and unknowns."""

    def heights(self, residuals: Floats, by: Floats) -> tuple[Floats, Floats]:
        """Sizes (h,) of such residuals, of which the greatest counts, and their slopes (h, k)."""

    def bound(self, here: Here) -> Bound | None:  # noqa: ARG002
        """What it requires at its stations; `None` for nothing."""
        return None

    def missed(self, here: Here, u: Floats, placing: Placing) -> Floats:  # noqa: ARG002
        """What it is off at its stations by its residuals [rad, or length]."""
        return self.unit * self.residuals(here, u)[0]

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:
        """What it is off (n,) on rows of an analysis at its inputs [rad, or length], by its own unknowns."""

    def facts(self, used: Used) -> Sequence[WantFact]:  # noqa: ARG002
        """What reports say of it besides its errors."""
        return ()

    def curve(self, used: Used) -> ReadingsCurve | PlacesCurve:
        """What figures show of it."""


def both_signs(residuals: Floats, by: Floats) -> tuple[Floats, Floats]:
    """Residuals (h,) and their opposites, of which the greatest is a size, with their slopes."""
    return np.concatenate([residuals, -residuals]), np.concatenate([by, -by])


def distances(residuals: Floats, by: Floats) -> tuple[Floats, Floats]:
    """Distances (h,) from the parts (3 h,) of residuals in space, and their slopes (h, k)."""
    parts = residuals.reshape(-1, 3)
    size = np.linalg.norm(parts, axis=1)
    slopes = np.einsum("ni,nik->nk", parts, by.reshape(*parts.shape, by.shape[-1]))
    return size, slopes / np.maximum(size, TINY)[:, None]
