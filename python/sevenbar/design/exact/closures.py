"""The closure of an RSSR with any angle between its axes, as nine coefficients of the dials' readings.

Crank about z, ball at (r cos alpha, r sin alpha, h); the common normal of the axes is x, their distance p,
the rocker's axis u = (0, -sin tau, cos tau) through (p, 0, 0), its ball at k along u and s across it, at
beta from x. Over 2 r s the closure |A - B|^2 = L^2 is

    ca cb + c sa sb - K - P cb + S ca - Q sa + H sb = 0,    c = cos tau                                   (1)
    P = p / r,  S = p / s,  Q = k sin(tau) / s,  H = h sin(tau) / r
    K = (r^2 + h^2 + p^2 + s^2 + k^2 - L^2 - 2 h k c) / (2 r s)

With readings a = alpha - u, b = beta - v any (1, ca, sa) C (1, cb, sb)^T = 0 with nine coefficients is such a
closure: its block of products M is made diagonal by turning the two zeros, `R(u) M R(v)^T ~ diag(1, c)`,
which is the singular value decomposition, c the ratio of the singular values with the sign of det M. All else
follows, up to the mirror image (tau, h, k negative), which has the same function. L^2 > 0 wherever the
closure holds at one real pair, as it is |A - B|^2 there.

Source: docs/theory_design.md, (38) to (40).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, short_way

#: 1 - |cos tau| below which axes are parallel: a twist of 0.003 deg, of which typed pairs say nothing.
PARALLEL = 1e-9

#: Coefficients, relative to the products', that count as zero: (1) of typed angles leaves 1e-13.
NOTHING = 1e-9

#: Sine of the angle of two common normals of parallel axes [-] that are one: where c is 1 up to rounding, the
#: zeros have half its digits.
ASIDE = 1e-6

#: L1 / L3 that are tried where the axes meet, which leaves it free.
RATIOS = (1.0, 0.5, 2.0, 0.25, 4.0)


@dataclass(frozen=True)
class SkewRssr:
    """An RSSR of any angle between its axes, in the frame of (1); lengths relative to s, the rocker's.

    `zeros` are the dials' zeros u, v [rad]: alpha = u + a, beta = v + b.
    """

    r: float
    s: float
    p: float
    h: float
    k: float
    coupler: float
    twist: float
    zeros: tuple[float, float]

    def ball_a(self, alpha: float) -> Floats:
        """The crank's ball at an angle [rad]."""
        return np.array([self.r * math.cos(alpha), self.r * math.sin(alpha), self.h])

    def ball_b(self, beta: float) -> Floats:
        """The rocker's ball at an angle [rad]."""
        up = np.array([0.0, math.cos(self.twist), math.sin(self.twist)])
        across = np.array([math.cos(beta), 0.0, 0.0]) + math.sin(beta) * up
        return np.asarray(self.foot_b() + self.s * across)

    def axis_b(self) -> Floats:
        """The direction of the rocker's axis."""
        return np.array([0.0, 0.0 - math.sin(self.twist), math.cos(self.twist)])

    def foot_b(self) -> Floats:
        """The middle of the circle of the rocker's ball."""
        return np.asarray(np.array([self.p, 0.0, 0.0]) + self.k * self.axis_b())


def products(inputs: Floats, outputs: Floats) -> Floats:
    """The nine products (n, 9) of (1, ca, sa) and (1, cb, sb) at angles (n,) [rad]."""
    one = np.ones_like(inputs)
    first = np.stack([one, np.cos(inputs), np.sin(inputs)], axis=1)
    second = np.stack([one, np.cos(outputs), np.sin(outputs)], axis=1)
    return np.asarray(np.einsum("ni,nj->nij", first, second).reshape(len(inputs), 9))


