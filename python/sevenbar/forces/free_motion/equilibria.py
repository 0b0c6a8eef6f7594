"""Where a linkage can rest: every zero of the slope of its potential on the circuit, found, not sampled.

    U'(s) = 0,    stable where U'' > 0,    omega^2 = U'' / m                                              (11)

A load that sets in at a place makes U' jump; where it jumps over zero upwards the linkage rests as well, held
from both sides.

Source: docs/theory_free.md, (11).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, ReadOnly
from sevenbar.curves.along import Along, zero_between
from sevenbar.forces.free_motion.course import MASS, SAME, EnergyCourse
from sevenbar.text.printing import Printed

#: A slope of U below this part of its greatest on all of a piece is none.
NO_SLOPE = 1e-12

#: A curvature of U below this part of its greatest is zero: neither stable nor unstable to the first order.
FLAT = 1e-9

Kind = Literal["stable", "unstable", "flat", "edge", "on its stop"]


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium(ReadOnly, Printed):
    """A place where the linkage can rest.

    `input` [rad, or length]; `q` (columns,) all joint values; `kind` is "stable", "unstable", "flat"
    where the curvature of the potential vanishes (or, up to the input `until`, its slope), "edge" where a
    load that sets in or ends there holds it, "on its stop" where what acts presses it against the `stop`,
    "range of crank", which gives `holding` along the positive turn of the joint whose range it is, else of
    the input [N m, of a slide N].
    `frequency` [rad/s] is that of small vibrations about a stable one, `rate` [1/s] that of leaving an
    unstable one; NaN where there is none, as where nothing with a mass moves. `potential` [J] is that of
    weights, springs and loads.
    """

    input: float
    columns: tuple[str, ...]
    q: Floats
    kind: Kind
    frequency: float
    rate: float
    potential: float
    place: float
    until: float = math.nan
    stop: str = ""
    holding: float = math.nan
    holding_unit: str = ""
    #: As of a free motion: the moment [N m] that the rule of each idle spin needs here, by its link.
    spin: Mapping[str, float] = field(default_factory=dict)


#: Place, kind, frequency and rate, and where a range of rest that begins there ends.
Resting = tuple[float, Kind, float, float, float]


def resting_places(course: EnergyCourse, first: float = 0.0) -> list[Resting]:
    """Places, kinds, frequencies and rates of all equilibria on a lap; none where U is constant.

    The first lap, where each has the same; with a spring that winds up the lap that begins at `first`.
    """
    if not course.winds:
        return _on_lap(course, 0)
    length = course.length
    begin = first - SAME * length
    lap = math.floor(begin / length)
    result = [
        (s + k * length, kind, frequency, rate, end + k * length)
        for k in (lap, lap + 1)
        for s, kind, frequency, rate, end in _on_lap(course, k)
    ]
    return [one for one in result if begin <= one[0] < begin + length]


def _on_lap(course: EnergyCourse, lap: int) -> list[Resting]:
    """The equilibria on a lap, by places on the first one."""
    quantities = course.quantities
    edges = quantities.edges
    own = course.slope_on(lap)
    if not own.series.any():
        return []
    turning = own.stationary(0)
    result: list[float] = []
    # what U' is just before a place where it changes its sign at once
    jumps: dict[float, float] = {}
    last = len(edges) - 2
    for i in range(last + 1):
        a, b = edges[i], edges[i + 1]
        marks = np.concatenate([[a], turning[(turning > a) & (turning < b)], [b]])
        heights = own.on(np.full(len(marks), i), marks)[:, 0]
        result += _zeros(own, i, marks, heights)
        before = i - 1 if i else last
        if i or course.closed:
            # the first piece goes on from the lap before, on which a spring is wound up less
            there = own if i else course.slope_on(lap - 1)
            left = float(there.on(np.array([before]), edges[before + 1 : before + 2])[0, 0])
            if left * heights[0] < 0:
                jumps[float(a)] = left
    flat = FLAT * float(own.slope.reach[0])
    ranges = _ranges_of_rest(own, closed=course.closed)
    if ranges is None:
        return []
    one = SAME * course.length
    out: list[Resting] = []
    for s in sorted({*result, *jumps}):
        if any(a - one < s + k * course.length < b + one for a, b in ranges for k in (0, 1)):
            continue
        near = abs(s - out[-1][0]) if out else math.inf
        if near < one or (out and course.closed and s - out[0][0] > course.length * (1 - SAME)):
            continue
        here = np.array([s])
        curvature = float(own.slope.at(here)[0, 0])
        mass = quantities.at(here)[:, MASS]
        squared = math.nan if course.is_massless(mass)[0] else abs(curvature) / float(mass[0])
        is_break = bool(np.any(np.abs(course.breaks - s) < SAME * course.length))
        if s in jumps and is_break:
            out.append((s, "edge" if jumps[s] < 0 else "unstable", math.nan, math.nan, math.nan))
        elif abs(curvature) <= flat:
            out.append((s, "flat", math.nan, math.nan, math.nan))
        elif curvature > 0:
            out.append((s, "stable", math.sqrt(squared), math.nan, math.nan))
        else:
            out.append((s, "unstable", math.nan, math.sqrt(squared), math.nan))
    out += [(a, "flat", math.nan, math.nan, b) for a, b in ranges]
    return sorted(out)


def _ranges_of_rest(own: Along, *, closed: bool) -> list[tuple[float, float]] | None:
    """The ranges on which U does not change at all, over the seam of a closed course; `None` everywhere."""
    length = own.length
    still = np.abs(own.series[:, :, 0]).sum(axis=1) <= NO_SLOPE * float(own.reach[0])
    if still.all():
        return None
    ends = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]))).reshape(-1, 2)
    result = [(float(own.edges[a]), float(own.edges[b])) for a, b in ends]
    if closed and len(result) > 1 and still[0] and still[-1]:
        result = [*result[1:-1], (result[-1][0], result[0][1] + length)]
    return result


def _zeros(own: Along, piece: int, marks: Floats, heights: Floats) -> list[float]:
    """Zeros of a piece's polynomial between its marks, those that only touch zero among them."""
    touch = 1e-13 * float(own.reach[0])
    result = [float(s) for s, h in zip(marks, heights, strict=True) if abs(h) <= touch]
    # alone, so that no neighbour has a say at its ends
    alone = Along(own.edges[piece : piece + 2], own.series[piece : piece + 1])
    for (low, high), (first, last) in zip(pairwise(marks), pairwise(heights), strict=True):
        if first * last < 0 and min(abs(first), abs(last)) > touch:
            result.append(zero_between(alone, 0.0, low, high))
    return result
