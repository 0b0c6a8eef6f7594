"""Axes in which places of three dimensions are drawn, flat or not, with a frame whose labels stay apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import Line3D, Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]

from sevenbar.arrays import Floats
from sevenbar.drawing import style
from sevenbar.drawing.style import QUIET, stroke
from sevenbar.drawing.view import Projection

#: The thinnest side of the drawn box, as a share of its longest.
THINNEST_BOX = 0.4
#: Room between what is drawn and the frame, as a share of the extent.
ROOM = 0.02
#: An edge of the box seen shorter than this share of its longest has no ticks.
END_ON = 0.08
#: Inches of an edge for each tick, and how many ticks there are at least and at most.
FOR_A_TICK, TICKS = 0.42, (2, 7)
#: Distance [points] of numbers from their edge, and of an axis' name from its numbers.
OFF, BEYOND = 4.0, 2.0
#: Height of a name with its brackets, as a share of the size of its letters; points in an inch.
UPRIGHT, POINTS = 1.4, 72.0

#: A tall box reaches out of the axes in which matplotlib puts it.
WHOLE: dict[str, Any] = {"clip_on": False}

PANE, EDGE, GRID = "#f3f3f5", "#9a9a9a", "#dedede"


class ViewAxes:
    """Axes of matplotlib and the view they show; what is drawn is given by places (n, 3) [length]."""

    def __init__(self, axes: Any, view: Projection) -> None:
        self.axes, self.view = axes, view
        #: boxes of texts [pixels] that others keep off
        self.taken: list[Bbox] = []

    def line(self, places: Floats, **look: Any) -> Any:
        """A new line along places; its widths follow the style."""
        look = {key: value * stroke() if key in ("lw", "ms", "mew") else value for key, value in look.items()}
        if self.view.flat:
            artist: Any = Line2D(*self.view.seen(places).T, **look)
            # its limits are those of the view
            self.axes.add_artist(artist) if not len(places) else self.axes.add_line(artist)
            return artist
        artist = Line3D(*places.T, **look, **WHOLE)
        self.axes.add_line(artist)
        return artist

    def panel(self, colour: Any, order: float) -> Any:
        """A new pale face of a flat view, without an edge."""
        artist = Polygon(np.empty((0, 2)), facecolor=colour, edgecolor="none", zorder=order)
        self.axes.add_artist(artist)
        return artist

    def put(self, artist: Any, places: Floats) -> None:
        """Moves a line or a panel to places."""
        if isinstance(artist, Polygon):
            artist.set_xy(self.view.seen(places))
        elif self.view.flat:
            artist.set_data(*self.view.seen(places).T)
        else:
            artist.set_data_3d(*places.T)

    def strokes(self, segments: Sequence[Floats], colour: Any, width: float, order: float) -> None:
        """Draws segments (n, 2, 3) that stay."""
        look: dict[str, Any] = {"colors": [colour], "linewidths": width * stroke(), "zorder": order}
        if not len(segments):
            return
        if self.view.flat:
            self.axes.add_collection(LineCollection([self.view.seen(s) for s in segments], **look))
        else:
            self.axes.add_collection3d(Line3DCollection(list(segments), **look, **WHOLE))

    def face(self, corners: Floats, colour: Any, edge: Any, width: float, order: float) -> None:
        """Draws a filled polygon (n, 3) that stays."""
        look: dict[str, Any] = {"facecolors": [colour], "edgecolors": [edge], "zorder": order}
        look["linewidths"] = width * stroke()
        if self.view.flat:
            self.axes.add_collection(PolyCollection([self.view.seen(corners)], **look))
        else:
            self.axes.add_collection3d(Poly3DCollection([corners], **look, **WHOLE))

    def anchor(self, places: Floats) -> Floats:
        """Where places (n, 3) are in the data coordinates of the page (n, 2)."""
        if self.view.flat:
            return self.view.seen(places)
        x, y, _ = proj3d.proj_transform(*np.asarray(places).T, self.axes.get_proj())
        return np.stack([x, y], axis=-1)

    def pixels(self, places: Floats) -> Floats:
        """Where places (n, 3) are on the page [pixels] (n, 2)."""
        result: Floats = self.axes.transData.transform(self.anchor(places))
        return result

    @property
    def figure(self) -> Figure:
        """The figure that it is a part of."""
        result: Figure = self.axes.figure.figure
        return result

    @property
    def point(self) -> float:
        """The size of a point [pixels]."""
        return float(self.figure.dpi) / 72.0

    def heading(self, text: str, x: float, y: float) -> None:
        """Writes the title of the axes, its lower middle at a place of the page [inch]."""
        place = self.figure.dpi_scale_trans.transform((x, y))
        across, up = self.axes.transAxes.inverted().transform(place)
        self.axes.set_title(text, x=across, y=up, pad=0.0, fontsize=style.letters() + 1)

    def word(self, text: str, place: Floats, offset: Floats, **look: Any) -> Any:
        """A text whose middle is `offset` (2,) [points] from a place (3,)."""
        x, y = self.anchor(place[None])[0]
        return self.axes.annotate(
            text, (x, y), xytext=tuple(offset), textcoords="offset points", ha="center", va="center",
            annotation_clip=False, **look,
        )  # fmt: skip


def measuring(figure: Figure) -> RendererAgg:
    """What measures the texts of a figure, whatever its canvas."""
    width, height = figure.get_size_inches() * figure.dpi
    return RendererAgg(max(width, 1), max(height, 1), figure.dpi)  # type: ignore[no-untyped-call]


@dataclass(frozen=True, eq=False)
class Box:
    """The lowest and highest corner (2,) or (3,) [length] of what is shown in a view.

    `outline` (n, 3) are the places that the page must hold: its corners, or what is drawn in place of a box.
    """

    low: Floats
    high: Floats
    outline: Floats


def box_round(places: Floats, view: Projection, outline: Floats | None = None) -> Box:
    """The box that shows places (n, 3) in a view."""
    known = places[np.isfinite(places).all(axis=1)]
    seen = view.seen(known) if view.flat else known
    low, high = seen.min(axis=0), seen.max(axis=0)
    extent = (1 + 2 * ROOM) * np.maximum(high - low, THINNEST_BOX * (high - low).max() or 1.0)
    if view.flat:
        extent = high - low + 2 * 2.5 * ROOM * (np.max(high - low) or 1.0)
        extent = np.maximum(extent, 0.3 * extent.max())
    middle = (low + high) / 2
    low, high = middle - extent / 2, middle + extent / 2
    if outline is None:
        outline = np.empty((0, 3)) if view.flat else corners_of(low, high)
    return Box(low, high, outline)


def set_limits(space: ViewAxes, box: Box) -> None:
    """Gives the axes these limits, a length unit as long in all directions."""
    axes, view, low, high = space.axes, space.view, box.low, box.high
    if view.flat:
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        for scale, size in zip((axes.xaxis, axes.yaxis), seen_size(view, box), strict=True):
            count = max(3, round(8 * size / max(high - low)))
            scale.set_major_locator(MaxNLocator(count, steps=[1, 2, 5, 10]))
        return
    axes.computed_zorder = False
    axes.set_proj_type("ortho")
    axes.view_init(view.elevation, view.azimuth)
    for name, ends in zip("xyz", zip(low, high, strict=True), strict=True):
        getattr(axes, f"set_{name}lim3d")(*ends, view_margin=0)
    axes.set_axis_off()
    axes.set_box_aspect(high - low)


def room_beside(space: ViewAxes) -> float:
    """Width [inch] of what is written at the left of a flat picture: numbers, and the axis' name upright."""
    axis = space.axes.yaxis
    numbers = axis.get_tightbbox(measuring(space.figure))
    name = axis.labelpad + UPRIGHT * style.letters()
    return (0.0 if numbers is None else float(numbers.width) / space.figure.dpi) + float(name) / POINTS


