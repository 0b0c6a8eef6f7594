"""Tasks for exact synthesis: random ones, ones made from a known linkage, and the pose that a linkage takes."""

import numpy as np
from scipy.spatial.transform import Rotation

from sevenbar.arrays import short_way
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.loop.rigid import inverse, pose


def random_turns(count, seed):
    return Rotation.random(count, random_state=np.random.default_rng(seed)).as_matrix()


def random_poses(count, seed, reach=50.0):
    places = np.random.default_rng(seed + 1000).uniform(-reach, reach, (count, 3))
    return pose(random_turns(count, seed), places)


def random_planar(count, seed):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(-50, 50, (count, 2)), rng.uniform(-1.5, 1.5, count)])


def coupler_poses(circuit, rows, link=2):
    """The poses (n, 4, 4) of a link on rows of a circuit: its frame, at the link's own origin."""
    places = circuit.written_point(link, (0.0, 0.0, 0.0)).position[rows]
    return pose(circuit.link_motion(link).rotation[rows], places)


def worst_miss(answer, wanted):
    """How far link 2 is from wanted displacements (n, 4, 4) where the input has its claimed values.

    By the ordinary analysis, which knows nothing of the synthesis: of all assembly modes at that input the
    one whose output is the claimed one. Rotations [-] and places relative to the size.
    """
    linkage, worst = answer.linkage, 0.0
    columns = linkage.columns
    first = poses(linkage, np.zeros((1, len(columns))))[0, 1]
    size = max(np.ptp([joint["at"] for joint in answer.draft.raw["joint"]], axis=0))
    for x, y, goal in zip(answer.claim.inputs, answer.claim.outputs, wanted, strict=True):
        modes = linkage.assembly_modes(x)
        nearest = np.abs(short_way(modes.q[:, linkage.places[-1]][:, 0] - y)).argmin()
        there = poses(linkage, modes.q[[nearest]])[0, 1] @ inverse(first)
        off = np.abs(there - goal)
        off[:3, 3] /= size
        worst = max(worst, float(off.max()))
    return worst


def lines_of(answer):
    """The joints' places (4, 3) and directions (4, 3)."""
    joints = answer.draft.raw["joint"]
    return np.array([j["at"] for j in joints]), np.array([j["axis"] for j in joints])
