"""A prototype in MuJoCo: joints of a tree in their own coordinates, the loop closed by soft constraints.

Loads are put on step by step; what drive and joints bear is read as it runs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import EngineError
from sevenbar.export.mjcf import IMPEDANCE, TIME_CONSTANT, cut, mjcf
from sevenbar.export.mjcf_acting import MASSLESS
from sevenbar.export.prototype import GROUND, Prototype
from sevenbar.simulation.engine import Record, imported, tell
from sevenbar.text.progress import Progress
from sevenbar.text.units import LENGTHS

#: A body pulled by a tendon, and by nothing else.
TENDON = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <site name="here"/>
    <body pos="1 0 0">
      <joint type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <site name="there"/>
    </body>
  </worldbody>
  <tendon>
    <spatial stiffness="1" springlength="0.5"><site site="here"/><site site="there"/></spatial>
  </tendon>
</mujoco>
"""

#: Linkages below this size [m] have forces and inertias that MuJoCo takes for none.
SMALLEST = 1e-4


class MujocoForces:
    """Loads put on one run, and what is read row by row; nothing where nothing acts.

    `drive` (rows,) is what the flywheel gives as it loses speed, `reactions` (rows, connections, 6) what
    passes from body to body, both as in a `Record`; no reactions where MuJoCo does not count springs.
    """

    def __init__(self, model: Prototype, own: Any, rows: int) -> None:
        self._model, self._own, self._engine = model, own, imported("mujoco")
        self._metre = LENGTHS[model.length_unit]
        self._bodies = [own.body(body.name).id for body in model.bodies]
        (self._wheel,) = np.flatnonzero(own.dof_armature)
        self._cut = cut(model)
        self.drive: Floats | None = None
        self.reactions: Floats | None = None
        if model.acting is None:
            return
        self.drive = np.zeros(rows)
        if not model.acting.springs or _counts_tendons(self._engine):
            self.reactions = np.zeros((rows, len(model.connections), 6))

    def load(self, data: Any) -> None:
        """Puts the loads on, as large as they are at the drive's value."""
        acting = self._model.acting
        if acting is None:
            return
        data.xfrc_applied[:] = 0.0
        value = self._model.drive.at(data.time)
        for load in acting.loads:
            number, at = load.place
            if number == GROUND:
                continue
            body, factor = self._bodies[number], load.factor(value)
            turn = data.xmat[body].reshape(3, 3)
            force, torque = (turn @ v if load.turns else v for v in (load.force, load.torque))
            place = data.xpos[body] + turn @ at * self._metre
            # MuJoCo applies them at the centre of mass
            moment = torque + np.cross(place - data.xipos[body], force)
            data.xfrc_applied[body] += factor * np.concatenate([force, moment])

    def read(self, data: Any, row: int) -> None:
        """Reads a row, after `mj_rnePostConstraint`."""
        if self.drive is None:
            return
        self.drive[row] = -self._own.dof_armature[self._wheel] * data.qacc[self._wheel]
        if self.reactions is None:
            return
        for number in range(len(self._model.connections)):
            self.reactions[row, number] = self._borne(data, number)

    def _borne(self, data: Any, number: int) -> Floats:
        """What a connection puts on the body after it: force and moment about the place of the one before."""
        joint, where = self._model.connections[number], self._cut
        if number == where.connection and not where.weld:
            kind = self._engine.mjtConstraint.mjCNSTR_EQUALITY
            rows = (data.efc_type == kind) & (data.efc_id == self._own.equality("loop").id)
            return np.concatenate([-data.efc_force[rows], np.zeros(3)])
        above = 0 if joint.after == GROUND else self._bodies[joint.after]
        closes = number == where.connection or joint.before == GROUND
        backwards = not closes and self._own.body_parentid[self._bodies[joint.before]] == above
        child = joint.before if backwards else joint.after
        # past the last joint a bare body is welded to the ground, which bears its weight
        body = self._own.body("loop_end_body").id if child == GROUND else self._bodies[child]
        way = -1.0 if backwards else 1.0
        moment, force = way * data.cfrc_int[body].reshape(2, 3)
        place = joint.drawn_before[:3, 3] * self._metre
        if joint.before != GROUND:
            above = self._bodies[joint.before]
            place = data.xpos[above] + data.xmat[above].reshape(3, 3) @ place
        # MuJoCo's moments are about the centre of mass of the whole tree
        arm = data.subtree_com[self._own.body_rootid[body]] - place
        return np.concatenate([force, moment + np.cross(arm, force)])


def _counts_tendons(engine: Any) -> bool:
    """Whether this MuJoCo counts the pull of tendons among the forces between bodies; older ones do not."""
    own = engine.MjModel.from_xml_string(TENDON)
    data = engine.MjData(own)
    engine.mj_forward(own, data)
    engine.mj_rnePostConstraint(own, data)
    return bool(data.cfrc_ext.any())


def acting_notes(model: Prototype) -> list[str]:
    """What is to be known of the forces of a run, in words."""
    if model.acting is None:
        return []
    notes = [
        "the drive's torque is what its flywheel gives as it loses speed; forces are as soft as the loop and "
        "come closer with smaller steps"
    ]
    bare = [body.name for number, body in enumerate(model.bodies) if number not in model.acting.masses]
    if bare:
        notes.append(
            f"MuJoCo takes no moving body without mass: {', '.join(bare)} weigh{'s' * (len(bare) == 1)} "
            f"{MASSLESS:g} of the heaviest"
        )
    return notes


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
