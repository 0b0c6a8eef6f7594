"""The studio as it opens: all of the linkage beside the panels, at three sizes; and a joint pulled by the mouse."""

import time

import numpy as np
import pytest

import browser
from browser import PATIENCE, Pages, canvas_colours, extent, keep, settled, tinted
from controls import button, click_button, folder, open_folder, open_tab, shown, toggle
from desk import Desk
from sevenbar.drawing.scene import COUPLER, INPUT, OUTPUT
from sevenbar.studio.state.sketch import beginning, drawn, kinds_of

SIZES = [(1100, 700), (1500, 900), (1920, 1080)]
#: A picture is at rest only after the page has found its shape [ms].
PUT_TOGETHER = 2500
#: What the camera may take on a machine with other work [s].
CAMERA = 60


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "slider.toml"
    path.write_text(drawn("Slider-crank", "mm", beginning(kinds_of("RRRP"))))
    return path


@pytest.fixture
def opened(chromium, studio, file, monkeypatch):
    """A studio's page in a window of a size."""
    made = []

    def open_page(width, height):
        monkeypatch.setattr(browser, "SIZE", {"width": width, "height": height})
        one = studio(str(file))
        pages = Pages(chromium)
        made.append(pages)
        page = pages(one.url)
        page.wait_for_timeout(PUT_TOGETHER)
        # on a machine with other work it takes longer until the panels lie to its left and right and something is on it
        end, canvas = time.monotonic() + PATIENCE, page.locator("canvas[data-engine]")
        while canvas.bounding_box()["width"] > width - 1 or tinted(settled(page), OUTPUT) < 60:
            assert time.monotonic() < end, "it is not put together"
        # the camera moves back only once the studio knows the canvas's size
        end = time.monotonic() + CAMERA
        while any(at_edges(settled(page))) and time.monotonic() < end:
            pass
        return page

    yield open_page
    for pages in made:
        pages.close()
        assert not pages.wrong


def at_edges(image):
    """Pixels of the input's, the output's and the coupler's colours at the edges of a picture."""
    edges = [image[:6], image[-6:], image[:, :6], image[:, -6:]]
    edges = np.concatenate([edge.reshape(-1, 3) for edge in edges])[None]
    return [tinted(edges, colour) for colour in (INPUT, OUTPUT, COUPLER)]


def picture(page):
    """The 3D canvas on the page, and where it is."""
    return settled(page), page.locator("canvas[data-engine]").bounding_box()


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_the_linkage_is_seen_whole_between_the_panels(opened, width, height):
    page = opened(width, height)
    image, box = picture(page)
    keep(page, f"opened_{width}")
    panels = [group.bounding_box() for group in page.locator("[data-dock-group]").all()]
    assert len(panels) >= 2
    for panel in panels:
        assert panel["x"] + panel["width"] <= box["x"] + 1 or panel["x"] >= box["x"] + box["width"] - 1
    assert box["width"] >= 0.4 * width, "the linkage has the most room"
    for colour in (INPUT, OUTPUT, COUPLER):
        assert tinted(image, colour) > 60, colour
    assert at_edges(image) == [0, 0, 0]
    # as large as it is when a person asks for it
    open_tab(page, "Show")
    click_button(page, "Look at it all")
    page.wait_for_timeout(PUT_TOGETHER)
    again = settled(page)
    # the browser draws fewer pixels where it is slow, and so other pixels at the edges of a link
    assert again.shape[0] / again.shape[1] == pytest.approx(image.shape[0] / image.shape[1], rel=0.01)
    for colour in (INPUT, OUTPUT, COUPLER):
        np.testing.assert_allclose(extent(again, colour), extent(image, colour), atol=0.02)


def test_a_camera_that_a_person_has_turned_stays(opened):
    page = opened(1500, 900)
    before, box = picture(page)
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] + 120, middle[1] + 40, steps=6)
    page.mouse.up()
    page.wait_for_timeout(1500)
    turned = settled(page)
    assert (turned != before).any(axis=2).sum() > 1000
    page.wait_for_timeout(6000)
    later = settled(page)
    # the questions after the picture's shape change nothing that is seen
    assert (np.abs(later.astype(int) - turned).max(axis=2) > 40).sum() < 50


def test_nothing_hides_play_while_the_steps_are_pointed_at(opened):
    page = opened(1100, 700)
    step = button(page, "+1").bounding_box()
    page.mouse.move(step["x"] + 4, step["y"] + 4)
    page.wait_for_timeout(800)
    play = button(page, "Play").bounding_box()
    there = "([x, y]) => document.elementsFromPoint(x, y)[0].closest('button')?.textContent"
    middle = [play["x"] + play["width"] / 2, play["y"] + play["height"] / 2]
    assert page.evaluate(there, middle).strip() == "Play"
    assert page.locator("[role=tooltip]").filter(visible=True).count() == 0


def test_a_joint_is_pulled_by_the_mouse_and_taken_back_by_one_undo(opened, file):
    page = opened(1500, 900)
    desk = Desk.__new__(Desk)
    desk.page = page
    before, box = picture(page)
    assert toggle(page, "drag points")
    page.get_by_text("what lies in one place moves together").wait_for()
    page.wait_for_timeout(1000)
    with_arrows = settled(page)
    keep(page, "drag_points")
    # the red arrow that reaches farthest to the right is that of the piston pin and its slider
    red = (with_arrows[..., 0] > 200) & (with_arrows[..., 1] < 100) & (with_arrows[..., 2] < 140)
    red &= (with_arrows != before).any(axis=2)
    ys, xs = np.nonzero(red)
    assert len(xs) > 30
    tip = np.argmax(xs)
    x, y = box["x"] + float(xs[tip]) - 5, box["y"] + float(ys[tip]) - 1
    page.mouse.move(x, y)
    page.wait_for_timeout(200)
    page.mouse.down()
    page.mouse.move(x + 60, y + 18, steps=12)
    page.mouse.up()
    page.wait_for_timeout(1500)

    def place(joint):
        label = f"{joint} ({'P' if joint == 'slider' else 'R'})"
        open_folder(page, label)
        page.wait_for_timeout(400)
        return float(shown(folder(page, label), "x [mm]"))

    keep(page, "drag_pulled")
    moved = place("piston_pin")
    assert moved > 135
    assert place("slider") == moved
    assert moved == round(moved, 1)
    click_button(page, "undo")
    desk.until(lambda: place("piston_pin"), 130.0)
    assert place("slider") == 130.0
    assert file.read_text().count("130") == 2, "nothing is written that was not saved"
    assert canvas_colours(page).shape == before.shape
