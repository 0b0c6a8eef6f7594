"""A coupler that follows from the other dimensions, among the numbers of a description."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import following_coupler
from sevenbar.kinematics.numbers.dimensions import Dimension

#: What a coupler follows from, in the order of `following_coupler`.
LEADERS = ("M", "N", "L1", "L3")


@dataclass(frozen=True)
class Following:
    """The place of L2 among k numbers, and those of M, N, L1 and L3, from which it follows.

    With c = L1 - M:  `L2^2 = c^2 + L3^2 + N^2`,  `L2 dL2 = c (dL1 - dM) + L3 dL3 + N dN`.
    """

    own: int
    leaders: tuple[int, ...]

    @staticmethod
    def among(dimensions: Sequence[Dimension], but: Sequence[int] = ()) -> Following | None:
        """That of the dimensions, `None` where none follows; `but` places are numbers of their own."""
        places = {d.place[1]: k for k, d in enumerate(dimensions) if d.place[0] == "rssr"}
        own = next((k for k, d in enumerate(dimensions) if d.follows and k not in but), None)
        return None if own is None else Following(own, tuple(places[name] for name in LEADERS))

    def whole(self, values: Floats) -> Floats:
        """The numbers (.., k) with the coupler that follows from them."""
        values = np.array(values, dtype=np.float64)
        values[..., self.own] = following_coupler(*(values[..., k] for k in self.leaders))
        return values

    def slopes(self, values: Floats) -> Floats:
        """The derivatives (4,) of the coupler at numbers (k,) by those that it follows from."""
        m, n, crank, rocker = values[list(self.leaders)]
        parts: Floats = np.array([m - crank, n, crank - m, rocker]) / self.whole(values)[self.own]
        return parts

    def chained(self, slopes: Floats, values: Floats) -> Floats:
        """Derivatives (.., k), those by the coupler passed on to what it follows from."""
        slopes = np.array(slopes, dtype=np.float64)
        slopes[..., list(self.leaders)] += slopes[..., self.own, None] * self.slopes(values)
        slopes[..., self.own] = 0.0
        return slopes
