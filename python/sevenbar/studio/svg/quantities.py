"""What the studio's curves can show: the output, the transmission angle, every joint, the points' speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import shown_value, slides
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import along
from sevenbar.kinematics.transmission import coupling_of
from sevenbar.studio.state.view import View

#: What a column has, by the order of its derivative, as the figures call them.
ORDERS = ("angle", "velocity", "acceleration")

#: The same of a point, whose place has no single number.
SIZES = {1: "speed", 2: "acceleration"}


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
        if self.column is None or self.order or not view.linkage.turns(self.column):
            return 0.0
        angles = np.degrees(view.circuit.q[:, self.column])
        known = angles[np.isfinite(angles)]
        # a start at half a turn up to rounding stays at +180
        return -360.0 * math.ceil((float(known[0]) - 180.0 - 1e-6) / 360.0) if known.size else 0.0

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
        # names come from files: a joint may be called "output"
        while name in names:
            name += " (joint)" if point is None else " (point)"
        names.add(name)
        found.append(Quantity(key, name, unit, order, column, point))

    def add_column(key: str, name: str, column: int) -> None:
        slide = not linkage.turns(column)
        length = linkage.length_unit
        units = (length, f"{length}/s", f"{length}/s²") if slide else ("deg", "rad/s", "rad/s²")
        for order, (word, unit) in enumerate(zip(ORDERS, units, strict=True)):
            shown = "position" if slide and order == 0 else word
            add(f"{key}.{word}", f"{name} {shown}", unit, order, column=column)

    ends = linkage.columns.index(motion.input), linkage.columns.index(motion.output)
    add_column("output", "output", ends[1])
    # its values are for those who draw it
    if motion.circuits and coupling_of(linkage, *ends) is not None:
        add(TRANSMISSION, "transmission angle", "deg", 0)
    for column, name in enumerate(linkage.columns):
        if name != motion.input:
            add_column(f"column.{name}", name, column)
    for place, point in enumerate(linkage.points):
        for order, word in SIZES.items():
            unit = linkage.length_unit + ("/s" if order == 1 else "/s²")
            add(f"point.{point.name}.{word}", f"{point.name} {word}", unit, order, point=place)
    return tuple(found)
