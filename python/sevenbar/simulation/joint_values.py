"""What joints do, read off the frames and the velocities of bodies: geometry alone, no closure.

Frames are those of links after their joints, as `Loop` has them; the ground comes last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Joint, Loop
from sevenbar.kinematics.loop.joints import Z
from sevenbar.kinematics.loop.rigid import axial, zyx_turns


@dataclass(frozen=True, eq=False)
class BodyStates:
    """Links at n times, the ground last: frames (n, links, 4, 4), the rest (n, links, 3) as in a record."""

    frames: Floats
    velocity: Floats
    acceleration: Floats
    spin: Floats
    spin_rate: Floats

    def point(self, link: int, place: Floats) -> tuple[Floats, Floats, Floats]:
        """Position, velocity and acceleration (n, 3) of a place in the frame of a link, counted from 0."""
        arm = self.frames[:, link, :3, :3] @ place
        spin = self.spin[:, link]
        turning = np.cross(spin, arm)
        return (
            self.frames[:, link, :3, 3] + arm,
            self.velocity[:, link] + turning,
            self.acceleration[:, link] + np.cross(self.spin_rate[:, link], arm) + np.cross(spin, turning),
        )


@dataclass(frozen=True, eq=False)
class JointValues:
    """Joint values and rates (n, columns), unwrapped; rates of a ball's turns are not formed and are NaN.

    `gap` (n, joints) [length] and `tilt` (n, joints) [rad] are by how much the two sides of each joint stand
    apart in the directions that it holds: the closure error.
    """

    q: Floats
    dq: Floats
    ddq: Floats
    gap: Floats
    tilt: Floats


def joint_values(linkage: Loop, bodies: BodyStates) -> JointValues:
    """The values of all joints of a linkage whose links stand and move so."""
    rows = len(bodies.frames)
    still = np.zeros((rows, 3))
    parts: list[tuple[Floats, Floats, Floats]] = []
    gaps: list[Floats] = []
    tilts: list[Floats] = []
    for i, joint in enumerate(linkage.joints):
        if i == 0:
            before = np.broadcast_to(linkage.base, (rows, 4, 4))
            motion = (still, still)
            spin, spin_rate = still, still
        else:
            before = bodies.frames[:, i - 1] @ linkage.links[i - 1]
            motion = bodies.point(i - 1, linkage.links[i - 1][:3, 3])[1:]
            spin, spin_rate = bodies.spin[:, i - 1], bodies.spin_rate[:, i - 1]
        after = bodies.frames[:, i]
        turn = np.swapaxes(before[:, :3, :3], 1, 2) @ after[:, :3, :3]
        way = after[:, :3, 3] - before[:, :3, 3]
        local = np.einsum("nji,nj->ni", before[:, :3, :3], way)
        columns: list[tuple[Floats, Floats, Floats]] = []
        turned = False
        for step in () if joint.row.is_ball or joint.row.has_cross else joint.row.steps:
            # what is behind a turn goes with it: across its axis that is the body after
            behind = turned and step.axis != Z
            axis = (after if behind else before)[:, :3, step.axis]
            own = (bodies.spin[:, i], bodies.spin_rate[:, i]) if behind else (spin, spin_rate)
            turned = turned or step.freedom == "turn"
            if step.driven:
                continue
            if step.freedom == "turn":
                columns.append(
                    (
                        np.arctan2(turn[:, 1, 0], turn[:, 0, 0]),
                        _dot(bodies.spin[:, i] - spin, axis),
                        _dot(bodies.spin_rate[:, i] - spin_rate, axis)
                        + _dot(bodies.spin[:, i] - spin, np.cross(spin, axis)),
                    )
                )
            else:
                apart = bodies.velocity[:, i] - motion[0]
                columns.append(
                    (
                        _dot(way, axis),
                        _dot(apart, axis) + _dot(way, np.cross(own[0], axis)),
                        _slide_acceleration(bodies, i, way, axis, motion, *own),
                    )
                )
        if joint.row.has_cross:
            columns += _universal(joint, turn, before, bodies, i, spin, spin_rate)
        if joint.row.is_ball:
            nothing = np.full(rows, np.nan)
            columns += [(value, nothing, nothing) for value in zyx_turns(turn).T]
        parts += columns
        gap, tilt = _apart(joint, turn, local, columns[0][0])
        gaps.append(gap)
        tilts.append(tilt)
    turns = linkage.turning
    q = np.stack([part[0] for part in parts], axis=1)
    q[:, turns] = np.unwrap(q[:, turns], axis=0)
    return JointValues(
        q,
        np.stack([part[1] for part in parts], axis=1),
        np.stack([part[2] for part in parts], axis=1),
        np.stack(gaps, axis=1),
        np.stack(tilts, axis=1),
    )


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))


def _slide_acceleration(
    bodies: BodyStates,
    i: int,
    way: Floats,
    axis: Floats,
    motion: tuple[Floats, Floats],
    spin: Floats,
    spin_rate: Floats,
) -> Floats:
    """The second derivative of `way . axis`, the axis carried by a body that turns so."""
    turning = np.cross(spin, axis)
    return (
        _dot(bodies.acceleration[:, i] - motion[1], axis)
        + 2 * _dot(bodies.velocity[:, i] - motion[0], turning)
        + _dot(way, np.cross(spin_rate, axis) + np.cross(spin, turning))
    )


def _universal(
    joint: Joint, turn: Floats, before: Floats, bodies: BodyStates, i: int, spin: Floats, spin_rate: Floats
) -> list[tuple[Floats, Floats, Floats]]:
    """Both turns of a universal joint: z of the frame before, then z of the frame after."""
    c, s = math.cos(joint.angle), math.sin(joint.angle)
    # Rz(a) Rx(angle) Rz(b): its last column and its last row tell a and b where s is not zero
    first = np.arctan2(turn[:, 0, 2] / s, -turn[:, 1, 2] / s)
    second = np.arctan2(turn[:, 2, 0] / s, turn[:, 2, 1] / s)
    near, far = before[:, :3, 2], bodies.frames[:, i, :3, 2]
    apart = bodies.spin[:, i] - spin

    def along(vector: Floats) -> tuple[Floats, Floats]:
        """The shares x, y of a vector x near + y far (+ what is across both)."""
        one, other = _dot(vector, near), _dot(vector, far)
        return (one - c * other) / s**2, (other - c * one) / s**2

    rates = along(apart)
    rest = (
        bodies.spin_rate[:, i]
        - spin_rate
        - rates[0][:, None] * np.cross(spin, near)
        - rates[1][:, None] * np.cross(bodies.spin[:, i], far)
    )
    seconds = along(rest)
    return [(first, rates[0], seconds[0]), (second, rates[1], seconds[1])]


def _apart(joint: Joint, turn: Floats, local: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """How far apart the sides of a joint stand, and how far askew, in what the joint holds."""
    row, free = joint.row, joint.row.free
    held = local[:, [axis for axis in range(3) if not free[axis]]]
    gap = np.linalg.norm(held, axis=1)
    if row.is_screw:
        # up to whole turns, which follow from the axial place
        turns = np.round((local[:, 2] / joint.advance - angle) / math.tau) if joint.advance else 0.0
        gap = np.hypot(gap, local[:, 2] - joint.advance * (angle + math.tau * turns))
    if row.is_ball:
        return gap, np.zeros(len(local))
    if row.has_cross:
        return gap, np.abs(turn[:, 2, 2] - math.cos(joint.angle)) / math.sin(joint.angle)
    if any(free[3:]):
        return gap, np.hypot(turn[:, 0, 2], turn[:, 1, 2])
    return gap, np.linalg.norm(axial(turn), axis=1)
