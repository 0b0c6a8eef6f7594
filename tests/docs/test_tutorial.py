"""The tutorial is what its commands do today, in both languages. Run `python tests/tutorial_pages.py` to write it anew."""

import csv
import math
import re
import tomllib

import numpy as np
import pytest
from PIL import Image

import sevenbar as sb
from browser import keep
from controls import click_button
from desk import SHOWN, Desk
from tutorial_pages import (
    BOX,
    DOCS,
    IMAGES,
    NUMBER,
    PAGES,
    PICTURES,
    as_today,
    boxes,
    make_light,
    spoken,
    write_file,
)

ENGLISH, CHINESE = PAGES
#: Greatest share of pixels that may look otherwise with another release of matplotlib.
OTHER_PIXELS = 0.01


def prose(page):
    """A page without its boxes, code and addresses."""
    text = BOX.sub("", page.read_text(encoding="utf-8"))
    text = re.sub(r"^```sh\n.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`]*`|\]\([^)]*\)", " ", text)


def decimals(text):
    """The decimal numbers of a text, as written."""
    return re.findall(r"(?<![\w.])\d+\.\d+(?![\w.]*\d)", text)


def linkage(name, **changed):
    """The linkage of the last box that shows this file, dimensions of `[rssr]` changed."""
    text = [text for kind, text in boxes(ENGLISH) if kind == "toml" and text.startswith(f"# {name}.toml")][-1]
    for dimension, value in changed.items():
        text, count = re.subn(rf"^{dimension} = .*$", f"{dimension} = {value}", text, flags=re.MULTILINE)
        assert count == 1
    return sb.loads(text)


