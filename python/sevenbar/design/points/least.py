"""The point of a link, within a box, whose greatest acceleration over the cycle is least, and its proof.

The acceleration of the point x is `a(s) = c(s) + G(s) x` at the input s, so the greatest |a| over the cycle
is a convex function of x. For chosen inputs it is a second-order cone problem (`box`). Its optimum is a
lower bound for the whole cycle, since inputs left out can only add to it; the greatest at the point found,
sought between the rows too, is an upper bound. Inputs at which that is met are added until both agree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.design.course import SearchCourse
from sevenbar.design.idle_link import refuse_idle_link
from sevenbar.design.points.box import least_greatest, least_squares_in
from sevenbar.design.points.cycle import ORDERS, Cycle, box_of, cycle_of
from sevenbar.design.points.polish import polished
from sevenbar.errors import check_word
from sevenbar.forces.cones import ConeOptimum
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress, silent

#: The part of the greatest within which upper and lower bound have to agree.
GAP = 1e-9

#: The same relative to the rate at the box's corners, where the least is 0: rounding of a sum of
#: squares.
ZERO = 1e-11

#: Rounds of adding inputs; two to four are usual, more where the greatest is as great at all inputs.
MOST_ROUNDS = 6

#: A peak lower than the greatest by this part may turn out to be one that decides.
ALMOST = 1e-3

#: Inputs [rad, or length] nearer than this are those of one peak.
SAME = 1e-5

#: An input decides where its dual weight is above this part of the whole.
DECIDING = 1e-5

#: A direction of the box in which no rate changes by more than this part of the greatest change is free.
FREE = 1e-12

Rate = Literal["velocity", "acceleration", "jerk"]


@dataclass(frozen=True, eq=False)
class Compared:
    """A point of the linkage's file on the same link: name, place as written, and the same value of it."""

    name: str
    at: tuple[float, float, float]
    value: float


@dataclass(frozen=True, eq=False, repr=False)
class LeastPoint(Printed):
    """The point `at` [length, as points are written] of a link at which a rate is least over the cycle.

    `value` is the greatest over the cycle, or the root mean square, of the quantity `of` [length/s, /s^2,
    /s^3]: no point of the box has less than `bound`. `inputs` (k,) [rad, or length] are those at which the
    greatest is met and by which the bound is proved, `weights` (k,) their shares in it, whose sum is 1; of a
    root mean square none. `sides` names the sides of the box on which the point lies; `free` (m, 3) are
    directions, relative to the box's sides, in which moving it changes nothing. `before` lists the points of
    the file; `solver` Clarabel's last solution of `rounds`.
    """

    cycle: Cycle
    of: Rate
    measure: Literal["greatest", "rms"]
    low: Floats
    high: Floats
    at: Floats
    value: float
    bound: float
    inputs: Floats
    weights: Floats
    sides: tuple[str, ...]
    free: Floats
    before: tuple[Compared, ...]
    rounds: int
    solver: ConeOptimum | None
    #: The size of the rate over the box [unit of the value]: what rounding is a part of.
    scale: float

    @property
    def link(self) -> int:
        """The link that carries the point."""
        return self.cycle.link

    @property
    def gap(self) -> float:
        """How much less another point could have at most."""
        return max(0.0, self.value - self.bound)

    @property
    def relative_gap(self) -> float:
        """The gap relative to the value; 0 where the value is 0 up to rounding."""
        return self.gap / self.value if self.value > ZERO * self.scale else 0.0

    @property
    def optimal(self) -> bool:
        """Whether the bounds agree to 1e-8 of the value: ten times what is sought."""
        return self.relative_gap <= 10 * GAP

    @property
    def unit(self) -> str:
        """The unit of the value, as in mm/s^2."""
        return rate_unit(self.cycle, self.of)


def rate_unit(cycle: Cycle, of: str) -> str:
    """The unit of a rate of a point."""
    order = ORDERS.index(of)
    return cycle.motion.linkage.length_unit + "/s" + (f"^{order}" if order > 1 else "")


