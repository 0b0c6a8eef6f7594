"""How freely a loop moves: freedoms counted, idle ones and redundant constraints named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats


@dataclass(frozen=True)
class Mobility:
    """The freedoms of a single loop.

    `freedoms` of all joints; `gruebler = freedoms - 6`; `rank` of the joints' screws in the poses found,
    idle freedoms aside (`None` where no pose was found); `finite` the freedoms that remain for motion, idle
    ones aside; `idle` and `redundant` in words.

    Source: docs/theory.md, (17) and (18).
    """

    freedoms: int
    gruebler: int
    rank: int | None
    finite: int | None
    idle: tuple[str, ...] = ()
    redundant: tuple[str, ...] = ()

    def __str__(self) -> str:
        parts = [f"Gruebler {self.gruebler}"]
        if self.idle:
            parts.append(f"idle {len(self.idle)}")
        if self.redundant:
            parts.append(f"redundant constraints {len(self.redundant)}")
        if self.finite is not None:
            parts.append(f"moves with {self.finite}")
        return ", ".join(parts)


#: Below this share of a wrench's length a part of it is rounding.
_ZERO = 1e-7


def redundant_constraints(wrenches: Floats, base: Floats) -> tuple[str, ...]:
    """One line for each redundant constraint.

    `wrenches` (k, 6): a basis of the forces and moments that all joints bear together, in the frame `base`,
    of the pose in which they were found. Those along the axes of the report frame are named so.
    """
    if len(wrenches) == 0:
        return ()
    forces, moments = wrenches[:, :3] @ base[:3, :3].T, wrenches[:, 3:] @ base[:3, :3].T
    # pure moments first: combinations without a force
    _, values, rows = np.linalg.svd(forces.T, full_matrices=True)
    rank = int((values > _ZERO).sum())
    couples = rows[rank:] @ moments
    lines = [f"a moment about {_direction(c)}" for c in _tidied(couples)]
    carriers = rows[:rank]
    for force, moment in zip(carriers @ forces, carriers @ moments, strict=True):
        pitch = float(force @ moment) / float(force @ force)
        kind = "a force along" if abs(pitch) < _ZERO or len(couples) else "a wrench along"
        lines.append(f"{kind} {_direction(force)}")
    return tuple(lines)


def _tidied(vectors: Floats) -> Floats:
    """A basis of the same space, along coordinate axes where these lie in it."""
    if len(vectors) == 0:
        return vectors
    basis = np.linalg.qr(vectors.T)[0].T
    kept = [axis for axis in np.eye(3) if np.linalg.norm(axis - basis.T @ (basis @ axis)) < _ZERO]
    for vector in basis:
        rest = vector - sum((float(vector @ k) * k for k in kept), np.zeros(3))
        if len(kept) < len(basis) and np.linalg.norm(rest) > 0.1:
            kept.append(rest / np.linalg.norm(rest))
    return np.array(kept[: len(basis)])


def _direction(vector: Floats) -> str:
    unit = vector / np.linalg.norm(vector)
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        if abs(abs(float(unit @ axis)) - 1) < _ZERO:
            return name
    if unit[np.argmax(np.abs(unit))] < 0:
        unit = -unit
    return "(" + ", ".join(f"{x:.4f}" for x in np.where(np.abs(unit) < _ZERO, 0.0, unit)) + ")"
