"""Screw axes, axodes, centrodes and instant centres against formulas of their own."""

from math import hypot, radians

import numpy as np
import pytest

import sevenbar as sb
from textbook_loops import four_bar_joints, linkage, moved, rotation, slider_crank_joints, spherical_joints

LENGTHS = (40, 100, 80, 90)


def four_bar():
    joints = four_bar_joints(*LENGTHS)
    return joints, linkage(joints)


def line_meets(a, b, c, d):
    """Where the line through a and b meets that through c and d, in the plane."""
    matrix = np.column_stack([np.subtract(b, a), np.subtract(c, d)])
    s, _ = np.linalg.solve(matrix, np.subtract(c, a))
    return np.asarray(a) + s * np.subtract(b, a)


def test_the_coupler_turns_about_where_crank_and_rocker_meet():
    joints, found = four_bar()
    for circuit in found.motion(72):
        axes = circuit.screw_axes(2)
        a = circuit.point(1, joints[1]["at"]).position[:, :2]
        b = circuit.point(3, joints[2]["at"]).position[:, :2]
        for k in range(len(a)):
            # where crank and rocker are nearly parallel the centre is far away
            expected = line_meets((0, 0), a[k], (90, 0), b[k])
            assert axes.point[k, :2] == pytest.approx(
                expected, abs=1e-10 * max(100, *abs(expected)) ** 2 / 100
            )
        assert np.abs(axes.pitch).max() < 1e-9
        assert np.abs(np.abs(axes.direction[:, 2]) - 1).max() < 1e-14
        # the velocity of a pin is the rate times its distance
        speed = np.linalg.norm(circuit.point(1, joints[1]["at"]).velocity, axis=1)
        arm = np.hypot(*(a - axes.point[:, :2]).T)
        assert speed == pytest.approx(arm * axes.rate, rel=1e-10)
        assert set(axes.status) == {"ok"}


def test_the_centrodes_roll_on_each_other():
    _, found = four_bar()
    circuit = found.motion(720).circuits[0]
    axes = circuit.screw_axes(2)
    moving, fixed = axes.moving_point, axes.fixed_point
    # a row's moving point, carried by the link, is the fixed point there
    for k in (0, 100, 333, 650):
        carried = circuit.point(2, tuple(moving[k])).position[k]
        assert carried == pytest.approx(fixed[k], abs=1e-9)
        # and rests
        speed = np.linalg.norm(circuit.point(2, tuple(moving[k])).velocity[k])
        assert speed < 1e-9 * 100
    # equal lengths of arc: rolling without slip
    near = np.abs(fixed).max(axis=1) < 500
    steps = [np.linalg.norm(np.diff(line, axis=0), axis=1) for line in (fixed, moving)]
    both = near[1:] & near[:-1] & (steps[0] < 5)
    assert both.sum() > 200
    assert np.abs(steps[0][both] / steps[1][both] - 1).max() < 1e-3
    assert np.abs(axes.fixed_point - axes.point).max() < 1e-9


def test_all_instant_centres_obey_aronhold_and_kennedy():
    rng = np.random.default_rng(0)
    loops = [
        linkage(moved(four_bar_joints(*LENGTHS), rotation(rng), rng.normal(size=3) * 50)),
        linkage(slider_crank_joints(40, 140, 10)),
        sb.from_dh("RRRR", length=[80, 70, 90, 30], twist=[0] * 4, offset=[0] * 4),
    ]
    checked = 0
    for found in loops:
        circuit = found.motion(72).circuits[0]
        centres = circuit.instant_centres()
        assert len(centres) == 6
        for i, j, k in ((1, 2, 3), (1, 2, 4), (1, 3, 4), (2, 3, 4)):
            for row in range(len(circuit.time)):
                words = {centres[pair].status[row] for pair in ((i, j), (i, k), (j, k))}
                assert words <= {"ok", "translation", "at-rest"}
                if "at-rest" in words:
                    continue
                three = [centres[pair].in_plane[row] for pair in ((i, j), (i, k), (j, k))]
                far = [centres[pair].status[row] == "translation" for pair in ((i, j), (i, k), (j, k))]
                if sum(far) == 1:
                    pair = ((i, j), (i, k), (j, k))[far.index(True)]
                    p, q = (three[n] for n in range(3) if not far[n])
                    plane = found.plane
                    slide = centres[pair].direction[row]
                    slide = np.array([slide @ plane.x, slide @ plane.y])
                    # infinitely far square to the slide
                    assert abs((q - p) @ slide) < 1e-12 * max(1, hypot(*(q - p))) * 1e2
                    checked += 1
                elif not any(far):
                    p, q, r = three
                    sides = [hypot(*(a - b)) for a, b in ((p, q), (q, r), (r, p))]
                    area = abs((q - p)[0] * (r - p)[1] - (q - p)[1] * (r - p)[0])
                    # height of the triangle over its longest side, by that side
                    assert area / max(sides) ** 2 < 1e-12
                    checked += 1
    assert checked > 800


