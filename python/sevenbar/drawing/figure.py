"""What all figures share: their style, the words on their axes, and how they are written to files."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sevenbar.arrays import Floats
from sevenbar.drawing.skeleton import short
from sevenbar.errors import OutputError, shown
from sevenbar.kinematics.circuits import Circuit
from sevenbar.kinematics.motion import Motion

#: What a figure can be written as.
FORMATS = ("png", "svg", "pdf")


PNG_DPI = 200


CIRCUIT_COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#6A3D9A", "#000000")


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


def slides(motion: Motion, column: str) -> bool:
    """Whether a column of the linkage is a length, and not an angle."""
    return motion.linkage.column_kinds[motion.linkage.columns.index(column)] == "slide"


def shown_value(motion: Motion, column: str, values: Any) -> Any:
    """Values of a column as they are drawn: angles in degrees, slides in the length unit."""
    return values if slides(motion, column) else np.degrees(values)


def input_label(motion: Motion) -> str:
    """What is written along an axis of the input."""
    name = short(motion.input, 40)
    if slides(motion, motion.input):
        return f"input position: {name} [{motion.linkage.length_unit}]"
    return f"input angle: {name} [deg]"


def new_figure(width: float, height: float) -> Figure:
    """An empty white figure [inch] with a canvas of its own, outside pyplot's register."""
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def title(motion: Motion) -> str:
    """The linkage's name and motion type."""
    return f"{short(motion.linkage.name, 60)}: {motion.motion_type}"


def told_range(circuit: Circuit, values: Floats, quantity: str) -> tuple[float, float] | None:
    """The ends of drawn values (n,), of rates that grow without bound those of `CUT`; `None` without any."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return None
    if quantity not in CUT or not circuit.turns_back:
        return float(finite.min()), float(finite.max())
    low, high = np.percentile(finite, [CUT[quantity], 100 - CUT[quantity]])
    return float(low), float(high)


def note(motion: Motion, cut: bool) -> str:
    """How the input is driven, and whether rates were cut."""
    name = short(motion.input, 40)
    unit = motion.linkage.length_unit if slides(motion, motion.input) else "rad"
    note = f"{name} at {motion.speed:g} {unit}/s"
    if motion.law is not None:
        note = f"{name} driven by a law"
    elif not all(circuit.goes_round for circuit in motion):
        note = f"{name} at ±{abs(motion.speed):g} {unit}/s"
    return note + ("; rates grow without bound at dead centres: axes cut" if cut else "")


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
