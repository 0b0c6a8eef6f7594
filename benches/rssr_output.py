"""Ratios of `output(alpha, order=2)` against vectorised NumPy of the same closed form, in one process.

Counted per pose: both give two branches, so two poses an input. Medians of paired runs; ratios are to be
trusted, absolute times only guide. Run: `python benches/rssr_output.py`
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import statistics
import time

import numpy as np

import sevenbar as sb
from sevenbar._core import simd_level

M = N = 700.0
L1, L3, D, SPEED = 250.0, 550.0, 0.0, 10.0
L2_SQUARED = (L1 - M) ** 2 + L3**2 + N**2


def numpy_output(alpha):
    """Eq. (8) on both branches and eq. (12), (13) with their signs mended, each array operation once."""
    s, c = np.sin(alpha), np.cos(alpha)
    y = L1 * s - D
    k = 0.5 * (L1**2 + M**2 + D**2 + L3**2 + N**2 - L2_SQUARED) - L1 * (M * c + D * s)
    rise = np.arcsin(k / (L3 * np.sqrt(N * N + y * y)))
    phase = np.arctan2(y, N)
    position, velocity, acceleration = (np.empty((2, alpha.size)) for _ in range(3))
    for branch, beta in enumerate((rise - phase, np.pi - rise - phase)):
        sb_, cb = np.sin(beta), np.cos(beta)
        r = L3 * (y * sb_ - N * cb)
        v = -SPEED * L1 * (M * s - D * c - L3 * c * cb) / r
        q = L1 * (M * c + D * s + L3 * s * cb)
        w = L3 * (y * cb + N * sb_)
        t = L1 * L3 * c * sb_
        position[branch], velocity[branch] = beta, v
        acceleration[branch] = -(SPEED**2 * q + v * v * w + 2 * SPEED * v * t) / r
    return position, velocity, acceleration


def paired(alpha, rounds, repeats):
    """Median nanoseconds a pose of NumPy and of Sevenbar, and the median ratio of neighbouring runs."""
    linkage = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=D)
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(repeats):
            theirs = numpy_output(alpha)
        middle = time.perf_counter()
        for _ in range(repeats):
            ours = linkage.output(alpha, order=2, speed=SPEED)
        end = time.perf_counter()
        times.append(((middle - start) / repeats, (end - middle) / repeats))
    for a, b in zip(theirs, (ours.position, ours.velocity, ours.acceleration), strict=True):
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-11 * np.abs(a).max())
    poses = 2 * alpha.size
    return (
        statistics.median(t[0] for t in times) / poses * 1e9,
        statistics.median(t[1] for t in times) / poses * 1e9,
        statistics.median(a / b for a, b in times),
    )


if __name__ == "__main__":
    print(f"output(alpha, order=2), one thread, vector unit {simd_level()}")
    print(f"{'inputs':>9} {'NumPy ns/pose':>14} {'Sevenbar ns/pose':>17} {'ratio':>7}")
    for count, rounds, repeats in ((3_600, 101, 20), (1_000_000, 15, 1)):
        alpha = np.random.default_rng(1).uniform(0.0, 2 * np.pi, count)
        theirs, ours, ratio = paired(alpha, rounds, repeats)
        print(f"{count:>9} {theirs:>14.1f} {ours:>17.1f} {ratio:>7.1f}")
