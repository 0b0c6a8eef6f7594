"""The 7R paper's linkage against scipy's `fsolve`, in one process, and all modes of random general loops.

One circuit at 360 inputs from a known pose: Sevenbar gives positions, velocities, accelerations and jerks of
all joints, dead centres, extremes and the proof that it stayed on the circuit; `fsolve` gives positions only,
each from the one before. Its closure
is written twice: in NumPy, as people write it, and in six equations spelled out in plain floats, the fastest
that Python has at this size. The runs take turns; ratios are to be trusted, absolute times only guide.
Needs scipy.
Run: `python benches/seven_r.py`
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("RAYON_NUM_THREADS", "1")

import math
import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.optimize import fsolve

import sevenbar as sb

LENGTH = (45.0, 15.0, 100.0, -115.0, 10.0, 35.0, 35.0)
OFFSET = (70.0, 10.0, 10.0, 10.0, 10.0, 10.0, -60.0)
TWIST = tuple(math.radians(a) for a in (80, -95, 0, 0, -75, 80, 150))

SAMPLES = 360
ROUNDS = 21
LOOPS = 200
SEED = 1

#: Size of the loop, to measure the closure of the peer by.
SIZE = 100.0


Closure = Callable[[np.ndarray, float], object]


def numpy_closure() -> Closure:
    """Three skew and three place equations of the product of seven matrices."""
    steps = np.zeros((7, 4, 4))
    steps[:, 3, 3] = 1.0
    steps[:, 2, 3] = OFFSET
    length = np.array(LENGTH)
    cosine, sine = np.cos(TWIST), np.sin(TWIST)
    steps[:, 2, 1], steps[:, 2, 2] = sine, cosine
    angles = np.empty(7)

    def equations(x: np.ndarray, theta: float) -> np.ndarray:
        angles[0], angles[1:] = theta, x
        c, s = np.cos(angles), np.sin(angles)
        a = steps
        a[:, 0, 0], a[:, 0, 1], a[:, 0, 2], a[:, 0, 3] = c, -s * cosine, s * sine, length * c
        a[:, 1, 0], a[:, 1, 1], a[:, 1, 2], a[:, 1, 3] = s, c * cosine, -c * sine, length * s
        t = a[0] @ a[1] @ a[2] @ a[3] @ a[4] @ a[5] @ a[6]
        return np.array(
            [
                t[2, 1] - t[1, 2],
                t[0, 2] - t[2, 0],
                t[1, 0] - t[0, 1],
                t[0, 3] / SIZE,
                t[1, 3] / SIZE,
                t[2, 3] / SIZE,
            ]
        )

    return equations


def plain_closure() -> Closure:
    """The same equations, step by step in plain floats."""
    links = [(a, d, math.cos(t), math.sin(t)) for a, d, t in zip(LENGTH, OFFSET, TWIST, strict=True)]
    sin, cos = math.sin, math.cos

    def equations(x: np.ndarray, theta: float) -> list[float]:
        # the rows of the product; each step multiplies from the right
        r00, r01, r02, p0 = 1.0, 0.0, 0.0, 0.0
        r10, r11, r12, p1 = 0.0, 1.0, 0.0, 0.0
        r20, r21, r22, p2 = 0.0, 0.0, 1.0, 0.0
        for angle, (a, d, ct, st) in zip((theta, *x.tolist()), links, strict=True):
            c, s = cos(angle), sin(angle)
            x0, y0 = c * r00 + s * r01, c * r01 - s * r00
            x1, y1 = c * r10 + s * r11, c * r11 - s * r10
            x2, y2 = c * r20 + s * r21, c * r21 - s * r20
            p0, p1, p2 = p0 + d * r02 + a * x0, p1 + d * r12 + a * x1, p2 + d * r22 + a * x2
            r00, r01, r02 = x0, ct * y0 + st * r02, ct * r02 - st * y0
            r10, r11, r12 = x1, ct * y1 + st * r12, ct * r12 - st * y1
            r20, r21, r22 = x2, ct * y2 + st * r22, ct * r22 - st * y2
        return [r21 - r12, r02 - r20, r10 - r01, p0 / SIZE, p1 / SIZE, p2 / SIZE]

    return equations


def fsolve_circuit(equations: Closure, start: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """Positions (n, 7) along one circuit, each solution the start of the next."""
    rows = np.empty((inputs.size, 7))
    x = start[1:]
    for k, theta in enumerate(inputs.tolist()):
        x = fsolve(equations, x, args=(theta,))
        rows[k, 0], rows[k, 1:] = theta, x
    return rows


def timed(work: Callable[[], object]) -> float:
    """Seconds of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def seven_r() -> sb.Linkage:
    """The paper's linkage."""
    return sb.from_dh("RRRRRRR", LENGTH, TWIST, OFFSET, name="7R")


