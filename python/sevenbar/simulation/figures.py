"""Figures of a simulation: Sevenbar as a line, the engine as markers, the difference on its own scale."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import headline, input_label, page_figure, shown_value, slides
from sevenbar.drawing.names import short, shown_name
from sevenbar.drawing.output_curves import drawable
from sevenbar.drawing.style import COMPUTED, OTHER, circuit_colour, styled
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


class _Curve(NamedTuple):
    """A quantity (n,) of both, how far they are apart, and its name and colour; without one in their own."""

    name: str
    theory: Floats
    engine: Floats
    apart: Floats
    colour: str = ""


class _Row(NamedTuple):
    """A row of panels: curves left, how far they are apart right [unit]; `label` is that of the curves."""

    label: str
    unit: str
    curves: list[_Curve]
    in_degrees: bool = False


@styled()
def output_figure(run: Simulation) -> Figure:
    """Angle, velocity and acceleration of the output: theory and engine left, their difference right."""
    motion, column = run.course.motion, run.course.circuit.output_column
    listed, rows = drawable(motion), {"angle": "q", "velocity": "dq", "acceleration": "ddq"}
    figure = page_figure(9.2, 7.2, pads=(0.06, 0.08))
    grid = figure.subplots(3, 2, sharex=True)
    for (left, right), (word, array) in zip(grid, rows.items(), strict=True):
        own, other = (getattr(one, array)[:, column] for one in (run.theory, run.engine))
        convert = np.degrees if listed[word].unit == "deg" else np.asarray
        _draw_both(left, run, convert(own), convert(other))
        left.set_ylabel(listed[word].label())
        right.plot(_across(run), other - own, color=_ENGINE, lw=0.9)
        unit = motion.linkage.unit_of(motion.output) if word == "angle" else listed[word].unit
        right.set_ylabel(say("difference [{unit}]", unit=unit))
        right.ticklabel_format(axis="y", style="sci", scilimits=(0, 0), useMathText=False)
    _finish(figure, run, _keys(run))
    return figure


@styled()
def joints_figure(run: Simulation) -> Figure:
    """Every joint's value, theory and engine, and the size of the difference on a logarithmic scale."""
    linkage, rows = run.linkage, []
    for turns in (turns for turns in (True, False) if turns in linkage.turning):
        unit, convert = ("rad", np.degrees) if turns else (linkage.length_unit, np.asarray)
        label = say("turns [{unit}]", unit="deg") if turns else say("slides [{unit}]", unit=unit)
        curves = [
            _Curve(
                column.name, convert(own), convert(other), np.abs(other - own), circuit_colour(column.number)
            )
            for column in linkage.each_column
            for own, other in [(run.theory.q[:, column.number], run.engine.q[:, column.number])]
            if column.turns == turns
        ]
        rows.append(_Row(label, unit, curves, in_degrees=turns))
    keys = [(shown_name(name, 20), circuit_colour(column)) for column, name in enumerate(linkage.columns)]
    return _sizes_figure(run, 1.6 + 3.4 * len(rows), rows, keys)


@styled()
def points_figure(run: Simulation) -> Figure:
    """Speed and acceleration of the named points, and how far the engine's points are off."""
    rows = []
    for what, label, per in (
        ("position", say("distance from the start"), ""),
        ("velocity", say("speed"), "/s"),
        ("acceleration", say("size of acceleration"), "/s²"),
    ):
        curves = []
        for place, (name, both) in enumerate(run.points.items()):
            engine, theory = (getattr(one, what) for one in both)
            origin = theory[0] if what == "position" else np.zeros(3)
            sizes = (_length(theory - origin), _length(engine - origin), _length(engine - theory))
            curves.append(_Curve(name, *sizes, circuit_colour(place)))
        unit = f"{run.linkage.length_unit}{per}"
        rows.append(_Row(f"{label} [{unit}]", unit, curves))
    keys = [
        (say("point {name}", name=short(n, 20)), circuit_colour(place)) for place, n in enumerate(run.points)
    ]
    return _sizes_figure(run, 7.4, rows, keys)


