"""Solvers of robot arms, each asked in its own way for all angles of a loop's joints 2 to 7, input held.

A solver is made for one arm (`prepared`), and then asked at as many targets as one likes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from evidence.benches.cases.arm import Arm
from evidence.benches.peers import AbsentError, Peers


class Answers(NamedTuple):
    """Angles (m, 6) [rad] of joints 2 to 7, and which (m,) the solver itself calls least squares."""

    angles: np.ndarray
    least_squares: np.ndarray


#: From an input [rad] to all answers.
Solve = Callable[[float], Answers]


def prepared(who: str, arm: Arm, peers: Peers) -> Solve:
    """The solver of this name for an arm; raises `AbsentError` where it is not here or refuses the arm."""
    return SOLVERS[who](arm, peers)


def _listed(angles: Any, least_squares: Any = None) -> Answers:
    rows = np.array(angles, dtype=np.float64).reshape(-1, 6)
    flags = (
        np.zeros(len(rows), bool) if least_squares is None else np.array(least_squares, dtype=bool).ravel()
    )
    return Answers(rows, flags)


def _ssik_arm(arm: Arm, peers: Peers) -> Any:
    return peers.module("ssik").Manipulator.from_axes(arm.axes, arm.offsets)


def ssik(arm: Arm, peers: Peers) -> Solve:
    """As its manual has it; of the three symbolic derivations for a general arm one is made."""
    manipulator = _ssik_arm(arm, peers)
    general = manipulator.solver_name == "ikgeo.general_6r"
    options: dict[str, Any] = {"respect_limits": False} | ({"linearity_joint": 2} if general else {})
    if general:
        peers.module("ssik", "_native").rr_native_geometry(manipulator.kinbody, linearity_joint=2)
    return lambda theta: _listed([one.q for one in manipulator.solve(arm.screwed(theta), **options)])


def ssik_husty_pfurner(arm: Arm, peers: Peers) -> Solve:
    """Its solver for any arm that needs no derivation; the first call builds its tables."""
    kinbody = _ssik_arm(arm, peers).kinbody
    solve = peers.module("ssik", "solvers.husty_pfurner.general_6r").solve
    solve(kinbody, arm.screwed(0.0))
    return lambda theta: _listed([one.q for one in solve(kinbody, arm.screwed(theta))[0]])


def roboticstoolbox(arm: Arm, peers: Peers) -> Solve:
    """`DHRobot.analytic_ik`: closed forms for wrists and three parallel axes, else Raghavan and Roth."""
    rtb = peers.module("roboticstoolbox-python")
    rows = zip(*arm.rows, strict=True)
    links = [rtb.RevoluteDH(a=a, alpha=alpha, d=d, offset=zero) for a, alpha, d, zero in rows]
    solver = rtb.DHRobot(links).analytic_ik()
    return lambda theta: _listed(solver.solve(arm.target(theta), joint_limits=False).q)


def eaik(arm: Arm, peers: Peers) -> Solve:
    """`HPRobot`, which looks for the geometry itself."""
    robot = peers.module("EAIK").HPRobot(arm.axes, arm.offsets)
    if not robot.hasKnownDecomposition():
        raise AbsentError(f"refuses the arm: {robot.getKinematicFamily()}")

    def solve(theta: float) -> Answers:
        found = robot.IK(arm.screwed(theta))
        return _listed(found.Q, found.is_LS)

    return solve


def ik_geo(arm: Arm, peers: Peers) -> Solve:
    """`Robot`, of the kind that suits the arm."""
    kind = ik_geo_kind(arm)
    robot = getattr(peers.module("ik-geo").Robot, kind)(arm.axes, arm.offsets)

    def solve(theta: float) -> Answers:
        target = arm.screwed(theta)
        # its forward kinematics tells that it takes the rotation by columns
        answers = robot.get_ik(np.ascontiguousarray(target[:3, :3].T), target[:3, 3].copy())
        return _listed([angles for angles, _ in answers], [flag for _, flag in answers])

    return solve


def ik_geo_kind(arm: Arm) -> str:
    """The name of ik-geo's solver for an arm's geometry, axes counted from 0; the user must choose it."""
    if arm.meet(3, 5):
        if arm.parallel(1, 2):
            return "spherical_two_parallel"
        return "spherical_two_intersecting" if arm.meet(0, 1) else "spherical"
    if arm.parallel(1, 3):
        return "three_parallel_two_intersecting" if arm.meet(4, 5) else "three_parallel"
    if arm.parallel(1, 2):
        return "two_parallel"
    return "two_intersecting" if arm.meet(4, 5) else "gen_six_dof"


SOLVERS: dict[str, Callable[[Arm, Peers], Solve]] = {
    "ssik": ssik,
    "ssik, Husty-Pfurner": ssik_husty_pfurner,
    "roboticstoolbox": roboticstoolbox,
    "EAIK": eaik,
    "ik-geo": ik_geo,
}
