"""Milliseconds a loop of measuring general loops in batches: all modes, circuits, extremes, 90 rows a turn.

Loops of seven turning joints: with Denavit-Hartenberg rows at random, and those of the paper of which each
dimension is off by up to 1 %. CPU and wall time on one thread and on two; the least of some rounds. Run:
`python benches/sweep_loops.py`
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import time

import numpy as np

from sevenbar._core import measure_loops, simd_level

COUNT, SAMPLES, ROUNDS = 200, 90, 3
PAPER = {
    "length": [45, 15, 100, -115, 10, 35, 35],
    "offset": [70, 10, 10, 10, 10, 10, -60],
    "twist": np.radians([80, -95, 0, 0, -75, 80, 150]),
}


def steps(length, offset, twist):
    """The transforms of Denavit-Hartenberg rows (n, 7) without their joints' turns, (n, 7, 4, 4)."""
    out = np.tile(np.eye(4), (*np.shape(length), 1, 1))
    out[..., 0, 3], out[..., 2, 3] = length, offset
    out[..., 1, 1] = out[..., 2, 2] = np.cos(twist)
    out[..., 2, 1] = np.sin(twist)
    out[..., 1, 2] = -out[..., 2, 1]
    return out


def arrays(rows):
    """What the core takes for loops with these transforms: advances, base, ground, links."""
    base = np.tile(np.eye(4), (len(rows), 1, 1))
    return np.zeros(rows.shape[:2]), base, np.linalg.inv(rows[:, 6]), np.ascontiguousarray(rows[:, :6])


def batches():
    """Random loops, and some near the paper's."""
    rng = np.random.default_rng(1)
    shape = (COUNT, 7)
    yield (
        "random",
        steps(rng.uniform(0.2, 1, shape), rng.uniform(-0.5, 0.5, shape), rng.uniform(-np.pi, np.pi, shape)),
    )
    off = {name: values * rng.uniform(0.99, 1.01, shape) for name, values in PAPER.items()}
    yield "the paper's, +-1 %", steps(**off)


def measured(loops, threads):
    """The result, and CPU and wall time [ms] a loop."""
    result, cpu, wall = None, [], []
    for _ in range(ROUNDS):
        start = time.process_time(), time.perf_counter()
        result = measure_loops("R" * 7, *loops, 0, 6, SAMPLES, threads)
        cpu.append(time.process_time() - start[0])
        wall.append(time.perf_counter() - start[1])
    return result, min(cpu) / COUNT * 1e3, min(wall) / COUNT * 1e3


if __name__ == "__main__":
    print(f"{COUNT} loops of 7 turning joints, {SAMPLES} rows a turn, vector unit {simd_level()}")
    print(f"{'':<20} {'circuits':>9} {'threads':>8} {'CPU ms':>8} {'wall ms':>8}")
    for name, rows in batches():
        loops = arrays(rows)
        for threads in (1, 2):
            result, cpu, wall = measured(loops, threads)
            assert result["complete"].all()
            circuits = result["circuits"].mean()
            print(f"{name:<20} {circuits:>9.2f} {threads:>8} {cpu:>8.2f} {wall:>8.2f}")
