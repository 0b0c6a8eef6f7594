"""The map as a figure to pin to the wall: regions, boundaries, contours, the design and what changes it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path

from sevenbar.design.maps.atlas import Map
from sevenbar.design.maps.heights import Heights
from sevenbar.design.maps.lettering import LINE, RASTER, is_free, names, take, write
from sevenbar.design.maps.plane import Kind
from sevenbar.drawing.asked import asked_style
from sevenbar.drawing.figure import new_figure
from sevenbar.drawing.names import short
from sevenbar.drawing.style import STYLES, letters, styled
from sevenbar.errors import check_word
from sevenbar.text.words import say

#: Sheets of paper, width and height [inch].
SIZES = {"A4": (11.69, 8.27), "A3": (16.54, 11.69), "A2": (23.39, 16.54), "A1": (33.11, 23.39)}

#: Letters and lines grow slower than the sheet: a wall map is read from nearer than its size.
GROWTH = 0.8

#: Letters on A4 [points], and the height of a map in a paper as a share of its width.
LETTERS, PAPER_SHAPE = 9.5, 0.78

#: Fill and hatch of each motion type; the fills differ in lightness, so grey copies can be read.
LOOKS: dict[str, tuple[str, str]] = {
    "double-crank": ("#3f7f5a", ""),
    "crank-rocker": ("#7fb0dc", ""),
    "rocker-crank": ("#c4785f", ""),
    "double-rocker": ("#f3e3ae", ""),
    "cannot-assemble": ("#ffffff", "///"),
    "invalid": ("#ffffff", "xxx"),
    "change-point": ("#b0b0b0", "..."),
}

#: Fills of motion types that no table foresees, and of a type with other counts of circuits.
OTHERS = ("#c7b8dd", "#e9c3d3", "#bfe0dc", "#d9d9d9", "#dfe3b4", "#b9bfd9")

#: How much lighter each further count of circuits of one type is than the one before, or darker.
SHADE = -0.16

#: No fill is darkened to less than this part, so that letters on it can be read.
DARKEST = 0.35

#: How much lighter all fills are below contours.
FAINT = 0.55

#: Colours of hatches, of contours with their values, and of the design with its arms.
HATCH = "#c4c4c4"
CONTOUR = "#7a1f5c"
MARK = "#c1121f"

#: Contours shorter than this have no value on them, longer ones than that have two [share of the ranges].
SHORT, LONG = 0.07, 0.9

#: Where values are written [share of the contour], and how far those of every other level are moved.
ONE, SEVERAL, STAGGER = 0.45, (0.25, 0.7), 0.1

#: No value is written nearer to the window's edge [share].
ROOM = 0.015

#: How far a value is moved along its contour where something is written already [share of the contour].
MOVED = (0.0, 0.07, -0.07, 0.14, -0.14, 0.21, -0.21)

#: Room that the value on a contour takes, to each side [share].
LABEL = (0.03, 0.02)


def sheet(size: str) -> tuple[float, float]:
    """Width and height [inch] of a sheet of this name; raises `RequestError` for another."""
    name = size.strip().upper() if isinstance(size, str) else size
    check_word("size", name, SIZES, "a sheet")
    return SIZES[name]


def draw(
    of: Map,
    heights: Heights | None = None,
    *,
    size: str | None = None,
    side: bool = True,
    title: bool = True,
) -> Figure:
    """The map on a sheet, with the contours of a measure where one is given.

    `size`: one of `SIZES`; both columns of a paper where a style for papers was chosen, else A4.
    `side`: with the column of the key and the numbers; `title`: with the title above.
    """
    with styled():
        widths = STYLES[asked_style() or "screen"].widths
        if size is None and widths is not None:
            width, height = widths[1], PAPER_SHAPE * widths[1]
            scale = letters() / LETTERS
        else:
            width, height = sheet(size or "A4")
            scale = (width / SIZES["A4"][0]) ** GROWTH
        rcParams.update({"font.size": LETTERS * scale, "hatch.linewidth": 0.7 * scale})
        figure = new_figure(width, height)
        margin = 0.62 * scale
        wide = 2.75 * scale if side else 0.0
        left, below = (margin + 0.2 * scale) / width, margin / height
        room = (1 - (2 * margin + wide) / width, 1 - (1.45 * margin + 0.15 * scale) / height)
        axes = figure.add_axes((left, below, *room))
        _fill(axes, of, scale, faint=heights is not None)
        taken = np.zeros((RASTER, RASTER), dtype=bool)
        _design(axes, of, scale, taken)
        if heights is not None:
            _contours(axes, heights, of, scale, taken)
        names(axes, of, scale, taken, (width, height))
        _frame(axes, of, scale)
        if side:
            _side(figure, axes, of, heights, scale)
        if title:
            _title(figure, axes, of, heights, scale)
    return figure


def look(of: Map, kind: Kind, *, faint: bool = False) -> dict[str, Any]:
    """Fill and hatch of a kind on a map; `faint` below contours."""
    if kind.motion_type in LOOKS:
        fill, hatch = LOOKS[kind.motion_type]
    else:
        types = dict.fromkeys(k.motion_type for k in of.areas)
        others = [t for t in types if t not in LOOKS]
        fill, hatch = OTHERS[others.index(kind.motion_type) % len(OTHERS)], ""
    counts = sorted(k.circuits for k in of.areas if k.motion_type == kind.motion_type)
    place = counts.index(kind.circuits) if kind.circuits in counts else 0
    colour = _shaded(fill, place * SHADE)
    if faint:
        colour = _shaded(colour, FAINT)
    return {"facecolor": colour, "edgecolor": HATCH, "hatch": hatch, "lw": 0.0}


def _shaded(colour: str | tuple[float, float, float], by: float) -> tuple[float, float, float]:
    """A colour moved towards white, or for a number below 0 towards black."""
    rgb = np.array(to_rgb(colour))
    red, green, blue = (rgb + (1 - rgb) * by if by > 0 else rgb * max(DARKEST, 1 + by)).tolist()
    return red, green, blue


def _fill(axes: Axes, of: Map, scale: float, *, faint: bool) -> None:
    for region in of.regions:
        loops = (of.values(np.vstack([loop, loop[:1]])) for loop in (region.outline, *region.holes))
        path = Path.make_compound_path(*(Path(loop, closed=True) for loop in loops))
        axes.add_patch(PathPatch(path, zorder=1, **look(of, of.kinds[region.kind], faint=faint)))
    for line in of.boundaries:
        alike = of.kinds[line.left].motion_type == of.kinds[line.right].motion_type
        style: dict[str, Any] = {"ls": (0, (4, 2)), "lw": 1.0 * scale} if alike else {"lw": 1.6 * scale}
        axes.plot(*of.values(line.places).T, color=LINE, solid_capstyle="round", zorder=4, **style)


def _contours(axes: Axes, heights: Heights, of: Map, scale: float, taken: np.ndarray) -> None:
    """Contour lines with their values written on them."""
    suffix = _suffix(heights.unit)
    for line in heights.contours:
        axes.plot(*of.values(line.places).T, color=CONTOUR, lw=1.05 * scale, zorder=3, solid_capstyle="round")
        lengths = np.hypot(*np.diff(line.places, axis=0).T)
        along = np.concatenate([[0.0], np.cumsum(lengths)])
        if along[-1] < SHORT:
            continue
        level = heights.levels.index(line.level)
        for part in (ONE,) if along[-1] < LONG else SEVERAL:
            # neighbours one step apart, so that their values do not overlap
            for moved in MOVED:
                at = (part + STAGGER * (level % 2) + moved) * along[-1]
                ends = [[np.interp(at + d, along, line.places[:, i]) for i in (0, 1)] for d in (-0.01, 0.01)]
                middle = np.mean(ends, axis=0)
                if ROOM < middle.min() <= middle.max() < 1 - ROOM and is_free(taken, middle, LABEL):
                    break
            else:
                continue
            (x0, y0), (x1, y1) = of.values(np.array(ends)).tolist()
            turn = np.degrees(np.arctan2(y1 - y0, x1 - x0))
            write(
                axes,
                np.array([(x0 + x1) / 2, (y0 + y1) / 2]),
                f"{line.level:g}{suffix}",
                7.5 * scale,
                (2.6 * scale, "white"),
                color=CONTOUR,
                rotation=(turn + 90) % 180 - 90,
                rotation_mode="anchor",
                transform_rotates_text=True,
                zorder=5,
            )
            take(taken, middle, LABEL)


def _unit(unit: str) -> str:
    """A unit of a column's name as it is written."""
    return unit.replace("_s3", "/s³").replace("_s2", "/s²").replace("_s", "/s")


