"""The best linkages of a survey made better with exact slopes, and checked by the ordinary analysis.

Unknown are the numbers that have a range, the input's start, and where they count the output's zero and the
seats of both balls. By linear programs (`programs`) the greatest error is made least, or the least
transmission angle or the greatest ball angle as good as can be with what is wanted met, to which Newton's
steps bring each trial back; bounds and limits are inequalities. A linkage that ends worse than it began, or
whose new form fails the check, stays as it was drawn.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.least_cone import half_angle
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import Candidate, Claim, Refusal, checked
from sevenbar.design.limits import Limits
from sevenbar.design.search import Designs, DesignSearch
from sevenbar.design.survey.skew_closure import (
    ANGLE,
    COUNT,
    L1,
    L2,
    L3,
    START,
    Poses,
    Values,
    poses,
)
from sevenbar.design.survey.tally import Kept, SurveyTally
from sevenbar.design.survey.task import SurveyTask, SwingWish, Travel, drawn_numbers, scale_of
from sevenbar.design.task.programs import MinimaxValues, lowered
from sevenbar.kinematics.solvers.batches import NUMBERS
from sevenbar.text.progress import Progress

#: Inputs at which a polished design is measured, over its range or over a turn.
DENSE = 361

#: Inputs of a whole turn at which a polished swing is measured.
TURN = 72

#: Room that is left at each limit for what lies between the inputs measured.
MARGIN = 1e-4

#: Gain of a figure, relative to it, that is not worth another program.
WORTH = 3e-3

#: Part of its mean step that an output makes at least where it must move one way.
STEADY = 0.05

#: Newton's steps on what is to be met exactly, and the error [rad] with which they have arrived.
MOST_NEWTON, MET = 8, 1e-13

#: By how much a limit may be missed through rounding [rad].
ROUNDING = 1e-9

#: How many of the best are polished for each design that is wanted.
POLISHED_EACH = 4

#: The seats of both balls, three numbers each.
SEATS = 6

#: Each link with each other length, of which it must be so much of a part.
LINKS, OTHERS = np.array([(link, other) for link in (L1, L2, L3) for other in range(6) if other != link]).T

#: A step whose square is nothing: slopes by it are right to rounding.
TINY = 1e-30


class Polish:
    """A linkage of a survey as unknowns z: free numbers and start, the output's zero, both seats."""

    def __init__(
        self, task: SurveyTask, numbers: Floats, branch: int, sense: float = 1.0, *, worth: float = WORTH
    ) -> None:
        self.task, self.numbers, self.branch, self.sense, self.worth = task, numbers, branch, sense, worth
        table = np.array(list(task.table.values()))
        self.free = np.append(np.flatnonzero(table[:, 1] > table[:, 0]), START)
        self.low = np.append(table[:, 0], -np.inf)[self.free]
        self.high = np.append(table[:, 1], np.inf)[self.free]
        self.inputs, self.wanted = task.readings
        self.balls = task.ball_angle < math.pi or task.rank == "ball angle"
        self.exactly = isinstance(task.want, Travel | SwingWish)
        # where what is met exactly ends: a travel, or a swing whose low end is at the start
        self.end = len(self.inputs) - 1
        if isinstance(task.want, SwingWish):
            turn = np.arange(TURN) * math.tau / TURN
            stroke = self._stroke(turn)
            self.inputs = np.sort(np.append(turn, stroke))
            self.end = int(np.searchsorted(self.inputs, stroke))

    def _stroke(self, turn: Floats) -> float:
        """The turn of the input to the high end: the slower stroke, or the quicker, by which is nearer."""
        assert isinstance(self.task.want, SwingWish)
        slow = self.task.want.slow
        result = poses(self.numbers, turn, self.branch)
        if result is None:
            return slow
        high = turn[result.output.argmax()]
        return slow if abs(high - slow) <= abs(math.tau - high - slow) else math.tau - slow

    def packed(self) -> Floats | None:
        """The unknowns at the start; `None` where a pose is out of reach."""
        now = poses(self.numbers, self.inputs, self.branch)
        if now is None:
            return None
        parts = [self.numbers[self.free]]
        # an unknown that nothing follows would go as far as a step may
        if not self.exactly:
            off = self.sense * now.output - self.wanted
            parts.append(np.array([(off.max() + off.min()) / 2]))
        if self.balls:
            seats = [direction.mean(axis=0) for direction in (now.crank, now.rocker)]
            parts += [seat / max(float(np.linalg.norm(seat)), 1e-9) for seat in seats]
        return np.concatenate(parts)

    def unpacked(self, z: Values) -> Values:
        """The numbers (.., 8) of unknowns (.., z)."""
        numbers = np.broadcast_to(self.numbers, (*z.shape[:-1], COUNT)).astype(z.dtype)
        numbers[..., self.free] = z[..., : len(self.free)]
        return numbers

    def met(self, z: Floats) -> tuple[Floats, ...] | None:
        """What is to be zero (m,) and its slopes (m, z): the travel, or the ends of a swing."""
        return _sloped(self._met, z)

    def _met(self, z: Values) -> tuple[Values] | None:
        now = poses(self.unpacked(z), self.inputs[: self.end + 1], self.branch)
        return None if now is None else (self._off(now),)

    def _off(self, now: Poses) -> Values:
        """What is to be zero (.., m) at poses."""
        output = now.output[..., self.end] - now.output[..., 0]
        if isinstance(self.task.want, Travel):
            return np.asarray(self.sense * output - self.wanted[-1])[..., None]
        if isinstance(self.task.want, SwingWish):
            ends = now.still[..., 0], now.still[..., self.end], output - self.task.want.angle
            return np.stack(ends, axis=-1)
        return now.output[..., :0]

    def values(self, z: Floats) -> MinimaxValues | None:
        """What is to be made low and what must not be negative; `None` out of reach."""
        result = _sloped(self._values, z)
        return None if result is None else MinimaxValues(*result)

    def _values(self, z: Values) -> tuple[Values, Values] | None:
        """Heights (.., h) and rooms (.., r) of unknowns (.., z)."""
        numbers, task = self.unpacked(z), self.task
        now = poses(numbers, self.inputs, self.branch) if (numbers[..., LINKS].real > 0).all() else None
        if now is None:
            return None
        heights = {"transmission": 1.0 - now.square}
        rooms = [now.square - max(math.sin(task.transmission_lowest) ** 2, MARGIN) - MARGIN]
        if self.balls:
            cosines = self._cosines(now, z)
            heights["ball angle"] = 1.0 - cosines
            limit = math.cos(task.ball_angle)
            rooms.append(cosines - limit - (MARGIN if limit > -1 else 0.0))
        if not self.exactly:
            off = self.sense * now.output - self.wanted - z[..., len(self.free), None]
            heights["error"] = np.concatenate([off, -off], axis=-1)
            if task.rank != "error":
                rooms.append(task.tolerance * (1 - MARGIN) - heights["error"])
        if isinstance(task.want, Travel):
            way = self.sense * math.copysign(1.0, task.want.output)
            least = STEADY * abs(task.want.output) / len(self.inputs)
            rooms.append(way * np.diff(now.output) - least)
        off = self._off(now)
        own, low, high = z[..., : len(self.free)], np.isfinite(self.low), np.isfinite(self.high)
        rooms += [off, -off, (own - self.low)[..., low], (self.high - own)[..., high]]
        # the ratio of lengths
        others = numbers[..., OTHERS]
        rooms.append(numbers[..., LINKS] - others * np.copysign(1.0, others.real) / task.ratio)
        return heights.get(task.rank, heights["transmission"]), np.concatenate(rooms, axis=-1)

    def _cosines(self, now: Poses, z: Values) -> Values:
        """The cosines (.., 2k) of both balls' angles from their seats."""
        result = []
        for direction, seat in ((now.crank, z[..., -SEATS:-3]), (now.rocker, z[..., -3:])):
            size = np.sqrt((seat**2).sum(axis=-1, keepdims=True))
            result.append((direction * (seat / size)[..., None, :]).sum(axis=-1))
        return np.concatenate(result, axis=-1)

    def exact(self, z: Floats) -> Floats:
        """The unknowns near by that meet the travel or the swing to rounding, by Newton's shortest steps.

        The same unknowns where a function is wanted, or where Newton's steps lead nowhere.
        """
        own, near = slice(0, len(self.free)), z.copy()
        for _ in range(MOST_NEWTON if self.exactly else 0):
            near[own] = np.clip(near[own], self.low, self.high)
            met = self.met(near)
            if met is None:
                break
            off, slopes = met
            if np.abs(off).max() < MET:
                return near
            # what is at a bound stays there
            slopes[:, own][:, (near[own] <= self.low) | (near[own] >= self.high)] = 0.0
            near = near - np.linalg.lstsq(slopes, off, rcond=None)[0]
        return z

    def polished(self) -> Floats:
        """The numbers (8,) of the better linkage; those it began with where none is found."""
        z = self.packed()
        if z is None:
            return self.numbers
        # the ends of a swing bend away from a step, a travel hardly does
        mended = self.exact if isinstance(self.task.want, SwingWish) else np.copy
        return self.unpacked(self.exact(lowered(self.values, z, worth=self.worth, mended=mended)))


