"""Torque and reactions compared with Exudyn's at two step sizes, and with both extrapolated to no step.

python -m evidence.accuracy.simulated_forces [NAME ..]
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import sevenbar as sb
from evidence.fuzz.loadings import random_inertia
from evidence.markdown import table
from sevenbar.arrays import Floats
from sevenbar.simulation.run import moved, prepared
from sevenbar.text.units import LENGTHS

#: Steps a turn of the coarser run; the finer has twice as many.
STEPS = 1800

#: The seed of bodies and loads.
SEED = 7

#: By how much a method of second order is off at half the step, in its error at the whole.
QUARTER = 4


def gallery(name: str) -> Callable[[], sb.Linkage]:
    """What loads a linkage of the gallery."""
    return lambda: sb.load(name)


LINKAGES: dict[str, Callable[[], sb.Linkage]] = {
    name: gallery(name) for name in ("rssr", "seven_r", "rscr", "rsur", "rccc", "rssp", "spherical_4r")
} | {
    "slider_crank": lambda: sb.slider_crank(crank=100, rod=300, offset=40),
    "planar_4r": gallery("planar_4r"),
    "bennett": gallery("bennett"),
}


@dataclass(frozen=True, eq=False)
class Rows:
    """Torque (n,), and all determinate forces (n, k) and moments (n, m) along the joints' axes.

    What passes along a joint's own freedoms is a spring's or the torque, and not among them.
    """

    torque: Floats
    forces: Floats
    moments: Floats

    def off(self, other: Rows) -> list[float]:
        """Greatest differences as parts of the greatest torque, force, and moment or torque."""
        torque = float(np.abs(other.torque).max())
        force = float(np.abs(other.forces).max(initial=0.0))
        moment = float(np.abs(other.moments).max(initial=torque))
        pairs = (
            (self.torque, other.torque, torque),
            (self.forces, other.forces, force),
            (self.moments, other.moments, moment),
        )
        return [float(np.abs(a - b).max(initial=0.0)) / scale if scale else 0.0 for a, b, scale in pairs]


def loaded(linkage: sb.Linkage) -> sb.Linkage:
    """A linkage with random bodies, weight, two loads, a spring with a damper, and one in the output.

    The joint of an output that goes round has the damper alone.
    """
    rng = np.random.default_rng(SEED)
    circuit, last = linkage.motion(8).circuits[0], len(linkage.joints)
    size = circuit.size
    metre = LENGTHS[linkage.length_unit]

    def body() -> sb.Body:
        mass, centre = rng.uniform(0.5, 3.0), 0.1 * size * rng.normal(size=3)
        return sb.Body(mass, tuple(centre), mass * random_inertia(rng, 0.5 * size * metre))

    slides = linkage.column_kinds[linkage.columns.index(linkage.drive.output)] == "slide"
    unit = size**-2 if slides else 1.0
    stiffness = 2.0 * unit if circuit.output_range else 0.0
    return linkage.loaded(
        bodies={link: body() for link in range(1, last)},
        gravity=(1.0, 2.0, -9.8),
        loads=[
            sb.Load(last - 1, (3.0, 4.0, -5.0), (0.1, 0.2, 0.3), at=(0.1 * size, 0.0, 0.0), axes="link"),
            sb.Load(1, (1.0, -2.0, 5.0), (0.1, 0.2, 0.3), at=(0.1 * size, 0.0, 0.0)),
        ],
        springs=[
            sb.Spring(0.3, 0.4 * size, 0.01, links=(1, last), at=((0.1 * size, 0.0, 0.0), (0.0, 0.0, size))),
            sb.Spring(stiffness, 0.1, 0.3 * unit, joint=linkage.drive.output),
        ],
    )


def both(linkage: sb.Linkage, steps: int, every: int) -> tuple[Rows, Rows]:
    """Exudyn's and Sevenbar's values at every so many rows of a course."""
    way, model = prepared(linkage, steps=steps)
    record = moved(way, model, "exudyn").record
    assert record.drive is not None
    assert record.reactions is not None
    rows, given = way.rows[::every], slice(len(way.lead), None, every)
    forces = way.circuit.forces()
    theirs: list[list[Floats]] = [[], []]
    ours: list[list[Floats]] = [[], []]
    for joint, seat in zip(linkage.joints, model.seats, strict=True):
        own = forces.reactions[joint.name]
        free = np.array(model.connections[seat].row.free)
        wrench = record.reactions[given, seat].reshape(-1, 2, 3)
        along = np.einsum("nji,nkj->nki", own.axes[rows], wrench)
        for k, (values, held) in enumerate(
            ((own.force, own.determinate[3:] & ~free[:3]), (own.moment, own.determinate[:3] & ~free[3:]))
        ):
            theirs[k].append(along[:, k, held])
            ours[k].append(values[rows][:, held])
    return (
        Rows(record.drive[given], *(np.concatenate(part, axis=1) for part in theirs)),
        Rows(forces.torque[rows], *(np.concatenate(part, axis=1) for part in ours)),
    )


def measured(linkage: sb.Linkage, steps: int = STEPS) -> list[list[float]]:
    """Torque, forces and moments: off at `steps`, at twice as many, and with both extrapolated."""
    coarse, own = both(linkage, steps, 1)
    fine, again = both(linkage, 2 * steps, 2)
    found = [
        (QUARTER * b - a) / (QUARTER - 1)
        for a, b in (
            (coarse.torque, fine.torque),
            (coarse.forces, fine.forces),
            (coarse.moments, fine.moments),
        )
    ]
    return [coarse.off(own), fine.off(again), Rows(*found).off(own)]


def main(names: Sequence[str]) -> None:
    """Prints the table, a row as it is done."""
    heads = ["linkage"]
    for steps in (f"{STEPS:,}", f"{2 * STEPS:,}", "extrapolated"):
        heads += [f"torque, {steps}", f"forces, {steps}", f"moments, {steps}"]
    rows = []
    for name in names or LINKAGES:
        found = measured(loaded(LINKAGES[name]()))
        rows.append([name, *(f"{value:.1e}" for part in found for value in part)])
        print(rows[-1], file=sys.stderr, flush=True)
    print(table(heads, rows))


if __name__ == "__main__":
    main(sys.argv[1:])
