"""Figures of a motion: the linkage in space and the curves of its output (Figures 3 and 4 of the paper)."""

from __future__ import annotations

import math
import os
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sevenbar.errors import OutputError, RequestError, shown
from sevenbar.motion import Circuit, Extremes, Floats, Motion
from sevenbar.scene import Skeleton, bars, label, link_keys, put, short, skeleton, stage, walk

#: What a figure can be written as.
FORMATS = ("png", "svg", "pdf")

PNG_DPI = 200

CIRCUIT_COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7")

LINE_STYLES = ("-", (0, (5, 1.6)), (0, (5, 1.5, 1, 1.5)), (0, (1.2, 1.2)))

#: Names may hold dollars, so mathematical text is off.
STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "text.usetex": False,
    "text.parse_math": False,
    "axes.unicode_minus": True,
    "svg.hashsalt": "sevenbar",
    "pdf.fonttype": 42,
    "grid.color": "#e2e2e2",
}

#: Rates that grow without bound are cut at these percentiles (low end; the high end mirrors it).
CUT = {"velocity": 4.0, "acceleration": 9.0}

#: Marks in the curves' legend.
EXTREME, LIMIT, CHANGE_POINT = "extreme", "input limit", "change point"

LABELS = {
    "angle": "angle [deg]",
    "velocity": "angular velocity [rad/s]",
    "acceleration": "angular acceleration [rad/s²]",
}


def configuration(motion: Motion, circuit: int = 0, positions: int = 6) -> Figure:
    """The linkage in space, in several positions spread over a circuit: one strong, the others faint.

    `circuit` is its index in `motion.circuits`, `positions` how many poses (1 to 100). Lengths are in the
    linkage's unit, equal along all three axes. Raises `RequestError` where there is no such circuit.

    Source: Sun and Zhou, Figure 3.
    """
    chosen = chosen_circuit(motion, circuit)
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
        stage(axes, motion, frame)
        for pose in poses[1:]:
            put(bars(axes, motion, frame, ghost=True), pose)
        put(bars(axes, motion, frame), poses[0])
        label(axes, frame, poses[0], range(len(frame.names)))
        which = f"circuit {chosen.index}, {len(poses)} position{'s' * (len(poses) > 1)}"
        figure.suptitle(f"{title(motion)}\n{which}", fontsize=11)
        figure.legend(handles=link_keys(motion, frame), loc="lower center", ncols=4, frameon=False)
    return figure


def chosen_circuit(motion: Motion, index: int) -> Circuit:
    """The circuit of this index, or `RequestError` saying why there is none."""
    count = len(motion.circuits)
    if count == 0:
        closing = "at no input" if motion.motion_type == "cannot-assemble" else "along no circuit"
        raise RequestError(
            f"motion: {motion.motion_type}, the loop closes {closing}, so there is nothing to draw"
        )
    if isinstance(index, bool) or not isinstance(index, (int, np.integer)) or not 0 <= index < count:
        allowed = "0" if count == 1 else f"0 to {count - 1}"
        raise RequestError(f"circuit: {shown(index)} is not a circuit of this motion; give {allowed}")
    return motion.circuits[index]


def new_figure(width: float, height: float) -> Figure:
    """An empty white figure [inch] with a canvas of its own, outside pyplot's register."""
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def title(motion: Motion) -> str:
    """The linkage's name and motion type."""
    return f"{short(motion.linkage.name, 60)}: {motion.motion_type}"


def _spread(motion: Motion, circuit: Circuit, frame: Skeleton, positions: int) -> list[int]:
    """Rows with a pose, evenly spread by the travel of both angles, a rocking circuit's off its ends."""
    path = walk(motion, circuit)
    solved = np.flatnonzero(~np.isnan(frame.places[:, :4]).any(axis=(1, 2)))
    steps = np.hypot(np.diff(path.input[solved]), np.diff(path.output[solved]))
    travel = np.concatenate([[0.0], np.cumsum(steps)])
    start = 0.0 if circuit.input_range is None else 0.5
    wanted = (np.arange(positions) + start) / positions * travel[-1]
    return [int(solved[np.argmin(np.abs(travel - place))]) for place in wanted]


@dataclass(frozen=True, eq=False)
class Pass:
    """A pass of a circuit as drawn: `input`, `angle` [deg], `time` [s] and the two rates, arrays (n,)."""

    circuit: Circuit
    label: str
    style: dict[str, Any]
    input: Floats
    time: Floats
    angle: Floats
    velocity: Floats
    acceleration: Floats


