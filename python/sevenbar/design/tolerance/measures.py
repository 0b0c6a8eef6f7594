"""Derivatives of what is measured of a circuit: extremes, swing, limits, time ratio, transmission angle.

An extreme of y(x, p) over x changes with p as y itself does at that place, dy*/dp = partial y/partial p (the
envelope theorem); where a symmetric linkage has it at two places, this is true of one of them. The place
changes by `dx*/dp = -(partial y'/partial p) / y''`. A dead centre of the input is an
extreme of the input over the output, so the loop driven by its output tells how it moves.

Source: docs/theory_design.md, (6).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.loop import STEP, Loop, Poses
from sevenbar.design.tolerance.numbers import Numbered
from sevenbar.design.tolerance.outputs import PER_TIME, QUANTITIES
from sevenbar.design.tolerance.rigid import Numbers, cross, moved
from sevenbar.kinematics.motion import Circuit, Extremes

#: A pose found is the extreme's own where it gives its value to this share of the quantity's greatest one.
SAME_VALUE = 1e-6

#: So many rows nearest to a value are tried: the passes of two turns go by it, with a row on both sides.
NEAREST = 8

#: A time ratio nearer to 1 is 1 but for rounding; there either stroke may become the slower: a kink.
EQUAL_STROKES = 1e-9

#: 1 - sin of a transmission angle of 90 degrees, and sin of one of 0: there it has a kink, or stays.
RIGHT_ANGLE, DEAD = 1e-12, 1e-7


@dataclass(frozen=True, eq=False)
class MeasureSlopes:
    """A measure of a circuit: value, unit, and derivatives (dimensions,) by the dimensions' units.

    `scale` takes it to rad where it is an angle in degrees. NaN where the measure has no derivative.
    """

    name: str
    unit: str
    value: float
    slopes: Floats
    scale: float = 1.0


def measure_slopes(loop: Loop, circuit: Circuit, speed: float) -> tuple[MeasureSlopes, ...]:
    """All measures of a circuit that has them, with their derivatives."""
    found = list(_extremes(loop, circuit, speed))
    found += _limits(loop.whole, circuit)
    found += _transmission(loop, circuit)
    return tuple(found)


def _angle_or_length(loop: Loop, column: int) -> tuple[str, float]:
    """The unit of a column as people read it, and its size as it is counted here."""
    if loop.columns[column].turns:
        return "deg", math.degrees(1.0)
    return loop.whole.linkage.length_unit, 1.0


def _extremes(loop: Loop, circuit: Circuit, speed: float) -> Iterator[MeasureSlopes]:
    """Extremes of the output and its rates, swing and time ratio."""
    column = circuit.output_column
    unit, told = _angle_or_length(loop, column)
    ends = []
    if circuit.angle is not None:
        for end in ("lowest", "highest"):
            value, at = getattr(circuit.angle, end), getattr(circuit.angle, f"{end}_at")
            here = _rates_at(loop, circuit, at, 0, value, speed)
            if here is None:
                continue
            ends.append(here)
            yield MeasureSlopes(f"angle_{end}", unit, value * told, here.slopes[0] * told, 1 / told)
    if len(ends) == 2 and circuit.swing is not None:
        low, high = ends
        yield MeasureSlopes(
            "swing", unit, circuit.swing * told, (high.slopes[0] - low.slopes[0]) * told, 1 / told
        )
        ratio = circuit.time_ratio
        if ratio is not None and circuit.angle is not None:
            stroke = (circuit.angle.highest_at - circuit.angle.lowest_at) % math.tau
            moves = high.place_slopes - low.place_slopes
            # the ratio is that of the stroke to the rest of the turn, or the other way round
            slope = math.tau / (math.tau - stroke) ** 2 if stroke > math.pi else -math.tau / stroke**2
            if ratio - 1 < EQUAL_STROKES:
                slope = math.nan
            yield MeasureSlopes("time_ratio", "", ratio, slope * moves)
    for order, quantity in enumerate(QUANTITIES[1:], 1):
        extremes: Extremes | None = getattr(circuit, quantity)
        if extremes is None:
            continue
        rate = ("rad" if loop.columns[column].turns else loop.whole.linkage.length_unit) + PER_TIME[order]
        for end in ("lowest", "highest"):
            value, at = getattr(extremes, end), getattr(extremes, f"{end}_at")
            here = _rates_at(loop, circuit, at, order, value, speed)
            if here is not None:
                yield MeasureSlopes(f"{quantity}_{end}", rate, value, here.slopes[order])


@dataclass(frozen=True, eq=False)
class _Here:
    """The output at one pose: derivatives (3, dimensions) of its rates, and of an extreme's input."""

    slopes: Floats
    place_slopes: Floats


