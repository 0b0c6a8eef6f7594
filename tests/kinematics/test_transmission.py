"""The transmission angle and the mechanical advantage against the laws of cosines, at 40 digits where needed."""

from math import acos, asin, cos, pi, radians

import mpmath
import numpy as np
import pytest

import sevenbar as sb
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.transmission.angle import coupling_of
from textbook_loops import (
    four_bar_joints,
    linkage,
    moved,
    rotation,
    slider_crank_joints,
    spherical_joints,
)

mpmath.mp.dps = 40


def acute(angle):
    return min(angle, pi - angle)


def planar_angle(crank, coupler, rocker, ground, theta):
    """Between coupler and rocker by the law of cosines."""
    square = crank**2 + ground**2 - 2 * crank * ground * mpmath.cos(theta)
    return float(mpmath.acos((coupler**2 + rocker**2 - square) / (2 * coupler * rocker)))


def spherical_angle(crank, coupler, rocker, ground, theta):
    """Between the arcs of coupler and rocker by the spherical law of cosines."""
    diagonal = mpmath.cos(crank) * mpmath.cos(ground) + mpmath.sin(crank) * mpmath.sin(ground) * mpmath.cos(
        theta
    )
    cosine = (diagonal - mpmath.cos(coupler) * mpmath.cos(rocker)) / (
        mpmath.sin(coupler) * mpmath.sin(rocker)
    )
    return float(mpmath.acos(cosine))


CRANK_ROCKERS = [(40, 100, 80, 90), (2, 7, 9, 8), (1, 2.6, 2.5, 2.4), (0.1, 0.4, 0.3, 0.35)]


@pytest.mark.parametrize("lengths", CRANK_ROCKERS)
def test_of_a_planar_four_bar_it_is_that_of_the_law_of_cosines_on_every_row(lengths):
    found = linkage(four_bar_joints(*lengths))
    # the crank's angle in the drawn pose, from the line to the other pivot
    x, y, _ = four_bar_joints(*lengths)[1]["at"]
    drawn = np.arctan2(y, x)
    for circuit in found.motion(72):
        expected = [acute(planar_angle(*lengths, drawn + theta)) for theta in circuit.input]
        assert np.abs(circuit.transmission_angle - expected).max() < 1e-12
        # the greatest and the least are on the line of the pivots, the least at one of both
        ends = [planar_angle(*lengths, theta) for theta in (0, pi)]
        extremes = circuit.transmission
        assert extremes.lowest == pytest.approx(min(map(acute, ends)), abs=1e-12)
        at = planar_angle(*lengths, drawn + extremes.lowest_at)
        assert acute(at) == pytest.approx(extremes.lowest, abs=1e-12)
        line = (drawn + extremes.lowest_at) / pi
        assert abs(line - round(line)) < 1e-11
        highest = pi / 2 if min(ends) < pi / 2 < max(ends) else max(map(acute, ends))
        assert extremes.highest == pytest.approx(highest, abs=1e-12)


def test_random_planar_four_bars_have_the_extremes_of_the_law_of_cosines_either_way():
    rng = np.random.default_rng(11)
    for number in range(60):
        lengths = rng.uniform(1, 10, 4)
        joints = four_bar_joints(*lengths)
        if joints is None or max(lengths) > 0.97 * (sum(lengths) - max(lengths)):
            continue
        found = linkage(moved(joints, rotation(rng), rng.normal(size=3) * 10))
        names = ("crank", "rocker") if number % 2 else ("rocker", "crank")
        motion = found.motion(36, input=names[0], output=names[1])
        a, b, c, d = lengths if number % 2 else lengths[[2, 1, 0, 3]]
        reach = [abs(d - a), d + a]
        low, high = max(reach[0], abs(b - c)), min(reach[1], b + c)
        ends = [acos(np.clip((b * b + c * c - x * x) / (2 * b * c), -1, 1)) for x in (low, high)]
        for circuit in motion:
            extremes = circuit.transmission
            # on dead centres cosines near 1 keep half the digits
            assert extremes.lowest == pytest.approx(min(map(acute, ends)), abs=1e-7)
            if not circuit.turns_back:
                assert extremes.lowest == pytest.approx(min(map(acute, ends)), abs=1e-12)
            else:
                assert extremes.lowest == 0.0
            right = min(ends) < pi / 2 < max(ends)
            assert extremes.highest == pytest.approx(pi / 2 if right else max(map(acute, ends)), abs=1e-11)


