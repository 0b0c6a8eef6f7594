"""How the joints of a linkage follow its dimensions: exact derivatives by differentiating the closure.

A closure `F(p, x, u) = 0` ties dimensions p, the input x and the passive joints u. Differentiated,

    F_u du/dp = -F_p,        F_u du/dx = -F_x                                                            (1)

For Denavit-Hartenberg rows every dimension is a joint that is held: the derivative of the loop's product by
a joint value or by a dimension is a screw (a twist of the base), that of offset and length a sliding one
along z and x of their row, that of twist a turning one about that x. F_u and F_p are then matrices of screws,
and with S the screws of the moving joints in loop order, [.,.] the bracket of two screws,

    sum S_i u_i' = 0,        sum S_i u_i'' + sum over i < j of [S_i, S_j] u_i' u_j' = 0                   (2)

give the rates by the input. The RSSR needs one equation only, `F = (|A - B|^2 - L2^2) / 2` of its two balls.

The derivatives of the *rates* by p and x take (2) at `p + i h e`, `u + i h du/dp` with h = 1e-30 and read the
imaginary part over h: exact to rounding, as no difference is formed (every step of (2) is analytic).

Source: docs/theory_design.md, (1) to (3).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.linkage import Linkage

#: Arrays of real numbers, or of complex ones within a complex step.
Numbers = npt.NDArray[Any]

#: The complex step: its square is nothing beside 1.
STEP = 1e-30

#: Newton's steps on the closure: the most, the longest [rad, or parts of the size], the error that ends them.
MOST_STEPS, LONGEST, CLOSED = 20, 0.3, 1e-13

#: An error [rad, or parts of the size] that rounding leaves where the loop is ill conditioned.
NEARLY_CLOSED = 1e-9

#: Singular value below which the passive joints of a loop are not determined, in units of radian and size.
FREE = 1e-7

#: Part of a dimension's screw that no joint can follow: the dimension opens the loop.
OPENING = 1e-9


@dataclass(frozen=True)
class Dimension:
    """A dimension of a form: its name, its kind ("length", "angle" [rad], "pitch"), its nominal value."""

    name: str
    kind: str
    nominal: float


@dataclass(frozen=True, eq=False)
class Response:
    """The output and its rates by the input on n rows, each with its derivatives by dimensions and input.

    `rates` holds y, y', y'' (n,) up to the order asked for; `by_dimension` (n, dimensions) and `by_input`
    (n,) of each.
    """

    rates: tuple[Floats, ...]
    by_dimension: tuple[Floats, ...]
    by_input: tuple[Floats, ...]


class Closure(Protocol):
    """The closure of one form of linkage, its dimensions p (k,), input x (n,), passive joints u (n, m)."""

    dimensions: tuple[Dimension, ...]
    #: The size of the linkage [length], in which lengths are measured here.
    size: float
    #: The place of the output among the passive joints.
    output: int

    def passive(self, q: Floats) -> Floats:
        """The passive joints (n, m) of rows of all joint values (n, columns)."""
        ...

    def error(self, p: Floats, x: Floats, u: Floats) -> Floats:
        """F (n, equations), in radians and parts of the size."""
        ...

    def jacobians(self, p: Numbers, x: Numbers, u: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """F_u (n, equations, m), F_x (n, equations) and F_p (n, equations, k)."""
        ...

    def rates(self, p: Numbers, x: Numbers, u: Numbers, order: int) -> tuple[Numbers, ...]:
        """y, y', y'' (n,) by the input up to an order; analytic, also for complex arguments."""
        ...


def closure_of(linkage: Linkage, input: str, output: str) -> Closure:
    """The closure of a linkage as it was written; `NotCoveredError` for a form without dimensions."""
    first, second = linkage.columns.index(input), linkage.columns.index(output)
    if linkage.form == "rssr":
        return RssrClosure(linkage, first)
    if linkage.form == "rows":
        return RowsClosure(linkage, first, second)
    raise NotCoveredError(
        "calibrate: a linkage drawn as [[joint]] has places and directions, not dimensions that a "
        "measurement could tell; write it as [rssr] or as Denavit-Hartenberg rows, [[link]]"
    )


