"""Grashof's rule against the motions that the loops have: planar and spherical four-bars, slider-cranks."""

import math
from itertools import product
from math import pi, radians

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.kinematics.solvers.four_bar import four_bar_of
from textbook_loops import (
    four_bar_joints,
    linkage,
    moved,
    rewritten,
    rotation,
    slider_crank_joints,
    spherical_joints,
)

NAMES = ("crank", "coupler_pin", "rocker_pin", "rocker")

#: Crank, coupler, rocker and ground of textbooks, with the class by Grashof's rule.
TEXTBOOK = [
    ((40, 100, 80, 90), "crank-rocker"),
    ((2, 7, 9, 4), "change-point"),
    ((80, 100, 40, 90), "crank-rocker"),
    ((100, 80, 90, 40), "double-crank"),
    ((80, 40, 90, 100), "double-rocker"),
    ((50, 60, 70, 100), "triple-rocker"),
    ((1, 1, 1, 1), "change-point"),
    ((0.1, 0.4, 0.2, 0.3), "change-point"),
    ((0.3, 0.5, 0.6, 0.4), "change-point"),
    ((2.6, 4.1, 3.3, 3.4), "change-point"),
    ((2.6, 4.1, 3.3, 3.5), "crank-rocker"),
    ((0.3, 0.1, 0.3, 0.1), "change-point"),
    ((3, 4, 5, 6), "change-point"),
]


def word(found, column):
    return "crank" if column in found.turning else "rocker"


def expected(found, first, second):
    pair = (word(found, first), word(found, second))
    return f"double-{pair[0]}" if pair[0] == pair[1] else "-".join(pair)


def pairs(names):
    return [(a, b) for a, b in product(names, names) if a != b]


@pytest.mark.parametrize(("lengths", "grashof"), TEXTBOOK)
def test_textbook_four_bars_have_their_class(lengths, grashof):
    rows = sb.from_dh("RRRR", length=lengths, twist=[0] * 4, offset=[0] * 4)
    found = four_bar_of(rows, "theta_1", "theta_4")
    assert list(found.links) == ["input link", "coupler", "output link", "ground"]
    assert tuple(found.links.values()) == lengths
    assert found.grashof == grashof
    short, one, other, long = sorted(lengths)
    assert found.excess == pytest.approx(short + long - one - other, abs=1e-12)
    assert (found.excess == 0) == (grashof == "change-point")
    motion = rows.motion(24)
    if grashof == "change-point":
        assert motion.motion_type == "change-point" or motion.change_points
    else:
        assert motion.motion_type == expected(found, "theta_1", "theta_4")


@pytest.mark.parametrize("longest", range(4))
def test_a_link_longer_than_the_three_others_together_does_not_close(longest):
    lengths = [10.0, 20.0, 30.0, 25.0]
    for gap, closes in ((-1e-3, True), (1e-3, False), (50.0, False)):
        own = list(lengths)
        own[longest] = sum(lengths) - lengths[longest] + gap
        found = sb.four_bar(*own)
        assert (found.as_four_bar().grashof != "cannot close") == closes, own
        assert (found.motion(24).motion_type != "cannot-assemble") == closes, own
    words = " ".join(repr(found.motion(24)).split())
    assert "is longer than the three others together, so the loop does not close" in words


def test_a_slide_that_the_two_links_do_not_reach_does_not_close():
    for offset, closes in ((69.999, True), (70.001, False)):
        loop = sb.from_dh("RRRP", length=[40, 30, offset, 0], twist=[0, 0, pi / 2, -pi / 2])
        found = loop.as_four_bar()
        assert (found.kind, found.offset) == ("slider-crank", pytest.approx(offset))
        assert (found.grashof != "cannot close") == closes, offset
        assert (loop.motion(24).motion_type != "cannot-assemble") == closes, offset


def test_the_class_is_that_of_the_motion_of_random_four_bars_for_every_input():
    rng = np.random.default_rng(2)
    seen = set()
    for number in range(240):
        lengths = rng.uniform(1, 10, 4)
        if max(lengths) > 0.98 * (sum(lengths) - max(lengths)):
            continue
        rows = sb.from_dh("RRRR", length=lengths, twist=[0] * 4, offset=[0] * 4)
        first, second = pairs(rows.columns)[number % 12]
        found = four_bar_of(rows, first, second)
        motion = rows.motion(24, input=first, output=second)
        assert motion.motion_type == expected(found, first, second), (lengths, first, second)
        assert (found.excess < 0) == (len(motion.circuits) == 2), lengths
        seen.add(found.grashof)
    assert seen == {"crank-rocker", "double-crank", "double-rocker", "triple-rocker"}


