"""`sevenbar design path` as a person calls it: files, messages, and the page that shows it."""

import contextlib
import io
import json
import re

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import ROOT
from sevenbar.description.draft import Draft
from sevenbar.design.curve_table import read_curve
from sevenbar.errors import TableError

PAGE = (ROOT / "docs" / "path.md").read_text(encoding="utf-8")

LINKAGE = sb.load("planar_4r")
CIRCUIT = LINKAGE.motion(12).circuits[0]
PATH = CIRCUIT.point(2, (0.0, -60.0, 30.0)).position


def table(folder, head="x [mm],y [mm],z [mm]", rows=PATH, scale=1.0):
    file = folder / "wanted.csv"
    lines = [",".join(f"{value * scale:.17g}" for value in row) for row in rows]
    file.write_text("\n".join([head, *lines]) + "\n")
    return file


ASKED = ("--link", 2, "--at", "0,-55,35", "--vary", "P.*", "--designs", 1, "--starts", 0)


def test_a_design_is_written_opens_and_makes_the_path(tmp_path):
    out = tmp_path / "found"
    run = sevenbar("design", "path", "planar_4r", "--path", table(tmp_path), *ASKED, "--out", out)
    assert run.returncode == 0, run.stderr
    names = sorted(file.name for file in out.iterdir())
    assert names == ["design_1.png", "design_1.toml", "summary.csv", "summary.json"]
    opened = Draft.of((out / "design_1.toml").read_text(), "design_1.toml").linkage
    point = opened.points[-1]
    law = sb.Law.of(
        np.arange(12), json.loads((out / "summary.json").read_text())["designs"][0]["inputs"], 1.0, 0.0
    )
    off = [np.abs(c.point(point.link, point.at).position - PATH).max() for c in opened.motion(law=law)]
    assert min(off) < 1e-8
    told = json.loads((out / "summary.json").read_text())
    assert told["designs"][0]["error_greatest_mm"] < 1e-8
    # a second call replaces nothing
    again = mistake("design", "path", "planar_4r", "--path", table(tmp_path), *ASKED, "--out", out)
    assert "exists already; give another path, or --force to replace it" in again


@pytest.mark.parametrize(
    ("more", "told"),
    [
        (("--point", "Z"), "point: no point 'Z'; this linkage has none"),
        ((), "--point: missing; the file names none, so add one to it, or a place on a link, as in --link"),
        (("--link", 2), "--at: missing; give --point NAME, or --link with --at"),
        (("--link", 2, "--at", "1,2"), "--at: '1,2' is not a place; give three numbers"),
        (("--link", 4, "--at", "1,2,3"), "point: 4 is not a moving link; give 1 to 3, link 4 is the ground"),
        (
            (*ASKED, "--bound", "length_1"),
            "--bound: 'length_1' is not bounds of a dimension; give the two ends",
        ),
        ((*ASKED, "--bound", "L1=1:2", "--bound", "L1=1:3"), "--bound: 'L1' is given twice; leave one out"),
        ((*ASKED, "--bound", "length_1=1"), "--bound: length_1 has no bounds of a dimension; give the two"),
        ((*ASKED, "--bound", "length_1=1:2"), "bounds: 'length_1' is not a dimension that varies"),
        ((*ASKED, "--bound", "P.v=1:2"), "bounds: P.v begins at -55 mm, outside 1:2"),
        ((*ASKED, "--vary", "twist_1"), "vary: twist_1 cannot change alone without opening the loop"),
        ((*ASKED, "--phase"), "--phase: inputs have no say without --timing"),
        ((*ASKED, "--timing"), "has no column for the input 'theta_1'; add one, or leave --timing out"),
        ((*ASKED, "--bound", "P.v=1cm:2cm"), "bounds: P.v begins at -55 mm, outside 10:20"),
        (
            (*ASKED, "--bound", "P.v=1deg:2"),
            "bounds: '1deg:2' of P.v are no bounds; give the least and the greatest",
        ),
        ((*ASKED, "--size", "9"), "--size: '9' is not a range; give two values, as in 50:1000 or 5cm:1m"),
        ((*ASKED, "--vary", "length_*", "--size", "1:2cm"), "20; give other limits, or another start"),
        ((*ASKED, "--transmission", "40deg"), "transmission: its angle is that of an RSSR"),
        ((*ASKED, "--motion-type", "crank"), "motion type: 'crank' is not offered"),
        ((*ASKED[:-4], "--starts", 0, "--designs", 0), "designs: 0 is not a count; give 1 to 50"),
        ((*ASKED, "--figures", "png"), "--figures: a folder for them is missing"),
    ],
)
def test_a_mistake_is_one_message_and_nothing_is_written(tmp_path, more, told):
    file = table(tmp_path)
    message = mistake("design", "path", "planar_4r", "--path", file, *more)
    assert told in message
    assert "\n" not in message
    assert list(tmp_path.iterdir()) == [file]


