"""`sevenbar design exact`: the columns of a table say what is asked, and all answers are printed and written."""

import json
import math

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar

#: Five poses on a line: four real dyads, one of them a slider.
ON_A_LINE = "x [cm],y [cm],turn_z [rad]\n" + "".join(f"{10 * i},0,{0.2 * i}\n" for i in range(5))

IN_SPACE = """x [mm],y [mm],z [mm],turn_x [deg],turn_y [deg],turn_z [deg]
0,0,0,0,0,0
10,4,2,10,5,20
15,9,8,25,5,40
22,8,9,40,-5,60
30,5,20,60,-20,80
"""

PAIRS = "input [deg],output [deg]\n0,0\n20,5\n40,18\n60,38\n80,61\n"


@pytest.fixture
def table(tmp_path):
    def write(text, rows=None):
        path = tmp_path / "asked.csv"
        path.write_text("".join(text.splitlines(keepends=True)[: None if rows is None else rows + 1]))
        return path

    return write


def test_poses_in_a_plane_are_taken_by_every_pair_of_dyads(table, tmp_path):
    done = sevenbar("design", "exact", table(ON_A_LINE), "--out", tmp_path / "out")
    assert "4 of 4 dyads" in done.stdout
    assert "(0, 0) along (-1, 0)" in done.stdout
    assert "[cm]" in done.stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert [row["defect"] for row in summary["designs"]] == ["none"] * 8 + ["circuit"] * 4
    first = sb.load(tmp_path / "out" / "design_1.toml")
    assert first.length_unit == "cm"
    # link 2 takes the poses on one circuit: rows stand about 1 cm apart
    far = [
        max(np.linalg.norm(circuit.point("body").position - (10 * i, 0, 0), axis=1).min() for i in range(5))
        for circuit in first.motion(720).circuits
    ]
    assert min(far) < 1.0


THREE_POSES = "x [mm],y [mm],turn_z [rad]\n0,0,0\n4,1,0.4\n7,4,0.9\n"


@pytest.mark.parametrize(
    "given",
    [
        ["--moving", "-1,0", "--moving", "2,1"],
        ["--moving=-1,0", "--moving=0.2cm,1 mm"],
        ["--moving", "-1, 0", "--moving", "2, 1"],
    ],
)
def test_the_moving_pivots_of_three_poses_are_those_that_are_given(table, given):
    done = sevenbar("design", "exact", table(THREE_POSES), *given, "--json")
    assert done.returncode == 0, done.stderr
    expected = sb.design.exact.planar_poses([(0, 0, 0), (4, 1, 0.4), (7, 4, 0.9)], moving=[(-1, 0), (2, 1)])
    found = json.loads(done.stdout)["dyads"]
    assert [dyad["link"]["at"][:2] for dyad in found] == [pytest.approx([-1, 0]), pytest.approx([2, 1])]
    grounds = [one.ground.at for one in expected.dyads]
    assert [dyad["ground"]["at"] for dyad in found] == [pytest.approx(at) for at in grounds]
    assert "(-1, 0)" in sevenbar("design", "exact", table(THREE_POSES), *given).stdout


def test_moving_pivots_that_do_not_fit_are_refused(table):
    for given, says in (
        (["-1,0"], "moving: [[-1.0, 0.0]] are no pivots; give two or more places x, y in the first pose"),
        (["-1,0,0", "1,0"], "--moving: '-1,0,0' is not a pivot; give x and y, as in -1,0 or 5mm,2cm"),
        (["a,b", "1,0"], "--moving: 'a,b' is not a pivot; give x and y, as in -1,0 or 5mm,2cm"),
    ):
        words = [word for pivot in given for word in ("--moving", pivot)]
        assert mistake("design", "exact", table(THREE_POSES), *words) == says
    five = mistake("design", "exact", table(ON_A_LINE), "--moving", "1,0", "--moving", "2,0")
    assert five == "moving: with 5 poses the pivots are not free; leave them out"
    pairs = mistake("design", "exact", table(PAIRS), "--moving", "1,0")
    assert pairs == "--moving: is for poses in a plane or orientations; the table has pairs of angles"


