"""What a motion comes to: one object for programs, a page of text for people, a folder of files to keep.

A report only writes down what the motion holds; it solves nothing.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.errors import RequestError, shown
from sevenbar.folder import draw, fill_folder, write_csv, write_figures
from sevenbar.linkage import Linkage
from sevenbar.mobility import Mobility
from sevenbar.motion import Circuit, DeadCentre, Extremes, Modes, Motion
from sevenbar.units import ANGLES, LENGTHS

__all__ = [
    "as_dict",
    "as_json",
    "joint_value",
    "modes_json",
    "print_modes",
    "print_text",
    "text",
    "without_nan",
    "write",
    "write_figures",
]


def as_dict(motion: Motion) -> dict[str, Any]:
    """The report as plain values: angles in radians, lengths in the linkage's unit, null beside a status.

    Values of a sliding input or output are lengths; `linkage.columns` tells which slide.
    """
    linkage = motion.linkage
    report = {
        "format": 1,
        "linkage": {
            "name": linkage.name,
            "kind": linkage.kind,
            "joints": [{"name": joint.name, "kind": joint.kind} for joint in linkage.joints],
            "columns": [
                {"name": name, "kind": kind}
                for name, kind in zip(linkage.columns, linkage.column_kinds, strict=True)
            ],
            "dimensions": dict(linkage.dimensions),
            "lengths": _side_lengths(linkage),
        },
        "units": {"length": linkage.length_unit, "angle": "rad", "time": "s"},
        "drive": {
            "input": motion.input,
            "output": motion.output,
            "speed": motion.speed,
            "law": motion.law is not None,
        },
        "samples": motion.samples,
        "motion_type": motion.motion_type,
        "limits": motion.limits.tolist(),
        "change_points": motion.change_points.tolist(),
        "mobility": {
            "gruebler": motion.mobility.gruebler,
            "freedoms": motion.mobility.freedoms,
            "rank": motion.mobility.rank,
            "finite": motion.mobility.finite,
        },
        "completeness": motion.completeness,
        "established": motion.established,
        "circuits": [_circuit_dict(circuit) for circuit in motion.circuits],
        "idle": list(motion.idle),
        "redundant": list(motion.redundant),
    }
    return without_nan(report)  # type: ignore[no-any-return]


def _side_lengths(linkage: Linkage) -> dict[str, float]:
    """Crank, coupler and rocker of an RSSR."""
    if linkage.kind != "RSSR":
        return {}
    return dict(zip(("crank", "coupler", "rocker"), linkage.lengths, strict=True))


def _circuit_dict(circuit: Circuit) -> dict[str, Any]:
    unbounded = "unbounded" if circuit.input_range is not None else "change-point"
    return {
        "motion_type": circuit.motion_type,
        "closed": circuit.closed,
        "turns": circuit.turns,
        "rows": len(circuit.time),
        "statuses": {
            str(word): int(count)
            for word, count in zip(*np.unique(circuit.status, return_counts=True), strict=True)
        },
        "input_range": circuit.input_range,
        "output_range": circuit.output_range,
        "dead_centres": [vars(d) for d in circuit.dead_centres],
        "residual_max": _residual(circuit),
        "swing": circuit.swing,
        "time_ratio": circuit.time_ratio,
        "transmission": _extremes_dict(circuit.transmission, "not-defined"),
        "extremes": {
            "angle": _extremes_dict(
                circuit.angle, "turns-fully" if circuit.output_range is None else "not-defined"
            ),
            "velocity": _extremes_dict(circuit.velocity, unbounded),
            "acceleration": _extremes_dict(circuit.acceleration, unbounded),
        },
    }


def _extremes_dict(extremes: Extremes | None, otherwise: str) -> dict[str, Any]:
    if extremes is None:
        return {"status": otherwise, "lowest": None, "lowest_at": None, "highest": None, "highest_at": None}
    return {"status": "ok", **vars(extremes)}


def _residual(circuit: Circuit) -> float:
    return float(np.nanmax(circuit.residual)) if np.isfinite(circuit.residual).any() else math.nan


def without_nan(value: Any) -> Any:
    """Plain values with null in place of each number that is not finite, as JSON needs it."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: without_nan(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(v) for v in value]
    return value


