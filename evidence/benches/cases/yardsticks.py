"""Yardsticks of the machine, measured in the same process: sines and cosines, 6x6 solves, memory.

Of NumPy, which has its own vector code for the first and LAPACK for the second.
"""

from __future__ import annotations

import numpy as np

from evidence.benches.harness import Work, compare

#: Doubles of an array that no cache holds.
LARGE = 16_000_000

#: Rounds of each measurement.
ROUNDS = 5


def sine_and_cosine(count: int) -> float:
    """Seconds for the sine and the cosine of one number, in an array of `count`."""
    angles = np.random.default_rng(0).uniform(0.0, 2 * np.pi, count)
    out = np.empty((2, count))

    def both() -> None:
        np.sin(angles, out=out[0])
        np.cos(angles, out=out[1])

    return compare([Work("", both, count)], rounds=ROUNDS)[0].median


def solve_of_six(count: int) -> float:
    """Seconds for one 6x6 system by `numpy.linalg.solve`, of a batch of `count`."""
    rng = np.random.default_rng(0)
    matrices, right = rng.normal(size=(count, 6, 6)), rng.normal(size=(count, 6, 1))
    return compare([Work("", lambda: np.linalg.solve(matrices, right), count)], rounds=ROUNDS)[0].median


def seconds_a_byte() -> float:
    """Seconds to move one byte between memory and one core: a copy reads and writes each."""
    source, target = np.zeros(LARGE), np.ones(LARGE)
    copied = compare([Work("", lambda: np.copyto(target, source), 16 * LARGE)], rounds=ROUNDS)
    return copied[0].median
