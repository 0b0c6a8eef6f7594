"""The 7R paper's finite differences beside exact rates, for its point (-100, -90, -80) on link 4.

The paper takes for the velocity of a sample the step to the next one over the time between them, for the last
sample the step to the first, and for the acceleration the same of these velocities. Printed are the greatest
errors on the first circuit, as parts of the greatest speed and of the greatest acceleration: as the paper has
them, then with each difference set against the middle of the samples that it is made of. Sevenbar's rates
stand for the truth; how far they are from 40-digit numbers, where these are kept, is told below.
Run: `python benches/finite_differences.py`
"""

import json
import math
from pathlib import Path

import numpy as np

import sevenbar as sb

SAMPLES = (90, 360, 3600)
LINK = 4
POINT = (-100.0, -90.0, -80.0)
REFERENCES = Path(__file__).parent.parent / "tests" / "references" / "seven_r_modes.json"

#: Rows nearer than this [rad] to a pose of the references are that pose.
SAME_POSE = 1e-9


def forward(values: np.ndarray, step: float) -> np.ndarray:
    """MATLAB's `diff(values) / step`, with the first value less the last at the end."""
    return (np.roll(values, -1, axis=0) - values) / step


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


def errors_of_rates(linkage: sb.Linkage) -> tuple[float, float, int]:
    """Velocity and acceleration by Sevenbar against 40 digits, on all circuits; at how many poses."""
    references = json.loads(REFERENCES.read_text(encoding="utf-8"))["modes"]
    worst, compared = [0.0, 0.0], 0
    for circuit in linkage.motion(samples=360):
        trace = circuit.point(LINK, POINT)
        for reference in references:
            apart = np.abs((circuit.q - np.array(reference["theta"]) + np.pi) % (2 * np.pi) - np.pi)
            row = int(apart.max(axis=1).argmin())
            if apart[row].max() > SAME_POSE:
                continue
            compared += 1
            for k, (rates, name) in enumerate(((trace.velocity, "v4"), (trace.acceleration, "a4"))):
                error = float(np.linalg.norm(rates[row] - np.array(reference[name])))
                worst[k] = max(worst[k], error / float(np.linalg.norm(rates, axis=1).max()))
    return worst[0], worst[1], compared


def main() -> None:
    """Prints the tables."""
    linkage = sb.load("seven_r")
    print("| | velocity | acceleration | velocity at the middle | acceleration at the middle |")
    print("|---|---|---|---|---|")
    for samples in SAMPLES:
        errors = " | ".join(f"{100 * error:.3g} %" for error in errors_of_differences(linkage, samples))
        print(f"| differences, {samples:,} samples | {errors} |")
    velocity, acceleration, compared = errors_of_rates(linkage)
    print(f"| exact rates, any number of samples | {velocity:.0e} | {acceleration:.0e} | | |")
    print(f"\nexact rates: against 40 digits at {compared} poses of all circuits")
    print("\n| circuit | least speed | at | greatest speed | at |")
    print("|---|---|---|---|---|")
    for circuit in linkage.motion(samples=3600):
        speed = np.linalg.norm(circuit.point(LINK, POINT).velocity, axis=1)
        ends = ((speed[k], math.degrees(circuit.input[k])) for k in (speed.argmin(), speed.argmax()))
        texts = " | ".join(f"{value:.2f} | {at:.1f}" for value, at in ends)
        print(f"| {circuit.index} | {texts} |")


if __name__ == "__main__":
    main()
