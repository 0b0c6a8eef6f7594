"""The least size of vectors affine in a point of a box, greatest or root mean square, with its proof.

    minimise t   subject to   |c_k + G_k x| <= t  for all k,   low <= x <= high

Clarabel's interior-point method finds x. The statement of how good it is does not depend on the solver: any
vectors y_k with `sum |y_k| <= 1` give a lower bound that no point of the box goes below,

    t >= sum y_k . c_k + sum_j min(h_j low_j, h_j high_j),   h = sum G_k^T y_k

and the solver's dual variables, brought to `sum |y_k| = 1`, make it the greatest. The bound is evaluated
here.

Source: docs/theory_design.md, (17) and (18).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import of_extra
from sevenbar.forces.cones import Bounds, ConeOptimum, least_greatest_size


class LeastInBox(NamedTuple):
    """A point (3,), the lower bound over the box, and what Clarabel says, in the vectors' own unit.

    The sizes of the `duals` are 0 but at rows that decide.
    """

    at: Floats
    bound: float
    solver: ConeOptimum


def least_greatest(constant: Floats, gradient: Floats, low: Floats, high: Floats) -> LeastInBox:
    """The point of a box with the least greatest |constant + gradient @ x|; (n, 3), (n, 3, 3), (3,), (3,).

    Raises `MissingExtraError` without Clarabel or SciPy.

    Source: Boyd and Vandenberghe, Convex Optimization, 4.4.2 and 5.9.1.
    """
    centre, half = (low + high) / 2, (high - low) / 2
    # x = centre + half y, sizes relative to the greatest at the centre
    middle, slopes = constant + gradient @ centre, gradient * half
    scale = float(np.linalg.norm(middle, axis=1).max() + np.abs(slopes).max()) or 1.0
    box = Bounds(np.vstack([np.eye(3), -np.eye(3)]), np.ones(6), 6)
    result = least_greatest_size(middle / scale, slopes / scale, box, who="the least point")
    bound = lower_bound(constant, gradient, low, high, result.duals)
    scaled = replace(result, primal=result.primal * scale, dual=result.dual * scale)
    return LeastInBox(np.clip(centre + half * result.x, low, high), bound, scaled)


def lower_bound(constant: Floats, gradient: Floats, low: Floats, high: Floats, dual: Floats) -> float:
    """What the greatest size is not below anywhere in the box, by dual vectors (n, 3) with `sum |y| <= 1`.

    Source: docs/theory_design.md, (18).
    """
    centre = (low + high) / 2
    slope = np.einsum("ki,kij->j", dual, gradient)
    # from the centre, so that what rounding leaves of the slope counts by half a side
    return max(0.0, float((dual * (constant + gradient @ centre)).sum() - np.abs(slope) @ (high - low) / 2))


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