def as_json(motion: Motion) -> str:
    """`as_dict` as JSON text."""
    return json.dumps(as_dict(motion), indent=2, allow_nan=False)


def text(motion: Motion) -> RenderableType:
    """The report for people, to be printed by rich; angles in degrees."""
    linkage = motion.linkage
    unit = linkage.length_unit
    facts = Table.grid(padding=(0, 2))
    facts.add_column(style="dim")
    facts.add_column()
    facts.add_row("loop", " ".join(f"{j.kind} {j.name}" for j in linkage.joints))
    rows = _in_rows(linkage)
    numbers = {} if rows else dict(linkage.dimensions) or dict(_side_lengths(linkage).items())
    if numbers:
        facts.add_row(
            "dimensions", "  ".join(f"{key} = {value:.6g}" for key, value in numbers.items()) + f"  [{unit}]"
        )
    drive = "an input law" if motion.law is not None else f"{motion.speed:.6g} {_units(motion)[0]}/s"
    facts.add_row("drive", f"{motion.input} at {drive}, output {motion.output}")
    facts.add_row("motion type", Text(motion.motion_type, style="bold"))
    meaning = _meaning(motion)
    if meaning:
        facts.add_row("", meaning)
    facts.add_row("circuits", _circuit_count(motion))
    if motion.circuits or motion.limits.size:
        show = _shown_input(motion)
        facts.add_row("input limits", "  ".join(show(x) for x in motion.limits) or _no_limits(motion))
    if motion.change_points.size:
        where = "  ".join(_degrees(x) for x in motion.change_points)
        facts.add_row(
            "change point",
            f"input {where}: two limits lie within 1e-6 rad; the least change of a dimension decides",
        )
    facts.add_row("completeness", f"{motion.completeness}: {COMPLETE[motion.completeness]}")
    if motion.completeness != "closed-form":
        facts.add_row("established", motion.established)
        facts.add_row("mobility", _mobility(motion.mobility))
    if motion.idle or motion.completeness == "closed-form":
        facts.add_row("idle freedom", "; ".join(motion.idle) + ", held by convention")
    facts.add_row("redundant", "; ".join(motion.redundant) or "no constraints")
    parts: list[RenderableType] = [Text(linkage.name, style="bold underline"), facts]
    if rows:
        parts += [Text(), _dimension_table(linkage)]
    if len(motion.circuits) > MOST_COLUMNS:
        parts += [part for table in _circuit_rows(motion) for part in (Text(), table)]
    elif motion.circuits:
        parts += [Text(), _circuit_table(motion)]
    return Group(*parts)


#: With more circuits than these a line of the report holds one circuit, not one quantity.
MOST_COLUMNS = 2


#: What each word for completeness means.
COMPLETE = {
    "closed-form": "all modes are found",
    "algebraic": "all modes are found",
    "searched": "the modes that a search from many starts found; there may be others",
}


def _units(motion: Motion) -> tuple[str, str]:
    """The units of the input and of the output as their rates are given: rad or a length."""
    linkage = motion.linkage
    kinds = dict(zip(linkage.columns, linkage.column_kinds, strict=True))
    first, second = (
        "rad" if kinds[c] == "turn" else linkage.length_unit for c in (motion.input, motion.output)
    )
    return first, second


def _in_rows(linkage: Linkage) -> bool:
    """Whether the linkage was written in Denavit-Hartenberg rows."""
    return "twist_1_deg" in linkage.dimensions


def _dimension_table(linkage: Linkage) -> Table:
    """The rows as they were written, one a link; a joint's own value is none of the dimensions."""
    unit = linkage.length_unit
    columns = {
        "length": f"length \\[{unit}]",
        "offset": f"offset \\[{unit}]",
        "twist_deg": "twist \\[deg]",
        "angle_deg": "angle \\[deg]",
        "pitch": f"pitch \\[{unit}/turn]",
    }
    numbers: dict[str, dict[int, float]] = {key: {} for key in columns}
    for key, value in linkage.dimensions.items():
        word, row, *rest = key.split("_")
        numbers["_".join([word, *rest])][int(row)] = value
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column("link", justify="right")
    table.add_column("joint before it")
    kept = [key for key in columns if numbers[key]]
    for key in kept:
        table.add_column(columns[key], justify="right")
    for place, joint in enumerate(linkage.joints, start=1):
        own = "offset" if joint.kind == "P" else "angle_deg"
        cells = [
            f"{numbers[key][place]:.6g}" if place in numbers[key] else "moves" if key == own else "-"
            for key in kept
        ]
        ground = " (ground)" if place == len(linkage.joints) else ""
        table.add_row(f"{place}", f"{joint.kind} {joint.name}{ground}", *cells)
    return table