def _suffix(unit: str) -> str:
    """A unit behind a number."""
    return "°" if unit == "deg" else f" {_unit(unit)}" if unit else ""


def _design(axes: Axes, of: Map, scale: float, taken: np.ndarray) -> None:
    """The design, and arms from it to the boundaries that are nearest along each dimension."""
    design = of.design
    if not design.inside:
        return
    here = (design.x, design.y)
    arrow = {"arrowstyle": "-|>", "lw": 1.0 * scale, "color": MARK, "mutation_scale": 9 * scale}
    arrow |= {"shrinkA": 0, "shrinkB": 0}
    share = of.shares_of(np.array([here]))[0]
    take(taken, share, (0.03, 0.03))
    for step in design.steps:
        if step.value is None:
            continue
        place = of.axes.index(step.axis)
        end = (step.value, here[1]) if place == 0 else (here[0], step.value)
        axes.annotate("", end, here, arrowprops=arrow, zorder=6)
        far = of.shares_of(np.array([end]))[0]
        middle = 0.5 * (far + share)
        reach = np.abs(far - share) / 2
        take(taken, middle, (reach[0] + 0.012, reach[1] + 0.012))
        if abs(far[place] - share[place]) < 0.07:
            middle = far + (0.03 if step.way == "up" else -0.03) * np.eye(2)[place]
        else:
            middle = middle + 0.014 * np.eye(2)[1 - place]
        write(
            axes,
            of.values(middle[None, :])[0],
            f"{step.value - here[place]:+.4g}",
            8 * scale,
            (2.8 * scale, "white"),
            va="center" if place else "bottom",
            color=MARK,
            rotation=90 * place,
            clip_on=True,
        )
        take(taken, middle, (0.035, 0.02) if place == 0 else (0.02, 0.035))
    axes.plot(*here, "o", ms=8.5 * scale, mfc="white", mec=MARK, mew=1.8 * scale, zorder=8)
    axes.plot(*here, "o", ms=2.6 * scale, color=MARK, zorder=9)


