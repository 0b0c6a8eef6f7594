"""Extremes and zeros of a smooth function on short intervals.

On an interval that is short enough, the polynomial through the function's values at `NODES` Chebyshev nodes
equals the function to rounding. The zeros of its derivative are then all places where the function can be
highest or lowest.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev, chebyshev

from sevenbar.arrays import Floats

#: Values for the polynomial of one interval: the next term of its series is rounding.
NODES = 16

#: A root with a smaller imaginary part counts as real, since rounding can split a double root into a complex
#: pair. A root too many does no harm: the function is evaluated at each.
NEARLY_REAL = 1e-4

#: Where the first coefficient is so many times as great as all others together there is no root: no wave is
#: greater than 1, or than 1.09 where a root still counts, up to the degree 40; no more are sought.
OUTWEIGHS = 1.1

#: A root beyond an end by no more than this is at the end; otherwise rounding could lose a root between two
#: neighbouring intervals.
AT_END = 1e-9

#: Most halvings of a bracket, from any length to rounding.
HALVINGS = 60


def nodes(count: int = NODES) -> Floats:
    """Zeros of Chebyshev's polynomial of this degree, from 1 down to -1, (count,)."""
    return np.asarray(np.cos(np.pi * (np.arange(count) + 0.5) / count))


def nodes_between(low: npt.ArrayLike, high: npt.ArrayLike, count: int = NODES) -> Floats:
    """Those between ends (..), from the high one down to the low one, (.., count)."""
    low, high = np.asarray(low)[..., None], np.asarray(high)[..., None]
    return np.asarray((low + high) / 2 + (high - low) / 2 * nodes(count))


def coefficients(values: Floats) -> Floats:
    """Chebyshev coefficients (count, ...) of the polynomial through values (count, ...) at `nodes(count)`.

    `c_k = (2 - [k = 0]) / count sum_j f_j cos(k pi (j + 1/2) / count)`
    """
    return np.asarray(np.tensordot(_waves(len(values)), values, axes=1))


@cache
def _waves(count: int) -> Floats:
    waves = np.cos(np.pi * np.outer(np.arange(count), np.arange(count) + 0.5) / count)
    waves[0] /= 2
    return np.asarray(2 / count * waves)


def series_through(values: Floats) -> Floats:
    """The same (m, count, ...) on m pieces, from values (m, count, ...) at the nodes of each."""
    return np.moveaxis(coefficients(np.moveaxis(values, 1, 0)), 0, 1)


def curve_through(values: Floats) -> Chebyshev:
    """The polynomial on [-1, 1] through values (count,) at `nodes(count)`."""
    return Chebyshev(coefficients(values), domain=[-1, 1])


def real_roots(curve: Chebyshev) -> Floats:
    """The real roots of a polynomial in [-1, 1]; double ones may be a pair with small imaginary parts."""
    # leading zeros would raise the degree; a constant has no roots
    trimmed = chebyshev.chebtrim(curve.coef)
    sizes = np.abs(trimmed)
    if len(trimmed) < 2 or sizes[0] > OUTWEIGHS * sizes[1:].sum():
        return np.empty(0)
    roots = Chebyshev(trimmed, domain=[-1, 1]).roots()
    selected = roots.real[(np.abs(roots.imag) < NEARLY_REAL) & (np.abs(roots.real) <= 1 + AT_END)]
    return np.asarray(np.clip(selected, -1, 1))


def highest_between(evaluate: Callable[[Floats], Floats], low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Where a function is highest in each bracket from `low` to `high` (k,), and its values there: (k,) each.

    `evaluate` maps places (j,) to values (j,) of a function that varies slowly over a bracket. Where the
    function is stationary nowhere inside, the place is the middle.
    """
    middle, half = (low + high) / 2, (high - low) / 2
    grid = nodes_between(low, high)
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
    """One zero (k,) in each bracket from `low` to `high`; `falls` says where the function goes from + to -.

    `function` maps places (k,) to values and slopes there. Newton's method, and bisection where a step would
    leave the bracket. The signs at the ends are not evaluated but taken from `falls`: where a zero is at an
    end, rounding decides them.
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
