"""Curves of a free motion over time: the input, its speed, and the energies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from sevenbar.drawing.figure import headline, new_figure
from sevenbar.drawing.names import short
from sevenbar.drawing.style import CIRCUIT_COLOURS, LINE_STYLES, page_size, styled
from sevenbar.forces.free_motion.result import FreeMotion
from sevenbar.text.words import say


def free_figure(
    result: FreeMotion, *, figsize: Sequence[float] | None = None, style: str | None = None
) -> Figure:
    """The input, its speed and the energies over time, one above the other."""
    with styled(style):
        figure = new_figure(*page_size(style, figsize, (7.0, 7.5), wide=True))
        panels = figure.subplots(3, 1, sharex=True)
        unit = "°" if result.input_turns else result.length_unit
        scale = np.degrees(1.0) if result.input_turns else 1.0
        name = result.columns[result.input_column]
        colour = CIRCUIT_COLOURS[0]
        panels[0].plot(result.time, scale * result.input, color=colour)
        panels[0].set_ylabel(f"{name} [{unit}]")
        panels[1].plot(result.time, scale * result.speed, color=colour)
        panels[1].set_ylabel(say("speed of {joint} [{unit}]", joint=name, unit=f"{unit}/s"))
        parts = (
            (say("kinetic"), result.kinetic),
            (say("potential"), result.potential),
            (say("sum"), result.energy),
        )
        for i, (word, values) in enumerate(parts):
            panels[2].plot(result.time, values, color=CIRCUIT_COLOURS[i], ls=LINE_STYLES[i], label=word)
        panels[2].set_ylabel(say("energy [J]"))
        panels[2].set_xlabel(say("time [s]"))
        panels[2].legend(frameon=False)
        headline(figure, f"{short(result.heading, 60)}\n{say('free motion')}")
    return figure
