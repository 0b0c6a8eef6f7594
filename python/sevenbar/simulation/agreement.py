"""An engine's record beside Sevenbar's rows: joints, named points, forces, closure errors, differences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Booleans, Floats
from sevenbar.export.prototype import Prototype
from sevenbar.forces.result import Forces
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import placed
from sevenbar.simulation.course import Course
from sevenbar.simulation.engine import Record
from sevenbar.simulation.joint_values import BodyStates, JointValues, joint_values
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False)
class ComparedForce:
    """A torque, a force or a moment of both at n rows, (n, k) each [`unit`], its components named by `axes`.

    The input's own has one component without a name. Of a reaction only those are here that equilibrium
    determines, along the axes of the joint's frame on the side of the link before.
    """

    name: str
    what: str
    unit: str
    axes: tuple[str, ...]
    engine: Floats
    theory: Floats

    @property
    def apart(self) -> Floats:
        """How far they are apart (n,)."""
        return np.asarray(np.linalg.norm(self.engine - self.theory, axis=1))

    @property
    def size(self) -> Floats:
        """How great Sevenbar's is (n,)."""
        return np.asarray(np.linalg.norm(self.theory, axis=1))


def compared_forces(course: Course, model: Prototype, record: Record) -> tuple[ComparedForce, ...]:
    """The input's torque, and what the constraints of each joint bear; nothing where an engine has no forces.

    What passes along a joint's own freedoms is a spring's, and at the input the torque; a ball that holds an
    idle spin bears what the rule needs.
    """
    if record.drive is None:
        return ()
    circuit, rows, first = course.circuit, course.rows, len(course.lead)
    forces, linkage = circuit.forces(), course.motion.linkage
    name = linkage.columns[circuit.input_column]
    what = "force" if forces.slides else "torque"
    drive = ComparedForce(
        name, what, forces.unit, ("",), record.drive[first:, None], forces.torque[rows][:, None]
    )
    if record.reactions is None:
        return (drive,)
    result = [drive]
    for joint, seat in zip(linkage.joints, model.seats, strict=True):
        row = model.connections[seat].row
        if not row.is_screw:
            result += _reaction(forces, joint.name, rows, row.free, record.reactions[first:, seat])
    return tuple(result)


def _reaction(
    forces: Forces, name: str, rows: np.ndarray, free: Sequence[bool], engine: Floats
) -> list[ComparedForce]:
    """The force and the moment in a joint, where any of their components is determinate."""
    reaction = forces.reactions[name]
    slides, turns = np.array(free[:3]), np.array(free[3:])
    result = []
    for what, unit, own, held, part in (
        ("force", "N", reaction.force, reaction.determinate[3:] & ~slides, engine[:, :3]),
        ("moment", "N m", reaction.moment, reaction.determinate[:3] & ~turns, engine[:, 3:]),
    ):
        if held.any():
            along = np.einsum("nji,nj->ni", reaction.axes[rows], part)
            axes = tuple(axis for axis, here in zip("xyz", held, strict=True) if here)
            result.append(ComparedForce(name, what, unit, axes, along[:, held], own[rows][:, held]))
    return result


@dataclass(frozen=True)
class Difference:
    """How far the engine is from Sevenbar in one quantity: greatest and median, absolute.

    `at` is the input [rad, or length] where it is greatest; `scale` the greatest absolute value that
    Sevenbar gives. All NaN where no row has a value.
    """

    quantity: str
    unit: str
    greatest: float
    at: float
    median: float
    scale: float


@dataclass(frozen=True, eq=False)
class PointValues:
    """A named point at n times, each (n, 3): position, velocity, acceleration."""

    position: Floats
    velocity: Floats
    acceleration: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Printed):
    """One run of an engine, row by row beside Sevenbar's.

    `input` (n,) and `time` (n,) [s] of the rows; `engine` and `theory` hold the joints' values, the theory's
    without closure errors; `points` holds each named point as the engine and as Sevenbar has it. `returned`
    is by how much the engine's links miss their first places [length] and attitudes [rad] at the end of a
    cycle; None where the course is no cycle. `forces` are those of both, where masses or loads act.
    """

    course: Course
    model: Prototype
    record: Record
    engine: JointValues
    theory: JointValues
    points: dict[str, tuple[PointValues, PointValues]]
    returned: tuple[float, float] | None
    forces: tuple[ComparedForce, ...] = ()
    differences: tuple[Difference, ...] = ()

    @property
    def linkage(self) -> Loop:
        """The linkage that was simulated."""
        return self.course.motion.linkage

    @property
    def time(self) -> Floats:
        """The time [s] of the rows."""
        return self.course.time

    @property
    def input(self) -> Floats:
        """Sevenbar's input [rad, or length] of the rows."""
        return self.theory.q[:, self.course.circuit.input_column]

    @property
    def gap(self) -> float:
        """The engine's greatest closure error [length]."""
        return float(self.engine.gap.max())

    @property
    def tilt(self) -> float:
        """The engine's greatest closure error [rad]."""
        return float(self.engine.tilt.max())

    def difference(self, quantity: str) -> Difference:
        """The difference of this name; `KeyError` where there is none."""
        return {result.quantity: result for result in self.differences}[quantity]


