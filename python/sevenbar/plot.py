"""Figures of a motion: the linkage in space and the curves of its output (Figures 3 and 4 of the paper)."""

from __future__ import annotations

import math
import os
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, withStroke
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3D, Poly3DCollection  # type: ignore[import-untyped]

from sevenbar.errors import OutputError, RequestError, shown
from sevenbar.linkage import Linkage, inverse
from sevenbar.motion import Circuit, Extremes, Floats, Integers, Motion

#: What a figure can be written as.
FORMATS = ("png", "svg", "pdf")
PNG_DPI = 200

#: Colours of Okabe and Ito, told apart by colour-blind readers too.
INPUT, OUTPUT, COUPLER, GROUND = "#0072B2", "#D55E00", "#009E73", "#808080"
POINT_COLOURS = ("#CC79A7", "#E69F00", "#56B4E9", "#000000")
CIRCUIT_COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7")
LINE_STYLES = ("-", (0, (5, 1.6)), (0, (5, 1.5, 1, 1.5)), (0, (1.2, 1.2)))

#: Names may hold dollars, so mathematical text is off.
STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "text.usetex": False,
    "text.parse_math": False,
    "axes.unicode_minus": True,
    "svg.hashsalt": "sevenbar",
    "pdf.fonttype": 42,
    "grid.color": "#e2e2e2",
}

#: Places of the pose: the two centres and the two balls; further named points come after them.
A0, A, B, B0 = 0, 1, 2, 3
#: The places between which each link lies.
LINK_ENDS = {1: (A0, A), 2: (A, B), 3: (B, B0), 4: (B0, A0)}

#: The thinnest side of the drawn box, as a share of its longest.
THINNEST_BOX = 0.4
#: Rates that grow without bound are cut at these percentiles (low end; the high end mirrors it).
CUT = {"velocity": 4.0, "acceleration": 9.0}

#: Marks in the curves' legend.
EXTREME, LIMIT, CHANGE_POINT = "extreme", "input limit", "change point"

LABELS = {
    "angle": "angle [deg]",
    "velocity": "angular velocity [rad/s]",
    "acceleration": "angular acceleration [rad/s²]",
}


@dataclass(frozen=True, eq=False)
class Walk:
    """A circuit as it is walked; closed by its first row, a turn on, unless a law drives.

    `rows` index the circuit; `input`, `output` [rad] and `time` [s] run on over the closure, each (n,).
    `passes` are the stretches between input dead centres, both ends included.
    """

    rows: Integers
    input: Floats
    output: Floats
    time: Floats
    passes: tuple[slice, ...]


