"""Letters of figures keep apart: no text lies on another or leaves the page, for every linkage and every kind of figure."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

import sevenbar as sb
from gallery_sample import SAMPLE
from lettered import ROOM, SLIDER_CRANK, SPHERICAL, collisions
from sevenbar.description.gallery import loops
from sevenbar.drawing import animate as animation
from sevenbar.drawing import plot
from sevenbar.drawing.figure import new_figure

DRAWN: dict[str, Callable[[], sb.Linkage]] = {
    "slider-crank": lambda: sb.from_axes(SLIDER_CRANK, name="Slider-crank"),
    "planar, long numbers": lambda: sb.four_bar(1000, 2000, 1600, 1800),
    "planar, small numbers": lambda: sb.four_bar(0.001, 0.002, 0.0016, 0.0018, length_unit="m"),
    "spherical, point far off": lambda: sb.from_axes(
        SPHERICAL, points=[{"name": "P", "link": 2, "at": (60, 40, 30)}]
    ),
}


def linkage_of(name: str) -> sb.Linkage:
    return DRAWN[name]() if name in DRAWN else sb.load(name)


def middle_modes(motion: sb.Motion) -> Any:
    ends = motion.circuits[0].pass_range(0) or (0.3, 0.3)
    return motion.linkage.assembly_modes(sum(ends) / 2)


#: Every kind of figure of a motion.
KINDS: dict[str, Callable[[sb.Motion], Figure]] = {
    "configuration": lambda m: plot.configuration(m),
    "configuration, paper": lambda m: plot.configuration(m, style="paper"),
    "curves": lambda m: plot.curves(m),
    "curves, paper": lambda m: plot.curves(m, style="paper"),
    "joints": lambda m: plot.joints(m),
    "modes": lambda m: plot.modes_overview(m.linkage, middle_modes(m)),
    "point": lambda m: plot.point_path(m, (1, (10.0, 20.0, 30.0))),
    "axodes": lambda m: plot.axodes(m),
}


@pytest.fixture(scope="module")
def motions() -> dict[str, sb.Motion]:
    return {}


#: Kinds that have other texts for each linkage; in the others it is the number of panels and the lengths of names
#: that differ, which the sample of the gallery has.
OWN = ("configuration", "curves", "modes")


def cases() -> list[Any]:
    """Every linkage with every kind of figure; what the sample of the gallery represents is a proof."""
    return [
        pytest.param(name, kind, marks=() if name in (*SAMPLE, *DRAWN) or kind in OWN else pytest.mark.proof)
        for name in (*loops(), *DRAWN)
        for kind in KINDS
    ]


@pytest.mark.usefixtures("fonts_of_matplotlib")
@pytest.mark.parametrize(("name", "kind"), cases())
def test_no_text_of_a_figure_lies_on_another_or_leaves_the_page(
    motions: dict[str, sb.Motion], name: str, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = motions.setdefault(name, linkage_of(name).motion(samples=48))
    assert collisions(KINDS[kind](motion), monkeypatch) == []


def test_texts_that_collide_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    figure = new_figure(6.0, 4.0)
    figure.text(0.5, 0.5, "one")
    figure.text(0.51, 0.5, "another")
    figure.text(0.99, 0.2, "beyond")
    found = collisions(figure, monkeypatch)
    assert [line.split()[0] for line in found] == ["'beyond'", "'one'"]


@pytest.mark.parametrize("name", ["planar_4r", "seven_r"])
def test_names_in_a_film_stay_near_their_joints_and_on_the_page(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    motion = linkage_of(name).motion(samples=48)
    seen: list[list[tuple[str, Any]]] = []
    draw = Text.draw

    def record(self: Text, renderer: Any) -> None:
        if hasattr(self, "xyann") and self.get_text() in labels:
            seen[-1].append((self.get_text(), self.get_window_extent(renderer)))
        draw(self, renderer)

    frame = animation.skeleton(motion, motion.circuits[0])
    labels = {name for name in frame.names if name}
    # every joint has its name, the inner ones, too
    assert len(labels) == len(motion.linkage.joints) + len(motion.linkage.added_points)
    seen.append([])
    with monkeypatch.context() as patch:
        patch.setattr(Text, "draw", record)
        animation.animate(motion, tmp_path / "a.gif", frames=6, progress=lambda *_: seen.append([]))
    for picture in seen[:-1]:
        for text, box in picture:
            assert box.x0 > -ROOM, text
            assert box.y0 > -ROOM, text
            assert math.isfinite(box.width), text