def test_centres_of_joints_are_the_joints():
    joints, found = four_bar()
    circuit = found.motion(36).circuits[0]
    centres = circuit.instant_centres()
    assert np.abs(centres[4, 1].in_plane).max() < 1e-12
    assert np.abs(centres[3, 4].in_plane - (90, 0)).max() < 1e-11
    assert centres[1, 2].place == pytest.approx(circuit.point(1, joints[1]["at"]).position, abs=1e-10)
    assert list(centres.columns("mm"))[:3] == ["P12_x_mm", "P12_y_mm", "P12_status"]
    slider = linkage(slider_crank_joints(40, 140, 10)).motion(36).circuits[0].instant_centres()
    assert set(slider[3, 4].status) == {"translation"}
    assert np.abs(np.abs(slider[3, 4].direction[:, 0]) - 1).max() < 1e-12
    with pytest.raises(sb.errors.SevenbarError, match="links: 4 and 4 have no centre"):
        slider[4, 4]


def test_the_screw_of_an_rssr_is_the_limit_of_finite_displacements():
    found = sb.load("rssr")
    circuit = found.motion(12).circuits[0]
    for link in (2, 3):
        axes = circuit.screw_axes(link)
        row = 2
        errors = []
        for step in (1e-2, 5e-3):
            x = circuit.input[row]
            law = sb.Law.of([0.0, 1.0], [x - step, x + step], 1.0, 0.0)
            near = found.motion(law=law).circuits[0]
            turn, place = near.link_motion(link).rotation, near.point(link, (0, 0, 0)).position
            finite = turn[1] @ turn[0].T
            skew = np.array(
                [finite[2, 1] - finite[1, 2], finite[0, 2] - finite[2, 0], finite[1, 0] - finite[0, 1]]
            )
            axis = skew / np.linalg.norm(skew)
            angle = np.arctan2(np.linalg.norm(skew) / 2, (np.trace(finite) - 1) / 2)
            shift = place[1] - finite @ place[0]
            pitch = shift @ axis / angle
            # (1 - R) p = shift across the axis
            across = shift - (shift @ axis) * axis
            point = 0.5 * (across + np.cross(axis, across) / np.tan(angle / 2))
            off = np.cross(point - axes.point[row], axis)
            errors.append(
                [
                    np.linalg.norm(axis - axes.direction[row]),
                    abs(pitch - axes.pitch[row]),
                    np.linalg.norm(off),
                ]
            )
        errors = np.array(errors)
        # a symmetric difference: the error falls with the square of the step
        large = errors[1] > 1e-7
        assert np.abs(errors[0][large] / errors[1][large] - 4).max(initial=0) < 0.1, errors
        assert large.sum() == (3 if link == 2 else 0)


def test_points_of_the_axis_move_along_it_at_the_slide_rate():
    for name in ("rssr", "seven_r", "bennett", "rccc"):
        found = sb.load(name)
        circuit = found.motion(24).circuits[0]
        for link in range(1, len(found.joints)):
            axes = circuit.screw_axes(link)
            for row in range(0, len(circuit.time), 5):
                if axes.status[row] != "ok":
                    continue
                trace = circuit.point(link, tuple(axes.moving_point[row]))
                assert trace.position[row] == pytest.approx(axes.point[row], abs=1e-9 * circuit.size)
                expected = axes.slide_rate[row] * axes.direction[row]
                scale = np.nanmax(np.linalg.norm(trace.velocity, axis=1)) + circuit.size
                assert trace.velocity[row] == pytest.approx(expected, abs=1e-10 * scale)
                assert axes.slide_rate[row] == pytest.approx(axes.pitch[row] * axes.rate[row], rel=1e-12)