def walk(motion: Motion, circuit: Circuit) -> Walk:
    """The rows of a circuit in the order of its motion."""
    count = len(circuit.time)
    starts = [0, *(np.flatnonzero(np.diff(circuit.branch)) + 1), count]
    rows = np.arange(count)
    if motion.law is not None or count < 2:
        passes = tuple(slice(a, b) for a, b in pairwise(starts))
        return Walk(rows, circuit.input, circuit.output, circuit.time, passes)
    way = math.copysign(circuit.turns * math.tau, motion.speed)
    first = circuit.output[0]
    ahead = 2 * circuit.output[-1] - circuit.output[-2]
    gained = 0.0 if circuit.output_range is not None else round((ahead - first) / math.tau) * math.tau
    last = circuit.input[0] + way
    period = circuit.time[-1] + abs(last - circuit.input[-1]) / abs(motion.speed)
    return Walk(
        np.append(rows, 0),
        np.append(circuit.input, last),
        np.append(circuit.output, first + gained),
        np.append(circuit.time, period),
        tuple(slice(a, b + 1) for a, b in pairwise(starts)),
    )


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The places of a linkage along a walk, in the report frame [length].

    `places` (n, 4 + k, 3): A0, A, B, B0 and k further named points, `names` of each; `axes` (2, 3) unit
    vectors along the joints at A0 and B0; `stays` the chains of places that tie further points to links.
    """

    places: Floats
    names: tuple[str, ...]
    axes: Floats
    stays: tuple[tuple[int, int, int], ...]

    def pose(self, row: float) -> Floats:
        """The places (4 + k, 3) at a row, between two rows on the straight line between them."""
        low = min(int(row), len(self.places) - 1)
        high, share = min(low + 1, len(self.places) - 1), row - low
        between: Floats = (1 - share) * self.places[low] + share * self.places[high]
        return self.places[low] if share == 0 else between

    @property
    def moving(self) -> tuple[int, ...]:
        """The places whose paths are drawn."""
        return (A, B, *range(4, len(self.names)))

    @property
    def span(self) -> float:
        """The largest extent along x, y or z [length]."""
        flat = self.places.reshape(-1, 3)
        return float((np.nanmax(flat, axis=0) - np.nanmin(flat, axis=0)).max())


def skeleton(motion: Motion, circuit: Circuit) -> Skeleton:
    """The places of the linkage along the walk of a circuit."""
    linkage: Linkage = motion.linkage
    rows = walk(motion, circuit).rows
    traces = [circuit.point(point.link, point.at).position[rows] for point in linkage.points]
    solved = np.flatnonzero(~np.isnan(traces[0]).any(axis=1) & ~np.isnan(traces[1]).any(axis=1))
    if solved.size == 0:
        raise RequestError(
            f"circuit: circuit {circuit.index} has no pose at the inputs of the law; nothing to draw"
        )
    frames = (linkage.base, linkage.base @ inverse(linkage.transforms[-1]))
    axes = np.stack([frame[:3, 2] for frame in frames])
    centres = []
    for frame, axis, trace in zip(frames, axes, traces, strict=False):
        arm = trace[solved[0]] - frame[:3, 3]
        centres.append(np.broadcast_to(frame[:3, 3] + (arm @ axis) * axis, trace.shape))
    places = np.stack([centres[0], traces[0], traces[1], centres[1], *traces[2:]], axis=1)
    names = ("A₀", "A", "B", "B₀", *(_short(point.name, 24) for point in linkage.points[2:]))
    ends = [LINK_ENDS[point.link] for point in linkage.points[2:]]
    return Skeleton(places, names, axes, tuple((a, 4 + i, b) for i, (a, b) in enumerate(ends)))


def configuration(motion: Motion, circuit: int = 0, positions: int = 6) -> Figure:
    """The linkage in space, in several positions spread over a circuit: one strong, the others faint.

    `circuit` is its index in `motion.circuits`, `positions` how many poses (1 to 100). Lengths are in the
    linkage's unit, equal along all three axes. Raises `RequestError` where there is no such circuit.

    Source: Sun and Zhou, Figure 3.
    """
    chosen = chosen_circuit(motion, circuit)
    if (
        isinstance(positions, bool)
        or not isinstance(positions, (int, np.integer))
        or not 1 <= positions <= 100
    ):
        raise RequestError(f"positions: {shown(positions)} is not a count; give 1 to 100")
    frame = skeleton(motion, chosen)
    poses = [frame.pose(row) for row in _spread(motion, chosen, frame, int(positions))]
    with rc_context(STYLE):
        figure = new_figure(7.0, 7.0)
        axes = figure.add_axes((0.0, 0.02, 1.0, 1.0), projection="3d")
        stage(axes, motion, frame)
        for pose in poses[1:]:
            put(bars(axes, motion, frame, ghost=True), pose)
        put(bars(axes, motion, frame), poses[0])
        label(axes, frame, poses[0], range(len(frame.names)))
        which = f"circuit {chosen.index}, {len(poses)} position{'s' * (len(poses) > 1)}"
        figure.suptitle(f"{title(motion)}\n{which}", fontsize=11)
        figure.legend(handles=link_keys(motion, frame), loc="lower center", ncols=4, frameon=False)
    return figure


def chosen_circuit(motion: Motion, index: int) -> Circuit:
    """The circuit of this index, or `RequestError` saying why there is none."""
    count = len(motion.circuits)
    if count == 0:
        closing = "at no input" if motion.motion_type == "cannot-assemble" else "along no circuit"
        raise RequestError(
            f"motion: {motion.motion_type}, the loop closes {closing}, so there is nothing to draw"
        )
    if isinstance(index, bool) or not isinstance(index, (int, np.integer)) or not 0 <= index < count:
        allowed = "0" if count == 1 else f"0 to {count - 1}"
        raise RequestError(f"circuit: {shown(index)} is not a circuit of this motion; give {allowed}")
    return motion.circuits[index]


def new_figure(width: float, height: float) -> Figure:
    """An empty white figure [inch] with a canvas of its own, outside pyplot's register."""
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def title(motion: Motion) -> str:
    """The linkage's name and motion type."""
    return f"{_short(motion.linkage.name, 60)}: {motion.motion_type}"


