"""The nearest optimum of a task: least squares or the least greatest residual, within bounds and rooms.

Least squares begin with rooms as penalties; then both goals end with Newton's method on the conditions of an
optimum (Karush, Kuhn and Tucker),

    grad f = sum y grad c,    y >= 0,    c >= 0,    y c = 0                                              (1)

with c the rooms and the bounds, and f half the sum of squares, or for the greatest residual t itself with
rooms t - h of every height h. What (1) is missed by shows how good a local optimum was found.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task.problem import TaskModel, TaskProblem, TaskSeed, TaskValues
from sevenbar.design.task.programs import MinimaxValues, lowered
from sevenbar.kinematics.numbers.least_squares import nearest_least

#: Evaluations of a first look, of a design that is kept, and of one that comes near to what is wanted.
LOOK, WHOLE, LONG = 40, 400, 1200

#: How much the first steps are held back, relative to the unknowns' sizes; and where that failed.
FIRST = (1e-3, 1.0)

#: Weights of a missed room, in rounds; and the room kept since a penalty is never met.
WEIGHTS, KEPT = (1.0, 10.0, 100.0), 1e-5

#: A room that is missed by less is kept.
ROUNDING = 1e-9

#: Gain of a linear program, relative to the greatest height, that is worth another: nobody sees 0.01 deg of a
#: transmission angle.
WORTH = {"minimax": 1e-9, "transmission": 1e-4}

#: A room that is to be kept exactly is missed by less: rounding.
KEPT_TO = 1e-14

#: A room so near to zero may be active.
ACTIVE = 1e-6

#: Residuals are measured against this at least [relative]: smaller ones are rounding of larger steps.
LEAST = 1e-4

#: Steps of Newton's method at the end, their most [units], and the step of its differences.
STEPS, FARTHEST, DIFFERENCE = 8, 0.1, 1e-5

#: Steps of Newton's method within a reach, its most unknowns, longest reach, shortest; the part of the
#: greatest curvature that is rounding; halvings of a step's multiplier.
DESCENTS, MOST_UNKNOWNS, MOST_REACH, SHORTEST, FLAT, HALVINGS = 12, 60, 0.5, 1e-9, 1e-13, 60

#: Most steps of sequential quadratic programs; for the greatest residual, which begin near their end.
PROGRAMS, FEWER = 200, 80

#: Residuals below this leave the second derivatives of the squares to the slopes alone: what is wanted can be
#: met exactly, down to rounding.
EXACT, NOTHING = 1e-7, 1e-13

#: Below this of the conditions least squares have found an optimum, which Newton's method makes exact.
ENDED = 1e-7

#: Below this the conditions of an optimum are met; above the second what they are missed by has a reason.
MET, SAID = 1e-11, 1e-6

#: A step down the slope [units of the unknowns] after which a cost so many times as great is a jump.
BEYOND, JUMP = 1e-6, 2.0

#: How a search ended: at a local optimum; at an edge, where a step further the linkage does not close or a
#: measure jumps, so that slopes need not vanish; or in a valley, before an optimum.
Ended = Literal["optimum", "edge", "valley"]


@dataclass(frozen=True, eq=False)
class Solved:
    """A local optimum as a start of its own; the weighted cost, and by how much (1) is missed, relative.

    `cost` is the root of the weighted mean squares, or the greatest weighted residual.
    """

    seed: TaskSeed
    inputs: tuple[Floats, ...]
    cost: float
    optimality: float
    room: float
    ended: Ended = "optimum"

    def poses_of(self, place: int) -> Floats:
        """The poses (n, columns) at the inputs of a want, by its place among those at poses."""
        first = sum(len(inputs) for inputs in self.inputs[:place])
        return self.seed.poses[first : first + len(self.inputs[place])]


@dataclass(frozen=True, eq=False)
class Conditions:
    """What (1) is made of at unknowns: gradient (m,), rooms (c,) and their slopes (c, m), and the unit.

    `curved` (m, m) are the second derivatives that slopes alone give, `cost` what is made least.
    """

    gradient: Floats
    curved: Floats | None
    cost: float
    room: Floats
    room_by: Floats
    unit: float


def solved(
    model: TaskModel,
    seed: TaskSeed,
    evaluations: int = WHOLE,
    *,
    whole: bool = True,
    most: float = math.inf,
) -> Solved | None:
    """The nearest optimum of a seed; `None` where its linkage does not close.

    `whole`: to the last digit, unless least squares leave more than `most`.
    """
    found = _least_squares(model, seed, evaluations, FIRST[0])
    if whole and (found is None or (found.stuck and not _ended(found.problem, found.z))):
        # a first step too far may have led into a corner where the linkage hardly closes
        other = _least_squares(model, seed, evaluations, FIRST[1])
        if found is None or (other is not None and other.size < found.size):
            found = other
    if whole and found is not None and NOTHING < found.size <= EXACT:
        found = _least_squares(model, found.problem.seed(found.z), LONG, FIRST[0])
    if found is None:
        return None
    problem, z = found.problem, found.z
    if not whole or found.size > most:
        return _as_solved(problem, z, math.nan)
    if model.task.goal != "least squares":
        problem = TaskProblem(model, problem.seed(z), minimax=True)
        z = _lowered(problem)
    elif not _ended(problem, z):
        problem, z = _programmed(problem, z)
        z = _descended(problem, z)
    z, missed = _settled(problem, z)
    if model.task.goal == "minimax" and missed > ENDED:
        problem, z = _programmed(problem, z)
        z, missed = _settled(problem, z)
    if problem.minimax and _exactly(model):
        z = _kept(problem, z)
    return _as_solved(problem, z, missed)


def _ended(problem: TaskProblem, z: Floats) -> bool:
    """Whether least squares are done: nothing is left, or (1) is met as nearly as slopes alone lead to."""
    if problem.size(z) <= EXACT:
        return True
    at = _conditions(problem, z)
    return at is not None and _multipliers(at)[2] < ENDED


def _as_solved(problem: TaskProblem, z: Floats, missed: float) -> Solved | None:
    here = problem.at(z)
    if here is None:
        return None
    cost = _cost(problem, z) if problem.minimax else float(np.linalg.norm(here.left))
    room = float(here.room.min(initial=math.inf))
    ended: Ended = "optimum"
    if missed > SAID and cost > EXACT:
        ended = "edge" if _at_edge(problem, z) else "valley"
    return Solved(problem.seed(z), tuple(problem.inputs(z)), cost, missed, room, ended)


def _at_edge(problem: TaskProblem, z: Floats) -> bool:
    """Whether the linkage does not close, or the cost jumps, a small step down the slope that (1) leaves."""
    at = _conditions(problem, _with_cost(problem, z))
    if at is None:
        return False
    active, y, _ = _multipliers(at)
    rest = (at.gradient - at.room_by[active].T @ y)[: len(z)]
    step = BEYOND * rest / max(float(np.abs(rest).max(initial=0.0)), 1e-300)
    return _cost(problem, problem.within(z - step)) > JUMP * _cost(problem, z)


@dataclass(frozen=True, eq=False)
class _Squares:
    """A problem about its least squares, the unknowns there and their root; `stuck`: no step led on."""

    problem: TaskProblem
    z: Floats
    stuck: bool

    @property
    def size(self) -> float:
        return self.problem.size(self.z)


def _least_squares(model: TaskModel, seed: TaskSeed, evaluations: int, first: float) -> _Squares | None:
    """Least squares with missed rooms as penalties."""
    problem = TaskProblem(model, seed)
    z = problem.within(problem.start)
    if problem.at(problem.start) is None:
        return None
    for weight in WEIGHTS:

        def residuals(z: Floats, weight: float = weight) -> Floats | None:
            here = problem.tried(z)
            if here is None:
                return None
            return np.concatenate([here.left, weight * np.minimum(here.room - KEPT, 0.0)])

        def slopes(z: Floats, weight: float = weight) -> Floats | None:
            here = problem.at(z)
            if here is None:
                return None
            problem.take(z)
            missed = here.room < KEPT
            return np.concatenate([here.left_by, weight * missed[:, None] * here.room_by])

        nearest = nearest_least(
            residuals, slopes, z, problem.low, problem.high, evaluations=evaluations, first=first
        )
        if nearest is None:
            return None
        z, stuck = nearest.z, nearest.end in ("stuck", "closed")
        here = problem.at(z)
        if here is not None and not (here.room < KEPT).any():
            break
    return _Squares(problem, z, stuck)


# ---- the greatest residual


def _heights(problem: TaskProblem, here: TaskValues) -> tuple[Floats, Floats]:
    """Weighted sizes (h,) of single residuals, and their slopes: distances of places, others both ways.

    For the greatest transmission angle how far the room of its squared sine is below 1.
    """
    if problem.model.task.goal == "transmission":
        rows = slice(problem.looked_at)
        return 1.0 - here.room[rows], -here.room_by[rows]
    heights, slopes = [], []
    count = 0
    for one in problem.model.wanted:
        rows = slice(count, count + one.count)
        count += one.count
        left, by = math.sqrt(one.count) * here.left[rows], math.sqrt(one.count) * here.left_by[rows]
        height, height_by = one.heights(left, by)
        heights.append(height)
        slopes.append(height_by)
    heights += [here.left[count:], -here.left[count:]]
    slopes += [here.left_by[count:], -here.left_by[count:]]
    return np.concatenate(heights), np.concatenate(slopes)


def _rooms(problem: TaskProblem, z: Floats, here: TaskValues) -> tuple[Floats, Floats]:
    """Rooms, then those to the bounds that there are, and their slopes."""
    one = np.eye(len(z))
    low, high = np.isfinite(problem.low), np.isfinite(problem.high)
    return (
        np.concatenate([here.room, (z - problem.low)[low], (problem.high - z)[high]]),
        np.concatenate([here.room_by, one[low], -one[high]]),
    )


def _lowered(problem: TaskProblem) -> Floats:
    def heights(z: Floats) -> MinimaxValues | None:
        here = problem.at(z)
        return None if here is None else MinimaxValues(*_heights(problem, here), *_rooms(problem, z, here))

    start, worth = problem.within(problem.start), WORTH[problem.model.task.goal]
    if _exactly(problem.model):
        return lowered(heights, start, worth=worth, mended=lambda z: _kept(problem, z))
    return lowered(heights, start, worth=worth)


def _exactly(model: TaskModel) -> bool:
    """Whether anything wanted must be met exactly."""
    return any(must.most == 0.0 for _, must in model.most)


def _kept(problem: TaskProblem, z: Floats) -> Floats:
    """The unknowns near by that keep every room, by Newton's shortest steps on those that are missed."""
    for _ in range(STEPS):
        here = problem.at(z)
        if here is None or not (here.room < -KEPT_TO).any():
            break
        missed = here.room < 0
        step = np.linalg.lstsq(here.room_by[missed], here.room[missed], rcond=None)[0]
        z = problem.within(z - step)
    return z


