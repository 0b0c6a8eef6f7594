"""Links that spin together between two balls, against the distance of the balls, on which alone the rest of the loop depends.

Each side of the loop keeps the balls at a distance that its one joint decides: the square of it is a constant, a cosine and a sine
of a turn (the law of cosines), or a quadratic of a slide. Nothing here knows how the spin is held.
"""

import itertools
import json
import math

import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar as run
from sevenbar.export import export
from sevenbar.reporting.facts import idle_note

CLOSED = 1e-11  # of a loop some hundreds long
SAME_ANGLE = 1e-7


def moved(point, at, axis, value, *, slides=False):
    """A point turned about an axis, or carried along it."""
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    at, arm = np.asarray(at, dtype=float), np.asarray(point, dtype=float) - at
    if slides:
        return at + arm + value * axis
    return (
        at
        + arm * math.cos(value)
        + np.cross(axis, arm) * math.sin(value)
        + axis * (axis @ arm) * (1 - math.cos(value))
    )


def turn_law(still, ball, at, axis):
    """c0, c, s of the squared distance `c0 + c cos q + s sin q` of a ball that turns from one that does not."""
    square = [float(((moved(ball, at, axis, q) - still) ** 2).sum()) for q in (0.0, math.pi, math.pi / 2)]
    middle = (square[0] + square[1]) / 2
    return middle, (square[0] - square[1]) / 2, square[2] - middle


def hinge_angles(distance, law):
    """The angles at which a hinge keeps the balls so far apart (squared)."""
    middle, c, s = law
    share = (distance - middle) / math.hypot(c, s)
    return [] if abs(share) > 1 else [math.atan2(s, c) + sign * math.acos(share) for sign in (1, -1)]


def rsrs(crank, crank_axis, ball_a, hinge, hinge_axis, ball_b):
    return sb.from_axes(
        [
            {"kind": "R", "name": "crank", "at": list(crank), "axis": list(crank_axis)},
            {"kind": "S", "name": "ball_a", "at": list(ball_a)},
            {"kind": "R", "name": "hinge", "at": list(hinge), "axis": list(hinge_axis)},
            {"kind": "S", "name": "ball_b", "at": list(ball_b)},
        ]
    )


#: What people type first: squares, right angles, equal arms, one ball above the other, parallel axes.
TEXTBOOK = {
    "a tripod": ((0, 0, 0), (0, 0, 1), (1, 0, 0), (2, 1, 0), (0, 1, 1), (3, 0, 1)),
    "in a plane": ((0, 0, 0), (0, 0, 1), (1, 0, 0), (2, 2, 0), (0, 0, 1), (4, 0, 0)),
    "a ball above the crank's circle": ((0, 0, 0), (0, 0, 1), (1, 0, 0), (2, 1, 0), (0, 1, 0), (1, 0, 1)),
    "equal arms at the hinge, one above the other": (
        (0, 0, 0),
        (1, 0, 0),
        (0, 0.5, 0),
        (1, 1, 0),
        (0, 0, 1),
        (2, 0.5, 1.5),
    ),
    "decimals": ((0.1, 0, 0), (0, 0, 1), (2.6, 0.1, 0), (2.4, 3.1, 0.8), (1, 1, 0), (0.9, -1.8, 2.1)),
    "right angles": ((0, 0, 0), (0, 0, 1), (2, 0, 0), (2, 3, 0), (1, 0, 0), (4, 3, 2)),
}


def random_rsrs(seed):
    random = np.random.default_rng(seed)
    points, axes = random.uniform(-100, 100, (4, 3)), random.normal(size=(2, 3))
    return points[0], axes[0], points[1], points[2], axes[1], points[3]


CASES = {**TEXTBOOK, **{f"random {seed}": random_rsrs(seed) for seed in range(12)}}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_modes_and_circuits_are_those_of_the_balls_distance(case):
    crank, crank_axis, ball_a, hinge, hinge_axis, ball_b = case
    linkage = rsrs(*case)
    assert linkage.mobility().finite == 1
    samples = 96
    motion = linkage.motion(samples)
    first, other = linkage.columns.index("crank"), linkage.columns.index("hinge")
    rows = np.concatenate([c.q[:, [first, other]] for c in motion.circuits])
    drives, follows = (
        turn_law(ball_b, ball_a, crank, crank_axis),
        turn_law(ball_a, ball_b, hinge, hinge_axis),
    )
    seen = 0
    for k in range(samples):
        angle = math.tau * k / samples
        distance = drives[0] + drives[1] * math.cos(angle) + drives[2] * math.sin(angle)
        share = (distance - follows[0]) / math.hypot(*follows[1:])
        if abs(abs(share) - 1) < 1e-6:
            continue  # a dead centre: two modes that are one
        want = hinge_angles(distance, follows)
        for w in want:
            apart = np.abs((rows - [angle, w] + math.pi) % math.tau - math.pi)
            assert apart.max(axis=1).min() < SAME_ANGLE, angle
        if k % 12 == 5:
            found = linkage.assembly_modes(angle)
            assert (len(found), found.completeness) == (len(want), "algebraic")
        seen += len(want)
    assert seen
    assert linkage.motion(12, input="hinge").circuits


