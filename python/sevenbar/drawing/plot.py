"""Figures of a motion: the linkage in space and the curves of its output (Figures 3 and 4 of the paper).

The public place of all figures: those of `paths`, and `save`, can be called from here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import (
    CIRCUIT_COLOURS,
    FORMATS,
    LINE_STYLES,
    STYLE,
    input_label,
    new_figure,
    note,
    save,
    shown_value,
    slides,
    title,
    told_range,
)
from sevenbar.drawing.paths import joints, modes_overview, point_path
from sevenbar.drawing.scene import bars, keys, label, put, stage
from sevenbar.drawing.skeleton import Skeleton, skeleton
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits import Circuit, Extremes
from sevenbar.kinematics.motion import Motion, chosen_circuit
from sevenbar.kinematics.poses import walk

__all__ = ["FORMATS", "configuration", "curves", "joints", "modes_overview", "point_path", "save"]


#: Marks in the curves' legend.
EXTREME, LIMIT, CHANGE_POINT = "extreme", "input limit", "change point"


#: The rows of the output's curves.
QUANTITIES = ("angle", "velocity", "acceleration")


def _label(motion: Motion, quantity: str) -> str:
    if slides(motion, motion.output):
        unit = motion.linkage.length_unit
        name = "output position" if quantity == "angle" else quantity
        suffix = {"angle": "", "velocity": "/s", "acceleration": "/s²"}[quantity]
        return f"{name} [{unit}{suffix}]"
    return {
        "angle": "output angle [deg]",
        "velocity": "angular velocity [rad/s]",
        "acceleration": "angular acceleration [rad/s²]",
    }[quantity]


def configuration(motion: Motion, circuit: int = 0, positions: int | None = None) -> Figure:
    """The linkage in space, in several positions spread over a circuit: one strong, the others faint.

    `circuit` is its index in `motion.circuits`, `positions` how many poses (1 to 100; six for up to four
    joints, else three). Lengths are in the linkage's unit, equal along all three axes. Raises
    `RequestError` where there is no such circuit.

        >>> import sevenbar as sb
        >>> figure = configuration(sb.load("bennett").motion())
        >>> figure.axes[0].get_zlabel()
        'z [mm]'

    Source: Sun and Zhou, Figure 3.
    """
    chosen = chosen_circuit(motion, circuit)
    if positions is None:
        positions = 6 if len(motion.linkage.joints) < 5 else 3
    if (
        isinstance(positions, bool)
        or not isinstance(positions, (int, np.integer))
        or not 1 <= positions <= 100
    ):
        raise RequestError(f"positions: {shown(positions)} is not a count; give 1 to 100")
    frame = skeleton(motion, chosen)
    poses = [frame.pose(row) for row in _spread(motion, chosen, frame, int(positions))]
    with rc_context(STYLE):
        figure = new_figure(7.0, 7.0)
        axes = figure.add_axes((0.0, 0.02, 1.0, 1.0), projection="3d")
        ends = motion.input, motion.output
        stage(axes, frame, ends)
        for pose in poses[1:]:
            put(bars(axes, frame, ends, ghost=True), pose)
        put(bars(axes, frame, ends), poses[0])
        label(axes, frame, poses[0], range(len(frame.names)))
        which = f"circuit {chosen.index}, {len(poses)} position{'s' * (len(poses) > 1)}"
        figure.suptitle(f"{title(motion)}\n{which}", fontsize=11)
        figure.legend(handles=keys(frame, ends), loc="lower center", ncols=4, frameon=False)
    return figure


def _spread(motion: Motion, circuit: Circuit, frame: Skeleton, positions: int) -> list[int]:
    """Rows with a pose, evenly spread by the travel of both angles, a rocking circuit's off its ends."""
    path = walk(circuit)
    solved = np.flatnonzero(~np.isnan(frame.places[:, : frame.solid]).any(axis=(1, 2)))
    ends = ((motion.input, path.input[solved]), (motion.output, path.output[solved]))
    # of a slide its whole range counts as much as half a turn
    scaled = [v * math.pi / (np.ptp(v) or 1.0) if slides(motion, column) else v for column, v in ends]
    steps = np.hypot(*(np.diff(values) for values in scaled))
    travel = np.concatenate([[0.0], np.cumsum(steps)])
    # many a loop lies flat, or folded, at zero
    wanted = (np.arange(positions) + 0.35) / positions * travel[-1]
    return [int(solved[np.argmin(np.abs(travel - place))]) for place in wanted]