def _programmed(begun: TaskProblem, z: Floats) -> tuple[TaskProblem, Floats]:
    """The unknowns after sequential quadratic programs, which hold the rooms: better ones, or the same.

    Where fewer heights are equal to the greatest than there are unknowns, linear programs go from side to
    side of a valley; these know its curvature. Costs are relative to the first.
    """
    from scipy.optimize import minimize

    # what was begun stays at its poses, which may not be found again from others
    minimax = begun.minimax
    problem = TaskProblem(begun.model, begun.seed(z), minimax=minimax)
    x = problem.within(problem.start)
    if minimax:
        x = np.append(x, 1.0)
    now, unit = begun.at(z), _cost(begun, z)
    first = _conditions(problem, x, unit)
    if now is None or first is None:
        return begun, z
    last = first
    ends = list(zip(problem.low, problem.high, strict=True))
    # bounds are no rooms here; of squares the whole sum counts
    own = slice(len(first.room) - int(np.isfinite(ends).sum()))
    times, per = (1.0, 1.0) if minimax else (2.0, unit)

    def at(x: Floats) -> Conditions:
        nonlocal last
        last = _conditions(problem, x, unit) or last
        return last

    def cost(x: Floats) -> float:
        here = _conditions(problem, x, unit)
        return 1e3 if here is None else here.cost / per

    def slopes(x: Floats) -> Floats:
        problem.take(_unknowns(problem, x))
        return times * at(x).gradient / per

    rooms: Any = {"type": "ineq", "fun": lambda x: at(x).room[own], "jac": lambda x: at(x).room_by[own]}
    with np.errstate(all="ignore"):
        found = minimize(
            cost,
            x,
            jac=slopes,
            bounds=[*ends, (0.0, math.inf)] if minimax else ends,
            constraints=[rooms] if len(first.room[own]) else [],
            method="SLSQP",
            options={"maxiter": FEWER if minimax else PROGRAMS, "ftol": 1e-14},
        )
    end = np.asarray(_unknowns(problem, found.x))
    then = problem.at(end)
    better = then is not None and (_lack(then), _cost(problem, end)) < (_lack(now), unit)
    return (problem, end) if better else (begun, z)


