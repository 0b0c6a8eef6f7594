"""What all figures share: their style, the words on their axes, and how they are written to files."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from sevenbar.arrays import Floats
from sevenbar.drawing.names import quantity_label, short, shown_name
from sevenbar.drawing.space import measuring
from sevenbar.drawing.style import STYLE, letters, page_size
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.errors import OutputError, RequestError, shown
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.text.aside import aside_prefix, clear_left
from sevenbar.text.paths import is_folder
from sevenbar.text.words import say

#: What a figure can be written as.
FORMATS = ("png", "svg", "pdf", "eps")


PNG_DPI = 200

#: A figure that is usually wider than this [inch] takes both columns of a paper.
BOTH_COLUMNS = 7.5

#: Letters [points] below which none are made smaller.
SMALLEST = 4.0

#: Width and height [inch] of a picture or a panel at least, for letters of 9 points: less cannot be read.
LEAST_ROOM = 0.8, 0.3

#: What a title may take of the width of its page.
TITLE_SHARE = 0.97


#: Rates that grow without bound are cut at these percentiles (low end; the high end mirrors it), by order.
CUT = {1: 4.0, 2: 9.0}


def slides(motion: Motion, column: str) -> bool:
    """Whether a column of the linkage is a length, and not an angle."""
    return not motion.linkage.turns(column)


def shown_value(motion: Motion, column: str, values: Any) -> Any:
    """Values of a column as they are drawn: angles in degrees, slides in the length unit."""
    return values if slides(motion, column) else np.degrees(values)


def input_label(motion: Motion) -> str:
    """What is written along an axis of the input."""
    return column_label(motion, motion.input)


def gridded(axes: Axes) -> None:
    """Draws a grid behind the curves of a panel."""
    axes.grid(True)
    axes.set_axisbelow(True)


def input_scale(axes: Axes, inputs: Floats, most: int, *, turns: bool) -> None:
    """Limits and ticks of the input below a panel; `inputs` (n,) as drawn, angles at most so many."""
    # a law may leave every range, or have one row
    known = inputs[np.isfinite(inputs)]
    if known.size and np.ptp(known) > 0:
        axes.set_xlim(known.min(), known.max())
    if turns:
        axes.xaxis.set_major_locator(DegreeLocator(most))


def input_axis(axes: Axes, motion: Motion, inputs: Floats, most: int) -> None:
    """`input_scale` of a motion, and its label."""
    input_scale(axes, inputs, most, turns=not slides(motion, motion.input))
    axes.set_xlabel(input_label(motion))


def column_label(motion: Motion, column: str) -> str:
    """What is written along an axis of a column: its name, whether it turns or slides, the unit."""
    if slides(motion, column):
        return quantity_label(column, "position", motion.linkage.length_unit)
    return quantity_label(column, "angle", "deg")


def new_figure(width: float, height: float, *, pads: tuple[float, float] | None = None) -> Figure:
    """An empty white figure [inch] with a canvas of its own, outside pyplot's register.

    With `pads` its panels are laid out by matplotlib, with this room [inch] above and at the sides of each.
    """
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    if pads is not None:
        figure.set_layout_engine("constrained", h_pad=pads[0], w_pad=pads[1])
    return figure


def page_figure(width: float, height: float, *, pads: tuple[float, float] | None = None) -> Figure:
    """`new_figure` of a usual size [inch], or of the style's width: both columns where it is wide."""
    return new_figure(*page_size(None, None, (width, height), wide=width > BOTH_COLUMNS), pads=pads)


def title_of(motion: Motion) -> str:
    """The linkage's name and motion type."""
    heading = short(motion.linkage.heading, 60)
    return say("{linkage}: {motion_type}", linkage=heading, motion_type=say(motion.motion_type))


def title_text(title: bool | str, usual: str) -> str:
    """The title of a figure: the caller's own, the usual one, or none."""
    return title if isinstance(title, str) else usual if title else ""


def headline(figure: Figure, text: str, **place: Any) -> Text:
    """Writes the title of a figure, no wider than its page; `place` goes to matplotlib."""
    title = figure.suptitle(text, **place)
    fit_letters(title, TITLE_SHARE * figure.get_figwidth())
    return title


def fit_letters(text: Text, width: float) -> None:
    """Makes a text that is wider than so much [inch] smaller: fonts differ from machine to machine."""
    figure: Any = text.get_figure()
    renderer = measuring(figure)
    # widths of letters are whole pixels, so they do not follow their size evenly
    while (wide := text.get_window_extent(renderer).width / figure.dpi) > width:
        size = float(text.get_fontsize()) * min(0.98, width / wide)
        if size < SMALLEST:
            break
        text.set_fontsize(size)


