"""A prototype in Exudyn: rigid bodies and hard constraints, a differential-algebraic system of index 3."""

from __future__ import annotations

from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import EngineError
from sevenbar.export.prototype import Prototype
from sevenbar.simulation.engine import Record, imported, tell
from sevenbar.simulation.exudyn_assembly import ExudynAssembly, pace_of
from sevenbar.simulation.exudyn_forces import add_acting, constraint_forces, constraint_sensors
from sevenbar.text.progress import Progress

#: Numerical damping of the generalized-alpha method, which needs less than 1 for constraints on positions;
#: an error of the accelerations at the start shrinks by about this factor a step.
SPECTRAL_RADIUS = 0.6

#: Newton's iterations end where the residual falls below this, or below this part of the step's first one:
#: lengths relative to the size, times in the input's time for a radian (or a size, where it slides).
TOLERANCE, SHARE = 1e-12, 1e-10


def run(model: Prototype, steps: int, step: float, *, progress: Progress | None = None) -> Record:
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
    container = exu.SystemContainer()
    system = container.AddSystem()
    pace = pace_of(model)
    assembly = ExudynAssembly(exu, system, model, pace)
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
            f"{model.redundant_text}: all joints are whole, and Exudyn's linear solver with full pivoting "
            "sets the repeated rows aside"
        )
    add_acting(assembly)
    sensors = assembly.add_motion_sensors()
    constraints = constraint_sensors(assembly)
    if progress is not None:

        def tick(_system: Any, time: float) -> bool:
            tell(progress, round(time / (step * pace)), steps)
            return True

        system.SetPreStepUserFunction(tick)
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
    tell(progress, steps, steps)

    def stored(name: str) -> Floats:
        """The values (n, bodies, numbers) of one sensor of each body."""
        return np.stack([system.GetSensorStoredData(own[name])[:, 1:] for own in sensors], axis=1)

    time = system.GetSensorStoredData(sensors[0]["Position"])[:, 0]
    if len(time) != steps + 1:
        raise EngineError(_failure(f"it kept {len(time)} of {steps + 1} steps"))
    frames = np.tile(np.eye(4), (len(time), len(model.bodies), 1, 1))
    frames[..., :3, 3] = stored("Position") * model.size
    frames[..., :3, :3] = stored("RotationMatrix").reshape(len(time), -1, 3, 3)
    forces = constraint_forces(assembly, constraints, frames)
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
        drive=None if forces is None else forces.drive,
        reactions=None if forces is None else forces.reactions,
    )


def _failure(reason: str) -> str:
    return f"exudyn could not follow the motion: {reason.strip()}; give more --steps or another --circuit"


def _settings(exu: Any, model: Prototype, steps: int, step: float) -> Any:
    settings = exu.SimulationSettings()
    time, solver = settings.timeIntegration, settings.linearSolver
    time.numberOfSteps, time.endTime, time.verboseMode = steps, steps * step, 0
    # every step is one of the motion's rows, so none may be cut
    time.adaptiveStep = False
    time.newton.useModifiedNewton = False
    time.newton.relativeTolerance, time.newton.absoluteTolerance = SHARE, TOLERANCE
    time.generalizedAlpha.spectralRadius = SPECTRAL_RADIUS
    solver.solverType = exu.LinearSolverType.EigenDense if model.redundant else exu.LinearSolverType.EXUdense
    solver.ignoreSingularJacobian = bool(model.redundant)
    settings.solution.file.write = False
    # half a step: each step is kept, whatever its rounding
    settings.solution.sensors.writePeriod = 0.5 * step
    return settings