def passes(motion: Motion) -> list[Pass]:
    """Every pass of every circuit; where the input goes back, the velocity is turned as it is in time."""
    made: list[Pass] = []
    for circuit in motion.circuits:
        path = walk(motion, circuit)
        for branch, part in enumerate(path.passes):
            label, way = f"circuit {circuit.index}", 1.0
            if len(path.passes) > 1:
                label += f", branch {branch}"
                if motion.law is None:
                    rise = path.input[part][-1] - path.input[part][0]
                    way = math.copysign(1.0, rise * motion.speed)
                    label += ": input rising" if rise > 0 else ": input falling"
            rates = path.rows[part], circuit.output_column
            colour = CIRCUIT_COLOURS[circuit.index % len(CIRCUIT_COLOURS)]
            style = {"color": colour, "ls": LINE_STYLES[len(made) % len(LINE_STYLES)], "lw": 1.6}
            angles = np.degrees(path.input[part]), path.time[part], np.degrees(path.output[part])
            made.append(Pass(circuit, label, style, *angles, way * circuit.dq[rates], circuit.ddq[rates]))
    return made


def curves(motion: Motion, against: Literal["both", "input", "time"] = "both") -> Figure:
    """Output angle [deg], velocity [rad/s] and acceleration [rad/s^2] of every circuit.

    `against` "input" [deg] or "time" [s] draws one of the two; "both" puts time on a second scale above where
    the input turns fully at constant speed, else in a second column. Where a rocking input goes back, the
    sign of the velocity is turned. Raises `RequestError` where the motion has no circuit.

    Source: Sun and Zhou, Figures 3 and 4.
    """
    chosen_circuit(motion, 0)
    if against not in ("both", "input", "time"):
        raise RequestError(f"against: {shown(against)} is not offered; give both, input or time")
    turning = motion.law is None and all(circuit.input_range is None for circuit in motion)
    columns = [against] if against != "both" else ["input"] if turning else ["input", "time"]
    drawn = passes(motion)
    with rc_context(STYLE):
        figure = new_figure(6.4 if len(columns) == 1 else 9.8, 7.8)
        figure.set_layout_engine("constrained", h_pad=0.05, w_pad=0.06)
        grid = figure.subplots(3, len(columns), sharex="col", sharey="row", squeeze=False)
        cut = False
        for row, quantity in enumerate(LABELS):
            for column, over in enumerate(columns):
                panel(grid[row, column], motion, drawn, quantity, over)
            cut |= _cut(grid[row, 0], drawn, quantity)
        for axes in grid.flat:
            axes.label_outer()
        if against == "both" and turning:
            _time_above(grid[0, 0], motion, drawn[0])
        figure.align_ylabels()
        figure.suptitle(title(motion), fontsize=11)
        keys = curve_keys(grid[0, 0], drawn)
        look = {"title": _note(motion, cut), "title_fontsize": 8.5, "frameon": False}
        figure.legend(handles=keys, loc="outside lower center", ncols=min(len(keys), 3), **look)
    return figure


def panel(axes: Axes, motion: Motion, drawn: Sequence[Pass], quantity: str, over: str) -> None:
    """Draws one quantity of the passes over "input" or "time", with the input limits and the extremes."""
    axes.grid(lw=0.6)
    for line in drawn:
        axes.plot(getattr(line, over), getattr(line, quantity), label=line.label, **line.style)
    for circuit in motion.circuits:
        own = [line for line in drawn if line.circuit is circuit]
        extremes: Extremes | None = getattr(circuit, quantity)
        if own and extremes is not None:
            sides = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
            values = [math.degrees(value) if quantity == "angle" else value for value, _ in sides]
            places = [
                _place(own, quantity, over, v, math.degrees(at))
                for v, (_, at) in zip(values, sides, strict=True)
            ]
            look = {"ms": 4.5, "mfc": "white", "mec": own[0].style["color"], "mew": 1.2, "zorder": 4}
            axes.plot(places, values, "o", ls="", label=EXTREME, **look)
    ends = np.concatenate([getattr(line, over) for line in drawn])
    room = 0.02 * np.ptp(ends) if over == "input" and motion.limits.size else 0.0
    if np.ptp(ends) > 0:
        axes.set_xlim(ends.min() - room, ends.max() + room)
    if over == "input":
        axes.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 1.5, 3, 4.5, 6, 10]))
        for inputs, style, name in ((motion.limits, "--", LIMIT), (motion.change_points, ":", CHANGE_POINT)):
            lifted = np.degrees(inputs) + 360.0 * np.arange(-4, 5)[:, None]
            for place in lifted[(lifted > ends.min() - 1e-6) & (lifted < ends.max() + 1e-6)]:
                axes.axvline(place, color="#505050", lw=1.0, ls=style, zorder=1, label=name)
    axes.set_xlabel(f"input angle: {short(motion.input, 40)} [deg]" if over == "input" else "time [s]")
    axes.set_ylabel(("output " if quantity == "angle" else "") + LABELS[quantity])


