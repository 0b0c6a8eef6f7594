"""A prototype in MuJoCo: joints of a tree in their own coordinates, the loop closed by soft constraints."""

from __future__ import annotations

import numpy as np

from sevenbar.errors import EngineError
from sevenbar.simulation.engine import Record, imported, tell
from sevenbar.simulation.mjcf import IMPEDANCE, TIME_CONSTANT, cut, mjcf
from sevenbar.simulation.mujoco_forces import MujocoForces, acting_notes
from sevenbar.simulation.prototype import Prototype
from sevenbar.text.progress import Progress
from sevenbar.text.units import LENGTHS

#: Linkages below this size [m] have forces and inertias that MuJoCo takes for none.
SMALLEST = 1e-4


def run(model: Prototype, steps: int, step: float, *, progress: Progress | None = None) -> Record:
    """Moves a prototype through `steps` steps of `step` [s]; rows of the record are the start and all steps.

    The model is `mjcf(model)`, started at its key frame. Raises `MissingExtraError` without MuJoCo and
    `EngineError` where the motion is lost.
    """
    mujoco = imported("mujoco")
    metre = LENGTHS[model.length_unit]
    if model.size * metre < SMALLEST:
        raise EngineError(
            f"mujoco cannot move a linkage of {model.size * metre:.1e} m: it reckons in metres, and needs "
            f"{SMALLEST:g} m; give another length_unit, or --engine exudyn"
        )
    try:
        own = mujoco.MjModel.from_xml_string(mjcf(model, time_step=step))
    except ValueError as error:
        raise EngineError(f"mujoco does not take the model: {error}") from None
    data = mujoco.MjData(own)
    mujoco.mj_resetDataKeyframe(own, data, 0)
    bodies = [own.body(body.name).id for body in model.bodies]
    rows, count = steps + 1, len(bodies)
    frames = np.tile(np.eye(4), (rows, count, 1, 1))
    rates = np.zeros((2, 2, rows, count, 3))
    six = np.zeros(6)
    kind = mujoco.mjtObj.mjOBJ_XBODY
    forces = MujocoForces(model, own, rows)
    for row in range(rows):
        mujoco.mj_kinematics(own, data)
        forces.load(data)
        mujoco.mj_forward(own, data)
        mujoco.mj_rnePostConstraint(own, data)
        frames[row, :, :3, 3] = data.xpos[bodies] / metre
        frames[row, :, :3, :3] = data.xmat[bodies].reshape(count, 3, 3)
        for place, body in enumerate(bodies):
            mujoco.mj_objectVelocity(own, data, kind, body, six, 0)
            rates[:, 0, row, place] = six[3:], six[:3]
            # MuJoCo's accelerations are those that an instrument would show, with weight
            mujoco.mj_objectAcceleration(own, data, kind, body, six, 0)
            rates[:, 1, row, place] = six[3:] + own.opt.gravity, six[:3]
        forces.read(data, row)
        if not np.isfinite(data.qacc).all() or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            raise EngineError(
                f"mujoco could not follow the motion: it became unstable at step {row} of {steps}; "
                "give more --steps or another --circuit"
            )
        if row < steps:
            mujoco.mj_step(own, data)
        tell(progress, row, steps)
    return Record(
        engine="MuJoCo",
        version=str(mujoco.__version__),
        time=np.arange(rows, dtype=np.float64) * step,
        frames=frames,
        velocity=rates[0, 0] / metre,
        acceleration=rates[0, 1] / metre,
        spin=rates[1, 0],
        spin_rate=rates[1, 1],
        method="soft constraints in joint coordinates, semi-implicit Euler steps of first order",
        notes=_notes(model, step),
        drive=forces.drive,
        reactions=forces.reactions,
    )


def _notes(model: Prototype, step: float) -> tuple[str, ...]:
    where = cut(model)
    joint = model.connections[where.connection]
    how = "a weld beyond" if where.weld else "holding together both sides of"
    notes = [
        f"the loop is closed by {how} joint {joint.name}; it is soft, impedance {IMPEDANCE}, time constant "
        f"{TIME_CONSTANT:g} steps: the closure error, and with it that of every angle, falls with the square "
        "of the step",
        f"a step of first order puts velocities off by about half a step ({step / 2:.3g} s) of acceleration",
    ]
    notes += [
        f"the idle spin of {model.bodies[rule.after].name} is held as Sevenbar's convention says, by two "
        "hinges for a ball"
        for rule in model.spin_rules
    ]
    notes += acting_notes(model)
    if model.redundant:
        notes.append(f"{model.redundant_text}: soft constraints need not be independent, so all are kept")
    return tuple(notes)
