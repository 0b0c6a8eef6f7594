"""A joint at the ground counts its link against the ground, about its axis as written, first or last.

Source: the motion of the link itself. Four points fixed on it give its rigid displacement from the drawn pose, which
is set against turns about and slides along the axes of the description, by Rodrigues' formula.
"""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError

EXACT = 1e-12

KINDS = "RPHCUSEKL"
FREEDOMS = {"R": 1, "P": 1, "H": 1, "C": 2, "U": 2, "S": 3, "E": 3, "K": 2, "L": 2}
PITCH = -0.7


def drawn(kinds, seed):
    """Joints anywhere, nothing parallel; the joint E of each has its neighbour off its axis."""
    rng = np.random.default_rng([seed, *map(ord, kinds)])
    joints = []
    for i, kind in enumerate(kinds):
        joint = {"kind": kind, "name": f"j{i + 1}", "at": rng.normal(size=3)}
        if kind in "RPHCE":
            joint["axis"] = rng.normal(size=3)
        if kind in "UKL":
            joint["axes"] = rng.normal(size=(2, 3))
        if kind in "KL":
            joint["axes"][0] = np.cross(*joint["axes"])
        if kind == "H":
            joint["pitch"] = PITCH
        joints.append(joint)
    return joints


def unit(vector):
    return np.asarray(vector) / np.linalg.norm(vector)


