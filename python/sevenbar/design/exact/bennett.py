"""The Bennett linkage whose coupler takes three given poses, by two factorings of a motion polynomial.

As dual quaternions the poses span a plane of seven-dimensional projective space, which meets Study's
quadric in a conic: the coupler motion of the linkage. With P_1 = 1 and s_ij the products of Study's quadric
it is

    C(t) = t^2 + t (s_23 / s_13 + P_2 - s_12 / s_13 P_3) + s_23 / s_13 P_2                                (1)

at t = infinity the first pose, at 0 the second, at -s_23 / s_13 the third. The norm C C* is a real polynomial
of degree four without real zeros, so it has two real factors M_1, M_2 of degree two. C less M_1 is linear,
with the zero h_2, and

    C(t) = (t - h_1) (t - h_2),    h_1 = -C_1 - h_2                                                       (2)

are two turns: h_1 about a fixed axis, h_2 about one of the body. M_2 gives the other dyad. The 6 factors of
degree two over the complex numbers give 6 dyads, of which these two are always real, and no others are.

Source: docs/theory_design.md, (36) and (37); K. Brunnthaler, H.-P. Schröcker, M. Husty, "A new method for the
synthesis of Bennett mechanisms", Proc. CK 2005; G. Hegedüs, J. Schicho, H.-P. Schröcker, "Factorization of
rational curves in the Study quadric", Mech. Mach. Theory 69 (2013), 142.
"""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.design.exact.answers import ExactAnswers
from sevenbar.design.exact.bilinear import Complexes
from sevenbar.design.exact.dyads import Dyad
from sevenbar.design.exact.given import Displacements, poses_given
from sevenbar.design.exact.lines import line_dyad
from sevenbar.design.exact.loops import all_loops, drawn
from sevenbar.design.exact.spherical import refuse_one_axis
from sevenbar.errors import RequestError, ends_here
from sevenbar.kinematics.loop.rigid import quaternion

#: Dyads RR of three poses over the complex numbers: factors of degree two of a norm of degree four.
DYADS = 6

#: Product of Study's quadric [-] of two poses below which they are turns of each other, or shifts.
NO_SCREW = 1e-10

#: Imaginary part of a norm's zero [-], and distance of two of them, below which there are no two dyads.
NO_FACTOR = 1e-7


@ends_here
def bennett_poses(poses: npt.ArrayLike, *, length_unit: str = "mm") -> ExactAnswers:
    """The one Bennett linkage whose coupler takes three poses (3, 4, 4), driven at either end.

    Raises `RequestError` where poses are equal, or two of them turns or shifts of each other, or their
    rotations have one axis: the linkage is then a limit that is none.

        >>> from sevenbar.kinematics.loop.rigid import about, pose
        >>> turns = [about(2, 0.5 * i) @ about(0, 0.2 * i * i) for i in range(3)]
        >>> found = bennett_poses(pose(turns, [(0, 0, 0), (10, 4, 2), (15, 9, 8)]))
        >>> found.real, [answer.linkage.motion().motion_type for answer in found.answers]
        (2, ['double-crank', 'double-crank'])
    """
    task = poses_given(poses, 3, 3)
    refuse_one_axis(task.turns, "poses")
    c1, c0 = _conic(task)
    zeros = _zeros(c1, c0)
    count = sum(_is_dyad(c1, c0, factor(c1, c0, -x - y, x * y)) for x, y in combinations(zeros, 2))
    dyads = []
    for z in zeros[zeros.imag > 0]:
        moving = factor(c1, c0, -2 * z.real, abs(z) ** 2)
        dyads.append(_dyad((-c1 - moving).real, moving.real, task))
    answers = all_loops(dyads, task, "Bennett linkage", length_unit)
    how = "quadratic factors of a norm of degree four without real zeros, two of them real"
    return ExactAnswers(
        "3 poses in space", "dyads", DYADS, count, len(dyads), answers, how, drawn(dyads, task)
    )