def test_the_tutorial_shows_what_its_commands_print_and_draw_today(tmp_path):
    count = 0
    for kind, text in boxes(ENGLISH):
        if kind == "toml":
            write_file(text, tmp_path)
        elif kind == "python":
            promised = re.findall(r"print\(.*\)  # (.*)", text)
            assert promised
            assert spoken(text, tmp_path) == promised
        else:
            count += as_today(text, tmp_path)
    assert count == 23
    for name, source in PICTURES.items():
        make_light(tmp_path / source, tmp_path / name)
        one, other = (np.asarray(Image.open(path / name).convert("L"), int) for path in (IMAGES, tmp_path))
        assert one.shape == other.shape, name
        assert np.mean(np.abs(one - other) > 64) < OTHER_PIXELS, name
    # no place of the map has the swing and the time ratio that are wanted
    with (tmp_path / "map" / "contours.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if (row["measure"], row["level"]) == ("swing", "60.0")]
    places = [(float(row["L1_mm"]), float(row["M_mm"])) for row in rows]
    assert len(places) > 100
    motions = [sb.rssr(M=M, N=300, L1=L1, L3=200, D=0).motion(8) for L1, M in places]
    ratios = [motion.circuits[0].time_ratio for motion in motions]
    assert 1.15 < max(ratios) < 1.16


def test_both_languages_give_the_same_files_and_commands_and_show_the_same():
    box = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
    english, chinese = (box.findall(page.read_text(encoding="utf-8")) for page in PAGES)
    assert len(english) > 15
    assert chinese == english


def test_both_languages_have_the_same_numbers_links_and_pictures():
    english, chinese = (page.read_text(encoding="utf-8") for page in PAGES)
    assert sorted(decimals(prose(CHINESE))) == sorted(decimals(prose(ENGLISH)))
    pictures = [
        re.findall(r"!\[[^\]]+\]\((?:\.\./)?(images/\w+\.png)\)", text) for text in (english, chinese)
    ]
    assert pictures[0] == pictures[1]
    assert {*pictures[0]} == {f"images/{name}" for name in (*PICTURES, "tutorial_studio.png")}


@pytest.mark.parametrize(
    "page", [*PAGES, DOCS / "zh" / "index.md"], ids=["english", "chinese", "chinese first page"]
)
def test_links_of_these_pages_lead_somewhere(page):
    for target in re.findall(r"\]\((?!https:)([^)#]+)\)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_each_number_of_the_text_stands_in_a_box_or_follows_from_the_files():
    circuit = linkage("chosen").motion().circuits[1]
    falls = (circuit.angle.lowest_at - circuit.angle.highest_at) % math.tau
    told = {f"{math.degrees(falls):.3f}", f"{360 - math.degrees(falls):.3f}"}
    # the slower stroke is the one downwards
    assert falls / (math.tau - falls) == pytest.approx(circuit.time_ratio, rel=1e-12)
    told |= {f"{abs(math.degrees(circuit.swing) - 60):.3f}", f"{abs(circuit.time_ratio - 1.2):.3f}"}
    for changed in ({"L1": 125}, {"M": 150}, {"L1": 125, "M": 150}):
        motion = linkage("feeder", **changed).motion()
        told |= {f"{math.degrees(limit):.3f}" for limit in motion.limits}
        if motion.motion_type == "crank-rocker":
            first = motion.circuits[0]
            told |= {f"{math.degrees(value):.3f}" for value in (first.swing, first.transmission.lowest)}
            told.add(f"{first.time_ratio:.6g}")
    shown = [float(x) for kind, text in boxes(ENGLISH) if kind != "toml" for x in re.findall(NUMBER, text)]
    # the wish; the lines of the map, held by the walk through the page; the oldest Python
    told |= {"0.5", "1.2", "1.19", "1.15", "1.16", "3.11"}
    for number in decimals(prose(ENGLISH)):
        places = len(number.partition(".")[2])
        stands = any(f"{abs(value):.{places}f}" == number for value in shown)
        assert stands or number in told, number


def test_what_the_install_line_names_are_extras():
    extras = tomllib.loads((DOCS.parent / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    (named,) = re.findall(r"pip install '\.\[(.*?)\]'", ENGLISH.read_text(encoding="utf-8"))
    assert named.split(",") == sorted({*named.split(",")} & {*extras})


def test_the_studio_answers_what_the_tutorial_says(studio, pages, tmp_path):
    text = [text for kind, text in boxes(ENGLISH) if kind == "toml" and text.startswith("# feeder.toml")][-1]
    write_file(text, tmp_path)
    one = studio(tmp_path / "feeder.toml")
    desk = Desk("rssr", pages(one.url, smooth=True), one)
    said = prose(ENGLISH)
    desk.type("L1 [mm]", "125")
    desk.until(lambda: desk.verdict().get("motion type"), "double-rocker")
    assert all(limit.strip("°") in said for limit in desk.verdict()["input limits"].split())
    click_button(desk.page, "undo")
    desk.until(lambda: desk.verdict().get("motion type"), "crank-rocker")
    desk.type("M [mm]", "150")
    desk.until(lambda: desk.verdict().get("swing of rocker"), "37.882°")
    assert desk.verdict()["transmission angle min"].partition("°")[0] in said
    desk.type("L1 [mm]", "125")
    desk.until(lambda: desk.verdict().get("swing of rocker"), "58.854°")
    verdict = desk.verdict()
    assert verdict["time ratio"] in said
    assert verdict["transmission angle min"].partition("°")[0] in said
    desk.page.mouse.move(220, 800)
    desk.page.mouse.wheel(0, 300)
    desk.page.wait_for_timeout(SHOWN)
    keep(desk.page, "tutorial_studio")


def test_pictures_are_light():
    for name in (*PICTURES, "tutorial_studio.png"):
        assert (IMAGES / name).stat().st_size < 160_000, name


def test_the_example_of_the_chinese_first_page_prints_what_its_comments_say(tmp_path):
    text = (DOCS / "zh" / "index.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    promised = re.findall(r"print\(.*\)  # (.*)", code)
    assert len(promised) == 4
    assert spoken(code, tmp_path) == promised
