"""The transmission angle at change points and dead centres, where sizes vanish and directions do not."""

from math import acos, asin, cos, hypot, pi, radians, sin

import numpy as np
import pytest

import sevenbar as sb
from evidence.rewritten.families import lattice
from evidence.rewritten.ways import scaled, ways
from sevenbar.kinematics.circuits.poses import poses
from textbook_loops import linkage, moved, rotation, slider_crank_joints, spherical_joints

Z = [0, 0, 1]


def drawn(a, b, c, d, theta=1.9):
    """A four-bar drawn with its crank at an angle that is on no grid; its folds are off every row."""
    pin = np.array([a * cos(theta), a * sin(theta)])
    line = np.array([d, 0]) - pin
    far = hypot(*line)
    along = (far**2 + b * b - c * c) / (2 * far)
    end = pin + (along * line + np.sqrt(b * b - along**2) * np.array([-line[1], line[0]])) / far
    places = ([0, 0], pin, end, [d, 0])
    names = ("crank", "pin", "wrist", "rocker")
    return [
        {"name": name, "kind": "R", "at": [*map(float, at), 0.0], "axis": Z}
        for name, at in zip(names, places, strict=True)
    ]


def ends_of(a, b, c, d):
    """The acute angles where crank and ground are in line, by the law of cosines."""
    cosines = [(b * b + c * c - (d + way * a) ** 2) / (2 * b * c) for way in (-1, 1)]
    return [min(x, pi - x) for x in (acos(min(max(y, -1.0), 1.0)) for y in cosines)]


FOLDING = [(1, 1, 2, 2), (1.5, 1.5, 0.8, 0.8), (1.7, 3.3, 1.7, 3.3), (1.2, 2.9, 2.3, 1.8)]


@pytest.mark.parametrize("lengths", FOLDING)
def test_at_a_change_point_off_the_grid_it_is_zero_in_a_drawing_as_in_rows(lengths):
    for joints in (
        drawn(*lengths),
        drawn(*lengths)[::-1],
        moved(drawn(*lengths), rotation(np.random.default_rng(5)), [3, 1, 2]),
    ):
        motion = linkage(joints).motion(36, input="crank", output="rocker")
        rows = sb.four_bar(*lengths).motion(36)
        assert len(motion.circuits) == len(rows.circuits)
        for circuit, other in zip(motion, rows, strict=True):
            assert circuit.transmission.lowest == pytest.approx(0, abs=1e-9)
            assert other.transmission.lowest == pytest.approx(0, abs=1e-9)
            assert circuit.transmission.highest == pytest.approx(other.transmission.highest, abs=1e-9)
            at = circuit.transmission.lowest_at
            assert min(abs(sin((at - p.input) / 2)) for p in motion.change_points) < 1e-9


@pytest.mark.parametrize("share", [1e-3, 1e-6, 1e-9, 1e-12])
def test_next_to_a_change_point_it_is_that_of_the_law_of_cosines(share):
    # the crank-rocker that almost folds; its angle is least on a stretch far narrower than a row's
    a, b, c = 1.2, 2.9, 2.3
    d = 1.8 + share
    circuit = linkage(drawn(a, b, c, d)).motion(36)[0]
    # 2 sin^2 (mu / 2) = 1 - cos mu keeps the digits
    apart = d - a
    expected = 2 * asin(np.sqrt((apart - b + c) * (apart + b - c) / (4 * b * c)))
    assert circuit.transmission.lowest == pytest.approx(expected, rel=max(1e-15 / share, 1e-9))


def test_a_slider_crank_and_a_spherical_four_bar_fold_to_zero_too():
    for crank, rod, offset in ((1.0, 1.5, 0.5), (0.1, 0.36, 0.26)):
        for circuit in linkage(slider_crank_joints(crank, rod, offset, at=1.9)).motion(36):
            assert circuit.transmission.lowest == pytest.approx(0, abs=1e-9)
            assert sin(1.9 + circuit.transmission.lowest_at) == pytest.approx(-1, abs=1e-12)
    for circuit in linkage(spherical_joints(*map(radians, (30, 80, 60, 50)))).motion(36):
        assert circuit.transmission.lowest == pytest.approx(0, abs=1e-9)


def test_of_a_four_bar_the_extremes_are_where_crank_and_ground_are_in_line():
    for lengths in ((40, 100, 80, 90), (1, 2.6, 2.5, 2.4), (2, 2, 2, 1)):
        for circuit in linkage(moved(drawn(*lengths), rotation(np.random.default_rng(2)), [1, 2, 3])).motion(
            12
        ):
            ends = ends_of(*lengths)
            if circuit.goes_round:
                assert circuit.transmission.lowest == pytest.approx(min(ends), abs=1e-12)


# ---- limits


