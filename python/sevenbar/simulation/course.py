"""The rows of a circuit that an engine is to follow: a whole cycle, or one pass between dead centres."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Booleans, Floats, Integers
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit

#: An engine starts so many rows ahead of the first that is compared. Its accelerations start with an error
#: that is damped by some 0.6 (Exudyn) to 0.75 (MuJoCo) a step, so that rounding remains.
LEAD = 100

#: Off the dead centres of the input stay this part of a pass at both ends: there rates grow without bound.
MARGIN = 0.05

#: Fewest rows that are a motion to compare.
LEAST_ROWS = 20

#: Steps of the input differ by no more than this part of one.
EVEN = 1e-6


@dataclass(frozen=True, eq=False)
class Course:
    """Rows of a circuit, evenly spaced in time, along which its input moves at the drive's speed.

    `lead` rows come first and are not compared, then `rows` (n,); `step` [s]. A course that `closes` ends
    with the row it began with, a cycle on.
    """

    motion: Motion
    circuit: Circuit
    lead: Integers
    rows: Integers
    step: float
    closes: bool

    @property
    def start(self) -> int:
        """The row with which the engine starts."""
        return int(self.lead[0]) if len(self.lead) else int(self.rows[0])

    @property
    def steps(self) -> int:
        """The engine's steps, those of the lead too."""
        return len(self.lead) + len(self.rows) - 1

    @property
    def time(self) -> Floats:
        """The time [s] of the rows, from the first on."""
        return np.arange(len(self.rows), dtype=np.float64) * self.step

    @property
    def q(self) -> Floats:
        """Sevenbar's joint values (n, columns), running on over the closure."""
        values = self.circuit.q[self.rows].copy()
        if self.closes:
            ahead = 2 * values[-2] - values[-3]
            turns = self.motion.linkage.turning
            whole = np.round((ahead - values[-1]) / math.tau) * math.tau
            values[-1] += np.where(turns & np.isfinite(whole), whole, 0.0)
        return values

    def text(self) -> str:
        """What is followed, in words."""
        if self.closes:
            turns = self.circuit.turns
            way = "one turn" if turns == 1 else f"{turns} turns"
            return f"circuit {self.circuit.index}, {way} of the input, until it closes"
        return (
            f"circuit {self.circuit.index}, one pass of the input without {MARGIN:.0%} at each end, "
            "where its dead centres are"
        )


def course(motion: Motion, index: int) -> Course:
    """The course along a circuit of a motion: all of it where its input turns fully, else its longest pass.

    Raises `RequestError` where there is no such circuit, or where it has too few rows.
    """
    if not motion.circuits:
        raise RequestError(
            f"simulate: {motion.linkage.name} does not move ({motion.motion_type}), so no engine can follow "
            "it; give another input, or other dimensions"
        )
    circuit = chosen_circuit(motion, index)
    if motion.law is not None:
        raise RequestError("law: an engine is driven at constant speed; give a motion without a law")
    count = len(circuit.time)
    solved = np.isin(circuit.status, ("ok", "turns-undefined"))
    closes = circuit.goes_round and solved.all() and count >= LEAST_ROWS
    rows = np.arange(count) if closes else _longest_pass(circuit, solved)
    if len(rows) > 1 and motion.speed * (circuit.input[rows[1]] - circuit.input[rows[0]]) < 0:
        rows = rows[::-1]
    if closes:
        step = float(abs(circuit.input[1] - circuit.input[0]) / abs(motion.speed))
        return Course(motion, circuit, rows[-LEAD:], np.append(rows, rows[0]), step, closes=True)
    margin = round(MARGIN * len(rows))
    inner = rows[margin : len(rows) - margin]
    lead = rows[max(0, min(margin, len(rows)) - LEAD) : margin]
    # of the margin only the half away from the dead centre
    lead = lead[len(lead) // 2 :]
    if len(inner) < LEAST_ROWS:
        raise RequestError(
            f"circuit: circuit {circuit.index} has {len(inner)} rows to compare at {motion.samples} steps a "
            f"turn; give more --steps, or another --circuit"
        )
    steps = np.diff(circuit.input[inner])
    if np.ptp(steps) > EVEN * abs(steps[0]):
        raise RequestError(
            f"circuit: the rows of circuit {circuit.index} are not evenly spaced; give another --circuit"
        )
    return Course(motion, circuit, lead, inner, float(abs(steps[0] / motion.speed)), closes=False)


def _longest_pass(circuit: Circuit, solved: Booleans) -> Integers:
    """The rows of the longest pass between input dead centres that have all values."""
    marks = np.flatnonzero(np.diff(circuit.branch) != 0) + 1
    passes = [np.arange(a, b) for a, b in pairwise([0, *marks, len(circuit.branch)])]
    return max((rows[solved[rows]] for rows in passes), key=len, default=np.array([], dtype=np.int64))