def _rates_at(
    loop: Loop, circuit: Circuit, at: float, order: int, value: float, speed: float
) -> _Here | None:
    """The output's rates at the pose of the circuit at an input where its rate of an order has a value."""
    column = circuit.output_column
    scale = np.array([loop.scales[column] * speed**k for k in range(3)])

    def rates(poses: Poses, p: Numbers, u: Numbers) -> Numbers:
        x = np.broadcast_to(poses.x, u.shape[1:])
        found = loop.rates(loop.walk(p, poses, x, u), poses, x, u)
        return np.stack([part[column] for part in (found.value, found.first, found.second)])

    poses = poses_at(loop, circuit, at)
    if not len(poses):
        return None
    found = rates(poses, loop.nominal, poses.u)[:, 0] * scale[:, None]
    apart = found[order] - value
    if order == 0 and loop.columns[column].turns:
        apart = np.remainder(apart + np.pi, math.tau) - np.pi
    best = int(np.argmin(np.abs(apart)))
    size = float(np.nanmax(np.abs((circuit.q, circuit.dq, circuit.ddq)[order][:, column]), initial=0.0))
    if not abs(apart[best]) <= SAME_VALUE * (size or 1.0):
        return None
    _, p, u = loop.slopes(poses.only(np.array([best])))
    slopes = rates(poses.only(np.array([best])), p, u)[..., 0].imag / STEP * scale[:, None]
    if order:
        return _Here(slopes, np.full(slopes.shape[1], np.nan))
    return _Here(slopes, -slopes[1] / found[2, best] * speed)


def _limits(whole: Numbered, circuit: Circuit) -> Iterator[MeasureSlopes]:
    """Dead centres of the input, each once."""
    back = Loop(whole, circuit.output_column)
    unit, told = _angle_or_length(back, circuit.input_column)
    place = back.passive.index(circuit.input_column)
    centres = [centre for centre in circuit.dead_centres if centre.kind == "input"]
    for number, centre in enumerate(sorted(centres, key=lambda c: c.input), 1):
        slopes = np.full(len(whole.names), np.nan)
        poses = poses_at(back, circuit, centre.output)
        apart = poses.u[place, 0] - centre.input / back.scales[circuit.input_column]
        if back.columns[circuit.input_column].turns:
            apart = np.remainder(apart + np.pi, math.tau) - np.pi
        if len(poses) and np.abs(apart).min() < SAME_VALUE:
            here = poses.only(np.array([np.argmin(np.abs(apart))]))
            slopes = back.slopes(here)[0][place, :, 0] * back.scales[circuit.input_column] * told
        yield MeasureSlopes(f"limit_{number}", unit, centre.input * told, slopes, 1 / told)


def poses_at(loop: Loop, circuit: Circuit, value: float) -> Poses:
    """Poses of a circuit where the loop's driving column has a value: from each row near to it."""
    apart = value - circuit.q[:, loop.input]
    if loop.columns[loop.input].turns:
        apart = np.remainder(apart + np.pi, math.tau) - np.pi
    size = np.abs(apart)
    nearest = np.sort(np.argsort(size, kind="stable")[: min(NEAREST, np.isfinite(size).sum())])
    poses = loop.poses(circuit.q[nearest])
    return loop.carried(poses, poses.x + apart[nearest][poses.rows] / loop.scales[loop.input])


def _transmission(loop: Loop, circuit: Circuit) -> Iterator[MeasureSlopes]:
    """The transmission angle's extremes: its sine is the coupler's part along the output ball's way."""
    if circuit.transmission is None:
        return
    points = loop.whole.linkage.points

    def sine(poses: Poses, p: Numbers, u: Numbers) -> Numbers:
        walk = loop.walk(p, poses, np.broadcast_to(poses.x, u.shape[1:]), u)
        built = loop.whole.built(p).points
        # A and B are the first two points of every RSSR
        a, b = (
            moved(walk.links[point.link - 1], at / loop.size)
            for point, at in zip(points[:2], built, strict=False)
        )
        arm = b if circuit.output_column else a
        screw = walk.screws[circuit.output_column]
        way = cross(screw[:3], arm) + screw[3:]
        along = a - b
        return np.asarray((along * way).sum(axis=0) / np.sqrt((along**2).sum(axis=0) * (way**2).sum(axis=0)))

    for end in ("lowest", "highest"):
        value, at = getattr(circuit.transmission, end), getattr(circuit.transmission, f"{end}_at")
        slopes = np.full(len(loop.whole.names), np.nan)
        poses = poses_at(loop, circuit, at)
        sines = sine(poses, loop.nominal, poses.u)[0]
        apart = np.abs(np.arcsin(np.minimum(np.abs(sines), 1.0)) - value)
        if len(poses) and apart.min() < SAME_VALUE and 1 - abs(sines[np.argmin(apart)]) > RIGHT_ANGLE:
            here = poses.only(np.array([np.argmin(apart)]))
            size = float(sines[np.argmin(apart)])
            _, p, u = loop.slopes(here)
            by_p = sine(here, p, u)[:, 0].imag / STEP
            slopes = np.degrees(math.copysign(1.0, size) * by_p / math.sqrt(1 - size * size))
        if value < DEAD:
            # it is 0 at every dead centre of the input
            slopes = np.zeros(len(slopes))
        yield MeasureSlopes(f"transmission_{end}", "deg", math.degrees(value), slopes, math.radians(1.0))