def against_fsolve(equations: Closure) -> tuple[float, float, float, float]:
    """Median seconds of the peer and of Sevenbar for one circuit; the ratio of them, and of paired runs."""
    linkage = seven_r()
    motion = linkage.motion(samples=SAMPLES)
    circuit = motion.circuits[0]
    theirs = fsolve_circuit(equations, circuit.q[0], circuit.q[:, 0])
    apart = np.abs((theirs - circuit.q + np.pi) % (2 * np.pi) - np.pi)
    # the peer follows the same circuit, or the comparison is of different work
    assert len(motion.circuits) == 8
    assert apart.max() < 1e-6
    peer, ours = [], []
    for _ in range(ROUNDS):
        peer.append(timed(lambda: fsolve_circuit(equations, circuit.q[0], circuit.q[:, 0])))
        ours.append(timed(lambda: linkage.circuit(circuit.q[0], samples=SAMPLES)))
    pairs = statistics.median(a / b for a, b in zip(peer, ours, strict=True))
    first, second = statistics.median(peer), statistics.median(ours)
    return first, second, first / second, pairs


def whole_motion(samples: int, rounds: int) -> float:
    """Median seconds of all eight circuits."""
    linkage = seven_r()
    linkage.motion(samples=samples)
    return statistics.median(timed(lambda: linkage.motion(samples=samples)) for _ in range(rounds))


def general_loops() -> list[tuple[sb.Linkage, float]]:
    """Loops of no special geometry: seven axes anywhere, asked a little off the drawn pose."""
    rng = np.random.default_rng(SEED)
    loops = []
    for _ in range(LOOPS):
        joints = [{"kind": "R", "at": rng.normal(size=3), "axis": rng.normal(size=3)} for _ in range(7)]
        loops.append((sb.from_axes(joints), float(rng.uniform(-0.3, 0.3))))
    return loops


def all_modes() -> tuple[float, float, int]:
    """Median and greatest seconds of all modes of a loop, and how many modes there were in all."""
    times, count = [], 0
    for linkage, theta in general_loops():
        linkage.assembly_modes(theta)
        times.append(min(timed(lambda: linkage.assembly_modes(theta)) for _ in range(3)))  # noqa: B023
        count += len(linkage.assembly_modes(theta))
    return statistics.median(times), max(times), count


if __name__ == "__main__":
    print(f"the 7R paper's linkage, one circuit at {SAMPLES} inputs, one thread")
    print("  fsolve: positions only; Sevenbar: with rates to jerk, steps certified; both from a known pose")
    print(f"  {'closure of fsolve':<20} {'fsolve ms':>10} {'Sevenbar ms':>12} {'ratio':>7} {'paired':>7}")
    for name, equations in (("NumPy", numpy_closure()), ("plain floats", plain_closure())):
        peer, ours, ratio, pairs = against_fsolve(equations)
        print(f"  {name:<20} {peer * 1e3:>10.2f} {ours * 1e3:>12.4f} {ratio:>7.0f} {pairs:>7.0f}")
    print(f"all eight circuits at 3600 inputs {whole_motion(3600, ROUNDS) * 1e3:10.2f} ms")
    median, longest, count = all_modes()
    print(f"all modes of {LOOPS} general loops, {count} in all")
    print(f"  median {median * 1e3:.3f} ms, longest {longest * 1e3:.3f} ms")
