"""The least greatest size of vectors that are affine in a point of a box: cones, and a proof.

    minimise t   subject to   |c_k + G_k x| <= t  for all k,   low <= x <= high

Clarabel's interior-point method finds x. The statement of how good it is does not depend on the solver: any
vectors y_k with `sum |y_k| <= 1` give a lower bound that no point of the box goes below,

    t >= sum y_k . c_k + sum_j min(h_j low_j, h_j high_j),   h = sum G_k^T y_k

and the solver's dual variables, brought to `sum |y_k| = 1`, make it the greatest. The bound is evaluated
here.

Source: docs/theory_design.md, (17) and (18).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.cones import Bounds, least_greatest_size


@dataclass(frozen=True, eq=False)
class ConeSolution:
    """A point (3,), the lower bound over the box, and what Clarabel says.

    `weights` (n,) are the sizes of the dual vectors, whose sum is 1: 0 but at rows that decide. `primal` and
    `dual` are Clarabel's objectives, `residual` the larger of its two residuals, in scaled variables.
    """

    at: Floats
    bound: float
    weights: Floats
    status: str
    steps: int
    primal: float
    dual: float
    residual: float


def least_greatest(constant: Floats, gradient: Floats, low: Floats, high: Floats) -> ConeSolution:
    """The point of a box with the least greatest |constant + gradient @ x|; (n, 3), (n, 3, 3), (3,), (3,).

    Raises `MissingExtraError` without Clarabel or SciPy.

    Source: Boyd and Vandenberghe, Convex Optimization, 4.4.2 and 5.9.1.
    """
    centre, half = (low + high) / 2, (high - low) / 2
    # x = centre + half y, sizes relative to the greatest at the centre
    middle, slopes = constant + gradient @ centre, gradient * half
    scale = float(np.linalg.norm(middle, axis=1).max() + np.abs(slopes).max()) or 1.0
    box = Bounds(np.vstack([np.eye(3), -np.eye(3)]), np.ones(6), 6)
    found = least_greatest_size(middle / scale, slopes / scale, box, who="the least point")
    return ConeSolution(
        at=np.clip(centre + half * found.x, low, high),
        bound=lower_bound(constant, gradient, low, high, found.duals),
        weights=np.linalg.norm(found.duals, axis=1),
        status=found.status,
        steps=found.steps,
        primal=found.primal * scale,
        dual=found.dual * scale,
        residual=found.residual,
    )


def lower_bound(constant: Floats, gradient: Floats, low: Floats, high: Floats, dual: Floats) -> float:
    """What the greatest size is not below anywhere in the box, by dual vectors (n, 3) with `sum |y| <= 1`.

    Source: docs/theory_design.md, (18).
    """
    centre = (low + high) / 2
    slope = np.einsum("ki,kij->j", dual, gradient)
    # from the centre, so that what rounding leaves of the slope counts by half a side
    return max(0.0, float((dual * (constant + gradient @ centre)).sum() - np.abs(slope) @ (high - low) / 2))
