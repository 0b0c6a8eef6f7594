"""Slots of joints as drawn, which run across their pins."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sevenbar.errors import Problem, shown
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.kinematics.loop.rigid import unit

#: A slot this far from square to its pin [rad] is refused; of one that is closer the share across it counts.
ASLANT = 1e-3


def slots_aslant(kind: str, axes: Sequence[Sequence[float]] | None, place: str) -> list[Problem]:
    """What is wrong with the axes of a joint with a slot that does not run across its pin."""
    if not axes or not KINDS[kind].has_slot:
        return []
    apart = angle_between(*axes)
    if abs(apart - math.pi / 2) <= ASLANT:
        return []
    written = shown([list(axis) for axis in axes])
    message = f"{written} are {math.degrees(apart):.3g} deg apart; a slot is square to its pin"
    return [Problem(f"{place}.axes", message)]


def angle_between(first: Sequence[float], second: Sequence[float]) -> float:
    """The angle [rad] from one axis to another."""
    a, b = unit(first), unit(second)
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