def closing(linkage, q):
    """The product round the loop, less one, from the values of its columns."""
    total, column = np.eye(4), 0
    for joint, link in zip(linkage.joints, linkage.transforms, strict=True):
        for axis in {"S": "zyx"}.get(joint.kind, "z"):
            value = q[column]
            step = np.eye(4)
            if joint.kind == "P":
                step[2, 3] = value
            else:
                i, j = {"z": (0, 1), "y": (2, 0), "x": (1, 2)}[axis]
                step[i, i] = step[j, j] = math.cos(value)
                step[j, i] = math.sin(value)
                step[i, j] = -math.sin(value)
            if joint.kind == "H":
                step[2, 3] = joint.pitch / math.tau * value
            total, column = total @ step, column + 1
        total = total @ link
    return np.abs(total - np.eye(4)).max()


def drawn(kinds, seed):
    random = np.random.default_rng(seed)
    joints = []
    for kind in kinds:
        joint = {"kind": kind, "at": random.uniform(-100, 100, 3).tolist()}
        if kind != "S":
            joint["axis"] = random.normal(size=3).tolist()
        if kind == "H":
            joint["pitch"] = 40.0
        joints.append(joint)
    return sb.from_axes(joints)


KINDS = ["RSRS", "SRSR", "RSPS", "PSRS", "SPSR", "SRSP", "HSRS", "SHRS", "SRRS", "SRPS"]


@pytest.mark.parametrize(("kinds", "seed"), list(itertools.product(KINDS, range(2))))
def test_told_turns_of_the_balls_close_the_loop_and_carry_its_points(kinds, seed):
    linkage = drawn(kinds, seed)
    motion = linkage.motion(60)
    assert motion.circuits
    for circuit in motion:
        assert {"ok", "dead-centre"} >= set(circuit.status)
        assert max(closing(linkage, q) for q in circuit.q) < 100 * CLOSED
        # each joint lies in the same place on both its links
        for link, joint in enumerate(linkage.joints[1:], start=1):
            place = linkage.description["joint"][link]["at"]
            before = circuit.point(link, place).position
            if link + 1 < len(linkage.joints) and joint.kind in "RS":
                assert np.abs(circuit.point(link + 1, place).position - before).max() < 1e-9
            elif joint.kind == "S":
                assert np.abs(before - place).max() < 1e-9


def richardson(values, step):
    """The derivative in the middle of nine values, to the eighth order."""
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    return np.tensordot(weights, values, 1) / step


@pytest.mark.parametrize("kinds", ["RSRS", "RSPS", "HSRS", "SRRS"])
def test_rates_of_balls_and_points_of_the_spinning_links_are_derivatives(kinds):
    linkage = drawn(kinds, 0)
    circuit = linkage.motion(1440, speed=1.0).circuits[0]
    good = [
        k
        for k in range(4, len(circuit.q) - 4)
        if (circuit.status[k - 4 : k + 5] == "ok").all() and len(set(circuit.branch[k - 4 : k + 5])) == 1
    ]
    k = min(good, key=lambda k: float(np.abs(circuit.dddq[k]).max()))
    around = slice(k - 4, k + 5)
    step = (circuit.q[k + 1] - circuit.q[k - 1])[circuit.input_column] / 2
    tables = [circuit.q, circuit.dq, circuit.ddq, circuit.dddq]
    for lower, higher in itertools.pairwise(tables):
        assert richardson(lower[around], step) == pytest.approx(higher[k], rel=1e-7, abs=1e-7)
    for link in (2, 3):
        trace = circuit.point(link, (10.0, -20.0, 30.0))
        orders = [trace.position, trace.velocity, trace.acceleration, trace.jerk]
        for lower, higher in itertools.pairwise(orders):
            assert richardson(lower[around], step) == pytest.approx(higher[k], rel=1e-7, abs=1e-5)