@styled()
def forces_figure(run: Simulation) -> Figure:
    """The input's torque, and the size of forces and moments in the joints; how far the engine's are off."""
    drive, *others = run.forces
    names = dict.fromkeys(force.name for force in others)
    colours = {name: circuit_colour(place) for place, name in enumerate(names)}
    # the input's own has a sign
    signed = [_Curve(drive.name, drive.theory[:, 0], drive.engine[:, 0], drive.apart)]
    label = say("input force") if drive.what == "force" else say("input torque")
    rows = [_Row(f"{label} [{drive.unit}]", drive.unit, signed)]
    for what, label in (("force", say("force [N]")), ("moment", say("moment [N m]"))):
        part = [force for force in others if force.what == what]
        curves = [_Curve(f.name, f.size, _length(f.engine), f.apart, colours[f.name]) for f in part]
        rows += [_Row(label, part[0].unit, curves)] if part else []
    keys = [(shown_name(name, 20), colour) for name, colour in colours.items()]
    return _sizes_figure(run, 1.2 + 2.2 * len(rows), rows, keys)


def _sizes_figure(run: Simulation, height: float, rows: list[_Row], keys: list[tuple[str, str]]) -> Figure:
    """Curves of theory and engine left, the sizes of their differences right, with a key to their colours."""
    figure = page_figure(9.2, height, pads=(0.06, 0.08))
    grid = figure.subplots(len(rows), 2, sharex=True, squeeze=False)
    for (left, right), row in zip(grid, rows, strict=True):
        for curve in row.curves:
            _draw_both(left, run, curve.theory, curve.engine, curve.colour)
            _draw_size(right, run, curve)
        if row.in_degrees:
            left.yaxis.set_major_locator(DegreeLocator(9))
        left.set_ylabel(row.label)
        right.set_ylabel(say("size of the difference [{unit}]", unit=row.unit))
    lines = [Line2D([], [], color=colour, lw=1.5, label=label) for label, colour in keys]
    _finish(figure, run, [*lines, *_keys(run, "0.35")[:2]])
    return figure


def _length(vectors: Floats) -> Floats:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _across(run: Simulation) -> Floats:
    """The input along the course as it is drawn, running on over the closure."""
    return np.asarray(shown_value(run.course.motion, run.course.motion.input, run.input))


def _draw_both(axes: Axes, run: Simulation, theory: Floats, engine: Floats, colour: str = "") -> None:
    across = _across(run)
    marks = np.unique(np.linspace(0, len(across) - 1, MARKS).astype(int))
    axes.plot(across, theory, color=colour or _THEORY, lw=1.3)
    axes.plot(across[marks], engine[marks], "o", ms=3.4, mfc="white", mec=colour or _ENGINE, mew=0.9)


def _draw_size(axes: Axes, run: Simulation, curve: _Curve) -> None:
    """Draws the greatest difference of each stretch: of rounding, its size and not its noise."""
    count = min(STRETCHES, len(curve.apart))
    greatest = [np.fmax.reduce(part) for part in np.array_split(np.maximum(curve.apart, FLOOR), count)]
    middles = [part[len(part) // 2] for part in np.array_split(_across(run), count)]
    axes.plot(middles, greatest, color=curve.colour or _ENGINE, lw=1.0, label=shown_name(curve.name, 20))
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    # mathematical text is off, so powers are written as numbers are
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _finish(figure: Figure, run: Simulation, keys: list[Line2D]) -> None:
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
    figure.legend(handles=keys, loc="outside lower center", ncols=min(len(keys), 6), frameon=False)


def _keys(run: Simulation, colour: str = "") -> list[Line2D]:
    return [
        Line2D([], [], color=colour or _THEORY, lw=1.3, label="Sevenbar"),
        Line2D([], [], ls="", marker="o", ms=4, mfc="white", mec=colour or _ENGINE, label=run.record.engine),
        Line2D([], [], color=_ENGINE, lw=0.9, label=say("{engine} minus Sevenbar", engine=run.record.engine)),
    ]


#: The figures of a run by their names; of points where the linkage names some.
FIGURES = {"output": output_figure, "joints": joints_figure, "points": points_figure, "forces": forces_figure}
