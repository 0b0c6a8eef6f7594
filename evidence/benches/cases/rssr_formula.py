"""The RSSR in closed form, written by hand: what a peer computes for `linkage.output`.

Source: Sun and Zhou, eq. (8), (12), (13), with the signs of the latter two mended. For shaft axes that cross
at right angles, as in the paper.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import sevenbar as sb

M = N = 700.0
L1, L3, D, SPEED = 250.0, 550.0, 0.0, 10.0
L2_SQUARED = (L1 - M) ** 2 + L3**2 + N**2

#: Position, velocity, acceleration, each (2, n).
Rates = tuple[np.ndarray, np.ndarray, np.ndarray]


def linkage() -> sb.Linkage:
    """The same for Sevenbar."""
    return sb.rssr(M=M, N=N, L1=L1, L3=L3, D=D)


def with_numpy(alpha: np.ndarray) -> Rates:
    """Both branches at inputs (n,), each array operation once."""
    s, c = np.sin(alpha), np.cos(alpha)
    y = L1 * s - D
    k = 0.5 * (L1**2 + M**2 + D**2 + L3**2 + N**2 - L2_SQUARED) - L1 * (M * c + D * s)
    rise = np.arcsin(k / (L3 * np.sqrt(N * N + y * y)))
    phase = np.arctan2(y, N)
    position, velocity, acceleration = (np.empty((2, alpha.size)) for _ in range(3))
    for branch, beta in enumerate((rise - phase, np.pi - rise - phase)):
        sine, cosine = np.sin(beta), np.cos(beta)
        r = L3 * (y * sine - N * cosine)
        v = -SPEED * L1 * (M * s - D * c - L3 * c * cosine) / r
        q = L1 * (M * c + D * s + L3 * s * cosine)
        w = L3 * (y * cosine + N * sine)
        t = L1 * L3 * c * sine
        position[branch], velocity[branch] = beta, v
        acceleration[branch] = -(SPEED**2 * q + v * v * w + 2 * SPEED * v * t) / r
    return position, velocity, acceleration


def _looped(alpha: np.ndarray) -> Rates:
    """The same, input by input."""
    position = np.empty((2, alpha.size))
    velocity = np.empty((2, alpha.size))
    acceleration = np.empty((2, alpha.size))
    for i in range(alpha.size):
        s, c = math.sin(alpha[i]), math.cos(alpha[i])
        y = L1 * s - D
        k = 0.5 * (L1**2 + M**2 + D**2 + L3**2 + N**2 - L2_SQUARED) - L1 * (M * c + D * s)
        rise = math.asin(k / (L3 * math.sqrt(N * N + y * y)))
        phase = math.atan2(y, N)
        for branch in range(2):
            beta = rise - phase if branch == 0 else math.pi - rise - phase
            sine, cosine = math.sin(beta), math.cos(beta)
            r = L3 * (y * sine - N * cosine)
            v = -SPEED * L1 * (M * s - D * c - L3 * c * cosine) / r
            q = L1 * (M * c + D * s + L3 * s * cosine)
            w = L3 * (y * cosine + N * sine)
            t = L1 * L3 * c * sine
            position[branch, i] = beta
            velocity[branch, i] = v
            acceleration[branch, i] = -(SPEED**2 * q + v * v * w + 2 * SPEED * v * t) / r
    return position, velocity, acceleration


def with_numba(numba: Any) -> Callable[[np.ndarray], Rates]:
    """The loop, compiled by numba with its default of exact arithmetic, and compiled once already."""
    compiled: Callable[[np.ndarray], Rates] = numba.njit(fastmath=False)(_looped)
    compiled(np.zeros(1))
    return compiled
