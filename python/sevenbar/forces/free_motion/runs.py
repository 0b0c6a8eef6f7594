"""A motion one way along a circuit without losses: time as an integral of place, and place by time.

    t = integral ds / s',    s' = sqrt(2 (E - U) / m)                                                     (6)

At a turning point c, where E = U, s = c - l (1 - w)^2 makes the integrand smooth:

    dt/dw = 2 sqrt(l m / (2 M)),    M the mean of U' from s to c                                          (7)

Source: docs/theory_free.md, (6) to (8).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from sevenbar.arrays import Floats
from sevenbar.curves.stationary import coefficients, nodes_between
from sevenbar.forces.free_motion.course import SHORT, TERMS, EnergyCourse

#: A panel is fine enough where its last terms are below this part of the first.
RESOLVED = 1e-14

#: What rounding of a place leaves, as a share of it by the length of a piece.
ROUNDING = 4e-15

#: What rounding leaves of energies and slopes, as a part of their greatest.
DIGITS = 2e-15

#: Most halvings of a panel: where an equilibrium is just passed the integrand is as sharp as rounding.
HALVINGS = 50

#: Steps of Newton's method, or halvings, from times to places.
STEPS = 60

#: What a panel does at its ends: it turns at its lower end, nowhere, or at its upper end.
LOW, PLAIN, HIGH = -1, 0, 1


@dataclass(frozen=True, eq=False)
class Run:
    """A motion from `low` up to `high`, or back; its panels in order, and times from `low` on.

    `kind`, `starts`, `ends`, `first`, `last` (m,): what a panel does, its places, and from which w to
    which w this piece of it goes; `times` (m + 1,) [s]; `rates` (m, terms) are dt/dw at the nodes.
    """

    low: float
    high: float
    kind: Floats
    starts: Floats
    ends: Floats
    first: Floats
    last: Floats
    rates: Floats

    @property
    def time(self) -> float:
        """How long it takes from `low` to `high` [s]."""
        return float(self.times[-1])

    @cached_property
    def times(self) -> Floats:
        """When each panel begins, and the end [s]."""
        return np.concatenate([[0.0], np.cumsum(self.rates @ _WEIGHTS * (self.last - self.first) / 2)])

    def _series(self, panels: npt.NDArray[np.int64]) -> tuple[Floats, Floats]:
        """Series (j, terms) of dt/dw on panels (j,), and of the time from their beginnings on."""
        series = self.rates[panels] @ _SERIES.T
        half = ((self.last - self.first) / 2)[panels]
        return series, np.asarray(chebyshev.chebint(series, lbnd=-1, axis=1) * half[:, None])

    def time_at(self, s: float) -> float:
        """When a place is passed [s]."""
        bounds = np.append(_place(self.kind, self.starts, self.ends, self.first)[0], self.high)
        i = int(np.clip(np.searchsorted(bounds, s, "right") - 1, 0, len(self.kind) - 1))
        share = (s - self.starts[i]) / (self.ends[i] - self.starts[i])
        share = min(max(share, 0.0), 1.0)
        w = {LOW: share**0.5, PLAIN: share, HIGH: 1 - (1 - share) ** 0.5}[int(self.kind[i])]
        x = (2 * w - self.first[i] - self.last[i]) / (self.last[i] - self.first[i])
        return float(
            self.times[i] + chebyshev.chebval(min(max(x, -1.0), 1.0), self._series(np.array([i]))[1][0])
        )

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Places and speeds s' (j,) of the motion upwards at times (j,) [s] from `low` on."""
        t = np.clip(t, 0.0, self.time)
        i = np.clip(np.searchsorted(self.times, t, "right") - 1, 0, len(self.kind) - 1)
        wanted = t - self.times[i]
        half = (self.last - self.first)[i] / 2
        series, integral = self._series(i)
        low, high = np.full(t.shape, -1.0), np.ones(t.shape)
        x = 2 * wanted / (self.times[i + 1] - self.times[i]) - 1
        x = np.clip(x, -1.0, 1.0)
        for _ in range(STEPS):
            terms = np.cos(np.arccos(x)[:, None] * np.arange(integral.shape[1]))
            missing = (terms * integral).sum(axis=1) - wanted
            rate = (terms[:, :-1] * series).sum(axis=1)
            low, high = np.where(missing <= 0, x, low), np.where(missing >= 0, x, high)
            step = x - missing / (rate * half)
            after = np.where((step >= low) & (step <= high), step, (low + high) / 2)
            moved = np.abs(after - x).max(initial=0.0)
            x = after
            if moved < 1e-15:
                break
        w = (self.first[i] + self.last[i]) / 2 + half * x
        terms = np.cos(np.arccos(np.clip(x, -1, 1))[:, None] * np.arange(series.shape[1]))
        place, by_w = _place(self.kind[i], self.starts[i], self.ends[i], w)
        return place, by_w / (terms * series).sum(axis=1)


