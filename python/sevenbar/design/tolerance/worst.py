"""The worst case: the linear sum along the cycle, and the corner designs that it names, exactly."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.exact import ChangedDesigns
from sevenbar.design.tolerance.linear import Given, Linear, linear_estimate
from sevenbar.design.tolerance.sensitivities import Sensitivities
from sevenbar.kinematics.linkage import Linkage


@dataclass(frozen=True, eq=False)
class WorstCase:
    """The worst case by the linear estimate, and as its corner designs have it.

    `high` and `low` (n,) are the exact deviations of the designs at the ends of all tolerances that the signs
    of the derivatives name, of each row its own; NaN where such a design does not close there.
    """

    linear: Linear
    high: Floats = field(repr=False)
    low: Floats = field(repr=False)

    @property
    def at(self) -> int:
        """The place among the rows where the linear estimate is greatest."""
        return self.linear.greatest

    @property
    def corner(self) -> dict[str, float]:
        """The dimensions of the design that is to deviate most upwards, at `at`."""
        signs = np.sign(self.linear.slopes[self.at])
        widths = self.linear.tolerances.widths
        return {
            dimension.name: dimension.value + float(sign * width)
            for dimension, sign, width in zip(self.linear.found.dimensions, signs, widths, strict=True)
            if width > 0
        }

    @property
    def difference(self) -> float:
        """How far the exact deviation at `at` is from the linear estimate, relative to it; NaN if none."""
        linear = float(self.linear.worst[self.at])
        exact = max(abs(self.high[self.at]), abs(self.low[self.at]))
        return float(exact / linear - 1) if linear > 0 else 0.0


def worst_case(
    of: Linkage | Sensitivities,
    given: Given | Linear,
    *,
    output: str | None = None,
    quantity: str = "position",
) -> WorstCase:
    """The worst case of an output along the cycle; the arguments are those of `linear_estimate`.

    >>> import numpy as np
    >>> import sevenbar as sb
    >>> found = worst_case(sb.load("rssr"), {"L1": 0.5, "L2": 0.5})
    >>> bool(np.degrees(found.high).max() < 0.5), abs(found.difference) < 0.01
    (True, True)
    """
    linear = (
        given if isinstance(given, Linear) else linear_estimate(of, given, output=output, quantity=quantity)
    )
    designs = ChangedDesigns(linear)
    # the corners of each row, looked at on that row; many rows share theirs
    corners, own = np.unique(np.sign(linear.slopes) * linear.tolerances.widths, axis=0, return_inverse=True)
    rows = np.arange(len(linear.rows))
    high, low = (
        designs.deviations(changes, designs.followed(changes)[0])[own.ravel(), rows]
        for changes in (corners, -corners)
    )
    return WorstCase(linear, high, low)
