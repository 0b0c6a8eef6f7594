"""The least root mean square of vectors that are affine in a point of a box, with its proof."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import of_extra


def least_squares_in(constant: Floats, gradient: Floats, low: Floats, high: Floats) -> tuple[Floats, float]:
    """The point of a box with the least root mean square of |constant + gradient @ x|, and a bound below it.

    The mean square f is convex, so that no point y has less than `f(x) + grad f(x) . (y - x)`.
    """
    with of_extra("design", "least squares in a box need scipy"):
        from scipy.optimize import lsq_linear
    centre, half = (low + high) / 2, (high - low) / 2
    share = 1 / math.sqrt(len(constant))
    matrix = share * (gradient * half).reshape(-1, 3)
    right = -share * (constant + gradient @ centre).ravel()
    # three numbers are enough of the many rows
    rotation, small = np.linalg.qr(matrix)
    y = np.clip(lsq_linear(small, rotation.T @ right, (-1.0, 1.0), method="bvls", tol=1e-15).x, -1.0, 1.0)
    left = matrix @ y - right
    slope = 2 * matrix.T @ left
    bound = float(left @ left) - float(np.where(slope > 0, slope * (y + 1), slope * (y - 1)).sum())
    return np.clip(centre + half * y, low, high), math.sqrt(max(0.0, bound))
