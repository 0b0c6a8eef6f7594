"""All modes of blocks in space that are one link on rods, joints and legs: against a search, and written in other ways."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.kinematics.circuits.poses import poses

#: The nets of the gallery in space, with as many modes as drawn and a point.
NETS = {
    "double_wishbone": (4, "algebraic"),
    "rssr_ss": (4, "algebraic"),
    "five_rod": (16, "algebraic"),
    "platform": (24, "algebraic"),
}

WISHBONE = {
    "lower": ("R", [0, 330, 180], [1, 0, 0.02], "frame", "lower wishbone"),
    "upper": ("R", [-20, 400, 430], [1, 0.03, -0.08], "frame", "upper wishbone"),
    "lower ball": ("S", [5, 700, 170], None, "lower wishbone", "upright"),
    "upper ball": ("S", [-15, 670, 450], None, "upper wishbone", "upright"),
}

ROD = ([120, 350, 230], [130, 680, 240])


#: As drawn.
STILL = np.eye(3)


def wishbone(turn=STILL, scale=1.0, order=tuple(WISHBONE), *, turned_round=False):
    """The double wishbone, moved, with its joints in another order, its joints from the other link."""

    def moved(v):
        return [float(x) for x in scale * turn @ np.array(v, dtype=float)]

    joints = []
    for name in order:
        kind, at, axis, *between = WISHBONE[name]
        row = {
            "name": name,
            "kind": kind,
            "at": moved(at),
            "between": between[::-1] if turned_round else between,
        }
        if axis is not None:
            row["axis"] = [
                float(x) for x in np.sign(np.linalg.det(turn)) * turn @ np.array(axis, dtype=float)
            ]
        joints.append(row)
    rod = {"name": "track rod", "between": ["frame", "upright"], "at": [moved(end) for end in ROD]}
    return sb.from_axes(joints, rods=[rod], ground="frame", drive="lower")


def upright_of(linkage, value):
    """The poses of the upright in all modes, ranked by where it is."""
    modes = linkage.assembly_modes(value)
    assert modes.completeness == "algebraic"
    frames = poses(linkage, modes.q)[:, linkage.link_names.index("upright")]
    return frames[np.lexsort(frames[:, :3, 3].round(6).T)]


@pytest.mark.parametrize("name", NETS)
def test_the_nets_of_the_gallery_have_all_modes(name):
    linkage = sb.load(name)
    count, word = NETS[name]
    modes = linkage.assembly_modes(0.0)
    assert (len(modes), modes.completeness) == (count, word)
    # the drawing is one of them
    drawn = np.where(linkage.turning, np.cos(modes.q) - 1.0, modes.q)
    assert np.abs(drawn).max(axis=1).min() < 1e-9
    assert modes.residual.max() < 1e-11 * linkage.size


@pytest.mark.parametrize("name", NETS)
def test_no_mode_that_a_search_finds_is_missing(name):
    from sevenbar.kinematics.nets.modes import _searched
    from sevenbar.kinematics.nets.order import order_of
    from sevenbar.kinematics.nets.tree import Tree

    linkage = sb.load(name)
    column = linkage.columns.index(linkage.drive.joint)
    found = 0
    for value in (0.05, -0.1, 0.2):
        value = value if linkage.turning[column] else value * 0.1 * linkage.size
        modes = linkage.assembly_modes(value)
        tree = Tree(linkage, (linkage.column_of(column).joint,), order_of(linkage, column))
        searched = _searched(linkage, tree, column, value)
        found += len(searched)
        for q in searched.q:
            turned = np.where(linkage.turning, np.abs(np.exp(1j * modes.q) - np.exp(1j * q)), modes.q - q)
            assert np.abs(turned).max(axis=1).min() < 1e-6 * linkage.size
    assert found > 3


def test_the_same_wishbone_written_in_other_ways_has_the_same_modes():
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    value = 0.1
    plain = upright_of(wishbone(), value)
    for mirrored in (turn * np.linalg.det(turn), -turn * np.linalg.det(turn)):
        sign = np.linalg.det(mirrored)
        other = poses_back(upright_of(wishbone(mirrored), value), mirrored)
        assert np.abs(ranked(other) - ranked(plain)).max() < 1e-8, sign
    scaled = upright_of(wishbone(scale=1e-3), value)
    assert np.abs(1000 * scaled[:, :3, 3] - plain[:, :3, 3]).max() < 1e-8
    order = ("upper ball", "lower", "lower ball", "upper")
    assert np.abs(upright_of(wishbone(order=order), value) - plain).max() < 1e-8
    assert np.abs(upright_of(wishbone(turned_round=True), -value) - plain).max() < 1e-8


def poses_back(frames, turn):
    """Frames of a net that was turned or mirrored, as of the net before."""
    back = frames.copy()
    back[:, :3, :3] = turn.T @ frames[:, :3, :3] @ turn
    back[:, :3, 3] = frames[:, :3, 3] @ turn
    return back


def ranked(frames):
    return frames[np.lexsort(frames[:, :3, 3].round(6).T)]


def test_a_strut_is_a_rod_of_its_length():
    linkage = sb.load("platform")
    strut = np.array([[-68, -188, 0], [41, -114, 260]], dtype=float)
    value = 5.0
    long = linkage.assembly_modes(value)
    places = poses(linkage, long.q)[:, linkage.link_names.index("platform")]
    heads = places[:, :3, :3] @ strut[1] + places[:, :3, 3]
    reach = np.linalg.norm(strut[1] - strut[0]) + value
    assert np.abs(np.linalg.norm(heads - strut[0], axis=1) - reach).max() < 1e-9
    # each pose of the platform with the tube in two poses
    apart = np.abs(places[:, None] - places[None]).max(axis=(2, 3)) < 1e-6
    assert (apart.sum(axis=1) == 2).all()


def test_a_rocker_on_a_rod_is_in_closed_form():
    joints = [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1], "between": ["frame", "crank"]},
        {"name": "rocker", "kind": "R", "at": [3, 1, 0], "axis": [0, 1, 0], "between": ["frame", "rocker"]},
        {"name": "second", "kind": "R", "at": [6, 0, 1], "axis": [1, 0, 1], "between": ["frame", "second"]},
    ]
    rods = [
        {"name": "one", "between": ["crank", "rocker"], "at": [[0.5, 0, 0], [3, 1, 2]]},
        {"name": "two", "between": ["rocker", "second"], "at": [[3.5, 1, 1.5], [6, 2, 1]]},
    ]
    train = sb.from_axes(joints, rods=rods, ground="frame", drive="crank")
    modes = train.assembly_modes(0.7)
    assert modes.completeness == "closed-form"
    motion = train.motion()
    assert motion.completeness == "counted"
    frames = poses(train, modes.q)
    for rod in rods:
        ends = []
        for link, at in zip(rod["between"], rod["at"], strict=True):
            frame = frames[:, train.link_names.index(link)]
            ends.append(frame[:, :3, :3] @ np.array(at, dtype=float) + frame[:, :3, 3])
        length = math.dist(*rod["at"])
        assert np.abs(np.linalg.norm(ends[0] - ends[1], axis=1) - length).max() < 1e-12


def test_a_four_bar_in_a_plane_is_solved_before_the_rod_that_it_drives():
    pins = [
        ("crank", [0, 0, 0], "frame", "crank"),
        ("a", [1, 2, 0], "crank", "coupler"),
        ("b", [5, 3, 0], "coupler", "rocker"),
        ("c", [4, 0, 0], "rocker", "frame"),
    ]
    joints = [
        {"name": n, "kind": "R", "at": at, "axis": [0, 0, 1], "between": [x, y]} for n, at, x, y in pins
    ]
    joints.append(
        {"name": "flap", "kind": "R", "at": [8, 1, 1], "axis": [1, 0, 0], "between": ["frame", "flap"]}
    )
    rods = [{"name": "link", "between": ["rocker", "flap"], "at": [[5, 2, 0], [8, 2, 3]]}]
    net = sb.from_axes(joints, rods=rods, ground="frame", drive="crank")
    assert [(block.group, block.solver) for block in net.order.blocks] == [
        ("planar", "dyad"),
        ("spatial", "loop"),
    ]
    modes = net.assembly_modes(0.0)
    assert modes.completeness == "closed-form"
    # the other mode of the four-bar is too far from the flap
    assert len(modes) == 2


def rocker_on_a_rod(ball, axis, end, turn=STILL, shift=(0, 0, 0)):
    """An RSSR whose coupler is a rod: crank about z at the origin, rocker at (4, 0, 0)."""

    def moved(v):
        return [float(x) for x in turn @ np.array(v, dtype=float) + np.array(shift, dtype=float)]

    def turned(v):
        return [float(x) for x in turn @ np.array(v, dtype=float)]

    joints = [
        {
            "name": "crank",
            "kind": "R",
            "at": moved([0, 0, 0]),
            "axis": turned([0, 0, 1]),
            "between": ["frame", "crank"],
        },
        {
            "name": "rocker",
            "kind": "R",
            "at": moved([4, 0, 0]),
            "axis": turned(axis),
            "between": ["frame", "rocker"],
        },
        {
            "name": "third",
            "kind": "R",
            "at": moved([9, 0, 1]),
            "axis": turned([1, 0, 1]),
            "between": ["frame", "third"],
        },
    ]
    rods = [
        {"name": "rod", "between": ["crank", "rocker"], "at": [moved(ball), moved(end)]},
        {"name": "second rod", "between": ["rocker", "third"], "at": [moved([5, 1, 0]), moved([8, 3, 1])]},
    ]
    return sb.from_axes(joints, rods=rods, ground="frame", drive="crank")


def test_a_drawing_at_a_dead_centre_is_a_mode_however_it_is_turned():
    rng = np.random.default_rng(3)
    for _ in range(20):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        net = rocker_on_a_rod([1, 0, 0], [0, 1, 0], [5, 0, 0], turn, rng.normal(size=3))
        modes = net.assembly_modes(0.0)
        assert modes.completeness == "closed-form"
        # the drawing, one mode or two that nearly meet
        rocker = modes.q[:, net.columns.index("rocker")]
        assert len(rocker) > 0
        assert np.abs(rocker).max() < 1e-6


def test_a_rod_that_does_not_hold_its_link_leaves_a_curve():
    # the ball on the crank lies on the axis of the rocker
    net = rocker_on_a_rod([1, 0, 0], [1, 0, 0], [4, 0, 1])
    modes = net.assembly_modes(0.0)
    assert (len(modes), modes.completeness) == (0, "algebraic")
    assert modes.on_curve is not None
    assert len(net.assembly_modes(1e-6)) > 0


def test_a_net_far_from_the_report_frame_is_as_certain():
    def shifted(match):
        return "[" + ", ".join(str(float(x) + 1e6) for x in match[1].split(",")) + "]"

    lines = sb.gallery.text("platform").splitlines()
    moved = [re.sub(r"\[(-?\d[-\d., ]*)\]", shifted, x) if x.startswith("at") else x for x in lines]
    modes = sb.loads("\n".join(moved)).assembly_modes(0.0)
    assert (len(modes), modes.completeness) == (24, "algebraic")
