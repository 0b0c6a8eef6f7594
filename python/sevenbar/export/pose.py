"""One pose of a circuit, with what a drawing of it must leave room for: the frames of all links."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Floats, finite_number
from sevenbar.drawing.skeleton import Skeleton, skeleton_of
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable, chosen_circuit
from sevenbar.kinematics.circuits.poses import joint_frames, poses_along
from sevenbar.kinematics.loop.law import Law

#: A link shorter than this part of the longest has no length: its joints are at one place up to rounding.
NO_LENGTH = 1e-6

#: Poses of a circuit for which a layout is chosen: enough to meet what links sweep over, and quick.
SAMPLED = 12


@dataclass(frozen=True, eq=False)
class Pose:
    """A pose of a linkage on one of its circuits; lengths in the linkage's unit, report frame.

    `frames` (n, 4, 4) are those of the links in it, the ground's last (the identity), and `others`
    (m, n, 4, 4) those of further poses of the circuit. `near` and `far` (n, 4, 4) are the frames of each
    joint on the link before it and on the link after it. `travel` (n, 2) is how far each joint slides along
    its axis on the circuit. `places` is what the figures draw.
    """

    motion: Motion
    circuit: Circuit
    branch: int
    q: Floats
    frames: Floats
    others: Floats
    near: Floats
    far: Floats
    travel: Floats
    places: Skeleton

    @property
    def linkage(self) -> Solvable:
        """The linkage in this pose."""
        return self.motion.linkage

    @property
    def input(self) -> float:
        """The input [rad, or length]."""
        return float(self.q[self.circuit.input_column])

    def polylines(self) -> list[Floats]:
        """The places (k, 3) along each link, the ground's last, from the joint before it to the one after."""
        return [self.places.places[0, list(line)] for line in self.places.polylines]


def take(motion: Motion, circuit: int = 0, at: float | None = None, branch: int | None = None) -> Pose:
    """The pose of a circuit at an input `at` [rad, or length] on its pass `branch`, the first by default.

    Without `at`: the first row of a circuit whose input goes round, the middle of the pass where it turns
    back. Raises `RequestError` where the circuit has no pose there.
    """
    chosen = chosen_circuit(motion, circuit)
    linkage = motion.linkage
    if at is not None:
        at = finite_number("at", at)
    else:
        ends = chosen.pass_range(branch or 0)
        at = float(chosen.input[0]) if ends is None else (ends[0] + ends[1]) / 2
    passes = sorted({int(b) for b in chosen.branch})
    if branch is not None and branch not in passes:
        known = "0" if passes == [0] else f"0 to {passes[-1]}"
        raise RequestError(f"branch: {shown(branch)} is not a pass of circuit {circuit}; give {known}")
    exact = linkage.motion(
        samples=motion.samples,
        input=motion.input,
        output=motion.output,
        law=Law.of([0.0], [at], 0.0, 0.0),
        agree=motion.agree,
    ).circuits[circuit]
    on_pass = np.flatnonzero(exact.branch == (branch or 0))
    frames = poses_along(linkage, exact, on_pass[:1])
    q = exact.q[on_pass[0]] if on_pass.size else np.array([math.nan])
    if np.isnan(frames).any() or np.isnan(q).any():
        raise _no_pose(motion, chosen, at)
    valid = poses_along(linkage, chosen, np.arange(len(chosen.time)))
    # this pose among them, so that there is one at least
    valid = np.concatenate([frames, valid[~np.isnan(valid).any(axis=(1, 2, 3))]])
    picked = np.unique(np.linspace(0, len(valid) - 1, SAMPLED).astype(int))
    near, far = (each[0] for each in joint_frames(linkage, frames))
    rows = np.vstack([chosen.q, q])
    slid = [
        joint.slid(rows[:, columns]) for joint, columns in zip(linkage.joints, linkage.places, strict=True)
    ]
    return Pose(
        motion=motion,
        circuit=chosen,
        branch=branch or 0,
        q=q,
        frames=frames[0],
        others=valid[picked],
        near=near,
        far=far,
        travel=np.stack([np.nanmin(slid, axis=1), np.nanmax(slid, axis=1)], axis=1),
        places=skeleton_of(linkage, frames),
    )


def extent_of(pose: Pose) -> float:
    """The size [length] that drawn parts are shares of: the extent of all places along the circuit."""
    return max(pose.places.span, skeleton_of(pose.linkage, pose.others).span)


def _no_pose(motion: Motion, circuit: Circuit, at: float) -> RequestError:
    column = motion.linkage.column_of(circuit.input_column)
    if circuit.input_range is None:
        allowed = "another value"
    else:
        low, high = circuit.input_range
        allowed = f"a value from {column.text(low)} to {column.text(high)}"
    if len(motion.circuits) > 1:
        allowed += ", or another circuit"
    return RequestError(
        f"at: circuit {circuit.index} has no pose of definite joint values at {column.name} = "
        f"{column.text(at)}; give {allowed}"
    )


def shortest_link(pose: Pose) -> float:
    """The length [length] of the shortest link that has one; 1 where none has."""
    lengths = [sum(float(np.linalg.norm(b - a)) for a, b in pairwise(line)) for line in pose.polylines()]
    small = NO_LENGTH * max(lengths, default=0.0)
    return min((length for length in lengths if length > small), default=1.0)