def _short(text: str, width: int) -> str:
    return text if len(text) <= width else text[: width - 1] + "…"


def _spread(motion: Motion, circuit: Circuit, frame: Skeleton, positions: int) -> list[int]:
    """Rows with a pose, evenly spread by the travel of both angles, a rocking circuit's off its ends."""
    path = walk(motion, circuit)
    solved = np.flatnonzero(~np.isnan(frame.places[:, :4]).any(axis=(1, 2)))
    steps = np.hypot(np.diff(path.input[solved]), np.diff(path.output[solved]))
    travel = np.concatenate([[0.0], np.cumsum(steps)])
    start = 0.0 if circuit.input_range is None else 0.5
    wanted = (np.arange(positions) + start) / positions * travel[-1]
    return [int(solved[np.argmin(np.abs(travel - place))]) for place in wanted]


def stage(axes: Any, motion: Motion, frame: Skeleton) -> None:
    """Draws into 3D axes what stands still: paths, ground, bearings, joint axes; and sets the view."""
    axes.computed_zorder = False
    elevation, azimuth = _view(frame)
    axes.view_init(elevation, azimuth)
    axes.set_proj_type("ortho")
    drawn = [frame.places.reshape(-1, 3)]
    for place, colour in zip(frame.moving, (*_ends_colours(motion), *_point_colours(frame)), strict=True):
        path = _arc(frame, place) if place in (A, B) else frame.places[:, place]
        axes.plot(*path.T, color=colour, lw=1.1, alpha=0.85, zorder=2)
    unit = 0.02 * frame.span
    ground = frame.pose(0)[[A0, B0]]
    axes.plot(*ground.T, color=GROUND, lw=3, alpha=0.6, zorder=2, solid_capstyle="round")
    middle = np.nanmean(frame.places.reshape(-1, 3), axis=0)
    for centre, axis, arm in zip(ground, frame.axes, _arms(frame), strict=True):
        away = float(axis @ (centre - middle))
        down = -math.copysign(1.0, axis[2] or 1.0)
        side = axis * (math.copysign(1.0, away) if abs(away) > 0.1 * frame.span else down)
        drawn.append(_bearing(axes, centre, side, unit, min(unit, max(0.4 * unit, 0.4 * arm))))
    _equal_box(axes, np.concatenate(drawn), motion.linkage.length_unit)


def _arc(frame: Skeleton, ball: int) -> Floats:
    """The arc of a circle that A or B runs over, smooth however coarse the rows are."""
    end = 0 if ball == A else 1
    centre = frame.pose(0)[(A0, B0)[end]]
    arms = frame.places[:, ball] - centre
    arms = arms[~np.isnan(arms).any(axis=1)]
    across = np.cross(frame.axes[end], arms[0])
    turn = np.unwrap(np.arctan2(arms @ across, arms @ arms[0]))
    grid = np.linspace(turn.min(), turn.max(), 241)[:, None]
    arc: Floats = centre + np.cos(grid) * arms[0] + np.sin(grid) * across
    return arc


