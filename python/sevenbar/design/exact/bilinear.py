"""Pairs of points that several bilinear forms make zero: the equations of Burmester's theory.

    a^T T_k b = 0,    k = 1 .. n,    a and b points of the complex projective plane                      (1)

(fixed and moving points of a plane, or axes of a sphere). With N(b) the rows `(T_k b)^T`, b has an a where
N(b) has rank 2 at most. Four forms do this at 6 points (the coefficient of x^2 y^2 in (x + y)^4; the 4 cubics
that are N's minors have just these in common), three on a cubic curve, two everywhere.

The four cubics times the three coordinates span all quartics that vanish at the 6 points, 9 of 15. The
monomials of degree 4 at the points span the rest, in which multiplication by one linear form divided by
another is a matrix (6, 6), whose eigenvectors are the points. Points at infinity are as good as others.

Source: docs/theory_design.md, (30).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats

Complexes = npt.NDArray[np.complex128]

#: Solutions of four forms over the complex numbers.
POINTS = 6

#: Singular value, relative to the greatest, below which the quartics of the 6 points depend on each other:
#: five poses typed to 10 digits leave 1e-6 and more, special ones 1e-15.
RANK = 1e-11

#: Distance of two solutions [-] that are one of multiplicity two, which rounding splits by its root.
DOUBLE = 1e-6

#: Imaginary part [-] of a solution that is real, after Newton's steps.
REAL = 1e-9

#: Newton's steps from an eigenvector, each of which doubles the digits.
STEPS = 4

_CUBICS = [m for m in itertools.product(range(4), repeat=3) if sum(m) == 3]
_QUARTICS = {m: i for i, m in enumerate(m for m in itertools.product(range(5), repeat=3) if sum(m) == 4)}
#: Place of each cubic monomial times x, y or z among the quartics (3, 10).
_SHIFTED = np.array(
    [[_QUARTICS[m[0] + (v == 0), m[1] + (v == 1), m[2] + (v == 2)] for m in _CUBICS] for v in range(3)]
)
#: The monomial of each product of three coordinates (27,).
_PRODUCTS = np.array(
    [_CUBICS.index((t.count(0), t.count(1), t.count(2))) for t in itertools.product(range(3), repeat=3)]
)
_SIGNS = np.zeros((3, 3, 3))
for _even in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    _SIGNS[_even], _SIGNS[_even[::-1]] = 1.0, -1.0
#: Two linear forms in general position.
_FORMS = np.array([[0.61, -0.45, 0.65], [-0.38, 0.71, 0.59]])


@dataclass(frozen=True, eq=False)
class PointPairs:
    """Solutions of (1): points a and b (n, 3) complex of length 1, with their multiplicities (n,).

    Those that are `real` (n,) are real numbers.
    """

    a: Complexes
    b: Complexes
    multiplicity: npt.NDArray[np.int64]
    real: npt.NDArray[np.bool_]


def cubic_of(forms: Floats) -> Floats:
    """The coefficients (10,) of `det N(b)` of three forms (3, 3, 3), by the monomials of `b`."""
    cube = np.einsum("abc,ai,bj,ck->ijk", _SIGNS, forms[0], forms[1], forms[2])
    return np.asarray(np.bincount(_PRODUCTS, cube.ravel(), minlength=10), dtype=np.float64)


def solutions(forms: Floats) -> PointPairs | None:
    """All solutions of four forms (4, 3, 3); `None` where there are infinitely many."""
    forms = forms / np.maximum(np.abs(forms).max(axis=(1, 2), keepdims=True), np.finfo(float).tiny)
    cubics = np.array([cubic_of(forms[list(three)]) for three in itertools.combinations(range(4), 3)])
    quartics = np.zeros((12, 15))
    for variable in range(3):
        quartics[4 * variable : 4 * variable + 4, _SHIFTED[variable]] = cubics
    length = np.linalg.norm(quartics, axis=1)
    if not length.all():
        return None
    _, sizes, base = np.linalg.svd(quartics / length[:, None])
    if sizes[15 - POINTS - 1] < RANK * sizes[0]:
        return None
    rest = base[15 - POINTS :].T
    above, below = (np.einsum("v,vmk->mk", form, rest[_SHIFTED]) for form in _FORMS)
    values = rest @ np.linalg.eig(np.linalg.pinv(below) @ above)[1]
    # the columns of each (3, 10) are multiples of the point
    points = np.array([np.linalg.svd(values[_SHIFTED, i])[0][:, 0] for i in range(POINTS)])
    polished = [_polished(forms, b) for b in points]
    return _sorted_out(np.array([p[0] for p in polished]), np.array([p[1] for p in polished]), forms)


def partner(forms: Floats, b: Floats | Complexes) -> Complexes:
    """The point a (3,) of a point b (3,): what the rows `(T_k b)^T` have least of."""
    return np.asarray(np.linalg.svd(forms @ b)[2][-1].conj(), dtype=np.complex128)


def _polished(forms: Floats, b: Complexes) -> tuple[Complexes, Complexes]:
    """A solution by Newton's steps on (1), the lengths of both points held."""
    a, b = partner(forms, b), b / np.linalg.norm(b)
    for _ in range(STEPS):
        sides = np.zeros((6, 6), complex)
        sides[:4, :3], sides[:4, 3:] = forms @ b, np.einsum("i,kij->kj", a, forms)
        sides[4, :3], sides[5, 3:] = a.conj(), b.conj()
        right = np.append(np.einsum("i,kij,j->k", a, forms, b), [0.0, 0.0])
        step = np.linalg.lstsq(sides, right, rcond=1e-13)[0]
        if not np.linalg.norm(step) < 0.1:
            break
        a, b = a - step[:3], b - step[3:]
        a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return a, b


