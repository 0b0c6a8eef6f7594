"""Free motion without losses: where it turns, whether it repeats itself, and the state at any time.

Between neighbouring marks of the course U rises or falls all the way, so the first mark where U is above the
energy has the turning point before it: none is missed. Between two turning points, or once round, the motion
repeats itself for ever.

Source: docs/theory_free.md, (6) to (10).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.forces.free_motion.course import EnergyCourse
from sevenbar.forces.free_motion.runs import Run, run_between

#: Where the energy meets a hill's top to this part of the greatest T, it is reached after an infinite time.
JUST = 1e-13

#: How near [parts of the lap] to such a top the exponential law takes over.
NEAR_TOP = 1e-6

#: A slope of U below this part of its greatest is that of an equilibrium.
BALANCED = 1e-13

#: Most laps of a motion that does not repeat itself.
MOST_LAPS = 20_000

#: Nearer than this [parts of the lap] to where a motion starts is no mark on its course.
HERE = 1e-13

#: U' below this part of its greatest is zero at a mark: more than BALANCED, as a mark is itself computed.
LEVEL = 1e-9

#: How far [parts of the lap] to both sides of a top the slopes are taken that give its curvature.
CURVATURE_STEP = 1e-4

#: The course is cut into so many for the first search of a turning point.
PARTS = 32

#: Most steps of Newton's method, or halvings, to a turning point.
STEPS = 200

#: Most laps that are taken together.
MOST_AT_ONCE = 128

#: How a motion goes on, for ever or until the time is up.
MotionKind = Literal["rotation", "oscillation", "rest", "asymptotic", "passing", "ends"]


@dataclass(frozen=True)
class Leg:
    """A run that starts at a time [s], upwards (direction 1) or downwards (-1), at `entry` [s] of the run."""

    start: float
    run: Run
    direction: int
    entry: float

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.start + (self.run.time - self.entry if self.direction > 0 else self.entry)

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds at times (j,) [s]."""
        place, speed = self.run.at(self.entry + self.direction * (t - self.start))
        return place, self.direction * speed


class Approach(NamedTuple):
    """How a motion comes ever nearer to a hill's top: `top - offset exp(-rate (t - start))` from a time on.

    `top` is its place, `start` [s] when the motion is so near that the exponential law takes over, `offset`
    how far before the top it then is, with its sign, and `rate` [1/s].
    """

    top: float
    start: float
    offset: float
    rate: float


@dataclass(frozen=True, eq=False)
class Conservative:
    """The motion from a place with a speed: legs, and by `period` [s] again and again."""

    kind: MotionKind
    legs: tuple[Leg, ...]
    period: float | None
    #: Places where it turns back, and those at which it arrives after an infinite time.
    turning: tuple[float, ...]
    #: What a period adds to the place.
    advance: float = 0.0
    rests_at: float = math.nan
    approach: Approach | None = None

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds s' (j,) at times (j,) [s]; NaN past the end of an open circuit."""
        t = np.asarray(t, dtype=np.float64)
        if self.kind == "rest":
            return np.full(t.shape, self.rests_at), np.zeros(t.shape)
        rounds = np.zeros(t.shape)
        if self.period is not None:
            rounds = np.floor(t / self.period)
            t = t - rounds * self.period
        place, speed = np.full(t.shape, np.nan), np.full(t.shape, np.nan)
        for leg in self.legs:
            on_leg = (t >= leg.start) & (t <= leg.end)
            if on_leg.any():
                place[on_leg], speed[on_leg] = leg.at(t[on_leg])
        if self.approach is not None:
            top, start, offset, rate = self.approach
            late = t > start
            remaining = offset * np.exp(-rate * (t[late] - start))
            place[late], speed[late] = top - remaining, rate * remaining
        elif self.legs and self.period is not None:
            # by rounding the legs may end before the period does
            late = t > self.legs[-1].end
            place[late], speed[late] = self.legs[-1].at(np.full(late.sum(), self.legs[-1].end))
        return place + rounds * self.advance, speed


def _whole(start: float, run: Run, direction: int) -> Leg:
    """A leg that is a whole run in one direction."""
    return Leg(start, run, direction, 0.0 if direction > 0 else run.time)


def _started(course: EnergyCourse, place: float, speed: float) -> tuple[_Seeker, int]:
    """What finds where a motion ends, and its first direction: 1, -1, or 0 at rest in an equilibrium."""
    mass, slope = (float(part[0]) for part in course.at(np.array([place]))[:2])
    if speed:
        direction = 1 if speed > 0 else -1
    elif abs(slope) <= BALANCED * course.steepest:
        direction = 0
    else:
        direction = 1 if slope <= 0 else -1
    return _Seeker(course, (place, mass * speed**2 / 2)), direction


