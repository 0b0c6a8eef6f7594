"""Circuits counted: none is missed, however narrow, and what does not balance is told.

Axes in one linear complex let the loop stand in a pose with two infinitesimal freedoms. Where the second-order form on these is
definite the pose stands alone, and a link moved by epsilon opens it to a circuit as wide as the root of epsilon, far narrower
than the spacing of the inputs at which modes are looked for.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import sevenbar as sb
from evidence.fuzz.edges import isolated_pose
from sevenbar import _core
from sevenbar.reporting.facts import facts_of

Floats = npt.NDArray[np.float64]


def opened(seed: int, letters: str, epsilon: float) -> _core.RawMotion:
    """The motion of the loop with one link moved along the wrench that no joint yields to."""
    rng = np.random.default_rng(seed)
    frames = []
    for point, axis in isolated_pose(rng, letters):
        x = np.cross(axis, rng.normal(size=3))
        x /= np.linalg.norm(x)
        frame = np.eye(4)
        frame[:3, :3] = np.array([x, np.cross(axis, x), axis]).T
        frame[:3, 3] = point
        frames.append(frame)
    links = np.array([np.linalg.inv(a) @ b for a, b in zip(frames[:-1], frames[1:], strict=True)])
    links[3][:3, 3] += epsilon * frames[3][2, :3]
    loop = _core.Loop(letters, np.zeros(len(letters)), frames[0], frames[-1], links)
    return loop.motion(0, 1, 90, 1.0, None)


def farthest(circuit: _core.RawCircuit) -> float:
    """How far the first three joints of a circuit go from the pose that stood alone [rad, or length]."""
    joints = circuit.joints[0][:, :3]
    joints = joints[np.isfinite(joints).all(axis=1)]
    return float(np.abs((joints + math.pi) % (2 * math.pi) - math.pi).max()) if len(joints) else math.inf


@pytest.mark.parametrize("letters", ["RRRRRRR", "RRRPRRR", "RRRPRPR", "PRRRRRR", "RRRRS", "RRRSR"])
@pytest.mark.parametrize("epsilon", [1e-5, 1e-8, 1e-11])
def test_a_narrow_circuit_is_found_on_the_side_on_which_it_opens(letters: str, epsilon: float) -> None:
    for seed in range(3):
        found = []
        for side in (1, -1):
            raw = opened(seed, letters, side * epsilon)
            assert raw.search.count.open == []
            found.append(sum(farthest(c) < 200 * math.sqrt(epsilon) for c in raw.circuits))
        assert sorted(found) == [0, 1]


def drawn(rng: np.random.Generator, kinds: str) -> sb.Linkage:
    joints: list[dict[str, Any]] = []
    for kind in kinds:
        joints.append({"kind": kind, "at": rng.uniform(-1, 1, 3).tolist()})
        if kind != "S":
            joints[-1]["axis"] = rng.normal(size=3).tolist()
    return sb.from_axes(joints)


@pytest.mark.parametrize("seed", [130, 173])
def test_limits_of_a_coupler_turned_over_and_beside_infinite_joints_are_counted(seed: int) -> None:
    linkage = drawn(np.random.default_rng(seed), "RSSR")
    motion, exact = linkage.motion(24, method="general"), linkage.motion(24)
    assert motion.completeness == "counted"
    assert motion.search.count is not None
    assert motion.search.count.dead_centres == sum(d.kind == "input" for c in exact for d in c.dead_centres)


def test_two_circuits_found_late_that_turn_back_at_the_same_inputs_both_count() -> None:
    # about the ball, which drives nothing else, the universal joint closes in two ways
    rng = np.random.default_rng(111)
    joints: list[dict[str, Any]] = []
    for kind in "RSUR":
        joints.append({"kind": kind, "at": rng.uniform(-1, 1, 3).tolist()})
        if kind == "R":
            joints[-1]["axis"] = rng.normal(size=3).tolist()
        if kind == "U":
            first = rng.normal(size=3)
            joints[-1]["axes"] = [first.tolist(), np.cross(first, rng.normal(size=3)).tolist()]
    motion = sb.from_axes(joints).motion(24)
    assert (motion.completeness, len(motion.circuits)) == ("counted", 4)
    assert motion.search.count is not None
    assert motion.search.count.dead_centres == 8


def test_where_turns_of_an_rssr_are_infinite_at_real_rocker_angles_its_crank_counts() -> None:
    # the coupler's height over its crank's plane is the rocker's alone: where it is the coupler's length
    # two complex couplers have no direction across the crank's axis
    for L2 in (56.3861, 169.1236):
        linkage = sb.rssr(112.1046, 85.6589, 56.6266, 106.9128, 42.8507, L2)
        motion, exact = (linkage.motion(24, input="rocker", method=m) for m in ("general", "auto"))
        assert (motion.completeness, len(motion.circuits)) == ("counted", len(exact.circuits))
        assert motion.search.count is not None
        assert motion.search.count.joint == "crank"


def test_a_complex_pair_straight_beside_a_drawn_pose_is_counted() -> None:
    # on one side of a border of two ranges, and known on the other
    for seed, epsilon in ((1, -1e-12), (4, 1e-12)):
        assert opened(seed, "RRRSR", epsilon).search.count.open == []


@pytest.mark.parametrize("kinds", ["RCCC", "RPRRRPR", "RRPRPRP"])
def test_circuits_that_end_where_slides_are_infinite_are_counted_and_none_is_missed(kinds: str) -> None:
    rng = np.random.default_rng(8)
    turns = np.array([letter == "R" for kind in kinds for letter in ("RP" if kind == "C" else kind)])
    far = 0
    for _ in range(6):
        linkage = drawn(rng, kinds)
        motion = linkage.motion(180)
        assert motion.completeness == "counted"
        far += sum(not c.closed for c in motion)
        size = linkage._general.size
        rows = np.concatenate([c.q[np.isfinite(c.q).all(axis=1)] for c in motion])
        for k in range(0, 180, 9):
            for q in linkage.assembly_modes(2 * math.pi * k / 180).q:
                # circuits are followed to 50 sizes
                if np.abs(q).max() < 40 * size:
                    off = rows - q
                    off = np.where(turns, (off + math.pi) % (2 * math.pi) - math.pi, off)
                    assert np.abs(off).max(axis=1).min() < 1e-6 * size
    assert far > 0


def test_a_circuit_between_two_inputs_with_infinite_slides_is_found_where_its_only_seed_is_too_far_out() -> (
    None
):
    # the circuit goes from -133.4 to -120.2 deg, and at the input -120 deg its slides are 300 sizes out
    joints = [
        ("R", [0.031, -3.103, 0.0], [-0.752, 0.443, -0.488]),
        ("P", [1.53, 1.786, 1.358], [-0.897, -0.326, 0.298]),
        ("R", [-0.716, -0.466, 0.479], [-0.93, -0.064, 0.361]),
        ("R", [-0.941, -0.049, -0.311], [-0.854, 0.281, 0.437]),
        ("R", [1.403, -1.006, -1.575], [0.721, -0.036, 0.692]),
        ("P", [0.326, 0.41, 0.051], [0.392, -0.304, -0.869]),
        ("R", [0.984, -0.666, 0.105], [-0.253, 0.158, 0.954]),
    ]
    linkage = sb.from_axes([{"kind": k, "at": at, "axis": axis} for k, at, axis in joints])
    at = math.radians(-127)
    modes = linkage.assembly_modes(at).q
    near = modes[np.abs(modes).max(axis=1) < 40 * linkage._general.size]
    assert len(near) > 2
    motion = linkage.motion(360)
    rows = np.concatenate([c.q for c in motion])
    for q in near:
        turned = np.where(
            [kind == "slide" for kind in linkage.column_kinds], 0, np.round((rows - q) / math.tau)
        )
        assert np.nanmin(np.abs(rows - q - math.tau * turned).max(axis=1)) < 1e-6
    # those that far out are not followed, and the report does not claim it
    assert motion.search.unfollowed == 2
    assert "could not be followed" in dict(facts_of(motion))["completeness"]


@pytest.mark.parametrize("kinds", ["RCCC", "RPRRRPR"])
def test_a_law_meets_an_open_circuit_at_its_own_inputs_and_nowhere_else(kinds: str) -> None:
    """Such a circuit has no dead centre and is not gone round: it begins and ends where slides are infinite."""
    inputs = np.linspace(-3, 3, 61)
    law = sb.Law.of(np.arange(61.0), inputs, 1.0, 0.0)
    missed = 0
    for seed in range(3):
        for circuit in drawn(np.random.default_rng(seed), kinds).motion(law=law):
            asked = np.tile(inputs, len(circuit.input) // 61)
            met = circuit.status != "no-solution"
            turned = (circuit.input - asked)[met] / (2 * math.pi)
            np.testing.assert_allclose(turned, np.round(turned), atol=1e-9)
            missed += int((~met).sum())
    assert missed > 0


def test_a_narrow_circuit_that_begins_in_its_own_dead_centre_is_counted() -> None:
    """Of a four-bar that closes nearly stretched only; its dead centres were taken for meetings with other curves."""
    length = [1.6168810006227978, 0.5710081024464377, 0.8319621303934439, 0.21391077221784888]
    motion = sb.from_dh("RRRR", length=length, twist=[0] * 4, offset=[0] * 4).motion(24)
    assert (motion.completeness, len(motion.circuits)) == ("counted", 1)
    # by the law of cosines: coupler and rocker in line between crank and ground
    a, b, c, d = length
    limit = math.pi - math.acos((a * a + d * d - (b + c) ** 2) / (2 * a * d))
    np.testing.assert_allclose(motion.limits, sorted((limit % math.tau, -limit % math.tau)), atol=1e-10)


def test_a_circuit_too_narrow_for_one_count_is_counted_about_other_axes_or_by_another_joint() -> None:
    """A spherical four-bar nearly stretched: its input swings 2e-5 rad, its dead centres are lost in the rounding of the phases."""
    side = [0.6999182565023351, 0.6394474344764746, 0.27152321780334704, 1.6108889087374223]
    motion = sb.from_dh("RRRR", length=[0] * 4, twist=side, offset=[0] * 4).motion(24)
    assert (motion.completeness, len(motion.circuits)) == ("counted", 1)
    assert motion.search.count is not None
    assert motion.search.count.joint in ("theta_1", "theta_4")


def test_the_paper_s_loop_has_no_branch_point() -> None:
    motion = sb.load("seven_r").motion(24)
    assert motion.completeness == "counted"
    assert motion.search.count is not None
    assert (
        motion.search.count.dead_centres,
        motion.search.count.complex_branch_points,
        motion.search.count.open,
        motion.search.count.circles,
    ) == (0, 0, (), 1)


def test_the_count_is_of_all_dead_centres_of_its_joint() -> None:
    rng = np.random.default_rng(5)
    for _ in range(8):
        linkage = sb.from_dh(
            "RRRRRRR",
            length=rng.uniform(0.2, 1.2, 7),
            twist=rng.uniform(-math.pi, math.pi, 7),
            offset=rng.uniform(-0.6, 0.6, 7),
        )
        motion = linkage.motion(24)
        assert motion.completeness == "counted"
        assert motion.search.count is not None
        dead_centres = [d for c in motion for d in c.dead_centres if d.kind == "input"]
        assert motion.search.count.dead_centres == len(dead_centres)


@pytest.mark.parametrize(
    ("name", "dead_centres"),
    [
        ("bennett", 0),
        ("goldberg_5r", 0),
        ("myard_5r", 0),
        ("bricard_line", 0),
        ("bricard_plane", 0),
        ("bricard_trihedral", 2),
        ("planar_4r", 0),
        ("spherical_4r", 0),
        ("sarrus", 0),
        ("six_bar", 0),
    ],
)
def test_overconstrained_loops_are_counted(name: str, dead_centres: int) -> None:
    """Their circuits meet others that only the closure with added joints has: zeros of the determinant, and no dead centres."""
    motion = sb.load(name).motion(36)
    assert motion.completeness == "counted"
    assert motion.search.count is not None
    assert motion.search.count.open == ()
    assert motion.search.count.dead_centres == dead_centres
    found = [d for c in motion.circuits for d in c.dead_centres if d.kind == "input"]
    assert len(found) == dead_centres


def test_screws_are_not_counted() -> None:
    motion = sb.load("screw_drill").motion(24)
    assert (motion.completeness, motion.search.count) == ("searched", None)
