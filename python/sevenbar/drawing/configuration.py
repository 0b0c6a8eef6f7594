"""Pictures of a linkage that stands still: in several positions of a circuit, in all assembly modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from sevenbar.arrays import whole_number
from sevenbar.drawing import page
from sevenbar.drawing.figure import given_axes, new_figure, refuse_small, slides, title_of, title_text
from sevenbar.drawing.lettering import write_names
from sevenbar.drawing.names import short, shown_name
from sevenbar.drawing.scene import bars, frame_box, keys, put, shown_places, stage
from sevenbar.drawing.skeleton import Skeleton, one_pose, skeleton, skeleton_of
from sevenbar.drawing.space import ViewAxes
from sevenbar.drawing.style import letters, page_size, styled
from sevenbar.drawing.view import Asked, view_of
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import poses, walk
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.ranges.reach import Reach, drawn_row, used_reach
from sevenbar.text.words import say

#: Width [inch] of a picture, of one mode in a row of two, and in a row of more.
WIDTH, MODE, SMALL_MODE = 6.4, 3.7, 2.9
#: Marks and lines of small pictures.
SMALLER = 0.7


def configuration(
    motion: Motion,
    circuit: int = 0,
    positions: int | None = None,
    *,
    ax: Any = None,
    view: Asked = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """The linkage in several positions spread over a circuit: one strong, the others faint.

    Of a linkage with stops they are spread from stop to stop, both among them, and the strong one is the
    drawn pose where that is between them. A planar loop is drawn in its plane, a spherical one on its sphere,
    any other in space. `circuit` is its index in `motion.circuits`, `positions` how many poses (1 to 100; six
    for up to four joints, else three). Lengths are in the linkage's unit, equal along all axes.

    `ax`: axes of matplotlib to draw in, without title and legend; made with projection="3d" for a view in
    space. `view`: one of `VIEWS` ("plane", "space", "xy", "xz", "yz", "iso"), or elevation and azimuth [deg].
    `figsize`: width and height [inch]. `style`: one of `STYLES` ("screen", "paper", "ieee"). `title`: False
    for none, or a text. Raises `RequestError` where there is no such circuit, view, style or size.

        >>> import sevenbar as sb
        >>> figure = configuration(sb.load("bennett").motion())
        >>> figure.axes[0].get_zlabel()
        'z [mm]'

    Source: Sun and Zhou, Figure 3.
    """
    chosen = chosen_circuit(motion, circuit)
    if positions is None:
        positions = 6 if motion.linkage.graph.ground < 5 else 3
    positions = whole_number("positions", positions, 1, 100, "a count")
    frame = skeleton(motion, chosen)
    way = TimedWalk(motion, chosen)
    reach = used_reach(way) if motion.law is None else None
    if reach is None:
        poses = [frame.pose(row) for row in _spread(motion, chosen, frame, positions)]
    else:
        frame, rows = _from_stop_to_stop(frame, reach, drawn_row(way), positions)
        poses = [frame.pose(row) for row in rows]
    ends = motion.input, motion.output
    with styled(style):
        if ax is not None:
            (ax,) = given_axes(ax, 1, "or none")
        seen = view_of(view, motion.linkage, shown_places(frame), ax)
        which = say(
            "circuit {number}, {count} position{s}",
            number=chosen.index, count=len(poses), s="s" * (len(poses) > 1),
        )  # fmt: skip
        heading = title_text(title, f"{title_of(motion)}\n{which}")
        figure, space, room = page.page_of_one(
            ax, seen, frame_box(frame, seen), heading, keys(frame, ends, seen) if legend else [],
            usual=WIDTH, figsize=figsize, style=style,
        )  # fmt: skip
        page.prepare(space, frame, room)
        within = None
        if room is not None:
            low, high = room[1] * figure.dpi, (room[1] + room[3]) * figure.dpi
            within = Bbox.from_extents(0, low, figure.bbox.width, high)
        stage(space, frame, ends)
        for pose in poses[1:]:
            put(space, bars(space, frame, ends, ghost=True), pose)
        put(space, bars(space, frame, ends), poses[0])
        write_names(space, frame, poses[0][None], within=within)
    return figure


def _spread(motion: Motion, circuit: Circuit, frame: Skeleton, positions: int) -> list[int]:
    """Rows with a pose, evenly spread by the travel of both angles, a rocking circuit's off its ends."""
    path = walk(circuit)
    solved = np.flatnonzero(~np.isnan(frame.places[:, : frame.solid]).any(axis=(1, 2)))
    ends = ((motion.input, path.input[solved]), (motion.output, path.output[solved]))
    # of a slide its whole range counts as much as half a turn
    scaled = [v * math.pi / (np.ptp(v) or 1.0) if slides(motion, column) else v for column, v in ends]
    steps = np.hypot(*(np.diff(values) for values in scaled))
    travel = np.concatenate([[0.0], np.cumsum(steps)])
    # many a loop lies flat, or folded, at zero
    wanted = (np.arange(positions) + 0.35) / positions * travel[-1]
    return [int(solved[np.argmin(np.abs(travel - place))]) for place in wanted]