def _frame(axes: Axes, of: Map, scale: float) -> None:
    x, y = of.axes
    axes.set_xlim(x.low, x.high)
    axes.set_ylim(y.low, y.high)
    axes.set_xlabel(x.label, fontsize=11 * scale)
    axes.set_ylabel(y.label, fontsize=11 * scale)
    axes.tick_params(direction="out", length=4 * scale, width=0.8 * scale, labelsize=9 * scale, zorder=10)
    for spine in axes.spines.values():
        spine.set_linewidth(1.0 * scale)
        spine.set_zorder(10)
    axes.grid(color="#00000018", lw=0.5 * scale, zorder=2)


def _title(figure: Figure, axes: Axes, of: Map, heights: Heights | None, scale: float) -> None:
    what = say("motion type") if heights is None else say(heights.measure.title)
    if heights is not None and heights.measure.per == "circuit":
        match heights.take:
            case "highest":
                what = say("{measure}, highest of all circuits", measure=what)
            case "lowest":
                what = say("{measure}, lowest of all circuits", measure=what)
            case number:
                what = say("{measure}, circuit {number}", measure=what, number=number)
    box = axes.get_position()
    name = short(of.linkage.heading, 60)
    words = say("{linkage}: {quantity}", linkage=name, quantity=what)
    figure.text(box.x0, box.y1 + 0.012, words, fontsize=13 * scale, va="bottom", ha="left")


