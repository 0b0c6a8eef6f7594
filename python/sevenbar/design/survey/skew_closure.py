"""One RSSR with axes at any angle at many inputs: outputs, transmission, balls; with exact derivatives.

With A and B the balls and v = B - A, both at an input a and the output b, the closure is

    G = (v . v - L2^2) / 2 = 0,      b_p = -G_p / G_b,      G_b = v . B_b                                 (1)

and every other quantity q(p, b) follows the numbers p by q_p + q_b b_p. The sine of the transmission angle is
|G_b| / (L2 L3). Numbers are M, N, L1, L2, L3, D, the angle between the axes and the start of the input (8,).
Slopes are imaginary parts: of numbers that differ by a tiny imaginary step, so does every quantity.

Source: docs/theory_many.md, (21) and (23).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sevenbar.arrays import Floats

#: How many numbers there are: those of the linkage, and the input's start.
COUNT = 8

#: Places of the numbers.
M, N, L1, L2, L3, D, ANGLE, START = range(COUNT)

#: Numbers or what follows from them: real, or complex by a tiny step.
Values = np.ndarray[Any, Any]


@dataclass(frozen=True, eq=False)
class Poses:
    """The poses of a linkage at inputs (k,) from its start on.

    `output` (.., k) [rad] on a branch, continued; `coupler` (.., k, 3): its direction from A to B. The frames
    of the side links: their direction outwards, the way their ball moves, their axis (.., k, 3).
    """

    output: Values
    coupler: Values
    crank_frame: tuple[Values, Values, Values]
    rocker_frame: tuple[Values, Values, Values]

    @property
    def square(self) -> Values:
        """The squared sine of the transmission angle (.., k)."""
        return _dot(self.coupler, self.rocker_frame[1]) ** 2

    @property
    def still(self) -> Values:
        """G_a / (L1 L2) (.., k), zero where the output turns back."""
        return -_dot(self.coupler, self.crank_frame[1])

    @property
    def crank(self) -> Values:
        """The coupler's direction from A in the crank's frame (.., k, 3)."""
        return np.stack([_dot(self.coupler, way) for way in self.crank_frame], axis=-1)

    @property
    def rocker(self) -> Values:
        """The coupler's direction from B in the rocker's frame (.., k, 3)."""
        return -np.stack([_dot(self.coupler, way) for way in self.rocker_frame], axis=-1)


def reach(numbers: Floats, inputs: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """E, F, K and W of the closure `L3 (E cos b + F sin b) = K` at inputs (k,), W negative out of reach."""
    sine, cosine = np.sin(numbers[ANGLE]), np.cos(numbers[ANGLE])
    a = numbers[START] + inputs
    along = numbers[L1] * np.cos(a)
    e = numbers[L1] * np.sin(a) - numbers[D]
    f = numbers[N] * sine - cosine * along
    z = numbers[N] * cosine - numbers[M] + sine * along
    k = 0.5 * (e * e + f * f + z * z + numbers[L3] ** 2 - numbers[L2] ** 2)
    return e, f, k, numbers[L3] ** 2 * (e * e + f * f) - k * k


def poses(numbers: Values, inputs: Floats, branch: int) -> Poses | None:
    """The poses at inputs (k,) [rad] from the start on; `None` where one is out of reach.

    Of numbers (8,), or of rows of them (.., 8) that are complex by tiny steps from one linkage.
    """
    e, f, k, w = reach(numbers.reshape(-1, COUNT)[0].real, inputs)
    if not (w > 0).all():
        return None
    spread = np.arctan2(np.sqrt(w), k)
    b: Values = np.unwrap(np.arctan2(f, e) + (spread if branch else -spread))
    m, n, l1, l2, l3, d, angle, start = np.moveaxis(numbers, -1, 0)[..., None]
    # up and y span the rocker's plane; with the angle between the axes up turns into the axis, that into -up
    axis, up = _vectors(np.sin(angle), 0, np.cos(angle)), _vectors(-np.cos(angle), 0, np.sin(angle))
    y, z = np.eye(3)[1:]
    cosine, sine = np.cos(start + inputs), np.sin(start + inputs)
    out, ahead = _vectors(cosine, sine, 0), _vectors(-sine, cosine, 0)
    ground = m[..., None] * axis + d[..., None] * y - n[..., None] * z - l1[..., None] * out

    def rocker(b: Values) -> tuple[Values, Values, Values]:
        """The rocker's direction, the way B moves, and v (.., k, 3)."""
        cosine, sine = np.cos(b)[..., None], np.sin(b)[..., None]
        out_b = cosine * y + sine * up
        return out_b, cosine * up - sine * y, ground + l3[..., None] * out_b

    if np.iscomplexobj(numbers):
        _, ahead_b, v = rocker(b)
        b = b - 1j * ((_dot(v, v) - l2**2) / 2 / (l3 * _dot(v, ahead_b)).real).imag
    out_b, ahead_b, v = rocker(b)
    return Poses(b, v / l2[..., None], (out, ahead, z), (out_b, ahead_b, axis))


def _vectors(x: Values, y: Values | int, z: Values | int) -> Values:
    result = np.zeros((*x.shape, 3), x.dtype)
    result[..., 0], result[..., 1], result[..., 2] = x, y, z
    return result


def _dot(a: Values, b: Values) -> Values:
    return np.asarray(np.einsum("...i,...i->...", a, b))
