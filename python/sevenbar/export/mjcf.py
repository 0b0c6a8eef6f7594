"""A prototype as MJCF, the XML of MuJoCo: a tree of bodies from the ground, the loop closed by equalities.

    model = prototype(linkage, circuit, row=0, speed=motion.speed)
    xml = mjcf(model)

Lengths are in metres. A joint's coordinate is Sevenbar's column of it, also where the tree goes through the
joint backwards; a ball counts from the pose of the file. Bodies lie in the start pose, closed, as a viewer
opens them, and each joint has its value there as `ref`. The key frame `start` has the velocities, too.

The input is driven in one of these ways:

- velocity   an actuator that keeps the motion's speed by itself; its control is a speed on top
- position   an actuator whose control is the input's value
- motor      an actuator whose control is torque or force
- flywheel   no actuator: so great an inertia that it runs on at the speed of the key frame, gravity or not
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Literal
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.mjcf_acting import add_springs, gyration, heaviest, inertial, joint_spring
from sevenbar.export.mjcf_elements import add, mark, numbers, placed
from sevenbar.export.prototype import GROUND, STILL, Connection, Prototype, SpinRule
from sevenbar.kinematics.loop.geometry import moved_by
from sevenbar.kinematics.loop.joints import Step
from sevenbar.kinematics.loop.rigid import inverse, pose
from sevenbar.text.units import LENGTHS

#: The flywheel's inertia, in those of a body: constraints change its speed by about the inverse of this.
FLYWHEEL = 1e10

#: How the input is driven.
Drive = Literal["velocity", "position", "motor", "flywheel"]

#: Gains of the actuators, in those that stop the inertia of a body within a second: of speed, of position.
#: That of a speed above 1 rad/s is so many times as great: what resists grows with the square of the speed.
SPEED_GAIN, POSITION_GAIN = 1e3, 1e5

#: Constraints come back with this time constant, in time steps: MuJoCo's least, below which it is unstable.
TIME_CONSTANT = 2.0

#: How much of a constraint's error MuJoCo answers for: its greatest, so that the loop is as hard as can be.
IMPEDANCE = 0.9999

#: The longest time step [s] of a file, and how many steps a turn of the input has at least: with fewer a
#: fast loop opens, by 2 % of its size with 20.
LONGEST_STEP, STEPS_OF_A_TURN = 1e-3, 360

#: Radius of the drawn bars, as a part of the linkage's size.
BAR = 0.008


@dataclass(frozen=True)
class Cut:
    """Where the loop is cut: the joint's number, and whether a weld beyond the last joint closes it."""

    connection: int
    weld: bool


def cut(model: Prototype) -> Cut:
    """At the far ball of a link between two, else at the first ball, else beyond the last joint."""
    balls = [number for number, joint in enumerate(model.connections) if joint.row.is_ball]
    held = {rule.after for rule in model.spin_rules}
    far = [number for number in balls if model.connections[number].before in held]
    chosen = (far or balls)[:1]
    return Cut(chosen[0], False) if chosen else Cut(len(model.connections) - 1, True)


def _time_step(model: Prototype) -> float:
    """A step [s] that closes the loop at the speed of the drive: `LONGEST_STEP`, shorter for a fast one."""
    drive = model.drive
    turn = math.tau * (1.0 if drive.turns else model.size)
    return min(LONGEST_STEP, turn / (STEPS_OF_A_TURN * abs(drive.speed))) if drive.speed else LONGEST_STEP


