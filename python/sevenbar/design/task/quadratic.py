"""Sequential quadratic programs about a task: slacks are held, and the curvature of valleys is known.

They end where a missed slack is no longer missed by less and less, and where all that a start may measure is
measured.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.task.optimum import ROUNDING, Conditions, conditions, cost_of, lack_of, squares, unknowns
from sevenbar.design.task.problem import TaskProblem, TaskValues

#: Most steps of sequential quadratic programs; for the greatest residual, which begin near their end.
PROGRAMS, FEWER = 200, 80

#: Unknowns tried by programs, four times as many where they are quick, among which the greatest lack of slack
#: must fall to this part while there is one, and of measures the cost by this part.
STALLED, FALLS, GAINED = 12, 0.98, 1e-8


def programmed(start: TaskProblem, z: Floats) -> tuple[TaskProblem, Floats]:
    """The unknowns after sequential quadratic programs, which hold the slacks: better ones, or the same.

    Where fewer heights are equal to the greatest than there are unknowns, linear programs go from side to
    side of a valley; these know its curvature. Costs are relative to the first.
    """
    from scipy.optimize import minimize

    # the start stays at its poses, which may not be found again from others
    minimax = start.minimax
    problem = TaskProblem(start.model, start.seed(z), minimax=minimax)
    x = problem.within(problem.start)
    if minimax:
        x = np.append(x, 1.0)
    now, unit = start.at(z), cost_of(start, z)
    first = conditions(problem, x, unit)
    if now is None or first is None:
        return start, z
    last = first
    ends = list(zip(problem.low, problem.high, strict=True))
    # bounds are no slacks here; of squares the whole sum counts
    own = slice(len(first.slack) - int(np.isfinite(ends).sum()))
    times, per = (1.0, 1.0) if minimax else (2.0, unit)

    def at(x: Floats) -> Conditions:
        nonlocal last
        last = conditions(problem, x, unit) or last
        return last

    course = _Course(problem.within(problem.start), problem.model.measures, problem.model.searched.measured)

    def value(x: Floats) -> TaskValues | None:
        z = unknowns(problem, x)
        here = problem.at(z) if minimax else problem.valued(z)
        if here is not None and not minimax:
            course.add(z, lack_of(here), squares(here))
        if course.stalls or not problem.model.effort.left:
            raise _StopsError
        return here

    def cost(x: Floats) -> float:
        here = value(x)
        if here is None:
            return 1e3
        return float(x[-1]) if minimax else squares(here) / per

    def slack(x: Floats) -> Floats:
        z = unknowns(problem, x)
        here = None if minimax else problem.valued(z)
        return at(x).slack[own] if here is None else here.slack

    def slopes(x: Floats) -> Floats:
        problem.take(unknowns(problem, x))
        return times * at(x).gradient / per

    slacks: Any = {"type": "ineq", "fun": slack, "jac": lambda x: at(x).slack_by[own]}
    with np.errstate(all="ignore"), suppress(_StopsError):
        result = minimize(
            cost,
            x,
            jac=slopes,
            bounds=[*ends, (0.0, math.inf)] if minimax else ends,
            constraints=[slacks] if len(first.slack[own]) else [],
            method="SLSQP",
            options={"maxiter": FEWER if minimax else PROGRAMS, "ftol": 1e-14},
        )
        last_z = np.asarray(unknowns(problem, result.x))
        if minimax:
            course.z = last_z
        elif (there := problem.at(last_z)) is not None:
            course.add(last_z, lack_of(there), squares(there))
    end = course.z
    then = problem.at(end)
    better = then is not None and (lack_of(then), cost_of(problem, end)) < (lack_of(now), unit)
    return (problem, end) if better else (start, z)


class _StopsError(Exception):
    """The programs lead no further."""


@dataclass
class _Course:
    """The unknowns of least (lack of slack, cost) on the way of programs, and the least of each so far.

    `figures`: with measures, and `measured`, those whose motions are what takes time.
    """

    z: Floats
    figures: bool
    measured: bool
    best: tuple[float, float] = (math.inf, math.inf)
    known: list[tuple[float, float]] = field(default_factory=list)

    def add(self, z: Floats, lack: float, cost: float) -> None:
        """They were tried."""
        if (lack, cost) < self.best:
            self.z, self.best = z, (lack, cost)
        self.known.append(self.best)

    @property
    def stalls(self) -> bool:
        """Whether a slack is missed, and no longer by less and less; or measures leave nothing to gain."""
        stalled = STALLED if self.measured else 4 * STALLED
        if len(self.known) <= stalled:
            return False
        (lack, cost), (lack_before, cost_before) = self.known[-1], self.known[-1 - stalled]
        if lack > ROUNDING:
            return lack > FALLS * lack_before
        return self.figures and lack_before <= ROUNDING and cost > (1 - GAINED) * cost_before
