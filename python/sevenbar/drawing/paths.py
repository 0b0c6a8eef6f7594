"""Figures of what any loop can show: all joints, the path of a point, all assembly modes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import (
    CIRCUIT_COLOURS,
    CUT,
    LINE_STYLES,
    STYLE,
    input_label,
    new_figure,
    note,
    shown_value,
    slides,
    title,
)
from sevenbar.drawing.scene import INPUT, OUTPUT, bars, keys, prepare_view, put, stage
from sevenbar.drawing.skeleton import one_pose, short, skeleton_of
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits import Circuit, Integers
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.motion import Modes, Motion, chosen_circuit
from sevenbar.kinematics.poses import frames_of, walk


def joints(motion: Motion) -> Figure:
    """Every joint's angle [deg] or slide [length] against the input: a panel a joint, a colour a circuit.

    Angles are drawn within (-180, 180], so that circuits can be told apart. Raises `RequestError` where the
    motion has no circuit.
    """
    chosen_circuit(motion, 0)
    linkage = motion.linkage
    shown_columns = [name for name in linkage.columns if name != motion.input]
    across = 2 if len(shown_columns) < 7 else 3
    down = math.ceil(len(shown_columns) / across)
    with rc_context(STYLE):
        figure = new_figure(3.6 * across + 0.6, 2.05 * down + 1.3)
        figure.set_layout_engine("constrained", h_pad=0.05, w_pad=0.06)
        grid = figure.subplots(down, across, sharex=True, squeeze=False)
        for place, axes in enumerate(grid.flat):
            axes.grid(lw=0.6)
            if place >= len(shown_columns):
                axes.remove()
                continue
            name = shown_columns[place]
            for circuit in motion:
                _joint_line(axes, motion, circuit, name)
            if not slides(motion, name):
                low, high = axes.get_ylim()
                if high - low > 120:
                    axes.set_ylim(-185, 185)
                    axes.set_yticks(range(-180, 181, 90))
            unit = linkage.length_unit if slides(motion, name) else "deg"
            axes.set_ylabel(f"{short(name, 22)} [{unit}]")
            if place + across >= len(shown_columns):
                axes.set_xlabel(input_label(motion))
                axes.tick_params(labelbottom=True)
        inputs = np.concatenate([shown_value(motion, motion.input, walk(c).input) for c in motion])
        # a law may leave every range, or have one row
        inputs = inputs[np.isfinite(inputs)]
        for axes in figure.axes:
            if inputs.size and np.ptp(inputs) > 0:
                axes.set_xlim(inputs.min(), inputs.max())
            if not slides(motion, motion.input):
                axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 1.5, 3, 4.5, 6, 9, 10]))
        figure.suptitle(title(motion), fontsize=11)
        lines = [
            Line2D([], [], **_circuit_style(circuit), label=f"circuit {circuit.index}") for circuit in motion
        ]
        figure.legend(handles=lines, loc="outside lower center", ncols=min(len(lines), 4), frameon=False)
    return figure


def _circuit_style(circuit: Circuit) -> dict[str, Any]:
    count = len(CIRCUIT_COLOURS)
    style = LINE_STYLES[(circuit.index + circuit.index // count) % len(LINE_STYLES)]
    return {"color": CIRCUIT_COLOURS[circuit.index % count], "ls": style, "lw": 1.5}


def _joint_line(axes: Axes, motion: Motion, circuit: Circuit, name: str) -> None:
    """One column of a circuit over the input, cut where it is wrapped."""
    index = motion.linkage.columns.index(name)
    rows = walk(circuit)
    across, values = shown_value(motion, motion.input, rows.input), circuit.q[rows.rows, index]
    if not slides(motion, name):
        values = np.degrees(np.angle(np.exp(1j * values)))
        jumps = np.flatnonzero(np.abs(np.diff(values)) > 180.0) + 1
        across, values = np.insert(across, jumps, np.nan), np.insert(values, jumps, np.nan)
    axes.plot(across, values, **_circuit_style(circuit))


#: Arrows along a path, and the length of the longest as a share of the path's extent.
ARROWS, LONGEST_ARROW = 36, 0.35


def point_path(
    motion: Motion,
    point: str | tuple[int, tuple[float, float, float]],
    circuit: int = 0,
    *,
    name: str | None = None,
) -> Figure:
    """A point's path in space with its velocity (a), its acceleration (b), and its speed over the input (c).

    `point` is a name of the linkage's points, or (link, at) as for `Circuit.point`; `name` is what the title
    calls it. Arrows are drawn to one scale in each view, told below it. Raises `RequestError` for a point or
    a circuit that does not exist.

    Source: "Kinematical analysis of 7R spatial mechanism", Figure 2.
    """
    chosen = chosen_circuit(motion, circuit)
    if isinstance(point, str):
        named = {p.name: (p.link, p.at) for p in motion.linkage.points}
        if point not in named:
            known = ", ".join(named) or "none; give (link, (u, v, w))"
            raise RequestError(f"point: no point {shown(point)}; this linkage has {known}")
        name, (link, at) = name or point, named[point]
    else:
        link, at = point
    trace = chosen.point(link, at)
    if not np.isfinite(trace.position).all(axis=1).any():
        raise RequestError(f"point: it has no place along circuit {chosen.index}; nothing to draw")
    path = walk(chosen)
    unit = motion.linkage.length_unit
    called = short(name or f"link {link} at ({', '.join(f'{x:g}' for x in at)})", 40)
    with rc_context(STYLE):
        figure = new_figure(10.6, 8.8)
        views: list[Any] = [figure.add_axes((x, 0.31, 0.5, 0.62), projection="3d") for x in (0.0, 0.5)]
        places = trace.position[path.rows]
        arrows = [arrows_along(places, v[path.rows]) for v in (trace.velocity, trace.acceleration)]
        # both views to one scale
        seen = np.concatenate([places, *(places[rows] + along for rows, along, _ in arrows)])
        drawn = zip("ab", views, ("velocity", "acceleration"), (INPUT, OUTPUT), arrows, strict=True)
        for letter, axes, quantity, colour, (rows, along, longest) in drawn:
            prepare_view(axes, seen, unit, fill=0.79)
            axes.plot(*places.T, color="#303030", lw=1.3, zorder=3)
            size = f"no {quantity}"
            if longest > 0:
                look = {"color": colour, "lw": 1.0, "arrow_length_ratio": 0.16, "zorder": 4}
                axes.quiver(*places[rows].T, *along.T, **look)
                size = f"longest arrow {longest:.4g} {unit}{'/s' if quantity == 'velocity' else '/s²'}"
            axes.set_title(f"({letter}) path and {quantity}: {size}", fontsize=10, y=1.0)
        below = figure.add_axes((0.09, 0.075, 0.87, 0.22))
        below.grid(lw=0.6)
        across = shown_value(motion, motion.input, path.input)
        speed = np.linalg.norm(trace.velocity[path.rows], axis=1)
        for number, part in enumerate(path.passes):
            style = LINE_STYLES[number % len(LINE_STYLES)]
            below.plot(across[part], speed[part], color=INPUT, ls=style, lw=1.6)
        below.set_xlim(np.nanmin(across), np.nanmax(across))
        if not slides(motion, motion.input):
            below.xaxis.set_major_locator(MaxNLocator(12, steps=[1, 1.5, 3, 4.5, 6, 9, 10]))
        bounded = speed[np.isfinite(speed)]
        if chosen.turns_back and bounded.size:
            below.set_ylim(0, 1.1 * np.percentile(bounded, 100 - CUT["velocity"]))
        elif bounded.size:
            below.set_ylim(0, 1.08 * (bounded.max() or 1.0))
        below.set_xlabel(input_label(motion))
        below.set_ylabel(f"speed [{unit}/s]")
        below.set_title("(c) speed along the path", fontsize=10)
        figure.suptitle(
            f"{title(motion)}\npoint {called}, circuit {chosen.index}, {note(motion, False)}", fontsize=11
        )
    return figure


def arrows_along(places: Floats, vectors: Floats) -> tuple[Integers, Floats, float]:
    """The rows at which arrows stand, the arrows (k, 3) [length], and the size of the longest vector."""
    solved = np.isfinite(places).all(axis=1)
    extent = float(np.ptp(places[solved], axis=0).max()) or 1.0
    rows = np.flatnonzero(solved & np.isfinite(vectors).all(axis=1))
    # evenly along the input, so that dense arrows mean slow motion
    rows = rows[np.unique(np.linspace(0, max(len(rows) - 1, 0), ARROWS + 1).astype(int))[:-1]]
    sizes = np.linalg.norm(vectors[rows], axis=1)
    if sizes.size:
        # next to dead centres vectors grow without bound: those are left out
        told = sizes <= 4 * np.percentile(sizes, 75)
        rows, sizes = rows[told], sizes[told]
    longest = float(sizes.max(initial=0.0))
    return rows, vectors[rows] * (LONGEST_ARROW * extent / longest if longest > 0 else 0.0), longest


def modes_overview(
    linkage: Loop, modes: Modes, *, input: str | None = None, output: str | None = None
) -> Figure:
    """All assembly modes at one input, side by side in space, from one side and to one scale.

    `input` and `output` name the columns that are coloured; the drive's where none is given.
    Raises `RequestError` where there is no mode.
    """
    count = len(modes)
    if count == 0:
        raise RequestError("modes: the loop closes at no mode, so there is nothing to draw")
    first = linkage.column(linkage.drive.joint if input is None else input, "input")
    second = linkage.other_column(first) if output is None else linkage.column(output, "output")
    slide = linkage.column_kinds[first] == "slide"
    value = f"{modes.input:.6g} {linkage.length_unit}" if slide else f"{math.degrees(modes.input):.6g}°"
    ends = linkage.columns[first], linkage.columns[second]
    poses = skeleton_of(linkage, frames_of(linkage, modes.q))
    across = min(count, 2 if count < 5 else 4)
    down = math.ceil(count / across)
    side = 4.6 if across < 3 else 3.3
    with rc_context(STYLE):
        figure = new_figure(max(across * side, 6.0), down * side + 1.3)
        height = figure.get_size_inches()[1]
        for index in range(count):
            row, column = divmod(index, across)
            bottom = (height - 0.6 - (row + 1) * side) / height
            place = (column / across, bottom, 1 / across, 0.95 * side / height)
            axes: Any = figure.add_axes(place, projection="3d")
            one = one_pose(poses, index)
            stage(axes, one, ends, around=poses, fill=0.84)
            put(bars(axes, one, ends, scale=0.7), one.pose(0))
            if index:
                for scale in (axes.xaxis, axes.yaxis, axes.zaxis):
                    scale.set_ticklabels([])
                    scale.set_label_text("")
            axes.set_title(f"mode {index}", fontsize=10, y=0.98)
        word = "mode" if count == 1 else "modes"
        figure.suptitle(
            f"{short(linkage.name, 60)}: {count} assembly {word} at {{}} = {value}".format(ends[0]),
            fontsize=11,
        )
        figure.legend(handles=keys(one_pose(poses, 0), ends), loc="lower center", ncols=4, frameon=False)
    return figure