def folding_cross():
    """An RSUR whose input rests where the universal joint's cross folds into the rod."""
    return [
        {"name": "out", "kind": "R", "at": [-0.8, 0.5, -0.9], "axis": [0.8, 0.9, -0.9]},
        {"name": "ball", "kind": "S", "at": [-1.2, 0.3, 1.1]},
        {"name": "cross", "kind": "U", "at": [-1.7, -1.3, -0.2], "axes": [[0.3, 0.8, 0.7], [0.6, -0.9, 1.0]]},
        {"name": "in", "kind": "R", "at": [0.5, -1.7, -1.0], "axis": [0.2, -0.2, -0.1]},
    ]


def as_if(joints, frame, scale=1.0):
    """The same loop turned, or mirrored, and scaled."""
    found = []
    for joint in joints:
        own = {**joint, "at": (scale * (frame @ joint["at"])).tolist()}
        if "axis" in joint:
            own["axis"] = (frame @ joint["axis"]).tolist()
        if "axes" in joint:
            own["axes"] = [(frame @ axis).tolist() for axis in joint["axes"]]
        found.append(own)
    return found


def test_where_the_output_stands_still_with_the_input_the_angle_has_its_limit():
    found = linkage(folding_cross())
    motion = found.motion(360, input="in", output="out")
    # the force is along the rod from the cross to the ball: its angle has no other extremes than the rod's
    for circuit in motion:
        frames = poses(found, circuit.q)
        ball, cross = (
            np.array([*joint["at"], 1.0]) for joint in (found.description["joint"][k] for k in (1, 2))
        )
        ball = (frames[:, 0] @ found.point_frames[0] @ ball)[:, :3]
        cross = (frames[:, 1] @ found.point_frames[1] @ cross)[:, :3]
        axis = np.array([0.8, 0.9, -0.9])
        way = np.cross(axis, ball - np.array([-0.8, 0.5, -0.9]))
        rod = ball - cross
        sine = np.abs((rod * way).sum(axis=1)) / np.linalg.norm(rod, axis=1) / np.linalg.norm(way, axis=1)
        assert np.abs(np.sin(circuit.transmission_angle) - sine).max() < 1e-9
    lowest, highest = (
        np.degrees([getattr(c.transmission, end) for c in motion]) for end in ("lowest", "highest")
    )
    assert lowest == pytest.approx([12.0223733989, 6.0165327989, 15.9002496448], abs=1e-8)
    assert highest == pytest.approx([15.7287065912, 32.3949038007, 18.7745514533], abs=1e-8)


def test_such_a_limit_depends_on_neither_samples_nor_frame_nor_end():
    reference = linkage(folding_cross()).motion(360, input="in", output="out")[0]
    for number, joints in enumerate(
        (
            folding_cross(),
            as_if(folding_cross(), rotation(np.random.default_rng(1))),
            as_if(folding_cross(), np.diag([-1.0, 1.0, 1.0])),
            as_if(folding_cross(), rotation(np.random.default_rng(3)), 1000.0),
        )
    ):
        circuit = linkage(joints).motion((72, 361, 36, 100)[number], input="in", output="out")[0]
        assert circuit.transmission.lowest == pytest.approx(reference.transmission.lowest, abs=1e-10)
        assert circuit.transmission.highest == pytest.approx(reference.transmission.highest, abs=1e-10)
        assert circuit.velocity.highest == pytest.approx(reference.velocity.highest, rel=1e-9)
        assert circuit.advantage.lowest == pytest.approx(reference.advantage.lowest, rel=1e-9)


def test_the_velocity_has_a_bound_where_the_output_stands_still_with_the_input():
    motion = linkage(folding_cross()).motion(20000, input="in", output="out")
    circuit = motion[0]
    velocity, advantage = circuit.dq[:, circuit.output_column], circuit.mechanical_advantage
    dead = np.flatnonzero(circuit.status == "dead-centre")
    assert circuit.velocity.highest == pytest.approx(np.nanmax(velocity), abs=1e-3)
    assert circuit.velocity.highest >= np.nanmax(velocity)
    assert circuit.velocity.lowest <= np.nanmin(velocity)
    # the row of the dead centre and its neighbours run on
    for row in dead:
        around = advantage[[(row - 1) % len(advantage), (row + 1) % len(advantage)]]
        assert np.abs(around - advantage[row]).max() < 1e-3
    assert circuit.advantage.lowest * circuit.velocity.highest == pytest.approx(1, rel=1e-9)


def test_at_an_ordinary_dead_centre_angle_and_advantage_are_zero():
    circuit = sb.load("planar_4r").motion(72, input="theta_4", output="theta_1")[0]
    dead = circuit.status == "dead-centre"
    assert dead.any()
    assert (circuit.transmission_angle[dead] == 0).all()
    assert (circuit.mechanical_advantage[dead] == 0).all()
    assert circuit.velocity is None


