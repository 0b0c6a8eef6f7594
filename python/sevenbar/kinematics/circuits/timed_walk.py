"""A circuit walked in time: its row at a time, the time and the input of a row, the rows at an input."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import Walk, walk
from sevenbar.kinematics.loop.geometry import Loop

#: Inputs [rad, or parts of the linkage's size] nearer to a limit are at it.
SAME_INPUT = 1e-9
#: Rows nearer to a sample are the sample.
SAME_ROW = 1e-9


#: By whether a stretch stands still first and last: the phase at a share of its input, the share at a phase.
PHASES: Mapping[tuple[bool, bool], tuple[Callable[[float], float], Callable[[float], float]]] = {
    (True, True): (lambda x: 2 * math.atan2(math.sqrt(x), math.sqrt(1 - x)), lambda p: math.sin(p / 2) ** 2),
    (True, False): (math.sqrt, lambda p: p**2),
    (False, True): (lambda x: 1 - math.sqrt(1 - x), lambda p: 1 - (1 - p) ** 2),
    (False, False): (lambda x: x, lambda p: p),
}


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of a path: its first row, the input on its rows, and whether it stands still at either end.

    Near a dead centre the joints move as the root of what is left of the input. So a place between two rows
    is given by a phase, an angle of which the input is the cosine: by that the joints run evenly.
    """

    start: int
    input: Floats
    stands_first: bool
    stands_last: bool

    @property
    def last(self) -> int:
        """Its last row on the path."""
        return self.start + len(self.input) - 1

    def row_of(self, value: float) -> float:
        """The row of the path at which the pass meets an input within its range."""
        sign = 1.0 if self.input[-1] >= self.input[0] else -1.0
        low = int(np.searchsorted(sign * self.input, sign * value, side="right")) - 1
        low = min(max(low, 0), len(self.input) - 2)
        before, after = self._phase(float(self.input[low])), self._phase(float(self.input[low + 1]))
        share = (self._phase(value) - before) / (after - before) if after != before else 0.0
        return self.start + low + share

    def input_at(self, row: float) -> float:
        """The input at a row of the path within the pass."""
        low = int(row) - self.start
        before, after = self._phase(float(self.input[low])), self._phase(float(self.input[low + 1]))
        first, last = float(self.input[0]), float(self.input[-1])
        return first + self._share(before + (row - int(row)) * (after - before)) * (last - first)

    def _phase(self, value: float) -> float:
        first, last = float(self.input[0]), float(self.input[-1])
        share = min(max((value - first) / (last - first), 0.0), 1.0) if last != first else 0.0
        return PHASES[self.stands_first, self.stands_last][0](share)

    def _share(self, phase: float) -> float:
        """How much of its input a pass has gone at a phase."""
        return PHASES[self.stands_first, self.stands_last][1](phase)


@dataclass(frozen=True, eq=False)
class TimedWalk:
    """A circuit of a motion, to be walked in time."""

    motion: Motion
    circuit: Circuit

    @property
    def linkage(self) -> Loop:
        """The linkage that moves."""
        return self.motion.linkage

    @cached_property
    def path(self) -> Walk:
        """The circuit's rows in the order of its motion."""
        return walk(self.circuit)

    @property
    def period(self) -> float:
        """The time [s] of one cycle."""
        return float(self.path.time[-1])

    def whole_turns(self, _column: int, /) -> float:
        """The whole turns [rad] by which a column is drawn elsewhere than the walk has it."""
        return 0.0

    def row_at(self, time: float) -> float:
        """The row of the path at a time [s], which runs on over the cycle of a closed circuit."""
        times = self.path.time
        time = time % self.period if self.circuit.closed else min(max(time, 0.0), self.period)
        low = min(int(np.searchsorted(times, time, side="right")) - 1, len(times) - 2)
        share = (time - times[low]) / (times[low + 1] - times[low])
        inputs = self.path.input
        return self.pass_of(low).row_of(float(inputs[low] + share * (inputs[low + 1] - inputs[low])))

    def time_at(self, row: float) -> float:
        """The time [s] of a row of the path."""
        times, inputs = self.path.time, self.path.input
        low = int(row)
        if row == low:
            return float(times[low])
        share = (self.input_at(row) - inputs[low]) / (inputs[low + 1] - inputs[low])
        return float(times[low] + share * (times[low + 1] - times[low]))

    def input_at(self, row: float) -> float:
        """The input [rad, or length] at a row: between two rows not on the straight line, as joints are."""
        low = int(row)
        return float(self.path.input[low]) if row == low else self.pass_of(low).input_at(row)

    def rows_at(self, value: float) -> list[float]:
        """The rows, rising, at which the circuit meets a value of the input; an angle is met in every turn.

        Two passes that meet it are two rows; at the dead centre between them there is one.
        """
        turns = self.linkage.turns(self.circuit.input_column)
        slack = SAME_INPUT * (1.0 if turns else self.circuit.size)
        last = len(self.path.rows) - 1
        result: set[float] = set()
        for part in self.passes:
            low, high = sorted((float(part.input[0]), float(part.input[-1])))
            values = [value]
            if turns:
                first, past = (math.floor((end - value) / math.tau) for end in (low - slack, high + slack))
                values = [value + k * math.tau for k in range(first + 1, past + 1)]
            for met in values:
                if low - slack <= met <= high + slack:
                    row = part.row_of(min(max(met, low), high))
                    near = float(round(row))
                    row = near if abs(row - near) < SAME_ROW else row
                    result.add(0.0 if row == last and self.circuit.closed else row)
        return sorted(result)

    @cached_property
    def passes(self) -> tuple[Stretch, ...]:
        """The stretches between input dead centres, each with both of its ends."""
        status, past = self.circuit.status[self.path.rows], len(self.path.rows)
        stretches = [
            (part.start, min(part.stop + (not self.circuit.closed), past)) for part in self.path.passes
        ]
        return tuple(
            Stretch(
                start,
                self.path.input[start:stop],
                bool(status[start] == "dead-centre"),
                bool(status[stop - 1] == "dead-centre"),
            )
            for start, stop in stretches
            if stop - start > 1
        )

    def pass_of(self, row: float) -> Stretch:
        """The pass that holds a row of the path, and goes on from it."""
        return next((part for part in self.passes if part.start <= row < part.last), self.passes[-1])
