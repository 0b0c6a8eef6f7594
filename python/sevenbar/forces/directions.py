"""Directions as people read them: a basis along coordinate axes where these lie in it, and its names."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats

#: Below this share of a vector's length a part of it is rounding.
ROUNDING = 1e-7


def tidied(vectors: Floats) -> Floats:
    """A basis of the space of vectors (k, 3), along coordinate axes where these lie in it."""
    if len(vectors) == 0:
        return vectors
    basis = np.linalg.qr(vectors.T)[0].T
    selected = [axis for axis in np.eye(3) if np.linalg.norm(axis - basis.T @ (basis @ axis)) < ROUNDING]
    for vector in basis:
        rest = vector - sum((float(vector @ k) * k for k in selected), np.zeros(3))
        if len(selected) < len(basis) and np.linalg.norm(rest) > 0.1:
            selected.append(rest / np.linalg.norm(rest))
    return np.array(selected[: len(basis)])


def direction_text(vector: Floats) -> str:
    """A direction (3,): x, y or z, else its three coordinates, the greatest of them positive."""
    unit = vector / np.linalg.norm(vector)
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        if abs(abs(float(unit @ axis)) - 1) < ROUNDING:
            return name
    if unit[np.argmax(np.abs(unit))] < 0:
        unit = -unit
    return "(" + ", ".join(f"{x:.4f}" for x in np.where(np.abs(unit) < ROUNDING, 0.0, unit)) + ")"
