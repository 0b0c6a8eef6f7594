"""What curves show of a circuit and of its forces: one list, and a curve as a value that all draw."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final, Generic, Literal, Protocol, TypeVar

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import CUT, shown_value, slides
from sevenbar.drawing.names import quantity_label
from sevenbar.drawing.ticks import NATURAL_ANGLE, settle
from sevenbar.forces.loading import Loading
from sevenbar.forces.result import Forces, Reaction
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import along
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.column import Column
from sevenbar.kinematics.loop.geometry import Joint, Point
from sevenbar.kinematics.transmission.angle import coupling_of
from sevenbar.text.units import LENGTHS

#: What the output's quantities have at the end of their names in a menu.
OF_OUTPUT: Final = " (output)"

#: The greatest force is that of all rows but this share [%], those nearest to dead centres.
ENDLESS: Final = 5.0

#: Larger values [any unit] count as none, lest a scale overflow.
LARGEST: Final = 1e200

#: What the axis below a curve shows.
Over = Literal["input", "time"]

#: The ends of a range.
Span = tuple[float, float]

#: Of what a quantity is: the start of its keys, its name, the end of its names in a menu, the thing itself.
Subject = tuple[str, str, str, Any]

#: What gives the values of a row: a circuit as it is walked, or its forces.
S = TypeVar("S")


@dataclass(frozen=True)
class Row(Generic[S]):
    """A row of the list: a quantity of every column, point or joint, or of the whole motion or its loading.

    `values` gives it from a source and one of these: of a circuit along its walk, of forces on their rows.
    `order` is that of its derivative, by which endless values are cut; `unit` may name `shown` and `unit` of
    a column, or the `length` unit.
    """

    of: type
    word: str
    unit: str
    order: int
    values: Callable[[S, Any], Floats]
    #: Its word and unit where the column, or what drives, slides.
    sliding: tuple[str, str] | None = None
    #: Whether it is a size, drawn from zero up.
    is_size: bool = False
    #: Whether its sign turns where a rocking input goes back.
    turned: bool = False
    #: Of which columns, motions and so on it is.
    where: Callable[[Any], bool] = lambda _: True

    def named(self, *, slides: bool) -> tuple[str, str]:
        """Its word and its unit."""
        return self.sliding if slides and self.sliding else (self.word, self.unit)


def _place(one: TimedWalk, column: Column) -> Floats:
    """Angles start where the walk has them and run on."""
    values = along(one.linkage, one.circuit, column.number) + one.whole_turns(column.number)
    return np.asarray(shown_value(one.motion, column.name, values))


def _transmission(one: TimedWalk, _: Motion) -> Floats:
    angle, rows = one.circuit.transmission_angle, one.path.rows
    return np.full(len(rows), np.nan) if angle is None else np.degrees(angle[rows])


def _is_transmitted(motion: Motion) -> bool:
    """Whether there is a transmission angle; its values are for those who draw it."""
    ends = (motion.linkage.columns.index(end) for end in (motion.input, motion.output))
    return bool(motion.circuits) and coupling_of(motion.linkage, *ends) is not None


def _has_mass(loading: Loading) -> bool:
    return any(loading.bodies.values())


def _size(vectors: Floats) -> Floats:
    sizes: Floats = np.linalg.norm(vectors, axis=-1)
    return sizes


#: Of a circuit. Where a rocking input goes back, velocities turn their sign.
MOTION: Final[tuple[Row[TimedWalk], ...]] = (
    Row(Column, "angle", "{shown}", 0, _place, sliding=("position", "{shown}")),
    Row(Column, "velocity", "{unit}/s", 1, lambda w, c: w.path.velocities(w.circuit.dq[:, c.number])),
    Row(Column, "acceleration", "{unit}/s²", 2, lambda w, c: w.circuit.ddq[w.path.rows, c.number]),
    Row(Motion, "transmission angle", "deg", 0, _transmission, where=_is_transmitted),
    Row(
        Point, "speed", "{length}/s", 1,
        lambda w, point: _size(w.circuit.point(point.name).velocity)[w.path.rows], is_size=True,
    ),
    Row(
        Point, "acceleration", "{length}/s²", 2,
        lambda w, point: _size(w.circuit.point(point.name).acceleration)[w.path.rows], is_size=True,
    ),
)  # fmt: skip

#: Of the forces along it. Most count as of the second order: like accelerations, they grow without bound at
#: dead centres.
FORCES: Final[tuple[Row[Forces], ...]] = (
    Row(Loading, "input torque", "N m", 2, lambda f, _: f.torque, sliding=("input force", "N")),
    Row(Loading, "power", "W", 2, lambda f, _: f.power, turned=True),
    Row(Loading, "kinetic energy", "J", 2, lambda f, _: f.kinetic, is_size=True, where=_has_mass),
    Row(Loading, "potential energy", "J", 0, lambda f, _: f.potential),
    Row(
        Loading, "shaking force", "N", 2, lambda f, _: _size(f.shaking[:, 3:]), is_size=True, where=_has_mass
    ),
    Row(Joint, "force", "N", 2, lambda f, joint: _size(f.reactions[joint.name].force), is_size=True),
    # a ball has no axis
    Row(
        Joint, "radial force", "N", 2, lambda f, joint: _size(f.reactions[joint.name].force[:, :2]),
        is_size=True, where=lambda joint: joint.kind != "S",
    ),
)  # fmt: skip

#: The key of the transmission angle.
TRANSMISSION: Final = "transmission angle"

#: The quantities of every column by their words: those that figures and films draw of the output.
QUANTITIES: Final = tuple(row.word for row in MOTION if row.of is Column)


class ActingForces(Protocol):
    """What acts on a linkage, and gives the forces along circuits."""

    @property
    def linkage(self) -> Linkage:
        """The linkage with its loading."""

    @property
    def is_empty(self) -> bool:
        """Whether nothing has a mass and nothing acts."""

    def forces(self, one: TimedWalk, /) -> Forces | None:
        """On the rows of a circuit; `None` where there are none."""

    def reason(self, one: TimedWalk, /) -> str:
        """Why there are none; empty where there are."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """A row of the list for one column, point, joint or motion (`item`): what one curve shows.

    `key` stays the same from one motion of a linkage to the next; `name` stands in a menu, `subject` and
    `word` along an axis. A quantity of forces has what is `acting`.
    """

    row: Row[Any]
    key: str
    name: str
    subject: str
    word: str
    unit: str
    item: Any
    acting: ActingForces | None = None

    @property
    def heading(self) -> str:
        """Its name above a curve, where there is little room."""
        return self.name.removesuffix(OF_OUTPUT)

    def label(self, unit: str = "") -> str:
        """What is written along its axis, in its own unit or in another."""
        return quantity_label(self.subject, self.word, unit or self.unit)

    def values(self, one: TimedWalk) -> Floats:
        """The values along the walk of a circuit, in `unit`, (n,); NaN where a row has none."""
        if self.acting is None:
            return self.row.values(one, self.item)
        forces = self.acting.forces(one)
        if forces is None:
            return np.full(len(one.path.rows), np.nan)
        values = self.row.values(forces, self.item)
        return one.path.velocities(values) if self.row.turned else np.asarray(values[one.path.rows])

    def absence(self, one: TimedWalk) -> str:
        """What is shown in place of a curve that has no value."""
        if self.acting is not None:
            forces = self.acting.forces(one)
            if forces is None:
                return self.acting.reason(one)
            known = np.isfinite(forces.torque)
            if self.row.of is Joint and np.isnan(self.row.values(forces, self.item)[known]).any():
                return "not determined: constraints are redundant"
        return f"no value along circuit {one.circuit.index}"

    def natural(self, one: TimedWalk) -> float:
        """The size of a value that a designer would call neither small nor large, in `unit`."""
        motion, size = one.motion, one.circuit.size or 1.0
        if self.acting is not None:
            forces = self.acting.forces(one)
            return 0.0 if forces is None else _natural_force(forces, self.unit, size)
        if self.row.order == 0:
            return NATURAL_ANGLE if self.unit == "deg" else size
        rate = abs(motion.speed) if motion.law is None else float(np.abs(motion.law.dq).max(initial=0.0))
        if slides(motion, motion.input):
            rate /= size
        natural = (1.0 if self.unit.startswith("rad") else size) * rate**self.row.order
        return natural if math.isfinite(natural) else 0.0


@dataclass(frozen=True)
class Mark:
    """An extreme of a curve: which one, its value in the curve's unit, and the input as it is drawn."""

    word: Literal["lowest", "highest"]
    value: float
    input: float


