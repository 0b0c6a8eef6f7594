"""How a link turns along a circuit, from the motions of its points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuit_values import Trace
from sevenbar.kinematics.rigid import axial
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False, repr=False)
class LinkMotion(Printed):
    """How a link turns along a circuit, in the report frame.

    `rotation` (n, 3, 3), its axes as columns; `velocity` [rad/s] and `acceleration` [rad/s^2] are vectors
    (n, 3). Rows without a value are NaN.
    """

    rotation: Floats
    velocity: Floats
    acceleration: Floats


def link_motion(point: Callable[[Floats], Trace], size: float) -> LinkMotion:
    """How a link turns whose points are traced by their coordinates (3,), in a linkage of a size [length]."""
    # the axes of the link's frame as far points, so that differences lose nothing
    traces = [point(place) for place in (np.zeros(3), *(size * np.eye(3)))]

    def axes(name: str) -> Floats:
        origin, *ends = (getattr(trace, name) for trace in traces)
        return np.stack([(end - origin) / size for end in ends], axis=-1)

    turn, rate, second = axes("position"), axes("velocity"), axes("acceleration")
    back = np.swapaxes(turn, -1, -2)
    spin = rate @ back
    return LinkMotion(turn, axial(spin), axial(second @ back + rate @ np.swapaxes(rate, -1, -2)))
