"""A function that is wanted of a linkage: readings of the input's and the output's dial, precision points."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array
from sevenbar.errors import RequestError
from sevenbar.text.expression import function_of, greatest_angle
from sevenbar.text.table import read_table

#: Points that determine a design with both zeros given, and with neither.
FIXED_ZEROS_MOST, FREE_ZEROS_MOST = 5, 7

#: Fewest points that are worth a design.
FEWEST = 3

#: Readings over the range at which a fit looks at the error: between them it rises by less than 1% of it.
FIT_SAMPLES = 81

#: Readings over the range at which errors are measured: 0.25 deg apart on a quarter turn.
DENSE_SAMPLES = 361

#: A function that rises or falls by more than this part of its whole range from one of 7220 values of x to
#: the next has a jump or a pole there; x^0.1, steep as it begins, does so by 0.41.
MOST_OF_A_STEP = 0.5

#: Most pairs of readings that a fit takes.
MOST_PAIRS = 100_000

#: Greatest reading [rad]: beyond it less than nine digits are left within a turn.
MOST_READING = 1e7


@dataclass(frozen=True)
class Dials:
    """What the two dials read: x and y of a function, and the angles [rad] from end to end of each."""

    x: tuple[float, float]
    y: tuple[float, float]
    input: tuple[float, float]
    output: tuple[float, float]

    @property
    def text(self) -> str:
        """Both dials in words: "input 0 to 90 deg for x from 0 to 1, output ..".

        >>> Dials((0, 1), (0, 2), (0, math.pi / 2), (0, math.pi)).text
        'input 0 to 90 deg for x from 0 to 1, output 0 to 180 deg for y from 0 to 2'
        """
        parts = []
        for side, angles, name, values in (
            ("input", self.input, "x", self.x),
            ("output", self.output, "y", self.y),
        ):
            first, last = map(math.degrees, angles)
            parts.append(
                f"{side} {first:g} to {last:g} deg for {name} from {values[0]:.6g} to {values[1]:.6g}"
            )
        return ", ".join(parts)


@dataclass(frozen=True, eq=False)
class Wish:
    """Readings wanted, all relative to zeros that the design is free to choose.

    `input`, `output` (m,) [rad] are those that a fit looks at, input rising; `point_input`, `point_output`
    (n,) the precision points, none where the whole range counts alike. `function` gives the output's reading
    at inputs, `None` where only the pairs are wanted. `zeros` [rad] where the design may not choose them.
    """

    title: str
    input: Floats
    output: Floats
    point_input: Floats
    point_output: Floats
    function: Callable[[Floats], Floats] | None = None
    zeros: tuple[float, float] | None = None
    #: The ranges of a function; `None` for pairs.
    dials: Dials | None = None
    #: What may be a mistake in a wish that cannot be met; `None` where nothing is.
    hint: str | None = None

    @property
    def pairs(self) -> bool:
        """Whether pairs are to be met exactly, so that designs differ by what they transmit."""
        return self.exact and self.function is None

    @property
    def exact(self) -> bool:
        """Whether precision points are to be met exactly."""
        return self.point_input.size > 0

    @property
    def dense(self) -> Floats:
        """Readings of the input over its range (361,) [rad]."""
        return np.linspace(self.input[0], self.input[-1], DENSE_SAMPLES)


def chebyshev(low: float, high: float, count: int) -> Floats:
    """Precision points (count,) between two ends, spaced as the zeros of Chebyshev's polynomial.

    Near to them lie the best ones: the error between them is about even.

        >>> chebyshev(0.0, 1.0, 2).round(4).tolist()
        [0.1464, 0.8536]
    """
    angles = (2 * np.arange(count) + 1) * math.pi / (2 * count)
    return (low + high) / 2 - (high - low) / 2 * np.cos(angles)


def wish_of_function(
    wanted: str | Callable[[Floats], Floats],
    x_range: tuple[float, float],
    input_range: tuple[float, float],
    output_range: tuple[float, float],
    *,
    points: int | None = None,
    title: str | None = None,
) -> Wish:
    """The wish for y(x): x goes over the input's range, y from its least to its greatest over the output's.

    Ranges in radians. y is a function, or a formula as `function_of` takes it. `points` precision points by
    Chebyshev's spacing, to be met exactly; none for the least error over the range. Raises `RequestError`.
    """
    formula = wanted if isinstance(wanted, str) else None
    function = function_of(wanted) if isinstance(wanted, str) else wanted
    title = title or ("y(x)" if formula is None else f"y = {formula}")
    low, high = x_range
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise RequestError(f"x: {low:g}:{high:g} is no range; give two numbers that rise, as in 0:1")
    for name, ends in (("input range", input_range), ("output range", output_range)):
        span = abs(ends[1] - ends[0])
        if not 0 < span < math.tau:
            raise RequestError(
                f"{name}: {math.degrees(ends[0]):g} to {math.degrees(ends[1]):g} deg is no part of a turn; "
                "give two angles less than 360 deg apart, as in 0:90deg"
            )
    if points is not None and not FEWEST <= points <= FREE_ZEROS_MOST:
        raise RequestError(
            f"points: {points} precision points are not offered; give {FEWEST} to {FREE_ZEROS_MOST}, "
            "or none for the least error over the range"
        )
    x = np.linspace(low, high, 20 * DENSE_SAMPLES)
    y = function(x)
    if not np.isfinite(y).all():
        at = x[int(np.flatnonzero(~np.isfinite(y))[0])]
        raise RequestError(f"y: {title} has no value at x = {at:g}; give another range of x")
    least, most = float(y.min()), float(y.max())
    if most - least <= 1e-12 * max(abs(least), abs(most), 1e-300):
        raise RequestError(f"y: {title} is the same all over {low:g}:{high:g}; give a function that changes")
    rise = int(np.argmax(np.abs(np.diff(y))))
    if abs(y[rise + 1] - y[rise]) > MOST_OF_A_STEP * (most - least):
        raise RequestError(
            f"y: {title} jumps between x = {x[rise]:.6g} and {x[rise + 1]:.6g}, from {y[rise]:.3g} to "
            f"{y[rise + 1]:.3g}; give a range of x in which it is continuous"
        )

    reading = partial(_reading, function, (low, high), (least, most), input_range, output_range)
    first, last = sorted(input_range)
    middle, half = (first + last) / 2, (last - first) / 2
    samples = middle - half * np.cos(np.linspace(0.0, math.pi, FIT_SAMPLES))
    at = np.empty(0) if points is None else chebyshev(first, last, points)
    dials = Dials((low, high), (least, most), input_range, output_range)
    hint = None if formula is None else degrees_hint(formula, (low, high))
    return Wish(title, samples, reading(samples), at, reading(at), reading, dials=dials, hint=hint)


def degrees_hint(formula: str, x: tuple[float, float]) -> str | None:
    """That x may be in degrees and counts in radians: a sine of the formula goes round more than once."""
    low, high = x
    result = greatest_angle(formula, np.linspace(low, high, DENSE_SAMPLES))
    if result is None or result[2] <= math.tau:
        return None
    name, argument, _ = result
    return (
        f"{name} takes radians; x goes to {high:g}: write {name}d({argument}) or x = {low:g}:{high:g}deg "
        "if these are degrees"
    )


def _reading(
    function: Callable[[Floats], Floats],
    x: tuple[float, float],
    y: tuple[float, float],
    inputs: tuple[float, float],
    outputs: tuple[float, float],
    a: Floats,
) -> Floats:
    """The output's readings that a function wants at the input's readings `a`, by the ends of each scale."""
    share = (a - inputs[0]) / (inputs[1] - inputs[0])
    value = (function(x[0] + (x[1] - x[0]) * share) - y[0]) / (y[1] - y[0])
    return np.asarray(outputs[0] + (outputs[1] - outputs[0]) * value)


def wish_of_pairs(
    inputs: npt.ArrayLike,
    outputs: npt.ArrayLike,
    *,
    zeros: tuple[float, float] | None = None,
    title: str = "pairs of angles",
) -> Wish:
    """The wish for pairs of readings (n,) [rad]: to seven are met exactly, more as well as can be.

    With `zeros` (input's, output's [rad]) the exact ones are five at most. Raises `RequestError`.
    """
    a, b = finite_array("points", inputs), finite_array("points", outputs)
    if a.size != b.size:
        raise RequestError(f"points: {a.size} inputs and {b.size} outputs; give one output for each input")
    if not FEWEST <= a.size <= MOST_PAIRS:
        raise RequestError(
            f"points: {a.size} pairs are not enough to tell a design; give {FEWEST} to {MOST_PAIRS}"
        )
    order = np.argsort(a, kind="stable")
    a, b = a[order], b[order]
    if (np.diff(a) <= 0).any():
        twice = math.degrees(a[int(np.flatnonzero(np.diff(a) <= 0)[0])])
        raise RequestError(f"points: input {twice:g} deg is given twice; give each once")
    if (wild := np.abs(np.concatenate([a, b])).max()) > MOST_READING:
        raise RequestError(
            f"points: {math.degrees(wild):g} deg has too few digits left within a turn; give smaller angles"
        )
    if a[-1] - a[0] >= math.tau:
        raise RequestError("points: the inputs reach over a full turn; give a part of one")
    most = FREE_ZEROS_MOST if zeros is None else FREE_ZEROS_MOST - 2
    none = np.empty(0)
    return Wish(title, a, b, *((a, b) if a.size <= most else (none, none)), zeros=zeros)


def read_pairs(path: Path) -> tuple[Floats, Floats]:
    """The pairs of readings [rad] in a CSV or text table: two columns, whose header names their units.

    The input comes first, unless the header names both as input and output. Raises `TableError`.
    """
    table = read_table(path, "pairs of angles")
    if len(table.names) != 2:
        raise table.wrong(f"{len(table.names)} columns; give two: readings of the input and of the output")
    named = table.column("input"), table.column("output")
    columns = []
    for column in (0, 1) if None in named else named:
        assert column is not None
        columns.append(table.sized(column, ("turn", 0), "m", what="angle", example="deg"))
    table.refuse_gaps(dict(enumerate(columns)), "leave the row out")
    return columns[0], columns[1]