@dataclass(frozen=True, eq=False)
class QuantityCurve:
    """A quantity along the walk of a circuit, as figures, the studio, films and notebooks draw it.

    `input` [deg, or length] and `values` [unit] are those of the rows (n,), values that vary by rounding only
    their mean; `natural` is the size of a value neither small nor large.
    """

    quantity: Quantity
    walked: TimedWalk
    input: Floats
    values: Floats
    natural: float
    marks: tuple[Mark, ...]

    @property
    def circuit(self) -> Circuit:
        """The circuit."""
        return self.walked.circuit

    @property
    def passes(self) -> tuple[slice, ...]:
        """The rows of each pass between input dead centres."""
        return self.walked.path.passes

    def span(self, part: slice | None = None) -> Span | None:
        """The range of a pass, or of all, worth showing, endless values by `CUT`; `None` without any."""
        if part is None:
            spans = [span for own in self.passes if (span := self.span(own)) is not None]
            return (min(low for low, _ in spans), max(high for _, high in spans)) if spans else None
        finite = self.values[part][np.isfinite(self.values[part])]
        if not finite.size:
            return None
        if not self.cut:
            return float(finite.min()), float(finite.max())
        share = CUT[min(self.quantity.row.order, 2)]
        low, high = np.percentile(finite, [share, 100 - share])
        return float(low), float(high)

    @property
    def cut(self) -> bool:
        """Whether the values grow without bound at dead centres of the input."""
        return bool(self.quantity.row.order) and self.circuit.turns_back

    def across(self, over: Over) -> Floats:
        """What is along the axis below, (n,)."""
        return self.input if over == "input" else self.walked.path.time

    def place(self, mark: Mark, over: Over) -> float:
        """Where along the axis below a mark is on the curve; NaN where it is not on it.

        An input is known to whole turns.
        """
        result = [(math.inf, math.nan)]
        for part in self.passes:
            off = self.input[part] - mark.input
            half = 180.0 if self.circuit.input_turns else math.inf
            off = (off + half) % (2 * half) - half if math.isfinite(half) else off
            for i in np.flatnonzero((off[:-1] * off[1:] <= 0) & (np.abs(off[:-1] - off[1:]) < half)):
                share = off[i] / (off[i] - off[i + 1]) if off[i] != off[i + 1] else 0.0
                ends = (values[part][i : i + 2] for values in (self.across(over), self.values))
                x, y = (start + share * (end - start) for start, end in ends)
                result.append((abs(y - mark.value), x))
        return min(result)[1]


