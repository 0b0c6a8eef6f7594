"""`sevenbar map` as a person calls it: what is printed and written, and one message for each mistake."""

from __future__ import annotations

import csv
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import DOCS
from sevenbar.design.maps.atlas import motion_map
from sevenbar.design.maps.figures import LOOKS, SIZES, draw, look
from sevenbar.design.maps.heights import measure_heights

PAGE = DOCS / "maps.md"
OVER = ("--over", "L1=100:400", "--over", "L3=300:800")


@pytest.fixture(scope="module")
def of():
    return motion_map(sb.load("rssr"), {"L1": (100, 1000), "D": (-800, 800)}, grid=21, follow=["L2"])


def test_the_shares_of_the_types_and_the_way_to_the_next_one_are_printed():
    run = sevenbar("map", "rssr", "--over", "L1=10:40cm", "--over", "L3=300..800", "--follow", "L2")
    assert (run.returncode, run.stderr) == (0, "mapping RSSR of Sun and Zhou ..\n")
    lines = [re.sub(r" +", " ", line).strip() for line in run.stdout.splitlines()]
    # the triangle below the line L3 = 2 L1
    assert "crank-rocker 58.333 %" in lines
    assert "double-rocker 41.667 %" in lines
    assert "L1 up +25 275 mm double-rocker" in lines
    assert "L3 down -50 500 mm double-rocker" in lines
    assert "L1 down not before 100 mm" in lines
    assert "held M, N, D; L2 follows (997.497 mm in the design)" in lines


def test_the_rod_that_the_file_leaves_out_is_held():
    run = sevenbar("map", "rssr", *OVER)
    lines = [re.sub(r" +", " ", line).strip() for line in run.stdout.splitlines()]
    assert "held M, N, D, L2 (997.497 mm in the design)" in lines
    assert "L1 up +36.1541 286.154146 mm double-rocker" in lines
    assert "L3 down -154.138 395.861873 mm double-rocker" in lines


