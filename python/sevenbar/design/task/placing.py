"""Where a linkage is that may be anywhere: the best rigid motion, in words and of a drawing, and small ones.

The rigid motion that brings points P_j nearest to others w_j has the rotation of the singular vectors of
`sum (w_j - w)(P_j - P)^T` (Kabsch); with s the singular values, the last with the sign of the determinant,
the squares left are `|w|^2 + |P|^2 - 2 s`, s = s1 + s2 + s3, and with a free scale `|w|^2 - s^2 / |P|^2`.

Source: docs/theory_design.md, (28).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.description.load_moving import moved_loads
from sevenbar.kinematics.loop.rigid import cross_matrix, rotation_vector
from sevenbar.kinematics.numbers.dimensions import description_of

#: A turn [rad] below which the first terms of its series stand for the rest.
SMALL = 1e-4


@dataclass(frozen=True, eq=False)
class Placing:
    """A similarity: `scale * rotation @ P + shift`."""

    rotation: Floats
    shift: Floats
    scale: float = 1.0

    def put(self, places: Floats) -> Floats:
        """Places (.., 3) as they are moved."""
        return np.asarray(self.scale * places @ self.rotation.T + self.shift)

    def back(self, places: Floats) -> Floats:
        """Places (.., 3) as they were before."""
        return np.asarray((places - self.shift) @ self.rotation / self.scale)


STILL = Placing(np.eye(3), np.zeros(3))


def placed(wanted: Floats, reached: Floats, *, scaled: bool = False, shares: Floats | None = None) -> Placing:
    """The similarity that brings `reached` (n, 3) nearest to `wanted` (n, 3); `scaled` where it may scale.

    Squares count by their `shares` (n,), alike where none are given.
    """
    share = np.ones((len(wanted), 1)) if shares is None else shares[:, None]
    far, near = ((share * places).sum(axis=0) / share.sum() for places in (wanted, reached))
    root = np.sqrt(share)
    rotation, scale, _ = turns((root * (wanted - far))[None], (root * (reached - near))[None], scaled=scaled)
    turn, size = rotation[0], float(scale[0])
    return Placing(turn, far - size * turn @ near, size)


def turns(wanted: Floats, reached: Floats, *, scaled: bool) -> tuple[Floats, Floats, Floats]:
    """Rotations (m, 3, 3), scales (m,) and squares left (m,) for centred sets (m or 1, n, 3)."""
    left, sizes, right = np.linalg.svd(np.swapaxes(wanted, 1, 2) @ reached)
    sign = np.sign(np.linalg.det(left @ right))
    left[:, :, 2] *= sign[:, None]
    total = sizes[:, 0] + sizes[:, 1] + sign * sizes[:, 2]
    own, other = (wanted**2).sum(axis=(1, 2)), (reached**2).sum(axis=(1, 2))
    if scaled:
        spread = np.maximum(other, np.finfo(float).tiny)
        return left @ right, total / spread, own - total**2 / spread
    return left @ right, np.ones_like(total), own + other - 2 * total


def standing(placing: Placing, unit: str) -> Mapping[str, float]:
    """Where the linkage stands so that its point goes through the wanted points: a turn, then a shift.

    `turn_x`, `turn_y`, `turn_z` is the axis of one turn times its angle.
    """
    turn = np.degrees(rotation_vector(placing.rotation))
    names = [f"shift_{letter}_{unit}" for letter in "xyz"] + [f"turn_{letter}_deg" for letter in "xyz"]
    return dict(zip(names, map(float, [*placing.shift, *turn]), strict=True))


def moved(draft: Draft, placing: Placing) -> Draft:
    """A drawn linkage with all its places and directions moved."""

    def put(table: Mapping[str, object]) -> dict[str, object]:
        own = dict(table)
        for key, value in table.items():
            if key == "at":
                own[key] = [float(x) for x in placing.put(np.array(value, dtype=np.float64))]
            elif key == "axis":
                own[key] = [float(x) for x in placing.rotation @ np.array(value, dtype=np.float64)]
            elif key == "axes":
                own[key] = (np.array(value, dtype=np.float64) @ placing.rotation.T).tolist()
        return own

    described = description_of(draft.linkage)  # with numbers where the file has formulas
    draft = draft.with_value(("joint",), [put(joint) for joint in described["joint"]])
    if "point" in described:
        draft = draft.with_value(("point",), [put(point) for point in described["point"]])
    for head, tables in moved_loads(described, placing.put, placing.rotation).items():
        draft = draft.with_value((head,), tables)
    return draft


def rigid_moves(places: Floats) -> Floats:
    """The small rigid motions (3 n, 6) of places (n, 3): three shifts, three turns."""
    moves = np.zeros((len(places), 3, 6))
    moves[:, :, :3] = np.eye(3) * float(np.abs(places).max())
    for axis, unit in enumerate(np.eye(3)):
        moves[:, :, 3 + axis] = np.cross(unit, places)
    return moves.reshape(-1, 6)


def rotation_of_vector(turn: Floats) -> Floats:
    """The rotation (3, 3) about an axis by its length [rad]."""
    angle, own = float(np.linalg.norm(turn)), cross_matrix(turn)
    half = 0.5 * np.sinc(angle / math.tau) ** 2
    return np.asarray(np.eye(3) + np.sinc(angle / math.pi) * own + half * own @ own)


def left_jacobian(turn: Floats) -> Floats:
    """J (3, 3): rotations near that of a turn (3,) are a turn by `J d` of it, where the turn changes by d."""
    angle = float(np.linalg.norm(turn))
    third = 1 / 6 - angle**2 / 120 if angle < SMALL else (angle - math.sin(angle)) / angle**3
    own = cross_matrix(turn)
    return np.asarray(np.eye(3) + 0.5 * np.sinc(angle / math.tau) ** 2 * own + third * own @ own)
