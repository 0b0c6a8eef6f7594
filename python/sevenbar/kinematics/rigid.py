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
