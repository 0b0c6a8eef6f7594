"""The result of a motion, in words and tables for people; what circuits share is said once."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from sevenbar.description.angle_doubts import angle_doubt
from sevenbar.kinematics.circuits import Circuit, DeadCentre, Extremes
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.mobility import Mobility
from sevenbar.kinematics.motion import Modes, Motion, Solvable
from sevenbar.reporting.four_bar_text import grashof_text, links_text
from sevenbar.reporting.how_found import how_found
from sevenbar.reporting.page import drive_text
from sevenbar.reporting.shown import Shown, degrees, plain

#: With more circuits than these a line of the table holds one circuit, not one quantity.
MOST_COLUMNS = 2

#: Dead centres told in one cell; an output that rests has no end of them.
MOST_DEAD_CENTRES = 8

#: Limits of the input that are listed.
MOST_LIMITS = 8

#: Characters between two columns in print.
GAP = 2

#: What each word for completeness means.
COMPLETE = {
    "closed-form": "all modes are found",
    "counted": "all modes and all circuits are found",
    "algebraic": "all modes are found",
    "searched": "the modes that a search from many starts found; there may be others",
}

#: What a cell says where there is nothing to tell.
NOTHING = ("-", "none")


Texts = tuple[str, ...]

#: Between the ends of a range.
RANGE = " to "


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


def summary(motion: Motion, room: int = 100) -> Summary:
    """All that the report tells people of a motion, in lines of `room` characters if that can be.

    Angles are in degrees, rates in radians.
    """
    linkage = motion.linkage
    # of an overconstrained loop the last digits decide
    exact = bool(motion.redundant)
    sheets = [_dimension_sheet(linkage, exact=exact)] if linkage.form == "rows" else []
    if len(motion.circuits) > MOST_COLUMNS:
        sheets += _compared(motion, room)
    elif motion.circuits:
        sheets += _side_by_side(motion)
    return Summary(linkage.heading, tuple(facts_of(motion)), tuple(sheets))


def modes_sheets(linkage: Loop, modes: Modes, room: int) -> list[Sheet]:
    """All assembly modes, one row a mode, in tables of at most `room` characters a line."""
    unit = linkage.length_unit
    count = len(modes)
    columns = [(f"residual\n[{unit}]", [f"{residual:.1e}" for residual in modes.residual])]
    for name, kind, q in reversed(list(zip(linkage.columns, linkage.column_kinds, modes.q.T, strict=True))):
        numbers = np.round(np.degrees(q) if kind == "turn" else q, 3) + 0.0  # no -0
        head = f"{name}\n[{'deg' if kind == 'turn' else unit}]"
        columns.append((head, [f"{x:.3f}" for x in numbers]))
    sheets = []
    while columns:
        heads, block = ["mode"], [[f"{i}" for i in range(count)]]
        left = room - len("mode")
        while columns:
            head, cells = columns[-1]
            left -= GAP + max(len(text) for text in [*head.split("\n"), *cells])
            if left < 0 and len(block) > 1:
                break
            columns.pop()
            heads.append(head)
            block.append(cells)
        everywhere = frozenset(range(len(heads)))
        sheets.append(Sheet(tuple(heads), tuple(zip(*block, strict=True)), everywhere))
    return sheets


def joint_text(linkage: Loop, column: int, value: float) -> str:
    """A joint's value with its unit."""
    return Shown("rad" if linkage.column_kinds[column] == "turn" else linkage.length_unit)(value)


def side_lengths(linkage: Solvable) -> dict[str, float]:
    """Crank, coupler and rocker of an RSSR."""
    if linkage.kind != "RSSR":
        return {}
    return dict(zip(("crank", "coupler", "rocker"), linkage.lengths, strict=True))


def closure_error(circuits: Iterable[Circuit]) -> float:
    """The greatest closure error [length]; NaN where no row has one."""
    residuals = [circuit.tally.residual for circuit in circuits]
    return max((worst for worst in residuals if not math.isnan(worst)), default=math.nan)


