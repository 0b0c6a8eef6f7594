"""Functions between the drive's two joints, and dwells of the output."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.design.task.task import DwellWant, FunctionWant
from sevenbar.design.task.wants.wanted import Begun, Stations
from sevenbar.kinematics.circuits.circuit import Circuit

#: So many of the best starts of a free input zero are tried.
TRIED = 2


class ReadingsWanted:
    """The output's readings (n,) at n stations, from zeros of input and output that may be unknowns."""

    def __init__(self, loop: TaskLoop, want: FunctionWant | DwellWant) -> None:
        self.weight = want.weight
        if isinstance(want, FunctionWant):
            inputs, self.readings, (first, second) = want.input, want.output, want.zeros
        else:
            inputs = np.linspace(*want.inputs, want.samples)
            self.readings, first, second = np.zeros(want.samples), 0.0, want.level
        self.turns = bool(loop.numbers.turns[loop.output])
        self.unit = float(loop.units[loop.output])
        self._column = loop.output
        self._input_free, self._output_free = first is None, second is None
        scales = [loop.units[loop.input]] * (first is None) + [self.unit] * (second is None)
        by = np.zeros((len(inputs), len(scales)))
        by[:, : int(first is None)] = 1.0
        self._zero = 0.0 if second is None else second
        self.stations = Stations(inputs + (first or 0.0), by, np.array(scales))
        self.count = len(inputs)

    def _apart(self, values: Floats) -> Floats:
        return short_way(values) if self.turns else values

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        """What the output is off (n,) at its stations, and the slopes (n, k + m)."""
        zero = u[-1] if self._output_free else self._zero
        by = here.q_by[:, self._column].copy()
        if self._output_free:
            by[:, -1:] -= 1.0
        return self._apart(here.q[:, self._column] - self.readings - zero) / self.unit, by / self.unit

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:  # noqa: ARG002
        """From the best starts of the inputs."""
        fixed, inputs, outputs = self.stations.fixed, one.inputs, one.outputs
        phases, rows = one.begins(fixed, free=self._input_free)
        gap = fixed + phases[:, None] - inputs[rows]
        slope = np.gradient(outputs, inputs)[rows]
        off = outputs[rows] - self.readings + slope * (short_way(gap) if one.turns else gap)
        zeros = np.full((len(rows), 1), self._zero)
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
        return self._apart(
            circuit.output[rows] - self.readings - (u[-1] if self._output_free else self._zero)
        )
