"""Where words stand on a map: names of regions in the room that lines, marks and values leave."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from rich.cells import cell_len

from sevenbar.arrays import Floats
from sevenbar.design.maps.atlas import Map

#: Places across a map where the name of a region is tried.
RASTER = 160

#: Height and width of a letter, relative to the size of the font.
LETTER = (1.35, 0.56)

#: The ink of boundaries and names.
LINE = "#1c1c1c"


def take(taken: np.ndarray, middle: Floats, half: Sequence[float]) -> None:
    """Marks a box [shares] as taken, so that no name is written there."""
    taken[_box(middle, half)] = True


def is_free(taken: np.ndarray, middle: Floats, half: Sequence[float]) -> bool:
    """Whether nothing of a box [shares] is taken."""
    return not taken[_box(middle, half)].any()


def write(axes: Axes, at: Floats, words: str, size: float, halo: tuple[float, str], **look: Any) -> None:
    """Words about a place (2,) [the dimensions' units], within a halo of a width and a colour."""
    look = {"ha": "center", "va": "center", "zorder": 7, **look}
    label = axes.text(float(at[0]), float(at[1]), words, fontsize=size, **look)
    label.set_path_effects([withStroke(linewidth=halo[0], foreground=halo[1])])


def _box(middle: Floats, half: Sequence[float]) -> tuple[slice, slice]:
    low = np.clip(((middle - half) * RASTER).astype(int), 0, RASTER)
    high = np.clip(np.ceil((middle + half) * RASTER).astype(int), 0, RASTER)
    return slice(low[1], high[1]), slice(low[0], high[0])


def names(axes: Axes, of: Map, scale: float, taken: np.ndarray, inches: tuple[float, float]) -> None:
    """Writes the name of each region where it fits, lying or standing, in the place with most room."""
    ticks = (np.arange(RASTER) + 0.5) / RASTER
    x, y = np.meshgrid(ticks, ticks)
    places = np.column_stack([x.ravel(), y.ravel()])
    box = axes.get_position()
    size = np.array([box.width * inches[0], box.height * inches[1]])
    for region in of.regions:
        free = region.holds(places).reshape(RASTER, RASTER) & ~taken
        name = of.name(of.kinds[region.kind])
        for points in (15.0, 12.0, 9.5):
            letter = points * scale / 72
            text = np.array([LETTER[1] * letter * cell_len(name), LETTER[0] * letter])
            result = None
            for rotation, extent in ((0, text), (90, text[::-1])):
                result = result or _room(free, extent / size, rotation)
            if result:
                (px, py), rotation = result
                at = of.values(np.array([[px, py]]))[0]
                write(axes, at, name, points * scale, (3 * scale, "#ffffffb0"), rotation=rotation, color=LINE)
                break


def _room(free: np.ndarray, extent: Floats, rotation: int) -> tuple[tuple[float, float], int] | None:
    """The middle [shares] of the free box of this extent [shares] with most room round it, if any."""
    best = None
    for room in (2.4, 1.7, 1.25, 1.05):
        w, h = np.maximum(1, np.ceil(extent * RASTER * np.array([1 + (room - 1) * 0.4, room]))).astype(int)
        if w > RASTER or h > RASTER:
            continue
        total = np.zeros((RASTER + 1, RASTER + 1))
        total[1:, 1:] = np.cumsum(np.cumsum(free, axis=0), axis=1)
        inside = total[h:, w:] - total[:-h, w:] - total[h:, :-w] + total[:-h, :-w]
        rows, columns = np.nonzero(inside == w * h)
        if rows.size:
            # of all places the one nearest to their middle
            away = np.hypot(rows - rows.mean(), columns - columns.mean())
            i = int(away.argmin())
            best = ((columns[i] + w / 2) / RASTER, (rows[i] + h / 2) / RASTER)
            break
    return None if best is None else (best, rotation)
