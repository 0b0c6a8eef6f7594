"""A screw for Exudyn, which has none: slide and turn of a cylindrical joint tied by one constraint."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sevenbar.linkage import pose
from sevenbar.motion import Floats
from sevenbar.prototype import GROUND, Connection


class ScrewConstraint:
    """`slide - advance * turn = 0` between two bodies whose coordinates are places and Euler parameters.

    The turn is known up to whole turns; it is taken nearest to the one before, at first to `turn`.
    """

    def __init__(self, joint: Connection, size: float, turn: float) -> None:
        self._advance = joint.advance / size
        frames = (joint.frame_before, joint.frame_after)
        self._frames = [pose(frame[:3, :3], frame[:3, 3] / size) for frame in frames]
        self._moves = [body != GROUND for body in (joint.before, joint.after)]
        self._turn = turn

    def value(
        self, _system: Any, _time: float, _item: int, q: Any, _rates: Any, _velocity_level: bool
    ) -> list[float]:
        """The constraint's value at Exudyn's coordinates."""
        (_, first), (_, second) = self._placed(q)
        sine, cosine = first[:3, 1] @ second[:3, 0], first[:3, 0] @ second[:3, 0]
        turn = math.atan2(sine, cosine)
        self._turn = turn + math.tau * round((self._turn - turn) / math.tau)
        slide = first[:3, 2] @ (second[:3, 3] - first[:3, 3])
        return [float(slide - self._advance * self._turn)]

    def slope(
        self, _system: Any, _time: float, _item: int, q: Any, _rates: Any, _velocity_level: bool
    ) -> Floats:
        """The derivatives (1, coordinates) of the value by the coordinates."""
        (first_slopes, first), (second_slopes, second) = self._placed(q)
        sine, cosine = first[:3, 1] @ second[:3, 0], first[:3, 0] @ second[:3, 0]
        square = sine * sine + cosine * cosine
        found = []
        for d_first, d_second in [(d, np.zeros((4, 4))) for d in first_slopes] + [
            (np.zeros((4, 4)), d) for d in second_slopes
        ]:
            d_sine = d_first[:3, 1] @ second[:3, 0] + first[:3, 1] @ d_second[:3, 0]
            d_cosine = d_first[:3, 0] @ second[:3, 0] + first[:3, 0] @ d_second[:3, 0]
            d_turn = (cosine * d_sine - sine * d_cosine) / square
            d_slide = d_first[:3, 2] @ (second[:3, 3] - first[:3, 3]) + first[:3, 2] @ (
                d_second[:3, 3] - d_first[:3, 3]
            )
            found.append(d_slide - self._advance * d_turn)
        return np.array([found])

    def _placed(self, q: Any) -> list[tuple[list[Floats], Floats]]:
        """The joint's frame in each body, after its derivatives by that body's coordinates."""
        coordinates = np.asarray(q)
        found: list[tuple[list[Floats], Floats]] = []
        for moves, frame in zip(self._moves, self._frames, strict=True):
            if not moves:
                found.append(([], frame))
                continue
            own, coordinates = coordinates[:7], coordinates[7:]
            slopes = []
            for k in range(3):
                slope = np.zeros((4, 4))
                slope[k, 3] = 1.0
                slopes.append(slope)
            for k in range(4):
                slope = np.zeros((4, 4))
                slope[:3, :] = _rotation(own[3:], np.eye(4)[k]) @ frame[:3, :]
                slopes.append(slope)
            placed = pose(0.5 * _rotation(own[3:], own[3:]), own[:3]) @ frame
            found.append((slopes, placed))
        return found


def _rotation(p: Floats, d: Floats) -> Floats:
    """The derivative in the direction d of the rotation matrix of Euler parameters p; at d = p, twice it."""
    scalar, vector = p[0], p[1:]
    d_scalar, d_vector = d[0], d[1:]
    return np.asarray(
        2.0 * (scalar * d_scalar - vector @ d_vector) * np.eye(3)
        + 2.0 * (np.outer(vector, d_vector) + np.outer(d_vector, vector))
        + 2.0 * (d_scalar * _skew(vector) + scalar * _skew(d_vector))
    )


def _skew(v: Floats) -> Floats:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