def agreement(course: Course, model: Prototype, record: Record) -> Simulation:
    """What an engine made of a course, beside what Sevenbar says."""
    linkage, circuit = course.motion.linkage, course.circuit
    bodies = _links(model, record, len(course.lead))
    values = joint_values(linkage, bodies)
    closed = np.zeros_like(values.gap)
    theory = JointValues(course.q, circuit.dq[course.rows], circuit.ddq[course.rows], closed, closed)
    _unwind(values, theory, linkage.turning)
    points = {}
    for point in linkage.points:
        place = placed(linkage.point_frames[point.link - 1], point.at)
        trace = circuit.point(point.name)
        own = (part[course.rows] for part in (trace.position, trace.velocity, trace.acceleration))
        points[point.name] = PointValues(*bodies.point(point.link - 1, place)), PointValues(*own)
    returned = None
    if course.closes:
        ends = bodies.frames[[0, -1]]
        apart = np.linalg.norm(ends[1, :, :3, 3] - ends[0, :, :3, 3], axis=-1).max()
        turn = np.swapaxes(ends[0, :, :3, :3], -1, -2) @ ends[1, :, :3, :3]
        # of a small turn the matrix less the unit matrix has a norm of sqrt 2 times its angle
        askew = np.linalg.norm(turn - np.eye(3), axis=(-1, -2)).max() / math.sqrt(2)
        returned = (float(apart), float(askew))
    forces = compared_forces(course, model, record)
    result = Simulation(course, model, record, values, theory, points, returned, forces)
    return replace(result, differences=tuple(_differences(result)))


def _links(model: Prototype, record: Record, first: int) -> BodyStates:
    """The links of a record from one row on, the ground last; crosses left out."""
    kept = [number for number, body in enumerate(model.bodies) if body.link]
    rows = len(record.time) - first

    def with_ground(name: str) -> Floats:
        ground = np.eye(4) if name == "frames" else np.zeros(3)
        own = np.broadcast_to(ground, (rows, 1, *ground.shape))
        return np.concatenate([getattr(record, name)[first:, kept], own], axis=1)

    return BodyStates(*map(with_ground, ("frames", "velocity", "acceleration", "spin", "spin_rate")))


def _unwind(values: JointValues, theory: JointValues, turns: Booleans) -> None:
    """Puts the engine's angles on the same whole turns as Sevenbar's, by their first rows with a value."""
    for column in np.flatnonzero(turns):
        apart = (theory.q[:, column] - values.q[:, column]) / math.tau
        known = apart[np.isfinite(apart)]
        if known.size:
            values.q[:, column] += math.tau * np.round(known[0])


def _differences(run: Simulation) -> Iterator[Difference]:
    """Those of the output and its rates, of all other joints, of points, and of forces."""
    linkage, circuit = run.linkage, run.course.circuit
    unit = linkage.length_unit
    output = circuit.output_column
    order = [output, *(c for c in range(len(linkage.columns)) if c != output)]
    slides = ~linkage.turning
    for column in order:
        name = linkage.columns[column]
        own = unit if slides[column] else "rad"
        word = "position" if slides[column] else "angle"
        rows = (
            (word, own, run.engine.q, run.theory.q),
            ("velocity", f"{own}/s", run.engine.dq, run.theory.dq),
            ("acceleration", f"{own}/s²", run.engine.ddq, run.theory.ddq),
        )
        for what, units, engine, theory in rows if column == output else rows[:1]:
            values = theory[:, column]
            apart = np.abs(engine[:, column] - values)
            yield _difference(run, f"{name} {what}", units, apart, np.nanmax(np.abs(values), initial=0.0))
    for name, (engine_point, theory_point) in run.points.items():
        for what, units in (("position", unit), ("velocity", f"{unit}/s"), ("acceleration", f"{unit}/s²")):
            theory = getattr(theory_point, what)
            apart, size = (
                np.linalg.norm(own, axis=1) for own in (getattr(engine_point, what) - theory, theory)
            )
            yield _difference(run, f"{name} {what}", units, apart, np.nanmax(size, initial=0.0))
    for force in run.forces:
        scale = np.nanmax(force.size, initial=0.0)
        yield _difference(run, f"{force.name} {force.what}", force.unit, force.apart, scale)


def _difference(run: Simulation, name: str, unit: str, apart: Floats, scale: float) -> Difference:
    """How far apart (n,) the two are in a quantity, which is up to `scale`."""
    if np.isnan(apart).all():
        return Difference(name, unit, math.nan, math.nan, math.nan, math.nan)
    worst = int(np.nanargmax(apart))
    median = float(np.nanmedian(apart))
    return Difference(name, unit, float(apart[worst]), float(run.input[worst]), median, float(scale))
