"""A motion as a page of facts and tables, circuits side by side or in rows; what they share is given once."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np
from rich.cells import cell_len

from sevenbar.kinematics.circuits import Circuit, DeadCentre, Extremes
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.motion import Modes, Motion
from sevenbar.reporting.extents import extent_rows, span_rows
from sevenbar.reporting.facts import facts_of, turns_text
from sevenbar.reporting.force_peaks import peaks_of
from sevenbar.reporting.force_words import number
from sevenbar.reporting.shown import Shown, degrees, six_digits
from sevenbar.text.words import say

#: With more circuits than these a line of the table holds one circuit, not one quantity.
MOST_COLUMNS = 2

#: Dead centres listed in one cell; an output that rests has no end of them.
MOST_DEAD_CENTRES = 8

#: Values below this share of what the linkage's size and its drive make are rounding.
REST = 1e-12

#: Characters between two columns in print.
GAP = 2

Texts = tuple[str, ...]


@dataclass(frozen=True)
class Sheet:
    """A table: its heads, and rows of cells; a cell or head may have several lines.

    Columns in `right` stand at the right; the `note` stands below.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    right: frozenset[int] = frozenset()
    note: str = ""


@dataclass(frozen=True)
class Summary:
    """A title, facts by name in order, and tables."""

    title: str
    facts: tuple[tuple[str, str], ...]
    sheets: tuple[Sheet, ...]


def summary(motion: Motion, room: int = 100, *, ranges: bool = False) -> Summary:
    """All that the report says of a motion, in lines of `room` characters if that can be.

    Angles are in degrees, rates in radians. With `ranges`, and where the linkage has stops, there are tables
    of ranges, bends and distances.
    """
    linkage = motion.linkage
    # of an overconstrained loop the last digits decide
    exact = bool(motion.redundant)
    sheets = [_dimension_sheet(linkage, exact=exact)] if linkage.in_rows else []
    if len(motion.circuits) > MOST_COLUMNS:
        sheets += _compared(motion, room)
    elif motion.circuits:
        sheets += _side_by_side(motion)
    if motion.circuits and (ranges or not linkage.stops.is_empty):
        sheets += _extents(motion)
    facts = tuple((say(name) if name else "", fact) for name, fact in facts_of(motion))
    return Summary(linkage.heading, facts, tuple(sheets))


def _extents(motion: Motion) -> list[Sheet]:
    """How far joints, balls and links go, and what stops leave of each circuit."""
    parts = [extent_rows(motion)]
    if motion.linkage.stops.stops:
        parts.append(span_rows(motion))
    return [Sheet(heads, tuple(rows), frozenset({0})) for heads, rows in parts]


def modes_sheets(linkage: Loop, modes: Modes, room: int) -> list[Sheet]:
    """All assembly modes, one row a mode, in tables of at most `room` characters a line."""
    unit = linkage.length_unit
    count = len(modes)
    columns = [(say("residual\n[{unit}]", unit=unit), [f"{residual:.1e}" for residual in modes.residual])]
    for name, kind, q in reversed(list(zip(linkage.columns, linkage.column_kinds, modes.q.T, strict=True))):
        numbers = np.round(np.degrees(q) if kind == "turn" else q, 3) + 0.0  # no -0
        head = f"{name}\n[{'deg' if kind == 'turn' else unit}]"
        columns.append((head, [f"{x:.3f}" for x in numbers]))
    sheets = []
    while columns:
        heads, block = [say("mode")], [[f"{i}" for i in range(count)]]
        left = room - cell_len(heads[0])
        while columns:
            head, cells = columns[-1]
            left -= GAP + max(cell_len(text) for text in [*head.split("\n"), *cells])
            if left < 0 and len(block) > 1:
                break
            columns.pop()
            heads.append(head)
            block.append(cells)
        everywhere = frozenset(range(len(heads)))
        sheets.append(Sheet(tuple(heads), tuple(zip(*block, strict=True)), everywhere))
    return sheets


def _dimension_sheet(linkage: Loop, *, exact: bool) -> Sheet:
    """The rows as written, one a link, to the last digit if `exact`; a joint's own value is no dimension."""
    digits = _every_digit if exact else "{:.6g}".format
    unit = linkage.length_unit
    columns = {
        "length": say("length [{unit}]", unit=unit),
        "offset": say("offset [{unit}]", unit=unit),
        "twist_deg": say("twist [deg]"),
        "angle_deg": say("angle [deg]"),
        "pitch": say("pitch [{unit}/turn]", unit=unit),
    }
    numbers: dict[str, dict[int, float]] = {key: {} for key in columns}
    for key, value in linkage.dimensions.items():
        word, row, *rest = key.split("_")
        numbers["_".join([word, *rest])][int(row)] = value
    kept = [key for key in columns if numbers[key]]
    rows = []
    for place, joint in enumerate(linkage.joints, start=1):
        own = {"angle": "angle_deg"}.get(joint.row.moving_key, "offset")
        cells = [
            digits(numbers[key][place]) if place in numbers[key] else say("moves") if key == own else "-"
            for key in kept
        ]
        named = f"{joint.kind} {joint.name}"
        if place == len(linkage.joints):
            named = say("{joint} (ground)", joint=named)
        rows.append((f"{place}", named, *cells))
    heads = (say("link"), say("joint before it"), *(columns[key] for key in kept))
    return Sheet(heads, tuple(rows), frozenset(range(len(heads))) - {1})


