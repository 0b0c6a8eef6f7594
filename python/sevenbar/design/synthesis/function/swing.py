"""Swing and time ratio: RSSR crank-rockers whose output rocks through an angle, slower one way than back.

At both ends of the swing the output stands still, G = 0 and G_alpha = 0 (G of `closure`, (1)). As G_alpha is
zero there, a change dp of the dimensions moves an end by

    dbeta = -G_p dp / G_beta,      dalpha = -(G_alpha_p dp + G_alpha_beta dbeta) / G_alpha_alpha         (1)

so the swing follows dp as if the crank stood still, and the stroke between the two ends by both dalpha. Two
equations, swing and stroke, leave three of the five ratios free: these make the least transmission angle of
the whole turn as great as can be.

Source: docs/theory_design.md, (27).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.candidates import (
    Candidate,
    Claim,
    Refusal,
    checked,
    distinct,
    ranked,
    renamed,
    transmits_best,
    within_limits,
)
from sevenbar.design.closure import draft_of, outputs, scaled, transmissions
from sevenbar.design.course import SearchCourse
from sevenbar.design.limits import MARGIN, Limits, size_room, turning_room
from sevenbar.design.synthesis.function.generation import USUAL, Synthesis, need_scipy
from sevenbar.design.synthesis.function.precision import reflected
from sevenbar.design.task.programs import MinimaxValues, lowered
from sevenbar.errors import RequestError
from sevenbar.text.progress import Progress, silent

#: Designs of the global search, and inputs of a turn at which they are checked.
SEARCHED, LOOKED_AT = 16384, 72

#: How many of them are refined for each design requested, and at least.
FITTED_EACH, FITTED_LEAST = 4, 24

#: Two starts are one where the arctangent of no ratio differs by more.
START_APART = 0.12

#: Inputs of a turn from whose extremes Newton finds the ends of a swing.
END_SAMPLES = 181

#: Newton's steps on the ends of a swing and on a wish, the last step [rad, parts of L3] that ends them, and
#: G and G_alpha, relative to the size squared, with which they have arrived.
MOST_NEWTON, LAST_STEP, ARRIVED = 30, 1e-14, 1e-11

#: Columns of a row (6,) that are unknown: all but L3.
FREE = (0, 1, 2, 3, 5)

#: Gain of a squared sine that is not worth another step.
WORTH = 1e-4

#: Greatest error of a swing [rad] and of a time ratio that counts as met.
MET = 1e-8

#: Time ratio beyond which the crank would stand still for all purposes on its quick way.
MOST_TIME_RATIO = 20.0


@dataclass(frozen=True, eq=False)
class SwingEnds:
    """The ends of a swing, the high one last: crank and output (2,) [rad] and their slopes (2, 6)."""

    crank: Floats
    output: Floats
    crank_slopes: Floats
    output_slopes: Floats

    @property
    def swing(self) -> float:
        """The swing [rad]."""
        return float(self.output[1] - self.output[0])

    @property
    def stroke(self) -> float:
        """The turn of the crank from the low to the high end [rad], in (0, 2 pi)."""
        return float((self.crank[1] - self.crank[0]) % math.tau)


def ends_of_swing(row: Floats, branch: int) -> SwingEnds | None:
    """The ends of the swing of a design (6,) on a branch; `None` where crank or output does not fit."""
    inputs = np.linspace(0.0, math.tau, END_SAMPLES)
    angles = np.unwrap(outputs(row[None], inputs, branch)[0])
    # an output that comes back a turn on does not rock
    if not np.isfinite(angles).all() or abs(angles[-1] - angles[0]) > 1.0:
        return None
    low, high = (_end(row, inputs[i], angles[i]) for i in (angles.argmin(), angles.argmax()))
    if low is None or high is None:
        return None
    return SwingEnds(*(np.array([a, b]) for a, b in zip(low, high, strict=True)))


def _end(row: Floats, alpha: float, beta: float) -> tuple[float, float, Floats, Floats] | None:
    """An end of the swing near a pose, by Newton on G and G_alpha: crank, output and their slopes (6,)."""
    for _ in range(MOST_NEWTON):
        g, by_alpha, by_beta, second, mixed, by_row, by_alpha_row = _second(row, alpha, beta)
        try:
            step = np.linalg.solve([[by_alpha, by_beta], [second, mixed]], [g, by_alpha])
        except np.linalg.LinAlgError:
            return None
        alpha, beta = alpha - step[0], beta - step[1]
        if np.abs(step).max() < LAST_STEP:
            break
    g, by_alpha, by_beta, second, mixed, by_row, by_alpha_row = _second(row, alpha, beta)
    if not abs(g) + abs(by_alpha) < ARRIVED * float((row**2).max()) or by_beta == 0 or second == 0:
        return None
    beta_slopes = -by_row / by_beta
    return alpha, beta, -(by_alpha_row + mixed * beta_slopes) / second, beta_slopes


def _second(
    row: Floats, alpha: float, beta: float
) -> tuple[float, float, float, float, float, Floats, Floats]:
    """G, G_alpha, G_beta, G_alpha_alpha, G_alpha_beta, G_p (6,) and G_alpha_p (6,) of one pose."""
    m, n, l1, l2, l3, d = row
    ca, sa, cb, sb = math.cos(alpha), math.sin(alpha), math.cos(beta), math.sin(beta)
    x, y = l1 * ca - m, l1 * sa - d
    g = l3 * (y * cb + n * sb) - (x * x + y * y + n * n + l3 * l3 - l2 * l2) / 2
    by_row = np.array([x, l3 * sb - n, l3 * sa * cb - x * ca - y * sa, l2, y * cb + n * sb - l3, y - l3 * cb])
    by_alpha_row = np.array([-l1 * sa, 0.0, l3 * ca * cb - m * sa + d * ca, 0.0, l1 * ca * cb, l1 * ca])
    by_alpha = l1 * (l3 * ca * cb - m * sa + d * ca)
    second = l1 * (-l3 * sa * cb - m * ca - d * sa)
    return g, by_alpha, l3 * (n * cb - y * sb), second, -l1 * l3 * ca * sb, by_row, by_alpha_row


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
    if not 0 < swing < math.tau:
        raise RequestError(
            f"swing: {math.degrees(swing):g} deg is no swing of a rocker; give an angle between 0 and 360 deg"
        )
    if not 1 <= time_ratio <= MOST_TIME_RATIO:
        raise RequestError(
            f"time ratio: {time_ratio:g} is not offered; it is the slower stroke over the quicker: "
            f"give 1 to {MOST_TIME_RATIO:g}"
        )
    if limits.motion_type not in (None, "crank-rocker"):
        raise RequestError(
            f"motion type: a {limits.motion_type} has no swing with a time ratio; give crank-rocker, or none"
        )
    if count < 1:
        raise RequestError(f"designs: {count} is no number of designs; give 1 or more")
    wanted_text = f"swing {math.degrees(swing):g} deg, time ratio {time_ratio:g}"
    wish = _Wish(swing, math.tau * time_ratio / (1 + time_ratio), limits)
    course = SearchCourse(1 + max(FITTED_LEAST, FITTED_EACH * count), progress)
    chosen, searched = _chosen(wish, course.total - 1, seed)
    course.step()
    kept: list[Candidate] = []
    refused: list[tuple[float, Refusal]] = []
    unfinished = ""
    try:
        for row, branch, ends in chosen:
            far, result = _judged(wish, wish.refined(row, branch, ends), branch, time_ratio, wanted_text)
            if isinstance(result, Candidate):
                kept.append(result)
            else:
                refused.append((far, result))
            course.step(transmits_best(kept))
        course.end()
    except KeyboardInterrupt:
        if not kept:
            raise
        unfinished = course.unfinished
    order = ranked(kept, lambda c: -(c.transmission_lowest or 0.0))
    best = distinct(order, scale_free=True, mirrored=True, count=count)
    refusals = tuple(refusal for _, refusal in sorted(refused, key=lambda pair: pair[0]))
    return Synthesis(
        wanted_text,
        limits,
        tuple(renamed(best, wanted_text)),
        refusals,
        searched,
        len(chosen),
        seed,
        unfinished=unfinished,
    )


@dataclass(frozen=True, eq=False)
class _Wish:
    """A swing and the slower stroke [rad], with limits."""

    swing: float
    slow: float
    limits: Limits

    def missed(self, ends: SwingEnds, rising: bool) -> tuple[Floats, Floats]:
        """How far off swing and stroke are (2,) [rad], and slopes (2, 5); `rising`: that stroke is slow."""
        stroke = self.slow if rising else math.tau - self.slow
        off = np.array([ends.swing - self.swing, ends.stroke - stroke])
        slopes = [ends.output_slopes[1] - ends.output_slopes[0], ends.crank_slopes[1] - ends.crank_slopes[0]]
        return off, np.array(slopes)[:, FREE]

    def refined(self, row: Floats, branch: int, ends: SwingEnds) -> Floats:
        """The design (6,) near another that meets the wish with the greatest least transmission angle."""
        rising = abs(ends.stroke - self.slow) <= abs(ends.stroke - math.tau + self.slow)

        def heights(z: Floats) -> MinimaxValues | None:
            moved = _row(z)
            there = ends_of_swing(moved, branch) if (moved[2:5] > 0).all() else None
            if there is None:
                return None
            square, slopes = turning_room(moved)
            size, size_slopes = size_room(moved, self.limits)
            off, off_slopes = self.missed(there, rising)
            return MinimaxValues(
                1.0 - square,
                -slopes[:, FREE],
                np.concatenate([size - MARGIN, off, -off]),
                np.concatenate([size_slopes[:, FREE], off_slopes, -off_slopes]),
            )

        z = lowered(heights, row[list(FREE)], worth=WORTH)
        there = ends_of_swing(_row(z), branch)
        for _ in range(MOST_NEWTON):
            if there is None:
                break
            off, slopes = self.missed(there, rising)
            step = np.linalg.lstsq(slopes, off, rcond=None)[0]
            there = ends_of_swing(_row(z - step), branch)
            if there is not None:
                z = z - step
            if np.abs(step).max() < LAST_STEP:
                break
        return _row(z)


def _row(z: Floats) -> Floats:
    row = np.ones(6)
    row[list(FREE)] = z
    return row


def _chosen(wish: _Wish, most: int, seed: int) -> tuple[list[tuple[Floats, int, SwingEnds]], int]:
    """Crank-rockers of a Sobol sequence that are nearest to the wish and differ; how many were looked at."""
    from scipy.stats import qmc

    draws = qmc.Sobol(5, seed=seed).random(SEARCHED)
    rows = np.ones((SEARCHED, 6))
    # a point reflection makes M positive
    rows[:, 0] = 4.0 * draws[:, 0]
    rows[:, [1, 5]] = 8.0 * draws[:, 1:3] - 4.0
    rows[:, [2, 3]] = 8.0 ** (2 * draws[:, 3:] - 1)
    inputs = np.linspace(0.0, math.tau, LOOKED_AT + 1)
    square = transmissions(rows, inputs).min(axis=1)
    rows, square = rows[square > MARGIN], square[square > MARGIN]
    ratio = np.abs(rows).max(axis=1) / rows[:, 2:5].min(axis=1)
    late = math.sin(wish.limits.transmission_lowest) - np.sqrt(square)
    missed = np.maximum(late, 0.0) + 0.1 * np.maximum(np.log(ratio / wish.limits.ratio), 0.0)
    scored: list[tuple[float, int, int]] = []
    for branch in (0, 1):
        angles = np.unwrap(outputs(rows, inputs, branch), axis=1)
        low, high = angles.argmin(axis=1), angles.argmax(axis=1)
        stroke = (inputs[high] - inputs[low]) % math.tau
        off = np.abs(np.maximum(stroke, math.tau - stroke) - wish.slow) / 2
        far = np.abs(np.ptp(angles, axis=1) - wish.swing) + off + missed
        rocks = np.abs(angles[:, -1] - angles[:, 0]) < 1.0
        scored += [(float(far[i]), int(i), branch) for i in np.flatnonzero(rocks)]
    chosen: list[tuple[Floats, int, SwingEnds]] = []
    seen: list[Floats] = []
    for _, i, branch in sorted(scored):
        own = np.abs(np.arctan(rows[i]))
        if any(np.abs(own - other).max() < START_APART for other in seen):
            continue
        ends = ends_of_swing(rows[i], branch)
        if ends is not None:
            seen.append(own)
            chosen.append((rows[i], branch, ends))
        if len(chosen) == most:
            break
    return chosen, SEARCHED


def _judged(
    wish: _Wish, row: Floats, branch: int, time_ratio: float, wanted_text: str
) -> tuple[float, Candidate | Refusal]:
    """A design as the ordinary analysis finds it, and how far from the wish it is [rad]."""
    ends, limits = ends_of_swing(row, branch), wish.limits
    if ends is None:
        return math.inf, Refusal("assembly", "the crank does not turn fully, or the output does not rock")
    far = abs(ends.swing - wish.swing) + abs(max(ends.stroke, math.tau - ends.stroke) - wish.slow)
    rows, zeros = reflected(row[None], np.zeros((1, 2)))
    row, turn = scaled(rows[0], limits.longest), zeros[0, 0]
    inputs = ends.crank[0] + turn + np.arange(LOOKED_AT) * math.tau / LOOKED_AT
    angles = outputs(row[None], inputs, branch)[0]
    claim = Claim(inputs, angles, np.array([ends.swing - wish.swing]), "deg", whole_turn=True)
    within = replace(limits, motion_type="crank-rocker")
    free = checked(draft_of(row, wanted_text), claim, Limits(motion_type="crank-rocker"))
    if isinstance(free, Refusal):
        return far, free
    circuit = free.draft.linkage.motion().circuits[free.circuit]
    reached, ratio = circuit.swing or 0.0, circuit.time_ratio or math.inf
    if abs(reached - wish.swing) > MET or abs(ratio - time_ratio) > MET:
        return far, Refusal("error", f"swing {math.degrees(reached):.4g} deg with time ratio {ratio:.4g}")
    figures = {
        "swing_deg": math.degrees(reached),
        "time_ratio": ratio,
        "input_at_low_deg": math.degrees((ends.crank[0] + turn) % math.tau),
        "input_at_high_deg": math.degrees((ends.crank[1] + turn) % math.tau),
    }
    return far, within_limits(replace(free, claim=replace(claim, figures=figures)), within)
