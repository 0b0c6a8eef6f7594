"""Limits of four-bars and of the RSSR in closed form, in 50 digits, and how near two of them are.

A limit is a complex input: where it is real the linkage turns back there, and a pair off the real axis by
little is a change that was missed by little.

Source: the cosine laws of plane and sphere; Sun and Zhou, eq. (5).
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np

DIGITS = 50

#: An imaginary part below this is that of a root that two real ones make: half the digits.
REAL = mp.mpf("1e-20")

Limits = list[Any]


def _by_cosines(cosines: Sequence[Any]) -> Limits:
    return [sign * angle for cosine in cosines for angle in [mp.acos(mp.mpc(cosine))] for sign in (1, -1)]


def planar_limits(length: np.ndarray) -> Limits:
    """Of the first joint: coupler and rocker in line. The angle is that between crank and ground."""
    with mp.workdps(DIGITS):
        a, b, c, d = map(mp.mpf, map(float, length))
        return _by_cosines([(a * a + d * d - reach * reach) / (2 * a * d) for reach in (b + c, b - c)])


def spherical_limits(side: np.ndarray) -> Limits:
    """The same on the sphere, sides in rad."""
    with mp.workdps(DIGITS):
        a, b, c, d = map(mp.mpf, map(float, side))
        top = mp.cos(a) * mp.cos(d)
        return _by_cosines([(mp.cos(arc) - top) / (mp.sin(a) * mp.sin(d)) for arc in (b + c, b - c)])


def rssr_limits(dimensions: Sequence[float]) -> tuple[Limits, Limits]:
    """Of crank and rocker, from M, N, L1, L2, L3, D: roots of the fourth degree in e^(i angle)."""
    with mp.workdps(DIGITS):
        m, n, l1, l2, l3, d = map(mp.mpf, map(float, dimensions))
        squares = m * m + n * n + d * d + l1 * l1 + l3 * l3 - l2 * l2
        # |A - B| = L2 is u cos + v sin = w in the other joint's angle, with one root where u^2 + v^2 = w^2
        crank = _roots(
            _trig(-2 * l3 * d, 0, 2 * l3 * l1), _trig(2 * l3 * n), _trig(squares, -2 * l1 * m, -2 * l1 * d)
        )
        rocker = _roots(
            _trig(2 * l1 * m), _trig(2 * l1 * d, 2 * l1 * l3), _trig(squares, 2 * l3 * d, -2 * l3 * n)
        )
        return crank, rocker


def _trig(constant: Any, cosine: Any = 0, sine: Any = 0) -> list[Any]:
    """Z times a trigonometric polynomial, by powers of z = e^(i angle), rising."""
    return [mp.mpc(cosine, sine) / 2, mp.mpc(constant), mp.mpc(cosine, -sine) / 2]


def _times(a: list[Any], b: list[Any]) -> list[Any]:
    return [sum(a[i] * b[k - i] for i in range(3) if 0 <= k - i < 3) for k in range(5)]


def _roots(u: list[Any], v: list[Any], w: list[Any]) -> Limits:
    squares = zip(_times(u, u), _times(v, v), _times(w, w), strict=True)
    rising = [a + b - c for a, b, c in squares]
    with warnings.catch_warnings():
        # mpmath 1.4 wants the order of the coefficients in words that 1.3 does not know
        warnings.simplefilter("ignore", DeprecationWarning)
        found = mp.polyroots(rising[::-1], maxsteps=500, extraprec=600)
    return [-1j * mp.log(z) for z in found if z]


def nearest(limits: Limits) -> tuple[float, float]:
    """The least distance of two real limits, and that of any two, complex pairs counted; turns left out."""
    real, every = [np.inf], [np.inf]
    with mp.workdps(DIGITS):
        for one, other in itertools.combinations(limits, 2):
            apart = one - other
            apart -= 2 * mp.pi * mp.nint(apart.real / (2 * mp.pi))
            every.append(float(abs(apart)))
            if abs(one.imag) < REAL and abs(other.imag) < REAL:
                real.append(every[-1])
    return min(real), min(every)


def widest(limits: Limits) -> float:
    """How wide the narrow range is whose two limits are real."""
    return nearest([limit for limit in limits if abs(limit.imag) < REAL])[0]
