"""How many answers tasks have whose number theory counts: random tasks, what was found, and the time.

Run: python -m evidence.benches.exact_counts [--tasks 100] [--seed 0]

Times are those of whole tasks, with the motion of every linkage found; the sources give none to compare.
"""

import argparse
import math
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design import exact
from sevenbar.design.exact.answers import ExactAnswers
from sevenbar.kinematics.loop.rigid import pose, rotation_of

#: What books and papers say of each task: the number over the complex numbers, and the real ones.
SAID = {
    "planar, 5 poses": "4 dyads, 0, 2 or 4 real (Burmester 1888)",
    "spherical, 5 orientations": "6 dyads at most (McCarthy, Soh 2011)",
    "CC, 5 poses": "6 dyads at most (McCarthy, Soh 2011)",
    "Bennett, 3 poses": "one linkage, two real dyads (Suh 1969; Brunnthaler and others 2005)",
    "RSSR, 8 pairs": "derived on this site: 1 closure, 1 linkage",
    "RSSR square, 7 pairs": "derived on this site: 2 closures",
    "RSSR twist 63 deg, 7 pairs": "derived on this site: 2 closures",
    "RSSR zeros given, 6 pairs": "derived on this site: 1 closure",
}


@dataclass
class Tally:
    """What the tasks of one kind had."""

    complete: int = 0
    real: Counter[int] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    linkages: int = 0
    worst: float = 0.0
    seconds: list[float] = field(default_factory=list)

    def add(self, found: ExactAnswers, seconds: float) -> None:
        """Counts one task."""
        self.complete += found.complete
        self.real[found.real] += 1
        self.linkages += len(found.answers)
        self.faults.update("none" if a.fault is None else a.fault for a in found.answers if a.verdict)
        self.worst = max([self.worst, *(a.error for a in found.answers)])
        self.seconds.append(seconds)


def turns(rng: np.random.Generator, count: int) -> Floats:
    """Rotations (count, 3, 3), even over all of them."""
    four = rng.normal(size=(count, 4))
    return rotation_of(four / np.linalg.norm(four, axis=1, keepdims=True))


def poses(rng: np.random.Generator, count: int) -> Floats:
    """Poses (count, 4, 4) within a box of side 100."""
    return pose(turns(rng, count), rng.uniform(-50, 50, (count, 3)))


def pairs(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    """Pairs of readings (count,) [rad]."""
    return np.sort(rng.uniform(0, 2.5, count)), rng.uniform(-1, 1, count)


def planar(rng: np.random.Generator) -> Floats:
    """Poses x, y, angle (5, 3)."""
    return np.column_stack([rng.uniform(-50, 50, (5, 2)), rng.uniform(-1.5, 1.5, 5)])


TASKS: dict[str, Callable[[np.random.Generator], ExactAnswers]] = {
    "planar, 5 poses": lambda rng: exact.planar_poses(planar(rng)),
    "spherical, 5 orientations": lambda rng: exact.spherical_orientations(turns(rng, 5)),
    "CC, 5 poses": lambda rng: exact.cc_dyads(poses(rng, 5)),
    "Bennett, 3 poses": lambda rng: exact.bennett_poses(poses(rng, 3)),
    "RSSR, 8 pairs": lambda rng: exact.function_pairs(*pairs(rng, 8)),
    "RSSR square, 7 pairs": lambda rng: exact.function_pairs(*pairs(rng, 7), twist=math.pi / 2),
    "RSSR twist 63 deg, 7 pairs": lambda rng: exact.function_pairs(*pairs(rng, 7), twist=1.1),
    "RSSR zeros given, 6 pairs": lambda rng: exact.function_pairs(*pairs(rng, 6), zeros=(0.3, 0.5)),
}


def main() -> None:
    """Prints one paragraph for each kind of task."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    for name, task in TASKS.items():
        rng, tally = np.random.default_rng(given.seed), Tally()
        for _ in range(given.tasks):
            start = time.perf_counter()
            found = task(rng)
            tally.add(found, time.perf_counter() - start)
        real = ", ".join(f"{count} with {number}" for number, count in sorted(tally.real.items()))
        faults = ", ".join(f"{count} {fault}" for fault, count in tally.faults.most_common()) or "no verdict"
        print(f"{name}")
        print(f"    theory     {found.theory} {found.counted}; {SAID[name]}")
        print(f"    complete   {tally.complete} of {given.tasks}")
        print(f"    real       {real}")
        print(f"    linkages   {tally.linkages}; defects: {faults}")
        print(f"    worst closure error {tally.worst:.1e} of the size")
        print(f"    time       {1e3 * float(np.median(tally.seconds)):.1f} ms (median), checks included")


if __name__ == "__main__":
    main()