def turn(axis, angle):
    """Rodrigues: the rotation about a direction."""
    x, y, z = unit(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


def displacement(joints, end, value):
    """Rotation about the joint's place and slide of the link at the first or last joint (`end` 0, -1).

    `value` gives the columns of the joint by their numbers from 1; a joint with one freedom has 1.
    """
    joint, last = joints[end], end == -1
    still = np.zeros(3)
    match joint["kind"]:
        case "R":
            return turn(joint["axis"], value(1)), still
        case "P":
            return np.eye(3), value(1) * unit(joint["axis"])
        case "H":
            return turn(joint["axis"], value(1)), PITCH * value(1) / math.tau * unit(joint["axis"])
        case "C":
            return turn(joint["axis"], value(1)), value(2) * unit(joint["axis"])
        case "U":
            # the first axis is held by the link before, the second by the link after
            first, second = (turn(axis, value(k)) for k, axis in enumerate(joint["axes"], 1))
            return (second @ first if last else first @ second), still
        case "S":
            x, y, z = np.eye(3)
            return turn(z, value(1)) @ turn(y, value(2)) @ turn(x, value(3)), still
        case "E":
            z = unit(joint["axis"])
            towards = joints[-2 if last else 1]["at"] - joint["at"]
            x = unit(towards - (towards @ z) * z)
            return turn(z, value(3)), value(1) * x + value(2) * np.cross(z, x)
        case "K" | "L" as kind:
            # the first axis is held by the link before, the second by the link after
            slot, pin = (unit(axis) for axis in joint["axes"][:: 1 if kind == "K" else -1])
            slide, angle = (value(k) for k in ((1, 2) if kind == "K" else (2, 1)))
            along, rotation = unit(slot - (slot @ pin) * pin), turn(pin, angle)
            # a slot of the ground stands still
            return rotation, slide * (along if (kind == "K") != last else rotation @ along)


def placed(joints, end, columns, q, marks):
    """Where marks (n, 3) on the link of an end joint are at joint values q (columns,)."""
    name = joints[end]["name"]

    def value(number):
        several = FREEDOMS[joints[end]["kind"]] > 1
        return q[columns.index(f"{name}.{number}" if several else name)]

    rotation, slide = displacement(joints, end, value)
    at = joints[end]["at"]
    return (marks - at) @ rotation.T + at + slide


def circuit_of(joints, input=None):
    """The circuit through the drawn pose, at a speed, from any joint that drives it."""
    linkage = sb.from_axes(joints)
    for name in [input] if input else linkage.drivable():
        try:
            return linkage, linkage.circuit(np.zeros(len(linkage.columns)), 90, input=name, speed=1.7)
        except RequestError:
            continue
    raise AssertionError(f"nothing drives {linkage.kind}")


def derivatives(values, h):
    """The value and the first three derivatives at 0 of a smooth function, from a polynomial within h."""
    nodes = np.cos(np.pi * (np.arange(13) + 0.5) / 13)
    found = np.linalg.solve(
        np.vander(nodes, increasing=True), np.array([values(h * x).ravel() for x in nodes])
    )
    shape = values(0.0).shape
    return [math.factorial(k) * found[k].reshape(shape) / h**k for k in range(4)]


LOOPS = [(kind + "R" * (7 - FREEDOMS[kind]), 0) for kind in KINDS]
LOOPS += [("R" * (7 - FREEDOMS[kind]) + kind, -1) for kind in KINDS]


@pytest.mark.parametrize(("kinds", "end"), LOOPS)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_value_of_a_joint_at_the_ground_is_the_motion_of_its_link(kinds, end, seed):
    joints = drawn(kinds, seed)
    linkage, circuit = circuit_of(joints)
    marks = np.vstack([np.zeros(3), np.eye(3)]) + joints[end]["at"]
    link = 1 if end == 0 else len(joints) - 1
    traces = [circuit.point(link, tuple(mark)) for mark in marks]
    ok = np.flatnonzero(circuit.status == "ok")
    assert len(ok) > 2
    moved = 0.0
    for row in ok:
        here = placed(joints, end, linkage.columns, circuit.q[row], marks)
        want = np.array([trace.position[row] for trace in traces])
        # what rounding of the pose's own closure leaves
        own = EXACT * circuit.size + 10 * circuit.residual[row]
        np.testing.assert_allclose(here, want, rtol=0, atol=own)
        moved = max(moved, np.abs(want - marks).max())
    assert moved > 0.01


@pytest.mark.parametrize(("kinds", "end"), LOOPS)
def test_its_rates_are_those_of_its_link(kinds, end):
    joints = drawn(kinds, 2)
    linkage, circuit = circuit_of(joints)
    marks = np.vstack([np.zeros(3), np.eye(3)]) + joints[end]["at"]
    link = 1 if end == 0 else len(joints) - 1
    traces = [circuit.point(link, tuple(mark)) for mark in marks]
    checked = 0
    clear = np.flatnonzero((circuit.status == "ok") & (circuit.condition < 1e4))
    for row in clear[:: 1 + len(clear) // 20]:
        q, dq, ddq, dddq = (rate[row] for rate in (circuit.q, circuit.dq, circuit.ddq, circuit.dddq))

        def at(t, q=q, dq=dq, ddq=ddq, dddq=dddq):
            return placed(joints, end, linkage.columns, q + t * (dq + t * (ddq / 2 + t * dddq / 6)), marks)

        # the time in which nothing changes by much
        second = 0.1 / max(np.abs(rate).max() ** (1 / k) for k, rate in enumerate((dq, ddq, dddq), 1))
        found = derivatives(at, second)
        for order, quantity in enumerate(("velocity", "acceleration", "jerk"), 1):
            want = np.array([getattr(trace, quantity)[row] for trace in traces])
            np.testing.assert_allclose(found[order], want, rtol=0, atol=1e-13 * 30**order / second**order)
        checked += 1
    assert checked > 2


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "S"])
def test_the_last_joint_drives_by_the_motion_of_its_link(kind):
    """By each of its columns: grid, speed and limits are those of the link's own motion, as it is reported."""
    joints = drawn("R" * (7 - FREEDOMS[kind]) + kind, 1)
    linkage = sb.from_axes(joints)
    own = [name for name in linkage.columns if name.split(".")[0] == joints[-1]["name"]]
    assert len(own) == FREEDOMS[kind]
    marks = np.vstack([np.zeros(3), np.eye(3)]) + joints[-1]["at"]
    for name in own:
        circuit = linkage.circuit(np.zeros(len(linkage.columns)), 720, input=name, speed=1.7)
        column = linkage.columns.index(name)
        ok = np.flatnonzero(circuit.status == "ok")
        assert circuit.input_column == column
        assert len(ok) > 2
        np.testing.assert_allclose(circuit.dq[ok, column], 1.7, rtol=1e-15)
        places = [circuit.point(len(joints) - 1, tuple(mark)).position for mark in marks]
        for row in ok[:: 1 + len(ok) // 50]:
            want = [place[row] for place in places]
            here = placed(joints, -1, linkage.columns, circuit.q[row], marks)
            np.testing.assert_allclose(
                here, want, rtol=0, atol=EXACT * circuit.size + 10 * circuit.residual[row]
            )


def slider_crank(axis=(1, 0, 0)):
    """Crank 40, rod 140: the pin is at 180 mm where it is drawn."""
    turning = {"kind": "R", "axis": (0, 0, 1)}
    return sb.from_axes(
        [
            {**turning, "name": "crank", "at": (0, 0, 0)},
            {**turning, "name": "pin", "at": (40, 0, 0)},
            {**turning, "name": "wrist", "at": (180, 0, 0)},
            {"kind": "P", "name": "slider", "at": (180, 0, 0), "axis": axis},
        ],
        points=[{"name": "wrist", "link": 3, "at": (180, 0, 0)}],
        speed="3000 rpm",
    )


def test_a_slider_crank_s_slider_is_where_its_pin_is():
    circuit = slider_crank().motion(4).circuits[0]
    place = np.array([180.0, math.sqrt(140**2 - 40**2), 100.0, math.sqrt(140**2 - 40**2)])
    np.testing.assert_allclose(circuit.output, place - 180, atol=1e-12)
    trace = circuit.point(3, (180, 0, 0))
    for order, quantity in enumerate(("position", "velocity", "acceleration", "jerk")):
        ours = (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)[order][:, -1]
        pin = getattr(trace, quantity)[:, 0] - (180 if order == 0 else 0)
        np.testing.assert_allclose(ours, pin, atol=1e-12 * 180 * (100 * math.pi) ** order)
    # -40 sin(crank) at a quarter turn, where the rod does not turn
    assert circuit.dq[1, -1] == pytest.approx(-40 * 100 * math.pi, rel=1e-12)
    assert (circuit.angle.lowest, circuit.angle.highest) == pytest.approx((-80, 0), abs=1e-12)


def test_an_axis_written_the_other_way_turns_the_sign_and_nothing_else():
    one, other = (slider_crank(axis).motion(24).circuits[0] for axis in ((1, 0, 0), (-2, 0, 0)))
    for quantity in ("q", "dq", "ddq", "dddq"):
        a, b = getattr(one, quantity), getattr(other, quantity)
        np.testing.assert_allclose(a[:, -1], -b[:, -1], atol=1e-11 * (1 + np.abs(b).max()))
        np.testing.assert_allclose(a[:, :-1], b[:, :-1], atol=1e-11 * (1 + np.abs(b).max()))


def test_both_ends_of_a_loop_count_alike():
    """A loop written from its other end has the same values at both ends, with the ends exchanged; a ball's too."""
    for kinds in ("RSSR", "CRRRRR", "SRRRR", "ERRRR", "HRRRRRR"):
        joints = drawn(kinds, 5)
        one, other = (sb.from_axes(each) for each in (joints, joints[::-1]))
        drive = next(joint["name"] for joint in joints[1:] if joint["kind"] == "R")
        value = 0.03
        a, b = (linkage.assembly_modes(value, input=drive) for linkage in (one, other))
        if drive not in (joints[0]["name"], joints[-1]["name"]):
            # an inner joint counts the other way round in the other order
            b = other.assembly_modes(-value, input=drive)
        if kinds[0] == "E":
            # the first slide points to the neighbour, from either end
            assert one.columns[:3] == other.columns[:-4:-1]
        ends = [name for name in one.columns if name.split(".")[0] in (joints[0]["name"], joints[-1]["name"])]
        mine, theirs = (
            np.array(sorted(modes.q[:, [linkage.columns.index(name) for name in ends]].tolist()))
            for modes, linkage in ((a, one), (b, other))
        )
        assert len(mine) == len(theirs) > 0, kinds
        np.testing.assert_allclose(mine, theirs, atol=1e-7, err_msg=kinds)
