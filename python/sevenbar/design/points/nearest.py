"""The point of a link, within a box, whose path is nearest a wanted curve.

The place of the point x is `p(s) = o(s) + R(s) x`, so at given inputs the distances from wanted places are
affine in x: their least root mean square is linear least squares, their least greatest a second-order cone
problem; both have one optimum. Without inputs each place of the curve is compared with the place of the path
nearest to it, which changes with x: such a search finds an optimum near where it starts, so it starts from
many points of the box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers, finite_array
from sevenbar.design.course import SearchCourse
from sevenbar.design.idle_link import refuse_idle_link
from sevenbar.design.points.box import least_greatest, least_squares_in
from sevenbar.design.points.cycle import Cycle, LinkRates, box_of, cycle_of, input_text
from sevenbar.errors import RequestError, check_word
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress, silent

#: Starts along each side of the box: from the 27 points of a grid the basins of a closed curve are met.
STARTS = 3

#: Rounds of nearest rows and least squares from each start; the best are followed exactly afterwards.
ROUNDS = 30

#: How many of the ends are followed.
FOLLOWED = 4

#: Steps of Newton's method from a row to the nearest input between rows; it doubles the digits.
STEPS = 4


@dataclass(frozen=True, eq=False, repr=False)
class NearestPath(Printed):
    """The point `at` [length, as points are written] whose path is nearest m wanted places (m, 3).

    `path` (m, 3) are the places of its path compared with them, at `inputs` (m,) [rad, or length];
    `distances` (m,) [length]. `bound` is a value of `rms` or `greatest` that no point of the box is below;
    `None` where inputs were free: then the optimum is local, the best of `starts`, of which `agreeing` ended
    at the same point.
    """

    cycle: Cycle
    measure: Literal["rms", "greatest"]
    at: Floats
    wanted: Floats
    path: Floats
    inputs: Floats
    bound: float | None
    starts: int
    agreeing: int

    @property
    def link(self) -> int:
        """The link that carries the point."""
        return self.cycle.link

    @property
    def distances(self) -> Floats:
        """The distance of each wanted place from the path, (m,) [length]."""
        return np.asarray(np.linalg.norm(self.wanted - self.path, axis=-1))

    @property
    def rms(self) -> float:
        """The root mean square of the distances [length]."""
        return math.sqrt(float((self.distances**2).mean()))

    @property
    def greatest(self) -> float:
        """The greatest distance [length]."""
        return float(self.distances.max())


def nearest_path_point(
    motion: Motion,
    link: int,
    curve: npt.ArrayLike,
    box: npt.ArrayLike,
    *,
    inputs: npt.ArrayLike | None = None,
    measure: Literal["rms", "greatest"] = "rms",
    circuit: int = 0,
    branch: int = 0,
    progress: Progress = silent,
) -> NearestPath:
    """The point of link 1, 2, .. in a box whose path is nearest a curve of m places (m, 3).

    Places are in the report frame [length]. With `inputs` (m,) [rad, or length] the path shall be at each
    place at its input; without, it shall pass by each place at any: `measure` "rms" only. What the path does
    away from them does not count. `progress` is called with (starts done, of how many, the best so far).

    Raises `RequestError` for arguments that do not fit, or inputs at which the circuit has no pose.

        >>> import sevenbar as sb
        >>> motion = sb.load("rssr").motion()
        >>> curve = motion.circuits[0].point(2, (500, 40, 20)).position[::30]
        >>> inputs = motion.circuits[0].input[::30]
        >>> found = nearest_path_point(motion, 2, curve, [(0, 900), (-100, 100), (-100, 100)], inputs=inputs)
        >>> found.at.round(6).tolist()
        [500.0, 40.0, 20.0]
    """
    low, high = box_of(box)
    wanted = _places(curve)
    check_word("measure", measure, ("rms", "greatest"))
    cycle = cycle_of(motion, link, circuit, branch, order="position")
    refuse_idle_link(motion.linkage, cycle.link, "a path on it")
    if inputs is None:
        if measure != "rms":
            raise RequestError("measure: greatest needs the input of each place; give inputs, or measure rms")
        return _untimed(cycle, wanted, low, high, progress)
    progress(0, 1, "")
    return _timed(cycle, wanted, _inputs(inputs, len(wanted)), (low, high), measure)


def _places(curve: npt.ArrayLike) -> Floats:
    try:
        wanted = np.asarray(curve, dtype=np.float64)
    except (TypeError, ValueError):
        wanted = np.array([])
    if wanted.ndim != 2 or wanted.shape[1] != 3 or len(wanted) < 3:
        raise RequestError(
            f"curve: an array of shape {wanted.shape} is no curve; give three places (m, 3) or more"
        )
    bad = np.flatnonzero(~np.isfinite(wanted).all(axis=1))
    if bad.size:
        raise RequestError(f"curve[{bad[0]}]: {wanted[bad[0]].tolist()} is not a place; give finite numbers")
    return wanted


def _inputs(inputs: npt.ArrayLike, count: int) -> Floats:
    result = finite_array("inputs", inputs)
    if result.size != count:
        raise RequestError(
            f"inputs: {result.size} values where the curve has {count} places; give one for each"
        )
    return result


def _at(cycle: Cycle, inputs: Floats) -> LinkRates:
    """The rates at inputs (n,); `RequestError` naming the first without a pose."""
    if cycle.motion.law is not None:
        raise RequestError("law: inputs of places need constant speed; leave the law out")
    rates = cycle.at(inputs)
    lost = np.flatnonzero(np.isnan(rates.constant[0]).any(axis=1))
    if lost.size:
        where = input_text(cycle.motion, float(inputs[lost[0]]))
        raise RequestError(
            f"inputs[{lost[0]}]: circuit {cycle.circuit.index} has no pose at {where}; give others"
        )
    return rates


def _timed(
    cycle: Cycle,
    wanted: Floats,
    inputs: Floats,
    box: tuple[Floats, Floats],
    measure: Literal["rms", "greatest"],
) -> NearestPath:
    rates = _at(cycle, inputs)
    constant, gradient = rates.constant[0] - wanted, rates.gradient[0]
    if measure == "greatest":
        at, bound, _ = least_greatest(constant, gradient, *box)
    else:
        at, bound = least_squares_in(constant, gradient, *box)
    return NearestPath(cycle, measure, at, wanted, rates.of("position", at), inputs, bound, 1, 1)


def _untimed(cycle: Cycle, wanted: Floats, low: Floats, high: Floats, progress: Progress) -> NearestPath:
    """Nearest rows and least squares in turn from a grid of starts; the best ends followed between rows."""
    grid = np.stack(np.meshgrid(*np.linspace(low, high, STARTS).T, indexing="ij"), axis=-1).reshape(-1, 3)
    starts = np.unique(grid, axis=0)
    course = SearchCourse(len(starts) + min(FOLLOWED, len(starts)), progress)
    unit = cycle.motion.linkage.length_unit
    ends: list[tuple[float, Floats]] = []
    for start in starts:
        ends.append(_alternated(cycle, wanted, start, low, high))
        course.step(f"best: rms {min(rms for rms, _ in ends):.4g} {unit}")
    ends.sort(key=lambda end: end[0])
    followed = []
    for _, at in ends[:FOLLOWED]:
        followed.append(_followed(cycle, wanted, at, low, high))
        course.step(f"best: rms {min(rms for rms, *_ in followed):.4g} {unit}")
    _, at, inputs, path = min(followed, key=lambda end: end[0])
    side = float((high - low).max()) or 1.0
    agreeing = sum(float(np.abs(end - at).max()) < 1e-2 * side for _, end in ends)
    return NearestPath(cycle, "rms", at, wanted, path, inputs, None, len(starts), max(agreeing, 1))


def _alternated(cycle: Cycle, wanted: Floats, at: Floats, low: Floats, high: Floats) -> tuple[float, Floats]:
    """A root mean square over rows, and the point it ends at."""
    rows: Integers | None = None
    for _ in range(ROUNDS):
        nearest, distance = _nearest_rows(cycle.rates.of("position", at), wanted)
        if rows is not None and np.array_equal(nearest, rows):
            break
        rows = nearest
        at, _ = least_squares_in(
            cycle.rates.constant[0][rows] - wanted, cycle.rates.gradient[0][rows], low, high
        )
    return math.sqrt(float((distance**2).mean())), at


def _nearest_rows(path: Floats, wanted: Floats) -> tuple[Integers, Floats]:
    """The row of a path (n, 3) nearest to each place (m, 3), and its distance."""
    from scipy.spatial import cKDTree

    distance, rows = cKDTree(path).query(wanted)
    return np.asarray(rows, dtype=np.int64), np.asarray(distance)


def _followed(
    cycle: Cycle, wanted: Floats, at: Floats, low: Floats, high: Floats
) -> tuple[float, Floats, Floats, Floats]:
    """Value, point, inputs and path where the nearest places are sought between rows too; Gauss and Newton.

    What a move of the point changes along the path does not count, since the nearest place moves along.
    """
    from scipy.optimize import least_squares

    half = (high - low) / 2
    centre = (low + high) / 2

    def foot(y: Floats) -> tuple[Floats, LinkRates, Floats]:
        point = centre + half * y
        inputs = _foot(cycle, wanted, point)
        rates = cycle.at(inputs)
        return point, rates, inputs

    def residual(y: Floats) -> Floats:
        point, rates, _ = foot(y)
        return np.asarray((rates.of("position", point) - wanted).ravel())

    def jacobian(y: Floats) -> Floats:
        point, rates, _ = foot(y)
        along = rates.of("velocity", point)
        along /= np.maximum(np.linalg.norm(along, axis=-1), np.finfo(float).tiny)[:, None]
        across = np.eye(3) - np.nan_to_num(along[:, :, None] * along[:, None, :])
        return np.asarray((across @ rates.gradient[0] * half).reshape(-1, 3))

    start = np.clip((at - centre) / np.where(half > 0, half, 1.0), -1 + 1e-9, 1 - 1e-9)
    result = least_squares(residual, start, jacobian, bounds=(-1, 1), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    point, rates, inputs = foot(result.x)
    path = rates.of("position", point)
    return math.sqrt(float(((path - wanted) ** 2).sum(axis=1).mean())), point, inputs, path


def _foot(cycle: Cycle, wanted: Floats, at: Floats) -> Floats:
    """The inputs (m,) at which the path of a point is nearest to each place, between the rows too."""
    rows, _ = _nearest_rows(cycle.rates.of("position", at), wanted)
    started = inputs = cycle.rates.input[rows]
    if not cycle.closed:
        return started
    for _ in range(STEPS):
        rates = cycle.at(inputs)
        away = rates.of("position", at) - wanted
        velocity = rates.of("velocity", at) / cycle.motion.speed
        curve = rates.of("acceleration", at) / cycle.motion.speed**2
        slope = (away * velocity).sum(axis=1)
        # Gauss's part alone where the distance does not curve up
        bend = (velocity**2).sum(axis=1)
        whole = bend + (away * curve).sum(axis=1)
        bend = np.where(whole > 0, whole, bend)
        step = np.divide(-slope, bend, out=np.zeros_like(slope), where=bend > 0)
        inputs = np.clip(inputs + step, started - abs(cycle.step), started + abs(cycle.step))
    return inputs
