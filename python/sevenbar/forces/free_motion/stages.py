"""A motion between stops: flight after flight, each ended by a stop that throws it back or holds it.

Newton's law of impact on one freedom: at a stop the rate s' becomes

    s' -> -e s',    0 <= e <= 1                                                                          (14)

and what is left of the kinetic energy is its part e^2. At rest on a stop it stays there as long as what acts
presses it against the stop.

Source: docs/theory_free.md, (14).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.forces.free_motion.conservative import BALANCED, conservative, swing_between
from sevenbar.forces.free_motion.course import SAME, EnergyCourse
from sevenbar.forces.free_motion.driven import PUSH, Motor, driven, force_at

#: A rebound with less than this part of the greatest kinetic energy at a stop is none: what is left of the
#: time of ever shorter flights is 1e-5 of the first one, and they become shorter than places are known.
RESTS = 1e-10

#: Most times that a motion meets its stops.
MOST_IMPACTS = 10_000


class Flight(Protocol):
    """A motion until it meets a stop: places and speeds s' (j,) at times (j,) [s] from its beginning."""

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds."""


@dataclass(frozen=True)
class Walls:
    """The stops at the beginning and at the end of an open course; empty where the circuit itself ends."""

    first: str
    last: str
    restitution: float = 0.0

    @property
    def none(self) -> bool:
        """Whether there are none."""
        return not (self.first or self.last)

    def at(self, place: float, course: EnergyCourse) -> tuple[str, int]:
        """The stop at a place and the way to it, -1 or 1; no stop and 0 where there is none."""
        near = SAME * course.length
        if self.first and place <= near:
            return self.first, -1
        return (self.last, 1) if self.last and place >= course.length - near else ("", 0)


@dataclass(frozen=True)
class StopMet:
    """A stop that is met: when [s], where, and with what rate s' before."""

    time: float
    place: float
    stop: str
    rate: float


@dataclass(frozen=True, eq=False)
class Held:
    """A place at which a stop holds the motion."""

    place: float

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """The place, and no speed."""
        return np.full(np.shape(t), self.place), np.zeros(np.shape(t))


@dataclass(frozen=True, eq=False)
class Stages:
    """Flights and rests one after the other: each with its beginning [s] and the energy [J] lost before."""

    begins: Floats
    flights: tuple[Flight, ...]
    #: How long [s] each lasts, the last for ever.
    lasting: Floats
    lost: Floats
    met: tuple[StopMet, ...]
    #: How the last one goes on, its period and turning points.
    kind: str
    period: float | None = None
    turning: tuple[float, ...] = ()

    def _which(self, t: Floats) -> npt.NDArray[np.int64]:
        return np.clip(np.searchsorted(self.begins, t, "right") - 1, 0, len(self.flights) - 1)

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds s' (j,) at times (j,) [s]."""
        t = np.asarray(t, dtype=np.float64)
        if len(self.flights) == 1:
            return self.flights[0].at(t)
        place, speed = np.empty(t.shape), np.empty(t.shape)
        which = self._which(t)
        for number in np.unique(which):
            mine = which == number
            own = np.minimum(t[mine] - self.begins[number], self.lasting[number])
            place[mine], speed[mine] = self.flights[number].at(own)
        return place, speed

    def rests(self, t: Floats) -> npt.NDArray[np.bool_]:
        """Whether a stop holds it at times (j,) [s]."""
        held = np.array([isinstance(flight, Held) for flight in self.flights])
        return np.asarray(held[self._which(np.asarray(t, dtype=np.float64))])

    def lost_at(self, t: Floats) -> Floats:
        """The energy [J] that stops have taken by times (j,) [s]."""
        return np.asarray(self.lost[self._which(np.asarray(t, dtype=np.float64))])


@dataclass(frozen=True, eq=False)
class _Flown:
    """A flight, when it meets the end of the course (infinite where it does not), and how it goes on."""

    flight: Flight
    time: float
    kind: str
    period: float | None = None
    turning: tuple[float, ...] = ()


#: A flight from a place with a rate s' at a time, for the rest of the time [s].
Fly = Callable[[float, float, float, float], _Flown]


def without_losses(course: EnergyCourse) -> Fly:
    """Flights that keep their energy."""

    def fly(place: float, speed: float, _begin: float, duration: float) -> _Flown:
        result = conservative(course, place, speed, duration)
        time = result.legs[-1].end if result.kind == "ends" else math.inf
        return _Flown(result, time, result.kind, result.period, result.turning)

    return fly


