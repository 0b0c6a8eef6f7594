"""The paper's Table 1: lowest, highest and range of a quantity, computed and measured.

Source: Sun and Zhou, Table 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.measuring.measured import Ends, MeasuredExtremes
from sevenbar.text.printing import Printed

#: Below this share of the range a lowest or highest value has no per cent worth printing.
NEAR_ZERO = 1e-9


@dataclass(frozen=True)
class Extent:
    """A line of the paper's Table 1: lowest, highest and range, computed and measured."""

    quantity: str
    computed: tuple[float, float]
    measured: tuple[float, float]

    def rows(self) -> list[tuple[str, float, float, float, float | None]]:
        """For lowest, highest, range: computed, measured, error and per cent.

        The error is measured minus computed, the per cent that of the size of the computed value; `None`
        where the computed value is zero.
        """
        rows = []
        span = abs(self.computed[1] - self.computed[0])
        for name, c, m in (
            ("lowest", self.computed[0], self.measured[0]),
            ("highest", self.computed[1], self.measured[1]),
            ("range", self.computed[1] - self.computed[0], self.measured[1] - self.measured[0]),
        ):
            per_cent = 100 * (m - c) / abs(c) if abs(c) > NEAR_ZERO * span and c else None
            rows.append((name, c, m, m - c, per_cent))
        return rows


@dataclass(frozen=True, repr=False)
class ExtremesComparison(Printed):
    """The paper's Table 1: measured extremes compared with those of a circuit, exact ones by root finding."""

    linkage: Linkage
    ends: Ends
    source: str
    speed: float
    circuit: int
    table: tuple[Extent, ...]
    #: Residual of each circuit, relative to the measured ranges.
    residuals: tuple[tuple[int, float], ...]


def compare_extremes(
    linkage: Linkage,
    measured: MeasuredExtremes,
    ends: Ends,
    *,
    speed: float | str | None = None,
    circuit: int | None = None,
) -> ExtremesComparison:
    """Compares measured extremes with those of the circuit that fits them best.

    Raises `RequestError` where no circuit has all of these extremes.

    Source: Sun and Zhou, Table 1.
    """
    motion = linkage.motion(input=ends.input, output=ends.output, speed=speed)
    tables = {
        c.index: extents
        for c in motion.circuits
        if circuit in (None, c.index) and (extents := _extents(c, measured, ends)) is not None
    }
    if not tables:
        who = (
            "no circuit of this motion has"
            if circuit is None
            else f"{circuit} is none of this motion, or lacks"
        )
        raise RequestError(
            f"circuit: {who} a lowest and a highest value of {', '.join(measured.outputs)}; "
            "`sevenbar analyze` shows what each circuit has"
        )
    residuals = sorted(((_residual(extents), index) for index, extents in tables.items()))
    best = residuals[0][1]
    return ExtremesComparison(
        linkage, ends, measured.source, motion.speed, best, tables[best], tuple((i, m) for m, i in residuals)
    )


def _extents(circuit: Circuit, measured: MeasuredExtremes, ends: Ends) -> tuple[Extent, ...] | None:
    result = []
    for quantity in measured.outputs:
        extremes = getattr(circuit, quantity)
        if extremes is None:
            return None
        values = extremes.lowest, extremes.highest
        m = measured.values[quantity]
        if quantity == "angle" and not ends.output_slides:
            turn = math.tau * round((sum(m) - sum(values)) / 2 / math.tau)
            values = values[0] + turn, values[1] + turn
        result.append(Extent(quantity, values, m))
    return tuple(result)


def _residual(extents: Sequence[Extent]) -> float:
    squares = [
        ((m - c) / ((e.measured[1] - e.measured[0]) or 1.0)) ** 2
        for e in extents
        for c, m in zip(e.computed, e.measured, strict=True)
    ]
    return math.sqrt(sum(squares) / len(squares))
