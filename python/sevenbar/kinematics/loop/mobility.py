"""How freely a loop moves: freedoms counted, idle ones and redundant constraints named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.directions import ROUNDING, direction_text, tidied


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

    @property
    def met_twice(self) -> int:
        """How many constraints are met twice over along the motion: as much more is free to first order."""
        if self.rank is None or self.finite != 1:
            return 0
        return self.freedoms - len(self.idle) - self.rank - self.finite

    def __str__(self) -> str:
        parts = [f"Gruebler {self.gruebler}"]
        if self.idle:
            parts.append(f"idle {len(self.idle)}")
        if self.redundant:
            parts.append(f"redundant constraints {len(self.redundant)}")
        if self.finite is not None:
            parts.append(f"moves with {self.finite}")
        return ", ".join(parts)


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
    rank = int((values > ROUNDING).sum())
    couples = rows[rank:] @ moments
    lines = [f"a moment about {direction_text(c)}" for c in tidied(couples)]
    carriers = rows[:rank]
    for force, moment in zip(carriers @ forces, carriers @ moments, strict=True):
        pitch = float(force @ moment) / float(force @ force)
        kind = "a force along" if abs(pitch) < ROUNDING or len(couples) else "a wrench along"
        lines.append(f"{kind} {direction_text(force)}")
    return tuple(lines)
