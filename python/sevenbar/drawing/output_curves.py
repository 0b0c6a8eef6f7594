"""Curves of the output of a motion over the input or time (Figures 3 and 4 of the paper)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import (
    circuits_text,
    gridded,
    input_label,
    note,
    range_drawn,
    shown_value,
    slides,
    title_of,
)
from sevenbar.drawing.names import handy_unit, quantity_label
from sevenbar.drawing.panels import coinciding, panels_of
from sevenbar.drawing.style import QUIET, circuit_colour, line_style, stroke, styled
from sevenbar.drawing.ticks import NATURAL_ANGLE, DegreeLocator, settle, widen
from sevenbar.errors import check_word
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.text.words import say

#: Marks in the curves' legend.
EXTREME, LIMIT, CHANGE_POINT = "extreme", "input limit", "change point"

#: The rows of the output's curves.
QUANTITIES = ("angle", "velocity", "acceleration")

#: Times its own width at which a range that other circuits share makes a curve flat.
FLATTEST = 5.0

#: The ends of a range.
Span = tuple[float, float]

#: Curves nearer than this [deg, or share of the size] on all rows are one.
SAME_CURVE = 1e-6


@dataclass(frozen=True, eq=False)
class DrawnPass:
    """A pass of a circuit as drawn: `input`, `angle` [deg, or length], `time` [s], the two rates; (n,)."""

    circuit: Circuit
    label: str
    #: The branch and how the input goes on it, where the circuit has several.
    way: str
    style: dict[str, Any]
    input: Floats
    time: Floats
    angle: Floats
    velocity: Floats
    acceleration: Floats


def passes(motion: Motion) -> list[DrawnPass]:
    """Every pass of every circuit; where the input goes back, the velocity is turned as it is in time."""
    made: list[DrawnPass] = []
    rate = abs(motion.speed) if motion.law is None else float(np.abs(motion.law.dq).max(initial=0.0))
    for circuit in motion.circuits:
        path = walk(circuit)
        size = circuit.size or 1.0
        quick = rate if circuit.input_turns else rate / size
        natural = 1.0 if circuit.output_turns else size
        velocity = settle(path.velocities(circuit.dq[:, circuit.output_column]), natural * quick)
        acceleration = settle(circuit.ddq[path.rows, circuit.output_column], natural * quick**2)
        angle = settle(
            shown_value(motion, motion.output, path.output), NATURAL_ANGLE if circuit.output_turns else size
        )
        for branch, part in enumerate(path.passes):
            label, way = say("circuit {number}", number=circuit.index), ""
            inputs = path.input[part]
            if len(path.passes) > 1:
                way = say("branch {number}", number=branch)
                if motion.law is None and inputs[-1] > inputs[0]:
                    way = say("{branch}: input rising", branch=way)
                elif motion.law is None:
                    way = say("{branch}: input falling", branch=way)
                label = say("{circuits}, {branch}", circuits=label, branch=way)
            colour, dashes = circuit_colour(circuit.index), line_style(len(made))
            style = {"color": colour, "ls": dashes, "lw": 1.6 * stroke()}
            places = shown_value(motion, motion.input, inputs), path.time[part]
            rates = velocity[part], acceleration[part]
            made.append(DrawnPass(circuit, label, way, style, *places, angle[part], *rates))
    return made


def drawn_once(motion: Motion, drawn: Sequence[DrawnPass]) -> list[DrawnPass]:
    """The passes without those that lie on another: one line, whose label names all its circuits."""
    near = SAME_CURVE * (drawn[0].circuit.size if drawn and slides(motion, motion.output) else 1.0)

    def alike(first: DrawnPass, line: DrawnPass) -> bool:
        return (
            first.circuit is not line.circuit
            and first.angle.shape == line.angle.shape
            and all(
                np.allclose(getattr(first, name), getattr(line, name), rtol=0, atol=near, equal_nan=True)
                for name in ("input", "time", "angle")
            )
        )

    groups = coinciding(drawn, alike)
    made = []
    for place, group in enumerate(groups):
        label = circuits_text([line.circuit.index for line in group])
        if group[0].way:
            label = say("{circuits}, {branch}", circuits=label, branch=group[0].way)
        style = group[0].style
        if len(groups) < len(drawn):
            style = style | {"ls": line_style(place)}
        made.append(replace(group[0], label=label, style=style))
    return made


def curves(
    motion: Motion,
    against: Literal["both", "input", "time"] = "both",
    *,
    quantities: Sequence[str] = QUANTITIES,
    ax: Any = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    legend: bool = True,
) -> Figure:
    """Output angle [deg], velocity [rad/s] and acceleration [rad/s^2] of every circuit; of a slide lengths.

    `against` "input" [deg] or "time" [s] draws one of the two; "both" puts time on a second scale above where
    the input turns fully at constant speed, else in a second column. Where a rocking input goes back, the
    sign of the velocity is turned. Circuits whose curves coincide are one line. `ax`: axes to draw in, one
    for each of the `quantities`, over the input unless `against` is "time". The rest is as for
    `configuration`. Raises `RequestError` where the motion has no circuit.

        >>> import sevenbar as sb
        >>> figure = curves(sb.load("rssr").motion(), against="input")
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['rocker angle [deg]', 'rocker velocity [rad/s]', 'rocker acceleration [rad/s²]']

    Source: Sun and Zhou, Figures 3 and 4.
    """
    chosen_circuit(motion, 0)
    check_word("against", against, ("both", "input", "time"))
    # a word is a sequence of its letters
    quantities = (quantities,) if isinstance(quantities, str) else quantities
    for quantity in quantities:
        check_word("quantities", quantity, QUANTITIES, "drawn")
    turning = motion.law is None and all(circuit.goes_round for circuit in motion)
    columns = [against]
    if against == "both":
        columns = ["input"] if turning or ax is not None else ["input", "time"]
    with styled(style):
        drawn = drawn_once(motion, passes(motion))
        usual = 6.4 if len(columns) == 1 else 9.8, 0.6 + 2.4 * len(quantities)
        page = panels_of(
            len(quantities) * len(columns), ax, "one for each of the quantities", usual,
            across=len(columns), figsize=figsize, style=style, sharex="col", sharey="row",
        )  # fmt: skip
        grid = np.array(page.axes, dtype=object).reshape(-1, len(columns))
        cut = False
        for row, quantity in enumerate(quantities):
            for column, over in enumerate(columns):
                panel(grid[row, column], motion, drawn, quantity, over)
            cut |= _cut(grid[row, 0], motion, drawn, quantity)
        if page.own:
            for axes in page.axes:
                axes.label_outer()
            if against == "both" and turning:
                _time_above(grid[0, 0], motion, drawn[0])
            page.figure.align_ylabels()
            keys = curve_keys(grid[:, 0], drawn) if legend else []
            page.finish(title, title_of(motion), keys, heading=note(motion, cut))
    return page.figure


def panel(axes: Axes, motion: Motion, drawn: Sequence[DrawnPass], quantity: str, over: str) -> None:
    """Draws one quantity of the passes over "input" or "time", with the input limits and the extremes."""
    gridded(axes)
    factor, length = _unit_of(motion, drawn, quantity)
    for line in drawn:
        axes.plot(getattr(line, over), factor * getattr(line, quantity), label=line.label, **line.style)
    for circuit in motion.circuits:
        own = [line for line in drawn if line.circuit is circuit]
        extremes: Extremes | None = getattr(circuit, quantity)
        if own and extremes is not None:
            sides = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
            values = np.array([value for value, _ in sides])
            values = shown_value(motion, motion.output, values) if quantity == "angle" else values
            if np.ptp(np.concatenate([getattr(line, quantity) for line in own])) == 0:
                continue
            period = math.inf if slides(motion, motion.input) else 360.0
            lines = [(line.input, getattr(line, over), getattr(line, quantity)) for line in own]
            places = [
                place_of(lines, v, shown_value(motion, motion.input, at), period)
                for v, (_, at) in zip(values, sides, strict=True)
            ]
            ring = {"ms": 4.5 * stroke(), "mfc": "white", "mec": own[0].style["color"], "mew": 1.2 * stroke()}
            axes.plot(places, factor * values, "o", ls="", label=say(EXTREME), zorder=4, **ring)
    ends = np.concatenate([getattr(line, over) for line in drawn])
    room = 0.02 * np.ptp(ends) if over == "input" and motion.limits.size else 0.0
    if np.ptp(ends) > 0:
        axes.set_xlim(ends.min() - room, ends.max() + room)
    if over == "input":
        if not slides(motion, motion.input):
            axes.xaxis.set_major_locator(DegreeLocator(9))
        marked = (motion.limits, "--", LIMIT), (motion.change_point_inputs, ":", CHANGE_POINT)
        for inputs, dashes, name in marked:
            for place in inputs_between(motion, inputs, ends.min(), ends.max()):
                axes.axvline(place, color=QUIET, lw=1.0 * stroke(), ls=dashes, zorder=1, label=say(name))
    if quantity == "angle" and not slides(motion, motion.output):
        axes.yaxis.set_major_locator(DegreeLocator(7))
    else:
        axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    if quantity == "angle":
        _on_view(axes, motion, drawn, factor)
    widen(axes.yaxis, factor * _natural(motion, quantity))
    axes.set_xlabel(input_label(motion) if over == "input" else say("time [s]"))
    axes.set_ylabel(output_label(motion, quantity, length))


def home_circuit(motion: Motion) -> Circuit:
    """The circuit that a motion is about: that of the drawn pose, else the first."""
    if motion.linkage.form != "drawn":
        return motion.circuits[0]
    turning, pose = motion.linkage.turning, motion.linkage.drawn_pose

    def distance(circuit: Circuit) -> float:
        off = circuit.q - pose
        off -= math.tau * np.round(off / math.tau) * turning
        off = np.abs(off / np.where(turning, 1.0, circuit.size or 1.0)).max(axis=1)
        return float(np.nanmin(off, initial=math.inf))

    return min(motion.circuits, key=distance)


def _on_view(axes: Axes, motion: Motion, drawn: Sequence[DrawnPass], factor: float) -> None:
    """Leaves circuits out of a panel's range with which the one the motion is about would be flat."""
    home = home_circuit(motion)
    spans: dict[int, Span] = {}
    for line in drawn:
        if (span := range_drawn(line.circuit, line.angle, "angle")) is not None:
            low, high = spans.get(line.circuit.index, span)
            spans[line.circuit.index] = min(low, span[0]), max(high, span[1])
    own = spans.get(home.index)
    if own is None or not own[1] > own[0]:
        return
    wide = own[1] - own[0]
    far = [
        index
        for index, span in spans.items()
        if max(span[1], own[1]) - min(span[0], own[0]) > FLATTEST * wide
        and (span[0] > own[1] or span[1] < own[0])
    ]
    if not far:
        return
    near = [span for index, span in spans.items() if index not in far]
    low, high = factor * min(span[0] for span in near), factor * max(span[1] for span in near)
    axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    values = "; ".join(
        say(
            "{circuit}: {low:.4g} to {high:.4g}, not shown",
            circuit=circuits_text([index]), low=factor * spans[index][0], high=factor * spans[index][1],
        )
        for index in far
    )  # fmt: skip
    axes.annotate(values, (0.01, 0.98), xycoords="axes fraction", va="top", fontsize="x-small", color=QUIET)


