"""Path generation: linkages of a given type whose point goes through wanted points, in order."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy.typing as npt

from sevenbar.arrays import whole_number
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import Candidate, renamed
from sevenbar.design.limits import Limits
from sevenbar.design.synthesis.path.task import PathTask, Where, path_task
from sevenbar.design.task.search import STARTS, DesignsFound, designed
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.progress import Progress, silent

#: The most starts, and the most designs.
MOST_STARTS, MOST_DESIGNS = 65536, 50

__all__ = ["STARTS", "generated", "path_generation", "path_task"]


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
) -> DesignsFound:
    """The designs of a task, best first; `progress` is called with (done, total, the best so far).

    Ctrl+C ends the search with what it has.
    """
    check_counts(count, starts, seed)
    result = designed(task.design, count=count, starts=starts, seed=seed, progress=progress)
    result.required(starts)
    best = sorted(result.designs, key=lambda design: design.candidate.error_greatest)
    return replace(result, designs=tuple(renamed(best, task.draft.linkage.name)))


def check_counts(count: object, starts: object, seed: object) -> None:
    """Raises `RequestError` for a number of designs or starts, or a seed, that is none."""
    whole_number("designs", count, 1, MOST_DESIGNS, "a count")
    whole_number("starts", starts, 0, MOST_STARTS, "a count")
    whole_number("seed", seed, 0, 2**63 - 1, "a count")
