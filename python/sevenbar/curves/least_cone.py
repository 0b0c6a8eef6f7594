"""The smallest cone about a curve of directions, and about some: its axis and half its opening.

The axis u of the smallest cone about unit vectors w solves

    maximise  min w . u   subject to   |u| = 1                                                            (13)

and touches two or three of them. Of a curve these are found by exchange: the cone about some places, then
the places where the curve leaves it the most, and so on. What the cone about the places falls short of the
curve's is known at each step, so the last cone is the smallest to rounding.

Source: docs/theory_measures.md, (13).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.along import Along

#: Places from which the exchange starts, and where the cone is wider than half a space.
STARTS, WIDE_STARTS = 6, 40

#: Most exchanges; four to six are usual.
EXCHANGES = 30

#: Cosines that differ by less are one.
ALIKE = 2e-15

#: A place touches the cone where its cosine is the cone's up to this.
TOUCHES = 1e-11

#: A vector product shorter than this has a direction of rounding.
FLAT = 1e-14


@dataclass(frozen=True, eq=False)
class LeastCone:
    """The smallest cone about a curve: its `axis` (3,), and the `places` (k,) where it touches the curve."""

    axis: Floats
    #: Half the opening [rad, up to pi].
    angle: float
    places: Floats


def angles(directions: Floats, axis: Floats) -> Floats:
    """The angles (n,) [rad] of unit vectors (n, 3) from a unit vector (3,), exact near 0 too."""
    sines = np.linalg.norm(np.cross(directions, axis), axis=1)
    return np.asarray(np.arctan2(sines, directions @ axis))


def least_axis(directions: Floats) -> Floats:
    """The axis (3,) of the smallest cone about a few unit vectors (k, 3): of all through one, two or three.

    >>> least_axis(np.eye(3)).round(6).tolist()
    [0.57735, 0.57735, 0.57735]
    """
    pairs = np.array(list(combinations(range(len(directions)), 2)), dtype=np.int64).reshape(-1, 2)
    triples = np.array(list(combinations(range(len(directions)), 3)), dtype=np.int64).reshape(-1, 3)
    a, b, c = (directions[triples[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    middles = directions[pairs].sum(axis=1)
    tried = np.concatenate([directions, middles, normals, -normals])
    sizes = np.linalg.norm(tried, axis=1)
    tried = tried[sizes > FLAT] / sizes[sizes > FLAT, None]
    return np.asarray(tried[int((tried @ directions.T).min(axis=1).argmax())])


def exchanged(some: Callable[[int], Floats], farthest: Callable[[Floats], Floats]) -> Floats:
    """The axis (3,) of the smallest cone about all of which `some` gives so many directions (k, 3).

    `farthest` gives directions (j, 3) among which are those farthest from an axis. A cone wider than half a
    space is the smallest about `WIDE_STARTS` and those found on the way.
    """
    few = some(STARTS)
    axis = least_axis(few)
    if (few @ axis).min() <= 0:
        few = some(WIDE_STARTS)
        axis = least_axis(few)
    for _ in range(EXCHANGES):
        own, result = few @ axis, farthest(axis)
        outside = result[result @ axis < own.min() - ALIKE]
        if not outside.size:
            break
        if own.min() > 0:
            # what does not touch a cone within half a space may go
            few = few[own < own.min() + TOUCHES]
        few = np.concatenate([few, outside])
        axis = least_axis(few)
    return axis


def half_angle(directions: Floats) -> float:
    """Half the opening [rad] of the smallest cone about unit vectors (k, 3)."""

    def some(count: int) -> Floats:
        chosen: Floats = directions[np.linspace(0, len(directions) - 1, count).astype(int)]
        return chosen

    def farthest(axis: Floats) -> Floats:
        return np.asarray(directions[[int((directions @ axis).argmin())]])

    return float(angles(directions, exchanged(some, farthest)).max())


def least_cone(curve: Along) -> LeastCone:
    """The smallest cone about a curve of unit vectors (3,), as `exchanged` finds it."""
    ends = float(curve.edges[0]), float(curve.edges[-1])

    def some(count: int) -> Floats:
        return curve.at(np.linspace(*ends, count, endpoint=False))

    def farthest(axis: Floats) -> Floats:
        return curve.at(np.concatenate([ends, dotted(curve, axis).stationary(0)]))

    axis = exchanged(some, farthest)
    # where the curve itself is farthest, not where the last exchange found it
    height = dotted(curve, axis)
    places = np.concatenate([ends, height.stationary(0)])
    heights = height.at(places)[:, 0]
    touching = np.unique(places[heights < heights.min() + TOUCHES])
    still = touching[np.isin(touching, height.stationary(0))]
    places = still if len(still) >= 2 else touching
    return LeastCone(axis, float(angles(curve.at(touching), axis).max()), places)


def dotted(curve: Along, axis: Floats) -> Along:
    """The scalar product of a curve's vectors with one, a single quantity."""
    return Along(curve.edges, (curve.series @ axis)[:, :, None])