def _natural(motion: Motion, quantity: str) -> float:
    """The size of a large value of a quantity of the output, as it is drawn."""
    circuit = motion.circuits[0]
    rate = abs(motion.speed) if motion.law is None else float(np.abs(motion.law.dq).max(initial=0.0))
    rate = rate if circuit.input_turns else rate / (circuit.size or 1.0)
    if quantity == "angle":
        return NATURAL_ANGLE if circuit.output_turns else circuit.size
    return (1.0 if circuit.output_turns else circuit.size) * rate ** QUANTITIES.index(quantity)


def _unit_of(motion: Motion, drawn: Sequence[DrawnPass], quantity: str) -> tuple[float, str]:
    """The factor and the length unit in which a slide's rate is drawn: metres for many millimetres."""
    unit = motion.linkage.length_unit
    if quantity == "angle" or not slides(motion, motion.output):
        return 1.0, unit
    ranges = [range_drawn(line.circuit, getattr(line, quantity), quantity) for line in drawn]
    return handy_unit(unit, max((abs(end) for ends in ranges if ends for end in ends), default=0.0))


def output_label(motion: Motion, quantity: str, length: str) -> str:
    """What is written along an axis of the output: its name, the quantity, the unit."""
    suffix = {"angle": "", "velocity": "/s", "acceleration": "/s²"}[quantity]
    if slides(motion, motion.output):
        word = "position" if quantity == "angle" else quantity
        return quantity_label(motion.output, word, f"{length}{suffix}")
    return quantity_label(motion.output, quantity, f"rad{suffix}" if suffix else "deg")


