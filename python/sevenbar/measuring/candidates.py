"""Every pass of every circuit against measured rows: residuals, and the zeros that fit each best.

At each row the linkage is solved at the row's input. With a phase the curve is first moved along the input by
a search over a turn, then by Gauss and Newton's steps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.law import Law
from sevenbar.measuring.measured import OUTPUTS, Ends, Measured
from sevenbar.measuring.passes import Key, PassFit, stretches_of, ways_through

#: Inputs of the first search for a phase over a turn, and the number of shifts tried.
GRID, SHIFTS = 1440, 360

#: Points of the computed curve that figures show, for each pass.
CURVE = 721

#: Candidates whose residual in the first search is within this factor of the least are aligned exactly.
NEAR = 4.0

#: Residuals below this are rounding.
SAME_RESIDUAL = 1e-12

#: Output and three derivatives by the input (n,) of each pass, by circuit and branch.
Passes = dict[tuple[int, int], list[Floats]]


class Candidates:
    """One measurement against one linkage."""

    def __init__(
        self, linkage: Linkage, ends: Ends, measured: Measured, inputs: Floats, speed: float
    ) -> None:
        self.linkage, self.ends, self.speed, self.inputs = linkage, ends, speed, inputs
        self.values = {quantity: measured.values[quantity] for quantity in measured.outputs}
        if not ends.output_slides and "angle" in self.values:
            # a jump of half a turn between two rows is one from 180 to -180 degrees
            self.values["angle"] = np.unwrap(self.values["angle"])
        self.scales = {quantity: ends.extent(quantity, v) for quantity, v in self.values.items()}
        self.source = measured.source
        self.stretches = stretches_of(inputs, slides=ends.input_slides)
        #: Which way the input goes at each row (n,), 1 or -1.
        self.ways = np.where(np.array(self.stretches.rising)[self.stretches.of_row], 1.0, -1.0)
        # the same inputs are needed again and again: for each pass, and once more for the chosen one
        self._last: tuple[bytes, Passes] = (b"", {})
        self.circuits: dict[int, Circuit] = {}

    def passes(self, inputs: Floats) -> Passes:
        """Output and three derivatives by the input (n,), at inputs, of each pass by circuit and branch."""
        if self._last[0] == inputs.tobytes():
            return self._last[1]
        law = Law.of(np.arange(float(inputs.size)), inputs, 1.0, 0.0)
        motion = self.linkage.motion(input=self.ends.input, output=self.ends.output, law=law)
        if not motion.circuits:
            raise RequestError(
                f"linkage: {motion.motion_type}, so there is no motion to compare {self.source} with"
            )
        self.circuits = {circuit.index: circuit for circuit in motion.circuits}
        self.turns = {circuit.index: max(circuit.turns, 1) for circuit in motion.circuits}
        result: Passes = {}
        for circuit in motion.circuits:
            for branch in range(len(circuit.time) // inputs.size):
                part = slice(branch * inputs.size, (branch + 1) * inputs.size)
                result[circuit.index, branch] = [
                    np.where(
                        circuit.status[part] == "no-solution", np.nan, rates[part, circuit.output_column]
                    )
                    for rates in (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)
                ]
        self._last = (inputs.tobytes(), result)
        return result

    def stretch_of_rows(self, key: Key) -> Integers:
        """The stretch of each row (n,); one where all rows are of one pass."""
        return self.stretches.of_row if len(key.branches) > 1 else np.zeros_like(self.stretches.of_row)

    def branch_of_rows(self, key: Key) -> Integers:
        """The pass of each row (n,)."""
        branches = np.array(key.branches, dtype=np.int64)
        return branches[self.stretch_of_rows(key)]

    def speeds(self, *, signed: bool) -> Floats:
        """The speed of the input at each row (n,)."""
        return abs(self.speed) * self.ways if signed else np.full(len(self.inputs), self.speed)

    def differences(self, rates: Sequence[Floats], offset: float, *, signed: bool) -> dict[str, Floats]:
        """Measured minus computed of each quantity, an angle within half a turn."""
        result, speeds = {}, self.speeds(signed=signed)
        for quantity, values in self.values.items():
            order = OUTPUTS.index(quantity)
            apart = values - rates[order] * speeds**order
            if quantity == "angle":
                apart = apart - offset
                if not self.ends.output_slides:
                    apart = apart - math.tau * np.round(apart / math.tau)
            result[quantity] = apart
        return result

    def _residual(self, rates: Sequence[Floats], offset: float, *, signed: bool) -> tuple[float, int, float]:
        """Root mean square of the differences relative to the ranges, open rows, and that of the others.

        In the first a row that does not close counts as a difference of a whole range.
        """
        apart = self.differences(rates, offset, signed=signed)
        parts = np.array([d / self.scales[q] for q, d in apart.items()])
        open_rows = int(np.isnan(parts).any(axis=0).sum())
        closed = float(np.mean(parts[np.isfinite(parts)] ** 2)) if open_rows < parts.shape[1] else 1.0
        every = float(np.mean(np.where(np.isnan(parts), 1.0, parts) ** 2))
        return math.sqrt(every), open_rows, math.sqrt(closed)

    def _offset(self, rates: Sequence[Floats]) -> float:
        """The offset of the output that fits best: the mean difference, of angles round the circle."""
        apart = self.differences(rates, 0.0, signed=False)["angle"]
        known = apart[np.isfinite(apart)]
        if known.size == 0:
            return 0.0
        if self.ends.output_slides:
            return float(known.mean())
        centre = math.atan2(float(np.sin(known).mean()), float(np.cos(known).mean()))
        return centre + float((known - centre - math.tau * np.round((known - centre) / math.tau)).mean())

    def best(self, phase: bool, offset: bool, circuit: int | None, branch: int | None) -> list[PassFit]:
        """Every pass, and every way from pass to pass, with its residual, the best first."""
        here = self.passes(self.inputs)
        for name, word, value, known in (
            ("circuit", "circuit", circuit, sorted({key[0] for key in here})),
            ("branch", "pass", branch, sorted({key[1] for key in here})),
        ):
            if value is not None and value not in known:
                allowed = "0" if known == [0] else f"{known[0]} to {known[-1]}"
                raise RequestError(f"{name}: {value} is not a {word} of this motion; give {allowed}")
        counts = {number: sum(key[0] == number for key in here) for number in self.circuits}
        wanted = [
            Key(number, way, turn)
            for number, count in counts.items()
            if circuit in (None, number)
            for way in ways_through(self.stretches, count)
            if branch is None or way == (branch,)
            for turn in range(self.turns[number])
        ]
        if not wanted:
            raise RequestError(f"branch: circuit {circuit} has no branch {branch}; leave --branch out")
        starts = self._first_phase(wanted, offset) if phase else dict.fromkeys(wanted, 0.0)
        tried = [self._judged(key, starts[key], offset) for key in wanted]
        least = min(candidate.residual for candidate in tried)
        if phase:
            tried = [self._refined(c, offset) if c.residual <= max(NEAR * least, 1e-3) else c for c in tried]
        # residuals that differ by rounding are the same; what closes nowhere explains nothing
        tried.sort(key=lambda c: (c.open_share == 1.0, float(f"{max(c.residual, SAME_RESIDUAL):.6g}"), c.key))
        if tried[0].open_rows == len(self.inputs):
            raise RequestError(
                f"{self.source}: at none of its inputs does the linkage close; check the units of the input "
                "and its zero, or let it be aligned with --align phase"
            )
        return tried

    def _gathered(self, table: Passes, key: Key) -> list[Floats]:
        """Output and derivatives (n,) at the rows, each on its own pass."""
        if len(key.branches) == 1:
            return table[key.circuit, key.branches[0]]
        own = self.branch_of_rows(key)
        every = [table[key.circuit, branch] for branch in range(1 + max(key.branches))]
        return [np.choose(own, [rates[order] for rates in every]) for order in range(4)]

    def at(self, key: Key, phase: float) -> list[Floats]:
        """Output and three derivatives by the input (n,) at the rows."""
        return self._gathered(self.passes(self.inputs + phase + math.tau * key.turn), key)

    def _judged(self, key: Key, phase: float, offset: bool) -> PassFit:
        rates = self.at(key, phase)
        moved = self._offset(rates) if offset else 0.0
        ways = (False, True) if len(self.stretches) > 1 and "velocity" in self.values else (False,)
        tries = [(*self._residual(rates, moved, signed=signed), signed) for signed in ways]
        residual, open_rows, closed, signed = min(tries)
        return PassFit(
            circuit=key.circuit,
            branch=key.branches[0],
            turn=key.turn,
            residual=residual,
            open_rows=open_rows,
            open_share=open_rows / len(self.inputs),
            phase=phase,
            offset=moved,
            branches=key.branches if len(key.branches) > 1 else (),
            signed=signed,
            closed_residual=closed,
        )

    def _first_phase(self, wanted: Sequence[Key], offset: bool) -> dict[Key, float]:
        """A phase for each candidate from curves read off a grid of the input, shifted step by step."""
        turns = max(self.turns.values())
        if self.ends.input_slides:
            motion = self.linkage.motion(72, input=self.ends.input, output=self.ends.output)
            spans = [c.input_range for c in motion if c.input_range is not None]
            low, high = min(s[0] for s in spans), max(s[1] for s in spans)
            grid = np.linspace(low, high, GRID + 1)
            middle = (self.inputs.min() + self.inputs.max()) / 2
            shifts = np.linspace(low - middle, high - middle, SHIFTS + 1)
        else:
            grid = np.linspace(0.0, math.tau * turns, GRID * turns + 1)
            shifts = math.tau * np.arange(SHIFTS) / SHIFTS
            shifts -= math.tau * np.round(shifts / math.tau)
        curves = self.passes(grid)
        if not self.ends.output_slides:
            curves = {k: [unwrapped(rates[0]), *rates[1:]] for k, rates in curves.items()}
        result: dict[Key, tuple[float, float]] = {}
        for shift in sorted(shifts.tolist(), key=abs):
            read: dict[int, Passes] = {}
            for key in wanted:
                if key.turn not in read:
                    at = self.inputs + shift + math.tau * key.turn
                    if not self.ends.input_slides:
                        at = at % (math.tau * turns)
                    read[key.turn] = {
                        k: [np.interp(at, grid, r) for r in rates] for k, rates in curves.items()
                    }
                here = self._gathered(read[key.turn], key)
                moved = self._offset(here) if offset else 0.0
                residual = self._residual(here, moved, signed=False)[0]
                if residual < result.get(key, (math.inf, 0.0))[0]:
                    result[key] = residual, shift
        return {key: result.get(key, (0.0, 0.0))[1] for key in wanted}

    def _refined(self, candidate: PassFit, offset: bool) -> PassFit:
        """The phase and offset of least squares near those given, by Gauss and Newton's steps."""
        best = candidate
        for _ in range(30):
            rates = self.at(candidate.key, best.phase)
            gradients, errors = [], []
            speeds = self.speeds(signed=best.signed)
            for quantity, apart in self.differences(rates, best.offset, signed=best.signed).items():
                order, scale = OUTPUTS.index(quantity), self.scales[quantity]
                slope = rates[order + 1] * speeds**order
                known = np.isfinite(apart) & np.isfinite(slope)
                aside = float(quantity == "angle")
                gradients.append(np.column_stack([slope, np.full(slope.size, aside)])[known] / scale)
                errors.append(apart[known] / scale)
            gradient, error = np.concatenate(gradients), np.concatenate(errors)
            if error.size <= gradient.shape[1]:
                return best
            step = np.linalg.lstsq(gradient if offset else gradient[:, :1], error, rcond=None)[0]
            for share in (1.0, 0.5, 0.25, 0.1, 0.01):
                tried = self._judged(candidate.key, best.phase + share * float(step[0]), offset)
                if tried.residual < best.residual:
                    break
            else:
                return best
            gain, best = best.residual - tried.residual, tried
            if gain <= 1e-12 * best.residual:
                return best
        return best

    def side_by_side(self, chosen: PassFit) -> tuple[dict[str, Floats], dict[str, Floats]]:
        """Computed and measured values of each quantity on the chosen pass."""
        rates = self.at(chosen.key, chosen.phase)
        apart = self.differences(rates, chosen.offset, signed=chosen.signed)
        measured = dict(self.values)
        if "angle" in measured:
            measured["angle"] = measured["angle"] - chosen.offset
            if not self.ends.output_slides:
                # one whole number of turns for all rows, so that the curve stays in one piece
                raw = measured["angle"] - rates[0] - apart["angle"]
                known = raw[np.isfinite(raw)]
                turns = round(float(np.median(known)) / math.tau) if known.size else 0
                measured["angle"] = measured["angle"] - math.tau * turns
        return {quantity: measured[quantity] - apart[quantity] for quantity in measured}, measured

    def curve(self, chosen: PassFit, computed: Mapping[str, Floats]) -> dict[str, Floats]:
        """The "input" (m,) of the linkage and each quantity on each stretch of the rows, NaN between them."""
        low, high = float(self.inputs.min()), float(self.inputs.max())
        grid = np.linspace(low, high, CURVE)
        table = self.passes(grid + chosen.phase + math.tau * chosen.turn)
        gap = np.array([np.nan])
        own = self.stretch_of_rows(chosen.key)
        parts: dict[str, list[Floats]] = {"input": [], **{q: [] for q in self.values}}
        for stretch, branch in enumerate(chosen.key.branches):
            rows = np.flatnonzero((own == stretch) & np.isfinite(next(iter(computed.values()))))
            way = float(self.ways[rows[0]]) if rows.size else 1.0
            speed = abs(self.speed) * way if chosen.signed else self.speed
            rates = table[chosen.circuit, branch]
            result = {q: rates[OUTPUTS.index(q)] * speed ** OUTPUTS.index(q) for q in self.values}
            if "angle" in result and not self.ends.output_slides:
                angle = unwrapped(result["angle"])
                known = np.flatnonzero(np.isfinite(angle))
                if known.size and rows.size:
                    nearest = known[np.argmin(np.abs(grid[known] - self.inputs[rows[0]]))]
                    turns = round((float(computed["angle"][rows[0]]) - angle[nearest]) / math.tau)
                    angle = angle + math.tau * turns
                result["angle"] = angle
            for quantity, values in {"input": grid + chosen.phase, **result}.items():
                parts[quantity] += [values, gap]
        return {quantity: np.concatenate(values)[:-1] for quantity, values in parts.items()}

    def circuit_of(self, chosen: PassFit) -> Circuit:
        """The chosen circuit at the inputs of the rows, once for each of its passes."""
        self.at(chosen.key, chosen.phase)
        return self.circuits[chosen.circuit]


def unwrapped(angles: Floats) -> Floats:
    """A curve without jumps of whole turns, its gaps kept."""
    known = np.isfinite(angles)
    result = angles.copy()
    result[known] = np.unwrap(angles[known])
    return result
