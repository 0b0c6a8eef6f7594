"""Loads put on a prototype in MuJoCo step by step, and what its drive and its joints bear."""

from __future__ import annotations

from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.simulation.engine import imported
from sevenbar.simulation.mjcf import cut
from sevenbar.simulation.mjcf_acting import MASSLESS
from sevenbar.simulation.prototype import GROUND, Prototype
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
        """Reads a row, after `mj_forward`."""
        if self.drive is None:
            return
        self.drive[row] = -self._own.dof_armature[self._wheel] * data.qacc[self._wheel]
        if self.reactions is None:
            return
        self._engine.mj_rnePostConstraint(self._own, data)
        for number in range(len(self._model.connections)):
            self.reactions[row, number] = self._borne(data, number)

    def _borne(self, data: Any, number: int) -> Floats:
        """What a connection puts on the body after it: force and moment about the place of the one before."""
        joint, where = self._model.connections[number], self._cut
        if number == where.connection and not where.weld:
            kind = self._engine.mjtConstraint.mjCNSTR_EQUALITY
            rows = (data.efc_type == kind) & (data.efc_id == self._own.equality("loop").id)
            return np.concatenate([-data.efc_force[rows], np.zeros(3)])
        backwards = number > where.connection
        child = joint.before if backwards else joint.after
        # past the last joint a bare body is welded to the ground, which bears its weight
        body = self._own.body("loop_end_body").id if child == GROUND else self._bodies[child]
        way = -1.0 if backwards else 1.0
        moment, force = way * data.cfrc_int[body].reshape(2, 3)
        place = joint.frame_before[:3, 3] * self._metre
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
