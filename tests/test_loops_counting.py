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
from fuzz.edges import isolated_pose
from sevenbar import _core

Floats = npt.NDArray[np.float64]


def opened(seed: int, letters: str, epsilon: float) -> dict[str, Any]:
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
    loop = _core.Loop(letters, np.zeros(7), frames[0], frames[-1], links)
    raw: dict[str, Any] = loop.motion(0, 6, 90, 1.0, None)
    return raw


def farthest(circuit: dict[str, Any]) -> float:
    """How far a circuit goes from the pose that stood alone [rad, or length]."""
    joints = circuit["joints"][0]
    joints = joints[np.isfinite(joints).all(axis=1)]
    return float(np.abs((joints + math.pi) % (2 * math.pi) - math.pi).max()) if len(joints) else math.inf


@pytest.mark.parametrize("letters", ["RRRRRRR", "RRRPRRR"])
@pytest.mark.parametrize("epsilon", [1e-5, 1e-8, 1e-11])
def test_a_narrow_circuit_is_found_on_the_side_on_which_it_opens(letters: str, epsilon: float) -> None:
    for seed in range(3):
        found = []
        for side in (1, -1):
            raw = opened(seed, letters, side * epsilon)
            assert raw["count"][4] == []
            found.append(sum(farthest(c) < 200 * math.sqrt(epsilon) for c in raw["circuits"]))
        assert sorted(found) == [0, 1]


def test_the_paper_s_loop_has_no_branch_point() -> None:
    motion = sb.load("seven_r").motion(24)
    assert motion.completeness == "counted"
    assert motion.count is not None
    assert (motion.count.dead_centres, motion.count.complex_branch_points, motion.count.open) == (0, 0, ())


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
        assert motion.count is not None
        dead_centres = [d for c in motion for d in c.dead_centres if d.kind == "input"]
        assert motion.count.dead_centres == len(dead_centres)


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
    assert motion.count is not None
    assert motion.count.open == ()
    assert motion.count.dead_centres == dead_centres
    found = [d for c in motion.circuits for d in c.dead_centres if d.kind == "input"]
    assert len(found) == dead_centres


def test_screws_are_not_counted() -> None:
    motion = sb.load("screw_drill").motion(24)
    assert (motion.completeness, motion.count) == ("searched", None)