def mjcf(model: Prototype, *, time_step: float | None = None, drive: Drive = "flywheel") -> str:
    """The MJCF of a prototype: a text that MuJoCo loads.

    Bodies are `link_1` .. and the crosses of universal joints; joints are named as Sevenbar's columns, a
    ball by its own name, the slide of a screw `<joint>.slide`. `loop` is the equality that closes the loop
    between two sites, `time_step` [s] also sets how fast it comes back: without one a millisecond, or less
    for a fast drive. The actuator of a `drive` is `drive`.

        >>> import sevenbar as sb
        >>> course, model = sb.simulation.prepared(sb.load("rssr"))
        >>> mjcf(model).splitlines()[0]
        '<mujoco model="RSSR of Sun and Zhou">'
    """
    time_step = _time_step(model) if time_step is None else time_step
    metre = LENGTHS[model.length_unit]
    root = Element("mujoco", model=model.name)
    root.append(ElementTree.Comment(" made by Sevenbar; lengths in metres, angles in radians "))
    add(root, "compiler", angle="radian", autolimits="true")
    gravity = "0 0 0" if model.acting is None else numbers(model.acting.gravity)
    # an actuator's gain is met within a step, which needs an implicit one
    integrator = "Euler" if drive == "flywheel" else "implicitfast"
    how = {"integrator": integrator, "solver": "Newton", "iterations": "100", "tolerance": "0"}
    add(root, "option", timestep=f"{time_step:.17g}", gravity=gravity, **how)
    extent = max(model.size * metre / 3, 1e-9)
    places = np.array([model.frames(number)[0][:3, 3] for number in range(len(model.connections))])
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    add(root, "statistic", extent=f"{extent:.6g}", center=numbers(middle * metre))
    default = add(root, "default")
    add(default, "geom", contype="0", conaffinity="0", mass="0", rgba="0.35 0.5 0.7 1")
    stiff = f"{TIME_CONSTANT * time_step:.17g} 1"
    add(default, "equality", solref=stiff, solimp=f"{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2")
    world = add(root, "worldbody")
    add(world, "light", pos=numbers([0, 0, 3 * extent]), dir="0 0 -1", directional="true")
    tree = _Tree(model, world, add(root, "equality"), flywheel=drive == "flywheel")
    tree.close(cut(model))
    add_springs(root, model, tree.elements)
    control = {} if drive == "flywheel" else {"ctrl": _actuator(root, model, drive)}
    frames = add(root, "keyframe")
    add(frames, "key", name="start", qpos=numbers(tree.qpos), qvel=numbers(tree.qvel), **control)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _actuator(root: Element, model: Prototype, drive: Drive) -> str:
    """Adds the actuator of the input; its control at the start."""
    number, freedom = model.drive.connection, model.drive.freedom
    unit = 1.0 if model.drive.turns else LENGTHS[model.length_unit]
    joint = next(
        name
        for name, step in model.connections[number].row.named(model.connections[number].name)
        if step.number == freedom
    )
    value, speed = (float(rows[number, freedom]) * unit for rows in (model.values, model.rates))
    by_speed, by_place = (gain * _inertia(model) for gain in (SPEED_GAIN, POSITION_GAIN))
    held = by_speed * (max(1.0, abs(speed)) if model.drive.turns else 1.0)
    how = {
        "velocity": {"gainprm": [held], "biasprm": [held * speed, 0.0, -held]},
        "position": {"gainprm": [by_place], "biasprm": [0.0, -by_place, -by_speed]},
        "motor": {"gainprm": [1.0]},
    }[drive]
    bias = {"biastype": "affine"} if "biasprm" in how else {}
    actuators = add(root, "actuator")
    written = {key: numbers(values) for key, values in how.items()}
    add(actuators, "general", name="drive", joint=joint, gaintype="fixed", **bias, **written)
    return f"{value:.17g}" if drive == "position" else "0"


def _inertia(model: Prototype) -> float:
    """The inertia [kg m^2; of a slide kg] of a body, by which the drive is measured."""
    mass, drive = heaviest(model), model.drive
    inertia = mass * (gyration(model) ** 2 if drive.turns else 1.0)
    advance = model.connections[drive.connection].advance * LENGTHS[model.length_unit]
    return max(inertia, mass * advance**2)