def inputs_between(motion: Motion, inputs: Floats, low: float, high: float) -> Floats:
    """The given inputs [rad, or length] as they are drawn, angles at every turn, within a range (m,)."""
    lifted = inputs[None, :]
    if not slides(motion, motion.input):
        lifted = np.degrees(inputs) + 360.0 * np.arange(-4, 5)[:, None]
    between: Floats = lifted[(lifted > low - 1e-6) & (lifted < high + 1e-6)]
    return between


def place_of(lines: Iterable[tuple[Floats, Floats, Floats]], value: float, at: float, period: float) -> float:
    """Where a panel's lines take a value at an input, known to whole periods; NaN where they do not.

    Each line has its inputs, its places along the panel and its values, (n,).
    """
    result = [(math.inf, math.nan)]
    for inputs, across, values in lines:
        off = inputs - at
        if math.isfinite(period):
            off = (off + period / 2) % period - period / 2
        for i in np.flatnonzero((off[:-1] * off[1:] <= 0) & (np.abs(off[:-1] - off[1:]) < period / 2)):
            share = off[i] / (off[i] - off[i + 1]) if off[i] != off[i + 1] else 0.0
            x, y = (v[i] + share * (v[i + 1] - v[i]) for v in (across, values))
            result.append((abs(y - value), x))
    return min(result)[1]


