"""What tolerances do by the linear estimate, along the cycle and of each measure.

With s the derivatives of an output, t the half widths and sigma the standard deviations of the errors,

    worst = sum |s_i t_i|,        deviation^2 = sum (s_i sigma_i)^2                                        (1)

and the share of a dimension in the variance is that of its term in the second sum, over the whole cycle.

Source: docs/theory_design.md, (7).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers, Words, counted
from sevenbar.description.held import HeldDimensions, held_of
from sevenbar.design.tolerance.sensitivities import Sensitivities, sensitivities
from sevenbar.design.tolerance.tolerances import Tolerances
from sevenbar.errors import RequestError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.text.words import say

#: What tolerances may be given as.
Given = Tolerances | Mapping[str, float | str]


@dataclass(frozen=True)
class Effect:
    """What a dimension's tolerance does to the output: the greatest effect, at which input, and the share."""

    dimension: Dimension
    width: float
    source: str
    greatest: float
    at: float
    share: float


@dataclass(frozen=True, eq=False)
class Linear:
    """The linear estimate (1) of an output on the rows where it means something.

    `rows` (n,) of the circuit, with `slopes` (n, dimensions) 0 where a dimension has no tolerance; `worst`
    and `deviation` (n,) in the output's unit. `status` (all rows,) says why others are left out.
    """

    found: Sensitivities = field(repr=False)
    tolerances: Tolerances = field(repr=False)
    distribution: str
    output: str
    quantity: str
    status: Words = field(repr=False)
    rows: Integers = field(repr=False)
    slopes: Floats = field(repr=False)

    @property
    def unit(self) -> str:
        """The output's unit."""
        return self.found.outputs[self.found.place(self.output, self.quantity)].unit

    @property
    def words(self) -> str:
        """The output in words: "angle of rocker", "velocity of slider", "P.x"."""
        one = self.found.outputs[self.found.place(self.output, self.quantity)]
        if not one.joint:
            return one.name
        word = "angle" if one.quantity == "position" and one.unit == "rad" else one.quantity
        return say("{quantity} of {joint}", quantity=say(word), joint=one.owner)

    @property
    def shown_unit(self) -> str:
        """The unit in which people read the output: degrees for angles."""
        return "deg" if self.unit == "rad" else self.unit.replace("^2", "²")

    def shown(self, values: npt.ArrayLike) -> Floats:
        """Values of the output in that unit."""
        array = np.asarray(values, dtype=np.float64)
        return np.degrees(array) if self.unit == "rad" else array

    def shown_input(self, value: float) -> str:
        """An input as people read it."""
        if self.found.input_turns:
            return f"{math.degrees(value):.4g}°"
        return f"{value:.4g} {self.found.linkage.length_unit}"

    @property
    def input(self) -> Floats:
        """The inputs (n,) [rad, or length]."""
        return np.asarray(self.found.input[self.rows])

    @cached_property
    def worst(self) -> Floats:
        """The worst case (n,)."""
        return np.asarray(np.abs(self.slopes) @ self.tolerances.widths)

    @cached_property
    def deviation(self) -> Floats:
        """The standard deviation (n,)."""
        return np.sqrt(self.slopes**2 @ self.tolerances.deviations(self.distribution) ** 2)

    @property
    def held(self) -> HeldDimensions:
        """The dimensions without a tolerance."""
        each = zip(self.found.dimensions, self.tolerances.widths, strict=True)
        return held_of(self.found.draft, [dimension.name for dimension, width in each if width > 0])

    @property
    def greatest(self) -> int:
        """The place among the rows where the worst case is greatest."""
        return int(np.argmax(self.worst))

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """Each dimension that has a tolerance, the greatest share of the variance first."""
        parts = (self.slopes * self.tolerances.deviations(self.distribution)) ** 2
        total = float(parts.sum())
        result = []
        for k, dimension in enumerate(self.found.dimensions):
            width, source = float(self.tolerances.widths[k]), self.tolerances.sources[k]
            if not width > 0:
                continue
            effect = np.abs(self.slopes[:, k]) * width
            row = int(np.argmax(effect))
            share = float(parts[:, k].sum()) / total if total > 0 else 0.0
            result.append(Effect(dimension, width, source, float(effect[row]), float(self.input[row]), share))
        return tuple(sorted(result, key=lambda effect: (-effect.share, -effect.greatest)))

    def measure(self, name: str) -> tuple[float, float]:
        """Worst case and standard deviation of a measure, in its unit; NaN where it has no derivative."""
        slopes = np.where(self.tolerances.widths > 0, self.found.measure(name).slopes, 0.0)
        deviations = self.tolerances.deviations(self.distribution)
        return float(np.abs(slopes) @ self.tolerances.widths), float(np.sqrt(slopes**2 @ deviations**2))

    def left_out(self) -> tuple[str, ...]:
        """What is left out, in words: rows, and dimensions."""
        remarks = list(self.tolerances.left_out)
        for word, count in counted(self.status[self.status != "ok"]).items():
            remarks.append(f"{count} of {len(self.status)} rows left out: {_WHY.get(word, word)}")
        return tuple(remarks)


_WHY = {
    "near-dead-centre": "so near to a dead centre of the input that these tolerances may move it past them, "
    "and the sensitivities grow without bound",
    "dead-centre": "at a dead centre of the input, where the sensitivities have no bound",
    "change-point": "at a change point, where the sensitivities have no bound",
}


def linear_estimate(
    of: Linkage | Sensitivities,
    given: Given,
    *,
    distribution: str = "normal",
    output: str | None = None,
    quantity: str = "position",
) -> Linear:
    """The linear estimate of what tolerances do to an output along the cycle.

    `given` are half widths by name or pattern, `distribution` normal, uniform or triangular, `output` a
    joint or a point's coordinate, of which `quantity` position, velocity or acceleration is estimated. Raises
    `RequestError` for arguments that do not fit, and where no row is left.

        >>> import sevenbar as sb
        >>> found = linear_estimate(sb.load("rssr"), {"L1": 0.5, "L2": 0.5})
        >>> bool((found.deviation <= found.worst).all())
        True
    """
    computed = of if isinstance(of, Sensitivities) else sensitivities(of)
    if not isinstance(given, Tolerances):
        given = computed.tolerances(given)
    # raises where there is no such distribution
    given.deviations(distribution)
    status = computed.clear(given.widths)
    place = computed.place(output, quantity)
    slopes = np.where(given.widths > 0, computed.slopes[:, place], 0.0)
    one = computed.outputs[place]
    if np.isnan(computed.values[computed.rows, place]).all() or np.isnan(slopes[status == "ok"]).any():
        raise RequestError(
            f"output: {one.name} takes part in an idle motion, which the input does not tell; give another"
        )
    rows = np.flatnonzero(status == "ok")
    if not rows.size:
        raise RequestError(
            "tolerance: these are so great that the dead centres of the input may move past every row; "
            "give smaller ones"
        )
    name = one.owner if one.joint else one.name
    return Linear(computed, given, distribution, name, one.quantity, status, rows, slopes[rows])