def _side(figure: Figure, axes: Axes, of: Map, heights: Heights | None, scale: float) -> None:
    """The key next to the map: kinds and their shares, lines, the design and what changes it."""
    box = axes.get_position()
    left = box.x1 + 0.18 * scale / figure.get_figwidth()
    keys: list[Any] = []
    for kind, share in of.areas.items():
        style = look(of, kind, faint=heights is not None) | {"lw": 0.8 * scale}
        percent = f"{100 * share:.1f} %" if share >= 5e-4 else "< 0.1 %"
        keys.append(Patch(label=f"{of.name(kind)}  {percent}", **style))

    def line(label: str, **look: Any) -> None:
        keys.append(Line2D([], [], label=label, **look))

    if heights is not None:
        unit = f" [{_unit(heights.unit)}]" if heights.unit else ""
        line(f"{say(heights.measure.title)}{unit}", color=CONTOUR, lw=1.05 * scale)
    line(say("motion type changes"), color=LINE, lw=1.6 * scale)
    if any(of.kinds[b.left].motion_type == of.kinds[b.right].motion_type for b in of.boundaries):
        line(say("circuits join or part"), color=LINE, lw=1.0 * scale, ls=(0, (4, 2)))
    if of.design.inside:
        mark: dict[str, Any] = {"marker": "o", "ms": 8 * scale, "mfc": "white", "mew": 1.6 * scale}
        line(say("the design"), color=MARK, ls="", **mark)
    legend = figure.legend(
        handles=keys,
        loc="upper left",
        bbox_to_anchor=(left, box.y1 + 0.008),
        frameon=False,
        fontsize=9.5 * scale,
        handlelength=1.7,
        handleheight=1.25,
        labelspacing=0.55,
        borderaxespad=0.0,
    )
    figure.canvas.draw()
    below = legend.get_window_extent().transformed(figure.transFigure.inverted()).y0
    facts = "\n".join(_facts(of, heights))
    figure.text(left, below - 0.03, facts, fontsize=8.8 * scale, va="top", ha="left", linespacing=1.5)


def _facts(of: Map, heights: Heights | None) -> list[str]:
    """The design and the fixed dimensions, line by line."""
    design = of.design
    x, y = of.axes
    lines = [say("input: {joint}", joint=short(of.input, 24)), ""]
    lines += [
        say("the design") if design.inside else say("the design (outside the map)"),
        f"{x.name} = {x.text(design.x)}",
        f"{y.name} = {y.text(design.y)}",
        of.name(design.kind),
    ]
    if heights is not None:
        unit = _suffix(heights.unit)
        value = say("none") if heights.here is None else f"{heights.here:.5g}{unit}"
        lines.append(f"{say(heights.measure.title)} = {value}")
    changes = [s for s in design.steps if s.value is not None and s.kind is not None]
    if changes:
        lines += ["", say("changes at")]
        lines += [
            f"{s.axis.name} = {s.axis.text(float(s.value or 0.0))}: {of.name(s.kind or design.kind)}"
            for s in changes
        ]
    moved = {axis.dimension.place for axis in of.axes}
    others = [d for d in of.draft.dimensions if d.place not in moved and d.place[0] == "rssr"]
    if others:
        lines += ["", say("held")]
        lines += [
            say("{name} follows from the others", name=d.name)
            if d.follows
            else f"{d.name} = {d.value:g} {d.unit}"
            for d in others
        ]
    return lines
