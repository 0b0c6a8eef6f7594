"""Forces on the parts of a circuit between stops: rows from stop to stop, and between them.

At constant speed, or at rest, one way along the circuit: on the way back torque and forces are the same but
for dampers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.forces.result import Forces, StopPart
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.dynamics.forces import ForceSolver, PosedRows, forces_on
from sevenbar.kinematics.paths.circuit_path import CircuitPath
from sevenbar.kinematics.paths.covered_path import closed_on, covered_path
from sevenbar.kinematics.paths.stretch import StopStretch, laps_by_range, used_stretch

#: At an end where the input moves by less than this [rad, or shares of the size] it is at a dead centre.
AT_DEAD_CENTRE = 1e-7

#: A place nearer to an end than this part of the circuit is the end.
SAME = 1e-9

#: Places to a piece from which an input's place is begun, and Newton's steps to it.
FINE = 16
STEPS = 8

#: A row is on a stretch if its pose misses that of the path by less [rad, or shares of the size].
ON_PATH = 1e-6


def parts_of(
    solver: ForceSolver, circuit: Circuit, stretches: tuple[StopStretch, ...], whole: Forces, *, at_rest: bool
) -> tuple[tuple[Forces, ...], int]:
    """The forces on each stretch, in order, and the number of that on which the linkage is used."""
    path = covered_path(solver.linkage, circuit, solver.numbers)
    used = used_stretch(solver.linkage, circuit, path, solver.numbers, stretches)
    alone = len(stretches) == 1
    result = [_Part(solver, circuit, path, one, alone, at_rest).forces(whole) for one in stretches]
    return tuple(result), 0 if used is None else used[0]


@dataclass(frozen=True, eq=False)
class _Part:
    """One stretch of a circuit."""

    solver: ForceSolver
    circuit: Circuit
    path: CircuitPath
    stretch: StopStretch
    #: Whether it is the only one.
    alone: bool
    at_rest: bool

    def forces(self, whole: Forces) -> Forces:
        """The forces on it: at both ends, and on the circuit's rows between them."""
        start, end = float(self._input[0]), float(self._input[-1])
        part = StopPart(start, end, self.stretch.first_stop, self.stretch.last_stop)
        if self._turns_back:
            # without bound there, and the rows say so
            return replace(whole.on(self._rows), part=part, between=None, _parts=None)
        if self._passes_change_point:
            own = whole.on(self._rows)
            return replace(own, part=part, between=None, _parts=None, through_change_points=True)
        low, high = sorted((start, end))
        inside = np.unique(self._unwrapped(self.circuit.input[self._rows]))
        near = SAME * (high - low)
        inside = inside[(inside > low + near) & (inside < high - near)]
        inputs = np.concatenate([[start], inside if end > start else inside[::-1], [end]])
        branch = self._branch
        return replace(self._at(inputs, branch), part=part, between=lambda x: self._at(x, branch))

    @cached_property
    def _places(self) -> Floats:
        """Places along the stretch, both ends and all edges among them, in order."""
        length = self.path.length
        low, high = self.stretch.begin, self.stretch.end
        laps = np.arange(2)[:, None] * length if self.path.closed else np.zeros((1, 1))
        marks = np.unique((self.path.input_marks + laps).ravel())
        marks = marks[(marks > low + SAME * length) & (marks < high - SAME * length)]
        ends = np.concatenate([[low], marks, [high]])
        shares = np.arange(FINE) / FINE
        return np.append((ends[:-1, None] + np.diff(ends)[:, None] * shares).ravel(), high)

    def _lapped(self, places: Floats) -> tuple[Floats, Floats]:
        """Places on the first lap, and what the input has gained before."""
        if not self.path.closed:
            return places, np.zeros_like(places)
        laps = np.where(places > self.path.length, 1.0, 0.0)
        return places - laps * self.path.length, laps * self.path.gain[self.path.input]

    def _inputs_at(self, places: Floats) -> tuple[Floats, Floats]:
        """The input at places, and its slope there."""
        own, gain = self._lapped(places)
        column = self.path.input
        return (
            self.path.poses.part(column).at(own)[:, 0] + gain,
            self.path.poses.slope.part(column).at(own)[:, 0],
        )

    @cached_property
    def _input(self) -> Floats:
        """The input at these places, on the lap of its range, else of the circuit's rows."""
        values = self._inputs_at(self._places)[0]
        if not self.solver.linkage.turns(self.path.input):
            return values
        known = self.circuit.input[np.isfinite(self.circuit.input)]
        middle = (values[0] + values[-1]) / 2
        values = values - math.tau * math.floor((middle - known.min()) / math.tau + SAME)
        start, end = float(values[0]), float(values[-1])
        turns = laps_by_range(self.solver.linkage, self.path.input, self.stretch, start, end)
        return np.asarray(values + math.tau * turns)

    @cached_property
    def _turns_back(self) -> bool:
        """Whether the input stands still on it, at a dead centre."""
        slopes = self._inputs_at(self._places)[1]
        still = AT_DEAD_CENTRE * float(self.solver.numbers.scales[self.path.input])
        return bool(np.any(np.abs(slopes) < still) or slopes.min() * slopes.max() < 0)

    @property
    def _passes_change_point(self) -> bool:
        if self.circuit.motion_type != "change-point":
            return False
        laps = (0.0, self.path.length) if self.path.closed else (0.0,)
        places = np.concatenate([self.path.centres + lap for lap in laps])
        near = SAME * self.path.length
        return bool(np.any((places > self.stretch.begin - near) & (places < self.stretch.end + near)))

    def _unwrapped(self, inputs: Floats) -> Floats:
        """Inputs on the lap of the stretch."""
        if not self.solver.linkage.turns(self.path.input):
            return inputs
        low = float(self._input.min()) - SAME
        return np.asarray(low + (inputs - low) % math.tau)

    def _place(self, inputs: Floats) -> Floats:
        """The places (n,) of inputs that the stretch has."""
        way = 1.0 if self._input[-1] > self._input[0] else -1.0
        shift = self._input[0] - self._inputs_at(self._places[:1])[0][0]
        places = np.interp(way * inputs, way * self._input, self._places)
        for _ in range(STEPS):
            values, slopes = self._inputs_at(places)
            step = (values + shift - inputs) / slopes
            places = np.clip(places - step, self.stretch.begin, self.stretch.end)
        return places

    def _poses(self, inputs: Floats) -> Floats:
        """The poses (n, columns) of the word at inputs."""
        places, gain = self._lapped(self._place(inputs))
        edges = self.path.poses.edges
        pieces = np.clip(np.searchsorted(edges, places, "right") - 1, 0, len(edges) - 2)
        near = closed_on(self.path, self.solver.numbers, pieces, places)
        if self.path.closed:
            near = near + (gain != 0)[:, None] * self.path.gain
        result = self.solver.loop.closed(inputs, near)
        lost = ~np.isfinite(result).all(axis=1)
        result[lost] = near[lost]
        return np.asarray(result)

    def _at(self, inputs: Floats, branch: int) -> Forces:
        """The forces at inputs (n,) on it."""
        count = len(inputs)
        way = 1.0 if self._input[-1] > self._input[0] else -1.0
        speed = way * abs(self.circuit.speed)
        rows = PosedRows(
            input=inputs,
            time=(inputs - self._input[0]) / speed,
            status=np.full(count, "ok", dtype="<U15"),
            branch=np.full(count, branch),
            poses=self._poses(inputs),
            rates=np.column_stack([np.full(count, speed), np.zeros(count)]),
        )
        return forces_on(self.solver, self.circuit, rows, at_rest=self.at_rest)

    @cached_property
    def _rows(self) -> Integers:
        """The circuit's rows between its ends."""
        circuit, numbers = self.circuit, self.solver.numbers
        within = np.flatnonzero(circuit.allowed.within)
        if self.alone or not within.size:
            return within
        smooth = ~numbers.is_ball
        own = numbers.poses(circuit.q[within])[:, smooth]
        inputs = self._unwrapped(circuit.input[within])
        low, high = sorted((self._input[0], self._input[-1]))
        if self._turns_back:
            # dead centres with it
            low, high = float(self._input.min()) - SAME, float(self._input.max()) + SAME
            nearest = np.array([np.abs(self._off(self._on_path, pose)).argmin() for pose in own])
            off = self._off(self._on_path[nearest], own)
            near = off < 2 * float(np.diff(self._places).max())
        else:
            near = self._off(self._poses(np.clip(inputs, low, high))[:, smooth], own) < ON_PATH
        return np.asarray(within[near & (inputs > low) & (inputs < high)])

    @cached_property
    def _on_path(self) -> Floats:
        """The poses of the path at its places, without balls."""
        poses = self.path.poses.at(self._lapped(self._places)[0])
        return np.asarray(poses[:, ~self.solver.numbers.is_ball])

    def _off(self, poses: Floats, others: Floats) -> Floats:
        """How far poses without balls are from others (n,), angles by whole turns."""
        smooth = ~self.solver.numbers.is_ball
        off = poses - others
        turning = self.solver.numbers.turns[smooth]
        off[:, turning] -= math.tau * np.round(off[:, turning] / math.tau)
        return np.asarray(np.linalg.norm(off / self.solver.numbers.scales[smooth], axis=1))

    @property
    def _branch(self) -> int:
        """The pass on which it is: that of the row nearest to its middle."""
        smooth = ~self.solver.numbers.is_ball
        known = np.flatnonzero(np.isfinite(self.circuit.q).all(axis=1))
        rows = self._rows if self._rows.size else known
        middle = self._on_path[len(self._places) // 2]
        off = self._off(self.solver.numbers.poses(self.circuit.q[rows])[:, smooth], middle)
        return int(self.circuit.branch[rows[int(off.argmin())]])