@dataclass(frozen=True, eq=False)
class DrawnPass:
    """A pass of a circuit as drawn: `input`, `angle` [deg, or length], `time` [s], the two rates; (n,)."""

    circuit: Circuit
    label: str
    style: dict[str, Any]
    input: Floats
    time: Floats
    angle: Floats
    velocity: Floats
    acceleration: Floats


def passes(motion: Motion) -> list[DrawnPass]:
    """Every pass of every circuit; where the input goes back, the velocity is turned as it is in time."""
    made: list[DrawnPass] = []
    for circuit in motion.circuits:
        path = walk(circuit)
        velocity = path.velocities(circuit.dq[:, circuit.output_column])
        acceleration = circuit.ddq[path.rows, circuit.output_column]
        for branch, part in enumerate(path.passes):
            label = f"circuit {circuit.index}"
            if len(path.passes) > 1:
                label += f", branch {branch}"
                if motion.law is None:
                    rise = path.input[part][-1] - path.input[part][0]
                    label += ": input rising" if rise > 0 else ": input falling"
            colour = CIRCUIT_COLOURS[circuit.index % len(CIRCUIT_COLOURS)]
            style = {
                "color": colour,
                "ls": LINE_STYLES[(len(made) + len(made) // 8) % len(LINE_STYLES)],
                "lw": 1.6,
            }
            angles = (
                shown_value(motion, motion.input, path.input[part]),
                path.time[part],
                shown_value(motion, motion.output, path.output[part]),
            )
            made.append(DrawnPass(circuit, label, style, *angles, velocity[part], acceleration[part]))
    return made


def curves(motion: Motion, against: Literal["both", "input", "time"] = "both") -> Figure:
    """Output angle [deg], velocity [rad/s] and acceleration [rad/s^2] of every circuit; of a slide lengths.

    `against` "input" [deg] or "time" [s] draws one of the two; "both" puts time on a second scale above where
    the input turns fully at constant speed, else in a second column. Where a rocking input goes back, the
    sign of the velocity is turned. Raises `RequestError` where the motion has no circuit.

        >>> import sevenbar as sb
        >>> figure = curves(sb.load("rssr").motion(), against="input")
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['output angle [deg]', 'angular velocity [rad/s]', 'angular acceleration [rad/s²]']

    Source: Sun and Zhou, Figures 3 and 4.
    """
    chosen_circuit(motion, 0)
    if against not in ("both", "input", "time"):
        raise RequestError(f"against: {shown(against)} is not offered; give both, input or time")
    turning = motion.law is None and all(circuit.goes_round for circuit in motion)
    columns = [against] if against != "both" else ["input"] if turning else ["input", "time"]
    drawn = passes(motion)
    with rc_context(STYLE):
        figure = new_figure(6.4 if len(columns) == 1 else 9.8, 7.8)
        figure.set_layout_engine("constrained", h_pad=0.05, w_pad=0.06)
        grid = figure.subplots(3, len(columns), sharex="col", sharey="row", squeeze=False)
        cut = False
        for row, quantity in enumerate(QUANTITIES):
            for column, over in enumerate(columns):
                panel(grid[row, column], motion, drawn, quantity, over)
            cut |= _cut(grid[row, 0], drawn, quantity)
        for axes in grid.flat:
            axes.label_outer()
        if against == "both" and turning:
            _time_above(grid[0, 0], motion, drawn[0])
        figure.align_ylabels()
        figure.suptitle(title(motion), fontsize=11)
        keys = curve_keys(grid[:, 0], drawn)
        look = {"title": note(motion, cut), "title_fontsize": 8.5, "frameon": False}
        figure.legend(
            handles=keys,
            loc="outside lower center",
            ncols=min(len(keys), 3 if len(keys) < 7 else 5 if len(columns) == 1 else 6),
            **look,
        )
    return figure


def panel(axes: Axes, motion: Motion, drawn: Sequence[DrawnPass], quantity: str, over: str) -> None:
    """Draws one quantity of the passes over "input" or "time", with the input limits and the extremes."""
    axes.grid(lw=0.6)
    for line in drawn:
        axes.plot(getattr(line, over), getattr(line, quantity), label=line.label, **line.style)
    for circuit in motion.circuits:
        own = [line for line in drawn if line.circuit is circuit]
        extremes: Extremes | None = getattr(circuit, quantity)
        if own and extremes is not None:
            sides = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
            values = [
                shown_value(motion, motion.output, value) if quantity == "angle" else value
                for value, _ in sides
            ]
            period = math.inf if slides(motion, motion.input) else 360.0
            lines = [(line.input, getattr(line, over), getattr(line, quantity)) for line in own]
            places = [
                place_of(lines, v, shown_value(motion, motion.input, at), period)
                for v, (_, at) in zip(values, sides, strict=True)
            ]
            look = {"ms": 4.5, "mfc": "white", "mec": own[0].style["color"], "mew": 1.2, "zorder": 4}
            axes.plot(places, values, "o", ls="", label=EXTREME, **look)
    ends = np.concatenate([getattr(line, over) for line in drawn])
    room = 0.02 * np.ptp(ends) if over == "input" and motion.limits.size else 0.0
    if np.ptp(ends) > 0:
        axes.set_xlim(ends.min() - room, ends.max() + room)
    if over == "input":
        if not slides(motion, motion.input):
            axes.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 1.5, 3, 4.5, 6, 10]))
        for inputs, style, name in (
            (motion.limits, "--", LIMIT),
            (motion.change_point_inputs, ":", CHANGE_POINT),
        ):
            for place in inputs_between(motion, inputs, ends.min(), ends.max()):
                axes.axvline(place, color="#505050", lw=1.0, ls=style, zorder=1, label=name)
    axes.set_xlabel(input_label(motion) if over == "input" else "time [s]")
    axes.set_ylabel(_label(motion, quantity))


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
    found = [(math.inf, math.nan)]
    for inputs, across, values in lines:
        off = inputs - at
        if math.isfinite(period):
            off = (off + period / 2) % period - period / 2
        for i in np.flatnonzero((off[:-1] * off[1:] <= 0) & (np.abs(off[:-1] - off[1:]) < period / 2)):
            share = off[i] / (off[i] - off[i + 1]) if off[i] != off[i + 1] else 0.0
            x, y = (v[i] + share * (v[i + 1] - v[i]) for v in (across, values))
            found.append((abs(y - value), x))
    return min(found)[1]


