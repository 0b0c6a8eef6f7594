"""How cost grows with samples, circuits, joints and threads, beside yardsticks of the same machine."""

from __future__ import annotations

import statistics
import time
from collections import defaultdict

import numpy as np

import sevenbar as sb
from evidence.benches.cases import loops, rssr_formula, yardsticks
from evidence.benches.cases.sweeps import Batch, batches
from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Cell, Outcome, Plot, Series, Table
from evidence.benches.setting import Setting
from evidence.circumstances import cores

TITLE = "How cost grows"
ABOUT = """\
Grey lines are yardsticks, measured in the same process: the sine and cosine of as many numbers by NumPy,
as many 6x6 systems by `numpy.linalg.solve` (a batch), the time to move the results to memory as a copy
does, as many times as fast as there are cores. CPU time; threads in wall time."""

#: Loops with four to seven turning joints.
BY_JOINTS = ("bennett", "goldberg_5r", "bricard_plane", "seven_r")

#: Samples of a circuit whose cost a row is told: enough that following the circuit is a small part.
ROWS = 7_200


def run(setting: Setting) -> Outcome:
    """A plot for each, and a table of a pose beside the yardsticks."""
    rounds = setting.choose(7, 3)
    arrays, near = with_inputs(rounds, setting.choose(6, 5))
    circuit = with_samples(rounds, setting.choose((90, 360, 1440, 5760, 23040), (90, 1440)))
    joints = with_joints(rounds)
    plots = [arrays, circuit, with_circuits(setting.choose(150, 10)), joints, with_threads(setting)]
    return Outcome(TITLE, ABOUT, [near], plots)


def with_inputs(rounds: int, decades: int) -> tuple[Plot, Table]:
    """RSSR arrays of 10 to 10^decades inputs."""
    linkage = rssr_formula.linkage()
    counts = [10**k for k in range(1, decades + 1)]
    ours, sines = [], []
    for count in counts:
        alpha = np.random.default_rng(1).uniform(0.0, 2 * np.pi, count)
        work = Work("", lambda alpha=alpha: linkage.output(alpha, order=2), 2 * count)  # type: ignore[misc]
        ours.append(1e9 * compare([work], rounds=rounds)[0].median)
        sines.append(1e9 * yardsticks.sine_and_cosine(count))
    # six numbers a pose-pair go out, one comes in
    memory = 1e9 * yardsticks.seconds_a_byte() * 8 * (6 + 1) / 2
    x = [float(count) for count in counts]
    plot = Plot(
        "bench_growth_inputs",
        "RSSR, position, velocity and acceleration",
        "inputs in the array",
        "ns a pose",
        [
            Series("Sevenbar", x, ours),
            Series("NumPy: one sine and one cosine", x, sines, yardstick=True),
            Series("memory: results written, inputs read", x, [memory] * len(x), yardstick=True),
        ],
    )
    rows: list[list[Cell]] = [
        ["one pose, array of the largest size [ns]", ours[-1], ""],
        ["one sine and one cosine by NumPy, same size [ns]", sines[-1], ""],
        ["its share of memory traffic at copying speed [ns]", memory, ""],
    ]
    return plot, Table("An RSSR pose beside the yardsticks", ["", "measured", "note"], rows)


def with_samples(rounds: int, samples: tuple[int, ...]) -> Plot:
    """One circuit of the 7R paper's linkage at more and more inputs."""
    linkage = sb.load("seven_r")
    pose = linkage.assembly_modes(0.0).q[0]
    times = [
        1e3 * compare([Work("", lambda n=n: linkage.circuit(pose, samples=n))], rounds=rounds)[0].median  # type: ignore[misc]
        for n in samples
    ]
    solves = [1e3 * n * yardsticks.solve_of_six(n) for n in samples]
    x = [float(n) for n in samples]
    return Plot(
        "bench_growth_samples",
        "The 7R paper's linkage, one circuit with rates to the jerk",
        "samples of the circuit",
        "ms",
        [Series("Sevenbar", x, times), Series("as many 6x6 solves by NumPy", x, solves, yardstick=True)],
    )


def with_circuits(count: int) -> Plot:
    """All circuits of general loops, by how many there are: median and greatest."""
    rng = np.random.default_rng(loops.SEED)
    times = defaultdict(list)
    for _ in range(count):
        linkage = loops.drawn(rng).linkage
        start = time.process_time()
        circuits = len(linkage.motion(samples=360).circuits)
        times[circuits].append(1e3 * (time.process_time() - start))
    numbers = sorted(number for number in times if number)
    x = [float(number) for number in numbers]
    return Plot(
        "bench_growth_circuits",
        f"{count} loops of seven turning joints drawn at random, 360 samples a turn",
        "circuits",
        "ms",
        [
            Series("median", x, [statistics.median(times[number]) for number in numbers]),
            Series("longest", x, [max(times[number]) for number in numbers]),
        ],
    )


def with_joints(rounds: int) -> Plot:
    """A row of a circuit with all rates, by the number of joints."""
    own = []
    for name in BY_JOINTS:
        linkage = sb.load(name)
        pose = linkage.assembly_modes(0.3).q[0]
        rows = len(linkage.circuit(pose, samples=ROWS).q)
        work = Work("", lambda a=linkage, q=pose: a.circuit(q, samples=ROWS), rows)  # type: ignore[misc]
        own.append((len(linkage.columns), 1e9 * compare([work], rounds=rounds)[0].median))
    solve = 1e9 * yardsticks.solve_of_six(ROWS)
    x = [float(joints) for joints, _ in own]
    return Plot(
        "bench_growth_joints",
        "A row of a circuit with rates to the jerk, linkages of the gallery",
        "joints of one freedom",
        "ns a row",
        [
            Series("Sevenbar", x, [y for _, y in own]),
            Series("one 6x6 solve by NumPy", x, [solve] * len(x), yardstick=True),
        ],
    )


def with_threads(setting: Setting) -> Plot:
    """Batches on one thread and on more, as many times as fast as on one."""
    dimensions = np.random.default_rng(1).uniform(0.05, 1.05, (6, setting.choose(1_000_000, 100_000)))
    numbers = [1, 2, 4]
    series = [
        Series(batch.name, [float(n) for n in numbers], speedups(batch, numbers, setting.choose(5, 3)))
        for batch in batches(dimensions, setting.choose(100, 10))
    ]
    ideal = [float(min(n, cores())) for n in numbers]
    series.append(Series(f"{cores()} cores", [float(n) for n in numbers], ideal, yardstick=True))
    return Plot("bench_growth_threads", "Sweeps on threads", "threads", "times as fast as one thread", series)


def speedups(batch: Batch, numbers: list[int], rounds: int) -> list[float]:
    """One thread's wall time over that of each number of threads."""
    works = [Work(str(n), lambda n=n: batch.call(n)) for n in numbers]  # type: ignore[misc]
    timings = compare(works, rounds=rounds, clock=time.perf_counter)
    return [1 / timing.ratio for timing in timings]
