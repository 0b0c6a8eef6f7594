"""Nanoseconds a linkage of classifying and measuring RSSRs in batches, against NumPy at 360 inputs.

The peer does what a sweep does without roots: whether each of 360 inputs closes the loop, for all linkages
at once, and so the input's ranges to a degree. All in one process, on one thread; medians of CPU time;
ratios are to be trusted, absolute times only guide. Run: `python benches/sweep.py`
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import statistics
import time

import numpy as np

from sevenbar._core import classify_rssr, measure_rssr, simd_level

MANY, SOME, SAMPLED = 1_000_000, 2_000, 20_000
INPUTS, ROUNDS = 360, 7

#: Codes of the motion types whose input turns fully, rocks, and stands.
TURNS, ROCKS, STANDS = (0, 2), (1, 3), (5,)


def uniform(count):
    """M, N, L1, L2, L3, D between 0.05 and 1.05, (6, count)."""
    return np.random.default_rng(1).uniform(0.05, 1.05, (6, count))


def sampled_types(dimensions):
    """Whether the loop closes at all inputs, at some or at none: 0, 1, 2 for each linkage."""
    m, n, l1, l2, l3, d = (column[:, None] for column in dimensions)
    alpha = np.linspace(0, 2 * np.pi, INPUTS, endpoint=False)
    x, z = l1 * np.sin(alpha) - d, l1 * np.cos(alpha) - m
    square = x * x + n * n
    k = 0.5 * (square + z * z + l3 * l3 - l2 * l2)
    closes = l3 * l3 * square >= k * k
    return np.where(closes.all(axis=1), 0, np.where(closes.any(axis=1), 1, 2))


def seconds(call):
    """Median CPU time of a call."""
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return statistics.median(times)


if __name__ == "__main__":
    many = uniform(MANY)
    some, sampled = (np.ascontiguousarray(many[:, :count]) for count in (SOME, SAMPLED))
    codes, _ = classify_rssr(sampled, "crank", 1)
    exact = np.select([np.isin(codes, kinds) for kinds in (TURNS, ROCKS, STANDS)], [0, 1, 2], 3)
    # a range narrower than the samples' distance is one in thousands
    assert np.mean(exact != sampled_types(sampled)) < 1e-3

    ours = seconds(lambda: classify_rssr(many, "crank", 1)) / MANY * 1e9
    measured = seconds(lambda: measure_rssr(some, "crank", 1)) / SOME * 1e9
    numpy = seconds(lambda: sampled_types(sampled)) / SAMPLED * 1e9
    print(f"uniform dimensions, one thread, vector unit {simd_level()}")
    print(f"{'':<34} {'ns/linkage':>11} {'ratio':>8}")
    print(f"{f'classify_rssr, {MANY} linkages':<34} {ours:>11.0f} {1:>8}")
    print(f"{f'NumPy at {INPUTS} inputs':<34} {numpy:>11.0f} {numpy / ours:>8.1f}")
    print(f"{'measure_rssr, every circuit':<34} {measured:>11.0f} {measured / ours:>8.0f}")