def _meaning(motion: Motion) -> str:
    """A sentence on a motion type that is not a pair of words for input and output."""
    mobility = motion.mobility
    match motion.motion_type:
        case "two-inputs":
            return (
                f"the loop moves with {mobility.finite} freedoms, so one input does not determine it: "
                "drive or lock another joint"
            )
        case "rigid":
            return (
                f"the loop closes but cannot move: the closure takes all of its {mobility.freedoms} freedoms"
            )
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
        return "none: it closes only at the change point" if motion.change_points.size else "none"
    ways = {
        "{} after one turn of the input": sum(c.closed and c.turns == 1 for c in motion),
        "{} after two turns of the input": sum(c.closed and c.turns == 2 for c in motion),
        "{} forth and back": sum(c.closed and c.turns == 0 for c in motion),
        "{} not known to close": sum(not c.closed for c in motion),
    }
    found = {way: count for way, count in ways.items() if count}
    total = len(motion.circuits)

    def told(way: str, who: str, many: bool) -> str:
        verb = ("go" if many else "goes") if "forth" in way else ("are" if many else "is")
        if "after" in way:
            verb = "close" if many else "closes"
        return f"{who} {way.format(verb)}"

    if len(found) == 1:
        return f"{total}, {told(next(iter(found)), 'each' if total > 1 else 'it', False)}"
    return f"{total}: " + ", ".join(told(way, str(count), count > 1) for way, count in found.items())


Row = tuple[str, Callable[[Circuit], str]]


def _plain_rows(motion: Motion) -> list[Row]:
    output = motion.output
    place, result = _shown_input(motion), _shown_output(motion)
    rows: list[Row] = [
        ("motion type", lambda c: c.motion_type),
        (f"range of {motion.input}", lambda c: _range(c.input_range, place)),
        (f"range of {output}", lambda c: _range(c.output_range, result)),
        (f"swing of {output}", lambda c: "full turns" if c.swing is None else result(c.swing)),
        ("time ratio", lambda c: "-" if c.time_ratio is None else f"{c.time_ratio:.6g}"),
    ]
    if any(circuit.transmission is not None for circuit in motion):
        rows += [
            ("transmission angle min", lambda c: _transmission(c, "lowest")),
            ("transmission angle max", lambda c: _transmission(c, "highest")),
        ]
    return rows


def _extreme_rows(motion: Motion) -> list[tuple[Row, Row]]:
    """The least and the greatest of the output's position, velocity and acceleration."""
    unit = _units(motion)[1]
    quantities: list[tuple[str, str, Callable[[Circuit], Extremes | None]]] = [
        ("angle" if unit == "rad" else "position", unit, lambda c: c.angle),
        ("velocity", f"{unit}/s", lambda c: c.velocity),
        ("acceleration", f"{unit}/s\u00b2", lambda c: c.acceleration),
    ]
    return [
        (
            (f"{motion.output} {name} min \\[{unit}]", _extreme_cell(motion, name, pick, "lowest")),
            (f"{motion.output} {name} max \\[{unit}]", _extreme_cell(motion, name, pick, "highest")),
        )
        for name, unit, pick in quantities
    ]


def _last_rows(motion: Motion) -> list[Row]:
    show = _shown_input(motion)
    return [
        ("dead centres of the input", lambda c: _dead_centres(c, "input", show)),
        ("dead centres of the output", lambda c: _dead_centres(c, "output", show)),
        (f"closure error max \\[{motion.linkage.length_unit}]", lambda c: f"{_residual(c):.1e}"),
    ]


