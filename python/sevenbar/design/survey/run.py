"""Runs a survey: parts on the threads of this machine or on a cluster; then the best are polished.

The answer has the designs, why others were refused, and what came nearest where there is none.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial, reduce
from operator import add
from pathlib import Path

from sevenbar.design.candidates import Candidate
from sevenbar.design.extra import need_scipy
from sevenbar.design.search import Designs
from sevenbar.design.survey.drawn import Drawn
from sevenbar.design.survey.journal import Journal
from sevenbar.design.survey.loops import LoopSurvey
from sevenbar.design.survey.polish import designs
from sevenbar.design.survey.tally import BEST, SurveyTally
from sevenbar.design.survey.task import SurveyTask
from sevenbar.design.task.search import DesignsFound
from sevenbar.errors import RequestError
from sevenbar.sweep.held_folder import refuse_unlike
from sevenbar.sweep.plan import maker
from sevenbar.sweep.run import Made, made_by_processes, made_on_threads, thread_count
from sevenbar.text.printing import lines, text_of
from sevenbar.text.progress import Progress, silent

#: The remark about a survey that Ctrl+C ended.
UNFINISHED = "stopped after {done} of {total} linkages; these are the best so far"

#: Makes parts and gives each when it is finished.
Making = Callable[[Iterable[int]], Generator[Made, None, None]]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SurveyResult(Designs[Candidate]):
    """The answer of a survey: designs polished and checked, best first, and the tally of all linkages.

    `refusals` say why others of the best were no designs after all; `polished` were made better.
    """

    task: SurveyTask | LoopSurvey
    tally: SurveyTally
    polished: int
    #: Of a design task: what the search that began with the best hundred found.
    found: DesignsFound | None = None

    @property
    def nearest(self) -> dict[str, str]:
        """By verdict, what came nearest to pass it: its figures and its numbers."""
        verdicts = self.task.verdicts
        return {
            verdicts[k]: self.task.words_of(verdicts[k], selected)
            for k, selected in self.tally.nearest.items()
        }

    @property
    def answer(self) -> str:
        """The answer in one sentence."""
        count = f"{self.tally.count:,}".replace(",", " ")
        if self.tally.found:
            return f"{self.tally.found} of {count} do it"
        return f"none of {count} does it"


@text_of.register(SurveyResult)
def _(result: SurveyResult) -> str:
    return lines(
        result.task.heading,
        [
            ("answer", result.answer),
            ("designs", str(len(result.candidates))),
            ("unfinished", result.unfinished),
        ],
    )


def part_line(task: Drawn, part: int) -> bytes:
    """The tally of a part as JSON: the same bits wherever it is made by the same `maker`."""
    return task.tally(part).line().encode()


def survey(
    task: SurveyTask | LoopSurvey,
    *,
    designs_wanted: int = BEST,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    mixed: bool = False,
    threads: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> SurveyResult:
    """Judges `task.count` linkages drawn from a sequence, and polishes and checks the best of them.

    Nothing is stored but tallies and the best hundred, each of another part of the space. With a folder `out`
    every finished part is kept in its journal, and `resume` goes on after a stop, `mixed` also on another
    vector unit. It runs on `threads` (all processors by default; loops other than RSSRs are judged by as many
    processes) or the workers of a Dask `scheduler`; the answer is the same. `progress` is called with the
    linkages done, of all, and the best so far; Ctrl+C ends the survey with what it has.

    Raises `RequestError` for an argument that does not fit, `OutputError` for a folder that cannot be used.

        >>> from sevenbar.design.survey import SurveyTask, Travel
        >>> task = SurveyTask(Travel(math.radians(90), math.radians(23.75)), count=3000)
        >>> found = survey(task, designs_wanted=1, threads=1)
        >>> found.tally.count, len(found.candidates)
        (3000, 1)
    """
    need_scipy()
    if not 0 <= designs_wanted <= BEST:
        raise RequestError(f"designs: {designs_wanted} designs are not offered; give 0 to {BEST}")
    if scheduler is not None and threads is not None:
        raise RequestError("threads: workers of a scheduler have their own; leave threads or scheduler out")
    folder = None if out is None else Path(out)
    if scheduler is None:
        at_once = min(thread_count(threads), task.parts)
        make = made_by_processes if isinstance(task, LoopSurvey) and at_once > 1 else made_on_threads
        here = partial(make, partial(part_line, task), at_once)
        tally = _judged(task, [maker()], here, folder, resume, mixed, progress)
    else:
        from sevenbar.sweep.cluster import Cluster

        with Cluster(scheduler, task, part_line) as cluster:
            tally = _judged(task, cluster.makers(), cluster.made, folder, resume, mixed, progress)
    unfinished = ""
    if tally.count < task.count:
        unfinished = UNFINISHED.format(done=tally.count, total=task.count)
    if isinstance(task, LoopSurvey):
        result = task.designs(tally, designs_wanted, progress)
        return SurveyResult(
            result.candidates,
            result.refusals,
            unfinished or result.unfinished,
            task=task,
            tally=tally,
            polished=len(result.designs),
            found=result,
        )
    best, polished = designs(task, tally, designs_wanted, progress)
    best = replace(best, unfinished=unfinished or best.unfinished)
    return SurveyResult(**vars(best), task=task, tally=tally, polished=polished)


def _judged(
    task: SurveyTask | LoopSurvey,
    makers: Sequence[Mapping[str, str]],
    made: Making,
    folder: Path | None,
    resume: bool,
    mixed: bool,
    progress: Progress,
) -> SurveyTally:
    """The tally of all parts, or of those that were done when Ctrl+C came."""
    refuse_unlike(makers, mixed=mixed)
    journal = None if folder is None else Journal(folder, task, makers, resume=resume, mixed=mixed)
    tallies = {} if journal is None else dict(journal.tallies)
    total = reduce(add, tallies.values()) if tallies else None
    progress(0 if total is None else total.count, task.count, _best(task, total))
    try:
        missing = (part for part in range(task.parts) if part not in tallies)
        with closing(made(missing)) as finished:
            for part, content, by in finished:
                if journal is not None:
                    journal.keep(part, content, by)
                tally = SurveyTally.of_dict(json.loads(content))
                total = tally if total is None else total + tally
                progress(total.count, task.count, _best(task, total))
    except KeyboardInterrupt:
        if total is None:
            raise
    finally:
        if journal is not None:
            journal.close()
    assert total is not None
    return total


def _best(task: SurveyTask | LoopSurvey, tally: SurveyTally | None) -> str:
    """The best so far in words."""
    if tally is None or not tally.best:
        return ""
    if isinstance(task, LoopSurvey):
        return f"{tally.found} fit, nearest: {tally.best[0].figure:.3g}"
    figure = math.degrees(abs(tally.best[0].figure))
    name = task.rank.replace("transmission", "transmission angle")
    return f"{tally.found} fit, best: {name} {figure:.3g} deg"
