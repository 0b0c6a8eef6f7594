"""The acceleration pole of a link: the point of it that has no acceleration at an instant.

The acceleration of the point x is `c + G x` with `G = (alpha x + omega x omega x) R`, so the pole is
`-G^-1 c`. Since `det G = -|omega x alpha|^2`, there is one wherever the axis of rotation changes its
direction. Where the axis keeps its direction, as in planar motion, G has rank two: a line of points along the
axis has the least acceleration, which is the part along the axis. Where the link does not turn at all every
point has the same acceleration.

Source: docs/theory_design.md, (21).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Words, triple
from sevenbar.design.points.cycle import Cycle, cycle_of
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.text.printing import Printed

#: The least singular value of G, relative to its greatest, of a single pole. G is known to some 1e-12; a pole
#: that is known to less than three digits is reported as a line.
RANK = 1e-9

#: A link whose greatest singular value [1/s^2] is below this part of the square of the input's speed does not
#: turn.
STILL = 1e-10


@dataclass(frozen=True, eq=False, repr=False)
class AccelerationPoles(Printed):
    """The pole of a link row by row over a cycle of n rows; `input` [rad, or length], `time` [s], each (n,).

    `status` (n,): "pole", one point without acceleration; "line", a line of points with the least, of which
    the one nearest to `near` is given; "none", a link that does not turn, whose points all accelerate alike.
    `at` (n, 3) are the points in the frame of the link, `place` (n, 3) the same in the report frame [length],
    NaN where there is none. `axis` (n, 3) is the line's direction in the link, NaN where there is none.
    `remaining` (n,) [length/s^2] is the acceleration of the point, `condition` (n,) by how much an error of
    the rates is magnified in the pole.
    """

    cycle: Cycle
    at: Floats
    place: Floats
    axis: Floats
    remaining: Floats
    condition: Floats
    status: Words

    @property
    def input(self) -> Floats:
        """The input [rad, or length], (n,)."""
        return self.cycle.rates.input

    @property
    def time(self) -> Floats:
        """The time [s], (n,)."""
        return self.cycle.rates.time


def acceleration_poles(
    motion: Motion,
    link: int,
    *,
    near: npt.ArrayLike = (0.0, 0.0, 0.0),
    circuit: int = 0,
    branch: int = 0,
) -> AccelerationPoles:
    """The acceleration poles of link 1, 2, .. over a circuit; `near` (3,) [length] is a point as written.

    Raises `RequestError` for a link or circuit that does not fit.

        >>> import sevenbar as sb
        >>> poles = acceleration_poles(sb.load("seven_r").motion(), 4)
        >>> sorted(set(poles.status.tolist())), bool(poles.remaining.max() < 1e-9)
        (['pole'], True)
    """
    wanted = np.array(triple("near", near))
    cycle = cycle_of(motion, link, circuit, branch, order="acceleration", rows=motion.samples)
    return poles_of(cycle, wanted)


def poles_of(cycle: Cycle, near: Floats) -> AccelerationPoles:
    """The poles along a cycle; `near` (3,) as for `acceleration_poles`."""
    rates = cycle.rates
    gradient, value = rates.gradient[2], rates.of("acceleration", near)
    left, sizes, right = np.linalg.svd(gradient)
    speed = float(np.abs(cycle.circuit.dq[:, cycle.circuit.input_column]).max())
    turns = sizes[:, 0] > STILL * speed**2
    single = turns & (sizes[:, 2] > RANK * sizes[:, 0])
    # the pseudo-inverse of G, which gives the point of a line nearest to `near`
    solvable = np.stack([turns, turns, single], axis=1)
    inverse = np.divide(1.0, sizes, out=np.zeros_like(sizes), where=solvable)
    at = near - np.einsum("kji,kj,klj,kl->ki", right, inverse, left, value)
    status = np.where(single, "pole", np.where(turns, "line", "none"))
    at[~turns] = np.nan
    remaining = np.linalg.norm(value + np.einsum("kij,kj->ki", gradient, np.nan_to_num(at - near)), axis=1)
    place = rates.constant[0] + np.einsum("kij,kj->ki", rates.gradient[0], at)
    axis = np.where((turns & ~single)[:, None], right[:, 2], np.nan)
    smallest = np.where(single, sizes[:, 2], sizes[:, 1])
    condition = np.divide(sizes[:, 0], smallest, out=np.full(len(sizes), np.inf), where=turns)
    return AccelerationPoles(cycle, at, place, axis, remaining, condition, status)
