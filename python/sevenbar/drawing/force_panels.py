"""What figures of forces are made of: curves over the input with peaks, hodographs, grids of joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import gridded, input_scale
from sevenbar.drawing.names import quantity_label, short, shown_name
from sevenbar.drawing.panels import Panels, panels_across, panels_of
from sevenbar.drawing.quantities import FORCES
from sevenbar.drawing.style import CIRCUIT_COLOURS, COMPUTED, LINE_STYLES, QUIET, letters, stroke
from sevenbar.errors import RequestError, no_joint
from sevenbar.forces.result import Forces, Reaction
from sevenbar.text.words import say

#: The colours of x, y, z and of the whole.
AXES = (CIRCUIT_COLOURS[1], CIRCUIT_COLOURS[2], CIRCUIT_COLOURS[5])
WHOLE = COMPUTED

#: Torques that grow without bound are cut at these percentiles.
CUT = 6.0

#: Below this part of the greatest force a component is rounding, and drawn as zero.
ROUNDING = 1e-9

#: Panels of joints that are drawn where none is named.
MOST_JOINTS = 9

#: Between a peak and its label [points].
GAP = 4.0

#: From this force [N] on figures have kN.
MANY_NEWTONS = 1e4

#: Room round a hodograph, as a share of its reach.
ROOM = 0.12


def _across(forces: Forces, inputs: Floats) -> Floats:
    return inputs if forces.slides else np.degrees(inputs)


def closed(forces: Forces, values: Floats) -> Floats:
    """Values of rows with the first again at the end, where they close."""
    return np.concatenate([values, values[:1]]) if forces.periodic else values


def drawn_inputs(forces: Forces) -> Floats:
    """The input of the rows as it is drawn; of a cycle with its end."""
    inputs = _across(forces, forces.input)
    if not forces.periodic:
        return inputs
    return np.concatenate([inputs, inputs[:1] + _across(forces, np.array([forces.period or 0.0]))])


def curve(
    axes: Axes,
    forces: Forces,
    values: Floats,
    colour: str,
    *,
    style: Any = "-",
    width: float = 1.6,
    label: str = "",
    shade: bool = False,
    zero: bool = True,
) -> None:
    """A quantity over the input, each pass for itself; a growth without bound is cut."""
    gridded(axes)
    across, along = drawn_inputs(forces), closed(forces, values)
    branch = closed(forces, forces.branch.astype(float))
    if zero:
        axes.axhline(0, color=QUIET, lw=0.7 * stroke())
    for place, number in enumerate(np.unique(branch)):
        rows = branch == number
        line = style if place == 0 else LINE_STYLES[place % len(LINE_STYLES)]
        look: dict[str, Any] = {"color": colour, "ls": line, "lw": width * stroke()}
        axes.plot(across[rows], along[rows], label=label if place == 0 else "", **look)
        if shade and len(np.unique(branch)) == 1:
            axes.fill_between(across[rows], along[rows], color=colour, alpha=0.13, lw=0)
    if "dead-centre" in forces.status:
        finite = along[np.isfinite(along)]
        if finite.size:
            low, high = np.percentile(finite, [CUT, 100 - CUT])
            # nearly constant, except near the ends
            room = max(0.15 * (high - low), 0.1 * abs(high + low) / 2) or 1.0
            axes.set_ylim(low - room, high + room)
    axes.ticklabel_format(axis="y", useOffset=False)


def drawn_quantity(axes: Axes, forces: Forces, quantity: str, colour: str, **style: Any) -> str:
    """A quantity of the list over the input, with its label; returns its word."""
    row = next(row for row in FORCES if row.word == quantity)
    word, unit = row.named(slides=forces.slides)
    curve(axes, forces, row.values(forces, forces.loading), colour, **style)
    axes.set_ylabel(quantity_label("", word, unit))
    return say(word)


def mark_peak(axes: Axes, forces: Forces, input: float, value: float, unit: str, colour: str) -> None:
    """A dot at a peak with its value, inside the panel and clear of its edges."""
    across = drawn_inputs(forces)
    x = float(_across(forces, np.array([input]))[0])
    if forces.periodic and not forces.slides:
        # the turn that is drawn
        low = float(min(across[0], across[-1]))
        x = low + (x - low) % abs(float(across[-1] - across[0]))
    axes.plot([x], [value], "o", ms=4 * stroke(), color=colour, zorder=5)
    low, high = axes.get_ylim()
    # room for the label above a highest value and below a lowest one
    need = min(0.5, (1.7 * letters() + GAP) * axes.figure.dpi / 72 / max(axes.bbox.height, 1.0))
    if value >= 0:
        axes.set_ylim(low, max(high, low + (value - low) / (1 - need)))
    else:
        axes.set_ylim(min(low, high - (high - value) / (1 - need)), high)
    left, right = axes.get_xlim()
    share = (x - left) / (right - left) if right != left else 0.5
    side = "left" if share < 0.2 else "right" if share > 0.8 else "center"
    axes.annotate(
        f"{digits(value)} {unit}",
        (x, value),
        xytext=(0, GAP if value >= 0 else -GAP),
        textcoords="offset points",
        ha=side,
        va="bottom" if value >= 0 else "top",
        color=colour,
    )


def digits(value: float) -> str:
    """A number to four digits, with the minus of the axes."""
    short = f"{value + 0.0:.4g}"
    return (f"{float(short):.0f}" if 1e4 <= abs(value) < 1e7 else short).replace("-", "\u2212")


def input_axis(panels: Sequence[Axes], forces: Forces, *, most: int = 9) -> None:
    """Limits, ticks and label of the input below panels."""
    for axes in panels:
        input_scale(axes, drawn_inputs(forces), most, turns=not forces.slides)
    kind, unit = ("position", forces.length_unit) if forces.slides else ("angle", "deg")
    panels[-1].set_xlabel(quantity_label(forces.driver, kind, unit))


def joint_panels(
    count: int, ax: Any, figsize: Sequence[float] | None, style: str | None, *, square: bool = False
) -> Panels:
    """A panel for each joint, `square` ones for hodographs."""
    across = {1: 1, 2: 2, 4: 2}.get(count, 3) if square else panels_across(count)
    down = math.ceil(count / across)
    page = 3.2 * across + 0.4, (3.2 if square else 2.2) * down + 1.0
    return panels_of(
        count, ax, "one for each joint", page, across=across, figsize=figsize, style=style, sharex=not square
    )


def chosen_reactions(forces: Forces, joints: Sequence[str] | None) -> list[Reaction]:
    """The reactions of joints by their names, of the first ones by default; raises `RequestError`."""
    names = list(forces.reactions)
    if joints is None:
        return [forces.reactions[name] for name in names[:MOST_JOINTS]]
    if not joints:
        raise RequestError("joints: none given; leave it out to draw all")
    for name in joints:
        if name not in names:
            raise RequestError(f"joints: {no_joint(name, names)}")
    return [forces.reactions[name] for name in joints]


def greatest_of(values: Floats) -> float:
    """The greatest size of known values, 0 without any."""
    known = np.abs(values[np.isfinite(values)])
    return float(known.max()) if known.size else 0.0


def reach_of(force: Floats, forces: Forces) -> float:
    """How far a hodograph reaches; of one that grows without bound a part of it."""
    sizes = np.abs(force[np.isfinite(force).all(axis=1)])
    if not sizes.size:
        return 1.0
    most = np.percentile(sizes, 100 - CUT) if "dead-centre" in forces.status else sizes.max()
    return (1 + ROOM) * float(most) or 1.0


def hodograph(axes: Axes, forces: Forces, pair: Floats, colour: str, *, reach: float | None = None) -> None:
    """The path of the tip of a force (n, 2) in a plane, both axes of one scale."""
    gridded(axes)
    path = closed(forces, pair)
    axes.axhline(0, color=QUIET, lw=0.7 * stroke())
    axes.axvline(0, color=QUIET, lw=0.7 * stroke())
    axes.plot(path[:, 0], path[:, 1], color=colour, lw=1.4 * stroke())
    first = pair[np.isfinite(pair).all(axis=1)][:1]
    axes.plot(first[:, 0], first[:, 1], "o", ms=4 * stroke(), color=colour)
    far = reach_of(pair, forces) if reach is None else reach
    axes.set_xlim(-far, far)
    axes.set_ylim(-far, far)
    axes.set_aspect("equal", adjustable="box")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))


def force_unit(*forces: Floats) -> tuple[str, float]:
    """The unit in which forces are drawn, and its size [N]: kN from 10 kN on."""
    most = max((float(np.abs(force[np.isfinite(force)]).max(initial=0.0)) for force in forces), default=0.0)
    return ("kN", 1e3) if most >= MANY_NEWTONS else ("N", 1.0)


def first_dot(forces: Forces, colour: str) -> Line2D:
    """What a legend has of the dot at the first row."""
    known = np.flatnonzero(np.isfinite(forces.torque))
    first = float(forces.input[known[0]]) if len(known) else math.nan
    text = f"{first:.4g} {forces.length_unit}" if forces.slides else f"{math.degrees(first) + 0.0:.4g}°"
    label = say("{joint} at {value}", joint=shown_name(forces.driver), value=text)
    return Line2D([], [], ls="", marker="o", ms=4 * stroke(), color=colour, label=label)


def title_of_forces(forces: Forces, what: str) -> str:
    """The linkage, and what is drawn."""
    whole = say("{what} at rest", what=what) if forces.at_rest else what
    return f"{short(forces.heading, 60)}\n{whole}"
