"""The linkage alone in one pose: no numbers, no legend, no title, as a page for teaching wants it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context, rcParams
from matplotlib.figure import Figure

from sevenbar.drawing import page
from sevenbar.drawing.figure import given_axes, new_figure
from sevenbar.drawing.lettering import write_names
from sevenbar.drawing.scene import bars, frame_box, put, shown_places, stage
from sevenbar.drawing.skeleton import one_pose, skeleton_of
from sevenbar.drawing.skeleton import skeleton as skeleton_along
from sevenbar.drawing.space import ViewAxes, fit, seen_size, set_limits
from sevenbar.drawing.style import page_size, styled
from sevenbar.drawing.view import Asked, view_of
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.ranges.reach import drawn_row, used_reach

#: Width of a figure [inch], and its height at most and at least, as shares of it.
WIDTH, TALLEST, LOWEST = 3.4, 1.3, 0.3
#: The shorter side [inch] from which lines, marks and letters have their usual size; on a smaller page they
#: are smaller, down to a share at which they are still seen, and letters [points] that are still read.
FULL_SIZE, THINNEST, LEAST_LETTERS = 2.6, 0.3, 6.0
#: Which share of a circuit is drawn where there is no drawn pose: many a loop lies flat at its first row.
SHARE = 0.12


def skeleton(
    motion: Motion,
    circuit: int = 0,
    at: float | str | None = None,
    *,
    names: bool = False,
    ax: Any = None,
    view: Asked = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
) -> Figure:
    """The linkage in one pose and nothing else: links, joints, ground; with their `names` on request.

    The pose is that `at` a value of the input, as "45 deg"; without one the drawn pose, of a linkage in rows
    one a little way along the circuit. Lines and marks are thinner on a small page, so that figures of 25 mm
    can be read. The rest is as for `configuration`.

        >>> import sevenbar as sb
        >>> figure = skeleton(sb.load("planar_4r").motion(), at="60 deg", figsize=(1.0, 1.0))
        >>> figure.axes[0].axison, len(figure.legends), len(figure.texts)
        (False, 0, 0)
    """
    chosen = chosen_circuit(motion, circuit)
    if at is None:
        whole = skeleton_along(motion, chosen)
        frame = one_pose(whole, 0)
        frame.places[0] = whole.pose(_row(motion, TimedWalk(motion, chosen)))
    else:
        pose = chosen.at(at)
        frame = skeleton_of(motion.linkage, poses(motion.linkage, pose.q[None]), motion.linkage.added_points)
    ends = motion.input, motion.output
    with styled(style):
        if ax is not None:
            (ax,) = given_axes(ax, 1, "or none")
        seen = view_of(view, motion.linkage, shown_places(frame), ax)
        box = frame_box(frame, seen)
        if ax is None:
            wide, tall = seen_size(seen, box)
            height = WIDTH * float(np.clip(tall / (wide or 1.0), LOWEST, TALLEST))
            size = page_size(style, figsize, (WIDTH, height), wide=False)
            figure = new_figure(*size)
            space = ViewAxes(page.own_axes(figure, seen), seen)
        else:
            figure, space = ax.figure.figure, ViewAxes(ax, seen)
            size = ax.get_window_extent().size / figure.dpi
        share = float(np.clip(min(size) / FULL_SIZE, THINNEST, 1.0))
        smaller: dict[Any, Any] = {
            "lines.linewidth": share * rcParams["lines.linewidth"],
            "font.size": max(LEAST_LETTERS, share * rcParams["font.size"]),
        }
        with rc_context(smaller):
            set_limits(space, box)
            if ax is None:
                edge = page.EDGE * share
                fit(space, box, (edge, edge, size[0] - 2 * edge, size[1] - 2 * edge))
            space.axes.set_axis_off()
            space.axes.apply_aspect()
            stage(space, frame, ends)
            put(space, bars(space, frame, ends), frame.pose(0))
            if names:
                write_names(space, frame, frame.places)
    return figure


def _row(motion: Motion, way: TimedWalk) -> float:
    """The row of a circuit's pose that shows the linkage as it is meant."""
    home = drawn_row(way)
    reach = used_reach(way) if motion.law is None else None
    if reach is not None:
        return reach.rolled(reach.clamped(reach.unrolled(home)) if home is not None else reach.low)
    if home is not None:
        return home
    solved = np.flatnonzero(np.isfinite(way.circuit.q[way.path.rows]).all(axis=1))
    return float(solved[int(SHARE * (len(solved) - 1))])
