"""Figures of measured and computed values: curves, and below them the differences alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import headline, page_figure
from sevenbar.drawing.names import quantity_label, short
from sevenbar.drawing.style import COMPUTED as COMPUTED_COLOUR
from sevenbar.drawing.style import OTHER, styled
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.measuring.calibrate import Calibration
from sevenbar.measuring.compare import Comparison
from sevenbar.measuring.measured import Ends
from sevenbar.text.words import say

COMPUTED: dict[str, Any] = {"color": COMPUTED_COLOUR, "lw": 1.6, "zorder": 2}
NOMINAL: dict[str, Any] = {"color": "#8a8a8a", "lw": 1.3, "ls": (0, (4, 2)), "zorder": 1}
MEASURED: dict[str, Any] = {"color": OTHER, "ls": "", "marker": "o", "mfc": "none", "mew": 0.9, "zorder": 3}

#: A curve: input and values (n,) as they are drawn, its name in the key, and its look.
Drawn = tuple[Floats, Floats, str, dict[str, Any]]

#: Markers [points] of few rows and of many, and how many rows are many.
LARGE, SMALL, MANY = 4.2, 2.2, 120

#: Width of a column of panels and height of the figure [inch].
WIDE, NARROW, TALL = 6.4, 4.3, 6.2


def shown(ends: Ends, quantity: str, values: Floats) -> Floats:
    """Values of a quantity as they are drawn: positions that turn in degrees, all else as it is."""
    return np.degrees(values) if quantity in ("input", "angle") and ends.turns(quantity) else values


def unit(ends: Ends, quantity: str) -> str:
    """The unit of `shown` values."""
    return "deg" if quantity in ("input", "angle") and ends.turns(quantity) else ends.unit(quantity)


@styled()
def comparison_figure(comparison: Comparison) -> Figure:
    """The computed curve with the measured points, and their differences, a column for each quantity."""
    ends, curve = comparison.ends, comparison.curve

    def curves(quantity: str) -> list[Drawn]:
        x, values = (shown(ends, name, curve[name]) for name in ("input", quantity))
        return [(x, values, say("computed"), COMPUTED)]

    def differences(quantity: str) -> list[Floats]:
        return [shown(ends, quantity, comparison.difference(quantity))]

    what = say("circuit {number} and measured values", number=comparison.chosen.circuit)
    below = {say("measured minus\ncomputed"): 1.4}
    return _figure(comparison, what, curves, below, differences)


@styled()
def calibration_figure(calibration: Calibration) -> Figure:
    """Measured points on the calibrated and the nominal curve; below, the differences before and after."""
    ends, sides = calibration.ends, (calibration.nominal, calibration.computed)
    x = shown(ends, "input", calibration.input)
    order = np.lexsort([x, calibration.stretch])
    ends_of_stretches = np.flatnonzero(np.diff(calibration.stretch[order])) + 1

    def parted(values: Floats) -> Floats:
        # no line from one pass to another
        return np.insert(values[order], ends_of_stretches, np.nan)

    def curves(quantity: str) -> list[Drawn]:
        before, after = (shown(ends, quantity, side[quantity]) for side in sides)
        return [
            (parted(x), parted(before), say("nominal"), NOMINAL),
            (parted(x), parted(after), say("calibrated"), COMPUTED),
        ]

    def differences(quantity: str) -> list[Floats]:
        measured = shown(ends, quantity, calibration.measured[quantity])
        return [measured - shown(ends, quantity, side[quantity]) for side in sides]

    below = {say("measured minus\nnominal"): 1.2, say("measured minus\ncalibrated"): 1.2}
    return _figure(calibration, say("before and after calibration"), curves, below, differences)


def _figure(
    result: Comparison | Calibration,
    what: str,
    curves: Callable[[str], list[Drawn]],
    below: Mapping[str, float],
    differences: Callable[[str], list[Floats]],
) -> Figure:
    """Curves with measured points, and differences in panels `below`: their heights by their labels."""
    ends, columns = result.ends, len(result.outputs)
    figure = page_figure(WIDE if columns == 1 else NARROW * columns, TALL, pads=(0.04, 0.06))
    heights = {"height_ratios": (3.0, *below.values())}
    grid = figure.subplots(1 + len(below), columns, sharex=True, squeeze=False, gridspec_kw=heights)
    x = shown(ends, "input", result.input)
    for quantity, column in zip(result.outputs, grid.T, strict=True):
        top, *panels = column
        for across, values, label, look in curves(quantity):
            top.plot(across, values, label=label, **look)
        _points(top, x, shown(ends, quantity, result.measured[quantity]), say("measured"))
        own = unit(ends, quantity)
        # with several columns the quantity must stand at each
        top.set_ylabel(quantity_label(ends.output, ends.word(quantity), own))
        for axes, label, apart in zip(panels, below, differences(quantity), strict=True):
            _points(axes, x, apart)
            axes.set_ylabel(f"{label} [{own}]")
            axes.yaxis.set_major_locator(MaxNLocator(4))
        panels[-1].set_xlabel(quantity_label(ends.input, ends.word("input"), unit(ends, "input")))
        for axes in column:
            axes.grid(lw=0.6)
            if ends.turns("input"):
                axes.xaxis.set_major_locator(DegreeLocator(9))
    figure.align_ylabels()
    headline(figure, f"{short(result.linkage.heading, 60)}\n{what}")
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(handles), frameon=False)
    return figure


def _points(axes: Axes, x: Floats, y: Floats, label: str = "") -> None:
    """Measured values, or without a label differences."""
    axes.plot(x, y, ms=SMALL if len(x) > MANY else LARGE, label=label, **MEASURED)
    if not label:
        axes.axhline(0.0, color="#505050", lw=0.8, zorder=1)
