"""How power closes along a cycle: a check of torque, loads and energies against each other.

Source: docs/theory_forces.md, (7).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from sevenbar.arrays import Floats
from sevenbar.curves.curve import mean
from sevenbar.curves.cycle_series import ENOUGH, CycleSeries
from sevenbar.curves.pieces import smooth_pieces
from sevenbar.curves.stationary import nodes
from sevenbar.forces.heard import ROUNDING


class Closing(NamedTuple):
    """What is left of `total - dE/dx` at most, and of the mean of `total`, as parts of the peak."""

    power: float
    work: float


#: Energy, what the drive gives and what loads supply, (3, n).
Given = Floats


def closing(
    rows: Given,
    rate: float,
    *,
    pull: float,
    first: float,
    period: float,
    evaluate: Callable[[Floats], Given] | None = None,
) -> Closing:
    """How well what is given over a cycle is the slope of the energy by the input x.

    Rows are the energy E [J], the power of the drive and of the loads [W] at a constant `rate` of the input;
    at rest the torque in place of the power, and 1. A slope of less than rounding of the greatest energy, and
    of the `pull` of what acts, is none. Where the rows are too few, `evaluate` gives the same at any inputs
    (m,), and the slope is that of pieces.
    """
    energy, total = _energy_and_total(rows, rate)
    slope = CycleSeries(energy, first, period).finer(1, 1)
    drive = float(np.abs(rows[1]).max()) / abs(rate)
    least = ROUNDING * (pull + float(np.abs(energy).max()))
    if max(float(np.abs(slope).max()), drive) <= least:
        return Closing(0.0, 0.0)
    result = _closing(slope, total, drive, float(np.mean(total)))
    if evaluate is None or max(result) <= ENOUGH:
        return result
    both = np.stack([energy, total], axis=1)
    # the slope is as large as what is given
    units = np.array([np.abs(energy).max(), max(np.abs(total).max(), np.abs(slope).max())])
    units[units == 0] = 1.0

    def between(inputs: Floats) -> Floats:
        return np.asarray(np.stack(_energy_and_total(evaluate(inputs), rate), axis=1) / units)

    own = smooth_pieces(between, both / units, first, period)
    if own.tail > result.power:
        return result
    slopes = own.along.slope.series[:, :, 0] / period
    given = units[1] * _values(own.along.series[:, :, 1])
    finer = _closing(units[0] * _values(slopes), given, drive, units[1] * mean(own.part(1)))
    return Closing(min(result.power, finer.power), min(result.work, finer.work))


def _energy_and_total(rows: Given, rate: float) -> tuple[Floats, Floats]:
    energy, drive, supplied = rows
    return energy, (drive + supplied) / rate


def _closing(slope: Floats, total: Floats, drive: float, gained: float) -> Closing:
    peak = max(float(np.abs(slope).max()), drive)
    left = float(np.abs(total - slope).max())
    return Closing(left / peak if peak else 0.0, abs(gained) / drive if drive else 0.0)


def _values(series: Floats) -> Floats:
    """Series (pieces, terms) at the nodes of the pieces."""
    return np.asarray(chebyshev.chebval(nodes(), series.T))
