"""Extremes of the output's velocity, acceleration and jerk along a circuit against 60 digits.

A rate is a parabola beside its extreme; the reference's own values at three inputs give its vertex, twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy.precise_loops import DIGITS, PreciseLoop
from evidence.accuracy.quantiles import QUANTITIES
from evidence.accuracy.reference_loops import Loop

#: Inputs [rad] to either side of a place of a parabola: the second one leaves 1e-12 of its vertex.
STEPS = (1e-4, 1e-6)

#: Second derivatives by the input below this part of the input's pace are no bend.
FLAT = 1e-9

#: Vertices farther [rad] than this are none of the extreme that was reported.
FAR = 1e-3

#: Asked for in a value, relative to the greater of both extremes, or of the input's pace.
ASKED = 1e-10


@dataclass(frozen=True)
class Extreme:
    """An extreme beside the exact one: its error relative to the greater of both, that of its place [rad]."""

    linkage: str
    circuit: int
    quantity: str
    end: str
    at: float
    value: float
    error: float
    place: float


def extremes(name: str, most: int) -> list[Extreme]:
    """Those of the first so many circuits of a linkage along which the input does not stand still."""
    linkage = sb.load(name)
    motion = linkage.motion(samples=360)
    loop = Loop.of(linkage)
    found = []
    for circuit in motion.circuits[:most]:
        for order, quantity in enumerate(QUANTITIES[1:], 1):
            ends = getattr(circuit, quantity)
            if ends is None:
                continue
            pace = loop.scales[circuit.output_column] * abs(motion.speed) ** order
            greater = max(abs(ends.lowest), abs(ends.highest), pace)
            for end, value, at in (
                ("lowest", ends.lowest, ends.lowest_at),
                ("highest", ends.highest, ends.highest_at),
            ):
                exact, place = exact_extreme(loop, circuit, order, at=at, speed=motion.speed)
                error = float(abs(mp.mpf(value) - exact)) / greater
                found.append(Extreme(name, circuit.index, quantity, end, at, value, error, place))
    return found


def exact_extreme(
    loop: Loop, circuit: sb.Circuit, order: int, *, at: float, speed: float
) -> tuple[mp.mpf, float]:
    """The exact extreme next to an input, and how far from it its place is [rad]."""
    column = circuit.input_column
    period = 2 * np.pi * max(1, circuit.turns)
    off = (circuit.input - at + period / 2) % period - period / 2
    row = int(np.argmin(np.abs(off)))
    near = np.array(circuit.q[row])
    near[column] -= off[row]
    (q,) = loop.polished(near, column)
    with mp.workdps(DIGITS):
        precise = PreciseLoop(loop, column)
        x = float(q[column])

        def rate(angle: float) -> mp.mpf:
            return precise.along((angle, speed, 0.0, 0.0), q)[circuit.output_column][order]

        scale = loop.scales[circuit.output_column] * abs(speed) ** order
        for step in STEPS:
            before, here, after = rate(x - step), rate(x), rate(x + step)
            bend = before - 2 * here + after
            if abs(bend) <= step**2 * FLAT * scale:
                # a constant, as the even pace of two shafts is: every place is one
                return here, 0.0
            shift = float(step * (before - after) / (2 * bend))
            if abs(shift) > FAR:
                # no extreme is near: how far the parabola points is reported, not followed
                return here, abs(shift)
            x += shift
        return rate(x), abs(x - float(q[column]))


def measured(name: str, most: int) -> dict[str, object]:
    """Of one linkage: how many were compared, greatest errors of values and places, how many miss `ASKED`."""
    found = extremes(name, most)
    return {
        "count": len(found),
        "value": {
            quantity: max((e.error for e in found if e.quantity == quantity), default=0.0)
            for quantity in QUANTITIES[1:]
        },
        "place": max((e.place for e in found), default=0.0),
        "beyond": sum(bool(e.error > ASKED) for e in found),
    }
