"""Which loops are planar and which spherical, wherever they are, and how near is near enough."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

import sevenbar as sb
from sevenbar import _core
from sevenbar.kinematics.loop.geometry import NO_SIZE
from sevenbar.kinematics.solvers.plane_and_sphere import SAME
from textbook_loops import (
    four_bar_joints,
    linkage,
    moved,
    rewritten,
    rotation,
    slider_crank_joints,
    spherical_joints,
    tilt,
)

PLANAR = {
    "4R": four_bar_joints(40, 100, 80, 90),
    "square": [
        {"kind": "R", "at": [x, y, 0], "axis": [0, 0, 1]} for x, y in ((0, 0), (0, 1), (1, 1), (1, 0))
    ],
    "slider-crank": slider_crank_joints(40, 140),
    "offset slider-crank, its slider a cylinder": slider_crank_joints(40, 140, 10, slide="C"),
    "double slider": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "R", "at": [1, 1, 0], "axis": [0, 0, 1]},
        {"kind": "P", "at": [1, 1, 0], "axis": [0, 1, 0]},
        {"kind": "P", "at": [1, 0, 0], "axis": [1, 0, 0]},
    ],
    "planar joint": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "E", "at": [1, 1, 0], "axis": [0, 0, 1]},
    ],
    "wedge": [
        {"kind": "P", "at": [0, 0, 0], "axis": [1, 0, 0]},
        {"kind": "P", "at": [1, 0, 0], "axis": [1, 1, 0]},
        {"kind": "P", "at": [1, 1, 0], "axis": [0, 1, 0]},
    ],
    "4R with axes both ways, links one above the other": [
        {"kind": "R", "at": [0, 0, 3], "axis": [0, 0, 1]},
        {"kind": "R", "at": [1, 2, 5], "axis": [0, 0, -1]},
        {"kind": "R", "at": [4, 2, -2], "axis": [0, 0, 1]},
        {"kind": "R", "at": [4, 0, 1], "axis": [0, 0, -1]},
    ],
    "one ball": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "S", "at": [1, 2, 1]},
        {"kind": "R", "at": [4, 2, 0], "axis": [0, 0, 1]},
        {"kind": "R", "at": [4, 0, 0], "axis": [0, 0, 1]},
    ],
    "a rod between two balls": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "S", "at": [1, 2, 1]},
        {"kind": "S", "at": [4, 2, 1]},
        {"kind": "R", "at": [4, 0, 0], "axis": [0, 0, 1]},
    ],
    "a sloping rod between two balls": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "S", "at": [1, 2, 1]},
        {"kind": "S", "at": [4, 2, 2]},
        {"kind": "R", "at": [4, 0, 0], "axis": [0, 0, 1]},
    ],
    "a slide along the normal, which cannot move": [
        *four_bar_joints(40, 100, 80, 90)[:3],
        {"kind": "C", "at": [90, 0, 0], "axis": [0, 0, 1]},
    ],
}

NOT_PLANAR = {
    "balls with a joint between": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "S", "at": [1, 2, 0]},
        {"kind": "R", "at": [3, 3, 0], "axis": [0, 0, 1]},
        {"kind": "S", "at": [4, 2, 0]},
    ],
    "a cylinder with a ball, which lets it turn": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"kind": "S", "at": [1, 2, 0]},
        {"kind": "R", "at": [4, 0, 0], "axis": [0, 0, 1]},
        {"kind": "C", "at": [4, 0, 0], "axis": [1, 0, 0]},
    ],
    "two slides along the normal": [
        *four_bar_joints(40, 100, 80, 90)[:2],
        {"kind": "C", "at": four_bar_joints(40, 100, 80, 90)[2]["at"], "axis": [0, 0, 1]},
        {"kind": "C", "at": [90, 0, 0], "axis": [0, 0, 1]},
    ],
    "a slide out of the plane": [
        *slider_crank_joints(40, 140)[:3],
        {"kind": "P", "at": slider_crank_joints(40, 140)[3]["at"], "axis": [1, 0, 0.1]},
    ],
    "a screw": [
        *slider_crank_joints(40, 140)[:3],
        {"kind": "H", "at": slider_crank_joints(40, 140)[3]["at"], "axis": [1, 0, 0], "pitch": 2},
    ],
}


def test_those_that_move_in_parallel_planes_are_planar_and_not_spherical():
    for name, joints in PLANAR.items():
        found = linkage(joints)
        assert found.plane is not None, name
        assert found.sphere is None, name
        assert found.plane.normal.tolist() == [0, 0, 1], name
        assert [found.plane.x.tolist(), found.plane.y.tolist()] == [[1, 0, 0], [0, 1, 0]], name


def test_those_that_can_leave_the_plane_are_not():
    for name, joints in NOT_PLANAR.items():
        assert linkage(joints).plane is None, name


@pytest.mark.parametrize(
    "name", ["4R", "slider-crank", "a sloping rod between two balls", "wedge", "one ball"]
)
def test_every_point_of_a_planar_loop_keeps_its_height(name):
    rng = np.random.default_rng(5)
    found = linkage(moved(PLANAR[name], rotation(rng), np.array([3.0, -8.0, 5.0])))
    plane = found.plane
    motion = found.motion(24)
    count = len(found.joints)
    heights = []
    for circuit in motion:
        for link in range(1, count):
            if name == "a rod between two balls" and link == 2:
                continue  # it spins about its own line
            for at in rng.normal(size=(3, 3)):
                place = circuit.point(link, tuple(at)).position
                heights.append(np.ptp((place - plane.origin) @ plane.normal))
    assert max(heights) < 1e-9 * 200


def test_what_is_not_planar_leaves_the_plane():
    out = linkage(NOT_PLANAR["a cylinder with a ball, which lets it turn"]).motion(24)
    assert out.motion_type not in ("rigid", "cannot-assemble")
    bennett = sb.load("bennett").motion(24).circuits[0].point(2, (1, 2, 3)).position
    assert np.linalg.svd(bennett - bennett.mean(axis=0))[1][-1] > 1e-3


def test_wherever_a_loop_is_it_is_what_it_is():
    rng = np.random.default_rng(1)
    ball = spherical_joints(*map(radians, (30, 80, 70, 85)), radius=50.0)
    for _ in range(40):
        turn, shift = rotation(rng), rng.normal(size=3) * 1000
        for name, joints in PLANAR.items():
            found = linkage(moved(joints, turn, shift))
            assert found.plane is not None, name
            assert found.sphere is None, name
            assert abs(abs(found.plane.normal @ turn[:, 2]) - 1) < 1e-12
            x, y, n = found.plane.x, found.plane.y, found.plane.normal
            assert np.allclose(
                np.column_stack([x, y, n]).T @ np.column_stack([x, y, n]), np.eye(3), atol=1e-14
            )
            assert np.allclose(np.cross(x, y), n, atol=1e-14)
            place = turn @ np.asarray(joints[0]["at"], dtype=float) + shift
            assert abs((place - found.plane.origin) @ n) < 1e-9
        for name, joints in NOT_PLANAR.items():
            assert linkage(moved(joints, turn, shift)).plane is None, name
        found = linkage(moved(ball, turn, shift))
        assert found.plane is None
        assert np.allclose(found.sphere.centre, shift, atol=1e-9)
        assert found.sphere.radius == pytest.approx(50)


@pytest.mark.parametrize(
    ("normal", "x", "y"),
    [
        ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
        ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
        ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
        ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((-1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ],
)
def test_parallel_to_the_report_frame_its_coordinates_are_those_of_that_frame(normal, x, y):
    z = np.array(normal, dtype=float)
    across = np.array(y, dtype=float)
    turn = np.column_stack([np.cross(across, z), across, z])
    shift = np.array([3.0, 5.0, 7.0])
    plane = linkage(moved(PLANAR["4R"], turn, shift)).plane
    assert (plane.x.tolist(), plane.y.tolist()) == ([*x], [*y])
    assert plane.coordinates(shift) == pytest.approx([shift @ np.array(x), shift @ np.array(y)], abs=1e-12)


@pytest.mark.parametrize("exponent", range(-16, -2))
def test_as_near_as_redundant_constraints_agree_is_near_enough(exponent):
    size = 10.0**exponent
    near = size <= SAME
    bent = four_bar_joints(40, 100, 80, 90)
    bent[2] = moved([{**bent[2], "at": [0, 0, 0]}], tilt(size), np.array(bent[2]["at"]))[0]
    found = linkage(bent)
    assert (found.plane is not None) == near
    assert found.plane is None or found.sphere is None
    rows = sb.from_dh("RRRR", length=[40, 100, 80, 90], offset=[0.9 * size * 310, 0, 0, 0], twist=[0] * 4)
    assert (rows.plane is not None) == near
    ball = spherical_joints(*map(radians, (30, 80, 70, 85)), radius=50.0)
    ball[1]["at"] = (np.array(ball[1]["at"]) + 1000 * size * np.array([0.6, -0.7, 0.2])).tolist()
    assert (linkage(ball).sphere is not None) == (exponent <= -10)


@pytest.mark.parametrize("exponent", range(-16, -2))
def test_a_sphere_that_grows_becomes_a_plane_and_is_never_both(exponent):
    arc = 10.0**exponent
    joints = spherical_joints(4 * arc, 10 * arc, 8 * arc, 9 * arc, radius=1 / arc)
    if joints is None:
        pytest.skip("rounding leaves no triangle")
    found = linkage(joints)
    assert found.plane is None or found.sphere is None
    if exponent >= -5:
        assert found.plane is None


def test_of_the_gallery_two_are_planar_and_two_are_spherical():
    kinds = {}
    for name in sb.gallery.loops():
        found = sb.load(name)
        kinds[name] = (found.plane is not None, found.sphere is not None)
    assert [name for name, (flat, _) in kinds.items() if flat] == ["engine", "planar_4r"]
    assert [name for name, (_, round_) in kinds.items() if round_] == ["spherical_4r", "universal_joint"]


def test_rows_of_any_twist_of_half_turns_are_planar_where_their_offsets_cancel():
    flat = sb.from_dh("RRRR", length=[4, 10, 8, 9], offset=[1, 2, 2, 1], twist=[0, pi, 0, pi])
    assert flat.plane is not None
    apart = sb.from_dh("RRRR", length=[4, 10, 8, 9], offset=[1, 2, 2, 2], twist=[0, pi, 0, pi])
    assert apart.plane is None  # it cannot be put together at all
    turned = sb.from_dh("RRRR", length=[4, 10, 8, 9], offset=[0] * 4, twist=[0, pi, 0, 0])
    assert turned.plane is None
    # a joint of rows that a plane holds at a quarter turn
    slider = sb.from_dh(
        "RRRRP",
        length=[40, 140, 0, 0, 0],
        offset=[0, 0, 0, 0, None],
        twist=[0, 0, pi / 2, 0, pi / 2],
        angle=[None, None, None, None, 0],
    )
    assert slider.plane is not None


def test_the_radius_reaches_the_joints_as_drawn_or_the_points():
    arcs = tuple(map(radians, (30, 80, 70, 85)))
    drawn = spherical_joints(*arcs, radius=50.0)
    centred = spherical_joints(*arcs, radius=0.0)
    far = [{"name": "P", "link": 2, "at": [77 * sin(0.4), 0, 77 * cos(0.4)]}]
    assert linkage(drawn).sphere.radius == pytest.approx(50)
    assert linkage(drawn, points=far).sphere.radius == pytest.approx(50)
    assert linkage(centred, points=far).sphere.radius == pytest.approx(77)
    assert linkage(centred).sphere.radius == 1.0
    assert repr(linkage(centred).sphere).splitlines() == [
        "MotionSphere",
        "  centre  (0, 0, 0)",
        "  radius  1",
    ]


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (0.1, 0.2, 0.3), (1e6, -2e6, 1 / 3), (1e-6, 0.0, 1e-7)])
def test_a_sphere_drawn_in_one_point_is_one_wherever_that_is(place):
    joints = spherical_joints(*map(radians, (30, 80, 70, 85)))
    for seed in range(8):
        turned = moved(joints, rotation(np.random.default_rng(seed)), np.zeros(3))
        for _, _, written in rewritten([{**joint, "at": list(place)} for joint in turned], seed):
            found = linkage([{**joint, "at": list(place)} for joint in written])
            np.testing.assert_allclose(found.sphere.centre, place, rtol=1e-12, atol=1e-12)
            assert found.sphere.radius == 1.0
            assert found.as_four_bar().grashof in ("crank-rocker", "double-crank", "double-rocker")


def test_a_sphere_is_one_in_every_size_and_place():
    for _, scale, written in rewritten(spherical_joints(*map(radians, (30, 80, 70, 85)), radius=2.0)):
        assert linkage(written).sphere is not None, scale


def test_slides_drawn_in_one_point_have_a_plane_wherever_that_is():
    for seed in range(8):
        turned = moved(PLANAR["wedge"], rotation(np.random.default_rng(seed)), np.zeros(3))
        for place in ((0.1, 0.2, 0.3), (1e6, -2e6, 1 / 3)):
            assert linkage([{**joint, "at": list(place)} for joint in turned]).is_planar


def test_balls_off_the_centre_make_no_sphere():
    joints = spherical_joints(*map(radians, (30, 80, 70, 85)), radius=50.0)
    for i in (1, 2):
        joints[i] = {"kind": "S", "at": joints[i]["at"]}
    assert linkage(joints).sphere is None


def test_a_loop_has_no_size_from_the_same_bound_on_as_in_the_core():
    assert NO_SIZE == _core.NO_SIZE
