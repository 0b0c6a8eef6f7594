"""The studio in a real browser, each part of it clicked through on the RSSR and on the 7R."""

import csv
import json
import re
import signal
import zipfile

import numpy as np
import pytest

import sevenbar as sb
from browser import Pages, changed, differs, keep, person, settled, tinted
from controls import (
    box,
    choose,
    click_button,
    download,
    open_folder,
    open_tab,
    options,
    rest,
    row,
    shown,
    toggle,
    type_into,
    upload,
)
from desk import Desk
from served import Studio
from sevenbar.drawing.style import COUPLER, INPUT, OUTPUT


@pytest.fixture(autouse=True)
def _fresh_after_a_failure(request):
    """One failure is not the next one's cause: the page is loaded anew."""
    failed = request.session.testsfailed
    yield
    if request.session.testsfailed > failed and "desk" in request.fixturenames:
        request.getfixturevalue("desk").page.reload()


#: For what the linkage makes no difference to: the other one goes with the proofs.
once = pytest.mark.parametrize(
    "desk", ["rssr", pytest.param("seven_r", marks=pytest.mark.proof)], indirect=True
)


@pytest.fixture(scope="module", params=["rssr", "seven_r"])
def desk(request, chromium, tmp_path_factory):
    studio = Studio(request.param, folder=tmp_path_factory.mktemp("studio"))
    pages = Pages(chromium)
    page = pages(studio.url)
    yield Desk(request.param, page, studio)
    pages.close()
    studio.stop()
    assert not pages.wrong
    assert list(studio.here.iterdir()) == [], "the studio wrote a file that nobody named"


def test_the_page_shows_the_linkage_and_its_verdict_in_the_words_of_the_report(desk):
    desk.says(desk.linkage.name)
    picture = settled(desk.page)
    for colour in (INPUT, OUTPUT, COUPLER):
        assert tinted(picture, colour) > 300, colour
    facts = desk.verdict()
    assert facts["motion type"] == desk.motion.motion_type
    assert facts["circuits"].startswith(str(len(desk.motion.circuits)))
    assert "all modes" in facts["completeness"]
    assert "mm" in facts["closure error"]
    if desk.name == "rssr":
        assert facts["time ratio"] == f"{desk.motion.circuits[0].time_ratio:.6g}"
        assert "swing of rocker" in facts
        assert "transmission angle min" in facts
    desk.keep("first_sight")


@once
def test_the_motion_is_played_paused_stepped_and_scrubbed(desk):
    page = desk.page
    desk.type("go to input", "60")
    desk.near(0, 60)
    desk.near(1, np.degrees(desk.motion.circuits[0].output[60]), 2e-3)
    before = settled(page)
    click_button(page, "+10")
    desk.near(0, 70)
    changed(page, before, 500)
    click_button(page, "-1")
    desk.near(0, 69)
    choose(page, "speed", "1/4 x")
    click_button(page, "Play")
    desk.wait(1000)
    # a busy machine shows nothing new for a while
    for _ in range(20):
        first = desk.reading()[0]
        desk.wait(1500)
        gone = (desk.reading()[0] - first) % 360
        if gone > 10:
            break
    click_button(page, "Pause")
    # a quarter of the usual speed: a turn in 24 s
    assert 10 < gone < 90
    # and what was on its way comes after Pause
    for _ in range(20):
        before = desk.reading()
        desk.wait(1000)
        if desk.reading() == before:
            break
    else:
        pytest.fail("a motion that is paused goes on")
    track = row(page, "input [deg]").locator(".mantine-Slider-track").bounding_box()
    page.mouse.click(track["x"] + 0.75 * track["width"], track["y"] + track["height"] / 2)
    desk.near(0, 270, 4)
    desk.type("go to input", "nonsense")
    desk.says("'nonsense' is no value of")
    desk.type("go to input", "0")


def test_circuits_and_modes_are_chosen_and_shown_as_ghosts(desk):
    page, count = desk.page, len(desk.motion.circuits)
    assert len(options(page, "circuit")) == count
    last = desk.motion.circuits[-1]
    choose(page, "circuit", f"{last.index}: {last.motion_type}")
    column = desk.motion.circuits[0].output_column
    desk.near(1, np.degrees(last.output[0]), 2e-3)
    value, _, first, modes = desk.reading()
    own = desk.linkage.assembly_modes(np.radians(value))
    assert modes == len(own)
    seen = []
    for step in range(modes):
        click_button(page, "Next mode at this input")
        desk.until(lambda: desk.reading()[2], (first + step) % modes + 1)
        seen.append(desk.reading()[1])
    # each is shown once: the outputs are those of all modes, which some may share
    wanted = sorted(np.round(np.degrees(own.q[:, column]) % 360, 1) % 360)
    assert sorted(np.round(np.array(seen) % 360, 1) % 360) == pytest.approx(wanted, abs=0.11)
    open_tab(page, "Show")
    before = settled(page)
    choose(page, "ghosts", "all modes at this input")
    changed(page, before, 500)
    desk.keep("modes")
    choose(page, "ghosts", "positions along the motion")
    changed(page, before, 1500)
    desk.keep("positions")
    choose(page, "ghosts", "none")
    choose(page, "circuit", f"0: {desk.motion.circuits[0].motion_type}")
    desk.wait()


