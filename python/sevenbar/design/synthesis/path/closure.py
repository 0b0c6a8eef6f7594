"""Where a point of any loop is, and how it follows inputs and dimensions: exact derivatives by screws.

A loop is a word of steps `C = exp(S t)` about lines S (`path_word`), and closes where their product is 1.
With W the product of the steps before a step, its joint value or dimension moves all that comes after by the
screw `Ad_W S`; a dimension that moves the line itself, by a twist X (a drawn place or axis), does by

    Ad_W X - Ad_(W C) X

since `exp(X) C exp(-X)` is the step about the moved line. So one walk along the word gives the closure, the
point, and the derivatives of both by every joint value q and every dimension p; those of the passive joints
come from `F_u du = -F_x dx - F_p dp`.

Source: docs/theory_design.md, (1) and (5).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.synthesis.path.word import PointWord, Step
from sevenbar.kinematics.geometry import Point

#: Newton's steps on the closure: the most, the longest [rad, or parts of the size], the error that ends.
MOST_STEPS, LONGEST, CLOSED = 12, 0.25, 1e-13

#: An error [rad, or parts of the size] that rounding leaves where the loop is ill conditioned.
NEARLY_CLOSED = 1e-9

#: Singular values below this part of the greatest belong to idle freedoms, which stand still.
IDLE = 1e-9

#: Part of a dimension's screw that no joint can follow: the dimension opens the loop.
OPENING = 1e-7

#: Singular values of the joints' screws below this part of the greatest say nothing of what they can follow.
FREE = 1e-7

#: The axes of a ball's three turns, in the order of its columns.
_BALL = np.eye(3)[::-1]


@dataclass(frozen=True, eq=False)
class Reached:
    """A point (n, 3) at closed poses, its derivative by the input (n, 3), and by dimensions (n, 3, k)."""

    position: Floats
    by_input: Floats
    by_dimension: Floats


class Walked(NamedTuple):
    """The closure error F (n, 6), in radians and parts of the size, and the point (n, 3).

    Each with its derivatives by all columns (.., columns) and by the varied dimensions (.., k).
    """

    error: Floats
    by_column: Floats
    by_dimension: Floats
    point: Floats
    point_by_column: Floats
    point_by_dimension: Floats


class PointClosure(PointWord):
    """The closure of a draft with one point: values (all,) are those of its dimensions in the file's units.

    `varied` are the numbers, among `dimensions`, of those by which derivatives are wanted.
    """

    def __init__(self, draft: Draft, point: Point, varied: Sequence[int] = ()) -> None:
        super().__init__(draft, point, varied)
        linkage = draft.linkage
        self.input = linkage.columns.index(linkage.drive.joint)
        #: The longest dimension [length], of which closure errors are parts.
        self.size = max((abs(d.value) for d in self.dimensions if d.kind == "length"), default=0.0) or 1.0
        self._slides = np.array([kind == "slide" for kind in linkage.column_kinds])
        self._passive = [k for k in range(len(linkage.columns)) if k != self.input]

    def walk(self, values: Floats, q: Floats, *, sensitive: bool = True) -> Walked:
        """Along the word at poses q (n, columns); not `sensitive`: without derivatives by dimensions."""
        word = self.word(values)
        own = {number: place for place, number in enumerate(self.varied)} if sensitive else {}
        rows, columns = q.shape
        by_column = np.zeros((rows, 6, columns))
        by_dimension = np.zeros((rows, 6, len(own)))
        turn = np.broadcast_to(word.start[:3, :3], (rows, 3, 3))
        origin = np.broadcast_to(word.start[:3, 3], (rows, 3))
        point = point_by_column = point_by_dimension = np.empty(0)
        for count, step in enumerate((*word.steps, None)):
            if count == word.carried:
                point = turn @ word.at + origin
                point_by_column = _carried(by_column, point)
                point_by_dimension = _carried(by_dimension, point)
                for number, way in word.at_moves.items():
                    if number in own:
                        point_by_dimension[:, :, own[number]] += turn @ way
            if step is None:
                break
            axis = turn @ step.axis
            angle: Floats | float = step.turn.constant
            length: Floats | float = step.slide.constant
            column = step.turn.column
            if column is not None or own.keys() & step.turn.dimensions.keys():
                screw = np.concatenate([axis, _cross(turn @ step.place + origin, axis)], axis=1)
                if column is not None:
                    by_column[:, :, column] += screw
                    angle = angle + q[:, column]
                for number, rate in step.turn.dimensions.items():
                    if number in own:
                        by_dimension[:, :, own[number]] += rate * screw
            if step.slide.column is not None:
                by_column[:, 3:, step.slide.column] += axis
                length = length + q[:, step.slide.column]
            for number, rate in step.slide.dimensions.items():
                if number in own:
                    by_dimension[:, 3:, own[number]] += rate * axis
            if step.pitch is not None:
                number, column = step.pitch
                by_column[:, 3:, column] += values[number] / math.tau * axis
                length = length + values[number] / math.tau * q[:, column]
                if number in own:
                    by_dimension[:, 3:, own[number]] += (q[:, column] / math.tau)[:, None] * axis
            moves = {number: twist for number, twist in step.moves.items() if number in own}
            for number, twist in moves.items():
                by_dimension[:, :, own[number]] += _adjoined(turn, origin, twist)
            turn, origin = _after(turn, origin, step, angle, length)
            for number, twist in moves.items():
                by_dimension[:, :, own[number]] -= _adjoined(turn, origin, twist)
        skew = np.stack(
            [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]],
            axis=1,
        )
        # half a turn has no skew part either
        far = (3.0 - np.trace(turn, axis1=1, axis2=2) > 2.0)[:, None]
        error = np.concatenate([np.where(far, 1.0, skew / 2), origin / self.size], axis=1)
        by_column[:, 3:] /= self.size
        by_dimension[:, 3:] /= self.size
        return Walked(error, by_column, by_dimension, point, point_by_column, point_by_dimension)

    @property
    def units(self) -> Floats:
        """What is 1 of each column (columns,): a radian, or the size."""
        return np.where(self._slides, self.size, 1.0)

    def poses(self, values: Floats, q: Floats) -> Floats:
        """Rows of the analysis (n, columns) as poses of the word.

        A ball whose link is held from spinning has two turns here, about the axis before and square to it.
        """
        q = q.copy()
        column = carried = 0
        steps = self.word(values).steps if self._spun and self._linkage.form == "drawn" else ()
        for i, joint in enumerate(self._linkage.joints):
            if i in self._spun and steps:
                first, second = steps[carried].axis, steps[carried + 1].axis
                turns = [_turning(axis, q[:, column + k]) for k, axis in enumerate(_BALL)]
                turn = turns[0] @ turns[1] @ turns[2]
                square = np.cross(first, second)
                q[:, column] = np.arctan2(turn @ second @ square, turn @ second @ second)
                rest = _turning(first, -q[:, column]) @ turn @ first
                q[:, column + 1] = np.arctan2(rest @ -square, rest @ first)
                q[:, column + 2] = 0.0
                carried += 2
            else:
                carried += len(joint.columns)
            column += len(joint.columns)
        return q

    def position(self, values: Floats, q: Floats) -> Floats:
        """The point (n, 3) at poses (n, columns)."""
        return self.walk(values, q, sensitive=False).point

    def closed(self, values: Floats, x: Floats, q: Floats) -> Floats:
        """The poses (n, columns) at inputs x (n,), by Newton's method from those nearby.

        NaN where it leads nowhere, or over a dead centre of the input.
        """
        q = q.copy()
        q[:, self.input] = x
        good = np.isfinite(q).all(axis=1)
        error = np.full(len(q), np.inf)
        scales = self.units[self._passive]
        for _ in range(MOST_STEPS):
            if not good.any():
                break
            walked = self.walk(values, q[good], sensitive=False)
            residual, by_column = walked.error, walked.by_column
            error[good] = np.abs(residual).max(axis=1)
            if error[good].max() < CLOSED:
                break
            step = (_inverse(by_column[:, :, self._passive] * scales) @ residual[:, :, None])[:, :, 0]
            step *= np.minimum(1.0, LONGEST / np.maximum(np.abs(step).max(axis=1, keepdims=True), LONGEST))
            rows = np.flatnonzero(good)
            q[rows[:, None], self._passive] -= step * scales
            good &= np.isfinite(q).all(axis=1)
        q[~(error < NEARLY_CLOSED)] = np.nan
        return q

    def reached(self, values: Floats, q: Floats) -> Reached:
        """The point at closed poses (n, columns), with its exact derivatives."""
        _, by_column, by_dimension, point, point_by_column, point_by_dimension = self.walk(values, q)
        scales = self.units[self._passive]
        back = -_inverse(by_column[:, :, self._passive] * scales) * scales[:, None]
        carried = point_by_column[:, :, self._passive] @ back
        by_input = point_by_column[:, :, self.input] + (carried @ by_column[:, :, self.input, None])[:, :, 0]
        return Reached(point, by_input, point_by_dimension + carried @ by_dimension)

    def openings(self, values: Floats, q: Floats) -> tuple[int, ...]:
        """The varied dimensions that cannot change without opening the loop, at closed poses (n, columns)."""
        _, by_column, by_dimension, *_ = self.walk(values, q)
        scaled = by_column * self.units
        left, sizes, _ = np.linalg.svd(scaled, full_matrices=False)
        left = left * (sizes > FREE * sizes[:, :1])[:, None, :]
        aside = by_dimension - left @ (np.swapaxes(left, 1, 2) @ by_dimension)
        whole = np.abs(by_dimension).max(axis=(0, 1))
        worst = np.abs(aside).max(axis=(0, 1))
        opening = worst > OPENING * np.maximum(whole, 1e-300)
        return tuple(number for number, opens in zip(self.varied, opening, strict=True) if opens)


def _after(
    turn: Floats, origin: Floats, step: Step, angle: Floats | float, length: Floats | float
) -> tuple[Floats, Floats]:
    """The frames (n, 3, 3), (n, 3) after a step, by Rodrigues' formula about its line."""
    if np.ndim(length) or length:
        origin = origin + np.reshape(length, (-1, 1)) * (turn @ step.axis)
    if not (np.ndim(angle) or angle):
        return turn, origin
    changed = turn @ _less_one(step.axis, angle)
    if step.place.any():
        origin = origin - changed @ step.place
    return turn + changed, origin


