"""What is left of rounding where forces balance: 0, as the answer is."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats

#: Below this part of what acts an answer is rounding.
ROUNDING = 1e-12


def heard(value: float, of: float) -> float:
    """A value, 0 where it is rounding of what it is made of.

    >>> heard(-3e-17, 2.0), heard(-3e-11, 2.0)
    (0.0, -3e-11)
    """
    return 0.0 if abs(value) <= ROUNDING * abs(of) else value


def without_rounding(rows: Floats, of: float) -> Floats:
    """Rows (n, ..), each column that is rounding on all rows 0; NaN stays."""
    known = np.where(np.isfinite(rows), np.abs(rows), 0.0)
    return np.asarray(
        np.where(
            known.max(axis=0, initial=0.0) <= ROUNDING * of, np.where(np.isfinite(rows), 0.0, rows), rows
        )
    )
