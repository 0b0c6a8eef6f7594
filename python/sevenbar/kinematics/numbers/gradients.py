"""Derivatives of what is measured of a circuit's output: extremes, swing, limits, time ratio.

An extreme of y(x, p) over x changes with p as y itself does at that place, dy*/dp = partial y/partial p (the
envelope theorem); where a symmetric linkage has it at two places, this is true of one of them. The place
changes by `dx*/dp = -(partial y'/partial p) / y''`. A dead centre of the input is an
extreme of the input over the output, so the loop driven by its output shows how it moves.

Source: docs/theory_design.md, (6).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.numbers.sensitivity import NumberedLoop, Numbers

#: The quantities of a joint, by the order of the derivative, and what time does to their units.
QUANTITIES = ("position", "velocity", "acceleration", "jerk")
PER_TIME = ("", "/s", "/s^2", "/s^3")

#: A pose found is the extreme's own where it gives its value to this share of the quantity's greatest one.
SAME_VALUE = 1e-6

#: So many rows nearest to a value are tried: the passes of two turns go by it, with a row on both sides.
NEAREST = 8

#: A time ratio nearer to 1 is 1 up to rounding; there either stroke may become the slower: a kink.
EQUAL_STROKES = 1e-9


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


def measure_slopes(
    numbers: Numbers, circuit: Circuit, speed: float, names: Sequence[str] | None = None
) -> tuple[MeasureSlopes, ...]:
    """Extremes of a circuit's output and its limits, with derivatives; NaN by numbers that open the loop.

    With `names` those that these need, and others perhaps.
    """
    loop = numbers.loop(circuit.input_column)
    result = list(_extremes(loop, circuit, speed, names))
    if names is None:
        result += _limits(numbers, circuit)
    opening = loop.opening(circuit)
    for one in result:
        one.slopes[opening] = np.nan
    return tuple(result)


def advantage_slopes(
    numbers: Numbers, circuit: Circuit, speed: float, names: Sequence[str] | None = None
) -> Iterator[MeasureSlopes]:
    """Extremes of the mechanical advantage where some are named: the speed over those of the output's rate.

    NaN where they are not: on circuits with dead centres of the input, at which the advantage is 0.
    """
    extremes, rates = circuit.advantage, circuit.velocity
    if names is None or extremes is None:
        return
    # the quickest output has the least advantage
    ends = {"lowest": "velocity_highest", "highest": "velocity_lowest"}
    known: dict[str, MeasureSlopes] = {}
    if rates is not None and rates.lowest * rates.highest > 0:
        known = {one.name: one for one in measure_slopes(numbers, circuit, speed, list(ends.values()))}
    for end, rate in ends.items():
        value, slopes = getattr(extremes, end), np.full(len(numbers.names), np.nan)
        if rate in known:
            slopes = -value / known[rate].value * known[rate].slopes
        yield MeasureSlopes(f"advantage_{end}", "", value, slopes)


def _apart(values: Floats, turns: bool) -> Floats:
    return short_way(values) if turns else values


def _extremes(
    loop: NumberedLoop, circuit: Circuit, speed: float, names: Sequence[str] | None
) -> Iterator[MeasureSlopes]:
    """Extremes of the output and its rates, swing and time ratio."""
    column, numbers = circuit.output_column, loop.numbers
    unit, scale = numbers.linkage.column_of(column).shown
    ends = []
    if circuit.angle is not None and (names is None or not {"swing", "time_ratio"}.isdisjoint(names)):
        for end in ("lowest", "highest"):
            value, at = getattr(circuit.angle, end), getattr(circuit.angle, f"{end}_at")
            here = _rates_at(loop, circuit, at, 0, value, speed)
            if here is None:
                continue
            ends.append(here)
            yield MeasureSlopes(f"angle_{end}", unit, value * scale, here.slopes[0] * scale, 1 / scale)
    if len(ends) == 2 and circuit.swing is not None:
        low, high = ends
        yield MeasureSlopes(
            "swing", unit, circuit.swing * scale, (high.slopes[0] - low.slopes[0]) * scale, 1 / scale
        )
        ratio = circuit.time_ratio
        if ratio is not None and circuit.angle is not None:
            whole = math.tau * max(circuit.turns, 1)
            stroke = (circuit.angle.highest_at - circuit.angle.lowest_at) % whole
            moves = high.place_slopes - low.place_slopes
            # the ratio is that of the stroke to the rest of the round, or the other way round
            slope = whole / (whole - stroke) ** 2 if 2 * stroke > whole else -whole / stroke**2
            if ratio - 1 < EQUAL_STROKES:
                slope = math.nan
            yield MeasureSlopes("time_ratio", "", ratio, slope * moves)
    for order, quantity in enumerate(QUANTITIES[1:], 1):
        extremes: Extremes | None = getattr(circuit, quantity)
        if extremes is None:
            continue
        rate = numbers.linkage.unit_of(column) + PER_TIME[order]
        for end in ("lowest", "highest"):
            if names is not None and f"{quantity}_{end}" not in names:
                continue
            value, at = getattr(extremes, end), getattr(extremes, f"{end}_at")
            here = _rates_at(loop, circuit, at, order, value, speed)
            if here is not None:
                yield MeasureSlopes(f"{quantity}_{end}", rate, value, here.slopes[order])


@dataclass(frozen=True, eq=False)
class _Here:
    """The output at one pose: derivatives (4, dimensions) of its rates, and of an extreme's input."""

    slopes: Floats
    place_slopes: Floats


