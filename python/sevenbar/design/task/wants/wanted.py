"""What every want is to the search: inputs at which it sees the linkage, and what is left there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.candidates import Fault
from sevenbar.design.task.loop import Here
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.kinematics.circuits.circuit import Circuit


@dataclass(frozen=True, eq=False)
class Stations:
    """The inputs `fixed + by u` (n,) of a want with own unknowns u (m,), whose units are `scales` (m,).

    They follow each other; `round`: the last leads to the first again; `free`: each is an unknown.
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
class Begun:
    """How a want may begin on a pass: its unknowns (m,), the rows of the pass (n,), the mean square left."""

    u: Floats
    rows: Integers
    error: float
    placing: Placing | None = None


@dataclass(frozen=True, eq=False)
class Bound:
    """What a want requires and not only makes small: a slack not below 0, with its slopes (k + m), and words.

    `slack` is relative to the want's unit.
    """

    fault: Fault
    slack: float
    slack_by: Floats
    missed: str


class Wanted(Protocol):
    """A want in a loop; one that requires something subclasses it and overrides `bound`."""

    stations: Stations
    weight: float
    #: What residuals are relative to, and whether errors are angles.
    unit: float
    turns: bool
    #: The number of residuals.
    count: int

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:
        """How it may begin on a pass, best first; `placing` is `None` where it may stand anywhere."""

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """The residuals (r,) at its stations, and their slopes (r, k + m) by free numbers and unknowns."""

    def heights(self, left: Floats, by: Floats) -> tuple[Floats, Floats]:
        """Sizes (h,) of such residuals, of which the greatest counts, and their slopes (h, k)."""

    def bound(self, here: Here) -> Bound | None:  # noqa: ARG002
        """What it requires at its stations; `None` for nothing."""
        return None

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:
        """What it is off (n,) on rows of an analysis at its inputs [rad, or length], by its own unknowns."""


def both_signs(left: Floats, by: Floats) -> tuple[Floats, Floats]:
    """Residuals (h,) and their opposites, of which the greatest is a size, with their slopes."""
    return np.concatenate([left, -left]), np.concatenate([by, -by])


def distances(left: Floats, by: Floats) -> tuple[Floats, Floats]:
    """Distances (h,) from the parts (3 h,) of residuals in space, and their slopes (h, k)."""
    left = left.reshape(-1, 3)
    size = np.linalg.norm(left, axis=1)
    slopes = np.einsum("ni,nik->nk", left, by.reshape(*left.shape, by.shape[-1]))
    return size, slopes / np.maximum(size, 1e-300)[:, None]
