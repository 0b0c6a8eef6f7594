"""Measured values compared with computed ones: the circuit that explains them, alignment, differences.

At each measured row the linkage is solved at the row's input: the measured one, or `speed * time`. Every pass
of every circuit is a candidate; the one with the least residual explains the data, and the others are
kept with their residuals. With `align` the curve is first moved along the input ("phase") and along the
output ("offset") by least squares: two zeros that differ on a test bench. Rows whose input turns back at its
limit are compared pass by pass.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import RequestError, check_word
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.measuring.candidates import SAME_RESIDUAL, Candidates
from sevenbar.measuring.doubtful import far_off_notes, first_of
from sevenbar.measuring.extremes import Extent
from sevenbar.measuring.measured import OUTPUTS, Ends, Measured
from sevenbar.measuring.passes import PassFit
from sevenbar.text.printing import Printed
from sevenbar.text.units import sliding_speed, turning_speed

#: What may be aligned.
ALIGN = ("phase", "offset")

#: A measured input that departs from uniform motion by more than this share of its travel is reported.
UNIFORM = 0.01

#: The second best candidate within this factor of the best: the data hardly distinguish the two.
CLOSE_CALL = 1.2

#: Lines that a note names.
MOST_LINES = 12


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
    `chosen.offset` subtracted from the angle, and is brought within half a turn of `computed`. `branch` is
    the pass of each row, `stretch` counts how often the input has turned at a limit, `speeds` is the speed
    of the input there.
    """

    linkage: Linkage
    ends: Ends
    source: str
    speed: float
    chosen: PassFit
    candidates: tuple[PassFit, ...]
    aligned: tuple[str, ...]
    line: Integers
    branch: Integers
    stretch: Integers
    speeds: Floats
    input: Floats
    measured: Mapping[str, Floats]
    computed: Mapping[str, Floats]
    #: The chosen circuit at the inputs of the rows, once for each of its passes.
    circuit: Circuit
    notes: tuple[str, ...]
    #: Those of the notes that say something of the rows, not of the differences.
    about_rows: tuple[str, ...]
    _candidates: Candidates = field(repr=False)

    @property
    def outputs(self) -> tuple[str, ...]:
        """The quantities that were measured."""
        return tuple(self.measured)

    @cached_property
    def curve(self) -> Mapping[str, Floats]:
        """The computed curve (m,) for figures: "input" and each quantity; NaN between stretches."""
        return self._candidates.curve(self.chosen, self.computed)

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
    first, second = linkage.end_columns(input, output)
    first_slides, second_slides = (not linkage.turns(column) for column in (first, second))
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
        check_word("align", word, ALIGN)
    if "offset" in aligned and "angle" not in measured.values:
        raise RequestError(
            "align: an offset of the output needs its angle, and the table has none; leave it out"
        )
    rate, notes = _speed(linkage, ends, measured, speed)
    inputs = inputs_of(measured, rate, start)
    problem = Candidates(linkage, ends, measured, inputs, rate)
    candidates = problem.best("phase" in aligned, "offset" in aligned, circuit, branch)
    best = candidates[0]
    computed, values = problem.side_by_side(best)
    compared = Comparison(
        linkage=linkage,
        ends=ends,
        source=measured.source,
        speed=rate,
        chosen=best,
        candidates=tuple(candidates),
        aligned=aligned,
        line=measured.line,
        branch=problem.branch_of_rows(best.key),
        stretch=problem.stretch_of_rows(best.key),
        speeds=problem.speeds(signed=best.signed),
        input=inputs + best.phase,
        measured=values,
        computed=computed,
        circuit=problem.circuit_of(best),
        notes=(),
        about_rows=(),
        _candidates=problem,
    )
    about = (*notes, *_about_rows(compared))
    return replace(compared, notes=(*about, *_about_differences(compared, measured)), about_rows=about)


def _about_rows(compared: Comparison) -> list[str]:
    """What the rows show besides their differences."""
    notes, best = [], compared.chosen
    if best.branches:
        behind = [int(compared.line[row]) for row in compared._candidates.stretches.turns]
        lines = f"line{'s' * (len(behind) > 1)} {first_of(behind, MOST_LINES)}"
        notes.append(
            f"the input turns back at its limit in {lines}: the rows are taken pass by pass, "
            f"on {name_of(best).partition(', ')[2]}"
        )
    for quantity, values in compared.measured.items():
        if np.ptp(values) == 0:
            notes.append(
                f"the {compared.ends.word(quantity)} is the same in all rows: they show no motion of "
                f"{compared.ends.output}"
            )
    others = [c for c in compared.candidates[1:] if not alike(c, best)]
    near = CLOSE_CALL * max(best.closed_residual, SAME_RESIDUAL)
    if others and others[0].closed_residual < near and others[0].open_rows <= best.open_rows:
        other = others[0]
        notes.append(
            f"{name_of(other)} explains the data nearly as well "
            f"(residual {per_cent(other.closed_residual)} against {per_cent(best.closed_residual)}): "
            "these data hardly distinguish the two"
        )
    return notes


def _about_differences(compared: Comparison, measured: Measured) -> list[str]:
    """What is to be said of the differences, and of rows that are left out."""
    notes, best = [], compared.chosen
    if not best.explains:
        notes.append(
            f"the differences are {per_cent(best.residual)} of the measured range: no circuit explains "
            f"these data; {causes(compared, '--align')}"
        )
    else:
        notes += _far_off(compared)
    if best.open_rows:
        notes.append(
            f"{best.open_rows} of {len(measured)} rows have inputs at which the loop does not close on this "
            "pass; they are left out"
        )
    if measured.left_out:
        notes.append(f"{measured.left_out} rows without a number were left out")
    return notes


def alike(one: PassFit, other: PassFit) -> bool:
    """Whether two candidates of a circuit differ by no more than what a few rows at its limits say."""
    if one.circuit != other.circuit:
        return False
    return one.key.branches == other.key.branches or bool(one.branches and other.branches)


def causes(compared: Comparison, zeros: str) -> str:
    """What to check where no circuit explains the rows; `zeros` is the option that finds zeros."""
    stretches = compared._candidates.stretches
    rows = "" if stretches.in_order else (
        f"the input turns back {len(stretches) - 1} times in {len(compared.line)} rows: sort them by time; "
    )  # fmt: skip
    return f"{rows}check units, zeros ({zeros}), speed and which joint was measured"


def _far_off(compared: Comparison) -> list[str]:
    """The rows whose differences are far from all others, with their lines."""
    rates = compared._candidates.at(compared.chosen.key, compared.chosen.phase)
    notes = []
    for quantity, measured in compared.measured.items():
        order = OUTPUTS.index(quantity)
        apart, slopes = compared.difference(quantity), rates[order + 1] * compared.speeds**order
        extent = float(np.ptp(measured))
        notes += far_off_notes(compared.ends, quantity, compared.line, compared.source, apart, slopes, extent)
    return notes


def name_of(fit: PassFit) -> str:
    """A candidate as people read it."""
    if not fit.branches:
        return f"circuit {fit.circuit}, branch {fit.branch}"
    shown_ways = ", ".join(map(str, fit.branches[:MOST_LINES]))
    more = ", .." if len(fit.branches) > MOST_LINES else ""
    return f"circuit {fit.circuit}, branches {shown_ways}{more} one after the other"


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
        rate = linkage.speed_of(column)
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
