"""The path of a point with its velocity and acceleration, and its speed over the input."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sevenbar.arrays import Floats, Integers
from sevenbar.drawing import page
from sevenbar.drawing.asked import PATH_PARTS
from sevenbar.drawing.figure import (
    CUT,
    given_axes,
    gridded,
    input_axis,
    new_figure,
    note,
    shown_value,
    title_of,
    title_text,
)
from sevenbar.drawing.names import amount_text, handy_unit, short
from sevenbar.drawing.space import ViewAxes, box_round
from sevenbar.drawing.style import (
    ACCELERATION,
    INK,
    LINE_STYLES,
    VELOCITY,
    letters,
    page_size,
    stroke,
    styled,
)
from sevenbar.drawing.view import Asked, Projection, view_of
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.text.words import say

#: Arrows along a path, and the length of the longest as a share of the path's extent.
ARROWS, LONGEST_ARROW = 36, 0.35
#: Rates of a size beyond so many times their upper quartile are left out next to dead centres.
BEYOND = 4.0
#: The head of an arrow: its length as a share of the arrow, at most that of the longest; half its angle.
HEAD, SPREAD = 0.16, 0.38
#: Least size of a picture, and least height of the panel of the speed [inch, at letters of 9 points].
LEAST_PICTURE, LEAST_PANEL = (1.8, 1.3), 1.2
#: Width of the page, of one picture alone, and height of the panel of the speed [inch].
WIDTH, ALONE, PANEL = 9.4, 5.4, 2.1


def point_path(
    motion: Motion,
    point: str | tuple[int, tuple[float, float, float]],
    circuit: int = 0,
    *,
    name: str | None = None,
    parts: Sequence[str] = PATH_PARTS[1:],
    ax: Any = None,
    view: Asked = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
) -> Figure:
    """A point's path with its velocity (a), its acceleration (b), and its speed over the input (c).

    `point` is a name of the linkage's points, or (link, at) as for `Circuit.point`; `name` is what the title
    calls it. The path of a planar loop is drawn in its plane, as a coupler curve. Arrows are drawn to one
    scale in each view; the greatest value of all rows is above it. `parts` are those of "path" (without
    arrows), "velocity", "acceleration" and "speed" that are drawn; `ax`: axes to draw in, one for each. The
    rest is as for `configuration`. Raises `RequestError` for a point or a circuit that does not exist.

    Source: "Kinematical analysis of 7R spatial mechanism", Figure 2.
    """
    chosen = chosen_circuit(motion, circuit)
    if isinstance(point, str):
        named = {p.name: (p.link, p.at) for p in motion.linkage.points}
        if point not in named:
            known = ", ".join(named) or "none; give (link, (u, v, w))"
            raise RequestError(f"point: no point {shown(point)}; this linkage has {known}")
        name, (link, at) = name or point, named[point]
        trace = chosen.point(point)
    else:
        link, at = point
        trace = chosen.point(link, at)
    for part in parts:
        if part not in PATH_PARTS:
            raise RequestError(f"parts: {shown(part)} is not drawn; give some of {', '.join(PATH_PARTS)}")
    if not np.isfinite(trace.position).all(axis=1).any():
        raise RequestError(f"point: it has no place along circuit {chosen.index}; nothing to draw")
    rows = walk(chosen).rows
    places = trace.position[rows]
    rates = [part for part in parts if part not in ("path", "speed")]
    arrows = {what: arrows_along(places, getattr(trace, what)[rows]) for what in rates}
    # both views to one scale
    seen = np.concatenate([places, *(places[own] + ways for own, ways, _ in arrows.values())])
    marks = [f"({letter}) " if len(parts) > 1 else "" for letter in "abcd"]
    letter = dict(zip(parts, marks, strict=False))
    pictures = [part for part in parts if part != "speed"]
    with styled(style):
        given = None if ax is None else given_axes(ax, len(parts), "one for each part")
        first = next((axes for axes, part in zip(given or (), parts, strict=False) if part != "speed"), None)
        seen_as = view_of(view, motion.linkage, seen, first)
        box = box_round(seen, seen_as)
        unit = motion.linkage.length_unit
        if given is not None:
            for axes, part in zip(given, parts, strict=True):
                if part == "speed":
                    _speed(axes, motion, chosen, trace)
                else:
                    space = ViewAxes(axes, seen_as)
                    page.prepare_box(space, box, unit, None)
                    _draw(space, places, arrows.get(part), part)
            return given[0].figure.figure  # type: ignore[no-any-return]
        wide = len(pictures) > 1
        usual = WIDTH if wide else ALONE
        figure = new_figure(*page_size(style, figsize, (usual, usual), wide=wide))
        where = f"({', '.join(f'{x:g}' for x in at)})"
        which = say(
            "point {name}, circuit {number}, {driven}",
            name=short(name or say("link {number} at {place}", number=link, place=where), 40),
            number=chosen.index, driven=note(motion, False),
        )  # fmt: skip
        heading = f"{title_of(motion)}\n{which}"
        top = page.write_title(figure, title_text(title, heading))
        width, height = figure.get_size_inches()
        line = 0.024 * letters()
        below = PANEL * letters() / 9.0 if "speed" in parts else 0.0
        across = width / max(len(pictures), 1)
        if figsize is None:
            height = top + below + (page.picture_height(seen_as, box, across) + line if pictures else 0.0)
            page.set_height(figure, height)
        elif pictures:
            below = min(below, 0.35 * height)
        else:
            below = height - top
        if figsize is not None:
            _check_room(figsize, across, height - top - line - below, below, pictures, parts)
        for place, part in enumerate(pictures):
            space = ViewAxes(page.own_axes(figure, seen_as), seen_as)
            room: page.Rectangle = (place * across, below, across, height - top - line - below)
            page.prepare_box(space, box, unit, room)
            _draw(space, places, arrows.get(part), part)
            words = letter[part]
            if part in arrows:
                greatest = _greatest(chosen, arrows[part][2], unit, part)
                words += say("{quantity}, {greatest}", quantity=say(part), greatest=greatest)
            space.heading(words, room[0] + across / 2, height - top - line + page.EDGE / 4)
        if "speed" in parts:
            left, under = 0.075 * letters(), 0.052 * letters()
            room = (left, under, width - left - 0.2, below - under - line - 0.1)
            axes = figure.add_axes((room[0] / width, room[1] / height, room[2] / width, room[3] / height))
            _speed(axes, motion, chosen, trace)
            axes.set_title(letter["speed"] + say("speed along the path"), fontsize=letters() + 1)
    return figure


def _greatest(circuit: Circuit, largest: float, unit: str, part: str) -> str:
    """The greatest size of a rate along a path, in words."""
    if not largest > 0:
        return say("zero")
    if circuit.turns_back:
        return say("without bound at dead centres")
    return say("at most {amount}", amount=amount_text(largest, unit, "/s" if part == "velocity" else "/s²"))


def _check_room(
    size: Sequence[float],
    across: float,
    high: float,
    below: float,
    pictures: Sequence[str],
    parts: Sequence[str],
) -> None:
    """Raises `RequestError` for a page on which the panels would run into each other."""
    scale = letters() / 9.0
    wide, tall = (scale * least for least in LEAST_PICTURE)
    narrow = bool(pictures) and (across < wide or high < tall)
    if len(parts) > 1 and (narrow or ("speed" in parts and below < scale * LEAST_PANEL)):
        given = " x ".join(f"{25.4 * side:.3g}" for side in size)
        raise RequestError(
            f"size: {given} mm is too small for {len(parts)} panels; give a greater one, or fewer parts, "
            "as in --parts velocity, or --kind coupler for the path alone"
        )


def _draw(space: ViewAxes, places: Floats, arrows: tuple[Integers, Floats, float] | None, part: str) -> None:
    """The path, and one of its rates as arrows on it."""
    space.line(places, color=INK, lw=1.3, zorder=3)
    if arrows is None:
        return
    rows, ways, _ = arrows
    if not len(rows):
        return
    view: Projection = space.view
    colour = VELOCITY if part == "velocity" else ACCELERATION
    start, end = places[rows], places[rows] + ways
    strokes = [np.stack(pair) for pair in zip(start, end, strict=True)]
    # heads in the plane of the page, as seen
    flat = ways @ view.screen.T
    length = np.linalg.norm(flat, axis=1, keepdims=True)
    way = flat / np.where(length > 0, length, 1.0)
    head = np.minimum(length, HEAD * np.linalg.norm(ways, axis=1).max())
    for turn in (SPREAD, -SPREAD):
        turned = way @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        back = end - (head * turned) @ view.screen
        strokes += [np.stack(pair) for pair in zip(end, back, strict=True)]
    space.strokes(strokes, colour, 1.0, 4)


def _speed(axes: Axes, motion: Motion, circuit: Circuit, trace: Trace) -> None:
    """The speed of a point over the input."""
    path = walk(circuit)
    gridded(axes)
    across = shown_value(motion, motion.input, path.input)
    speed = np.linalg.norm(trace.velocity[path.rows], axis=1)
    bounded = speed[np.isfinite(speed)]
    most = float(bounded.max(initial=0.0))
    if circuit.turns_back and bounded.size:
        most = float(np.percentile(bounded, 100 - CUT[1]))
    factor, unit = handy_unit(motion.linkage.length_unit, most)
    for number, part in enumerate(path.passes):
        dashes = LINE_STYLES[number % len(LINE_STYLES)]
        axes.plot(across[part], factor * speed[part], color=VELOCITY, ls=dashes, lw=1.6 * stroke())
    input_axis(axes, motion, across, 10)
    axes.set_ylim(0, 1.08 * factor * (most or 1.0))
    axes.set_ylabel(say("speed [{unit}/s]", unit=unit))


def arrows_along(places: Floats, vectors: Floats) -> tuple[Integers, Floats, float]:
    """The rows of the arrows, the arrows (k, 3) [length], and the size of the longest vector of all rows."""
    solved = np.isfinite(places).all(axis=1)
    extent = float(np.ptp(places[solved], axis=0).max()) or 1.0
    rows = np.flatnonzero(solved & np.isfinite(vectors).all(axis=1))
    largest = float(np.linalg.norm(vectors[rows], axis=1).max(initial=0.0))
    # evenly along the input, so that dense arrows mean slow motion
    rows = rows[np.unique(np.linspace(0, max(len(rows) - 1, 0), ARROWS + 1).astype(int))[:-1]]
    sizes = np.linalg.norm(vectors[rows], axis=1)
    if sizes.size:
        # next to dead centres vectors grow without bound: those are left out
        selected = sizes <= BEYOND * np.percentile(sizes, 75)
        rows, sizes = rows[selected], sizes[selected]
    longest = float(sizes.max(initial=0.0))
    return rows, vectors[rows] * (LONGEST_ARROW * extent / longest if longest > 0 else 0.0), largest
