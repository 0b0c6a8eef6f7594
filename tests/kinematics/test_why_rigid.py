"""Why a loop is rigid: what is off, by how much, and how it would move if it were not.

Source: geometry alone. A joint of a loop that moves is tilted or shifted by a known amount, which is named, and the motion
is that of the loop before.
"""

import io
import json
import math

import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from command_runs import sevenbar
from double_constraint import DOUBLE, Z, named
from sevenbar.kinematics.loop.no_length import no_length
from sevenbar.reporting.report import as_dict, text
from sevenbar.text.words import language
from textbook_loops import four_bar_joints, linkage, rewritten, slider_crank_joints, spherical_joints


def told(motion):
    console = Console(file=io.StringIO(), width=400)
    console.print(text(motion))
    return " ".join(console.file.getvalue().split())


TILTED = named(
    [("R", (0, 0, 0), Z), ("R", (40, 0, 0), Z), ("R", (120, 70, 0), (0, 0.02, 1)), ("R", (90, 0, 0), Z)]
)
TILT = math.atan(0.02)


def test_a_tilted_axis_is_named_with_its_angle_and_the_motion_without_it():
    motion = linkage(TILTED).motion(24)
    assert motion.motion_type == "rigid"
    reason = motion.reason
    assert (reason.common, reason.joints, reason.motion_type) == ("plane", ("a", "b", "d"), "crank-rocker")
    ((off),) = reason.off
    assert (off.joint, off.what) == ("c", "axis")
    assert off.by == pytest.approx(TILT, rel=1e-9)
    assert (
        "the axes of a, b and d are parallel, but that of c is 1.15 deg off; "
        "without that it would move as a crank-rocker"
    ) in told(motion)
    plain = as_dict(motion)["reason"]
    assert plain["off"][0]["joint"] == "c"
    json.dumps(plain)


def test_it_is_named_however_the_loop_is_written():
    for way, _, joints in rewritten(TILTED):
        motion = linkage(joints).motion(24)
        assert motion.motion_type == "rigid", way
        assert motion.reason.off[0].joint == "c", way
        assert motion.reason.off[0].by == pytest.approx(TILT, rel=1e-8), way
        assert set(motion.reason.motion_type.split("-")) <= {"crank", "rocker", "double"}, way


@pytest.mark.parametrize("exponent", range(-8, 1))
def test_a_tilt_of_any_size_is_named(exponent):
    joints = [dict(joint) for joint in TILTED]
    joints[2]["axis"] = [0, 10.0**exponent, 1]
    reason = linkage(joints).motion(24).reason
    assert reason.off[0].by == pytest.approx(math.atan(10.0**exponent), rel=1e-6)


def test_axes_that_are_all_out_a_little_are_all_named():
    joints = [dict(joint) for joint in TILTED]
    joints[1]["axis"] = [0.01, 0, 1]
    motion = linkage(joints).motion(24)
    assert [off.joint for off in motion.reason.off] == ["b", "c"]
    joints[3]["axis"] = [0, 0.01, 1]
    reason = linkage(joints).motion(24).reason
    assert (len(reason.joints), len(reason.off)) == (1, 3)
    assert "the axes are parallel to that of" in told(linkage(joints).motion(24))


def test_a_slide_along_the_axes_is_named_and_has_no_motion_without_that():
    joints = slider_crank_joints(40, 120)
    joints[3]["axis"] = Z
    for _, _, written in rewritten(joints):
        motion = linkage(written).motion(24)
        assert motion.motion_type == "rigid"
        ((off),) = motion.reason.off
        assert (off.joint, off.what, motion.reason.motion_type) == ("slider", "slide", None)
        assert off.by == pytest.approx(math.pi / 2)
    assert (
        "the axes of crank, crank_pin and wrist are parallel, but the slide of slider is 90 deg off the plane "
        "square to them"
    ) in told(linkage(joints).motion(24))


@pytest.mark.parametrize(("slide", "moves"), [("P", "crank-slider"), ("C", "crank-rocker")])
def test_a_slide_that_leaves_the_plane_a_little_is_named(slide, moves):
    # of a cylinder its turn is read, which stays at rest
    joints = slider_crank_joints(40, 120, 10, slide=slide)
    joints[3]["axis"] = [1, 0, 0.02]
    reason = linkage(joints).motion(24).reason
    assert (reason.off[0].joint, reason.off[0].what, reason.motion_type) == (
        "slider",
        "slide",
        moves,
    )
    assert reason.off[0].by == pytest.approx(TILT)