def corners_of(low: Floats, high: Floats) -> Floats:
    """The corners (8, 3) of a box."""
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])


def seen_size(view: Projection, box: Box) -> tuple[float, float]:
    """Width and height [length] at which a box is seen."""
    width, height = box.high - box.low if view.flat else np.ptp(box.outline @ view.screen.T, axis=0)
    return float(width), float(height)


def fit(space: ViewAxes, box: Box, room: tuple[float, float, float, float]) -> None:
    """Places the axes so that the box fills a rectangle of the page: left, bottom, width, height [inch]."""
    figure, axes = space.figure, space.axes
    page = np.array(figure.get_size_inches())
    left, bottom, width, height = room
    if space.view.flat:
        axes.set_position((left / page[0], bottom / page[1], width / page[0], height / page[1]))
        return
    axes.set_position((0.0, 0.0, 1.0, 1.0))
    axes.apply_aspect()
    seen = space.pixels(box.outline) / figure.dpi
    size, middle = np.ptp(seen, axis=0), (seen.min(axis=0) + seen.max(axis=0)) / 2
    factor = min(width / size[0], height / size[1])
    # the page, which the axes fill now, larger by this factor, with the box in the middle of the room
    corner = np.array([left + width / 2, bottom + height / 2]) - factor * middle
    axes.set_position((*(corner / page), factor, factor))
    axes.apply_aspect()


