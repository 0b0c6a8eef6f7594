"""Rigid motions and rotations as matrices, and the other ways to write a rotation.

Matrices act on columns: `T_ab` takes coordinates in b to coordinates in a. Leading axes `...` are kept: a
stack of motions is handled as one.

Source: Murray, Li and Sastry, "A mathematical introduction to robotic manipulation", chapter 2.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats

#: How far the product of a rotation and its transpose may be from 1: figures written with four decimals pass.
ROUNDED = 1e-3

#: What is rounding of a cosine or sine: this share of the angle, and so much at most.
EPSILON, MOST_ROUNDING = float(np.finfo(float).eps), 1e-9


def pose(rotation: npt.ArrayLike, origin: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Floats:
    """The rigid motion (..., 4, 4) with this rotation (..., 3, 3) and this origin (..., 3) [length]."""
    turn, place = np.asarray(rotation, dtype=np.float64), np.asarray(origin, dtype=np.float64)
    matrix = np.zeros((*np.broadcast_shapes(turn.shape[:-2], place.shape[:-1]), 4, 4))
    matrix[..., :3, :3], matrix[..., :3, 3], matrix[..., 3, 3] = turn, place, 1.0
    return matrix


def flaw_of_rotation(matrix: Floats) -> str:
    """Why a matrix (3, 3) is no rotation; empty for one that is, to the digits of `ROUNDED`."""
    off = float(np.abs(matrix @ matrix.T - np.eye(3)).max())
    if off > ROUNDED:
        return (
            f"is no rotation: its rows are not of length 1 and at right angles (off by {off:.2g}); "
            "give a rotation, or axis and angle"
        )
    return "is no rotation: it mirrors; change the sign of one row" if np.linalg.det(matrix) < 0 else ""


def inverse(motion: Floats) -> Floats:
    """The inverse (..., 4, 4) of a rigid motion (..., 4, 4)."""
    back = np.swapaxes(motion[..., :3, :3], -1, -2)
    return pose(back, -(back @ motion[..., :3, 3:])[..., 0])


def product(first: Floats, second: Floats) -> Floats:
    """The product of two motions (4, 4) or stacks of motions (n, 4, 4)."""
    if first.ndim > second.ndim:
        # one product of all rows is several times as quick as one for each
        return np.asarray((first.reshape(-1, 4) @ second).reshape(first.shape))
    return np.asarray(first @ second)


def placed(frame: Floats, place: npt.ArrayLike) -> Floats:
    """A place (3,) written in a frame (4, 4), in the coordinates in which that frame is given."""
    return np.asarray(frame[:3, :3] @ np.asarray(place, dtype=np.float64) + frame[:3, 3])


def about(axis: int, angle: npt.ArrayLike, size: int = 3) -> Floats:
    """The rotations (..., 3, 3) about x, y or z (`axis` 0, 1, 2) by angles (...) [rad].

    Quarter turns are exact: a cosine or sine of which only rounding is left is 0. With `size` 4 they are
    motions (..., 4, 4).
    """
    angles = np.asarray(angle, dtype=np.float64)
    rounding = np.minimum(EPSILON * np.abs(angles), MOST_ROUNDING)
    cosine, sine = (np.where(np.abs(v) < rounding, 0.0, v) for v in (np.cos(angles), np.sin(angles)))
    matrix = np.zeros((*angles.shape, size, size))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix[..., axis, axis] = matrix[..., 3:, 3:] = 1.0
    matrix[..., first, first] = matrix[..., second, second] = cosine
    matrix[..., second, first], matrix[..., first, second] = sine, -sine
    return matrix


def cross_matrix(vector: npt.ArrayLike) -> Floats:
    """The matrices (..., 3, 3) that take a vector to its product with those (..., 3) on its left: `w x v`."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=np.float64), -1, 0)
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)


def turns_about(axis: Floats, angles: Floats) -> Floats:
    """The rotations (n, 3, 3) about a direction (3,) of length 1 by angles (n,) [rad] (Rodrigues)."""
    tilde = cross_matrix(axis)
    sines, versed = np.sin(angles)[:, None, None], (1 - np.cos(angles))[:, None, None]
    return np.asarray(np.eye(3) + sines * tilde + versed * (tilde @ tilde))


