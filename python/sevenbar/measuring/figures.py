"""Figures of measured and computed values: curves, and below them the differences alone."""

from __future__ import annotations

from collections.abc import Mapping
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
MEASURED: dict[str, Any] = {
    "color": OTHER,
    "ls": "",
    "marker": "o",
    "mfc": "none",
    "mew": 0.9,
    "zorder": 3,
}

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


def comparison_figure(comparison: Comparison) -> Figure:
    """The computed curve with the measured points, and their differences, a column for each quantity."""
    ends = comparison.ends
    with styled():
        figure, grid = _grid(len(comparison.outputs), (3.0, 1.4))
        for column, quantity in enumerate(comparison.outputs):
            x = shown(ends, "input", comparison.input)
            top, below = grid[:, column]
            curve = shown(ends, quantity, comparison.curve[quantity])
            top.plot(
                shown(ends, "input", comparison.curve["input"]), curve, label=say("computed"), **COMPUTED
            )
            _points(top, x, shown(ends, quantity, comparison.measured[quantity]), say("measured"))
            _points(below, x, shown(ends, quantity, comparison.difference(quantity)))
            _labels(grid[:, column], ends, quantity, [say("measured minus\ncomputed")])
        name = short(comparison.linkage.heading, 60)
        what = say("circuit {number} and measured values", number=comparison.chosen.circuit)
        title = f"{name}\n{what}"
        _finish(figure, grid, title)
    return figure


def calibration_figure(calibration: Calibration) -> Figure:
    """Measured points on the calibrated and the nominal curve; below, the differences before and after."""
    ends = calibration.ends
    with styled():
        figure, grid = _grid(len(calibration.outputs), (3.0, 1.2, 1.2))
        x = shown(ends, "input", calibration.input)
        order = np.lexsort([x, calibration.stretch])
        # no line from one pass to another
        ends_of_stretches = np.flatnonzero(np.diff(calibration.stretch[order])) + 1
        for column, quantity in enumerate(calibration.outputs):
            top, before, after = grid[:, column]
            sides: Mapping[str, Mapping[str, Floats]] = {
                "nominal": calibration.nominal,
                "calibrated": calibration.computed,
            }
            for name, look in (("nominal", NOMINAL), ("calibrated", COMPUTED)):
                values = shown(ends, quantity, sides[name][quantity])
                line = (np.insert(v[order], ends_of_stretches, np.nan) for v in (x, values))
                top.plot(*line, label=say(name), **look)
            measured = shown(ends, quantity, calibration.measured[quantity])
            _points(top, x, measured, say("measured"))
            for axes, name in ((before, "nominal"), (after, "calibrated")):
                _points(axes, x, measured - shown(ends, quantity, sides[name][quantity]))
            _labels(
                grid[:, column],
                ends,
                quantity,
                [say("measured minus\nnominal"), say("measured minus\ncalibrated")],
            )
        _finish(
            figure, grid, f"{short(calibration.linkage.heading, 60)}\n{say('before and after calibration')}"
        )
    return figure


def _grid(columns: int, heights: tuple[float, ...]) -> tuple[Figure, Any]:
    figure = page_figure(WIDE if columns == 1 else NARROW * columns, TALL, pads=(0.04, 0.06))
    grid = figure.subplots(
        len(heights), columns, sharex=True, squeeze=False, gridspec_kw={"height_ratios": heights}
    )
    return figure, grid


def _points(axes: Axes, x: Floats, y: Floats, label: str = "") -> None:
    """Measured values, or without a label differences."""
    axes.plot(x, y, ms=SMALL if len(x) > MANY else LARGE, label=label, **MEASURED)
    if not label:
        axes.axhline(0.0, color="#505050", lw=0.8, zorder=1)


def _labels(column: Any, ends: Ends, quantity: str, differences: list[str]) -> None:
    top, *below = column
    name = ends.word(quantity)
    # with several columns the quantity must stand at each
    top.set_ylabel(quantity_label(ends.output, name, unit(ends, quantity)))
    for axes, text in zip(below, differences, strict=True):
        axes.set_ylabel(f"{text} [{unit(ends, quantity)}]")
        axes.yaxis.set_major_locator(MaxNLocator(4))
    below[-1].set_xlabel(quantity_label(ends.input, ends.word("input"), unit(ends, "input")))
    for axes in column:
        axes.grid(lw=0.6)
        if ends.turns("input"):
            axes.xaxis.set_major_locator(DegreeLocator(9))


def _finish(figure: Figure, grid: Any, title: str) -> None:
    figure.align_ylabels()
    headline(figure, title)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(handles), frameon=False)
