"""Wants at given inputs: functions between the drive's two joints, dwells, points on a straight line."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.design.task.task import DwellWant, FunctionWant, StraightWant
from sevenbar.design.task.wants.wanted import Begun, Bound, Stations, Wanted, both_signs, distances
from sevenbar.kinematics.circuits.circuit import Circuit

#: So many of the best starts of a free input zero are tried.
TRIED = 2


class ReadingsWanted(Wanted):
    """The output's `readings` (n,) at `inputs` (n,), both from zeros that may be unknowns."""

    def __init__(self, loop: TaskLoop, want: FunctionWant | DwellWant) -> None:
        self.weight = want.weight
        if isinstance(want, FunctionWant):
            self.inputs, self.readings, self._zeros = want.input, want.output, want.zeros
        else:
            self.inputs, self.readings = np.linspace(*want.inputs, want.samples), np.zeros(want.samples)
            self._zeros = 0.0, want.level
        first, second = self._zeros
        self.turns = bool(loop.numbers.turns[loop.output])
        self.unit = float(loop.units[loop.output])
        self._column = loop.output
        self._input_free, self._output_free = first is None, second is None
        scales = [loop.units[loop.input]] * (first is None) + [self.unit] * (second is None)
        by = np.zeros((len(self.inputs), len(scales)))
        by[:, : int(first is None)] = 1.0
        self.stations = Stations(self.inputs + (first or 0.0), by, np.array(scales))
        self.count = len(self.inputs)

    def zeros(self, u: Floats) -> tuple[float, float]:
        """The values of input and output at the readings 0, by its own unknowns."""
        first, second = self._zeros
        return float(u[0]) if first is None else first, float(u[-1]) if second is None else second

    def _apart(self, values: Floats) -> Floats:
        return short_way(values) if self.turns else values

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """What the output is off (n,) at its stations, and the slopes (n, k + m)."""
        by = here.q_by[:, self._column].copy()
        if self._output_free:
            by[:, -1:] -= 1.0
        off = here.q[:, self._column] - self.readings - self.zeros(u)[1]
        return self._apart(off) / self.unit, by / self.unit

    def heights(self, left: Floats, by: Floats) -> tuple[Floats, Floats]:
        """What the output is off, to either side."""
        return both_signs(left, by)

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:  # noqa: ARG002
        """From the best starts of the inputs."""
        fixed, inputs, outputs = self.stations.fixed, one.inputs, one.outputs
        phases, rows = one.begins(fixed, free=self._input_free)
        gap = fixed + phases[:, None] - inputs[rows]
        slope = np.gradient(outputs, inputs)[rows]
        off = outputs[rows] - self.readings + slope * (short_way(gap) if one.turns else gap)
        zeros = np.full((len(rows), 1), self._zeros[1] or 0.0)
        if self._output_free:
            zeros = off[:, :1] + self._apart(off - off[:, :1]).mean(axis=1, keepdims=True)
        errors = ((self._apart(off - zeros) / self.unit) ** 2).mean(axis=1)
        return [
            Begun(
                np.array([phases[k]] * self._input_free + [zeros[k, 0]] * self._output_free),
                rows[k],
                float(errors[k]),
                placing,
            )
            for k in np.argsort(errors, kind="stable")[:TRIED]
        ]

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:  # noqa: ARG002
        """What the output is off (n,) on rows of an analysis [rad, or length]."""
        return self._apart(circuit.output[rows] - self.readings - self.zeros(u)[1])


class LineWanted(Wanted):
    """Distances of a point p from the line through two unknown places a and b, in three parts.

    r = p - a - t (b - a),    t = (p - a) . (b - a) / |b - a|^2

    Where a length is given, the point must go as far: the distance of the two places farthest along the line.
    """

    turns = False

    def __init__(self, loop: TaskLoop, want: StraightWant) -> None:
        self.weight = want.weight
        self.numbers, self._name = [loop.named(want.point)], want.point
        self._length = want.length
        self.unit = loop.size if want.length is None else want.length
        inputs = np.linspace(*want.inputs, want.samples)
        self.stations = Stations(inputs, np.zeros((want.samples, 6)), np.full(6, loop.size))
        self.count = 3 * want.samples
        self._length_unit = loop.linkage.length_unit

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """The residuals (r,), and their slopes (r, k + 6)."""
        p, by = here.points[:, self.numbers[0]], here.points_by[:, self.numbers[0]]
        a, way = u[:3], u[3:] - u[:3]
        square = float(way @ way)
        off = p - a
        t = off @ way / square
        across = np.eye(3) - np.outer(way, way) / square
        left = (off - t[:, None] * way).ravel()
        if not by.shape[-1]:
            return left / self.unit, np.empty((len(left), 0))
        slopes = np.einsum("ij,njk->nik", across, by)
        t_a = (-way - off + 2 * t[:, None] * way) / square
        t_b = (off - 2 * t[:, None] * way) / square
        slopes[:, :, -6:-3] += (t[:, None, None] - 1) * np.eye(3) - np.einsum("i,nj->nij", way, t_a)
        slopes[:, :, -3:] += -t[:, None, None] * np.eye(3) - np.einsum("i,nj->nij", way, t_b)
        return left / self.unit, slopes.reshape(3 * len(p), -1) / self.unit

    def heights(self, left: Floats, by: Floats) -> tuple[Floats, Floats]:
        """Distances from the line."""
        return distances(left, by)

    def bound(self, here: Here) -> Bound | None:
        """That the point goes as far as the length."""
        if self._length is None:
            return None
        p, by = here.points[:, self.numbers[0]], here.points_by[:, self.numbers[0]]
        first, last = farthest(p)
        gone = p[last] - p[first]
        size = float(np.linalg.norm(gone))
        slopes = gone @ (by[last] - by[first]) / max(size, 1e-300) / self.unit
        asked = f"at least {self._length:g} {self._length_unit} is asked"
        missed = f"the point goes {size:.4g} {self._length_unit}, {asked}"
        return Bound("length", (size - self._length) / self.unit, slopes, missed)

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:  # noqa: ARG002
        """On a pass that has the range of inputs, with the best line of its rows."""
        curve = one.point(self._name)
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


def farthest(p: Floats) -> tuple[int, int]:
    """The two of some places (n, 3) that are farthest from each other along their best line."""
    along = p @ np.linalg.svd(p - p.mean(axis=0), full_matrices=False)[2][0]
    return int(along.argmin()), int(along.argmax())