@pytest.mark.parametrize(
    ("crank", "rod", "offset"), [(40, 140, 0), (40, 140, 10), (0.1, 0.26, 0.1), (1, 3, 1.5)]
)
def test_of_a_slider_crank_it_is_the_rods_angle_against_the_normal_of_the_slide(crank, rod, offset):
    found = linkage(slider_crank_joints(crank, rod, offset, at=1.0))
    for circuit in found.motion(72):
        sine = (offset - crank * np.sin(1.0 + circuit.input)) / rod
        pressure = np.abs(np.arcsin(sine))
        assert np.abs(circuit.transmission_angle - (pi / 2 - pressure)).max() < 1e-12
        greatest = max(abs(asin((offset - s * crank) / rod)) for s in (-1, 1))
        assert circuit.transmission.lowest == pytest.approx(pi / 2 - greatest, abs=1e-13)
        assert cos(1.0 + circuit.transmission.lowest_at) == pytest.approx(0, abs=1e-11)
        least = 0 if abs(offset) <= crank else abs(asin((offset - crank) / rod))
        assert circuit.transmission.highest == pytest.approx(pi / 2 - least, abs=1e-12)
    # driven by the slide, the angle between rod and crank
    for circuit in found.motion(72, input="slider", output="crank"):
        pin = circuit.point(1, found.description["joint"][1]["at"]).position[:, :2]
        wrist = circuit.point(3, found.description["joint"][2]["at"]).position[:, :2]
        rods = wrist - pin
        assert np.abs(np.hypot(*rods.T) - rod).max() < 1e-11 * rod
        cross = np.abs(pin[:, 0] * rods[:, 1] - pin[:, 1] * rods[:, 0]) / (crank * rod)
        inside = circuit.status == "ok"
        assert np.abs(np.sin(circuit.transmission_angle) - cross)[inside].max() < 1e-12
        assert circuit.transmission.lowest == 0.0


def test_of_an_inverted_slider_crank_the_force_is_square_to_the_rocker():
    # crank pin in a slot of a rocker whose line goes through its own pivot
    joints = [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"name": "pin", "kind": "R", "at": [30, 0, 0], "axis": [0, 0, 1]},
        {"name": "slot", "kind": "P", "at": [30, 0, 0], "axis": [30, 80, 0]},
        {"name": "rocker", "kind": "R", "at": [0, -80, 0], "axis": [0, 0, 1]},
    ]
    for circuit in linkage(joints).motion(36):
        assert circuit.transmission_angle == pytest.approx(pi / 2, abs=1e-12)
        assert circuit.transmission.lowest == pytest.approx(pi / 2, abs=1e-12)


ARCS = [
    tuple(map(radians, a))
    for a in ((30, 80, 70, 85), (20, 60, 50, 70), (40, 90, 100, 95), (35, 120, 75, 110))
]


@pytest.mark.parametrize("arcs", ARCS)
def test_of_a_spherical_four_bar_it_is_that_of_the_spherical_law_of_cosines(arcs):
    joints = spherical_joints(*arcs)
    a = joints[1]["axis"]
    drawn = np.arctan2(a[1], a[0])
    for circuit in linkage(joints).motion(72):
        expected = [acute(spherical_angle(*arcs, drawn + x)) for x in circuit.input]
        assert np.abs(circuit.transmission_angle - expected).max() < 1e-12
        ends = [spherical_angle(*arcs, x) for x in (0, pi)]
        assert circuit.transmission.lowest == pytest.approx(min(map(acute, ends)), abs=1e-12)
        highest = pi / 2 if min(ends) < pi / 2 < max(ends) else max(map(acute, ends))
        assert circuit.transmission.highest == pytest.approx(highest, abs=1e-12)


@pytest.mark.parametrize("side", ["crank", "rocker"])
def test_of_an_rssr_the_general_way_has_what_the_closed_form_has(side):
    for given in (
        {"M": 700, "N": 700, "L1": 250, "L3": 550, "D": 0},
        {"M": 5, "N": 3, "L1": 1, "L2": 6, "L3": 4, "D": 1.5},
    ):
        one = sb.rssr(**given)
        pairs = zip(one.motion(input=side), one.motion(input=side, method="general"), strict=True)
        for closed, general in pairs:
            for name in ("lowest", "highest"):
                assert getattr(general.transmission, name) == pytest.approx(
                    getattr(closed.transmission, name), abs=1e-12
                )
            angles = closed.transmission_angle
            assert np.nanmin(angles) >= closed.transmission.lowest - 1e-12
            assert np.nanmax(angles) <= closed.transmission.highest + 1e-12


