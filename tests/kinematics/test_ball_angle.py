"""How far balls and universal joints are bent at poses, and slopes of angles between lines."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError
from sevenbar.kinematics.ranges.ball_angle import ball_angle, line_angles

LOOPS = ["rssr", "rscr", "rsur", "five_bar", "swash_plate", "rssp"]


def carried(linkage, circuit, link, direction):
    """A direction of a link along a circuit, from the traces of two of its points."""
    link = link or len(linkage.joints)
    ends = [circuit.point(link, tuple(place)).position for place in (np.zeros(3), direction)]
    return (ends[1] - ends[0]) / np.linalg.norm(direction)


@pytest.mark.parametrize("name", LOOPS)
def test_the_angle_is_that_between_lines_of_traced_points(name):
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


def test_slopes_of_an_angle_between_lines_are_those_of_differences_and_none_at_its_kink():
    rng = np.random.default_rng(2)
    ends, by = rng.normal(size=(5, 4, 3)), rng.normal(size=(5, 4, 3, 2))
    angles, slopes = line_angles(ends, by)
    for k in range(2):
        up, down = (line_angles(ends + way * 1e-6 * by[..., k], by)[0] for way in (1, -1))
        np.testing.assert_allclose(slopes[:, k], (up - down) / 2e-6, rtol=0, atol=1e-8)
    ends[:, 2:] = ends[:, :2] + 1.0
    angles, slopes = line_angles(ends, by)
    assert angles.max() < 1e-15
    assert np.isnan(slopes).all()


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