def times(a: Complexes, b: Complexes) -> Complexes:
    """The product (8,) of dual quaternions, (w, x, y, z) and the dual part after them."""
    return np.concatenate([_product(a[:4], b[:4]), _product(a[:4], b[4:]) + _product(a[4:], b[:4])])


def _product(a: Complexes, b: Complexes) -> Complexes:
    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.append(a[0] * b[0] - a[1:] @ b[1:], vector)


def _conjugate(a: Complexes) -> Complexes:
    return np.asarray(a * np.array([1, -1, -1, -1, 1, -1, -1, -1]))


def _inverse(a: Complexes) -> Complexes:
    norm = times(a, _conjugate(a))
    # of a dual number: 1 / (n + e m) = 1 / n - e m / n^2
    back = np.zeros(8, complex)
    back[0], back[4] = 1 / norm[0], -norm[4] / norm[0] ** 2
    return times(_conjugate(a), back)


def _conic(task: Displacements) -> tuple[Complexes, Complexes]:
    """C_1 and C_0 (8,) of (1)."""
    p = np.zeros((3, 8), complex)
    p[0, 0] = 1.0
    for i, (turn, shift) in enumerate(zip(task.turns, task.shifts, strict=True), 1):
        p[i, :4] = quaternion(turn)
        p[i, 4:] = _product(np.append(0j, shift / 2), p[i, :4])
    study = (p[:, :4] @ p[:, 4:].T).real
    study = study + study.T
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if abs(study[i, j]) < NO_SCREW:
            raise RequestError(
                f"poses[{j}]: is a turn about one line, or a shift, of poses[{i}]; a Bennett linkage needs "
                "screws that turn and slide: change one of them"
            )
    ratio, share = study[1, 2] / study[0, 2], study[0, 1] / study[0, 2]
    return np.asarray(ratio * p[0] + p[1] - share * p[2]), np.asarray(ratio * p[1])


def norm_of(c1: Complexes, c0: Complexes) -> Floats:
    """The coefficients (5,) of `C C*`, the highest first; its dual part vanishes."""
    a, b = c1[:4], c0[:4]
    return np.array([1.0, 2 * a[0], a @ a + 2 * b[0], 2 * (a @ b), b @ b]).real


def _zeros(c1: Complexes, c0: Complexes) -> Complexes:
    """The four zeros of the norm, two and two conjugate."""
    zeros = np.roots(norm_of(c1, c0)).astype(complex)
    scale = float(np.abs(zeros).max())
    apart = min(abs(x - y) for x, y in combinations(zeros, 2))
    if np.abs(zeros.imag).min() < NO_FACTOR * scale or apart < NO_FACTOR * scale:
        raise RequestError("poses: the dyads of these three coincide or are at infinity; change one of them")
    return zeros


def factor(c1: Complexes, c0: Complexes, m1: complex, m0: complex) -> Complexes:
    """h_2 (8,) of (2) by the factor `t^2 + m1 t + m0` of the norm."""
    one = np.eye(8, dtype=complex)[0]
    return -times(_inverse(c1 - m1 * one), c0 - m0 * one)


def _is_dyad(c1: Complexes, c0: Complexes, moving: Complexes) -> bool:
    """Whether `(t + C_1 + h_2) (t - h_2)` is the conic, and both factors are turns about lines."""
    fixed = -c1 - moving
    size = 1 + max(float(np.abs(fixed).max()), float(np.abs(moving).max())) ** 2
    off = [*(times(fixed, moving) - c0), *(h[1:4] @ h[5:] for h in (fixed, moving)), fixed[4], moving[4]]
    return bool(np.abs(off).max() < NO_FACTOR * size)


def _dyad(fixed: Floats, moving: Floats, task: Displacements) -> Dyad:
    """The dyad RR of two turns: the vector part of each is its line, a direction and a moment."""
    lines = []
    for turn in (fixed, moving):
        length = math.hypot(*turn[1:4])
        direction, moment = turn[1:4] / length, turn[5:] / length
        lines.append((direction, np.cross(direction, moment)))
    (a, p), (b, q) = lines
    b = b if a @ b >= 0 else -b
    return line_dyad(a, b, p, q, "RR", task)
