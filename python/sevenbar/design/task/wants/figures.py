"""Measures of a circuit as wants and musts: values at any numbers, exact slopes where those exist."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.loop import SAMPLES, TaskLoop
from sevenbar.design.task.task import FigureWant
from sevenbar.design.task.transmitting import LeastAngle
from sevenbar.errors import DescriptionError, NotCoveredError, RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.measures import circuit_gradient, circuit_mass_gradient, measures_named

#: Step of the differences that stand in for slopes where a measure has none of its own [of a unit].
STEP = 1e-5

#: A circuit is the same where its nearest row has no joint further off [rad, or relative to the size].
SAME_CIRCUIT = 0.5


class Figures:
    """The measures, by name, of the circuit near a pose."""

    def __init__(self, loop: TaskLoop, names: Sequence[str]) -> None:
        self._loop = loop
        self.names = tuple(names)
        #: Motions that were measured, with slopes two.
        self.motions = 0
        self._measures = measures_named(names) if names else ()
        self._angle = LeastAngle(loop) if self.names == ("transmission_lowest",) else None
        #: Whether a value takes a motion that is measured, and counts.
        self.measured = bool(self.names) and not (self._angle and self._angle.known)
        #: Whether they are all of one circuit, which the general way follows.
        self._alone = loop.linkage.form != "rssr" and all(one.per == "circuit" for one in self._measures)
        self._columns = [c for c, ball in enumerate(loop.numbers.is_ball) if not ball]

    def at(self, values: Floats, anchor: Floats, *, slopes: bool = True) -> tuple[Floats, Floats] | None:
        """Values (f,) and slopes (f, k) at numbers (k,), of the circuit near a row (columns,) of an analysis.

        `None` where the circuit is gone or one of the measures has no value.
        """
        quick = None if self._angle is None else self._angle.at(values, anchor, slopes=slopes)
        if quick is not None:
            return quick
        self.motions += 1 + slopes
        found = self._near(values, anchor)
        if found is None:
            return None
        linkage, circuit, motion = found
        read = list(self.read(motion, circuit).values())
        if not np.isfinite(read).all():
            return None
        by = np.zeros((len(read), len(values)))
        if slopes:
            known = circuit_gradient(linkage, circuit, only=self.names)
            own = {name: self._loop.all_slopes(values, one.slopes) for name, one in known.items()}
            if self._loop.free_masses:
                for name, one in circuit_mass_gradient(linkage, circuit, only=self.names).items():
                    own[name] = own[name] + self._loop.mass_slopes(one.slopes)
            rest = [i for i, name in enumerate(self.names) if not np.isfinite(own.get(name, np.nan)).all()]
            by = np.array([np.zeros(len(values)) if i in rest else own[n] for i, n in enumerate(self.names)])
            if rest:
                by[rest] = self._differences(values, anchor)[rest]
        return np.array(read), by

    def _differences(self, values: Floats, anchor: Floats) -> Floats:
        columns = []
        for k, scale in enumerate(self._loop.scales):
            step = np.zeros(len(values))
            step[k] = STEP * scale
            up, down = (self.at(values + way * step, anchor, slopes=False) for way in (1, -1))
            none = np.zeros(len(self.names))
            columns.append(none if up is None or down is None else (up[0] - down[0]) / (2 * step[k]))
        return np.stack(columns, axis=1)

    def _near(self, values: Floats, anchor: Floats) -> tuple[Solvable, Circuit, Motion | None] | None:
        """The linkage at numbers (k,), its circuit near a row (columns,), and the motion where that is asked.

        The circuit through the pose that closes at the row's input, without a search for the others.
        """
        loop = self._loop
        q = loop.near(values, anchor) if self._alone else None
        if q is not None:
            try:
                linkage = loop.drawn(values).linkage
                return linkage, linkage.circuit(q[0], SAMPLES), None
            except (DescriptionError, RequestError, NotCoveredError):
                # where it stands still others may be near
                pass
        found = self.circuit(values, anchor)
        return None if found is None else (found[0].linkage, found[1], found[0])

    def read(self, motion: Motion | None, circuit: Circuit) -> dict[str, float]:
        """The measures of a circuit; NaN where one has no value."""
        found = {}
        for measure in self._measures:
            value = measure.value(motion if motion and measure.per == "linkage" else circuit)
            found[measure.name] = float(value) if isinstance(value, (int, float)) else np.nan
        return found

    def circuit(self, values: Floats, anchor: Floats) -> tuple[Motion, Circuit] | None:
        """The motion at numbers (k,), and its circuit near a row (columns,); `None` where there is none."""
        motion = self._loop.motion(values)
        if motion is None:
            return None
        best, least = None, SAME_CIRCUIT
        turning = self._loop.numbers.turns[self._columns]
        for circuit in motion.circuits:
            off = circuit.q[:, self._columns] - anchor[self._columns]
            off = np.where(turning, short_way(off), off) / self._loop.units[self._columns]
            far = np.abs(off).max(axis=1)
            far = float(np.nanmin(far)) if np.isfinite(far).any() else np.inf
            if far < least:
                best, least = circuit, far
        return None if best is None else (motion, best)


def figure_left(want: FigureWant, value: float, by: Floats) -> tuple[float, Floats]:
    """The residual of a figure, and its slopes."""
    if want.value == "small":
        return value / want.unit, by / want.unit
    if want.value == "great":
        if value < want.unit:
            # a gap may be negative: less is worse there, too
            return 2 - value / want.unit, -by / want.unit
        return want.unit / value, -want.unit / value**2 * by
    return (value - want.value) / want.unit, by / want.unit