def test_against_its_neighbour_a_link_has_the_axis_of_the_joint():
    found = sb.load("seven_r")
    circuit = found.motion(24).circuits[0]
    for joint in range(1, 6):
        axes = circuit.screw_axes(joint + 1, relative_to=joint)
        assert np.abs(axes.pitch).max() < 1e-9 * circuit.size
        rate = np.abs(circuit.dq[:, joint])
        assert axes.rate == pytest.approx(rate, abs=1e-10)
        # the same line in both links on all rows
        assert np.ptp(np.abs(axes.moving_direction), axis=0).max() < 1e-9
        assert np.ptp(np.abs(axes.fixed_direction), axis=0).max() < 1e-9


def test_relative_axes_of_three_links_share_a_common_normal():
    # Phillips and Hunt: the three axes of three links have one line that meets all at right angles
    circuit = sb.load("seven_r").motion(12).circuits[0]
    axes = [circuit.screw_axes(*pair) for pair in ((2, 4), (4, 6), (2, 6))]
    for row in range(len(circuit.time)):
        twists = []
        for one in axes:
            w = one.rate[row] * one.direction[row]
            v = np.cross(one.point[row], w) + one.pitch[row] * w
            twists.append(np.concatenate([w, v]))
        # 2 against 6 is 2 against 4 and 4 against 6
        assert twists[2] == pytest.approx(twists[0] + twists[1], abs=1e-9 * circuit.size)


def test_a_spherical_loop_turns_about_its_centre():
    rng = np.random.default_rng(2)
    shift = np.array([5.0, -3.0, 8.0])
    arcs = tuple(map(radians, (30, 80, 70, 85)))
    found = linkage(moved(spherical_joints(*arcs, radius=50.0), rotation(rng), shift))
    axes = found.motion(36).circuits[0].screw_axes(2)
    off = np.linalg.norm(np.cross(axes.point - shift, axes.direction), axis=1)
    assert off.max() < 1e-10
    assert np.abs(axes.pitch).max() < 1e-10


def test_a_link_that_only_slides_or_rests_has_no_axis():
    slider = linkage(slider_crank_joints(40, 140)).motion(36).circuits[0].screw_axes(3)
    # it stands still at its dead centres
    assert set(slider.status) <= {"translation", "at-rest"}
    moving = slider.status == "translation"
    assert np.isinf(slider.pitch[moving]).all()
    assert np.isnan(slider.point).all()
    assert np.abs(np.abs(slider.direction[moving][:, 0]) - 1).max() < 1e-12
    assert not slider.rate.any()
    square = sb.from_dh("RRRR", length=[2, 1, 2, 1], twist=[0] * 4, offset=[0] * 4)
    for circuit in square.motion(36):
        words = set(circuit.screw_axes(2).status)
        # the coupler of a parallelogram slides round, that of its twin turns
        assert words <= {"translation", "ok", "change-point"}
    rocker = sb.load("planar_4r").motion(36, input="theta_4", output="theta_1").circuits[0]
    dead = rocker.status == "dead-centre"
    axes = rocker.screw_axes(2)
    assert set(axes.status[dead]) == {"dead-centre"}
    assert np.isnan(axes.rate[dead]).all()


def test_what_is_asked_for_wrongly_is_refused():
    circuit = sb.load("rssr").motion(12).circuits[0]
    for call, message in (
        (lambda: circuit.screw_axes(9), "link: 9 is not a link; give 1 to 4"),
        (lambda: circuit.screw_axes(2, relative_to=2), "relative_to: link 2 is the link itself"),
        (lambda: circuit.instant_centres(), "instant_centres: the loop is not planar"),
        (lambda: circuit.point("C"), "point: no point 'C'; this linkage has A, B"),
        (lambda: circuit.point("A", at=(1, 2, 3)), "at: point 'A' has its place"),
        (lambda: circuit.point(2), "at: a link needs a place on it"),
    ):
        with pytest.raises(sb.errors.SevenbarError, match=message.replace("(", r"\(")):
            call()
    b = next(point for point in sb.load("rssr").points if point.name == "B")
    assert np.array_equal(circuit.point("B").position, circuit.point(b.link, b.at).position)


def test_its_columns_have_units():
    columns = sb.load("rssr").motion(12).circuits[0].screw_axes(2).columns("mm")
    assert list(columns)[:4] == ["status", "point_x_mm", "point_y_mm", "point_z_mm"]
    assert list(columns)[-3:] == ["pitch_mm_rad", "rate_rad_s", "slide_rate_mm_s"]
