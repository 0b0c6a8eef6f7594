"""The tour of docs/studio.md, walked through: what it says comes on the page. Its pictures come from here, by way of build/screenshots."""

import re

import pytest

import sevenbar as sb
from browser import keep
from controls import choose, click_button, download, open_tab, type_into
from desk import SHOWN, TAKEN, Desk
from places import DOCS

TOUR = " ".join((DOCS / "studio.md").read_text(encoding="utf-8").split())


@pytest.fixture
def desk(studio, pages):
    one = studio("rssr")
    return Desk("rssr", pages(one.url, smooth=True), one)


def told(name, value):
    """A value that the page shows, once it is sure that the tour tells of it too."""
    assert value in TOUR, f"{name} = {value} is not in docs/studio.md"
    return value


def test_the_tour_of_the_manual_is_true(desk, tmp_path):
    page = desk.page
    # look
    desk.until(lambda: desk.verdict().get("swing of rocker"), told("swing", "75.146°"))
    assert desk.verdict()["transmission angle min"] == f"{told('transmission', '16.999°')} @ 180.000°"
    assert desk.verdict()["transmission angle max"].startswith(told("transmission", "45.942°"))
    # try something wrong
    desk.type("L1 [mm]", told("L1", "285"))
    desk.until(lambda: desk.verdict().get("motion type"), told("type", "double-rocker"))
    assert desk.verdict()["input limits"].split() == [told("limit", "161.161°"), told("limit", "198.839°")]
    page.wait_for_timeout(TAKEN)
    click_button(page, "Play")
    inputs = []
    for _ in range(40):
        page.wait_for_timeout(150)
        inputs.append(desk.reading()[0])
        if len(inputs) > 15 and {x < 161.5 or x > 198.5 for x in inputs} == {True}:
            break
    click_button(page, "Pause")
    # the crank never stands where the loop does not close
    assert all(x <= 161.162 or x >= 198.838 for x in inputs), inputs
    desk.type("go to input", "150")
    page.mouse.move(700, 820)
    page.wait_for_timeout(SHOWN)
    keep(page, "tour_limits")
    click_button(page, "undo")
    desk.until(lambda: desk.verdict().get("motion type"), "crank-rocker")
    # try the other way
    desk.type("M [mm]", told("M", "560"))
    desk.until(lambda: desk.verdict().get("swing of rocker"), told("swing", "60.292°"))
    assert desk.verdict()["transmission angle min"].startswith(told("transmission", "30.642°"))
    desk.type("go to input", "180")
    page.mouse.move(220, 800)
    page.mouse.wheel(0, 900)
    page.wait_for_timeout(SHOWN)
    keep(page, "tour_answer")
    # is there room
    open_tab(page, "Points")
    choose(page, "link", "2")
    type_into(page, "at x, y, z [mm]", told("at", "500, 40, 0"))
    click_button(page, "Add point")
    desk.says(re.compile("P on link 2: fastest"))
    open_tab(page, "Show")
    choose(page, "ghosts", told("ghosts", "positions along the motion"))
    choose(page, "ghosts", told("ghosts", "all modes at this input"))
    assert len(sb.rssr(M=560, N=700, L1=250, L3=550, D=0).motion().circuits) == 2
    # take it home
    open_tab(page, "Files")
    saved = download(page, "Download as TOML", tmp_path)
    assert "M = 560\n" in saved.read_text()
    assert saved.read_text().startswith("# The example of Sun and Zhou")
    choose(page, "export", "page that plays (HTML)")
    assert b"60.292" in download(page, "Export", tmp_path).read_bytes()


def test_the_picture_of_the_readme(studio, pages):
    one = studio("seven_r")
    desk = Desk("seven_r", pages(one.url, smooth=True), one)
    page = desk.page
    desk.type("go to input", "60")
    open_tab(page, "Show")
    choose(page, "ghosts", "all modes at this input")
    open_tab(page, "Shape")
    page.mouse.move(725, 430)
    for _ in range(4):
        page.mouse.wheel(0, -120)
        page.wait_for_timeout(300)
    page.wait_for_timeout(3000)
    assert desk.reading()[3] == 8
    keep(page, "readme")