def _cut(axes: Axes, motion: Motion, drawn: Sequence[DrawnPass], quantity: str) -> bool:
    """Cuts the range of rates that grow without bound at input dead centres; returns whether it did."""
    ranges = [(line, range_drawn(line.circuit, getattr(line, quantity), quantity)) for line in drawn]
    spans = [span for _, span in ranges if span is not None]
    if quantity == "angle" or not any(span is not None and line.circuit.turns_back for line, span in ranges):
        return False
    factor, _ = _unit_of(motion, drawn, quantity)
    low, high = factor * np.min(spans), factor * np.max(spans)
    axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    return True


def _time_above(axes: Axes, motion: Motion, line: DrawnPass) -> None:
    rate, start = math.degrees(motion.speed), line.input[0]
    there_and_back = (lambda angle: (angle - start) / rate), (lambda time: start + time * rate)
    above = axes.secondary_xaxis("top", functions=there_and_back)
    above.set_xlabel(say("time [s]"))


def curve_keys(panels: Iterable[Axes], drawn: Sequence[DrawnPass]) -> list[Line2D]:
    """One legend entry for each pass and for each kind of mark."""
    lines = {str(line.get_label()): line for axes in panels for line in axes.lines}
    marks = [say(mark) for mark in (EXTREME, LIMIT, CHANGE_POINT)]
    if marks[0] in lines:  # drawn in each circuit's colour
        ring: dict[str, Any] = {"ms": 4.5 * stroke(), "mfc": "white", "mec": "#404040"}
        lines[marks[0]] = Line2D([], [], ls="", marker="o", label=marks[0], **ring)
    return [lines[label] for label in (*(line.label for line in drawn), *marks) if label in lines]
