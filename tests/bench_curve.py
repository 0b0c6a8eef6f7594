"""The curve of examples/rssr_bench.csv: what a bench would measure on an RSSR whose dimensions are a little off.

Source: the closure alone, by `reference_rssr`; noise of a known deviation from a fixed seed. `PYTHONPATH=. python tests/bench_curve.py`
prints the file.
"""

from __future__ import annotations

import numpy as np

from evidence.fuzz.random_linkages import Dimensions

#: The real dimensions [mm], where the drawing has 700, 700, 250, 550, 0, 997.497.
REAL = Dimensions(M=700.0, N=700.0, L1=251.2, L3=548.6, D=0.0, L2=998.1)

#: The zeros of the two encoders [rad]: crank = measured + INPUT_ZERO, measured = rocker + OUTPUT_ZERO.
INPUT_ZERO, OUTPUT_ZERO = 0.020, -0.010

#: Speed of the crank [rad/s], deviation of the encoder's noise [rad], rows of one turn, seed.
SPEED, NOISE, ROWS, SEED = 10.0, 0.0005, 180, 2010

HEADER = f"""\
# Not measured: computed by tests/bench_curve.py from the closure of an RSSR with the dimensions
# M = {REAL.M:g}, N = {REAL.N:g}, L1 = {REAL.L1:g}, L2 = {REAL.L2:g}, L3 = {REAL.L3:g}, D = {REAL.D:g} mm, one turn of the crank at {SPEED:g} rad/s.
# Its zeros are {INPUT_ZERO:g} rad (crank) and {OUTPUT_ZERO:g} rad (rocker) off, its noise has a standard deviation of {NOISE:g} rad.
time [s],rocker [deg]
"""


def text() -> str:
    """The file."""
    times = 2 * np.pi / SPEED / ROWS * np.arange(ROWS)
    angle = REAL.reference().outputs(SPEED * times + INPUT_ZERO)[0] + OUTPUT_ZERO
    angle = angle + NOISE * np.random.default_rng(SEED).normal(size=ROWS)
    return HEADER + "".join(f"{t:.6f},{a:.4f}\n" for t, a in zip(times, np.degrees(angle), strict=True))


if __name__ == "__main__":
    print(text(), end="")  # noqa: T201
