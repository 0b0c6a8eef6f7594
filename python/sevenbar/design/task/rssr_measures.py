"""Measures of an RSSR whose input turns fully, in closed form: swing, time ratio, least transmission angle.

The squared sine s(a) of the transmission angle is a trigonometric polynomial of degree two in the input a, so
it has two minima at most. With b(a) the output on a branch, its ends are where b' = 0, and

    b_p = -G_p / G_b    at an end,      a_p = -b'_p / b''                                                  (1)

are the slopes of its value and of its place by a number p of the linkage. Second derivatives come by complex
steps, exact to rounding.

Source: docs/theory_design.md, (6) and (26).
"""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.closure import output_slopes, outputs, transmission_slopes, transmissions
from sevenbar.design.task.loop import TaskLoop

#: The measures, in their closed forms.
KNOWN = ("swing", "time_ratio", "transmission_lowest")

#: Inputs of a turn between which extremes are sought, and the longest of Newton's steps to each [rad].
TURN, FARTHEST = np.arange(72) * math.tau / 72, math.tau / 72

#: Most steps, and the step [rad] after which an extreme is exact: it changes by the square.
STEPS, NEAR = 8, 1e-10

#: A step whose square is nothing; a curvature at a minimum that is none; a sine of 0, whose slope is kept.
TINY, FLAT, DEAD = 1e-30, 1e-12, 1e-7

#: A branch [rad] so far from an anchor is another circuit; strokes so nearly equal [rad] have a kink in their
#: ratio.
SAME_BRANCH, EQUAL = 0.5, 1e-6


class RssrMeasures:
    """The measures of an RSSR driven by its crank, at numbers of a task's loop."""

    def __init__(self, loop: TaskLoop) -> None:
        self._loop = loop
        ends = loop.input, loop.output
        #: Whether they are known of the loop.
        self.known = loop.linkage.form == "rssr" and ends == (0, len(loop.linkage.columns) - 1)

    def knows(self, names: Collection[str]) -> bool:
        """Whether all of these measures are known."""
        return self.known and bool(names) and set(names) <= set(KNOWN)

    def at(self, values: Floats, anchor: Floats, names: Collection[str]) -> tuple[Floats, Floats] | None:
        """Measures (f,) of the circuit near a row (columns,), and their slopes (f, k) by the free numbers.

        `None` where the input does not turn fully, the output does, or strokes are equal.
        """
        row = self._loop.row(values)
        if not (transmissions(row, TURN)[0] > 0).all():
            return None
        read: dict[str, tuple[float, Floats]] = {}
        if "transmission_lowest" in names:
            read["transmission_lowest"] = min(_least_angles(row), key=lambda end: end[0])
        if {"swing", "time_ratio"} & set(names):
            strokes = _strokes(row, anchor[self._loop.input], anchor[self._loop.output])
            if strokes is None:
                return None
            read |= strokes
        value, by = zip(*(read[name] for name in names), strict=True)
        return np.array(value), self._loop.row_slopes(values, np.array(by))

    def ends(self, values: Floats) -> list[tuple[float, Floats]]:
        """Both minima of the transmission angle [deg], or the only one twice, and their slopes (k,).

        Below zero where the input does not turn fully.
        """
        angles, by = zip(*_least_angles(self._loop.row(values)), strict=True)
        return list(zip(angles, self._loop.row_slopes(values, np.array(by)), strict=True))


def _least_angles(row: Floats) -> list[tuple[float, Floats]]:
    """Both minima of the transmission angle [deg], and their slopes (6,)."""
    square = transmissions(row, TURN)[0]
    low = (square <= np.roll(square, 1)) & (square < np.roll(square, -1))
    low[square.argmin()] = True
    places = TURN[low]
    for _ in range(STEPS):
        slope = transmission_slopes(row, places + 1j * TINY)[1][0]
        step = np.clip(slope.real / np.maximum(slope.imag / TINY, FLAT), -FARTHEST, FARTHEST)
        places = places - step
        if np.abs(step).max() < NEAR:
            break
    square = np.minimum(transmissions(row, places)[0], 1.0)
    cosine = np.sqrt(1 - square)
    sine = np.sqrt(np.maximum(square, 0.0))
    # its cosine is beyond 1 where the input is out of reach
    angles = np.degrees(np.where(square > 0, np.arcsin(sine), 1 - cosine))
    flat = 2 * cosine * np.where(square > 0, np.maximum(sine, DEAD), 1.0)
    by = np.degrees(transmission_slopes(row, places)[0][0] / np.maximum(flat, DEAD)[:, None])
    ends = list(zip(angles.tolist(), by, strict=True))
    return [ends[0], ends[-1]]


def _strokes(row: Floats, at: float, output: float) -> dict[str, tuple[float, Floats]] | None:
    """Swing [deg] and time ratio of the circuit through an input and an output, with slopes (6,)."""
    off = [abs(float(short_way(outputs(row, np.array([at]), branch)[0, 0] - output))) for branch in (0, 1)]
    branch = int(off[1] < off[0])
    if not off[branch] <= SAME_BRANCH:
        return None
    angles = np.unwrap(outputs(row, np.append(TURN, math.tau), branch)[0])
    if abs(angles[-1] - angles[0]) > 1.0:
        # it turns, too
        return None
    places = TURN[[int(angles[:-1].argmin()), int(angles[:-1].argmax())]]
    for _ in range(STEPS):
        b = outputs(row, places, branch)[0]
        by, rate, bend = _slopes(row, places, b)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.clip(rate / bend, -FARTHEST, FARTHEST)
        places = places - step
        if np.abs(step).max() < NEAR:
            break
    else:
        return None
    stepped = row + 1j * TINY * np.eye(6)
    moved = output_slopes(stepped, places[None], b + 1j * TINY * by.T)[1].imag / TINY
    place_by = -moved.T / bend[:, None]
    swing = float((b[1] - b[0]) - math.tau * round(float(b[1] - b[0] - np.ptp(angles)) / math.tau))
    stroke = float((places[1] - places[0]) % math.tau)
    if not np.isfinite(by).all() or abs(stroke - math.pi) < EQUAL:
        return None
    rest, moves = math.tau - stroke, place_by[1] - place_by[0]
    ratio, slope = (
        (stroke / rest, math.tau / rest**2) if stroke > rest else (rest / stroke, -math.tau / stroke**2)
    )
    return {
        "swing": (math.degrees(swing), np.degrees(by[1] - by[0])),
        "time_ratio": (ratio, slope * moves),
    }


def _slopes(row: Floats, places: Floats, b: Floats) -> tuple[Floats, Floats, Floats]:
    """Slopes of the output at inputs (n,) by the dimensions (n, 6), and its first and second by the input."""
    by, rate = output_slopes(row, places[None], b[None])
    ahead: Any = 1j * TINY
    bend = output_slopes(row, places[None] + ahead, b[None] + ahead * rate)[1].imag / TINY
    return by[0], rate[0], bend[0]