def _sloped(function: Callable[[Values], tuple[Values, ...] | None], z: Floats) -> tuple[Floats, ...] | None:
    """Each of the values (r,) of a function of unknowns, and its slopes (r, z), by a tiny complex step."""
    result = function(z + 1j * TINY * np.eye(len(z)))
    if result is None:
        return None
    return tuple(own for values in result for own in (values[0].real, values.imag.T / TINY))


def draft_of(numbers: Floats, branch: int, sense: float, name: str) -> Draft:
    """A description of a linkage in the pose where its readings start: both joints are at zero there."""
    first = poses(numbers, np.zeros(1), branch)
    assert first is not None
    m, n, l1, _, l3, d = (numbers[:6] * scale_of(numbers)).tolist()
    crank, rocker, axis = first.crank_frame[0][0], first.rocker_frame[0][0], first.rocker_frame[2][0]
    ground, hinge = np.array([0.0, 0.0, n]), m * axis + [0.0, d, 0.0]
    joints = [
        {"name": "crank", "kind": "R", "at": ground.tolist(), "axis": [0.0, 0.0, 1.0]},
        {"name": "A", "kind": "S", "at": (ground + l1 * crank).tolist()},
        {"name": "B", "kind": "S", "at": (hinge + l3 * rocker).tolist()},
        {"name": "rocker", "kind": "R", "at": hinge.tolist(), "axis": (sense * axis + 0.0).tolist()},
    ]
    return Draft.made(name, "mm", drive={"joint": "crank", "output": "rocker"}, joint=joints)