def conservative(course: EnergyCourse, place: float, speed: float, duration: float) -> Conservative:
    """The motion from a place with s' = `speed`, for a time [s] at least."""
    seeker, direction = _started(course, place, speed)
    if not direction:
        return Conservative("rest", (), None, (), rests_at=place)
    rests = speed == 0.0
    if not course.repeats:
        return _passing(seeker, place, direction, duration, rests=rests)
    ahead = seeker.end(place, direction, place + direction * course.length)
    if ahead is None:
        low = min(place, place + direction * course.length)
        leg = _whole(0.0, seeker.run(low, low + course.length), direction)
        return Conservative("rotation", (leg,), leg.run.time, (), advance=direction * course.length)
    behind = (place, "turn") if rests else seeker.end(place, -direction, place - direction * course.length)
    if ahead[1] == "top":
        return _to_the_top(seeker, place, direction, ahead[0], ())
    # U repeats itself, so a hill that stops the motion ahead is behind it, too
    assert behind is not None
    if behind[1] == "top":
        # it turns once and comes back for ever towards the other side
        low, high = sorted((place, ahead[0]))
        first = _whole(0.0, seeker.run(low, high, (direction < 0, direction > 0)), direction)
        back = _whole(first.end, first.run, -direction)
        return _to_the_top(seeker, place, -direction, behind[0], (first, back), turned=ahead[0])
    return _swing(seeker, place, direction, (ahead[0], behind[0]), at_end=place == behind[0])


def swing_between(
    course: EnergyCourse, place: float, speed: float
) -> tuple[Conservative, tuple[bool, bool]] | None:
    """The motion to and fro on an open course that is thrown back at its ends, and at which ends it turns.

    `None` where it rests, or comes ever nearer to a top.
    """
    seeker, direction = _started(course, place, speed)
    if not direction:
        return None
    rests = speed == 0.0
    ends, turns = [], []
    for towards, last in ((-1, 0.0), (1, course.length)):
        result = (place, "turn") if rests and towards != direction else seeker.end(place, towards, last)
        if result is not None and result[1] == "top":
            return None
        ends.append(last if result is None else result[0])
        turns.append(result is not None)
    at_end = place == ends[0 if direction > 0 else 1]
    both = turns[0], turns[1]
    return _swing(seeker, place, direction, (ends[0], ends[1]), at_end=at_end, turns=both), both


def _swing(
    seeker: _Seeker,
    place: float,
    direction: int,
    ends: tuple[float, float],
    *,
    at_end: bool,
    turns: tuple[bool, bool] = (True, True),
) -> Conservative:
    """A motion to and fro between two ends, from a place between them or `at_end`; it `turns` at them."""
    low, high = sorted(ends)
    run = seeker.run(low, high, turns)
    first = _whole(0.0, run, direction) if at_end else Leg(0.0, run, direction, run.time_at(place))
    back = _whole(first.end, run, -direction)
    again = _whole(back.end, run, direction)
    return Conservative("oscillation", (first, back, again), 2 * run.time, (low, high))


def _to_the_top(
    seeker: _Seeker,
    place: float,
    direction: int,
    top: float,
    before: tuple[Leg, ...],
    turned: float | None = None,
) -> Conservative:
    """A motion from a place, after some legs, that comes ever nearer to a top."""
    course = seeker.course
    course.refuse_massless(min(place, top), max(place, top))
    offset = direction * NEAR_TOP * course.length
    near = top - offset
    start = before[-1].end if before else 0.0
    legs = before
    if direction * (near - place) > 0:
        low, high = sorted((place, near))
        # seen from the top, little energy loses no digits
        legs = (*before, _whole(start, _Seeker(course, (top, 0.0)).run(low, high), direction))
        start = legs[-1].end
    step = CURVATURE_STEP * course.length
    slopes = course.slope(np.array([top - step, top + step]))
    curvature = float((slopes[1] - slopes[0]) / (2 * step))
    rate = math.sqrt(max(-curvature, 0.0) / float(course.at(np.array([top]))[0][0]))
    turning = (top,) if turned is None else (turned, top)
    return Conservative("asymptotic", legs, None, turning, approach=Approach(top, start, offset, rate))


