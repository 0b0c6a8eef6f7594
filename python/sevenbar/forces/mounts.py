"""Links that may carry a counterweight, and which numbers of it act on the shaking at all.

Source: docs/theory_forces.md, (19) and (20).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Booleans, Floats
from sevenbar.forces.directions import direction_text, tidied

#: A singular value below this part of the greatest is rounding, as for mobility.
RANK = 1e-8


@dataclass(frozen=True, eq=False)
class Mount:
    """A link that may carry a counterweight.

    `unit` (n, 4, 6) is its shaking, row by row, for unit first moments along the axes in which its points are
    written [by kg and length], and for 1 kg at their origin; moment [N m], then force [N]. Radii count from
    `pivot` (3,) [length], written as a point of the link; `axis` (3,) is the axis of the joint there, called
    `name`.
    """

    link: int
    unit: Floats
    pivot: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis: tuple[float, float, float] | None = None
    name: str = ""

    @property
    def columns(self) -> Floats:
        """What g and a mass in the pivot do, (n, 6, 4).

        Source: docs/theory_forces.md, (19).
        """
        moved = np.eye(4)
        moved[3, :3] = self.pivot
        return np.asarray(np.einsum("ij,njw->nwi", moved, self.unit))


@dataclass(frozen=True, eq=False)
class Acting:
    """The columns (rows, 4) of every link, root mean square over the cycle, and what of them acts."""

    columns: list[Floats]
    used: Booleans
    mass_acts: list[bool]
    greatest: float
    rank: int

    @staticmethod
    def of(columns: list[Floats]) -> Acting:
        """From columns (rows, 4) whose numbers are of one unit, each over the root of the rows."""
        # the mass has its own threshold: in the pivot of a link that turns about the ground it is rounding
        sizes = [np.linalg.norm(own, axis=0) for own in columns]
        whole = max(float(own.max(initial=0.0)) for own in sizes)
        acts = [bool(own[3] > RANK * whole) for own in sizes]
        used = np.concatenate([[True, True, True, one] for one in acts])
        values = np.linalg.svd(np.hstack(columns)[:, used], compute_uv=False)
        greatest = float(values.max(initial=0.0))
        return Acting(columns, used, acts, greatest, int((values > RANK * greatest).sum()) if greatest else 0)

    def least_squares(self, target: Floats) -> Floats:
        """The shortest numbers (links, 4) with the least |target + columns @ numbers|.

        Source: docs/theory_forces.md, (20).
        """
        left, values, right = np.linalg.svd(np.hstack(self.columns)[:, self.used], full_matrices=False)
        selected = slice(0, self.rank)
        numbers = np.zeros(len(self.used))
        numbers[self.used] = -right[selected].T @ ((left[:, selected].T @ target) / values[selected])
        return numbers.reshape(-1, 4)

    def names(self, mounts: Sequence[Mount]) -> list[str]:
        """What does nothing: of each link, then how many combinations of several links."""
        idle, single = [], 0
        for mount, own, acts in zip(mounts, self.columns, self.mass_acts, strict=True):
            _, values, right = np.linalg.svd(own[:, :3], full_matrices=True)
            values = np.pad(values, (0, 3 - len(values)))
            nothing = tidied(right[values <= RANK * self.greatest])
            idle += [
                f"link {mount.link}: mass times radius along {_along(mount, vector)}" for vector in nothing
            ]
            single += len(nothing)
            if not acts:
                idle.append(f"link {mount.link}: a mass in the pivot")
        several = int(self.used.sum()) - self.rank - single
        if several > 0:
            idle.append(f"{several} combination{'s' * (several > 1)} of several numbers")
        return idle


def _along(mount: Mount, vector: Floats) -> str:
    if mount.axis is not None:
        axis = np.asarray(mount.axis) / np.linalg.norm(mount.axis)
        if np.linalg.norm(np.cross(axis, vector)) < RANK * 10:
            return f"the axis of {mount.name or 'its joint'}"
    return direction_text(vector)