def judged(task: SurveyTask, numbers: Floats, kept: Kept) -> Candidate | Refusal:
    """A linkage (8,) as the ordinary analysis finds it, with the figures of the survey measured densely."""
    whole = isinstance(task.want, SwingWish)
    inputs, _ = task.readings
    span = math.tau if whole else float(inputs[-1])
    dense = np.linspace(0.0, span, DENSE)[: DENSE - whole]
    if not whole and not isinstance(task.want, Travel):
        dense = np.union1d(dense, inputs)
    found = poses(numbers, dense, kept.branch)
    if found is None:
        return Refusal("assembly", "cannot reach the whole range of the input")
    angles = kept.sense * (found.output - found.output[0])
    errors, reached = _errors(task, dense, angles)
    if flaw := _too_far(task, float(np.abs(errors).max())):
        return flaw
    lowest = math.asin(math.sqrt(min(float(found.square.min()), 1.0)))
    if lowest < task.transmission_lowest - ROUNDING:
        wish = math.degrees(task.transmission_lowest)
        return Refusal(
            "transmission", f"transmission angle down to {math.degrees(lowest):.4g} deg, {wish:g} required"
        )
    balls = [half_angle(directions) for directions in (found.crank, found.rocker)]
    if max(balls) > task.ball_angle + ROUNDING:
        wish = math.degrees(task.ball_angle)
        return Refusal("cone", f"a ball turns {math.degrees(max(balls)):.4g} deg, {wish:g} allowed")
    names = (f"{name}_ratio" if name != "angle" else "axes_deg" for name in NUMBERS)
    values = (*numbers[:6], math.degrees(numbers[ANGLE]))
    figures = {
        **reached,
        "ball_crank_deg": math.degrees(balls[0]),
        "ball_rocker_deg": math.degrees(balls[1]),
        **dict(zip(names, map(float, values), strict=True)),
    }
    claim = Claim(dense, angles, errors, "deg", figures, whole_turn=whole)
    draft = draft_of(numbers, kept.branch, kept.sense, task.want.title)
    limits = Limits(motion_type="crank-rocker" if whole else task.motion_type)
    result = checked(draft, claim, limits)
    if isinstance(result, Refusal):
        return result
    result = replace(result, transmission_lowest=lowest)
    if isinstance(task.want, SwingWish):
        result = swung(task.want, result)
        # of its strokes, too
        return _too_far(task, result.error_greatest) or result
    return result