def _place(kind: Floats, start: Floats, end: Floats, w: Floats) -> tuple[Floats, Floats]:
    """The place s of w, and ds/dw."""
    way = end - start
    place = np.where(
        kind == LOW, start + way * w**2, np.where(kind == HIGH, end - way * (1 - w) ** 2, start + way * w)
    )
    slope = np.where(kind == LOW, 2 * way * w, np.where(kind == HIGH, 2 * way * (1 - w), way))
    return place, slope


def run_between(
    course: EnergyCourse, low: float, high: float, turns: tuple[bool, bool], reference: tuple[float, float]
) -> Run:
    """The run from `low` to `high`, which may be turning points; `reference` is a place and T there [J]."""
    course.refuse_massless(low, high)
    marks = _inner_marks(course, low, high)
    turns_low, turns_high = turns
    reach = (high - low) / 2 if turns_low and turns_high else high - low
    low_end = low + _turn_length(course, low, high, reach, 1) if turns_low else low
    high_end = high - _turn_length(course, low, high, reach, -1) if turns_high else high
    inner = marks[(marks > low_end) & (marks < high_end)]
    # marks that nearly meet make no panel
    edges = np.concatenate([[low_end], inner, [high_end]])
    keep = np.append(np.diff(edges) > 1e-13 * course.length, True)
    edges = edges[keep]
    panels = [(PLAIN, a, b) for a, b in pairwise(edges)]
    if turns_low:
        panels.insert(0, (LOW, low, low_end))
    if turns_high:
        panels.append((HIGH, high_end, high))
    # what each does, its places, and from which w to which
    own = np.array([(*panel, 0.0, 1.0) for panel in panels]).T
    done = []
    # far laps have fewer digits left for the place on them
    resolved = max(RESOLVED, ROUNDING * max(abs(low), abs(high)) / course.shortest)
    for halving in range(HALVINGS + 1):
        _, starts, ends, first, last = own
        w = nodes_between(first, last, TERMS)
        rates, noise = _rates(course, own, w, reference)
        ends_of = np.abs(rates @ _SERIES[[0, -2, -1]].T)
        worst = ends_of[:, 1:].max(axis=1) / ends_of[:, 0]
        rough = (
            worst > np.maximum(resolved, noise) if halving < HALVINGS else np.zeros(len(first), dtype=bool)
        )
        # no finer than places are known
        rough &= (last - first) * (ends - starts) > 1e-14 * course.length
        done.append(np.vstack([own, rates.T])[:, ~rough])
        if not rough.any():
            break
        own = np.repeat(own[:, rough], 2, axis=1)
        own[4, ::2] = own[3, 1::2] = (first + last)[rough] / 2
    whole = np.concatenate(done, axis=1)
    whole = whole[:, np.lexsort((whole[3], whole[1]))]
    kind, starts, ends, first, last = whole[:5]
    rates = np.ascontiguousarray(whole[5:].T)
    return Run(low, high, kind, starts, ends, first, last, rates)


