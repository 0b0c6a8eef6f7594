"""A page of a path: wanted places and the path, in its plane or from several sides, and the errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.drawing.asked import asked_view
from sevenbar.drawing.figure import fit_letters, headline, page_figure
from sevenbar.drawing.page import place_picture
from sevenbar.drawing.style import COMPUTED, OTHER, letters, styled
from sevenbar.drawing.view import view_of
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.words import say

USED: dict[str, Any] = {"color": COMPUTED, "lw": 1.8, "zorder": 2, "label": "path, used part"}
WHOLE: dict[str, Any] = {"color": "#a8a8a8", "lw": 1.1, "zorder": 1, "label": "rest of its circuit"}
WANTED: dict[str, Any] = {
    "color": OTHER,
    "ls": "",
    "marker": "o",
    "mfc": "none",
    "mew": 1.0,
    "ms": 4.6,
    "zorder": 3,
    "label": "wanted points",
}

#: Of wanted points so many are numbered, the first and the last among them.
NUMBERED = 6

#: A path narrower than this part of its extent is seen from its edge.
EDGE = 0.1

#: Colour of the error's bars.
BAR = "#404040"


@dataclass(frozen=True, eq=False)
class PathPage:
    """What a page of a path shows: wanted places (n, 3), the used path (m, 3), `errors` (n,) at the places.

    `frames` are poses (k, 4, 3), an origin and the ends of three axes, each with a colour; `whole` (j, 3) all
    of the circuit's path.
    """

    wanted: Floats
    used: Floats
    errors: Floats
    title: str
    frames: Sequence[tuple[Floats, str]] = ()
    whole: Floats | None = None

    @property
    def lines(self) -> list[tuple[Floats, dict[str, Any]]]:
        """The lines of every view, each as it is drawn."""
        rest = [] if self.whole is None else [(self.whole, WHOLE)]
        axes = [
            (np.stack([frame[0], end]), {"color": colour, "lw": 1.2, "zorder": 2})
            for frames, colour in self.frames
            for frame in frames
            for end in frame[1:]
        ]
        return [*rest, (self.used, USED), *axes, (self.wanted, WANTED)]


def path_page(linkage: Linkage, page: PathPage) -> Figure:
    """Wanted places and path, and the distance at each place, the last panel.

    Of a planar linkage in its plane; of any other in space (a) and from three sides (b to d).
    """
    with styled():
        figure = page_figure(10.4, 7.6)
        every = np.concatenate([line for line, _ in page.lines])
        every = every[np.isfinite(every).all(axis=1)]
        asked = asked_view()
        if asked is None and not linkage.is_planar:
            asked = "space"
        view = view_of(asked, linkage, every)
        wide = 0.76 if view.planar else 0.47
        width, height = figure.get_size_inches()
        room = (0.015 * width, 0.35 * height, wide * width, 0.53 * height)
        space = place_picture(figure, every, room, linkage.length_unit, view)
        for line, look in page.lines:
            space.line(line, **_named(look))
        if view.planar:
            _number(space.axes, view.seen(page.wanted))
        else:
            _sides(figure, page, linkage.length_unit)
        where = say("in its plane") if view.planar else say("in space")
        figure.text(wide / 2 + 0.015, 0.885, f"(a) {where}", fontsize=letters() + 1, ha="center", va="bottom")
        _errors(figure, page, linkage.length_unit, "b" if view.planar else "e", wide)
        handles, labels = space.axes.get_legend_handles_labels()
        beside = (0.90, 0.61 if view.planar else 0.325)
        figure.legend(handles[::-1], labels[::-1], loc="center", bbox_to_anchor=beside, frameon=False)
        headline(figure, page.title)
    return figure


def _errors(figure: Figure, page: PathPage, unit: str, letter: str, wide: float) -> None:
    """The distance at each place as bars, below the picture and as wide."""
    errors = page.errors
    below = figure.add_axes((0.085, 0.085, wide - 0.08, 0.19))
    below.bar(np.arange(1, len(errors) + 1), errors, color=BAR, width=0.62)
    below.set_xlabel(say("wanted point"))
    below.set_ylabel(say("distance [{unit}]", unit=unit))
    below.set_xlim(0.3, len(errors) + 0.7)
    below.xaxis.set_major_locator(MaxNLocator(10, integer=True))
    below.yaxis.set_major_locator(MaxNLocator(4))
    below.grid(axis="y", lw=0.6)
    below.set_axisbelow(True)
    head = below.set_title(
        f"({letter}) "
        + say(
            "error: greatest {greatest:.3g} {unit}, root mean square {rms:.3g} {unit}",
            greatest=float(np.abs(errors).max()), rms=float(np.sqrt((errors**2).mean())), unit=unit,
        )
    )  # fmt: skip
    fit_letters(head, (wide - 0.08) * figure.get_figwidth())


def _sides(figure: Figure, page: PathPage, unit: str) -> None:
    """The same from three sides."""
    sides = (
        ("b", 0, 1, (0.565, 0.605, 0.18, 0.27)),
        ("c", 0, 2, (0.565, 0.19, 0.18, 0.27)),
        ("d", 1, 2, (0.81, 0.605, 0.18, 0.27)),
    )
    for letter, across, up, place in sides:
        axes = figure.add_axes(place)
        _side(axes, page, (across, up))
        axes.set_title(f"({letter}) " + say(" and ").join(("xyz"[across], "xyz"[up])))
        axes.set_xlabel(f"{'xyz'[across]} [{unit}]", labelpad=1)
        axes.set_ylabel(f"{'xyz'[up]} [{unit}]", labelpad=1)


def _named(look: dict[str, Any]) -> dict[str, Any]:
    """A look with its label in the language that is spoken."""
    return {**look, "label": say(look["label"])} if "label" in look else look


def _side(axes: Axes, page: PathPage, plane: tuple[int, int]) -> None:
    """Wanted points and path, seen along an axis."""
    for line, look in page.lines:
        axes.plot(line[:, plane[0]], line[:, plane[1]], **_named(look))
    # only where the path is not seen from its edge
    flat = np.ptp(page.wanted[:, list(plane)], axis=0).min() < EDGE * float(np.ptp(page.wanted, axis=0).max())
    if not flat:
        _number(axes, page.wanted[:, list(plane)])
    low, high = axes.get_xlim(), axes.get_ylim()
    # to one scale, and no line of a flat path pressed to the frame
    half = 0.56 * max(low[1] - low[0], high[1] - high[0])
    axes.set_xlim(sum(low) / 2 - half, sum(low) / 2 + half)
    axes.set_ylim(sum(high) / 2 - half, sum(high) / 2 + half)
    axes.set_aspect("equal")
    axes.grid(lw=0.6)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.yaxis.set_major_locator(MaxNLocator(4))


def _number(axes: Axes, seen: Floats) -> None:
    """Numbers of some wanted points, at their places (n, 2) in the picture."""
    count = len(seen)
    for i in np.unique(np.linspace(0, count - 1, min(NUMBERED, count)).astype(int)):
        axes.annotate(
            str(i + 1),
            seen[i],
            xytext=(4, 4),
            textcoords="offset points",
            fontsize=letters() - 1.5,
            color="#303030",
        )
