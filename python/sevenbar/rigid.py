"""Rigid motions as homogeneous matrices (4, 4), and twists (6,): angular part, then linear part."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats

#: Below this share of the way to a place the place lies on an axis.
ON_AXIS = 1e-12


def pose(rotation: npt.ArrayLike, origin: npt.ArrayLike) -> Floats:
    """The homogeneous matrix (4, 4) with these columns of axes and this origin."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = origin
    return matrix


def inverse(matrix: Floats) -> Floats:
    """The inverse of a rigid motion."""
    rotation = matrix[:3, :3].T
    return pose(rotation, -rotation @ matrix[:3, 3])


def about(axis: int, angle: float) -> Floats:
    """The rotation (3, 3) about an axis 0, 1, 2.

    With an exact 0 where only rounding is left: twists of 90 or 180 degrees are meant exactly.
    """
    rounding = np.finfo(float).eps * abs(angle)
    c, s = math.cos(angle), math.sin(angle)
    c, s = (0.0 if abs(c) < rounding else c), (0.0 if abs(s) < rounding else s)
    matrix = np.eye(3)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix[j, j] = matrix[k, k] = c
    matrix[j, k], matrix[k, j] = -s, s
    return matrix


def unit(vector: npt.ArrayLike | None) -> Floats:
    """The direction of a vector (3,)."""
    direction = np.asarray(vector, dtype=np.float64)
    return np.asarray(direction / math.hypot(*direction))


def frame_about(axis: npt.ArrayLike | None, towards: Floats) -> Floats:
    """Columns x, y, z: z along the axis, x across it towards a place (any where that lies on the axis)."""
    z = unit(axis)
    across = towards - (towards @ z) * z
    if np.linalg.norm(across) <= ON_AXIS * np.linalg.norm(towards):
        across = np.eye(3)[np.argmin(np.abs(z))]
        across = across - (across @ z) * z
    x = across / np.linalg.norm(across)
    # of a place almost on the axis the first step leaves little but rounding, some of it along the axis
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, cross(z, x), z])


def cross(a: Floats, b: Floats) -> Floats:
    """The vector product of two vectors (3,)."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def adjoint(matrix: Floats) -> Floats:
    """The matrix (6, 6) that takes twists of a frame (4, 4) to the frame in which that is given."""
    rotation, (x, y, z) = matrix[:3, :3], matrix[:3, 3].tolist()
    found = np.zeros((6, 6))
    found[:3, :3] = found[3:, 3:] = rotation
    found[3:, :3] = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) @ rotation
    return found