def least_acceleration_point(
    motion: Motion, link: int, box: npt.ArrayLike, *, circuit: int = 0, branch: int = 0
) -> LeastPoint:
    """The point of link 1, 2, .. in a box whose greatest acceleration over the cycle is least.

    `box` is ((low, high), (low, high), (low, high)) [length] in the coordinates in which points are written:
    (u, v, w) in Denavit-Hartenberg rows, the link's frame for `[rssr]`, the drawn pose for drawn joints.
    `branch` is the pass of a circuit that rocks, which needs a law. `least_point` has other rates and means.

    Raises `RequestError` for a link, box or circuit that does not fit, `MissingExtraError` without Clarabel.

        >>> import sevenbar as sb
        >>> found = least_acceleration_point(sb.load("seven_r").motion(), 4, [(-200, 200)] * 3)
        >>> round(found.value, 6), found.relative_gap < 1e-9
        (77.183066, True)
    """
    return least_point(motion, link, box, of="acceleration", circuit=circuit, branch=branch)


def least_point(
    motion: Motion,
    link: int,
    box: npt.ArrayLike,
    *,
    of: Rate = "acceleration",
    measure: Literal["greatest", "rms"] = "greatest",
    circuit: int = 0,
    branch: int = 0,
    progress: Progress = silent,
) -> LeastPoint:
    """The point of a box with the least greatest, or least root mean square by time, of a rate.

    `progress` is called with (rounds done, at most how many, the best so far); the rest is as for
    `least_acceleration_point`.

        >>> import sevenbar as sb
        >>> motion = sb.load("seven_r").motion()
        >>> box = [(-200, 200)] * 3
        >>> mean, greatest = (least_point(motion, 4, box, measure=word).value for word in ("rms", "greatest"))
        >>> bool(mean < greatest)
        True
    """
    check_word("of", of, ORDERS[1:])
    check_word("measure", measure, ("greatest", "rms"))
    low, high = box_of(box)
    cycle = cycle_of(motion, link, circuit, branch, order=of)
    refuse_idle_link(motion.linkage, cycle.link, "the motion of a point on it")
    course = SearchCourse(1 if measure == "rms" else MOST_ROUNDS, progress)
    index, centre, half = ORDERS.index(of), (low + high) / 2, (high - low) / 2
    constant, gradient = cycle.rates.constant[index], cycle.rates.gradient[index]
    around = cycle.sizes(of, centre).max() + np.abs(gradient @ half).max()
    free = _free(gradient * half)
    if measure == "rms":
        at, value, bound = _least_rms(cycle, constant, gradient, (low, high), free)
        inputs, weights, rounds, solver = np.array([]), np.array([]), 1, None
    else:
        at, value, bound, inputs, weights, rounds, solver = _least_greatest(
            cycle, of, (low, high), free, around, course
        )
    course.end()
    before = tuple(
        Compared(p.name, p.at, _value(cycle, of, measure, np.array(p.at)))
        for p in motion.linkage.points
        if p.link == link
    )
    return LeastPoint(
        cycle=cycle,
        of=of,
        measure=measure,
        low=low,
        high=high,
        at=at,
        value=value,
        bound=min(bound, value),
        inputs=inputs,
        weights=weights,
        sides=_sides(at, low, high),
        free=free,
        before=before,
        rounds=rounds,
        solver=solver,
        scale=float(around),
    )