def test_an_axis_that_misses_the_point_of_the_others_is_named_with_its_distance():
    joints = spherical_joints(*map(math.radians, (30, 80, 70, 85)), radius=50.0)
    axis = np.array(joints[1]["axis"])
    aside = np.cross(axis, [0, 0, 1])
    joints[1]["at"] = (np.array(joints[1]["at"]) + 0.02 * aside / np.linalg.norm(aside)).tolist()
    for way, scale, written in rewritten(joints):
        motion = linkage(written).motion(24)
        assert motion.motion_type == "rigid", way
        assert (motion.reason.common, motion.reason.off[0].joint) == ("point", "coupler_pin"), way
        assert motion.reason.off[0].by == pytest.approx(0.02 * scale, rel=1e-6), way
        assert motion.reason.motion_type is not None
    said = told(linkage(joints).motion(24))
    assert (
        "the axes of crank, rocker_pin and rocker go through one point, but that of coupler_pin passes it at"
        in said
    )
    assert "0.02 mm; without that it would move as a crank-rocker" in said


def test_what_is_another_kind_of_linkage_has_no_such_reason():
    rng = np.random.default_rng(3)
    for _ in range(8):
        joints = [
            {"kind": "R", "at": rng.normal(size=3).tolist(), "axis": rng.normal(size=3).tolist()}
            for _ in range(4)
        ]
        motion = linkage(joints).motion(24)
        assert (motion.motion_type, motion.reason) == ("rigid", None)
    triangle = four_bar_joints(40, 100, 80, 90)[:3]
    assert linkage(triangle).motion(24).reason is None
    for name in ("planar_4r", "bennett", "rssr", "seven_r"):
        assert sb.load(name).motion(24).reason is None


TRIANGLE = named([("R", (0, 0, 0), Z), ("R", (0, 0, 0), Z), ("R", (2, 0, 0), Z), ("R", (3, 1, 0), Z)])


def test_two_joints_on_one_axis_are_named_from_every_joint_and_have_no_class():
    for way, _, joints in rewritten(TRIANGLE):
        found = linkage(joints)
        motion = found.motion(24)
        assert motion.four_bar is None, way
        assert (motion.reason.common, set(motion.reason.joints)) == ("one-axis", {"a", "b"}), way
        # with the ground between them the others turn as one body
        names = [joint["name"] for joint in joints]
        grounded = {names[0], names[-1]} == {"a", "b"}
        assert (motion.motion_type == "rigid") != grounded, way
        assert grounded or [found.motion(24, input=name).motion_type for name in names] == ["rigid"] * 4, way
    said = told(linkage(TRIANGLE).motion(24))
    assert "closing it removes all of its 3 freedoms that are not idle" in said
    assert "a and b are on one axis: link 1 has length 0 between them" in said
    assert "turn fully" not in said
    assert "the ground has length 0 between them" in told(linkage(TRIANGLE[1:] + TRIANGLE[:1]).motion(24))


def test_a_link_without_length_in_a_loop_that_moves_is_named_too():
    five = [*four_bar_joints(40, 100, 80, 90), {"name": "again", "kind": "R", "at": [90, 0, 0], "axis": Z}]
    motion = linkage(five).motion(24)
    assert motion.motion_type == "crank-rocker"
    assert set(motion.reason.joints) == {"rocker", "again"}
    with pytest.raises(
        sb.errors.RequestError, match=r"^input: joint 'rocker' has no freedom that drives the loop"
    ):
        linkage(five).motion(24, input="rocker")
    with pytest.raises(
        sb.errors.RequestError, match=r"^output: joint 'rocker' has no freedom that the input moves"
    ):
        linkage(five).motion(24, output="rocker")


#: A ball on the axis of a cylinder, as far out as it comes: rigid but for the spin of the link between.
SPINS = named(
    [
        ("R", (1, -1, -1), Z),
        ("S", (2, -1, 1), None),
        ("C", (2, -2, 1), (0, 1, 0)),
        ("R", (0, -2, -1), (1, 0, 0)),
    ]
)


def test_a_ball_on_the_axis_of_a_cylinder_spins_idly_from_every_end():
    for way, _, joints in rewritten(SPINS):
        motion = linkage(joints).motion(24)
        if {joints[0]["name"], joints[-1]["name"]} == {"b", "c"}:
            # the ground does not spin: all others do, about it
            assert (motion.idle, motion.mobility.finite) == ((), 1), way
            continue
        assert (motion.motion_type, motion.mobility.finite) == ("rigid", 0), way
        (spin,) = motion.idle
        assert spin.endswith("about the axis of c, on which b lies"), way


def test_idle_freedoms_are_seen_through_a_joint_that_they_do_not_move():
    ball, turn, slide = ((0, 0, 3), None), ((0, 0, 1), Z), ((0, 0, 2), Z)
    ways = {
        "ball": (
            [("R", *turn), ("P", *slide), ("S", *ball)],
            "spin of links 2 and 3 together about the axis of b",
        ),
        "turns": ([("R", *turn), ("P", *slide), ("R", (0, 0, 4), Z)], "turn of links 2 and 3 together about"),
        "slides": (
            [("P", *slide), ("R", *turn), ("P", (5, 5, 5), Z)],
            "slide of links 2 and 3 together along",
        ),
    }
    rng = np.random.default_rng(2)
    for three, words in ways.values():
        rest = [("R", rng.normal(size=3).tolist(), rng.normal(size=3).tolist()) for _ in range(3)]
        for order in (three, three[::-1]):
            found = linkage(named([rest[0], *order, *rest[1:]]))
            (idle,) = found.idle
            assert idle.startswith(words[:30]), idle
            assert found.idle_links == {2, 3}


