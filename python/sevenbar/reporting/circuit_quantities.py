"""What is reported of circuits, quantity by quantity, each as short texts with the input where it is met."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import DeadCentre, Extremes
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.reporting.facts import turns_text
from sevenbar.reporting.force_peaks import peaks_of
from sevenbar.reporting.force_words import number
from sevenbar.reporting.shown import REST, Shown, degrees, six_digits
from sevenbar.text.words import say

#: Dead centres listed in one cell; an output that rests has no end of them.
MOST_DEAD_CENTRES = 8

Texts = tuple[str, ...]


@dataclass(frozen=True)
class CircuitQuantity:
    """What is reported of each circuit: one text or more.

    `name`, in English, is what it is called here, `words` and `unit` are its label in a list, `head` is above
    its column. Two texts that are the `ends` of something are two lines of a list, min and max; others are
    one line, joined by `between`. `only` keeps it to lists or to tables; a column may be left out where it
    is `spare` and room is short.
    """

    name: str
    words: str
    head: str
    cells: Callable[[Circuit], Texts]
    unit: str = ""
    ends: bool = False
    between: str = ", "
    only: Literal["", "list", "table"] = ""
    spare: bool = False

    def label(self, end: str = "") -> str:
        """What it is called in a list: its words, an end of it, its unit."""
        return " ".join(word for word in (self.words, end, self.unit) if word)


#: A quantity with its cells, one for each circuit.
Reported = tuple[CircuitQuantity, list[Texts]]


def quantities_of(motion: Motion) -> list[CircuitQuantity]:
    """All that is reported of circuits, in order."""
    first, second = motion.input, motion.output
    in_unit, out_unit = (motion.linkage.unit_of(end) for end in (first, second))
    place, result = (Shown("rad" if unit == "rad" else "") for unit in (in_unit, out_unit))
    # of a slide the unit is in the label: a line is not broken between a number and its unit
    in_label, out_label = ("" if unit == "rad" else f"[{unit}]" for unit in (in_unit, out_unit))
    in_head, out_head = (f"\n{label}" if label else "" for label in (in_label, out_label))

    def ends(extremes: Extremes | None, show: Callable[[float], str], otherwise: str) -> Texts:
        if extremes is None:
            return (otherwise,)
        pairs = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
        if extremes.lowest == extremes.highest:
            # throughout, and at no place more than at another
            return (show(extremes.lowest),)
        return tuple(f"{show(value)} @ {place(at, whole=True)}" for value, at in pairs)

    def settled(extremes: Extremes | None, circuit: Circuit, order: int) -> Extremes | None:
        """Extremes without rounding: of a joint that rests, or follows evenly, both are one number."""
        if extremes is None:
            return None
        quick = abs(motion.speed) if motion.law is None else float(np.abs(motion.law.dq).max(initial=0.0))
        size = circuit.size or 1.0
        natural = (1.0 if circuit.output_turns else size) * (
            quick / (1.0 if circuit.input_turns else size)
        ) ** order
        low, high = (0.0 if abs(x) < REST * natural else x for x in (extremes.lowest, extremes.highest))
        return replace(extremes, lowest=low, highest=low if high - low < REST * natural else high)

    def rate(extremes: Extremes | None, circuit: Circuit) -> Texts:
        if motion.law is not None:
            return ends(extremes, six_digits, say("no row within the range"))
        return ends(
            extremes, six_digits, say("change point") if circuit.goes_round else say("no bound at limits")
        )

    def range_of(circuit: Circuit, end: int, show: Shown) -> Texts:
        extent = circuit.output_range if end else circuit.input_range
        if extent is not None and words_of(circuit.motion_type)[end] == "spindle":
            return (say("without end"),)
        if extent is None:
            return (say("full turns"),)
        # the input is given as its limits are
        return show.range(*extent) if end == 0 else (show(extent[0]), show(extent[1]))

    def way(circuit: Circuit) -> Texts:
        words = (say(circuit.motion_type),) if motion.motion_type == "mixed" else ()
        return (*words, way_round(circuit)) if len({way_round(c) for c in motion}) > 1 else words or ("-",)

    def swing(circuit: Circuit) -> Texts:
        return ("-",) if circuit.swing is None else (result(circuit.swing),)

    def time_ratio(circuit: Circuit) -> Texts:
        # a ratio of angles, and of times at a constant speed
        ratio = circuit.time_ratio
        if ratio is None or motion.law is not None:
            return ("-",)
        between = degrees(math.pi * (ratio - 1) / (ratio + 1))
        return (say("{ratio}", ratio=six_digits(ratio), between=between),)

    def reach(circuit: Circuit) -> Texts:
        return (
            ends(settled(circuit.angle, circuit, 0), result, "")
            if circuit.angle
            else range_of(circuit, 1, result)
        )

    def rate_of(name: Literal["velocity", "acceleration"], unit: str) -> CircuitQuantity:
        order = 1 + (name == "acceleration")
        words = say("{joint} {quantity}", joint=second, quantity=say(name))

        def of(circuit: Circuit) -> Texts:
            return rate(settled(getattr(circuit, name), circuit, order), circuit)

        head = f"{words}\n[{unit}] @ {first}"
        return CircuitQuantity(f"{second} {name}", words, head, of, f"[{unit}]", ends=True)

    def stands_still(end: Literal["input", "output"]) -> list[CircuitQuantity]:
        # in a table the ends of a range are its own column
        ranged = end == "output" or any(c.input_range is not None for c in motion)
        name = f"dead centres of the {end}"
        if end == "input":
            words, others = say("dead centres of the input"), say("other dead centres of the input")
            head, head_of_others = (
                say("dead\ncentres of\nthe input"),
                say("other dead\ncentres of\nthe input"),
            )
        else:
            words, others = say("dead centres of the output"), say("other dead centres of the output")
            head, head_of_others = "", say("other dead\ncentres of\nthe output")
        if ranged:
            head = head_of_others
        return [
            CircuitQuantity(name, words, "", lambda c: _dead_centres(c, end, place), in_label, only="list"),
            CircuitQuantity(
                f"other {name}" if ranged else name,
                others if ranged else words,
                head,
                lambda c: _dead_centres(c, end, place, within=True),
                only="table",
            ),
        ]

    def forces() -> list[CircuitQuantity]:
        if motion.linkage.loading.is_empty:
            return []
        unit = "N m" if in_unit == "rad" else "N"
        # once for both, and only where they are reported
        found = cache(peaks_of)

        def torque(circuit: Circuit) -> Texts:
            peaks = found(circuit)
            if peaks is None:
                return ("-" if circuit.goes_round else say("no bound at limits"),)
            return (f"{number(peaks.torque.value)} @ {place(peaks.torque.input, whole=True)}",)

        def bearing(circuit: Circuit) -> Texts:
            peaks = found(circuit)
            if peaks is None or peaks.greatest is None:
                return ("-",)
            name, peak = peaks.greatest
            where = say("{force} in {joint}", force=number(peak.value), joint=name)
            return (f"{where} @ {place(peak.input, whole=True)}",)

        peak = say("peak torque") if unit == "N m" else say("peak force")
        reaction = say("greatest reaction")
        return [
            CircuitQuantity(
                "peak torque",
                say("{joint} {quantity}", joint=first, quantity=peak),
                f"{peak}\n[{unit}] @ {first}",
                torque,
                f"[{unit}]",
            ),
            CircuitQuantity(
                "greatest reaction", reaction, f"{reaction}\n[N] @ {first}", bearing, "[N]", spare=True
            ),
        ]

    position = "angle" if out_unit == "rad" else "position"
    between = say(" to ")
    first_range, second_range = (say("range of {joint}", joint=joint) for joint in (first, second))
    return [
        CircuitQuantity("motion type", say("motion type"), say("motion type"), way),
        CircuitQuantity(
            f"range of {first}",
            first_range,
            say("range of\n{joint}", joint=first) + in_head,
            lambda c: range_of(c, 0, place),
            in_label,
            between=between,
        ),
        *stands_still("input"),
        CircuitQuantity(
            f"range of {second}",
            second_range,
            "",
            lambda c: range_of(c, 1, result),
            out_label,
            between=between,
            only="list",
        ),
        CircuitQuantity(
            f"range of {second}",
            second_range,
            say("range of\n{joint} @ {other}", joint=second, other=first) + out_head,
            reach,
            out_label,
            between=between,
            only="table",
        ),
        CircuitQuantity(
            f"swing of {second}", say("swing of {joint}", joint=second), "", swing, out_label, only="list"
        ),
        *stands_still("output"),
        CircuitQuantity("time ratio", say("time ratio"), say("time\nratio"), time_ratio, spare=True),
        CircuitQuantity(
            "transmission angle",
            say("transmission angle"),
            say("transmission\nangle @ {joint}", joint=first),
            lambda c: ends(c.transmission, degrees, "-"),
            ends=True,
        ),
        CircuitQuantity(
            f"{second} {position}",
            say("{joint} {quantity}", joint=second, quantity=say(position)),
            "",
            lambda c: ends(settled(c.angle, c, 0), six_digits, "-"),
            f"[{out_unit}]",
            ends=True,
            only="list",
        ),
        rate_of("velocity", f"{out_unit}/s"),
        rate_of("acceleration", f"{out_unit}/s\u00b2"),
        *forces(),
    ]


def way_round(circuit: Circuit) -> str:
    """How a circuit closes: after so many turns of the input, to and fro, or not."""
    if not circuit.closed:
        return say("not closed")
    return turns_text(circuit.turns) if circuit.turns else say("to and fro")


def cells_of(
    motion: Motion, form: Literal["list", "table"], labels: tuple[str, ...] = ("",)
) -> list[Reported]:
    """Each quantity with its cells, without those that say nothing, or that the facts hold already.

    Only those whose names begin with one of the `labels`, since some take time.
    """
    quantities = [
        quantity
        for quantity in quantities_of(motion)
        if quantity.only in ("", form) and quantity.name.startswith(labels)
    ]
    found = [(quantity, [quantity.cells(circuit) for circuit in motion]) for quantity in quantities]
    full = f"range of {motion.input}"
    return [
        (quantity, cells)
        for quantity, cells in found
        if any(cell[0] not in nothing() for cell in cells)
        and not (quantity.name == full and set(cells) == {(say("full turns"),)})
    ]


def nothing() -> Texts:
    """What a cell says where there is nothing to tell."""
    return "-", say("none")


def _dead_centres(circuit: Circuit, kind: str, show: Shown, *, within: bool = False) -> Texts:
    """Where the input or the output stands still; `within`: the ends of its range left out."""
    found: Sequence[DeadCentre] = [d for d in circuit.dead_centres if d.kind == kind]
    if within:
        angle = circuit.angle
        ends = (angle.lowest_at, angle.highest_at) if kind == "output" and angle else ()
        ends = circuit.input_range or () if kind == "input" else ends
        found = [d for d in found if not any(show.same(d.input, end) for end in ends)]
    places = list(dict.fromkeys(show(d.input, whole=True) for d in found))
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
