"""A prototype in Exudyn: rigid bodies and hard constraints, a differential-algebraic system of index 3."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import EngineError
from sevenbar.kinematics.rigid import perpendicular, pose
from sevenbar.simulation.engine import Record, imported
from sevenbar.simulation.exudyn_screw import ScrewConstraint
from sevenbar.simulation.prototype import GROUND, GYRATION, Body, Connection, Prototype, SpinRule
from sevenbar.text.progress import Progress

#: Numerical damping of the generalized-alpha method, which needs less than 1 for constraints on positions;
#: an error of the accelerations at the start shrinks by about this factor a step.
SPECTRAL_RADIUS = 0.6

#: Newton's iterations end where the residual falls below this, or below this part of the step's first one:
#: lengths relative to the size, times in the input's time for a radian (or a size, where it slides).
TOLERANCE, SHARE = 1e-12, 1e-10

#: A body's mass. Small against lengths of size one, so that constraints weigh most in the residual.
MASS = 1e-2

#: A bar is moved at most so often.
TICKS = 200


def run(
    model: Prototype,
    steps: int,
    step: float,
    *,
    progress: Progress | None = None,
) -> Record:
    """Moves a prototype through `steps` steps of `step` [s]; rows of the record are the start and all steps.

    Each body is Exudyn's rigid body with Euler parameters, each joint a GenericJoint with the constraints of
    its kind, the drive a constraint on one freedom with an offset that runs on with time. Where constraints
    repeat each other all are kept, and Exudyn's linear solver with full pivoting sets the repeated rows
    aside. Raises `MissingExtraError` without Exudyn and `EngineError` where its solver fails.
    """
    exu = imported("exudyn")
    # its messages come back as errors of ours
    printed, exu.config.printToConsole = exu.config.printToConsole, False
    try:
        return _run(exu, model, steps, step, progress)
    finally:
        exu.config.printToConsole = printed


def _run(exu: Any, model: Prototype, steps: int, step: float, progress: Progress | None) -> Record:
    items = imported("exudyn.itemInterface")
    container = exu.SystemContainer()
    system = container.AddSystem()
    pace = _pace(model)
    assembly = _Assembly(items, system, model, pace)
    notes = []
    for joint in model.connections:
        assembly.add_joint(joint)
        if joint.row.is_screw:
            notes.append(
                f"Exudyn has no screw: {joint.name} is a cylindrical joint, its slide tied to its turn"
            )
    assembly.add_drive()
    for rule in model.spin_rules:
        assembly.add_spin_rule(rule)
        notes.append(
            f"the idle spin of {model.bodies[rule.after].name} is held as Sevenbar's convention says"
        )
    if model.redundant:
        notes.append(
            f"{len(model.redundant)} redundant constraint{'s' * (len(model.redundant) > 1)} "
            f"({'; '.join(model.redundant)}): all joints are whole, and Exudyn's linear solver with full "
            "pivoting sets the repeated rows aside"
        )
    sensors = assembly.add_sensors(exu.OutputVariableType)
    if progress is not None:
        system.SetPreStepUserFunction(_ticking(progress, steps, step * pace))
    system.Assemble()
    try:
        solved = system.SolveDynamic(_settings(exu, model, steps, step * pace), showHints=False)
    except (RuntimeError, ValueError, exu.SolverError) as error:
        reason = str(error)
        if model.redundant:
            reason += ", perhaps as constraints repeat each other only for dimensions exact to all digits"
        raise EngineError(_failure(reason)) from None
    if not solved:
        raise EngineError(_failure("its solver stopped"))
    if progress is not None:
        progress(steps, steps)

    def stored(name: str) -> Floats:
        """The values (n, bodies, numbers) of one sensor of each body."""
        return np.stack([system.GetSensorStoredData(own[name])[:, 1:] for own in sensors], axis=1)

    time = system.GetSensorStoredData(sensors[0]["Position"])[:, 0]
    if len(time) != steps + 1:
        raise EngineError(_failure(f"it kept {len(time)} of {steps + 1} steps"))
    frames = np.tile(np.eye(4), (len(time), len(model.bodies), 1, 1))
    frames[..., :3, 3] = stored("Position") * model.size
    frames[..., :3, :3] = stored("RotationMatrix").reshape(len(time), -1, 3, 3)
    return Record(
        engine="Exudyn",
        version=str(exu.__version__),
        time=time / pace,
        frames=frames,
        velocity=stored("Velocity") * model.size * pace,
        acceleration=stored("Acceleration") * model.size * pace**2,
        spin=stored("AngularVelocity") * pace,
        spin_rate=stored("AngularAcceleration") * pace**2,
        method=f"hard constraints (index 3), generalized-alpha, spectral radius {SPECTRAL_RADIUS}",
        notes=tuple(notes),
    )


def _pace(model: Prototype) -> float:
    """How many of Exudyn's units of time make a second."""
    drive = model.drive
    return abs(drive.speed) / (1.0 if drive.turns else model.size)


def _failure(reason: str) -> str:
    return f"exudyn could not follow the motion: {reason.strip()}; give more --steps or another --circuit"


