"""The output of changed designs, exactly, on the circuit and the pass of the nominal one."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.linear import Linear
from sevenbar.design.tolerance.loop import Loop, Poses
from sevenbar.design.tolerance.outputs import QUANTITIES, values_of

#: Steps in which a change is made where it is too great for one.
PARTS = 8


class Designs:
    """Changed designs of a linear estimate, on its rows."""

    def __init__(self, linear: Linear) -> None:
        found = linear.found
        self.loop: Loop = found.loop
        self.poses: Poses = found.poses.only(np.isin(found.poses.rows, linear.rows))
        self.speed = found.speed
        self.output = found.outputs[found.place(linear.output, linear.quantity)]
        self.order = QUANTITIES.index(self.output.quantity)
        self.by_p = self.loop.slopes(self.poses)[0]
        self.nominal = self.values(self.loop.nominal, self.poses.u)[0]

    def followed(self, changes: Floats) -> Floats:
        """The passive columns (m, samples, rows) of designs changed by (dimensions, samples, rows or 1).

        NaN where the loop does not close on the same pass of the circuit.
        """
        p = self.loop.nominal + changes
        u = self.loop.followed(p, self.poses, self.poses.u + self._predicted(changes))
        lost = np.flatnonzero(np.isnan(u).any(axis=(0, 2)))
        if lost.size:
            again = np.broadcast_to(self.poses.u, (len(u), lost.size, len(self.poses)))
            for share in np.arange(1, PARTS + 1) / PARTS:
                again = self.loop.followed(self.loop.nominal + share * changes[:, lost], self.poses, again)
            u[:, lost] = np.where(np.isnan(u[:, lost]), again, u[:, lost])
        return u

    def _predicted(self, changes: Floats) -> Floats:
        """The linear prediction (m, samples, rows) of how the passive columns change."""
        still = np.isfinite(self.by_p).all(axis=(0, 2))
        shape = (changes.shape[1], len(self.poses))
        wide = np.broadcast_to(changes[still], (int(still.sum()), *shape))
        return np.asarray(np.einsum("mkr,ksr->msr", self.by_p[:, still], wide))

    def values(self, p: Floats, u: Floats) -> Floats:
        """The output (samples, rows)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(values_of(self.loop, self.poses, (self.output,), p, u, self.speed)[0])

    def deviations(self, changes: Floats, u: Floats) -> Floats:
        """The output of changed designs less the nominal one's, (samples, rows)."""
        return np.asarray(self.values(self.loop.nominal + changes, u) - self.nominal)

    def determinants(self, changes: Floats, u: Floats) -> Floats:
        """The determinant (samples, rows) that is zero at a dead centre of the input."""
        x = np.broadcast_to(self.poses.x, u.shape[1:])
        walk = self.loop.walk(self.loop.nominal + changes, self.poses, x, u)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.linalg.det(self.loop.matrix(walk, self.poses)))
