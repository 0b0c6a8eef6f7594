"""Many linkages at once, on one thread and on two: motion types, measures of circuits, general loops."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from evidence.benches.cases import yardsticks
from evidence.benches.harness import Timing, Work, compare
from evidence.benches.outcome import Cell, Outcome, Table, timed
from evidence.benches.peers import AbsentError
from evidence.benches.setting import Setting
from evidence.circumstances import cores
from sevenbar._core import classify_rssr, measure_loops, measure_rssr

TITLE = "Sweeps: many linkages, one and two threads"
ABOUT = """\
Motion types and limits of RSSRs with dimensions drawn at random (`classify_rssr`), against what a sweep
does without roots: whether each of 360 inputs closes the loop, and so the input's ranges to a degree, in
NumPy and compiled by numba. Then on one and on two threads, in wall time: the same, measures of all
circuits (`measure_rssr`), and general loops of seven turning joints with all modes, circuits and extremes
(`measure_loops`, 90 rows a turn)."""

INPUTS = 360

#: Codes of the motion types whose input turns fully, rocks, and stands.
TURNS, ROCKS, STANDS = (0, 2), (1, 3), (5,)

#: Share of linkages whose range lies between two samples of the peer.
MISSED = 1e-3

PAPER: dict[str, Any] = {
    "length": [45, 15, 100, -115, 10, 35, 35],
    "offset": [70, 10, 10, 10, 10, 10, -60],
    "twist": np.radians([80, -95, 0, 0, -75, 80, 150]),
}


def run(setting: Setting) -> Outcome:
    """Two tables."""
    dimensions = np.random.default_rng(1).uniform(0.05, 1.05, (6, setting.choose(1_000_000, 100_000)))
    return Outcome(TITLE, ABOUT, [types(dimensions, setting), threads(dimensions, setting)])


def types(dimensions: np.ndarray, setting: Setting) -> Table:
    """Against the peers, one thread."""
    some = np.ascontiguousarray(dimensions[:, :20_000])
    codes, _ = classify_rssr(some, "crank", 1)
    exact = np.select([np.isin(codes, kinds) for kinds in (TURNS, ROCKS, STANDS)], [0, 1, 2], 3)

    def agrees(found: Any) -> None:
        share = np.mean(exact != found)
        assert share < MISSED, f"{share:.2%} of the types differ"

    works = [
        Work("Sevenbar", lambda: classify_rssr(dimensions, "crank", 1), dimensions.shape[1], "exact"),
        Work("NumPy", lambda: sampled_types(some), some.shape[1], f"{INPUTS} inputs", agrees),
    ]
    absent = []
    try:
        compiled = setting.peers.module("numba").njit(fastmath=False)(looped_types)
        compiled(np.ones((6, 1)))
        works.append(Work("numba", lambda: compiled(some), some.shape[1], f"{INPUTS} inputs", agrees))
    except AbsentError as error:
        absent = [("numba", str(error))]
    return timed(
        "motion types, one thread", "ns a linkage", compare(works, rounds=setting.choose(9, 3)), absent
    )


def sampled_types(dimensions: np.ndarray) -> np.ndarray:
    """Whether the loop closes at all inputs, at some or at none: 0, 1, 2 for each linkage."""
    m, n, l1, l2, l3, d = (column[:, None] for column in dimensions)
    alpha = np.linspace(0, 2 * np.pi, INPUTS, endpoint=False)
    x, z = l1 * np.sin(alpha) - d, l1 * np.cos(alpha) - m
    square = x * x + n * n
    k = 0.5 * (square + z * z + l3 * l3 - l2 * l2)
    closes = l3 * l3 * square >= k * k
    return np.where(closes.all(axis=1), 0, np.where(closes.any(axis=1), 1, 2))


def looped_types(dimensions: np.ndarray) -> np.ndarray:
    """The same linkage by linkage, with sines and cosines made once."""
    alpha = np.arange(INPUTS) * (2 * np.pi / INPUTS)
    sine, cosine = np.sin(alpha), np.cos(alpha)
    types = np.empty(dimensions.shape[1], dtype=np.int64)
    for i in range(dimensions.shape[1]):
        m, n, l1 = dimensions[0, i], dimensions[1, i], dimensions[2, i]
        l2, l3, d = dimensions[3, i], dimensions[4, i], dimensions[5, i]
        closed = 0
        for j in range(INPUTS):
            x, z = l1 * sine[j] - d, l1 * cosine[j] - m
            square = x * x + n * n
            k = 0.5 * (square + z * z + l3 * l3 - l2 * l2)
            closed += l3 * l3 * square >= k * k
        types[i] = 0 if closed == INPUTS else (1 if closed else 2)
    return types


@dataclass(frozen=True)
class Batch:
    """A batch: its name, its size, and the call by the number of threads."""

    name: str
    count: int
    call: Callable[[int], Any]
    #: Bytes read and written for one linkage.
    bytes: int = 0


def batches(dimensions: np.ndarray, loops: int) -> list[Batch]:
    """What is measured on threads."""
    some, speed = np.ascontiguousarray(dimensions[:, : 10 * loops]), np.ones(10 * loops)
    drawn = {name: loop_arrays(rows) for name, rows in loop_rows(loops).items()}
    return [
        # six doubles come in; a byte and four limits go out, and are filled before
        Batch(
            "classify_rssr", dimensions.shape[1], lambda n: classify_rssr(dimensions, "crank", n), 48 + 2 * 33
        ),
        Batch("measure_rssr", speed.size, lambda n: measure_rssr(some, "crank", speed, n)),
        *(Batch(f"measure_loops, {name}", loops, on_loops(arrays)) for name, arrays in drawn.items()),
    ]


def on_loops(arrays: tuple[np.ndarray, ...]) -> Callable[[int], Any]:
    """The measures of general loops, by the number of threads."""
    advances, base, ground, links = arrays
    given = advances, base, ground, links, 0, 6, 90, np.ones(len(base))
    return lambda threads: measure_loops("R" * 7, *given, threads)


def threads(dimensions: np.ndarray, setting: Setting) -> Table:
    """Wall times on one thread and on two."""
    byte = yardsticks.seconds_a_byte()
    columns = [
        "",
        "µs a linkage, 1 thread",
        "2 threads",
        "times as fast",
        "from",
        "to",
        "share of memory's speed",
        "note",
    ]
    rows: list[list[Cell]] = []
    for batch in batches(dimensions, setting.choose(200, 10)):
        works = [
            Work("2", lambda: batch.call(2), batch.count),  # noqa: B023
            Work("1", lambda: batch.call(1), batch.count),  # noqa: B023
        ]
        two, one = compare(works, rounds=setting.choose(5, 3), clock=time.perf_counter)
        share = byte * batch.bytes / two.median if batch.bytes else None
        rows.append([batch.name, 1e6 * one.median, 1e6 * two.median, *gains(one), share, f"{batch.count:,}"])
    return Table(f"threads, wall time, {cores()} cores", columns, rows)


def gains(one: Timing) -> tuple[float, float, float]:
    """How many times as fast two threads are, with the spread."""
    return one.ratio, one.ratio_low, one.ratio_high


def loop_rows(count: int) -> dict[str, np.ndarray]:
    """Transforms (n, 7, 4, 4) of loops drawn at random, and of loops near the 7R paper's."""
    rng = np.random.default_rng(1)
    shape = (count, 7)
    off = {name: values * rng.uniform(0.99, 1.01, shape) for name, values in PAPER.items()}
    return {
        "random": steps(
            rng.uniform(0.2, 1, shape), rng.uniform(-0.5, 0.5, shape), rng.uniform(-np.pi, np.pi, shape)
        ),
        "the paper's ±1 %": steps(off["length"], off["offset"], off["twist"]),
    }


def steps(length: np.ndarray, offset: np.ndarray, twist: np.ndarray) -> np.ndarray:
    """The transforms of Denavit-Hartenberg rows (n, 7) without their joints' turns, (n, 7, 4, 4)."""
    out = np.tile(np.eye(4), (*np.shape(length), 1, 1))
    out[..., 0, 3], out[..., 2, 3] = length, offset
    out[..., 1, 1] = out[..., 2, 2] = np.cos(twist)
    out[..., 2, 1] = np.sin(twist)
    out[..., 1, 2] = -out[..., 2, 1]
    return out


def loop_arrays(rows: np.ndarray) -> tuple[np.ndarray, ...]:
    """What the core takes for loops with these transforms: advances, base, ground, links."""
    base = np.tile(np.eye(4), (len(rows), 1, 1))
    return np.zeros(rows.shape[:2]), base, np.linalg.inv(rows[:, 6]), np.ascontiguousarray(rows[:, :6])