def _arms(frame: Skeleton) -> tuple[float, float]:
    distances = np.linalg.norm(frame.places[:, [A, B]] - frame.places[:, [A0, B0]], axis=2)
    crank, rocker = np.nanmax(distances, axis=0)
    return float(crank), float(rocker)


def _view(frame: Skeleton) -> tuple[float, float]:
    """Elevation and azimuth [deg] that show both circles open and the ground link from the side."""
    # none along an axis of the box, whose labels would fall together
    azimuths = (np.arange(-180.0, 180.0, 90.0)[:, None] + [20.0, 30.0, 45.0, 60.0, 70.0]).ravel()
    elevation, azimuth = (grid.ravel() for grid in np.meshgrid([20.0, 30.0, 40.0, 50.0], azimuths))
    up, round_ = np.radians(elevation), np.radians(azimuth)
    towards = np.stack([np.cos(up) * np.cos(round_), np.cos(up) * np.sin(round_), np.sin(up)], axis=1)
    opened = np.abs(towards @ frame.axes.T).min(axis=1)
    ground = frame.pose(0)[B0] - frame.pose(0)[A0]
    end_on = np.abs(towards @ ground) / (np.linalg.norm(ground) or 1.0)
    # among like views the usual one, x to the right and y away
    unusual = (1 - np.cos(np.radians(azimuth + 60.0))) / 2 + np.abs(elevation - 30.0) / 100
    best = int(np.argmax(np.minimum(opened, 0.6) - 0.4 * end_on**2 - 0.3 * unusual))
    return float(elevation[best]), float(azimuth[best])


