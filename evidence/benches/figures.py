"""The plots of the page, in the style of Sevenbar's own figures."""

from __future__ import annotations

import math
from pathlib import Path

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from evidence.benches.outcome import Plot
from sevenbar.drawing.figure import new_figure, save
from sevenbar.drawing.style import CIRCUIT_COLOURS, STYLE

#: Width and height [inch].
SIZE = (6.4, 3.6)

#: Names of curves beside each other above a plot.
LEGEND_COLUMNS = 3

#: Ends of an axis further apart than this many times make it logarithmic.
WIDE = 12.0

#: A logarithmic axis that is shorter than this many times has numbers between the powers of ten.
FEW = 500.0

YARDSTICK_COLOUR = "#555555"

#: Strokes of yardsticks, told apart where there are several.
YARDSTICK_STROKES = ((0, (5, 2)), (0, (1.2, 1.6)), (0, (6, 2, 1.2, 2)))

MARKS = "osD^vP"


def drawn(plot: Plot, folder: Path) -> Path:
    """Writes a plot as SVG; returns its path."""
    with rc_context(STYLE):
        figure = new_figure(*SIZE)
        legend_rows = math.ceil(len(plot.series) / LEGEND_COLUMNS)
        axes = figure.add_axes((0.12, 0.135, 0.85, 0.77 - 0.06 * legend_rows))
        axes.set_title(plot.title, fontsize=10, loc="left", pad=7 + 15 * legend_rows)
        axes.grid(visible=True)
        axes.set_axisbelow(True)
        measured = [series for series in plot.series if not series.yardstick]
        for number, series in enumerate(measured):
            colour = CIRCUIT_COLOURS[number % len(CIRCUIT_COLOURS)]
            mark = MARKS[number % len(MARKS)]
            axes.plot(
                series.x,
                series.y,
                marker=mark,
                markersize=4.5,
                color=colour,
                linewidth=1.4,
                label=series.label,
            )
        yardsticks = [series for series in plot.series if series.yardstick]
        for number, series in enumerate(yardsticks):
            stroke = YARDSTICK_STROKES[number % len(YARDSTICK_STROKES)]
            axes.plot(
                series.x,
                series.y,
                color=YARDSTICK_COLOUR,
                linestyle=stroke,
                linewidth=1.2,
                label=series.label,
            )
        axes.set_xlabel(plot.x_label)
        axes.set_ylabel(plot.y_label)
        _scaled(axes, plot)
        # above the plot, where it hides no mark
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0, 1.0),
            ncols=LEGEND_COLUMNS,
            frameon=False,
            fontsize=8,
            borderaxespad=0.2,
            borderpad=0.2,
            handlelength=1.8,
            columnspacing=1.4,
        )
        return save(figure, folder / f"{plot.name}.svg")


def _scaled(axes: Axes, plot: Plot) -> None:
    """Logarithmic axes where values lie far apart, else from zero on; numbers as people write them."""
    for axis, values in (
        (axes.xaxis, [x for series in plot.series for x in series.x]),
        (axes.yaxis, [y for series in plot.series for y in series.y]),
    ):
        name = "x" if axis is axes.xaxis else "y"
        if min(values) > 0 and max(values) > WIDE * min(values):
            axes.set(**{f"{name}scale": "log"})
            if max(values) < FEW * min(values):
                axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: written(value)))
            axis.set_minor_formatter(NullFormatter())
            continue
        if name == "y":
            axes.set_ylim(bottom=0)
        if all(value == int(value) for value in values) and len(set(values)) < 12:
            axis.set_ticks(sorted(set(values)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: written(value)))


def written(value: float) -> str:
    """A number on an axis: 0.01, 10, 10,000, 1e-8."""
    if value != 0 and (abs(value) < 1e-3 or abs(value) >= 1e7):
        return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{value:,g}" if abs(value) < 1e3 else f"{value:,.0f}"
