"""Freedoms of loops with balls that are no neighbours, against the null space of the joints' screws."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import NotCoveredError

NOTHING = 1e-9


def drawn(kinds, seed):
    """A loop of these joints in general position."""
    random = np.random.default_rng(seed)
    joints = []
    for kind in kinds:
        joint = {"kind": kind, "at": random.uniform(-100, 100, 3).tolist()}
        if kind == "U":
            joint["axes"] = random.normal(size=(2, 3)).tolist()
        elif kind != "S":
            joint["axis"] = random.normal(size=3).tolist()
        joints.append(joint)
    return joints


def freedoms_seen(joints):
    """How many freedoms joints that are no balls take part in, of all the loop has in this pose.

    The closure ties the rates of all joints by their screws; what is left of its null space when only those
    joints are looked at are the freedoms that are not idle.
    """
    screws, seen = [], []
    for joint in joints:
        place, kind = np.array(joint["at"]), joint["kind"]
        axes = np.eye(3) if kind == "S" else np.array(joint.get("axes", [joint.get("axis")]))
        for axis in axes:
            if kind == "P":
                screws.append([*np.zeros(3), *axis])
            else:
                screws.append([*axis, *np.cross(place / 100, axis)])
            seen.append(kind != "S")
            if kind == "C":
                screws.append([*np.zeros(3), *axis])
                seen.append(True)
    _, values, rows = np.linalg.svd(np.array(screws).T)
    free = rows[(values > NOTHING).sum() :]
    return len(free), int((np.linalg.svd(free[:, seen])[1] > NOTHING).sum())


@pytest.mark.parametrize(
    "kinds",
    ["RSRS", "SRSR", "SRRS", "RSPS", "RSCS", "RSUS", "RRSRS", "RSRRS", "PSRS", "RSSRS", "RSRSRS", "SRSRS"],
)
@pytest.mark.parametrize("seed", range(3))
def test_freedoms_that_only_balls_take_part_in_are_idle(kinds, seed):
    joints = drawn(kinds, seed)
    found = sb.from_axes(joints).mobility()
    total, seen = freedoms_seen(joints)
    assert (found.gruebler, found.finite, len(found.idle)) == (total, seen, total - seen)


def test_the_idle_spin_of_several_links_is_named():
    assert sb.from_axes(drawn("RSRS", 1)).idle == (
        "spin of links 2 and 3 together about the line of theta_2 and theta_4",
    )
    assert sb.from_axes(drawn("RSRRS", 1)).idle == (
        "spin of links 2, 3 and 4 together about the line of theta_2 and theta_5",
    )


def test_a_screw_among_spinning_links_is_refused_and_moves_from_another_joint_on():
    screw = drawn("RSHS", 1)
    screw[2]["pitch"] = 30.0
    linkage = sb.from_axes(screw)
    assert linkage.mobility().finite == 1
    for call in (linkage.motion, lambda: linkage.assembly_modes(0.0)):
        with pytest.raises(
            NotCoveredError, match=r"spin of links 2 and 3 together .* describe the loop from"
        ):
            call()
    # the remedy of the message
    assert sb.from_axes(screw[2:] + screw[:2]).motion(samples=12).circuits


def test_a_loop_with_two_freedoms_beside_an_idle_spin_needs_two_inputs():
    motion = sb.from_axes(drawn("RSCS", 1)).motion(samples=12)
    assert motion.motion_type == "two-inputs"
    assert motion.mobility.finite == 2


def test_the_mobility_of_a_motion_is_that_of_its_input() -> None:
    """With j1 driven it moves with 1; the pose drawn lies on a surface of poses that j1 does not move."""
    joints = [
        ("R", (1, 1, -2), (1, 0, 0)),
        ("R", (-2, 2, 2), (1, 0, 0)),
        ("R", (-2, 1, -1), (1, 0, 0)),
        ("P", (2, -1, 0), (0, 0, 1)),
        ("R", (-2, 2, -2), (0, 0, 1)),
        ("R", (-2, 2, 0), (1, 0, 0)),
        ("R", (1, -1, -1), (0, 0, 1)),
    ]
    drawn = [
        {"kind": kind, "at": at, "axis": axis, "name": f"j{i}"}
        for i, (kind, at, axis) in enumerate(joints, 1)
    ]
    for written in (drawn, drawn[::-1]):
        linkage = sb.from_axes(written)
        motion = linkage.motion(24, input="j1", output="j7")
        assert (motion.mobility.finite, motion.mobility.redundant) == (1, motion.redundant)
        assert str(linkage.mobility(input="j1")) == str(motion.mobility)
