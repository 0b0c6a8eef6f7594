"""Linkages that are begun in the studio: from a kind, and from the places of joints."""

import tomllib

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.sketch import BEGINNINGS, DrawnJoint, beginning, drawn, kinds_of, of_kind


@pytest.mark.parametrize(
    ("kinds", "wanted"),
    [("RRRR", "crank-rocker"), ("RRRP", "crank-slider"), ("RSSR", "crank-rocker"), ("RSSP", "crank-slider")],
)
def test_every_beginning_turns_fully(kinds, wanted):
    linkage = sb.loads(drawn("Mine", "mm", beginning(kinds_of(kinds))))
    assert linkage.motion().motion_type == wanted
    assert (linkage.name, linkage.kind) == ("Mine", kinds)
    assert set(BEGINNINGS) == {"RRRR", "RRRP", "RSSR", "RSSP"}


def test_the_drawn_four_bar_has_the_lengths_of_its_points():
    linkage = sb.loads(drawn("Mine", "in", beginning(kinds_of("R R R R"))))
    motion = linkage.motion()
    assert linkage.length_unit == "in"
    circuit = motion.circuits[0]
    a, b = (circuit.point(2, at).position for at in ((0, 40, 0), (100, 80, 0)))
    # crank 40 about (0, 0), rocker hypot(10, 80) about (90, 0), coupler hypot(100, 40)
    assert np.allclose(np.linalg.norm(a, axis=1), 40)
    assert np.allclose(np.linalg.norm(b - [90, 0, 0], axis=1), np.hypot(10, 80))
    assert np.allclose(np.linalg.norm(b - a, axis=1), np.hypot(100, 40))
    # Grashof: 40 + 107.7 < 80.6 + 90
    assert motion.motion_type == "crank-rocker"


@pytest.mark.parametrize("words", ["RSSR", "R S S R", "r,s,s,r", " R-S-S-R "])
def test_kinds_are_read_as_people_write_them(words):
    assert kinds_of(words) == ("R", "S", "S", "R")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("R X R", "joints: 'X' is not a kind of joint; give letters of"),
        ("R", "joints: a loop has 2 to 12 joints, not 1"),
        ("", "joints: a loop has 2 to 12 joints, not 0"),
        ("R" * 13, "joints: a loop has 2 to 12 joints, not 13"),
    ],
)
def test_what_are_no_kinds_is_refused(words, message):
    with pytest.raises(RequestError) as refused:
        kinds_of(words)
    assert str(refused.value).startswith(message)


@pytest.mark.parametrize(
    "words", ["RR", "RRRRR", "RRRRRRR", "RCCC", "RHRR", "RUSR", "RPUS", "REES", "R" * 12]
)
def test_joints_of_any_kinds_are_a_description_whether_they_move_or_not(words):
    joints = beginning(kinds_of(words))
    linkage = sb.loads(drawn("Any", "mm", joints))
    assert linkage.kind == words
    session = Session(drawn("Any", "mm", joints), "Any")
    assert bool(session.problem) != (session.view is not None)


def test_the_7r_as_laid_out_moves():
    assert len(sb.loads(drawn("Any", "mm", beginning(kinds_of("R" * 7)))).motion().circuits) > 0


def test_joints_that_were_written_stay_when_others_are_added():
    mine = (DrawnJoint("R", (1, 2, 3), name="mine"), DrawnJoint("S", (4, 5, 6)), DrawnJoint("R", (7, 8, 9)))
    found = beginning(kinds_of("RCRRR"), mine)
    assert found[0] == mine[0]
    assert found[1].kind == "C"
    assert found[2] == mine[2]


def test_what_is_drawn_is_an_ordinary_file_with_plain_numbers():
    text = drawn("Mine", "mm", beginning(kinds_of("RHUS")))
    raw = tomllib.loads(text)
    assert raw["joint"][1]["pitch"] == 10
    assert len(raw["joint"][2]["axes"]) == 2
    assert "axis" not in raw["joint"][3]
    assert raw["joint"][0]["at"] == [0, 0, 0]
    assert "[[joint]]" in text
    assert ".0]" not in drawn("Mine", "mm", beginning(kinds_of("RRRR")))


def test_what_cannot_be_drawn_says_where_and_why():
    joints = list(beginning(kinds_of("RRRR")))
    joints[1] = DrawnJoint("R", (0, 40, 0), axes=((0, 0, 0), (0, 1, 0)))
    with pytest.raises(DescriptionError, match=r"Mine: joint\[2\].axis"):
        drawn("Mine", "mm", joints)
    with pytest.raises(RequestError, match="name: missing"):
        drawn("  ", "mm", joints)


def test_a_new_linkage_of_a_kind_has_its_dimensions_and_a_name_of_its_own():
    linkage = sb.loads(of_kind("Mine", "planar_4r"))
    assert linkage.name == "Mine"
    assert linkage.motion().motion_type == sb.load("planar_4r").motion().motion_type
    assert "Freudenstein" not in of_kind("Mine", "planar_4r")
