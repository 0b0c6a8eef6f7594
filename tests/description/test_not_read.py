"""What is not covered is refused by name, and files of other programs say what they are."""

import math

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.errors import DescriptionError, TableError

JOINT = '[[joint]]\nkind = "{kind}"\nat = [{x}, 0, 0]\naxis = [0, 0, 1]\n{more}\n'


def file_of(*joints, more=""):
    rows = "".join(JOINT.format(kind=kind, x=x, more=own) for x, (kind, own) in enumerate(joints))
    return f"format = 1\n{rows}{more}"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (file_of(("R", 'links = ["ground", "crank"]'), ("R", "")), "joint[1].links: a file has one loop"),
        (file_of(("R", ""), ("R", 'parent = "crank"')), "joint[2].parent: a file has one loop"),
        ("format = 1\n[[loop]]\na = 1\n[[loop]]\na = 1\n", "loop: a file has one loop"),
        (file_of(("R", ""), ("R", ""), more="[[loop]]\na = 1\n"), "loop: a file has one loop"),
        (file_of(("gear", ""), ("R", "")), "joint[1].kind: 'gear' is not a joint kind: gears are not covered"),
        (file_of(("cam", ""), ("R", "")), "cams are not covered"),
        (file_of(("R", ""), more="[[friction]]\nmu = 0.1\n"), "friction: friction is not covered"),
        (file_of(("R", ""), more="[[belt]]\na = 1\n"), "belt: belts are not covered"),
        ("format = 1\n[joint]\nkind = 'R'\n[joint]\nkind = 'R'\n", "'[joint]' stands twice; write [[joint]] before"),
        ("format = 1\n[rssr]\nM = 1\n[rssr]\nM = 1\n", "'[rssr]' stands twice; leave one of them out"),
        ('{"format": 1}', "line 1: JSON cannot be read; write TOML"),
    ],
)  # fmt: skip
def test_what_is_not_covered_is_named(text, says, tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(DescriptionError) as caught:
        sb.load(file)
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("arm.urdf", b'<?xml version="1.0"?>\n<robot name="a"/>', "URDF cannot be read; write the joints"),
        ("arm.xml", b"<mujoco/>", "XML (MJCF, Simscape) cannot be read"),
        ("arm.txt", b"<sdf version='1.7'/>", "SDF cannot be read"),
        ("arm.FCStd", b"PK\x03\x04..", "a FreeCAD file cannot be read"),
    ],
)
def test_files_of_other_programs_say_what_they_are(name, content, says, tmp_path):
    file = tmp_path / name
    file.write_bytes(content)
    assert says in mistake("analyze", str(file))


@pytest.mark.parametrize("code", ["utf-16", "utf-16-le", "utf-16-be"])
def test_wide_text_is_read_with_and_without_its_mark(code, tmp_path):
    file = tmp_path / "wide.toml"
    file.write_bytes(sb.gallery.text("rssr").encode(code))
    assert sb.load(file).kind == "RSSR"


def test_the_output_of_one_loop_is_the_law_of_the_next(tmp_path):
    first = sb.load("planar_4r")
    sb.report.write(first.motion(), tmp_path / "one")
    table = tmp_path / "one" / "motion.csv"
    second = sb.load("rssr")
    with pytest.raises(TableError, match=r"has rows of circuits 0, 1; say which, as in --law-circuit 0"):
        sb.load_law(table, second)
    with pytest.raises(TableError, match=r"may each be the angle; .* as in --law-joint theta_1"):
        sb.load_law(table, second, circuit=0)
    law = sb.load_law(table, second, circuit=1, joint="theta_4")
    own = first.motion()[1]
    assert np.allclose(law.q, own["theta_4"])
    assert np.allclose(law.dq, own.dq[:, 3])
    said = sevenbar(
        "analyze", "rssr", "--law", str(table), "--law-circuit", "1", "--law-joint", "theta_4"
    ).stdout
    assert "360 rows" in said


def test_angles_of_a_law_with_rates_count_on_past_a_turn(tmp_path):
    table = tmp_path / "law.csv"
    rows = [f"{k},{(k * 30 + 180) % 360 - 180},30,0,0" for k in range(20)]
    table.write_text("\n".join(["time [s],crank [deg],crank [deg/s],crank [deg/s^2],crank [deg/s^3]", *rows]))
    law = sb.load_law(table, sb.load("rssr"))
    assert np.allclose(law.q, np.arange(20) * math.radians(30))


def test_options_of_a_law_need_one():
    assert mistake("analyze", "rssr", "--law-circuit", "1") == (
        "--law-circuit: there is no table of a law; give --law, too"
    )
