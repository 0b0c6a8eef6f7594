"""What the studio's curves can show of forces: torque and power of the input, shaking, what joints bear."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import slides
from sevenbar.forces.result import Forces, Reaction
from sevenbar.studio.state.acting import SwitchedLoading
from sevenbar.studio.state.view import View
from sevenbar.studio.svg.quantities import Quantity
from sevenbar.text.units import LENGTHS

#: What every joint has, and one with an axis: words of the name, and components of the force in its frame.
PARTS = {"force": (0, 1, 2), "radial force": (0, 1)}

#: The greatest force is sought among all rows but this share [%], those nearest to dead centres.
ENDLESS = 5.0


@dataclass(frozen=True)
class ForceQuantity(Quantity):
    """Something of the forces that `acting` gives, by its `key`; of a `joint` the size of some of its force.

    It counts as of the second order: like accelerations, forces grow without bound at dead centres.
    """

    acting: SwitchedLoading | None = None
    joint: str = ""

    @property
    def is_size(self) -> bool:
        """Whether it is a size, drawn from zero up."""
        return bool(self.joint) or self.key == "forces.shaking"

    def values(self, view: View) -> Floats:
        """The values along the walk of a view's circuit, in `unit`, (n,); NaN where a row has none.

        The power is that of the motion as it is seen: turned where the input goes back.
        """
        path, forces = view.path, self._forces(view)
        if forces is None:
            return np.full(len(path.rows), np.nan)
        if self.key == "forces.power":
            return path.velocities(forces.power)
        if self.joint:
            own = forces.reactions[self.joint]
            return _size(own.force[:, self._part])[path.rows]
        values = _size(forces.shaking[:, 3:]) if self.key == "forces.shaking" else forces.torque
        return np.asarray(values[path.rows])

    def natural(self, view: View) -> float:
        """The size of a value that a designer would call neither small nor large, in `unit`."""
        forces = self._forces(view)
        if forces is None:
            return 0.0
        sizes = np.concatenate([_greatest(reaction) for reaction in forces.reactions.values()])
        force = float(np.percentile(sizes, 100 - ENDLESS)) if sizes.size else 0.0
        arm = 1.0 if forces.slides else view.circuit.size * LENGTHS[forces.length_unit]
        if self.unit == "W":
            speed = float(np.abs(forces.speed).max())
            return force * arm * speed * (LENGTHS[forces.length_unit] if forces.slides else 1.0)
        return force * (arm if self.unit == "N m" else 1.0)

    def absence(self, view: View) -> str:
        """What is shown in place of a curve that has no value."""
        forces = self._forces(view)
        if forces is None:
            return self.acting.reason(view) if self.acting else ""
        if self.joint and not forces.reactions[self.joint].determinate[3:][self._part].all():
            return "not determined: constraints are redundant"
        return super().absence(view)

    @property
    def _part(self) -> list[int]:
        return list(PARTS[self.key.rpartition(".")[2]])

    def _forces(self, view: View) -> Forces | None:
        return None if self.acting is None else self.acting.forces(view)


def force_quantities(view: View, acting: SwitchedLoading, taken: Collection[str]) -> tuple[ForceQuantity, ...]:
    """All of forces that can be drawn, in the order of a menu, with names that are not `taken`.

    None where nothing acts. Nothing is computed.
    """
    if acting.is_empty:
        return ()
    found: list[ForceQuantity] = []
    names = set(taken)

    def add(key: str, name: str, unit: str, joint: str = "") -> None:
        # names come from files: a joint may be called "shaking"
        while name in names:
            name += " (joint)"
        names.add(name)
        found.append(ForceQuantity(f"forces.{key}", name, unit, 2, acting=acting, joint=joint))

    slide = slides(view.motion, view.motion.input)
    add("torque", "input force" if slide else "input torque", "N" if slide else "N m")
    add("power", "power", "W")
    if any(acting.linkage.loading.bodies.values()):
        add("shaking", "shaking force", "N")
    for joint in view.linkage.joints:
        add(f"{joint.name}.force", f"{joint.name} force", "N", joint.name)
        # a ball has no axis
        if joint.kind != "S":
            add(f"{joint.name}.radial force", f"{joint.name} radial force", "N", joint.name)
    return tuple(found)


def _size(vectors: Floats) -> Floats:
    sizes: Floats = np.linalg.norm(vectors, axis=1)
    return sizes


def _greatest(reaction: Reaction) -> Floats:
    """The greatest component of a force on each row that has one."""
    sizes = np.abs(reaction.force[:, reaction.determinate[3:]]).max(axis=1, initial=-math.inf)
    return np.asarray(sizes[np.isfinite(sizes)])
