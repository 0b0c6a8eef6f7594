"""What a linkage is at given inputs: the outputs of the closed form, and all assembly modes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, ReadOnly, Words
from sevenbar.text.printing import Printed

#: No poses.
_NONE = np.empty(0)


@dataclass(frozen=True, eq=False, repr=False)
class Output(ReadOnly, Printed):
    """Both branches of the closed form on n inputs; arrays (2, n), `None` above the order asked for.

    `position` [rad], `velocity` [rad/s], `acceleration` [rad/s^2], `jerk` [rad/s^3]. An input without
    solution keeps its place as NaN; so do the rates at an input dead centre. `status` says which.
    """

    position: Floats
    velocity: Floats | None = None
    acceleration: Floats | None = None
    jerk: Floats | None = None

    @property
    def status(self) -> Words:
        """The status of each value, (2, n): "ok", "dead-centre" (from order 1 on), "no-solution"."""
        status = np.full(self.position.shape, "ok", dtype="<U15")
        if self.velocity is not None:
            status[np.isnan(self.velocity)] = "dead-centre"
        status[np.isnan(self.position)] = "no-solution"
        return status


@dataclass(frozen=True, eq=False, repr=False)
class Modes(ReadOnly, Printed):
    """All assembly modes at one input: joint values (m, columns), angles in (-pi, pi].

    Turns of a ball that have no direction are NaN; `status` says which.
    """

    q: Floats
    residual: Floats
    completeness: Literal["closed-form", "algebraic", "monodromy", "searched"]
    columns: tuple[str, ...]
    input: float
    #: Other poses that redundant constraints alone keep open: how much [rad, relative to the size], rising.
    open_by: Floats = field(default_factory=lambda: _NONE)
    #: The closure error [rad, relative to the size] up to which they agree; NaN where nothing is redundant.
    agree: float = math.nan
    #: A pose (columns,) on a curve of poses that all close at this input: the other joints can still move.
    #: `q` has isolated modes only, none of that curve. `None` where no such curve was found.
    on_curve: Floats | None = None

    @property
    def status(self) -> Words:
        """The status of each mode, (m,): "ok", or "turns-undefined" where those of a ball are."""
        return np.where(np.isnan(self.q).any(axis=1), "turns-undefined", "ok")

    def __len__(self) -> int:
        return len(self.q)
