"""Path generation: linkages of a given type whose point goes through wanted points, in order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from sevenbar.design.synthesis.candidates import Candidate, Refusal, distinct, ranked, renamed, tally
from sevenbar.design.synthesis.limits import Limits
from sevenbar.design.synthesis.path_check import checked_path
from sevenbar.design.synthesis.path_refine import LOOK, Refined, refined
from sevenbar.design.synthesis.path_search import Seed, apart, looked_at, seeds
from sevenbar.design.synthesis.path_task import MOST_POINTS, PathTask, Where, path_task
from sevenbar.draft import Draft
from sevenbar.errors import RequestError, shown
from sevenbar.linkage import Linkage

#: Starts where none are asked for, the most, and the most designs.
STARTS, MOST_STARTS, MOST_DESIGNS = 256, 65536, 50

#: How often a design that passes its points in a wrong order is matched with them anew.
MATCHED_ANEW = 2

#: Of the starts so many for each design wanted are looked at closer, and of these so many to the end.
LOOKED_AT, TAKEN = 8, 3

__all__ = ["MOST_POINTS", "STARTS", "generated", "path_generation", "path_task"]


def path_generation(
    linkage: Linkage | Draft,
    points: npt.ArrayLike,
    point: Where,
    *,
    vary: Sequence[str] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    timing: npt.ArrayLike | None = None,
    phase: bool = False,
    place: bool = False,
    limits: Limits | None = None,
    count: int = 5,
    starts: int = STARTS,
    seed: int = 0,
) -> tuple[Candidate, ...]:
    """Several distinct linkages whose point goes through wanted points in order, the best first.

    `linkage` is the type and the start; `points` (n, 3) [length], closed where the last repeats the first;
    `point` a name, or (link, at). `vary` names dimensions or patterns (all that can change alone where none
    are given), `bounds` hold (low, high) in the file's units. `timing` (n,) [rad, or length] are the inputs
    at which the points shall be reached, with `phase` from an unknown start on. With `place` the linkage may
    stand anywhere in space, and be of any size where every length varies. `limits`: transmission angle (of
    an RSSR), size, motion type. `starts` linkages all over the bounds are tried, from a `seed`.

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
    )
    return generated(task, count=count, starts=starts, seed=seed)


def generated(
    task: PathTask,
    *,
    count: int = 5,
    starts: int = STARTS,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Candidate, ...]:
    """The designs of a task, as `path_generation` gives them; `progress` is told (done, total)."""
    _count("designs", count, 1, MOST_DESIGNS)
    _count("starts", starts, 0, MOST_STARTS)
    _count("seed", seed, 0, 2**63 - 1)
    found = seeds(task, starts, seed)
    rough = apart(task, found, LOOKED_AT * count)
    steps = len(rough) + TAKEN * count
    looked: list[Refined] = []
    for i, one in enumerate(rough):
        _tell(progress, i, steps)
        look = refined(task, one, LOOK)
        looked += [look] if look is not None else []
    looked.sort(key=lambda one: one.rms)
    kept: list[Candidate] = []
    refusals: list[Refusal] = []
    for i, look in enumerate(looked):
        if len(distinct(ranked(kept), scale_free=False)) >= count and i >= TAKEN * count:
            break
        _tell(progress, min(len(rough) + i, steps), steps)
        answer = _answer(task, look)
        if isinstance(answer, Candidate):
            kept.append(answer)
        else:
            refusals.append(answer)
    _tell(progress, steps, steps)
    if not kept:
        raise RequestError(_nothing(task, found, refusals))
    best = distinct(ranked(kept), scale_free=False, count=count)
    return tuple(renamed(best, task.draft.linkage.name))


def _answer(task: PathTask, look: Refined) -> Candidate | Refusal:
    """The design that a first look leads to; matched anew where it passes the points in a wrong order."""
    start = Seed(look.varied, look.inputs, look.poses, 0.0, _phase(task, look))
    answer: Candidate | Refusal | None = None
    for _ in range(MATCHED_ANEW + 1):
        whole = refined(task, start)
        if whole is None:
            break
        answer = checked_path(task, whole)
        if isinstance(answer, Candidate) or answer.fault != "order":
            break
        start = min(looked_at(task, whole.varied), key=lambda one: one.error, default=start)
        if not np.isfinite(start.error):
            break
    return answer or checked_path(task, look)


def _tell(progress: Callable[[int, int], None] | None, done: int, total: int) -> None:
    if progress is not None:
        progress(done, total)


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
        f"path: no design passes the check ({tally(refusals)}); the nearest: {last.told}; give wider bounds "
        "or limits, or more starts"
    )


def _count(name: str, value: object, low: int, high: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise RequestError(f"{name}: {shown(value)} is not a count; give {low} to {high}")
