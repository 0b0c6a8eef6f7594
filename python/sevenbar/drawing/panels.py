"""The panels of a figure of curves: on a page of their own, or on the axes of the caller."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sevenbar.drawing.figure import (
    given_axes,
    headline,
    key_below,
    new_figure,
    refuse_small,
    tidy,
    title_text,
)
from sevenbar.drawing.style import page_size

Line = TypeVar("Line")

#: Which panels have one scale, as matplotlib names it.
Shared = bool | Literal["row", "col"]

#: Room [inch] above and at the sides of a panel.
PADS = (0.05, 0.06)


@dataclass(frozen=True, eq=False)
class Panels:
    """The panels of a figure in rows of `across`; `own` where they are on a page of their own."""

    figure: Figure
    axes: list[Axes]
    across: int
    own: bool

    def label_lowest(self) -> None:
        """Labels the input below the lowest panels alone, of a page of its own."""
        label = self.axes[-1].get_xlabel()
        for place, axes in enumerate(self.axes if self.own else ()):
            last = place + self.across >= len(self.axes)
            axes.tick_params(labelbottom=last)
            axes.set_xlabel(label if last else "")

    def label_outer(self) -> None:
        """As `label_lowest`, and the quantity of all at the left panels alone."""
        self.label_lowest()
        for place, axes in enumerate(self.axes if self.own else ()):
            if place % self.across:
                axes.set_ylabel("")

    def finish(
        self, title: bool | str, usual: str, handles: Sequence[Any] = (), *, heading: str = ""
    ) -> None:
        """Writes title and legend on a page of its own; axes of the caller have neither."""
        if self.own:
            if text := title_text(title, usual):
                headline(self.figure, text)
            key_below(self.figure, handles, heading)
            count = len(self.axes)
            what = f"{count} panels" if count > 1 else "a panel"
            wide, tall = self._least()
            refuse_small(
                self.figure, wide, tall, f"{what} with numbers and legend", "in Python fewer panels, or ax="
            )

    def _least(self) -> tuple[float, float]:
        """The least width and height [inch] of a panel, once titles, labels and legend have their room."""
        with warnings.catch_warnings():
            warnings.filterwarnings("error", "constrained_layout not applied")
            try:
                tidy(self.figure)
            except UserWarning:
                return 0.0, 0.0
        boxes = [axes.get_window_extent() for axes in self.axes]
        dpi = self.figure.dpi
        return min(box.width for box in boxes) / dpi, min(box.height for box in boxes) / dpi


def panels_of(
    count: int,
    ax: Any,
    what: str,
    page: tuple[float, float],
    *,
    across: int = 1,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    sharex: Shared = True,
    sharey: Shared = False,
) -> Panels:
    """So many panels in rows of `across` on a page of their own, or the caller's axes.

    `page` is the usual size [inch], `what` says in a message what axes are for. Raises `RequestError` for
    another number of them.
    """
    if ax is not None:
        axes = given_axes(ax, count, what)
        return Panels(axes[0].figure.figure, axes, count, own=False)
    down = math.ceil(count / across)
    figure = new_figure(*page_size(style, figsize, page, wide=across > 1), pads=PADS)
    grid = list(figure.subplots(down, across, squeeze=False, sharex=sharex, sharey=sharey).flat)
    for empty in grid[count:]:
        empty.remove()
    return Panels(figure, grid[:count], across, own=True)


def panels_across(count: int) -> int:
    """Columns of a grid of panels: few empty places, and as high as wide."""
    return min(
        (1, 2, 3, 4), key=lambda n: (-count % n) + abs(math.ceil(count / n) - 1.3 * n) + 9 * (n > count)
    )


def coinciding(lines: Sequence[Line], alike: Callable[[Line, Line], bool]) -> list[list[Line]]:
    """Lines in groups, each with those that are like its first one."""
    groups: list[list[Line]] = []
    for line in lines:
        group = next((group for group in groups if alike(group[0], line)), None)
        if group is None:
            groups.append([line])
        else:
            group.append(line)
    return groups
