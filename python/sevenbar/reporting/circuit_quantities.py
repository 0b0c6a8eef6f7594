"""What is reported of circuits, quantity by quantity, each as short texts with the input where it is met."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Literal

import numpy as np

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import DeadCentre, Extremes
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.reporting.facts import turns_text
from sevenbar.reporting.force_peaks import peaks_of
from sevenbar.reporting.shown import REST, Shown, degrees, number, six_digits, turned
from sevenbar.text.words import say

#: Dead centres listed in one cell; an output that rests has no end of them.
MOST_DEAD_CENTRES = 8

Texts = tuple[str, ...]

#: The quantities that say what a circuit is; others have no role.
Role = Literal["", "motion type", "input range", "output range"]


@dataclass(frozen=True)
class CircuitQuantity:
    """What is reported of each circuit: one text or more.

    `words` and `unit` are its label in a list, `head` is above its column. Two texts that are the `ends` of
    something are two lines of a list, min and max; others are one line, joined by `between`. `only` keeps it
    to lists or to tables; a column may be left out where it is `spare` and room is short. `role` is what it
    is known by in other modules.
    """

    words: str
    head: str
    cells: Callable[[Circuit], Texts]
    unit: str = ""
    ends: bool = False
    between: str = ", "
    only: Literal["", "list", "table"] = ""
    spare: bool = False
    role: Role = ""

    def label(self, end: str = "") -> str:
        """What it is called in a list: its words, an end of it, its unit."""
        return " ".join(word for word in (self.words, end, self.unit) if word)


#: A quantity with its cells, one for each circuit.
Reported = tuple[CircuitQuantity, list[Texts]]


class _Texts:
    """The texts of a motion's circuits: numbers in the units of its input and output."""

    def __init__(self, motion: Motion) -> None:
        self.motion, self.input, self.output = motion, motion.input, motion.output
        self.in_unit, self.out_unit = (motion.linkage.unit_of(end) for end in (motion.input, motion.output))
        self.place, self.result = (
            Shown("rad" if unit == "rad" else "") for unit in (self.in_unit, self.out_unit)
        )
        # the search for peaks once for both, and only where they are reported
        self.peaks = cache(peaks_of)

    def ends(self, extremes: Extremes | None, show: Callable[[float], str], otherwise: str) -> Texts:
        """The lowest and the highest value, and the input at each."""
        if extremes is None:
            return (otherwise,)
        pairs = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
        if extremes.lowest == extremes.highest:
            # throughout, and at no place more than at another
            return (show(extremes.lowest),)
        return tuple(f"{show(value)} @ {self.place(at, whole=True)}" for value, at in pairs)

    def settled(self, extremes: Extremes | None, circuit: Circuit, order: int) -> Extremes | None:
        """Extremes without rounding: of a joint that rests, or follows evenly, both are one number."""
        if extremes is None:
            return None
        low, high = extremes.lowest, extremes.highest
        if order == 0 and circuit.output_turns:
            turn = turned(low, high)
            low, high = low + turn, high + turn
        low, high = self._rounded(low, high, circuit, order)
        return replace(extremes, lowest=low, highest=high)

    def _rounded(self, low: float, high: float, circuit: Circuit, order: int) -> tuple[float, float]:
        """Two values of the output's derivative of an order; rounding is 0, and their difference too."""
        law = self.motion.law
        quick = abs(self.motion.speed) if law is None else float(np.abs(law.dq).max(initial=0.0))
        size = circuit.size or 1.0
        natural = (1.0 if circuit.output_turns else size) * (
            quick / (1.0 if circuit.input_turns else size)
        ) ** order
        low, high = (0.0 if abs(x) < REST * natural else x for x in (low, high))
        return low, low if high - low < REST * natural else high

    def motion_type(self, circuit: Circuit) -> Texts:
        """Its motion type where circuits differ in it, and how it goes round where they differ in that."""
        words = (say(circuit.motion_type),) if self.motion.motion_type == "mixed" else ()
        ways = {way_round(other) for other in self.motion}
        return (*words, way_round(circuit)) if len(ways) > 1 else words or ("-",)

    def input_range(self, circuit: Circuit) -> Texts:
        """The range of the input, in the convention of its limits."""
        extent = circuit.input_range
        return self._endless(circuit, extent, 0) or self.place.range(*(extent or ()))

    def output_range(self, circuit: Circuit) -> Texts:
        """The range of the output."""
        extent = circuit.output_range
        words = self._endless(circuit, extent, 1)
        if words or extent is None:
            return words
        turn = turned(*extent) if circuit.output_turns else 0.0
        low, high = self._rounded(extent[0] + turn, extent[1] + turn, circuit, 0)
        if low == high:
            return (say("at rest at {value}", value=self.result(low)),)
        return self.result(low), self.result(high)

    def _endless(self, circuit: Circuit, extent: tuple[float, float] | None, end: int) -> Texts:
        """The words in place of a range; nothing where there is one."""
        if extent is None:
            return (say("full turns"),)
        return (say("without end"),) if words_of(circuit.motion_type)[end] == "spindle" else ()

    def output_reach(self, circuit: Circuit) -> Texts:
        """The least and the greatest value of the output with their inputs, or its range."""
        if circuit.angle is None:
            return self.output_range(circuit)
        return self.ends(self.settled(circuit.angle, circuit, 0), self.result, "")

    def output_values(self, circuit: Circuit) -> Texts:
        """The least and the greatest value of the output, as plain numbers."""
        return self.ends(self.settled(circuit.angle, circuit, 0), six_digits, "-")

    def swing(self, circuit: Circuit) -> Texts:
        """The swing of the output."""
        return ("-",) if circuit.swing is None else (self.result(circuit.swing),)

    def time_ratio(self, circuit: Circuit) -> Texts:
        """The time ratio: one of angles, and of times at a constant speed."""
        ratio = circuit.time_ratio
        if circuit.many_strokes and self.motion.law is None:
            return (say("not defined: more than two strokes"),)
        if ratio is None or self.motion.law is not None:
            return ("-",)
        between = degrees(math.pi * (ratio - 1) / (ratio + 1))
        return (say("{ratio}", ratio=six_digits(ratio), between=between),)

    def transmission(self, circuit: Circuit) -> Texts:
        """The least and the greatest transmission angle."""
        return self.ends(circuit.transmission, degrees, "-")

    def velocity(self, circuit: Circuit) -> Texts:
        """The extremes of the output's velocity."""
        return self._rate(self.settled(circuit.velocity, circuit, 1), circuit)

    def acceleration(self, circuit: Circuit) -> Texts:
        """The extremes of the output's acceleration."""
        return self._rate(self.settled(circuit.acceleration, circuit, 2), circuit)

    def _rate(self, extremes: Extremes | None, circuit: Circuit) -> Texts:
        if self.motion.law is not None:
            return self.ends(extremes, six_digits, say("no row within the range"))
        unbounded = say("change point") if circuit.goes_round else say("no bound at limits")
        return self.ends(extremes, six_digits, unbounded)

    def peak_torque(self, circuit: Circuit) -> Texts:
        """The greatest torque or force of the input."""
        peaks = self.peaks(circuit)
        if peaks is None and self.motion.linkage.stops.stops and not circuit.allowed.spans:
            return (say("none"),)
        if peaks is None:
            return ("-" if circuit.goes_round else say("no bound at limits"),)
        return (f"{number(peaks.torque.value)} @ {self.place(peaks.torque.input, whole=True)}",)

    def reaction(self, circuit: Circuit) -> Texts:
        """The greatest reaction, and in which joint."""
        peaks = self.peaks(circuit)
        if peaks is None or peaks.greatest is None:
            return ("-",)
        name, peak = peaks.greatest
        where = say("{force} in {joint}", force=number(peak.value), joint=name)
        return (f"{where} @ {self.place(peak.input, whole=True)}",)