def test_read_at_a_slide_between_two_balls_it_is_the_same_from_either_end():
    joints = [
        {"name": "in", "kind": "R", "at": [0, 0, 0], "axis": Z},
        {"name": "a", "kind": "S", "at": [1, 0, 0.2]},
        {"name": "slide", "kind": "P", "at": [2, 1, 1.2], "axis": [1.0, 0.2, 1.0]},
        {"name": "b", "kind": "S", "at": [3, 2, 2.2]},
    ]
    found = []
    for start in range(4):
        rolled = joints[start:] + joints[:start]
        for order in (rolled, rolled[::-1]):
            circuits = linkage(order).motion(36, input="in", output="slide").circuits
            found.append(
                sorted((round(c.transmission.lowest, 9), round(c.transmission.highest, 9)) for c in circuits)
            )
    assert found.count(found[0]) == len(found)


def test_an_output_that_is_at_an_end_of_its_range_at_two_inputs_has_no_time_ratio():
    for circuit in sb.load("rccc").motion(72, input="crank", output="slide_3"):
        turned = [d.output for d in circuit.dead_centres if d.kind == "output"]
        ends = (circuit.angle.lowest, circuit.angle.highest)
        assert max(sum(abs(x - end) < 1e-9 for x in turned) for end in ends) == 2
        assert circuit.many_strokes
        assert circuit.time_ratio is None
    ordinary = sb.load("planar_4r").motion(36)[0]
    assert not ordinary.many_strokes
    assert ordinary.time_ratio > 1


def test_the_velocity_at_a_change_point_where_the_input_turns_back_is_its_limit() -> None:
    """Joints on a lattice: towards the change point at 0 the output's velocity is that of half the input's."""
    joints = [
        ("R", (2, 1, 0), (0, 0, 1)),
        ("P", (0, -2, 0), (0, 0, 1)),
        ("R", (1, 2, -2), (0, 0, 1)),
        ("R", (-1, -1, 0), (1, 0, 0)),
        ("R", (-2, 2, 0), (1, 0, 0)),
        ("R", (0, 1, 2), (1, 0, 1)),
        ("R", (-2, -1, -1), (1, 0, 0)),
    ]
    linkage = sb.from_axes([{"kind": kind, "at": at, "axis": axis} for kind, at, axis in joints])
    for samples in (24, 90):
        velocity = linkage.motion(samples).circuits[0].velocity
        assert velocity is not None
        assert velocity.lowest == pytest.approx(-0.5, abs=1e-6)
        assert velocity.lowest_at == pytest.approx(2 * pi, abs=1e-6)


def test_velocity_extremes_of_a_circuit_through_change_points_are_of_all_its_passes() -> None:
    joints = [
        ("R", (-1, 2, 2), (0, 0, 1)),
        ("R", (2, -1, -2), (0, 1, 0)),
        ("R", (-1, 1, 1), (0, 1, 0)),
        ("R", (0, -1, 0), (0, 1, 0)),
        ("R", (1, -1, 0), (0, 0, 1)),
        ("R", (-2, -2, -2), (0, 1, 0)),
        ("R", (-1, 2, 1), (0, 1, 1)),
    ]
    drawn = [
        {"kind": kind, "at": at, "axis": axis, "name": f"j{i}"}
        for i, (kind, at, axis) in enumerate(joints, 1)
    ]
    for written in (drawn, drawn[1:] + drawn[:1]):
        circuit = sb.from_axes(written).motion(24, input="j1", output="j7").circuits[-1]
        assert circuit.motion_type == "change-point"
        assert circuit.velocity is not None
        # both rest at a limit of the input, and the output's velocity has a limit there
        highest = max(abs(circuit.velocity.lowest), abs(circuit.velocity.highest))
        assert highest == pytest.approx(2.848415, abs=1e-5)


@pytest.mark.parametrize("scale", [1.0, 1 / 3, 1e3])
def test_an_angle_that_ends_in_zero_at_a_change_point_where_the_input_turns_back_is_zero_there(scale):
    circuit = scaled(lattice(2567, seed=1), scale).linkage().motion(36).circuits[0]
    # it grows with the root of the input: 0.0643 at 0.00459, 0.0912 at 0.00917
    assert circuit.transmission.lowest == 0.0
    assert circuit.transmission.lowest_at == pytest.approx(0.0, abs=1e-12)
    assert circuit.transmission.highest == pytest.approx(0.596494997815, abs=1e-9)


def test_extremes_are_known_where_a_row_has_no_solution():
    # the drawn pose is an inflection: all joints move with the third root of the input
    written = ways(lattice(1732, seed=1), np.random.default_rng(1))
    moved_along = next(way for way in written if way.name == "places moved along axes")
    angle = moved_along.linkage.motion(36).circuits[0].transmission
    assert angle.lowest == 0.0
    assert angle.highest == pytest.approx(1.38311054015888, abs=1e-9)
