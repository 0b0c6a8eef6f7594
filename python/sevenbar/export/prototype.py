"""The linkage as rigid bodies, joints and a drive: all that another program needs, and no equation of ours.

A prototype is made of the linkage and of one row of a circuit, whose pose and velocities it starts with.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import permutations

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import NotCoveredError, RequestError
from sevenbar.export.acting import PlacedLoading, acting
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import poses_along
from sevenbar.kinematics.loop.joints import JointKind, kind_row
from sevenbar.kinematics.loop.rigid import about, inverse

#: The number of the ground among the bodies.
GROUND = -1

#: Radius of gyration of every body about its own frame, as a part of the linkage's size: the motion that the
#: drive prescribes does not depend on masses, so any will do.
GYRATION = 0.1

#: The first joint's axis and the line of two balls must differ by this sine for the rule of the spin.
LEAST_SINE = 1e-8


@dataclass(frozen=True, eq=False)
class MovingBody:
    """A rigid body: its frame at the start, in the report frame, and how that moves.

    `frame` (4, 4); `velocity` of its origin (3,) [length/s]; `spin` (3,) [rad/s]. Its centre of mass is the
    frame's origin. `link` is the link it stands for, counted from 1; 0 for the cross of a universal joint.
    """

    name: str
    link: int
    frame: Floats
    velocity: Floats
    spin: Floats


#: The ground as a body.
STILL = MovingBody("ground", 0, np.eye(4), np.zeros(3), np.zeros(3))


@dataclass(frozen=True, eq=False)
class Connection:
    """A joint between two bodies, of any kind without a cross, which is a body here.

    `before` and `after` number the bodies, `GROUND` for the ground; `frame_before` and `frame_after` (4, 4)
    are the joint's frames in the two, equal where the joint is at zero. `advance` [length for a radian] of H.
    `backwards` and `to_drawn` (4, 4): as of a joint of the linkage.
    """

    name: str
    kind: str
    before: int
    after: int
    frame_before: Floats
    frame_after: Floats
    advance: float = 0.0
    backwards: bool = False
    to_drawn: Floats = field(default_factory=lambda: np.eye(4))

    @property
    def row(self) -> JointKind:
        """Its kind's row of the table."""
        return kind_row(self.kind, backwards=self.backwards)

    @property
    def drawn_before(self) -> Floats:
        """Its frame (4, 4) in the body before, as it is drawn."""
        return self.frame_before if self.backwards else self.frame_before @ self.to_drawn

    @property
    def drawn_after(self) -> Floats:
        """Its frame (4, 4) in the body after, as it is drawn."""
        return self.frame_after @ self.to_drawn if self.backwards else self.frame_after


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
    """The drive: one of the six freedoms of a joint (2 slides along z, 5 turns), from `start` at `speed`."""

    connection: int
    freedom: int
    start: float
    speed: float

    @property
    def turns(self) -> bool:
        """Whether it is a turn."""
        return self.freedom >= 3

    def at(self, time: float) -> float:
        """The value [rad, or length] at a time [s] after the start."""
        return self.start + self.speed * time


@dataclass(frozen=True, eq=False)
class Prototype:
    """Bodies, the joints between them, and the drive.

    `size` [length] is that of the linkage. `values` (k, 6) holds what each joint has slid along x, y, z
    [length] and turned about them [rad] at the start and `rates` (k, 6) how fast that grows; NaN where a
    joint does not move, or is a ball.
    """

    name: str
    length_unit: str
    size: float
    bodies: tuple[MovingBody, ...]
    connections: tuple[Connection, ...]
    spin_rules: tuple[SpinRule, ...]
    drive: PrescribedMotion
    values: Floats
    rates: Floats
    #: Constraints that the others imply, in words.
    redundant: tuple[str, ...] = ()
    #: Masses, loads and springs; none where the linkage has none, and any masses will do.
    acting: PlacedLoading | None = None
    #: The connection that has the constraints of each joint of the linkage next to the link before it.
    seats: tuple[int, ...] = ()

    @property
    def redundant_text(self) -> str:
        """How many constraints the others imply, and which."""
        count = len(self.redundant)
        return f"{count} redundant constraint{'s' * (count > 1)} ({'; '.join(self.redundant)})"

    def frames(self, number: int) -> tuple[Floats, Floats]:
        """Both frames (4, 4) of a joint at the start, in the report frame."""
        own = self.connections[number]
        return self.placed(own.before) @ own.frame_before, self.placed(own.after) @ own.frame_after

    def placed(self, body: int) -> Floats:
        """The frame (4, 4) of a body at the start; the ground's is the report frame."""
        return (STILL if body == GROUND else self.bodies[body]).frame