def _passing(seeker: _Seeker, place: float, direction: int, duration: float, *, rests: bool) -> Conservative:
    """A motion that no lap repeats: lap by lap until it turns twice, time is up, or the circuit ends."""
    course = seeker.course
    legs: list[Leg] = []
    here, time = place, 0.0
    # a start at rest is a turning point
    first_turn = place if rests else None
    ahead, laps = 1, 0
    while laps < MOST_LAPS:
        # a motion that goes faster and faster is taken by more and more laps
        aim = (
            here + direction * ahead * course.length
            if course.closed
            else (course.length if direction > 0 else 0.0)
        )
        laps, ahead = laps + ahead, min(2 * ahead, MOST_AT_ONCE)
        end = seeker.end(here, direction, aim)
        if end is not None and end[1] == "turn" and first_turn is not None:
            return _swing(
                seeker, place, direction if rests else -direction, (first_turn, end[0]), at_end=rests
            )
        if end is not None and end[1] == "top":
            return _to_the_top(seeker, here, direction, end[0], tuple(legs), first_turn)
        stop = aim if end is None else end[0]
        turns = (here == first_turn and not (rests and legs), end is not None)
        low, high = sorted((here, stop))
        legs.append(_whole(time, seeker.run(low, high, turns if direction > 0 else turns[::-1]), direction))
        time, here = legs[-1].end, stop
        if end is not None and time < duration:
            first_turn, direction, ahead = here, -direction, 1
        elif time >= duration or not course.closed:
            kind: MotionKind = "passing" if time >= duration else "ends"
            return Conservative(kind, tuple(legs), None, () if first_turn is None else (first_turn,))
    raise RequestError(
        f"duration: the motion goes round more than {MOST_LAPS} times and repeats nothing; give a shorter one"
    )


class _Seeker:
    """Finds where a motion of known energy turns or ends; `reference` is a place and T there [J]."""

    def __init__(self, course: EnergyCourse, reference: tuple[float, float]) -> None:
        self.course, self.reference = course, reference

    def run(self, low: float, high: float, turns: tuple[bool, bool] = (False, False)) -> Run:
        """The run between two places, of which it may turn at either."""
        return run_between(self.course, low, high, turns, self.reference)

    def kinetic(self, s: Floats) -> Floats:
        """T (j,) [J] at places (j,); below zero where the motion does not come."""
        return np.asarray(self.reference[1] - self.course.rise(self.reference[0], s))

    def end(self, place: float, direction: int, aim: float) -> tuple[float, str] | None:
        """The first place from here to `aim` where it turns ("turn"), or that it never reaches ("top")."""
        course = self.course
        first, last = np.sort(course.laps(np.array([place, aim])))
        laps = np.arange(first - 1, last + 2) if course.closed else np.zeros(1)
        marks = course.marks(laps)
        inside = marks[(direction * (marks - place) > HERE * course.length) & (direction * (aim - marks) > 0)]
        ordered = np.append(inside[::direction], aim)
        if not course.closed:
            ordered = ordered[direction * (ordered - place) > 0]
        if not ordered.size:
            return None
        kinetic = self.kinetic(ordered)
        scale = max(float(np.abs(kinetic).max()), self.reference[1])
        slopes = np.abs(course.slope(ordered))
        flat = slopes <= LEVEL * course.steepest
        for i, (height, level) in enumerate(zip(kinetic, flat, strict=True)):
            if level and abs(height) <= JUST * scale:
                return float(ordered[i]), "top"
            if height < 0 or (height == 0 and not level):
                start = place if i == 0 else float(ordered[i - 1])
                return self._zero(start, float(ordered[i])), "turn"
        return None

    def _zero(self, inside: float, outside: float) -> float:
        """Where T is zero between a place that is reached and one that is not."""
        fine = inside + (outside - inside) * np.arange(PARTS + 1) / PARTS
        beyond = np.flatnonzero(self.kinetic(fine[1:-1]) < 0)
        first = int(beyond[0]) + 1 if beyond.size else PARTS
        inside, outside = float(fine[first - 1]), float(fine[first])
        ends = self.kinetic(np.array([inside, outside]))
        at = inside + (outside - inside) * float(np.clip(ends[0] / (ends[0] - ends[1]), 0.0, 1.0))
        for _ in range(STEPS):
            here = np.array([at])
            height, slope = float(self.kinetic(here)[0]), -float(self.course.slope(here)[0])
            if height > 0:
                inside = at
            else:
                outside = at
            step = at - height / slope if slope else math.inf
            after = step if min(inside, outside) < step < max(inside, outside) else (inside + outside) / 2
            if abs(after - at) <= 4 * np.spacing(abs(at)):
                return after
            at = after
        return at