def _rates(
    course: EnergyCourse, panels: Floats, w: Floats, reference: tuple[float, float]
) -> tuple[Floats, Floats]:
    """dt/dw (m, terms) on panels (5, m) at w (m, terms), and what part of it rounding may be (m,)."""
    kind, starts, ends = panels[:3]
    rates, noise = np.empty(w.shape), np.empty(len(kind))
    piece, whole = course.whole_pieces(starts, ends)
    origin, there = reference
    apart = SHORT * course.shortest
    far = (starts > origin + apart) | (ends < origin - apart)
    whole &= (kind == PLAIN) & (w[:, 0] > 1 - 1 / TERMS**2) & (w[:, -1] < 1 / TERMS**2) & far
    if whole.any():
        mass, energy = course.at_nodes(piece[whole], course.laps((starts + ends)[whole] / 2))
        kinetic = there + float(course.at(np.array([origin]))[2][0]) - energy
        rates[whole], noise[whole] = _slowness(mass, kinetic, DIGITS * (course.highest + there))
        rates[whole] *= (ends - starts)[whole, None]
    plain = np.flatnonzero((kind == PLAIN) & ~whole)
    if plain.size:
        place, by_w = _place(kind[plain, None], starts[plain, None], ends[plain, None], w[plain])
        mass = course.at(place.ravel())[0].reshape(place.shape)
        kinetic = there - course.rise(origin, place.ravel()).reshape(place.shape)
        away = np.abs(place - origin)
        small = DIGITS * (np.where(away < apart, course.steepest * away, course.highest) + there)
        rates[plain], noise[plain] = _slowness(mass, kinetic, small)
        rates[plain] *= by_w
    for which, edge, sign in ((LOW, starts, -1.0), (HIGH, ends, 1.0)):
        own = np.flatnonzero(kind == which)
        if own.size:
            place, _ = _place(kind[own, None], starts[own, None], ends[own, None], w[own])
            mass = course.at(place.ravel())[0].reshape(place.shape)
            at = np.repeat(edge[own], w.shape[1])
            mean = sign * course.mean_slope(place.ravel(), at).reshape(place.shape)
            # at a turning point the square root of the way cancels
            rates[own], noise[own] = _slowness(mass, mean, DIGITS * course.steepest)
            rates[own] *= 2 * np.sqrt(ends - starts)[own, None]
    return rates, noise


def _slowness(mass: Floats, kinetic: Floats, small: Floats | float) -> tuple[Floats, Floats]:
    """sqrt(m / (2 T)) (m, terms), and what part of T rounding may be (m,)."""
    kinetic = np.maximum(kinetic, np.finfo(float).tiny)
    return np.sqrt(np.maximum(mass, 0.0) / (2 * kinetic)), (small / kinetic).max(axis=1)


#: From values at the nodes to a series, and to the integral from -1 to 1.
_SERIES = coefficients(np.eye(TERMS))
_WEIGHTS = chebyshev.chebint(_SERIES, lbnd=-1).sum(axis=0)


def _inner_marks(course: EnergyCourse, low: float, high: float) -> Floats:
    edges = course.quantities.edges
    if not course.closed:
        return edges
    laps = np.arange(np.floor(low / course.length), np.floor(high / course.length) + 1)
    return np.asarray((edges[:-1] + laps[:, None] * course.length).ravel())


def _turn_length(course: EnergyCourse, low: float, high: float, reach: float, way: int) -> float:
    """How far a panel goes that turns at `low` (way 1) or at `high` (way -1): to a break, or a piece."""
    place = low if way > 0 else high
    lap = float(course.laps(np.array([place]))[0])
    inside = place - lap * course.length
    edges = course.quantities.edges
    i = int(np.clip(np.searchsorted(edges, inside, "right") - 1, 0, len(edges) - 2))
    most = min(reach, float(edges[i + 1] - edges[i]))
    for k in (-1, 0, 1):
        ahead = way * (course.breaks + (lap + k) * course.length - place)
        ahead = ahead[ahead > 1e-12 * course.length]
        most = min(most, float(ahead.min(initial=np.inf)))
    return most
