"""A curve's picture as SVG: frame, grid, words, lines, and the cursor over it; places in px, y downwards."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from html import escape
from typing import Final

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.names import short
from sevenbar.kinematics.circuits.poses import at_row
from sevenbar.studio.svg.scale import Scale

GROUND, GRID, ZERO, INK, QUIET = "#ffffff", "#e8eaed", "#b4b9c0", "#2b3038", "#6b727c"

#: Room round the plot area: left, top, right, bottom; `LABELLED` at the top where numbers stand along it.
MARGINS: Final = (46, 24, 16, 36)
LABELLED = 36

#: The size of the letters, and how wide they are at most as shares of it, by sort; bold ones are wider.
FONT, NARROW_LETTER, LETTER, CAPITAL, WIDE_LETTER, BOLD = 11, 0.42, 0.64, 0.84, 1.05, 1.1
NARROW: Final = frozenset("iljtfrI.,:;'|!()[]/ ²°·")
WIDE: Final = frozenset("mwMW@%&—…")

#: Coordinates [tenths of px] are kept within these bounds, far outside any frame.
FAR = 100_000

#: How the numbers and names of axes look.
_NUMBER: Final = f'fill="{QUIET}"'
HALO: Final = f'stroke="{GROUND}" stroke-width="3" stroke-linejoin="round" paint-order="stroke"'


@dataclass(frozen=True)
class Frame:
    """The size of a picture and, within it, the plot area, `top` below the upper edge."""

    width: int
    height: int
    top: int = MARGINS[1]

    @property
    def box(self) -> tuple[int, int, int, int]:
        """The plot area: left, top, right, bottom."""
        left, _, right, bottom = MARGINS
        return left, self.top, self.width - right, self.height - bottom

    def x(self, scale: Scale, values: Floats) -> Floats:
        """Where values stand along the axis below."""
        left, _, right, _ = self.box
        return left + (right - left) / (scale.high - scale.low) * (values - scale.low)

    def y(self, scale: Scale, values: Floats) -> Floats:
        """Where values stand along the axis at the left."""
        _, top, _, bottom = self.box
        return bottom - (bottom - top) / (scale.high - scale.low) * (values - scale.low)

    def svg(self, content: str, *, name: str = "", style: str = "") -> str:
        """The picture, as wide as the page has room; `name` is what a screen reader says of it."""
        role = f'role="img" aria-label="{escape(name)}"' if name else 'aria-hidden="true"'
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" {role} '
            f'font-family="sans-serif" font-size="{FONT}" fill="{INK}" '
            f'style="display:block;width:100%;height:auto;{style}">{content}</svg>'
        )


# after a change of the linkage most words are the same
@lru_cache(4096)
def breadth(text: str, *, bold: bool = False) -> float:
    """How wide a text is at most."""
    return (BOLD if bold else 1.0) * FONT * sum(map(_share, text))


def _share(letter: str) -> float:
    if letter in NARROW:
        return NARROW_LETTER
    if letter in WIDE or letter > "\u2e7f":
        return WIDE_LETTER
    return CAPITAL if letter.isupper() or letter == "−" else LETTER


def fitted(text: str, room: float, *, bold: bool = False) -> str:
    """The text, cut so that it is not wider than the room."""
    letters = len(text)
    while letters > 1 and breadth(short(text, letters), bold=bold) > room:
        letters -= 1
    return short(text, letters)


def words(
    frame: Frame, x: float, y: float, text: str, *, anchor: str = "start", bold: bool = False, look: str = ""
) -> str:
    """A text at a place, moved where it would leave the picture."""
    wide = breadth(text, bold=bold)
    before = {"start": 0.0, "middle": wide / 2, "end": wide}[anchor]
    x = max(min(x, frame.width - 1 - (wide - before)), before + 1)
    held = "" if anchor == "start" else f' text-anchor="{anchor}"'
    weight = ' font-weight="600"' if bold else ""
    return f'<text x="{x:.1f}" y="{y:.1f}"{held}{weight} {look}>{escape(text)}</text>'


def labelled(name: str, unit: str, room: float, *, bold: bool = False) -> str:
    """A name, cut where it has no room, with its unit in brackets."""
    unit = f" [{unit}]"
    return fitted(name, room - breadth(unit, bold=bold), bold=bold) + unit


def grid(frame: Frame, below: Scale, beside: Scale, name: str, unit: str) -> str:
    """Thin lines at the ticks of both axes, their numbers, and the name of the axis below."""
    left, _, right, _ = frame.box
    up = frame.y(beside, np.array(beside.ticks)).tolist()
    across, numbers = _axis_below(frame, below, name, unit)
    lines = "".join(f"M{left} {y:.2f}H{right}" for y in up)
    parts = [f'<path d="{across}{lines}" stroke="{GRID}"/>']
    if beside.low < 0 < beside.high:
        zero = float(frame.y(beside, np.zeros(1))[0])
        parts.append(f'<path d="M{left} {zero:.1f}H{right}" stroke="{ZERO}"/>')
    parts.append(numbers)
    for y, value in zip(up, beside.ticks, strict=True):
        parts.append(words(frame, left - 6, y + 4, beside.word(value), anchor="end", look=_NUMBER))
    return "".join(parts)


# all curves share it, and a change seldom gives another
@lru_cache(16)
def _axis_below(frame: Frame, below: Scale, name: str, unit: str) -> tuple[str, str]:
    """The `d` of the lines at the ticks of the axis below; its numbers and its name."""
    left, top, right, bottom = frame.box
    across = frame.x(below, np.array(below.ticks)).tolist()
    parts = [
        words(frame, x, bottom + 14, below.word(value), anchor="middle", look=_NUMBER)
        for x, value in zip(across, below.ticks, strict=True)
    ]
    label = labelled(name, below.unit(unit), frame.width - 4)
    parts.append(words(frame, (left + right) / 2, bottom + 29, label, anchor="middle", look=_NUMBER))
    return "".join(f"M{x:.2f} {top}V{bottom}" for x in across), "".join(parts)


@lru_cache(64)
def head(frame: Frame, name: str, unit: str, keys: tuple[tuple[str, str], ...], colour: str) -> str:
    """The name of what is drawn, and keys (word, dashes of its line) at the right, above the plot area."""
    parts: list[str] = []
    end = frame.box[2] + 4.0
    for word, dashes in reversed(keys):
        end -= breadth(word)
        parts.append(words(frame, end, 15, word, look=f'fill="{QUIET}"'))
        if dashes:
            look = f'stroke="{colour}" stroke-width="2" stroke-dasharray="{dashes}"'
            parts.append(f'<path d="M{end - 22:.1f} 11H{end - 4:.1f}" {look}/>')
            end -= 22
        end -= 8
    label = labelled(name, unit, end - 6, bold=True)
    return words(frame, 6, 15, label, bold=True) + "".join(parts)


def stroke(x: Floats, y: Floats) -> str:
    """The `d` of a line [tenths of px], (n,), broken where a place is NaN."""
    known = np.isfinite(x) & np.isfinite(y)
    places = np.stack([x, y], axis=1)
    if known.all():
        return _joined(places)
    edges = np.flatnonzero(np.diff(known, prepend=False, append=False))
    return "".join(_joined(places[a:b]) for a, b in edges.reshape(-1, 2).tolist())


def _joined(places: Floats) -> str:
    numbers = np.rint(np.clip(10.0 * places, -FAR, FAR)).astype(np.int64).ravel().tolist()
    # a place alone is drawn as a dot
    return "M" + " ".join(map(str, numbers)) + ("h0" if len(numbers) == 2 else "")


@dataclass(frozen=True, eq=False)
class Panel:
    """One quantity drawn for one circuit, the others faint behind it: `svg`, and the cursor over it.

    `x`, `y` [px] and `values` are those of the circuit's walk, row by row, (n,); none without a curve.
    """

    frame: Frame
    svg: str
    x: Floats
    y: Floats
    values: Floats
    scale: Scale | None = None
    unit: str = ""
    colour: str = INK

    def cursor(self, row: float) -> str:
        """The cursor at a row of the walk, which may lie between two, as SVG: line, dot, value."""
        return self.frame.svg("".join(self._cursor(row)), style="position:absolute;left:0;bottom:0")

    @property
    def html(self) -> str:
        """The HTML of the picture, as wide as the page has room."""
        return f"<div>{self.svg}</div>"

    def cursor_html(self, row: float) -> str:
        """The HTML of the cursor; put right below the picture's it lies over it, at any width."""
        return f'<div style="position:relative;height:0;pointer-events:none">{self.cursor(row)}</div>'

    def _cursor(self, row: float) -> list[str]:
        if self.scale is None or not math.isfinite(row):
            return []
        row = min(max(row, 0.0), len(self.x) - 1.0)
        x, y, value = (float(at_row(column, row)) for column in (self.x, self.y, self.values))
        left, top, right, bottom = self.frame.box
        if not left - 0.01 <= x <= right + 0.01:
            return []
        parts = [f'<path d="M{x:.1f} {top}V{bottom}" stroke="{INK}"/>']
        label, inside = "no value", float(top)
        if math.isfinite(y):
            label, inside = self.scale.reading(value, self.unit), min(max(y, top), bottom)
            # a hollow dot at the edge stands for a value beyond it
            fill, ring = (self.colour, GROUND) if inside == y else (GROUND, self.colour)
            look = f'r="4.5" fill="{fill}" stroke="{ring}" stroke-width="1.5"'
            parts.append(f'<circle cx="{x:.1f}" cy="{inside:.1f}" {look}/>')
        aside, anchor = (x + 8, "start") if x + 8 + breadth(label, bold=True) <= right else (x - 8, "end")
        line = inside - 7 if inside - 7 - FONT > top else min(inside + 7 + FONT, bottom - 3)
        return [*parts, words(self.frame, aside, line, label, anchor=anchor, bold=True, look=HALO)]