@once
def test_axes_paths_and_names_are_switched_on_and_off(desk):
    page = desk.page
    open_tab(page, "Show")
    full = settled(page)
    for what in ("joint axes", "paths", "names"):
        toggle(page, what)
        changed(page, full, 60)
        if what == "names":
            desk.keep("names")
        toggle(page, what)
        desk.wait()
    click_button(page, "Look at it all")
    desk.wait()


@once
def test_a_dimension_is_dragged_and_typed_and_all_follows(desk):
    page = desk.page
    open_tab(page, "Shape")
    label = "L1 [mm]" if desk.name == "rssr" else "length [mm]"
    first = "250" if desk.name == "rssr" else "45"
    assert shown(page, label) == first
    curve, picture = desk.pictures().first.inner_html(), settled(page)
    thumb = row(page, label).locator("xpath=following::*[@role='slider']").first
    thumb.scroll_into_view_if_needed()
    track = row(page, label).locator("xpath=following::*[contains(@class,'mantine-Slider-track')]").first
    thumb, track = thumb.bounding_box(), track.bounding_box()
    page.mouse.move(thumb["x"] + 4, thumb["y"] + 4)
    page.mouse.down()
    page.mouse.move(thumb["x"] + 4 + 0.06 * track["width"], thumb["y"] + 4, steps=5)
    rest(page)
    page.mouse.up()
    desk.wait(1200)
    dragged = desk.until(lambda: float(shown(page, label)) > float(first) and float(shown(page, label)))
    desk.until(lambda: desk.pictures().first.inner_html() != curve)
    changed(page, picture, 300)
    click_button(page, "undo")
    # a whole drag is one step
    desk.until(lambda: shown(page, label), first)
    click_button(page, "redo")
    desk.until(lambda: float(shown(page, label)), dragged)
    desk.type(label, f"{float(first) / 10 + 1}cm")
    other = {"rssr": sb.rssr(M=700, N=700, L1=260, L3=550, D=0)}.get(desk.name)
    if other is not None:
        swing = np.degrees(other.motion().circuits[0].swing)
        desk.until(lambda: desk.verdict().get("swing of rocker"), f"{swing:.3f}°")
    click_button(page, "reset")
    desk.until(lambda: shown(page, label), first)
    desk.until(lambda: desk.pictures().first.inner_html(), curve)


def test_what_cannot_be_assembled_leaves_the_last_one_in_grey_with_the_reason(desk):
    page = desk.page
    open_tab(page, "Shape")
    label, far = ("L2 [mm]", "5000") if desk.name == "rssr" else ("length [mm]", "2000")
    before = settled(page)
    desk.type(label, far)
    desk.says("cannot-assemble")
    desk.says("The last one that moves stays in grey.")
    assert tinted(before, OUTPUT) > 300 > tinted(changed(page, before, 500), OUTPUT)
    desk.keep("grey")
    click_button(page, "undo")
    desk.until(lambda: page.get_by_text("The last one that moves").count(), 0)
    settled(page, lambda picture: tinted(picture, OUTPUT) > 300)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("abc", "'abc' is not a finite length"),
        ("NaN", "'NaN' is not a finite length"),
        ("1e300", "1e+300 is out of range"),
        ("0", "0 is not a length"),
        ("30deg", "'30deg' is not a finite length"),
    ],
)
def test_bad_values_are_refused_in_place_and_harm_nothing(desk, text, words):
    page = desk.page
    open_tab(page, "Shape")
    label = "L1 [mm]" if desk.name == "rssr" else "length [mm]"
    if text == "0" and desk.name == "seven_r":
        # a length of a row may be 0, a speed may not
        label, text, words = "speed [rad/s]", "0", "moves nothing"
        open_folder(page, "drive")
    first = shown(page, label)
    verdict, curve = desk.verdict(), desk.pictures().first.inner_html()
    desk.type(label, text)
    desk.says(words)
    alert = page.get_by_role("alert").filter(has_text=words)
    beside = box(page, label).bounding_box()
    assert 0 < alert.bounding_box()["y"] - beside["y"] < 120, "the reason stands below the box"
    assert (desk.verdict(), desk.pictures().first.inner_html()) == (verdict, curve)
    if text == "abc":
        desk.keep("refused")
    desk.type(label, first)
    desk.until(lambda: page.get_by_role("alert").filter(has_text=words).count(), 0)


