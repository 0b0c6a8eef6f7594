"""What a linkage is at given inputs: the outputs of the closed form, and all assembly modes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, Words, short_way
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.printing import Printed

#: Modes nearer to each other in every joint [rad, or relative to the size] are one pose.
ONE_POSE = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Output(Printed):
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
class Modes(Printed):
    """All assembly modes at one input: joint values (m, columns), angles in (-pi, pi].

    Turns of a ball that have no direction are NaN; `status` says which.
    """

    q: Floats
    residual: Floats
    completeness: Literal["closed-form", "algebraic", "searched"]
    columns: tuple[str, ...]
    input: float
    #: Other poses that redundant constraints alone keep open: how much [rad, relative to the size], rising.
    open_by: Floats = field(default_factory=lambda: np.empty(0))
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

    def each_once(self, loop: Loop, size: float) -> Modes:
        """The same without poses that rounding alone keeps apart; slides count relative to the `size`.

        At a dead centre two modes are one, which a solver finds twice, apart by the root of its rounding.
        """
        # no two poses are near whose sums are not: most often that is all there is to compute
        sums = sorted(np.cos(self.q).sum(axis=1).tolist())
        least = ONE_POSE * len(self.columns) * max(size, 1.0)
        if all(after - before > least for before, after in pairwise(sums)):
            return self
        turns = np.array([loop.turns(name) for name in self.columns])
        apart = self.q[:, None] - self.q
        apart = np.abs(np.where(turns, short_way(apart), apart / size))
        # turns without a direction are those of one pose, too
        near = (np.isnan(apart) | (apart < ONE_POSE)).all(axis=2)
        first = ~np.tril(near, -1).any(axis=1)
        return replace(self, q=self.q[first], residual=self.residual[first])
