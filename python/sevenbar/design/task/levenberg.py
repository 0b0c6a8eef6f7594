"""Least squares within bounds by Levenberg and Marquardt's method, the unknowns at their bounds held there.

A step s from z solves  `min |r + J s|^2 + l |D s|^2`  over the unknowns that no bound stops, D the greatest
lengths that the columns of J have had; l falls and rises with what the step before kept of its promise.

Source: K. Madsen, H. B. Nielsen, O. Tingleff, Methods for non-linear least squares problems, IMM 2004, (3.14)
to (3.16); J. J. More, Lecture Notes in Mathematics 630 (1978), for D; M. Transtrum, J. Sethna, arXiv
1201.5885 (2012), for the second order of a step.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats

#: The most of l, and the most that one step may change an unknown [units].
MOST, FARTHEST = 1e16, 0.5

#: The part of its promise that a step must keep.
KEPT = 1e-4

#: Steps before their second order counts; the share of a step at which that is found, and the most of it.
STRAIGHT, SHARE, MOST_BENT = 10, 0.1, 0.4

#: A fall of the squares, relative to them, after which it ends; and a step, relative to the unknowns.
FALL, STEP = 1e-15, 1e-15

#: An unknown whose column is shorter, relative to the longest, does nothing; it is rounding.
LEAST = 1e-8

#: Squares that are rounding of residuals of unit size.
NOTHING = 1e-31


def nearest_least(
    residuals: Callable[[Floats], tuple[Floats, Floats] | None],
    start: Floats,
    low: Floats,
    high: Floats,
    *,
    evaluations: int,
    first: float,
    taken: Callable[[Floats], None],
) -> Floats | None:
    """The unknowns (k,) of the nearest least sum of squares; `None` where there is none at the start.

    `residuals` gives residuals (r,) and slopes (r, k), `None` where there are none: a step never leads there.
    `first` is the first l; `taken` is called with each place that a step has led to.
    """
    z = np.clip(start, low, high)
    now = residuals(z)
    if now is None:
        return None
    left, by = now
    cost = float(left @ left)
    sizes = np.linalg.norm(by, axis=0)
    weight, growth = first, 2.0
    for number in range(evaluations):
        pull = by.T @ left
        free = ~(((z <= low) & (pull > 0)) | ((z >= high) & (pull < 0)))
        if not free.any() or cost < NOTHING:
            break
        scale = np.maximum(sizes, LEAST * max(float(sizes.max()), LEAST))[free]
        step = np.zeros(len(z))
        matrix = np.concatenate([by[:, free] / scale, np.sqrt(weight) * np.eye(len(scale))])
        sides = np.concatenate([-left, np.zeros(len(scale))])
        step[free] = np.linalg.lstsq(matrix, sides, rcond=None)[0] / scale
        step *= min(1.0, FARTHEST / max(float(np.abs(step).max()), 1e-300))
        straight = cost - float(((left + by @ step) ** 2).sum())
        if number >= STRAIGHT:
            step = _bent(residuals, z, left, by, step, free, scale, matrix)
        then_z = np.clip(z + step, low, high)
        step = then_z - z
        if np.abs(step).max() <= STEP * (1 + float(np.abs(z).max())):
            break
        promised = cost - float(((left + by @ step) ** 2).sum())
        if number >= STRAIGHT:
            promised = max(promised, straight)
        then = residuals(then_z) if promised > 0 else None
        gained = -np.inf if then is None else cost - float(then[0] @ then[0])
        if then is None or not gained > KEPT * promised:
            weight *= growth
            growth *= 2
            if weight > MOST:
                break
            continue
        taken(then_z)
        z, (left, by) = then_z, then
        sizes = np.maximum(sizes, np.linalg.norm(by, axis=0))
        weight *= max(1 / 3, 1 - (2 * gained / promised - 1) ** 3)
        growth = 2.0
        if gained <= FALL * cost:
            break
        cost -= gained
    return z


def _bent(
    residuals: Callable[[Floats], tuple[Floats, Floats] | None],
    z: Floats,
    left: Floats,
    by: Floats,
    step: Floats,
    free: npt.NDArray[np.bool_],
    scale: Floats,
    matrix: Floats,
) -> Floats:
    """A step with its second order, by which it follows a valley that bends; without it where it is large."""
    ahead = residuals(z + SHARE * step)
    if ahead is None:
        return step
    second = 2 / SHARE * ((ahead[0] - left) / SHARE - by @ step)
    sides = np.concatenate([-second, np.zeros(len(scale))])
    bend = np.zeros(len(z))
    bend[free] = np.linalg.lstsq(matrix, sides, rcond=None)[0] / scale / 2
    small = np.linalg.norm(bend[free] * scale) <= MOST_BENT * np.linalg.norm(step[free] * scale)
    return step + bend if small else step