def test_a_slide_with_a_ball_at_each_end_is_followed():
    """A cylinder between two balls, its direction along their line: the length that a crank asks for."""
    linkage = sb.from_axes(
        [
            {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
            {"kind": "S", "at": [1, 0, 0]},
            {"kind": "P", "at": [2, 0, 0], "axis": [1, 0, 0]},
            {"kind": "S", "at": [3, 0, 0]},
        ]
    )
    motion = linkage.motion(36)
    assert motion.motion_type == "crank-slider"
    slides = linkage.columns.index("theta_3")
    lengths = {
        tuple(np.round(np.abs(c.q[:, slides] + 2) - np.sqrt(10 - 6 * np.cos(c.q[:, 0])), 9)) for c in motion
    }
    assert lengths == {(0.0,) * 36}


def test_another_spin_is_left_out_of_a_pose():
    linkage = rsrs(*random_rsrs(0))
    circuit = linkage.motion(60).circuits[0]
    frames = [circuit.link_motion(link).rotation[7] for link in (1, 2, 3)]
    balls = [circuit.point(1, linkage.description["joint"][1]["at"]).position[7], np.array(random_rsrs(0)[5])]
    line = (balls[1] - balls[0]) / np.linalg.norm(balls[1] - balls[0])
    c, s = math.cos(1.1), math.sin(1.1)
    odd = np.array([[0, -line[2], line[1]], [line[2], 0, -line[0]], [-line[1], line[0], 0]])
    spin = c * np.eye(3) + s * odd + (1 - c) * np.outer(line, line)

    def turns(matrix):
        return (
            math.atan2(matrix[1, 0], matrix[0, 0]),
            math.asin(-matrix[2, 0]),
            math.atan2(matrix[2, 1], matrix[2, 2]),
        )

    pose = circuit.q[7].copy()
    pose[1:4] = turns((frames[0] @ linkage.links[0, :3, :3]).T @ spin @ frames[1])
    pose[5:8] = turns((spin @ frames[2] @ linkage.links[2, :3, :3]).T @ linkage.ground[:3, :3])
    assert closing(linkage, pose) < 1e-9
    assert linkage.circuit(pose, 60).q == pytest.approx(circuit.q, abs=1e-9)


def test_all_links_between_balls_in_the_ground_spin_together():
    linkage = drawn("SRRS", 0)
    assert linkage.idle == ("spin of links 1, 2 and 3 together about the line of theta_1 and theta_4",)
    assert linkage.idle_links == {1, 2, 3}
    motion = linkage.motion(48)
    # the chain between the balls is as long as the ground in every pose
    balls = [np.array(joint["at"]) for joint in linkage.description["joint"] if joint["kind"] == "S"]
    for circuit in motion:
        ends = [circuit.point(link, ball).position for link, ball in zip((1, 3), balls, strict=True)]
        length = np.linalg.norm(ends[1] - ends[0], axis=1)
        assert length == pytest.approx(np.linalg.norm(balls[1] - balls[0]), rel=1e-12)


TIE_ROD = """
format = 1
[[joint]]
name = "crank"
kind = "R"
at = [0, 0, 0]
axis = [0, 0, 1]
[[joint]]
kind = "S"
at = [30, 0, 0]
[[joint]]
kind = "S"
at = [100, 90, 50]
[[joint]]
name = "slider"
kind = "P"
at = [100, 90, 50]
axis = [1, 0, 0]
[[point]]
name = "wheel_centre"
link = {link}
at = [60, 50, 20]
"""
HELD = "idle freedom: spin of link 2 about the line of theta_2 and theta_3, held by convention; points of link 2 go with it"


@pytest.mark.parametrize(("link", "says"), [(2, True), (1, False)])
def test_figures_and_tables_with_a_point_of_an_idle_link_say_that_a_convention_holds_it(tmp_path, link, says):
    file = tmp_path / "tie.toml"
    file.write_text(TIE_ROD.format(link=link), encoding="utf-8")
    for words in (
        ["plot", str(file), "--kind", "coupler", "-o", str(tmp_path / "figures")],
        ["export", str(file), "-o", str(tmp_path / "tie.csv")],
    ):
        lines = run(*words, "--samples", "24").stdout.splitlines()
        assert (HELD in lines) is says, words
        assert lines[0].startswith("written: ")
    note = json.loads((export(sb.load(file).motion(12), None, tmp_path / "tie.json")[0]).read_text())
    assert (note["idle_links"], note["idle"]) == (
        [2],
        ["spin of link 2 about the line of theta_2 and theta_3"],
    )


def test_without_an_idle_link_or_its_points_nothing_is_said_of_one():
    assert idle_note(sb.load("rssr"), [1, 3]) == ""
    assert idle_note(sb.load("planar_4r"), [1, 2, 3, 4]) == ""
    assert idle_note(sb.load("rssr"), [1, 2]).endswith("held by convention; points of link 2 go with it")
    with sb.language("zh"):
        assert idle_note(sb.load("rssr"), [2]).endswith("按约定固定；构件 2 上的点随之而定")
