"""A screw for Exudyn, which has none: slide and turn of a cylindrical joint tied by one constraint."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.prototype import GROUND, Connection
from sevenbar.kinematics.loop.rigid import pose


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
        first, second = (placed for placed, _ in self._placed(q))
        sine, cosine = first[:3, 1] @ second[:3, 0], first[:3, 0] @ second[:3, 0]
        turn = math.atan2(sine, cosine)
        self._turn = turn + math.tau * round((self._turn - turn) / math.tau)
        slide = first[:3, 2] @ (second[:3, 3] - first[:3, 3])
        return [float(slide - self._advance * self._turn)]

    def slope(
        self, _system: Any, _time: float, _item: int, q: Any, _rates: Any, _velocity_level: bool
    ) -> Floats:
        """The derivatives (1, coordinates) of the value by the coordinates."""
        (first, own_first), (second, own_second) = self._placed(q)
        sine, cosine = first[:3, 1] @ second[:3, 0], first[:3, 0] @ second[:3, 0]
        way = second[:3, 3] - first[:3, 3]
        # by the numbers of each frame: the value's linear parts, and those of the turn's tangent
        by_first, by_second = np.zeros((3, 4)), np.zeros((3, 4))
        share = self._advance / (sine * sine + cosine * cosine)
        by_first[:, 0] = share * sine * second[:3, 0]
        by_first[:, 1] = -share * cosine * second[:3, 0]
        by_first[:, 2] = way
        by_first[:, 3] = -first[:3, 2]
        by_second[:, 0] = share * (sine * first[:3, 0] - cosine * first[:3, 1])
        by_second[:, 3] = first[:3, 2]
        result: list[float] = []
        for moves, frame, own, by in zip(
            self._moves, self._frames, (own_first, own_second), (by_first, by_second), strict=True
        ):
            if moves:
                # a frame is R(p) frame + place
                result += list(by[:, 3])
                result += [float(np.vdot(by, _rotation(own[3:], d) @ frame[:3, :])) for d in np.eye(4)]
        return np.array([result])

    def _placed(self, q: Any) -> list[tuple[Floats, Floats]]:
        """The joint's frame in each body, and that body's own coordinates, none of the ground."""
        coordinates = np.asarray(q)
        result: list[tuple[Floats, Floats]] = []
        for moves, frame in zip(self._moves, self._frames, strict=True):
            if moves:
                own, coordinates = coordinates[:7], coordinates[7:]
                result.append((pose(0.5 * _rotation(own[3:], own[3:]), own[:3]) @ frame, own))
            else:
                result.append((frame, coordinates[:0]))
        return result


def _rotation(p: Floats, d: Floats) -> Floats:
    """The derivative in the direction d of the rotation matrix of Euler parameters p; at d = p, twice it."""
    (a, b, c, e), (da, db, dc, de) = p.tolist(), d.tolist()
    even = a * da - b * db - c * dc - e * de
    xy, xz, yz = b * dc + c * db, b * de + e * db, c * de + e * dc
    x, y, z = a * db + b * da, a * dc + c * da, a * de + e * da
    return 2.0 * np.array(
        [
            [even + 2 * b * db, xy - z, xz + y],
            [xy + z, even + 2 * c * dc, yz - x],
            [xz - y, yz + x, even + 2 * e * de],
        ]
    )
