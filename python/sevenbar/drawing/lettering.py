"""The names of joints and points in a picture: each on its freest side, clear of links and of each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

from sevenbar.arrays import Floats
from sevenbar.drawing.names import named_together
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.drawing.space import ViewAxes, measuring
from sevenbar.drawing.style import letters

#: Directions and distances [points] that are tried for a name.
DIRECTIONS, DISTANCES = 24, (8.0, 13.0, 19.0, 27.0, 38.0)
#: Joints nearer than this [points] in all poses share a name.
TOGETHER = 9.0
#: What it counts where a name lies on another, or off the page; on a link; and for each point of distance.
FORBIDDEN, ON_A_LINE, AWAY = 1e4, 1.0, 0.02
#: Places along a line at which it is looked for under a name.
ALONG = np.linspace(0.0, 1.0, 24)


def write_names(
    space: ViewAxes,
    frame: Skeleton,
    poses: Floats,
    *,
    within: Bbox | None = None,
    distances: Sequence[float] = DISTANCES,
) -> list[tuple[Any, int]]:
    """Writes the names of a frame, where they are in the first of poses (m, k, 3); returns texts and places.

    Each name keeps its offset in all poses, one of `distances` [points], chosen so that it is clear in most.
    `within` is the part of the page [pixels] to stay in, that of the axes where none is given.
    """
    inside = within or space.axes.get_window_extent()
    renderer = measuring(space.figure)
    seen = np.stack([space.pixels(pose) for pose in poses])
    # in each pose the lines, as places along them
    pairs = np.array(frame.lines)
    starts, ends = seen[:, pairs[:, 0]], seen[:, pairs[:, 1]]
    lines = (starts[:, :, None] + ALONG[:, None] * (ends - starts)[:, :, None]).reshape(len(poses), -1, 2)
    made: list[tuple[Any, int]] = []
    taken: list[Floats] = [np.tile(box.get_points().ravel(), (len(poses), 1)) for box in space.taken]
    turns = np.linspace(0, math.tau, DIRECTIONS, endpoint=False)
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    lost = {int(place) for place in np.flatnonzero(np.isnan(seen[0]).any(axis=1))}
    named = named_together(frame.names, seen, TOGETHER * space.point, lost | frame.far)
    for place, names in named.items():
        size = letters() + 1.5
        halo = [withStroke(linewidth=2.2, foreground="white")]
        text = space.word(
            ", ".join(names), poses[0, place], np.zeros(2), fontsize=size, zorder=9, path_effects=halo
        )
        box = text.get_window_extent(renderer)
        half = np.array([box.width, box.height]) / 2
        best, least = np.zeros(2), math.inf
        for distance in distances:
            offsets = ways * (distance * space.point + half)
            for offset in offsets:
                middle = seen[:, place] + offset
                cost = AWAY * distance + _cost(middle, half + 1.5 * space.point, lines, taken, inside)
                if cost < least:
                    best, least = offset, cost
        text.xyann = tuple(best / space.point)
        middle = seen[:, place] + best
        taken.append(np.concatenate([middle - half, middle + half], axis=1))
        made.append((text, place))
        space.taken.append(Bbox.from_extents(*taken[-1][0]))
    return made


def _cost(middle: Floats, half: Floats, lines: Floats, taken: Sequence[Floats], inside: Bbox) -> float:
    """How bad a name's box is, with its middle in each pose (m, 2) and half its size (2,), over all poses."""
    low, high = middle - half, middle + half
    hits = ((lines > low[:, None]) & (lines < high[:, None])).all(axis=2)
    cost = ON_A_LINE * float(hits.sum()) / len(middle)
    for other in taken:
        apart = (low >= other[:, 2:]).any(axis=1) | (high <= other[:, :2]).any(axis=1)
        cost += FORBIDDEN * float((~apart).sum()) / len(middle)
    (left, bottom), (right, top) = inside.get_points()
    out = (low < (left, bottom)).any(axis=1) | (high > (right, top)).any(axis=1)
    return cost + FORBIDDEN * float(out.sum()) / len(middle)
