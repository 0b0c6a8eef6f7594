"""Quantiles of errors: each is an error that occurred."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

#: The shares of the errors that are reported, by their names on the page.
SHARES = {"median": 0.5, "90 %": 0.9, "99 %": 0.99, "greatest": 1.0}

#: Half the distance of 1 to the next double: what one rounding may come to.
ROUNDING = 2.0**-53

#: What is compared, by the order of the derivative by time.
QUANTITIES = ("position", "velocity", "acceleration", "jerk")


def quantiles(errors: Sequence[float] | np.ndarray) -> dict[str, float]:
    """The errors (n,) below which the shares lie, by name.

    The least error that is no smaller than the share of all, so that with few errors no number is made up.
    Raises `ValueError` where there is none, or one is no number.

        >>> quantiles([4.0, 1.0, 3.0, 2.0])["median"]
        2.0
    """
    values = np.asarray(errors, dtype=np.float64)
    if values.size == 0:
        raise ValueError("errors: none to take quantiles of")
    if not np.isfinite(values).all():
        raise ValueError(f"errors[{int(np.flatnonzero(~np.isfinite(values))[0])}]: not a finite number")
    found = np.quantile(values, list(SHARES.values()), method="inverted_cdf")
    return dict(zip(SHARES, map(float, found), strict=True))


@dataclass(frozen=True)
class Row:
    """One row that was compared: where it is, and its errors.

    `input` [rad, or length], `condition` as the circuit has it, `errors` of position, velocity,
    acceleration and jerk, by what they are of ("joints", "points"); `apart` how far the next dead centre of
    the input is, in the input's unit (infinite where there is none).
    """

    linkage: str
    circuit: int
    input: float
    condition: float
    apart: float
    errors: Mapping[str, Sequence[float]]


def summary(rows: Sequence[Row], what: str) -> dict[str, dict[str, object]]:
    """For each quantity: errors, the same in roundings (eps x condition), and the worst row."""
    chosen = [row for row in rows if what in row.errors]
    found: dict[str, dict[str, object]] = {}
    for order, quantity in enumerate(QUANTITIES):
        errors = np.array([row.errors[what][order] for row in chosen])
        units = np.array([row.condition * ROUNDING for row in chosen])
        worst = chosen[int(errors.argmax())]
        found[quantity] = {
            "rows": len(chosen),
            "errors": quantiles(errors),
            "roundings": quantiles(errors / units),
            "worst": {
                "circuit": worst.circuit,
                "input": worst.input,
                "condition": worst.condition,
                "error": worst.errors[what][order],
            },
        }
    return found
