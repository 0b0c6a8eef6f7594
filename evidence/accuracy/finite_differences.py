"""The 7R paper's finite differences beside exact rates, for its point (-100, -90, -80) on link 4.

The paper takes for the velocity of a sample the step to the next one over the time between them, for the last
sample the step to the first, and for the acceleration the same of these velocities. It tells no number of
samples. Run by itself it prints the tables of docs/seven_r.md:
`python -m evidence.accuracy.finite_differences`
"""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy.forty_digits import LoopReference
from evidence.accuracy.gallery_rows import seeded
from evidence.accuracy.published import LINK, POINT, seven_r

#: Samples of a turn of the tables.
SAMPLES = (90, 360, 3600)

#: Steps [rad] of the curve of errors, from one to where nothing but rounding is left.
STEPS = tuple(10.0 ** (-k / 4) for k in range(49))

#: How many inputs, drawn at random, a point of that curve is the greatest error of.
INPUTS = 24


def forward(values: np.ndarray, step: float) -> np.ndarray:
    """MATLAB's `diff(values) / step`, with the first value less the last at the end."""
    steps: np.ndarray = (np.roll(values, -1, axis=0) - values) / step
    return steps


def relative(values: np.ndarray, truth: np.ndarray) -> float:
    """The longest difference of two sets of vectors (n, 3), as a part of the longest true one."""
    lengths = np.linalg.norm(values - truth, axis=1), np.linalg.norm(truth, axis=1)
    return float(lengths[0].max() / lengths[1].max())


def errors_of_differences(linkage: sb.Linkage, samples: int) -> tuple[float, float, float, float]:
    """Velocity and acceleration by the paper's way; the same set against the middle of their samples."""
    # every second row lies half way between two samples
    trace = linkage.motion(samples=2 * samples).circuits[0].point(LINK, POINT)
    step = 2 * math.pi / samples
    velocity = forward(trace.position[::2], step)
    acceleration = forward(velocity, step)
    return (
        relative(velocity, trace.velocity[::2]),
        relative(acceleration, trace.acceleration[::2]),
        relative(velocity, trace.velocity[1::2]),
        relative(acceleration, np.roll(trace.acceleration[::2], -1, axis=0)),
    )


def last_sample(linkage: sb.Linkage, samples: int) -> float:
    """The error of the last velocity where samples hold both 0 and 360 degrees, as of MATLAB's `linspace`.

    The last point is the first again, so the difference is zero whatever the point does. As a part of the
    greatest speed.
    """
    trace = linkage.motion(samples=samples - 1).circuits[0].point(LINK, POINT)
    closed = np.concatenate([trace.position, trace.position[:1]])
    velocity = forward(closed, 2 * math.pi / (samples - 1))
    greatest = float(np.linalg.norm(trace.velocity, axis=1).max())
    return float(np.linalg.norm(velocity[-1] - trace.velocity[0])) / greatest


def _forward_rates(x: Callable[[int], np.ndarray], h: float) -> list[np.ndarray]:
    """Three derivatives from samples here and ahead."""
    first = x(1) - x(0)
    second = x(2) - 2 * x(1) + x(0)
    return [first / h, second / h**2, (x(3) - 3 * x(2) + 3 * x(1) - x(0)) / h**3]


def _central_rates(x: Callable[[int], np.ndarray], h: float) -> list[np.ndarray]:
    """Three derivatives from samples to both sides."""
    second = x(1) - 2 * x(0) + x(-1)
    return [(x(1) - x(-1)) / (2 * h), second / h**2, (x(2) - 2 * x(1) + 2 * x(-1) - x(-2)) / (2 * h**3)]


#: The schemes by name: velocity, acceleration and jerk from samples a step apart.
SCHEMES = {"forward": _forward_rates, "central": _central_rates}


