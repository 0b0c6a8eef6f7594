"""Figures of forces along a circuit: torque and power, reactions, bearing loads, shaking, energies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import new_figure
from sevenbar.drawing.force_panels import (
    AXES,
    ROUNDING,
    WHOLE,
    chosen_reactions,
    curve,
    digits,
    drawn_quantity,
    first_dot,
    force_unit,
    greatest_of,
    hodograph,
    input_axis,
    joint_panels,
    mark_peak,
    reach_of,
    title_of_forces,
)
from sevenbar.drawing.names import shown_name
from sevenbar.drawing.panels import panels_of
from sevenbar.drawing.style import INK, LINE_STYLES, OTHER, QUIET, stroke, styled
from sevenbar.errors import RequestError, check_word
from sevenbar.forces.result import COMPONENTS, Forces, Reaction
from sevenbar.forces.sizing import Sizing
from sevenbar.text.words import say


def torque(
    forces: Forces,
    sizing: Sizing | None = None,
    *,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """Torque and power of the input over it, with their peaks and the root mean square; at rest the torque.

    `sizing` is that of the forces where it is at hand. `ax`: axes to draw in, two, or one at rest. The rest
    is as for `configuration`.

        >>> import sevenbar as sb
        >>> circuit = sb.load("rssr").motion().circuits[0]
        >>> figure = torque(circuit.forces(bodies={3: sb.Body(2.0, solid="rod")}))
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['input torque [N m]', 'power [W]']
    """
    count = 1 if forces.at_rest else 2
    result = sizing or sizing_of(forces)
    with styled(style):
        what = "torque, then power" if count > 1 else "or none"
        page = panels_of(count, ax, what, (6.4, 2.3 * count + 1.0), figsize=figsize, style=style)
        panels, handles = page.axes, []
        word = drawn_quantity(panels[0], forces, "input torque", WHOLE, shade=True)
        if result is not None:
            # on the side of the peak
            rms = math.copysign(result.rms_torque, result.peak_torque.value)
            look: dict[str, Any] = {"color": QUIET, "lw": 0.9 * stroke(), "ls": (0, (4, 2))}
            value = f"{digits(result.rms_torque)} {forces.unit}"
            handles = [panels[0].axhline(rms, label=say("rms {value}", value=value), **look)]
        if count > 1:
            drawn_quantity(panels[1], forces, "power", OTHER, shade=True)
        input_axis(panels, forces)
        whole = say("{torque} and power", torque=word) if count > 1 else word
        page.finish(title, title_of_forces(forces, whole), handles if legend else [])
        if result is not None:
            mark_peak(
                panels[0], forces, result.peak_torque.input, result.peak_torque.value, forces.unit, WHOLE
            )
            if count > 1:
                mark_peak(panels[1], forces, result.peak_power.input, result.peak_power.value, "W", OTHER)
                if (low := result.braking_power) is not None:
                    mark_peak(panels[1], forces, low.input, low.value, "W", OTHER)
    return page.figure


def reactions(
    forces: Forces,
    *,
    joints: Sequence[str] | None = None,
    what: str = "force",
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """What joints bear over the input: a panel a joint, the components in its own frame and their size.

    `what`: "force" [N] or "moment" [N m]. Components that equilibrium does not determine are not drawn, nor
    the size without all three. `joints` names those that are drawn, the first nine by default. `ax`: axes to
    draw in, one for each joint. The rest is as for `configuration`.

        >>> import sevenbar as sb
        >>> found = sb.load("rssr").motion().circuits[0].forces(bodies={3: sb.Body(2.0, solid="rod")})
        >>> [axes.get_title() for axes in reactions(found, joints=["crank", "rocker"]).axes]
        ['crank', 'rocker']
    """
    check_word("what", what, ("force", "moment"))
    chosen = chosen_reactions(forces, joints)
    letters = COMPONENTS[3:] if what == "force" else COMPONENTS[:3]
    scale = max((greatest_of(getattr(reaction, what)) for reaction in forces.reactions.values()), default=0.0)
    with styled(style):
        page = joint_panels(len(chosen), ax, figsize, style)
        whole = False
        for axes, reaction in zip(page.axes, chosen, strict=True):
            values = getattr(reaction, what)
            known = np.isfinite(values).any(axis=0)
            for i in np.flatnonzero(known):
                own = np.where(np.abs(values[:, i]) > ROUNDING * scale, values[:, i], 0.0 * values[:, i])
                curve(axes, forces, own, AXES[i], style=LINE_STYLES[i], zero=False)
            if known.all():
                whole = True
                curve(axes, forces, np.linalg.norm(values, axis=1), INK, width=1.0, zero=False)
            if not known.any():
                where: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "va": "center"}
                axes.text(0.5, 0.5, say("not determined"), color=QUIET, **where)
                axes.set_yticks([])
            axes.axhline(0, color=QUIET, lw=0.6 * stroke())
            axes.set_title(shown_name(reaction.joint, 28))
            axes.set_ylabel(say("force [N]") if what == "force" else say("moment [N m]"))
        input_axis(page.axes, forces, most=5)
        page.label_outer()
        made = [
            Line2D([], [], color=AXES[i], ls=LINE_STYLES[i], label=letters[i])
            for i in range(3)
            if any(np.isfinite(getattr(r, what)[:, i]).any() for r in chosen)
        ]
        if whole:
            made.append(Line2D([], [], color=INK, lw=1.0 * stroke(), label=say("size")))
        which = say("forces in the joints") if what == "force" else say("moments in the joints")
        page.finish(title, title_of_forces(forces, which), made if legend else [])
    return page.figure


def drawn_bearings(forces: Forces, joints: Sequence[str] | None = None) -> list[Reaction]:
    """The joints whose force square to the axis is determined: those of a polar picture."""
    result = chosen_reactions(forces, joints)
    return [one for one in result if one.determinate[3:5].all() and one.kind != "S"]


def bearings(
    forces: Forces,
    *,
    joints: Sequence[str] | None = None,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """Polar pictures of bearing loads: the force square to each joint's axis, in the joint's own frame.

    The curve is where the tip of the force is in one cycle, the dot its place on the first row. `joints`
    names those that are drawn. Raises `RequestError` where none of them is determined. The rest is as for
    `reactions`.
    """
    chosen = drawn_bearings(forces, joints)
    if not chosen:
        raise RequestError(
            "joints: these are balls, which have no axis, or their forces are not determined; nothing to draw"
        )
    with styled(style):
        page = joint_panels(len(chosen), ax, figsize, style, square=True)
        unit, size = force_unit(*(reaction.force[:, :2] for reaction in chosen))
        for axes, reaction in zip(page.axes, chosen, strict=True):
            hodograph(axes, forces, reaction.force[:, :2] / size, WHOLE)
            axes.set_title(shown_name(reaction.joint, 28))
            axes.set_xlabel(f"Fx [{unit}]")
            axes.set_ylabel(f"Fy [{unit}]")
        heading = title_of_forces(
            forces, say("forces square to the joints' axes, x and y of the link before each joint")
        )
        page.finish(title, heading, [first_dot(forces, WHOLE)] if legend else [])
    return page.figure


def shaking(
    forces: Forces,
    *,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """The hodograph of the shaking force, seen along the axes of the report frame, and its size.

    Views in which nothing but a line is to be seen are left out. `ax`: axes to draw in, one for each view and
    one for the size. Raises `RequestError` at rest. The rest is as for `configuration`.
    """
    if forces.at_rest:
        raise RequestError("shaking: at rest nothing shakes; give forces of a motion")
    force = forces.shaking[:, 3:]
    scale = greatest_of(force)
    force = np.where(np.abs(force) > ROUNDING * scale, force, 0.0 * force)
    moves = [i for i in range(3) if greatest_of(force[:, i]) > 0]
    views = list(combinations(moves, 2))
    with styled(style):
        across = 2 if views else 1
        down = math.ceil((len(views) + 1) / across)
        usual = (7.2, 3.1 * down + 0.6) if views else (6.4, 3.6)
        page = panels_of(
            len(views) + 1, ax, "one for each view and one for the size", usual,
            across=across, figsize=figsize, style=style, sharex=False,
        )  # fmt: skip
        panels = page.axes
        reach = reach_of(force, forces)
        for axes, (i, j) in zip(panels, views, strict=False):
            hodograph(axes, forces, force[:, [i, j]], WHOLE, reach=reach)
            axes.set_xlabel(f"F{'xyz'[i]} [N]")
            axes.set_ylabel(f"F{'xyz'[j]} [N]")
        size = panels[len(views)]
        drawn_quantity(size, forces, "shaking force", INK, zero=False)
        input_axis([size], forces, most=5)
        size.set_ylim(bottom=0)
        heading = title_of_forces(forces, say("shaking force on the ground"))
        page.finish(title, heading, [first_dot(forces, WHOLE)] if legend and views else [])
    return page.figure


def energies(
    forces: Forces,
    *,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """Kinetic and potential energy over the input, those that there are, and their sum.

    `ax`: axes to draw in, one. The rest is as for `configuration`.
    """
    with styled(style):
        page = panels_of(1, ax, "or none", (6.4, 4.2), figsize=figsize, style=style)
        (axes,) = page.axes
        total = forces.kinetic + forces.potential
        drawn: list[tuple[str, Floats, str, Any]] = [
            (say("kinetic"), forces.kinetic, WHOLE, "-"),
            (say("potential"), forces.potential, AXES[1], LINE_STYLES[1]),
        ]
        drawn = [one for one in drawn if greatest_of(one[1]) > 0]
        if len(drawn) > 1:
            drawn.append((say("sum"), total, INK, LINE_STYLES[3]))
        for label, values, colour, line in drawn:
            curve(axes, forces, values, colour, style=line, label=label, zero=False)
        axes.set_ylabel(say("energy [J]"))
        input_axis([axes], forces)
        handles = axes.get_legend_handles_labels()[0] if legend else []
        page.finish(title, title_of_forces(forces, say("energies")), handles)
    return page.figure


#: The figures of forces by their names.
KINDS: dict[str, Callable[..., Figure]] = {
    draw.__name__: draw for draw in (torque, reactions, bearings, shaking, energies)
}


def figure_of_kind(forces: Forces, kind: str, options: dict[str, Any]) -> Figure:
    """The figure of a kind; raises `RequestError` for another."""
    check_word("kind", kind, KINDS, "a figure of forces")
    return KINDS[kind](forces.within_stops or forces, **options)


def small(forces: Forces) -> Figure | None:
    """A small picture of the torque, for notebooks."""
    forces = forces.within_stops or forces
    if not np.isfinite(forces.torque).any():
        return None
    with styled():
        figure = new_figure(4.6, 2.8, pads=(0.05, 0.06))
        axes = figure.subplots()
        drawn_quantity(axes, forces, "input torque", WHOLE, shade=True)
        input_axis([axes], forces, most=6)
    return figure


def sizing_of(forces: Forces) -> Sizing | None:
    """The sizing of rows that have one: not of several passes one after the other."""
    own = forces.within_stops
    if own is not forces:
        return None if own is None else own.sizing()
    if forces.period is None and len(np.unique(forces.branch)) > 1:
        return None
    return forces.sizing()
