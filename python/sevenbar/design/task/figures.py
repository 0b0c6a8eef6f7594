"""Figures of a task's designs: each want as it is met, and how much slack the musts leave on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import Locator, MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.path_page import PathPage, path_page
from sevenbar.design.task.wanted import PlacesCurve, ReadingsCurve
from sevenbar.drawing.figure import headline, page_figure
from sevenbar.drawing.names import short
from sevenbar.drawing.style import COMPUTED, OTHER, styled
from sevenbar.kinematics.loop.columns import shown_in
from sevenbar.text.words import say

#: Wanted readings beyond which they are a line.
MANY = 40

#: Colours of musts, one after the other.
COLOURS = (COMPUTED, OTHER, "#2a7f3f", "#8a4fa8", "#b8860b", "#404040")

#: A curve: its places, its values, and how it is drawn.
Curve = tuple[Floats, Floats, Mapping[str, Any]]

GENERATED: Mapping[str, Any] = {"color": COMPUTED, "lw": 1.8, "zorder": 2}
WANTED: Mapping[str, Any] = {"color": OTHER, "lw": 1.3, "ls": (0, (4, 2.5)), "zorder": 3}
POINTS: Mapping[str, Any] = {"color": OTHER, "ls": "", "marker": "o", "mfc": "white", "zorder": 4}


def readings_figure(
    title: str, curves: Sequence[Curve], errors: Sequence[Curve], labels: Sequence[str], ticks: Locator
) -> Figure:
    """Curves over the input's readings, and below them errors, the first of which decides the scale.

    `labels` are those of both panels and of the input.
    """
    with styled():
        figure = page_figure(6.4, 6.0, pads=(0.05, 0.06))
        panels = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (3.0, 1.6)})
        top, below = panels
        below.axhline(0.0, color="#505050", lw=0.8, zorder=1)
        for axes, lines, label in zip(panels, (curves, errors), labels[:2], strict=True):
            for x, y, look in lines:
                axes.plot(x, y, **look)
            axes.set_ylabel(label)
            axes.grid(lw=0.6)
        if np.abs(errors[0][1]).max() < 1e-9:
            below.set_ylim(-1.0, 1.0)
        below.set_xlabel(labels[2])
        below.xaxis.set_major_locator(ticks)
        below.yaxis.set_major_locator(MaxNLocator(5))
        figure.align_ylabels()
        headline(figure, title)
        handles, names = top.get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=len(handles), frameon=False)
    return figure


def want_figure(along: DesignAlong, number: int) -> Figure:
    """A want with a way, by its place among those: readings and error, or the path and its distances."""
    title = say("want {number}", number=along.task.sampled[number][0] + 1)
    curve = along.curve(number)
    if isinstance(curve, ReadingsCurve):
        return _readings(along, curve, number, title)
    return _places(along, curve, title)


def _readings(along: DesignAlong, curve: ReadingsCurve, number: int, title: str) -> Figure:
    """The output's readings over the input's; below, the design's less those wanted."""
    linkage = along.task.draft.linkage
    drive = linkage.drive
    x, y, at, wanted = curve.inputs, curve.outputs, curve.at, curve.wanted
    order = np.argsort(x)
    errors = np.interp(at, x[order], y[order]) - wanted
    (x_unit, across), (y_unit, up) = (shown_in(linkage, column) for column in (drive.joint, drive.output))
    points = len(at) <= MANY
    mark = {**POINTS, "ms": 5.0, "zorder": 3} if points else WANTED
    line = {"ls": "", "marker": "o", "ms": 4.0} if points else {"lw": 1.6}
    met = along.design.met[number]
    reached = say(
        "error at most {greatest:.3g} {unit}, RMS {rms:.3g} {unit}",
        greatest=up * met.greatest, rms=up * met.rms, unit=y_unit,
    )  # fmt: skip
    return readings_figure(
        f"{_title(along)}\n{title}: {reached}",
        [
            (across * x, up * y, {**GENERATED, "label": say("generated")}),
            (across * at, up * wanted, {**mark, "label": say("wanted")}),
        ],
        [(across * at, up * errors, {"color": COMPUTED, **line})],
        [
            say("output reading [{unit}]", unit=y_unit),
            say("generated less\nwanted [{unit}]", unit=y_unit),
            say("input reading [{unit}]", unit=x_unit),
        ],
        MaxNLocator(9),
    )


def _places(along: DesignAlong, curve: PlacesCurve, title: str) -> Figure:
    """The path in space and from three sides, or the frames of poses, and the distance at each."""
    frames = [] if curve.frames is None else list(zip(curve.frames, (OTHER, COMPUTED), strict=True))
    page = PathPage(curve.wanted, curve.path, curve.errors, f"{_title(along)}, {title}", frames)
    return path_page(along.task.draft.linkage, page)


def musts_figure(along: DesignAlong) -> Figure | None:
    """The slack of each must about poses over the input; below 0 it is missed. `None` without any."""
    slacks = along.slacks()
    if not slacks:
        return None
    linkage, task = along.task.draft.linkage, along.task
    units = list(dict.fromkeys(along.slack_unit(place) for place, *_ in slacks))
    joint = linkage.drive.joint
    x_unit, across = shown_in(linkage, joint)
    with styled():
        figure = page_figure(6.4, 2.6 + 2.4 * len(units), pads=(0.05, 0.06))
        every = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
        seen: set[int] = set()
        for place, _, inputs, values in slacks:
            axes = every[units.index(along.slack_unit(place))]
            label = None if place in seen else short(task.musts[place].words(linkage), 60)
            seen.add(place)
            order = np.argsort(inputs)
            colour = COLOURS[place % len(COLOURS)]
            axes.plot(across * inputs[order], values[order], color=colour, lw=1.6, label=label)
        for axes, unit in zip(every, units, strict=True):
            axes.axhline(0.0, color="#505050", lw=0.8, zorder=1)
            axes.set_ylabel(say("room [{unit}]", unit=unit))
            axes.grid(lw=0.6)
            axes.yaxis.set_major_locator(MaxNLocator(5))
            axes.legend(loc="best", frameon=True)
        every[-1].set_xlabel(say("input: {joint}", joint=f"{joint} [{x_unit}]"))
        headline(figure, f"{_title(along)}\n{say('what must hold, with its room')}")
    return figure


def _title(along: DesignAlong) -> str:
    return short(along.design.candidate.name, 60)