def _every_digit(number: float) -> str:
    return f"{number!r}".removesuffix(".0")


@dataclass(frozen=True)
class _Quantity:
    """What is reported of each circuit: one text or more.

    `name`, in English, is what it is called here, `words` and `unit` are its label in a list, `head` is above
    its column. Two texts that are the `ends`
    of something are two lines of a list, min and max; others are one line, joined by `between`. `only`
    keeps it to lists or to tables; a column may be left out where it is `spare` and room is short.
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
        return " ".join(word for word in (self.words, end, self.unit) if word)


def _quantities(motion: Motion) -> list[_Quantity]:
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

    def rate_of(name: Literal["velocity", "acceleration"], unit: str) -> _Quantity:
        order = 1 + (name == "acceleration")
        words = say("{joint} {quantity}", joint=second, quantity=say(name))

        def of(circuit: Circuit) -> Texts:
            return rate(settled(getattr(circuit, name), circuit, order), circuit)

        head = f"{words}\n[{unit}] @ {first}"
        return _Quantity(f"{second} {name}", words, head, of, f"[{unit}]", ends=True)

    def stands_still(end: Literal["input", "output"]) -> list[_Quantity]:
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
            _Quantity(name, words, "", lambda c: _dead_centres(c, end, place), in_label, only="list"),
            _Quantity(
                f"other {name}" if ranged else name,
                others if ranged else words,
                head,
                lambda c: _dead_centres(c, end, place, within=True),
                only="table",
            ),
        ]

    def forces() -> list[_Quantity]:
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
            _Quantity(
                "peak torque",
                say("{joint} {quantity}", joint=first, quantity=peak),
                f"{peak}\n[{unit}] @ {first}",
                torque,
                f"[{unit}]",
            ),
            _Quantity(
                "greatest reaction", reaction, f"{reaction}\n[N] @ {first}", bearing, "[N]", spare=True
            ),
        ]

    position = "angle" if out_unit == "rad" else "position"
    between = say(" to ")
    first_range, second_range = (say("range of {joint}", joint=joint) for joint in (first, second))
    return [
        _Quantity("motion type", say("motion type"), say("motion type"), way),
        _Quantity(
            f"range of {first}",
            first_range,
            say("range of\n{joint}", joint=first) + in_head,
            lambda c: range_of(c, 0, place),
            in_label,
            between=between,
        ),
        *stands_still("input"),
        _Quantity(
            f"range of {second}",
            second_range,
            "",
            lambda c: range_of(c, 1, result),
            out_label,
            between=between,
            only="list",
        ),
        _Quantity(
            f"range of {second}",
            second_range,
            say("range of\n{joint} @ {other}", joint=second, other=first) + out_head,
            reach,
            out_label,
            between=between,
            only="table",
        ),
        _Quantity(
            f"swing of {second}", say("swing of {joint}", joint=second), "", swing, out_label, only="list"
        ),
        *stands_still("output"),
        _Quantity("time ratio", say("time ratio"), say("time\nratio"), time_ratio, spare=True),
        _Quantity(
            "transmission angle",
            say("transmission angle"),
            say("transmission\nangle @ {joint}", joint=first),
            lambda c: ends(c.transmission, degrees, "-"),
            ends=True,
        ),
        _Quantity(
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
        return say("open")
    return turns_text(circuit.turns) if circuit.turns else say("to and fro")


def _reported(
    motion: Motion, form: Literal["list", "table"], labels: tuple[str, ...] = ("",)
) -> list[tuple[_Quantity, list[Texts]]]:
    """Each quantity with its cells, without those that say nothing, or that the facts hold already.

    Only those whose names begin with one of the `labels`, since some take time.
    """
    quantities = [
        quantity
        for quantity in _quantities(motion)
        if quantity.only in ("", form) and quantity.name.startswith(labels)
    ]
    found = [(quantity, [quantity.cells(circuit) for circuit in motion]) for quantity in quantities]
    full = f"range of {motion.input}"
    return [
        (quantity, cells)
        for quantity, cells in found
        if any(cell[0] not in _nothing() for cell in cells)
        and not (quantity.name == full and set(cells) == {(say("full turns"),)})
    ]


def _nothing() -> Texts:
    """What a cell says where there is nothing to tell."""
    return "-", say("none")


def circuit_facts(motion: Motion, circuit: Circuit, labels: tuple[str, ...] = ("",)) -> list[tuple[str, str]]:
    """What the report has of one circuit: names, and values each "@" the input where it is met.

    Of all, those whose names begin with one of the `labels`.
    """
    reported = [(quantity, [cells[circuit.index]]) for quantity, cells in _reported(motion, "list", labels)]
    return [(label, cells[0]) for label, cells in _lines(reported) if cells[0] not in _nothing()]


def _lines(reported: Sequence[tuple[_Quantity, list[Texts]]]) -> list[tuple[str, Texts]]:
    """Quantities as lines of a list, those with two ends as two lines."""
    lines: list[tuple[str, Texts]] = []
    for quantity, cells in reported:
        if quantity.ends and any(len(cell) == 2 for cell in cells):
            lines.append((quantity.label(say("min")), tuple(cell[0] for cell in cells)))
            lines.append((quantity.label(say("max")), tuple(cell[-1] for cell in cells)))
        else:
            lines.append((quantity.label(), tuple(quantity.between.join(cell) for cell in cells)))
    return lines


def _side_by_side(motion: Motion) -> list[Sheet]:
    """A line for each quantity: first those that circuits share, then with a column for each circuit."""
    lines = _lines(_reported(motion, "list"))
    if len(motion.circuits) == 1:
        return [_list(motion, [say("circuit {number}", number=0)], lines)]
    shared = [(label, cells[:1]) for label, cells in lines if len(set(cells)) == 1]
    own = [(label, cells) for label, cells in lines if len(set(cells)) > 1]
    width = max(cell_len(label) for label, _ in lines)
    names = [say("circuit {number}", number=circuit.index) for circuit in motion]
    parts = (([say("both circuits")], shared), (names, own))
    return [_list(motion, heads, part, width) for heads, part in parts if part]


def _compared(motion: Motion, room: int) -> list[Sheet]:
    """What all circuits share, then one table: a row for each circuit, those that agree in one row."""
    reported = _reported(motion, "table")
    shared = [
        (quantity.label(), (quantity.between.join(cells[0]),)) for quantity, cells in reported if _same(cells)
    ]
    own = [(quantity, cells) for quantity, cells in reported if not _same(cells)]
    sheets = [_list(motion, [say("every circuit")], shared)] if shared else []
    if own:
        table = _comparison(motion, own)
        if width_of(table) > room:
            table = _comparison(motion, [part for part in own if not part[0].spare])
        if width_of(table) > room:
            rows = tuple(tuple(cell.replace(" @ ", "\n@ ") for cell in row) for row in table.rows)
            table = replace(table, rows=rows)
        sheets.append(table)
    return sheets


def _comparison(motion: Motion, reported: Sequence[tuple[_Quantity, list[Texts]]]) -> Sheet:
    alike: dict[Texts, list[str]] = {}
    for circuit in motion:
        row = tuple("\n".join(cells[circuit.index]) for _, cells in reported)
        alike.setdefault(row, []).append(str(circuit.index))
    rows = tuple((", ".join(indices), *row) for row, indices in alike.items())
    heads = (say("circuit"), *(quantity.head for quantity, _ in reported))
    notes = []
    if any(quantity.name.startswith("range of") for quantity, _ in reported):
        notes.append(say("the ends of a range are dead centres"))
    if len(rows) < len(motion.circuits):
        notes.append(say("circuits that agree in all of this share a row"))
    return Sheet(heads, rows, frozenset({0}), say("; ").join(notes))


def _same(cells: Sequence[Texts]) -> bool:
    return len(set(cells)) == 1


def width_of(sheet: Sheet) -> int:
    """The characters that its longest line takes in print."""
    columns = zip(sheet.heads, *sheet.rows, strict=True)
    widths = [max(cell_len(line) for cell in column for line in cell.split("\n")) for column in columns]
    return sum(widths) + GAP * (len(widths) - 1)


def _list(motion: Motion, names: Sequence[str], lines: Sequence[tuple[str, Texts]], width: int = 0) -> Sheet:
    unit = motion.linkage.unit_of(motion.input)
    where = say("value @ angle of {joint}", joint=motion.input)
    if unit != "rad":
        where = say("value @ position of {joint} [{unit}]", joint=motion.input, unit=unit)
    return Sheet(
        (where + " " * (width - cell_len(where)), *names), tuple((label, *cells) for label, cells in lines)
    )


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
