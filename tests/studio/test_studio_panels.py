"""The panels of the studio's curves: the cursor, what stays inside the frame, empty frames, the scales."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from PIL import ImageFont

import sevenbar as sb
from sevenbar.drawing.quantities import quantities
from sevenbar.studio.state.view import views_of
from sevenbar.studio.svg.curves import panels
from sevenbar.studio.svg.picture import Panel
from sevenbar.studio.svg.scale import scale
from studio_pictures import (
    HOSTILE,
    MOTIONS,
    SVG,
    by_key,
    circles,
    motion_of,
    number,
    output_panels,
    pixels,
    subpaths,
    texts,
    ticks,
    value_at,
)

# --- the cursor


@pytest.mark.parametrize("name", ["rssr", "double-rocker", "slide in", "two turns"])
def test_the_cursors_dot_is_the_curves_vertex_at_every_row(name: str) -> None:
    motion = motion_of(name)
    for over in ("input", "time"):
        panel = output_panels(motion, over=over)[0]
        vertices = np.concatenate(subpaths(panel))
        for row in range(len(panel.values)):
            ((x, y, _),) = circles(Panel(panel.frame, panel.cursor(row), panel.x, panel.y, panel.values))
            assert np.abs(vertices - [x, y]).max(axis=1).min() < 0.101


def test_between_two_rows_the_dot_is_on_the_line_between_them() -> None:
    panel = output_panels(motion_of("rssr"))[1]
    for row in (0.25, 77.5, 359.9):
        low, share = int(row), row - int(row)
        root = ET.fromstring(panel.cursor(row))
        (dot,) = root.iter(f"{SVG}circle")
        for key, column in (("cx", panel.x), ("cy", panel.y)):
            between = column[low] + share * (column[low + 1] - column[low])
            assert float(dot.get(key, 0)) == pytest.approx(between, abs=0.051)
        (told,) = texts(panel.cursor(row))
        value = panel.values[low] + share * (panel.values[low + 1] - panel.values[low])
        assert number(told.text.split()[0]) == pytest.approx(value, abs=0.0051)
        assert told.text.endswith(" rad/s")


@pytest.mark.parametrize("row", [-5.0, math.nan, math.inf, 1e9])
def test_a_row_off_the_walk_shows_an_end_or_nothing(row: float) -> None:
    panel = output_panels(motion_of("rssr"))[0]
    end = (
        panel.cursor(0 if row < 0 else 360)
        if math.isfinite(row)
        else panel.frame.svg("", style="position:absolute;left:0;bottom:0")
    )
    assert panel.cursor(row) == end


def test_at_a_dead_centre_the_cursor_stands_and_says_that_there_is_no_rate() -> None:
    motion = motion_of("double-rocker")
    panel = output_panels(motion)[1]
    (row,) = np.flatnonzero(np.isnan(panel.values))[:1]
    root = ET.fromstring(panel.cursor(int(row)))
    assert [text.text for text in root.iter(f"{SVG}text")] == ["no value"]
    assert not list(root.iter(f"{SVG}circle"))


# --- nothing leaves the frame


@cache
def font(*, bold: bool) -> ImageFont.FreeTypeFont:
    fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    # one of the widest sans-serif fonts that browsers fall back on
    return ImageFont.truetype(fonts / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"), 110)


def assert_inside(svg: str, width: int, height: int) -> None:
    for text in texts(svg):
        wide = font(bold=text.bold).getlength(text.text) / 10
        start = text.x - {"start": 0.0, "middle": wide / 2, "end": wide}[text.anchor]
        assert start >= 0, text
        assert start + wide <= width, text
        assert 9 <= text.y <= height - 3, text


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("width", [300, 420])
def test_every_text_and_the_cursor_stay_inside_the_frame(name: str, width: int) -> None:
    motion = motion_of(name)
    for over in ("input", "time"):
        for panel in panels(
            views_of(motion), quantities(motion), len(motion.circuits) - 1, over=over, width=width
        ):
            assert_inside(panel.svg, width, 170)
            left, top, right, bottom = panel.frame.box
            for row in np.linspace(0, max(len(panel.values) - 1, 0), 25):
                cursor = panel.cursor(row)
                assert_inside(cursor, width, 170)
                for dot in ET.fromstring(cursor).iter(f"{SVG}circle"):
                    assert left <= float(dot.get("cx", 0)) <= right
                    assert top <= float(dot.get("cy", 0)) <= bottom


def test_the_words_of_a_picture_do_not_lie_on_one_another() -> None:
    for name in MOTIONS:
        motion = motion_of(name)
        for panel in panels(views_of(motion), quantities(motion), 0):
            boxes = []
            for text in texts(panel.svg):
                wide = font(bold=text.bold).getlength(text.text) / 10
                start = text.x - {"start": 0.0, "middle": wide / 2, "end": wide}[text.anchor]
                boxes.append((start, start + wide, text))
            for i, (a, b, one) in enumerate(boxes):
                for c, d, other in boxes[i + 1 :]:
                    assert abs(one.y - other.y) >= 8 or b <= c or d <= a, (name, one, other)


def test_hostile_names_are_shown_as_they_are_written() -> None:
    motion = motion_of("hostile")
    for panel in panels(views_of(motion), quantities(motion)):
        assert "<script" not in panel.html
        root = ET.fromstring(panel.html)
        assert not [e for e in root.iter() if "script" in e.tag]
    shown = panels(views_of(motion), [by_key(motion)[f"point.{HOSTILE}.speed"]], width=900)[0]
    assert f"{HOSTILE} speed [mm/s]" in [text.text for text in texts(shown.svg)]
    assert shown.svg.count("&lt;script&gt;") == 3


def test_the_cursor_lies_over_the_picture_at_any_width() -> None:
    panel = output_panels(motion_of("rssr"))[0]
    below, over = ET.fromstring(panel.html)[0], ET.fromstring(panel.cursor_html(3.5))[0]
    assert below.get("viewBox") == over.get("viewBox") == "0 0 420 170"
    assert "width:100%" in (below.get("style") or "")
    assert (below.get("style") or "-") in (over.get("style") or "")
    assert "pointer-events:none" in panel.cursor_html(3.5)


# --- motions with nothing to draw, and wrong requests


def test_a_law_beyond_the_range_leaves_an_empty_frame() -> None:
    linkage = sb.rssr(M=700, N=700, L1=500, L3=550, D=100)
    t = np.linspace(0, 1, 20)
    motion = linkage.motion(law=sb.Law.of(t, math.radians(180) + 0.1 * t, 0.1, 0.0))
    for panel in output_panels(motion):
        assert any(text.text.startswith(("no value", motion.motion_type)) for text in texts(panel.svg))


@pytest.mark.parametrize("over", ["input", "time"])
def test_a_law_is_drawn_as_it_runs(over: str) -> None:
    t = np.linspace(0, 1, 30)
    law = sb.Law.of(t, 2 + t**2, 2 * t, 2.0)
    motion = sb.load("rssr").motion(law=law)
    panel = output_panels(motion, over=over)[1]
    np.testing.assert_array_equal(panel.values, motion.circuits[0].dq[:, motion.circuits[0].output_column])
    below, beside = ticks(panel)
    vertices = np.concatenate(subpaths(panel))
    wanted = t if over == "time" else np.degrees(law.q)
    np.testing.assert_allclose(value_at(below, vertices[:, 0]), wanted, atol=0.1 * pixels(below))
    np.testing.assert_allclose(value_at(beside, vertices[:, 1]), panel.values, atol=0.1 * pixels(beside))


# --- the scales


@example(middle=1.0, span=0.001, most=4, degrees=False)
@given(
    middle=st.floats(-1e6, 1e6),
    span=st.floats(1e-3, 1e7),
    most=st.integers(3, 8),
    degrees=st.booleans(),
)
def test_ticks_are_few_inside_and_told_apart(middle: float, span: float, most: int, *, degrees: bool) -> None:
    found = scale(middle - span / 2, middle + span / 2, most, degrees=degrees)
    places = found.ticks
    assert 1 <= len(places) <= most
    room = 1e-6 * span
    assert all(found.low - room <= place <= found.high + room for place in places)
    for place in places:
        # what is written is the place itself, not one nearby
        assert number(found.word(place)) * 10.0**found.power == pytest.approx(place, abs=1e-6 * found.step)


@pytest.mark.parametrize(
    ("low", "high", "degrees", "wanted"),
    [
        (0, 360, True, [0, 90, 180, 270, 360]),
        (-20, 200, True, [0, 45, 90, 135, 180]),
        (0, 720, True, [0, 180, 360, 540, 720]),
        (0, 0.63, False, [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]),
        (-6, 9, False, [-5, -2.5, 0, 2.5, 5, 7.5]),
    ],
)
def test_ticks_stand_at_numbers_that_people_use(
    low: float, high: float, wanted: list[float], *, degrees: bool
) -> None:
    most = 7 if low == 0 else 6 if not degrees else 5
    np.testing.assert_allclose(scale(low, high, most, degrees=degrees).ticks, wanted, atol=1e-12)


def test_large_and_small_numbers_share_a_power_of_ten_with_the_unit() -> None:
    large, small = scale(-2.6e6, 7.1e6, 5), scale(0, 4.2e-5, 5)
    assert ([large.word(t) for t in large.ticks], large.unit("mm/s²")) == (
        ["−2", "0", "2", "4", "6"],
        "10⁶ mm/s²",
    )
    assert (small.word(2e-5), small.unit("rad/s")) == ("20", "10⁻⁶ rad/s")
    assert large.reading(1234567.0, "mm/s²") == "1.235·10⁶ mm/s²"
    assert scale(0, 100, 5).reading(-0.001, "deg") == "0.0°"