def _circuit_table(motion: Motion) -> Table:
    """A line for each quantity, a column for each circuit."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column(_where(motion), overflow="fold")
    for circuit in motion.circuits:
        table.add_column(f"circuit {circuit.index}", overflow="fold")
    extremes = [row for pair in _extreme_rows(motion) for row in pair]
    for label, cell in [*_plain_rows(motion), *extremes, *_last_rows(motion)]:
        table.add_row(label, *(cell(circuit) for circuit in motion.circuits))
    return table


def _where(motion: Motion) -> str:
    return f"value @ {'angle' if _units(motion)[0] == 'rad' else 'position'} of {motion.input}"


def _circuit_rows(motion: Motion) -> list[Table]:
    """A line for each circuit, in tables narrow enough for a page."""
    first, ranges, others = _plain_rows(motion)[0], _plain_rows(motion)[1:3], _plain_rows(motion)[3:]
    last = _last_rows(motion)
    pairs: list[Sequence[Row]] = [*_extreme_rows(motion)]
    tables = [
        _table_of(motion, [first, *ranges]),
        _table_of(motion, _telling(motion, [*others, *last])),
        *(_table_of(motion, _telling(motion, pair)) for pair in pairs),
    ]
    return [table for table in tables if len(table.columns) > 1]


def _telling(motion: Motion, rows: Sequence[Row]) -> list[Row]:
    """The rows that say more of some circuit than its motion type does."""
    return [row for row in rows if {row[1](c) for c in motion} - {"full turns", "turns fully", "none", "-"}]


def _table_of(motion: Motion, rows: Sequence[Row]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column("circuit", justify="right")
    for label, _ in rows:
        table.add_column(label, overflow="fold")
    for circuit in motion:
        table.add_row(str(circuit.index), *(cell(circuit) for _, cell in rows))
    return table


def _extreme_cell(
    motion: Motion, name: str, pick: Callable[[Circuit], Extremes | None], end: str
) -> Callable[[Circuit], str]:
    show = _shown_input(motion)

    def cell(circuit: Circuit) -> str:
        extremes = pick(circuit)
        if extremes is not None:
            return _at(f"{getattr(extremes, end):.6g}", show(getattr(extremes, f"{end}_at"), whole=True))
        if name in ("angle", "position"):
            return "turns fully" if circuit.output_range is None else "not defined"
        return "no bound at limits" if circuit.input_range else "change point"

    return cell


def _transmission(circuit: Circuit, end: str) -> str:
    extremes = circuit.transmission
    if extremes is None:
        return "not defined"
    return _at(_degrees(getattr(extremes, end)), _degrees(getattr(extremes, f"{end}_at") % math.tau))


#: Dead centres told in one cell; an output that rests has no end of them.
MOST_DEAD_CENTRES = 8


class _Shown:
    """How a joint's value is written: an angle in degrees, a slide in the length unit."""

    def __init__(self, unit: str) -> None:
        self._unit = unit

    def __call__(self, value: float, *, whole: bool = False) -> str:
        """The value with its unit; `whole` takes an angle into [0, 360)."""
        if self._unit != "rad":
            return f"{value:.6g} {self._unit}"
        return _degrees(value % math.tau if whole else value)


def _shown_input(motion: Motion) -> _Shown:
    return _Shown(_units(motion)[0])


def _shown_output(motion: Motion) -> _Shown:
    return _Shown(_units(motion)[1])


def _dead_centres(circuit: Circuit, kind: str, show: _Shown) -> str:
    found: Sequence[DeadCentre] = [d for d in circuit.dead_centres if d.kind == kind]
    told = [show(d.input, whole=True) for d in found[:MOST_DEAD_CENTRES]]
    if len(found) > MOST_DEAD_CENTRES:
        told.append(f"and {len(found) - MOST_DEAD_CENTRES} more")
    return ", ".join(told) or "none"


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.3f}\u00b0"


def _range(ends: tuple[float, float] | None, show: _Shown) -> str:
    return "full turns" if ends is None else f"{show(ends[0])} to {show(ends[1])}"


def _at(value: str, place: str) -> str:
    return f"{value} @ {place}"


def print_text(motion: Motion, console: Console | None = None) -> None:
    """Prints the report for people."""
    (console or Console()).print(text(motion))


