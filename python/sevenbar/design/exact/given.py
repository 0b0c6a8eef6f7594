"""Poses and orientations as callers give them: rigid, different, and as displacements from the first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.loop.rigid import about, flaw_of_rotation, pose

#: How far the last row of a rigid motion may be from 0, 0, 0, 1.
RIGID = 1e-5

#: Two poses are one where no number differs by more [rad, relative to the greatest distance of two].
SAME_POSE = 1e-9


@dataclass(frozen=True, eq=False)
class Displacements:
    """Where a body goes from its first pose: `motions` (n, 4, 4), the first the identity.

    Coordinates count from `origin` (3,), the place of the body's own point in the first pose; `reach` is the
    greatest distance of two of its places, 1 where all are one [length].
    """

    motions: Floats
    origin: Floats
    reach: float

    @property
    def turns(self) -> Floats:
        """The rotations (n - 1, 3, 3) from the first pose."""
        return self.motions[1:, :3, :3]

    @property
    def shifts(self) -> Floats:
        """The ways (n - 1, 3) of the body's point from the first pose, relative to `reach`."""
        return np.asarray(self.motions[1:, :3, 3] / self.reach)

    @property
    def centre(self) -> Floats | None:
        """The place (3,) that all displacements leave where it is, in the caller's coordinates, if any."""
        sides, right = np.concatenate(np.eye(3) - self.turns), np.concatenate(self.shifts)
        result = np.linalg.lstsq(sides, right, rcond=None)[0]
        still = np.abs(sides @ result - right).max() < SAME_POSE
        return np.asarray(result * self.reach + self.origin) if still else None


def planar_given(poses: npt.ArrayLike, least: int, most: int) -> Displacements:
    """The displacements of planar poses (n, 3): x, y [length] and angle [rad]."""
    given = _given("poses", poses, (3,), "rows x, y, angle (n, 3)")
    places = np.column_stack([given[:, :2], np.zeros(len(given))])
    return displacements(pose(about(2, given[:, 2]), places), least, most, what="poses")


def orientations_given(orientations: npt.ArrayLike, least: int, most: int) -> Displacements:
    """The displacements of rotation matrices (n, 3, 3)."""
    given = _given("orientations", orientations, (3, 3), "rotation matrices (n, 3, 3)")
    return displacements(pose(_rotations("orientations", given)), least, most, what="orientations")


def poses_given(poses: npt.ArrayLike, least: int, most: int) -> Displacements:
    """The displacements of rigid motions (n, 4, 4)."""
    given = _given("poses", poses, (4, 4), "rigid motions (n, 4, 4)")
    last = np.abs(given[:, 3] - [0.0, 0.0, 0.0, 1.0]).max(axis=1)
    if (last > RIGID).any():
        raise RequestError(
            f"poses[{int(last.argmax())}]: the last row is not 0, 0, 0, 1; give a rigid motion"
        )
    turns = _rotations("poses", given[:, :3, :3])
    return displacements(pose(turns, given[:, :3, 3]), least, most, what="poses")


def _given(name: str, values: npt.ArrayLike, shape: tuple[int, ...], what: str) -> Floats:
    """Finite numbers (n, ..) of a shape, or `RequestError` saying what to give."""
    given = numbers_given(name, values)
    if given.ndim != 1 + len(shape) or given.shape[1:] != shape:
        raise RequestError(f"{name}: an array of shape {given.shape} does not fit; give {what}")
    return given


def displacements(poses: Floats, least: int, most: int, *, what: str) -> Displacements:
    """The displacements from the first of poses (n, 4, 4); `RequestError` for too many, or twins."""
    if not least <= len(poses) <= most:
        allowed = f"{least} to {most}" if least < most else f"{least}"
        raise RequestError(f"{what}: {len(poses)} are given; give {allowed}")
    places = poses[:, :3, 3]
    reach = float(np.linalg.norm(places[:, None] - places[None], axis=2).max())
    if reach <= SAME_POSE * float(np.abs(places).max(initial=0.0)):
        reach = 1.0
    for i in range(len(poses)):
        for j in range(i):
            apart = np.abs(poses[i] - poses[j])
            apart[:3, 3] /= reach
            if apart.max() < SAME_POSE:
                raise RequestError(f"{what}[{i}]: is the same as {what}[{j}]; give each once")
    turns = poses[:, :3, :3] @ poses[0, :3, :3].T
    turns[0] = np.eye(3)
    return Displacements(pose(turns, places - places[0]), places[0].copy(), reach)


def place_text(values: Floats, size: float) -> str:
    """A place or direction in a message: "(1.5, 0, -2)", rounding relative to a size as 0."""
    selected = np.where(np.abs(values) < SAME_POSE * size, 0.0, values)
    return "(" + ", ".join(f"{value:.6g}" for value in selected) + ")"


def numbers_given(name: str, values: npt.ArrayLike) -> Floats:
    """An array of finite numbers, or `RequestError` naming the first that is none."""
    try:
        given = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise RequestError(f"{name}: {shown(values)} is not an array of numbers") from None
    bad = np.argwhere(~np.isfinite(given))
    if bad.size:
        place = ", ".join(str(i) for i in bad[0])
        value = given[tuple(bad[0])]
        raise RequestError(f"{name}[{place}]: {value} is not a finite number; give a finite one")
    return given


def _rotations(name: str, given: Floats) -> Floats:
    """Matrices (n, 3, 3) that are rotations up to their last digits, as the nearest exact ones."""
    for i, matrix in enumerate(given):
        if flaw := flaw_of_rotation(matrix):
            raise RequestError(f"{name}[{i}]: {flaw}")
    left, _, right = np.linalg.svd(given)
    return np.asarray(left @ right)