def test_a_constraint_that_is_met_twice_over_leaves_one_freedom_from_every_end():
    for joints in (DOUBLE, DOUBLE[::-1], [joint for _, _, joint in rewritten(DOUBLE)][1]):
        motion = linkage(joints).motion(24)
        found = (motion.motion_type, motion.mobility.finite, len(motion.circuits))
        assert found == ("double-rocker", 1, 1)
        assert "a constraint is met twice over along the circuits" in told(motion)


def test_what_moves_with_two_freedoms_says_what_to_do():
    follower = named(
        [
            ("R", (0, 0, 0), Z),
            ("R", (1, 0, 0), Z),
            ("P", (2.418, 2.456, 0), (1.5, 2.598, 0)),
            ("R", (2.418, 2.456, 0), Z),
            ("R", (2, 0.5, 0), Z),
        ]
    )
    motion = linkage(follower).motion(24)
    assert motion.motion_type == "two-inputs"
    assert (
        "where another loop moves it by two of its joints, write both as one linkage with links by name"
        in told(motion)
    )


#: An arm of six turning joints: lengths, twists, offsets.
ARM = [(0, -90, 400), (400, 0, 0), (25, -90, 0), (0, 90, 420), (0, -90, 0), (0, 0, 80)]


def arm_rows(*, last_length):
    length, twist, offset = zip(*ARM, strict=True)
    rows = [f"{x} deg" for x in twist]
    return sb.from_dh("R" * 6, length=[*length[:-1], last_length], twist=rows, offset=list(offset))


def test_the_table_of_an_arm_says_how_it_is_closed_and_that_gives_its_postures():
    motion = arm_rows(last_length=5000).motion(24)
    assert motion.motion_type == "cannot-assemble"
    assert "the table of an open arm wants one joint more, at the hand, as the input" in told(motion)
    frame, joints = np.eye(4), []
    values = (0.3, -0.7, 0.4, 0.5, 0.6, 0.2)
    for (length, twist, offset), value in zip(ARM, values, strict=True):
        joints.append(("R", frame[:3, 3].tolist(), frame[:3, 2].tolist()))
        c, s, ca, sa = (
            math.cos(value),
            math.sin(value),
            math.cos(math.radians(twist)),
            math.sin(math.radians(twist)),
        )
        row = [
            [c, -s * ca, s * sa, length * c],
            [s, c * ca, -c * sa, length * s],
            [0, sa, ca, offset],
            [0, 0, 0, 1],
        ]
        frame = frame @ np.array(row)
    hand = ("R", frame[:3, 3].tolist(), frame[:3, 0].tolist())
    modes = linkage(named([*joints, hand])).assembly_modes(0.0, input="g")
    assert len(modes) == 8
    assert np.abs(modes.q).max(axis=1).min() < 1e-9


def test_reasons_are_in_chinese_and_in_json(tmp_path):
    for joints in (TILTED, TRIANGLE, DOUBLE):
        motion = linkage(joints).motion(24)
        with language("zh"):
            said = sb.report.markdown(motion)
        assert not any(word in said for word in ("parallel", "axis", "freedom", "length"))
    file = tmp_path / "tilted.toml"
    rows = "\n".join(
        f'[[joint]]\nname = "{j["name"]}"\nkind = "R"\nat = {j["at"]}\naxis = {j["axis"]}' for j in TILTED
    )
    file.write_text(f"format = 1\n{rows}\n")
    found = json.loads(sevenbar("analyze", file, "--json").stdout)["reason"]
    assert (found["common"], found["joints"], found["motion_type"]) == (
        "plane",
        ["a", "b", "d"],
        "crank-rocker",
    )


def test_links_of_a_net_that_share_a_pin_have_their_length():
    for name in ("jansen", "peaucellier"):
        assert no_length(sb.load(name)) is None
    # a link whose two joints are one pin has none
    pins = [
        {"at": at, "links": links.split()}
        for at, links in [
            ((0, 0), "frame crank"), ((0, 0), "crank coupler"), ((9, 7), "coupler rocker"), ((10, 0), "rocker frame"),
            ((12, 6), "rocker link"), ((20, 7), "link lever"), ((20, 0), "lever frame"),
        ]
    ]  # fmt: skip
    assert no_length(sb.from_pins(pins, ground="frame")).joints == ("pin_1", "pin_2")