def errors_by_step() -> dict[str, object]:
    """Errors of differences of the point's places at each step, and of exact rates, against 60 digits.

    The greatest error at any input, relative to the greatest exact rate of all inputs; each a list by step,
    for velocity, acceleration and jerk. Places are in double precision, as any program would have them.
    """
    linkage = sb.load("seven_r")
    pose = linkage.assembly_modes(0.0).q[0]
    inputs = np.sort(seeded("seven_r", 4).uniform(0, 2 * np.pi, INPUTS))
    against = LoopReference(linkage, 0)
    offsets = range(-2, 4)
    # (inputs, steps, offsets)
    grid = inputs[:, None, None] + np.array(STEPS)[None, :, None] * np.array(offsets)
    order = np.argsort(grid.ravel(), kind="stable")
    law = sb.Law.of(np.arange(grid.size), grid.ravel()[order], 1.0, 0.0, 0.0)
    circuit = linkage.circuit(pose, law=law)
    trace = circuit.point(LINK, POINT)
    places, rates = np.empty((grid.size, 3)), np.empty((3, grid.size, 3))
    places[order] = trace.position
    for k, values in enumerate((trace.velocity, trace.acceleration, trace.jerk)):
        rates[k, order] = values
    joints = np.empty((grid.size, len(linkage.columns)))
    joints[order] = circuit.q
    places = places.reshape(*grid.shape, 3)
    # all steps share the middle one
    middle = offsets.index(0)
    ours = rates.reshape(3, *grid.shape, 3)[:, :, 0, middle]
    poses = joints.reshape(*grid.shape, -1)[:, 0, middle]
    with mp.workdps(against.digits):
        moments = [against.exact(q, (1.0, 0.0, 0.0), LINK, POINT)[1] for q in poses]
    exact = np.array([[[float(x[k]) for x in point] for point in moments] for k in (1, 2, 3)])
    scales = [float(np.linalg.norm(values, axis=1).max()) for values in exact]

    def errors(values: list[np.ndarray]) -> list[float]:
        return [
            float(np.linalg.norm(v - e, axis=1).max()) / scale
            for v, e, scale in zip(values, exact, scales, strict=True)
        ]

    found: dict[str, object] = {"steps": list(STEPS), "exact rates": errors(list(ours))}
    for name, scheme in SCHEMES.items():
        by_step = [
            errors(scheme(lambda k, s=s: places[:, s, middle + k], h))  # type: ignore[misc]
            for s, h in enumerate(STEPS)
        ]
        found[name] = [list(values) for values in zip(*by_step, strict=True)]
    return found


def measured() -> dict[str, object]:
    """All that the page states of differences."""
    linkage = sb.load("seven_r")
    return {
        "by_samples": {str(samples): errors_of_differences(linkage, samples) for samples in SAMPLES},
        "last_sample": last_sample(linkage, 361),
        "by_step": errors_by_step(),
    }


def main() -> None:
    """Prints the tables."""
    linkage = sb.load("seven_r")
    print("| | velocity | acceleration | velocity at the middle | acceleration at the middle |")
    print("|---|---|---|---|---|")
    for samples in SAMPLES:
        errors = " | ".join(f"{100 * error:.3g} %" for error in errors_of_differences(linkage, samples))
        print(f"| differences, {samples:,} samples | {errors} |")
    kept = seven_r()
    errors_of_all = kept["errors"]
    assert isinstance(errors_of_all, dict)
    velocity, acceleration = errors_of_all["v4"], errors_of_all["a4"]
    print(f"| exact rates, any number of samples | {velocity:.0e} | {acceleration:.0e} | | |")
    print(f"\nexact rates: against 40 digits at {kept['compared']} poses of all circuits")
    print("\n| circuit | least speed | at | greatest speed | at |")
    print("|---|---|---|---|---|")
    for circuit in linkage.motion(samples=3600):
        speed = np.linalg.norm(circuit.point(LINK, POINT).velocity, axis=1)
        ends = ((speed[k], math.degrees(circuit.input[k])) for k in (speed.argmin(), speed.argmax()))
        texts = " | ".join(f"{value:.2f} | {at:.1f}" for value, at in ends)
        print(f"| {circuit.index} | {texts} |")


if __name__ == "__main__":
    main()