def draw_frame(space: ViewAxes, box: Box, unit: str, *, letters: str = "xyz") -> None:
    """The box behind what is drawn: panes, grid, numbers and names of the axes, without collisions."""
    axes, view, low, high = space.axes, space.view, box.low, box.high
    names = [f"{letter} [{unit}]" if unit else letter for letter in letters]
    if view.flat:
        axes.set_xlabel(f"{view.letters[0]} [{unit}]")
        axes.set_ylabel(f"{view.letters[1]} [{unit}]")
        axes.grid(True)
        axes.set_axisbelow(True)
        return
    axes.set(xlabel=names[0], ylabel=names[1], zlabel=names[2])
    behind = view.towards > 0
    back, front = np.where(behind, low, high), np.where(behind, high, low)
    seen = space.pixels(corners_of(low, high))
    middle = seen.mean(axis=0)
    renderer = measuring(space.figure)
    longest = float(np.ptp(seen, axis=0).max())
    ticks, shown = [], []
    for axis in range(3):
        edge = _edge(space, axis, back, front)
        start, end = space.pixels(np.stack(edge))
        length = float(np.linalg.norm(end - start))
        inches = length / space.figure.dpi
        count = int(np.clip(inches / FOR_A_TICK, *TICKS))
        values = MaxNLocator(count, steps=[1, 2, 5, 10]).tick_values(low[axis], high[axis])
        room = 1e-9 * (high[axis] - low[axis])
        ticks.append([v for v in values if low[axis] - room <= v <= high[axis] + room])
        if length > END_ON * longest:
            shown.append((axis, edge))
    _panes(space, back, front, ticks)
    for axis, edge in shown:
        start, end = space.pixels(np.stack(edge))
        along = (end - start) / np.linalg.norm(end - start)
        out = np.array([along[1], -along[0]])
        out = out if out @ ((start + end) / 2 - middle) > 0 else -out
        widest = 0.0
        for value, text in zip(ticks[axis], _numbers(ticks[axis]), strict=True):
            place = np.array(edge[0])
            place[axis] = value
            reach = _keep_word(space, text, place, out, OFF, renderer, size=style.letters() - 1.5)
            widest = max(widest, reach)
        place, away = np.mean(edge, axis=0), OFF + BEYOND + widest
        if axis == 2:
            # at its upper end, where no room is lost at its side
            place, out, away = edge[1], along, 1.5 * OFF
        _keep_word(space, names[axis], place, out, away, renderer, size=style.letters(), needed=True)


def draw_axes(space: ViewAxes, centre: Floats, start: float, end: float) -> None:
    """Instead of a box: the directions x, y, z from a centre, drawn from one distance to another [length]."""
    space.axes.set(xlabel="x", ylabel="y", zlabel="z")
    renderer = measuring(space.figure)
    middle = space.pixels(centre[None])[0]
    for letter, way in zip("xyz", np.eye(3), strict=True):
        tip = centre + end * way
        out = space.pixels(tip[None])[0] - middle
        length = float(np.linalg.norm(out))
        if length < END_ON * abs(end) * space.point:
            continue
        front = way @ space.view.towards > 0
        space.strokes([np.stack([centre + start * way, tip])], QUIET, 1.0, 5 if front else 0.2)
        _keep_word(space, letter, tip, out / length, OFF / 2, renderer, size=style.letters(), needed=True)


def _edge(space: ViewAxes, axis: int, back: Floats, front: Floats) -> tuple[Floats, Floats]:
    """The edge of the box that has an axis' numbers: the lowest on the outline, or that at the left."""
    others = [k for k in range(3) if k != axis]
    result = []
    for first, second in ((back, front), (front, back)):
        start = np.where(np.arange(3) == others[0], first, second)
        start[axis], end = back[axis], start.copy()
        end[axis] = front[axis]
        pair = start if start[axis] < end[axis] else end, end if start[axis] < end[axis] else start
        seen = space.pixels(np.stack(pair)).mean(axis=0)
        result.append((seen[0] if axis == 2 else seen[1], pair))
    return min(result, key=lambda one: one[0])[1]


def _panes(space: ViewAxes, back: Floats, front: Floats, ticks: list[list[float]]) -> None:
    """The three faces of the box behind what is drawn, with lines at the ticks."""
    grid = []
    for axis in range(3):
        u, v = (k for k in range(3) if k != axis)
        corners = np.tile(back, (4, 1))
        corners[1, u] = corners[2, u] = front[u]
        corners[2, v] = corners[3, v] = front[v]
        space.face(corners, PANE, EDGE, 0.6, 0)
        for along, across in ((u, v), (v, u)):
            for value in ticks[along]:
                ends = np.tile(back, (2, 1))
                ends[:, along], ends[1, across] = value, front[across]
                grid.append(ends)
    space.strokes(grid, GRID, 0.6, 0.1)


def _numbers(values: Sequence[float]) -> list[str]:
    """Numbers at ticks, all with as many digits as their step needs."""
    step = min(np.diff(values), default=1.0)
    digits = max(0, -math.floor(math.log10(step) + 1e-9)) if step > 0 else 0
    if max(map(abs, values), default=0.0) >= 1e6 or digits > 6:
        return [f"{value:g}".replace("-", "−") for value in values]
    return [f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−") for value in values]


def _keep_word(
    space: ViewAxes, text: str, place: Floats, out: Floats, off: float, renderer: RendererAgg, *, size: float,
    needed: bool = False,
) -> float:  # fmt: skip
    """Writes a word at a place, outward; leaves it out where it met another, unless `needed`.

    Returns how far [points] it reaches beyond `off`.
    """
    word = space.word(text, place, np.zeros(2), fontsize=size)
    box = word.get_window_extent(renderer)
    half = float(np.abs(out) @ (box.width, box.height)) / 2 / space.point
    shift = (off + half) * out
    moved = box.translated(*(shift * space.point))
    if not needed and any(moved.padded(1.5 * space.point).overlaps(other) for other in space.taken):
        word.remove()
        return 0.0
    word.xyann = tuple(shift)
    space.taken.append(moved)
    return 2 * half
