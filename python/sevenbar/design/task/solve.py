"""The nearest optimum of a task: least squares or the least greatest residual, within bounds and slacks.

Least squares begin with slacks as penalties; then both goals end with Newton's method on the conditions of an
optimum (Karush, Kuhn and Tucker),

    grad f = sum y grad c,    y >= 0,    c >= 0,    y c = 0                                              (1)

with c the slacks and the bounds, and f half the sum of squares, or for the greatest residual t itself with
slacks t - h of every height h. What (1) is missed by shows how good a local optimum was found.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task import effort
from sevenbar.design.task.optimum import (
    ROUNDING,
    Conditions,
    conditions,
    cost_of,
    heights,
    lack_of,
    multipliers,
    slacks_of,
    unknowns,
    with_cost,
)
from sevenbar.design.task.problem import TaskModel, TaskProblem, TaskSeed
from sevenbar.design.task.programs import MinimaxValues, lowered
from sevenbar.design.task.quadratic import programmed
from sevenbar.kinematics.numbers.least_squares import nearest_least

#: Evaluations of a first look, of a design that is kept, and of one that comes near to what is wanted.
LOOK, WHOLE, LONG = 40, 400, 1200

#: How much the first steps are held back, relative to the unknowns' sizes; and where that failed.
FIRST = (1e-3, 1.0)

#: Weights of a missed slack, in rounds; and the slack kept since a penalty is never met.
WEIGHTS, KEPT = (1.0, 10.0, 100.0), 1e-5

#: Gain of a linear program, relative to the greatest height, that is worth another: nobody sees 0.01 deg of a
#: transmission angle.
WORTH = {"minimax": 1e-9, "transmission": 1e-4}

#: A slack that is missed by more after programs is not kept by smaller steps.
FAR_OFF = 1e-3

#: Evaluations of least squares where measures must hold.
NEAR_BY = 40

#: A slack that is to be kept exactly is missed by less: rounding.
KEPT_TO = 1e-14

#: Steps of Newton's method at the end, their most [units], and the step of its differences.
STEPS, FARTHEST, DIFFERENCE = 8, 0.1, 1e-5

#: Steps of Newton's method within a reach, its most unknowns, longest reach, shortest; the part of the
#: greatest curvature that is rounding; halvings of a step's multiplier.
DESCENTS, MOST_UNKNOWNS, MOST_REACH, SHORTEST, FLAT, HALVINGS = 12, 60, 0.5, 1e-9, 1e-13, 60

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
    slack: float
    ended: Ended = "optimum"
    #: Whether it misses a slack that no step leads to.
    hopeless: bool = False

    def poses_of(self, place: int) -> Floats:
        """The poses (n, columns) at the inputs of a want, by its place among those at poses."""
        first = sum(len(inputs) for inputs in self.inputs[:place])
        return self.seed.poses[first : first + len(self.inputs[place])]


def solved(
    model: TaskModel,
    seed: TaskSeed,
    evaluations: int = WHOLE,
    *,
    whole: bool = True,
    most: float = math.inf,
) -> Solved | None:
    """The nearest optimum of a seed; `None` where its linkage does not close.

    `whole`: to the last digit, unless least squares leave more than `most`, or a must is missed that no step
    leads to, or the start has taken all the motions that it may.
    """
    model.effort.begin(effort.WHOLE if whole else effort.LOOK)
    # where measures must hold the programs know better from the first step on
    alone = whole and model.task.goal == "minimax" and bool(model.figure_musts) and model.searched.measured
    result = _started(model, seed) if alone else _least_squares(model, seed, evaluations, FIRST[0])
    if whole and not alone and (result is None or (result.stuck and not _ended(result.problem, result.z))):
        # a first step too far may have led into a corner where the linkage hardly closes
        other = _least_squares(model, seed, evaluations, FIRST[1])
        if result is None or (other is not None and other.size < result.size):
            result = other
    if whole and not alone and result is not None and NOTHING < result.size <= EXACT:
        result = _least_squares(model, result.problem.seed(result.z), LONG, FIRST[0])
    if result is None:
        return None
    problem, z = result.problem, result.z
    if not whole or (result.size > most and not alone) or _hopeless(problem, z):
        return _as_solved(problem, z, math.nan)
    if model.task.goal != "least squares":
        problem = TaskProblem(model, problem.seed(z), minimax=True)
        z = _lowered(problem)
    elif not _ended(problem, z):
        problem, z = programmed(problem, z)
        if _misses(problem, z):
            return _as_solved(problem, z, math.nan)
        z = _descended(problem, z)
    z, missed = _settled(problem, z)
    if model.task.goal == "minimax" and missed > ENDED:
        problem, z = programmed(problem, z)
        z, missed = _settled(problem, z)
    if problem.minimax and _exactly(model):
        z = _kept(problem, z)
    return _as_solved(problem, z, missed)


def _misses(problem: TaskProblem, z: Floats) -> bool:
    """Whether a slack is missed by so much that only another start can keep it."""
    here = problem.at(z)
    return here is not None and bool(lack_of(here) > FAR_OFF)


def _hopeless(problem: TaskProblem, z: Floats) -> bool:
    """Whether such a slack is missed and has no slope: no step leads to it."""
    here = problem.at(z)
    if here is None:
        return False
    missed = here.slack < -FAR_OFF
    return bool((missed & (np.abs(here.slack_by).max(axis=1, initial=0.0) == 0.0)).any())


def _ended(problem: TaskProblem, z: Floats) -> bool:
    """Whether least squares are done: nothing is left, or (1) is met as nearly as slopes alone lead to."""
    if problem.size(z) <= EXACT:
        return True
    at = conditions(problem, z)
    return at is not None and multipliers(at)[2] < ENDED


def _as_solved(problem: TaskProblem, z: Floats, missed: float) -> Solved | None:
    here = problem.at(z)
    if here is None:
        return None
    hopeless = _hopeless(problem, z)
    cost = cost_of(problem, z) if problem.minimax else float(np.linalg.norm(here.residuals))
    slack = float(here.slack.min(initial=math.inf))
    ended: Ended = "optimum"
    if missed > SAID and cost > EXACT:
        ended = "edge" if _at_edge(problem, z) else "valley"
    return Solved(problem.seed(z), tuple(problem.inputs(z)), cost, missed, slack, ended, hopeless)


def _at_edge(problem: TaskProblem, z: Floats) -> bool:
    """Whether the linkage does not close, or the cost jumps, a small step down the slope that (1) leaves."""
    at = conditions(problem, with_cost(problem, z))
    if at is None:
        return False
    active, y, _ = multipliers(at)
    rest = (at.gradient - at.slack_by[active].T @ y)[: len(z)]
    step = BEYOND * rest / max(float(np.abs(rest).max(initial=0.0)), 1e-300)
    return cost_of(problem, problem.within(z - step)) > JUMP * cost_of(problem, z)


@dataclass(frozen=True, eq=False)
class _Squares:
    """A problem about its least squares, the unknowns there and their root; `stuck`: no step led on."""

    problem: TaskProblem
    z: Floats
    stuck: bool

    @property
    def size(self) -> float:
        return self.problem.size(self.z)


def _started(model: TaskModel, seed: TaskSeed) -> _Squares | None:
    """A problem at its seed as it is; `None` where the linkage does not close."""
    problem = TaskProblem(model, seed)
    z = problem.within(problem.start)
    return None if problem.at(z) is None else _Squares(problem, z, stuck=False)


def _least_squares(model: TaskModel, seed: TaskSeed, evaluations: int, first: float) -> _Squares | None:
    """Least squares with missed slacks as penalties."""
    problem = TaskProblem(model, seed)
    z = problem.within(problem.start)
    if problem.at(problem.start) is None:
        return None
    for weight in WEIGHTS:

        def residuals(z: Floats, weight: float = weight) -> Floats | None:
            here = problem.tried(z)
            if here is None:
                return None
            return np.concatenate([here.residuals, weight * np.minimum(here.slack - KEPT, 0.0)])

        def slopes(z: Floats, weight: float = weight) -> Floats | None:
            here = problem.at(z)
            if here is None:
                return None
            problem.take(z)
            missed = here.slack < KEPT
            return np.concatenate([here.residuals_by, weight * missed[:, None] * here.slack_by])

        most = min(evaluations, model.effort.left)
        if model.figure_musts:
            # penalties only lead near: a measure has kinks at which their steps become short
            most = min(most, NEAR_BY)
        nearest = nearest_least(
            residuals, slopes, z, problem.low, problem.high, evaluations=most, first=first
        )
        if nearest is None:
            return None
        z, stuck = nearest.z, nearest.end in ("stuck", "closed")
        here = problem.at(z)
        if here is not None and not (here.slack < KEPT).any():
            break
        if not model.effort.left or _hopeless(problem, z):
            break
    return _Squares(problem, z, stuck)


def _lowered(problem: TaskProblem) -> Floats:
    def valued(z: Floats) -> MinimaxValues | None:
        here = problem.at(z)
        return None if here is None else MinimaxValues(*heights(problem, here), *slacks_of(problem, z, here))

    start, worth = problem.within(problem.start), WORTH[problem.model.task.goal]
    if _exactly(problem.model):
        return lowered(valued, start, worth=worth, mended=lambda z: _kept(problem, z))
    return lowered(valued, start, worth=worth)


def _exactly(model: TaskModel) -> bool:
    """Whether anything wanted must be met exactly."""
    return any(must.most == 0.0 for _, must in model.most)


def _kept(problem: TaskProblem, z: Floats) -> Floats:
    """The unknowns near by that keep every slack, by Newton's shortest steps on those that are missed."""
    for _ in range(STEPS):
        here = problem.at(z)
        if here is None or not (here.slack < -KEPT_TO).any():
            break
        missed = here.slack < 0
        step = np.linalg.lstsq(here.slack_by[missed], here.slack[missed], rcond=None)[0]
        z = problem.within(z - step)
    return z