def quantities_of(motion: Motion) -> list[CircuitQuantity]:
    """All that is reported of circuits, in order."""
    texts = _Texts(motion)
    first, second = motion.input, motion.output
    # of a slide the unit is in the label: a line is not broken between a number and its unit
    in_label, out_label = ("" if unit == "rad" else f"[{unit}]" for unit in (texts.in_unit, texts.out_unit))
    in_head, out_head = (f"\n{label}" if label else "" for label in (in_label, out_label))
    first_range, second_range = (say("range of {joint}", joint=joint) for joint in (first, second))
    in_head = say("range of\n{joint}", joint=first) + in_head
    out_head = say("range of\n{joint} @ {other}", joint=second, other=first) + out_head
    in_range = partial(CircuitQuantity, first_range, unit=in_label, between=say(" to "), role="input range")
    out_range = partial(
        CircuitQuantity, second_range, unit=out_label, between=say(" to "), role="output range"
    )
    position = _of_output(texts, "angle" if texts.out_unit == "rad" else "position", texts.out_unit)
    velocity = _of_output(texts, "velocity", f"{texts.out_unit}/s")
    acceleration = _of_output(texts, "acceleration", f"{texts.out_unit}/s\u00b2")
    transmission = say("transmission angle"), say("transmission\nangle @ {joint}", joint=first)
    swing = say("swing of {joint}", joint=second)
    return [
        CircuitQuantity(say("motion type"), say("motion type"), texts.motion_type, role="motion type"),
        in_range(in_head, texts.input_range),
        *_standstills(texts, "input", in_label),
        out_range("", texts.output_range, only="list"),
        out_range(out_head, texts.output_reach, only="table"),
        CircuitQuantity(swing, "", texts.swing, out_label, only="list"),
        *_standstills(texts, "output", in_label),
        CircuitQuantity(say("time ratio"), say("time\nratio"), texts.time_ratio, spare=True),
        CircuitQuantity(*transmission, texts.transmission, ends=True),
        position(texts.output_values, only="list"),
        velocity(texts.velocity),
        acceleration(texts.acceleration),
        *_forces(texts),
    ]


