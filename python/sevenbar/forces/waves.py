"""What measures of forces need of a smooth cycle: its torque and its shaking as curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sevenbar.arrays import Floats
from sevenbar.forces.shaking import shaking_of
from sevenbar.forces.sizing import CycleLoads


@dataclass(frozen=True, eq=False)
class ForceWaves:
    """What measures of forces need of a cycle: the loads of its torque, and the peak of the shaking force.

    `None` of a circuit that has no measures.
    """

    loads: CycleLoads | None = None
    #: Rows (n, 6) [N m, and N] of the shaking, and the way of the input round the cycle [rad].
    shaking: Floats | None = None
    period: float = 0.0

    @cached_property
    def peak_shaking(self) -> float | None:
        """The greatest shaking force [N]."""
        if self.loads is None or self.shaking is None:
            return None
        rows = self.loads.rows
        return shaking_of(self.shaking, rows.input, period=self.period, time=rows.time).force.value
