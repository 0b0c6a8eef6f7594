"""Wants about the output over the input: functions and dwells, as residuals in a loop."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.design.task.wanted import ReadingsCurve, Stations, TaskStart, Used, Wanted, both_signs
from sevenbar.kinematics.circuits.circuit import Circuit

#: So many of the best starts of a free input zero are tried.
TRIED = 2


class ReadingsWanted(Wanted):
    """The output's `readings` (n,) at `inputs` (n,), from `zeros` that are unknowns where `None`."""

    def __init__(
        self,
        loop: TaskLoop,
        inputs: Floats,
        readings: Floats,
        zeros: tuple[float | None, float | None],
        weight: float,
    ) -> None:
        self.inputs, self.readings, self._zeros, self.weight = inputs, readings, zeros, weight
        first, second = zeros
        self.turns = bool(loop.numbers.turns[loop.output])
        self.unit = float(loop.units[loop.output])
        self._column = loop.output
        self._input_free, self._output_free = first is None, second is None
        scales = []
        if self._input_free:
            scales.append(loop.units[loop.input])
        if self._output_free:
            scales.append(self.unit)
        by = np.zeros((len(inputs), len(scales)))
        if self._input_free:
            by[:, 0] = 1.0
        self.stations = Stations(inputs + (first or 0.0), by, np.array(scales))
        self.count = len(inputs)

    def zeros(self, u: Floats) -> tuple[float, float]:
        """The values of input and output at the readings 0, by its own unknowns."""
        first, second = self._zeros
        return float(u[0]) if first is None else first, float(u[-1]) if second is None else second

    def _apart(self, values: Floats) -> Floats:
        return short_way(values) if self.turns else values

    def residuals(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        by = here.q_by[:, self._column].copy()
        if self._output_free:
            by[:, -1:] -= 1.0
        off = here.q[:, self._column] - self.readings - self.zeros(u)[1]
        return self._apart(off) / self.unit, by / self.unit

    def heights(self, residuals: Floats, by: Floats) -> tuple[Floats, Floats]:
        return both_signs(residuals, by)

    def starts(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[TaskStart]:
        fixed, inputs, outputs = self.stations.fixed, one.inputs, one.outputs
        phases, rows = one.begins(fixed, free=self._input_free)
        gap = fixed + phases[:, None] - inputs[rows]
        slope = np.gradient(outputs, inputs)[rows]
        off = outputs[rows] - self.readings + slope * (short_way(gap) if one.turns else gap)
        zeros = np.full((len(rows), 1), self._zeros[1] or 0.0)
        if self._output_free:
            zeros = off[:, :1] + self._apart(off - off[:, :1]).mean(axis=1, keepdims=True)
        errors = ((self._apart(off - zeros) / self.unit) ** 2).mean(axis=1)
        free = np.column_stack([phases, zeros[:, 0]])[:, [self._input_free, self._output_free]]
        best = np.argsort(errors, kind="stable")[:TRIED]
        return [TaskStart(free[k], rows[k], float(errors[k]), placing) for k in best]

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:
        return self._apart(circuit.output[rows] - self.readings - self.zeros(u)[1])

    def shown_zeros(self, used: Used) -> tuple[float, float]:
        """The values of input and output at the readings 0 [rad, or length], angles in (-pi, pi]."""
        first, second = self.zeros(used.u)
        turns = used.loop.numbers.turns
        return (
            float(short_way(first)) if turns[used.loop.input] else first,
            float(short_way(second)) if turns[used.loop.output] else second,
        )

    def curve(self, used: Used) -> ReadingsCurve:
        first, second = self.shown_zeros(used)
        x, y = used.inputs - first, used.poses[:, self._column] - second
        if used.loop.numbers.turns[used.loop.input]:
            # on the turn of the readings
            x = x - math.tau * np.round((x[0] - self.inputs[0]) / math.tau)
        if self.turns:
            y = np.unwrap(y)
            y = y - math.tau * np.round((y[0] - self.readings[0]) / math.tau)
        return ReadingsCurve(x, y, self.inputs, self.readings)
