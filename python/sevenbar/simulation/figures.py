"""Figures of a simulation: Sevenbar as a line, the engine as markers, the difference on its own scale."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import headline, input_label, page_figure, shown_value, slides
from sevenbar.drawing.names import quantity_label, short, shown_name
from sevenbar.drawing.style import CIRCUIT_COLOURS, COMPUTED, OTHER, styled
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.simulation.agreement import Simulation
from sevenbar.text.words import say

#: Marks of the engine along a curve.
MARKS = 40

#: In so many stretches a course is cut where the greatest difference of each is drawn.
STRETCHES = 180

#: A logarithmic panel ends at this part of its greatest difference, or at this number: below is rounding.
SPAN, FLOOR = 1e-6, 1e-17

_ENGINE, _THEORY = OTHER, COMPUTED


def output_figure(run: Simulation) -> Figure:
    """Angle, velocity and acceleration of the output: theory and engine left, their difference right."""
    motion, column = run.course.motion, run.course.circuit.output_column
    slide = slides(motion, motion.output)
    unit = motion.linkage.unit_of(motion.output)
    rows = (
        ("position" if slide else "angle", unit if slide else "deg", "", run.engine.q, run.theory.q),
        ("velocity", unit, "/s", run.engine.dq, run.theory.dq),
        ("acceleration", unit, "/s²", run.engine.ddq, run.theory.ddq),
    )
    with styled():
        figure = page_figure(9.2, 7.2, pads=(0.06, 0.08))
        grid = figure.subplots(3, 2, sharex=True)
        for (left, right), (word, shown, per, engine, theory) in zip(grid, rows, strict=True):
            own, other = theory[:, column], engine[:, column]
            convert = np.degrees if shown == "deg" else np.asarray
            _compared(left, run, convert(own), convert(other))
            left.set_ylabel(quantity_label(motion.output, word, f"{shown}{per}"))
            right.plot(_across(run), other - own, color=_ENGINE, lw=0.9)
            right.set_ylabel(say("difference [{unit}]", unit=f"{unit}{per}"))
            right.ticklabel_format(axis="y", style="sci", scilimits=(0, 0), useMathText=False)
        _finish(figure, run)
        figure.legend(handles=_keys(run), loc="outside lower center", ncols=3, frameon=False)
    return figure


def joints_figure(run: Simulation) -> Figure:
    """Every joint's value, theory and engine, and the size of the difference on a logarithmic scale."""
    linkage = run.linkage
    kinds = [turns for turns in (True, False) if turns in linkage.turning]
    with styled():
        figure = page_figure(9.2, 1.6 + 3.4 * len(kinds), pads=(0.06, 0.08))
        grid = figure.subplots(len(kinds), 2, sharex=True, squeeze=False)
        for (left, right), turns in zip(grid, kinds, strict=True):
            unit = "rad" if turns else linkage.length_unit
            shown = "deg" if turns else unit
            convert = np.degrees if turns else np.asarray
            for column, name in enumerate(linkage.columns):
                if linkage.turns(column) != turns:
                    continue
                colour = CIRCUIT_COLOURS[column % len(CIRCUIT_COLOURS)]
                own, other = run.theory.q[:, column], run.engine.q[:, column]
                _compared(left, run, convert(own), convert(other), colour)
                _logarithmic(right, run, np.abs(other - own), colour, shown_name(name, 20))
            if turns:
                left.yaxis.set_major_locator(DegreeLocator(9))
            left.set_ylabel(
                say("turns [{unit}]", unit=shown) if turns else say("slides [{unit}]", unit=shown)
            )
            right.set_ylabel(say("size of the difference [{unit}]", unit=unit))
        _finish(figure, run)
        keys = [
            Line2D(
                [], [], color=CIRCUIT_COLOURS[c % len(CIRCUIT_COLOURS)], lw=1.5, label=shown_name(name, 20)
            )
            for c, name in enumerate(linkage.columns)
        ]
        keys += _keys(run, "0.35")[:2]
        figure.legend(handles=keys, loc="outside lower center", ncols=min(len(keys), 6), frameon=False)
    return figure


def points_figure(run: Simulation) -> Figure:
    """Speed and acceleration of the named points, and how far the engine's points are off."""
    unit = run.linkage.length_unit
    rows = (("position", ""), ("velocity", "/s"), ("acceleration", "/s²"))
    with styled():
        figure = page_figure(9.2, 7.4, pads=(0.06, 0.08))
        grid = figure.subplots(3, 2, sharex=True)
        for (left, right), (what, per) in zip(grid, rows, strict=True):
            for place, (name, (engine, theory)) in enumerate(run.points.items()):
                colour = CIRCUIT_COLOURS[place % len(CIRCUIT_COLOURS)]
                own, other = getattr(theory, what), getattr(engine, what)
                origin = own[0] if what == "position" else np.zeros(3)
                _compared(left, run, _length(own - origin), _length(other - origin), colour)
                _logarithmic(right, run, _length(other - own), colour, shown_name(name, 20))
            label = {
                "position": say("distance from the start"),
                "velocity": say("speed"),
                "acceleration": say("size of acceleration"),
            }[what]
            left.set_ylabel(f"{label} [{unit}{per}]")
            right.set_ylabel(say("size of the difference [{unit}]", unit=f"{unit}{per}"))
        _finish(figure, run)
        keys = [
            Line2D(
                [],
                [],
                color=CIRCUIT_COLOURS[p % len(CIRCUIT_COLOURS)],
                lw=1.5,
                label=say("point {name}", name=short(n, 20)),
            )
            for p, n in enumerate(run.points)
        ]
        keys += _keys(run, "0.35")[:2]
        figure.legend(handles=keys, loc="outside lower center", ncols=min(len(keys), 6), frameon=False)
    return figure


