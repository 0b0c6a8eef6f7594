"""The worst case: the linear sum along the cycle, and designs at the corners of the tolerances, exactly."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.course import SearchCourse
from sevenbar.design.tolerance.exact import ChangedDesigns
from sevenbar.design.tolerance.linear import Given, Linear, linear_estimate
from sevenbar.design.tolerance.sensitivities import Sensitivities
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.progress import Progress, silent

#: All corners are computed for so many dimensions with a tolerance: 256 designs.
MOST_DIMENSIONS = 8

#: Corners that are computed at once.
BLOCK = 64


@dataclass(frozen=True, eq=False)
class WorstCase:
    """The worst case by the linear estimate, and as the corner designs have it.

    A corner has every dimension at one end of its tolerance: 2^k of them, `corners`, of which `tried` were
    computed: all up to 8 dimensions, else those that the signs of the derivatives name on some row, and their
    opposites. `high` and `low` (n,) are the greatest and least exact deviation of these on each row; NaN
    where one of them does not close. `changes` (tried, dimensions) are the corners, and `deviations` (tried,
    n) theirs.
    """

    linear: Linear
    corners: int
    changes: Floats = field(repr=False)
    deviations: Floats = field(repr=False)

    @property
    def tried(self) -> int:
        """How many corners were computed."""
        return len(self.changes)

    @property
    def high(self) -> Floats:
        """The greatest exact deviation of the corners on each row (n,)."""
        return np.asarray(self.deviations.max(axis=0))

    @property
    def low(self) -> Floats:
        """The least exact deviation of the corners on each row (n,)."""
        return np.asarray(self.deviations.min(axis=0))

    @property
    def at(self) -> int:
        """The place among the rows where the linear estimate is greatest."""
        return self.linear.greatest

    @property
    def corner(self) -> dict[str, float]:
        """The dimensions of the design that deviates most upwards at `at`, or of one that does not close."""
        return self._dimensions(self._place(np.argmax))

    @property
    def corner_low(self) -> dict[str, float]:
        """The same downwards."""
        return self._dimensions(self._place(np.argmin))

    @property
    def opposite(self) -> bool:
        """Whether these two have opposite errors."""
        high, low = (self.changes[self._place(pick)] for pick in (np.argmax, np.argmin))
        return bool((high == -low).all())

    @property
    def open(self) -> int:
        """How many of the corners that were computed do not close at `at`."""
        return int(np.isnan(self.deviations[:, self.at]).sum())

    def _place(self, pick: object) -> int:
        # both take NaN for the most
        return int(pick(self.deviations[:, self.at]))  # type: ignore[operator]

    def _dimensions(self, place: int) -> dict[str, float]:
        widths = self.linear.tolerances.widths
        return {
            dimension.name: dimension.value + float(change)
            for dimension, change, width in zip(
                self.linear.found.dimensions, self.changes[place], widths, strict=True
            )
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
    progress: Progress = silent,
) -> WorstCase:
    """The worst case of an output along the cycle; the arguments are those of `linear_estimate`.

    `progress` is called with (corners done, of how many, "").

    >>> import numpy as np
    >>> import sevenbar as sb
    >>> found = worst_case(sb.load("rssr"), {"L1": 0.5, "L2": 0.5})
    >>> found.tried, bool(np.degrees(found.high).max() < 0.5), abs(found.difference) < 0.01
    (4, True, True)
    """
    linear = (
        given if isinstance(given, Linear) else linear_estimate(of, given, output=output, quantity=quantity)
    )
    changes, corners = corners_of(linear)
    designs, course = ChangedDesigns(linear), SearchCourse(len(changes), progress)
    deviations = np.empty((len(changes), len(linear.rows)))
    for part, result, _ in designs.in_blocks(changes, BLOCK):
        deviations[part] = result
        course.step(done=len(changes[part]))
    return WorstCase(linear, corners, changes, deviations)


def corners_of(linear: Linear) -> tuple[Floats, int]:
    """The changes (m, dimensions) of the corners that are computed, and how many corners there are."""
    widths = linear.tolerances.widths
    own: Integers = np.flatnonzero(widths)
    if len(own) <= MOST_DIMENSIONS:
        changes = np.zeros((2 ** len(own), len(widths)))
        changes[:, own] = np.array(list(product((-1.0, 1.0), repeat=len(own)))) * widths[own]
        return changes, len(changes)
    signs = np.where(linear.slopes[:, own] < 0, -1.0, 1.0)
    named = np.unique(np.concatenate([signs, -signs]), axis=0)
    changes = np.zeros((len(named), len(widths)))
    changes[:, own] = named * widths[own]
    return changes, 2 ** len(own)
