"""Tolerances from a wanted error: those by which every dimension has the same greatest effect.

Source: docs/theory_design.md, (9).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sevenbar.arrays import is_number
from sevenbar.design.tolerance.linear import Linear, linear_estimate
from sevenbar.design.tolerance.sensitivities import Sensitivities, sensitivities
from sevenbar.design.tolerance.tolerances import Tolerances
from sevenbar.errors import RequestError, check_word, shown
from sevenbar.kinematics.linkage import Linkage

#: By which sum the wanted error is met.
SUMS = ("worst", "statistical")

#: An effect of a small change relative to the greatest one that is none: such a dimension is left out.
NO_EFFECT = 1e-9

#: Rounds in which rows that the tolerances found bring too near to a dead centre are left out; twelve were
#: seen among 3,600 rows.
MOST_ROUNDS = 64

#: Change of tolerances from round to round, in parts, that is none.
SETTLED = 1e-12


def tolerances_for(
    of: Linkage | Sensitivities,
    wanted: float,
    *,
    names: Sequence[str] = ("*",),
    sum: str = "worst",
    distribution: str = "normal",
    output: str | None = None,
    quantity: str = "position",
) -> Linear:
    """Tolerances of equal effect by which an output is off by `wanted` at most, and their linear estimate.

    `wanted` is in the output's unit (rad for an angle). Each tolerance is inverse to the greatest sensitivity
    along the cycle of the dimensions that `names` (or patterns) choose, and all are scaled such that the
    greatest error along the cycle is `wanted`: "worst" the worst case, "statistical" three standard
    deviations of normal errors. Dimensions without an effect get none. Raises `RequestError` for a wanted
    error that is not greater than 0, and for arguments that do not fit.

        >>> import sevenbar as sb
        >>> found = tolerances_for(sb.load("rssr"), 0.001, names=["L*"])
        >>> round(float(found.worst.max()), 12)
        0.001
    """
    if not (is_number(wanted) and math.isfinite(wanted) and wanted > 0):
        raise RequestError(f"wanted: {shown(wanted)} is not an error; give one greater than 0")
    check_word("sum", sum, SUMS)
    result = of if isinstance(of, Sensitivities) else sensitivities(of)

    def estimate(chosen: Tolerances) -> Linear:
        return linear_estimate(result, chosen, distribution=distribution, output=output, quantity=quantity)

    chosen = result.tolerances(dict.fromkeys(names, 1.0))
    widths = np.where(chosen.widths > 0, result.small, 0.0)
    for _ in range(MOST_ROUNDS):
        linear = estimate(replace(chosen, widths=widths))
        effects = np.abs(linear.slopes).max(axis=0)
        small = effects * result.small
        matters = small > NO_EFFECT * small.max()
        if not matters.any():
            raise RequestError(
                "tolerance: none of these dimensions has an effect on the output; choose others"
            )
        equal = np.divide(1.0, effects, out=np.zeros(len(effects)), where=matters)
        terms = np.abs(linear.slopes) * equal
        error = terms.sum(axis=1) if sum == "worst" else np.sqrt((terms**2).sum(axis=1))
        last, widths = widths, equal * wanted / error.max()
        if np.allclose(last, widths, rtol=SETTLED, atol=0.0):
            break
    else:
        raise RequestError(
            f"wanted: for {wanted:g} the rows clear of dead centres do not settle; give a smaller error"
        )
    sources = tuple("equal effect" if width > 0 else "" for width in widths)
    return estimate(replace(chosen, widths=widths, sources=sources))
