"""Figures of what is measured along a circuit: the transmission angle, and the axodes of a link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import (
    circuits_text,
    given_axes,
    gridded,
    input_axis,
    title_of,
    title_text,
)
from sevenbar.drawing.page import page_of_one, prepare_box
from sevenbar.drawing.panels import coinciding, panels_of
from sevenbar.drawing.quantities import TRANSMISSION, QuantityCurve, curve_of, quantities
from sevenbar.drawing.scene import bars, put, shown_places, stage
from sevenbar.drawing.skeleton import skeleton
from sevenbar.drawing.space import box_round
from sevenbar.drawing.style import LINE_STYLES, QUIET, circuit_colour, stroke, styled
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.drawing.view import Asked, view_of
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.text.words import say

#: The least transmission angle [deg] that textbooks recommend.
RECOMMENDED = 40.0
#: Circuits whose angles differ by less [deg] are one line.
SAME_ANGLE = 1e-6
#: The fixed and the moving axode.
FIXED, MOVING = "#4B4B4B", "#B4436C"
#: Lines of an axode that are drawn, and half their length as a share of the linkage's extent.
LINES, HALF = 72, 0.3
#: An axode reaches so far from the middle of the linkage, in its extents: farther off it is cut.
REACH = 1.5


def transmission(
    motion: Motion,
    *,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """The transmission angle [deg] of every circuit over the input, with the 40 degrees of textbooks.

    The rest is as for `configuration`. Raises `RequestError` where no circuit has a transmission angle.

        >>> import sevenbar as sb
        >>> figure = transmission(sb.load("planar_4r").motion())
        >>> figure.axes[0].get_ylabel()
        'transmission angle [deg]'
    """
    chosen_circuit(motion, 0)
    own = [one for one in quantities(motion) if one.key == TRANSMISSION]
    lines = [curve_of(one, TimedWalk(motion, circuit)) for one in own for circuit in motion]
    lines = [line for line in lines if np.isfinite(line.values).any()]
    if not lines:
        raise RequestError(
            "transmission: no circuit of this linkage has a transmission angle; nothing to draw"
        )
    with styled(style):
        page = panels_of(1, ax, "or none", (6.4, 3.6), figsize=figsize, style=style)
        (axes,) = page.axes
        gridded(axes)
        for place, group in enumerate(coinciding(lines, _alike)):
            look: dict[str, Any] = {
                "color": circuit_colour(group[0].circuit.index),
                "ls": LINE_STYLES[place % len(LINE_STYLES)],
                "label": circuits_text([line.circuit.index for line in group]),
            }
            axes.plot(group[0].input, group[0].values, lw=1.6 * stroke(), **look)
        axes.axhline(
            RECOMMENDED, color=QUIET, lw=0.9 * stroke(), ls=":", label=say("{angle:g}°", angle=RECOMMENDED)
        )
        input_axis(axes, motion, np.concatenate([line.input for line in lines]), 9)
        axes.set_ylim(0, 90)
        axes.yaxis.set_major_locator(DegreeLocator(7))
        axes.set_ylabel(lines[0].quantity.label())
        page.finish(title, title_of(motion), axes.get_legend_handles_labels()[0] if legend else [])
    return page.figure


def _alike(first: QuantityCurve, second: QuantityCurve) -> bool:
    """Whether the curves of two circuits are one line."""
    return all(
        one.shape == other.shape and np.allclose(one, other, rtol=0, atol=SAME_ANGLE, equal_nan=True)
        for one, other in ((first.input, second.input), (first.values, second.values))
    )


def axodes(
    motion: Motion,
    link: int = 2,
    circuit: int = 0,
    *,
    ax: Any = None,
    view: Asked = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """The fixed and the moving axode of a link, with the linkage in one pose; of a planar loop centrodes.

    The moving axode, fixed in the link, rolls on the fixed one, and slides along it where the pitch is not
    zero; both touch in the instantaneous screw axis of the pose, of a planar loop in the instant centre.
    Parts far from the linkage are cut. The rest is as for `configuration`. Raises `RequestError` for a link
    without an axis.

    Source: docs/theory_measures.md, (8) to (10).

        >>> import sevenbar as sb
        >>> figure = axodes(sb.load("planar_4r").motion())
        >>> [text.get_text() for text in figure.legends[0].get_texts()]
        ['fixed centrode', 'moving centrode', 'instant centre']
    """
    chosen = chosen_circuit(motion, circuit)
    result = chosen.screw_axes(link)
    frame = skeleton(motion, chosen)
    rows = walk(chosen).rows
    if not (result.status == "ok").any():
        raise RequestError(
            f"link: link {link} has no screw axis along circuit {chosen.index}; nothing to draw"
        )
    # the pose in which the axis is nearest to the linkage
    solid = shown_places(frame)
    middle, size = np.nanmean(solid, axis=0), frame.span
    away = np.linalg.norm(np.cross(result.point[rows] - middle, result.direction[rows]), axis=1)
    first = int(np.nanargmin(np.where(result.status[rows] == "ok", away, np.nan)))
    row = int(rows[first])
    # the moving axode where the link is in the pose that is drawn
    turn, place = _frame_of(chosen, link, row)
    both = (
        (result.point[rows], result.direction[rows]),
        (result.moving_point[rows] @ turn.T + place, result.moving_direction[rows] @ turn.T),
    )
    ends = motion.input, motion.output
    with styled(style):
        given = None if ax is None else given_axes(ax, 1, "or none")[0]
        seen = view_of(view, motion.linkage, solid, given)
        fixed, moving = say("fixed axode"), say("moving axode")
        if seen.planar:
            fixed, moving = say("fixed centrode"), say("moving centrode")
        lines = [_axode(point, way, middle, size, planar=seen.planar) for point, way in both]
        every = np.concatenate([solid, *(line.reshape(-1, 3) for line in lines)])
        box = box_round(every[np.isfinite(every).all(axis=1)], seen)
        handles = [
            Line2D([], [], color=FIXED, lw=1.6 * stroke(), label=fixed),
            Line2D([], [], color=MOVING, lw=1.6 * stroke(), label=moving),
            Line2D([], [], color="black", lw=1.6 * stroke(), label=say("screw axis")),
        ]
        if seen.planar:
            handles[2] = Line2D([], [], color="black", ls="", marker="o", ms=5, label=say("instant centre"))
        which = say("axodes of link {link}, circuit {number}", link=link, number=chosen.index)
        if seen.planar:
            which = say("centrodes of link {link}, circuit {number}", link=link, number=chosen.index)
        heading = title_text(title, f"{title_of(motion)}\n{which}")
        figure, space, room = page_of_one(
            given, seen, box, heading, handles if legend else [], usual=6.4, figsize=figsize, style=style
        )
        prepare_box(space, box, motion.linkage.length_unit, room)
        stage(space, frame, ends)
        put(space, bars(space, frame, ends, scale=0.8), frame.pose(first))
        for line, colour in zip(lines, (FIXED, MOVING), strict=True):
            if seen.planar:
                space.line(line, color=colour, lw=1.6, zorder=9)
            else:
                space.strokes([one for one in line if np.isfinite(one).all()], colour, 0.7, 4)
        if seen.planar:
            space.line(both[0][0][first][None], ls="", marker="o", color="black", ms=5, zorder=10)
        elif np.isfinite(lines[0][0]).all():
            axis = _axode(both[0][0][first][None], both[0][1][first][None], middle, size, planar=False)
            space.line(axis[0], color="black", lw=1.6, zorder=10)
    return figure


def _frame_of(circuit: Circuit, link: int, row: int) -> tuple[Floats, Floats]:
    """Turn (3, 3) and place (3,) that lead from a link's coordinates to the report frame on a row."""
    places = ((0.0, 0.0, 0.0), (1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))
    ends = [circuit.written_point(link, at).position[row] for at in places]
    return np.stack([end - ends[0] for end in ends[1:]], axis=1), ends[0]


def _axode(points: Floats, ways: Floats, middle: Floats, size: float, *, planar: bool) -> Floats:
    """The lines (m, 2, 3) of an axode near a linkage, of a planar loop its centres (n, 3); NaN far off."""
    # of each line the place that is nearest to the linkage
    near = points + ((middle - points) * ways).sum(axis=1, keepdims=True) * ways
    near = np.where(np.linalg.norm(near - middle, axis=1, keepdims=True) < REACH * size, near, np.nan)
    if planar:
        return near
    chosen = np.unique(np.linspace(0, len(near) - 1, LINES).astype(int))
    ends = HALF * size * ways[chosen]
    return np.stack([near[chosen] - ends, near[chosen] + ends], axis=1)
