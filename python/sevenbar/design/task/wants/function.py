"""The want of a function: the output's readings over those of the input."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import StrictBool

from sevenbar.arrays import Floats
from sevenbar.description.values import Text, key
from sevenbar.design.task.flaws import Flaws, order_flaws, over_a_turn
from sevenbar.design.task.given import one_of, read_file, reading, reading_span, zero
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.task import DesignTask, SampledWant, WantForm
from sevenbar.design.task.values import OF_INPUT, Numbers, Pairs, Points, Span, Weight, Zero
from sevenbar.design.task.wanted import Used, WantFact
from sevenbar.design.task.wants.readings import ReadingsWanted
from sevenbar.design.task.words import ends_in_words
from sevenbar.design.wish import chebyshev, degrees_hint, read_pairs, wish_of_function
from sevenbar.errors import RequestError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.columns import shown_in
from sevenbar.text.expression import function_of


class FunctionForm(WantForm):
    """The output as a function of the input."""

    kind: Annotated[Literal["function"], key("this want")]
    y: Annotated[Text | None, key("a function of x, as in 'x^2'; or pairs, or a table")] = None
    x: Annotated[Numbers, key("of y: the range of x; an angle with a unit counts in radians")] = (0.0, 1.0)
    input: Annotated[
        Span | None,
        key("of y: readings of the input over the range of x; left out with output, x itself", OF_INPUT),
    ] = None
    output: Annotated[
        Span | None, key("of y: readings of the output from the least y to the greatest; y itself", OF_INPUT)
    ] = None
    points: Annotated[
        Points | None,
        key("of y: so many points by Chebyshev's spacing are wanted, not all of the range"),
    ] = None
    pairs: Annotated[Pairs | None, key("readings of input and output, row by row", OF_INPUT)] = None
    table: Annotated[
        Text | None, key("a CSV file or workbook of pairs: two columns, their units in the header")
    ] = None
    input_zero: Annotated[Zero, key("the input's value at the reading 0, or free", OF_INPUT)] = "free"
    output_zero: Annotated[Zero, key("the output's value at the reading 0, or free", OF_INPUT)] = "free"
    exact: Annotated[StrictBool, key("whether all points must be met exactly")] = False
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> FunctionWant:
        source = one_of(self, "y", "pairs", "table")
        if self.y is None:
            for name in ("input", "output", "points"):
                if getattr(self, name) is not None:
                    raise RequestError(f"{name}: belongs to y; {source} says it all, so leave it out")
        columns = linkage.drive.joint, linkage.drive.output
        if self.y is not None:
            x, y = self._of_formula(self.y, linkage)
        elif self.pairs is not None:
            rows = [(f"pairs[{i + 1}]", row) for i, row in enumerate(self.pairs)]
            x, y = (
                np.array([reading(name, row[side], linkage, column) for name, row in rows])
                for side, column in enumerate(columns)
            )
        else:
            if not all(map(linkage.turns, columns)):
                raise RequestError("table: holds angles, and a joint of the drive slides; give pairs")
            x, y = read_file(read_pairs, folder, str(self.table))
        zeros = (
            zero("input_zero", self.input_zero, linkage, columns[0]),
            zero("output_zero", self.output_zero, linkage, columns[1]),
        )
        return FunctionWant(x, y, zeros, self.weight)

    def _of_formula(self, formula: str, linkage: Linkage) -> tuple[Floats, Floats]:
        """Readings of input and output that y(x) wants: over the ranges of both, or x and y themselves."""
        drive = linkage.drive
        low, high = self.x
        if not low < high:
            raise RequestError(f"x: {low:g}:{high:g} does not rise; give the lower end first")
        # over ranges from 0 to 1, so readings are shares of the ranges
        curve = wish_of_function(formula, self.x, (0.0, 1.0), (0.0, 1.0), title=formula)
        share = curve.input if self.points is None else chebyshev(0.0, 1.0, self.points)
        if self.input is None and self.output is None:
            x = low + (high - low) * share
            if linkage.turns(drive.joint) and high - low >= math.tau:
                raise RequestError(
                    f"x: goes over {math.degrees(high - low):g} deg, for it counts in radians; "
                    "give a part of a turn"
                )
            return x, function_of(formula)(x)
        ranges = []
        for name, ends, column in (("input", self.input, drive.joint), ("output", self.output, drive.output)):
            if ends is None:
                raise RequestError(
                    f"{name}: is missing; give both ranges of readings, or neither where x and y are the "
                    "readings"
                )
            first, last = reading_span(name, ends, linkage, column)
            if first == last:
                raise RequestError(f"{name}: both ends are one; give a range, as in '0:90deg'")
            if linkage.turns(column) and abs(last - first) >= math.tau:
                raise RequestError(
                    f"{name}: goes over {math.degrees(abs(last - first)):g} deg; give a part of a turn"
                )
            ranges.append((first, last))
        assert curve.function is not None
        (a, b), (c, d) = ranges
        return a + (b - a) * share, c + (d - c) * curve.function(share)

    def hints(self) -> Iterator[tuple[str, str]]:
        if self.y is not None and (hint := degrees_hint(self.y, self.x)):
            yield "y", hint


@dataclass(frozen=True, eq=False)
class FunctionWant(SampledWant):
    """The output as a function of the input: readings of the drive's two joints.

    At `input` (n,) the output reads `output` (n,), both [rad, or length], rising or falling in the input. The
    values of the joints are the readings plus `zeros` (input's, output's); a zero that is `None` is free.
    Residuals: what the output is off [rad, or relative to the linkage's size].
    """

    form = FunctionForm
    of_output = True

    input: Floats
    output: Floats
    zeros: tuple[float | None, float | None] = (0.0, 0.0)
    weight: float = 1.0

    def flaws(self, task: DesignTask) -> Flaws:
        x, y = self.input, self.output
        if x.ndim != 1 or x.shape != y.shape or x.size < 2 or not np.isfinite([x, y]).all():
            yield "", f"{x.size} inputs and {y.size} outputs; give two finite pairs or more"
            return
        yield from order_flaws(x, "", "input")
        if over_a_turn(task.draft.linkage, float(np.ptp(x))):
            yield "", f"the inputs go over {math.degrees(float(np.ptp(x))):g} deg; give a turn at most"
        yield from self.exact_flaws(task, x.size, self.zeros.count(None))

    def words(self, linkage: Linkage) -> str:
        drive = linkage.drive
        return (
            f"{drive.output} over {drive.joint}: {len(self.input)} readings, "
            f"{ends_in_words(self.input, linkage, drive.joint)} in, "
            f"{ends_in_words(self.output, linkage, drive.output)} out"
        )

    def input_range(self) -> tuple[float, float] | None:
        start, _ = self.zeros
        return None if start is None else (float(self.input.min()) + start, float(self.input.max()) + start)

    def readings_of(self, column: str, linkage: Linkage) -> Floats | None:
        columns = linkage.drive.joint, linkage.drive.output
        for name, zero_at, readings in zip(columns, self.zeros, (self.input, self.output), strict=True):
            if name == column:
                return None if zero_at is None else zero_at + readings
        return None

    def in_loop(self, loop: TaskLoop) -> _FunctionResiduals:
        return _FunctionResiduals(loop, self.input, self.output, self.zeros, self.weight)


class _FunctionResiduals(ReadingsWanted):
    def facts(self, used: Used) -> Sequence[WantFact]:
        linkage, result = used.loop.linkage, []
        ends = (("input_zero", linkage.drive.joint), ("output_zero", linkage.drive.output))
        for (name, column), value in zip(ends, self.shown_zeros(used), strict=True):
            unit, scale = shown_in(linkage, column)
            result.append(WantFact(name, unit, value * scale))
        return result