def facts_of(motion: Motion) -> list[tuple[str, str]]:
    """What the report tells of the motion as a whole: names and words."""
    linkage = motion.linkage
    facts = [("loop", joints_text(linkage))]
    if linkage.form == "rows":
        before = f"link {len(linkage.joints) - 1}" if len(linkage.joints) > 2 else "the link before it"
        facts.append(("last joint", f"{linkage.joints[-1].name} counts the ground relative to {before}"))
    if numbers := dimensions_text(linkage):
        facts.append(("dimensions", numbers))
    if bar := motion.four_bar:
        facts.append(("links", links_text(bar, linkage.length_unit)))
        facts.append(("Grashof", grashof_text(bar, linkage.length_unit)))
    if doubt := angle_doubt(linkage.description):
        facts.append(("angles", doubt))
    speed = motion.speed if motion.law is None else None
    unit, written = _units(motion)[0], motion.speed_written
    facts.append(("drive", drive_text(motion.input, speed, unit, motion.output, written=written)))
    if motion.law is not None:
        t = motion.law.t
        rows = f"{t.size} row{'s' * (t.size != 1)} from {t[0]:.6g} s to {t[-1]:.6g} s"
        facts.append(("law", f"{rows}; extremes of velocity and acceleration are those of its rows"))
    facts.append(("motion type", motion.motion_type))
    if told := meaning(motion):
        facts.append(("", told))
    if near := nearly_moves(motion):
        facts.append(("nearly moves", near))
    facts.append(("circuits", _circuit_count(motion)))
    if motion.circuits or motion.limits.size:
        facts.append(("input limits", _limits_text(motion)))
    facts.extend(_change_points(motion))
    facts.append(("completeness", f"{motion.completeness}: {COMPLETE[motion.completeness]}"))
    if motion.completeness != "closed-form":
        facts.append(("how found", how_found(motion)))
        facts.append(("mobility", _mobility(motion.mobility)))
    if motion.idle:
        facts.append(("idle freedom", "; ".join(motion.idle) + ", held by convention"))
    facts.append(("redundant", "; ".join(motion.redundant) or "no constraints"))
    if motion.circuits:
        facts.append(("closure error", f"at most {closure_error(motion):.1e} {linkage.length_unit}"))
    return facts


def _limits_text(motion: Motion) -> str:
    """The input's limits; of many no more than their number, since the tables have them by circuit."""
    if motion.limits.size > MOST_LIMITS:
        return f"{motion.limits.size}, by circuit in the table below"
    show = Shown(_units(motion)[0])
    return "  ".join(show(x) for x in motion.limits) or _no_limits(motion)


def joints_text(linkage: Loop) -> str:
    """The joints in loop order: kinds and names."""
    return "  ".join(f"{joint.kind} {joint.name}" for joint in linkage.joints)


def dimensions_text(linkage: Solvable) -> str:
    """The dimensions by name; nothing of Denavit-Hartenberg rows, which want a table."""
    numbers = {} if linkage.form == "rows" else dict(linkage.dimensions) or side_lengths(linkage)
    told = "  ".join(f"{key} = {value:.6g}" for key, value in numbers.items())
    return f"{told}  [{linkage.length_unit}]" if told else ""


def speed_text(linkage: Loop, input: str, speed: float) -> str:
    """The speed at which a joint drives."""
    turns = linkage.column_kinds[linkage.columns.index(input)] == "turn"
    return f"at {speed:.6g} {'rad' if turns else linkage.length_unit}/s"


def _change_points(motion: Motion) -> list[tuple[str, str]]:
    """Lines for the poses at which branches meet, and for those that stand alone."""
    show = Shown(_units(motion)[0])
    lines = []
    meeting = [point for point in motion.change_points if not point.isolated]
    if meeting:
        where = "  ".join(show(x) for x in motion.change_point_inputs)
        what = "branches meet there; the least change of a dimension decides how it goes on"
        lines.append(("change point", f"input {where}: {what}"))
    free = max((point.freedoms for point in meeting), default=0)
    if free > 1:
        lines.append(("", f"there it can also move with {free} freedoms, which no circuit shows"))
    alone = [show(point.input) for point in motion.change_points if point.isolated]
    if alone:
        lines.append(("isolated pose", f"input {'  '.join(alone)}: no motion leads out of it"))
    return lines