def _bearing(axes: Any, centre: Floats, side: Floats, unit: float, radius: float) -> Floats:
    """An R joint on the ground: cylinder, axis, hatched plate on the far side; returns their hull (n, 3)."""
    across = np.cross(side, np.eye(3)[np.argmin(np.abs(side))])
    u = across / np.linalg.norm(across)
    v = np.cross(side, u)
    turn = np.linspace(0, math.tau, 17)
    ring = radius * (np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v)
    near, far = centre - 1.8 * unit * side + ring, centre + 1.8 * unit * side + ring
    wall = [np.stack([near[i], near[i + 1], far[i + 1], far[i]]) for i in range(16)]
    foot = centre + 4.5 * unit * side
    corners = [foot + 2.8 * unit * (p * u + q * v) for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    plate = Poly3DCollection([corners], facecolors="#e4e4e4", edgecolors=GROUND, lw=0.8, zorder=3)
    axes.add_collection3d(plate)
    # strokes at 45 degrees behind the plate's edge say "ground"
    for p in np.linspace(-1, 0.6, 6):
        ends = foot + 2.8 * unit * np.stack([p * u - v, (p + 0.4) * u - v + 0.4 * side])
        axes.plot(*ends.T, color=GROUND, lw=0.8, zorder=3)
    axes.plot(*np.stack([centre, foot]).T, color=GROUND, lw=2.2, zorder=3)
    ends = np.stack([centre - 8 * unit * side, centre + 8 * unit * side])
    axes.plot(*ends.T, color="#404040", lw=0.9, ls=(0, (7, 2, 1.5, 2)), zorder=4)
    # apart, for faces of unlike corner counts in one collection are padded with what the memory held
    for faces in (wall, [near[:-1], far[:-1]]):
        look = {"facecolors": "#b8b8b8", "edgecolors": "#707070", "lw": 0.25, "zorder": 5}
        axes.add_collection3d(Poly3DCollection(faces, **look, shade=True))
    return np.concatenate([ends, near, far, np.stack(corners)])


def _equal_box(axes: Any, drawn: Floats, unit: str) -> None:
    """Limits round everything drawn, a length unit as long along each axis, as large as the axes can hold."""
    low, high = np.nanmin(drawn, axis=0), np.nanmax(drawn, axis=0)
    extent = np.maximum(high - low, THINNEST_BOX * (high - low).max()) * 1.04
    middle = (low + high) / 2
    for index, name in enumerate("xyz"):
        ends = (middle[index] - extent[index] / 2, middle[index] + extent[index] / 2)
        getattr(axes, f"set_{name}lim3d")(*ends, view_margin=0)
        scale = getattr(axes, f"{name}axis")
        scale.set_major_locator(MaxNLocator(max(2, round(6 * extent[index] / extent.max()))))
        # labels stand off by a share of the other two sides
        stand_off = max(1.0, 0.9 * extent.max() / float(np.linalg.norm(np.delete(extent, index))))
        scale.set_tick_params(labelsize=7.5, pad=10 * stand_off - 8)
        scale.set_label_text(f"{name} [{unit}]")
        scale.labelpad = 25 * stand_off - 21
    right, above = _screen(axes)
    seen = max(np.abs(right) @ extent, np.abs(above) @ extent * 1.06) / np.linalg.norm(extent)
    axes.set_box_aspect(extent, zoom=0.74 / seen)


def _ends_colours(motion: Motion) -> tuple[str, str]:
    """The colours of links 1 and 3."""
    return (INPUT, OUTPUT) if motion.input == motion.linkage.joints[0].name else (OUTPUT, INPUT)


def _point_colours(frame: Skeleton) -> list[str]:
    return [POINT_COLOURS[i % len(POINT_COLOURS)] for i in range(len(frame.names) - 4)]


Bars = list[tuple[Any, tuple[int, ...]]]


def bars(axes: Any, motion: Motion, frame: Skeleton, *, ghost: bool = False) -> Bars:
    """New artists for one pose, each with the places it joins: bars, balls, points; `put` moves them."""
    first, second = _ends_colours(motion)
    order, width = (3, 2.0) if ghost else (6, 5.0)
    look = {"alpha": 0.28 if ghost else 1.0, "zorder": order}
    made: Bars = []

    def add(places: tuple[int, ...], **style: Any) -> None:
        line = Line3D([], [], [], solid_capstyle="round", **look | style)
        axes.add_line(line)
        made.append((line, places))

    for places in frame.stays:
        add(places, color=COUPLER if places[::2] == LINK_ENDS[2] else GROUND, lw=width / 3)
    for link, colour in ((2, COUPLER), (1, first), (3, second)):
        outline = [] if ghost else [withStroke(linewidth=width + 1.6, foreground="#202020"), Normal()]
        add(LINK_ENDS[link], color=colour, lw=width, path_effects=outline)
    ball = {"ls": "", "marker": "o", "zorder": order + 1}
    size = 3.0 if ghost else 9.0
    add((A, B), **ball, color="#303030", ms=size)
    if not ghost:
        add((A, B), **ball, color="#f4f4f4", ms=size / 2.6)
    for place, colour in zip(range(4, len(frame.names)), _point_colours(frame), strict=True):
        add((place,), **ball, color=colour, ms=0.6 * size)
    return made


def put(made: Bars, pose: Floats) -> None:
    """Moves the artists of `bars` to a pose, places (4 + k, 3)."""
    for artist, places in made:
        artist.set_data_3d(*pose[list(places)].T)


def label(axes: Any, frame: Skeleton, pose: Floats, places: Sequence[int]) -> None:
    """Writes the names of places of a pose, each on its freest side; what falls together shares one label."""
    screen = _screen(axes)
    seen = pose @ screen.T
    lines = [seen[[a, b]] for a, b in LINK_ENDS.values()]
    for centre, axis in zip((A0, B0), frame.axes @ screen.T * frame.span / 6, strict=True):
        lines.append(np.stack([seen[centre] - axis, seen[centre] + axis]))
    named: dict[int, list[str]] = {}
    for i in places:
        near = [k for k in named if np.linalg.norm(seen[k] - seen[i]) < 0.03 * frame.span]
        named.setdefault(near[0] if near else i, []).append(frame.names[i])
    turns = np.linspace(0, math.tau, 24, endpoint=False)
    for i, names in named.items():
        spots = seen[i] + 0.06 * frame.span * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        best = turns[int(np.argmax([min(_distance(spot, line) for line in lines) for spot in spots]))]
        place = pose[i] + 0.045 * frame.span * np.array([math.cos(best), math.sin(best)]) @ screen
        side = "center" if abs(math.cos(best)) < 0.5 else "left" if math.cos(best) > 0 else "right"
        halo = [withStroke(linewidth=2.5, foreground="white")]
        axes.text(*place, ", ".join(names), fontsize=11, ha=side, va="center", zorder=9, path_effects=halo)


def _screen(axes: Any) -> Floats:
    """The directions, unit vectors (2, 3), that are seen as right and up."""
    up, round_ = math.radians(axes.elev), math.radians(axes.azim)
    above = [-math.sin(up) * math.cos(round_), -math.sin(up) * math.sin(round_), math.cos(up)]
    return np.array([[-math.sin(round_), math.cos(round_), 0.0], above])


def _distance(spot: Floats, line: Floats) -> float:
    along = line[1] - line[0]
    share = np.clip((spot - line[0]) @ along / ((along @ along) or 1.0), 0, 1)
    return float(np.linalg.norm(spot - line[0] - share * along))


def link_keys(motion: Motion, frame: Skeleton) -> list[Line2D]:
    """The legend's entries of a 3D view."""
    keys = [
        Line2D([], [], color=INPUT, lw=5, label=f"input: {_short(motion.input, 24)}"),
        Line2D([], [], color=COUPLER, lw=5, label="coupler"),
        Line2D([], [], color=OUTPUT, lw=5, label=f"output: {_short(motion.output, 24)}"),
        Line2D([], [], color=GROUND, lw=3, alpha=0.6, label="ground"),
    ]
    for place, colour in zip(frame.moving, (*_ends_colours(motion), *_point_colours(frame)), strict=True):
        keys.append(Line2D([], [], color=colour, lw=1.1, label=f"path of {frame.names[place]}"))
    return [*keys, Line2D([], [], color="#404040", lw=0.9, ls=(0, (7, 2, 1.5, 2)), label="joint axis")]


@dataclass(frozen=True, eq=False)
class Pass:
    """A pass of a circuit as drawn: `input`, `angle` [deg], `time` [s] and the two rates, arrays (n,)."""

    circuit: Circuit
    label: str
    style: dict[str, Any]
    input: Floats
    time: Floats
    angle: Floats
    velocity: Floats
    acceleration: Floats


def passes(motion: Motion) -> list[Pass]:
    """Every pass of every circuit; where the input goes back, the velocity is turned as it is in time."""
    made: list[Pass] = []
    for circuit in motion.circuits:
        path = walk(motion, circuit)
        for branch, part in enumerate(path.passes):
            label, way = f"circuit {circuit.index}", 1.0
            if len(path.passes) > 1:
                label += f", branch {branch}"
                if motion.law is None:
                    rise = path.input[part][-1] - path.input[part][0]
                    way = math.copysign(1.0, rise * motion.speed)
                    label += ": input rising" if rise > 0 else ": input falling"
            rates = path.rows[part], circuit.output_column
            colour = CIRCUIT_COLOURS[circuit.index % len(CIRCUIT_COLOURS)]
            style = {"color": colour, "ls": LINE_STYLES[len(made) % len(LINE_STYLES)], "lw": 1.6}
            angles = np.degrees(path.input[part]), path.time[part], np.degrees(path.output[part])
            made.append(Pass(circuit, label, style, *angles, way * circuit.dq[rates], circuit.ddq[rates]))
    return made


def curves(motion: Motion, against: Literal["both", "input", "time"] = "both") -> Figure:
    """Output angle [deg], velocity [rad/s] and acceleration [rad/s^2] of every circuit.

    `against` "input" [deg] or "time" [s] draws one of the two; "both" puts time on a second scale above where
    the input turns fully at constant speed, else in a second column. Where a rocking input goes back, the
    sign of the velocity is turned. Raises `RequestError` where the motion has no circuit.

    Source: Sun and Zhou, Figures 3 and 4.
    """
    chosen_circuit(motion, 0)
    if against not in ("both", "input", "time"):
        raise RequestError(f"against: {shown(against)} is not offered; give both, input or time")
    turning = motion.law is None and all(circuit.input_range is None for circuit in motion)
    columns = [against] if against != "both" else ["input"] if turning else ["input", "time"]
    drawn = passes(motion)
    with rc_context(STYLE):
        figure = new_figure(6.4 if len(columns) == 1 else 9.8, 7.8)
        figure.set_layout_engine("constrained", h_pad=0.05, w_pad=0.06)
        grid = figure.subplots(3, len(columns), sharex="col", sharey="row", squeeze=False)
        cut = False
        for row, quantity in enumerate(LABELS):
            for column, over in enumerate(columns):
                panel(grid[row, column], motion, drawn, quantity, over)
            cut |= _cut(grid[row, 0], drawn, quantity)
        for axes in grid.flat:
            axes.label_outer()
        if against == "both" and turning:
            _time_above(grid[0, 0], motion, drawn[0])
        figure.align_ylabels()
        figure.suptitle(title(motion), fontsize=11)
        keys = curve_keys(grid[0, 0], drawn)
        look = {"title": _note(motion, cut), "title_fontsize": 8.5, "frameon": False}
        figure.legend(handles=keys, loc="outside lower center", ncols=min(len(keys), 3), **look)
    return figure


def panel(axes: Axes, motion: Motion, drawn: Sequence[Pass], quantity: str, over: str) -> None:
    """Draws one quantity of the passes over "input" or "time", with the input limits and the extremes."""
    axes.grid(lw=0.6)
    for line in drawn:
        axes.plot(getattr(line, over), getattr(line, quantity), label=line.label, **line.style)
    for circuit in motion.circuits:
        own = [line for line in drawn if line.circuit is circuit]
        extremes: Extremes | None = getattr(circuit, quantity)
        if own and extremes is not None:
            sides = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
            values = [math.degrees(value) if quantity == "angle" else value for value, _ in sides]
            places = [
                _place(own, quantity, over, v, math.degrees(at))
                for v, (_, at) in zip(values, sides, strict=True)
            ]
            look = {"ms": 4.5, "mfc": "white", "mec": own[0].style["color"], "mew": 1.2, "zorder": 4}
            axes.plot(places, values, "o", ls="", label=EXTREME, **look)
    ends = np.concatenate([getattr(line, over) for line in drawn])
    room = 0.02 * np.ptp(ends) if over == "input" and motion.limits.size else 0.0
    if np.ptp(ends) > 0:
        axes.set_xlim(ends.min() - room, ends.max() + room)
    if over == "input":
        axes.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 1.5, 3, 4.5, 6, 10]))
        for inputs, style, name in ((motion.limits, "--", LIMIT), (motion.change_points, ":", CHANGE_POINT)):
            lifted = np.degrees(inputs) + 360.0 * np.arange(-4, 5)[:, None]
            for place in lifted[(lifted > ends.min() - 1e-6) & (lifted < ends.max() + 1e-6)]:
                axes.axvline(place, color="#505050", lw=1.0, ls=style, zorder=1, label=name)
    axes.set_xlabel(f"input angle: {_short(motion.input, 40)} [deg]" if over == "input" else "time [s]")
    axes.set_ylabel(("output " if quantity == "angle" else "") + LABELS[quantity])


