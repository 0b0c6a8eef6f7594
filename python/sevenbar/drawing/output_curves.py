"""Curves of the output of a motion over the input or time (Figures 3 and 4 of the paper)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
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
    slides,
    title_of,
)
from sevenbar.drawing.names import handy_unit
from sevenbar.drawing.panels import coinciding, panels_of
from sevenbar.drawing.quantities import QUANTITIES, Over, Quantity, QuantityCurve, Span, curve_of, quantities
from sevenbar.drawing.style import QUIET, circuit_colour, line_style, stroke, styled
from sevenbar.drawing.ticks import DegreeLocator, widen
from sevenbar.errors import check_word
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.text.words import say

#: Marks in the curves' legend.
EXTREME, LIMIT, CHANGE_POINT = "extreme", "input limit", "change point"

#: Times its own width at which a range that other circuits share makes a curve flat.
FLATTEST = 5.0

#: Most lines that a legend names one by one; of more, the style of those along which the input falls.
MOST_NAMED = 16
DASHED = "--"

#: Curves nearer than this [deg, or share of their natural size] on all rows are one.
SAME_CURVE = 1e-6


@dataclass(frozen=True, eq=False)
class DrawnPass:
    """A pass of a circuit as a line: the rows `part` of the curve of each quantity, and its style."""

    circuit: Circuit
    curves: Mapping[str, QuantityCurve]
    part: slice
    #: The circuits that it is of.
    circuits: str
    #: The branch and how the input goes on it, where the circuit has several.
    direction: str
    style: dict[str, Any]

    @property
    def label(self) -> str:
        """What it is in a legend."""
        if not self.direction:
            return self.circuits
        return say("{circuits}, {branch}", circuits=self.circuits, branch=self.direction)

    def across(self, over: Over) -> Floats:
        """What is along the axis below, (n,)."""
        return self.curves["angle"].across(over)[self.part]

    def values(self, quantity: str) -> Floats:
        """Its values of a quantity, (n,)."""
        return self.curves[quantity].values[self.part]

    def span(self, quantity: str) -> Span | None:
        """The range worth showing."""
        return self.curves[quantity].span(self.part)

    @property
    def placed(self) -> list[Floats]:
        """What is the same where two lines are one: input, time, and values but rates of the output."""
        return [self.across("input"), self.across("time")] + [
            self.values(word) / (1.0 if curve.quantity.unit == "deg" else curve.natural or 1.0)
            for word, curve in self.curves.items()
            if word not in QUANTITIES[1:]
        ]


def drawable(motion: Motion) -> dict[str, Quantity]:
    """What can be drawn, by a word: of the output "angle" and its rates, of all else its name in a menu."""
    return {one.row.word if one.key.startswith("output.") else one.name: one for one in quantities(motion)}


def curves_of(
    motion: Motion, circuit: Circuit, words: Iterable[str] = QUANTITIES
) -> dict[str, QuantityCurve]:
    """The curves of quantities along a circuit, by their words."""
    listed, walked = drawable(motion), TimedWalk(motion, circuit)
    return {word: curve_of(listed[word], walked) for word in words}


def passes(motion: Motion, words: Iterable[str] = QUANTITIES) -> list[DrawnPass]:
    """Every pass of every circuit; where the input goes back, the velocity is turned as it is in time."""
    made: list[DrawnPass] = []
    for circuit in motion.circuits:
        path, own = walk(circuit), curves_of(motion, circuit, dict.fromkeys(("angle", *words)))
        for branch, part in enumerate(path.passes):
            circuits, direction = say("circuit {number}", number=circuit.index), ""
            inputs = path.input[part]
            if len(path.passes) > 1:
                direction = say("branch {number}", number=branch)
                if motion.law is None and inputs[-1] > inputs[0]:
                    direction = say("{branch}: input rising", branch=direction)
                elif motion.law is None:
                    direction = say("{branch}: input falling", branch=direction)
            colour, dashes = circuit_colour(circuit.index), line_style(len(made))
            style = {"color": colour, "ls": dashes, "lw": 1.6 * stroke()}
            made.append(DrawnPass(circuit, own, part, circuits, direction, style))
    return made


def drawn_once(drawn: Sequence[DrawnPass]) -> list[DrawnPass]:
    """The passes without those that lie on another: one line, whose label names all its circuits."""

    def alike(first: DrawnPass, line: DrawnPass) -> bool:
        return (
            first.circuit is not line.circuit
            and first.values("angle").shape == line.values("angle").shape
            and all(
                np.allclose(one, other, rtol=0, atol=SAME_CURVE, equal_nan=True)
                for one, other in zip(first.placed, line.placed, strict=True)
            )
        )

    groups = coinciding(drawn, alike)
    made = []
    for place, group in enumerate(groups):
        circuits = circuits_text([line.circuit.index for line in group])
        style = group[0].style
        if len(groups) < len(drawn):
            style = style | {"ls": line_style(place)}
        made.append(replace(group[0], circuits=circuits, style=style))
    return made


def by_circuit(drawn: Sequence[DrawnPass]) -> list[DrawnPass]:
    """The passes with one label to a circuit, dashed where the input falls: more than a legend can name."""

    def falls(line: DrawnPass) -> bool:
        inputs = line.across("input")
        return bool(inputs[-1] < inputs[0])

    return [
        replace(line, direction="", style=line.style | {"ls": DASHED if falls(line) else "-"})
        for line in drawn
    ]


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
    for each of the `quantities`, over the input unless `against` is "time": those of the output, or others of
    the studio's menu, as "transmission angle" or "P speed" of a point P. The rest is as for `configuration`.
    Raises `RequestError` where the motion has no circuit.

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
        check_word("quantities", quantity, drawable(motion), "drawn")
    turning = motion.law is None and all(circuit.goes_round for circuit in motion)
    columns: list[Over] = ["time" if against == "time" else "input"]
    if against == "both":
        columns = ["input"] if turning or ax is not None else ["input", "time"]
    with styled(style):
        drawn = drawn_once(passes(motion, quantities))
        if len(drawn) > MOST_NAMED and motion.law is None:
            drawn = by_circuit(drawn)
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
            cut |= _cut(grid[row, 0], drawn, quantity)
        if page.own:
            for axes in page.axes:
                axes.label_outer()
            if against == "both" and turning:
                _time_above(grid[0, 0], motion, drawn[0])
            page.figure.align_ylabels()
            keys = curve_keys(grid[:, 0], drawn) if legend else []
            page.finish(title, title_of(motion), keys, heading=note(motion, cut))
    return page.figure


def panel(axes: Axes, motion: Motion, drawn: Sequence[DrawnPass], quantity: str, over: Over) -> None:
    """Draws one quantity of the passes over "input" or "time", with the input limits and the extremes."""
    gridded(axes)
    factor, unit = _unit_of(drawn, quantity)
    for line in drawn:
        axes.plot(line.across(over), factor * line.values(quantity), label=line.label, **line.style)
    for circuit in motion.circuits:
        own = [line for line in drawn if line.circuit is circuit]
        curve = own[0].curves[quantity] if own else None
        if curve and curve.marks and np.ptp(curve.values) != 0:
            places = [curve.place(mark, over) for mark in curve.marks]
            values = np.array([mark.value for mark in curve.marks])
            ring = {"ms": 4.5 * stroke(), "mfc": "white", "mec": own[0].style["color"], "mew": 1.2 * stroke()}
            axes.plot(places, factor * values, "o", ls="", label=say(EXTREME), zorder=4, **ring)
    ends = np.concatenate([line.across(over) for line in drawn])
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
    if unit == "deg":
        axes.yaxis.set_major_locator(DegreeLocator(7))
    else:
        axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    if quantity == "angle":
        _on_view(axes, motion, drawn, factor)
    shown = drawn[0].curves[quantity]
    widen(axes.yaxis, factor * shown.natural)
    if shown.quantity.row.is_size:
        axes.set_ylim(bottom=0)
    axes.set_xlabel(input_label(motion) if over == "input" else say("time [s]"))
    axes.set_ylabel(shown.quantity.label(unit))


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
        if (span := line.span("angle")) is not None:
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


def _unit_of(drawn: Sequence[DrawnPass], quantity: str) -> tuple[float, str]:
    """The factor and the unit in which a quantity is drawn: rates of what slides in metres for many mm."""
    unit = drawn[0].curves[quantity].quantity.unit
    if "/" not in unit:
        return 1.0, unit
    ranges = [line.span(quantity) for line in drawn]
    length, _, per = unit.partition("/")
    most = max((abs(end) for ends in ranges if ends for end in ends), default=0.0)
    factor, length = handy_unit(length, most)
    return factor, f"{length}/{per}"


def inputs_between(motion: Motion, inputs: Floats, low: float, high: float) -> Floats:
    """The given inputs [rad, or length] as they are drawn, angles at every turn, within a range (m,)."""
    lifted = inputs[None, :]
    if not slides(motion, motion.input):
        lifted = np.degrees(inputs) + 360.0 * np.arange(-4, 5)[:, None]
    between: Floats = lifted[(lifted > low - 1e-6) & (lifted < high + 1e-6)]
    return between


def _cut(axes: Axes, drawn: Sequence[DrawnPass], quantity: str) -> bool:
    """Cuts the range of rates that grow without bound at input dead centres; returns whether it did."""
    ranges = [(line, span) for line in drawn if (span := line.span(quantity)) is not None]
    if not any(line.curves[quantity].cut for line, _ in ranges):
        return False
    spans = [span for _, span in ranges]
    factor, _ = _unit_of(drawn, quantity)
    low, high = factor * np.min(spans), factor * np.max(spans)
    if high > low:
        axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    return bool(high > low)


def _time_above(axes: Axes, motion: Motion, line: DrawnPass) -> None:
    rate, start = math.degrees(motion.speed), line.across("input")[0]
    there_and_back = (lambda angle: (angle - start) / rate), (lambda time: start + time * rate)
    above = axes.secondary_xaxis("top", functions=there_and_back)
    above.set_xlabel(say("time [s]"))


def curve_keys(panels: Iterable[Axes], drawn: Sequence[DrawnPass]) -> list[Line2D]:
    """One legend entry for each pass and for each kind of mark."""
    lines = {str(line.get_label()): line for axes in panels for line in axes.lines}
    named = [line.label for line in drawn]
    if len(set(named)) < len(named):
        # several lines to a circuit
        wide = drawn[0].style["lw"]
        for line in drawn:
            lines[line.label] = Line2D([], [], label=line.label, color=line.style["color"], lw=wide)
        for dashes, word in (("-", say("input rising")), (DASHED, say("input falling"))):
            named.append(word)
            lines[word] = Line2D([], [], label=word, color=QUIET, ls=dashes, lw=wide)
    marks = [say(mark) for mark in (EXTREME, LIMIT, CHANGE_POINT)]
    if marks[0] in lines:  # drawn in each circuit's colour
        ring: dict[str, Any] = {"ms": 4.5 * stroke(), "mfc": "white", "mec": "#404040"}
        lines[marks[0]] = Line2D([], [], ls="", marker="o", label=marks[0], **ring)
    return [lines[label] for label in dict.fromkeys((*named, *marks)) if label in lines]
