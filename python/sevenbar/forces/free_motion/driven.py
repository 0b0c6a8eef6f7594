"""Free motion with dampers, or with a motor by its speed or by time: an ordinary equation along s.

    m s'' = -U' - D s' - m' s'^2 / 2 + torque(t, dx/dt) dx/ds                                             (12)

Solved by collocation at Chebyshev's nodes in time, step by step with tight tolerances, from break to break of
the loads, twice: the difference of the two is the accuracy reported.

Source: docs/theory_free.md, (12).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sevenbar._core import driven as driven_rows
from sevenbar.arrays import Floats
from sevenbar.curves.along import Along
from sevenbar.errors import RequestError
from sevenbar.forces.free_motion.course import INPUT, SLOPE, EnergyCourse

#: What a step of the two solutions may miss, as a part of a lap and of the motion's speed.
TOLERANCE = 1e-12
COARSE = 1e-10

#: Most stretches between breaks.
MOST_STRETCHES = 100_000

#: So near [parts of the lap] to a place without mass s' grows beyond what steps in time can follow.
NEAR_MASSLESS = 1e-3

#: At a break at rest, a push of this part of the lap says which side counts.
PUSH = 1e-12


@dataclass(frozen=True, eq=False)
class Motor:
    """A torque at the input [J for a radian, or the length unit]: a table, or a function of the speed."""

    table: tuple[Floats, Floats] | None = None
    by_time: bool = False
    function: Callable[[float], float] | None = None

    def at(self, times: Floats, speeds: Floats) -> Floats:
        """Torques (j,) at times and speeds of the input (j,)."""
        if self.table is not None:
            return np.interp(times if self.by_time else speeds, *self.table)
        assert self.function is not None
        return np.array([self.function(float(speed)) for speed in speeds])

    @property
    def asked(self) -> tuple[bool, Floats, Floats] | Callable[[float, float], float]:
        """What the core asks."""
        if self.table is not None:
            return self.by_time, *self.table
        function = self.function
        assert function is not None
        return lambda _, speed: function(speed)


@dataclass(frozen=True, eq=False)
class Driven:
    """A solution: place and speed as polynomials of time."""

    states: Along
    #: Whether it stopped at the end of an open circuit.
    ended: bool

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds s' (j,) at times (j,) [s]; NaN past the end of an open circuit."""
        t = np.asarray(t, dtype=np.float64)
        end = self.states.edges[-1]
        place, speed = np.where(
            (t <= end * (1 + 1e-14))[:, None], self.states.at(np.minimum(t, end)), np.nan
        ).T
        return place, speed


def force_at(course: EnergyCourse, place: float, times: Floats, motor: Motor | None) -> Floats:
    """What pushes at rest along the course (j,) [J for a unit of it], at a place and times (j,) [s]."""
    own = course.quantities.at(np.array([place]))[0]
    pushes = np.full(times.shape, -own[SLOPE])
    return pushes if motor is None else pushes + motor.at(times, np.zeros(times.shape)) * own[INPUT]


def driven(
    course: EnergyCourse,
    place: float,
    speed: float,
    duration: float,
    motor: Motor | None,
    tolerance: float,
    *,
    begin: float = 0.0,
) -> Driven:
    """The motion from a place with s' = `speed` for a time [s]; it begins at the motor's time `begin` [s]."""
    length, edges = course.length, course.quantities.edges
    median = float(np.median(course.quantities.at((edges[:-1] + edges[1:]) / 2)[:, 0]))
    scale = max(
        abs(speed), math.sqrt(2 * float(np.ptp(course.at(course.marks(np.zeros(1)))[2])) / median), 1e-6
    )
    times, series = [np.array([begin])], []
    time, ended, until = begin, False, begin + duration
    start = place
    near = NEAR_MASSLESS * length
    course.refuse_massless(place - near, place + near)
    stops = np.unique(np.concatenate([course.breaks, course.massless - near, course.massless + near]))
    if not course.closed:
        stops = stops[(stops > 0) & (stops < length)]
    for _ in range(MOST_STRETCHES):
        low, high = _stretch(course, stops, place, upwards=place == start and speed >= 0)
        moments, steps, (place, speed), stopped, whole = driven_rows(
            edges,
            course.pushing,
            length if course.closed else None,
            (time, place, speed, until),
            (tolerance * length, tolerance * scale),
            (low, high),
            None if motor is None else motor.asked,
        )
        time = float(moments[-1])
        if not whole:
            raise RequestError(f"duration: the motion could be followed up to {time:.6g} s only")
        times.append(moments[1:])
        series.append(steps)
        if not stopped:
            break
        hit = low if abs(place - low) < abs(place - high) else high
        course.refuse_massless(hit - near, hit + near)
        if not course.closed and hit in (0.0, length):
            ended = True
            break
        # on to the other side of the break
        place = hit + math.copysign(2 * PUSH * length, speed)
    else:
        raise RequestError("duration: loads set in and end too often; give a shorter one")
    return Driven(Along(np.concatenate(times) - begin, np.concatenate(series)), ended)


def _stretch(course: EnergyCourse, breaks: Floats, place: float, *, upwards: bool) -> tuple[float, float]:
    """The breaks on both sides of a place; one at the place is below where the motion begins `upwards`."""
    if not course.closed:
        inner = np.concatenate([[0.0], breaks, [course.length]])
    elif not breaks.size:
        return -math.inf, math.inf
    else:
        lap = math.floor(place / course.length)
        inner = np.concatenate([breaks + (lap + k) * course.length for k in (-1, 0, 1)])
    inner = np.unique(inner)
    below = inner[inner < place + (PUSH * course.length if upwards else 0)]
    low = float(below[-1] if below.size else inner[0])
    above = inner[inner > low]
    return low, float(above[0] if above.size else inner[-1])
