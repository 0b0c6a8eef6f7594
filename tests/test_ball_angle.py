"""How far balls and universal joints are bent at poses, and its slopes by the joints."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError
from sevenbar.kinematics.ball_angle import ball_angle
from sevenbar.kinematics.sensitivity import Numbers, ball_rotations

LOOPS = ["rssr", "rscr", "rsur", "five_bar", "swash_plate", "rssp"]


def carried(linkage, circuit, link, direction):
    """A direction of a link along a circuit, from the traces of two of its points."""
    link = link or len(linkage.joints)
    ends = [circuit.point(link, tuple(place)).position for place in (np.zeros(3), direction)]
    return (ends[1] - ends[0]) / np.linalg.norm(direction)


@pytest.mark.parametrize("name", LOOPS)
def test_the_angle_is_that_between_lines_of_traced_points_and_its_slopes_are_those_of_differences(name):
    rng = np.random.default_rng(1)
    linkage = sb.load(name)
    circuit = linkage.motion(24).circuits[0]
    for place, joint in enumerate(linkage.joints):
        if not joint.row.bends:
            continue
        seat, stud = rng.normal(size=(2, 3))
        bend = ball_angle(linkage, joint.name, seat, stud)
        own = carried(linkage, circuit, place, seat), carried(linkage, circuit, place + 1, stud)
        expected = np.arccos((own[0] * own[1]).sum(axis=1))
        np.testing.assert_allclose(bend.at(circuit.q), expected, rtol=0, atol=1e-11)
        slopes, step = bend.slopes(circuit.q), 1e-6
        for column in range(circuit.q.shape[1]):
            change = step * np.eye(circuit.q.shape[1])[column]
            difference = (bend.at(circuit.q + change) - bend.at(circuit.q - change)) / (2 * step)
            np.testing.assert_allclose(slopes[:, column], difference, rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", LOOPS)
def test_poses_of_the_word_have_the_same_angle_where_the_rod_is_the_stud(name):
    linkage = sb.load(name)
    q, numbers = linkage.motion(24).circuits[0].q, Numbers(linkage)
    for joint in linkage.joints:
        if not joint.row.bends:
            continue
        of_rows = ball_angle(linkage, joint.name).at(q)
        of_word = ball_angle(linkage, joint.name, numbers=numbers).at(numbers.poses(q))
        np.testing.assert_allclose(of_word, of_rows, rtol=0, atol=1e-13)


def test_the_ball_of_a_crank_with_square_axes_has_the_angle_of_the_formula():
    # crank about z, so its axis and the coupler enclose acos of the ball's drop over the coupler's length
    M, N, L1, L3 = 700.0, 700.0, 250.0, 550.0
    linkage = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=0)
    circuit = linkage.motion(36).circuits[0]
    length = math.sqrt((L1 - M) ** 2 + L3**2 + N**2)
    height_of_b = L3 * np.sin(circuit.output)
    expected = np.arccos((N - height_of_b) / length)
    found = ball_angle(linkage, "ball_a", seat=(0, 0, -1)).at(circuit.q)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)


def test_slopes_by_rotation_are_those_of_a_small_turn():
    linkage = sb.load("rscr")
    bend = ball_angle(linkage, "ball", seat=(1, 2, 0))
    q = linkage.motion(12).circuits[0].q
    turn, step = bend.rotation(q), 1e-6
    for axis, by in enumerate(bend.rotation_slopes(q).T):
        way = np.zeros((1, 3))
        # turns about z, y and x
        way[0, 2 - axis] = step
        ahead, back = (np.arccos((ball_rotations(s * way) @ turn @ bend.stud) @ bend.seat) for s in (1, -1))
        np.testing.assert_allclose(by, (ahead - back) / (2 * step), rtol=0, atol=1e-8)


def test_at_the_tip_the_angle_is_zero_and_its_slopes_are_too():
    linkage = sb.load("rscr")
    bend = ball_angle(linkage, "ball", seat=(1, 0, 0), stud=(1, 0, 0))
    q = linkage.motion(12).circuits[0].q[:1].copy()
    along = bend.rotation(q)[0].T @ bend.seat
    exact = ball_angle(linkage, "ball", seat=(1, 0, 0), stud=_written(linkage, along))
    assert exact.at(q)[0] < 1e-15
    assert not exact.slopes(q).any()


def _written(linkage, direction):
    """A direction in the frame after the ball of an RSCR, as points of its link are written."""
    return linkage.point_frames[1][:3, :3].T @ direction


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ("crank", "joint: 'crank' is not a joint S or U, which a cone is of; give one of ball_a, ball_b"),
        ("ball", "joint: no joint 'ball'"),
    ],
)
def test_a_joint_without_a_cone_is_refused(joint, message):
    with pytest.raises(RequestError, match=message):
        ball_angle(sb.load("rssr"), joint)


def test_a_direction_of_no_length_is_refused():
    with pytest.raises(RequestError, match=r"seat: .* is not a direction; give three numbers, not all 0"):
        ball_angle(sb.load("rssr"), "ball_a", seat=(0, 0, 0))
