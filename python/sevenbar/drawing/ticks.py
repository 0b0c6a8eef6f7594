"""Where an axis has its ticks and where it ends: angles by 45 and 90 degrees, rounding as a flat line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.ticker import Locator, MaxNLocator

from sevenbar.arrays import Floats

#: Steps [deg] that people read angles by, from 5 deg on.
DEGREE_STEPS = (5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0)

#: A curve that varies less than this share of its natural size is drawn flat: what is left is rounding.
FLAT = 1e-6

#: What a person would call a large angle [deg]: the natural size of angles.
NATURAL_ANGLE = 90.0


class DegreeLocator(Locator):
    """Ticks at steps by which people read angles, at most so many."""

    def __init__(self, most: int) -> None:
        self.most = most

    def __call__(self) -> Sequence[float]:
        """The ticks between the ends of the axis."""
        assert self.axis is not None
        low, high = self.axis.get_view_interval()
        return self._between(low, high, min(self.most, max(2, self.axis.get_tick_space())))

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        """The ticks between two angles [deg]."""
        return self._between(vmin, vmax, self.most)

    def _between(self, vmin: float, vmax: float, most: int) -> Sequence[float]:
        low, high = sorted((float(vmin), float(vmax)))
        if (high - low) / most <= DEGREE_STEPS[0] / 2:
            return MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        for step in (*DEGREE_STEPS, *(360.0 * k for k in (2, 5, 10, 20, 50, 100, 1000))):
            first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
            if last - first < most:
                break
        return [k * step for k in range(first, last + 1)]


def settle(values: Floats, natural: float) -> Floats:
    """The values, all equal to their mean where they vary by rounding only; a mean that is rounding is zero.

    `natural` is the size of a large value. Those that are NaN stay so.
    """
    known = values[np.isfinite(values)]
    if not known.size or np.ptp(known) > FLAT * natural:
        return values
    mean = float(known.mean())
    return np.where(np.isfinite(values), 0.0 if abs(mean) <= FLAT * natural else mean, np.nan)


def widen(axis: Any, natural: float) -> None:
    """Gives the axis of a flat curve a scale on which its rounding is nothing; leaves others as they are."""
    low, high = axis.get_data_interval()
    if np.isfinite([low, high]).all() and abs(high - low) <= FLAT * natural:
        middle = (low + high) / 2
        half = 0.1 * max(abs(middle), natural) or 1.0
        axis.axes.set(**{f"{axis.axis_name}lim": (middle - half, middle + half)})
