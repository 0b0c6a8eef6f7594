"""What is said at once of a net as it is drawn: a dead centre, a change point, nothing that moves, or nearly."""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.kinematics.nets.drawn import drawn_pose
from sevenbar.reporting.drawn import drawn_lines, drawn_of


def pins(*places):
    return [{"at": at, "links": links.split(), "name": f"p{i}"} for i, (at, links) in enumerate(places, 1)]


def watt(knee=(110, 80), **more):
    return sb.from_pins(
        pins(
            ((0, 0), "frame crank"), ((10, 40), "crank coupler"), (knee, "coupler rocker"), ((100, 0), "frame rocker"),
            ((150, 60), "rocker link"), ((220, 70), "link lever"), ((200, 0), "frame lever"),
        ),
        ground="frame", **more,
    )  # fmt: skip


def cranks(end):
    """Three cranks on a coupler, equal for (56, 10)."""
    return sb.from_pins(
        pins(
            ((0, 0), "frame one"), ((6, 10), "one c"), ((20, 0), "frame two"), ((26, 10), "two c"),
            ((50, 0), "frame three"), (end, "three c"),
        ),
        ground="frame",
    )  # fmt: skip


def drawn(linkage):
    return drawn_of(linkage, linkage.input_column(), linkage.mobility())


def lines(linkage):
    mobility = linkage.mobility()
    column = linkage.input_column()
    return drawn_lines(linkage, column, mobility, drawn_of(linkage, column, mobility))


def test_of_a_pose_like_others_there_is_no_sentence():
    for linkage in (watt(), watt(drive="p7"), cranks((56, 10))):
        assert (drawn(linkage).word, lines(linkage)) == ("regular", [])


@pytest.mark.parametrize("knee", [(20, 80), (5, 20), (-10, -40), (20, 80 + 1e-9)])
def test_crank_and_coupler_in_line_are_a_dead_centre_of_all_beyond_them(knee):
    for drive in ("p4", "p6", "p7"):
        found = drawn(watt(knee, drive=drive))
        assert (found.word, found.others) == ("dead-centre", ("p1", "p2", "p3"))
    assert drawn(watt(knee, drive="p1")).word == "regular"
    assert lines(watt(knee, drive="p4")) == [
        "drawn at a dead centre of p4, where two modes meet; draw it in another pose, or drive p1, p2, p3"
    ]


def test_a_pose_near_a_dead_centre_is_like_others():
    assert drawn(watt((20, 80.001), drive="p4")).word == "regular"


def test_coupler_and_rocker_in_line_are_a_dead_centre_of_the_crank():
    # the knee on the line from the crank's end to the rocker's pivot
    knee = tuple(np.array([10.0, 40.0]) + 0.3 * (np.array([100.0, 0.0]) - [10.0, 40.0]))
    assert drawn(watt(knee)).word == "dead-centre"


def test_a_structure_says_that_nothing_moves():
    braced = sb.from_pins(
        pins(((0, 0), "frame a"), ((30, 40), "a b"), ((90, 0), "b frame"), ((10, 30), "a c"), ((70, 50), "c d"), ((80, 30), "d b")),
        ground="frame",
    )  # fmt: skip
    assert drawn(braced).word == "rigid"
    assert drawn(braced).nearly is None
    assert lines(braced) == ["nothing moves; leave out a joint or a rod, or give a joint more freedoms"]


def test_a_net_drawn_a_little_off_says_where_and_how_much():
    rigid = cranks((56, 10.1))
    found = drawn(rigid)
    assert (rigid.mobility().finite, found.word) == (0, "rigid")
    # the third crank's end would go square to (6, 10.1), the coupler's square to (6, 10)
    assert found.nearly.where in ("p3", "p4", "p5", "p6")
    assert 0 < found.nearly.opens < 0.1
    # ten times nearer it opens by a tenth
    nearer = drawn(cranks((56, 10.01))).nearly.opens
    assert 9 < found.nearly.opens / nearer < 11
    assert "nearly moves: " in lines(rigid)[1]
    # one axis that is not square to the plane
    tilted = [
        {"kind": "R", "at": [*at, 0], "axis": [0, 0, 1], "between": links}
        for at, *links in [
            ([0, 0], "frame", "crank"), ([10, 40], "crank", "coupler"), ([110, 80], "coupler", "rocker"), ([100, 0], "frame", "rocker"),
            ([150, 60], "rocker", "link"), ([220, 70], "link", "lever"), ([200, 0], "frame", "lever"),
        ]
    ]  # fmt: skip
    tilted[4]["axis"] = [0, 0.002, 1]
    assert drawn(sb.from_axes(tilted, ground="frame")).nearly is not None


def test_more_freedoms_than_one_input_moves_are_counted():
    loose = sb.from_pins(
        pins(
            ((0, 0), "frame crank"), ((10, 40), "crank coupler"), ((110, 80), "coupler rocker"), ((100, 0), "frame rocker"),
            ((150, 60), "rocker link"), ((190, 90), "link lever"), ((220, 70), "lever arm"), ((200, 0), "arm frame"),
        ),
        ground="frame",
    )  # fmt: skip
    assert lines(loose) == ["one input is too few for 2 freedoms; join links by more joints or rods"]


def test_a_drawing_is_judged_the_same_however_large_it_is_and_where():
    for scale in (1e-3, 1.0, 1e4):
        turn = scale * np.exp(0.7j)
        moved = [
            {"at": (z.real, z.imag), "links": ["frame", "crank"] if i == 0 else links}
            for i, (at, links) in enumerate(
                [((0, 0), []), ((10, 40), ["crank", "a"]), ((20, 80), ["a", "b"]), ((100, 0), ["b", "frame"]),
                 ((60, 70), ["b", "c"]), ((90, 90), ["c", "d"]), ((150, 0), ["d", "frame"])]
            )
            for z in [complex(*at) * turn + 300 * scale]
        ]  # fmt: skip
        linkage = sb.from_pins(moved, ground="frame", drive="pin_7")
        found = drawn_pose(linkage, linkage.input_column(), 1)
        assert (found.word, found.others) == ("dead-centre", ("pin_1", "pin_2", "pin_3"))


def test_a_slide_and_a_screw_may_be_at_a_dead_centre_too():
    # a crank in line with its rod: the slide stands still
    joints = [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1], "between": ["frame", "crank"]},
        {"name": "big end", "kind": "R", "at": [30, 0, 0], "axis": [0, 0, 1], "between": ["crank", "rod"]},
        {
            "name": "small end",
            "kind": "R",
            "at": [120, 0, 0],
            "axis": [0, 0, 1],
            "between": ["rod", "piston"],
        },
        {"name": "bore", "kind": "P", "at": [120, 0, 0], "axis": [1, 0, 0], "between": ["frame", "piston"]},
        {"name": "eye", "kind": "R", "at": [40, 20, 0], "axis": [0, 0, 1], "between": ["rod", "link"]},
        {"name": "end", "kind": "R", "at": [90, 60, 0], "axis": [0, 0, 1], "between": ["link", "lever"]},
        {"name": "lever", "kind": "R", "at": [60, 90, 0], "axis": [0, 0, 1], "between": ["lever", "frame"]},
    ]
    assert drawn(sb.from_axes(joints, ground="frame", drive="bore")).word == "dead-centre"
    assert drawn(sb.from_axes(joints, ground="frame", drive="crank")).word == "regular"