def test_the_class_is_that_of_the_motion_of_random_spherical_four_bars_for_every_input():
    rng = np.random.default_rng(3)
    seen, count = set(), 0
    while count < 300:
        arcs = rng.uniform(0.05, pi - 0.05, 4)
        joints = spherical_joints(*arcs)
        if joints is None:
            continue
        count += 1
        if count % 2:
            # the same axes, some of them drawn the other way
            for joint in joints:
                if rng.random() < 0.5:
                    joint["axis"] = (-np.array(joint["axis"])).tolist()
        found = linkage(joints)
        first, second = pairs(NAMES)[count % 12]
        bar = four_bar_of(found, first, second)
        motion = found.motion(24, input=first, output=second)
        assert motion.motion_type == expected(bar, first, second), (arcs, first, second)
        seen.add(bar.grashof)
    assert seen == {"crank-rocker", "double-crank", "double-rocker", "triple-rocker"}


def test_the_class_is_that_of_the_motion_of_random_slider_cranks_for_every_input():
    rng = np.random.default_rng(4)
    seen, count = set(), 0
    while count < 200:
        crank, rod, offset = rng.uniform(1, 10, 3) * np.array([1, 1, 0.7])
        at = rng.uniform(0, 2 * pi)
        if (
            rod**2 <= (offset - crank * np.sin(at)) ** 2
            or abs(min(crank, rod) + offset - max(crank, rod)) < 1e-3
        ):
            continue
        count += 1
        found = linkage(slider_crank_joints(crank, rod, offset, at=at))
        first, second = pairs(found.columns)[count % 12]
        bar = four_bar_of(found, first, second)
        assert bar.excess == pytest.approx(min(crank, rod) + offset - max(crank, rod))
        motion = found.motion(24, input=first, output=second)
        for circuit in motion:
            words = ["slider" if name == "slider" else word(bar, name) for name in (first, second)]
            kind = f"double-{words[0]}" if words[0] == words[1] else "-".join(words)
            assert circuit.motion_type == kind, (crank, rod, offset, first, second)
        seen.add((bar.grashof, bar.shortest))
    assert {grashof for grashof, _ in seen} == {"Grashof", "non-Grashof"}
    assert len(seen) >= 4


@pytest.mark.parametrize(
    ("crank", "rod", "offset", "grashof"),
    [
        (40, 140, 0, "Grashof"),
        (40, 140, 100, "change-point"),
        (0.1, 0.3, 0.2, "change-point"),
        (1, 1, 0, "change-point"),
        (40, 140, 101, "non-Grashof"),
        (2.6, 3.1, 0.4, "Grashof"),
    ],
)
def test_textbook_slider_cranks_have_their_class(crank, rod, offset, grashof):
    bar = four_bar_of(linkage(slider_crank_joints(crank, rod, offset)), "crank", "slider")
    assert (bar.grashof, bar.offset) == (grashof, pytest.approx(offset, abs=1e-12))
    assert bar.links == {"input link": pytest.approx(crank), "coupler": pytest.approx(rod)}
    assert bar.turning == (("crank", "crank_pin") if grashof == "Grashof" else ())


@pytest.mark.parametrize("exponent", range(-16, -2))
@pytest.mark.parametrize("sign", [-1, 1])
def test_near_a_change_point_the_class_is_that_of_the_motion(exponent, sign):
    gap = sign * 10.0**exponent
    rows = sb.from_dh("RRRR", length=[2, 7 + gap, 8, 3], twist=[0] * 4, offset=[0] * 4)
    found = four_bar_of(rows, "theta_1", "theta_4")
    assert found.excess == pytest.approx(2 + 8 - 7 - gap - 3, abs=1e-9) or found.grashof == "change-point"
    if abs(gap) <= 1e-13:
        assert found.grashof == "change-point"
        assert rows.motion(24).motion_type == "change-point"
    elif abs(gap) >= 1e-9:
        assert found.grashof == ("crank-rocker" if gap > 0 else "triple-rocker")
        assert rows.motion(24).motion_type == expected(found, "theta_1", "theta_4")


def test_links_have_the_same_names_wherever_and_however_the_loop_is_described():
    rng = np.random.default_rng(8)
    joints = four_bar_joints(40, 100, 80, 90)
    for _ in range(5):
        found = linkage(moved(joints, rotation(rng), rng.normal(size=3) * 100))
        bar = four_bar_of(found, "crank", "rocker")
        assert bar.links == pytest.approx({"input link": 40, "coupler": 100, "output link": 80, "ground": 90})
        back = four_bar_of(found, "rocker", "crank")
        assert back.links == pytest.approx(
            {"input link": 80, "coupler": 100, "output link": 40, "ground": 90}
        )
        assert (back.shortest, back.grashof) == ("output link", "crank-rocker")
    arcs = tuple(map(radians, (30, 80, 70, 85)))
    bar = four_bar_of(linkage(spherical_joints(*arcs)), "crank", "rocker")
    assert tuple(bar.links.values()) == pytest.approx(arcs)
    assert bar.excess == pytest.approx(radians(30 + 85 - 80 - 70))


