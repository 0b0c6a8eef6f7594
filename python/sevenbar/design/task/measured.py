"""Measures of a circuit as wants and musts: what may be asked, values at any numbers, exact slopes if any."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.given import amount
from sevenbar.design.task.loop import SAMPLES, TaskLoop
from sevenbar.design.task.rssr_measures import RssrMeasures
from sevenbar.design.task.transmitting import LeastAngle
from sevenbar.design.task.values import Given
from sevenbar.errors import DescriptionError, NotCoveredError, RequestError, no_joint, shown, suggestion
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.measures import (
    JOINT_EXTENTS,
    JOINT_MEASURES,
    NAMED,
    OF_JOINTS,
    circuit_gradient,
    circuit_mass_gradient,
    is_of_forces,
    measures_named,
)

#: Step of the differences that stand in for slopes where a measure has none of its own [of a unit].
STEP = 1e-5

#: Inputs of a turn that show whether a measure has a meaning.
FEW = 12

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
        own = RssrMeasures(loop)
        self._closed_form = own if own.knows(self.names) else None
        #: Whether a value takes a motion that is measured, and counts.
        self.measured = bool(self.names) and not (self._closed_form or (self._angle and self._angle.known))
        #: Whether they are all of one circuit, which the general way follows.
        self._alone = loop.linkage.form != "rssr" and all(one.per == "circuit" for one in self._measures)
        self._columns = [c for c, ball in enumerate(loop.numbers.is_ball) if not ball]

    def at(self, values: Floats, anchor: Floats, *, slopes: bool = True) -> tuple[Floats, Floats] | None:
        """Values (f,) and slopes (f, k) at numbers (k,), of the circuit near a row (columns,) of an analysis.

        `None` where the circuit is gone or one of the measures has no value.
        """
        quick = None if self._angle is None else self._angle.at(values, anchor, slopes=slopes)
        if quick is None and self._closed_form is not None:
            quick = self._closed_form.at(values, anchor, self.names)
        if quick is not None:
            return quick
        self.motions += 1 + slopes
        result = self._near(values, anchor)
        if result is None:
            return None
        linkage, circuit, motion = result
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
        result = self.circuit(values, anchor)
        return None if result is None else (result[0].linkage, result[1], result[0])

    def read(self, motion: Motion | None, circuit: Circuit) -> dict[str, float]:
        """The measures of a circuit; NaN where one has no value."""
        result = {}
        for measure in self._measures:
            value = measure.value(motion if motion and measure.per == "linkage" else circuit)
            result[measure.name] = float(value) if isinstance(value, (int, float)) else np.nan
        return result

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


def measure_unit(name: str, linkage: Linkage) -> str:
    """The unit in which a measure is read; empty without one."""
    (measure,) = measures_named([name])
    return measure.unit(linkage, linkage.drive.output).replace("_", " ")


def measure_value(key: str, value: Given, linkage: Linkage, name: str) -> float:
    """A value of a measure in the unit that it is read in; a number stays as it is."""
    if not isinstance(value, str):
        return value
    try:
        (measure,) = measures_named([name])
    except RequestError:
        # the name is checked with the task
        return 0.0
    unit = measure.unit(linkage, linkage.drive.output)
    return amount(key, value, unit if unit in ("deg", linkage.length_unit) else "")


def measure_flaw(linkage: Linkage, name: str) -> str:
    """Why a measure cannot be wanted; empty for one that can."""
    try:
        (measure,) = measures_named([name])
    except RequestError:
        numbers = [n for n, m in NAMED.items() if m.quantity != "word"]
        known = [*numbers, *(f"{kind}:JOINT" for kind in OF_JOINTS)]
        return f"{shown(name)} is not a measure; {suggestion(name, known)}give one of {', '.join(known)}"
    if measure.quantity == "word":
        return f"'{name}' is a word, not a number; give limits.motion_type"
    kind, _, joint = name.partition(":")
    names = [known.name for known in linkage.joints]
    if kind in JOINT_MEASURES and joint not in names:
        return no_joint(joint, names)
    if is_of_forces(name) and linkage.loading.is_empty:
        return "nothing acts on the linkage: no body, load or spring; write them into its file"
    if (
        name.startswith("transmission")
        and linkage.form != "rssr"
        and all(circuit.transmission is None for circuit in linkage.motion(FEW).circuits)
    ):
        return "this linkage has no transmission angle; leave it out"
    if kind in JOINT_EXTENTS:
        for circuit in linkage.motion(FEW).circuits[:1]:
            try:
                measure.value(circuit)
            except RequestError as error:
                return str(error).removeprefix("measure: ")
    return ""


def value_flaw(linkage: Linkage, name: str, value: float, key: str = "value") -> str:
    """Why a measure never has a value, as wanted, or as the `least` or the `most`; empty where it may."""
    (measure,) = measures_named([name])
    low, high = measure.bounds
    if name == "swing" and linkage.kind in ("RSSR", "RRRR"):
        # the output of a longer loop may rock by more than a turn, and a slide by any length
        high = 360.0
    if value < low and key != "least":
        return f"{value:g} cannot be: {name} is never below {low:g}; give another value"
    if value > high and key != "most":
        return f"{value:g} cannot be: {name} is never above {high:g}; give another value"
    return ""
