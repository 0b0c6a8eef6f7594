"""How a link turns along a circuit, from the motions of its points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, ReadOnly
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.loop.rigid import axial
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False, repr=False)
class LinkMotion(ReadOnly, Printed):
    """How a link turns along a circuit, in the report frame.

    `rotation` (n, 3, 3), its axes as columns; `velocity` [rad/s] and `acceleration` [rad/s^2] are vectors
    (n, 3). Rows without a value are NaN.
    """

    rotation: Floats
    velocity: Floats
    acceleration: Floats


#: A point of a link by its coordinates (3,), along a circuit.
Traced = Callable[[Floats], Trace]


def rates_of_frame(point: Traced, size: float) -> Callable[[str], tuple[Floats, Floats]]:
    """The origin (n, 3) and the axes (n, 3, 3) of the frame in which points are given, or rates of them.

    By what a trace has: "position", "velocity", .. The axes are those of points as far off as the linkage's
    `size` [length], so that differences lose nothing.
    """
    traces = [point(place) for place in (np.zeros(3), *(size * np.eye(3)))]

    def of(name: str) -> tuple[Floats, Floats]:
        origin, *ends = (getattr(trace, name) for trace in traces)
        return origin, np.stack([(end - origin) / size for end in ends], axis=-1)

    return of


def link_motion(point: Traced, size: float) -> LinkMotion:
    """How a link turns whose points are traced by their coordinates, in a linkage of a size [length]."""
    of = rates_of_frame(point, size)
    turn, rate, second = (of(name)[1] for name in ("position", "velocity", "acceleration"))
    back = np.swapaxes(turn, -1, -2)
    spin = rate @ back
    return LinkMotion(turn, axial(spin), axial(second @ back + rate @ np.swapaxes(rate, -1, -2)))
