"""A point that goes along a straight line, wherever that is."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.design.task.task import StraightWant
from sevenbar.design.task.wants.wanted import Begun, Stations
from sevenbar.kinematics.circuits.circuit import Circuit


class LineWanted:
    """Distances of a point p from the line through two unknown places a and b, in three parts.

    r = p - a - t (b - a),    t = (p - a) . (b - a) / |b - a|^2

    and what the point's way from first to last lacks of the length, where one is given.
    """

    turns = False

    def __init__(self, loop: TaskLoop, want: StraightWant) -> None:
        self.weight = want.weight
        self.numbers, self._name = [loop.named(want.point)], want.point
        self._length = want.length
        self.unit = loop.size if want.length is None else want.length
        inputs = np.linspace(*want.inputs, want.samples)
        self.stations = Stations(inputs, np.zeros((want.samples, 6)), np.full(6, loop.size))
        self.count = 3 * want.samples + (want.length is not None)

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """The residuals (r,), and their slopes (r, k + 6)."""
        p, by = here.points[:, self.numbers[0]], here.points_by[:, self.numbers[0]]
        a, way = u[:3], u[3:] - u[:3]
        square = float(way @ way)
        off = p - a
        t = off @ way / square
        across = np.eye(3) - np.outer(way, way) / square
        left = (off - t[:, None] * way).ravel()
        gone = p[-1] - p[0]
        size = float(np.linalg.norm(gone)) or 1.0
        if self._length is not None:
            left = np.append(left, min(size - self._length, 0.0))
        if not by.shape[-1]:
            return left / self.unit, np.empty((len(left), 0))
        slopes = np.einsum("ij,njk->nik", across, by)
        t_a = (-way - off + 2 * t[:, None] * way) / square
        t_b = (off - 2 * t[:, None] * way) / square
        slopes[:, :, -6:-3] += (t[:, None, None] - 1) * np.eye(3) - np.einsum("i,nj->nij", way, t_a)
        slopes[:, :, -3:] += -t[:, None, None] * np.eye(3) - np.einsum("i,nj->nij", way, t_b)
        slopes = slopes.reshape(3 * len(p), -1)
        if self._length is not None:
            short = size < self._length
            slopes = np.concatenate([slopes, (short * gone @ (by[-1] - by[0]) / size)[None]])
        return left / self.unit, slopes / self.unit

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:  # noqa: ARG002
        """On a pass that has the range of inputs, with the best line of its rows."""
        curve = one.named(self._name)
        found = []
        for rows in one.begins(self.stations.fixed, free=False)[1][:1]:
            p = curve[rows]
            middle = p.mean(axis=0)
            way = np.linalg.svd(p - middle)[2][0]
            along = (p - middle) @ way
            error = float(((p - middle - along[:, None] * way) ** 2).sum() / p.size / self.unit**2)
            u = np.concatenate([middle + along.min() * way, middle + along.max() * way])
            found.append(Begun(u, rows, error, placing))
        return found

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:  # noqa: ARG002
        """The distances (n,) from the line on rows of an analysis [length]."""
        way = (u[3:] - u[:3]) / np.linalg.norm(u[3:] - u[:3])
        off = np.cross(circuit.point(self._name).position[rows] - u[:3], way)
        return np.asarray(np.linalg.norm(off, axis=1))
