"""Joint values, rates and closure errors read off the frames of links: against the frames they were made of."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.gallery import loops
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.simulation.joint_values import BodyStates, joint_values

#: Joints of every kind one after another; the loop need not close, for nothing here closes it.
OPEN = sb.from_axes(
    [
        {"name": "turn", "kind": "R", "at": (0, 0, 0), "axis": (1, 2, 2)},
        {"name": "slide", "kind": "P", "at": (10, 0, 3), "axis": (0, 1, 0)},
        {"name": "screw", "kind": "H", "at": (20, 5, 0), "axis": (2, 0, 1), "pitch": 7},
        {"name": "sleeve", "kind": "C", "at": (30, 5, 9), "axis": (0, 3, 4)},
        {"name": "cross", "kind": "U", "at": (35, 15, 5), "axes": [(1, 0, 0), (1, 1, 1)]},
        {"name": "ball", "kind": "S", "at": (40, 0, 0)},
        {"name": "last", "kind": "E", "at": (0, 50, 0), "axis": (0, 0, 1)},
    ]
)


def courses(t):
    """Smooth joint values (n, columns) at times t, balls away from their singular turns; two derivatives."""
    count = len(OPEN.columns)
    size = np.where(OPEN.turning, 0.7, 3.0)
    rate = 1.0 + 0.2 * np.arange(count)
    phase = 0.5 * np.arange(count)
    angle = rate * t[:, None] + phase
    return size * np.sin(angle), size * rate * np.cos(angle), -size * rate**2 * np.sin(angle)


def bodies_at(t):
    """Links that move so, by differences of fourth order of their frames; the ground moves on with the last joint."""
    step = 5e-4

    def frames(at):
        moving = poses(OPEN, courses(at)[0])[:, :-1]
        # backwards: it turns first, and its slides are carried by the ground
        turn, *slides = courses(at)[0][:, OPEN.places[-1]].T
        last = moving[:, -1] @ OPEN.links[-1] @ turn_z(turn) @ shifts(*slides)
        return np.concatenate([moving, (last @ np.linalg.inv(OPEN.ground))[:, None]], axis=1)

    around = [frames(t + k * step) for k in (-2, -1, 0, 1, 2)]
    first = (around[0] - 8 * around[1] + 8 * around[3] - around[4]) / (12 * step)
    second = (-around[0] + 16 * around[1] - 30 * around[2] + 16 * around[3] - around[4]) / (12 * step**2)
    turn = around[2][..., :3, :3]
    back = np.swapaxes(turn, -1, -2)
    spin = axial(first[..., :3, :3] @ back)
    # the rest of the second derivative is symmetric
    rate = axial(second[..., :3, :3] @ back)
    return BodyStates(around[2], first[..., :3, 3], second[..., :3, 3], spin, rate)


def read_off(bodies):
    """The values of all joints, the first of them against a ground that stands still."""
    parts = {name: states.copy() for name, states in vars(bodies).items()}
    for states in parts.values():
        states[:, -1] = 0.0
    parts["frames"][:, -1] = np.eye(4)
    found, first = joint_values(OPEN, bodies), joint_values(OPEN, BodyStates(**parts))
    for name, values in vars(found).items():
        values[:, 0] = getattr(first, name)[:, 0]
    return found


def shifts(x, y):
    matrices = np.tile(np.eye(4), (len(x), 1, 1))
    matrices[:, 0, 3], matrices[:, 1, 3] = x, y
    return matrices


def turn_z(angle):
    matrices = np.tile(np.eye(4), (len(angle), 1, 1))
    matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angle)
    matrices[:, 1, 0] = np.sin(angle)
    matrices[:, 0, 1] = -np.sin(angle)
    return matrices


def axial(matrices):
    odd = 0.5 * (matrices - np.swapaxes(matrices, -1, -2))
    return np.stack([odd[..., 2, 1], odd[..., 0, 2], odd[..., 1, 0]], axis=-1)


def test_values_and_rates_of_every_kind_of_joint_are_those_it_was_moved_by():
    t = np.linspace(0, 6, 200)
    q, dq, ddq = courses(t)
    found = read_off(bodies_at(t))
    assert found.q == pytest.approx(q, abs=1e-12)
    ball = ["ball" in name for name in OPEN.columns]
    assert np.isnan(found.dq[:, ball]).all()
    rest = ~np.array(ball)
    assert found.dq[:, rest] == pytest.approx(dq[:, rest], abs=1e-8)
    assert found.ddq[:, rest] == pytest.approx(ddq[:, rest], abs=1e-6)
    assert found.gap.max() < 1e-12
    assert found.tilt.max() < 1e-12


@pytest.mark.parametrize(
    ("link", "joint", "way", "shows"),
    [
        (0, "turn", (0, 0, 1), True),
        (0, "turn", (1, 0, 0), True),
        (1, "slide", (0, 0, 1), False),
        (1, "slide", (1, 0, 0), True),
        (2, "screw", (0, 0, 1), True),
        (3, "sleeve", (0, 0, 1), False),
        (3, "sleeve", (0, 1, 0), True),
        (4, "cross", (0, 1, 0), True),
        (5, "ball", (0, 0, 1), True),
    ],
)
def test_a_link_pushed_aside_opens_its_joint_by_as_much_unless_the_joint_lets_it(link, joint, way, shows):
    bodies = bodies_at(np.array([0.3]))
    before = read_off(bodies).gap
    bodies.frames[0, link, :3, 3] += 0.01 * bodies.frames[0, link, :3, :3] @ np.array(way, dtype=float)
    place = [own.name for own in OPEN.joints].index(joint)
    opened = read_off(bodies).gap[0, place]
    assert before.max() < 1e-12
    assert opened == pytest.approx(0.01 if shows else 0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("link", "joint", "axis", "shows"),
    [
        (0, "turn", 0, True),
        (0, "turn", 2, False),
        (1, "slide", 2, True),
        (2, "screw", 1, True),
        (3, "sleeve", 1, True),
        (3, "sleeve", 2, False),
        (5, "ball", 0, False),
    ],
)
def test_a_link_turned_aside_tilts_its_joint_by_as_much_unless_the_joint_lets_it(link, joint, axis, shows):
    bodies = bodies_at(np.array([0.3]))
    small = np.zeros((3, 3))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    small[b, a], small[a, b] = 1e-4, -1e-4
    turn = np.linalg.qr(np.eye(3) + small)[0]
    turn *= np.sign(np.diag(turn))
    bodies.frames[0, link, :3, :3] = bodies.frames[0, link, :3, :3] @ turn
    place = [own.name for own in OPEN.joints].index(joint)
    tilt = read_off(bodies).tilt[0, place]
    assert tilt == pytest.approx(1e-4 if shows else 0.0, abs=1e-8)


@pytest.mark.parametrize("name", loops())
def test_sevenbar_s_own_links_give_sevenbar_s_own_joint_values(name):
    linkage = sb.load(name)
    circuit = linkage.motion(90).circuits[0]
    rows = np.flatnonzero(circuit.status == "ok")
    traces = [circuit.link_motion(k + 1) for k in range(len(linkage.joints))]
    origins = [
        circuit.point(k + 1, tuple(np.linalg.inv(linkage.point_frames[k])[:3, 3]))
        for k in range(len(linkage.joints))
    ]
    frames = np.tile(np.eye(4), (len(rows), len(traces), 1, 1))
    for k, (trace, origin) in enumerate(zip(traces, origins, strict=True)):
        frames[:, k, :3, :3] = trace.rotation[rows]
        frames[:, k, :3, 3] = origin.position[rows]
    frames[:, -1] = np.eye(4)

    def stacked(values):
        return np.stack([value[rows] for value in values], axis=1)

    bodies = BodyStates(
        frames,
        stacked([origin.velocity for origin in origins]),
        stacked([origin.acceleration for origin in origins]),
        stacked([trace.velocity for trace in traces]),
        stacked([trace.acceleration for trace in traces]),
    )
    found = joint_values(linkage, bodies)
    known = np.isfinite(found.dq)
    scale = np.where(linkage.turning, 1.0, circuit.size)
    whole = 2 * np.pi * np.round((circuit.q[rows] - found.q) / (2 * np.pi))
    whole[:, ~linkage.turning] = 0
    assert np.abs((found.q + whole - circuit.q[rows]) / scale).max() < 1e-9
    fast = max(1.0, np.abs(circuit.dq[rows]).max() ** 2, np.abs(circuit.ddq[rows]).max())
    assert np.abs(((found.dq - circuit.dq[rows]) / scale)[known]).max() < 1e-8 * fast
    assert np.abs(((found.ddq - circuit.ddq[rows]) / scale)[known]).max() < 1e-7 * fast
