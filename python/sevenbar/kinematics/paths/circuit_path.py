"""A circuit by its own arc length: all joint values as polynomials, through dead centres and change points.

    ds^2 = sum (dq_c)^2,   lengths as shares of the size, balls left out                                (1)

On a piece one joint drives that moves all along it, so a dead centre of the input is a place like any other.
A change point lies in the middle of its piece, with no node on it: values on both sides carry the motion
straight across.

Source: docs/theory_free.md, (1) to (3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from sevenbar.arrays import Floats, Integers
from sevenbar.curves.along import Along
from sevenbar.curves.stationary import coefficients, nodes, nodes_between, series_through
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.numbers.sensitivity import Numbers

#: Nodes on a piece: even, so that none lies in its middle.
TERMS = 24

#: Length of a piece before any is divided [rad, or shares of the size].
PIECE = 0.5

#: Half the length of the piece round a change point, at most, and as a part of the way to the next one.
ROUND_CHANGE_POINT = 0.25
TO_THE_NEXT = 0.35

#: A piece is fine enough where the last terms of its series are below this [rad, or shares of the size].
RESOLVED = 2e-13

#: Last terms below this part of the greatest value, or of a radian or the size, are rounding.
NOISE = 4e-15

#: Newton's steps from arc lengths to the driver's values, at most, and one after which only rounding is left.
INVERSIONS = 12
INVERTED = 1e-15

#: Most times a piece is divided.
DIVISIONS = 9

#: A joint drives a piece if it moves by this part of the way or more all along.
DRIVES = 0.15

#: Rows nearer to each other than this part of the circuit are one.
APART = 1e-6

#: An input that misses a value by less [rad, or shares of the size] at a dead centre, or at the seam of a
#: closed circuit, has it: both are known to rounding.
HAS = 1e-12

#: Where the passive joints' volume is below this part of its greatest, and least, a change point may be near.
NEAR_CHANGE_POINT = 0.05

#: Rows a turn from which a path can be followed.
ENOUGH_ROWS = 180


class NotFollowedError(RequestError):
    """A circuit cannot be followed along its own length."""


@dataclass(frozen=True, eq=False)
class CircuitPath:
    """A circuit by its arc length s, from 0 to `length`; closed ones go on by whole lengths.

    `poses` has all columns of the word by s, `drivers` (m,) the column that drives each piece; `gain`
    (columns,) is what a closed circuit adds to them. `tail` [rad, or shares of the size] is the greatest of
    the last terms of a joint's series.
    """

    poses: Along
    drivers: Integers
    gain: Floats
    closed: bool
    tail: float
    #: Places of change points, and of poses that are nearly ones.
    centres: Floats
    input: int

    @property
    def length(self) -> float:
        """The length of the circuit."""
        return self.poses.length

    @cached_property
    def input_marks(self) -> Floats:
        """Edges and dead centres of the input, between which it goes one way."""
        return np.union1d(self.poses.edges, self.poses.stationary(self.input))

    def places(self, value: float, *, turns: bool) -> Floats:
        """Where the input has a value, an angle by whole turns, in order."""
        heights = self.poses.part(self.input).at(self.input_marks)[:, 0]
        # of a slide by its own way, of an angle by a radian, and by the turns that were counted
        touch = HAS * max(1.0 if turns else float(np.ptp(heights)), abs(value))
        if not turns:
            return self.poses.crossings(self.input, value, self.input_marks, touch)
        first = math.ceil((heights.min() - value) / math.tau - APART)
        last = math.floor((heights.max() - value) / math.tau + APART)
        result = [
            self.poses.crossings(self.input, value + math.tau * k, self.input_marks, touch)
            for k in range(first, last + 1)
        ]
        places = np.unique(np.concatenate(result)) if result else np.empty(0)
        # an edge that is a dead centre up to rounding is one place
        places = places[np.diff(places, prepend=-np.inf) > HAS * self.length]
        if self.closed and places.size > 1 and places[-1] - places[0] > self.length * (1 - APART):
            places = places[:-1]
        return places


class PathBuilder:
    """Follows the rows of a circuit, piece by piece."""

    def __init__(self, numbers: Numbers, circuit: Circuit) -> None:
        self.numbers, self.circuit = numbers, circuit
        self.smooth = np.flatnonzero(~numbers.is_ball)
        self.drivers = [int(c) for c in self.smooth if c not in numbers.held]
        rows = numbers.poses(circuit.q)
        rows = rows[np.isfinite(rows).all(axis=1)]
        if len(rows) < 4:
            raise NotFollowedError("circuit: it has no rows to follow; ask a motion with more samples")
        # turns of a ball that holds a spin come from arctangents
        spun = [c for joint in numbers.spun for c in numbers.word.freedoms[joint][0].columns]
        rows[:, spun] = np.unwrap(rows[:, spun], axis=0)
        gain = np.zeros(rows.shape[1])
        if circuit.closed:
            turns = np.round((rows[-1] - rows[0]) / math.tau)
            gain[numbers.turns] = math.tau * turns[numbers.turns]
            rows = np.concatenate([rows, rows[:1] + gain])
        self.gain = gain
        steps = self._steps(rows)
        keep = np.append(True, steps > APART * steps.sum())
        if circuit.closed and not keep[-1]:
            # the last row is the first once more
            keep[np.flatnonzero(keep)[-1]], keep[-1] = False, True
        rows = rows[keep]
        chords = np.concatenate([[0.0], np.cumsum(self._steps(rows))])
        self.lap = float(chords[-1])
        if circuit.closed:
            # a lap more, so that pieces may begin anywhere
            rows = np.concatenate([rows, rows[1:] + gain])
            chords = np.concatenate([chords, chords[1:] + self.lap])
        self.rows, self.chords = rows, chords
        slopes = np.diff(rows[:, self.smooth] / numbers.scales[self.smooth], axis=0)
        self.directions = slopes / np.diff(chords)[:, None]

    def _steps(self, rows: Floats) -> Floats:
        scaled = rows[:, self.smooth] / self.numbers.scales[self.smooth]
        return np.asarray(np.linalg.norm(np.diff(scaled, axis=0), axis=1))

    def _change_points(self) -> Floats:
        """Chords of the first lap at which the volume of the passive joints' screws is least and small."""
        inner = (self.directions[:-1] + self.directions[1:]) / 2
        best = np.abs(inner).argmax(axis=1)
        volumes = np.full(len(inner), np.nan)
        for k, column in enumerate(self.smooth):
            mine = np.flatnonzero(best == k)
            if mine.size and int(column) in self.drivers:
                at = self.rows[mine + 1]
                # by how far one joint moves, the volume without it is the same for all
                sides = self.numbers.driven(int(column)).followed(at[:, column], at)[1][0]
                volumes[mine] = np.abs(sides) / np.abs(inner[mine, k])
        chords = self.chords[1:-1]
        volumes = np.where(np.isfinite(volumes), volumes, 0.0)
        result = []
        least = NEAR_CHANGE_POINT * volumes.max()
        for j in range(1, len(volumes) - 1):
            if volumes[j] > least or volumes[j] > volumes[j - 1] or volumes[j] >= volumes[j + 1]:
                continue
            a, b, c = volumes[j - 1 : j + 2]
            # zero along a line from either side
            low, high = chords[j - 1], chords[j + 1]
            result.append(float((low * c + high * a) / (a + c)) if b > 0.1 * min(a, c) else float(chords[j]))
        places = np.array(result)
        if not self.circuit.closed:
            return places
        return np.unique(np.round(places % self.lap, 9)) if places.size else places

    def built(self) -> CircuitPath:
        """The path; raises `RequestError` where the circuit cannot be followed."""
        centres = self._change_points()
        first, edges = 0.0, [0.0, self.lap]
        if centres.size:
            gaps = np.diff(np.append(centres, centres[0] + self.lap)) if self.circuit.closed else None
            ends = [0.0, self.lap]
            if gaps is not None:
                # the seam lies far from all
                widest = int(np.argmax(gaps))
                first = float(centres[widest] + gaps[widest] / 2)
                centres = np.sort(first + (centres - first) % self.lap)
                ends = [first, first + self.lap]
            near = np.diff(np.concatenate([[2 * ends[0] - centres[0]], centres, [2 * ends[1] - centres[-1]]]))
            half = np.minimum(ROUND_CHANGE_POINT, TO_THE_NEXT * np.minimum(near[:-1], near[1:]))
            edges = sorted([*ends, *(centres - half), *(centres + half)])
        cut = [first]
        for a, b in pairwise(edges):
            whole = centres.size and bool(np.any((centres > a) & (centres < b)))
            parts = 1 if whole else max(1, math.ceil((b - a) / PIECE))
            cut += [a + (b - a) * k / parts for k in range(1, parts + 1)]
        todo = list(pairwise(cut))
        done: list[tuple[float, int, float, Floats]] = []
        for division in range(DIVISIONS + 1):
            charts = [self._driver(a, b) for a, b in todo]
            result = self._pieces(todo, charts)
            rough: list[tuple[float, float]] = []
            for (a, b), column, piece in zip(todo, charts, result, strict=True):
                last = division == DIVISIONS
                if piece is None and last:
                    raise NotFollowedError(
                        "circuit: it cannot be followed closely enough along its own length; ask a motion "
                        "with more samples"
                    )
                if piece is None or (self._tail(piece[1]) > RESOLVED and not last):
                    rough += divided(a, b, centres)
                else:
                    done.append((a, column, *piece))
            todo = rough
            if not todo:
                break
        done.sort(key=lambda piece: piece[0])
        lengths = np.array([piece[2] for piece in done])
        series = np.stack([piece[3] for piece in done])
        path = np.concatenate([[0.0], np.cumsum(lengths)])
        chords = np.append([piece[0] for piece in done], first + self.lap)
        return CircuitPath(
            poses=Along(path, series),
            drivers=np.array([piece[1] for piece in done]),
            gain=self.gain,
            closed=self.circuit.closed,
            tail=max(self._tail(own) for own in series),
            centres=np.interp(centres, chords, path),
            input=self.circuit.input_column,
        )

    def _tail(self, series: Floats) -> float:
        last = np.abs(series[-2:, self.smooth] / self.numbers.scales[self.smooth])
        return float(last.max())

    def _within(self, a: float, b: float) -> tuple[int, int]:
        """Rows such that a and b lie between the first and the last of them."""
        low = int(np.searchsorted(self.chords, a, "right")) - 1
        high = int(np.searchsorted(self.chords, b, "left"))
        return min(max(low, 0), len(self.chords) - 2), min(high, len(self.chords) - 1)

    def _driver(self, a: float, b: float) -> int:
        low, high = self._within(a, b)
        ways = self.directions[low : max(high, low + 1)]
        same = np.where((ways > 0).all(axis=0) | (ways < 0).all(axis=0), np.abs(ways).min(axis=0), 0.0)
        for k, column in enumerate(self.smooth):
            if int(column) not in self.drivers:
                same[k] = 0.0
        k = int(same.argmax())
        return int(self.smooth[k]) if same[k] > DRIVES else -1

    def _at(self, chord: float) -> Floats:
        """A pose near a chord, on the line between two rows."""
        low = min(max(int(np.searchsorted(self.chords, chord, "right")) - 1, 0), len(self.chords) - 2)
        share = (chord - self.chords[low]) / (self.chords[low + 1] - self.chords[low])
        return np.asarray(self.rows[low] + share * (self.rows[low + 1] - self.rows[low]))

    def _closed(self, wanted: list[tuple[int, Floats]]) -> list[Floats]:
        """Poses closed with the driver's value held, in as few calls as there are drivers; else NaN."""
        out: list[Floats] = [np.full(start.shape, np.nan) for _, start in wanted]
        for column in {column for column, _ in wanted if column >= 0}:
            mine = [i for i, (own, _) in enumerate(wanted) if own == column]
            start = np.concatenate([wanted[i][1] for i in mine])
            result = self.numbers.driven(column).closed(start[:, column], start)
            counts = np.cumsum([len(wanted[i][1]) for i in mine])[:-1]
            for i, part in zip(mine, np.split(result, counts), strict=True):
                out[i] = part
        return out

    def _pieces(
        self, todo: list[tuple[float, float]], charts: list[int]
    ) -> list[tuple[float, Floats] | None]:
        """Lengths and series (terms, columns) by arc length; `None` where a joint that drives is missing."""
        usable = [i for i, column in enumerate(charts) if column >= 0]
        chords = sorted({x for i in usable for x in todo[i]})
        # both sides of an edge take its pose from one driver
        closed = self._closed([(self._driver(x, x), self._at(x)[None]) for x in chords])
        ends = {x: pose[0] for x, pose in zip(chords, closed, strict=True)}
        starts: list[tuple[int, Floats]] = []
        kept: list[int] = []
        for i in usable:
            a, b = todo[i]
            if not np.isfinite([ends[a], ends[b]]).all():
                continue
            low, high = self._within(a, b)
            inner = self.rows[low + 1 : high]
            near = np.concatenate([ends[a][None], inner, ends[b][None]])
            x = near[:, charts[i]]
            way = np.sign(x[-1] - x[0])
            if way == 0 or np.any(np.diff(x) * way <= 0):
                continue
            at = nodes_between(x[0], x[-1], TERMS)
            order = slice(None) if way > 0 else slice(None, None, -1)
            start = np.column_stack([np.interp(at, x[order], near[order, c]) for c in range(near.shape[1])])
            starts.append((charts[i], start))
            kept.append(i)
        result: list[tuple[float, Floats] | None] = [None] * len(todo)
        poses = self._closed(starts)
        whole = [k for k, own in enumerate(poses) if np.isfinite(own).all()]
        if whole:
            mine = [kept[k] for k in whole]
            both = np.array([[ends[x] for x in todo[i]] for i in mine])
            pieces = self._by_length(np.stack([poses[k] for k in whole]), [charts[i] for i in mine], both)
            for i, piece in zip(mine, zip(*pieces, strict=True), strict=True):
                result[i] = float(piece[0]), piece[1]
        return result

    def _by_length(self, poses: Floats, drivers: list[int], ends: Floats) -> tuple[Floats, Floats]:
        """Pieces by their drivers' values (m, terms, columns) as ones by arc length: lengths and series.

        `ends` (m, 2, columns) are the poses at both ends.
        """
        series = series_through(poses)
        fine = nodes(2 * TERMS)
        slopes = chebyshev.chebvander(fine, TERMS - 2) @ chebyshev.chebder(series, axis=1)
        rates = slopes[:, :, self.smooth] / self.numbers.scales[self.smooth]
        speed = coefficients(np.linalg.norm(rates, axis=2).T)
        along = chebyshev.chebint(speed, lbnd=-1)
        lengths = along.sum(axis=0)
        wanted = lengths[:, None] * (nodes(TERMS) + 1) / 2
        x = np.broadcast_to(nodes(TERMS), wanted.shape)
        for _ in range(INVERSIONS):
            terms = np.cos(np.arccos(x)[:, :, None] * np.arange(len(along)))
            step = (np.einsum("mjk,km->mj", terms, along) - wanted) / np.einsum(
                "mjk,km->mj", terms[:, :, :-1], speed
            )
            x = np.clip(x - step, -1.0, 1.0)
            if np.abs(step).max() < INVERTED:
                break
        terms = np.cos(np.arccos(x)[:, :, None] * np.arange(TERMS))
        poses = terms @ series
        for own, at, column, (start, end) in zip(poses, x, drivers, ends, strict=True):
            # the driver's own values are a line
            own[:, column] = (start[column] + end[column]) / 2 + (end[column] - start[column]) / 2 * at
        by_length = series_through(poses)
        # a piece that is too rough by its driver's values is so by its length
        rough = np.array([self._tail(own) > RESOLVED for own in series])
        by_length[rough] = series[rough]
        return lengths, np.array(
            [own if r else self._heard(own) for own, r in zip(by_length, rough, strict=True)]
        )

    def _heard(self, series: Floats) -> Floats:
        """A series without its end where that is rounding, which slopes would magnify."""
        sizes = np.abs(series) / (NOISE * np.maximum(self.numbers.scales, np.abs(series).max(axis=0)))
        last = len(series) - np.argmax(sizes[::-1] > 1, axis=0)
        return np.where(np.arange(len(series))[:, None] < last, series, 0.0)


def divided(a: float, b: float, centres: Floats, apart: float = 0.0) -> list[tuple[float, float]]:
    """The parts of a piece: halves; three where a change point lies in it, `apart` from its ends."""
    inside = centres[(centres > a + apart) & (centres < b - apart)]
    if inside.size:
        # what is round a change point stays round it
        c = float(inside[0])
        h = min(c - a, b - c) / 2
        return [(a, c - h), (c - h, c + h), (c + h, b)]
    return [(a, (a + b) / 2), ((a + b) / 2, b)]


def path_of(numbers: Numbers, circuit: Circuit) -> CircuitPath:
    """The path of a circuit whose rows cover it; see `CircuitPath`."""
    return PathBuilder(numbers, circuit).built()