def curve_of(quantity: Quantity, one: TimedWalk) -> QuantityCurve:
    """The curve of a quantity along a circuit."""
    motion, circuit = one.motion, one.circuit
    natural, values = quantity.natural(one), quantity.values(one)
    marks: tuple[Mark, ...] = ()
    row, column = quantity.row, quantity.item
    if row.of is Column and column.number == circuit.output_column:
        extremes: Extremes | None = getattr(circuit, row.word)
        turns = 0.0 if row.order else one.whole_turns(column.number)
        for word in ("lowest", "highest") if extremes is not None else ():
            value, at = getattr(extremes, word), getattr(extremes, f"{word}_at")
            value = value if row.order else shown_value(motion, column.name, value + turns)
            marks += (Mark(word, value, shown_value(motion, motion.input, at)),)
    inputs = shown_value(motion, motion.input, one.path.input)
    values = settle(np.where(np.abs(values) < LARGEST, values, np.nan), natural)
    return QuantityCurve(quantity, one, inputs, values, natural, marks)


def quantities(motion: Motion, acting: ActingForces | None = None) -> tuple[Quantity, ...]:
    """All that can be drawn, in the order of a menu: output, other columns, named points, then forces.

    Forces only where something acts; nothing is computed.
    """
    linkage, output = motion.linkage, motion.linkage.column_of(motion.output)
    subjects: list[Subject] = [("output", output.name, OF_OUTPUT, output), ("", "", "", motion)]
    ends = motion.input, motion.output
    subjects += [(f"column.{c.name}", c.name, "", c) for c in linkage.each_column if c.name not in ends]
    subjects += [(f"point.{point.name}", point.name, "", point) for point in linkage.points]
    names: set[str] = set()
    result = [*_listed(MOTION, motion, subjects, names)]
    if acting is not None and not acting.is_empty:
        subjects = [("forces", "", "", acting.linkage.loading)]
        subjects += [(f"forces.{joint.name}", joint.name, "", joint) for joint in linkage.joints]
        result += _listed(FORCES, motion, subjects, names, acting)
    return tuple(result)


def place_of_column(motion: Motion, name: str) -> Quantity:
    """The angle or place of any column, of the input, too."""
    return next(_listed(MOTION, motion, [("", name, "", motion.linkage.column_of(name))], set()))


def _listed(
    rows: tuple[Row[Any], ...],
    motion: Motion,
    subjects: list[Subject],
    taken: set[str],
    acting: ActingForces | None = None,
) -> Iterator[Quantity]:
    """The rows of each subject; a name that is taken gets a word of what it is of."""
    for start, subject, end, item in subjects:
        column = item if isinstance(item, Column) else motion.linkage.column_of(motion.input)
        units = {"shown": column.shown[0], "unit": column.unit, "length": motion.linkage.length_unit}
        for row in rows:
            if not isinstance(item, row.of) or not row.where(item):
                continue
            word, unit = row.named(slides=not column.turns)
            name = f"{subject} {word}{end}".strip()
            # names come from files: a joint may be called "output"
            while name in taken:
                name += " (point)" if row.of is Point else " (joint)"
            taken.add(name)
            key = f"{start}.{row.word}".strip(".")
            yield Quantity(row, key, name, subject, word, unit.format(**units), item, acting)


def _natural_force(forces: Forces, unit: str, size: float) -> float:
    """The size of a value that is neither small nor large, of forces of a linkage of a size."""
    sizes = np.concatenate([_greatest(reaction) for reaction in forces.reactions.values()])
    force = float(np.percentile(sizes, 100 - ENDLESS)) if sizes.size else 0.0
    metre = LENGTHS[forces.length_unit]
    arm = 1.0 if forces.slides else size * metre
    if unit == "W":
        speed = float(np.nanmax(np.abs(forces.speed), initial=0.0))
        return force * arm * speed * (metre if forces.slides else 1.0)
    return force * {"N m": arm, "J": size * metre}.get(unit, 1.0)


def _greatest(reaction: Reaction) -> Floats:
    """The greatest component of a force on each row that has one."""
    sizes = np.abs(reaction.force[:, reaction.determinate[3:]]).max(axis=1, initial=-math.inf)
    return np.asarray(sizes[np.isfinite(sizes)])
