"""Swing and time ratio: RSSR crank-rockers whose output rocks through an angle, slower one way than back.

The crank-rockers of a survey that are nearest to the wish are polished as the best of every survey are. With
G of `closure`, (1), the input u at the low end, the stroke s of the crank and the swing w

    G_alpha(u) = 0,      G_alpha(u + s) = 0,      beta(u + s) - beta(u) = w                               (1)

are three equations for the five ratios and u; the three numbers that remain make the least transmission angle
of the whole turn as great as can be.

Source: docs/theory_design.md, (27).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.candidates import (
    SAME,
    Candidate,
    Claim,
    Refusal,
    checked,
    transmits_best,
    within_limits,
)
from sevenbar.design.closure import draft_of, outputs, scaled
from sevenbar.design.extra import need_scipy
from sevenbar.design.limits import MARGIN, Limits
from sevenbar.design.search import DesignSearch
from sevenbar.design.survey.polish import Polish, swung
from sevenbar.design.survey.skew_closure import START, N
from sevenbar.design.survey.tally import SurveyTally
from sevenbar.design.survey.task import SurveyTask, SwingWish, drawn_numbers, refuse_without_swing
from sevenbar.design.synthesis.function.generation import USUAL, Synthesis, check_count
from sevenbar.design.synthesis.function.precision import reflected
from sevenbar.text.progress import Progress, silent

#: Designs of the survey, and inputs of a turn at which one is checked.
SEARCHED, LOOKED_AT = 131072, 72

#: The angle between axes, as bounds [rad].
SQUARE = math.pi / 2, math.pi / 2

#: How many of them are refined for each design requested, and at least.
FITTED_EACH, FITTED_LEAST = 4, 24

#: Of starts that end in one design so many are enough; those that follow keep their own N, so that designs
#: differ.
ENOUGH = 8

#: Gain of a squared sine that is not worth another step.
WORTH = 1e-4

#: Greatest error of a swing and of a stroke [rad] that counts as met.
MET = 1e-8


def swing_generation(
    swing: float,
    time_ratio: float = 1.0,
    *,
    limits: Limits = USUAL,
    count: int = 5,
    seed: int = 0,
    progress: Progress = silent,
) -> Synthesis:
    """RSSR crank-rockers with a `swing` [rad] and a `time_ratio` >= 1, those that transmit best first.

    The crank turns at constant speed; its transmission angle counts over the whole turn. `progress` is called
    with (done, total, the best so far); Ctrl+C ends the search with what it has. Raises `RequestError` for a
    wish that is none; one that cannot be met has no candidates.

        >>> found = swing_generation(math.radians(60), 1.2, count=1)
        >>> round(found.candidates[0].claim.figures["time_ratio"], 9)
        1.2
    """
    need_scipy()
    want = SwingWish(swing, time_ratio)
    refuse_without_swing(limits.motion_type)
    check_count(count)
    most = max(FITTED_LEAST, FITTED_EACH * count)
    search: DesignSearch[Candidate] = DesignSearch(1 + most, progress, count=count, mirrored=True)
    started = _started(want, limits, most, seed)
    search.step()
    ends: list[Floats] = []

    def solve(start: tuple[Floats, int]) -> tuple[float, Candidate | Refusal]:
        numbers, branch = start
        held = numbers[N] if _most_alike(ends) >= ENOUGH else None
        polished = Polish(_task(want, limits, held), numbers, branch, worth=WORTH).polished()
        ends.append(np.abs(polished[:6]) / np.abs(polished[:6]).max())
        far, result = _judged(want, limits, polished, branch)
        if math.isinf(far):
            far, result = _judged(want, limits, numbers, branch)
        return (
            (far, result) if isinstance(result, Refusal) else (-(result.transmission_lowest or 0.0), result)
        )

    with search.until_stopped(search.checked):
        search.over(started, solve, transmits_best)
    return Synthesis(
        **vars(search.result(want.title)),
        wanted=want.title,
        limits=limits,
        searched=SEARCHED,
        fitted=len(started),
        seed=seed,
    )


def _most_alike(ends: list[Floats]) -> int:
    """How many of the designs (6,), relative to their longest, are one."""
    rows = np.array(ends).reshape(-1, 6)
    return int((np.abs(rows[:, None] - rows).max(axis=2) < SAME).sum(axis=1).max(initial=0))


def _task(want: SwingWish, limits: Limits, held: float | None) -> SurveyTask:
    """The wish as polishing has it: axes at right angles, L3 = 1, the limits of the size; N may be `held`."""
    ratio = limits.ratio
    bounds = dict.fromkeys(("M", "N", "D"), (-ratio, ratio)) | {"angle": SQUARE}
    bounds |= dict.fromkeys(("L1", "L2"), (1 / ratio, ratio)) | {"L3": (1.0, 1.0)}
    if held is not None:
        bounds["N"] = held, held
    # a margin is left that Newton's last steps may use
    return SurveyTask(want, bounds, transmission_lowest=0.0, ratio=ratio ** (1 - MARGIN), rank="transmission")


def _started(want: SwingWish, limits: Limits, most: int, seed: int) -> list[tuple[Floats, int]]:
    """The crank-rockers of a survey that are nearest to the wish, each of another part of the space.

    Each as the numbers (8,) of `skew_closure`, the input's start at its low end, and the branch.
    """
    task = SurveyTask(
        want,
        {"angle": SQUARE},
        SEARCHED,
        seed,
        tolerance=math.pi,
        transmission_lowest=0.0,
        ratio=limits.ratio,
    )
    best = SurveyTally.of(task.core().tally(0, SEARCHED)).best[:most]
    rows = drawn_numbers(task, [selected.index for selected in best])
    return [
        (np.append(row, selected.start), selected.branch) for row, selected in zip(rows, best, strict=True)
    ]


def _judged(
    want: SwingWish, limits: Limits, numbers: Floats, branch: int
) -> tuple[float, Candidate | Refusal]:
    """A design as the ordinary analysis finds it, and how far from the wish it is [rad]."""
    rows, zeros = reflected(numbers[None, :6], np.array([[numbers[START], 0.0]]))
    row = scaled(rows[0], limits.longest)
    inputs = zeros[0, 0] + np.arange(LOOKED_AT) * math.tau / LOOKED_AT
    claim = Claim(inputs, outputs(row[None], inputs, branch)[0], np.zeros(1), "deg", whole_turn=True)
    free = checked(draft_of(row, want.title), claim, Limits(motion_type="crank-rocker"))
    if isinstance(free, Refusal):
        return math.inf, free
    free = swung(want, free)
    if free.error_greatest > MET:
        figures = free.claim.figures
        reached = f"swing {figures['swing_deg']:.4g} deg with time ratio {figures['time_ratio']:.4g}"
        return free.error_greatest, Refusal("error", reached)
    return free.error_greatest, within_limits(free, replace(limits, motion_type="crank-rocker"))
