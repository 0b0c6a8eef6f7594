"""Rigid motions as matrices."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats


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


def turns_about(axis: int, angle: Floats) -> Floats:
    """Rotations (n, 4, 4) about x, y or z by angles (n,)."""
    matrices = np.tile(np.eye(4), (len(angle), 1, 1))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrices[:, a, a] = matrices[:, b, b] = np.cos(angle)
    matrices[:, b, a], matrices[:, a, b] = np.sin(angle), -np.sin(angle)
    return matrices


def slides_along(axis: int, distance: Floats) -> Floats:
    """Translations (n, 4, 4) along x, y or z by distances (n,)."""
    matrices = np.tile(np.eye(4), (len(distance), 1, 1))
    matrices[:, axis, 3] = distance
    return matrices


def axis_to_z(axis: int) -> Floats:
    """The frame (4, 4) whose z is x, y or z of another."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.roll(np.eye(3), 2 - axis, axis=1)
    return matrix
