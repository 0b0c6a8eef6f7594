"""Styles of figures, for screens and for papers, and the colours: each has one meaning in all figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from matplotlib import rc_context, rcParams
from matplotlib.font_manager import get_font_names

from sevenbar.drawing.asked import asked_style
from sevenbar.drawing.fonts import chinese_font
from sevenbar.errors import RequestError, check_word, shown
from sevenbar.text.words import language, spoken

#: Links, from the colours of Okabe and Ito, which colour-blind readers can distinguish.
INPUT, OUTPUT, COUPLER, GROUND = "#0072B2", "#D55E00", "#009E73", "#808080"

#: Rods between two links of a net.
ROD = "#5b6b7b"

#: Joints that are neither input nor output, and the paths of joints between moving links.
JOINT, PATH = "#9a9a9a", "#b5c7bd"

#: Named points and their paths.
POINT_COLOURS = ("#CC79A7", "#E69F00", "#56B4E9", "#000000")

#: Circuits, from the muted colours of Tol: none is that of a link.
CIRCUIT_COLOURS = ("#332288", "#CC6677", "#6B8E23", "#882255", "#44AA99", "#B8860B", "#AA4499", "#000000")

#: Vectors of a point.
VELOCITY, ACCELERATION = "#7A3E9D", "#B5651D"

#: The force in a joint.
REACTION = "#C2185B"

#: What is computed, where it is compared with what comes from elsewhere: measured, wanted, another program's.
COMPUTED, OTHER = CIRCUIT_COLOURS[0], "#C77700"

#: Lines of zeros, limits and marks; lines that only lead the eye.
INK, QUIET = "#303030", "#505050"

#: Styles of lines one after the other.
LINE_STYLES = ("-", (0, (5, 1.6)), (0, (5, 1.5, 1, 1.5)), (0, (1.2, 1.2)))


def circuit_colour(index: int) -> str:
    """The colour of a circuit by its number."""
    return CIRCUIT_COLOURS[index % len(CIRCUIT_COLOURS)]


def line_style(index: int) -> Any:
    """The style of a line by its number; lines of one colour have others."""
    return LINE_STYLES[(index + index // len(CIRCUIT_COLOURS)) % len(LINE_STYLES)]


#: Names may hold dollars, so mathematical text is off; text in SVG stays text.
STYLE: dict[Any, Any] = {
    "font.size": 9.0,
    "text.usetex": False,
    "text.parse_math": False,
    "axes.unicode_minus": True,
    "svg.hashsalt": "sevenbar",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "grid.color": "#e2e2e2",
    "grid.linewidth": 0.6,
    "figure.titlesize": 11.0,
    "axes.titlesize": 10.0,
    "legend.frameon": False,
}

#: Millimetres in an inch.
MM = 25.4


@dataclass(frozen=True)
class FigureStyle:
    """A style: settings of matplotlib beyond the common ones, and the widths [inch] of one and two columns.

    Without widths each figure has a size of its own. The first of `fonts` that there is is used.
    """

    settings: dict[Any, Any] = field(default_factory=dict)
    widths: tuple[float, float] | None = None
    fonts: tuple[str, ...] = ()


def _for_paper(size: float) -> dict[Any, Any]:
    """Settings for letters of a size [points], and lines that are thin with them."""
    return {
        "font.size": size,
        "figure.titlesize": size + 1.0,
        "axes.titlesize": size,
        "axes.labelsize": size,
        "xtick.labelsize": size - 0.5,
        "ytick.labelsize": size - 0.5,
        "legend.fontsize": size - 0.5,
        "lines.linewidth": 1.0,
        "axes.linewidth": 0.6,
        "grid.linewidth": 0.4,
        **{
            f"{axis}tick.major.{what}": value
            for axis in "xy"
            for what, value in (("width", 0.6), ("size", 2.5))
        },
    }


_SANS = ("Arial", "Helvetica", "Liberation Sans", "Arimo")

#: The styles by name: "paper" for columns of 85 and 170 mm, "ieee" for those of IEEE.
STYLES: dict[str, FigureStyle] = {
    "screen": FigureStyle(),
    "paper": FigureStyle(_for_paper(7.5), (85 / MM, 170 / MM), _SANS),
    "ieee": FigureStyle(
        _for_paper(8.0), (3.5, 7.16), ("Times New Roman", "Times", "Liberation Serif", "Tinos", "STIXGeneral")
    ),
}

#: The width of lines [points] for which widths in the figures are written.
USUAL_LINE = 1.5


def check_style(name: str, key: str = "style") -> str:
    """The name of a style; raises `RequestError` for another."""
    check_word(key, name, STYLES, "a style")
    return name


@contextmanager
def styled(name: str | None = None) -> Iterator[None]:
    """Draws in a style, that of `drawn_as` or "screen" where none is given, and leaves matplotlib as it was.

    In Chinese with a font that has its characters; where none is installed, in English, with a warning.
    """
    chosen = STYLES[check_style(name or asked_style() or "screen")]
    fonts: dict[Any, Any] = {}
    chinese = chinese_font() if spoken() == "zh" else None
    if chosen.fonts or chinese:
        there = set(get_font_names())
        latin = [font for font in chosen.fonts if font in there][:1]
        # letters that a font lacks, such as subscripts, are taken from the next one
        last = ["DejaVu Sans", chinese] if chinese and not latin else [chinese, "DejaVu Sans"]
        fonts = {"font.family": [*latin, *(font for font in last if font)]}
    settings = {**STYLE, "lines.linewidth": USUAL_LINE, **chosen.settings, **fonts}
    with rc_context(settings), language("zh" if chinese else "en"):
        yield


def stroke() -> float:
    """The factor of the widths of lines and marks in the style that is drawn in."""
    return float(rcParams["lines.linewidth"]) / USUAL_LINE


def letters() -> float:
    """The size of the letters [points] in the style that is drawn in."""
    return float(rcParams["font.size"])


def page_size(
    style: str | None, figsize: Sequence[float] | None, usual: tuple[float, float], *, wide: bool
) -> tuple[float, float]:
    """Width and height [inch] of a figure: as given, else as the style has it, else the usual one.

    `wide`: it takes both columns of a page.
    """
    if figsize is not None:
        return checked_size(figsize)
    widths = STYLES[style or asked_style() or "screen"].widths
    if widths is None:
        return usual
    width = widths[wide]
    return width, usual[1] * width / usual[0]


def checked_size(figsize: Sequence[float]) -> tuple[float, float]:
    """Width and height [inch]; raises `RequestError` for anything else."""
    try:
        width, height = (float(side) for side in figsize)
    except (TypeError, ValueError):
        width = height = 0.0
    if not (0.5 <= width <= 60 and 0.5 <= height <= 60):
        raise RequestError(
            f"figsize: {shown(figsize)} is not a size; give width and height of 0.5 to 60 inches, "
            "as in (3.3, 2.5)"
        )
    return width, height


def paler(colour: str, white: float) -> tuple[float, float, float]:
    """A colour mixed with a share of white: as if it were transparent, in formats that cannot be."""
    from matplotlib.colors import to_rgb

    red, green, blue = (white + (1.0 - white) * part for part in to_rgb(colour))
    return red, green, blue
