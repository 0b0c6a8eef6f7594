"""Trade-offs of two wants: the designs of which none is better in both, found by bounding one want.

With f the greatest error of a want, or the distance of a measure from its value, each point of the front
solves

    least f1    with f2 <= e                                                                          (1)

or the same with f1 and f2 exchanged (the epsilon constraint). At the ends e is the best value of f2 alone.
From there the widest gap between neighbours is halved, both values relative to their extent; the want that
differs more there is bounded. Each search begins at the neighbouring designs found so far.

Source: Y. Haimes, L. Lasdon and D. Wismer, "On a bicriterion formulation of the problems of integrated system
identification and system optimization", IEEE Trans. Systems, Man, and Cybernetics 1 (1971), 296-297.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.candidates import renamed
from sevenbar.design.course import SearchCourse
from sevenbar.design.task.check import TaskDesign
from sevenbar.design.task.contradictions import refuse_contradictions
from sevenbar.design.task.musts import measure_within, residuals_within
from sevenbar.design.task.search import EXACT, STARTS, DesignsFound, designed
from sevenbar.design.task.task import DesignTask, MeasureWant, Must, SampledWant
from sevenbar.errors import RequestError, shown
from sevenbar.text.progress import Progress, silent

#: Points of a front, by default and at most.
POINTS, MOST_POINTS = 9, 50

#: The weight of the want that is bounded and not improved: below what counts as met exactly.
BESIDES = 1e-12

#: Two points closer than this share of the front's extent are the same, and count as equally good.
SAME = 1e-4

#: What a want at its best may lose while the other is improved, and what counts as equally good whatever the
#: front's extent [relative, and of its unit]: beyond rounding.
LOST = 1e-9

#: A gap narrower than this share of the front's extent is not halved.
NARROW = 0.01


@dataclass(frozen=True, eq=False)
class ParetoPoint:
    """A design of a front and its two values: errors [rad, or length], measures as they are read."""

    values: tuple[float, float]
    design: TaskDesign


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """The points of a front by rising first value; `wants` are the places of the two wants among the task's.

    `solved` bounds were tried, `missing` of them without a design; `unfinished` says that the search was
    stopped.
    """

    task: DesignTask
    wants: tuple[int, int]
    points: tuple[ParetoPoint, ...]
    solved: int
    missing: int
    unfinished: str = ""

    @property
    def found(self) -> DesignsFound:
        """The designs as those of a search."""
        title = self.task.draft.linkage.name
        designs = renamed([point.design for point in self.points], title, "front")
        return DesignsFound(tuple(designs), (), self.unfinished, task=self.task, starts=self.solved)

    @property
    def values(self) -> Floats:
        """The two values of each point (n, 2)."""
        return np.array([point.values for point in self.points]).reshape(-1, 2)


def pareto(
    task: DesignTask,
    first: int | str,
    second: int | str,
    *,
    points: int = POINTS,
    starts: int = STARTS,
    seed: int = 0,
    progress: Progress = silent,
) -> ParetoFront:
    """The front of two wants of a task, each by its place, counted from 1, or by the name of its measure.

    Errors count by the greatest, whatever the task's goal. `starts` linkages are tried for each end of the
    front; between them each search begins at its neighbours. Raises `RequestError` for wants that there are
    not, and where an end has no design. Ctrl+C ends it with what it has.
    """
    refuse_contradictions(task)
    one, other = (_place(task, key, name) for key, name in (("first", first), ("second", second)))
    pair = one, other
    if one == other:
        raise RequestError(f"pareto: want {one + 1} is named twice; give two wants")
    if not 3 <= points <= MOST_POINTS:
        raise RequestError(f"points: {points} points make no front; give 3 to {MOST_POINTS}")
    course = SearchCourse(points + 2, progress)
    kept: list[ParetoPoint] = []
    bounds: list[tuple[int, float]] = []
    missing = 0

    def search(improved: int, musts: Sequence[Must], given: Sequence[ParetoPoint], tries: int) -> int:
        """Designs in which one of the wants is improved."""
        wants = tuple(
            want.weighted(BESIDES) if i in pair and i != improved else want
            for i, want in enumerate(task.wants)
        )
        own = replace(task, wants=wants, musts=(*task.musts, *musts), goal="minimax")
        started = [point.design.values for point in given]
        result = designed(own, count=1, starts=tries, seed=seed, given=started)
        for design in result.designs:
            kept.append(ParetoPoint((_value(task, one, design), _value(task, other, design)), design))
        course.step(f"{len(kept)} points")
        return len(result.designs)

    with course.until_stopped(kept, 2):
        for improved, second in ((one, other), (other, one)):
            if not search(improved, (), kept, starts):
                raise RequestError(
                    f"pareto: no design is found for want {improved + 1} alone; solve the task first, "
                    "and ease what must hold"
                )
            # among equals the best of the other
            best = min(kept, key=lambda point: point.values[pair.index(improved)])
            value = best.values[pair.index(improved)]
            bound = value + LOST * max(abs(value), 1.0)
            search(second, [_must(task, improved, bound)], [best], starts if best.design.cost < EXACT else 0)
        while len(bounds) < points - 2 and (gap := _widest_gap(kept, bounds)) is not None:
            bounds.append(gap)
            axis, bound = gap
            near = sorted(kept, key=lambda point: abs(point.values[axis] - bound))
            missing += not search(pair[1 - axis], [_must(task, pair[axis], bound)], near[:3], 0)
    front = _front(task, pair, kept)
    return ParetoFront(task, pair, front, len(bounds) + 2, missing, course.unfinished)


def _place(task: DesignTask, key: str, given: int | str) -> int:
    """The place of a want among the task's, counted from 0."""
    names = [want.name if isinstance(want, MeasureWant) else "" for want in task.wants]
    count = len(task.wants)
    if isinstance(given, str) and given in names:
        return names.index(given)
    number = int(given) if isinstance(given, int) or given.strip().isdecimal() else 0
    if not 1 <= number <= count:
        if count == 1:
            raise RequestError("pareto: this task has one want; a trade-off needs two")
        named = "".join(f", or {name}" for name in names if name)
        raise RequestError(f"{key}: {shown(given)} is no want of the task; give 1 to {count}{named}")
    return number - 1