def pin(kind, at, axis=(0, 0, 1)):
    return {"kind": kind, "at": list(at), **({"axis": list(axis)} if kind != "S" else {})}


GROUND, A, B, C = (0, 0, 0), (1, 0, 0), (4, 2.5, 0), (4, 0, 0)
SLIDER = (3, 0.5, 0)

#: Lengths of the first three links and the ground, or of the two and the offset.
BARS = [1, math.hypot(3, 2.5), 2.5, 4]
CRANKS = [1, math.hypot(2, 0.5), 0.5]

#: Planar loops whose turns are joints of other kinds.
WITH_BALLS = {
    "RSSR": ([pin("R", GROUND), pin("S", A), pin("S", B), pin("R", C)], BARS),
    "RSSR, the rod slopes": (
        [pin("R", GROUND), pin("S", A), pin("S", (4, 2.5, 1)), pin("R", (4, 0, 3))],
        BARS,
    ),
    "RRSR": ([pin("R", GROUND), pin("R", A), pin("S", B), pin("R", C)], BARS),
    "RRRS": ([pin("R", GROUND), pin("R", A), pin("R", B), pin("S", C)], BARS),
    "RSCR": ([pin("R", GROUND), pin("S", A), pin("C", B), pin("R", C)], BARS),
    "RSSP": ([pin("R", GROUND), pin("S", A), pin("S", SLIDER), pin("P", SLIDER, (1, 0, 0))], CRANKS),
    "RSSP, the rod slopes": (
        [pin("R", GROUND), pin("S", A), pin("S", (3, 0.5, 1)), pin("P", (3, 0.5, 1), (1, 0, 0))],
        CRANKS,
    ),
    "RRSP": ([pin("R", GROUND), pin("R", A), pin("S", SLIDER), pin("P", (7, 7, 7), (1, 0, 0))], CRANKS),
}


@pytest.mark.parametrize("name", WITH_BALLS)
def test_links_of_a_planar_loop_with_balls_are_those_in_its_plane_however_it_is_written(name):
    joints, expected_links = WITH_BALLS[name]
    classes = set()
    for way, scale, written in rewritten(joints):
        bar = linkage(written).as_four_bar()
        found = [*bar.links.values()] + ([] if bar.offset is None else [bar.offset])
        assert sorted(found) == pytest.approx(sorted(scale * x for x in expected_links), rel=1e-9), way
        classes.add(bar.grashof in ("triple-rocker", "non-Grashof"))
    assert classes == {False}


#: What of the gallery has four links in a plane or on a sphere.
FOUR_BARS = ("engine", "planar_4r", "spherical_4r", "universal_joint")


@pytest.mark.parametrize("small", [1e-3, 1e-5, 1e-6, 1e-7, 1e-8])
def test_however_short_a_link_is_both_circuits_are_found(small):
    short_rod = [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "R", "at": [0.8, 0.6, 0], "axis": [0, 0, 1]},
        {"kind": "R", "at": [0.8 + 0.6 * small, 0.6 + 0.8 * small, 0], "axis": [0, 0, 1]},
        {"kind": "P", "at": [0.8 + 0.6 * small, 0.6 + 0.8 * small, 0], "axis": [1, 0, 0]},
    ]
    coupler = sb.four_bar(1, small, 1, 1)
    for short, ends in (
        (coupler, ("theta_1", "theta_4")),
        (coupler, ("theta_4", "theta_1")),
        (sb.four_bar(1, small, 1.3, 1.9), ("theta_1", "theta_4")),
        (sb.four_bar(small, 1, 1, 1), ("theta_1", "theta_4")),
        (sb.four_bar(1, 1, 1, small), ("theta_1", "theta_4")),
        (sb.spherical_four_bar(1, small, 1, 1), ("theta_1", "theta_4")),
        (sb.spherical_four_bar(small, 1, 1, 1), ("theta_1", "theta_4")),
        (sb.slider_crank(small, 1, 0.3), ("crank", "slider")),
        (sb.from_axes(short_rod), (None, None)),
    ):
        motion = short.motion(24, input=ends[0], output=ends[1])
        assert (len(motion), motion.search.unfollowed) == (2, 0)


def test_of_a_triangle_one_pose_is_enough():
    triangle = sb.from_axes(
        [{"kind": "R", "at": at, "axis": [0, 0, 1]} for at in ([0, 0, 0], [2, 0, 0], [1, 2, 0])]
    )
    assert triangle.motion(24).motion_type == "rigid"


def test_other_loops_have_none():
    for name in sb.gallery.loops():
        found = sb.load(name)
        bar = four_bar_of(found, found.drive.joint, found.drive.output)
        assert (bar is not None) == (name in FOUR_BARS), name
    cross = sb.load("universal_joint")
    assert four_bar_of(cross, "input_shaft", "output_shaft").turning == ("input_shaft", "output_shaft")