def _cut(axes: Axes, drawn: Sequence[DrawnPass], quantity: str) -> bool:
    """Cuts the range of rates that grow without bound at input dead centres; tells whether it did."""
    told = [(line, told_range(line.circuit, getattr(line, quantity), quantity)) for line in drawn]
    spans = [span for _, span in told if span is not None]
    if quantity == "angle" or not any(span is not None and line.circuit.turns_back for line, span in told):
        return False
    low, high = np.min(spans), np.max(spans)
    axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    return True


def _time_above(axes: Axes, motion: Motion, line: DrawnPass) -> None:
    rate, start = math.degrees(motion.speed), line.input[0]

    def time(angle: Any) -> Any:
        return (angle - start) / rate

    def angle(time: Any) -> Any:
        return start + time * rate

    above = axes.secondary_xaxis("top", functions=(time, angle))
    above.set_xlabel("time [s]")


def curve_keys(panels: Iterable[Axes], drawn: Sequence[DrawnPass]) -> list[Line2D]:
    """One legend entry for each pass and for each kind of mark."""
    lines = {str(line.get_label()): line for axes in panels for line in axes.lines}
    if EXTREME in lines:  # drawn in each circuit's colour
        lines[EXTREME] = Line2D([], [], ls="", marker="o", ms=4.5, mfc="white", mec="#404040", label=EXTREME)
    return [
        lines[label]
        for label in (*(line.label for line in drawn), EXTREME, LIMIT, CHANGE_POINT)
        if label in lines
    ]