def _units(motion: Motion) -> tuple[str, str]:
    """The units of the input and of the output as their rates are given: rad or a length."""
    linkage = motion.linkage
    kinds = dict(zip(linkage.columns, linkage.column_kinds, strict=True))
    first, second = (
        "rad" if kinds[c] == "turn" else linkage.length_unit for c in (motion.input, motion.output)
    )
    return first, second


def _dimension_sheet(linkage: Loop, *, exact: bool) -> Sheet:
    """The rows as written, one a link, to the last digit if `exact`; a joint's own value is no dimension."""
    digits = _every_digit if exact else "{:.6g}".format
    unit = linkage.length_unit
    columns = {
        "length": f"length [{unit}]",
        "offset": f"offset [{unit}]",
        "twist_deg": "twist [deg]",
        "angle_deg": "angle [deg]",
        "pitch": f"pitch [{unit}/turn]",
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
            digits(numbers[key][place]) if place in numbers[key] else "moves" if key == own else "-"
            for key in kept
        ]
        ground = " (ground)" if place == len(linkage.joints) else ""
        rows.append((f"{place}", f"{joint.kind} {joint.name}{ground}", *cells))
    heads = ("link", "joint before it", *(columns[key] for key in kept))
    return Sheet(heads, tuple(rows), frozenset(range(len(heads))) - {1})


def _every_digit(number: float) -> str:
    return f"{number!r}".removesuffix(".0")


def nearly_moves(motion: Motion) -> str:
    """By how little a linkage without a circuit misses a motion; empty where it moves, or misses more."""
    near = motion.near_motion
    if near is None:
        return ""
    return (
        f"as a {near.motion_type}: redundant constraints miss by up to {near.share:.1e} of the size "
        f"({near.miss:.2g} {motion.linkage.length_unit}), or as many rad; --agree {near.agree:.0e} takes "
        "them to agree"
    )


def meaning(motion: Motion) -> str:
    """A sentence on a motion type that is not a pair of words for input and output."""
    match motion.motion_type:
        case "two-inputs":
            return (
                f"the loop moves with {motion.mobility.finite} freedoms, so one input does not determine it: "
                "lock a joint (leave it out)"
            )
        case "rigid":
            taken = motion.mobility.freedoms
            return f"the loop closes but cannot move: closing it removes all of its {taken} freedoms"
        case "cannot-assemble" if motion.linkage.kind == "RSSR":
            return "no input closes the loop: the coupler is too short or too long"
        case "cannot-assemble":
            return "no values of the joints were found that close the loop"
        case "change-point":
            return "the motion runs through a pose from which it can go on in more than one way"
        case "mixed":
            return "the circuits differ; see below"
    return ""


def _mobility(mobility: Mobility) -> str:
    count = f"Gruebler {mobility.freedoms} - 6 = {mobility.gruebler}"
    parts = [count] if mobility.rank is None else [count, f"rank {mobility.rank}"]
    for number, name in (
        (len(mobility.idle), "idle freedom"),
        (len(mobility.redundant), "redundant constraint"),
    ):
        if number:
            parts.append(f"{number} {name}{'s' * (number > 1)}")
    start = "not known, as no pose was found" if mobility.finite is None else f"{mobility.finite}"
    return f"{start} ({', '.join(parts)})"


def _no_limits(motion: Motion) -> str:
    turns = all(circuit.input_range is None for circuit in motion)
    return "none: the input turns fully" if turns else "none found"


