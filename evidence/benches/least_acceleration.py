"""The point of least acceleration of the 7R paper's link 4, set against searches that know nothing of it.

Run: python evidence/benches/least_acceleration.py [--points 31]
"""

import argparse
import time

import numpy as np

import sevenbar as sb
from sevenbar.arrays import Floats
from sevenbar.design.points import least_acceleration_point
from sevenbar.kinematics.circuits.circuit import Circuit

LINK, SIDE = 4, 200.0


def rows_of(circuit: Circuit) -> tuple[Floats, Floats]:
    """The acceleration of all points of the link: of the first (n, 3), and by coordinate (3, n, 3)."""
    origin, *ends = (
        circuit.point(LINK, at).acceleration
        for at in ((0.0, 0.0, 0.0), (SIDE, 0.0, 0.0), (0.0, SIDE, 0.0), (0.0, 0.0, SIDE))
    )
    return origin, np.stack([(end - origin) / SIDE for end in ends])


def search(rows: tuple[Floats, Floats], middle: Floats, half: float, count: int) -> Floats:
    """The point of the least of the greatest accelerations over a grid of count^3 points within the box."""
    origin, slopes = rows
    axes = [np.clip(np.linspace(m - half, m + half, count), -SIDE, SIDE) for m in middle]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    squares = np.zeros(len(points))
    for value, slope in zip(origin, slopes.swapaxes(0, 1), strict=True):
        vectors = value + points @ slope
        np.maximum(squares, np.einsum("ij,ij->i", vectors, vectors), out=squares)
    best: Floats = points[int(squares.argmin())]
    return best


def greatest(circuit: Circuit, at: Floats) -> float:
    """The greatest acceleration of a point over the rows of a circuit."""
    u, v, w = (float(x) for x in at)
    return float(np.linalg.norm(circuit.point(LINK, (u, v, w)).acceleration, axis=1).max())


def main() -> None:
    """Prints the optimum with its bound, then the searches, each on a finer grid round the best before."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=31, help="points along a side of the grid")
    count = parser.parse_args().points
    motion = sb.load("seven_r").motion()
    box = [(-SIDE, SIDE)] * 3
    least_acceleration_point(motion, LINK, box)
    started = time.process_time()
    found = least_acceleration_point(motion, LINK, box)
    spent = time.process_time() - started
    print(f"optimum      {found.value:.9f} mm/s^2 at {np.round(found.at, 5)}, {1e3 * spent:.0f} ms")
    print(f"lower bound  {found.bound:.9f}, gap {found.gap:.1e}, relative {found.relative_gap:.1e}")
    rows = rows_of(motion.linkage.motion(720).circuits[0])
    fine = motion.linkage.motion(36_000).circuits[0]
    middle, half = np.zeros(3), SIDE
    for _ in range(6):
        middle = search(rows, middle, half, count)
        # the rows of the search are half a degree apart and miss a little; these are a hundredth
        value = greatest(fine, middle)
        spacing = 2 * half / (count - 1)
        told = f"{count**3} points {spacing:.2g} mm apart"
        print(f"search       {value:.9f} over {told}: {value - found.value:+.2e}")
        # a narrow valley: a finer grid must not lose it
        half *= 0.3


if __name__ == "__main__":
    main()