def stepped(course: EnergyCourse, motor: Motor | None, tolerance: float) -> Fly:
    """Flights with dampers or a motor."""

    def fly(place: float, speed: float, begin: float, duration: float) -> _Flown:
        result = driven(course, place, speed, duration, motor, tolerance, begin=begin)
        time = float(result.states.edges[-1]) if result.ended else math.inf
        return _Flown(result, time, "ends" if result.ended else "driven")

    return fly


def staged(
    course: EnergyCourse,
    walls: Walls,
    start: tuple[float, float],
    duration: float,
    fly: Fly,
    motor: Motor | None = None,
) -> Stages:
    """The motion from a place with a rate s' between stops, for a time [s] at least."""
    begins, flights, lasting, losses = list[float](), list[Flight](), list[float](), list[float]()
    met = list[StopMet]()
    (place, speed), time, lost, greatest = start, 0.0, 0.0, 0.0
    kind, period, turning = "meets stops", None, tuple[float, ...]()

    def add(flight: Flight, lasts: float) -> None:
        begins.append(time)
        flights.append(flight)
        lasting.append(lasts)
        losses.append(lost)

    while time < duration:
        if len(met) > MOST_IMPACTS:
            raise RequestError(
                f"duration: the motion meets its stops more than {MOST_IMPACTS} times; give a shorter one"
            )
        stop, direction = walls.at(place, course)
        if stop:
            place = course.length if direction > 0 else 0.0
        if stop and direction * speed > 0:
            energy = float(course.at(np.array([place]))[0][0]) * speed**2 / 2
            greatest = max(greatest, energy)
            met.append(StopMet(time, place, stop, speed))
            after = energy * walls.restitution**2
            after = after if after > RESTS * greatest else 0.0
            lost += energy - after
            speed = -walls.restitution * speed if after else 0.0
        if stop and speed == 0:
            until = _held_until(course, place, direction, time, motor)
            if until > time:
                add(Held(place), until - time)
                time, kind = until, "on its stop" if until == math.inf else kind
                continue
        # steps begin within
        here = place - 2 * direction * PUSH * course.length if motor is not None else place
        flown = fly(here, speed, time, duration - time)
        add(flown.flight, flown.time)
        if flown.time == math.inf:
            if len(flights) == 1:
                kind, period, turning = flown.kind, flown.period, flown.turning
            break
        places, speeds = flown.flight.at(np.array([flown.time]))
        time, speed = time + flown.time, float(speeds[0])
        place = course.length if places[0] > course.length / 2 else 0.0
        if not walls.at(place, course)[0]:
            kind = "ends"
            break
    return Stages(
        np.array(begins),
        tuple(flights),
        np.array(lasting),
        np.array(losses),
        tuple(met),
        kind,
        period,
        turning,
    )


def _held_until(
    course: EnergyCourse, place: float, direction: int, time: float, motor: Motor | None
) -> float:
    """Until when [s] a stop on the `direction` holds what rests at it; now where it is left at once."""

    def pressed(at: Floats) -> Floats:
        return direction * force_at(course, place, at, motor)

    if pressed(np.array([time]))[0] <= BALANCED * course.steepest:
        return time
    if motor is None or motor.table is None or not motor.by_time:
        return math.inf
    times = motor.table[0]
    later = np.concatenate([[time], times[times > time]])
    forces = pressed(later)
    left = np.flatnonzero(forces < 0)
    if not left.size:
        return math.inf
    second = int(left[0])
    a, b = later[second - 1], later[second]
    # straight lines between the rows of the table
    return float(a + (b - a) * forces[second - 1] / (forces[second - 1] - forces[second]))


def elastic(course: EnergyCourse, walls: Walls, start: tuple[float, float]) -> Stages | None:
    """The motion between stops that take no energy, to and fro for ever; `None` where it is another one."""
    place, speed = start
    stop, direction = walls.at(place, course)
    if stop:
        place = course.length if direction > 0 else 0.0
        # thrown back at once
        speed = -direction * abs(speed)
        if not speed and _held_until(course, place, direction, 0.0, None):
            return None
    result = swing_between(course, place, speed)
    if result is None:
        return None
    flight, turns = result
    met = []
    for direction, end, turned in zip((-1, 1), flight.turning, turns, strict=True):
        stop = walls.at(end, course)[0]
        if not turned and not stop:
            # the circuit ends there
            return None
        if not turned:
            leg = next(leg for leg in flight.legs if leg.direction == direction)
            met.append(StopMet(leg.end, end, stop, float(leg.at(np.array([leg.end]))[1][0])))
    if not met:
        return None
    met.sort(key=lambda one: one.time)
    none = np.zeros(1)
    return Stages(
        none, (flight,), none + math.inf, none, tuple(met), "oscillation", flight.period, flight.turning
    )