def ball(found, circuit, joint, link):
    """The places (n, 3) of a ball along a circuit, as a point of a link before (link = joint) or after it."""
    at = found.links[link - 1][:3, 3] if joint == link else np.zeros(3)
    own = np.linalg.inv(found.point_frames[link - 1]) @ (*at, 1.0)
    return circuit.point(link, tuple(own[:3])).position


def test_of_a_spatial_slider_crank_it_is_that_of_the_rods_line_either_way():
    found = sb.load("rssp")
    for circuit in found.motion(72):
        a, b = ball(found, circuit, 1, 1), ball(found, circuit, 2, 3)
        line = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
        way = b[5] - b[20]
        assert (
            np.abs(np.sin(circuit.transmission_angle) - np.abs(line @ way) / np.linalg.norm(way)).max()
            < 1e-12
        )
    for circuit in found.motion(72, input=found.columns[-1], output=found.columns[0]):
        a, b = ball(found, circuit, 1, 1), ball(found, circuit, 2, 3)
        line = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
        way = np.cross(found.base[:3, 2], a - found.base[:3, 3])
        sine = np.abs((line * way).sum(axis=1)) / np.linalg.norm(way, axis=1)
        inside = circuit.status != "dead-centre"
        assert np.abs(np.sin(circuit.transmission_angle) - sine)[inside].max() < 1e-12
        assert circuit.transmission.lowest == 0.0


def test_through_a_ball_beside_other_joints_the_force_is_square_to_what_they_do():
    drawn = sb.load("rscr")
    assert coupling_of(drawn, 0, len(drawn.columns) - 1) is None  # the output is driven through a cylinder
    # the same loop from its other end: rocker, cylinder, ball, crank
    joints = [dict(joint) for joint in reversed(drawn.description["joint"])]
    found = linkage(joints)
    ball_at = np.array([*joints[2]["at"], 1.0])
    axis, foot = np.array(joints[3]["axis"], dtype=float), np.array(joints[3]["at"], dtype=float)

    def place(q):
        """The ball as a point of the link that the input and the cylinder carry, drawn with all at zero."""
        return (poses(found, q[None])[0, 1] @ found.point_frames[1] @ ball_at)[:3]

    defined = 0
    for circuit in found.motion(24):
        angle = circuit.transmission_angle
        for row in np.flatnonzero(circuit.status == "ok")[::2]:
            q = circuit.q[row]
            here, step = place(q), 1e-5
            ways = []
            for column in (1, 2):
                more, less = q.copy(), q.copy()
                more[column] += step
                less[column] -= step
                ways.append((place(more) - place(less)) / (2 * step))
            force, w = np.cross(*ways), np.cross(axis, here - foot)
            sine = abs(force @ w) / np.linalg.norm(force) / np.linalg.norm(w)
            assert np.sin(angle[row]) == pytest.approx(sine, abs=1e-8)
            defined += 1
        dead = any(centre.kind == "input" for centre in circuit.dead_centres)
        assert (circuit.transmission.lowest == 0.0) == dead
    assert defined > 8


def test_loops_for_which_no_angle_is_defined_have_none():
    for name in ("bennett", "seven_r", "rccc", "sarrus", "five_bar", "rscr"):
        circuit = sb.load(name).motion(24).circuits[0]
        assert circuit.transmission is None
        assert circuit.transmission_angle is None


def test_extremes_do_not_depend_on_samples_speed_or_law():
    found = sb.load("planar_4r")
    reference = found.motion().circuits[0].transmission
    t = np.linspace(0, 1, 7)
    for motion in (
        found.motion(4),
        found.motion(7),
        found.motion(speed=-2.0),
        found.motion(law=sb.Law.of(t, q=t, dq=1.0, ddq=0.0)),
    ):
        extremes = motion.circuits[0].transmission
        assert extremes.lowest == pytest.approx(reference.lowest, abs=1e-13)
        assert extremes.highest == pytest.approx(reference.highest, abs=1e-12)


@pytest.mark.parametrize(
    "lengths", [(1, 1, 1, 1), (2, 1, 2, 1), (3, 5, 3, 5), (0.3, 0.1, 0.3, 0.1), (2, 3, 3, 2)]
)
def test_squares_parallelograms_and_kites_have_angles_on_every_row(lengths):
    found = sb.from_dh("RRRR", length=lengths, twist=[0] * 4, offset=[0] * 4)
    for circuit in found.motion(36):
        angle = circuit.transmission_angle
        known = np.isfinite(angle)
        assert known.sum() > 20
        assert circuit.transmission.lowest < 1e-6
        assert np.nanmin(angle) >= 0
        assert np.nanmax(angle) <= circuit.transmission.highest + 1e-12


