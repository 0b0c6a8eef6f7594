"""Curves of all joints over the input: a panel a joint, a line a circuit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sevenbar.drawing.figure import gridded, input_axis, title_of
from sevenbar.drawing.panels import panels_across, panels_of
from sevenbar.drawing.quantities import curve_of, place_of_column
from sevenbar.drawing.style import circuit_colour, line_style, stroke, styled
from sevenbar.drawing.ticks import NATURAL_ANGLE, DegreeLocator, widen
from sevenbar.errors import RequestError, no_joint
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.text.words import say

#: Circuits whose curves lie on each other: how much wider each is than the one on it.
WIDER = 2.0
#: Curves nearer than this share of their natural size lie on each other.
TOGETHER = 1e-6


def joints(
    motion: Motion,
    *,
    columns: Sequence[str] | None = None,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """Every joint's angle [deg] or slide [length] against the input: a panel a joint, a colour a circuit.

    Angles run on over 180 degrees. Where circuits coincide, the lower number is drawn as a broad line under
    the other. `columns` names those that are drawn, all but the input by default; `ax`: axes to draw in, one
    for each. The rest is as for `configuration`. Raises `RequestError` where the motion has no circuit.
    """
    chosen_circuit(motion, 0)
    linkage = motion.linkage
    for name in columns or ():
        if name not in linkage.columns:
            raise RequestError(f"columns: {no_joint(name, linkage.columns)}")
    drawn = [name for name in linkage.columns if name != motion.input] if columns is None else list(columns)
    if not drawn:
        raise RequestError("columns: none given; leave it out to draw all")
    with styled(style):
        across = panels_across(len(drawn))
        usual = 3.4 * across + 0.4, 2.0 * math.ceil(len(drawn) / across) + 1.0
        page = panels_of(
            len(drawn), ax, "one for each column", usual, across=across, figsize=figsize, style=style
        )
        for axes, name in zip(page.axes, drawn, strict=True):
            _panel(axes, motion, name)
        page.label_lowest()
        lines = [Line2D([], [], **_look(c, 0), label=say("circuit {number}", number=c.index)) for c in motion]
        page.finish(title, title_of(motion), lines if legend else [])
    return page.figure


def _panel(axes: Axes, motion: Motion, name: str) -> None:
    """The curves of one column of all circuits."""
    gridded(axes)
    quantity = place_of_column(motion, name)
    lines = [curve_of(quantity, TimedWalk(motion, circuit)) for circuit in motion]
    natural = lines[0].natural
    for place, line in enumerate(lines):
        above = sum(
            other.values.shape == line.values.shape
            and np.allclose(other.values, line.values, rtol=0, atol=TOGETHER * natural, equal_nan=True)
            and np.allclose(other.input, line.input, rtol=0, atol=TOGETHER * NATURAL_ANGLE, equal_nan=True)
            for other in lines[place + 1 :]
        )
        axes.plot(line.input, line.values, **_look(line.circuit, above))
    if quantity.unit == "deg":
        axes.yaxis.set_major_locator(DegreeLocator(6))
    else:
        axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    widen(axes.yaxis, natural)
    input_axis(axes, motion, np.concatenate([line.input for line in lines]), 6)
    axes.set_ylabel(quantity.label())


def _look(circuit: Circuit, above: int) -> dict[str, Any]:
    """The line of a circuit with so many others on it."""
    dashes = "-" if above else line_style(circuit.index)
    width = (1.5 + WIDER * min(above, 3)) * stroke()
    return {"color": circuit_colour(circuit.index), "ls": dashes, "lw": width}