def _cost(problem: TaskProblem, z: Floats) -> float:
    """The sum of squares, or the greatest height."""
    here = problem.at(z)
    if here is None:
        return math.inf
    return float(_heights(problem, here)[0].max()) if problem.minimax else float(here.left @ here.left)


def _with_cost(problem: TaskProblem, z: Floats) -> Floats:
    """The unknowns x of (1): z, and for the greatest residual t behind them."""
    return np.append(z, _cost(problem, z)) if problem.minimax else z


def _unknowns(problem: TaskProblem, x: Floats) -> Floats:
    """The unknowns z of such x."""
    return x[:-1] if problem.minimax else x


def _descended(problem: TaskProblem, z: Floats) -> Floats:
    """The unknowns after Newton's method within a reach, by which narrow valleys are gone down to their end.

    Steps solve `min g s + s H s / 2, |s| <= reach` over the unknowns that no bound stops; H by differences of
    the exact gradient. It ends at a room: there the programs know better.
    """
    reach = FARTHEST
    at = _conditions(problem, z)
    for _ in range(DESCENTS):
        if at is None or reach < SHORTEST or not len(z) <= MOST_UNKNOWNS or _multipliers(at)[2] < ENDED:
            break
        low, high = z <= problem.low + ROUNDING, z >= problem.high - ROUNDING
        free = ~((low & (at.gradient > 0)) | (high & (at.gradient < 0)))
        curved = _curved(problem, z, at, np.empty(0, dtype=np.int64), np.empty(0))
        if curved is None or not free.any():
            break
        while reach >= SHORTEST:
            step = np.zeros(len(z))
            while free.any():
                step = np.zeros(len(z))
                step[free] = _within(at.gradient[free], curved[np.ix_(free, free)], reach)
                stopped = free & ((low & (step < 0)) | (high & (step > 0)))
                if not stopped.any():
                    break
                free &= ~stopped
            then_z = problem.within(z + step)
            then = _conditions(problem, then_z)
            kept = then is not None and not (then.room < np.minimum(at.room, 0.0) - ROUNDING).any()
            if then is not None and kept and then.cost < at.cost:
                z, at, reach = then_z, then, min(4 * reach, MOST_REACH)
                problem.take(z)
                break
            reach = min(reach, float(np.abs(step).max())) / 4
    return z