def _of_output(texts: _Texts, name: str, unit: str) -> Callable[..., CircuitQuantity]:
    """The least and the greatest value of something of the output, by its cells."""
    words = say("{joint} {quantity}", joint=texts.output, quantity=say(name))
    head = f"{words}\n[{unit}] @ {texts.input}"
    return partial(CircuitQuantity, words, head, unit=f"[{unit}]", ends=True)


def _standstills(texts: _Texts, end: Literal["input", "output"], unit: str) -> list[CircuitQuantity]:
    """The dead centres of an end; in a table those that are no ends of a range, which is its own column."""
    ranged = end == "output" or any(c.input_range is not None for c in texts.motion)
    if end == "input":
        words, others = say("dead centres of the input"), say("other dead centres of the input")
        head, head_of_others = say("dead\ncentres of\nthe input"), say("other dead\ncentres of\nthe input")
    else:
        words, others = say("dead centres of the output"), say("other dead centres of the output")
        head, head_of_others = "", say("other dead\ncentres of\nthe output")
    within = partial(_dead_centres, kind=end, show=texts.place, within=True)
    shown = (others, head_of_others) if ranged else (words, head)
    return [
        CircuitQuantity(words, "", partial(_dead_centres, kind=end, show=texts.place), unit, only="list"),
        CircuitQuantity(*shown, within, only="table"),
    ]


def _forces(texts: _Texts) -> list[CircuitQuantity]:
    """The peak torque and the greatest reaction, where there are loads."""
    if texts.motion.linkage.loading.is_empty:
        return []
    first, unit = texts.input, "N m" if texts.in_unit == "rad" else "N"
    peak = say("peak torque") if unit == "N m" else say("peak force")
    words, reaction = say("{joint} {quantity}", joint=first, quantity=peak), say("greatest reaction")
    return [
        CircuitQuantity(words, f"{peak}\n[{unit}] @ {first}", texts.peak_torque, f"[{unit}]"),
        CircuitQuantity(reaction, f"{reaction}\n[N] @ {first}", texts.reaction, "[N]", spare=True),
    ]


def way_round(circuit: Circuit) -> str:
    """How a circuit closes: after so many turns of the input, to and fro, or not."""
    if not circuit.closed:
        return say("not closed")
    return turns_text(circuit.turns) if circuit.turns else say("to and fro")


def cells_of(
    motion: Motion,
    form: Literal["list", "table"],
    *,
    in_brief: bool = False,
    circuits: Sequence[Circuit] | None = None,
) -> list[Reported]:
    """Each quantity with its cells, without those that say nothing, or that the facts hold already.

    `in_brief` those that have a role, since others take time; cells of all circuits, or of some for the same
    reason.
    """

    def is_held(quantity: CircuitQuantity) -> bool:
        return quantity.role == "input range" and {*map(quantity.cells, motion)} == {(say("full turns"),)}

    shown = motion.circuits if circuits is None else circuits
    result = [
        (quantity, [quantity.cells(circuit) for circuit in shown])
        for quantity in quantities_of(motion)
        if quantity.only in ("", form) and (quantity.role or not in_brief) and not is_held(quantity)
    ]
    return [
        (quantity, cells) for quantity, cells in result if any(cell[0] not in nothing() for cell in cells)
    ]


def nothing() -> Texts:
    """What a cell says where there is nothing to tell."""
    return "-", say("none")


def _dead_centres(circuit: Circuit, *, kind: str, show: Shown, within: bool = False) -> Texts:
    """Where the input or the output stands still; `within`: the ends of its range left out."""
    result: Sequence[DeadCentre] = [d for d in circuit.dead_centres if d.kind == kind]
    if within:
        angle = circuit.angle
        ends = (angle.lowest_at, angle.highest_at) if kind == "output" and angle else ()
        ends = circuit.input_range or () if kind == "input" else ends
        result = [d for d in result if not any(show.same(d.input, end) for end in ends)]
    places = list(dict.fromkeys(show(d.input, whole=True) for d in result))
    more = len(places) - MOST_DEAD_CENTRES
    return (*places[:MOST_DEAD_CENTRES], *([say("and {count} more", count=more)] if more > 0 else [])) or (
        say("none"),
    )


def words_of(motion_type: str) -> tuple[str, str]:
    """What input and output are called, read off the motion type of a circuit.

    >>> words_of("double-spindle"), words_of("spindle-slider"), words_of("change-point")
    (('spindle', 'spindle'), ('spindle', 'slider'), ('change', 'point'))
    """
    first, _, second = motion_type.partition("-")
    return (second, second) if first == "double" else (first, second)