def test_the_curves_show_what_is_chosen_and_the_cursor_goes_along(desk):
    page = desk.page
    desk.until(lambda: desk.pictures().count(), 3)
    offered = options(page, "curve 3")
    outputs = [o for o in offered if o.endswith(" (output)")]
    assert len(outputs) == 3
    joint = "ball_a.1 velocity" if desk.name == "rssr" else "theta_4 velocity"
    point = "speed of A" if desk.name == "rssr" else "speed of P"
    wanted = [next(o for o in offered if joint in o), next(o for o in offered if point.split()[-1] in o)]
    for choice in wanted:
        choose(page, "curve 3", choice)
        desk.until(lambda choice=choice: choice in desk.pictures().nth(2).get_attribute("aria-label"))
    choose(page, "curve 3", outputs[-1])
    choose(page, "over", "time")
    desk.until(lambda: "time [s]" in desk.pictures().first.inner_html())
    choose(page, "over", "the input")
    desk.type("go to input", "90")
    desk.near(0, 90)
    cursors = page.locator("svg[aria-hidden=true] circle").filter(visible=True)
    there = cursors.first.bounding_box()
    desk.type("go to input", "180")
    desk.near(0, 180)
    assert cursors.first.bounding_box()["x"] > there["x"] + 50
    output = np.degrees(desk.motion.circuits[0].output[180])
    told = page.locator("svg[aria-hidden=true] text").filter(visible=True).first.text_content()
    number = float(re.search(r"[-−\d.]+", told)[0].replace("−", "-"))
    assert number == pytest.approx(output, abs=1.0)
    desk.type("go to input", "0")


@once
def test_a_point_is_added_moved_and_taken_away(desk):
    page = desk.page
    open_tab(page, "Points")
    if desk.name == "seven_r":  # brings the paper's point P
        assert shown(page, "u [mm]") == "-100"
        desk.keep("point")
        trace = desk.motion.circuits[0].point(4, (-100, -90, -80))
        fastest = np.linalg.norm(trace.velocity, axis=1).max()
        desk.says(f"P on link 4: fastest {fastest:.4g} mm/s")
    name = shown(page, "name")
    choose(page, "link", "2")
    at = "at u, v, w [mm]" if desk.name == "seven_r" else "at x, y, z [mm]"
    type_into(page, at, "10, 20")
    click_button(page, "Add point")
    desk.says("'10, 20' is not a place; give three numbers")
    type_into(page, at, "60, 40, 30")
    before = settled(page)
    click_button(page, "Add point")
    desk.says(f"point {name}")
    # its path and its arrows are drawn
    with_arrows = changed(page, before, 300)
    desk.says(re.compile(f"{name} on link 2: fastest"))
    desk.keep("points")
    open_tab(page, "Show")
    toggle(page, "velocity arrows")
    changed(page, with_arrows, 40)
    toggle(page, "velocity arrows")
    open_tab(page, "Points")
    choose(page, "remove", name)
    click_button(page, "Remove point")
    desk.until(lambda: page.get_by_text(f"{name} on link 2").count(), 0)


def test_the_input_is_driven_by_another_joint(desk):
    page = desk.page
    open_tab(page, "Shape")
    first, last = ("crank", "rocker") if desk.name == "rssr" else ("theta_1", "theta_7")
    choose(page, "input", last)
    motion = desk.linkage.motion(input=last, output=first)
    there = ", there and back" if motion.circuits[0].input_range else ""
    desk.until(lambda: row(page, f"input{there} [deg]").count())
    desk.until(lambda: desk.verdict().get("motion type"), motion.motion_type)
    if desk.name == "rssr":
        circuit = motion.circuits[int(shown(page, "circuit").partition(":")[0])]
        low, high = (np.degrees(x) for x in circuit.input_range)
        # the rocker drives, and turns back at its limits
        choose(page, "speed", "4 x")
        click_button(page, "Play")
        seen = []

        def both_ways():
            seen.append(desk.reading()[0])
            steps = np.diff([(x - low) % 360 for x in seen])
            return bool((steps > 0).any() and (steps < 0).any())

        desk.until(both_ways)
        click_button(page, "Pause")
        choose(page, "speed", "1 x")
        assert all((x - low) % 360 <= (high - low) + 1e-2 for x in seen), seen
        desk.type("go to input", str(round(high + 20)))
        desk.says("is out of reach of circuit")
        desk.keep("driven_by_the_rocker")
    click_button(page, "reset")
    desk.until(lambda: desk.verdict().get("motion type"), desk.motion.motion_type)
    choose(page, "circuit", f"0: {desk.motion.circuits[0].motion_type}")
    desk.type("go to input", "0")