def _place(own: Sequence[Pass], quantity: str, over: str, value: float, at: float) -> float:
    """Where along a panel the passes of a circuit take a value at an input [deg], known to whole turns."""
    found = [(math.inf, math.nan)]
    for line in own:
        off = (line.input - at + 180.0) % 360.0 - 180.0
        for i in np.flatnonzero((off[:-1] * off[1:] <= 0) & (np.abs(off[:-1] - off[1:]) < 180.0)):
            share = off[i] / (off[i] - off[i + 1]) if off[i] != off[i + 1] else 0.0
            x, y = (v[i] + share * (v[i + 1] - v[i]) for v in (getattr(line, over), getattr(line, quantity)))
            found.append((abs(y - value), x))
    return min(found)[1]


def _cut(axes: Axes, drawn: Sequence[Pass], quantity: str) -> bool:
    """Cuts the range of rates that grow without bound at input dead centres; tells whether it did."""
    drawn = [line for line in drawn if np.isfinite(getattr(line, quantity)).any()]
    if quantity not in CUT or not any(_rocking(line.circuit) for line in drawn):
        return False
    spans: list[Floats] = []
    for line in drawn:
        values = getattr(line, quantity)
        share = CUT[quantity] if _rocking(line.circuit) else 0.0
        spans.append(np.percentile(values[np.isfinite(values)], [share, 100 - share]))
    low, high = np.min(spans), np.max(spans)
    axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    return True


