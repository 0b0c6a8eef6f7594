"""What a design must keep to besides its task: transmission angle, size, motion type; as inequalities too."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.closure import transmission_slopes, transmissions
from sevenbar.errors import RequestError, check_word

#: What a linkage can be asked to be, seen from its input.
MOTION_TYPES = ("crank-rocker", "double-crank", "rocker-crank", "double-rocker")

#: Motion types whose input turns fully.
INPUT_TURNS = ("crank-rocker", "double-crank")

#: Longest dimension over shortest link where no size is given: beyond, nobody could build it.
MOST_RATIO = 20.0

#: Length of the longest dimension where no size is given [mm].
USUAL_SIZE = 1000.0

#: Room that is left at each limit for what lies between the inputs looked at [rad, or of the squared sine].
MARGIN = 1e-4

#: Inputs of a full turn at which a crank must be able to stand: the worst lies less than 0.1% of W's
#: amplitude below the least of them.
TURN_SAMPLES = 72


@dataclass(frozen=True)
class Limits:
    """Limits of a design; each that is not given lets everything pass.

    `transmission_lowest` [rad]: the least transmission angle over the range of the input that is used.
    `size` (low, high) [length]: no link shorter than `low`, no dimension longer than `high`.
    `motion_type`: one of `MOTION_TYPES`, of the linkage as its input drives it. Raises `RequestError`.
    """

    transmission_lowest: float = 0.0
    size: tuple[float, float] | None = None
    motion_type: str | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.transmission_lowest < math.pi / 2:
            degrees = math.degrees(self.transmission_lowest)
            raise RequestError(
                f"transmission: {degrees:g} deg is no limit; give an angle from 0 to below 90 deg"
            )
        if self.size is not None:
            low, high = self.size
            if not (0 < low < high and math.isfinite(high)):
                raise RequestError(
                    f"size: {low:g}:{high:g} is no range of lengths; give the shortest link and the longest "
                    "dimension, as in 50:1000"
                )
        if self.motion_type is not None:
            check_word("motion type", self.motion_type, MOTION_TYPES)

    def flaw(self, form: str) -> str:
        """What is wrong with the transmission angle for linkages of a form; empty where nothing is."""
        if self.transmission_lowest == 0.0 or form == "rssr":
            return ""
        return (
            "its angle is that of an RSSR given by its dimensions, [rssr]; leave the limit out, or write a "
            "task for `sevenbar design task`, whose [limits] hold it for any loop that has the angle"
        )

    @property
    def ratio(self) -> float:
        """The most that the longest dimension may be of the shortest link."""
        return MOST_RATIO if self.size is None else self.size[1] / self.size[0]

    @property
    def longest(self) -> float:
        """The length that the longest dimension gets where the task leaves the scale open."""
        return USUAL_SIZE if self.size is None else self.size[1]

    def text(self) -> str:
        """The limits in words."""
        parts = []
        if self.transmission_lowest:
            parts.append(f"transmission angle >= {math.degrees(self.transmission_lowest):g} deg")
        if self.size is not None:
            parts.append(f"links >= {self.size[0]:g}, dimensions <= {self.size[1]:g}")
        if self.motion_type is not None:
            parts.append(self.motion_type)
        return "; ".join(parts) or "none"


def transmission_slack(row: Floats, inputs: Floats, limits: Limits) -> tuple[Floats, Floats, Floats]:
    """sin^2 of the transmission angle less that of its limit at inputs (m,); must not be negative.

    With its derivatives by the dimensions (m, 6) and by the input (m,). Where no limit is given the input
    must be reached at least. A margin is left.
    """
    by_dimension, by_input = transmission_slopes(row[None], inputs)
    least = max(math.sin(limits.transmission_lowest + MARGIN) ** 2, MARGIN)
    return transmissions(row[None], inputs)[0] - least, by_dimension[0], by_input[0]


def turning_slack(row: Floats) -> tuple[Floats, Floats]:
    """sin^2 of the transmission angle over a full turn of the input (72,), less a margin, and slopes (72, 6).

    Where none is negative the input turns fully.
    """
    inputs = np.arange(TURN_SAMPLES) * math.tau / TURN_SAMPLES
    return transmissions(row[None], inputs)[0] - MARGIN, transmission_slopes(row[None], inputs)[0][0]
