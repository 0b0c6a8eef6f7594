"""What the page of conventions says of frames, zeros, statuses and rates is what the program does.

Source: the page's own words and formulas, evaluated here by hand.
"""

import math
import re

import numpy as np
import pytest

import sevenbar as sb
from places import DOCS
from sevenbar.design.tolerance.sensitivities import NEAR
from sevenbar.kinematics.circuits.circuit_values import SPIN_UNDEFINED, STATUSES
from sevenbar.kinematics.loop.joints import KINDS

PAGE = (DOCS / "conventions.md").read_text(encoding="utf-8")

UNIT = np.eye(3)


def along(circuit: sb.Circuit, link: int, row: int) -> list[np.ndarray]:
    """Origin and axes of the frame in which points of a link are written."""
    origin, *ends = (circuit.point(link, tuple(at)).position[row] for at in (np.zeros(3), *UNIT))
    return [origin, *(end - origin for end in ends)]


def table(heading: str) -> list[list[str]]:
    """The rows of the first table below a heading."""
    text = PAGE.partition(f"\n## {heading}\n")[2]
    (rows, *_) = re.findall(r"^\|---.*\n((?:\|.*\n)+)", text, flags=re.MULTILINE)
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]] for row in rows.splitlines()]


def test_every_status_is_told():
    told = [row[0].strip("`") for row in table("Statuses")]
    assert told == [*STATUSES, SPIN_UNDEFINED, NEAR]


def test_joint_kinds_have_the_columns_that_are_told():
    assert {row[0]: row[1].split(", ") for row in table("Joints")} == {
        k: [*v.freedoms] for k, v in KINDS.items()
    }


def test_frames_of_the_rssr_are_those_of_the_table():
    M, N, L1, L3, D = 700.0, 600.0, 250.0, 550.0, 120.0
    circuit = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=D).motion(samples=7).circuits[0]
    for row, (a, b) in enumerate(zip(circuit.input, circuit.output, strict=True)):
        ball_a = np.array([L1 * math.cos(a), L1 * math.sin(a), N])
        ball_b = np.array([M, D + L3 * math.cos(b), L3 * math.sin(b)])
        coupler = (ball_b - ball_a) / np.linalg.norm(ball_b - ball_a)
        nearest = UNIT[2] - coupler * coupler[2]
        want = {
            1: ([0, 0, N], (ball_a - [0, 0, N]) / L1, UNIT[2]),
            2: (ball_a, coupler, nearest / np.linalg.norm(nearest)),
            3: (ball_b, (np.array([M, D, 0]) - ball_b) / L3, UNIT[0]),
            4: (np.zeros(3), UNIT[0], UNIT[2]),
        }
        for link, (origin, x, z) in want.items():
            frame = along(circuit, link, row)
            np.testing.assert_allclose(frame, [origin, x, np.cross(z, x), z], atol=1e-10)


def test_a_point_of_a_row_is_written_from_where_the_link_before_meets_the_axis():
    linkage = sb.load("seven_r")
    circuit = linkage.motion(samples=4).circuits[2]
    ground = along(circuit, 7, 0)
    # the ground's link is row 7: its offset of -60 leads along i to the origin, where the link begins along j
    np.testing.assert_allclose(ground, [[60, 0, 0], *UNIT], atol=1e-10)
    first = along(circuit, 1, 1)
    theta, twist = circuit.input[1], math.radians(150)
    axis = np.array([math.cos(twist), 0, -math.sin(twist)])  # e_g turned about e_7 by the twist of link 7
    link = math.cos(theta) * UNIT[1] + math.sin(theta) * np.cross(axis, UNIT[1])
    np.testing.assert_allclose(first, [[0, 35, 0], axis, link, np.cross(axis, link)], atol=1e-10)


@pytest.mark.parametrize("method", ["auto", "general"])
def test_rates_are_at_the_speed_of_the_drive_on_every_pass(method):
    linkage = sb.rssr(M=700, N=700, L1=285, L3=550, D=0, speed=3)
    (circuit,) = linkage.motion(samples=24, method=method).circuits
    assert set(circuit.branch) == {0, 1}
    assert circuit.input[0] == circuit.input.min()
    moving = circuit.status == "ok"
    np.testing.assert_array_equal(circuit.dq[moving, circuit.input_column], 3.0)
    assert np.isnan(circuit.dq[circuit.status == "dead-centre"]).all()
    assert (np.diff(circuit.time) > 0).all()
    back = np.diff(circuit.input)[circuit.branch[1:] == 1]
    assert (back[1:] < 0).all()


def test_a_screw_advances_by_its_pitch_a_turn_right_handed():
    """A loop of a screw and a slide on one axis: both count the one link against the ground."""
    joints = [
        {"name": "thread", "kind": "H", "at": (0, 0, 0), "axis": (0, 0, 1), "pitch": 8.0},
        {"name": "nut", "kind": "C", "at": (0, 0, 0), "axis": (0, 0, 1)},
    ]
    (mode,) = sb.from_axes(joints).assembly_modes(math.pi / 2).q
    assert mode == pytest.approx([math.pi / 2, math.pi / 2, 2.0], abs=1e-9)
