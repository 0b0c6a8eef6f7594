"""RSSR linkages through given pairs of angles, with any angle between the axes: three to eight pairs.

The nine coefficients of a closure (`closures`) are a null vector of the pairs' products, and every null
vector is one closure. So, counting closures over the complex numbers,

    zeros   axes    pairs
    free    any     8       1    one null vector
    free    given   7       2    of a pencil: (1 + c^2) det M = c tr M^T M is a quadratic
    given   any     6       1    seven coefficients, as the block of products is diagonal
    given   given   5       1    six coefficients

and fewer pairs leave a family, whose members are drawn. A closure has the cosine c or 1 / c of the angle of
the axes, so one linkage, up to its mirror image. A real closure of free zeros is always one; of given zeros
it is none where |c| > 1, or the crank would lie on the other side of its zero.

Source: docs/theory_design.md, (38) to (40).
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array, finite_number, positive_length
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import Claim
from sevenbar.design.closure import draft_of
from sevenbar.design.exact.answers import ExactAnswer, ExactAnswers, judged
from sevenbar.design.exact.bilinear import cubic_roots
from sevenbar.design.exact.closures import SkewRssr, designed, products, rssr_of
from sevenbar.design.exact.draws import directions
from sevenbar.design.exact.dyads import plain
from sevenbar.design.synthesis.function.precision import null_angles, reflected
from sevenbar.design.wish import FEWEST, wish_of_pairs
from sevenbar.errors import RequestError, ends_here, shown

#: Coefficients of a closure.
COEFFICIENTS = 9

#: Singular value of the pairs' products, relative to the greatest, below which pairs depend on each other.
RANK = 1e-12

#: Coefficients of a quadratic along null vectors of length 1 that count as zero: pairs in special position.
NO_QUADRATIC = 1e-10

#: |cos| from which axes count as parallel: two planes of motion, whose linkages are planar four-bars.
PARALLEL = 1 - 1e-9

#: |cos| below which axes are square, and the linkage has the form `[rssr]`.
SQUARE = 1e-12

#: Output angles [rad] that are one.
STILL = 1e-12


@ends_here
def function_pairs(
    inputs: npt.ArrayLike,
    outputs: npt.ArrayLike,
    *,
    twist: float | None = None,
    zeros: tuple[float, float] | None = None,
    samples: int = 64,
    seed: int = 0,
    longest: float = 1000.0,
    length_unit: str = "mm",
) -> ExactAnswers:
    """RSSR linkages whose dials read three to eight pairs (n,) [rad], with any angle between the axes.

    `twist` [rad], between 0 and pi, is the angle of the axes where it is given: then 7 pairs at most, and
    with pi / 2 the linkages have the form `[rssr]`; all others are drawn, in the pose of the first pair.
    `zeros` [rad] are the angles at which the dials read zero: counted from the common normal of the axes, or
    as `[rssr]` counts them; two pairs less, then. Fewer pairs than a linkage has numbers leave a family: of
    `samples` draws by `seed` those that are linkages. The `longest` length is the scale.

        >>> import sevenbar as sb
        >>> wanted = sb.from_axes([
        ...     {"kind": "R", "at": (0, 0, 30), "axis": (0, 0, 1)},
        ...     {"kind": "S", "at": (40, 10, 30)},
        ...     {"kind": "S", "at": (150, 80, 60)},
        ...     {"kind": "R", "at": (100, 10, 0), "axis": (0, -0.8, 0.6)},
        ... ]).motion(36).circuits[0]
        >>> found = function_pairs(wanted.input[:8], wanted.output[:8])
        >>> found.complete, found.real, len(found.defect_free)
        (True, 1, 1)

    Raises `RequestError` for pairs that are none, axes that are parallel, or more pairs than numbers.
    """
    cosine = None if twist is None else _cosine(twist)
    most = 8 - (twist is not None) - 2 * (zeros is not None)
    if np.size(inputs) < FEWEST:
        raise RequestError(f"points: {np.size(inputs)} pairs leave too much open; give {FEWEST} to {most}")
    wish = wish_of_pairs(inputs, outputs, title="pairs of angles")
    a, b = wish.input, wish.output
    if a.size > most:
        given = " and ".join(w for w, v in (("twist", twist), ("zeros", zeros)) if v is not None)
        raise RequestError(
            f"points: {a.size} pairs are more than an RSSR{f' with {given} given' if given else ''} has "
            f"numbers; give {most} at most"
        )
    if np.ptp(b) < STILL:
        raise RequestError("outputs: all are the same; give pairs whose output moves")
    scale = positive_length("longest", longest)
    own = None if zeros is None else _own_zeros(zeros, cosine)
    spaces, theory, known, how = _closures(a, b, cosine, own, samples, seed)
    result = [rssr for rssr in (_linkage(space, cosine, own) for space in spaces) if rssr is not None]
    answers = tuple(_answer(rssr, a, b, i, scale, length_unit) for i, rssr in enumerate(result, 1))
    return ExactAnswers(f"{a.size} pairs of angles", "closures", theory, known, len(result), answers, how)


def _cosine(twist: float) -> float:
    angle = finite_number("twist", twist)
    cosine = math.cos(angle)
    if not 0 < angle < math.pi or abs(cosine) >= PARALLEL:
        raise RequestError(
            f"twist: {math.degrees(angle):g} deg makes the axes parallel, or is no angle between them; give "
            "one between 0 and 180 deg"
        )
    return 0.0 if abs(cosine) < SQUARE else cosine


def _own_zeros(zeros: tuple[float, float], cosine: float | None) -> tuple[float, float]:
    """Zeros from the common normal; those of `[rssr]` count the crank from the rocker's axis."""
    both = finite_array("zeros", zeros)
    if both.size != 2:
        raise RequestError(f"zeros: {shown(zeros)} are not two angles; give those of input and output")
    u, v = both.tolist()
    return (u - math.pi / 2, v) if cosine == 0.0 else (u, v)


