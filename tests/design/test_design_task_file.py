"""A task file is read whole: its values in radians and lengths, each mistake with its place and what to do."""

from pathlib import Path

import numpy as np
import pytest

from places import DOCS, EXAMPLES, ROOT
from sevenbar.description.gallery import text as gallery_text
from sevenbar.design.task.file.reader import read_task, task_file
from sevenbar.design.task.file.schema import MUSTS, WANTS, LimitsForm, TaskForm
from sevenbar.design.task.wants.pose_form import PoseForm
from sevenbar.errors import DescriptionError

#: A task that is right, part by part.
FREE = '[free]\nlength_1 = "30:80"\n'
PATH = '[[want]]\nkind = "path"\npoint = "P"\nplaces = [[0, 100, 0], [20, 110, 0], [40, 100, 0]]\n'
FUNCTION = '[[want]]\nkind = "function"\npairs = [[0, 10], [20, 30], [40, 35]]\n'
POINT = '[[point]]\nname = "P"\nlink = 2\nat = [-50, 0, 20]\n'
DRAWN = """
format = 1
name = "drawn RSSR"
[[joint]]
name = "crank"
kind = "R"
at = [0, 0, 0]
axis = [0, 0, 1]
[[joint]]
name = "A"
kind = "S"
at = [50, 0, 0]
[[joint]]
name = "B"
kind = "S"
at = [200, 80, 90]
[[joint]]
name = "rocker"
kind = "R"
at = [200, 0, 60]
axis = [1, 0, 0]
[[point]]
name = "G"
link = 4
at = [0, 0, 0]
"""


def written(folder: Path, body: str, linkage: str = "planar.toml") -> Path:
    (folder / "drawn.toml").write_text(DRAWN)
    apart = gallery_text("planar_4r").replace("length = 90", "length = 300")
    (folder / "apart.toml").write_text(apart + POINT)
    (folder / "planar.toml").write_text(gallery_text("planar_4r") + POINT)
    (folder / "path.csv").write_text("x [cm],y [cm]\n0,10\n2,11\n4,10\n")
    (folder / "pairs.csv").write_text("input_deg,output_deg\n0,10\n20,30\n40,35\n")
    (folder / "poses.csv").write_text("x [mm],y [mm],turn_z [deg]\n0,0,0\n10,5,20\n")
    path = folder / "task.toml"
    path.write_text(f'linkage = "{linkage}"\n{body}' if linkage else body)
    return path


def message(folder: Path, body: str, linkage: str = "planar.toml") -> str:
    path = written(folder, body, linkage)
    with pytest.raises(DescriptionError) as caught:
        read_task(path)
    return str(caught.value).replace(str(path), "task.toml").replace(str(folder), "DIR")


