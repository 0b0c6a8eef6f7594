"""The hands that the studio's tests lend to a browser, tried on controls whose values are known from the server."""

import re
import sys
import time

import numpy as np
import pytest
import viser
from playwright.sync_api import expect

from browser import PATIENCE, Pages, canvas_colours, chromium, differs, drawn, settled, tinted
from controls import (
    choose,
    click_button,
    download,
    drag,
    folder,
    head,
    open_folder,
    open_tab,
    options,
    panel,
    rest,
    shown,
    slider,
    toggle,
    type_into,
    upload,
)
from served import Served


class Desk:
    """A viser server with each kind of control, made for every client, and what it received last from each."""

    def __init__(self):
        self.server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        self.url = f"http://127.0.0.1:{self.server.get_port()}"
        self.received = {}
        self.ball = None
        self.server.on_client_connect(self._furnish)

    def _note(self, key, handle):
        handle.on_update(lambda event: self.received.update({key: event.target.value}))

    def _press(self, key, handle):
        handle.on_click(lambda event: self.received.update({key: event.target.value}))

    def _furnish(self, client):
        gui = client.gui
        self.ball = client.scene.add_icosphere("/ball", radius=0.5, color=(255, 0, 0))
        side = gui.add_panel()
        for name in ("Front", "Behind"):
            with side.add_tab(name):
                self._note(name, gui.add_text("Same", ""))
        side.dock_left()
        gui.main_panel.dock_right()
        tabs = gui.add_tab_group()
        with tabs.add_tab("Plain"):
            self._note("number", gui.add_number("A number", 1.0, step=0.001))
            self._note("slider", gui.add_slider("A slider", 0.0, 100.0, 0.5, 50.0))
            self._note("text", gui.add_text("A text", "before"))
            self._note("choice", gui.add_dropdown("A choice", ("one", "one and more", "two")))
            self._note("box", gui.add_checkbox("A box", initial_value=False))
            self._note("vector", gui.add_vector3("A vector", (0.0, 0.0, 0.0), step=0.01))
            self._press("button", gui.add_button("A button"))
            self._press("group", gui.add_button_group("A group", ("back", "forth")))
        with tabs.add_tab("Nested"):
            for name in ("First", "Second"):
                with gui.add_folder(name, expand_by_default=name == "First"):
                    self._note(name, gui.add_text("Twice", ""))
            form = gui.add_form("A form")
            with form:
                inner = gui.add_text("Entered", "")
            form.on_submit(lambda _: self.received.update(form=inner.value))
            given = gui.add_upload_button("Give")
            given.on_upload(lambda _: self.received.update(given=(given.value.name, given.value.content)))
            gui.add_button("Take").on_click(
                lambda event: event.client.send_file_download("known.txt", b"known", save_immediately=True)
            )

    def gets(self, key, value):
        """Whether the server has received a value, or does if it is given time."""
        end = time.monotonic() + PATIENCE
        while self.received.get(key) != value and time.monotonic() < end:
            time.sleep(0.02)
        return self.received.get(key) == value


@pytest.fixture(scope="module")
def desk():
    made = Desk()
    yield made
    made.server.stop()


@pytest.fixture(scope="module")
def opened(chromium):
    made = Pages(chromium)
    yield made
    made.close()
    assert not made.wrong


@pytest.fixture(scope="module")
def page(desk, opened):
    return opened(desk.url, tolerated=("known trouble",))


def test_what_a_hand_does_to_a_control_is_what_the_server_receives(desk, page):
    open_tab(page, "Plain")
    type_into(page, "A number", "1.25")
    assert desk.gets("number", 1.25)
    type_into(page, "A slider", "7")
    assert desk.gets("slider", 7.0)
    type_into(page, "A text", "now")
    assert desk.gets("text", "now")
    type_into(page, "A text", "")
    assert desk.gets("text", "")
    type_into(page, "A vector", "2.5", part=1)
    assert desk.gets("vector", (0.0, 2.5, 0.0))
    assert options(page, "A choice") == ["one", "one and more", "two"]
    choose(page, "A choice", "two")
    assert desk.gets("choice", "two")
    assert shown(page, "A choice") == "two"
    assert toggle(page, "A box")
    assert desk.gets("box", True)
    click_button(page, "A button")
    click_button(page, "forth")
    assert desk.gets("group", "forth")
    assert "button" in desk.received


def test_a_slider_pulled_to_a_part_of_its_way_stands_there(desk, page):
    open_tab(page, "Plain")
    drag(page, "A slider", 0.9, 0.25)
    # a page that lags shows it some time after the hand has let go
    expect(slider(page, "A slider")).to_have_attribute(
        "aria-valuenow", re.compile("^2[3-6]"), timeout=PATIENCE * 1e3
    )
    assert float(slider(page, "A slider").get_attribute("aria-valuenow")) == pytest.approx(25, abs=1.5)
    assert desk.gets("slider", float(shown(page, "A slider")))


