"""Torque and shaking of a smooth cycle as Fourier series: all that measures need, without the joints.

Torque is linear in what acts, so with the factor f_i(x) of load i

    M(x) = M_0(x) + sum f_i(x) M_i(x)

where M_0 is the torque without the loads and M_i what a whole load i adds. Loads set in and end, but M_0 and
every M_i are smooth round a cycle. A few rows give their series, and no pose is solved for anew between them.

Source: docs/theory_forces.md, (1) to (4), (10).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Curve
from sevenbar.curves.cycle_series import CycleSeries
from sevenbar.curves.pieces import pieces
from sevenbar.forces.closing import closing
from sevenbar.forces.result import LITTLE
from sevenbar.forces.sizing import WITHHELD, CycleLoads, Wrenches
from sevenbar.forces.waves import ForceWaves
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.driven import driven
from sevenbar.kinematics.dynamics.forces import ForceSolver, acting_forces, nothing_pulls, winds_up
from sevenbar.text.units import LENGTHS

#: Every other row is tried first where so many are left: most linkages need no more.
HALF = 150

#: Rows of a sharper circuit are solved for anew, this part more than its waves need, so many times at
#: most; where they need more than so many rows, pieces are quicker.
MORE, TIMES, MOST = 0.25, 2, 1500

#: Fewer rows have no series to speak of.
FEWEST = 3

#: A series with a greater tail may be off in the tenth digit.
RESOLVED = 1e-11

#: Power that closes to this part of its peak on a few rows does so on all, as far as measures need.
CLOSED = WITHHELD / 10


@dataclass(frozen=True)
class _Torque:
    """Rows (n,) of a cycle by their torque [N m | N] and power [W]; without the joints."""

    input: Floats
    time: Floats
    torque: Floats
    power: Floats
    reactions: Mapping[str, Wrenches] = field(default_factory=dict)


def force_waves(solver: ForceSolver, circuit: Circuit) -> ForceWaves | None:
    """The series of a circuit that goes round at constant speed without stops and change points.

    One that turns back at dead centres has no bound there, and so no measures. `None` where the rows do not
    show all of them to `RESOLVED`, or power does not close along the cycle to `CLOSED`: then all that
    `Circuit.forces` computes is needed.
    """
    loading = solver.loading
    if loading.is_empty or solver.linkage.stops.stops:
        return None
    if not circuit.goes_round:
        return ForceWaves()
    if np.isnan(circuit.speed) or circuit.motion_type == "change-point" or winds_up(circuit, loading):
        return None
    count = len(circuit.input)
    rows = float(count)
    for stride in (2, 1) if count % 2 == 0 and count >= 2 * HALF else (1,):
        result = _Waves(solver, circuit, circuit.speed, stride).found()
        if not isinstance(result, float):
            return result
        rows = result
    first, step = float(circuit.input[0]), float(circuit.input[1] - circuit.input[0])
    for _ in range(TIMES if circuit.turns == 1 else 0):
        if (1 + MORE) * rows > MOST:
            break
        finer = math.ceil((1 + MORE) * rows)
        inputs: Floats = first + step * count / finer * np.arange(finer, dtype=np.float64)
        anew = driven(solver.linkage, circuit, inputs, speed=circuit.speed)
        result = _Waves(solver, anew, circuit.speed).found()
        if not isinstance(result, float):
            return result
        rows = result
    return None


@dataclass(frozen=True, eq=False)
class _Waves:
    """The series through every so many rows of a circuit."""

    solver: ForceSolver
    circuit: Circuit
    #: Of the input [rad/s]; rows that were solved for at inputs have none of their own.
    speed: float
    stride: int = 1

    def found(self) -> ForceWaves | float | None:
        """What measures need, or how many rows show it; `None` where series are not enough."""
        solver, circuit = self.solver, self.circuit
        inputs = circuit.input[:: self.stride]
        if len(inputs) < FEWEST or not (circuit.status == "ok").all():
            return None
        period = float(circuit.input[1] - circuit.input[0]) * len(circuit.input)
        slides = not solver.linkage.turns(circuit.input_column)
        size = solver.size
        metre = LENGTHS[solver.linkage.length_unit] if slides else 1.0
        # first without loads, then each by itself
        torque, energies, supplied, shaking = self._solved(inputs)
        pull, _ = acting_forces(solver, energies, shaking[:, 3:])
        if nothing_pulls(solver, self._speeds(len(inputs)), energies[:, 0], shaking[:, 3:]):
            return None
        torque = torque * (size if slides else size**2)
        pull = pull * (1.0 if slides else size)
        whole = self._whole(torque, inputs)
        peak = float(np.abs(whole).max())
        if not peak > LITTLE * pull:
            return None
        parts = (energies, supplied.T, shaking[:, :3], shaking[:, 3:])
        table = np.concatenate([torque.T / peak, *map(_in_parts, parts)], axis=1)
        series = CycleSeries(table, float(inputs[0]), period)
        if not np.isfinite(table).all():
            return None
        if series.tail * series.scale > RESOLVED:
            return series.rows_to(RESOLVED / series.scale)
        rate = self.speed * metre
        power = whole * rate
        given = np.stack([energies.sum(axis=1), power, self._whole(supplied, inputs)])
        if max(closing(given, self.speed, pull=pull, first=float(inputs[0]), period=period)) > CLOSED:
            return None
        rows = _Torque(inputs, circuit.time[:: self.stride], whole, power)
        return ForceWaves(self._loads(rows, torque / peak, peak, period, rate), shaking, period)

    def _loads(self, rows: _Torque, torque: Floats, unit: float, period: float, rate: float) -> CycleLoads:
        first, breaks = float(rows.input[0]), self.solver.loading.breaks(turns=self.circuit.turns)
        own = (rows.torque / unit)[:, None]
        every: Curve = CycleSeries(own, first, period)
        if breaks:
            waves = CycleSeries(torque.T, first, period)
            every = pieces(
                lambda inputs: self._whole(waves.at(inputs).T, inputs)[:, None], own, first, period, breaks
            )
        return CycleLoads(
            rows,
            every,
            np.array([unit]),
            np.ones(1, dtype=bool),
            "pieces" if breaks else "series",
            period,
            rate,
        )

    def _speeds(self, count: int) -> Floats:
        return np.broadcast_to([self.speed, 0.0], (count, 2))

    def _solved(self, inputs: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Torque [by the square of the size] and power of the loads [W], (1 + loads, n); see `_whole`.

        Between them energies (n, 2) [J], last shaking (n, 6) [N m, and N].
        """
        solver, count = self.solver, len(inputs)
        # without loads, and with each by itself
        cases = 1 + len(solver.loading.loads)
        poses = solver.numbers.poses(self.circuit.q[:: self.stride])
        factors = np.repeat(np.eye(cases)[:, 1:], count, axis=0)
        result = solver.solved(
            np.tile(inputs, cases), np.tile(poses, (cases, 1)), self._speeds(cases * count), factors=factors
        )
        torque = result.torque.reshape(cases, count)
        energies = result.energies.reshape(cases, count, 3) * solver.size**2
        supplied = energies[:, :, 2]
        torque[1:] -= torque[0]
        supplied[1:] -= supplied[0]
        shaking = result.shaking[:count] * np.repeat([solver.size**2, solver.size], 3)
        return torque, energies[0, :, :2], supplied, shaking

    def _whole(self, parts: Floats, inputs: Floats) -> Floats:
        """The first of parts (1 + loads, n), and the others as much as the loads act at the inputs (n,)."""
        turns = self.solver.linkage.turns(self.circuit.input_column)
        whole: Floats = parts[0].copy()
        for part, load in zip(parts[1:], self.solver.loading.loads, strict=True):
            whole += load.factors(inputs, turns=turns) * part
        return whole


def _in_parts(rows: Floats) -> Floats:
    """Rows (n, k) of one kind as parts of the greatest."""
    most = float(np.abs(rows).max(initial=0.0))
    return np.asarray(rows / most if most else rows)