class _Assembly:
    """A prototype put together in an Exudyn system; a length of 1 is its size, a second has `pace` units."""

    def __init__(self, items: Any, system: Any, model: Prototype, pace: float) -> None:
        self.items, self.system, self.model, self.pace = items, system, model, pace
        self.ground = system.AddObject(items.ObjectGround())
        self.nodes = [self._add_node(body) for body in model.bodies]
        inertia = [MASS * GYRATION**2] * 3 + [0.0] * 3
        self.bodies = [
            system.AddObject(items.ObjectRigidBody(nodeNumber=node, mass=MASS, inertia=inertia))
            for node in self.nodes
        ]

    def _add_node(self, body: Body) -> Any:
        rigid = imported("exudyn.rigidBodyUtilities")
        parameters = rigid.RotationMatrix2EulerParameters(body.frame[:3, :3])
        rates = rigid.AngularVelocity2EulerParameters_t(body.spin / self.pace, parameters)
        place, velocity = body.frame[:3, 3] / self.model.size, body.velocity / (self.model.size * self.pace)
        return self.system.AddNode(
            self.items.NodeRigidBodyEP(
                referenceCoordinates=[*place, *parameters], initialVelocities=[*velocity, *rates]
            )
        )

    def _marker(self, body: int, frame: Floats) -> Any:
        return self.system.AddMarker(
            self.items.MarkerBodyRigid(
                bodyNumber=self.ground if body == GROUND else self.bodies[body],
                localHT=pose(frame[:3, :3], frame[:3, 3] / self.model.size),
            )
        )

    def _add_constraints(
        self,
        joint: Connection,
        held: list[int],
        offset: Callable[..., list[float]] | None = None,
        *,
        from_after: bool = False,
    ) -> None:
        markers = [
            self._marker(joint.before, joint.frame_before),
            self._marker(joint.after, joint.frame_after),
        ]
        self.system.AddObject(
            self.items.ObjectJointGeneric(
                markerNumbers=markers[::-1] if from_after else markers,
                constrainedAxes=held,
                **({} if offset is None else {"offsetUserFunction": offset}),
            )
        )

    def add_joint(self, joint: Connection) -> None:
        """Adds the constraints of a joint's kind; of a screw those of a cylinder, and one of its own."""
        self._add_constraints(joint, [int(not free) for free in joint.row.free])
        if not joint.row.is_screw:
            return
        turn = self.model.values[self.model.connections.index(joint), 5]
        screw = ScrewConstraint(joint, self.model.size, turn)
        one = np.zeros((1, 1))
        nodes = [None if body == GROUND else self.nodes[body] for body in (joint.before, joint.after)]
        self.system.AddObject(
            self.items.ObjectConnectorCoordinateVector(
                markerNumbers=[
                    self.system.AddMarker(
                        self.items.MarkerNodeCoordinates(
                            nodeNumber=self.system.AddNode(self.items.NodePointGround())
                            if node is None
                            else node
                        )
                    )
                    for node in nodes
                ],
                scalingMarker0=one,
                constraintUserFunction=screw.value,
                jacobianUserFunction=screw.slope,
            )
        )

    def add_drive(self) -> None:
        """Constrains the driven freedom alone; the joint itself has the other constraints."""
        drive = self.model.drive
        joint = self.model.connections[drive.connection]
        # Exudyn slides along axes of its first body: where the body after carries them, that one is first,
        # and the slide is the other way
        carried = joint.row.has_plane and joint.backwards and not drive.turns
        unit = (1.0 if drive.turns else self.model.size) * (-1.0 if carried else 1.0)

        def offset(_system: Any, time: float, _item: int, _parameters: Any) -> list[float]:
            values = [0.0] * 6
            values[drive.freedom] = drive.at(time / self.pace) / unit
            return values

        held = [int(row == drive.freedom) for row in range(6)]
        self._add_constraints(joint, held, offset, from_after=carried)

    def add_spin_rule(self, rule: SpinRule) -> None:
        # of a turn about z alone held, x of the first frame and y of the second stay at right angles
        self.system.AddObject(
            self.items.ObjectJointGeneric(
                markerNumbers=[
                    self._marker(rule.before, pose(_axes_with(rule.axis_before, 0))),
                    self._marker(rule.after, pose(_axes_with(rule.axis_after, 1))),
                ],
                constrainedAxes=[0, 0, 0, 0, 0, 1],
            )
        )

    def add_sensors(self, kinds: Any) -> list[dict[str, Any]]:
        names = (
            "Position",
            "RotationMatrix",
            "Velocity",
            "Acceleration",
            "AngularVelocity",
            "AngularAcceleration",
        )
        return [
            {
                name: self.system.AddSensor(
                    self.items.SensorBody(
                        bodyNumber=body,
                        storeInternal=True,
                        writeToFile=False,
                        outputVariableType=getattr(kinds, name),
                    )
                )
                for name in names
            }
            for body in self.bodies
        ]


def _axes_with(axis: Floats, place: int) -> Floats:
    """A rotation matrix with this unit vector as its column `place`."""
    second = perpendicular(axis)
    columns = [axis, second, np.cross(axis, second)]
    return np.column_stack(columns[-place:] + columns[:-place])


def _settings(exu: Any, model: Prototype, steps: int, step: float) -> Any:
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = steps * step
    settings.timeIntegration.verboseMode = 0
    # every step is one of the motion's rows, so none may be cut
    settings.timeIntegration.adaptiveStep = False
    settings.timeIntegration.newton.useModifiedNewton = False
    settings.timeIntegration.newton.relativeTolerance = SHARE
    settings.timeIntegration.newton.absoluteTolerance = TOLERANCE
    settings.timeIntegration.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    if model.redundant:
        settings.linearSolver.solverType = exu.LinearSolverType.EigenDense
        settings.linearSolver.ignoreSingularJacobian = True
    else:
        settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    settings.solution.file.write = False
    # half a step: each step is kept, whatever its rounding
    settings.solution.sensors.writePeriod = 0.5 * step
    return settings


def _ticking(progress: Progress, steps: int, step: float) -> Callable[[Any, float], bool]:
    every = max(1, steps // TICKS)

    def tick(_system: Any, time: float) -> bool:
        done = round(time / step)
        if done % every == 0:
            progress(done, steps)
        return True

    return tick