def test_tables_of_every_naming_hold_the_same_points(tmp_path):
    inputs = np.degrees(CIRCUIT.input)[:, None]
    for head, rows, scale in (
        ("x [mm],y [mm],z [mm]", PATH, 1.0),
        ("x_cm,y_cm,z_cm", PATH, 0.1),
        ("P_x_mm,P_y_mm,P_z_mm,P_vx_mm_s", np.column_stack([PATH, PATH[:, 0]]), 1.0),
        ("theta_1 [deg],P_x [m],P_y [m],P_z [m]", np.column_stack([inputs * 1e3, PATH]), 1e-3),
    ):
        timed = head.startswith("theta")
        points, read = read_curve(table(tmp_path, head, rows, scale), LINKAGE, "theta_1", point="P")
        assert points == pytest.approx(PATH, abs=1e-11)
        if timed:
            assert read == pytest.approx(CIRCUIT.input, abs=1e-12)
        else:
            assert read is None
    flat, _ = read_curve(table(tmp_path, "x_mm,y_mm", PATH[:, :2]), LINKAGE, "theta_1")
    assert flat[:, 2].tolist() == [0.0] * 12


@pytest.mark.parametrize(
    ("head", "told"),
    [
        ("x,y,z", "column 'x': has no unit; write it as in 'x [mm]'"),
        ("x [deg],y [mm],z [mm]", "column 'x [deg]': 'deg' is not a unit of the x; give one like mm"),
        ("a [mm],b [mm],c [mm]", "no column for x; the columns are 'a [mm]', 'b [mm]', 'c [mm]'"),
        ("Q x [mm],R x [mm],y [mm]", "line 1: 'Q x [mm]' and 'R x [mm]' both hold x"),
        ("", "has no header, so the unit of its numbers is not known"),
    ],
)
def test_a_table_without_units_or_names_is_told_of(tmp_path, head, told):
    with pytest.raises(TableError, match=re.escape(told)):
        read_curve(table(tmp_path, head), LINKAGE, "theta_1")


def test_a_gap_in_a_table_is_told_with_its_line(tmp_path):
    rows = PATH.copy()
    rows[3, 1] = np.nan
    with pytest.raises(TableError, match=r"line 5: no number in column 'y \[mm\]'"):
        read_curve(table(tmp_path, rows=rows), LINKAGE, "theta_1")


def test_the_example_of_the_page_prints_what_its_comment_says():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    assert printed.getvalue().splitlines() == re.findall(r"print\(.*\)  # (.*)", code)


def test_what_the_page_prints_is_what_its_command_prints_today(tmp_path):
    commands = re.findall(r"^    \$ sevenbar (.*)$", PAGE, flags=re.MULTILINE)
    assert len(commands) == 1
    # errors at the last decimals of the table
    rounding = re.compile(r"\d\.\d+e-\d+")
    shown = re.sub(r" +", " ", rounding.sub("~", PAGE))
    run = sevenbar(*commands[0].replace("DIR", str(tmp_path / "found")).replace("'", "").split(), cwd=ROOT)
    assert run.returncode == 0, run.stderr
    for line in run.stdout.partition("\nwritten:")[0].splitlines():
        told = re.sub(r" +", " ", rounding.sub("~", line)).strip()
        assert not told.strip("─") or f" {told}\n" in shown, line