def test_the_table_has_a_column_of_it_where_it_is_defined():
    columns = sb.load("planar_4r").motion(24).columns()
    angle = sb.load("planar_4r").motion(24).circuits[0].transmission_angle
    assert columns["transmission_deg"][:24] == pytest.approx(np.degrees(angle))
    assert "transmission_rad" in sb.load("planar_4r").motion(24).columns(si=True)
    assert not [name for name in sb.load("seven_r").motion(24).columns() if "transmission" in name]


def test_the_mechanical_advantage_is_the_inverse_ratio_of_the_speeds():
    for name in ("planar_4r", "rssr", "rssp", "bennett"):
        circuit = sb.load(name).motion(72).circuits[0]
        ratio = circuit.dq[:, circuit.output_column] / circuit.dq[:, circuit.input_column]
        assert np.abs(circuit.mechanical_advantage * ratio - 1).max() < 1e-12


def test_of_a_universal_joint_it_is_between_the_cosine_of_the_bend_and_its_inverse():
    found = sb.load("universal_joint")
    for circuit in found.motion(72):
        # of a bend with the cosine 0.8
        ends = sorted(map(abs, (circuit.advantage.lowest, circuit.advantage.highest)))
        assert ends == pytest.approx([0.8, 1.25], abs=1e-12)
        there = found.circuit(
            circuit.q[0],
            law=sb.Law.of([0.0, 1.0], [circuit.advantage.lowest_at, circuit.advantage.highest_at], 1.0, 0.0),
        )
        assert there.mechanical_advantage == pytest.approx(
            [circuit.advantage.lowest, circuit.advantage.highest], abs=1e-9
        )


def test_it_has_extremes_where_the_output_never_stands_still():
    drag = sb.from_dh("RRRR", length=[80, 70, 90, 30], twist=[0] * 4, offset=[0] * 4)
    for circuit in drag.motion(360):
        values = circuit.mechanical_advantage
        assert circuit.advantage.lowest <= values.min() + 1e-12
        assert circuit.advantage.highest >= values.max() - 1e-12
        assert circuit.advantage.lowest == pytest.approx(values.min(), rel=1e-3)
    back = sb.load("planar_4r").motion(input="theta_4", output="theta_1").circuits[0]
    assert back.motion_type == "rocker-crank"
    assert back.mechanical_advantage[back.status == "dead-centre"] == pytest.approx(0)
    assert (
        np.abs(back.mechanical_advantage).max()
        <= max(abs(back.advantage.lowest), back.advantage.highest) + 1e-12
    )
    assert sb.load("planar_4r").motion().circuits[0].advantage is None


def test_by_statics_the_torque_follows_from_the_force_of_the_coupler():
    # a force along the coupler: its moment about the rocker's pivot over that about the crank's
    lengths = (40, 100, 80, 90)
    joints = four_bar_joints(*lengths)
    x, y, _ = joints[1]["at"]
    drawn = np.arctan2(y, x)
    circuit = linkage(joints).motion(72).circuits[0]
    a = circuit.point(1, joints[1]["at"]).position[:, :2]
    b = circuit.point(3, joints[2]["at"]).position[:, :2]
    assert (
        np.hypot(
            *(a - 40 * np.column_stack([np.cos(drawn + circuit.input), np.sin(drawn + circuit.input)])).T
        ).max()
        < 1e-12
    )
    line = b - a

    def moment(place):
        return place[:, 0] * line[:, 1] - place[:, 1] * line[:, 0]

    ratio = moment(b - (90, 0)) / moment(a)
    # a drawn rocker may be counted against its axis
    apart = np.minimum(
        np.abs(circuit.mechanical_advantage - ratio), np.abs(circuit.mechanical_advantage + ratio)
    )
    assert (apart / np.abs(ratio)).max() < 1e-10


def test_an_output_at_rest_gives_no_number_of_rounding():
    # the crossed position of a square, in which the output does not turn
    resting = sb.four_bar(50, 50, 50, 50).motion(36).circuits[0]
    moving = np.isfinite(resting.mechanical_advantage)
    assert np.isinf(resting.mechanical_advantage).any()
    assert np.abs(resting.mechanical_advantage[moving]).max(initial=0.0) < 1e9
