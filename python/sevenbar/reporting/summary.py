"""A motion as a page of facts and tables, circuits side by side or in rows; what they share is given once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from textwrap import wrap

import numpy as np
from rich.cells import cell_len

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.reporting.circuit_quantities import Reported, Texts, cells_of, nothing
from sevenbar.reporting.extents import extent_rows, span_rows
from sevenbar.reporting.facts import facts_of
from sevenbar.text.words import say

#: With more circuits than these a line of the table holds one circuit, not one quantity.
MOST_COLUMNS = 2

#: Characters between two columns in print.
GAP = 2


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


#: What a designer reads in a brief report; how it was found is left out.
BRIEF = (
    "drive",
    "motion type",
    "nearly moves",
    "circuits",
    "input limits",
    "change point",
    "within the stops",
)


def summary(motion: Motion, room: int = 100, *, ranges: bool = False, short: bool = False) -> Summary:
    """All that the report says of a motion, in lines of `room` characters if that can be.

    Angles are in degrees, rates in radians. With `ranges`, and where the linkage has stops, there are tables
    of ranges, bends and distances. A `short` one has what it does, not how it is written and was found.
    """
    linkage = motion.linkage
    # of an overconstrained loop the last digits decide
    exact = bool(motion.redundant)
    sheets = [_dimension_sheet(linkage, exact=exact)] if linkage.in_rows and not short else []
    if len(motion.circuits) > MOST_COLUMNS:
        sheets += _compared(motion, room)
    elif motion.circuits:
        sheets += _side_by_side(motion)
    if motion.circuits and (ranges or not linkage.stops.is_empty):
        parts = [extent_rows(motion), *([span_rows(motion)] if linkage.stops.stops else [])]
        sheets += [Sheet(heads, tuple(rows), frozenset({0})) for heads, rows in parts]
    every = facts_of(motion)
    sure = motion.completeness in ("closed-form", "counted") and not motion.search.unfollowed
    shown = _short(every, sure=sure) if short else every
    facts = tuple((say(name) if name else "", fact) for name, fact in shown)
    return Summary(linkage.heading, facts, tuple(sheets))


def _short(facts: Sequence[tuple[str, str]], *, sure: bool) -> list[tuple[str, str]]:
    """The facts of a brief report and their sentences; unless it is `sure`, also whether all is found."""
    result, takes = [], False
    for name, fact in facts:
        takes = name in BRIEF or (name == "completeness" and not sure) if name else takes
        result += [(name, fact)] * takes
    return result


def modes_sheets(linkage: Loop, modes: Modes, room: int) -> list[Sheet]:
    """All assembly modes, one row a mode, in tables of at most `room` characters a line."""
    unit = linkage.length_unit
    count = len(modes)
    columns = [(say("residual\n[{unit}]", unit=unit), [f"{residual:.1e}" for residual in modes.residual])]
    for column, q in reversed(list(zip(linkage.each_column, modes.q.T, strict=True))):
        numbers = np.round(np.degrees(q) if column.turns else q, 3) + 0.0  # no -0
        head = f"{column.name}\n[{column.shown[0]}]"
        columns.append((head, [f"{x:.3f}" for x in numbers]))
    return wide_sheets([(say("mode"), [f"{i}" for i in range(count)])], columns[::-1], room)


#: A column of a table: its head, and its cells.
Column = tuple[str, list[str]]


def wide_sheets(first: Sequence[Column], columns: Sequence[Column], room: int) -> list[Sheet]:
    """Columns in as many tables as lines of `room` characters ask, each with the `first` ones."""

    def width(column: Column) -> int:
        return GAP + max(cell_len(line) for text in (column[0], *column[1]) for line in text.split("\n"))

    sheets = []
    columns = list(columns)[::-1]
    while columns:
        heads, block = [head for head, _ in first], [cells for _, cells in first]
        left = room + GAP - sum(map(width, first))
        while columns:
            left -= width(columns[-1])
            if left < 0 and len(block) > len(first):
                break
            head, cells = columns.pop()
            heads.append(head)
            block.append(cells)
        everywhere = frozenset(range(len(heads)))
        sheets.append(Sheet(tuple(heads), tuple(zip(*block, strict=True)), everywhere))
    return sheets


def _dimension_sheet(linkage: Loop, *, exact: bool) -> Sheet:
    """The rows as written, one a link, to the last digit if `exact`; a joint's own value is no dimension."""
    digits = (lambda number: f"{number!r}".removesuffix(".0")) if exact else "{:.6g}".format
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
    selected = [key for key in columns if numbers[key]]
    rows = []
    for place, joint in enumerate(linkage.joints, start=1):
        own = {"angle": "angle_deg"}.get(joint.row.moving_key, "offset")
        cells = [
            digits(numbers[key][place]) if place in numbers[key] else say("moves") if key == own else "-"
            for key in selected
        ]
        named = f"{joint.kind} {joint.name}"
        if place == linkage.graph.ground:
            named = say("{joint} (ground)", joint=named)
        rows.append((f"{place}", named, *cells))
    heads = (say("link"), say("joint before it"), *(columns[key] for key in selected))
    return Sheet(heads, tuple(rows), frozenset(range(len(heads))) - {1})


