"""Texts of a figure that lie on another or leave the page."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

#: What a text may lie on another, or beyond the page [pixels at 100 dpi]: boxes have room round their letters.
ROOM = 1.5


SLIDER_CRANK = [
    {"name": "crank", "kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
    {"name": "crank pin", "kind": "R", "at": (40, 0, 0), "axis": (0, 0, 1)},
    {"name": "wrist pin", "kind": "R", "at": (180, 0, 0), "axis": (0, 0, 1)},
    {"name": "slider", "kind": "P", "at": (180, 0, 0), "axis": (1, 0, 0)},
]


SPHERICAL = [
    {"name": "in", "kind": "R", "at": (1, 0, 0), "axis": (1, 0, 0)},
    {"name": "a", "kind": "R", "at": (0.8, 0.6, 0), "axis": (0.8, 0.6, 0)},
    {"name": "b", "kind": "R", "at": (0, 0.6, 0.8), "axis": (0, 0.6, 0.8)},
    {"name": "out", "kind": "R", "at": (0, 0, 1), "axis": (0, 0, 1)},
]


def drawn_texts(figure: Figure, monkeypatch: pytest.MonkeyPatch) -> list[Text]:
    """The texts that are drawn, those of ticks among them."""
    found: list[Text] = []
    draw = Text.draw

    def record(self: Text, renderer: Any) -> None:
        if self.get_visible() and self.get_text().strip():
            found.append(self)
        draw(self, renderer)

    with monkeypatch.context() as patch:
        patch.setattr(Text, "draw", record)
        figure.draw_without_rendering()
    return found


def collisions(figure: Figure, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The texts that lie on another, and those that leave the page, in words."""
    texts = drawn_texts(figure, monkeypatch)
    assert texts
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts]
    wrong = []
    width, height = figure.bbox.width, figure.bbox.height
    for text, box in boxes:
        if box.x0 < -ROOM or box.y0 < -ROOM or box.x1 > width + ROOM or box.y1 > height + ROOM:
            wrong.append(f"{text!r} leaves the page: {np.round(box.extents)} of {width:g} x {height:g}")
    for (one, a), (other, b) in combinations(boxes, 2):
        across, up = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        if across > ROOM and up > ROOM:
            wrong.append(f"{one!r} lies on {other!r} by {across:.1f} x {up:.1f}")
    return wrong
