"""Rows that lie far from all others: a slip of a hand or of a sensor, named with their lines.

A row counts as far off if its difference is more than `FAR` times the median of all. Where many differences
are of one kind, as those of wrong dimensions are, none is: they follow the curve, and its steepest part is no
slip. So near a dead centre of the input, where the output is steep, the difference counts as one of the
input.

Source: the least sum of absolute differences by reweighted least squares; Beaton and Tukey, "The fitting of
power series", Technometrics 16 (1974).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.measuring.measured import Ends

#: Times the median difference beyond which a row is far off; of normal noise one in 1e40 is.
FAR = 20.0

#: Share of the measured range that is rounding: differences below it are none.
EXACT = 1e-10

#: Share of the rows that may be slips; more of them have a cause in common.
FEW = 0.1

#: Rows that one message names.
MOST_NAMED = 5

#: Times the median residual that no row exceeds where there is no need to look closer: a row that is far off
#: draws at most half of the curve to itself.
PLAIN = 6.0

#: Steps of the fit by absolute differences, and the smallest weight's difference relative to the median.
STEPS, LEAST = 30, 1e-3


def far_off(differences: Floats, slopes: Floats, extent: float) -> list[int]:
    """The rows whose differences (n,) are far from the others', the farthest first.

    `slopes` (n,) are the derivatives of the curve by the input, `extent` is the measured range.
    """
    known = np.flatnonzero(np.isfinite(differences))
    if known.size < 4:
        return []
    size = np.abs(differences[known] - np.median(differences[known]))
    floor = EXACT * extent
    far = (size > FAR * np.median(size)) & (size > floor)
    steep = np.abs(slopes[known])
    if np.isfinite(steep).any():
        steep = np.where(np.isfinite(steep), steep, np.inf)
        gentle = np.maximum(steep, np.median(steep))
        by_input = np.divide(size, gentle, out=np.zeros_like(size), where=gentle > 0)
        far &= by_input > FAR * np.median(by_input)
    rows = known[far]
    if rows.size > max(1.0, FEW * known.size):
        return []
    return [int(row) for row in rows[np.argsort(-size[far], kind="stable")]]


def left_by_most(residual: Floats, jacobian: Floats) -> Floats:
    """What is left of a residual (n,) where most rows count and few that are far off do not.

    The least sum of absolute values over changes of the parameters, by their derivatives (n, k).
    """
    left = residual
    if not jacobian.shape[1] or np.abs(left).max() <= PLAIN * np.median(np.abs(left)):
        return left
    for _ in range(STEPS):
        middle = float(np.median(np.abs(left)))
        if middle == 0.0:
            break
        root = 1.0 / np.sqrt(np.maximum(np.abs(left), LEAST * middle))
        step = np.linalg.lstsq(jacobian * root[:, None], -residual * root, rcond=None)[0]
        left = residual + jacobian @ step
    return left


def first_of(lines: Sequence[int], most: int) -> str:
    """Lines of a file as a message names them: the first ones, and how many more there are."""
    more = f" and {len(lines) - most} more" if len(lines) > most else ""
    return ", ".join(map(str, lines[:most])) + more


def far_off_notes(
    ends: Ends,
    quantity: str,
    lines: Integers,
    source: str,
    differences: Floats,
    slopes: Floats,
    extent: float,
) -> list[str]:
    """A note on the rows (n,) of a quantity that are far off, if any, by their `lines` in the file."""
    rows = far_off(differences, slopes, extent)
    if not rows:
        return []
    word, unit = ends.word(quantity), ends.unit(quantity)
    middle = float(np.nanmedian(np.abs(differences - np.nanmedian(differences))))
    named = []
    for row in rows[:MOST_NAMED]:
        times = abs(float(differences[row])) / middle if middle > 0 else np.inf
        often = f"{times:,.0f} times the median" if times < 1e6 else "the others by almost nothing"
        named.append(f"line {lines[row]} by {differences[row]:.3g} {unit} ({often})")
    more = f", and {len(rows) - MOST_NAMED} more" if len(rows) > MOST_NAMED else ""
    listed = f"{', '.join(named)}{more}"
    return [f"the {word} is far off in {source}: {listed}; measure again there, or leave such rows out"]
