"""Measured values compared with computed ones: the circuit that explains them, alignment, differences.

At each measured row the linkage is solved at the row's input: the measured one, or `speed * time`. Every pass
of every circuit is a candidate; the one with the least residual explains the data, and the others are
kept with their residuals. With `align` the curve is first moved along the input ("phase") and along the
output ("offset") by least squares: two zeros that differ on a test bench.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits import Law
from sevenbar.kinematics.linkage import Linkage
from sevenbar.measuring.extremes import Extent
from sevenbar.measuring.measured import OUTPUTS, Ends, Measured
from sevenbar.text.printing import Printed
from sevenbar.text.units import sliding_speed, turning_speed

#: What may be aligned.
ALIGN = ("phase", "offset")

#: Inputs of the first search for a phase over a turn, and the number of shifts tried.
GRID, SHIFTS = 1440, 360

#: Points of the computed curve that figures show.
CURVE = 721

#: Candidates whose residual in the first search is within this factor of the least are aligned exactly.
NEAR = 4.0

#: A measured input that departs from uniform motion by more than this share of its travel is reported.
UNIFORM = 0.01

#: The second best candidate within this factor of the best: the data hardly distinguish the two.
CLOSE_CALL = 1.2

#: Differences of this share of the measured range are no small ones: something else is wrong.
UNEXPLAINED = 0.1

#: Residuals below this are rounding.
SAME_RESIDUAL = 1e-12


@dataclass(frozen=True)
class PassFit:
    """A pass of a circuit and its residual: the rms of differences relative to each measured range."""

    circuit: int
    branch: int
    #: Whole turns of the input at which the data begin, for a circuit that closes after several.
    turn: int
    residual: float
    #: Rows whose input does not close the loop on this pass.
    open_rows: int
    phase: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class Spread:
    """How measured values differ from computed ones: measured minus computed."""

    greatest: float
    #: Line of the file of the greatest difference.
    line: int
    rms: float
    mean: float


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Printed):
    """Measured and computed values at the same inputs, (n,) each; NaN where the loop does not close.

    `input` [rad, or length] is that of the linkage: the measured one plus `chosen.phase`; `measured` has
    `chosen.offset` subtracted from the angle, and is brought within half a turn of `computed`.
    """

    linkage: Linkage
    ends: Ends
    source: str
    speed: float
    chosen: PassFit
    candidates: tuple[PassFit, ...]
    aligned: tuple[str, ...]
    line: np.ndarray[tuple[int], np.dtype[np.int64]]
    input: Floats
    measured: Mapping[str, Floats]
    computed: Mapping[str, Floats]
    #: The computed curve over the inputs, for figures: input (m,), and each quantity (m,).
    curve_input: Floats
    curve: Mapping[str, Floats]
    notes: tuple[str, ...]

    @property
    def outputs(self) -> tuple[str, ...]:
        """The quantities that were measured."""
        return tuple(self.measured)

    def difference(self, quantity: str) -> Floats:
        """Measured minus computed, (n,)."""
        return self.measured[quantity] - self.computed[quantity]

    def spread(self, quantity: str) -> Spread:
        """The differences of a quantity in four numbers."""
        difference = self.difference(quantity)
        worst = int(np.nanargmax(np.abs(difference)))
        known = difference[np.isfinite(difference)]
        return Spread(
            greatest=float(difference[worst]),
            line=int(self.line[worst]),
            rms=math.sqrt(float(np.mean(known**2))),
            mean=float(np.mean(known)),
        )

    @property
    def table(self) -> tuple[Extent, ...]:
        """Lowest, highest and range at the measured rows, computed and measured."""
        extents = []
        for quantity in self.outputs:
            closed = np.isfinite(self.computed[quantity])
            sides = [np.asarray(v[quantity])[closed] for v in (self.computed, self.measured)]
            c, m = ((float(v.min()), float(v.max())) for v in sides)
            extents.append(Extent(quantity, c, m))
        return tuple(extents)


def per_cent(part: float) -> str:
    """A part as people read it, to three digits, never as a power of ten."""
    return f"{100 * part:.3g} %" if 100 * part < 999.5 else f"{100 * part:.0f} %"


def ends_of(linkage: Linkage, input: str | None = None, output: str | None = None) -> Ends:
    """The two joints that a measurement of a linkage is about: the drive's, or those named.

    >>> import sevenbar as sb
    >>> ends = ends_of(sb.load("rssp"))
    >>> ends.output, ends.output_slides
    ('slider', True)
    """
    first = linkage.column(linkage.drive.joint if input is None else input, "input")
    second = linkage.other_column(first) if output is None else linkage.column(output, "output")
    if first == second:
        raise RequestError(
            f"output: joint '{linkage.columns[first]}' is the input; "
            f"give another: {', '.join(linkage.drivable(first))}"
        )
    first_slides, second_slides = (linkage.column_kinds[column] == "slide" for column in (first, second))
    names = linkage.columns[first], linkage.columns[second]
    return Ends(*names, first_slides, second_slides, linkage.length_unit)


def compare(
    linkage: Linkage,
    measured: Measured,
    ends: Ends | None = None,
    *,
    align: Sequence[str] = (),
    speed: float | str | None = None,
    start: float = 0.0,
    circuit: int | None = None,
    branch: int | None = None,
) -> Comparison:
    """Compares measured rows with the linkage's motion.

    `align` of "phase" (the zero of the input) and "offset" (the zero of the output). The input moves at
    `speed`, the drive's where none is given; where the table has time but no input, it is at `start` [rad,
    or length] at time 0. `circuit` and `branch` (the pass) are found by the least residual where not given.
    Raises `RequestError` for a wrong argument, and where no circuit closes at any of the inputs.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> linkage = sb.load("rssr")
        >>> inputs = np.linspace(0.0, 6.0, 50)
        >>> angle = linkage.output(inputs).position[0] + 0.01
        >>> measured = Measured("by hand", np.arange(50), {"input": inputs, "angle": angle})
        >>> found = compare(linkage, measured, align=["offset"])
        >>> found.chosen.circuit, round(found.chosen.offset, 6)
        (0, 0.01)
    """
    ends = ends_of(linkage) if ends is None else ends
    aligned = tuple(dict.fromkeys(align))
    for word in aligned:
        if word not in ALIGN:
            raise RequestError(f"align: {shown(word)} is not offered; give {' or '.join(ALIGN)}")
    if "offset" in aligned and "angle" not in measured.values:
        raise RequestError(
            "align: an offset of the output needs its angle, and the table has none; leave it out"
        )
    rate, notes = _speed(linkage, ends, measured, speed)
    inputs = inputs_of(measured, rate, start)
    problem = _Problem(linkage, ends, measured, inputs, rate)
    candidates = problem.candidates("phase" in aligned, "offset" in aligned, circuit, branch)
    best = candidates[0]
    others = [c for c in candidates[1:] if (c.circuit, c.branch) != (best.circuit, best.branch)]
    near = CLOSE_CALL * max(best.residual, SAME_RESIDUAL)
    if others and others[0].residual < near and others[0].open_rows <= best.open_rows:
        other = others[0]
        notes.append(
            f"circuit {other.circuit}, branch {other.branch} explains the data nearly as well "
            f"(residual {per_cent(other.residual)} against {per_cent(best.residual)}): "
            "these data hardly distinguish the two"
        )
    if best.residual > UNEXPLAINED:
        notes.append(
            f"the differences are {per_cent(best.residual)} of the measured range: no circuit explains "
            "these data; check units, zeros (--align), speed and which joint was measured"
        )
    computed, values = problem.side_by_side(best)
    if best.open_rows:
        notes.append(
            f"{best.open_rows} of {len(measured)} rows have inputs at which the loop does not close on this "
            "pass; they are left out"
        )
    if measured.left_out:
        notes.append(f"{measured.left_out} rows without a number were left out")
    return Comparison(
        linkage=linkage,
        ends=ends,
        source=measured.source,
        speed=rate,
        chosen=best,
        candidates=tuple(candidates),
        aligned=aligned,
        line=measured.line,
        input=inputs + best.phase,
        measured=values,
        computed=computed,
        curve_input=np.linspace(*_ends(inputs + best.phase), CURVE),
        curve=problem.curve(best, _ends(inputs), values, computed),
        notes=tuple(notes),
    )


def _ends(values: Floats) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def inputs_of(measured: Measured, speed: float, start: float) -> Floats:
    """The input of each row [rad, or length]: as measured, or by the time at constant speed."""
    if "input" in measured.values:
        return measured.values["input"]
    return start + speed * measured.values["time"]


def _speed(
    linkage: Linkage, ends: Ends, measured: Measured, given: float | str | None
) -> tuple[float, list[str]]:
    """The input's speed, and what the data say of it where they hold both time and input."""
    column = linkage.columns.index(ends.input)
    if given is not None:
        try:
            rate = sliding_speed(given, ends.length_unit) if ends.input_slides else turning_speed(given)
        except RequestError as error:
            raise RequestError(f"speed: {error}") from None
    else:
        same = (
            linkage.column_kinds[linkage.columns.index(linkage.drive.joint)] == linkage.column_kinds[column]
        )
        rate = linkage.drive.speed if same else 1.0
    notes: list[str] = []
    values = measured.values
    if "time" in values and "input" in values and (given is None) and len(measured) > 2:
        travel = values["input"] if ends.input_slides else np.unwrap(values["input"])
        slope, start = np.polyfit(values["time"], travel, 1)
        apart = float(np.max(np.abs(travel - start - slope * values["time"])))
        if slope != 0 and apart <= UNIFORM * np.ptp(travel):
            if abs(slope - rate) > UNIFORM * abs(rate):
                notes.append(
                    f"the measured input moves at {slope:.6g}, the drive at {rate:.6g}: the former is taken"
                )
            return float(slope), notes
        if set(measured.outputs) - {"angle"}:
            notes.append(
                "the measured input does not move uniformly; computed velocities and accelerations are those "
                f"at a constant {rate:.6g}"
            )
    return rate, notes


