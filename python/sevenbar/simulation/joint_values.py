"""What joints do, read off the frames and the velocities of bodies: geometry alone, no closure.

Frames are those of links after their joints, as `Loop` has them; the ground comes last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

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


class _Side(NamedTuple):
    """A joint's frame (n, 4, 4) on a body, how its origin moves and how the body turns, (n, 3) each."""

    frame: Floats
    velocity: Floats
    acceleration: Floats
    spin: Floats
    spin_rate: Floats


#: The values (n,) of a column, and their two derivatives by time.
_Values = tuple[Floats, Floats, Floats]


def joint_values(linkage: Loop, bodies: BodyStates) -> JointValues:
    """The values of all joints of a linkage whose links stand and move so."""
    columns: list[_Values] = []
    apart: list[tuple[Floats, Floats]] = []
    for i, joint in enumerate(linkage.joints):
        before, after = (_side(linkage, bodies, i, link) for link in linkage.graph.between[i])
        turn = np.swapaxes(before.frame[:, :3, :3], 1, 2) @ after.frame[:, :3, :3]
        way = after.frame[:, :3, 3] - before.frame[:, :3, 3]
        own = _columns(joint, turn, way, before, after)
        slider = after if joint.row.slides_on_after else before
        local = np.einsum("nji,nj->ni", slider.frame[:, :3, :3], way)
        columns += own
        apart.append(_apart(joint, turn, local, own[0][0]))
    q, dq, ddq = (np.stack(part, axis=1) for part in zip(*columns, strict=True))
    q[:, linkage.turning] = np.unwrap(q[:, linkage.turning], axis=0)
    gap, tilt = (np.stack(part, axis=1) for part in zip(*apart, strict=True))
    return JointValues(q, dq, ddq, gap, tilt)


def _side(linkage: Loop, bodies: BodyStates, joint: int, link: int) -> _Side:
    """A joint on one of its links."""
    on, body = linkage.joint_on(joint, link), link - 1
    _, velocity, acceleration = bodies.point(body, on[:3, 3])
    spins = bodies.spin[:, body], bodies.spin_rate[:, body]
    return _Side(bodies.frames[:, body] @ on, velocity, acceleration, *spins)


def _columns(joint: Joint, turn: Floats, way: Floats, before: _Side, after: _Side) -> list[_Values]:
    """The columns of a joint, whose sides are a `turn` (n, 3, 3) and a `way` (n, 3) apart."""
    if joint.row.is_ball:
        nothing = np.full(len(turn), np.nan)
        return [(value, nothing, nothing) for value in zyx_turns(turn).T]
    if joint.row.has_cross:
        return _universal(joint, turn, before, after)
    columns: list[_Values] = []
    turned = False
    for step in joint.row.steps:
        # what is behind a turn goes with it: across its axis that is the body after
        carrier = after if turned and step.axis != Z else before
        axis = carrier.frame[:, :3, step.axis]
        turned = turned or step.freedom == "turn"
        # d(axis)/dt
        swept = np.cross(carrier.spin, axis)
        if step.driven:
            continue
        if step.freedom == "turn":
            spin, rate = after.spin - before.spin, after.spin_rate - before.spin_rate
            value = np.arctan2(turn[:, 1, 0], turn[:, 0, 0])
            columns.append((value, _dot(spin, axis), _dot(rate, axis) + _dot(spin, swept)))
        else:
            velocity = after.velocity - before.velocity
            acceleration = (
                _dot(after.acceleration - before.acceleration, axis)
                + 2 * _dot(velocity, swept)
                + _dot(way, np.cross(carrier.spin_rate, axis) + np.cross(carrier.spin, swept))
            )
            columns.append((_dot(way, axis), _dot(velocity, axis) + _dot(way, swept), acceleration))
    return columns


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))


def _universal(joint: Joint, turn: Floats, before: _Side, after: _Side) -> list[_Values]:
    """Both turns of a universal joint: z of the frame before, then z of the frame after."""
    c, s = math.cos(joint.angle), math.sin(joint.angle)
    # Rz(a) Rx(angle) Rz(b): its last column and its last row tell a and b where s is not zero
    first = np.arctan2(turn[:, 0, 2] / s, -turn[:, 1, 2] / s)
    second = np.arctan2(turn[:, 2, 0] / s, turn[:, 2, 1] / s)
    near, far = before.frame[:, :3, 2], after.frame[:, :3, 2]

    def along(vector: Floats) -> tuple[Floats, Floats]:
        """The shares x, y of a vector x near + y far (+ what is across both)."""
        one, other = _dot(vector, near), _dot(vector, far)
        return (one - c * other) / s**2, (other - c * one) / s**2

    rates = along(after.spin - before.spin)
    rest = (
        after.spin_rate
        - before.spin_rate
        - rates[0][:, None] * np.cross(before.spin, near)
        - rates[1][:, None] * np.cross(after.spin, far)
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
