"""Figures of points: rates over a cycle and poles in the link; a path on its curve; torque and forces."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.design.points.cycle import Cycle
from sevenbar.design.points.inertia import Inertia
from sevenbar.design.points.least import ZERO, LeastPoint
from sevenbar.design.points.nearest import NearestPath
from sevenbar.design.points.poles import AccelerationPoles
from sevenbar.drawing.asked import asked_view
from sevenbar.drawing.figure import fit_letters, headline, input_label, page_figure, shown_value, slides
from sevenbar.drawing.names import short
from sevenbar.drawing.page import place_picture, write_title_over_panels
from sevenbar.drawing.space import measuring
from sevenbar.drawing.style import CIRCUIT_COLOURS, COMPUTED, LINE_STYLES, OTHER, letters, styled
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.drawing.view import view_of
from sevenbar.text.words import say

#: The point found, and what it is compared with.
FOUND, BOUND = COMPUTED, "#8a8a8a"

#: Poles farther from the box than this part of its longest side are not drawn.
FARTHEST = 0.75

#: Most points of the file, or masses, with a line of their own: more cannot be distinguished.
MOST_LINES = 6


def least_figure(result: LeastPoint, poles: AccelerationPoles, name: str) -> Figure:
    """The rate over the cycle of the file's points and of the new one, and the poles' path in the link."""
    cycle, linkage = result.cycle, result.cycle.motion.linkage
    with styled():
        figure = page_figure(11.0, 5.0)
        rms = result.measure == "rms"
        what = {"link": result.link, "number": cycle.circuit.index, "quantity": say(result.of)}
        which = (
            say("link {link}, circuit {number}: least root mean square {quantity}", **what)
            if rms
            else say("link {link}, circuit {number}: least greatest {quantity}", **what)
        )
        heads, top = write_title_over_panels(figure, f"{short(linkage.heading, 60)}\n{which}")
        axes = figure.add_axes((0.065, 0.12, 0.44, top - 0.12))
        across = shown_value(cycle.motion, cycle.motion.input, cycle.rates.input)
        for i, point in enumerate(result.before[:MOST_LINES]):
            look: dict[str, Any] = {"color": _other(i), "ls": LINE_STYLES[1 + i % 3], "lw": 1.4}
            sizes = cycle.sizes(result.of, np.array(point.at))
            axes.plot(across, sizes, label=short(point.name, 24), **look)
        sizes = cycle.sizes(result.of, result.at)
        axes.plot(across, sizes, color=FOUND, lw=1.8, label=short(name, 24))
        bound = say("least root mean square") if rms else say("lower bound of the greatest")
        axes.axhline(result.value, color=BOUND, lw=1.0, ls=(0, (4, 2)), label=bound)
        if len(result.inputs):
            marks = shown_value(cycle.motion, cycle.motion.input, result.inputs)
            axes.plot(marks, np.full(len(marks), result.value), "o", color=FOUND, mfc="white", ms=5)
        _input_axis(axes, cycle, across)
        # a point that stands still is at the foot of what others of the box have
        axes.set_ylim(0, None if result.value > ZERO * result.scale else result.scale)
        axes.set_ylabel(f"{say(result.of)} [{result.unit.replace('^2', '²').replace('^3', '³')}]")
        _head_of_panel(figure, 0.285, heads, "(a) " + say("over the cycle"), 0.44)
        axes.legend(frameon=False, fontsize=letters() - 0.5)
        _poles_in_the_link(figure, result, poles, name, heads)
    return figure


def _poles_in_the_link(
    figure: Figure, result: LeastPoint, poles: AccelerationPoles, name: str, heads: float
) -> None:
    low, high = result.low, result.high
    corners = np.array(list(product(*zip(low, high, strict=True))))
    away = np.maximum(low - poles.at, poles.at - high).max(axis=1)
    near = away <= FARTHEST * float((high - low).max())
    path = np.where(near[:, None], poles.at, np.nan)
    points = np.array([point.at for point in result.before[:MOST_LINES]]).reshape(-1, 3)
    shown = [corners, points[np.isfinite(points).all(axis=1)], path[near]]
    places = np.concatenate(shown)
    linkage = result.cycle.motion.linkage
    width, height = figure.get_size_inches()
    room = (0.54 * width, 0.55, 0.46 * width, heads * height - 0.55)
    # the plane of the linkage is not that of places in a link
    asked = asked_view()
    view = view_of("space" if asked in (None, "plane") else asked, linkage, places)
    space = place_picture(figure, places, room, linkage.length_unit, view, letters="uvw")
    axes: Any = space.axes
    for a, b in product(corners, corners):
        if (a <= b).all() and np.count_nonzero(a != b) == 1:
            axes.plot(*np.stack([a, b]).T, color="#b8b8b8", lw=0.8)
    if near.any():
        single = (poles.status[near] == "pole").any()
        label = say("acceleration poles") if single else say("points of least acceleration")
        axes.plot(*_closed(path, result.cycle).T, color=CIRCUIT_COLOURS[2], lw=1.3, label=label)
    for i, point in enumerate(result.before[:MOST_LINES]):
        axes.plot(*np.array([point.at]).T, "s", color=_other(i), ms=5, label=short(point.name, 24))
    axes.plot(*result.at[:, None], "o", color=FOUND, ms=6, label=short(name, 24))
    where = say("in the link: the box")
    if not near.any():
        where = say("in the link: the box; no pole near the box")
    elif not near.all():
        counts = {"count": np.count_nonzero(near), "all": len(near)}
        where = say("in the link: the box; {count} of {all} poles near the box", **counts)
    middle = (room[0] + room[2] / 2) / width
    _head_of_panel(figure, middle, heads, f"(b) {where}", 0.45)
    _legend_below(figure, axes, middle, 3)


def nearest_figure(result: NearestPath, name: str) -> Figure:
    """The path of the point in space on the wanted places, and the distance of each from it."""
    cycle, linkage = result.cycle, result.cycle.motion.linkage
    with styled():
        figure = page_figure(10.6, 4.9)
        path = cycle.rates.of("position", result.at)
        both = np.concatenate([path, result.wanted])
        width, height = figure.get_size_inches()
        view = view_of(None, linkage, both)
        which = say(
            "link {link}, circuit {number}: path nearest the curve, rms {rms:.4g} {unit}",
            link=result.link, number=cycle.circuit.index, rms=result.rms, unit=linkage.length_unit,
        )  # fmt: skip
        heads, top = write_title_over_panels(figure, f"{short(linkage.heading, 60)}\n{which}")
        room = (0.1, 0.3, 0.5 * width - 0.1, top * height - 0.3)
        space = place_picture(figure, both, room, linkage.length_unit, view)
        space.line(
            _closed(path, cycle), color=FOUND, lw=1.4, label=say("path of {name}", name=short(name, 24))
        )
        space.line(result.wanted, ls="", marker="o", color=OTHER, mfc="none", ms=4, label=say("wanted"))
        _legend_below(figure, space.axes, 0.27, 2)
        where = "(a) " + (say("in its plane") if view.flat else say("in space"))
        _head_of_panel(figure, 0.27, heads, where, 0.5)
        below = figure.add_axes((0.59, 0.12, 0.39, top - 0.12))
        below.plot(np.arange(1, len(result.distances) + 1), result.distances, "o-", color=FOUND, ms=3, lw=1.0)
        below.grid(lw=0.6)
        below.set_ylim(bottom=0)
        below.xaxis.set_major_locator(MaxNLocator(integer=True))
        below.set_xlabel(say("wanted place"))
        below.set_ylabel(say("distance [{unit}]", unit=linkage.length_unit))
        _head_of_panel(figure, 0.785, heads, "(b) " + say("distance of the path from it"), 0.39)
    return figure


def inertia_figure(result: Inertia) -> Figure:
    """The torque of the input over the cycle, and the sizes of the inertia forces."""
    cycle, linkage = result.cycle, result.cycle.motion.linkage
    with styled():
        figure = page_figure(7.0, 6.6, pads=(0.05, 0.06))
        torque, force = figure.subplots(2, 1, sharex=True)
        across = shown_value(cycle.motion, cycle.motion.input, result.input)
        torque.axhline(0, color=BOUND, lw=0.8)
        torque.plot(across, result.torque, color=FOUND, lw=1.7)
        torque.fill_between(across, result.torque, color=FOUND, alpha=0.15, lw=0)
        what = (
            say("input force [{unit}]", unit=result.unit)
            if result.slides
            else say("input torque [{unit}]", unit=result.unit)
        )
        torque.set_ylabel(what)
        torque.grid(lw=0.6)
        for i, (mass, sizes) in enumerate(zip(result.masses[:MOST_LINES], result.sizes, strict=False)):
            label = f"{short(mass.name, 24)}, {mass.mass:g} kg"
            force.plot(across, sizes, color=_other(i), ls=LINE_STYLES[i % 4], lw=1.5, label=label)
        if len(result.masses) > 1:
            total = np.linalg.norm(result.shaking, axis=1)
            force.plot(across, total, color="#303030", lw=1.0, label=say("sum of all"))
        force.set_ylim(0, 1.08 * float(np.linalg.norm(result.force, axis=2).max() or 1.0))
        figure.align_ylabels()
        force.set_ylabel(say("inertia force [N]"))
        _input_axis(force, cycle, across)
        figure.legend(loc="outside lower center", ncols=3, frameon=False)
        what = say("circuit {number}: what masses require of the input", number=cycle.circuit.index)
        headline(figure, f"{short(linkage.heading, 60)}\n{what}")
    return figure


def _head_of_panel(figure: Figure, across: float, up: float, text: str, width: float) -> None:
    """The title of a panel about a place of the page, within a width [shares of the page's]."""
    head = figure.text(across, up, text, fontsize=letters() + 1, ha="center", va="bottom")
    fit_letters(head, width * figure.get_figwidth())


def _other(index: int) -> str:
    """The colour of a point of the file, or of a mass."""
    others = [colour for colour in CIRCUIT_COLOURS if colour != FOUND]
    return others[index % len(others)]


def _input_axis(axes: Axes, cycle: Cycle, across: Floats) -> None:
    axes.grid(lw=0.6)
    ends = [across.min(), across.max()]
    if cycle.closed:
        ends = sorted([across[0], across[0] + math.copysign(math.degrees(cycle.turn), cycle.step)])
    axes.set_xlim(*ends)
    if not slides(cycle.motion, cycle.motion.input):
        axes.xaxis.set_major_locator(DegreeLocator(9))
    axes.set_xlabel(input_label(cycle.motion))


def _legend_below(figure: Figure, axes: Any, middle: float, columns: int) -> None:
    """The legend of axes at the foot of the page, in at most so many columns, about a place [share]."""
    handles, labels = axes.get_legend_handles_labels()
    for count in range(columns, 0, -1):
        legend = figure.legend(
            handles, labels, frameon=False, fontsize=8.5, loc="lower center", bbox_to_anchor=(middle, 0.0),
            ncols=count,
        )  # fmt: skip
        if count == 1 or legend.get_window_extent(measuring(figure)).x1 <= figure.bbox.width:
            return
        legend.remove()


def _closed(path: Floats, cycle: Cycle) -> Floats:
    """A path with its first row again at its end, where it closes."""
    return np.concatenate([path, path[:1]]) if cycle.closed else path