def _within(gradient: Floats, curved: Floats, reach: float) -> Floats:
    """The step (m,) of least `g s + s H s / 2` no longer than the reach."""
    bends, ways = np.linalg.eigh(curved)
    pull = ways.T @ gradient
    floor = FLAT * max(float(np.abs(bends).max()), 1e-300)
    low = max(0.0, -float(bends[0])) + floor
    if np.linalg.norm(pull / (bends + low)) <= reach:
        return np.asarray(-ways @ (pull / (bends + low)))
    high = low + float(np.linalg.norm(gradient)) / reach
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        longer = np.linalg.norm(pull / (bends + middle)) > reach
        low, high = (middle, high) if longer else (low, middle)
    return np.asarray(-ways @ (pull / (bends + high)))


def _lack(here: TaskValues) -> float:
    """What rooms lack, none where it is rounding."""
    lack = -float(here.room.min(initial=0.0))
    return lack if lack > ROUNDING else 0.0


# ---- the conditions of an optimum


def _conditions(problem: TaskProblem, x: Floats, per: float = 1.0) -> Conditions | None:
    """At unknowns x; for the greatest residual heights, and t behind them, are relative to `per`."""
    z = _unknowns(problem, x)
    here = problem.at(z)
    if here is None:
        return None
    room, by = _rooms(problem, z, here)
    if not problem.minimax:
        columns = np.linalg.norm(here.left_by, axis=0)
        # at the least of a single figure its slopes vanish, so they alone are no unit
        size = float(np.linalg.norm(here.left))
        unit = max(size, LEAST) * max(float(columns.max(initial=0.0)), size, 1e-300)
        curved, gradient = here.left_by.T @ here.left_by, here.left_by.T @ here.left
        return Conditions(gradient, curved, float(here.left @ here.left), room, by, unit)
    height, slopes = (own / per for own in _heights(problem, here))
    gradient = np.append(np.zeros(len(z)), 1.0)
    room = np.concatenate([x[-1] - height, room])
    by = np.block([[-slopes, np.ones((len(height), 1))], [by, np.zeros((len(by), 1))]])
    return Conditions(gradient, None, float(x[-1]), room, by, max(float(np.abs(slopes).max()), 1.0))