def table(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def test_the_folder_holds_the_map_for_people_and_for_programs(tmp_path):
    out = tmp_path / "atlas"
    run = sevenbar(
        "map", "rssr", *OVER, "--measure", "swing", "--out", out, "--figures", "svg,pdf", "--grid", 15
    )
    assert run.returncode == 0
    names = {path.name for path in out.iterdir()}
    assert names == {
        *("map.json", "boundaries.csv", "contours.csv"),
        *("map.svg", "map.pdf", "swing.svg", "swing.pdf"),
    }
    told = json.loads((out / "map.json").read_text())
    assert [axis["dimension"] for axis in told["axes"]] == ["L1", "L3"]
    assert sum(kind["share"] for kind in told["kinds"]) == pytest.approx(1)
    assert told["design"]["changes"][1] == {
        "dimension": "L1",
        "way": "up",
        "at": pytest.approx(286.154146),
        "becomes": {"motion_type": "double-rocker", "circuits": 1},
    }
    (line,) = told["boundaries"]
    assert {line["left"]["motion_type"], line["right"]["motion_type"]} == {"crank-rocker", "double-rocker"}
    rows = table(out / "boundaries.csv")
    assert len(rows) == len(line["points"])
    for row in rows:
        reach = math.hypot(700 + float(row["L1_mm"]), 700 - float(row["L3_mm"]))
        assert reach == pytest.approx(told["held"]["L2"], abs=1e-3)
    assert (told["left_out"], told["follow"]) == (["L2"], [])
    assert told["held"] == {"M": 700, "N": 700, "D": 0, "L2": pytest.approx(997.496867)}
    (swing,) = told["measures"]
    assert swing["unit"] == "deg"
    assert swing["design"] == pytest.approx(75.1465, abs=1e-3)
    levels = {float(row["level"]) for row in table(out / "contours.csv")}
    assert levels <= set(swing["levels"])
    assert levels


def test_nothing_is_replaced_without_force(tmp_path):
    (tmp_path / "map.json").write_text("mine")
    message = mistake("map", "rssr", *OVER, "--out", tmp_path)
    assert message == f"{tmp_path / 'map.json'}: exists already; give another path, or --force to replace it"
    assert sevenbar("map", "rssr", *OVER, "--out", tmp_path, "--force").returncode == 0


def test_json_is_printed_alone():
    run = sevenbar("map", "rssr", *OVER, "--json")
    assert json.loads(run.stdout)["format"] == 1


RANGE = "as in 'L1=100:400' or 'L1=10:40cm'"
MISTAKES = {
    ("rssr",): f"over: 0 dimensions given where a map has two; give a range for each of two, {RANGE}",
    (
        "rssr",
        "--over",
        "L1=1:2",
    ): f"over: 1 dimension given where a map has two; give a range for each of two, {RANGE}",
    ("rssr", "--over", "L1=1:2", "--over", "L1=1:3"): "over: 'L1' is given twice; leave one out",
    (
        "rssr",
        "--over",
        "L1=1:2",
        "--over",
        "rssr.L1=1:3",
    ): "over: L1 is given twice under two names; give two dimensions",
    (
        "rssr",
        "--over",
        "L9=1:2",
        "--over",
        "L1=1:2",
    ): "dimension: 'L9' is not a dimension of 'RSSR of Sun and Zhou'; ",
    (
        "rssr",
        "--over",
        "L1=400:100",
        "--over",
        "L3=1:2",
    ): "over: L1: 400:100 goes down; give LOW:HIGH with LOW < HIGH",
    ("rssr", "--over", "L1=5:5", "--over", "L3=1:2"): "over: L1: 5:5 is empty; give LOW:HIGH with LOW < HIGH",
    (
        "rssr",
        "--over",
        "L1=0:5",
        "--over",
        "L3=1:2",
    ): "over: L1: 0:5 holds values that are no length; give a range above 0",
    ("rssr", "--over", "L1=5", "--over", "L3=1:2"): f"over: L1: '5' is not a range; give LOW:HIGH, {RANGE}",
    (
        "rssr",
        "--over",
        "L1",
        "--over",
        "L3=1:2",
    ): f"over: 'L1' is not a range of a dimension; give NAME=LOW:HIGH, {RANGE}",
    (
        "rssr",
        "--over",
        "L1=a:5",
        "--over",
        "L3=1:2",
    ): "over: L1: 'a' is not a finite length; give 250 or 250mm",
    (
        "rssr",
        "--over",
        "L1=5kg:6kg",
        "--over",
        "L3=1:2",
    ): "over: L1: '5kg' is not a finite length; give 250 or 250mm",
    (
        "rssr",
        "--over",
        "L1=1000000000:1000000000.5",
        "--over",
        "L3=1:2",
    ): "over: L1: 1000000000.0:1000000000.5 is too narrow",
    ("rssr", *OVER, "--measure", "swng"): "measure: 'swng' is not a measure; did you mean 'swing'? ",
    (
        "rssr",
        *OVER,
        "--measure",
        "limits",
    ): "measure: limits is a count, which has no contours; give some of swing, ",
    (
        "rssr",
        *OVER,
        "--measure",
        "swing",
        "--take",
        "best",
    ): "--take: 'best' is not offered; give highest, lowest, or",
    (
        "rssr",
        *OVER,
        "--measure",
        "swing",
        "--levels",
        "1,x",
    ): "--levels: '1,x' are not finite numbers; give some, as in 20,40,60",
    ("rssr", *OVER, "--levels", "1"): "--levels: of no measure; give --measure too, as in '--measure swing'",
    ("rssr", *OVER, "--size", "A9"): "size: 'A9' is not a sheet; give A4, A3, A2 or A1",
    ("rssr", *OVER, "--grid", "1"): "grid: 1 is not a count of lines; give 3 to 1001",
    (
        "rssr",
        *OVER,
        "--input",
        "wheel",
    ): "input: no joint 'wheel'; this linkage has crank, ball_a, ball_b, rocker",
    ("nowhere", *OVER): "nowhere: no such file; ",
}


@pytest.mark.parametrize("arguments", MISTAKES, ids=lambda words: " ".join(words))
def test_each_mistake_has_one_message_that_says_what_to_do(arguments):
    message = mistake("map", *arguments)
    assert message.startswith(MISTAKES[arguments])
    assert "\n" not in message


def words_on(figure):
    return [text.get_text() for text in figure.findobj(Text) if text.get_text() and text.get_visible()]


def test_a_figure_names_its_regions_its_axes_and_the_design(of):
    figure = draw(of)
    words = words_on(figure)
    assert {"L1 [mm]", "D [mm]", "crank-rocker", "the design", "motion type changes"} <= set(words)
    assert any(word.startswith("crank-rocker  ") and word.endswith(" %") for word in words)
    (told,) = [word for word in words if word.startswith("input: crank")]
    assert "L1 = 250 mm" in told
    assert "L1 = 275 mm: double-rocker" in told
    assert "L2 follows from the others" in told


@pytest.mark.parametrize("command", ["map", "sweep"])
def test_an_end_that_is_no_number_is_the_option_s_and_not_the_file_s(command):
    over = {"map": "L1=100:nan", "sweep": "L1=100:nan:5"}[command]
    told = mistake(command, "rssr", "--over", over, "--over", {"map": "L3=300:800", "sweep": "L3=1"}[command])
    assert told == "over: L1: 'nan' is not a finite length; give 250 or 250mm"


def test_a_circuit_that_no_linkage_on_the_map_has_is_refused(tmp_path):
    words = ("map", "rssr", *OVER, "--measure", "swing", "--grid", "5", "--take", "7", "--out", "out")
    run = sevenbar(*words, cwd=tmp_path)
    assert (run.returncode, run.stdout, list(tmp_path.iterdir())) == (2, "", [])
    assert run.stderr.splitlines()[-1] == (
        "sevenbar: take: 7 is a circuit that no linkage on the map has: they have at most 2, 0 to 1; "
        "give one of these, highest or lowest"
    )


@pytest.mark.parametrize("size", SIZES)
def test_a_sheet_has_the_size_asked_for_and_nothing_leaves_it(of, size):
    (heights,) = measure_heights(of, ["swing"])
    figure = draw(of, heights, size=size)
    assert tuple(figure.get_size_inches()) == SIZES[size]
    renderer = figure.canvas.get_renderer()
    page = figure.bbox
    for text in figure.findobj(Text):
        box = text.get_window_extent(renderer)
        if text.get_text() and text.get_visible() and box.width > 0 and text.axes is None:
            assert page.x0 <= box.x0
            assert box.x1 <= page.x1
            assert page.y0 <= box.y0
            assert box.y1 <= page.y1


def lightness(colour) -> float:
    """CIE L* of a colour."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    y = float(linear @ [0.2126, 0.7152, 0.0722])
    return 116 * y ** (1 / 3) - 16


def test_the_motion_types_can_be_told_apart_in_grey():
    names = ["double-crank", "rocker-crank", "crank-rocker", "double-rocker", "cannot-assemble"]
    light = sorted(lightness(LOOKS[name][0]) for name in names)
    # both counts of circuits of a double-rocker stand on one map
    of = motion_map(
        sb.rssr(M=700, N=700, L1=250, L3=550, D=100, L2=1000), {"L1": (1500, 1800), "L2": (700, 1200)}, grid=9
    )
    light += [lightness(look(of, kind)["facecolor"]) for kind in of.areas if kind.circuits == 2]
    light.sort()
    assert min(np.diff(light)) > 6


def test_what_the_page_on_maps_prints_is_what_its_commands_print_today(tmp_path):
    page = PAGE.read_text(encoding="utf-8")
    shown = re.sub(r" +", " ", page)
    commands = re.findall(r"^    \$ sevenbar (.*)$", page, flags=re.MULTILINE)
    assert len(commands) >= 2
    for index, command in enumerate(commands):
        run = sevenbar(*command.replace("DIR", str(tmp_path / str(index))).split())
        assert run.returncode == 0, run.stderr
        for line in run.stdout.partition("\nwritten:")[0].splitlines():
            told = re.sub(r" +", " ", line).strip()
            assert not told.strip("─") or f" {told}\n" in shown, line


def test_the_example_of_the_page_on_maps_prints_what_its_comments_say(capsys):
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    exec(code, {})
    promised = re.findall(r"print\(.*\)  # (.*)", code)
    assert capsys.readouterr().out.splitlines() == promised


def test_without_shapely_the_extra_is_named():
    hide = "import sys; sys.modules['shapely'] = None"
    told = mistake("map", "rssr", *OVER, before=hide)
    assert told == "maps need shapely; install it with: pip install 'sevenbar[design]'"


def test_without_shapely_the_other_tools_of_design_are_there():
    hide = "import sys; sys.modules['shapely'] = None"
    code = f"{hide}\nimport sevenbar as sb\nprint(len(sb.design.tolerance.__all__), len(sb.design.points.__all__))"
    run = [sys.executable, "-c", code]
    assert subprocess.run(run, capture_output=True, text=True, check=True).stdout.split()[0] == "9"
