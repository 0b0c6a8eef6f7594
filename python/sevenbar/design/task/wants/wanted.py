"""What every want is to the search: inputs at which it sees the linkage, and what is left there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sevenbar.arrays import Floats, Integers
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


class Wanted(Protocol):
    """A want in a loop."""

    stations: Stations
    weight: float
    #: What residuals are relative to, and whether errors are angles.
    unit: float
    turns: bool

    @property
    def count(self) -> int:
        """The number of residuals."""

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:
        """How it may begin on a pass, best first; `placing` is `None` where it may stand anywhere."""

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """The residuals (r,) at its stations, and their slopes (r, k + m) by free numbers and unknowns."""

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:
        """What it is off (n,) on rows of an analysis at its inputs [rad, or length], by its own unknowns."""
