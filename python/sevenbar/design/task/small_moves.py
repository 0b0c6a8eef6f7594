"""Small rigid motions of places, and turns by a vector with their slopes."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.rigid import cross_matrix

#: A turn [rad] below which the first terms of its series stand for the rest.
SMALL = 1e-4


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