class _Problem:
    """One measurement against one linkage: candidates, residuals, alignment."""

    def __init__(
        self, linkage: Linkage, ends: Ends, measured: Measured, inputs: Floats, speed: float
    ) -> None:
        self.linkage, self.ends, self.speed, self.inputs = linkage, ends, speed, inputs
        self.values = {quantity: measured.values[quantity] for quantity in measured.outputs}
        if not ends.output_slides and "angle" in self.values:
            # a jump of half a turn between two rows is one from 180 to -180 degrees
            self.values["angle"] = np.unwrap(self.values["angle"])
        self.scales = {quantity: float(np.ptp(v)) or 1.0 for quantity, v in self.values.items()}
        self.source = measured.source
        # the same inputs are needed again and again: for each pass, and once more for the chosen one
        self._last: tuple[bytes, dict[tuple[int, int], list[Floats]]] = (b"", {})

    def passes(self, inputs: Floats) -> dict[tuple[int, int], list[Floats]]:
        """Output and three derivatives by the input (n,), at inputs, of each pass by circuit and branch."""
        if self._last[0] == inputs.tobytes():
            return self._last[1]
        law = Law.of(np.arange(float(inputs.size)), inputs, 1.0, 0.0)
        motion = self.linkage.motion(input=self.ends.input, output=self.ends.output, law=law)
        if not motion.circuits:
            raise RequestError(
                f"linkage: {motion.motion_type}, so there is no motion to compare {self.source} with"
            )
        self.turns = {circuit.index: max(circuit.turns, 1) for circuit in motion.circuits}
        self.full = all(circuit.goes_round for circuit in motion.circuits)
        found: dict[tuple[int, int], list[Floats]] = {}
        for circuit in motion.circuits:
            for branch in range(len(circuit.time) // inputs.size):
                part = slice(branch * inputs.size, (branch + 1) * inputs.size)
                found[circuit.index, branch] = [
                    np.where(
                        circuit.status[part] == "no-solution", np.nan, rates[part, circuit.output_column]
                    )
                    for rates in (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)
                ]
        self._last = (inputs.tobytes(), found)
        return found

    def differences(self, rates: Sequence[Floats], offset: float = 0.0) -> dict[str, Floats]:
        """Measured minus computed of each quantity, an angle within half a turn."""
        found = {}
        for quantity, values in self.values.items():
            order = OUTPUTS.index(quantity)
            apart = values - rates[order] * self.speed**order
            if quantity == "angle":
                apart = apart - offset
                if not self.ends.output_slides:
                    apart = apart - math.tau * np.round(apart / math.tau)
            found[quantity] = apart
        return found

    def residual(self, rates: Sequence[Floats], offset: float) -> tuple[float, int]:
        """Root mean square of the differences relative to the ranges, and how many rows do not close.

        A row that does not close counts as a difference of a whole range.
        """
        parts = np.array([d / self.scales[q] for q, d in self.differences(rates, offset).items()])
        open_rows = int(np.isnan(parts).any(axis=0).sum())
        return math.sqrt(float(np.mean(np.where(np.isnan(parts), 1.0, parts) ** 2))), open_rows

    def offset(self, rates: Sequence[Floats]) -> float:
        """The offset of the output that fits best: the mean difference, of angles round the circle."""
        apart = self.differences(rates)["angle"]
        known = apart[np.isfinite(apart)]
        if known.size == 0:
            return 0.0
        if self.ends.output_slides:
            return float(known.mean())
        centre = math.atan2(float(np.sin(known).mean()), float(np.cos(known).mean()))
        return centre + float((known - centre - math.tau * np.round((known - centre) / math.tau)).mean())

    def candidates(self, phase: bool, offset: bool, circuit: int | None, branch: int | None) -> list[PassFit]:
        """Every pass with its residual, the best first."""
        here = self.passes(self.inputs)
        for name, word, value, known in (
            ("circuit", "circuit", circuit, sorted({key[0] for key in here})),
            ("branch", "pass", branch, sorted({key[1] for key in here})),
        ):
            if value is not None and value not in known:
                allowed = "0" if known == [0] else f"{known[0]} to {known[-1]}"
                raise RequestError(f"{name}: {value} is not a {word} of this motion; give {allowed}")
        wanted = [
            (*key, turn)
            for key in here
            if circuit in (None, key[0]) and branch in (None, key[1])
            for turn in range(self.turns[key[0]])
        ]
        if not wanted:
            raise RequestError(f"branch: circuit {circuit} has no branch {branch}; leave --branch out")
        starts = self._first_phase(wanted, offset) if phase else dict.fromkeys(wanted, 0.0)
        tried = [self._judged(key, starts[key], offset) for key in wanted]
        least = min(candidate.residual for candidate in tried)
        if phase:
            tried = [self._refined(c, offset) if c.residual <= max(NEAR * least, 1e-3) else c for c in tried]
        # residuals that differ by rounding are the same
        tried.sort(
            key=lambda c: (float(f"{max(c.residual, SAME_RESIDUAL):.6g}"), c.circuit, c.branch, c.turn)
        )
        if tried[0].open_rows == len(self.inputs):
            raise RequestError(
                f"{self.source}: at none of its inputs does the linkage close; check the units of the input "
                "and its zero, or let it be aligned with --align phase"
            )
        return tried

    def _at(self, key: tuple[int, int, int], phase: float) -> list[Floats]:
        return self.passes(self.inputs + phase + math.tau * key[2])[key[:2]]

    def _judged(self, key: tuple[int, int, int], phase: float, offset: bool) -> PassFit:
        rates = self._at(key, phase)
        moved = self.offset(rates) if offset else 0.0
        residual, open_rows = self.residual(rates, moved)
        return PassFit(*key, residual, open_rows, phase, moved)

    def _first_phase(
        self, wanted: Sequence[tuple[int, int, int]], offset: bool
    ) -> dict[tuple[int, int, int], float]:
        """A phase for each pass from curves read off a grid of the input, shifted step by step."""
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
        found = {}
        for key in wanted:
            rates = curves[key[:2]]
            if not self.ends.output_slides:
                rates = [_unwrapped(rates[0]), *rates[1:]]
            best = (math.inf, 0.0)
            for shift in sorted(shifts, key=abs):
                at = self.inputs + shift + math.tau * key[2]
                if not self.ends.input_slides:
                    at = at % (math.tau * turns)
                here = [np.interp(at, grid, r) for r in rates]
                moved = self.offset(here) if offset else 0.0
                best = min(best, (self.residual(here, moved)[0], float(shift)), key=lambda pair: pair[0])
            found[key] = best[1]
        return found

    def _refined(self, candidate: PassFit, offset: bool) -> PassFit:
        """The phase and offset of least squares near those given, by Gauss and Newton's steps."""
        key = (candidate.circuit, candidate.branch, candidate.turn)
        best = candidate
        for _ in range(30):
            rates = self._at(key, best.phase)
            gradients, errors = [], []
            for quantity, apart in self.differences(rates, best.offset).items():
                order, scale = OUTPUTS.index(quantity), self.scales[quantity]
                slope = rates[order + 1] * self.speed**order
                known = np.isfinite(apart) & np.isfinite(slope)
                aside = float(quantity == "angle")
                gradients.append(np.column_stack([slope, np.full(slope.size, aside)])[known] / scale)
                errors.append(apart[known] / scale)
            gradient, error = np.concatenate(gradients), np.concatenate(errors)
            if error.size <= gradient.shape[1]:
                return best
            step = np.linalg.lstsq(gradient if offset else gradient[:, :1], error, rcond=None)[0]
            for share in (1.0, 0.5, 0.25, 0.1, 0.01):
                tried = self._judged(key, best.phase + share * float(step[0]), offset)
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
        rates = self._at((chosen.circuit, chosen.branch, chosen.turn), chosen.phase)
        apart = self.differences(rates, chosen.offset)
        measured = dict(self.values)
        if "angle" in measured:
            measured["angle"] = measured["angle"] - chosen.offset
            if not self.ends.output_slides:
                # one whole number of turns for all rows, so that the curve stays in one piece
                raw = measured["angle"] - rates[0] - apart["angle"]
                known = raw[np.isfinite(raw)]
                measured["angle"] = measured["angle"] - math.tau * round(float(np.median(known)) / math.tau)
        return {quantity: measured[quantity] - apart[quantity] for quantity in measured}, measured

    def curve(
        self,
        chosen: PassFit,
        ends: tuple[float, float],
        measured: Mapping[str, Floats],
        computed: Mapping[str, Floats],
    ) -> dict[str, Floats]:
        """Each quantity over the inputs between two ends, (m,); an angle near the computed ones."""
        at = np.linspace(*ends, CURVE) + chosen.phase + math.tau * chosen.turn
        rates = self.passes(at)[chosen.circuit, chosen.branch]
        found = {q: rates[OUTPUTS.index(q)] * self.speed ** OUTPUTS.index(q) for q in measured}
        if "angle" in found and not self.ends.output_slides:
            angle = _unwrapped(found["angle"])
            known = np.flatnonzero(np.isfinite(angle))
            nearest = known[
                np.argmin(np.abs(at[known] - chosen.phase - math.tau * chosen.turn - self.inputs[0]))
            ]
            turns = round((computed["angle"][0] - angle[nearest]) / math.tau) if known.size else 0
            found["angle"] = angle + math.tau * turns
        return found


def _unwrapped(angles: Floats) -> Floats:
    """A curve without jumps of whole turns, its gaps kept."""
    known = np.isfinite(angles)
    result = angles.copy()
    result[known] = np.unwrap(angles[known])
    return result