def solve(a: Numbers, b: Numbers) -> Numbers:
    """The solution of `a v = b` for stacks (n, e, m), (n, e, r): exact, or of least squares where e > m.

    Analytic in complex arguments, so no conjugate is taken. NaN where a matrix is singular.
    """
    if a.shape[1] != a.shape[2]:
        turned = np.swapaxes(a, 1, 2)
        a, b = turned @ a, turned @ b
    try:
        return np.linalg.solve(a, b)
    except np.linalg.LinAlgError:
        return np.full((*a.shape[:1], a.shape[2], b.shape[2]), np.nan)


def followed(closure: Closure, p: Floats, x: Floats, u: Floats) -> Floats:
    """The passive joints (n, m) by Newton's method from those of a pose nearby; NaN where it leads nowhere.

    A row that comes out on the other side of a dead centre of the input, where the determinant of F_u changes
    its sign, is on another pass and so NaN too.
    """
    start = closure.jacobians(p, x, u)[0]
    u = u.copy()
    known = np.isfinite(u).all(axis=1)
    error = np.full(len(u), np.inf)
    for _ in range(MOST_STEPS):
        residual = closure.error(p, x[known], u[known])
        error[known] = np.abs(residual).max(axis=1)
        if error[known].max(initial=0.0) < CLOSED:
            break
        step = solve(closure.jacobians(p, x[known], u[known])[0], residual[:, :, None])[:, :, 0]
        with np.errstate(invalid="ignore"):
            step *= np.minimum(1.0, LONGEST / np.maximum(np.abs(step).max(axis=1, keepdims=True), LONGEST))
        u[known] -= step
        known &= np.isfinite(u).all(axis=1)
        error[~known] = np.inf
    end = closure.jacobians(p, x, u)[0]
    with np.errstate(invalid="ignore"):
        side = np.full(len(u), -1.0)
        side[known] = np.linalg.det(np.swapaxes(start[known], 1, 2) @ end[known])
    u[(error > NEARLY_CLOSED) | ~(side > 0)] = np.nan
    return u


def response(closure: Closure, p: Floats, x: Floats, u: Floats, order: int) -> Response:
    """The output and its rates up to an order (0 to 2) at closed poses, with their exact derivatives."""
    by_u, by_x, by_p = closure.jacobians(p, x, u)
    slopes = -solve(by_u, np.concatenate([by_x[:, :, None], by_p], axis=2))
    slope_x, slope_p = slopes[:, :, 0], slopes[:, :, 1:]
    rates = closure.rates(p, x, u, order)
    by_dimension = [np.empty((len(x), len(p))) for _ in rates]
    by_dimension[0] = slope_p[:, closure.output]
    by_input = [slope_x[:, closure.output]]
    if order:
        for k in range(len(p)):
            moved = p.astype(complex)
            moved[k] += 1j * STEP
            stepped = closure.rates(moved, x.astype(complex), u + 1j * STEP * slope_p[:, :, k], order)
            for into, value in zip(by_dimension[1:], stepped[1:], strict=True):
                into[:, k] = value.imag / STEP
        stepped = closure.rates(p.astype(complex), x + 1j * STEP, u + 1j * STEP * slope_x, order)
        by_input += [value.imag / STEP for value in stepped[1:]]
    return Response(tuple(np.asarray(r) for r in rates), tuple(by_dimension), tuple(by_input))