def test_the_moving_axes_of_three_orientations_are_those_that_are_given(table):
    text = "turn_x [deg],turn_y [deg],turn_z [deg]\n0,0,0\n10,5,20\n25,5,40\n"
    done = sevenbar("design", "exact", table(text), "--moving", "0,0,1", "--moving", "1,0,1")
    assert done.returncode == 0, done.stderr
    wrong = mistake("design", "exact", table(text), "--moving", "0,1", "--moving", "1,0,1")
    assert wrong == "--moving: '0,1' is not an axis; give x,y,z, as in 0,0,1"


@pytest.mark.parametrize(
    ("text", "rows", "options", "expected"),
    [
        (IN_SPACE, 5, [], "CCCC"),
        (IN_SPACE, 3, [], "Bennett"),
        (IN_SPACE, 3, ["--linkage", "rccc", "--samples", "3"], "RCCC"),
        (PAIRS, 5, ["--samples", "4", "--seed", "1"], "RSSR"),
        (PAIRS, 5, ["--twist", "90deg", "--zeros", "30deg,90deg"], "RSSR"),
    ],
)
def test_the_columns_say_which_linkages(table, text, rows, options, expected):
    found = json.loads(sevenbar("design", "exact", table(text, rows), *options, "--json").stdout)
    assert found["designs"]
    assert all(expected in row["name"] for row in found["designs"])
    assert max(row["closure_error"] for row in found["designs"]) < 1e-12


def test_orientations_alone_are_those_of_a_spherical_four_bar(table):
    text = "\n".join(line.split(",", 3)[3] for line in IN_SPACE.splitlines()) + "\n"
    found = json.loads(sevenbar("design", "exact", table(text), "--json").stdout)
    assert (found["found"], found["theory"]) == (6, 6)
    assert [dyad["joints"] for dyad in found["dyads"]] == ["RR"] * found["real"]


def test_pairs_are_read_by_the_linkage_that_is_written(table, tmp_path):
    out = tmp_path / "out"
    sevenbar("design", "exact", table(PAIRS), "--twist", "90deg", "--zeros", "30deg,90deg", "--out", out)
    linkage = sb.load(out / "design_1.toml")
    crank = np.radians([30.0, 50, 70, 90, 110])
    rocker = np.radians([90.0, 95, 108, 128, 151])
    off = np.angle(np.exp(1j * (linkage.output(crank).position - rocker)))
    assert np.abs(off).max(axis=1).min() < math.radians(1e-9)


@pytest.mark.parametrize(
    ("text", "rows", "options", "words"),
    [
        (
            PAIRS,
            5,
            ["--linkage", "planar"],
            "takes poses in a plane, and the table has pairs of angles; give rssr",
        ),
        (IN_SPACE, 3, ["--linkage", "bricard"], "'bricard' is not known here"),
        (IN_SPACE, 4, [], "poses: 4 in space are given; give 3 (bennett, rccc) or 5 (cccc)"),
        (IN_SPACE, 3, ["--twist", "90deg"], "twist: has no say for linkage bennett; leave it out"),
        (PAIRS, 5, ["--zeros", "30"], "--zeros: '30' is not two angles"),
        (PAIRS, 2, [], "3 to 8"),
        ("x [mm],y [mm]\n1,2\n3,4\n5,6\n", 3, [], "neither pairs of angles nor poses"),
        ("a,b\n1,2\n3,4\n5,6\n", 3, [], "has no unit"),
        (ON_A_LINE.replace("20,0", "20,?"), 5, [], "line 4, column 'y [cm]'"),
    ],
)
def test_a_table_that_asks_for_nothing_is_refused(table, text, rows, options, words):
    message = mistake("design", "exact", table(text, rows), *options)
    assert words in message
