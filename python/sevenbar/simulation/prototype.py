"""The linkage as rigid bodies, joints and a drive: all that another program needs, and no equation of ours.

A prototype is made of the linkage and of one row of a circuit, whose pose and velocities it starts with.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import NotCoveredError, RequestError
from sevenbar.linkage import Linkage
from sevenbar.motion import Circuit
from sevenbar.rigid import inverse, pose
from sevenbar.skeleton import frames_along

#: The number of the ground among the bodies.
GROUND = -1

#: Radius of gyration of every body about its own frame, as a part of the linkage's size: the motion that the
#: drive prescribes does not depend on masses, so any will do.
GYRATION = 0.1

#: The first joint's axis and the line of two balls must differ by this sine for the rule of the spin.
LEAST_SINE = 1e-8

#: The freedoms of a joint along and about the axes of its frame: x, y, z, then turns about them.
FREEDOMS = {
    "R": (False, False, False, False, False, True),
    "P": (False, False, True, False, False, False),
    "C": (False, False, True, False, False, True),
    "H": (False, False, True, False, False, True),
    "S": (False, False, False, True, True, True),
}


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body: its frame at the start, in the report frame, and how that moves.

    `frame` (4, 4); `velocity` of its origin (3,) [length/s]; `spin` (3,) [rad/s]. Its centre of mass is the
    frame's origin. `link` is the link it stands for, counted from 1; 0 for the cross of a universal joint.
    """

    name: str
    link: int
    frame: Floats
    velocity: Floats
    spin: Floats


@dataclass(frozen=True, eq=False)
class Connection:
    """A joint between two bodies, R P C H or S, that turns about and slides along z of its two frames.

    `before` and `after` number the bodies, `GROUND` for the ground; `frame_before` and `frame_after` (4, 4)
    are the joint's frames in the two, equal where the joint is at zero. `advance` [length for a radian] of H.
    """

    name: str
    kind: str
    before: int
    after: int
    frame_before: Floats
    frame_after: Floats
    advance: float = 0.0


@dataclass(frozen=True, eq=False)
class SpinRule:
    """Holds the idle spin of a link between two balls: a direction in one body stays across one in another.

    `axis_before` (3,) of body `before` and `axis_after` (3,) of body `after` stay at right angles.
    """

    before: int
    after: int
    axis_before: Floats
    axis_after: Floats


@dataclass(frozen=True)
class PrescribedMotion:
    """The drive: freedom 2 (slide along z) or 5 (turn about z) of one joint, from `start` at `speed`."""

    connection: int
    freedom: int
    start: float
    speed: float

    def at(self, time: float) -> float:
        """The value [rad, or length] at a time [s] after the start."""
        return self.start + self.speed * time


@dataclass(frozen=True, eq=False)
class Prototype:
    """Bodies, joints and drive; joint k lies between body k - 1 and body k, the ground before and after all.

    `size` [length] is that of the linkage. `values` (k, 2) holds each joint's turn [rad] and slide [length]
    at the start and `rates` (k, 2) how fast they grow; NaN where a joint has none, or is a ball.
    """

    name: str
    length_unit: str
    size: float
    bodies: tuple[Body, ...]
    connections: tuple[Connection, ...]
    spin_rules: tuple[SpinRule, ...]
    drive: PrescribedMotion
    values: Floats
    rates: Floats
    #: Constraints that the others imply, in words.
    redundant: tuple[str, ...] = ()

    def frames(self, number: int) -> tuple[Floats, Floats]:
        """Both frames (4, 4) of a joint at the start, in the report frame."""
        joint = self.connections[number]
        return (
            self.placed(joint.before) @ joint.frame_before,
            self.placed(joint.after) @ joint.frame_after,
        )

    def placed(self, body: int) -> Floats:
        """The frame (4, 4) of a body at the start; the ground's is the report frame."""
        return np.eye(4) if body == GROUND else self.bodies[body].frame


