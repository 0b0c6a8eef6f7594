"""Surveys of any loop: linkages drawn within the bounds of a design task, each judged by its wants and musts.

Each is followed round all its circuits. Where a pass has what is wanted, what is left of it and what must
hold are measured at the poses that are used, those between too. With the best hundred the search of
`designed` begins, so a linkage may be among them that is near and lacks something.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from functools import reduce
from operator import add
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.candidates import size_fault
from sevenbar.design.survey.drawn import FORMAT, Drawn
from sevenbar.design.survey.tally import Kept, SurveyTally
from sevenbar.design.task.problem import TaskModel, TaskProblem
from sevenbar.design.task.search import EASE, DesignsFound, designed
from sevenbar.design.task.starts import seeds_at
from sevenbar.design.task.task import DesignTask
from sevenbar.sweep.sampling import MOST_SOBOL, sobol_points
from sevenbar.text.progress import Progress, silent

#: What may be said of a linkage; the first is that it does what is wanted.
VERDICTS: tuple[str, ...] = ("found", *EASE)

#: Of the ways in which a linkage may begin so many are judged, the nearest first, until one does it.
TRIED = 4

#: By how much a must may be missed through rounding [rad, or relative to the size].
ROUNDING = 1e-9

#: Parts into which the range of each number is divided where linkages are distinguished.
CELLS = 3

#: Cells of the spread of a measure, the last for all beyond, and the width of each.
SPREAD = 36
STEPS = {"error": 0.02, "swing": math.radians(10), "time_ratio": 0.1, "transmission": math.radians(2.5)}


@dataclass(frozen=True, eq=False)
class LoopSurvey(Drawn):
    """Linkages within the bounds of a design task: what is wanted, what must hold and the limits are its.

    One does it that keeps what must hold as it is drawn. The figure by which they are ranked is the root of
    the weighted mean squares of what is left and of what the musts lack. Raises `RequestError`.
    """

    #: What a processor judges in some seconds.
    part_size = 256
    verdicts = VERDICTS

    task: DesignTask
    count: int = 10**5
    seed: int = 0

    def __post_init__(self) -> None:
        self.check_counts(MOST_SOBOL)

    @property
    def heading(self) -> str:
        """What it is."""
        return f"Survey of {self.task.draft.linkage.heading}"

    def values(self, first: int, stop: int) -> Floats:
        """The free numbers (n, k) of linkages by their indices."""
        low, high = self.task.low, self.task.high
        return low + sobol_points(self.seed, len(low), first, stop).T * (high - low)

    def tally(self, part: int) -> SurveyTally:
        """The tally of a part."""
        linkages, model = self.linkages(part), TaskModel(self.task)
        rows = zip(linkages, self.values(linkages.start, linkages.stop), strict=True)
        return reduce(add, (self._of_one(model, index, values) for index, values in rows))

    def _of_one(self, model: TaskModel, index: int, values: Floats) -> SurveyTally:
        """The tally of one linkage."""
        motion = model.loop.motion(values)
        verdict, selected = _judged(model, index, values)
        best: tuple[Kept, ...] = ()
        nearest: dict[int, Kept] = {}
        measured: dict[str, float | None] = {}
        if motion is not None and selected is not None:
            circuit = motion.circuits[selected.branch]
            turns = motion.linkage.turns(model.loop.linkage.drive.output)
            measured = {
                "error": selected.error,
                "swing": circuit.swing if turns else None,
                "time_ratio": circuit.time_ratio,
                "transmission": selected.transmission,
            }
            best = (replace(selected, place=self._cell(values)),)
            if number := VERDICTS.index(verdict):
                nearest = {number: replace(selected, place=number)}
        return SurveyTally(
            {one: int(one == verdict) for one in VERDICTS},
            {"cannot-assemble" if motion is None else motion.motion_type: 1},
            {"0" if motion is None else str(len(motion.limits)): 1},
            {name: (step, _spread(measured.get(name), step)) for name, step in STEPS.items()},
            best,
            nearest,
        )

    def _cell(self, values: Floats) -> int:
        """The part of the space that a linkage lies in: the low, middle or high third of each number."""
        width = np.maximum(self.task.high - self.task.low, np.finfo(float).tiny)
        thirds = np.minimum(CELLS * (values - self.task.low) / width, CELLS - 1).astype(int)
        return sum(int(third) * CELLS**k for k, third in enumerate(thirds))

    def request(self) -> dict[str, Any]:
        """What the survey is, as plain values: two surveys with one request have the same answer."""
        task = self.task
        asked = {
            "format": FORMAT,
            "linkage": dict(task.draft.raw),
            "agree": task.draft.agree,
            "free": {one.name: [one.low, one.high] for one in task.free},
            "wanted": [{"kind": type(one).__name__, **asdict(one)} for one in task.wants],
            "must_hold": [{"kind": type(one).__name__, **asdict(one)} for one in task.musts],
            "placement": task.placement,
            "goal": task.goal,
            "limits": asdict(task.limits),
            "follow": task.follow,
            "count": self.count,
            "seed": self.seed,
            "part_size": self.part_size,
        }
        plain: dict[str, Any] = json.loads(json.dumps(asked, default=np.ndarray.tolist))
        return plain

    def words_of(self, verdict: str, kept: Kept) -> str:  # noqa: ARG002
        """A linkage that came nearest to pass a verdict: its figures and its numbers."""
        (row,) = self.values(kept.index, kept.index + 1)
        numbers = (f"{name} {value:.4g}" for name, value in zip(self.task.names, row, strict=True))
        lack = math.sqrt(max(kept.figure**2 - kept.error**2, 0.0))
        return f"error {kept.error:.3g}, musts lack {lack:.3g}: linkage {kept.index}, {', '.join(numbers)}"

    def designs(self, tally: SurveyTally, count: int, progress: Progress = silent) -> DesignsFound:
        """Up to `count` designs of the search that begins with the best linkages of a tally."""
        if not count:
            return DesignsFound((), task=self.task, starts=0)
        given = [self.values(selected.index, selected.index + 1)[0] for selected in tally.best]
        try:
            return designed(self.task, count=count, starts=0, given=given, progress=progress)
        except KeyboardInterrupt:
            return DesignsFound((), unfinished="stopped before the first design", task=self.task, starts=0)


def _spread(value: float | None, step: float) -> tuple[int, ...]:
    """A one in the cell in which a value lies; none where there is no value."""
    cell = int(min(value / step, SPREAD - 1)) if value is not None and math.isfinite(value) else None
    return tuple(int(k == cell) for k in range(SPREAD))


def _judged(model: TaskModel, index: int, values: Floats) -> tuple[str, Kept | None]:
    """The verdict of a linkage, and its best way to begin where it has one."""
    motion, limits = model.loop.motion(values), model.task.limits
    if motion is None or not motion.circuits:
        return "assembly", None
    if limits.motion_type not in (None, motion.motion_type):
        return "motion type", None
    best: tuple[str, Kept] | None = None
    for seed in sorted(seeds_at(model, values), key=lambda seed: seed.error)[:TRIED]:
        problem = TaskProblem(model, seed)
        here = problem.tried(problem.start)
        if here is None:
            continue
        missed: list[str] = [fault for fault, slack in here.least.items() if slack < -ROUNDING]
        if limits.size and size_fault(model.loop.drawn(seed.values), limits) is not None:
            missed.insert(0, "size")
        verdict = missed[0] if missed else "found"
        error = float(np.linalg.norm(here.residuals))
        figure = math.hypot(error, *np.minimum(here.slack, 0.0))
        start = seed.anchor[model.loop.input]
        lowest = motion.circuits[seed.circuit].transmission
        angle = math.nan if lowest is None else lowest.lowest
        selected = Kept(index, 0, figure, error, angle, (math.nan, math.nan), float(start), seed.circuit, 1.0)
        if best is None or (verdict != "found", selected.order) < (best[0] != "found", best[1].order):
            best = verdict, selected
        if not missed:
            break
    return best or ("dead centre", None)