def half_turn(axis: npt.ArrayLike) -> Floats:
    """The motion (4, 4) of half a turn about an axis (3,) through the origin: `2 a a^T / a.a - 1`.

    >>> half_turn((1, -1, 0))[:3, :3].tolist()
    [[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]
    """
    a = np.asarray(axis, dtype=np.float64)
    # no -0
    return pose(2.0 * np.outer(a, a) / float(a @ a) - np.eye(3) + 0.0)


def unit(vector: npt.ArrayLike) -> Floats:
    """The unit vector (3,) along a vector (3,) that is not zero."""
    direction = np.asarray(vector, dtype=np.float64)
    return np.asarray(direction / math.hypot(*direction))


def cross(a: Floats, b: Floats) -> Floats:
    """The vector product of two vectors (3,)."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def perpendicular(vector: Floats) -> Floats:
    """A unit vector (3,) at right angles to a vector (3,) that is not zero."""
    return unit(np.cross(vector, np.eye(3)[np.argmin(np.abs(vector))]))


def axial(matrices: Floats) -> Floats:
    """The vectors w (..., 3) of the skew parts of matrices (..., 3, 3): `w x v = (M - M^T) v / 2`."""
    odd = 0.5 * (matrices - np.swapaxes(matrices, -1, -2))
    return np.stack([odd[..., 2, 1], odd[..., 0, 2], odd[..., 1, 0]], axis=-1)


def rotation_vector(rotation: Floats) -> Floats:
    """The axis of a rotation (3, 3) times its angle [rad], (3,); of half a turn one of the two."""
    skew, cosine = axial(rotation), (float(np.trace(rotation)) - 1) / 2
    sine = math.hypot(*skew)
    angle = math.atan2(sine, cosine)
    if sine > 1e-6:
        return np.asarray(skew / sine * angle)
    if cosine > 0:
        return skew
    # half a turn: the axis is the column that is longest in R + 1
    columns = rotation + np.eye(3)
    return unit(columns[:, int(np.linalg.norm(columns, axis=0).argmax())]) * angle


def quaternion(rotation: Floats) -> Floats:
    """The unit quaternion (w, x, y, z), w >= 0, of a rotation (3, 3).

    It is the eigenvector of a symmetric matrix that belongs to the greatest eigenvalue, well conditioned
    for every rotation.
    """
    r = rotation
    matrix = np.diag([np.trace(r), *(2 * np.diag(r) - np.trace(r))])
    matrix[0, 1:] = matrix[1:, 0] = 2 * axial(r)
    matrix[1:, 1:] += (r + r.T) * (1 - np.eye(3))
    vector: Floats = np.linalg.eigh(matrix)[1][:, -1]
    return vector if vector[0] >= 0 else -vector


def rotation_of(quaternion: Floats) -> Floats:
    """The rotations (..., 3, 3) of unit quaternions (w, x, y, z), (..., 4)."""
    w, cross = quaternion[..., 0, None, None], cross_matrix(quaternion[..., 1:])
    return np.asarray(np.eye(3) + 2 * (w * cross + cross @ cross))


def zyx_turns(rotation: Floats) -> Floats:
    """The turns (..., 3) [rad] about z, y and x that make rotations (..., 3, 3): `Rz(a) Ry(b) Rx(c)`.

    The turn about y is within a quarter; where it is one, the turn about z is not defined, and the three
    still make the rotation.
    """
    first = np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])
    # what is left after the first, so that the three belong together where it is not defined
    rest = about(2, -first) @ rotation
    second = np.arctan2(-rest[..., 2, 0], rest[..., 0, 0])
    third = np.arctan2(-rest[..., 1, 2], rest[..., 1, 1])
    return np.stack([first, second, third], axis=-1)


def axis_to_z(axis: int) -> Floats:
    """The frame (4, 4) whose z is x, y or z of another."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.roll(np.eye(3), 2 - axis, axis=1)
    return matrix
