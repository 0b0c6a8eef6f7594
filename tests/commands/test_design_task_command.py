"""`sevenbar design task` as a person calls it: designs as files that do what was asked, fronts, messages."""

import csv
import json

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.description.draft import Draft
from sevenbar.description.gallery import text as gallery_text
from sevenbar.design.task import DesignTask, FigureWant, FreeNumber, FunctionWant
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.figures import musts_figure, want_figure
from sevenbar.design.task.file.reader import task_file
from sevenbar.design.task.front import pareto
from sevenbar.design.task.report import TaskDesigns, task_report
from sevenbar.design.task.search import designed
from sevenbar.errors import RequestError

#: Readings of the planar four-bar of 40, 100, 80 and 90 mm, by the law of cosines.
INPUT = np.radians([20.0, 60.0, 100.0])


def rocker(theta, branch):
    """The angle between rocker and ground of the planar four-bar, by the law of cosines.

    `theta` is the angle of the crank against the extension of the ground, as rows have it.
    """
    x, y = 90 + 40 * np.cos(theta), 40 * np.sin(theta)
    far = np.hypot(x, y)
    return np.arctan2(y, x) + branch * np.arccos((far**2 + 80**2 - 100**2) / (2 * far * 80))


TASK = """
linkage = "start.toml"
[free]
length_1 = "30:60"
length_2 = "80:120"
[[want]]
kind = "function"
pairs = [[20, {0:.10f}], [60, {1:.10f}], [100, {2:.10f}]]
input_zero = 0
output_zero = 0
[[must]]
kind = "range"
joint = "theta_3"
range = "-170:-60"
"""


@pytest.fixture
def task_path(tmp_path):
    (tmp_path / "start.toml").write_text(gallery_text("planar_4r").replace("length = 40", "length = 45"))
    readings = sb.load("planar_4r").motion(18).circuits[0]
    rows = [1, 3, 5]
    np.testing.assert_allclose(readings.input[rows], INPUT, atol=1e-12)
    path = tmp_path / "task.toml"
    path.write_text(TASK.format(*np.degrees(readings.output[rows])))
    return path


@pytest.mark.parametrize(
    ("want", "words"),
    [
        (FigureWant("swing", 60.0), "swing 60 deg"),
        (FigureWant("swing", "small"), "swing small"),
        (FigureWant("time_ratio", 1.2), "time_ratio 1.2"),
        (
            FunctionWant(np.radians([0.0, 10.0, 20.0]), np.radians([5.0, 9.0, 5.0])),
            "rocker over crank: 3 readings, 0 to 20 deg in, 5 deg out",
        ),
    ],
)
def test_a_want_in_words_has_its_unit(want, words):
    assert want.words(sb.load("rssr")) == words


def test_the_design_of_known_readings_is_found_and_reported(task_path, tmp_path):
    read = task_file(task_path)
    found = TaskDesigns(designed(read.task, count=1, starts=0), read.name, read.source, 0, 0)
    (design,) = found.found.designs
    # the numbers the readings were made of
    np.testing.assert_allclose(design.values, [40, 100], atol=1e-7)
    report = task_report(read.task, 1, "sevenbar design task task.toml")
    answer = json.loads(report.json(found))
    (one,) = answer["designs"]
    assert one["wants"][0]["greatest"] < 1e-9
    assert one["kkt_residual"] < 1e-6
    assert (answer["starts"], answer["begun"]) == (0, found.found.starts)
    assert one["musts"][0]["unit"] == "deg"
    assert one["musts"][0]["room"] > 0
    written = report.write(found, tmp_path / "out")
    names = sorted(path.name for path in written)
    assert names == [
        "design_1.toml",
        "design_1_linkage.png",
        "design_1_musts.png",
        "design_1_want_1.png",
        "summary.csv",
        "summary.json",
    ]
    text = (tmp_path / "out" / "design_1.toml").read_text()
    assert "# made by: sevenbar design task task.toml" in text
    assert sb.loads(text).dimensions["length_1"] == pytest.approx(40, abs=1e-7)


def test_the_way_of_a_design_lies_on_the_closed_form(task_path):
    read = task_file(task_path)
    (design,) = designed(read.task, count=1, starts=0).designs
    along = DesignAlong(read.task, design)
    x, read = along.ways[0].inputs, along.curve(0).outputs
    # the zero and the sense of the last joint are its own
    both = [np.ptp(np.unwrap(read + sign * rocker(x, way))) for sign in (-1, 1) for way in (-1, 1)]
    assert len(x) > 200
    assert min(both) < 1e-7


