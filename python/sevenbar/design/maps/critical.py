"""Distances at which the coupler of an RSSR changes what the linkage can do: the critical ones of its balls.

With crank and rocker turned at will, the distance of the balls is a function on the torus of both angles. The
poses that a coupler allows are one level of it, and a level changes its shape only at a critical value.
"""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats

#: Powers of the trigonometric polynomial whose zeros are the critical angles, and samples that give it.
DEGREE, SAMPLES = 4, 16

#: Complex zeros this near to the real circle [rad] count as real: a fourfold zero is known to 1e-4 only. One
#: too many costs time and no truth, since it can only cause a cell to be examined more closely.
NEARLY_REAL = 1e-3

#: Of two signs that fit about as well both are kept: shares of the slope's terms.
EITHER_SIGN = 1e-6

#: Rounding of a critical distance, relative to the greatest dimension; a double zero keeps half its digits.
ROUNDING = 1e-7

#: Problems whose companion matrices are solved in one call.
CHUNK = 4096


def _half_angle() -> Floats:
    """Coefficients in t (9, 9) of `exp(i k x) (1 + t^2)^4` for k = -4 .. 4, with `t = tan(x / 2)`."""
    rows = []
    for k in range(-DEGREE, DEGREE + 1):
        row = np.ones(1, dtype=complex)
        for sign, count in ((1j, DEGREE + k), (-1j, DEGREE - k)):
            for _ in range(count):
                row = np.convolve(row, [1.0, sign])
        rows.append(row)
    return np.array(rows)


_HALF_ANGLE = _half_angle()


def critical_gaps(dimensions: Floats, near: Floats) -> Floats:
    """Critical distances of the balls less the coupler's length [length], NaN where there is none: (n, 16).

    `dimensions` (6, n) are M, N, L1, L2, L3, D; complex zeros nearer to the real circle than `near` (n,)
    [rad] count, too. For a crank angle a the balls are nearest and farthest at
    `f = g -+ L3 sqrt(H)`, `H = (D - L1 sin a)^2 + N^2`, twice f the squared distance; the critical a are
    zeros of `(M sin a - D cos a)^2 H - L3^2 cos^2 a (D - L1 sin a)^2`, of degree four.

    Source: docs/theory_design.md, (12) to (14).
    """
    parts = [
        _gaps(dimensions[:, start : start + CHUNK], near[start : start + CHUNK])
        for start in range(0, dimensions.shape[1], CHUNK)
    ]
    return np.concatenate(parts) if parts else np.empty((0, 4 * DEGREE))


def _gaps(dimensions: Floats, nearly: Floats) -> Floats:
    size = np.abs(dimensions).max(axis=0)
    M, N, L1, L2, L3, D = (row[:, None] for row in dimensions / size)

    def polynomial(a: Floats) -> Floats:
        sin, cos = np.sin(a), np.cos(a)
        reach = D - L1 * sin
        value: Floats = (M * sin - D * cos) ** 2 * (reach**2 + N**2) - (L3 * cos * reach) ** 2
        return value

    # where the polynomial is greatest there is no zero, so none is near t = infinity
    circle: Floats = np.arange(SAMPLES, dtype=np.float64) * (math.tau / SAMPLES)
    values = polynomial(circle[None, :])
    turn = circle[np.abs(values).argmax(axis=1)] + math.pi
    values = polynomial(circle[None, :] + turn[:, None])
    powers = np.fft.fft(values, axis=1)[:, np.arange(-DEGREE, DEGREE + 1)] / SAMPLES
    coefficients = (powers @ _HALF_ANGLE).real
    companion = np.zeros((len(turn), 2 * DEGREE, 2 * DEGREE))
    companion[:, 1:, :-1] = np.eye(2 * DEGREE - 1)
    companion[:, :, -1] = -coefficients[:, :-1] / coefficients[:, -1:]
    zeros = np.linalg.eigvals(companion)
    near = np.abs(zeros.imag) < nearly[:, None] * (1 + np.abs(zeros) ** 2) / 2
    a = turn[:, None] + 2 * np.arctan(zeros.real)

    sin, cos = np.sin(a), np.cos(a)
    reach = D - L1 * sin
    root = np.hypot(reach, N)
    middle = 0.5 * (M * M + N * N + L1 * L1 + L3 * L3 + D * D) - L1 * (M * cos + D * sin)
    # the slope of f by a, both parts times the root
    first, second = L1 * (M * sin - D * cos) * root, -L1 * L3 * cos * reach
    both = np.abs(first) + np.abs(second) + root
    gaps = []
    for sign in (-1.0, 1.0):
        slope, other = np.abs(first + sign * second), np.abs(first - sign * second)
        fits = near & ((slope <= other) | (slope <= EITHER_SIGN * both))
        squared = np.maximum(2 * (middle + sign * L3 * root), 0.0)
        gaps.append(np.where(fits, np.sqrt(squared) - L2, np.nan))
    found: Floats = np.concatenate(gaps, axis=1) * size[:, None]
    return found