def _place(own: Sequence[Pass], quantity: str, over: str, value: float, at: float) -> float:
    """Where along a panel the passes of a circuit take a value at an input [deg], known to whole turns."""
    found = [(math.inf, math.nan)]
    for line in own:
        off = (line.input - at + 180.0) % 360.0 - 180.0
        for i in np.flatnonzero((off[:-1] * off[1:] <= 0) & (np.abs(off[:-1] - off[1:]) < 180.0)):
            share = off[i] / (off[i] - off[i + 1]) if off[i] != off[i + 1] else 0.0
            x, y = (v[i] + share * (v[i + 1] - v[i]) for v in (getattr(line, over), getattr(line, quantity)))
            found.append((abs(y - value), x))
    return min(found)[1]


def _cut(axes: Axes, drawn: Sequence[Pass], quantity: str) -> bool:
    """Cuts the range of rates that grow without bound at input dead centres; tells whether it did."""
    drawn = [line for line in drawn if np.isfinite(getattr(line, quantity)).any()]
    if quantity not in CUT or not any(_rocking(line.circuit) for line in drawn):
        return False
    spans: list[Floats] = []
    for line in drawn:
        values = getattr(line, quantity)
        share = CUT[quantity] if _rocking(line.circuit) else 0.0
        spans.append(np.percentile(values[np.isfinite(values)], [share, 100 - share]))
    low, high = np.min(spans), np.max(spans)
    axes.set_ylim(low - 0.1 * (high - low), high + 0.1 * (high - low))
    return True


def _rocking(circuit: Circuit) -> bool:
    return any(centre.kind == "input" for centre in circuit.dead_centres)


def _time_above(axes: Axes, motion: Motion, line: Pass) -> None:
    rate, start = math.degrees(motion.speed), line.input[0]

    def time(angle: Any) -> Any:
        return (angle - start) / rate

    def angle(time: Any) -> Any:
        return start + time * rate

    above = axes.secondary_xaxis("top", functions=(time, angle))
    above.set_xlabel("time [s]")


def _note(motion: Motion, cut: bool) -> str:
    name = short(motion.input, 40)
    note = f"{name} at {motion.speed:g} rad/s"
    if motion.law is not None:
        note = f"{name} driven by a law"
    elif any(circuit.input_range is not None for circuit in motion):
        note = f"{name} at ±{abs(motion.speed):g} rad/s"
    return note + ("; rates grow without bound at dead centres: axes cut" if cut else "")


def curve_keys(axes: Axes, drawn: Sequence[Pass]) -> list[Line2D]:
    """One legend entry for each pass and for each kind of mark."""
    lines = {str(line.get_label()): line for line in axes.lines}
    if EXTREME in lines:  # drawn in each circuit's colour
        lines[EXTREME] = Line2D([], [], ls="", marker="o", ms=4.5, mfc="white", mec="#404040", label=EXTREME)
    return [
        lines[label]
        for label in (*(line.label for line in drawn), EXTREME, LIMIT, CHANGE_POINT)
        if label in lines
    ]


def save(figure: Figure, path: str | os.PathLike[str]) -> Path:
    """Writes a figure as PNG (200 dpi), SVG or PDF, by the path's ending; returns the path.

    Raises `OutputError` for another ending and where the file cannot be written; then nothing is left behind.
    """
    target = Path(path)
    ending = target.suffix.lower().removeprefix(".")
    if ending not in FORMATS:
        raise OutputError(f"{target}: {shown(target.suffix)} is not a figure format; give .png, .svg or .pdf")
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with written_whole(target) as file, rc_context(STYLE):
        figure.savefig(file, format=ending, dpi=PNG_DPI, metadata=dates.get(ending))
    return target


@contextmanager
def written_whole(target: Path, *, keep: bool = True) -> Iterator[Path]:
    """A file beside `target` to write to; put in its place when all went well and `keep`, else removed."""
    partial = target.parent / f".partial-{uuid.uuid4().hex}{target.suffix}"
    try:
        if target.is_dir():
            raise IsADirectoryError(0, "it is a folder")
        yield partial
        if keep:
            partial.replace(target)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(
            f"{target}: cannot be written: {reason}; give a path in a folder that exists and can be written"
        ) from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
