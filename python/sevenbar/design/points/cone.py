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
from sevenbar.errors import MissingExtraError

#: What is required of Clarabel, relative and absolute, in scaled variables; below, rounding is in its way.
TOLERANCE = 1e-9

#: Most steps of the interior-point method; some 15 are usual.
MOST_STEPS = 200


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
    try:
        import clarabel
        from scipy import sparse
    except ImportError:
        raise MissingExtraError(
            "the least point needs clarabel and scipy; install them with: pip install 'sevenbar[design]'"
        ) from None
    count = len(constant)
    centre, half = (low + high) / 2, (high - low) / 2
    # x = centre + half y, sizes relative to the greatest at the centre
    middle, slopes = constant + gradient @ centre, gradient * half
    scale = float(np.linalg.norm(middle, axis=1).max() + np.abs(slopes).max()) or 1.0
    # rows of (t, c + G y) in the cone, then the box; slack = right - matrix @ (y, t)
    cones = np.zeros((count, 4, 4))
    cones[:, 0, 3] = -1.0
    cones[:, 1:, :3] = -slopes / scale
    sides = np.hstack([np.vstack([np.eye(3), -np.eye(3)]), np.zeros((6, 1))])
    matrix = np.vstack([cones.reshape(-1, 4), sides])
    right = np.concatenate([np.hstack([np.zeros((count, 1)), middle / scale]).ravel(), np.ones(6)])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = MOST_STEPS
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix((4, 4)),
        np.array([0.0, 0.0, 0.0, 1.0]),
        sparse.csc_matrix(matrix),
        right,
        [clarabel.SecondOrderConeT(4)] * count + [clarabel.NonnegativeConeT(6)],
        settings,
    )
    found = solver.solve()
    at = np.clip(centre + half * np.array(found.x)[:3], low, high)
    dual = -np.array(found.z)[: 4 * count].reshape(count, 4)[:, 1:]
    sizes = np.linalg.norm(dual, axis=1)
    total = float(sizes.sum()) or 1.0
    return ConeSolution(
        at=at,
        bound=lower_bound(constant, gradient, low, high, dual / total),
        weights=sizes / total,
        status=str(found.status),
        steps=int(found.iterations),
        primal=float(found.obj_val) * scale,
        dual=float(found.obj_val_dual) * scale,
        residual=max(float(found.r_prim), float(found.r_dual)),
    )


def lower_bound(constant: Floats, gradient: Floats, low: Floats, high: Floats, dual: Floats) -> float:
    """What the greatest size is not below anywhere in the box, by dual vectors (n, 3) with `sum |y| <= 1`.

    Source: docs/theory_design.md, (18).
    """
    centre = (low + high) / 2
    slope = np.einsum("ki,kij->j", dual, gradient)
    # from the centre, so that what rounding leaves of the slope counts by half a side
    return max(0.0, float((dual * (constant + gradient @ centre)).sum() - np.abs(slope) @ (high - low) / 2))