def test_nothing_found_says_what_was_nearest_and_what_to_ease(task_path):
    text = task_path.read_text().replace('range = "-170:-60"', 'range = "-1:1"')
    task_path.write_text(text)
    read = task_file(task_path)
    found = designed(read.task, count=1, starts=0)
    with pytest.raises(RequestError, match="design: ") as caught:
        found.required(0)
    assert "a wider range of the joint" in str(caught.value) or "wider bounds" in str(caught.value)


def test_a_front_holds_no_point_that_another_beats():
    linkage = sb.load("planar_4r")
    rows = linkage.motion(18).circuits[0]
    want = FunctionWant(rows.input[[1, 3, 5]], rows.output[[1, 3, 5]])
    free = (FreeNumber("length_1", 35, 45), FreeNumber("length_3", 70, 90))
    task = DesignTask(Draft.of_linkage(linkage), free, (want, FigureWant("swing", "small", unit=60.0)))
    front = pareto(task, 1, "swing", points=4, starts=0)
    values = front.values
    assert len(values) >= 3
    assert (np.diff(values[:, 0]) > 0).all()
    assert (np.diff(values[:, 1]) < 0).all()
    # its ends: the readings exactly, and the shortest crank with the longest rocker
    assert values[0, 0] < 1e-5
    shortest = Draft.of_linkage(linkage).with_values({"length_1": 35.0, "length_3": 90.0}).linkage
    assert values[-1, 1] <= np.degrees(shortest.motion().circuits[0].swing) + 1e-6
    for point in front.points:
        swing = np.degrees(point.design.draft.linkage.motion().circuits[point.design.candidate.circuit].swing)
        assert point.values[1] == pytest.approx(swing, rel=1e-6)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (1, 1, "pareto: want 1 is named twice"),
        (1, 5, "second: 5 is no want of the task; give 1 to 2, or swing"),
        ("torque", 1, "first: 'torque' is no want of the task"),
    ],
)
def test_wants_of_a_front_that_there_are_not(first, second, expected):
    linkage = sb.load("planar_4r")
    want = FunctionWant(np.array([0.1, 0.5]), np.array([0.1, 0.3]))
    task = DesignTask(
        Draft.of_linkage(linkage),
        (FreeNumber("length_1", 35, 45),),
        (want, FigureWant("swing", "small")),
    )
    with pytest.raises(RequestError, match=expected):
        pareto(task, first, second)


def test_a_task_file_in_place_of_a_command_is_a_task(task_path):
    options = ("--designs", 1, "--starts", 0, "--json")
    short = sevenbar("design", task_path, *options)
    whole = sevenbar("design", "task", task_path, *options)
    assert short.returncode == 0, short.stderr
    assert json.loads(short.stdout)["designs"] == json.loads(whole.stdout)["designs"]


def test_a_front_is_written(task_path, tmp_path):
    task_path.write_text(
        task_path.read_text() + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = 'small'\n"
    )
    out = tmp_path / "front"
    run = sevenbar(
        "design", "task", task_path, "--pareto", "1,swing", "--points", 3, "--starts", 0, "--out", out
    )
    assert run.returncode == 0, run.stderr
    with (out / "front.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert rows[0].keys() >= {"want_1_greatest_deg", "swing_deg", "kkt_residual", "length_1"}
    assert {f"design_{row['design']}.toml" for row in rows} <= {path.name for path in out.iterdir()}
    assert (out / "front.png").exists()


def test_mistakes_come_before_the_search(task_path):
    found = mistake("design", "task", task_path, "--pareto", "1")
    assert "--pareto: '1' are not two wants; give two, as in 1,2" in found
    assert "no such file" in mistake("design", "task", task_path.parent / "none.toml")
    folder = task_path.parent
    near = mistake("design", "task", folder / task_path.name.replace("t", "tt", 1))
    assert f"no such file; did you mean '{task_path}'? give the path of a task file (TOML)" in near
    assert "is a folder; give the path of a task file (TOML) in it" in mistake("design", "task", folder)
    (folder / "loop.toml").write_text(gallery_text("planar_4r"))
    linkage = mistake("design", "task", folder / "loop.toml")
    assert (
        "is a linkage file and not a task; a task names its linkage, as in linkage = 'loop.toml'" in linkage
    )
    assert "--seed: 'x' is not a whole number; give one, as in 2" in mistake(
        "design", "task", task_path, "--seed", "x"
    )


def test_figures_are_drawn(task_path):
    read = task_file(task_path)
    (design,) = designed(read.task, count=1, starts=0).designs
    along = DesignAlong(read.task, design)
    assert len(want_figure(along, 0).axes) == 2
    assert len(musts_figure(along).axes) == 1