def _descended(problem: TaskProblem, z: Floats) -> Floats:
    """The unknowns after Newton's method within a reach, by which narrow valleys are gone down to their end.

    Steps solve `min g s + s H s / 2, |s| <= reach` over the unknowns that no bound stops; H by differences of
    the exact gradient. It ends at a slack: there the programs know better.
    """
    reach = FARTHEST
    at = conditions(problem, z)
    for _ in range(DESCENTS):
        if not problem.model.effort.left:
            break
        if at is None or reach < SHORTEST or not len(z) <= MOST_UNKNOWNS or multipliers(at)[2] < ENDED:
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
            then = conditions(problem, then_z)
            selected = then is not None and not (then.slack < np.minimum(at.slack, 0.0) - ROUNDING).any()
            if then is not None and selected and then.cost < at.cost:
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


def _settled(problem: TaskProblem, z: Floats) -> tuple[Floats, float]:
    """The unknowns after Newton's method on (1), where it makes them better; and what (1) is missed by."""
    x = with_cost(problem, z)
    problem.take(z)
    at = conditions(problem, x)
    if at is None:
        return z, math.inf
    active, y, missed = multipliers(at)
    for _ in range(STEPS):
        if missed < MET or not problem.model.effort.left:
            break
        rows = active[y > 0]
        curved = _curved(problem, x, at, rows, y[y > 0])
        if curved is None:
            break
        step = _newton(at, curved, rows)
        step *= min(1.0, FARTHEST / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        then_x = x + step
        then_x[: len(z)] = problem.within(then_x[: len(z)])
        then = conditions(problem, then_x)
        if then is None:
            break
        then_active, then_y, then_missed = multipliers(then)
        if not then_missed < missed:
            break
        x, at, active, y, missed = then_x, then, then_active, then_y, then_missed
        problem.take(unknowns(problem, x))
    return unknowns(problem, x), missed


def _newton(at: Conditions, curved: Floats, active: Integers) -> Floats:
    """The step of Newton's method with these slacks held at zero."""
    rows, count = at.slack_by[active], len(active)
    matrix = np.block([[curved, -rows.T], [rows, np.zeros((count, count))]])
    sides = np.concatenate([-at.gradient, -at.slack[active]])
    return np.asarray(np.linalg.lstsq(matrix, sides, rcond=1e-13)[0][: len(curved)])


def _curved(problem: TaskProblem, x: Floats, at: Conditions, active: Integers, y: Floats) -> Floats | None:
    """The second derivatives of f less those of the slacks by their multipliers."""

    def pull(point: Floats) -> Floats | None:
        there = conditions(problem, point)
        return None if there is None else there.gradient - there.slack_by[active].T @ y

    exact = at.curved is not None and at.cost <= EXACT**2 and not len(active)
    result = at.curved if exact else _differences(pull, x)
    return result if result is not None and np.isfinite(result).all() else None


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
    result = np.array(columns)
    return np.asarray((result + result.T) / 2)
