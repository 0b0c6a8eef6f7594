"""Figures of tolerances: which dimension matters most, and how far the output may deviate along the cycle."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sevenbar.arrays import Floats, Integers
from sevenbar.design.tolerance.linear import Linear
from sevenbar.design.tolerance.samples import MonteCarlo
from sevenbar.drawing.figure import headline, key_below, page_figure, tidy
from sevenbar.drawing.names import quantity_label, short
from sevenbar.drawing.space import measuring
from sevenbar.drawing.style import COMPUTED, OTHER, letters, styled
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.text.words import say

#: Bars beyond the first so many share one, and their height [inch] for letters of 9 points.
MOST_BARS, BAR = 14, 0.28

LINEAR, EXACT, BAND = COMPUTED, OTHER, "#e2dff2"


def shares_figure(linear: Linear) -> Figure:
    """The share of each dimension's tolerance in the variance over the cycle, the greatest above."""
    effects = list(linear.effects)
    labels = [f"{short(e.dimension.name, 24)} ± {e.width:.4g} {e.dimension.unit}".rstrip() for e in effects]
    shares = [100 * effect.share for effect in effects]
    if len(effects) > MOST_BARS:
        rest = len(effects) - MOST_BARS + 1
        labels = [*labels[: MOST_BARS - 1], say("{count} others together", count=rest)]
        shares = [*shares[: MOST_BARS - 1], sum(shares[MOST_BARS - 1 :])]
    with styled():
        figure = page_figure(6.4, 1.0, pads=(0.06, 0.06))
        figure.set_figheight((1.5 + BAR * len(labels)) * letters() / 9.0)
        axes = figure.subplots()
        axes.barh(range(len(labels)), shares, color=LINEAR, height=0.62)
        axes.set_yticks(range(len(labels)), labels)
        axes.invert_yaxis()
        for place, share in enumerate(shares):
            axes.annotate(f"{share:.1f} %", (share, place), (3, 0), textcoords="offset points", va="center")
        axes.set_xlim(0, 1.14 * max([*shares, 1e-9]))
        axes.set_xlabel(say("share in the variance over the cycle, {output} [%]", output=linear.words))
        label = axes.xaxis.label
        if label.get_window_extent(measuring(figure)).width > 0.7 * figure.bbox.width:
            label.set_text(label.get_text().replace(", ", ",\n", 1))
        axes.grid(axis="x", lw=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        headline(figure, f"{short(linear.found.linkage.heading, 60)}\n{say('which tolerance matters most')}")
    return figure


def deviation_figure(linear: Linear, exact: MonteCarlo | None) -> Figure:
    """How far the output may deviate along the cycle: worst case, 3 sigma, and what samples do."""
    passes = _passes(linear)
    with styled():
        figure = page_figure(6.4 if len(passes) == 1 else 8.4, 4.6, pads=(0.04, 0.06))
        grid = figure.subplots(1, len(passes), sharey=True, squeeze=False)[0]
        result = linear.found
        what, unit = ("angle", "deg") if result.input_turns else ("position", result.linkage.length_unit)
        label = quantity_label(result.input_name, what, unit)
        for axes, (name, rows) in zip(grid, passes, strict=True):
            _band(axes, linear, exact, rows)
            axes.set_xlabel(label)
            axes.grid(lw=0.6)
            axes.set_axisbelow(True)
            axes.margins(x=0)
            if result.input_turns:
                axes.xaxis.set_major_locator(DegreeLocator(9))
            if name:
                axes.set_title(name, fontsize=letters())
        grid[0].set_ylabel(say("deviation, {output} [{unit}]", output=linear.words, unit=linear.shown_unit))
        key_below(figure, grid[0].get_legend_handles_labels()[0])
        what = say("what the tolerances do, circuit {number}", number=linear.found.circuit.index)
        headline(figure, f"{short(linear.found.linkage.heading, 60)}\n{what}")
        tidy(figure)
    return figure


def _passes(linear: Linear) -> list[tuple[str, Integers]]:
    """Each pass of the circuit with its rows' places, in the order of the circuit."""
    branch = linear.found.circuit.branch[linear.rows]
    numbers = np.unique(branch)
    if len(numbers) == 1:
        return [("", np.arange(len(branch)))]
    return [(say("branch {number}", number=number), np.flatnonzero(branch == number)) for number in numbers]


def _band(axes: Axes, linear: Linear, exact: MonteCarlo | None, rows: Integers) -> None:
    result = linear.found
    x = linear.input[rows]
    order = np.argsort(x, kind="stable")
    rows, x = rows[order], x[order]
    # a circuit that goes round ends where it began
    round_ = result.circuit.goes_round and len(linear.rows) == len(linear.status)
    if round_ and result.circuit.turns:
        rows, x = np.append(rows, rows[0]), np.append(x, x[0] + 2 * np.pi * abs(result.circuit.turns))
    # rows that are left out leave a gap
    gaps = (
        np.flatnonzero(np.diff(x) > 1.5 * np.median(np.diff(x))) + 1
        if len(x) > 2
        else np.array([], dtype=int)
    )

    def shown(values: Floats) -> Floats:
        return np.insert(linear.shown(values)[rows], gaps, np.nan)

    turns = result.input_turns
    places = np.insert(np.degrees(x) if turns else x, gaps, np.nan)
    worst, sigma = shown(linear.worst), shown(3 * linear.deviation)
    axes.fill_between(places, -worst, worst, color=BAND, lw=0, label=say("linear, worst case"))
    axes.plot(places, sigma, color=LINEAR, lw=1.5, label=say("linear, 3 standard deviations"))
    axes.plot(places, -sigma, color=LINEAR, lw=1.5)
    if exact is not None:
        between = (
            (0, 4, (0, (4, 2)), say("Monte Carlo, 99.73 % between")),
            (1, 3, (0, (1.2, 1.2)), say("Monte Carlo, 95 % between")),
        )
        for low, high, dashes, label in between:
            axes.plot(places, shown(exact.quantiles[low]), color=EXACT, lw=1.2, ls=dashes, label=label)
            axes.plot(places, shown(exact.quantiles[high]), color=EXACT, lw=1.2, ls=dashes)
        axes.plot(places, shown(exact.quantiles[2]), color=EXACT, lw=1.0, label=say("Monte Carlo, median"))
    axes.axhline(0.0, color="#505050", lw=0.6, zorder=1)