def _too_far(task: SurveyTask, error: float) -> Refusal | None:
    """The refusal of a greatest error [rad]; `None` within the tolerance."""
    if error <= task.tolerance + ROUNDING:
        return None
    return Refusal(
        "error", f"greatest error {math.degrees(error):.3g} deg, {math.degrees(task.tolerance):g} deg allowed"
    )


def swung(want: SwingWish, result: Candidate) -> Candidate:
    """A crank-rocker with the swing and the time ratio that its circuit has, exactly."""
    circuit = result.draft.linkage.motion().circuits[result.circuit]
    assert circuit.angle is not None
    swing, ratio = circuit.swing or 0.0, circuit.time_ratio or math.inf
    late = abs(math.tau / (1 + 1 / ratio) - want.slow)
    error = max(abs(swing - want.angle), late)
    figures = {
        **result.claim.figures,
        "swing_deg": math.degrees(swing),
        "time_ratio": ratio,
        "input_at_low_deg": math.degrees(circuit.angle.lowest_at % math.tau),
        "input_at_high_deg": math.degrees(circuit.angle.highest_at % math.tau),
    }
    return replace(result, claim=replace(result.claim, figures=figures, errors=np.array([error])))


def _errors(task: SurveyTask, dense: Floats, angles: Floats) -> tuple[Floats, dict[str, float]]:
    """The errors [rad] over a range or a turn, the output's zero chosen, and figures of the task."""
    want = task.want
    if isinstance(want, SwingWish):
        return np.array([np.ptp(angles) - want.angle]), {}
    if isinstance(want, Travel):
        miss = float(angles[-1]) - want.output
        back = np.diff(angles) * math.copysign(1.0, want.output) < -ROUNDING
        return np.array([math.inf if back.any() else miss]), {"travel_deg": math.degrees(float(angles[-1]))}
    if want.function is None:
        off = np.interp(want.input - want.input[0], dense, angles) - want.output
    else:
        off = angles - np.asarray(want.function(want.input[0] + dense))
    zero = float(off.max() + off.min()) / 2
    # as drawn the joints are at zero where the readings start
    zeros = {"input_zero_deg": 0.0 - math.degrees(want.input[0]), "output_zero_deg": math.degrees(zero)}
    return off - zero, zeros


def designs(
    task: SurveyTask, tally: SurveyTally, count: int, progress: Progress
) -> tuple[Designs[Candidate], int]:
    """The best of a survey as designs, and how many became better by polishing.

    A second Ctrl+C, or one while polishing, ends it with what is there.
    """
    best = tally.best[: POLISHED_EACH * count]
    search: DesignSearch[Candidate] = DesignSearch(len(best), progress, count=count)
    better = 0

    def solve(start: tuple[Kept, Floats]) -> tuple[float, Candidate | Refusal]:
        nonlocal better
        selected, numbers = start
        drawn = np.append(numbers, selected.start)
        new = judged(task, Polish(task, drawn, selected.branch, selected.sense).polished(), selected)
        if isinstance(new, Refusal):
            new = judged(task, drawn, selected)
        else:
            better += 1
        return (0.0 if isinstance(new, Refusal) else rank_of(task, new)), new

    with search.until_stopped(search.checked, fewest=0):
        rows = drawn_numbers(task, [selected.index for selected in best])
        search.over(zip(best, rows, strict=True), solve, lambda result: f"polishing, {len(result)} checked")
    return search.result(task.want.title), better


def rank_of(task: SurveyTask, candidate: Candidate) -> float:
    """The figure by which designs are sorted: less is better."""
    figures = candidate.claim.figures
    if task.rank == "ball angle":
        return max(figures["ball_crank_deg"], figures["ball_rocker_deg"])
    if task.rank == "error" and not isinstance(task.want, Travel | SwingWish):
        return candidate.error_greatest
    return -(candidate.transmission_lowest or 0.0)
