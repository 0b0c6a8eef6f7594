"""Structures: loops that close in single poses and do not move are rigid, in rows as they are drawn."""

from math import acos, pi, radians

import numpy as np
import pytest

import sevenbar as sb


def triangle(*lengths: float) -> sb.Linkage:
    return sb.from_dh("RRR", length=list(lengths), twist=[0] * 3, offset=[0] * 3)


def spherical_triangle(*arcs: float) -> sb.Linkage:
    return sb.from_dh("RRR", length=[0] * 3, twist=[radians(a) for a in arcs], offset=[0] * 3)


SQUARE_CORNERED = [(3, 4, 5), (0.3, 0.4, 0.5), (1, 1, 1), (2.6, 2.6, 0.1), (5, 5, 6 + 1e-9)]


@pytest.mark.parametrize("lengths", SQUARE_CORNERED, ids=str)
def test_a_triangle_in_rows_is_rigid(lengths):
    linkage = triangle(*lengths)
    motion = linkage.motion(24)
    assert motion.motion_type == "rigid"
    assert motion.circuits == ()
    assert linkage.mobility().finite == 0


def test_a_pose_that_was_searched_for_is_not_counted():
    assert triangle(3, 4, 5).motion(24).completeness == "searched"
    assert triangle(3, 4, 8).motion(24).completeness == "counted"


@pytest.mark.parametrize("lengths", SQUARE_CORNERED, ids=str)
def test_it_closes_at_the_angles_of_the_cosine_law_alone(lengths):
    a, b, c = lengths
    # sides a and b enclose the angle opposite to c; joint 2 turns the one against the other
    turned = pi - acos((a * a + b * b - c * c) / (2 * a * b))
    linkage = triangle(*lengths)
    assert len(linkage.assembly_modes(0.123456).q) == 0
    found = [linkage.assembly_modes(t, input="theta_2").q for t in (turned, -turned)]
    for q in found:
        assert len(q) == 1
        assert np.abs((np.array(lengths) * np.exp(1j * np.cumsum(q[0]))).sum()) < 1e-9


@pytest.mark.parametrize("lengths", [(3, 4, 8), (1, 1, 2.6), (0.1, 0.1, 0.3)], ids=str)
def test_lengths_of_which_one_is_too_long_close_nowhere(lengths):
    assert triangle(*lengths).motion(24).motion_type == "cannot-assemble"


def test_a_drawn_triangle_is_rigid_too():
    joints = [
        {"kind": "R", "at": [x, y, 0], "axis": [0, 0, 1]} for x, y in ((0.0, 0.0), (3.0, 0.0), (3.0, 4.0))
    ]
    assert sb.from_axes(joints).motion(24).motion_type == "rigid"


@pytest.mark.parametrize("arcs", [(90, 90, 90), (60, 60, 60), (30, 40, 50)], ids=str)
def test_a_spherical_triangle_is_rigid(arcs):
    assert spherical_triangle(*arcs).motion(24).motion_type == "rigid"


def test_a_spherical_four_bar_with_an_arc_of_zero_is_rigid_beside_an_idle_turn():
    assert sb.spherical_four_bar("0 deg", "30 deg", "30 deg", "30 deg").motion(24).motion_type == "rigid"


@pytest.mark.parametrize("seed", range(8))
def test_axes_anywhere_that_do_not_meet_their_condition_close_nowhere(seed):
    random = np.random.default_rng(seed)
    numbers = {key: list(random.uniform(0.5, 2.0, 4)) for key in ("length", "twist", "offset")}
    assert sb.from_dh("RRRR", **numbers).motion(24).motion_type == "cannot-assemble"
