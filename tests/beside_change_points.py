"""RSSRs a little off a change point."""

from __future__ import annotations

import numpy as np

from evidence.fuzz.random_linkages import Dimensions, square


def critical(rng: np.random.Generator, off: float) -> Dimensions:
    """A linkage `off` from a change point: its coupler is a stationary distance of both circles."""
    while True:
        free = square(rng)
        a, b = rng.uniform(-np.pi, np.pi, 2)
        for _ in range(60):
            sa, ca, sb_, cb = np.sin(a), np.cos(a), np.sin(b), np.cos(b)
            gap = np.array(
                [free.L1 * ca - free.M, free.L1 * sa - free.D - free.L3 * cb, free.N - free.L3 * sb_]
            )
            by_a, by_b = free.L1 * np.array([-sa, ca, 0]), free.L3 * np.array([0, sb_, -cb])
            twice_a, twice_b = free.L1 * np.array([-ca, -sa, 0]), free.L3 * np.array([0, cb, sb_])
            gradient = np.array([gap @ by_a, gap @ by_b])
            mixed = by_a @ by_b
            hessian = np.array([[by_a @ by_a + gap @ twice_a, mixed], [mixed, by_b @ by_b + gap @ twice_b]])
            if abs(np.linalg.det(hessian)) < 1e-9:
                break
            a, b = np.array([a, b]) - np.linalg.solve(hessian, gradient)
        coupler = float(np.linalg.norm(gap))
        if coupler > 1e-3 and np.abs(gradient).max() < 1e-13:
            return Dimensions(free.M, free.N, free.L1, free.L3, free.D, coupler * (1 + off))
