"""RSSRs drawn in blocks: dimensions (6, n) in the order M, N, L1, L2, L3, D of the core's rows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

#: Decades that lengths are spread over, and those of a common scale on both sides of 1.
DECADES, SCALES = 12, 90

#: Steps of Newton's method to a stationary distance of the two circles.
NEWTON = 40

#: What a dimension at the ends of the format's range may be.
ENDS = (0.0, 1e-100, 1e-50, 1e-12, 1 - 1e-15, 1.0, 1 + 1e-15, 2.0, 1e12, 1e50, 1e100)

#: Least length where a length was rounded or cut to nothing.
LEAST = 1e-100


def _lengths(values: Floats) -> Floats:
    """The rows L1, L2, L3 made positive, as the format wants them."""
    values[2:5] = np.maximum(np.abs(values[2:5]), LEAST)
    return values


def uniform(rng: np.random.Generator, count: int) -> Floats:
    """All in (-1, 1)."""
    return _lengths(rng.uniform(-1, 1, (6, count)))


def decades(rng: np.random.Generator, count: int) -> Floats:
    """Each over twelve decades, of either sign, now and then 0."""
    values = 10 ** rng.uniform(-DECADES / 2, DECADES / 2, (6, count)) * rng.choice([-1, 1], (6, count))
    values[[0, 1, 5]] *= rng.random((3, count)) > 0.1
    return _lengths(values)


def _ball_gap(values: Floats, a: Floats, b: Floats) -> Floats:
    """From ball B to ball A (3, n) at crank angles `a`, rocker angles `b`. Source: Sun and Zhou, eq. (5)."""
    m, n, l1, _, l3, d = values
    return np.array([l1 * np.cos(a) - m, l1 * np.sin(a) - d - l3 * np.cos(b), n - l3 * np.sin(b)])


def _with_coupler(values: Floats, coupler: Floats) -> Floats:
    values[3] = coupler
    return _lengths(values)


def assembled(rng: np.random.Generator, count: int) -> Floats:
    """The coupler as long as it is in a random pose, all else over two decades."""
    values = 10 ** rng.uniform(-1, 1, (6, count)) * rng.choice([-1, 1], (6, count))
    values = _lengths(values)
    return _with_coupler(
        values, np.linalg.norm(_ball_gap(values, *rng.uniform(-np.pi, np.pi, (2, count))), axis=0)
    )


def integers(rng: np.random.Generator, count: int) -> Floats:
    """Small whole numbers, half with a coupler drawn at quarter turns: all that can coincide."""
    values = rng.integers(-4, 5, (6, count)).astype(np.float64)
    values[2:5] = rng.integers(1, 5, (3, count))
    quarters = rng.integers(0, 4, (2, count)) * (np.pi / 2)
    gap = np.linalg.norm(np.round(_ball_gap(values, *quarters)), axis=0)
    return _with_coupler(values, np.where((rng.random(count) < 0.5) & (gap > 0), gap, values[3]))


def change_points(rng: np.random.Generator, count: int) -> Floats:
    """The coupler a stationary distance of the two circles, off by 1e-16 to 1e-2: two limits meet nearby."""
    values = uniform(rng, count)
    l1, l3 = values[2], values[4]
    a, b = rng.uniform(-np.pi, np.pi, (2, count))
    zero = np.zeros(count)
    for _ in range(NEWTON):
        gap = _ball_gap(values, a, b)
        by_a = l1 * np.array([-np.sin(a), np.cos(a), zero])
        by_b = l3 * np.array([zero, np.sin(b), -np.cos(b)])
        twice_a = l1 * np.array([-np.cos(a), -np.sin(a), zero])
        twice_b = l3 * np.array([zero, np.cos(b), np.sin(b)])
        gradient = np.array([(gap * by_a).sum(0), (gap * by_b).sum(0)])
        mixed = (by_a * by_b).sum(0)
        aa, bb = (by_a**2).sum(0) + (gap * twice_a).sum(0), (by_b**2).sum(0) + (gap * twice_b).sum(0)
        determinant = aa * bb - mixed * mixed
        determinant = np.where(np.abs(determinant) < 1e-12, 1.0, determinant)
        a = a - (bb * gradient[0] - mixed * gradient[1]) / determinant
        b = b - (aa * gradient[1] - mixed * gradient[0]) / determinant
    off = rng.choice([-1, 0, 1], count) * 10 ** rng.uniform(-16, -2, count)
    return _with_coupler(values, np.linalg.norm(_ball_gap(values, a, b), axis=0) * (1 + off))


def scaled(rng: np.random.Generator, count: int) -> Floats:
    """Linkages that close, in units far from 1."""
    return assembled(rng, count) * 10 ** rng.uniform(-SCALES, SCALES, count)


def ends(rng: np.random.Generator, count: int) -> Floats:
    """Each dimension at an end of what the format takes, or beside 1."""
    values = rng.choice(ENDS, (6, count))
    values[[0, 1, 5]] *= rng.choice([-1, 1], (3, count))
    return _lengths(values)


FAMILIES: dict[str, Callable[[np.random.Generator, int], Floats]] = {
    "uniform": uniform,
    "twelve decades": decades,
    "assembled": assembled,
    "whole numbers": integers,
    "change points": change_points,
    "scaled": scaled,
    "ends of the format": ends,
}


def description(column: Floats) -> dict[str, object]:
    """The tables of a file for one column of dimensions (6,)."""
    values = dict(zip(("M", "N", "L1", "L2", "L3", "D"), map(float, column), strict=True))
    return {"format": 1, "rssr": values}
