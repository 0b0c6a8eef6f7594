"""How a figure with pictures of a linkage is laid out: title, pictures, legend, no empty paper between."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import headline, new_figure, refuse_small
from sevenbar.drawing.scene import draw_box, frame_box
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.drawing.space import (
    Box,
    ViewAxes,
    box_round,
    draw_frame,
    fit,
    measuring,
    room_beside,
    seen_size,
    set_limits,
)
from sevenbar.drawing.style import letters, page_size
from sevenbar.drawing.view import Projection

#: Room [inch], for letters of 9 points: round the page; at the sides of a picture, for numbers and names of
#: its axes, left, right, below, above.
EDGE, FLAT_MARGINS, SOLID_MARGINS = 0.08, (0.62, 0.16, 0.46, 0.12), (0.5, 0.5, 0.42, 0.26)
#: Height of a line of letters by their size, and room [inch] between the title of a panel and the panel.
LINE, PANEL_ROOM = 1.2, 0.08
#: A picture is so high at least and at most, as shares of its width.
LOWEST, HIGHEST = 0.3, 1.15
#: Share of the caller's axes that the box of three dimensions fills.
FILL = 0.72
#: What to draw on a small page.
ALONE = "draw the linkage alone (--kind skeleton, plot.skeleton)"
#: Columns of a legend.
MOST_COLUMNS = 6

#: A rectangle of the page [inch]: left, bottom, width, height.
Rectangle = tuple[float, float, float, float]


def margins(view: Projection) -> Floats:
    """Room [inch] that the labels round a picture need: left, right, below, above."""
    return np.array(FLAT_MARGINS if view.flat else SOLID_MARGINS) * letters() / 9.0


def write_title(figure: Figure, text: str) -> float:
    """Writes a title at the top of the page; returns the height [inch] that it takes."""
    if not text:
        return EDGE / 2
    height = float(figure.get_figheight())
    title = headline(figure, text, y=1 - EDGE / height, va="top")
    return title.get_window_extent(measuring(figure)).height / figure.dpi + 1.8 * EDGE


def write_title_over_panels(figure: Figure, text: str) -> tuple[float, float]:
    """Writes a title; returns where titles of panels stand, and where these panels end.

    Both are shares of the page's height.
    """
    height = float(figure.get_figheight())
    line = LINE * (letters() + 1) / 72
    below = height - write_title(figure, text)
    return (below - line) / height, (below - line - PANEL_ROOM) / height


def write_legend(
    figure: Figure, handles: Sequence[Any], *, centre: float | None = None, width: float | None = None
) -> float:
    """Writes a legend at the foot of the page, in as few lines as fit; returns its height [inch].

    `centre` and `width` [inch] are those of the part of the page that is its own, all of it by default.
    """
    if not handles:
        return EDGE / 2
    page = figure.get_size_inches()
    place = ((page[0] / 2 if centre is None else centre) / page[0], EDGE / 2 / page[1])
    made: Legend | None = None
    for columns in range(min(len(handles), MOST_COLUMNS), 0, -1):
        # no more columns than equal lines need
        lines = -(-len(handles) // columns)
        made = figure.legend(
            handles=list(handles), loc="lower center", bbox_to_anchor=place, ncols=-(-len(handles) // lines),
            frameon=False, borderaxespad=0.0, columnspacing=1.4,
        )  # fmt: skip
        size = made.get_window_extent(measuring(figure))
        if columns == 1 or size.width / figure.dpi <= (width or page[0]) - EDGE:
            break
        made.remove()
    assert made is not None
    return float(size.height / figure.dpi) + 1.5 * EDGE


def set_height(figure: Figure, height: float) -> None:
    """Gives the page another height [inch], title and legend keeping their distance from its edges."""
    figure.set_figheight(height)
    title = figure._suptitle  # type: ignore[attr-defined]
    if title is not None:
        title.set_y(1 - EDGE / height)
    for legend in figure.legends:
        (x, _), _ = legend.get_bbox_to_anchor().transformed(figure.transFigure.inverted()).get_points()
        legend.set_bbox_to_anchor((x, EDGE / 2 / height), figure.transFigure)


def own_axes(figure: Figure, view: Projection) -> Any:
    """New axes on a figure, of the kind that a view needs; `prepare` places them."""
    if view.flat:
        return figure.add_axes((0.1, 0.1, 0.8, 0.8))
    return figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")


def picture_height(view: Projection, box: Box, width: float) -> float:
    """The height [inch] of a picture with its labels that is so wide [inch] with them."""
    left, right, below, above = margins(view)
    wide, tall = seen_size(view, box)
    inner = width - left - right
    return float(np.clip(inner * tall / (wide or 1.0), LOWEST * inner, HIGHEST * inner) + below + above)


def page_of_one(
    ax: Any,
    view: Projection,
    box: Box,
    heading: str,
    handles: Sequence[Any],
    *,
    usual: float,
    figsize: Sequence[float] | None,
    style: str | None,
) -> tuple[Figure, ViewAxes, Rectangle | None]:
    """A page with a title, one picture and a legend; its axes, and the room of the picture.

    It has the `usual` width [inch] unless `figsize` or the style gives another, and without `figsize` the
    height that the picture needs. The caller's `ax` are on a page of their own, and have no room.
    """
    if ax is not None:
        return ax.figure.figure, ViewAxes(ax, view), None
    figure = new_figure(*page_size(style, figsize, (usual, usual), wide=False))
    top, foot = write_title(figure, heading), write_legend(figure, handles)
    width, height = figure.get_size_inches()
    if figsize is None:
        height = top + foot + picture_height(view, box, width)
        set_height(figure, height)
    left, right, below, above = margins(view)
    wide, tall = width - left - right, height - top - foot - below - above
    refuse_small(figure, wide, tall, "this picture with its numbers and words", ALONE)
    return figure, ViewAxes(own_axes(figure, view), view), (0.0, foot, width, height - top - foot)


def _fit_picture(space: ViewAxes, box: Box, room: Rectangle) -> None:
    """Places axes on the page so that their box and its labels fill a rectangle."""
    left, right, below, above = margins(space.view)
    if space.view.flat:
        # long numbers need more
        left = max(left, room_beside(space) + EDGE)
    inner = (room[0] + left, room[1] + below, room[2] - left - right, room[3] - below - above)
    fit(space, box, inner)
    space.axes.apply_aspect()


def prepare(space: ViewAxes, frame: Skeleton, room: Rectangle | None) -> None:
    """Limits, place on the page and frame of the axes, for all that a picture of a frame shows.

    The caller's axes, which keep their place, have no `room`.
    """
    box = frame_box(frame, space.view)
    _place(space, box, room)
    draw_box(space, frame, box)


def prepare_box(
    space: ViewAxes, box: Box, unit: str, room: Rectangle | None, *, letters: str = "xyz"
) -> None:
    """The same for a box of any places."""
    _place(space, box, room)
    draw_frame(space, box, unit, letters=letters)


def _place(space: ViewAxes, box: Box, room: Rectangle | None) -> None:
    set_limits(space, box)
    if room is None:
        _fill_given(space, box)
    else:
        _fit_picture(space, box, room)


def _fill_given(space: ViewAxes, box: Box) -> None:
    """Makes the box as large as the caller's axes can hold with its labels."""
    axes, view = space.axes, space.view
    axes.apply_aspect()
    if view.flat:
        return
    seen = np.ptp(space.pixels(box.outline), axis=0) / (axes.bbox.width, axes.bbox.height)
    axes.set_box_aspect(box.high - box.low, zoom=FILL / float(seen.max()))
    axes.apply_aspect()


def place_picture(
    figure: Figure, places: Floats, room: Rectangle, unit: str, view: Projection, *, letters: str = "xyz"
) -> ViewAxes:
    """New axes that show places (n, 3) in a rectangle of the page; `letters` name the axes of space."""
    space = ViewAxes(own_axes(figure, view), view)
    prepare_box(space, box_round(places, view), unit, room, letters=letters)
    return space
