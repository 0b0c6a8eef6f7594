"""RSSR designs through given pairs of angles, exactly: three to seven precision points in closed form.

With the dials' readings a, b and their zeros u, v (alpha = u + a, beta = v + b), the closure over L1 L3 is

    k0 - k1 cos alpha - k2 sin alpha + k3 cos beta - k4 sin beta = sin alpha cos beta                    (1)
    k0 = (M^2 + N^2 + L1^2 + L3^2 + D^2 - L2^2) / (2 L1 L3)
    k1 = M / L3,   k2 = D / L3,   k3 = D / L1,   k4 = N / L1

linear in five numbers that are free of each other, as many as the ratios of the six dimensions. So

- five points and both zeros given: one linear system, one design;
- four: a line of designs, three: a plane. With D = 0 (then k2 = k3 = 0) three points give one linear system,
  and L1 / L3 stays free: such designs share one function and differ in transmission;
- six: the zeros turn (cos, sin) of a and of b among themselves, so with the left null vector of the rows
  (1, cos a, sin a, cos b, sin b) one equation is left of (1), bilinear in (cos u, sin u) and
  (cos v, -sin v): each u has its one v;
- seven: two such equations, whose determinant is a quadratic in tan u: two designs at most.

Zeros count mod pi: half a turn of u is L1 < 0. A point reflection of the linkage (M, N, D negative, both
zeros half a turn on) has the same function; of the two the one with M >= 0 is kept.

`sevenbar.design.exact.function` has axes at any angle, and all linkages that there are; this has starts for a
search, a thousand at a time, so each solves its own form of the closure.

Source: docs/theory_design.md, (23) to (25).
"""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.wish import FEWEST, FIXED_ZEROS_MOST, FREE_ZEROS_MOST

#: Rank of a system of points, relative to its greatest singular value, below which points repeat each other.
RANK = 1e-10

#: Share of L1 (or 1 / L1) in L3 beyond which a design of few points is not tried.
FARTHEST = 20.0


def system(inputs: Floats, outputs: Floats) -> tuple[Floats, Floats]:
    """The rows (.., n, 5) of (1) and its right sides (.., n) at angles of the linkage (.., n) [rad]."""
    ca, sa, cb, sb = np.cos(inputs), np.sin(inputs), np.cos(outputs), np.sin(outputs)
    return np.stack([np.ones_like(ca), -ca, -sa, cb, -sb], axis=-1), sa * cb


def designs_of(k: Floats, zeros: Floats, ratios: Floats | None = None) -> tuple[Floats, Floats]:
    """Designs (m, 6) with L3 = 1 and their zeros (m, 2), of coefficients (n, 5) and zeros (n, 2) [rad].

    `ratios` (n,) are L1 / L3 where D = 0, which leaves them free. Coefficients without a design, whose
    coupler would have no length, are left out.
    """
    with np.errstate(all="ignore"):
        l1 = k[:, 2] / k[:, 3] if ratios is None else ratios
        n = k[:, 4] * l1
        l2 = np.sqrt(k[:, 1] ** 2 + n**2 + l1**2 + 1.0 + k[:, 2] ** 2 - 2 * k[:, 0] * l1)
    rows = np.column_stack([k[:, 1], n, l1, l2, np.ones_like(l1), k[:, 2]])
    zeros = zeros + np.column_stack([np.where(l1 < 0, math.pi, 0.0), np.zeros_like(l1)])
    rows[:, 2] = np.abs(rows[:, 2])
    good = np.isfinite(rows).all(axis=1) & (rows[:, 2] > 0) & (l2 > 0)
    return rows[good], zeros[good]


def reflected(rows: Floats, zeros: Floats) -> tuple[Floats, Floats]:
    """Designs (n, 6) and zeros (n, 2), those with M < 0 by the point reflection that has their function."""
    turn = rows[:, 0] < 0
    rows = np.where(turn[:, None], rows * [-1, -1, 1, 1, 1, -1], rows)
    zeros = np.where(turn[:, None], zeros + math.pi, zeros)
    return rows, short_way(zeros)


