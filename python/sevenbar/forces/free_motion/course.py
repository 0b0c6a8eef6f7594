"""A linkage as one body on its circuit: the mass that arc length sees, potential energy, damping.

    T = m(s) s'^2 / 2,    m s'' + m' s'^2 / 2 = -U' - D s' + torque dx/ds                                 (4)

U is the potential energy of weights and springs less the work of loads, which depends on the place only, so
on a closed circuit it may rise or fall with every lap.

Source: docs/theory_free.md, (4) and (5).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from sevenbar.arrays import Floats
from sevenbar.curves.along import Along
from sevenbar.curves.stationary import nodes_between, series_through
from sevenbar.errors import RequestError

#: Points of Gauss's rule for the rise of U over a short way, and how short, in pieces.
GAUSS = 20
SHORT = 0.5

#: Nodes of a piece for integrals over it.
TERMS = 20

#: A mass below this part of its greatest is zero: a link that stands still leaves no more than rounding.
MASSLESS = 1e-12

#: Places nearer than this part of the circuit are one.
SAME = 1e-10

#: Why there is no motion through a place without mass, and what to do.
MASSLESS_WAY = (
    "bodies: the motion reaches a pose in which nothing that has a mass moves, so its speed there has no "
    "bound; give a mass to a link that moves in this pose, as [[body]] of the crank or the coupler"
)

#: The columns of `EnergyCourse.quantities`.
MASS, SLOPE, DAMPING, INPUT, WINDING = range(5)


@dataclass(frozen=True, eq=False)
class EnergyCourse:
    """What moves and what acts along a circuit; closed ones go on for ever, by laps.

    `quantities` by arc length s from 0: m [J s^2], U' [J], D [J s], d(input)/ds [rad, or length], and what
    U' gains with each lap from springs in joints that wind up [J], all for s in radians. `breaks` are places
    where U' jumps or kinks, `start` [J] is the potential energy of weights and springs at s = 0.
    """

    quantities: Along
    closed: bool
    breaks: Floats
    start: float
    tail: float

    @property
    def length(self) -> float:
        """One lap."""
        return self.quantities.length

    def driven_by(self, torque: float) -> EnergyCourse:
        """The same with a constant torque [J for a radian, or by the length unit] at the input."""
        if not torque:
            return self
        series = self.quantities.series.copy()
        series[:, :, SLOPE] -= torque * series[:, :, INPUT]
        return replace(self, quantities=Along(self.quantities.edges, series))

    def between(self, low: float, high: float) -> EnergyCourse:
        """The part from a place to a place, on a closed course of a lap at most: an open one from 0 on."""
        length, one = self.length, SAME * self.length
        laps = np.arange(np.floor(low / length), np.floor(high / length) + 1) if self.closed else np.zeros(1)

        def within(places: Floats) -> Floats:
            result = np.unique(np.round((places + laps[:, None] * length).ravel(), 15))
            return np.asarray(result[(result > low + one) & (result < high - one)])

        edges = np.concatenate([[low], within(self.quantities.edges), [high]])
        edges = edges[np.append(np.diff(edges) > one, True)]
        middle = (edges[:-1] + edges[1:]) / 2
        lap = self.laps(middle)
        own = self.quantities.edges
        pieces = np.clip(np.searchsorted(own, middle - lap * length, "right") - 1, 0, len(own) - 2)
        terms = self.quantities.series.shape[1]
        before = lap * length
        grid = nodes_between(edges[:-1] - before, edges[1:] - before, terms)
        values = self.quantities.on(np.repeat(pieces, terms), grid.ravel()).reshape(*grid.shape, -1)
        # how far springs are wound up on a lap is part of the slope there
        values[:, :, SLOPE] += lap[:, None] * values[:, :, WINDING]
        values[:, :, WINDING] = 0.0
        start = float(self.at(np.array([low]))[2][0])
        return EnergyCourse(
            Along(edges - low, series_through(values)), False, within(self.breaks) - low, start, self.tail
        )

    @cached_property
    def _all(self) -> Along:
        """m, U', D, dx/ds, winding, and the integrals of U' and of winding."""
        integrals = self.quantities.part(SLOPE, WINDING).integral.series
        series = np.concatenate([np.pad(self.quantities.series, ((0, 0), (0, 1), (0, 0))), integrals], axis=2)
        return Along(self.quantities.edges, series)

    @cached_property
    def pushing(self) -> Floats:
        """The series (pieces, terms, 6) of `quantities` and of m'."""
        by_place = np.pad(self.quantities.slope.series[:, :, :1], ((0, 0), (0, 1), (0, 0)))
        return np.concatenate([self.quantities.series, by_place], axis=2)

    @cached_property
    def _gains(self) -> tuple[float, float]:
        """What U gains on the first lap, and by how much more on each next one."""
        last = self._all.series[-1].sum(axis=0)
        return float(last[-2]), float(last[-1])

    @property
    def gain(self) -> float:
        """What U gains on a lap; 0 where that is rounding."""
        return self._gains[0] if abs(self._gains[0]) > 1e-12 * self.steepest * self.length else 0.0

    @property
    def repeats(self) -> bool:
        """Whether U is the same on every lap."""
        return self.closed and not self.gain and not self.winds

    @cached_property
    def winds(self) -> bool:
        """Whether a spring winds up from lap to lap."""
        return bool(self.quantities.series[:, :, WINDING].any())

    def laps(self, s: Floats) -> Floats:
        """The lap (j,) of places (j,), counted from 0."""
        return np.floor(s / self.length) if self.closed else np.zeros_like(s)

    def at(self, s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """m, U', U and D, each (j,), at places (j,) on any lap; U is `start` at 0."""
        s = np.asarray(s, dtype=np.float64)
        lap = self.laps(s)
        own = self._all.at(s - lap * self.length)
        energy = self._energy(own[:, 5], own[:, 6], lap)
        return own[:, MASS], own[:, SLOPE] + lap * own[:, WINDING], energy, own[:, DAMPING]

    def _energy(self, first: Floats, wound: Floats, lap: Floats) -> Floats:
        """U on laps from its value on the first and what winding adds."""
        more = self._gains[1] if self.winds else 0.0
        return self.start + first + lap * wound + lap * self.gain + more * lap * (lap - 1) / 2

    @cached_property
    def _nodes(self) -> Floats:
        """m, U and winding (pieces, terms, 3) at the nodes of the first lap's pieces."""
        edges = self.quantities.edges
        grid = nodes_between(edges[:-1], edges[1:], TERMS)
        own = self._all.on(np.repeat(np.arange(len(grid)), TERMS), grid.ravel())
        return own.reshape(*grid.shape, -1)[:, :, [MASS, 5, 6]]

    def at_nodes(self, pieces: npt.NDArray[np.int64], laps: Floats) -> tuple[Floats, Floats]:
        """M and U (j, terms) at the nodes of pieces (j,) on laps (j,)."""
        own = self._nodes[pieces]
        return own[:, :, 0], self._energy(own[:, :, 1], own[:, :, 2], laps[:, None])

    def whole_pieces(
        self, starts: Floats, ends: Floats
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
        """The pieces (j,) on which stretches (j,) lie, and whether these are all of them."""
        edges, middle = self.quantities.edges, (starts + ends) / 2
        before = self.laps(middle) * self.length
        piece = np.clip(np.searchsorted(edges, middle - before, "right") - 1, 0, len(edges) - 2)
        off = np.abs(starts - before - edges[piece]) + np.abs(ends - before - edges[piece + 1])
        return piece, off <= 1e-13 * np.maximum(self.length, np.abs(middle))

    def slope_on(self, lap: float) -> Along:
        """U' on a lap, by places on the first one."""
        series = self.quantities.series
        return Along(self.quantities.edges, series[:, :, [SLOPE]] + lap * series[:, :, [WINDING]])

    @cached_property
    def _slopes(self) -> Along:
        return self.quantities.part(*((SLOPE, WINDING) if self.winds else (SLOPE,)))

    def slope(self, s: Floats) -> Floats:
        """U' (j,) at places (j,)."""
        lap = self.laps(s)
        own = self._slopes.at(s - lap * self.length)
        return np.asarray(own[:, 0] + lap * own[:, 1]) if self.winds else own[:, 0]

    def rise(self, a: Floats | float, b: Floats) -> Floats:
        """U(b) - U(a), (j,): over short ways the integral of U', which loses no digits."""
        a, b = np.broadcast_arrays(np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64))
        out = self.at(b)[2] - self.at(a)[2]
        near = np.flatnonzero((np.abs(b - a) < SHORT * self.shortest) & ~self._parted(a, b))
        if near.size:
            out[near] = (b - a)[near] * self.mean_slope(a[near], b[near])
        return np.asarray(out)

    def _parted(self, a: Floats, b: Floats) -> npt.NDArray[np.bool_]:
        """Whether a break lies between places (j,), where no polynomial leads across."""
        if not self.breaks.size:
            return np.zeros(a.shape, dtype=bool)
        count, laps = len(self.breaks), (self.laps(a), self.laps(b))
        first, second = (
            np.searchsorted(self.breaks, s - lap * self.length) + count * lap
            for s, lap in zip((a, b), laps, strict=True)
        )
        return np.asarray(first != second)

    def mean_slope(self, a: Floats, b: Floats) -> Floats:
        """The mean of U' (j,) over short ways from a to b, (j,) each."""
        points, weights = _GAUSS
        where = a[:, None] + (b - a)[:, None] * (points + 1) / 2
        return np.asarray(self.slope(where.ravel()).reshape(where.shape) @ weights / 2)

    @cached_property
    def massless(self) -> Floats:
        """Places (j,) on the first lap where nothing with a mass moves, in order."""
        own = self.quantities.part(MASS)
        places = np.union1d(own.edges, own.stationary(0))
        return places[self.is_massless(own.at(places)[:, 0])]

    def is_massless(self, mass: Floats) -> npt.NDArray[np.bool_]:
        """Whether masses m (j,) are zero."""
        return np.asarray(mass <= MASSLESS * self.quantities.reach[MASS])

    def refuse_massless(self, low: float, high: float) -> None:
        """Raises `RequestError` where a motion from `low` to `high` reaches a place without mass.

        There s' of any energy has no bound: links without mass would turn what moves back at once.
        """
        if not self.massless.size:
            return
        off = SAME * self.length
        first, last = self.laps(np.array([low, high]))
        laps = np.arange(first - 1, last + 2)
        places = (self.massless + laps[:, None] * self.length).ravel() if self.closed else self.massless
        if np.any((places >= low - off) & (places <= high + off)):
            raise RequestError(MASSLESS_WAY)

    @cached_property
    def steepest(self) -> float:
        """The greatest size of U'."""
        return float(self.quantities.reach[SLOPE])

    @cached_property
    def highest(self) -> float:
        """The greatest size of U on the first lap, from its own integral."""
        return float(self._all.reach[5])

    @cached_property
    def shortest(self) -> float:
        """The length of the shortest piece."""
        return float(np.diff(self.quantities.edges).min())

    @cached_property
    def _first_marks(self) -> Floats:
        return self._marked(0.0)

    def _marked(self, lap: float) -> Floats:
        own = self.slope_on(lap)
        if not own.series.any():
            return own.edges
        zeros = own.crossings(0, 0.0, np.union1d(own.edges, own.stationary(0)))
        return np.unique(np.concatenate([own.edges, zeros]))

    def marks(self, laps: Floats) -> Floats:
        """Places on laps (j,), edges among them, between which U rises or falls all the way, in order."""
        result = [self._marked(lap) if self.winds and lap else self._first_marks for lap in laps.tolist()]
        return np.unique(np.concatenate(result) + np.repeat(laps, [len(own) for own in result]) * self.length)


_GAUSS = legendre.leggauss(GAUSS)
