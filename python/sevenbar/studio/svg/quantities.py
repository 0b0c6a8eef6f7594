"""What the studio's curves can show: output, joints, points, transmission angle; forces where some act."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import shown_value, slides
from sevenbar.forces.result import Forces, Reaction
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import along
from sevenbar.kinematics.transmission.angle import coupling_of
from sevenbar.studio.state.acting import SwitchedLoading
from sevenbar.studio.state.view import View
from sevenbar.text.units import LENGTHS

#: What a column has, by the order of its derivative, as the figures call them.
ORDERS = ("angle", "velocity", "acceleration")

#: The same of a point, whose place has no single number.
SIZES = {1: "speed", 2: "acceleration"}


#: What the output's quantities have at the end of their names in the menu.
OF_OUTPUT = " (output)"

#: The key of the transmission angle.
TRANSMISSION = "transmission"


@dataclass(frozen=True)
class Quantity:
    """One thing that a curve shows, by the `order` of its derivative: of a column or of a named point.

    `key` stays the same from one motion of a linkage to the next; `name` and `unit` are what people read;
    one of `column` and `point` is set, their places in the linkage's `columns` and `points`, or none for the
    transmission angle.
    """

    key: str
    name: str
    unit: str
    order: int
    column: int | None = None
    point: int | None = None

    @property
    def heading(self) -> str:
        """Its name above a curve, where there is little room."""
        return self.name.removesuffix(OF_OUTPUT)

    @property
    def kind(self) -> str:
        """The word of its order: "angle" (or place), "velocity", "acceleration"."""
        return ORDERS[self.order]

    def values(self, view: View) -> Floats:
        """The values along the walk of a view's circuit, in `unit`, (n,); NaN where a row has none.

        Angles start within (-180, 180] and run on; where a rocking input goes back, velocities turn their
        sign. Of a point's velocity and acceleration the size is given.
        """
        circuit, path = view.circuit, view.path
        if self.key == TRANSMISSION:
            angle = circuit.transmission_angle
            return np.full(len(path.rows), np.nan) if angle is None else np.degrees(angle[path.rows])
        if self.column is None:
            trace = view.traces[self.point or 0]
            vectors = trace.velocity if self.order == 1 else trace.acceleration
            sizes: Floats = np.linalg.norm(vectors, axis=1)[path.rows]
            return sizes
        if self.order == 0:
            values = along(view.linkage, circuit, self.column)
            shown: Floats = shown_value(view.motion, circuit.columns[self.column], values)
            return shown + self.shift(view)
        if self.order == 1:
            return path.velocities(circuit.dq[:, self.column])
        accelerations: Floats = circuit.ddq[path.rows, self.column]
        return accelerations

    @property
    def is_size(self) -> bool:
        """Whether it is a size, drawn from zero up."""
        return self.point is not None

    def absence(self, view: View) -> str:
        """What is shown in place of a curve that has no value."""
        return f"no value along circuit {view.circuit.index}"

    def shift(self, view: View) -> float:
        """The whole turns [deg] that bring the angle's first value into (-180, 180]; 0 for all else."""
        return 0.0 if self.column is None or self.order else math.degrees(view.whole_turns(self.column))

    def natural(self, view: View) -> float:
        """The size of a value that a designer would call neither small nor large, in `unit`."""
        motion, size = view.motion, view.circuit.size
        turn = self.column is not None and motion.linkage.turns(self.column)
        if self.order == 0:
            return 90.0 if turn or self.key == TRANSMISSION else size
        rate = abs(motion.speed) if motion.law is None else float(np.abs(motion.law.dq).max())
        if slides(motion, motion.input):
            rate /= size
        natural = (1.0 if turn else size) * rate * (rate if self.order == 2 else 1.0)
        return natural if math.isfinite(natural) else 0.0


def quantities(motion: Motion) -> tuple[Quantity, ...]:
    """All that can be drawn, in the order of a menu: output, every column but the input, named points."""
    linkage = motion.linkage
    found: list[Quantity] = []
    names: set[str] = set()

    def add(
        key: str, name: str, unit: str, order: int, *, column: int | None = None, point: int | None = None
    ) -> None:
        name = _free(name, names, "joint" if point is None else "point")
        found.append(Quantity(key, name, unit, order, column, point))

    def add_column(key: str, name: str, column: int, role: str = "") -> None:
        own = linkage.each_column[column]
        slide, unit = not own.turns, own.unit
        units = (own.shown[0], f"{unit}/s", f"{unit}/s²")
        for order, (word, unit) in enumerate(zip(ORDERS, units, strict=True)):
            shown = "position" if slide and order == 0 else word
            add(f"{key}.{word}", f"{name} {shown}{role}", unit, order, column=column)

    ends = linkage.columns.index(motion.input), linkage.columns.index(motion.output)
    add_column("output", motion.output, ends[1], OF_OUTPUT)
    # its values are for those who draw it
    if motion.circuits and coupling_of(linkage, *ends) is not None:
        add(TRANSMISSION, "transmission angle", "deg", 0)
    for column, name in enumerate(linkage.columns):
        if column not in ends:
            add_column(f"column.{name}", name, column)
    for place, point in enumerate(linkage.points):
        for order, word in SIZES.items():
            unit = linkage.length_unit + ("/s" if order == 1 else "/s²")
            add(f"point.{point.name}.{word}", f"{point.name} {word}", unit, order, point=place)
    return tuple(found)


#: What every joint has, and one with an axis: words of the name, and components of the force in its frame.
PARTS = {"force": (0, 1, 2), "radial force": (0, 1)}

#: The greatest force is that of all rows but this share [%], those nearest to dead centres.
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


def force_quantities(
    view: View, acting: SwitchedLoading, taken: Collection[str]
) -> tuple[ForceQuantity, ...]:
    """All of forces that can be drawn, in the order of a menu, with names that are not `taken`.

    None where nothing acts. Nothing is computed.
    """
    if acting.is_empty:
        return ()
    found: list[ForceQuantity] = []
    names = set(taken)

    def add(key: str, name: str, unit: str, joint: str = "") -> None:
        name = _free(name, names, "joint")
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


def _free(name: str, taken: set[str], sort: str) -> str:
    """A name that no other has, now taken; names come from files: a joint may be called "output"."""
    while name in taken:
        name += f" ({sort})"
    taken.add(name)
    return name


def _size(vectors: Floats) -> Floats:
    sizes: Floats = np.linalg.norm(vectors, axis=1)
    return sizes


def _greatest(reaction: Reaction) -> Floats:
    """The greatest component of a force on each row that has one."""
    sizes = np.abs(reaction.force[:, reaction.determinate[3:]]).max(axis=1, initial=-math.inf)
    return np.asarray(sizes[np.isfinite(sizes)])
