"""A circuit in the order of its motion, and the poses of its links on the way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.loop.rigid import inverse, pose, product


@dataclass(frozen=True, eq=False)
class Walk:
    """A circuit as it is walked; closed by its first row, a turn on, unless a law drives.

    `rows` index the circuit; `input`, `output` [rad] and `time` [s] run on over the closure, each (n,).
    `passes` are the stretches between input dead centres, both ends included; `ways` has a factor for the
    velocities of each: -1 where the input goes back, against its speed, else 1.
    """

    rows: Integers
    input: Floats
    output: Floats
    time: Floats
    passes: tuple[slice, ...]
    ways: tuple[float, ...]

    @cached_property
    def sign(self) -> Floats:
        """The factor of the velocities on each row, (n,)."""
        sign = np.ones(len(self.rows))
        for way, part in zip(self.ways, self.passes, strict=True):
            sign[part] = way
        return sign

    def velocities(self, rates: Floats) -> Floats:
        """Rates by time (rows of the circuit, ..) along the walk as they are seen: turned on the way back."""
        turned: Floats = (rates[self.rows].T * self.sign).T
        return turned


@once_for(0)
def walk(circuit: Circuit) -> Walk:
    """The rows of a circuit in the order of its motion."""
    count = len(circuit.time)
    starts = [0, *(np.flatnonzero(np.diff(circuit.branch)) + 1), count]
    rows, inputs, outputs, times = np.arange(count), circuit.input, circuit.output, circuit.time
    closes = circuit.closed and count > 1 and not math.isnan(circuit.speed)
    if closes:
        # one that turns back on the way is walked as it rises
        way = circuit.turns * math.copysign(math.tau, circuit.speed if circuit.goes_round else 1.0)
        gained = 0.0 if circuit.output_range is not None else _turns_gained(outputs)
        last = inputs[0] + way
        times = np.append(times, times[-1] + abs(last - inputs[-1]) / abs(circuit.speed))
        rows, inputs = np.append(rows, 0), np.append(inputs, last)
        outputs = np.append(outputs, outputs[0] + gained)
    passes = tuple(slice(a, b + closes) for a, b in pairwise(starts))
    return Walk(rows, inputs, outputs, times, passes, _ways(circuit.speed, inputs, passes))


def _ways(speed: float, inputs: Floats, passes: Sequence[slice]) -> tuple[float, ...]:
    if math.isnan(speed) or len(passes) < 2:
        return (1.0,) * len(passes)
    rises = (float(inputs[part][-1] - inputs[part][0]) for part in passes)
    return tuple(math.copysign(1.0, rise * speed) for rise in rises)


def _turns_gained(angles: Floats) -> float:
    """The whole turns [rad] between the first row of a closed circuit and the first again; 0 if unknown."""
    ahead = float(2 * angles[-1] - angles[-2] - angles[0])
    return round(ahead / math.tau) * math.tau if math.isfinite(ahead) else 0.0


def along(linkage: Loop, circuit: Circuit, column: int) -> Floats:
    """A column [rad, or length] of a circuit along its walk; a turn runs on over the closure, (n,)."""
    path = walk(circuit)
    if column == circuit.output_column:
        return path.output
    values: Floats = circuit.q[path.rows, column]
    if len(path.rows) > len(circuit.time) and linkage.turns(column):
        values[-1] += _turns_gained(circuit.q[:, column])
    return values


def at_row(values: Floats, row: float) -> Floats:
    """Values (n, ..) of rows at a row from 0 to n - 1, on the straight line between two, (..)."""
    low = min(int(row), len(values) - 1)
    high, share = min(low + 1, len(values) - 1), row - low
    between: Floats = values[low] + share * (values[high] - values[low]) if share else values[low]
    return between


def poses(linkage: Loop, q: Floats) -> Floats:
    """The frames (n, links, 4, 4) of the links in the report frame, from joint values (n, columns).

    That of the ground, the last link, is the report frame itself.
    """
    if linkage.net is not None:
        return _poses_of_net(linkage, q)
    now = np.broadcast_to(linkage.base, (len(q), 4, 4))
    result = np.empty((len(q), len(linkage.joints), 4, 4))
    for i, link in enumerate(linkage.links):
        frame = now @ linkage.joints[i].motion(q[:, linkage.places[i]])
        result[:, i] = frame
        now = product(frame, link)
    result[:, -1] = np.eye(4)
    return result


def _poses_of_net(linkage: Loop, q: Floats) -> Floats:
    """The same of a net, along a tree of its joints and of the columns of links that rods alone hold."""
    graph = linkage.graph
    result = np.full((len(q), graph.ground, 4, 4), np.nan)
    result[:, -1] = np.eye(4)
    reached = {graph.ground}
    for joint in graph.tree:
        before, after = graph.between[joint]
        moved = linkage.joints[joint].motion(q[:, linkage.places[joint]])
        first, second = linkage.frames[joint]
        if before in reached:
            result[:, after - 1] = result[:, before - 1] @ first @ moved @ inverse(second)
        else:
            result[:, before - 1] = result[:, after - 1] @ second @ inverse(moved) @ inverse(first)
        reached |= {before, after}
    for apart in linkage.links_apart:
        result[:, apart.link - 1] = apart.poses(q)
    return result


def _poses_back(linkage: Loop, q: Floats) -> Floats:
    """The same by the joints after each link, from the ground back."""
    now = linkage.ground @ inverse(linkage.joints[-1].motion(q[:, linkage.places[-1]]))
    result = np.empty((len(q), len(linkage.joints), 4, 4))
    result[:, -1] = np.eye(4)
    for i in reversed(range(len(linkage.links))):
        result[:, i] = frame = now @ inverse(linkage.links[i])
        now = frame @ inverse(linkage.joints[i].motion(q[:, linkage.places[i]]))
    return result


def joint_frames(linkage: Loop, frames: Floats) -> tuple[Floats, Floats]:
    """The frames (n, joints, 4, 4) of each joint on the link before it and on the link after it.

    `frames` (n, links, 4, 4) are those of the links, as `poses` gives them. A joint that slides is where it
    is drawn on both, whatever it reads there.
    """
    return frames_on(linkage, frames, 0), frames_on(linkage, frames, 1)


def frames_on(linkage: Loop, frames: Floats, side: Literal[0, 1]) -> Floats:
    """Those on the link before each joint (0), or on the link after it (1)."""
    if linkage.net is None:
        result = np.empty(frames.shape)
        if side:
            result[:, :-1], result[:, -1] = frames[:, :-1], linkage.ground
        else:
            result[:, 0] = linkage.base
            for i, link in enumerate(linkage.links):
                result[:, i + 1] = product(frames[:, i], link)
    else:
        links = np.array(linkage.graph.between)[:, side] - 1
        result = frames[:, links] @ linkage.frames[:, side]
    for i, joint in enumerate(linkage.joints):
        if joint.value and joint.backwards == side:
            result[:, i] = result[:, i] @ joint.to_drawn
    return result


def opening(linkage: Loop, frames: Floats, q: Floats) -> Floats:
    """How far the frames (n, links, 4, 4) of the links leave the loop open, (n, 4, 4): of the last joint."""
    before = frames_on(linkage, frames, 0)
    closing = before[:, -1] @ linkage.joints[-1].motion(q[:, linkage.places[-1]])
    return np.abs(closing - linkage.ground)


def drawn_frames(linkage: Loop) -> tuple[Floats, Floats]:
    """The frames (joints, 4, 4) before and after each joint in the drawn pose, each after those before it."""
    q, now = linkage.drawn_pose[None], linkage.base
    before, after = [], []
    for joint, own, link in zip(linkage.joints, linkage.places, linkage.transforms, strict=True):
        before.append(now)
        after.append(now @ joint.motion(q[:, own])[0])
        now = after[-1] @ link
    return np.stack(before), np.stack(after)


def joint_places(linkage: Loop, frames: Floats, link: int) -> list[Floats]:
    """The places (n, 3) of the joints of a link on it, from the frames (n, links, 4, 4) of all links."""
    sides, graph = joint_frames(linkage, frames), linkage.graph
    return [sides[graph.side(joint, link)][:, joint, :3, 3] for joint in graph.joints_of(link)]


def poses_along(linkage: Loop, circuit: Circuit, rows: Integers) -> Floats:
    """The frames (n, links, 4, 4) of the links along rows of a circuit; NaN where it has no pose."""
    q = circuit.q[rows]
    frames = poses(linkage, q)
    # where a ball's turns have no value, the links still have a place: those beyond it by the ground
    has_pose = ~np.isnan(q).all(axis=1)
    part = np.flatnonzero(has_pose & np.isnan(frames).any(axis=(1, 2, 3)))
    if linkage.net is None:
        frames[part] = np.where(np.isnan(frames[part]), _poses_back(linkage, q[part]), frames[part])
    lost = np.flatnonzero(has_pose & np.isnan(frames).any(axis=(1, 2, 3)))
    for link in linkage.graph.moving if lost.size else ():
        x, y, z = (float(value) for value in inverse(linkage.point_frames[link - 1])[:3, 3])
        frames[lost, link - 1] = pose(
            circuit.link_motion(link).rotation[rows[lost]],
            circuit.written_point(link, (x, y, z)).position[rows[lost]],
        )
    return frames
