"""Free motion without losses: where it turns, whether it repeats itself, and the state at any time.

Between neighbouring marks of the course U rises or falls all the way, so the first mark where U is above the
energy has the turning point before it: none is missed. Between two turning points, or once round, the motion
repeats itself for ever.

Source: docs/theory_free.md, (6) to (10).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

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

#: The way is cut into so many for the first search of a turning point.
PARTS = 32

#: Most laps that are taken together.
MOST_AT_ONCE = 128

#: How a motion goes on.
Course = Literal["rotation", "oscillation", "rest", "asymptotic", "passing", "ends"]


@dataclass(frozen=True)
class Leg:
    """A run that begins at a time [s], upwards (way 1) or downwards, at `entry` [s] of its own time."""

    begin: float
    run: Run
    way: int
    entry: float

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.begin + (self.run.time - self.entry if self.way > 0 else self.entry)

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds at times (j,) [s]."""
        own = self.entry + self.way * (t - self.begin)
        place, speed = self.run.at(own)
        return place, self.way * speed


@dataclass(frozen=True, eq=False)
class Conservative:
    """The motion from a place with a speed: legs, and by `period` [s] again and again."""

    kind: Course
    legs: tuple[Leg, ...]
    period: float | None
    #: Places where it turns back, and those at which it arrives after an infinite time.
    turning: tuple[float, ...]
    #: What a period adds to the place.
    advance: float = 0.0
    rests_at: float = math.nan
    #: Towards a hill's top: its place, from when on only that counts, from where, and the rate [1/s].
    top: tuple[float, float, float, float] | None = field(default=None)

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
            mine = (t >= leg.begin) & (t <= leg.end)
            if mine.any():
                place[mine], speed[mine] = leg.at(t[mine])
        if self.top is not None:
            top, begin, off, rate = self.top
            late = t > begin
            left = off * np.exp(-rate * (t[late] - begin))
            place[late], speed[late] = top - left, rate * left
        elif self.legs and self.period is not None:
            late = t > self.legs[-1].end
            place[late], speed[late] = self.legs[-1].at(np.full(late.sum(), self.legs[-1].end))
        return place + rounds * self.advance, speed


def _whole(begin: float, run: Run, way: int) -> Leg:
    """A leg that is a whole run one way."""
    return Leg(begin, run, way, 0.0 if way > 0 else run.time)


def conservative(course: EnergyCourse, place: float, speed: float, duration: float) -> Conservative:
    """The motion from a place with s' = `speed`, for a time [s] at least."""
    mass, slope = (float(part[0]) for part in course.at(np.array([place]))[:2])
    rests = speed == 0.0
    if rests and abs(slope) <= BALANCED * course.steepest:
        return Conservative("rest", (), None, (), rests_at=place)
    rises = slope <= 0 if rests else speed > 0
    way = 1 if rises else -1
    seeker = _Seeker(course, (place, mass * speed**2 / 2))
    if not course.repeats:
        return _passing(seeker, place, way, duration, rests=rests)
    ahead = seeker.end(place, way, place + way * course.length)
    if ahead is None:
        low = min(place, place + way * course.length)
        leg = _whole(0.0, seeker.run(low, low + course.length), way)
        return Conservative("rotation", (leg,), leg.run.time, (), advance=way * course.length)
    behind = (place, "turn") if rests else seeker.end(place, -way, place - way * course.length)
    if ahead[1] == "top":
        return _to_the_top(seeker, place, way, ahead[0], ())
    assert behind is not None
    if behind[1] == "top":
        # it turns once and comes back for ever towards the other side
        low, high = sorted((place, ahead[0]))
        first = _whole(0.0, seeker.run(low, high, (way < 0, way > 0)), way)
        back = _whole(first.end, first.run, -way)
        return _to_the_top(seeker, place, -way, behind[0], (first, back), turned=ahead[0])
    return _swing(seeker, place, way, (ahead[0], behind[0]), at_end=place == behind[0])


def swing_between(
    course: EnergyCourse, place: float, speed: float
) -> tuple[Conservative, tuple[bool, bool]] | None:
    """The motion to and fro on an open course that is thrown back at its ends, and at which ends it turns.

    `None` where it rests, or comes ever nearer to a top.
    """
    mass, slope = (float(part[0]) for part in course.at(np.array([place]))[:2])
    rests = speed == 0.0
    if rests and abs(slope) <= BALANCED * course.steepest:
        return None
    way = 1 if (slope <= 0 if rests else speed > 0) else -1
    seeker = _Seeker(course, (place, mass * speed**2 / 2))
    ends, turns = [], []
    for towards, last in ((-1, 0.0), (1, course.length)):
        result = (place, "turn") if rests and towards != way else seeker.end(place, towards, last)
        if result is not None and result[1] == "top":
            return None
        ends.append(last if result is None else result[0])
        turns.append(result is not None)
    at_end = place == ends[0 if way > 0 else 1]
    both = turns[0], turns[1]
    return _swing(seeker, place, way, (ends[0], ends[1]), at_end=at_end, turns=both), both