def test_a_label_that_stands_twice_is_found_in_its_folder_and_in_its_panel(desk, page):
    open_tab(page, "Nested")
    open_folder(page, "Second")
    for name in ("First", "Second"):
        type_into(folder(page, name), "Twice", name[0])
    for name in ("Front", "Behind"):
        open_tab(page, name)
        type_into(panel(page, name), "Same", name[0])
    for name in ("First", "Second", "Front", "Behind"):
        assert desk.gets(name, name[0])


def comes_to_read(page, form, line):
    """Whether a form's head reads so, or does if the page, which may lag, is given time."""
    end = time.monotonic() + PATIENCE
    while head(page, form).inner_text().strip() != line and time.monotonic() < end:
        rest(page)
    return head(page, form).inner_text().strip() == line


def test_enter_commits_a_form_and_leaving_it_does_not(desk, page):
    open_tab(page, "Nested")
    type_into(page, "Entered", "35", end="")
    assert comes_to_read(page, "A form", "A form*")
    type_into(page, "Entered", "35", end="Enter")
    assert desk.gets("form", "35")
    # the page takes the star away when the server's word on the form arrives, be it typed into again or not
    assert comes_to_read(page, "A form", "A form")
    type_into(page, "Entered", "9")
    assert comes_to_read(page, "A form", "A form*")
    assert desk.received["form"] == "35"


def test_files_are_given_and_taken_byte_for_byte(desk, page, tmp_path):
    open_tab(page, "Nested")
    path = tmp_path / "given.bin"
    path.write_bytes(bytes(range(256)))
    upload(page, "Give", path)
    assert desk.gets("given", ("given.bin", bytes(range(256))))
    taken = download(page, "Take", tmp_path)
    assert (taken.name, taken.read_bytes()) == ("known.txt", b"known")


def test_the_canvas_shows_what_the_scene_holds(desk, page):
    with_ball = settled(page)
    desk.ball.visible = False
    without = settled(page)
    # a disc: as wide as high, and its share of the square around it is a quarter of pi
    rows, columns = np.nonzero(np.abs(with_ball.astype(int) - without).max(axis=2) > 8)
    height, width = np.ptp(rows) + 1, np.ptp(columns) + 1
    assert height == pytest.approx(width, abs=3)
    assert differs(with_ball, without) == pytest.approx(np.pi / 4 * height * width, rel=0.03)
    assert drawn(without, "white", 4) > drawn(with_ball, "white", 4) > 0.5 * without[..., 0].size
    # the arrows of the axes in the corner are red, too
    red = tinted(with_ball, "red") - tinted(without, "red")
    assert red == pytest.approx(differs(with_ball, without), rel=0.05)
    assert tinted(with_ball, "cyan") == 0
    assert differs(without, canvas_colours(page)) == 0


def test_what_goes_wrong_on_a_page_is_seen(opened, page):
    page.evaluate("console.error('known trouble')")
    page.evaluate("console.error('said')")
    page.evaluate("void setTimeout(() => { throw new Error('thrown') })")
    page.evaluate("void fetch('http://127.0.0.1:9/').catch(() => {})")
    end = time.monotonic() + PATIENCE
    while len(opened.wrong) < 4 and time.monotonic() < end:
        page.wait_for_timeout(100)
    wrong = opened.wrong.copy()
    opened.wrong.clear()
    # what the browser itself says of the address that does not answer comes last
    assert set(wrong[:3]) == {"console: said", "raised: thrown", "asked elsewhere: http://127.0.0.1:9/"}


def test_without_chromium_a_test_fails_with_the_command_that_installs_it(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(pytest.fail.Exception, match="apt-get install chromium"):
        chromium()


SERVES = "import time; print('http://127.0.0.1:9', flush=True); time.sleep({seconds})"


def test_a_program_that_ends_by_itself_or_with_a_traceback_does_not_pass(tmp_path):
    short = Served([sys.executable, "-c", SERVES.format(seconds=0)], tmp_path / "short")
    short.process.wait(PATIENCE)
    with pytest.raises(AssertionError, match="ended by itself"):
        short.stop()
    # Ctrl+C in a sleep is a KeyboardInterrupt that nobody takes
    long = Served([sys.executable, "-c", SERVES.format(seconds=PATIENCE)], tmp_path / "long")
    assert long.runs
    assert long.memory() > 1
    with pytest.raises(AssertionError, match="Traceback"):
        long.stop()