def key_below(figure: Figure, handles: Sequence[Any], heading: str = "") -> None:
    """Writes a legend below all panels, in as many columns as the page is wide."""
    width = figure.bbox.width
    for lines in range(1, len(handles) + 1):
        made = figure.legend(
            handles=list(handles), loc="outside lower center", ncols=-(-len(handles) // lines),
            title=heading or None, title_fontsize="small", frameon=False,
        )  # fmt: skip
        if made.get_window_extent(measuring(figure)).width <= 0.98 * width or lines == len(handles):
            break
        made.remove()


def circuits_text(numbers: Sequence[int]) -> str:
    """Circuits by their numbers: "circuit 3", "circuits 1 and 5", "circuits 0, 1 and 2"."""
    *first, last = map(str, numbers)
    if not first:
        return say("circuit {number}", number=last)
    return say("circuits {numbers} and {last}", numbers=say(", ").join(first), last=last)


def given_axes(ax: Any, count: int, what: str) -> list[Any]:
    """The caller's axes, as a list of so many; raises `RequestError` for another number."""
    result = list(np.ravel(np.asarray(ax, dtype=object)))
    if len(result) != count or not all(hasattr(axes, "plot") for axes in result):
        raise RequestError(f"ax: give {count} axes of matplotlib, {what}")
    return result


def refuse_small(figure: Figure, wide: float, tall: float, what: str, instead: str) -> None:
    """`RequestError` for a page that leaves so little width and height [inch] to what it shows."""
    least = letters() / 9.0 * np.array(LEAST_ROOM)
    if wide >= least[0] and tall >= least[1]:
        return
    given = " x ".join(f"{25.4 * side:.3g}" for side in figure.get_size_inches())
    raise RequestError(f"size: {given} mm is too small for {what}; give a greater one, or {instead}")


def tidy(figure: Figure) -> None:
    """Breaks the labels of upright axes that are longer than the axis, at the unit, then at words."""
    renderer = measuring(figure)
    figure.draw_without_rendering()
    for axes in figure.axes:
        label = axes.yaxis.label
        for mark in (" [", " "):
            if label.get_window_extent(renderer).height > 0.98 * axes.bbox.height:
                head, _, tail = label.get_text().rpartition(mark)
                if head:
                    label.set_text(f"{head}\n{mark.strip()}{tail}")
    figure.align_ylabels()


def note(motion: Motion, cut: bool) -> str:
    """How the input is driven, and whether rates were cut."""
    name = shown_name(motion.input)
    unit = motion.linkage.unit_of(motion.input)
    speed = motion.speed_written or f"{motion.speed:g} {unit}/s"
    if not all(circuit.goes_round for circuit in motion):
        speed = f"±{abs(motion.speed):g} {unit}/s"
    driven = say("{joint} at {speed}", joint=name, speed=speed)
    if motion.law is not None:
        driven = say("{joint} driven by a law", joint=name)
    if not cut:
        return driven
    return say("{driven}; rates grow without bound at dead centres: axes cut", driven=driven)


def format_of(path: Path) -> str:
    """The format of a figure by its path's ending; `OutputError` for another ending."""
    ending = path.suffix.lower().removeprefix(".")
    if ending not in FORMATS:
        raise OutputError(
            f"{path}: {shown(path.suffix)} is not a figure format; give .png, .svg, .pdf or .eps"
        )
    return ending


def save(figure: Figure, path: str | os.PathLike[str]) -> Path:
    """Writes a figure as PNG (200 dpi), SVG, PDF or EPS, by the path's ending; returns the path.

    Raises `OutputError` for another ending and where the file cannot be written; then nothing is left behind.
    """
    target = Path(path)
    ending = format_of(target)
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with written_whole(target) as file, rc_context(STYLE):
        figure.savefig(file, format=ending, dpi=PNG_DPI, metadata=dates.get(ending))
        if ending == "eps":
            # nor the name of a file aside, so that one figure gives the same bytes
            dated, lines = (b"%%CreationDate", b"%%Title"), file.read_bytes().split(b"\n")
            file.write_bytes(b"\n".join(line for line in lines if not line.startswith(dated)))
    return target


@contextmanager
def written_whole(target: Path, *, keep: bool = True) -> Iterator[Path]:
    """A file beside `target` to write to; put in its place when all went well and `keep`, else removed."""
    clear_left(target.parent)
    partial = target.parent / f"{aside_prefix()}{uuid.uuid4().hex}{target.suffix}"
    try:
        if is_folder(target):
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
