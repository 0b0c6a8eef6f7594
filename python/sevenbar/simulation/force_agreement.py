"""Torque and reactions as an engine and Sevenbar have them, as far as equilibrium determines them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.result import Forces
from sevenbar.simulation.course import Course
from sevenbar.simulation.engine import Record
from sevenbar.simulation.prototype import Prototype


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
    found = [drive]
    for joint, seat in zip(linkage.joints, model.seats, strict=True):
        row = model.connections[seat].row
        if not row.is_screw:
            found += _reaction(forces, joint.name, rows, row.free, record.reactions[first:, seat])
    return tuple(found)


def _reaction(
    forces: Forces, name: str, rows: np.ndarray, free: Sequence[bool], engine: Floats
) -> list[ComparedForce]:
    """The force and the moment in a joint, where any of their components is determinate."""
    reaction = forces.reactions[name]
    slides, turns = np.array(free[:3]), np.array(free[3:])
    found = []
    for what, unit, own, held, part in (
        ("force", "N", reaction.force, reaction.determinate[3:] & ~slides, engine[:, :3]),
        ("moment", "N m", reaction.moment, reaction.determinate[:3] & ~turns, engine[:, 3:]),
    ):
        if held.any():
            along = np.einsum("nji,nj->ni", reaction.axes[rows], part)
            axes = tuple(axis for axis, here in zip("xyz", held, strict=True) if here)
            found.append(ComparedForce(name, what, unit, axes, along[:, held], own[rows][:, held]))
    return found