def _multipliers(at: Conditions) -> tuple[Integers, Floats, float]:
    """The active rooms, their multipliers >= 0, and by how much (1) is missed."""
    from scipy.optimize import nnls

    active = np.flatnonzero(at.room <= ACTIVE)
    missed = max(float(-at.room.min(initial=0.0)), 0.0)
    if not active.size:
        return active, np.empty(0), max(float(np.abs(at.gradient).max(initial=0.0)) / at.unit, missed)
    y, _ = nnls(at.room_by[active].T, at.gradient, maxiter=50 * len(active))
    rest = np.abs(at.gradient - at.room_by[active].T @ y).max(initial=0.0) / at.unit
    slack = float(np.abs(y * at.room[active]).max(initial=0.0)) / at.unit
    return active, y, max(float(rest), missed, slack)


def _settled(problem: TaskProblem, z: Floats) -> tuple[Floats, float]:
    """The unknowns after Newton's method on (1), where it makes them better; and what (1) is missed by."""
    x = _with_cost(problem, z)
    problem.take(z)
    at = _conditions(problem, x)
    if at is None:
        return z, math.inf
    active, y, missed = _multipliers(at)
    for _ in range(STEPS):
        if missed < MET:
            break
        rows = active[y > 0]
        curved = _curved(problem, x, at, rows, y[y > 0])
        if curved is None:
            break
        step = _newton(at, curved, rows)
        step *= min(1.0, FARTHEST / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        then = _conditions(problem, x + step)
        if then is None:
            break
        then_active, then_y, then_missed = _multipliers(then)
        if not then_missed < missed:
            break
        x, at, active, y, missed = x + step, then, then_active, then_y, then_missed
        problem.take(_unknowns(problem, x))
    return _unknowns(problem, x), missed


def _newton(at: Conditions, curved: Floats, active: Integers) -> Floats:
    """The step of Newton's method with these rooms held at zero."""
    rows, count = at.room_by[active], len(active)
    matrix = np.block([[curved, -rows.T], [rows, np.zeros((count, count))]])
    sides = np.concatenate([-at.gradient, -at.room[active]])
    return np.asarray(np.linalg.lstsq(matrix, sides, rcond=1e-13)[0][: len(curved)])


def _curved(problem: TaskProblem, x: Floats, at: Conditions, active: Integers, y: Floats) -> Floats | None:
    """The second derivatives of f less those of the rooms by their multipliers."""

    def pull(point: Floats) -> Floats | None:
        there = _conditions(problem, point)
        return None if there is None else there.gradient - there.room_by[active].T @ y

    exact = at.curved is not None and at.cost <= EXACT**2 and not len(active)
    found = at.curved if exact else _differences(pull, x)
    return found if found is not None and np.isfinite(found).all() else None


def _differences(pull: Callable[[Floats], Floats | None], x: Floats) -> Floats | None:
    """The symmetric slopes (m, m) of a gradient, by central differences."""
    columns = []
    for k in range(len(x)):
        step = np.zeros(len(x))
        step[k] = DIFFERENCE
        up, down = pull(x + step), pull(x - step)
        if up is None or down is None:
            return None
        columns.append((up - down) / (2 * DIFFERENCE))
    found = np.array(columns)
    return np.asarray((found + found.T) / 2)