def write(motion: Motion, folder: str | os.PathLike[str], figures: Sequence[str] = ("png",)) -> list[Path]:
    """Writes report.json, motion.csv and the figures into a folder, made if need be; returns their paths.

    The figures are configuration and motion; but for an RSSR, whose curves tell all, also joints, and
    path_<name> for each named point. All files are finished in a folder beside it before the first is put
    in place. Raises `OutputError` where that cannot be done.
    """

    def fill(staging: Path) -> None:
        (staging / "report.json").write_text(as_json(motion) + "\n", encoding="utf-8")
        write_csv(motion, staging / "motion.csv")
        if motion.circuits:
            general = motion.linkage.kind != "RSSR"
            kinds = ["configuration", "curves", *(["joints", "point"] if general else [])]
            points = {point.name: (point.link, point.at) for point in motion.linkage.points}
            draw(motion, staging, kinds, points, 0, figures)

    return fill_folder(Path(folder), fill)


def joint_value(text: str, key: str, linkage: Linkage, column: int) -> float:
    """The value of a joint [rad, or length] as people write it: "30deg", "0.5rad", "12mm".

    A plain number is in degrees for a turn and in the length unit for a slide. Raises `RequestError`.
    """
    slides = linkage.column_kinds[column] == "slide"
    # every length is a whole number of micrometres, so the quotient of two is right to the last digit
    own = LENGTHS[linkage.length_unit] * 1e6
    sizes = {unit: round(size * 1e6) / round(own) for unit, size in LENGTHS.items()} if slides else ANGLES
    plain = linkage.length_unit if slides else "deg"
    match = re.fullmatch(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\W\d]*)\s*", text)
    unit = (match[2] or plain) if match else ""
    if match is None or unit not in sizes or not math.isfinite(float(match[1])):
        kind = "slides" if slides else "turns"
        hint = f"12 or 12{plain}" if slides else "30, 30deg or 0.5rad"
        raise RequestError(
            f"{key}: {shown(text)} is no value of {linkage.columns[column]}, which {kind}; give {hint}"
        )
    return float(match[1]) * sizes[unit]


def modes_json(linkage: Linkage, modes: Modes, column: int) -> str:
    """All assembly modes as JSON text: angles in radians, lengths in the linkage's unit."""
    report = {
        "format": 1,
        "linkage": {"name": linkage.name, "kind": linkage.kind},
        "units": {"length": linkage.length_unit, "angle": "rad"},
        "input": {"joint": linkage.columns[column], "value": modes.input},
        "completeness": modes.completeness,
        "count": len(modes),
        "columns": [
            {"name": name, "kind": kind}
            for name, kind in zip(linkage.columns, linkage.column_kinds, strict=True)
        ],
        "modes": [
            {"q": q.tolist(), "residual": float(residual)}
            for q, residual in zip(modes.q, modes.residual, strict=True)
        ],
    }
    return json.dumps(without_nan(report), indent=2, allow_nan=False)


def print_modes(linkage: Linkage, modes: Modes, column: int, console: Console | None = None) -> None:
    """Prints a table of all assembly modes, one row a mode; angles in degrees."""
    console = console or Console()
    unit, kinds = linkage.length_unit, linkage.column_kinds
    value = _Shown("rad" if kinds[column] == "turn" else unit)(modes.input)
    console.print(Text(linkage.name, style="bold underline"))
    count = len(modes)
    console.print(
        f"{count or 'no'} assembly mode{'s' * (count != 1)} at {linkage.columns[column]} = {value}, "
        f"{modes.completeness}: {COMPLETE[modes.completeness]}",
        highlight=False,
    )
    if not count:
        return
    columns = [("residual", f"\\[{unit}]", [f"{residual:.1e}" for residual in modes.residual])]
    for name, kind, q in reversed(list(zip(linkage.columns, kinds, modes.q.T, strict=True))):
        numbers = np.round(np.degrees(q) if kind == "turn" else q, 3) + 0.0  # no -0
        cells = [f"{x:.3f}" for x in numbers]
        columns.append((name, "\\[deg]" if kind == "turn" else f"\\[{unit}]", cells))
    while columns:
        table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
        table.add_column("mode", justify="right")
        block = [[f"{i}" for i in range(count)]]
        room = console.width - 4
        while columns:
            name, head, cells = columns[-1]
            room -= 3 + max(len(name), *(len(cell) for cell in cells))
            if room < 0 and len(block) > 1:
                break
            columns.pop()
            table.add_column(f"{name}\n{head}", justify="right", no_wrap=True)
            block.append(cells)
        for row in zip(*block, strict=True):
            table.add_row(*row)
        console.print()
        console.print(table)
