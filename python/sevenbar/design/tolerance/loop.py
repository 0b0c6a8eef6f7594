"""The closed loop at many numbers and inputs at once: its passive joints, their rates, and points on links.

With S the screws of the columns in loop order, x the input, u the passive columns, A the screws of these,

    A u' + S_x = 0,        A u'' + sum over i < j of [S_i, S_j] q_i' q_j' = 0                              (1)

give the rates by the input. At a nominal pose let U s V^T be the singular value decomposition of A, and r
its rank. With U_r the first r columns of U, and the rest N of V, which moves nothing but an idle link,

    M = (U_r^T A; N^T)                                                                                     (2)

is square; it solves (1) and Newton's steps nearby, for redundant constraints and idle freedoms alike. Closure
and (1) are analytic in numbers and joints, so every derivative by a number is a complex step `p + i h e`,
`u + i h du/dp`: exact to rounding. A ball's columns are small turns from its nominal rotation, which have no
pose where they fail.

Arrays are components first: numbers (k, samples, rows or 1), passive columns (m, samples, rows).

Source: docs/theory_design.md, (2) to (4).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.numbers import BALL_AXES, Numbered
from sevenbar.design.tolerance.rigid import (
    Numbers,
    Rigid,
    about,
    constant,
    cross,
    moved,
    product,
    spun,
    then,
)
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.motion import Integers

#: The complex step: its square is nothing beside 1.
STEP = 1e-30

#: Newton's steps: the most, the longest [rad, or parts of the size], and one whose next is rounding.
MOST_STEPS, LONGEST, LAST = 20, 0.3, 1e-8

#: Closure error [rad, or parts of the size] that rounding leaves where the loop is ill conditioned.
NEARLY_CLOSED = 1e-9

#: Singular value [rad, parts of the size] below which the input does not determine the passive joints.
FREE = 1e-7

#: Part of a number's screw that no joint can follow: the number opens the loop.
OPENING = 1e-9

#: Steps in which poses are carried to other inputs, no farther than to the next row.
CARRIED_BY = 4

#: Axes behind the components: samples and rows.
TRAILING = 2


@dataclass(frozen=True, eq=False)
class Walk:
    """A walk round the loop: its end (1 if it closes), screws (6, ..) of the columns, frames of the links."""

    end: Rigid
    screws: list[Numbers]
    links: list[Rigid]

    def error(self) -> Numbers:
        """The closure error (6, ..) [rad, parts of the size]; where it closes its derivatives are screws."""
        r, place = self.end
        skew = np.stack([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / 2
        # half a turn has no skew part either
        far = 3.0 - (r[0, 0] + r[1, 1] + r[2, 2]).real > 2.0
        return np.concatenate([np.where(far, 1.0, skew), place])


@dataclass(frozen=True, eq=False)
class Poses:
    """Closed poses at the nominal numbers, and how the loop is solved near them.

    `rows` (n,) are their rows in the circuit, `x` (1, n) the input, `u` (m, 1, n) the passive columns, a
    ball's turns counted from its rotation in `balls`, by joint; lengths in parts of the size. `onto`
    (n, r, 6) is U_r^T and `idle` (n, d, m) N^T of (2), `side` (n,) the sign of M's determinant.
    """

    rows: Integers
    x: Floats
    u: Floats
    balls: dict[int, Floats]
    onto: Floats
    idle: Floats
    side: Floats

    def __len__(self) -> int:
        return len(self.rows)

    def only(self, kept: npt.NDArray[Any]) -> Poses:
        """Some of the poses, by a mask (n,) or places."""
        balls = {joint: turn[..., kept] for joint, turn in self.balls.items()}
        arrays = self.onto[kept], self.idle[kept], self.side[kept]
        return Poses(self.rows[kept], self.x[:, kept], self.u[..., kept], balls, *arrays)


@dataclass(frozen=True, eq=False)
class Rates:
    """All columns by the input at poses: values, first and second derivatives (columns, samples, rows)."""

    value: Numbers
    first: Numbers
    second: Numbers


class Loop:
    """The loop of a linkage's numbers, driven by one of its columns."""

    def __init__(self, whole: Numbered, input_column: int) -> None:
        self.whole = whole
        self.columns = whole.columns
        self.input = input_column
        self.passive = [k for k in range(len(self.columns)) if k != input_column]
        lengths = (abs(d.value) for d in whole.dimensions if d.kind == "length")
        self.size = max(lengths, default=0.0) or 1.0
        #: What a column's value in a circuit is in parts of here.
        self.scales = np.array([1.0 if column.turns else self.size for column in self.columns])
        #: The nominal numbers (k, 1, 1).
        self.nominal = whole.nominal[:, None, None]
        self._rank = 0

    def poses(self, q: Floats) -> Poses:
        """Closed poses at the nominal numbers from joint values (n, columns) that nearly close.

        Rows are left out that have no values, do not close, or stand at a dead centre of the input. Raises
        `NotCoveredError` where no joint follows the input.
        """
        rows = np.flatnonzero(np.isfinite(q).all(axis=1))
        values = (q[rows] / self.scales).T[:, None, :]
        balls = {}
        for k, column in enumerate(self.columns):
            if column.ball and column.axis == BALL_AXES[0]:
                first, second, third = (about(axis, values[k + i]) for i, axis in enumerate(BALL_AXES))
                balls[column.joint] = product(product(first, second), third)
        u = np.stack([0 * values[k] if self.columns[k].ball else values[k] for k in self.passive])
        rough = self._decomposed(rows, values[self.input], u, balls)
        return self._closed(rough, rough.x, self.followed(self.nominal, rough))

    def carried(self, poses: Poses, x: Floats) -> Poses:
        """The poses on the same pass at other inputs x (1, n); those are left out that are not reached."""
        u = poses.u
        for share in np.arange(1, CARRIED_BY + 1) / CARRIED_BY:
            step = replace(poses, x=poses.x + share * (x - poses.x))
            u = self.followed(self.nominal, step, u)
        return self._closed(poses, x, u)

    def _closed(self, poses: Poses, x: Floats, u: Floats) -> Poses:
        """Those of the poses whose passive columns u were found at inputs x."""
        found = np.asarray(np.isfinite(u).all(axis=(0, 1)))
        kept = poses.only(found)
        return self._decomposed(kept.rows, x[:, found], u[..., found], kept.balls)

    def _decomposed(self, rows: Integers, x: Floats, u: Floats, balls: dict[int, Floats]) -> Poses:
        """Poses with (2) at each, without those at dead centres."""
        none = np.zeros((0, 0, 0))
        bare = Poses(rows, x, u, balls, none, none, np.zeros(0))
        screws = self.screws(self.walk(self.nominal, bare, x, u))[0]
        left, values, right = np.linalg.svd(screws)
        # a pose at a dead centre alone would not tell how many equations count elsewhere
        self._rank = rank = max(self._rank, int((values > FREE).sum(axis=1).max(initial=0)))
        if rank == 0 and len(rows):
            raise NotCoveredError("tolerance: no joint follows the input, so there is nothing to be told")
        held = (values > FREE).sum(axis=1) == rank
        onto, idle = np.swapaxes(left[held][:, :, :rank], 1, 2), right[held][:, rank:, :]
        side = np.sign(np.linalg.det(np.concatenate([onto @ screws[held], idle], axis=1)))
        kept = {joint: turn[..., held] for joint, turn in balls.items()}
        return Poses(rows[held], x[:, held], u[..., held], kept, onto, idle, side)

    def walk(self, p: Numbers, poses: Poses, x: Numbers, u: Numbers) -> Walk:
        """Round the loop at numbers p, the input x (samples, rows) and passive columns u, near some poses."""
        built = self.whole.built(p)
        values = {self.input: x} | {k: u[i] for i, k in enumerate(self.passive)}
        frame = self._scaled(built.fixed[0])
        screws, links = [], []
        for k, column in enumerate(self.columns):
            q = values[k]
            if column.ball and column.axis == BALL_AXES[0]:
                frame = then(frame, (poses.balls[column.joint], constant(np.zeros(3), TRAILING)))
            direction = frame[0][:, column.axis]
            if column.turns:
                advance = built.advances[k] / self.size
                screws.append(_screw(direction, cross(frame[1], direction) + advance * direction))
                frame = spun(frame[0], column.axis, q), frame[1] + advance * q * direction
            else:
                screws.append(_screw(np.zeros_like(direction), direction))
                frame = frame[0], frame[1] + q * direction
            if column.ends:
                links.append(frame)
            frame = then(frame, self._scaled(built.fixed[k + 1]))
        return Walk(frame, screws, links)

    def _scaled(self, motion: Rigid) -> Rigid:
        return motion[0], motion[1] / self.size

    def screws(self, walk: Walk) -> Numbers:
        """A of (1), (samples, rows, 6, m)."""
        return _stacked([walk.screws[k] for k in self.passive])

    def matrix(self, walk: Walk, poses: Poses) -> Numbers:
        """M of (2), (samples, rows, m, m)."""
        told = poses.onto @ self.screws(walk)
        idle = np.broadcast_to(poses.idle, (*told.shape[:-2], *poses.idle.shape[1:]))
        return np.concatenate([told, idle], axis=-2)

    def followed(self, p: Floats, poses: Poses, start: Floats | None = None) -> Floats:
        """The passive columns (m, samples, rows) at other numbers p, at the poses' inputs, on the same pass.

        NaN where Newton's method leads nowhere, or to the other side of a dead centre of the input, where the
        determinant of M changes its sign. `start` is where it begins, the poses themselves by default.
        """
        samples = p.shape[1]
        shape = len(self.passive), samples, len(poses)
        u = np.array(np.broadcast_to(poses.u if start is None else start, shape))
        found = np.full(shape, np.nan)
        left = np.arange(samples)
        with np.errstate(all="ignore"):
            for _ in range(MOST_STEPS):
                walk = self.walk(p[:, left], poses, np.broadcast_to(poses.x, u.shape[1:]), u)
                step = self._solved(self.matrix(walk, poses), poses, walk.error())
                longest = np.abs(step).max(axis=0)
                u = u - step * np.minimum(1.0, LONGEST / np.maximum(longest, LONGEST))
                settled = ~(longest > LAST).any(axis=1)
                found[:, left[settled]] = u[:, settled]
                left, u = left[~settled], u[:, ~settled]
                if not left.size:
                    break
            found[:, left] = u
            walk = self.walk(p, poses, np.broadcast_to(poses.x, shape[1:]), found)
            closed = np.abs(walk.error()).max(axis=0) < NEARLY_CLOSED
            same = np.linalg.det(self.matrix(walk, poses)) * poses.side > 0
        found[:, ~(closed & same)] = np.nan
        return found

    def _solved(self, matrix: Numbers, poses: Poses, right: Numbers) -> Numbers:
        """The v (m, ..) of `A v = right` (6, ..) by M, whose idle directions stay."""
        told = (poses.onto @ np.moveaxis(right, 0, -1)[..., None])[..., 0]
        whole = np.zeros(matrix.shape[:-1], dtype=np.result_type(matrix, told))
        whole[..., : told.shape[-1]] = told
        try:
            solved = np.linalg.solve(matrix, whole[..., None])
        except np.linalg.LinAlgError:
            singular = np.linalg.det(matrix) == 0
            solved = np.linalg.solve(np.where(singular[..., None, None], np.nan, matrix), whole[..., None])
        return np.moveaxis(solved[..., 0], -1, 0)

    def rates(self, walk: Walk, poses: Poses, x: Numbers, u: Numbers) -> Rates:
        """All columns and their first two derivatives by the input: (1)."""
        matrix = self.matrix(walk, poses)
        first = self._all(np.ones_like(x), -self._solved(matrix, poses, walk.screws[self.input]))
        before = np.zeros_like(walk.screws[0])
        bias = np.zeros_like(before)
        for screw, rate in zip(walk.screws, first, strict=True):
            bias = bias + _bracket(before, screw) * rate
            before = before + screw * rate
        second = self._all(np.zeros_like(x), -self._solved(matrix, poses, bias))
        return Rates(self._all(x, u), first, second)

    def _all(self, x: Numbers, u: Numbers) -> Numbers:
        """All columns in loop order from the input and the others."""
        return np.insert(u, self.input, x, axis=0)

    def slopes(self, poses: Poses) -> tuple[Floats, Numbers, Numbers]:
        """du/dp (m, k, rows) at the nominal numbers, and the numbers and passive columns a complex step off.

        Both have a sample for each number, so that `imag / STEP` of what they give is its derivative.
        """
        count = len(self.nominal)
        p = self.nominal + 1j * STEP * np.eye(count)[:, :, None]
        shape = count, len(poses)
        x = np.broadcast_to(poses.x, shape)
        u = np.broadcast_to(poses.u, (len(self.passive), *shape))
        right = self.walk(p, poses, x, u).error().imag / STEP
        matrix = self.matrix(self.walk(self.nominal, poses, poses.x, poses.u), poses)
        by_p = -self._solved(np.broadcast_to(matrix, (*shape, *matrix.shape[2:])), poses, right)
        return by_p, p, u + 1j * STEP * by_p

    def opening(self, poses: Poses) -> tuple[str, ...]:
        """Numbers that cannot change alone without opening the loop, that of an overconstrained linkage."""
        count = len(self.nominal)
        p = self.nominal + 1j * STEP * np.eye(count)[:, :, None]
        shape = count, len(poses)
        x = np.broadcast_to(poses.x, shape)
        u = np.broadcast_to(poses.u, (len(self.passive), *shape))
        right = np.moveaxis(self.walk(p, poses, x, u).error().imag / STEP, 0, -1)[..., None]
        aside = np.abs(right - np.swapaxes(poses.onto, 1, 2) @ (poses.onto @ right)).max(axis=(1, 2, 3))
        units = [self.size if d.kind in ("length", "pitch") else 1 / d.scale for d in self.whole.dimensions]
        return tuple(
            name
            for name, part in zip(self.whole.names, aside * np.array(units), strict=True)
            if part > OPENING
        )

    def point(self, walk: Walk, rates: Rates, index: int, at: Numbers) -> tuple[Numbers, Numbers]:
        """A point on link `index` from 0 at `at` (3, ..) [length]: place and its derivative by the input."""
        if index == len(walk.links) - 1:
            still = np.broadcast_to(at, (3, *rates.value.shape[1:]))
            return still, np.zeros_like(still)
        place = moved(walk.links[index], at / self.size)
        velocity = np.zeros_like(place)
        for column, screw, rate in zip(self.columns, walk.screws, rates.first, strict=True):
            if column.joint <= index:
                velocity = velocity + (cross(screw[:3], place) + screw[3:]) * rate
        return place * self.size, velocity * self.size


def _screw(direction: Numbers, moment: Numbers) -> Numbers:
    return np.concatenate(np.broadcast_arrays(direction, moment))


def _stacked(screws: list[Numbers]) -> Numbers:
    """Screws (6, samples, rows) as columns of matrices (samples, rows, 6, m)."""
    shape = np.broadcast_shapes(*(screw.shape for screw in screws))
    together = np.stack([np.broadcast_to(screw, shape) for screw in screws])
    return np.ascontiguousarray(np.moveaxis(together, (0, 1), (-1, -2)))


def _bracket(one: Numbers, other: Numbers) -> Numbers:
    """The bracket of two screws (6, ..)."""
    w, v, turned, slid = one[:3], one[3:], other[:3], other[3:]
    return np.concatenate([cross(w, turned), cross(w, slid) + cross(v, turned)])
