"""The least greatest size of vectors that are affine in numbers which cones bound.

    minimise t   subject to   |c_k + G_k x| <= t  for all k,   right - matrix x  in cones                 (21)

Clarabel's interior-point method finds x and the dual vectors, from which callers compute a lower bound of
their own.

Source: docs/theory_forces.md, (21); Boyd and Vandenberghe, Convex Optimization, 4.4.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import of_extra

#: What is required of Clarabel, relative and absolute, in scaled variables; below, rounding is in its way.
TOLERANCE = 1e-9

#: Most steps of the interior-point method; some 15 are usual.
MOST_STEPS = 200


@dataclass(frozen=True, eq=False)
class Bounds:
    """Where k numbers x may lie: of `right - matrix @ x`, (m,), the first `lines` rows are >= 0.

    The others are in second-order cones of these `sizes`, each `first >= |rest|`.
    """

    matrix: Floats
    right: Floats
    lines: int
    sizes: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class ConeOptimum:
    """Numbers x (k,), dual vectors (n, d) whose sizes have the sum 1, and what Clarabel says.

    `primal` and `dual` are its objectives, `residual` the larger of its two residuals.
    """

    x: Floats
    duals: Floats
    status: str
    steps: int
    primal: float
    dual: float
    residual: float


def least_greatest_size(constant: Floats, gradient: Floats, bounds: Bounds, *, who: str) -> ConeOptimum:
    """The x (k,) with the least greatest |constant + gradient @ x|; (n, d), (n, d, k), sizes about 1.

    Raises `MissingExtraError` without Clarabel or SciPy, which `who` needs.
    """
    with of_extra("design", f"{who} needs clarabel and scipy"):
        import clarabel
        from scipy import sparse
    count, size, numbers = gradient.shape
    # rows of (t, c + G x) in the cone, then the bounds; slack = right - matrix @ (x, t)
    cones = np.zeros((count, size + 1, numbers + 1))
    cones[:, 0, numbers] = -1.0
    cones[:, 1:, :numbers] = -gradient
    sides = np.hstack([bounds.matrix, np.zeros((len(bounds.matrix), 1))])
    matrix = np.vstack([cones.reshape(-1, numbers + 1), sides])
    right = np.concatenate([np.hstack([np.zeros((count, 1)), constant]).ravel(), bounds.right])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = MOST_STEPS
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix((numbers + 1, numbers + 1)),
        np.concatenate([np.zeros(numbers), [1.0]]),
        sparse.csc_matrix(matrix),
        right,
        [
            *[clarabel.SecondOrderConeT(size + 1)] * count,
            clarabel.NonnegativeConeT(bounds.lines),
            *[clarabel.SecondOrderConeT(own) for own in bounds.sizes],
        ],
        settings,
    )
    result = solver.solve()
    duals = -np.array(result.z)[: (size + 1) * count].reshape(count, size + 1)[:, 1:]
    total = float(np.linalg.norm(duals, axis=1).sum()) or 1.0
    return ConeOptimum(
        x=np.array(result.x)[:numbers],
        duals=duals / total,
        status=str(result.status),
        steps=int(result.iterations),
        primal=float(result.obj_val),
        dual=float(result.obj_val_dual),
        residual=max(float(result.r_prim), float(result.r_dual)),
    )
