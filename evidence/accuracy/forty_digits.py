"""One row of a circuit beside numbers of more than forty digits: joints, and a point of a link.

The references are `precise_loops` (any loop, from the product round it) and, for the RSSR, `reference_rssr`
(from the distance of its two balls): poses by Newton's method, derivatives by differences, in 60 and 80
digits.

Scales: a joint's position in radians, a slide and a place relative to the longest link. A rate of order k in
parts of the greatest component of the exact vector in the same row, or, where that is smaller, of the input's
speed to the power k: beside an output dead centre a velocity passes zero and has no relative error.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy import precise_loops, reference_rssr
from evidence.accuracy.precise_loops import PreciseLoop
from evidence.accuracy.reference_loops import Loop
from evidence.accuracy.reference_rssr import Rssr, Side

#: The cosine of a ball's second turn, and the sine of the coupler against the crank's axis, below which the
#: turns, and the coupler's spin, have hardly a direction: their errors there are not those of the motion.
DEFINED = 0.2

#: Value and three derivatives of each number.
Moments = list[list[mp.mpf]]


class Reference(Protocol):
    """What a reference must tell of one linkage driven by one column."""

    digits: int
    size: float
    scales: np.ndarray

    def columns(self, q: np.ndarray) -> np.ndarray:
        """The columns that have a value of their own at a pose (m,)."""

    def links(self, q: np.ndarray) -> np.ndarray:
        """The moving links, from 1, that no idle freedom carries."""

    def exact(
        self, q: np.ndarray, rates: Sequence[float], link: int, at: Sequence[float]
    ) -> tuple[Moments, Moments]:
        """All joints, and the point `at` (as written) of a link, at the input and its three rates."""


class LoopReference:
    """Any loop in 60 digits."""

    digits = precise_loops.DIGITS

    def __init__(self, linkage: sb.Linkage, column: int) -> None:
        self.loop = Loop.of(linkage)
        self.column = column
        self.size, self.scales = self.loop.size, self.loop.scales
        ends = zip(linkage.joints, self.loop.ends, strict=True)
        self.balls = [end for joint, end in ends if joint.kind == "S"]
        with mp.workdps(self.digits):
            self.precise = PreciseLoop(self.loop, column)

    def columns(self, q: np.ndarray) -> np.ndarray:
        """All but those that an idle freedom moves, and the turns of a ball that have hardly a direction."""
        kept = ~self.loop.idle(q, self.column)[1]
        for end in self.balls:
            if abs(np.cos(q[end - 1])) < DEFINED:
                kept[end - 2 : end + 1] = False
        return np.flatnonzero(kept)

    def links(self, q: np.ndarray) -> np.ndarray:
        """Those that the pose holds."""
        return np.flatnonzero(~self.loop.idle(q, self.column)[2]) + 1

    def exact(
        self, q: np.ndarray, rates: Sequence[float], link: int, at: Sequence[float]
    ) -> tuple[Moments, Moments]:
        """By the product round the loop."""
        point = self.precise.point(link, at)
        found = self.precise.along((q[self.column], *rates), q, lambda values: [*values, *point(values)])
        return found[:-3], found[-3:]


class RssrReference:
    """An RSSR of the form of Sun and Zhou in 80 digits, with its coupler and the turns of its balls."""

    digits = reference_rssr.DIGITS

    def __init__(self, linkage: sb.Linkage, column: int) -> None:
        M, N, D = (linkage.dimensions[name] for name in "MND")
        crank, coupler, rocker = linkage.lengths
        self.rssr = Rssr(
            Side(np.array([0.0, 0.0, N]), np.array([0.0, 0.0, 1.0]), np.array([crank, 0.0, N])),
            Side(np.array([M, D, 0.0]), np.array([1.0, 0.0, 0.0]), np.array([M, D + rocker, 0.0])),
            coupler,
        )
        self.driver, self.near = ("crank", 7) if column == 0 else ("rocker", 0)
        self.size, self.scales = self.rssr.size, np.ones(8)
        with mp.workdps(self.digits):
            self.precise = self.rssr.precise()

    def columns(self, q: np.ndarray) -> np.ndarray:
        """All but the turns of a ball that have hardly a direction."""
        kept = np.ones(8, bool)
        for middle in (2, 5):
            kept[middle - 1 : middle + 2] = self._spins(q) and abs(np.cos(q[middle])) >= DEFINED
        return np.flatnonzero(kept)

    def links(self, q: np.ndarray) -> np.ndarray:
        """Crank, rocker, and the coupler where its spin has a direction."""
        return np.array([1, 2, 3] if self._spins(q) else [1, 3])

    def _spins(self, q: np.ndarray) -> bool:
        return float(self.precise.coupler_sine(mp.mpf(float(q[0])), mp.mpf(float(q[7])))) >= DEFINED

    def exact(
        self, q: np.ndarray, rates: Sequence[float], link: int, at: Sequence[float]
    ) -> tuple[Moments, Moments]:
        """By the distance of the balls."""

        def measure(crank: mp.mpf, rocker: mp.mpf) -> list[mp.mpf]:
            turns = self.precise.turns(crank, rocker)
            return [crank, *turns, rocker, *self.precise.point(link, at, crank, rocker)]

        at_input = q[0 if self.driver == "crank" else 7]
        found = self.precise.along((at_input, *rates), q[self.near], self.driver, measure)
        return found[:-3], found[-3:]


def reference(linkage: sb.Linkage, column: int) -> Reference:
    """The one that serves a linkage driven by a column."""
    if "rssr" in linkage.description:
        return RssrReference(linkage, column)
    return LoopReference(linkage, column)


def joint_errors(
    got: np.ndarray, exact: Moments, units: np.ndarray, pace: float, turns: np.ndarray
) -> list[float]:
    """Of joints (4, m), in their units, `turns` (m,) telling the angles: four errors."""
    apart = [
        [mp.mpf(float(got[order, k])) - moments[order] for k, moments in enumerate(exact)]
        for order in range(4)
    ]
    for k in np.flatnonzero(turns):
        apart[0][k] -= 2 * mp.pi * mp.nint(apart[0][k] / (2 * mp.pi))
    errors = [max(float(abs(a)) / unit for a, unit in zip(apart[0], units, strict=True))]
    for order in (1, 2, 3):
        lengths = [float(abs(moments[order])) / unit for moments, unit in zip(exact, units, strict=True)]
        scale = max(pace**order, *lengths)
        errors.append(max(float(abs(a)) / unit for a, unit in zip(apart[order], units, strict=True)) / scale)
    return errors


def point_errors(got: np.ndarray, exact: Moments, size: float, pace: float) -> list[float]:
    """Of a point (4, 3): the greatest component of the error, relative to the size and to the scales."""
    return joint_errors(got, exact, np.full(3, size), pace, np.zeros(3, bool))


class Comparison:
    """The rows of one circuit beside a reference.

    A row's point is one of a moving link drawn from `rng`, at a place on it drawn once for the circuit:
    within half a size of the link's frame along each axis.
    """

    def __init__(
        self, linkage: sb.Linkage, circuit: sb.Circuit, against: Reference, *, rng: np.random.Generator
    ) -> None:
        self.circuit, self.against, self.rng = circuit, against, rng
        self.turns = np.array([kind == "turn" for kind in linkage.column_kinds])
        self.traces: dict[int, tuple[tuple[float, ...], sb.Trace]] = {}
        for link, frame in enumerate(linkage.point_frames[:-1], 1):
            place = against.size * rng.uniform(-0.5, 0.5, size=3)
            # as a file would write it
            at = tuple(map(float, frame[:3, :3].T @ (place - frame[:3, 3])))
            self.traces[link] = (at, circuit.point(link, (at[0], at[1], at[2])))

    def errors(self, row: int, rates: Sequence[float]) -> dict[str, list[float]]:
        """Of the joints and of one point at a row, the input moving at `rates`."""
        circuit, against = self.circuit, self.against
        q = circuit.q[row]
        pace = abs(rates[0]) / float(against.scales[circuit.input_column])
        with mp.workdps(against.digits):
            links, kept = against.links(q), against.columns(q)
            link = int(self.rng.choice(links)) if links.size else 1
            at, trace = self.traces[link]
            joints, point = against.exact(q, rates, link, at)
            values = (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)
            got = np.array([array[row, kept] for array in values])
            exact = [joints[k] for k in kept]
            found = {"joints": joint_errors(got, exact, against.scales[kept], pace, self.turns[kept])}
            if links.size:
                places = (trace.position, trace.velocity, trace.acceleration, trace.jerk)
                moved = np.array([array[row] for array in places])
                found["points"] = point_errors(moved, point, against.size, pace)
        return found
