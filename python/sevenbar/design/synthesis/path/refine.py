"""A rough match made exact: least squares over dimensions and inputs at once, with exact derivatives.

The unknowns are what varies of the linkage and, without timing, the input at each wanted point: then at the
solution each point is the foot of its wanted point, as the derivative by its input is square to what is left.
Where the linkage may stand anywhere, each evaluation is placed by `path_match.placed`. What is left is then
square to every small rigid motion B of the points, so with the part of the derivatives along B taken off the
gradient of the sum of squares stays exact (variable projection).

Source: docs/theory_design.md, (29).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.limits import INPUT_TURNS, transmission_room, turning_room
from sevenbar.design.synthesis.path.search import Seed
from sevenbar.design.synthesis.path.task import PathTask
from sevenbar.design.task.match import STILL, Placing, placed

#: Evaluations of a first look, and of a design that is kept.
LOOK, WHOLE = 40, 400

#: Where least squares end: parts of the error's square, of the unknowns, of the gradient.
TOLERANCE = 1e-15

#: A step after which a passive joint stands further away [rad] has left its branch and is not taken.
LONGEST_STEP = 1.2

#: Limits weigh so much beside the path, relative to its extent, more in each of these rounds; and by how much
#: they are kept with room [sin^2 of an angle], since a penalty is never quite met.
WEIGHTS, ROOM = (1.0, 10.0, 100.0), 1e-4

#: Shares of the used range at which the transmission angle is held.
HELD_AT = np.linspace(0.0, 1.0, 25)

#: Columns of the path's derivatives that a small rigid motion leaves, below this part of the greatest.
FLAT = 1e-9


@dataclass(frozen=True, eq=False)
class Refined:
    """A solution: what varies (k,), inputs (n,), closed poses (n, columns), its placing, root mean square."""

    varied: Floats
    inputs: Floats
    poses: Floats
    placing: Placing
    rms: float


class PathProblem:
    """Residuals and derivatives of a task about poses that are followed; unknowns z = (what varies, inputs).

    With `phase` one unknown stands for all inputs, with timing alone none.
    """

    def __init__(self, task: PathTask, seed: Seed, weight: float = 0.0) -> None:
        self._task = task
        self._poses = seed.poses
        self._asked: tuple[Floats, Floats] | None = None
        self._weight = weight * task.extent
        self.count = len(task.varied)
        self.start = np.concatenate([seed.varied, self._free(seed)])
        scales = [_unit(task, d.kind) / d.scale for d in task.dimensions]
        slides = not task.draft.linkage.turns(task.closure.input)
        self.scales = np.array(
            scales + [task.closure.size if slides else 1.0] * (len(self.start) - self.count)
        )
        rest = np.full(len(self.start) - self.count, np.inf)
        self.bounds = (np.concatenate([task.low, -rest]), np.concatenate([task.high, rest]))

    def _free(self, seed: Seed) -> Floats:
        if self._task.timing is None:
            return seed.inputs
        return np.array([seed.phase]) if self._task.phase else np.empty(0)

    def split(self, z: Floats) -> tuple[Floats, Floats]:
        """The values of all dimensions, and the inputs (n,)."""
        task, own = self._task, z[self.count :]
        values = task.values(z[: self.count])
        if task.timing is None:
            return values, own
        return values, task.timing + (own[0] if task.phase else 0.0)

    def poses(self, z: Floats) -> Floats:
        """The closed poses (n, columns), followed from those last taken; NaN where that leads nowhere."""
        if self._asked is not None and np.array_equal(self._asked[0], z):
            return self._asked[1]
        values, inputs = self.split(z)
        closure = self._task.closure
        poses = closure.closed(values, inputs, self._poses)
        step = np.abs(poses - self._poses) / closure.units
        step[:, closure.input] = 0.0
        poses[(step > LONGEST_STEP).any(axis=1)] = np.nan
        self._asked = z.copy(), poses
        return poses

    def residuals(self, z: Floats) -> Floats:
        """What is left at the points (3 n,) [length], then of the limits (m,); infinite off the branch."""
        values, inputs = self.split(z)
        poses = self.poses(z)
        rest, _ = self._limits(z)
        if not np.isfinite(poses).all():
            return np.full(3 * len(inputs) + len(rest), np.inf)
        found = self._task.closure.position(values, poses)
        return np.concatenate([(self.placing(found).put(found) - self._task.wanted).ravel(), rest])

    def jacobian(self, z: Floats) -> Floats:
        """The derivatives of the residuals by the unknowns; asked for where a step was taken."""
        task = self._task
        values, inputs = self.split(z)
        poses = self.poses(z)
        self._poses = poses
        reached = task.closure.reached(values, poses)
        placing = self.placing(reached.position)
        turn = placing.rotation
        rows = len(inputs)
        by_inputs: Floats = np.einsum("ij,nj->ni", turn, reached.by_input)
        columns = [np.einsum("ij,njk->nik", turn, reached.by_dimension)]
        if task.timing is None:
            own = np.zeros((rows, 3, rows))
            own[np.arange(rows), :, np.arange(rows)] = by_inputs
            columns.append(own)
        elif task.phase:
            columns.append(by_inputs[:, :, None])
        jacobian = np.concatenate(columns, axis=2).reshape(3 * rows, -1)
        if task.place:
            moves = _rigid(placing.put(reached.position))
            jacobian -= moves @ (moves.T @ jacobian)
        return np.concatenate([jacobian, self._limits(z)[1]])

    def placing(self, found: Floats) -> Placing:
        """Where the linkage stands, its points at `found` (n, 3)."""
        return placed(self._task.wanted, found) if self._task.place else STILL

    def _limits(self, z: Floats) -> tuple[Floats, Floats]:
        """What limits of an RSSR are missed by (m,), weighted, and its derivatives (m, unknowns)."""
        task = self._task
        if task.draft.linkage.form != "rssr" or not self._weight:
            return np.empty(0), np.empty((0, len(z)))
        values, inputs = self.split(z)
        numbers = {d.place[1]: i for i, d in enumerate(task.closure.dimensions) if d.place[0] == "rssr"}
        row = values[[numbers[key] for key in ("M", "N", "L1", "L2", "L3", "D")]]
        missed, slopes = [], []
        if task.limits.transmission_lowest and task.closure.input == 0:
            first, last = inputs[0], inputs[-1]
            used = first + HELD_AT * (math.tau if task.closed else last - first)
            room, by_row, by_input = transmission_room(row, used, task.limits)
            by = np.zeros((len(room), len(z)))
            self._by_row(by, by_row, numbers)
            if task.timing is None:
                by[:, self.count] += by_input * (1.0 if task.closed else 1.0 - HELD_AT)
                by[:, -1] += 0.0 if task.closed else by_input * HELD_AT
            elif task.phase:
                by[:, -1] += by_input
            missed.append(room - ROOM)
            slopes.append(by)
        if task.limits.motion_type in INPUT_TURNS and task.closure.input == 0:
            room, by_row = turning_room(row)
            by = np.zeros((len(room), len(z)))
            self._by_row(by, by_row, numbers)
            missed.append(room - ROOM)
            slopes.append(by)
        if not missed:
            return np.empty(0), np.empty((0, len(z)))
        rest, by_all = np.concatenate(missed), np.concatenate(slopes)
        return self._weight * np.minimum(rest, 0.0), self._weight * by_all * (rest < 0)[:, None]

    def _by_row(self, by: Floats, by_row: Floats, numbers: dict[str | int, int]) -> None:
        """Adds derivatives by a row of dimensions to those by the unknowns."""
        for column, key in enumerate(("M", "N", "L1", "L2", "L3", "D")):
            if numbers[key] in self._task.varied:
                by[:, self._task.varied.index(numbers[key])] += by_row[:, column]


def _unit(task: PathTask, kind: str) -> float:
    """How large a change of a dimension is that matters as much as a radian."""
    return task.closure.size if kind in ("length", "pitch") else 1.0


def _rigid(places: Floats) -> Floats:
    """An orthonormal basis (3 n, 6 or fewer) of the small rigid motions of places (n, 3)."""
    own = places - places.mean(axis=0)
    moves = np.zeros((len(places), 3, 6))
    moves[:, :, :3] = np.eye(3) * float(np.abs(own).max())
    for axis, unit in enumerate(np.eye(3)):
        moves[:, :, 3 + axis] = np.cross(unit, own)
    left, sizes, _ = np.linalg.svd(moves.reshape(-1, 6), full_matrices=False)
    return np.asarray(left[:, sizes > FLAT * sizes[0]])


def refined(task: PathTask, seed: Seed, evaluations: int = WHOLE) -> Refined | None:
    """The nearest least sum of squares, bounds held; `None` where the seed's linkage does not close."""
    weights = WEIGHTS if task.limits.transmission_lowest or task.limits.motion_type in INPUT_TURNS else (0.0,)
    for weight in weights:
        problem = PathProblem(task, seed, weight)
        z = _solved(problem, evaluations)
        if z is None:
            return None
        poses = problem.poses(z)
        if not np.isfinite(poses).all():
            return None
        values, inputs = problem.split(z)
        phase = float(z[-1]) if task.phase else 0.0
        seed = Seed(z[: problem.count], inputs, poses, 0.0, phase)
    found = task.closure.position(values, poses)
    placing = problem.placing(found)
    left = placing.put(found) - task.wanted
    return Refined(seed.varied, inputs, poses, placing, float(np.sqrt((left**2).sum(axis=1).mean())))


def _solved(problem: PathProblem, evaluations: int) -> Floats | None:
    from scipy.optimize import least_squares

    low, high = problem.bounds
    # least squares want to begin inside
    inside = 1e-9 * np.where(np.isfinite(high - low), high - low, 0.0)
    start = np.clip(problem.start, low + inside, high - inside)
    if not np.isfinite(problem.residuals(start)).all():
        return None
    # its trust region divides by numbers that may be zero, and mends that itself
    with np.errstate(all="ignore"):
        solved = least_squares(
            problem.residuals,
            start,
            problem.jacobian,
            bounds=(low, high),
            x_scale=problem.scales,
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=None,
            max_nfev=evaluations,
        )
    return np.asarray(solved.x)
