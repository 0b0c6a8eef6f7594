"""Passes of a circuit, which the input goes through without a dead centre, and where inputs lie on them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.kinematics.circuits.circuit import Circuit

#: Starts of an input law that are tried in a turn, or over the range of a pass.
PHASES = 36


@dataclass(frozen=True, eq=False)
class InputPass:
    """Rows (m,) of a circuit along one pass; `closed`: round and round; `turns`: its input is an angle."""

    circuit: Circuit
    rows: Integers
    closed: bool
    turns: bool

    @property
    def inputs(self) -> Floats:
        """The input along the rows."""
        return self.circuit.input[self.rows]

    @property
    def outputs(self) -> Floats:
        """The output along the rows."""
        return self.circuit.output[self.rows]

    @property
    def period(self) -> float:
        """What the input gains in one round, 0 where it does not go round."""
        return math.tau * self.circuit.turns if self.closed else 0.0

    def point(self, link: int | str, at: tuple[float, float, float] | None = None) -> Floats:
        """Where a place of a link, or a named point, is along the rows (m, 3)."""
        one = self.circuit
        result = one.point(link) if isinstance(link, str) or at is None else one.written_point(link, at)
        return result.position[self.rows]

    def begins(self, timing: Floats, *, free: bool) -> tuple[Floats, Integers]:
        """What may be added to inputs (n,) so that they lie within the pass (p,), and their rows (p, n).

        Any is tried where it is `free`, else whole turns.
        """
        own = self.inputs
        phases = np.fromiter(self._phases(timing, free=free), dtype=np.float64)
        inputs = timing + phases[:, None]
        if not self.closed:
            within = ((inputs >= own.min()) & (inputs <= own.max())).all(axis=1)
            phases, inputs = phases[within], inputs[within]
        gap = inputs[:, :, None] - own
        if self.closed:
            gap = (gap + self.period / 2) % self.period - self.period / 2
        return phases, np.abs(gap).argmin(axis=2)

    def unwound(self, rows: Integers) -> Floats:
        """The inputs (n,) at rows in the order they are passed, a round's gain added where it begins anew."""
        inputs = self.inputs[rows].copy()
        if self.closed:
            steps = np.diff(rows)
            way = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
            inputs[1:] += way * self.period * np.cumsum(way * steps < 0)
        return inputs

    def _phases(self, timing: Floats, *, free: bool) -> Iterator[float]:
        own = self.inputs
        if free:
            if self.closed:
                yield from (own[0] - timing[0] + self.period * k / PHASES for k in range(PHASES))
                return
            room = float(np.ptp(own) - np.ptp(timing))
            if room >= 0:
                yield from own.min() - timing.min() + np.linspace(0.0, room, PHASES)
        elif not self.turns:
            yield 0.0
        elif self.closed:
            yield from (math.tau * k for k in range(max(self.circuit.turns, 1)))
        else:
            nearest = round(float(own.mean() - timing.mean()) / math.tau)
            yield from (math.tau * k for k in (nearest - 1, nearest, nearest + 1))


def passes(circuit: Circuit) -> Iterator[InputPass]:
    """The passes of a circuit; rows without a pose are left out."""
    turns = bool(circuit.input_turns)
    good = np.isfinite(circuit.q).all(axis=1)
    if circuit.goes_round and good.all():
        yield InputPass(circuit, np.arange(len(circuit.q)), True, turns)
        return
    for branch in np.unique(circuit.branch):
        rows = np.flatnonzero((circuit.branch == branch) & good)
        if len(rows) > 1:
            yield InputPass(circuit, rows, False, turns)
