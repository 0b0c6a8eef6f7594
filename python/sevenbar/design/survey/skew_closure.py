"""One RSSR with axes at any angle at many inputs: outputs, transmission, balls; with exact derivatives.

With A and B the balls and v = B - A, both at an input a and the output b, the closure is

    G = (v . v - L2^2) / 2 = 0,      b_p = -G_p / G_b,      G_b = v . B_b                                 (1)

and every other quantity q(p, b) follows the numbers p by q_p + q_b b_p. The sine of the transmission angle is
|G_b| / (L2 L3). Numbers are M, N, L1, L2, L3, D, the angle between the axes and the start of the input (8,).

Source: docs/theory_many.md, (21) and (23).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats

#: How many numbers there are: those of the linkage, and the input's start.
COUNT = 8

#: Places of the numbers.
M, N, L1, L2, L3, D, ANGLE, START = range(COUNT)


@dataclass(frozen=True, eq=False)
class Poses:
    """The poses of a linkage at inputs (k,) from its start on, each quantity with its slopes (.., 8).

    `output` (k,) [rad] on a branch, continued; `square` (k,): squared sine of the transmission angle;
    `crank`, `rocker` (k, 3): the coupler's direction from either ball in that of its side link, outwards,
    the way the ball moves, along the axis; `still` (k,): G_a / (L1 L2), zero where the output turns back.
    """

    output: Floats
    output_slopes: Floats
    square: Floats
    square_slopes: Floats
    crank: Floats
    crank_slopes: Floats
    rocker: Floats
    rocker_slopes: Floats
    still: Floats
    still_slopes: Floats


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


def poses(numbers: Floats, inputs: Floats, branch: int) -> Poses | None:
    """The poses at inputs (k,) [rad] from the start on; `None` where one is out of reach."""
    e, f, k, w = reach(numbers, inputs)
    if not (w > 0).all():
        return None
    spread = np.arctan2(np.sqrt(w), k)
    b = np.unwrap(np.arctan2(f, e) + (spread if branch else -spread))
    count = len(inputs)
    s, c = np.sin(numbers[ANGLE]), np.cos(numbers[ANGLE])
    sa, ca = np.sin(numbers[START] + inputs), np.cos(numbers[START] + inputs)
    sb, cb = np.sin(b), np.cos(b)
    zero = np.zeros(count)
    axis = np.array([s, 0.0, c])
    # up and y span the rocker's plane; with the angle between the axes up turns into the axis, that into -up
    up, y = np.array([-c, 0.0, s]), np.array([0.0, 1.0, 0.0])
    out = np.column_stack([ca, sa, zero])
    ahead = np.column_stack([-sa, ca, zero])
    out_b = cb[:, None] * y + sb[:, None] * up
    ahead_b = -sb[:, None] * y + cb[:, None] * up
    l1, l2, l3 = numbers[[L1, L2, L3]]
    tip = numbers[M] * axis + numbers[D] * y + l3 * out_b
    v = tip - l1 * out - numbers[N] * np.array([0.0, 0.0, 1.0])

    by = np.zeros((count, COUNT, 3))
    by[:, M], by[:, D] = axis, y
    by[:, N] = [0.0, 0.0, -1.0]
    by[:, L1], by[:, L3] = -out, out_b
    by[:, ANGLE] = -numbers[M] * up + l3 * sb[:, None] * axis
    by[:, START] = -l1 * ahead
    by_b = l3 * ahead_b
    g = np.einsum("kpi,ki->kp", by, v)
    g[:, L2] -= l2
    g_b = np.einsum("ki,ki->k", v, by_b)
    slopes = -g / g_b[:, None]
    v_p = by + by_b[:, None] * slopes[..., None]

    # how the rocker's frame turns with the numbers: by the output, and by the angle between the axes
    out_p = ahead_b[:, None] * slopes[..., None]
    ahead_p = -out_b[:, None] * slopes[..., None]
    out_p[:, ANGLE] += sb[:, None] * axis
    ahead_p[:, ANGLE] += cb[:, None] * axis
    axis_p = np.zeros((COUNT, 3))
    axis_p[ANGLE] = -up

    size = l2 * l3
    sine = g_b / size
    sine_p = (np.einsum("kpi,ki->kp", v_p, by_b) + l3 * np.einsum("ki,kpi->kp", v, ahead_p)) / size
    sine_p[:, L2] -= sine / l2

    frame = np.stack([out, ahead, np.tile([0.0, 0.0, 1.0], (count, 1))], axis=1)
    crank = np.einsum("kji,ki->kj", frame, v) / l2
    crank_p = np.einsum("kji,kpi->kjp", frame, v_p) / l2
    # the crank's frame turns with the start
    crank_p[:, 0, START] += crank[:, 1]
    crank_p[:, 1, START] -= crank[:, 0]
    crank_p[..., L2] -= crank / l2

    frame_b = np.stack([out_b, ahead_b, np.tile(axis, (count, 1))], axis=1)
    frame_p = np.stack([out_p, ahead_p, np.broadcast_to(axis_p, (count, COUNT, 3))], axis=1)
    rocker = -np.einsum("kji,ki->kj", frame_b, v) / l2
    rocker_p = -(np.einsum("kji,kpi->kjp", frame_b, v_p) + np.einsum("kjpi,ki->kjp", frame_p, v)) / l2
    rocker_p[..., L2] -= rocker / l2

    still = -np.einsum("ki,ki->k", v, ahead) / l2
    still_p = -np.einsum("kpi,ki->kp", v_p, ahead) / l2
    still_p[:, START] += np.einsum("ki,ki->k", v, out) / l2
    still_p[:, L2] -= still / l2
    return Poses(
        b, slopes, sine**2, 2 * sine[:, None] * sine_p, crank, crank_p, rocker, rocker_p, still, still_p
    )


def least_square(numbers: Floats, inputs: Floats) -> float:
    """The least squared sine of the transmission angle at inputs (k,); negative out of reach."""
    w = reach(numbers, inputs)[3]
    return float(w.min() / (numbers[L2] * numbers[L3]) ** 2)
