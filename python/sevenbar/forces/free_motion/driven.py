"""Free motion with dampers, or with a motor by its speed or by time: an ordinary equation in s and s'.

    m s'' = -U' - D s' - m' s'^2 / 2 + torque(t, dx/dt) dx/ds                                             (12)

Solved by an explicit method of order eight with tight tolerances (scipy's DOP853), from break to break of the
loads, twice: the difference of the two is the accuracy reported.

Source: docs/theory_free_motion.md, (12).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.forces.free_motion.course import EnergyCourse

#: Relative tolerances of the two solutions.
TOLERANCE = 1e-12
COARSE = 1e-10

#: Most stretches between breaks.
MOST_STRETCHES = 100_000

#: At a break at rest, a push of this part of the lap says which side counts.
PUSH = 1e-12

#: Torque of the motor at times, inputs and speeds of the input.
Motor = Callable[[float, float], float]


@dataclass(frozen=True, eq=False)
class Driven:
    """A solution, dense between `bounds` [s]."""

    bounds: Floats
    parts: tuple[Any, ...]
    #: Whether it stopped at the end of an open circuit.
    ended: bool

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds s' (j,) at times (j,) [s]; NaN past the end of an open circuit."""
        t = np.asarray(t, dtype=np.float64)
        i = np.clip(np.searchsorted(self.bounds, t, "right") - 1, 0, len(self.parts) - 1)
        out = np.full((2, len(t)), np.nan)
        for k in np.unique(i):
            mine = (i == k) & (t <= self.bounds[-1] * (1 + 1e-14))
            if mine.any():
                out[:, mine] = self.parts[k](np.minimum(t[mine], self.bounds[-1]))
        return out[0], out[1]


def driven(
    course: EnergyCourse, place: float, speed: float, duration: float, motor: Motor | None, tolerance: float
) -> Driven:
    """The motion from a place with s' = `speed` for a time [s]."""
    from scipy.integrate import solve_ivp

    quantities, length = course.quantities, course.length
    edges = quantities.edges
    bounds_of, last = edges.tolist(), len(edges) - 2
    by_place = np.pad(quantities.slope.series[:, :, :1], ((0, 0), (0, 1), (0, 0)))
    tables = list(
        np.ascontiguousarray(np.moveaxis(np.concatenate([quantities.series, by_place], axis=2), 1, 2))
    )
    numbers = np.arange(quantities.series.shape[1])
    scale = max(abs(speed), math.sqrt(2 * float(np.ptp(course.at(course.marks(0.0))[2])) / float(
        np.median(quantities.at((edges[:-1] + edges[1:]) / 2)[:, 0]))), 1e-6)  # fmt: skip
    breaks = course.breaks
    bounds, parts = [0.0], []
    time, state = 0.0, np.array([place, speed])
    ended = False
    for _ in range(MOST_STRETCHES):
        low, high = _stretch(course, breaks, state, place)

        def push(t: float, y: Floats, low: float = low, high: float = high) -> list[float]:
            s, v = float(y[0]), float(y[1])
            inside = min(max(s, low + PUSH * length), high - PUSH * length)
            lap = math.floor(inside / length) if course.closed else 0
            here = inside - lap * length
            # one place at a time: in plain numbers and one product
            piece = min(max(bisect_right(bounds_of, here) - 1, 0), last)
            start, end = bounds_of[piece], bounds_of[piece + 1]
            x = min(max((2 * here - start - end) / (end - start), -1.0), 1.0)
            own = tables[piece] @ np.cos(numbers * math.acos(x))
            mass, slope, loss, by_s, winding, by_mass = own.tolist()
            force = -(slope + lap * winding) - loss * v - by_mass * v * v / 2
            if motor is not None:
                force += motor(t, by_s * v) * by_s
            return [v, force / mass]

        events: list[Any] = []
        for bound in (low, high):
            if math.isfinite(bound):
                event: Any = lambda t, y, bound=bound: y[0] - bound  # noqa: ARG005, E731
                event.terminal = True
                event.direction = 1.0 if bound == high else -1.0
                events.append(event)
        found = solve_ivp(
            push,
            (time, duration),
            state,
            method="DOP853",
            rtol=tolerance,
            atol=[tolerance * length, tolerance * scale],
            dense_output=True,
            events=events or None,
        )
        if found.status < 0:
            raise RequestError(f"duration: the motion could be followed up to {found.t[-1]:.6g} s only")
        parts.append(found.sol)
        bounds.append(float(found.t[-1]))
        time, state = float(found.t[-1]), found.y[:, -1].copy()
        if found.status == 0:
            break
        hit = low if abs(state[0] - low) < abs(state[0] - high) else high
        if not course.closed and hit in (0.0, length):
            ended = True
            break
        # on to the other side of the break
        state[0] = hit + math.copysign(2 * PUSH * length, state[1])
    else:
        raise RequestError("duration: loads set in and end too often; give a shorter one")
    return Driven(np.array(bounds), tuple(parts), ended)


def _stretch(course: EnergyCourse, breaks: Floats, state: Floats, start: float) -> tuple[float, float]:
    """The breaks on both sides of a place."""
    place = float(state[0])
    if not course.closed:
        inner = np.concatenate([[0.0], breaks, [course.length]])
    elif not breaks.size:
        return -math.inf, math.inf
    else:
        lap = math.floor(place / course.length)
        inner = np.concatenate([breaks + (lap + k) * course.length for k in (-1, 0, 1)])
    inner = np.unique(inner)
    off = PUSH * course.length
    below, above = inner[inner < place + (off if place == start and state[1] >= 0 else 0)], inner
    low = float(below[-1]) if below.size else float(inner[0])
    above = inner[inner > low]
    return low, float(above[0]) if above.size else float(inner[-1])