def _least_greatest(
    cycle: Cycle, of: Rate, box: tuple[Floats, Floats], free: Floats, around: float, course: SearchCourse
) -> tuple[Floats, float, float, Floats, Floats, int, ConeOptimum]:
    """Point, value, bound, inputs that decide, their weights, rounds, the cones' last solution."""
    index, (low, high) = ORDERS.index(of), box
    inputs = cycle.rates.input
    constant, gradient = cycle.rates.constant[index], cycle.rates.gradient[index]
    value, bound, rounds = math.inf, 0.0, 0
    while True:
        rounds += 1
        at, least, solver = least_greatest(constant, gradient, low, high)
        at, weights = _centred(at, box, free), np.linalg.norm(solver.duals, axis=1)
        peaks, heights = cycle.peaks(of, at)
        bound = max(bound, least)
        tried = [(float(heights.max()), at, inputs, weights)]
        if cycle.closed:
            # by Newton's method, from peaks that are nearly the greatest and rows with a weight
            started = np.concatenate(
                [peaks[heights >= (1 - ALMOST) * heights.max()], inputs[weights > DECIDING]]
            )
            better = polished(cycle, of, at, started, low, high)
            if better is not None:
                bound = max(bound, better.bound)
                height = float(cycle.peaks(of, better.at)[1].max())
                tried.append((height, better.at, better.inputs, better.weights))
        nearest = min(tried, key=lambda one: one[0])
        if nearest[0] < value:
            value, best, deciding, shares = nearest
        course.step(f"best: {value:.6g} {rate_unit(cycle, of)}")
        close = value - bound <= max(GAP * value, ZERO * around)
        if close or not cycle.closed or rounds == MOST_ROUNDS:
            break
        added = cycle.at(peaks)
        inputs = np.concatenate([inputs, peaks])
        constant = np.concatenate([constant, added.constant[index]])
        gradient = np.concatenate([gradient, added.gradient[index]])
    return best, value, bound, *_deciding(cycle, deciding, shares), rounds, solver


def _deciding(cycle: Cycle, inputs: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """The inputs with a weight, rising within the cycle, and the weights; those of one peak together."""
    inputs, weights = inputs[weights > DECIDING], weights[weights > DECIDING]
    if cycle.closed:
        inputs = (inputs + SAME) % cycle.turn - SAME
    order = np.argsort(inputs)
    inputs, weights = inputs[order], weights[order]
    first = np.flatnonzero(np.diff(inputs, prepend=-np.inf) > SAME)
    return inputs[first], np.add.reduceat(weights, first) if len(first) else weights


def _least_rms(
    cycle: Cycle, constant: Floats, gradient: Floats, box: tuple[Floats, Floats], free: Floats
) -> tuple[Floats, float, float]:
    """Point, root mean square, and lower bound: linear least squares in a box."""
    root = np.sqrt(len(constant) * cycle.shares)[:, None]
    at, bound = least_squares_in(root * constant, root[:, :, None] * gradient, *box)
    at = _centred(at, box, free)
    value = math.sqrt(float(((root * (constant + gradient @ at)) ** 2).sum(axis=1).mean()))
    return at, value, bound


def _value(cycle: Cycle, of: str, measure: str, at: Floats) -> float:
    """The greatest of a rate of a point over the cycle, or its root mean square."""
    if measure == "rms":
        return math.sqrt(cycle.mean((cycle.rates.of(of, at) ** 2).sum(axis=1)))
    return float(cycle.peaks(of, at)[1].max())


def _free(gradient: Floats) -> Floats:
    """Directions (m, 3) of the box, relative to its sides, in which no row (n, 3, 3) changes."""
    _, sizes, rows = np.linalg.svd(gradient.reshape(-1, 3), full_matrices=False)
    return np.asarray(rows[sizes <= FREE * max(sizes[0], np.finfo(float).tiny)])


def _centred(at: Floats, box: tuple[Floats, Floats], free: Floats) -> Floats:
    """The point as near to the box's centre as directions that change nothing allow."""
    low, high = box
    centre, half = (low + high) / 2, (high - low) / 2
    away = (at - centre) / np.where(half > 0, half, 1.0)
    nearer = centre + half * (away - free.T @ (free @ away))
    return nearer if ((nearer >= low) & (nearer <= high)).all() else at


def _sides(at: Floats, low: Floats, high: Floats) -> tuple[str, ...]:
    """The sides of the box on which a point lies, as in "u lowest"."""
    near = 1e-6 * (high - low) / 2
    words = []
    for i, letter in enumerate("uvw"):
        if high[i] == low[i]:
            words.append(f"{letter} given")
        elif at[i] - low[i] <= near[i]:
            words.append(f"{letter} lowest")
        elif high[i] - at[i] <= near[i]:
            words.append(f"{letter} highest")
    return tuple(words)