def _circuit_count(motion: Motion) -> str:
    if not motion.circuits:
        return "none: it closes only in isolated poses" if motion.change_points else "none"
    turning = sorted({c.turns for c in motion if c.closed and c.turns})
    ways = {
        f"{{}} after {_turns(k)} of the input": sum(c.closed and c.turns == k for c in motion)
        for k in turning
    }
    ways["{} to and fro"] = sum(c.closed and c.turns == 0 for c in motion)
    ways["{} not known to close"] = sum(not c.closed for c in motion)
    found = {way: count for way, count in ways.items() if count}
    total = len(motion.circuits)

    def told(way: str, who: str, many: bool) -> str:
        verb = ("go" if many else "goes") if "fro" in way else ("are" if many else "is")
        if "after" in way:
            verb = "close" if many else "closes"
        return f"{who} {way.format(verb)}"

    if len(found) == 1:
        return f"{total}, {told(next(iter(found)), 'each' if total > 1 else 'it', False)}"
    return f"{total}: " + ", ".join(told(way, str(count), count > 1) for way, count in found.items())


@dataclass(frozen=True)
class _Quantity:
    """What is told of each circuit: one text or more.

    `name` and `unit` are its label in a list, `head` stands above its column. Two texts that are the `ends`
    of something are two lines of a list, min and max; others are one line, joined by `between`. `only`
    keeps it to lists or to tables; a column may be left out where it is `spare` and room is short.
    """

    name: str
    head: str
    cells: Callable[[Circuit], Texts]
    unit: str = ""
    ends: bool = False
    between: str = ", "
    only: Literal["", "list", "table"] = ""
    spare: bool = False

    def label(self, end: str = "") -> str:
        return " ".join(word for word in (self.name, end, self.unit) if word)


def _quantities(motion: Motion) -> list[_Quantity]:
    """All that is told of circuits, in order."""
    first, second = motion.input, motion.output
    in_unit, out_unit = _units(motion)
    place, result = (Shown("rad" if unit == "rad" else "") for unit in (in_unit, out_unit))
    # of a slide the unit is in the label: a line is not broken between a number and its unit
    in_label, out_label = ("" if unit == "rad" else f"[{unit}]" for unit in (in_unit, out_unit))
    in_head, out_head = (f"\n{label}" if label else "" for label in (in_label, out_label))

    def ends(extremes: Extremes | None, show: Callable[[float], str], otherwise: str) -> Texts:
        if extremes is None:
            return (otherwise,)
        pairs = ((extremes.lowest, extremes.lowest_at), (extremes.highest, extremes.highest_at))
        return tuple(f"{show(value)} @ {place(at, whole=True)}" for value, at in pairs)

    def rate(extremes: Extremes | None, circuit: Circuit) -> Texts:
        if motion.law is not None:
            return ends(extremes, plain, "no row within the range")
        return ends(extremes, plain, "change point" if circuit.goes_round else "no bound at limits")

    def range_of(circuit: Circuit, end: int, show: Shown) -> Texts:
        extent = circuit.output_range if end else circuit.input_range
        if extent is not None and words_of(circuit.motion_type)[end] == "spindle":
            return ("without end",)
        if extent is None:
            return ("full turns",)
        # the input is given as its limits are
        return show.range(*extent) if end == 0 else (show(extent[0]), show(extent[1]))

    def way(circuit: Circuit) -> Texts:
        words = (circuit.motion_type,) if motion.motion_type == "mixed" else ()
        return (*words, way_round(circuit)) if len({way_round(c) for c in motion}) > 1 else words or ("-",)

    def swing(circuit: Circuit) -> Texts:
        return ("-",) if circuit.swing is None else (result(circuit.swing),)

    def time_ratio(circuit: Circuit) -> Texts:
        # a ratio of angles, and of times at a constant speed
        return (
            ("-",) if circuit.time_ratio is None or motion.law is not None else (plain(circuit.time_ratio),)
        )

    def reach(circuit: Circuit) -> Texts:
        return ends(circuit.angle, result, "") if circuit.angle else range_of(circuit, 1, result)

    def rate_of(name: str, unit: str, pick: Callable[[Circuit], Extremes | None]) -> _Quantity:
        head = f"{second} {name}\n[{unit}] @ {first}"
        return _Quantity(f"{second} {name}", head, lambda c: rate(pick(c), c), f"[{unit}]", ends=True)

    def stands_still(end: str) -> list[_Quantity]:
        # a table tells the ends of a range as that
        ranged = end == "output" or any(c.input_range is not None for c in motion)
        other = "other " if ranged else ""
        told, others = f"dead centres of the {end}", f"{other}dead centres of the {end}"
        head = f"{other}dead\ncentres of\nthe {end}"
        return [
            _Quantity(told, "", lambda c: _dead_centres(c, end, place), in_label, only="list"),
            _Quantity(others, head, lambda c: _dead_centres(c, end, place, within=True), only="table"),
        ]

    position = "angle" if out_unit == "rad" else "position"
    return [
        _Quantity("motion type", "motion type", way),
        _Quantity(
            f"range of {first}",
            f"range of\n{first}{in_head}",
            lambda c: range_of(c, 0, place),
            in_label,
            between=RANGE,
        ),
        *stands_still("input"),
        _Quantity(
            f"range of {second}", "", lambda c: range_of(c, 1, result), out_label, between=RANGE, only="list"
        ),
        _Quantity(
            f"range of {second}",
            f"range of\n{second} @ {first}{out_head}",
            reach,
            out_label,
            between=RANGE,
            only="table",
        ),
        _Quantity(f"swing of {second}", "", swing, out_label, only="list"),
        *stands_still("output"),
        _Quantity("time ratio", "time\nratio", time_ratio, spare=True),
        _Quantity(
            "transmission angle",
            f"transmission\nangle @ {first}",
            lambda c: ends(c.transmission, degrees, "-"),
            ends=True,
        ),
        _Quantity(
            f"{second} {position}",
            "",
            lambda c: ends(c.angle, plain, "-"),
            f"[{out_unit}]",
            ends=True,
            only="list",
        ),
        rate_of("velocity", f"{out_unit}/s", lambda c: c.velocity),
        rate_of("acceleration", f"{out_unit}/s\u00b2", lambda c: c.acceleration),
    ]


