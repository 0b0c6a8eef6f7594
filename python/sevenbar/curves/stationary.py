"""Where a smooth function is stationary: by the polynomial through values at Chebyshev's nodes, and by signs.

The polynomial through values at `NODES` nodes is the function up to a term of its series that is rounding
where the stretch is short enough; the zeros of its derivative are all places where the function may be
highest or lowest.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev, chebyshev

from sevenbar.arrays import Floats

#: Values from which the curve of a short stretch is made: the next term of its series is rounding.
NODES = 16

#: A root with a smaller imaginary part counts as real: rounding makes two complex ones of a double root. One
#: too many does no harm, as each is a place of the function.
NEARLY_REAL = 1e-4

#: A root beyond an end by no more than this lies at the end: else rounding loses one between two pieces.
AT_END = 1e-9

#: Most halvings of a bracket, from any length to rounding.
HALVINGS = 60


def nodes(count: int = NODES) -> Floats:
    """Zeros of Chebyshev's polynomial of this degree, from 1 down to -1, (count,)."""
    return np.asarray(np.cos(np.pi * (np.arange(count) + 0.5) / count))


def coefficients(values: Floats) -> Floats:
    """Chebyshev coefficients (count, ...) of the polynomial through values (count, ...) at `nodes(count)`.

    `c_k = (2 - [k = 0]) / count sum_j f_j cos(k pi (j + 1/2) / count)`
    """
    count = len(values)
    waves = np.cos(np.pi * np.outer(np.arange(count), np.arange(count) + 0.5) / count)
    waves[0] /= 2
    return np.asarray(np.tensordot(2 / count * waves, values, axes=1))


def curve_through(values: Floats) -> Chebyshev:
    """The polynomial on [-1, 1] through values (count,) at `nodes(count)`."""
    return Chebyshev(coefficients(values), domain=[-1, 1])


def real_roots(curve: Chebyshev) -> Floats:
    """The real roots of a polynomial in [-1, 1]; double ones may be a pair with small imaginary parts."""
    # a term of zero is no degree, and a constant has no root worth the name
    trimmed = chebyshev.chebtrim(curve.coef)
    if len(trimmed) < 2:
        return np.empty(0)
    roots = Chebyshev(trimmed, domain=[-1, 1]).roots()
    kept = roots.real[(np.abs(roots.imag) < NEARLY_REAL) & (np.abs(roots.real) <= 1 + AT_END)]
    return np.asarray(np.clip(kept, -1, 1))


def highest_between(evaluate: Callable[[Floats], Floats], low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where (k,) a function is highest inside brackets from `low` to `high`, (k,) each, and how high.

    `evaluate` takes places (j,) and gives values (j,), of waves longer than the brackets. Where these are
    stationary nowhere inside, the place is the middle.
    """
    middle, half = (low + high) / 2, (high - low) / 2
    grid = middle[:, None] + half[:, None] * nodes()
    values = evaluate(grid.ravel()).reshape(grid.shape)
    tops = np.zeros(len(middle))
    for i, own in enumerate(values):
        curve = curve_through(own)
        tried = np.concatenate([[0.0], real_roots(curve.deriv())])
        tops[i] = tried[np.argmax(curve(tried))]
    places = middle + half * tops
    return places, evaluate(places)


def zeros_between(
    function: Callable[[Floats], tuple[Floats, Floats]],
    low: Floats,
    high: Floats,
    falls: npt.NDArray[np.bool_],
) -> Floats:
    """One zero (k,) in each bracket, at which a function falls from above zero to below, or rises.

    `function` takes places (k,) and gives values and slopes there. Newton's method, and half the bracket
    where a step leaves it. Of which sign the ends are is the caller's word: rounding may see a zero that
    lies at an end on either side of it.
    """
    low, high = low.copy(), high.copy()
    at = (low + high) / 2
    for _ in range(HALVINGS):
        value, slope = function(at)
        before = (value > 0) == falls
        low, high = np.where(before, at, low), np.where(before, high, at)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = at - value / slope
        inside = (step >= np.minimum(low, high)) & (step <= np.maximum(low, high))
        after = np.where(inside, step, (low + high) / 2)
        moved = np.abs(after - at) > 4 * np.spacing(np.abs(at))
        at = after
        if not moved.any():
            break
    return at