def _must(task: DesignTask, place: int, bound: float) -> Must:
    """That a want's value is at most so great."""
    want = task.wants[place]
    if isinstance(want, MeasureWant):
        return measure_within(want.name, *want.ends(bound))
    assert isinstance(want, SampledWant)
    return residuals_within(place, bound / want.residual_unit(task.draft.linkage))


def _value(task: DesignTask, place: int, design: TaskDesign) -> float:
    """What a design makes of a want, the less the better: its greatest error, or its measure."""
    want = task.wants[place]
    if isinstance(want, MeasureWant):
        return want.loss(float(design.figures[want.name]))
    return design.met[[i for i, _ in task.sampled].index(place)].greatest


def _widest_gap(kept: Sequence[ParetoPoint], bounds: Sequence[tuple[int, float]]) -> tuple[int, float] | None:
    """Which value is bounded next, 0 or 1, and by what; `None` where no gap is wide.

    A bound tried within a gap led to no point of it: what lies below the bound is empty.
    """
    values = np.array([point.values for point in _unbeaten(kept)])
    extent = np.ptp(values, axis=0)
    widest, best = NARROW, None
    for ends in pairwise(values) if (extent > 0).all() else ():
        for axis in (0, 1):
            low, high = sorted(float(end[axis]) for end in ends)
            low = max([low, *(bound for tried, bound in bounds if tried == axis and low < bound < high)])
            width = (high - low) / extent[axis]
            if width > widest:
                widest, best = width, (axis, (low + high) / 2)
    return best


def _unbeaten(kept: Sequence[ParetoPoint]) -> list[ParetoPoint]:
    """The points of which none is better in both, each once, by rising first value."""
    ordered = sorted(kept, key=lambda point: point.values)
    every = np.array([point.values for point in ordered]).reshape(-1, 2)
    slack = np.zeros(2)
    if len(every):
        slack = np.maximum(SAME * np.ptp(every, axis=0), LOST * np.maximum(np.abs(every).max(axis=0), 1.0))
    best = math.inf
    front: list[ParetoPoint] = []
    for point in ordered:
        if point.values[1] < best - slack[1]:
            if front and point.values[0] - front[-1].values[0] <= slack[0]:
                front.pop()
            front.append(point)
            best = point.values[1]
    return front


def _front(task: DesignTask, pair: tuple[int, int], kept: Sequence[ParetoPoint]) -> tuple[ParetoPoint, ...]:
    """The points of the front, values as they are read.

    Of a measure that shall be great the value is its negative before, and the measure itself in the answer.
    """
    wants = [task.wants[place] for place in pair]
    signs = [-1.0 if isinstance(want, MeasureWant) and want.value == "great" else 1.0 for want in wants]
    return tuple(
        replace(point, values=(signs[0] * point.values[0], signs[1] * point.values[1]))
        for point in _unbeaten(kept)
    )