def rssr_of(coefficients: Floats) -> SkewRssr | None:
    """The RSSR of nine coefficients (3, 3) of readings; `None` where no real linkage has them.

    Of the four pairs of zeros, half turns on, those with crank and common normal positive are kept; of the
    linkage and its mirror image that with 0 < tau < pi.
    """
    left, sizes, right = np.linalg.svd(coefficients[1:, 1:])
    if sizes[0] <= NOTHING * np.abs(coefficients).max():
        return None
    turn_a, turn_b = left.T, right
    sign = 1.0
    for turn in (turn_a, turn_b):
        if np.linalg.det(turn) < 0:
            turn[1] *= -1
            sign = -sign
    c = sign * sizes[1] / sizes[0]
    scaled = coefficients / sizes[0]
    by_b, by_a = turn_b @ scaled[0, 1:], turn_a @ scaled[1:, 0]
    u, v = math.atan2(turn_a[1, 0], turn_a[0, 0]), math.atan2(turn_b[1, 0], turn_b[0, 0])
    if 1 - abs(c) < PARALLEL:
        return _parallel(-scaled[0, 0], by_b, by_a, u, v, math.copysign(1.0, c))
    return designed(c, -scaled[0, 0], -by_b[0], by_a[0], -by_a[1], by_b[1], u, v)


def designed(
    c: float, K: float, P: float, S: float, Q: float, H: float, u: float, v: float, *, turned: bool = True
) -> SkewRssr | None:
    """The RSSR of the numbers of (1) and its zeros; `None` where L^2 is not positive, or r no length.

    With `turned` the zeros may be moved by half turns, else only r > 0 as it comes is a linkage.
    """
    if abs(P) < NOTHING and abs(S) < NOTHING:
        tries = [_sized(c, K, ratio, 0.0, Q, H, (u, v)) for ratio in RATIOS]
        return next((result for result in tries if result is not None), None)
    if abs(P) < NOTHING or abs(S) < NOTHING:
        return None
    if S / P < 0:
        if not turned:
            return None
        u, K, P, H = u + math.pi, -K, -P, -H
    if S < 0 and turned:
        u, v, S, Q, H, P = u + math.pi, v + math.pi, -S, -Q, -H, -P
    return _sized(c, K, S / P, S, Q, H, (u, v))


def _sized(
    c: float, K: float, r: float, p: float, Q: float, H: float, zeros: tuple[float, float]
) -> SkewRssr | None:
    sine = math.sqrt(max((1 - c) * (1 + c), 0.0))
    if sine == 0.0:
        return None
    h, k = H * r / sine, Q / sine
    square = r * r + h * h + p * p + 1 + k * k - 2 * h * k * c - 2 * r * K
    if not square > NOTHING * max(r * r, h * h, p * p, k * k, 1.0):
        return None
    u, v = short_way(np.array(zeros)).tolist()
    return SkewRssr(r, 1.0, p, h, k, math.sqrt(square), math.acos(c), (u, v))


def _parallel(K: float, by_b: Floats, by_a: Floats, u: float, v: float, c: float) -> SkewRssr | None:
    """The linkage of parallel axes, whose zeros turn together until the common normal is x."""
    size = math.hypot(*by_a), math.hypot(*by_b)
    if min(size) < NOTHING:
        return None
    # f has S ca - P cb, and no sa, sb
    turn = -math.atan2(by_a[1], by_a[0])
    cos, sin = math.cos(turn), math.sin(turn)
    along = cos * by_b[0] - c * sin * by_b[1]
    aside = c * sin * by_b[0] + cos * by_b[1]
    if abs(aside) > ASIDE * size[1]:
        return None
    u, v, S, P = u + turn, v + c * turn, size[0], -along
    if P < 0:
        u, K, P = u + math.pi, -K, -P
    r = S / P
    square = r * r + S * S + 1 - 2 * r * K
    if not square > NOTHING * max(r * r, S * S, 1.0):
        return None
    zeros = short_way(np.array([u, v])).tolist()
    return SkewRssr(r, 1.0, S, 0.0, 0.0, math.sqrt(square), math.acos(c), (zeros[0], zeros[1]))
