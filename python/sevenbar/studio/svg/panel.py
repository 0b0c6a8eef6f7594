"""A panel of the studio: the picture of a curve as HTML, and the cursor that is laid over it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.poses import at_row
from sevenbar.studio.svg.picture import FONT, GROUND, HALO, INK, Frame, breadth, words
from sevenbar.studio.svg.scale import Scale


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