def _closures(
    a: Floats,
    b: Floats,
    cosine: float | None,
    zeros: tuple[float, float] | None,
    samples: int,
    seed: int,
) -> tuple[list[Floats], int | None, int | None, str]:
    """Closures (3, 3) of the pairs; how many by theory and how many were found, `None` for a family; how."""
    base = _null_space(a, b, cosine, zeros)
    size, pencil = len(base), cosine is not None and zeros is None
    if size == 1 and not pencil:
        return [base[0]], 1, 1, "one null vector of the pairs' products"
    if size == 2 and pencil:
        quadratic = _of_pencil(base[0], base[1], cosine or 0.0)
        if np.abs(quadratic).max() > NO_QUADRATIC:
            result = [x * base[0] + y * base[1] for x, y in _real_roots(quadratic)]
            return result, 2, 2, "the angle of the axes is a quadratic along the pencil of null vectors"
        pencil = False  # all of it has the angle wanted
    how = f"members of a family of {size} coefficients, drawn with seed {seed}"
    if cosine is None and zeros is None and _all_parallel(base):
        lines = directions(samples, 2 * size, seed)
        return _in_planes(base, lines), None, None, f"{how}; all have parallel axes"
    draws = directions(samples, size * (1 + pencil), seed)
    if not pencil:
        return list(np.einsum("nk,kij->nij", draws, base)), None, None, how
    result = []
    for draw in draws:
        first, second = (np.einsum("k,kij->ij", half, base) for half in np.split(draw, 2))
        roots = _real_roots(_of_pencil(first, second, cosine or 0.0))
        result += [x * first + y * second for x, y in roots]
    return result, None, None, how


def _null_space(a: Floats, b: Floats, cosine: float | None, zeros: tuple[float, float] | None) -> Floats:
    """A basis (k, 3, 3) of the closures of the pairs, orthonormal."""
    if zeros is None:
        rows, back = products(a, b), np.eye(COEFFICIENTS)
    else:
        # without ca sb and sa cb; with the axes given ca cb and sa sb go together
        selected = [0, 1, 2, 3, 4, 6, 8] if cosine is None else [0, 1, 2, 3, 4, 6]
        back = np.eye(COEFFICIENTS)[selected]
        if cosine is not None:
            back[4, 8] = cosine
        rows = products(a + zeros[0], b + zeros[1]) @ back.T
    _, sizes, base = np.linalg.svd(rows)
    rank = int((sizes > RANK * sizes[0]).sum())
    return np.asarray((base[rank:] @ back).reshape(-1, 3, 3))


def _all_parallel(base: Floats) -> bool:
    """Whether every closure of a space (k, 3, 3) has parallel axes: blocks of products that only turn."""
    block = base[:, 1:, 1:]
    for way in (1.0, -1.0):
        off = np.abs([block[:, 0, 0] - way * block[:, 1, 1], block[:, 0, 1] + way * block[:, 1, 0]])
        if off.max() < NO_QUADRATIC:
            return True
    return False


