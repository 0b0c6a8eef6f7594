"""Uniform solids by their shape: volume, centre, and inertia about it; and densities of materials."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats

#: Densities of materials [kg/m^3], as handbooks have them; those of alloys and plastics differ by some %.
DENSITIES: Mapping[str, float] = {
    "steel": 7850.0,
    "cast iron": 7200.0,
    "aluminium": 2700.0,
    "titanium": 4500.0,
    "brass": 8500.0,
    "bronze": 8800.0,
    "copper": 8960.0,
    "POM": 1410.0,
    "PA": 1140.0,
    "ABS": 1050.0,
    "PLA": 1240.0,
}


@dataclass(frozen=True, eq=False)
class UniformSolid:
    """Volume [length^3], centre (3,) [length], and the inertia (3, 3) about it of a unit mass [length^2]."""

    volume: float
    centre: Floats
    inertia: Floats


def cylinder(start: Floats, end: Floats, diameter: float, bore: float = 0.0) -> UniformSolid:
    """A round bar between the middles (3,) of its ends, or a tube with a `bore`.

    With radii R and r

        V = pi (R^2 - r^2) l,   I = (R^2 + r^2) / 2 about the axis, (R^2 + r^2) / 4 + l^2 / 12 across it

    >>> cylinder(np.zeros(3), np.array([0.0, 0.0, 6.0]), 2.0).inertia.diagonal().tolist()
    [3.25, 3.25, 0.5]
    """
    along = end - start
    length = math.hypot(*along)
    squares = (diameter**2 + bore**2) / 4
    volume = math.pi / 4 * (diameter - bore) * (diameter + bore) * length
    inertia = _spun(along / length, squares / 2, squares / 4 + length**2 / 12)
    return UniformSolid(volume, (start + end) / 2, inertia)


def square_bar(start: Floats, end: Floats, width: float) -> UniformSolid:
    """A bar of square section between the middles (3,) of its ends."""
    along = end - start
    length = math.hypot(*along)
    inertia = _spun(along / length, width**2 / 6, (width**2 + length**2) / 12)
    return UniformSolid(width**2 * length, (start + end) / 2, inertia)


def box(centre: Floats, size: Floats, axes: Floats) -> UniformSolid:
    """A box of three edges `size` (3,) along the rows of `axes` (3, 3), unit vectors square to each other.

    `I_x = (b^2 + c^2) / 12` about the edge a, and so on.

    >>> box(np.zeros(3), np.array([1.0, 2.0, 3.0]), np.eye(3)).inertia.diagonal().round(6).tolist()
    [1.083333, 0.833333, 0.416667]
    """
    squares = size**2 / 12
    moments = squares.sum() - squares
    return UniformSolid(float(np.prod(size)), centre, axes.T @ (moments[:, None] * axes))


def ball(centre: Floats, radius: float) -> UniformSolid:
    """A ball: `I = 2/5 r^2`."""
    return UniformSolid(4 / 3 * math.pi * radius**3, centre, 0.4 * radius**2 * np.eye(3))


def _spun(axis: Floats, about: float, across: float) -> Floats:
    """An inertia (3, 3) that is one about a unit vector (3,) and another about all square to it."""
    return across * np.eye(3) + (about - across) * np.outer(axis, axis)