def circuit_facts(motion: Motion, circuit: Circuit, *, brief: bool = False) -> list[tuple[str, str]]:
    """What the report has of one circuit: names, and values each "@" the input where it is met.

    In `brief` its motion type and its ranges.
    """
    lines = _lines(cells_of(motion, "list", in_brief=brief, circuits=(circuit,)))
    return [(label, cells[0]) for label, cells in lines if cells[0] not in nothing()]


def _lines(reported: Sequence[Reported]) -> list[tuple[str, Texts]]:
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
    lines = _lines(cells_of(motion, "list"))
    if len(motion.circuits) == 1:
        return [_list(motion, [say("circuit {number}", number=0)], lines)]
    shared = [(label, cells[:1]) for label, cells in lines if len(set(cells)) == 1]
    own = [(label, cells) for label, cells in lines if len(set(cells)) > 1]
    width = max(cell_len(label) for label, _ in lines)
    names = [say("circuit {number}", number=circuit.index) for circuit in motion]
    parts = (([say("both circuits")], shared), (names, own))
    return [_list(motion, heads, part, width) for heads, part in parts if part]


def _compared(motion: Motion, width: int) -> list[Sheet]:
    """What all circuits share, then one table: a row for each circuit, those that agree in one row."""
    reported = cells_of(motion, "table")
    shared = [
        (quantity.label(), (quantity.between.join(cells[0]),)) for quantity, cells in reported if _same(cells)
    ]
    own = [(quantity, cells) for quantity, cells in reported if not _same(cells)]
    sheets = [_list(motion, [say("every circuit")], shared)] if shared else []
    if own:
        table = _comparison(motion, own)
        if width_of(table) > width:
            table = _comparison(motion, [part for part in own if not part[0].spare])
        if width_of(table) > width:
            rows = tuple(tuple(cell.replace(" @ ", "\n@ ") for cell in row) for row in table.rows)
            table = replace(table, rows=rows)
        sheets += _parted(table, width)
    return sheets


def _parted(table: Sheet, width: int) -> list[Sheet]:
    """A table, or several with its first column each where lines of `width` characters would break words."""

    def in_lines(head: str, cells: Sequence[str]) -> Column:
        widest = max(cell_len(part) for text in (*head.split(), *cells) for part in text.split("\n"))
        return "\n".join(wrap(head, widest, break_long_words=False)), list(cells)

    first, *columns = zip(table.heads, zip(*table.rows, strict=True), strict=True)
    words = [
        [*head.split(), *(part for cell in cells for part in _unbroken(cell))] for head, cells in columns
    ]
    if cell_len(first[0]) + sum(GAP + max(map(cell_len, parts)) for parts in words) <= width:
        return [table]
    sheets = wide_sheets([in_lines(*first)], [in_lines(*column) for column in columns], width)
    parts = [replace(sheet, right=table.right) for sheet in sheets]
    return [*parts[:-1], replace(parts[-1], note=table.note)]


def _unbroken(cell: str) -> list[str]:
    """What of a cell stays in one line: its words, and each place with the sign before it."""
    return cell.replace("@ ", "@_").split()


def _comparison(motion: Motion, reported: Sequence[Reported]) -> Sheet:
    alike: dict[Texts, list[str]] = {}
    for circuit in motion:
        row = tuple("\n".join(cells[circuit.index]) for _, cells in reported)
        alike.setdefault(row, []).append(str(circuit.index))
    rows = tuple((", ".join(indices), *row) for row, indices in alike.items())
    heads = (say("circuit"), *(quantity.head for quantity, _ in reported))
    notes = []
    if any(quantity.role.endswith("range") for quantity, _ in reported):
        closed = all(circuit.closed for circuit in motion)
        notes.append(
            say("the ends of a range are dead centres")
            if closed
            else say("the ends of a range are dead centres where the circuit closes")
        )
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