def _swing(
    seeker: _Seeker,
    place: float,
    way: int,
    ends: tuple[float, float],
    *,
    at_end: bool,
    turns: tuple[bool, bool] = (True, True),
) -> Conservative:
    """A motion to and fro between two ends, from a place between them or `at_end`; it `turns` at them."""
    low, high = sorted(ends)
    run = seeker.run(low, high, turns)
    first = _whole(0.0, run, way) if at_end else Leg(0.0, run, way, run.time_at(place))
    back = _whole(first.end, run, -way)
    again = _whole(back.end, run, way)
    return Conservative("oscillation", (first, back, again), 2 * run.time, (low, high))


def _to_the_top(
    seeker: _Seeker, place: float, way: int, top: float, before: tuple[Leg, ...], turned: float | None = None
) -> Conservative:
    """A motion from a place, after some legs, that comes ever nearer to a top."""
    course = seeker.course
    course.refuse_massless(min(place, top), max(place, top))
    off = NEAR_TOP * course.length
    near = top - way * off
    begin = before[-1].end if before else 0.0
    legs = before
    if way * (near - place) > 0:
        low, high = sorted((place, near))
        # seen from the top, little energy loses no digits
        legs = (*before, _whole(begin, _Seeker(course, (top, 0.0)).run(low, high), way))
        begin = legs[-1].end
    step = 1e-4 * course.length
    slopes = course.slope(np.array([top - step, top + step]))
    curvature = float((slopes[1] - slopes[0]) / (2 * step))
    rate = math.sqrt(max(-curvature, 0.0) / float(course.at(np.array([top]))[0][0]))
    turning = (top,) if turned is None else (turned, top)
    return Conservative("asymptotic", legs, None, turning, top=(top, begin, way * off, rate))


def _passing(seeker: _Seeker, place: float, way: int, duration: float, *, rests: bool) -> Conservative:
    """A motion that no lap repeats: lap by lap until it turns twice, time is up, or the circuit ends."""
    course = seeker.course
    legs: list[Leg] = []
    here, time = place, 0.0
    # a start at rest is a turning point
    first_turn = place if rests else None
    ahead, laps = 1, 0
    while laps < MOST_LAPS:
        # a motion that goes faster and faster is taken by more and more laps
        aim = here + way * ahead * course.length if course.closed else (course.length if way > 0 else 0.0)
        laps, ahead = laps + ahead, min(2 * ahead, MOST_AT_ONCE)
        end = seeker.end(here, way, aim)
        if end is not None and end[1] == "turn" and first_turn is not None:
            return _swing(seeker, place, way if rests else -way, (first_turn, end[0]), at_end=rests)
        if end is not None and end[1] == "top":
            return _to_the_top(seeker, here, way, end[0], tuple(legs), first_turn)
        stop = aim if end is None else end[0]
        turns = (here == first_turn and not (rests and legs), end is not None)
        low, high = sorted((here, stop))
        legs.append(_whole(time, seeker.run(low, high, turns if way > 0 else turns[::-1]), way))
        time, here = legs[-1].end, stop
        if end is not None and time < duration:
            first_turn, way, ahead = here, -way, 1
        elif time >= duration or not course.closed:
            kind: Course = "passing" if time >= duration else "ends"
            return Conservative(kind, tuple(legs), None, () if first_turn is None else (first_turn,))
    raise RequestError(
        f"duration: the motion goes round more than {MOST_LAPS} times and repeats nothing; give a shorter one"
    )


class _Seeker:
    """Finds where a motion of known energy ends; `reference` is a place and T there [J]."""

    def __init__(self, course: EnergyCourse, reference: tuple[float, float]) -> None:
        self.course, self.reference = course, reference

    def run(self, low: float, high: float, turns: tuple[bool, bool] = (False, False)) -> Run:
        """The run between two places, of which it may turn at either."""
        return run_between(self.course, low, high, turns, self.reference)

    def kinetic(self, s: Floats) -> Floats:
        """T (j,) [J] at places (j,); below zero where the motion does not come."""
        return np.asarray(self.reference[1] - self.course.rise(self.reference[0], s))

    def end(self, place: float, way: int, aim: float) -> tuple[float, str] | None:
        """The first place from here to `aim` where it turns ("turn"), or that it never reaches ("top")."""
        course = self.course
        first, last = np.sort(course.laps(np.array([place, aim])))
        laps = np.arange(first - 1, last + 2) if course.closed else np.zeros(1)
        marks = course.marks(laps)
        inside = marks[(way * (marks - place) > 1e-13 * course.length) & (way * (aim - marks) > 0)]
        ordered = np.append(inside[::way], aim)
        if not course.closed:
            ordered = ordered[way * (ordered - place) > 0]
        if not ordered.size:
            return None
        kinetic = self.kinetic(ordered)
        scale = max(float(np.abs(kinetic).max()), self.reference[1])
        slopes = np.abs(course.slope(ordered))
        flat = slopes <= 1e-9 * course.steepest
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
        for _ in range(200):
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