def _in_planes(base: Floats, lines: Floats) -> list[Floats]:
    """Where lines (n, 2k) of a space with parallel axes meet what is a linkage: one common normal for both.

    With M the block of products the sides `M^T f_a` and `f_b` must be parallel, a cubic along a line.
    """

    def aside(place: float, first: Floats, second: Floats) -> float:
        f = first + place * second
        x, y = f[1:, 1:].T @ f[1:, 0]
        return float(x * f[0, 2] - y * f[0, 1])

    result: list[Floats] = []
    for line in lines:
        first, second = (np.einsum("k,kij->ij", half, base) for half in np.split(line, 2))
        roots = cubic_roots(partial(aside, first=first, second=second))
        result += [first + x * second for x in roots]
    return result


def _of_pencil(first: Floats, second: Floats, c: float) -> Floats:
    """`(1 + c^2) det M - c tr M^T M` of x first + y second, by x^2, x y, y^2 (3,)."""

    def form(one: Floats, other: Floats) -> float:
        p, q = one[1:, 1:], other[1:, 1:]
        mixed = (p[0, 0] * q[1, 1] + p[1, 1] * q[0, 0] - p[0, 1] * q[1, 0] - p[1, 0] * q[0, 1]) / 2
        return float((1 + c * c) * mixed - c * (p * q).sum())

    return np.array([form(first, first), 2 * form(first, second), form(second, second)])


def _real_roots(quadratic: Floats) -> list[tuple[float, float]]:
    """The real (x, y) of length 1 with q0 x^2 + q1 x y + q2 y^2 = 0: none, one or two."""
    first, mixed, last = quadratic
    angles = null_angles(np.array([[first, mixed / 2], [mixed / 2, last]]))
    return [(math.cos(angle), math.sin(angle)) for angle in np.unique(angles)]


def _linkage(space: Floats, cosine: float | None, zeros: tuple[float, float] | None) -> SkewRssr | None:
    """The RSSR of a closure; its zeros are those given."""
    if zeros is None:
        return rssr_of(space)
    if abs(space[1, 1]) <= RANK * np.abs(space).max():
        return None
    f = space / space[1, 1]
    c = float(f[2, 2]) if cosine is None else cosine
    if abs(c) >= PARALLEL:
        return None
    return designed(c, -f[0, 0], -f[0, 1], f[1, 0], -f[2, 0], f[0, 2], *zeros, turned=False)


def _answer(
    rssr: SkewRssr, a: Floats, b: Floats, number: int, longest: float, length_unit: str
) -> ExactAnswer:
    """The linkage with its check: of square axes as `[rssr]`, else as drawn in the pose of the first pair."""
    size = max(rssr.r, rssr.s, abs(rssr.p), abs(rssr.h), abs(rssr.k), rssr.coupler)
    scale, (u, v), name = longest / size, rssr.zeros, f"RSSR through pairs {number}"
    angles = list(zip((u + a).tolist(), (v + b).tolist(), strict=True))
    distances = [math.dist(rssr.ball_a(x), rssr.ball_b(y)) for x, y in angles]
    errors = scale * np.abs(np.array(distances) - rssr.coupler)
    figures = {"closure_error": float(errors.max()) / longest, "twist_deg": math.degrees(rssr.twist)}
    if abs(math.cos(rssr.twist)) < SQUARE:
        row = scale * np.array([rssr.k, rssr.h, rssr.r, rssr.coupler, rssr.s, rssr.p])
        rows, turned = reflected(row[None], np.array([[u + math.pi / 2, v]]))
        u, v = turned[0].tolist()
        draft, inputs, outputs = draft_of(rows[0], name, length_unit=length_unit), u + a, v + b
    else:
        draft = _drawn(rssr, angles[0], scale, name, length_unit)
        # as drawn its joints are at zero
        u, v = 0.0 - a[0], 0.0 - b[0]
        inputs, outputs = u + a, v + b
    figures |= {"input_zero_deg": math.degrees(u), "output_zero_deg": math.degrees(v)}
    return judged(draft, Claim(inputs, outputs, errors, length_unit, figures))


def _drawn(rssr: SkewRssr, pose: tuple[float, float], scale: float, name: str, length_unit: str) -> Draft:
    places = [np.array([0.0, 0.0, rssr.h]), rssr.ball_a(pose[0]), rssr.ball_b(pose[1]), rssr.foot_b()]
    at = [plain(scale * place) for place in places]
    joints = [
        {"name": "crank", "kind": "R", "at": at[0], "axis": [0.0, 0.0, 1.0]},
        {"name": "ball_a", "kind": "S", "at": at[1]},
        {"name": "ball_b", "kind": "S", "at": at[2]},
        {"name": "rocker", "kind": "R", "at": at[3], "axis": rssr.axis_b().tolist()},
    ]
    return Draft.made(name, length_unit, joint=joints)
