"""Path generation: linkages of a given type whose point goes through wanted points, in order."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.description.draft import Draft
from sevenbar.design.candidates import (
    Candidate,
    Refusal,
    distinct,
    least_error,
    ranked,
    renamed,
    tally,
)
from sevenbar.design.course import SearchCourse
from sevenbar.design.limits import Limits
from sevenbar.design.synthesis.path.check import checked_path
from sevenbar.design.synthesis.path.refine import LOOK, Refined, refined
from sevenbar.design.synthesis.path.search import Seed, apart, looked_at, seeds
from sevenbar.design.synthesis.path.task import PathTask, Where, path_task
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.progress import Progress, silent

#: Starts by default, the most, and the most designs.
STARTS, MOST_STARTS, MOST_DESIGNS = 256, 65536, 50

#: Of the starts so many for each design wanted are checked closer, and of these so many to the end.
LOOKED_AT, TAKEN = 8, 3

__all__ = ["STARTS", "PathFound", "generated", "path_generation", "path_task"]


@dataclass(frozen=True, eq=False)
class PathFound:
    """The designs of a search, best first; `unfinished` says that it was stopped, empty where it ended."""

    candidates: tuple[Candidate, ...]
    unfinished: str


def path_generation(
    linkage: Linkage | Draft,
    points: npt.ArrayLike,
    point: Where,
    *,
    vary: Sequence[str] | None = None,
    bounds: Mapping[str, tuple[float | str, float | str]] | None = None,
    timing: npt.ArrayLike | None = None,
    phase: bool = False,
    place: bool = False,
    limits: Limits | None = None,
    count: int = 5,
    starts: int = STARTS,
    seed: int = 0,
    follow: Collection[str] = (),
) -> tuple[Candidate, ...]:
    """Several distinct linkages whose point goes through wanted points in order, the best first.

    `linkage` is the type and the start; `points` (n, 3) [length], closed where the last repeats the first;
    `point` a name, or (link, at). `vary` names dimensions or patterns (all that can change alone where none
    are given), `bounds` hold (low, high) in the file's units. `timing` (n,) [rad, or length] are the inputs
    at which the points shall be reached, with `phase` from an unknown start on. With `place` the linkage may
    stand anywhere in space, and be of any size where every length varies. `limits`: transmission angle (of
    an RSSR), size, motion type. `starts` linkages all over the bounds are tried, from a `seed`. L2 of an RSSR
    whose file leaves it out varies like the others, or is in `follow`.

    Each answer is one circuit through all points in their order without a dead centre between, as the
    ordinary analysis of its file finds it; its errors [length] are the distances there.

    Raises `RequestError` for what does not fit, and where nothing is found, with the reasons.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> linkage = sb.load("rssr")
        >>> path = linkage.motion(12).circuits[0].point(3, (50.0, 60.0, 0.0)).position
        >>> (best,) = path_generation(
        ...     linkage, path, (3, (40.0, 70.0, 0.0)), vary=["P.*"], count=1, starts=0
        ... )
        >>> best.error_greatest < 1e-8
        True
    """
    task = path_task(
        linkage,
        points,
        point,
        vary=vary,
        bounds=bounds,
        timing=timing,
        phase=phase,
        place=place,
        limits=limits,
        follow=follow,
    )
    return generated(task, count=count, starts=starts, seed=seed).candidates


def generated(
    task: PathTask,
    *,
    count: int = 5,
    starts: int = STARTS,
    seed: int = 0,
    progress: Progress = silent,
) -> PathFound:
    """The designs of a task; `progress` is called with (done, total, the best so far).

    Ctrl+C ends the search with what it has.
    """
    check_counts(count, starts, seed)
    course = SearchCourse(starts + 1 + (LOOKED_AT + TAKEN) * count, progress)
    kept: list[Candidate] = []
    unfinished = ""
    try:
        _search(task, count, starts, seed, course, kept)
        course.end()
    except KeyboardInterrupt:
        if not kept:
            raise
        unfinished = course.unfinished
    best = distinct(ranked(kept), scale_free=False, count=count)
    return PathFound(tuple(renamed(best, task.draft.linkage.name)), unfinished)


def _search(
    task: PathTask, count: int, starts: int, seed: int, course: SearchCourse, kept: list[Candidate]
) -> None:
    """Adds the designs that pass the check to `kept`, one by one; `RequestError` where none does."""
    found = seeds(task, starts, seed, course.step)
    rough = apart(task, found, LOOKED_AT * count)
    course.step(done=starts + 1 - course.done)
    looked: list[Refined] = []
    unit = task.draft.linkage.length_unit
    for one in rough:
        looks = [_looked(task, start) for start in (one, one.other) if start is not None]
        looked += [look for look in looks if look is not None]
        nearest = min((look.rms for look in looked), default=None)
        course.step("" if nearest is None else f"nearest: rms {nearest:.3g} {unit}")
    course.step(done=starts + 1 + LOOKED_AT * count - course.done)
    # those in order first: the others are mostly refused
    looked.sort(key=lambda one: (task.timing is None and not _ordered(one), one.rms))
    refusals: list[Refusal] = []
    for i, look in enumerate(looked):
        if len(distinct(ranked(kept), scale_free=False)) >= count and i >= TAKEN * count:
            break
        answer = _answer(task, look)
        if isinstance(answer, Candidate):
            kept.append(answer)
        else:
            refusals.append(answer)
        course.step(least_error(kept), done=int(course.done < course.total))
    if not kept:
        raise RequestError(_nothing(task, found, refusals))


def _looked(task: PathTask, start: Seed) -> Refined | None:
    """A first look at a start; matched anew once where its points have left their order."""
    look = refined(task, start, LOOK)
    if look is None or task.timing is not None or _ordered(look):
        return look
    again = min(looked_at(task, look.varied), key=lambda one: one.error, default=None)
    if again is None or not np.isfinite(again.error):
        return look
    return refined(task, again, LOOK) or look


def _ordered(look: Refined) -> bool:
    """Whether the inputs of a path go one way."""
    steps = np.diff(look.inputs)
    return bool((steps > 0).all() or (steps < 0).all())


def _answer(task: PathTask, look: Refined) -> Candidate | Refusal:
    """The design that a first look leads to, solved to the end and checked."""
    start = Seed(look.varied, look.inputs, look.poses, 0.0, _phase(task, look))
    return checked_path(task, refined(task, start) or look)


def _phase(task: PathTask, look: Refined) -> float:
    """What was added to the wanted inputs."""
    return 0.0 if task.timing is None else float(look.inputs[0] - task.timing[0])


def _nothing(task: PathTask, found: Sequence[Seed], refusals: Sequence[Refusal]) -> str:
    """Why nothing was found, in words."""
    if not found:
        what = "goes round" if task.closed else "passes the points"
        return (
            f"path: no circuit of any start {what} without a dead centre of the input; give wider bounds, "
            "more starts, or another joint as the input"
        )
    if not refusals:
        return "path: no start could be followed to a solution; give wider bounds, or more starts"
    last = refusals[0]
    return (
        f"path: no design passes the check ({tally(refusals)}); the nearest: {last.detail}; give wider "
        "bounds or limits, or more starts"
    )


def check_counts(count: object, starts: object, seed: object) -> None:
    """Raises `RequestError` for a number of designs or starts, or a seed, that is none."""
    _count("designs", count, 1, MOST_DESIGNS)
    _count("starts", starts, 0, MOST_STARTS)
    _count("seed", seed, 0, 2**63 - 1)


def _count(name: str, value: object, low: int, high: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise RequestError(f"{name}: {shown(value)} is not a count; give {low} to {high}")