def _turned(point: Complexes) -> Complexes:
    """A point of length 1 by the factor that makes its greatest coordinate real and positive."""
    greatest = point[np.abs(point).argmax()]
    return np.asarray(point * (abs(greatest) / greatest) / np.linalg.norm(point))


def _sorted_out(a: Complexes, b: Complexes, forms: Floats) -> PointPairs:
    """The solutions that differ, and which of them are real."""
    groups: list[list[int]] = []
    for i in range(len(b)):
        alike = (g for g in groups if 1 - abs(np.vdot(b[g[0]], b[i])) < DOUBLE**2)
        group = next(alike, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    fixed, moving, real = [], [], []
    for group in groups:
        mean = _turned(sum((_turned(b[i]) for i in group), np.zeros(3, complex)))
        one = _turned(a[group[0]]) if len(group) == 1 else _turned(partner(forms, mean))
        within = REAL if len(group) == 1 else DOUBLE
        is_real = max(np.abs(one.imag).max(), np.abs(mean.imag).max()) < within
        fixed.append(one.real if is_real else one)
        moving.append(mean.real if is_real else mean)
        real.append(is_real)
    return PointPairs(
        np.array(fixed, complex),
        np.array(moving, complex),
        np.array([len(g) for g in groups]),
        np.array(real),
    )


def on_cubic(forms: Floats, first: Floats, second: Floats) -> Floats:
    """The real points b (n, 3) on the line through two points at which three forms (3, 3, 3) have an a."""
    cubic, monomials = cubic_of(forms), np.array(_CUBICS)
    roots = cubic_roots(lambda x: float(np.prod((first + x * second) ** monomials, axis=1) @ cubic))
    points = first + roots[:, None] * second
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def cubic_roots(value: Callable[[float], float]) -> Floats:
    """The real places x (n,) at which a cubic vanishes, by its values; none where it does everywhere."""
    places = np.array([0.0, 1.0, -1.0, 2.0])
    values = [value(float(x)) for x in places]
    roots = np.roots(np.linalg.solve(np.vander(places, 4), values)) if np.any(values) else np.empty(0)
    return np.asarray(roots[np.abs(roots.imag) < REAL * (1 + np.abs(roots))].real)