class _Tree:
    """The tree of bodies as it grows: `elements` holds the XML element of each body placed so far.

    `qpos` and `qvel` are joint coordinates and velocities of the start, in the order of MuJoCo.
    """

    def __init__(self, model: Prototype, world: Element, equality: Element, *, flywheel: bool) -> None:
        self._has_flywheel = flywheel
        self._model, self._metre, self._equality = model, LENGTHS[model.length_unit], equality
        self.elements: dict[int, Element] = {GROUND: world}
        self.qpos: list[float] = []
        self.qvel: list[float] = []
        self._rules = {rule.after: rule for rule in model.spin_rules}

    def close(self, where: Cut) -> None:
        """Adds all bodies, from the ground up to the cut on both sides, and what closes the loop there."""
        model = self._model
        self._grow(GROUND, where)
        closing = model.connections[where.connection]
        if where.weld:
            self._add(self.elements[closing.before], closing, where.connection, 1.0)
            mark(self.elements[GROUND], "ground_side", closing.frame_after, model)
            kind, sites, more = (
                "weld",
                ("ground_side", "loop_end"),
                {"torquescale": f"{gyration(model):.17g}"},
            )
        else:
            kind, sites, more = "connect", (f"{closing.name}_before", f"{closing.name}_after"), {}
            mark(self.elements[closing.before], sites[0], closing.frame_before, model)
            mark(self.elements[closing.after], sites[1], closing.frame_after, model)
        add(self._equality, kind, name="loop", site1=sites[0], site2=sites[1], **more)

    def _grow(self, body: int, where: Cut) -> None:
        """Adds all bodies beyond one that is placed, except the joint where the loop is cut."""
        for number, joint in enumerate(self._model.connections):
            ends = joint.before, joint.after
            if number == where.connection or body not in ends:
                continue
            child, direction = (joint.after, 1.0) if body == joint.before else (joint.before, -1.0)
            if child not in self.elements:
                self._add(self.elements[body], joint, number, direction)
                self._grow(child, where)

    def _add(self, parent: Element, joint: Connection, number: int, direction: float) -> Element:
        """Adds the body after a joint, or with `direction` -1 the one before it, read as the same joint.

        Past the last joint a bare body that the ground's frame is welded to.
        """
        child, near, far = joint.after, joint.frame_before, joint.frame_after
        if direction < 0:
            child, near, far = joint.before, far, near
        elif child in self._rules:
            return self._add_held_ball(parent, joint, self._rules[child])
        name = self._model.bodies[child].name if child != GROUND else "loop_end_body"
        far = far if child != GROUND else np.eye(4)
        moved = self._moved(joint, number)
        body = self._add_body(
            parent, name, near @ (moved if direction > 0 else inverse(moved)) @ inverse(far), child
        )
        self._add_freedoms(body, joint, number, far, direction)
        if child == GROUND:
            mark(body, "loop_end", far, self._model)
        return body

    def _add_body(self, parent: Element, name: str, frame: Floats, number: int) -> Element:
        body = add(parent, "body", name=name, **placed(frame, self._metre))
        add(body, "inertial", **inertial(self._model, number))
        if number != GROUND:
            self.elements[number] = body
            self._add_bar(body, number)
        return body

    def _add_bar(self, body: Element, number: int) -> None:
        """A bar between the two joints of a body, for the eye."""
        ends = [joint.drawn_after[:3, 3] for joint in self._model.connections if joint.after == number]
        ends += [joint.drawn_before[:3, 3] for joint in self._model.connections if joint.before == number]
        radius = f"{BAR * self._model.size * self._metre:.6g}"
        first, second = (end * self._metre for end in ends)
        if np.linalg.norm(second - first) > BAR * self._model.size * self._metre:
            shape = {"type": "capsule", "size": radius, "fromto": numbers([*first, *second])}
        else:
            shape = {"type": "sphere", "size": radius, "pos": numbers(first)}
        add(body, "geom", **shape)

    def _add_freedoms(
        self, body: Element, joint: Connection, number: int, frame: Floats, direction: float
    ) -> None:
        """The joints of MuJoCo that make up one of ours, at `frame` of the body, and their start."""
        if joint.row.is_ball:
            add(body, "joint", name=joint.name, type="ball", pos=numbers(frame[:3, 3] * self._metre))
            # counted from the pose in which the bodies lie
            self.qpos += [1.0, 0.0, 0.0, 0.0]
            own, other = (joint.after, joint.before) if direction > 0 else (joint.before, joint.after)
            rotation = self._model.placed(own)[:3, :3]
            self.qvel += list(rotation.T @ (self._spin(own) - self._spin(other)))
            return
        steps = joint.row.named(joint.name)
        carried = self._carried([step for _, step in steps], number, direction)
        # a joint of MuJoCo is carried by those before it in its body
        order = range(len(steps)) if direction > 0 else reversed(range(len(steps)))
        for k in order:
            (name, step), at = steps[k], frame @ carried[k]
            turns = step.freedom == "turn"
            unit, place = (1.0, {"pos": numbers(at[:3, 3] * self._metre)}) if turns else (self._metre, {})
            value = float(self._model.values[number, step.number]) * unit
            add(
                body,
                "joint",
                name=name,
                type="hinge" if turns else "slide",
                **place,
                axis=numbers(direction * at[:3, step.axis]),
                ref=f"{value:.17g}",
                **self._flywheel(number, step.number),
                **joint_spring(self._model, number, step.number),
            )
            self.qpos.append(value)
            self.qvel.append(float(self._model.rates[number, step.number]) * unit)
            if step.driven:
                tie, advance = f"{joint.name}_screw", numbers([0, joint.advance * self._metre, 0, 0, 0])
                add(self._equality, "joint", name=tie, joint1=name, joint2=joint.name, polycoef=advance)

    def _moves(self, steps: Sequence[Step], number: int) -> list[Floats]:
        """The motion (4, 4) of each step at the start."""
        values = self._model.values[number]
        return [moved_by(step, np.array([values[step.number]]))[0] for step in steps]

    def _moved(self, joint: Connection, number: int) -> Floats:
        """The motion (4, 4) of a joint at the start, from its frame before to that after."""
        if joint.row.is_ball:
            before, after = self._model.frames(number)
            return pose(before[:3, :3].T @ after[:3, :3], np.zeros(3))
        return reduce(np.matmul, self._moves(joint.row.steps, number), np.eye(4))

    def _carried(self, steps: Sequence[Step], number: int, direction: float) -> list[Floats]:
        """The frame (4, 4) of each step at the start, in the joint's frame on the body that it moves."""
        moves = self._moves(steps, number)
        if direction < 0:
            return [reduce(np.matmul, moves[:k], np.eye(4)) for k in range(len(moves))]
        return [inverse(reduce(np.matmul, moves[k + 1 :], np.eye(4))) for k in range(len(moves))]

    def _add_held_ball(self, parent: Element, joint: Connection, rule: SpinRule) -> Element:
        """A ball whose link's idle spin is held: two hinges, about the two directions that stay square."""
        model = self._model
        above, own = model.placed(joint.before), model.bodies[joint.after].frame
        body = self._add_body(parent, model.bodies[joint.after].name, inverse(above) @ own, joint.after)
        place = numbers(joint.frame_after[:3, 3] * self._metre)
        first = own[:3, :3].T @ above[:3, :3] @ rule.axis_before
        for end, axis in (("1", first), ("2", rule.axis_after)):
            add(body, "joint", name=f"{joint.name}.{end}", type="hinge", pos=place, axis=numbers(axis))
        spin = own[:3, :3].T @ (self._spin(joint.after) - self._spin(joint.before))
        self.qpos += [0.0, 0.0]
        self.qvel += [float(spin @ first), float(spin @ rule.axis_after)]
        return body

    def _spin(self, body: int) -> Floats:
        return (STILL if body == GROUND else self._model.bodies[body]).spin

    def _flywheel(self, number: int, freedom: int) -> dict[str, str]:
        """The inertia that keeps the driven joint at its speed."""
        drive = self._model.drive
        if not self._has_flywheel or number != drive.connection or freedom != drive.freedom:
            return {}
        return {"armature": f"{FLYWHEEL * _inertia(self._model):.17g}"}
