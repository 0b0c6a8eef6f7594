"""Loops on whole numbers, whose circuits touch or cross: followed to their ends in any frame, and each once."""

from math import radians

import numpy as np
import pytest

import sevenbar as sb
from evidence.rewritten.families import lattice
from evidence.rewritten.ways import ways

#: Axes of a 7R on whole numbers: places and directions. Three circuits cross in six poses, and two touch in a seventh.
WHOLE = (
    ((2, -1, 2), (0, 1, 0)), ((1, 0, 1), (1, 0, 0)), ((-1, 2, 0), (0, 1, 0)), ((0, 0, 0), (1, 0, 0)),
    ((-2, -2, -1), (0, 1, 0)), ((-2, -1, 1), (0, 1, 0)), ((-1, 1, -2), (0, 1, 1)),
)  # fmt: skip


@pytest.mark.parametrize("written", ["as drawn", "mirrored", "turned"])
def test_circuits_that_touch_do_not_break_off_in_any_frame(written: str) -> None:
    frame = np.eye(3)
    if written == "mirrored":
        frame = np.diag([-1.0, 1.0, 1.0])
    elif written == "turned":
        frame = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    joints = [
        {"kind": "R", "at": (frame @ at).tolist(), "axis": (frame @ axis).tolist()} for at, axis in WHOLE
    ]
    motion = sb.from_axes(joints).motion(36)
    assert len(motion.limits) == 28
    assert (motion.completeness, motion.search.unfollowed) == ("counted", 0)
    assert all(circuit.closed for circuit in motion)
    assert [point.ways for point in motion.change_points] == [4] * 7


def in_whole_numbers(index: int, name: str) -> sb.Motion:
    """The motion of a loop on the lattice, written as the name says."""
    one = lattice(index, seed=1)
    (way,) = (way for way in ways(one, np.random.default_rng(1)) if way.name == name)
    return way.linkage.motion(36, input=way.input, output=way.output)


@pytest.mark.parametrize("name", ["as drawn", "turned 1", "mirrored and turned"])
def test_three_curves_through_one_pose_are_all_followed_in_any_frame(name: str) -> None:
    # two lie in a plane and the third leaves it, and steps that begin in the plane stay there
    motion = in_whole_numbers(628, name)
    assert all(circuit.closed for circuit in motion)
    assert sorted(point.ways for point in motion.change_points) == [4, 4, 6]
    assert sorted(len(circuit.dead_centres) for circuit in motion) == [4, 6, 6, 22]


@pytest.mark.parametrize("name", ["as drawn", "axes reversed", "places moved, turned", "as rows"])
def test_curves_that_touch_so_closely_that_rounding_hides_them_from_afar_do_not_break_off(name: str) -> None:
    motion = in_whole_numbers(539, name)
    assert len(motion.circuits) == 4
    assert all(circuit.closed for circuit in motion)
    assert [point.ways for point in motion.change_points] == [4, 4]


@pytest.mark.parametrize("name", ["as drawn", "mirrored", "axes reversed", "turned and moved off"])
def test_an_output_that_turns_back_in_a_pose_of_whole_numbers_and_next_to_it_does_both(name: str) -> None:
    # by 3.6e-6 rad, within a step that ends in that pose
    motion = in_whole_numbers(1198, name)
    assert sorted(len(circuit.dead_centres) for circuit in motion) == [6, 8, 14]


@pytest.mark.parametrize("name", ["as drawn", "mirrored", "as rows"])
def test_an_output_that_turns_back_where_its_rate_is_rounding_does_so_once(name: str) -> None:
    motion = in_whole_numbers(1416, name)
    turning_back = [circuit for circuit in motion if circuit.input_range is not None]
    assert [len(circuit.dead_centres) for circuit in turning_back] == [6, 6]
    for circuit in turning_back:
        assert circuit.swing == pytest.approx(1.854590436, abs=1e-8)


def test_a_circuit_runs_on_where_a_ball_crosses_the_last_axis() -> None:
    up, along = [0, 0, 1], [1, 0, 0]
    turns = [((1, 1, 2), up), ((-1, -1, -2), up), ((1, -2, 2), up), ((2, 0, 0), along)]
    joints = [{"kind": "R", "at": list(at), "axis": axis} for at, axis in turns]
    joints.insert(2, {"kind": "S", "at": [0, 0, 0]})
    motion = sb.from_axes(joints).motion()
    ranges = sorted(np.degrees(circuit.input_range).tolist() for circuit in motion)
    expected = [[-32.4919, 29.1403], [60.8597, 122.4919], [85.1392, 364.8608]]
    assert np.allclose(ranges, expected, atol=1e-3)
    assert all(circuit.closed for circuit in motion)
    assert len(motion.change_points) == 4
    # the ball may also stay on the axis while the last joint spins: that is not followed, and said
    assert motion.search.unfollowed > 0


def test_rows_of_whole_numbers_whose_circuits_touch_are_counted() -> None:
    motion = sb.from_dh(
        "R" * 7,
        length=[1, 0, 1, 1, 1, 1, 1],
        twist=[radians(t) for t in (45, 90, 90, -90, 90, 45, 45)],
        offset=[1, 1, 0, 0, 0, 0, 0],
    ).motion(36)
    assert motion.motion_type == "change-point"
    assert motion.completeness == "counted"
    assert all(circuit.closed for circuit in motion)
    assert [point.ways for point in motion.change_points] == [4]


def test_a_circuit_that_is_not_known_to_close_ends_in_a_change_point() -> None:
    motion = sb.from_dh(
        "R" * 7,
        length=[1, 2, 1, 0, 1, 1, 0],
        twist=[radians(t) for t in (90, -90, 90, 90, 0, 90, 90)],
        offset=[1, 0, 0, 0, 1, 0, 0],
    ).motion(36)
    assert motion.completeness != "counted"
    passing = {number for point in motion.change_points for number in point.circuits}
    assert {circuit.index for circuit in motion if not circuit.closed} <= passing