def prototype(linkage: Solvable, circuit: Circuit, row: int, speed: float) -> Prototype:
    """The prototype of a linkage that starts at one row of a circuit with its input at `speed`.

    Raises `NotCoveredError` for an idle freedom that is not the spin of a link between two balls.
    """
    frames = poses_along(linkage, circuit, np.array([row]))[0]
    # rates of a row are given for the input at the motion's own speed, whatever the pass
    share = speed / circuit.dq[row, circuit.input_column]
    bodies: list[MovingBody] = []
    connections: list[Connection] = []
    values: list[Floats] = []
    rates: list[Floats] = []
    drive: PrescribedMotion | None = None
    graph = linkage.graph
    links, columns = {graph.ground: GROUND}, dict[str, tuple[int, int]]()
    seats = []

    def link_body(link: int) -> MovingBody:
        own = frames[link - 1]
        place = inverse(linkage.point_frames[link - 1]) @ np.array([0.0, 0.0, 0.0, 1.0])
        velocity = circuit.written_point(link, (place[0], place[1], place[2])).velocity[row]
        spin = circuit.link_motion(link).velocity[row]
        return MovingBody(f"link_{link}", link, own, share * velocity, share * spin)

    for i, joint in enumerate(linkage.joints):
        own = linkage.places[i]
        steps = joint.steps(circuit.q[row, own][None])
        paces = [share * pace[0] for _, pace in joint.steps(circuit.dq[row, own][None])]
        link_before, link_after = graph.between[i]
        before = links[link_before]
        frame_before, frame_after = (linkage.joint_on(i, link) for link in graph.between[i])
        first = len(connections)
        seats.append(first)
        if joint.row.has_cross:
            # the cross is a body of its own
            (step, q), (second, _) = steps
            carrier = STILL if before == GROUND else bodies[before]
            start = carrier.frame @ frame_before
            velocity = carrier.velocity + np.cross(carrier.spin, start[:3, 3] - carrier.frame[:3, 3])
            cross, spin = start @ about(step.axis, q[0], 4), carrier.spin + paces[0] * start[:3, step.axis]
            bodies.append(MovingBody(f"{joint.name}_cross", 0, cross, velocity, spin))
            after = len(bodies) - 1
            name, kind = joint.columns[0], step.letter
            connections.append(Connection(name, kind, before, after, frame_before, np.eye(4)))
            before, frame_before = after, joint.before(second)
            name, kind = joint.columns[-1], second.letter
        else:
            name, kind = joint.name, joint.kind
        if link_after not in links:
            bodies.append(link_body(link_after))
            links[link_after] = len(bodies) - 1
        after, both = links[link_after], (frame_before, frame_after)
        connections.append(
            Connection(name, kind, before, after, *both, joint.advance, joint.backwards, joint.to_drawn)
        )
        values += [np.full(6, math.nan) for _ in connections[first:]]
        rates += [np.full(6, math.nan) for _ in connections[first:]]
        column = own.start
        for (step, q), pace in zip(steps, paces, strict=True):
            number = len(connections) - 1 if step.tilted or not joint.row.has_cross else first
            if not joint.row.is_ball:
                values[number][step.number], rates[number][step.number] = q[0], pace
            if not step.driven:
                columns[linkage.columns[column]] = (number, step.number)
            if column == circuit.input_column and not step.driven:
                drive = PrescribedMotion(number, step.number, float(q[0]), speed)
            column += not step.driven
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
        acting(linkage, links, columns),
        tuple(seats),
    )


def _spin_rules(
    linkage: Solvable, bodies: list[MovingBody], connections: list[Connection]
) -> tuple[SpinRule, ...]:
    """The rule of the idle spin of each link between two balls: its y stays across an axis before."""
    axes = linkage.spin_axes
    rules = []
    for joint, following in permutations(connections, 2):
        linked = joint.after == following.before != GROUND
        if joint.name not in axes or not (linked and joint.row.is_ball and following.row.is_ball):
            continue
        body = bodies[joint.after]
        line = body.frame[:3, :3] @ following.frame_before[:3, 3]
        axis_before = joint.frame_before[:3, :3] @ axes[joint.name]
        carrier = STILL if joint.before == GROUND else bodies[joint.before]
        axis = carrier.frame[:3, :3] @ axis_before
        second = np.cross(axis, line)
        if np.linalg.norm(second) <= LEAST_SINE * np.linalg.norm(line):
            raise NotCoveredError(
                f"simulate: at the start the line of {joint.name} and {following.name} is parallel to the "
                "axis before it, where the rule of the spin names no direction; start at another input"
            )
        second /= np.linalg.norm(second)
        rules.append(SpinRule(joint.before, joint.after, axis_before, body.frame[:3, :3].T @ second))
    idle = linkage.idle
    if len(idle) > len(rules):
        raise NotCoveredError(
            f"simulate: {'; '.join(idle)}: an idle freedom that is not the spin of a link between two "
            f"balls is not held in an engine; describe the loop without it{_without_idle(linkage)}"
        )
    return tuple(rules)


def _without_idle(linkage: Solvable) -> str:
    """How a loop of the same motion is written, without freedoms that no engine holds."""
    held = linkage.held
    if held.spins:
        return ""
    letters, changes = [], []
    for i, (joint, own) in enumerate(zip(linkage.joints, linkage.places, strict=True)):
        freedoms = linkage.column_kinds[own]
        selected = [
            "R" if freedom == "turn" else "P"
            for column, freedom in enumerate(freedoms, own.start)
            if column not in held.columns
        ]
        # of a link between two balls an engine holds the spin
        if i in held.balls or len(selected) == len(freedoms):
            letters.append(joint.kind)
            continue
        letters += selected
        changes.append(
            f"{' '.join(selected)} in place of {joint.name}" if selected else f"without {joint.name}"
        )
    return f": {' '.join(letters)} moves alike, {', '.join(changes)}"