def _less_one(axis: Floats, angle: Floats | float) -> Floats:
    """Rotations (n, 3, 3) about a unit axis (3,), less the identity."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    whole = np.reshape(angle, (-1, 1, 1))
    return np.asarray(np.sin(whole) * cross + 2 * np.sin(whole / 2) ** 2 * (cross @ cross))


def _turning(axis: Floats, angle: Floats) -> Floats:
    """Rotations (n, 3, 3) about a unit axis (3,)."""
    return np.asarray(np.eye(3) + _less_one(axis, angle))


def _adjoined(turn: Floats, origin: Floats, twist: Floats) -> Floats:
    """A twist (6,) of frames (n, 3, 3), (n, 3) as one of the report frame, (n, 6)."""
    spin = turn @ twist[:3]
    return np.concatenate([spin, turn @ twist[3:] + _cross(origin, spin)], axis=1)


def _cross(one: Floats, other: Floats) -> Floats:
    """Cross products of vectors (.., 3)."""
    x, y, z = one[..., 0], one[..., 1], one[..., 2]
    a, b, c = other[..., 0], other[..., 1], other[..., 2]
    return np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=-1)


def _carried(screws: Floats, point: Floats) -> Floats:
    """What screws (n, 6, k) move points (n, 3) by, (n, 3, k)."""
    spin = np.swapaxes(screws[:, :3], 1, 2)
    moved = _cross(spin, point[:, None, :]) + np.swapaxes(screws[:, 3:], 1, 2)
    return np.ascontiguousarray(np.swapaxes(moved, 1, 2))


def _inverse(matrices: Floats) -> Floats:
    """Pseudo-inverses of (n, 6, m); directions of idle freedoms stand still."""
    return np.asarray(np.linalg.pinv(matrices, rcond=IDLE))
