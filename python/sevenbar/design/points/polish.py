"""The least greatest rate to the last digits: Newton's method on the conditions of the optimum.

An interior-point method knows the point to some eight digits, fewer where rows crowd at one peak. Four inputs
are enough to decide: three coordinates and a height. Each height `f_i(x)`, the greatest `|c + G x|` near
input s_i, is a smooth function of the point, and

    sum lambda_i grad f_i = 0 along the free coordinates,   sum lambda_i = 1,   f_i = t

is solved by Newton's method. With `F = |c + G x|^2 / 2` and F_s its derivative by the input

    grad f = G^T a / f,    hess f = (G^T G - F_sx F_sx^T / F_ss - grad f grad f^T) / f

Source: docs/theory_design.md, (19) and (20).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Booleans, Floats
from sevenbar.design.points.box import lower_bound
from sevenbar.design.points.cycle import ORDERS, Cycle

#: Steps of Newton's method; each doubles the digits, of which the interior-point method gives the first four.
STEPS = 5

#: The step of the input [rad] of five-point differences: rounding and their error are both near 1e-10 there.
DIFFERENCE = 3e-3

#: A height that curves by less than this part of it for a radian squared is flat along the input: rounding
#: curves so.
FLAT = 1e-4

#: Nearer to a side than this part of half the box, a coordinate is held there.
ON_SIDE = 1e-6

#: A height below this part of what the box's sides change in it is rounding.
NO_HEIGHT = 1e-9

#: Dual weights below are none.
NO_WEIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class Polished:
    """A point (3,), the lower bound over the box, the inputs (k,) that give it and their weights (k,)."""

    at: Floats
    bound: float
    inputs: Floats
    weights: Floats


def polished(cycle: Cycle, of: str, at: Floats, inputs: Floats, low: Floats, high: Floats) -> Polished | None:
    """The optimum near a point, from inputs (k,) among which are those that decide; `None` if not found."""
    half = (high - low) / 2
    free = (np.minimum(at - low, high - at) > ON_SIDE * half) & (half > 0)
    at = np.where(free, at, np.where(at - low < high - at, low, high))
    peaks = _Peaks.at(cycle, of, at, inputs)
    weights = _weights(peaks, free, half)
    selected = weights > NO_WEIGHT
    if not selected.any() or peaks.vanish(half):
        return None
    inputs, weights = inputs[selected], weights[selected]
    for _ in range(STEPS):
        peaks = _Peaks.at(cycle, of, at, inputs)
        inputs = inputs + peaks.ahead
        peaks = _Peaks.at(cycle, of, at, inputs)
        if peaks.vanish(half):
            return None
        moved, weights = _step(peaks, weights, free, half)
        target = at.copy()
        target[free] = np.clip(at[free] + moved, low[free], high[free])
        inputs, at = inputs + peaks.drift @ (target - at), target
    peaks = _Peaks.at(cycle, of, at, inputs)
    weights = _weights(peaks, free, half)
    if not weights.any():
        return None
    weights /= weights.sum()
    return Polished(at, peaks.bound(weights, low, high), inputs, weights)


@dataclass(frozen=True, eq=False)
class _Peaks:
    """k peaks of a rate of a point: heights (k,), their slopes (k, 3) and curvatures (k, 3, 3) by the point.

    `ahead` (k,) is how far each input is off its peak, `drift` (k, 3) how the point's place moves it.
    """

    value: Floats
    constant: Floats
    gradient: Floats
    heights: Floats
    slopes: Floats
    curvatures: Floats
    ahead: Floats
    drift: Floats

    @staticmethod
    def at(cycle: Cycle, of: str, at: Floats, inputs: Floats) -> _Peaks:
        """Those at inputs (k,) near them."""
        count, index = len(inputs), ORDERS.index(of)
        places = (inputs + DIFFERENCE * np.arange(-2, 3)[:, None]).ravel()
        rates = cycle.at(places)
        values = rates.of(of, at).reshape(5, count, 3)
        gradients = rates.gradient[index].reshape(5, count, 3, 3)
        first = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12 * DIFFERENCE)
        second = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / (12 * DIFFERENCE**2)
        value, gradient = values[2], gradients[2]
        rate, turning = np.tensordot(first, values, 1), np.tensordot(first, gradients, 1)
        bend = np.tensordot(second, values, 1)
        heights = np.linalg.norm(value, axis=1)
        safe = np.where(heights > 0, heights, 1.0)
        slopes = np.einsum("ki,kij->kj", value, gradient) / safe[:, None]
        uphill, along = (value * rate).sum(axis=1), (rate * rate + value * bend).sum(axis=1)
        across = np.einsum("ki,kij->kj", rate, gradient) + np.einsum("ki,kij->kj", value, turning)
        peaked = along < -FLAT * heights**2
        share = np.where(peaked, -1 / np.where(peaked, along, 1.0), 0.0)
        curvatures = np.einsum("kij,kil->kjl", gradient, gradient)
        curvatures += share[:, None, None] * _squares(across) - _squares(slopes)
        return _Peaks(
            value=value,
            constant=rates.constant[index].reshape(5, count, 3)[2],
            gradient=gradient,
            heights=heights,
            slopes=slopes,
            curvatures=curvatures / safe[:, None, None],
            # not beyond the stencil, where the parabola says nothing
            ahead=np.clip(share * uphill, -2 * DIFFERENCE, 2 * DIFFERENCE),
            drift=share[:, None] * across,
        )

    def vanish(self, half: Floats) -> bool:
        """Whether a height is zero up to rounding, so that it has no slope; `half` (3,) of the sides."""
        reach = np.abs(self.gradient * half).max(axis=(1, 2))
        return bool((self.heights <= NO_HEIGHT * reach).any())

    def bound(self, weights: Floats, low: Floats, high: Floats) -> float:
        """The lower bound that weights (k,) of the peaks give."""
        dual = (weights / self.heights)[:, None] * self.value
        return lower_bound(self.constant, self.gradient, low, high, dual)


def _squares(vectors: Floats) -> Floats:
    """The products (k, 3, 3) of vectors (k, 3) with themselves."""
    return vectors[:, :, None] * vectors[:, None, :]


def _weights(peaks: _Peaks, free: Booleans, half: Floats) -> Floats:
    """The weights (k,) >= 0 with which slopes along the free coordinates cancel best; few are not zero."""
    from scipy.optimize import nnls

    slopes = (peaks.slopes * half)[:, free] / (float(np.abs(peaks.slopes * half).max()) or 1.0)
    wanted = np.append(np.zeros(slopes.shape[1]), 1.0)
    return np.asarray(nnls(np.vstack([slopes.T, np.ones(len(slopes))]), wanted)[0])


def _step(peaks: _Peaks, weights: Floats, free: Booleans, half: Floats) -> tuple[Floats, Floats]:
    """Newton's step of the free coordinates, and the peaks' weights."""
    scale = float(peaks.heights.max())
    slopes = (peaks.slopes * half)[:, free] / scale
    curvature = np.einsum("k,kij->ij", weights, peaks.curvatures) * np.outer(half, half) / scale
    count, size = slopes.shape
    matrix = np.zeros((size + count + 1, size + count + 1))
    matrix[:size, :size] = curvature[np.ix_(free, free)]
    matrix[:size, size:-1] = slopes.T
    matrix[size:-1, :size] = slopes
    matrix[size:-1, -1] = -1.0
    matrix[-1, size:-1] = 1.0
    right = np.concatenate([np.zeros(size), -peaks.heights / scale, [1.0]])
    result = np.linalg.lstsq(matrix, right, rcond=None)[0]
    return half[free] * result[:size], result[size:-1]