class RssrClosure:
    """The RSSR of Sun and Zhou: `F = (|A - B|^2 - L2^2) / 2` in parts of the size squared.

    A = (L1 cos alpha, L1 sin alpha, N), B = (M, D + L3 cos beta, L3 sin beta); u is the angle that does not
    drive.
    """

    names = ("M", "N", "L1", "L2", "L3", "D")

    def __init__(self, linkage: Linkage, input_column: int) -> None:
        values = linkage.dimensions
        self.dimensions = tuple(Dimension(name, "length", values[name]) for name in self.names)
        self.size = max(abs(value) for value in values.values())
        self.output = 0
        self._crank_drives = input_column == 0

    def passive(self, q: Floats) -> Floats:
        """The passive joints of rows of all joint values."""
        return q[:, -1:] if self._crank_drives else q[:, :1]

    def _balls(self, p: Numbers, x: Numbers, u: Numbers) -> tuple[Numbers, list[Numbers], list[Numbers]]:
        """A - B, and the first two derivatives of A by alpha and of -B by beta, all (n, 3)."""
        alpha, beta = (x, u[:, 0]) if self._crank_drives else (u[:, 0], x)
        m, n, l1, _, l3, d = p / self.size
        ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
        zero = np.zeros_like(ca)
        apart = np.stack([l1 * ca - m, l1 * sa - d - l3 * cb, n - l3 * sb], axis=1)
        a = [np.stack([-l1 * sa, l1 * ca, zero], axis=1), np.stack([-l1 * ca, -l1 * sa, zero], axis=1)]
        b = [np.stack([zero, l3 * sb, -l3 * cb], axis=1), np.stack([zero, l3 * cb, l3 * sb], axis=1)]
        return apart, a, b

    def error(self, p: Floats, x: Floats, u: Floats) -> Floats:
        """F (n, equations)."""
        apart, _, _ = self._balls(p, x, u)
        return np.asarray(((apart**2).sum(axis=1) - (p[3] / self.size) ** 2)[:, None] / 2)

    def jacobians(self, p: Numbers, x: Numbers, u: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """F_u, F_x and F_p."""
        apart, a, b = self._balls(p, x, u)
        by_alpha, by_beta = (apart * a[0]).sum(axis=1), (apart * b[0]).sum(axis=1)
        by_x, by_u = (by_alpha, by_beta) if self._crank_drives else (by_beta, by_alpha)
        alpha, beta = (x, u[:, 0]) if self._crank_drives else (u[:, 0], x)
        by_p = np.stack(
            [
                -apart[:, 0],
                apart[:, 2],
                apart[:, 0] * np.cos(alpha) + apart[:, 1] * np.sin(alpha),
                np.full_like(by_alpha, -p[3] / self.size),
                -apart[:, 1] * np.cos(beta) - apart[:, 2] * np.sin(beta),
                -apart[:, 1],
            ],
            axis=1,
        )
        return by_u[:, None, None], by_x[:, None], by_p[:, None, :] / self.size

    def rates(self, p: Numbers, x: Numbers, u: Numbers, order: int) -> tuple[Numbers, ...]:
        """y, y', y'' up to an order."""
        apart, a, b = self._balls(p, x, u)
        drives, follows = (a, b) if self._crank_drives else (b, a)
        f_x, f_u = ((apart * side[0]).sum(axis=1) for side in (drives, follows))
        first = -f_x / f_u
        if order < 2:
            return (u[:, 0], first)[: order + 1]
        f_xx, f_uu = ((side[0] ** 2 + apart * side[1]).sum(axis=1) for side in (drives, follows))
        f_xu = (drives[0] * follows[0]).sum(axis=1)
        return u[:, 0], first, -(f_xx + (2 * f_xu + f_uu * first) * first) / f_u


class RowsClosure:
    """Denavit-Hartenberg rows: all `Rz(theta) Tz(offset) Tx(length) Rx(twist)` multiply to the identity.

    Lengths are in parts of the size here, the slides in u and x too being lengths. `NotCoveredError` for a
    loop whose passive joints are not determined by its closure.
    """

    def __init__(self, linkage: Linkage, input_column: int, output_column: int) -> None:
        values = linkage.dimensions
        self._kinds = [joint.kind for joint in linkage.joints]
        count = len(self._kinds)
        found = []
        for i, joint in enumerate(linkage.joints, 1):
            found.append(Dimension(f"length_{i}", "length", values[f"length_{i}"]))
            found.append(Dimension(f"twist_{i}", "angle", math.radians(values[f"twist_{i}_deg"])))
            if joint.kind == "P":
                found.append(Dimension(f"angle_{i}", "angle", math.radians(values[f"angle_{i}_deg"])))
            else:
                found.append(Dimension(f"offset_{i}", "length", values[f"offset_{i}"]))
            if joint.kind == "H":
                found.append(Dimension(f"pitch_{i}", "pitch", values[f"pitch_{i}"]))
        self.dimensions = tuple(found)
        self._places = {dimension.name: k for k, dimension in enumerate(found)}
        self.size = max((abs(d.nominal) for d in found if d.kind != "angle"), default=0.0) or 1.0
        self._passive = [k for k in range(count) if k != input_column]
        self._input = input_column
        self.output = self._passive.index(output_column)
        if len(self._passive) > 6:
            raise NotCoveredError(
                f"calibrate: {len(self._passive)} joints follow one input and six equations tie them, so not "
                "all are determined; leave out what moves no other link"
            )

    def passive(self, q: Floats) -> Floats:
        """The passive joints of rows of all joint values."""
        return q[:, self._passive]

    def _walked(
        self, p: Numbers, x: Numbers, u: Numbers
    ) -> tuple[Numbers, list[Numbers], Mapping[str, Numbers]]:
        """The product of all rows (n, 4, 4), the screws (n, 6) of the joints, and those of the dimensions."""
        kind = np.result_type(p, x, u)
        frame = np.broadcast_to(np.eye(4, dtype=kind), (len(x), 4, 4))
        values = {self._input: x} | {joint: u[:, k] for k, joint in enumerate(self._passive)}
        joints: list[Numbers] = []
        dimensions: dict[str, Numbers] = {}
        for k, letter in enumerate(self._kinds):
            number = k + 1
            q = values[k]
            length, twist = p[self._places[f"length_{number}"]], p[self._places[f"twist_{number}"]]
            pitch = p[self._places[f"pitch_{number}"]] if letter == "H" else 0.0
            fixed = p[self._places[f"angle_{number}" if letter == "P" else f"offset_{number}"]]
            theta = np.full_like(q, fixed) if letter == "P" else q
            offset = q if letter == "P" else fixed + pitch * q / math.tau
            turn, slide = _turning(frame, 2), _sliding(frame, 2)
            if letter == "P":
                joints.append(slide)
                dimensions[f"angle_{number}"] = turn
            else:
                joints.append(turn + slide * (pitch / math.tau / self.size))
                dimensions[f"offset_{number}"] = slide / self.size
                if letter == "H":
                    dimensions[f"pitch_{number}"] = slide * (q / math.tau / self.size)[:, None]
            frame = frame @ _row(theta, offset / self.size, length / self.size, twist)
            dimensions[f"length_{number}"] = _sliding(frame, 0) / self.size
            dimensions[f"twist_{number}"] = _turning(frame, 0)
        # a slide's value is a length, and screws are by parts of the size
        joints = [
            s / self.size if letter == "P" else s for s, letter in zip(joints, self._kinds, strict=True)
        ]
        return frame, joints, dimensions

    def error(self, p: Floats, x: Floats, u: Floats) -> Floats:
        """F (n, equations)."""
        frame = self._walked(p, x, u)[0]
        r = frame[:, :3, :3]
        skew = np.stack([r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], axis=1)
        # half a turn has no skew part either
        far = (3.0 - np.trace(r, axis1=1, axis2=2) > 2.0)[:, None]
        return np.concatenate([np.where(far, 1.0, skew / 2), frame[:, :3, 3]], axis=1)

    def jacobians(self, p: Numbers, x: Numbers, u: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """F_u, F_x and F_p."""
        _, joints, dimensions = self._walked(p, x, u)
        by_u = np.stack([joints[k] for k in self._passive], axis=2)
        by_p = np.stack([dimensions[d.name] for d in self.dimensions], axis=2)
        return by_u, joints[self._input], by_p

    def rates(self, p: Numbers, x: Numbers, u: Numbers, order: int) -> tuple[Numbers, ...]:
        """y, y', y'' up to an order."""
        joints = self._walked(p, x, u)[1]
        by_u = np.stack([joints[k] for k in self._passive], axis=2)
        first = -solve(by_u, joints[self._input][:, :, None])[:, :, 0]
        y = u[:, self.output]
        if order < 2:
            return (y, first[:, self.output])[: order + 1]
        speeds = {self._input: np.ones_like(x)} | {j: first[:, k] for k, j in enumerate(self._passive)}
        before = np.zeros_like(joints[0])
        bias = np.zeros_like(joints[0])
        for k, screw in enumerate(joints):
            bias = bias + _bracket(before, screw) * speeds[k][:, None]
            before = before + screw * speeds[k][:, None]
        second = -solve(by_u, bias[:, :, None])[:, :, 0]
        return y, first[:, self.output], second[:, self.output]

    def opening(self, p: Floats, x: Floats, u: Floats) -> tuple[str, ...]:
        """Dimensions that cannot change alone without opening the loop: those of an overconstrained one.

        Raises `NotCoveredError` where the passive joints are not determined.
        """
        by_u, _, by_p = self.jacobians(p, x, u)
        left, values, _ = np.linalg.svd(by_u * self._scales(), full_matrices=False)
        if np.median(values.min(axis=1)) < FREE:
            raise NotCoveredError(
                "calibrate: the passive joints are not all determined by the input, so neither are dimensions"
            )
        parts = by_p * np.where([d.kind == "angle" for d in self.dimensions], 1.0, self.size)
        aside = parts - left @ (np.swapaxes(left, 1, 2) @ parts)
        worst = np.abs(aside).max(axis=(0, 1))
        return tuple(d.name for d, w in zip(self.dimensions, worst, strict=True) if w > OPENING)

    def _scales(self) -> Floats:
        return np.array([self.size if self._kinds[k] == "P" else 1.0 for k in self._passive])


def _row(theta: Numbers, offset: Numbers, length: Numbers, twist: Numbers) -> Numbers:
    """`Rz(theta) Tz(offset) Tx(length) Rx(twist)`, (n, 4, 4)."""
    c, s, ct, st = np.cos(theta), np.sin(theta), np.cos(twist), np.sin(twist)
    matrix = np.zeros((len(theta), 4, 4), dtype=np.result_type(theta, offset, length, twist))
    matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 0, 2], matrix[:, 0, 3] = c, -s * ct, s * st, length * c
    matrix[:, 1, 0], matrix[:, 1, 1], matrix[:, 1, 2], matrix[:, 1, 3] = s, c * ct, -c * st, length * s
    matrix[:, 2, 1], matrix[:, 2, 2], matrix[:, 2, 3], matrix[:, 3, 3] = st, ct, offset, 1.0
    return matrix


def _turning(frame: Numbers, axis: int) -> Numbers:
    """The screw (n, 6) of a turn about an axis of a frame: direction, then moment about the origin."""
    direction = frame[:, :3, axis]
    return np.concatenate([direction, np.cross(frame[:, :3, 3], direction)], axis=1)


def _sliding(frame: Numbers, axis: int) -> Numbers:
    direction = frame[:, :3, axis]
    return np.concatenate([np.zeros_like(direction), direction], axis=1)


def _bracket(one: Numbers, other: Numbers) -> Numbers:
    """The bracket of two screws (n, 6)."""
    w, v = one[:, :3], one[:, 3:]
    turned, moved = other[:, :3], other[:, 3:]
    return np.concatenate([np.cross(w, turned), np.cross(w, moved) + np.cross(v, turned)], axis=1)
