"""The search for designs: many starts are tried, the promising ones solved, each of them checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.design.candidates import Refusal, least_error, likeness
from sevenbar.design.extra import need_scipy
from sevenbar.design.search import Designs, DesignSearch
from sevenbar.design.task.check import TIGHT, TaskDesign, checked_design, missed_between
from sevenbar.design.task.musts import MUSTS
from sevenbar.design.task.problem import TaskModel, TaskSeed
from sevenbar.design.task.solve import LOOK, Solved, solved
from sevenbar.design.task.starts import apart, seeds, seeds_at
from sevenbar.design.task.task import DesignTask, PoseMust
from sevenbar.design.task.wants import WANTS
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import MEASURES
from sevenbar.text.progress import Progress, silent

#: Starts by default.
STARTS = 256

#: Of the starts so many for each design wanted are tried closer, and of these so many solved at most.
TRIED, TAKEN = 8, 3

#: A look leads to a design that is kept where no dimension differs by more; and it is left where its least
#: squares are more than so many times those of the designs that are kept.
ONE, HOPELESS = 1e-3, 2.0

#: Starts in a row of a task with measures that lead to nothing new, after which the search ends.
IDLE = 8

#: Those that miss a slack by more are taken last; those whose costs, slacks and numbers differ by less are
#: one; seeds of one linkage whose errors differ by less are mirror images.
MISSED, ALIKE, SAME = -0.01, 1e-4, 1e-7

#: A cost below which a task is met exactly: no other start can be better.
EXACT = 1e-11


#: The kinds of faults, and what may be given up where one is the commonest.
EASE: Mapping[str, str] = {
    "assembly": "wider bounds, more starts, or another start",
    "circuit": "wider bounds, or more starts: the poses lie on two circuits",
    "dead centre": "another joint as the input, or wider bounds",
    "order": "more starts, or another order",
    "error": "a greater `most`, fewer exact points, or more free numbers",
    "transmission": "a smaller least transmission angle",
    "size": "a wider range of sizes",
    "motion type": "another motion type, or any",
    **{one.fault: one.ease for one in (*MUSTS, *WANTS) if one.fault},
    "figure": "other ends of the measure",
}

#: Those of musts about poses.
POSE_FAULTS = {one.fault for one in MUSTS if issubclass(one, PoseMust)}


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class DesignsFound(Designs[TaskDesign]):
    """The designs of a task, best first, and why others were refused.

    `starts` is the number of ways to begin that there were.
    """

    task: DesignTask
    starts: int
    #: Starts that ended since they had measured all the motions that one may.
    ended_early: int = 0

    def required(self, starts: int) -> None:
        """Raises `RequestError` where nothing was found of so many starts: what was nearest, what to ease."""
        if self.designs:
            return
        tried = f"{starts + 1} linkage{'s' * (starts > 0)}"
        if not self.starts:
            raise RequestError(
                f"design: none of {tried} within the bounds can begin: no pass of a circuit has what is "
                "wanted without a dead centre of the input; give wider bounds, more starts, or another joint "
                "as the input"
            )
        if not self.refusals:
            raise RequestError(
                f"design: {tried} gave {self.starts} ways to begin, and none could be followed; give "
                "wider bounds, or more starts"
            )
        faults = list(dict.fromkeys(refusal.fault for refusal in self.refusals))
        ease = "; or ".join(dict.fromkeys(EASE[fault] for fault in faults))
        raise RequestError(
            f"design: nothing does what is asked; of {tried} {len(self.refusals)} were solved, "
            f"refused: {self.refused}; the nearest: {self.refusals[0].detail}; give {ease}"
        )


def designed(
    task: DesignTask,
    *,
    count: int = 5,
    starts: int = STARTS,
    seed: int = 0,
    given: Sequence[npt.ArrayLike] = (),
    progress: Progress = silent,
) -> DesignsFound:
    """Up to `count` distinct designs of a task, the best first; none where nothing does what is asked.

    The linkage itself, `starts` others within the bounds from a `seed`, and those of free numbers `given`
    (k,) each are the starts. Each design is opened from its file and found by the ordinary analysis to do
    what it claims, on one circuit and without a dead centre between. `progress` is called with (done, total,
    the best so far). Ctrl+C ends the search with what it has; before the first design it raises.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> from sevenbar.description.draft import Draft
        >>> from sevenbar.design.task import DesignTask, FreeNumber, FunctionWant
        >>> rows = sb.rssr(M=700, N=700, L1=250, L3=550, D=0).motion(36).circuits[0]
        >>> want = FunctionWant(rows.input[2:12:3], rows.output[2:12:3])
        >>> start = Draft.of_linkage(sb.rssr(M=710, N=690, L1=255, L3=545, D=0, L2=990))
        >>> free = [FreeNumber("M", 500, 900), FreeNumber("N", 500, 900), FreeNumber("L1", 100, 400)]
        >>> task = DesignTask(start, tuple(free) + (FreeNumber("L2", 800, 1200),), (want,))
        >>> (best,) = designed(task, count=1, starts=0).designs
        >>> best.met[0].greatest < 1e-9
        True
    """
    need_scipy()
    model = TaskModel(task)
    total = starts + 1 + len(given) + (TRIED + TAKEN) * count
    search: DesignSearch[TaskDesign] = DesignSearch(total, progress, count=count, scale_free=False)
    started: list[TaskSeed] = []
    with search.until_stopped(search.checked):
        started = seeds(model, starts, seed, search.step, [np.asarray(v, dtype=float) for v in given])
        tried = _tried(model, started, search)
        _take_each(model, tried, search)
    return DesignsFound(
        **vars(search.result(task.draft.linkage.name)),
        task=task,
        starts=len(started),
        ended_early=model.effort.ended,
    )


def _tried(model: TaskModel, started: Sequence[TaskSeed], search: DesignSearch[TaskDesign]) -> list[Solved]:
    """A first look at each of the starts that are not alike, the best first; one met exactly is taken."""
    tried: list[Solved] = []

    def look(one: TaskSeed) -> tuple[float, TaskDesign | Refusal] | None:
        result = _first_look(model, one)
        if result is None:
            return None
        if result.cost < EXACT:
            exact.append(result.cost)
            return _taken(model, result, search)
        tried.append(result)
        return None

    def words(_: object) -> str:
        nearest = min((*exact, *(one.cost for one in tried)), default=math.inf)
        return f"nearest: {nearest:.3g}" if nearest < math.inf else ""

    exact: list[float] = []
    chosen = apart(model, _unlike_seeds(model, started), TRIED * search.count)
    search.over(chosen, look, words, enough=lambda: _worst(search) < EXACT)
    tried.sort(key=lambda one: (one.hopeless, one.slack < MISSED, one.cost))
    return _unlike(model, tried)


def _take_each(model: TaskModel, tried_first: Sequence[Solved], search: DesignSearch[TaskDesign]) -> None:
    """Solves them to their ends until enough designs differ, and no better is in sight."""
    count = idle = 0
    known = 0, math.inf

    def enough() -> bool:
        nonlocal count, idle, known
        best = min((cost for cost, _ in search.checked), default=math.inf)
        now = len(search.different), best
        new = now[0] > known[0] or best < (1 - SAME) * known[1]
        idle, known = (0, now) if new else (idle + 1, known)
        count += 1
        if idle > min(IDLE, TAKEN * search.count) and model.figures.names:
            return True
        many = count > TAKEN * search.count or best < EXACT
        return search.enough and many

    def words(designs: list[TaskDesign]) -> str:
        # the error of a single want in its unit, the cost of several
        if len(model.task.wants) > 1 and designs:
            return f"best: {min(one.cost for one in designs):.3g}"
        return least_error([one.candidate for one in designs])

    search.over(tried_first, lambda look: _taken(model, look, search), words, enough=enough)


def _unlike_seeds(model: TaskModel, started: Sequence[TaskSeed]) -> Sequence[TaskSeed]:
    """Of circuits of one linkage with the same measures, as those that are mirror images, the first.

    Forces and stops may tell mirror images apart, and poses do.
    """
    if model.wanted or not set(model.figures.names) <= set(MEASURES):
        return started
    selected: list[TaskSeed] = []
    for one in started:
        like = (np.array_equal(one.values, other.values) for other in selected)
        same = (
            alike and math.isclose(one.error, other.error, rel_tol=SAME)
            for alike, other in zip(like, selected, strict=True)
        )
        if not any(same):
            selected.append(one)
    return selected


def _unlike(model: TaskModel, tried: Sequence[Solved]) -> list[Solved]:
    """Without those that lead to the same: the same numbers, costs and slacks."""
    selected: list[Solved] = []
    for look in tried:
        ways = [look.cost, look.slack, *look.seed.values / model.loop.scales]
        known = ([one.cost, one.slack, *one.seed.values / model.loop.scales] for one in selected)
        if not any(np.allclose(ways, other, rtol=ALIKE, atol=ALIKE) for other in known):
            selected.append(look)
    return selected


def _worst(search: DesignSearch[TaskDesign]) -> float:
    """The cost of the last of as many designs as are wanted; infinite while there are fewer."""
    return search.different[search.count - 1].cost if search.enough else math.inf


def _taken(
    model: TaskModel, look: Solved, search: DesignSearch[TaskDesign]
) -> tuple[float, TaskDesign | Refusal] | None:
    """A first look solved to the end and checked, or why not; `None` for one that is known or hopeless."""
    own = likeness(model.loop.drawn(look.seed.values), scale_free=False)
    if any(np.abs(own - likeness(one.draft, scale_free=False)).max() < ONE for _, one in search.checked):
        return None
    most = HOPELESS * _worst(search)
    solution = solved(model, look.seed, most=most)
    if solution is None:
        return 0.0, Refusal("assembly", "the linkage is lost on the way to its optimum")
    if solution.cost > most:
        return None
    answer = _answer(model, solution, most)
    return (answer.cost if isinstance(answer, TaskDesign) else 0.0), answer


def _answer(model: TaskModel, solution: Solved, most: float) -> TaskDesign | Refusal:
    """What the check says of a solution; a must missed between the poses solved for is held tighter."""
    answer = checked_design(model, solution)
    missed = answer.room < -TIGHT if isinstance(answer, TaskDesign) else answer.fault in POSE_FAULTS
    margins = missed_between(model, solution) if missed else {}
    if not margins:
        return answer
    tighter = solved(TaskModel(model.task, margins), solution.seed, most=most)
    again = None if tighter is None else checked_design(model, tighter)
    return again if isinstance(again, TaskDesign) else answer


def _first_look(model: TaskModel, one: TaskSeed) -> Solved | None:
    """A first look at a start; free inputs are matched anew once, where they may have left their places."""
    look = solved(model, one, LOOK, whole=False)
    if look is None or look.cost < EXACT or not any(want.stations.free for want in model.wanted):
        return look
    again = min(seeds_at(model, look.seed.values), key=lambda seed: seed.error, default=None)
    other = None if again is None else solved(model, again, LOOK, whole=False)
    return look if other is None or other.cost > look.cost else other
