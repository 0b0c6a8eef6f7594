"""The conditions of an optimum at the unknowns of a task: heights, slacks, their slopes, and multipliers.

Karush's, Kuhn's and Tucker's,

    grad f = sum y grad c,    y >= 0,    c >= 0,    y c = 0                                              (1)

with c the slacks and the bounds, and f half the sum of squares, or for the greatest residual t itself with
slacks t - h of every height h.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task.problem import TaskProblem, TaskValues

#: A slack that is missed by less is kept.
ROUNDING = 1e-9

#: A slack so near to zero may be active.
ACTIVE = 1e-6

#: Residuals are measured against this at least [relative]: smaller ones are rounding of larger steps.
LEAST = 1e-4


@dataclass(frozen=True, eq=False)
class Conditions:
    """What (1) is made of at unknowns: gradient (m,), slacks (c,) and their slopes (c, m), and the unit.

    `curved` (m, m) are the second derivatives that slopes alone give, `cost` what is made least.
    """

    gradient: Floats
    curved: Floats | None
    cost: float
    slack: Floats
    slack_by: Floats
    unit: float


def heights(problem: TaskProblem, here: TaskValues) -> tuple[Floats, Floats]:
    """Weighted sizes (h,) of single residuals, and their slopes: distances of places, others both ways.

    For the greatest transmission angle how far the slack of its squared sine is below 1.
    """
    if problem.model.task.goal == "transmission":
        rows = slice(problem.looked_at)
        return 1.0 - here.slack[rows], -here.slack_by[rows]
    heights, slopes = [], []
    count = 0
    for one in problem.model.wanted:
        rows = slice(count, count + one.count)
        count += one.count
        residuals, by = (
            math.sqrt(one.count) * here.residuals[rows],
            math.sqrt(one.count) * here.residuals_by[rows],
        )
        height, height_by = one.heights(residuals, by)
        heights.append(height)
        slopes.append(height_by)
    heights += [here.residuals[count:], -here.residuals[count:]]
    slopes += [here.residuals_by[count:], -here.residuals_by[count:]]
    return np.concatenate(heights), np.concatenate(slopes)


def slacks_of(problem: TaskProblem, z: Floats, here: TaskValues) -> tuple[Floats, Floats]:
    """Slacks, then those to the bounds that there are, and their slopes."""
    one = np.eye(len(z))
    low, high = np.isfinite(problem.low), np.isfinite(problem.high)
    return (
        np.concatenate([here.slack, (z - problem.low)[low], (problem.high - z)[high]]),
        np.concatenate([here.slack_by, one[low], -one[high]]),
    )


def squares(here: TaskValues) -> float:
    """The sum of squares."""
    return float(here.residuals @ here.residuals)


def cost_of(problem: TaskProblem, z: Floats) -> float:
    """The sum of squares, or the greatest height."""
    here = problem.at(z)
    if here is None:
        return math.inf
    return (
        float(heights(problem, here)[0].max()) if problem.minimax else float(here.residuals @ here.residuals)
    )


def with_cost(problem: TaskProblem, z: Floats) -> Floats:
    """The unknowns x of (1): z, and for the greatest residual t behind them."""
    return np.append(z, cost_of(problem, z)) if problem.minimax else z


def unknowns(problem: TaskProblem, x: Floats) -> Floats:
    """The unknowns z of such x."""
    return x[:-1] if problem.minimax else x


def lack_of(here: TaskValues) -> float:
    """What slacks lack, none where it is rounding."""
    lack = -float(here.slack.min(initial=0.0))
    return lack if lack > ROUNDING else 0.0


def conditions(problem: TaskProblem, x: Floats, per: float = 1.0) -> Conditions | None:
    """At unknowns x; for the greatest residual heights, and t behind them, are relative to `per`."""
    z = unknowns(problem, x)
    here = problem.at(z)
    if here is None:
        return None
    slack, by = slacks_of(problem, z, here)
    if not problem.minimax:
        columns = np.linalg.norm(here.residuals_by, axis=0)
        # at the least of a single figure its slopes vanish, so they alone are no unit
        size = float(np.linalg.norm(here.residuals))
        unit = max(size, LEAST) * max(float(columns.max(initial=0.0)), size, 1e-300)
        curved, gradient = here.residuals_by.T @ here.residuals_by, here.residuals_by.T @ here.residuals
        return Conditions(gradient, curved, float(here.residuals @ here.residuals), slack, by, unit)
    height, slopes = (own / per for own in heights(problem, here))
    gradient = np.append(np.zeros(len(z)), 1.0)
    slack = np.concatenate([x[-1] - height, slack])
    by = np.block([[-slopes, np.ones((len(height), 1))], [by, np.zeros((len(by), 1))]])
    return Conditions(gradient, None, float(x[-1]), slack, by, max(float(np.abs(slopes).max()), 1.0))


def multipliers(at: Conditions) -> tuple[Integers, Floats, float]:
    """The active slacks, their multipliers >= 0, and by how much (1) is missed."""
    from scipy.optimize import nnls

    active = np.flatnonzero(at.slack <= ACTIVE)
    missed = max(float(-at.slack.min(initial=0.0)), 0.0)
    if not active.size:
        return active, np.empty(0), max(float(np.abs(at.gradient).max(initial=0.0)) / at.unit, missed)
    y, _ = nnls(at.slack_by[active].T, at.gradient, maxiter=50 * len(active))
    rest = np.abs(at.gradient - at.slack_by[active].T @ y).max(initial=0.0) / at.unit
    slack = float(np.abs(y * at.slack[active]).max(initial=0.0)) / at.unit
    return active, y, max(float(rest), missed, slack)