def _from_stop_to_stop(
    frame: Skeleton, reach: Reach, drawn: float | None, positions: int
) -> tuple[Skeleton, list[int]]:
    """The poses between two stops, and rows of it evenly spread: the drawn one first, else the first."""
    home = reach.unrolled(drawn) if drawn is not None and reach.holds(drawn) else reach.low
    home = reach.clamped(home)
    inner = np.arange(math.floor(reach.low) + 1, math.ceil(reach.high))
    rows = np.unique(np.concatenate([[reach.low, home, reach.high], inner]))
    own = replace(frame, places=np.stack([frame.pose(reach.rolled(float(row))) for row in rows]))
    steps = np.nan_to_num(np.linalg.norm(np.diff(own.places[:, : own.solid], axis=0), axis=2)).sum(axis=1)
    travel = np.concatenate([[0.0], np.cumsum(steps)])
    first = int(np.searchsorted(rows, home))
    within = 0 < first < len(rows) - 1
    count = positions - 1 if within else positions
    wanted = np.linspace(0.0, travel[-1], count) if count > 1 else np.array([travel[-1]] * count)
    others = [int(np.argmin(np.abs(travel - place))) for place in wanted]
    return own, [first, *(row for row in others if row != first)][:positions]


def modes_overview(
    linkage: Loop,
    modes: Modes,
    *,
    input: str | None = None,
    output: str | None = None,
    ax: Any = None,
    view: Asked = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """All assembly modes at one input, side by side, from one side and to one scale.

    `input` and `output` name the columns that are coloured; the drive's where none is given. `ax`: axes to
    draw in, one for each mode. The rest is as for `configuration`. Raises `RequestError` where there is no
    mode.
    """
    count = len(modes)
    if count == 0:
        raise RequestError("modes: the loop closes at no mode, so there is nothing to draw")
    first, second = linkage.end_columns(input, output)
    slide = not linkage.turns(first)
    value = f"{modes.input:.6g} {linkage.length_unit}" if slide else f"{math.degrees(modes.input):.6g}°"
    ends = linkage.columns[first], linkage.columns[second]
    frame = skeleton_of(linkage, poses(linkage, modes.q))
    across = min(count, 2 if count < 5 else 4)
    down = math.ceil(count / across)
    with styled(style):
        given = None if ax is None else given_axes(ax, count, "one for each mode")
        seen = view_of(view, linkage, shown_places(frame), given[0] if given else None)
        box = frame_box(frame, seen)
        if given:
            for axes, index in zip(given, range(count), strict=True):
                space = ViewAxes(axes, seen)
                page.prepare(space, frame, None)
                _draw_mode(space, frame, index, ends, 1.0)
                if title:
                    axes.set_title(say("mode {number}", number=index))
            return given[0].figure.figure  # type: ignore[no-any-return]
        usual = across * (MODE if across < 3 else SMALL_MODE)
        usual = max(usual, 5.0)
        figure = new_figure(*page_size(style, figsize, (usual, usual), wide=across > 1))
        named = say(
            "{linkage}: {count} assembly mode{s}\nat {joint} = {value}",
            linkage=short(linkage.heading, 60), count=count, s="s" * (count > 1),
            joint=shown_name(ends[0]), value=value,
        )  # fmt: skip
        top = page.write_title(figure, title_text(title, named))
        foot = page.write_legend(figure, keys(one_pose(frame, 0), ends, seen) if legend else [])
        width, height = figure.get_size_inches()
        heading = 0.026 * letters()
        if figsize is None:
            height = top + foot + down * (heading + page.picture_height(seen, box, width / across))
            page.set_height(figure, height)
        side = width / across, (height - top - foot) / down
        left, right, below, above = page.margins(seen)
        room = side[0] - left - right, side[1] - heading - below - above
        refuse_small(figure, *room, f"{count} modes with their numbers", page.ALONE)
        for index in range(count):
            row, column = divmod(index, across)
            left, bottom = column * side[0], height - top - (row + 1) * side[1]
            # the last row in the middle
            left += (across - min(across, count - row * across)) * side[0] / 2
            space = ViewAxes(page.own_axes(figure, seen), seen)
            page.prepare(space, frame, (left, bottom, side[0], side[1] - heading))
            _draw_mode(space, frame, index, ends, SMALLER if across > 2 else 0.85)
            middle, above = left + side[0] / 2, bottom + side[1] - heading + page.EDGE / 2
            space.heading(say("mode {number}", number=index), middle, above)
    return figure


def _draw_mode(space: ViewAxes, poses: Skeleton, index: int, ends: tuple[str, str], scale: float) -> None:
    one = one_pose(poses, index)
    stage(space, one, ends, around=poses)
    put(space, bars(space, one, ends, scale=scale), one.pose(0))
    write_names(space, one, one.places)
