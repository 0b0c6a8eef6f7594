"""The studio's pictures read as a person reads them: places by the ticks, values by the words."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import sevenbar as sb
from sevenbar.arrays import Floats
from sevenbar.drawing.quantities import Quantity, quantities
from sevenbar.studio.state.view import views_of
from sevenbar.studio.svg.curves import panels
from sevenbar.studio.svg.picture import GRID, Panel

SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = "<script>alert(1)</script> & \"W\" 'm'"


def planar(first: tuple[float, ...], second: tuple[float, ...], last: str = "rocker") -> sb.Linkage:
    joints: list[dict[str, Any]] = [
        {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1), "name": HOSTILE if last == HOSTILE else "crank"},
        {"kind": "S", "at": first},
        {"kind": "S", "at": second},
        {"kind": "R", "at": (200, 0, 0), "axis": (0, 0, 1), "name": last + " out"},
    ]
    return sb.from_axes(joints, points=[{"name": last, "link": 2, "at": first}])


MOTIONS: dict[str, Callable[[], sb.Motion]] = {
    "rssr": lambda: sb.load("rssr").motion(),
    "seven_r": lambda: sb.load("seven_r").motion(),
    "backwards": lambda: sb.load("rssr").motion(speed=-10),
    "double-rocker": lambda: sb.rssr(M=700, N=700, L1=500, L3=550, D=100).motion(),
    "rocker-crank": lambda: sb.load("rssr").motion(input="rocker"),
    "mixed": lambda: sb.load("rscr").motion(),
    "trihedral": lambda: sb.load("bricard_trihedral").motion(),
    "slide out": lambda: sb.load("rssp").motion(),
    "slide in": lambda: sb.load("rssp").motion(input="slider"),
    "two turns": lambda: sb.load("myard_5r").motion(),
    "parallelogram": lambda: planar((0, 100, 0), (200, 100, 0)).motion(),
    "hostile": lambda: planar((0, 100, 0), (220, 130, 0), HOSTILE).motion(),
}
ROCKING = ["double-rocker", "rocker-crank", "trihedral", "slide in"]


@cache
def motion_of(name: str) -> sb.Motion:
    return MOTIONS[name]()


def by_key(motion: sb.Motion) -> dict[str, Quantity]:
    return {quantity.key: quantity for quantity in quantities(motion)}


def output_panels(motion: sb.Motion, circuit: int = 0, **wanted: Any) -> tuple[Panel, ...]:
    return panels(views_of(motion), quantities(motion)[:3], circuit, **wanted)


# --- a picture read as its reader does: places are told by the ticks


class Text(NamedTuple):
    text: str
    x: float
    y: float
    anchor: str
    bold: bool


def texts(svg: str) -> list[Text]:
    return [
        Text(
            e.text or "",
            float(e.get("x", 0)),
            float(e.get("y", 0)),
            e.get("text-anchor", "start"),
            e.get("font-weight") is not None,
        )
        for e in ET.fromstring(svg).iter(f"{SVG}text")
    ]


def number(word: str) -> float:
    return float(word.replace("−", "-"))


def ticks(panel: Panel) -> tuple[dict[float, float], dict[float, float]]:
    """The places [px] of the grid's lines below and at the left, each with the number at it."""
    left, _, _, bottom = panel.frame.box
    (grid,) = (
        e.get("d", "") for e in ET.fromstring(panel.svg).findall(f"{SVG}path") if e.get("stroke") == GRID
    )
    across = [float(x) for x in re.findall(r"M([-\d.]+) \d+V", grid)]
    up = [float(y) for y in re.findall(r"M\d+ ([-\d.]+)H", grid)]
    below = [number(t.text) for t in texts(panel.svg) if t.y == bottom + 14]
    beside = [number(t.text) for t in texts(panel.svg) if t.anchor == "end" and t.x <= left - 6]
    return dict(zip(across, below, strict=True)), dict(zip(up, beside, strict=True))


def value_at(scale: dict[float, float], places: Floats) -> Floats:
    (a, va), *_, (b, vb) = scale.items()
    return va + (places - a) * (vb - va) / (b - a)


def pixels(scale: dict[float, float]) -> float:
    """How much a px is worth."""
    (a, va), *_, (b, vb) = scale.items()
    return abs((vb - va) / (b - a))


def area(panel: Panel) -> ET.Element:
    found = ET.fromstring(panel.svg).find(f"{SVG}svg")
    assert found is not None
    return found


def subpaths(panel: Panel) -> list[Floats]:
    """The vertices [px] of the chosen circuit's unbroken lines, (n, 2) each."""
    plot_area = area(panel)
    corner = np.array([float(plot_area.get("x", 0)), float(plot_area.get("y", 0))])
    chosen = plot_area.findall(f"{SVG}g")[-1]
    lines = [line for path in chosen for line in path.get("d", "").split("M")[1:]]
    return [
        np.array(line.removesuffix("h0").split(), dtype=float).reshape(-1, 2) / 10 + corner for line in lines
    ]


def circles(panel: Panel) -> list[tuple[float, float, str]]:
    return [
        (float(e.get("cx", 0)), float(e.get("cy", 0)), e.findtext(f"{SVG}title") or "")
        for e in ET.fromstring(panel.svg).iter(f"{SVG}circle")
    ]
