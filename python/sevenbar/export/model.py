"""MJCF: the linkage as MuJoCo opens and runs it, the loop closed by equality constraints."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from sevenbar.errors import RequestError
from sevenbar.export.mjcf import Drive, mjcf
from sevenbar.export.parts import Assembly
from sevenbar.export.prototype import prototype
from sevenbar.kinematics.loop.law import Law
from sevenbar.text.progress import Progress, silent


def write_mjcf(
    assembly: Assembly, path: Path, _progress: Progress = silent, drive: Drive = "velocity"
) -> None:
    """The bodies as rods with masses, in the pose, with the velocities of its motion, driven by an actuator.

    Raises `RequestError` at a dead centre of the input, where velocities have no bound.
    """
    pose, motion = assembly.pose, assembly.pose.motion
    linkage = pose.linkage
    speed = linkage.drive.speed if math.isnan(motion.speed) else motion.speed
    # rows of just this input, one for each pass of the circuit
    law = Law.of([0.0], [pose.input], [speed], [0.0])
    circuit = linkage.circuit(pose.q, input=motion.input, output=motion.output, law=law, agree=motion.agree)
    usable = np.flatnonzero(circuit.status == "ok")
    if not usable.size:
        raise RequestError(
            "at: the pose is a dead centre of the input, where joints move at no bounded speed; give another"
        )
    apart = np.abs(np.exp(1j * circuit.q[usable]) - np.exp(1j * pose.q)).max(axis=1)
    model = prototype(linkage, circuit, int(usable[apart.argmin()]), speed)
    if model.drive.turns and not model.connections[model.drive.connection].advance:
        # counted in the turn of the given input: a position is given in it
        model.values[model.drive.connection, model.drive.freedom] = pose.input
    path.write_text(mjcf(model, drive=drive), encoding="utf-8")
