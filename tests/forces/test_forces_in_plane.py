"""Forces of planar linkages in the report frame: the F12x, F12y of a textbook."""

import math
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.forces.result import Forces

#: A four-bar of uniform rods [m, kg/m], its crank at an angle with speed and acceleration; after a textbook.
CRANK, COUPLER, ROCKER, GROUND = 0.86, 1.85, 0.86, 2.22
BY_LENGTH = 23.4791
ANGLE, SPEED, ACCELERATION = math.radians(-36), -10.0, 10.0
#: What pushes at the coupler's centre [N].
PUSH = np.array([300.0, -400.0])


def turned(vector: Any) -> Any:
    return np.array([-vector[1], vector[0]])


def along(angle: float) -> Any:
    return np.array([math.cos(angle), math.sin(angle)])


def nine_equations(coupler: float, rocker: float) -> tuple[float, dict[str, Any]]:
    """Torque and joint forces of Newton and Euler, from guesses of the two other angles."""
    lengths = np.array([CRANK, COUPLER, -ROCKER])
    angles = np.array([ANGLE, coupler, rocker])
    for _ in range(50):
        left = sum(s * along(a) for s, a in zip(lengths, angles, strict=True)) - [GROUND, 0]
        slopes = np.column_stack([s * turned(along(a)) for s, a in zip(lengths[1:], angles[1:], strict=True)])
        angles[1:] -= np.linalg.solve(slopes, left)
    rates = [SPEED, *np.linalg.solve(slopes, -lengths[0] * SPEED * turned(along(ANGLE)))]
    pulls = sum(s * w**2 * along(a) for s, w, a in zip(lengths, rates, angles, strict=True))
    rest = pulls - lengths[0] * ACCELERATION * turned(along(ANGLE))
    seconds = [ACCELERATION, *np.linalg.solve(slopes, rest)]
    ends = [np.zeros(2), CRANK * along(ANGLE)]
    ends += [ends[1] + COUPLER * along(angles[1]), np.array([GROUND, 0.0])]

    def second(length: float, i: int) -> Any:
        return length * (seconds[i] * turned(along(angles[i])) - rates[i] ** 2 * along(angles[i]))

    at_pin = second(CRANK, 0)
    accelerations = [second(CRANK / 2, 0), at_pin + second(COUPLER / 2, 1), second(ROCKER / 2, 2)]
    # unknown: force of the link before in each joint on the link after, the torque
    matrix, right = np.zeros((9, 9)), np.zeros(9)
    for i, length in enumerate((CRANK, COUPLER, ROCKER)):
        mass, centre = BY_LENGTH * length, (ends[i] + ends[i + 1]) / 2
        for sign, joint in ((1.0, i), (-1.0, i + 1)):
            matrix[2 * i : 2 * i + 2, 2 * joint : 2 * joint + 2] = sign * np.eye(2)
            arm = ends[joint] - centre
            matrix[6 + i, 2 * joint : 2 * joint + 2] = sign * np.array([-arm[1], arm[0]])
        right[2 * i : 2 * i + 2] = mass * accelerations[i] - (PUSH if i == 1 else 0.0)
        right[6 + i] = mass * length**2 / 12 * seconds[i]
    matrix[6, 8] = 1.0
    found = np.linalg.solve(matrix, right)
    return float(found[8]), {f"theta_{i + 1}": found[2 * i : 2 * i + 2] for i in range(4)}


def push_of(circuit: sb.Circuit) -> Forces:
    rods = {link: sb.Body(BY_LENGTH * s, solid="rod") for link, s in ((1, CRANK), (2, COUPLER), (3, ROCKER))}
    load = sb.Load(2, force=(*PUSH, 0.0), at=(0, COUPLER / 2, 0))
    return circuit.forces(bodies=rods, loads=[load])


@pytest.mark.parametrize("row", [2, 7])
def test_a_planar_four_bar_has_the_joint_forces_of_newton_and_euler_in_the_report_frame(
    row: int,
) -> None:
    linkage = sb.four_bar(crank=CRANK, coupler=COUPLER, rocker=ROCKER, ground=GROUND, length_unit="m")
    times = np.array([-0.02, -0.01, 0.0, 0.01, 0.02])
    law = sb.Law.of(
        times, ANGLE + SPEED * times + ACCELERATION / 2 * times**2, SPEED + ACCELERATION * times, ACCELERATION
    )
    circuit = linkage.motion(law=law).circuits[0]
    forces = push_of(circuit)
    # both ways of assembling it, pass after pass
    pose = circuit.q[row]
    coupler = ANGLE + pose[1]
    torque, joints = nine_equations(coupler, coupler + pose[2])
    assert forces.torque[row] == pytest.approx(torque, rel=1e-9)
    for name, force in joints.items():
        found = forces.reactions[name].force_in_report[row]
        assert found[:2] == pytest.approx(force, rel=1e-9, abs=1e-9 * abs(torque))
        # across the plane rigid bodies leave it open
        assert np.isnan(found[2])
    moment = forces.reactions["theta_1"].moment_in_report[row]
    assert moment[2] == pytest.approx(torque, rel=1e-9)
    assert np.isnan(moment[:2]).all()


def test_what_is_determined_whole_is_the_same_turned_into_the_report_frame() -> None:
    forces = sb.load("rssr_press").motion(samples=36).circuits[0].forces()
    for reaction in forces.reactions.values():
        assert reaction.determinate.all()
        turned_force = np.einsum("nij,nj->ni", reaction.axes, reaction.force)
        turned_moment = np.einsum("nij,nj->ni", reaction.axes, reaction.moment)
        assert reaction.force_in_report == pytest.approx(turned_force, rel=1e-12, abs=1e-9)
        assert reaction.moment_in_report == pytest.approx(turned_moment, rel=1e-12, abs=1e-9)


def test_a_plane_askew_leaves_open_what_has_a_part_across_it() -> None:
    normal = np.array([0.0, math.sin(0.3), math.cos(0.3)])
    level = np.array([1.0, 0.0, 0.0])
    other = np.cross(normal, level)
    places = [(0.0, 0.0), (40.0, 0.0), (78.359375, 92.3512), (90.0, 0.0)]
    joints = [
        {
            "kind": "R",
            "name": f"j{i}",
            "at": [float(x) for x in a * level + b * other],
            "axis": normal.tolist(),
        }
        for i, (a, b) in enumerate(places)
    ]
    lines = "\n".join(
        f'[[joint]]\nname = "{j["name"]}"\nkind = "R"\nat = {j["at"]}\naxis = {j["axis"]}' for j in joints
    )
    rod = "\n".join(f'[[body]]\nlink = {i}\nmass = 1\nsolid = "rod"' for i in (1, 2, 3))
    linkage = sb.loads(f'format = 1\nlength_unit = "mm"\n{lines}\n{rod}\n')
    reaction = linkage.motion(samples=12).circuits[0].forces().reactions["j0"]
    force = reaction.force_in_report
    assert np.isfinite(force[:, 0]).all()
    assert np.isnan(force[:, 1:]).all()