@once
def test_files_are_saved_and_opened_again(desk, tmp_path):
    page = desk.page
    open_tab(page, "Files")
    saved = download(page, "Download as TOML", tmp_path)
    assert saved.name == f"{desk.name}.toml"
    assert sb.load(saved).dimensions == desk.linkage.dimensions
    bad = tmp_path / "bad.toml"
    bad.write_text("format = 1\n[rssr]\nM = 700\nN = 700\nL1 = -5\nL3 = 550\nD = 0\n")
    upload(page, "Open a TOML file", bad)
    desk.says("bad.toml: rssr.L1: -5 is not a length")
    desk.says(desk.linkage.name)
    mine = tmp_path / "mine.toml"
    mine.write_text(saved.read_text().replace(desk.linkage.name, "Mine <b>own</b>"))
    upload(page, "Open a TOML file", mine)
    desk.says("Mine <b>own</b>")
    choose(page, "gallery", next(o for o in options(page, "gallery") if o.startswith("rsur:")))
    desk.wait(1200)
    desk.says(sb.load("rsur").name)
    desk.keep("gallery")
    choose(page, "gallery", next(o for o in options(page, "gallery") if o.startswith(f"{desk.name}:")))
    desk.wait(1200)
    desk.says(desk.linkage.name)


@once
def test_motion_figures_and_pose_are_exported(desk, tmp_path):
    page = desk.page
    open_tab(page, "Files")
    choose(page, "export", "motion (CSV)")
    with download(page, "Export", tmp_path).open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(len(circuit.time) for circuit in desk.motion)
    column = f"{desk.motion.output}_deg"
    assert float(rows[90][column]) == pytest.approx(np.degrees(desk.motion.circuits[0].output[90]), abs=1e-9)
    choose(page, "export", "report and figures (PNG)")
    packed = download(page, "Export", tmp_path)
    with zipfile.ZipFile(packed) as archive:
        names = set(archive.namelist())
        assert {"report.md", "report.json", "motion.csv", "configuration.png"} <= names
        assert json.loads(archive.read("report.json"))["motion_type"] == desk.motion.motion_type
    choose(page, "export", "pose (GLB)")
    assert download(page, "Export", tmp_path).read_bytes()[:4] == b"glTF"


@once
def test_the_exported_page_plays_without_a_server(desk, chromium, tmp_path):
    page = desk.page
    open_tab(page, "Files")
    choose(page, "export", "page that plays (HTML)")
    saved = download(page, "Export", tmp_path)
    context = person(chromium, viewport={"width": 1000, "height": 600})
    wrong = []
    alone = context.new_page()
    alone.on("pageerror", lambda error: wrong.append(str(error)))
    alone.on(
        "request",
        lambda asked: asked.url.startswith(("file:", "blob:", "data:", "about:")) or wrong.append(asked.url),
    )
    try:
        alone.goto(saved.as_uri())
        assert desk.motion.motion_type in alone.title()
        alone.get_by_text("completeness").wait_for()
        alone.frame_locator("iframe").locator("canvas[data-engine]").wait_for()
        film = alone.locator("iframe").element_handle().content_frame()
        # the linkage moves in it
        seen = settled(film, lambda picture: tinted(picture, OUTPUT) > 60, still=False)
        for _ in range(3):
            seen = settled(film, lambda picture, last=seen: differs(last, picture) > 60, still=False)
        keep(alone, f"{desk.name}_alone")
    finally:
        # a page that plays leaves no time to others
        context.close()
    assert wrong == []


@once
def test_two_tabs_do_not_disturb_each_other(desk, chromium):
    pages = Pages(chromium)
    other = pages(desk.studio.url)
    label = "L1 [mm]" if desk.name == "rssr" else "length [mm]"
    open_tab(desk.page, "Shape")
    first = shown(desk.page, label)
    curve = desk.pictures().first.inner_html()
    theirs = Desk(desk.name, other, desk.studio)
    theirs.type(label, "61")
    theirs.until(lambda: theirs.pictures().first.inner_html() != curve)
    assert (shown(desk.page, label), desk.pictures().first.inner_html()) == (first, curve)
    pages.close()
    assert pages.wrong == []


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGHUP])
def test_closing_the_terminal_ends_it(studio, pages, how):
    one = studio("rssr")
    assert one.url.startswith("http://127.0.0.1:")
    pages(one.url, tolerated=["WebSocket", "ERR_CONNECTION_REFUSED"])
    code = one.stop(how)
    assert code == (0 if how == signal.SIGINT else 129)


def test_another_address_is_told_for_what_it_is(studio):
    one = studio("rssr", "--host", "0.0.0.0")
    assert "served at 0.0.0.0, over the network: whoever has the address printed here" in one.stderr
