"""The rigid motions against SciPy's rotations, which share no code with them, and at the places where formulas fail."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sevenbar.kinematics.loop import rigid

RANDOM = Rotation.random(60, 5)
#: Turns by nothing, by half a turn, and by very little less, about axes of all kinds.
AXES = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [-1, 2, 3]], dtype=float)
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)
EDGES = Rotation.from_rotvec(
    np.concatenate([a * AXES for a in (0.0, 1e-9, 1e-4, math.pi - 1e-4, math.pi - 1e-9, math.pi)])
)
ALL = Rotation.concatenate([RANDOM, EDGES])
QUARTERS = [Rotation.from_euler("ZYX", [a, b * math.pi / 2, c]) for a, b, c in ((1, 1, 2), (0.3, -1, -2))]

matrices = pytest.mark.parametrize("turn", list(ALL), ids=range(len(ALL)))


@pytest.mark.parametrize("axis", range(3))
def test_rotations_about_the_axes_are_scipys_and_quarter_turns_are_exact(axis: int) -> None:
    angles = np.linspace(-7, 7, 60).reshape(6, 10)
    known = Rotation.from_euler("xyz"[axis], angles.reshape(-1, 1)).as_matrix().reshape(6, 10, 3, 3)
    np.testing.assert_allclose(rigid.about(axis, angles), known, atol=1e-15)
    assert set(rigid.about(axis, math.pi / 2 * np.arange(-8, 9)).ravel()) <= {-1.0, 0.0, 1.0}


def test_poses_carry_points_as_scipys_rotations_do_and_inverses_bring_them_back() -> None:
    places, points = np.random.default_rng(1).normal(size=(2, len(ALL), 3))
    made = rigid.pose(ALL.as_matrix(), places)
    carried = (made @ np.insert(points, 3, 1.0, axis=1)[:, :, None])[..., 0]
    np.testing.assert_allclose(carried[:, :3], ALL.apply(points) + places, atol=1e-14)
    np.testing.assert_allclose(rigid.inverse(made) @ made, np.tile(np.eye(4), (len(ALL), 1, 1)), atol=1e-14)
    assert (rigid.inverse(made)[:, 3] == [0, 0, 0, 1]).all()
    np.testing.assert_allclose(rigid.pose(np.eye(3), places)[:, :3, 3], places)
    assert rigid.pose(ALL.as_matrix()).shape == (len(ALL), 4, 4)


@matrices
def test_a_rotation_written_otherwise_is_the_same_rotation(turn: Rotation) -> None:
    matrix = turn.as_matrix()
    vector, four = rigid.rotation_vector(matrix), rigid.quaternion(matrix)
    assert Rotation.from_rotvec(vector).as_matrix() == pytest.approx(matrix, abs=2e-8)
    assert np.linalg.norm(vector) == pytest.approx(turn.magnitude(), abs=2e-8)
    assert four[0] >= 0
    assert Rotation.from_quat(four, scalar_first=True).as_matrix() == pytest.approx(matrix, abs=1e-14)
    assert rigid.rotation_of(four) == pytest.approx(matrix, abs=1e-14)


@matrices
def test_turns_about_z_y_and_x_make_the_rotation(turn: Rotation) -> None:
    turns = rigid.zyx_turns(turn.as_matrix())
    assert Rotation.from_euler("ZYX", turns).as_matrix() == pytest.approx(turn.as_matrix(), abs=1e-14)
    assert abs(turns[1]) <= math.pi / 2 + 1e-12


@pytest.mark.parametrize("turn", QUARTERS, ids=("up", "down"))
def test_turns_belong_together_where_the_first_is_not_defined(turn: Rotation) -> None:
    turns = rigid.zyx_turns(turn.as_matrix())
    assert Rotation.from_euler("ZYX", turns).as_matrix() == pytest.approx(turn.as_matrix(), abs=1e-14)


def test_stacks_are_handled_row_by_row() -> None:
    stack = ALL.as_matrix()
    assert rigid.zyx_turns(stack) == pytest.approx(np.stack([rigid.zyx_turns(one) for one in stack]))
    fours = ALL.as_quat(scalar_first=True).reshape(-1, 2, 4)
    assert rigid.rotation_of(fours) == pytest.approx(stack.reshape(-1, 2, 3, 3))


@given(st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3).filter(lambda v: math.hypot(*v) > 1e-3))
def test_a_perpendicular_is_a_unit_vector_at_right_angles(vector: list[float]) -> None:
    found = rigid.perpendicular(np.array(vector))
    assert np.linalg.norm(found) == pytest.approx(1, abs=1e-14)
    assert abs(found @ rigid.unit(vector)) < 1e-14


def test_the_axial_vector_is_that_of_the_cross_product() -> None:
    w, v = np.random.default_rng(2).normal(size=(2, 5, 3))
    matrices = np.stack([np.cross(one, np.eye(3)).T for one in w])
    # the symmetric part is not looked at
    found = rigid.axial(matrices + np.eye(3))
    np.testing.assert_allclose(found, w, atol=1e-15)
    np.testing.assert_allclose((matrices @ v[:, :, None])[..., 0], np.cross(found, v), atol=1e-15)


def test_a_turn_by_any_number_is_a_rotation():
    for angle in (1e6, 4e7, 1e16, 1.7e98, 1e300):
        turn = rigid.about(0, angle)
        assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-15)