def forces_figure(run: Simulation) -> Figure:
    """The input's torque, and the size of forces and moments in the joints; how far the engine's are off."""
    joints = dict.fromkeys(force.name for force in run.forces[1:])
    colours = {name: CIRCUIT_COLOURS[k % len(CIRCUIT_COLOURS)] for k, name in enumerate(joints)}
    parts = [list(run.forces[:1])]
    parts += [[force for force in run.forces[1:] if force.what == what] for what in ("force", "moment")]
    shown = [part for part in parts if part]
    with styled():
        figure = page_figure(9.2, 1.2 + 2.2 * len(shown), pads=(0.06, 0.08))
        grid = figure.subplots(len(shown), 2, sharex=True, squeeze=False)
        for number, ((left, right), part) in enumerate(zip(grid, shown, strict=True)):
            unit = part[0].unit
            for force in part:
                colour = colours[force.name] if number else ""
                # the input's own has a sign
                own, other = (
                    _length(values) if number else values[:, 0] for values in (force.theory, force.engine)
                )
                _compared(left, run, own, other, colour)
                _logarithmic(right, run, force.apart, colour or _ENGINE, shown_name(force.name, 20))
            left.set_ylabel(_force_label(part[0].what, unit, drive=number == 0))
            right.set_ylabel(say("size of the difference [{unit}]", unit=unit))
        _finish(figure, run)
        keys = [
            Line2D([], [], color=colour, lw=1.5, label=shown_name(name, 20))
            for name, colour in colours.items()
        ]
        keys += _keys(run, "0.35")[:2]
        figure.legend(handles=keys, loc="outside lower center", ncols=min(len(keys), 6), frameon=False)
    return figure


def _force_label(what: str, unit: str, *, drive: bool) -> str:
    if drive:
        return f"{say('input force') if what == 'force' else say('input torque')} [{unit}]"
    return say("force [N]") if what == "force" else say("moment [N m]")


def _length(vectors: Floats) -> Floats:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _across(run: Simulation) -> Floats:
    """The input along the course as it is drawn, running on over the closure."""
    return np.asarray(shown_value(run.course.motion, run.course.motion.input, run.input))


def _compared(axes: Axes, run: Simulation, theory: Floats, engine: Floats, colour: str = "") -> None:
    across = _across(run)
    marks = np.unique(np.linspace(0, len(across) - 1, MARKS).astype(int))
    axes.plot(across, theory, color=colour or _THEORY, lw=1.3)
    axes.plot(across[marks], engine[marks], "o", ms=3.4, mfc="white", mec=colour or _ENGINE, mew=0.9)


def _logarithmic(axes: Axes, run: Simulation, values: Floats, colour: str, name: str) -> None:
    """Draws the greatest value of each stretch: of rounding, its size and not its noise."""
    count = min(STRETCHES, len(values))
    greatest = [np.fmax.reduce(part) for part in np.array_split(np.maximum(values, FLOOR), count)]
    middles = [part[len(part) // 2] for part in np.array_split(_across(run), count)]
    axes.plot(middles, greatest, color=colour, lw=1.0, label=name)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    # mathematical text is off, so powers are written as numbers are
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _finish(figure: Figure, run: Simulation) -> None:
    motion = run.course.motion
    across = _across(run)
    for axes in figure.axes:
        axes.grid(lw=0.6)
        axes.set_axisbelow(True)
        axes.set_xlim(float(np.nanmin(across)), float(np.nanmax(across)))
        if not slides(motion, motion.input):
            axes.xaxis.set_major_locator(DegreeLocator(6))
        if axes.get_yscale() == "log":
            values = np.concatenate([np.asarray(line.get_ydata(), dtype=np.float64) for line in axes.lines])
            highest, lowest = float(np.nanmax(values)), float(np.nanmin(values))
            axes.set_ylim(max(FLOOR, SPAN * highest, lowest / 3), 3 * highest)
    for axes in figure.axes[-2:]:
        axes.set_xlabel(input_label(motion))
    unit = motion.linkage.unit_of(motion.input)
    driven = say("{joint} at {speed}", joint=shown_name(motion.input, 24), speed=f"{motion.speed:g} {unit}/s")
    title = say(
        "{linkage}: Sevenbar and {engine} {version}\ncircuit {number}, {driven}, step {step:.3g} s",
        linkage=short(motion.linkage.heading, 60), engine=run.record.engine, version=run.record.version,
        number=run.course.circuit.index, driven=driven, step=run.course.step,
    )  # fmt: skip
    headline(figure, title)


def _keys(run: Simulation, colour: str = "") -> list[Line2D]:
    return [
        Line2D([], [], color=colour or _THEORY, lw=1.3, label="Sevenbar"),
        Line2D([], [], ls="", marker="o", ms=4, mfc="white", mec=colour or _ENGINE, label=run.record.engine),
        Line2D([], [], color=_ENGINE, lw=0.9, label=say("{engine} minus Sevenbar", engine=run.record.engine)),
    ]


#: The figures of a run by their names; of points where the linkage names some.
FIGURES = {"output": output_figure, "joints": joints_figure, "points": points_figure, "forces": forces_figure}
