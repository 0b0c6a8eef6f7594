"""Poses and derivatives of any single loop in 60 digits, sharing no formula with the core.

Source: the definition of a linkage alone, as in `reference_loops`: the product round the loop is the identity. Poses
come of Newton's method, derivatives by time of joints and points of central differences with a step of 1e-14: 18
digits are left of a third derivative, more of the lower ones. No derivative is written out but the Jacobian of Newton's
method, and that in double precision, which makes no digit of the result.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mpmath as mp
import numpy as np

from evidence.accuracy.differences import central_differences
from evidence.accuracy.reference_loops import Loop

#: Digits carried, and the step of the central differences.
DIGITS = 60
STEP = mp.mpf(10) ** -14


class PreciseLoop:
    """Poses and derivatives of a loop in 60 digits, from the closed product and nothing else.

    Use under `mp.workdps(DIGITS)`. Where the loop has more equations than it needs, or idle freedoms, Newton's
    method takes the fixed combination of equations that a pseudoinverse at the double-precision pose names, and
    the idle freedoms stay as they are.
    """

    def __init__(self, loop: Loop, column: int = 0) -> None:
        self.loop, self.column = loop, column
        self.fixed = [_exact(matrix) for matrix in loop.fixed]
        self.base = _exact(loop.base)
        self.turns = [mp.mpf(float(x)) for x in loop.turns]
        self.slides = [mp.mpf(float(x)) for x in loop.slides]

    def frames(self, q: Sequence[mp.mpf]) -> list[list[list[mp.mpf]]]:
        """The frame (3 rows of 4) after each one-freedom joint and after the last link, from the base on."""
        frame = [[mp.mpf(int(i == j)) for j in range(4)] for i in range(3)]
        frames = []
        for value, turns, slides, fixed in zip(q, self.turns, self.slides, self.fixed, strict=True):
            if turns:
                c, s = mp.cos(turns * value), mp.sin(turns * value)
                frame = [[c * x + s * y, c * y - s * x, z, p] for x, y, z, p in frame]
            if slides:
                frame = [[x, y, z, p + slides * value * z] for x, y, z, p in frame]
            frames.append(frame)
            frame = _times(frame, fixed)
        return [*frames, frame]

    def link(self, q: Sequence[mp.mpf], number: int) -> list[list[mp.mpf]]:
        """The own frame of a moving link, from 1, from the base on."""
        back = np.eye(4)
        back[:3, :3] = self.loop.backs[number - 1]
        return _times(self.frames(q)[self.loop.ends[number - 1]], _exact_rows(back))

    def residual(self, q: Sequence[mp.mpf]) -> list[mp.mpf]:
        """The sine of the product's turn about x, y, z, and its place relative to the size."""
        r = self.frames(q)[-1]
        turned = [(r[2][1] - r[1][2]) / 2, (r[0][2] - r[2][0]) / 2, (r[1][0] - r[0][1]) / 2]
        return turned + [row[3] / self.loop.size for row in r]

    def follower(self, q: np.ndarray) -> Callable[[mp.mpf], list[mp.mpf]]:
        """The joint values at any input close to the closed pose (m,)."""
        free = self.loop.free(self.column)
        held = self.loop.jacobian(q)[0][:, free]
        chord = np.linalg.pinv(held, rcond=1e-8) * self.loop.scales[free][:, None]
        chord_mp = [[mp.mpf(float(x)) for x in row] for row in chord]
        near = [mp.mpf(float(x)) for x in q]

        def at(angle: mp.mpf) -> list[mp.mpf]:
            values = list(near)
            values[self.column] = mp.mpf(angle)
            for _ in range(60):
                residual = self.residual(values)
                largest = mp.mpf(0)
                for k, row in zip(free, chord_mp, strict=True):
                    step = mp.fdot(zip(row, residual, strict=True))
                    values[k] -= step
                    largest = max(largest, abs(step) / self.loop.scales[k])
                # a step of the chord makes at least a thousandth of an error
                if largest < mp.mpf(10) ** -(DIGITS - 6):
                    return values
            raise ArithmeticError(f"no pose near {q} at input {angle}")

        return at

    def along(
        self,
        rates: tuple[float, float, float, float],
        q: np.ndarray,
        measure: Callable[[list[mp.mpf]], list[mp.mpf]] = list,
    ) -> list[list[mp.mpf]]:
        """Value and three derivatives by time of all that `measure` tells of the joint values.

        `rates` are the input and its three derivatives at one moment, `q` (m,) the pose in double precision.
        """
        angle, speed, acceleration, jerk = (mp.mpf(float(x)) for x in rates)
        at = self.follower(q)
        samples = []
        for k in (-2, -1, 0, 1, 2):
            t = k * STEP
            samples.append(measure(at(angle + t * (speed + t * (acceleration / 2 + t * jerk / 6)))))
        return [central_differences(values, STEP) for values in zip(*samples, strict=True)]

    def point(self, link: int, at: Sequence[float]) -> Callable[[list[mp.mpf]], list[mp.mpf]]:
        """Measures the place in the report frame of a point of a moving link, as it is written."""
        own = _exact_rows(self.loop.point_frames[link - 1])
        written = [*(mp.mpf(float(x)) for x in at), mp.mpf(1)]
        place = [mp.fdot(zip(row, written, strict=True)) for row in own] + [mp.mpf(1)]

        def measure(q: list[mp.mpf]) -> list[mp.mpf]:
            frame = self.link(q, link)
            moved = [mp.fdot(zip(row, place, strict=True)) for row in frame] + [mp.mpf(1)]
            return [mp.fdot(zip(row, moved, strict=True)) for row in self.base]

        return measure


def _exact_rows(matrix: np.ndarray) -> list[list[mp.mpf]]:
    return [[mp.mpf(float(x)) for x in row] for row in matrix[:3]]


def _exact(matrix: np.ndarray) -> list[list[mp.mpf]]:
    """Three rows of a rigid motion whose rotation is one in all digits: a rounded one stretches what it turns."""
    rows = _exact_rows(matrix)
    x = [row[0] for row in rows]
    length = mp.sqrt(mp.fdot(zip(x, x, strict=True)))
    x = [v / length for v in x]
    y = [row[1] for row in rows]
    along = mp.fdot(zip(x, y, strict=True))
    y = [v - along * u for v, u in zip(y, x, strict=True)]
    length = mp.sqrt(mp.fdot(zip(y, y, strict=True)))
    y = [v / length for v in y]
    z = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
    return [[x[i], y[i], z[i], rows[i][3]] for i in range(3)]


def _times(frame: list[list[mp.mpf]], fixed: list[list[mp.mpf]]) -> list[list[mp.mpf]]:
    return [
        [
            row[0] * fixed[0][j]
            + row[1] * fixed[1][j]
            + row[2] * fixed[2][j]
            + (row[3] if j == 3 else mp.mpf(0))
            for j in range(4)
        ]
        for row in frame
    ]