def _rocking(circuit: Circuit) -> bool:
    return any(centre.kind == "input" for centre in circuit.dead_centres)


def _time_above(axes: Axes, motion: Motion, line: Pass) -> None:
    rate, start = math.degrees(motion.speed), line.input[0]

    def time(angle: Any) -> Any:
        return (angle - start) / rate

    def angle(time: Any) -> Any:
        return start + time * rate

    above = axes.secondary_xaxis("top", functions=(time, angle))
    above.set_xlabel("time [s]")


def _note(motion: Motion, cut: bool) -> str:
    name = _short(motion.input, 40)
    note = f"{name} at {motion.speed:g} rad/s"
    if motion.law is not None:
        note = f"{name} driven by a law"
    elif any(circuit.input_range is not None for circuit in motion):
        note = f"{name} at ±{abs(motion.speed):g} rad/s"
    return note + ("; rates grow without bound at dead centres: axes cut" if cut else "")


def curve_keys(axes: Axes, drawn: Sequence[Pass]) -> list[Line2D]:
    """One legend entry for each pass and for each kind of mark."""
    lines = {str(line.get_label()): line for line in axes.lines}
    if EXTREME in lines:  # drawn in each circuit's colour
        lines[EXTREME] = Line2D([], [], ls="", marker="o", ms=4.5, mfc="white", mec="#404040", label=EXTREME)
    return [
        lines[label]
        for label in (*(line.label for line in drawn), EXTREME, LIMIT, CHANGE_POINT)
        if label in lines
    ]


def save(figure: Figure, path: str | os.PathLike[str]) -> Path:
    """Writes a figure as PNG (200 dpi), SVG or PDF, by the path's ending; returns the path.

    Raises `OutputError` for another ending and where the file cannot be written; then nothing is left behind.
    """
    target = Path(path)
    ending = target.suffix.lower().removeprefix(".")
    if ending not in FORMATS:
        raise OutputError(f"{target}: {shown(target.suffix)} is not a figure format; give .png, .svg or .pdf")
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with written_whole(target) as file, rc_context(STYLE):
        figure.savefig(file, format=ending, dpi=PNG_DPI, metadata=dates.get(ending))
    return target


@contextmanager
def written_whole(target: Path) -> Iterator[Path]:
    """A file beside `target` to write to; put in its place when all went well, else removed."""
    partial = target.parent / f".partial-{uuid.uuid4().hex}{target.suffix}"
    try:
        if target.is_dir():
            raise IsADirectoryError(0, "it is a folder")
        yield partial
        partial.replace(target)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(
            f"{target}: cannot be written: {reason}; give a path in a folder that exists and can be written"
        ) from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