def _rates_at(
    loop: NumberedLoop, circuit: Circuit, at: float, order: int, value: float, speed: float
) -> _Here | None:
    """The output's rates at the pose of the circuit at an input where its rate of an order has a value."""
    column = circuit.output_column
    q = poses_at(loop, circuit, at)
    here = loop.slopes(q, 3)
    result = np.column_stack([q[:, column], here.rates[:, :, column]]) * speed ** np.arange(4)
    apart = np.abs(_apart(result[:, order] - value, bool(order == 0 and loop.numbers.turns[column])))
    rows = (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)[order][:, column]
    best = nearest(apart, float(np.nanmax(np.abs(rows), initial=0.0)))
    if best is None:
        return None
    slopes = here.by_number[best, :, :, column] * speed ** np.arange(4.0)[:, None]
    if order:
        return _Here(slopes, np.full(slopes.shape[1], np.nan))
    return _Here(slopes, -slopes[1] / result[best, 2] * speed)


def _limits(numbers: Numbers, circuit: Circuit) -> Iterator[MeasureSlopes]:
    """Dead centres of the input, each once."""
    back = numbers.loop(circuit.output_column)
    place = circuit.input_column
    unit, scale = numbers.linkage.column_of(place).shown
    centres = [centre for centre in circuit.dead_centres if centre.kind == "input"]
    for number, centre in enumerate(sorted(centres, key=lambda c: c.input), 1):
        slopes = np.full(len(numbers.names), np.nan)
        q = poses_at(back, circuit, centre.output)
        apart = np.abs(_apart(q[:, place] - centre.input, bool(numbers.turns[place])))
        if (best := nearest(apart, numbers.scales[place])) is not None:
            slopes = back.slopes(q[best : best + 1], 0).by_number[0, 0, :, place] * scale
        yield MeasureSlopes(f"limit_{number}", unit, centre.input * scale, slopes, 1 / scale)


def poses_at(loop: NumberedLoop, circuit: Circuit, value: float) -> Floats:
    """Poses (n, columns) of a circuit where the loop's driving column has a value, from each row nearby."""
    apart = _apart(value - circuit.q[:, loop.input], bool(loop.numbers.turns[loop.input]))
    size = np.where(np.isfinite(circuit.q).all(axis=1), np.abs(apart), np.nan)
    nearest = np.sort(np.argsort(size, kind="stable")[: min(NEAREST, np.isfinite(size).sum())])
    q = loop.numbers.poses(circuit.q[nearest])
    result = loop.closed(q[:, loop.input] + apart[nearest], q)
    return np.asarray(result[np.isfinite(result).all(axis=1)])


def nearest(apart: Floats, size: float = 1.0) -> int | None:
    """The pose (n,) that is least apart from a value, as a share of its size; `None` where none gives it."""
    if not np.isfinite(apart).any():
        return None
    best = int(np.nanargmin(apart))
    return best if apart[best] <= SAME_VALUE * (size or 1.0) else None