def way_round(circuit: Circuit) -> str:
    """How a circuit closes: after so many turns of the input, to and fro, or not."""
    if not circuit.closed:
        return "open"
    return _turns(circuit.turns) if circuit.turns else "to and fro"


def _turns(count: int) -> str:
    return {1: "one turn", 2: "two turns"}.get(count, f"{count} turns")


def _telling(
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
    told = f"range of {motion.input}"
    return [
        (quantity, cells)
        for quantity, cells in found
        if any(cell[0] not in NOTHING for cell in cells)
        and not (quantity.name == told and set(cells) == {("full turns",)})
    ]


def circuit_facts(motion: Motion, circuit: Circuit, labels: tuple[str, ...] = ("",)) -> list[tuple[str, str]]:
    """What the report has of one circuit: names, and values each "@" the input where it is met.

    Of all, those whose names begin with one of the `labels`.
    """
    told = [(quantity, [cells[circuit.index]]) for quantity, cells in _telling(motion, "list", labels)]
    return [(label, cells[0]) for label, cells in _lines(told) if cells[0] not in NOTHING]


def _lines(told: Sequence[tuple[_Quantity, list[Texts]]]) -> list[tuple[str, Texts]]:
    """Quantities as lines of a list, those with two ends as two lines."""
    lines: list[tuple[str, Texts]] = []
    for quantity, cells in told:
        if quantity.ends and any(len(cell) == 2 for cell in cells):
            lines.append((quantity.label("min"), tuple(cell[0] for cell in cells)))
            lines.append((quantity.label("max"), tuple(cell[-1] for cell in cells)))
        else:
            lines.append((quantity.label(), tuple(quantity.between.join(cell) for cell in cells)))
    return lines


def _side_by_side(motion: Motion) -> list[Sheet]:
    """A line for each quantity: first those that circuits share, then with a column for each circuit."""
    lines = _lines(_telling(motion, "list"))
    if len(motion.circuits) == 1:
        return [_list(motion, ["circuit 0"], lines)]
    shared = [(label, cells[:1]) for label, cells in lines if len(set(cells)) == 1]
    own = [(label, cells) for label, cells in lines if len(set(cells)) > 1]
    width = max(len(label) for label, _ in lines)
    names = [f"circuit {circuit.index}" for circuit in motion]
    parts = ((["both circuits"], shared), (names, own))
    return [_list(motion, heads, part, width) for heads, part in parts if part]


def _compared(motion: Motion, room: int) -> list[Sheet]:
    """What all circuits share, then one table: a row for each circuit, those that agree in one row."""
    told = _telling(motion, "table")
    shared = [
        (quantity.label(), (quantity.between.join(cells[0]),)) for quantity, cells in told if _same(cells)
    ]
    own = [(quantity, cells) for quantity, cells in told if not _same(cells)]
    sheets = [_list(motion, ["every circuit"], shared)] if shared else []
    if own:
        table = _comparison(motion, own)
        if width_of(table) > room:
            table = _comparison(motion, [part for part in own if not part[0].spare])
        if width_of(table) > room:
            rows = tuple(tuple(cell.replace(" @ ", "\n@ ") for cell in row) for row in table.rows)
            table = replace(table, rows=rows)
        sheets.append(table)
    return sheets


def _comparison(motion: Motion, told: Sequence[tuple[_Quantity, list[Texts]]]) -> Sheet:
    alike: dict[Texts, list[str]] = {}
    for circuit in motion:
        row = tuple("\n".join(cells[circuit.index]) for _, cells in told)
        alike.setdefault(row, []).append(str(circuit.index))
    rows = tuple((", ".join(indices), *row) for row, indices in alike.items())
    heads = ("circuit", *(quantity.head for quantity, _ in told))
    notes = []
    if any(head.startswith("range of") for head in heads):
        notes.append("the ends of a range are dead centres")
    if len(rows) < len(motion.circuits):
        notes.append("circuits that agree in all of this share a row")
    return Sheet(heads, rows, frozenset({0}), "; ".join(notes))


def _same(cells: Sequence[Texts]) -> bool:
    return len(set(cells)) == 1


def width_of(sheet: Sheet) -> int:
    """The characters that its longest line takes in print."""
    columns = zip(sheet.heads, *sheet.rows, strict=True)
    widths = [max(len(line) for cell in column for line in cell.split("\n")) for column in columns]
    return sum(widths) + GAP * (len(widths) - 1)


def _list(motion: Motion, names: Sequence[str], lines: Sequence[tuple[str, Texts]], width: int = 0) -> Sheet:
    unit = _units(motion)[0]
    where = f"value @ angle of {motion.input}"
    if unit != "rad":
        where = f"value @ position of {motion.input} [{unit}]"
    return Sheet((where.ljust(width), *names), tuple((label, *cells) for label, cells in lines))


def _dead_centres(circuit: Circuit, kind: str, show: Shown, *, within: bool = False) -> Texts:
    """Where the input or the output stands still; `within`: but for the ends of its range."""
    found: Sequence[DeadCentre] = [d for d in circuit.dead_centres if d.kind == kind]
    if within:
        angle = circuit.angle
        ends = (angle.lowest_at, angle.highest_at) if kind == "output" and angle else ()
        ends = circuit.input_range or () if kind == "input" else ends
        found = [d for d in found if not any(show.same(d.input, end) for end in ends)]
    places = list(dict.fromkeys(show(d.input, whole=True) for d in found))
    more = len(places) - MOST_DEAD_CENTRES
    return (*places[:MOST_DEAD_CENTRES], *([f"and {more} more"] if more > 0 else [])) or ("none",)


def words_of(motion_type: str) -> tuple[str, str]:
    """What input and output are called, read off the motion type of a circuit.

    >>> words_of("double-spindle"), words_of("spindle-slider"), words_of("change-point")
    (('spindle', 'spindle'), ('spindle', 'slider'), ('change', 'point'))
    """
    first, _, second = motion_type.partition("-")
    return (second, second) if first == "double" else (first, second)