def through(
    inputs: Floats,
    outputs: Floats,
    *,
    zeros: tuple[float, float] | None = None,
    samples: int = 1024,
    seed: int = 0,
) -> tuple[Floats, Floats]:
    """Designs (m, 6), L3 = 1, through the pairs of readings (n,) [rad], and their zeros (m, 2) [rad].

    Three to seven pairs; with `zeros` given, to five. Where they leave a family of designs, `samples` of it
    are given, from a Sobol sequence. A design closes at all pairs but may need both branches for them: that
    is for the check. None where the pairs contradict each other.
    """
    from scipy.stats import qmc

    count = len(inputs)
    draws = qmc.Sobol(5, seed=seed).random(samples)
    if count <= FIXED_ZEROS_MOST:
        pairs = draws[:, :2] * math.pi
        if zeros is not None:
            pairs = np.tile(zeros, (1 if count == FIXED_ZEROS_MOST else samples, 1))
        rows, pairs = _few(inputs, outputs, pairs, draws[: len(pairs), 2:])
        if zeros is None:
            return reflected(rows, pairs)
        # half a turn on is another zero than the one given
        own = np.abs(np.cos(pairs[:, 0] - zeros[0]) - 1.0) < RANK
        return rows[own], pairs[own]
    first = draws[:, 0] * math.pi
    null, products = _zero_equations(inputs, outputs)
    if null.shape[1] != count - 5:
        return np.empty((0, 6)), np.empty((0, 2))
    # (equations, 2, 2)
    g = np.einsum("ne,jkn->ejk", null, products)
    if count == FREE_ZEROS_MOST:
        first = null_angles(np.outer(g[0, :, 0], g[1, :, 1]) - np.outer(g[0, :, 1], g[1, :, 0]))
    u = np.stack([np.cos(first), np.sin(first)])
    w = g[0].T @ u
    pairs = np.column_stack([first, np.arctan2(-w[0], -w[1])])
    sides, right = system(inputs + pairs[:, :1], outputs + pairs[:, 1:])
    return reflected(*designs_of(np.einsum("mij,mj->mi", np.linalg.pinv(sides), right), pairs))


def _few(inputs: Floats, outputs: Floats, zeros: Floats, draws: Floats) -> tuple[Floats, Floats]:
    """Designs through three to five pairs with zeros (m, 2) given; `draws` (m, 3) choose among them."""
    count = len(inputs)
    rows, right = system(inputs + zeros[:, :1], outputs + zeros[:, 1:])
    left, sizes, base = np.linalg.svd(rows)
    sound = sizes[:, -1] > RANK * sizes[:, 0]
    rows, right, zeros, draws = rows[sound], right[sound], zeros[sound], draws[sound]
    left, sizes, base = left[sound], sizes[sound], base[sound]
    k = np.einsum("mij,mi->mj", base[:, :count], np.einsum("mji,mj->mi", left, right) / sizes)
    # tangents reach everywhere, and mostly near
    steps = np.tan((draws[:, : 5 - count] - 0.5) * (math.pi * 0.98))
    k = k + np.einsum("mij,mi->mj", base[:, count:], steps)
    result = [designs_of(k, zeros)]
    if count == FEWEST and len(rows):
        square = rows[:, :, [0, 1, 4]]
        good = np.abs(np.linalg.det(square)) > RANK
        flat = np.zeros((int(good.sum()), 5))
        flat[:, [0, 1, 4]] = np.linalg.solve(square[good], right[good][:, :, None])[:, :, 0]
        result.append(designs_of(flat, zeros[good], FARTHEST ** (2 * draws[good, 2] - 1)))
    return np.concatenate([f[0] for f in result]), np.concatenate([f[1] for f in result])


def _zero_equations(inputs: Floats, outputs: Floats) -> tuple[Floats, Floats]:
    """The left null vectors (n, n - 5) of the rows whose span no zeros change, and the products (2, 2, n)."""
    rows, _ = system(inputs, outputs)
    left, sizes, _ = np.linalg.svd(rows)
    rank = int((sizes > RANK * sizes[0]).sum())
    ca, sa, cb, sb = np.cos(inputs), np.sin(inputs), np.cos(outputs), np.sin(outputs)
    return left[:, rank:], np.array([[sa * cb, sa * sb], [ca * cb, ca * sb]])


def null_angles(q: Floats) -> Floats:
    """The angles u in (-pi/2, pi/2] with (cos u, sin u) q (cos u, sin u)^T = 0; none, one or two."""
    # q of cos 2u and sin 2u: a level of one sine
    mean, cosine, sine = (q[0, 0] + q[1, 1]) / 2, (q[0, 0] - q[1, 1]) / 2, (q[0, 1] + q[1, 0]) / 2
    amplitude = math.hypot(cosine, sine)
    if amplitude == 0.0 or abs(mean) > amplitude:
        return np.empty(0)
    middle, half = math.atan2(sine, cosine), math.acos(-mean / amplitude)
    return np.array([middle - half, middle + half]) / 2