def test_values_come_in_radians_and_the_linkages_lengths(tmp_path):
    body = """
goal = "minimax"
placement = "free"
name = "three places"
[free]
"length_*" = "10:200"
length_2 = "5:20cm"
[limits]
motion_type = "crank-rocker"
size = "1cm:1m"
[[want]]
kind = "path"
point = "P"
table = "path.csv"
weight = 2
[[want]]
kind = "function"
table = "pairs.csv"
input_zero = 30
exact = true
[[want]]
kind = "poses"
link = 2
table = "poses.csv"
arm = "10cm"
[[want]]
kind = "poses"
link = 2
arm = 50
poses = [{ at = [1, 2, 0], angle = 30 }, { at = [0, 0, 0], matrix = [[0, -1, 0], [1, 0, 0], [0, 0, 1]] }]
[[want]]
kind = "figure"
name = "swing"
value = "0.5rad"
[[want]]
kind = "dwell"
range = "100:140deg"
[[must]]
kind = "range"
joint = "theta_2"
range = "-pi/2:90deg"
[[must]]
kind = "figure"
name = "time_ratio"
most = 1.5
[[must]]
kind = "most"
want = 1
most = "1mm"
[[must]]
kind = "apart"
links = [1, 3]
least = "1cm"
"""
    found = task_file(written(tmp_path, body))
    task = found.task
    assert found.name == "three places"
    assert task.goal == "minimax"
    assert task.placement == "free"
    bounds = {one.name: (one.low, one.high) for one in task.free}
    assert bounds == {
        "length_1": (10, 200),
        "length_2": (50, 200),
        "length_3": (10, 200),
        "length_4": (10, 200),
    }
    assert task.limits.size == (10, 1000)
    assert task.limits.motion_type == "crank-rocker"
    path, pairs, of_table, poses, swing, dwell = task.wants
    np.testing.assert_allclose(path.places, [[0, 100, 0], [20, 110, 0], [40, 100, 0]])
    assert path.weight == 2
    assert not path.closed
    np.testing.assert_allclose(np.degrees([pairs.input, pairs.output]), [[0, 20, 40], [10, 30, 35]])
    assert pairs.zeros == (pytest.approx(np.pi / 6), None)
    assert of_table.arm == 100
    np.testing.assert_allclose(of_table.poses[1, :3, 3], [10, 5, 0])
    # a turn about z: its cosine and sine
    np.testing.assert_allclose(of_table.poses[1, :2, 0], [np.cos(np.pi / 9), np.sin(np.pi / 9)])
    np.testing.assert_allclose(poses.poses[0, :2, 0], [np.sqrt(3) / 2, 0.5])
    np.testing.assert_allclose(poses.poses[1, :3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert swing.value == pytest.approx(np.degrees(0.5))
    assert dwell.inputs == pytest.approx((np.radians(100), np.radians(140)))
    assert dwell.level is None
    turned, ratio, most, apart, exact = task.musts
    assert (turned.low, turned.high) == pytest.approx((-np.pi / 2, np.pi / 2))
    assert ratio.most == 1.5
    assert apart.least == 10
    # relative to the extent of the path, 40 mm
    assert most.most == pytest.approx(1 / 40)
    assert exact.want == 1


def test_a_formula_goes_over_its_ranges_and_points_are_chebyshevs(tmp_path):
    body = (
        FREE
        + '[[want]]\nkind = "function"\ny = "x^2"\nx = "0:2"\ninput = "0:90deg"\noutput = "60:0deg"\npoints = 3\n'
    )
    (want,) = read_task(written(tmp_path, body)).wants
    share = 0.5 - 0.5 * np.cos((2 * np.arange(3) + 1) * np.pi / 6)
    np.testing.assert_allclose(np.degrees(want.input), 90 * share, atol=1e-12)
    np.testing.assert_allclose(np.degrees(want.output), 60 - 60 * share**2, atol=1e-12)


def test_a_formula_without_ranges_gives_the_readings_themselves(tmp_path):
    # the outer wheel of a car whose track is 0.55 of its wheelbase
    y = "atan(tan(x)/(1 + 0.55*tan(x)))"
    body = FREE + f'[[want]]\nkind = "function"\ny = "{y}"\nx = "-30deg:40deg"\n'
    (want,) = read_task(written(tmp_path, body)).wants
    assert np.degrees(want.input[[0, -1]]) == pytest.approx((-30, 40))
    np.testing.assert_allclose(1 / np.tan(want.output) - 1 / np.tan(want.input), 0.55)


def test_poses_of_a_frame_on_the_link_are_those_of_the_link_itself(tmp_path):
    poses = "poses = [{ at = [10, 20, 0], angle = 90 }]"
    frame = "frame = { at = [10, 20, 0], angle = 90 }"
    body = FREE + f'[[want]]\nkind = "poses"\nlink = 2\n{frame}\n{poses}\n'
    (want,) = read_task(written(tmp_path, body)).wants
    np.testing.assert_allclose(want.poses[0], np.eye(4), atol=1e-14)


def test_a_linkage_may_stand_in_the_file_itself(tmp_path):
    inner = gallery_text("planar_4r")
    tables = inner.replace("[[", "[[linkage.").replace("\n[drive", "\n[linkage.drive")
    head, _, rest = tables.partition("\n[")
    body = FREE + FUNCTION + f"[linkage]\n{head}\n[{rest}"
    assert read_task(written(tmp_path, body, linkage="")).draft.linkage.kind == "RRRR"


def test_files_that_a_linkage_in_the_task_names_lie_beside_it_and_its_mistakes_have_their_place(tmp_path):
    inner = gallery_text("planar_4r").replace("[[", "[[linkage.").replace("\n[drive", "\n[linkage.drive")
    head, _, rest = inner.partition("\n[")
    load = '[[linkage.load]]\nlink = 3\ntorque = [0, 0, 2]\ntable = "press.csv"\n'
    (tmp_path / "press.csv").write_text("theta_1 [deg],factor\n0,1\n180,0.5\n360,1\n")
    task = written(tmp_path, FREE + FUNCTION + f"[linkage]\n{head}\n[{rest}\n{load}", linkage="")
    (row,) = read_task(task).draft.raw["load"]
    assert row["table"][1] == [180.0, 0.5]
    (tmp_path / "press.csv").unlink()
    with pytest.raises(DescriptionError, match=r"task\.toml: linkage\.load\[1\]\.table: .*press\.csv"):
        read_task(task)


def test_a_closed_path_does_not_repeat_its_first_place(tmp_path):
    rows = "[[0, 100], [20, 110], [40, 100], [0, 100]]"
    body = FREE + f'[[want]]\nkind = "path"\npoint = "P"\nplaces = {rows}\n'
    (want,) = read_task(written(tmp_path, body)).wants
    assert want.closed
    assert len(want.places) == 3


WRONG = {
    "linkage outside": ("../planar.toml", FREE + PATH, "task.toml: linkage: '../planar.toml' is not below the folder of this file"),
    "linkage from the root": ("/etc/passwd", FREE + PATH, "task.toml: linkage: '/etc/passwd' is not below the folder of this"),
    "table outside": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 2\ntable = '../none.csv'\n", "task.toml: want[1].table: '../none.csv' is not below the folder of this file"),
    "no linkage": ("", FREE + PATH, "task.toml: linkage: is missing; give a file in the folder of this one"),
    "unknown linkage": ("planar_4rr", FREE + PATH, "task.toml: linkage: 'planar_4rr': no such file"),
    "unknown key": ("planar.toml", 'gaol = "minimax"\n' + FREE + PATH, "task.toml: gaol: is not known here; did you mean 'goal'?"),
    "unknown goal": ("planar.toml", 'goal = "least"\n' + FREE + PATH, "task.toml: goal: 'least' is not a goal; allowed: least squares, minimax"),
    "unknown placement": ("planar.toml", 'placement = "anywhere"\n' + FREE + PATH, "task.toml: placement: 'anywhere' is not a placement; allowed:"),
    "no wants": ("planar.toml", FREE, "task.toml: want: is missing; needed here: linkage, want, free"),
    "empty wants": ("planar.toml", "want = []\n" + FREE, "task.toml: want: none given; say what is wanted"),
    "no free numbers": ("planar.toml", PATH, "task.toml: free: is missing"),
    "empty free": ("planar.toml", "[free]\n" + PATH, "task.toml: free: no number may change; give bounds of some of length_1,"),
    "no kind": ("planar.toml", FREE + "[[want]]\npoint = 'P'\n", "task.toml: want[1].kind: is missing; give one of function, path, poses"),
    "unknown kind": ("planar.toml", FREE + "[[want]]\nkind = 'paths'\n", "task.toml: want[1].kind: 'paths' is none; did you mean 'path'?"),
    "key of another kind": ("planar.toml", FREE + PATH + "angle = 3\n", "task.toml: want[1].angle: is not known here; did you mean 'table'? allowed:"),
    "unknown number": ("planar.toml", '[free]\nlenth_1 = "1:2"\n' + PATH, "task.toml: free.lenth_1: is not a number of the linkage; did you mean 'length_1'?"),
    "pattern of nothing": ("planar.toml", '[free]\n"Z*" = "1:2"\n' + PATH, "task.toml: free.Z*: is not a number of the linkage"),
    "two patterns": ("planar.toml", '[free]\n"length_?" = "10:200"\n"length*" = "10:200"\n' + PATH, "is matched by 'length_?', too; leave one out"),
    "no range": ("planar.toml", "[free]\nlength_1 = 3\n" + PATH, "task.toml: free.length_1: 3 is not a range; give the two ends"),
    "wrong unit": ("planar.toml", '[free]\nlength_1 = "3:4deg"\n' + PATH, "task.toml: free.length_1: link[1].length: '3deg' is not a finite length; give 250 or 250mm"),
    "bounds turned round": ("planar.toml", '[free]\nlength_1 = "80:30"\n' + PATH, "task.toml: free.length_1: 80:30 are no bounds; give the least value first"),
    "bounds exclude the start": ("planar.toml", '[free]\nlength_1 = "60:80"\n' + PATH, "task.toml: free.length_1: begins at 40 mm, outside 60:80; give bounds that hold it"),
    "a link of length 0": ("rssr", '[free]\nL1 = "-10:300"\n' + FUNCTION, "task.toml: free.L1: -10 is no length of a link; give bounds > 0"),
    "a point in no want": ("planar.toml", '[free]\n"P.u" = "-50:50"\n' + FUNCTION, "task.toml: free.P.u: point 'P' is in no want and no must"),
    "free and follows": ("rssr", 'follow = ["L2"]\n[free]\nL2 = "900:1100"\n' + FUNCTION, "task.toml: free.L2: is to follow from the others"),
    "follows nothing": ("planar.toml", 'follow = "length_1"\n' + FREE + PATH, "task.toml: follow: 'length_1' is given, 40 mm, so it stays"),
    "unknown point": ("planar.toml", FREE + PATH.replace('"P"', '"Q"'), "task.toml: want[1].point: no point 'Q'; this linkage has P"),
    "point of the ground": ("drawn.toml", '[free]\n"crank.at_z" = "-5:5"\n'.replace("at_z", "z") + PATH.replace('"P"', '"G"'), "task.toml: want[1].point: 'G' is on the ground, which stands still"),
    "path of two points": ("planar.toml", FREE + PATH.replace(", [40, 100, 0]", ""), "task.toml: want[1].places: 2 given; a path needs at least 3"),
    "places and table": ("planar.toml", FREE + PATH + "table = 'path.csv'\n", "task.toml: want[1]: places and table are both given; give one of the two"),
    "no places": ("planar.toml", FREE + "[[want]]\nkind = 'path'\npoint = 'P'\n", "task.toml: want[1]: places and table are missing; give one of the two"),
    "no such table": ("planar.toml", FREE + "[[want]]\nkind = 'path'\npoint = 'P'\ntable = 'none.csv'\n", "task.toml: want[1].table: DIR/none.csv: no such file"),
    "timing turns back": ("planar.toml", FREE + PATH + "timing = [0, 20, 10]\n", "task.toml: want[1].timing: the input of point 3 turns back"),
    "timing of another count": ("planar.toml", FREE + PATH + "timing = [0, 20]\n", "task.toml: want[1].timing: 2 inputs for 3 points; give one for each"),
    "timing of no table": ("planar.toml", FREE + PATH + "timing = true\n", "task.toml: want[1].timing: no table has a column for the input 'theta_1'"),
    "phase without timing": ("planar.toml", FREE + PATH + "phase = true\n", "task.toml: want[1].phase: there are no inputs whose start could be free"),
    "no flag": ("planar.toml", FREE + PATH + "phase = 'yes'\n", "task.toml: want[1].phase: 'yes' is neither true nor false"),
    "no weight": ("planar.toml", FREE + PATH + "weight = 0\n", "task.toml: want[1].weight: 0 is not a weight; give a number > 0"),
    "y and pairs": ("planar.toml", FREE + FUNCTION + "y = 'x'\n", "task.toml: want[1]: y and pairs are given; give one of the three"),
    "ranges without y": ("planar.toml", FREE + FUNCTION + "input = '0:9'\n", "task.toml: want[1].input: belongs to y; pairs says it all"),
    "y with one range": (
        "planar.toml",
        FREE + "[[want]]\nkind = 'function'\ny = 'x'\noutput = '0:9'\n",
        "task.toml: want[1].input: is missing; give both ranges of readings, or neither",
    ),
    "readings over a turn": (
        "planar.toml",
        FREE + "[[want]]\nkind = 'function'\ny = 'x'\nx = '0:90'\n",
        "task.toml: want[1].x: goes over 5156.62 deg, for it counts in radians; give a part of a turn",
    ),
    "y is no formula": ("planar.toml", FREE + "[[want]]\nkind = 'function'\ny = 'xx'\ninput = '0:9'\noutput = '0:9'\n", "task.toml: want[1].y: 'xx': no 'xx' is known"),
    "y has no value": ("planar.toml", FREE + "[[want]]\nkind = 'function'\ny = 'log(x)'\ninput = '0:9'\noutput = '0:9'\n", "task.toml: want[1].y: log(x) has no value at x = 0"),
    "x falls": ("planar.toml", FREE + "[[want]]\nkind = 'function'\ny = 'x'\nx = '1:0'\ninput = '0:9'\noutput = '0:9'\n", "task.toml: want[1].x: 1:0 does not rise"),
    "over a turn": ("planar.toml", FREE + "[[want]]\nkind = 'function'\ny = 'x'\ninput = '0:400'\noutput = '0:9'\n", "task.toml: want[1].input: goes over 400 deg; give a part of a turn"),
    "a length where an angle belongs": ("planar.toml", FREE + "[[want]]\nkind = 'function'\ny = 'x'\ninput = '0:4mm'\noutput = '0:9'\n", "task.toml: want[1].input: '0mm' is no value of theta_1, which turns"),
    "input turns back": ("planar.toml", FREE + FUNCTION.replace("[40, 35]", "[10, 35]"), "task.toml: want[1]: the input 3 turns back"),
    "more points than numbers": ("planar.toml", FREE + FUNCTION.replace("[40, 35]", "[40, 35], [50, 45]") + "exact = true\n", "task.toml: want[1].exact: 4 conditions are to be met exactly, and 3 numbers are free"),
    "no rotation": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 2\narm = 5\nposes = [{ at = [0, 0, 0], matrix = [[1, 0, 0], [0, 2, 0], [0, 0, 1]] }]\n", "task.toml: want[1].poses[1].matrix: is no rotation: its rows are not of length 1"),
    "a mirror": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 2\narm = 5\nposes = [{ at = [0, 0, 0], matrix = [[1, 0, 0], [0, 1, 0], [0, 0, -1]] }]\n", "task.toml: want[1].poses[1].matrix: is no rotation: it mirrors"),
    "a matrix and an angle": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 2\nposes = [{ at = [0, 0, 0], angle = 3, matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }]\n", "task.toml: want[1].poses[1]: a matrix, and axis or angle"),
    "a pose without a place": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 2\nposes = [{ angle = 3 }]\n", "task.toml: want[1].poses[1].at: is missing"),
    "a pose of the ground": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 4\nposes = [{ at = [0, 0, 0] }]\n", "task.toml: want[1].link: 4 is no moving link; give 1 to 3, link 4 is the ground"),
    "no link": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 0\nposes = [{ at = [0, 0, 0] }]\n", "task.toml: want[1].link: 0 is not a link; give a whole number from 1"),
    "unknown measure": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swinging'\nvalue = 30\n", "task.toml: want[1].name: 'swinging' is not a measure; did you mean 'swing'?"),
    "a word wanted": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'motion_type'\nvalue = 30\n", "task.toml: want[1].name: 'motion_type' is a word, not a number; give limits.motion_type"),
    "torque of nothing": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'peak_torque'\nvalue = 'small'\n", "task.toml: want[1].name: nothing acts on the linkage"),
    "bearing of no joint": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'peak_force:theta'\nvalue = 'small'\n", "task.toml: want[1].name: no joint 'theta'; did you mean 'theta_"),
    "time ratio below 1": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'time_ratio'\nvalue = 0.5\n", "task.toml: want[1].value: 0.5 cannot be: time_ratio is never below 1"),
    "a swing over a turn": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = 400\n", "task.toml: want[1].value: 400 cannot be: swing is never above 360"),
    "two values of a measure": ("planar.toml", FREE + "".join(f"[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = {x}\n" for x in (40, 60)), "task.toml: want[2].name: want 1 wants swing, too, and another value; leave one out"),
    "small and great of a measure": ("planar.toml", FREE + "".join(f"[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = {x!r}\n" for x in ('small', 'great')), "task.toml: want[2].name: want 1 wants swing, too, and another value; leave one out"),
    "no poses given": ("planar.toml", FREE + "[[want]]\nkind = 'poses'\nlink = 2\nposes = []\n", "task.toml: want[1].poses: none given; give tables of at, axis and angle"),
    "a swing at most below 0": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'figure'\nname = 'swing'\nmost = -10\n", "task.toml: must[1].most: -10 cannot be: swing is never below 0"),
    "a swing at least over a turn": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'figure'\nname = 'swing'\nleast = 400\n", "task.toml: must[1].least: 400 cannot be: swing is never above 360"),
    "ends of two musts apart": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'figure'\nname = 'swing'\nleast = 50\n[[must]]\nkind = 'figure'\nname = 'swing'\nmost = 40\n", "task.toml: must[2].name: must 1 wants swing outside these ends"),
    "ranges of two musts apart": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'range'\njoint = 'theta_2'\nrange = '0:10'\n[[must]]\nkind = 'range'\njoint = 'theta_2'\nrange = '380:400'\n", "task.toml: must[2].range: has nothing in common with that of must 1"),
    "readings outside a range": ("planar.toml", FREE + FUNCTION + "input_zero = 0\noutput_zero = 360\n[[must]]\nkind = 'range'\njoint = 'theta_4'\nrange = '100:120'\n", "task.toml: must[1].range: want 1 needs theta_4 outside it"),
    "a swing in mm": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = '3mm'\n", "task.toml: want[1].value: '3mm' does not fit; give 30, 30deg or 0.5rad, or 'small' or 'great'"),
    "a swing made least": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = 'least'\n", "task.toml: want[1].value: 'least' does not fit; give 30, 30deg or 0.5rad, or 'small' or 'great'"),
    "dwell turned round": ("planar.toml", FREE + "[[want]]\nkind = 'dwell'\nrange = '90:20'\n", "task.toml: want[1].range: its first end is not below its second one"),
    "dwell over a turn": ("planar.toml", FREE + "[[want]]\nkind = 'dwell'\nrange = '0:400'\n", "task.toml: want[1].range: goes over 400 deg of the input"),
    "unknown joint": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'range'\njoint = 'theta_9'\nrange = '0:9'\n", "task.toml: must[1].joint: no joint 'theta_9'"),
    "range of a ball": ("drawn.toml", '[free]\n"crank.z" = "-5:5"\n' + FUNCTION + "[[must]]\nkind = 'range'\njoint = 'A'\nrange = '0:9'\n", "task.toml: must[1].joint: joint 'A' is a ball"),
    "cone about a rod on the far side": ("swash_plate", "[free]\nknuckle.x = '50:60'\n[[want]]\nkind = 'dwell'\nrange = '0:20deg'\n[[must]]\nkind = 'cone'\njoint = 'knuckle'\nangle = 15\n", "task.toml: must[1].seat: left out, it goes along the rod, from which knuckle is 137.2 to 169.7 deg off at the start; give"),
    "poses where measures are wanted": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = 60\n[[must]]\nkind = 'range'\njoint = 'theta_3'\nrange = '0:90'\n", "task.toml: must[1]: is about poses, and measures alone are wanted; bound a measure"),
    "bend of a hinge": ("drawn.toml", FREE.replace("length_1", "A.x") + "[[want]]\nkind = 'figure'\nname = 'ball_angle:crank'\nvalue = 'small'\n", "task.toml: want[1].name: 'crank' is not a joint S or U"),
    "a box without the ground": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'box'\nlow = [-200, 10, -200]\nhigh = [200, 200, 80]\n", "task.toml: must[1].names: theta_4 stands still at ("),
    "a box of a linkage anywhere": ("planar.toml", 'placement = "free"\n' + FREE + PATH + "[[must]]\nkind = 'box'\nlow = [-200, -20, -200]\nhigh = [200, 200, 80]\n", "task.toml: must[1]: a box stands in space, and with placement 'free' the linkage may stand"),
    "cone of no ball": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'cone'\njoint = 'theta_1'\nangle = 15\n", "task.toml: must[1].joint: 'theta_1' is not a joint S or U, which a cone is of; this linkage has none"),
    "cone of no joint": ("drawn.toml", '[free]\n"crank.z" = "-5:5"\n' + FUNCTION + "[[must]]\nkind = 'cone'\njoint = 'C'\nangle = 15\n", "task.toml: must[1].joint: no joint 'C'; this linkage has crank, A, B, rocker"),
    "cone too wide": ("drawn.toml", '[free]\n"crank.z" = "-5:5"\n' + FUNCTION + "[[must]]\nkind = 'cone'\njoint = 'A'\nangle = 190\n", "task.toml: must[1].angle: 190 deg is no cone"),
    "empty box": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'box'\nlow = [0, 0, 5]\nhigh = [9, 9, 5]\n", "task.toml: must[1].low: empty along z: 5 is not below 5"),
    "box of nothing": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'box'\nlow = [0, 0, 0]\nhigh = [9, 9, 9]\nnames = ['Q']\n", "task.toml: must[1].names: no point or joint 'Q'; this linkage has P, theta_1"),
    "path outside the box": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'box'\nlow = [-99, 0, -9]\nhigh = [30, 200, 9]\nnames = 'P'\n", "task.toml: must[1].names: place 3 of want 1 lies outside the box"),
    "links that meet": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'apart'\nlinks = [1, 4]\nleast = 5\n", "task.toml: must[1].links: 1 and 4 meet in a joint, so their distance is 0"),
    "no such link": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'apart'\nlinks = [1, 7]\nleast = 5\n", "task.toml: must[1].links: 7 is not a link; give 1 to 4"),
    "no ends of a figure": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'figure'\nname = 'swing'\n", "task.toml: must[1]: has no end; give least, most, or both"),
    "ends turned round": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'figure'\nname = 'swing'\nleast = 50\nmost = 40\n", "task.toml: must[1].least: 50 is above the most, 40"),
    "wanted outside its ends": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = 60\n[[must]]\nkind = 'figure'\nname = 'swing'\nmost = '40deg'\n", "task.toml: must[1].name: want 1 wants it outside these ends"),
    "most of no want": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'most'\nwant = 3\nmost = 1\n", "task.toml: must[1].want: 3 is not a want; give its place, 1 to 1"),
    "most of a figure": ("planar.toml", FREE + "[[want]]\nkind = 'figure'\nname = 'swing'\nvalue = 60\n[[must]]\nkind = 'most'\nwant = 1\nmost = 1\n", "task.toml: must[1].want: is a figure; bound it by a must"),
    "most below 0": ("planar.toml", FREE + PATH + "[[must]]\nkind = 'most'\nwant = 1\nmost = '-1mm'\n", "task.toml: must[1].most: -0.025 is no bound; give a number > 0"),
    "transmission of a Bennett": ("bennett", '[free]\nlength_1 = "40:60"\n' + FUNCTION + "[limits]\ntransmission = 30\n", "task.toml: limits.transmission: no transmission angle is defined from theta_1 to theta_4"),
    "a transmission angle of 100 deg": ("rssr", '[free]\nL1 = "200:300"\n' + FUNCTION + "[limits]\ntransmission = 100\n", "task.toml: limits.transmission: 100 deg is no limit"),
    "unknown motion type": ("planar.toml", FREE + PATH + "[limits]\nmotion_type = 'crank'\n", "task.toml: limits.motion_type: 'crank' is not a motion type; allowed: crank-rocker"),
    "size turned round": ("planar.toml", FREE + PATH + "[limits]\nsize = '90:10'\n", "task.toml: limits.size: 90:10 is no range of lengths"),
    "placed for nothing": ("planar.toml", 'placement = "free"\n' + FREE + FUNCTION, "task.toml: placement: 'free' changes nothing: no path and no poses are wanted"),
    "a twist opens a plane": (
        "planar.toml",
        '[free]\ntwist_1 = "-5:5"\n' + PATH,
        "task.toml: free.twist_1: cannot change alone without opening the loop; leave it out",
    ),
    "a chain that does not close": (
        "apart.toml",
        FREE + PATH,
        "task.toml: linkage: moves nowhere as it is described",
    ),
    "no TOML": ("planar.toml", "[free\n", "task.toml: line 2: '[free' is not valid TOML"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_each_mistake_has_its_place_and_what_to_do(tmp_path, case):
    linkage, body, expected = WRONG[case]
    found = message(tmp_path, body, linkage)
    assert any(line.startswith(expected) or (not expected.startswith("task") and expected in line)
               for line in found.splitlines()), found  # fmt: skip


def test_all_mistakes_come_at_once(tmp_path):
    found = message(
        tmp_path,
        '[free]\nlength_1 = "90:80"\n' + PATH.replace('"P"', '"Q"'),
    )
    assert [line.split(": ")[1] for line in found.splitlines()] == [
        "free.length_1",
        "want[1].point",
    ]


def test_a_file_that_is_none_is_said(tmp_path):
    with pytest.raises(DescriptionError, match="no such file; give the path of a task file"):
        read_task(tmp_path / "none.toml")


def test_every_key_of_a_task_file_is_on_the_page(monkeypatch):
    root = ROOT
    monkeypatch.syspath_prepend(root / "docs" / "_extensions")
    from key_tables import task_keys_of

    page = (root / "docs" / "design-task.md").read_text(encoding="utf-8")
    tables = {f"want_{kind}": form for kind, form in WANTS.items()}
    tables |= {f"must_{kind}": form for kind, form in MUSTS.items()}
    tables |= {"": TaskForm, "limits": LimitsForm, "pose": PoseForm}
    for head, form in tables.items():
        assert f"<!-- made: task_keys{' ' + head if head else ''} -->" in page
        rows = task_keys_of(root, head).splitlines()[2:]
        assert [row.split("`")[1] for row in rows] == list(form.model_fields)


@pytest.mark.parametrize("case", ["nozzle", "pick_place", "steering"])
def test_the_examples_are_tasks(case):
    folder = EXAMPLES / "design"
    task = read_task(folder / f"{case}_task.toml")
    assert task.free
    assert task.wants


def test_the_first_example_of_the_page_is_a_task(tmp_path):
    page = (DOCS / "design-task.md").read_text(encoding="utf-8")
    text = page.split("```toml\n")[1].split("```")[0]
    (tmp_path / "my_task.toml").write_text(text)
    task = read_task(tmp_path / "my_task.toml")
    assert task.names == ("M", "L1")


def test_an_x_that_may_be_in_degrees_is_hinted_at_before_the_search(tmp_path):
    want = "[[want]]\nkind = 'function'\ny = 'sin(x)'\nx = '0:90'\ninput = '0:60deg'\noutput = '0:40deg'\n"
    (tmp_path / "task.toml").write_text("linkage = 'planar_4r'\n" + FREE + want, encoding="utf-8")
    (hint,) = task_file(tmp_path / "task.toml").hints
    assert hint.startswith("want[1].y: sin takes radians; x goes to 90: write sind(x) or x = 0:90deg")