def prototype(linkage: Linkage, circuit: Circuit, row: int, speed: float) -> Prototype:
    """The prototype of a linkage that starts at one row of a circuit with its input at `speed`.

    Raises `NotCoveredError` for an idle freedom that is not the spin of a link between two balls.
    """
    frames = frames_along(linkage, circuit, np.array([row]))[0]
    # rates of a row are told for the input at the motion's own speed, whatever the pass
    share = speed / circuit.dq[row, circuit.input_column]
    bodies: list[Body] = []
    connections: list[Connection] = []
    values: list[tuple[float, float]] = []
    rates: list[tuple[float, float]] = []
    drive: PrescribedMotion | None = None
    column = 0
    before = GROUND
    last = len(linkage.joints) - 1

    def link_body(i: int) -> Body:
        own = frames[i]
        place = inverse(linkage.point_frames[i]) @ np.array([0.0, 0.0, 0.0, 1.0])
        velocity = circuit.point(i + 1, (place[0], place[1], place[2])).velocity[row]
        spin = circuit.link_motion(i + 1).velocity[row]
        return Body(f"link_{i + 1}", i + 1, own, share * velocity, share * spin)

    for i, joint in enumerate(linkage.joints):
        width = len(joint.columns)
        q, dq = circuit.q[row, column : column + width], share * circuit.dq[row, column : column + width]
        frame_before = linkage.base if i == 0 else linkage.links[i - 1]
        if joint.kind == "U":
            # the cross is a body of its own
            above = np.eye(4) if before == GROUND else bodies[before].frame
            start = above @ frame_before
            carrier = None if before == GROUND else bodies[before]
            cross = start @ turned(q[0])
            arm = np.zeros(3) if carrier is None else start[:3, 3] - carrier.frame[:3, 3]
            carried = np.zeros(3) if carrier is None else carrier.spin
            velocity = np.zeros(3) if carrier is None else carrier.velocity + np.cross(carried, arm)
            bodies.append(Body(f"{joint.name}_cross", 0, cross, velocity, carried + dq[0] * start[:3, 2]))
            connections.append(
                Connection(f"{joint.name}.1", "R", before, len(bodies) - 1, frame_before, np.eye(4))
            )
            before = len(bodies) - 1
            frame_before = tilted(joint.angle)
            values.append((q[0], math.nan))
            rates.append((dq[0], math.nan))
        kind = "R" if joint.kind == "U" else joint.kind
        slide = {"P": 0, "C": 1}.get(kind)
        turn = {"R": width - 1, "C": 0, "H": 0}.get(kind)
        if i < last:
            bodies.append(link_body(i))
            after, frame_after = len(bodies) - 1, np.eye(4)
        else:
            after, frame_after = GROUND, linkage.ground
        name = joint.columns[-1] if joint.kind == "U" else joint.name
        advance = joint.pitch / math.tau
        connections.append(Connection(name, kind, before, after, frame_before, frame_after, advance))
        values.append((_value(q, turn), _value(q, slide)))
        rates.append((_value(dq, turn), _value(dq, slide)))
        if column <= circuit.input_column < column + width:
            offset = circuit.input_column - column
            number = len(connections) - 1 - (joint.kind == "U" and offset == 0)
            slides = linkage.column_kinds[circuit.input_column] == "slide"
            drive = PrescribedMotion(number, 2 if slides else 5, float(q[offset]), speed)
        column += width
        before = after
    if drive is None:
        raise RequestError(f"input: column {circuit.input_column} is no joint of this linkage")
    return Prototype(
        linkage.name,
        linkage.length_unit,
        circuit.size,
        tuple(bodies),
        tuple(connections),
        _spin_rules(linkage, bodies, connections),
        drive,
        np.array(values),
        np.array(rates),
        linkage.mobility().redundant,
    )


def _value(values: Floats, place: int | None) -> float:
    return math.nan if place is None else float(values[place])


def _spin_rules(linkage: Linkage, bodies: list[Body], connections: list[Connection]) -> tuple[SpinRule, ...]:
    """The rule of the idle spin of each link between two balls: its y stays across the axis before."""
    rules = []
    for first, joint in enumerate(connections[:-1]):
        following = connections[first + 1]
        if joint.kind != "S" or following.kind != "S":
            continue
        if first == 0:
            raise NotCoveredError(
                f"simulate: link 1 spins idly between {joint.name} and {following.name} and no axis stands "
                "before it; describe the loop from another joint on"
            )
        body = bodies[joint.after]
        line = body.frame[:3, :3] @ following.frame_before[:3, 3]
        axis_frame = connections[first - 1].frame_after
        axis = bodies[joint.before].frame[:3, :3] @ axis_frame[:3, 2]
        second = np.cross(axis, line)
        if np.linalg.norm(second) <= LEAST_SINE * np.linalg.norm(line):
            raise NotCoveredError(
                f"simulate: at the start the line of {joint.name} and {following.name} is parallel to the "
                f"axis of {connections[first - 1].name}, where the rule of the spin names no direction; "
                "start at another input"
            )
        second /= np.linalg.norm(second)
        rules.append(SpinRule(joint.before, joint.after, axis_frame[:3, 2], body.frame[:3, :3].T @ second))
    idle = linkage.idle
    if len(idle) > len(rules):
        raise NotCoveredError(
            f"simulate: {'; '.join(idle)}: an idle freedom that is not the spin of a link between two "
            "balls is not held in an engine; describe the loop without it"
        )
    return tuple(rules)


def turned(angle: float) -> Floats:
    """The turn (4, 4) about z."""
    c, s = math.cos(angle), math.sin(angle)
    return pose([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], np.zeros(3))


def tilted(angle: float) -> Floats:
    """The turn (4, 4) about x."""
    c, s = math.cos(angle), math.sin(angle)
    return pose([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]], np.zeros(3))
