"""Rigid motions of many poses at once: components first, then samples and rows; analytic, so complex too."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

#: Real numbers, or complex ones within a complex step; trailing axes are samples and rows.
Numbers = npt.NDArray[Any]

#: A rigid motion: rotation (3, 3, ..) and place (3, ..).
Rigid = tuple[Numbers, Numbers]


def constant(values: npt.ArrayLike, trailing: int) -> Numbers:
    """Numbers that depend on nothing, with so many axes of length 1 behind."""
    array = np.asarray(values, dtype=np.float64)
    return array.reshape(array.shape + (1,) * trailing)


def then(one: Rigid, other: Rigid) -> Rigid:
    """The motion `one @ other`."""
    return product(one[0], other[0]), moved(one, other[1])


def product(one: Numbers, other: Numbers) -> Numbers:
    """The product of two rotations."""
    return np.stack([turned(one, other[:, k]) for k in range(3)], axis=1)


def moved(motion: Rigid, at: Numbers) -> Numbers:
    """A place (3, ..) after a motion."""
    return np.asarray(motion[1] + turned(motion[0], at))


def turned(rotation: Numbers, vector: Numbers) -> Numbers:
    """A vector (3, ..) after a rotation; components that are zero for all samples cost nothing."""
    parts = [rotation[:, k] * vector[k] for k in range(3) if np.any(vector[k])]
    if not parts:
        return np.zeros(np.broadcast_shapes(rotation[:, 0].shape, vector.shape), dtype=vector.dtype)
    return np.asarray(sum(parts[1:], parts[0]))


def inverse(motion: Rigid) -> Rigid:
    """The motion back."""
    back = np.swapaxes(motion[0], 0, 1)
    return back, -turned(back, motion[1])


def about(axis: int, angle: Numbers) -> Numbers:
    """The rotation about an axis 0, 1, 2 of the frame."""
    matrix = np.zeros((3, 3, *angle.shape), dtype=angle.dtype)
    b, c = (axis + 1) % 3, (axis + 2) % 3
    matrix[axis, axis] = 1.0
    matrix[b, b] = matrix[c, c] = np.cos(angle)
    matrix[c, b] = np.sin(angle)
    matrix[b, c] = -matrix[c, b]
    return matrix


def spun(rotation: Numbers, axis: int, angle: Numbers) -> Numbers:
    """A rotation followed by one about its own axis 0, 1, 2."""
    b, c = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(angle), np.sin(angle)
    columns = {
        axis: np.broadcast_to(rotation[:, axis], np.broadcast_shapes(rotation[:, axis].shape, angle.shape)),
        b: rotation[:, b] * cosine + rotation[:, c] * sine,
        c: rotation[:, c] * cosine - rotation[:, b] * sine,
    }
    return np.stack([columns[k] for k in range(3)], axis=1)


def cross(a: Numbers, b: Numbers) -> Numbers:
    """The vector product of vectors (3, ..)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def unit(vector: Numbers) -> Numbers:
    """The direction of vectors (3, ..)."""
    return np.asarray(vector / np.sqrt((vector * vector).sum(axis=0)))
