"""The result of a motion: one object for programs, a page of text for people, a folder of files to keep.

A report only writes down what the motion holds; it solves nothing.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joint_text import joint_value
from sevenbar.reporting.extents import extents_dict
from sevenbar.reporting.facts import closure_error, side_lengths
from sevenbar.reporting.figures import FigureLook, posed_circuit, report_figures, write_figures
from sevenbar.reporting.files import Files, LongTable, Report, head_of, json_file, json_text, without_nan
from sevenbar.reporting.force_peaks import peaks_dict
from sevenbar.reporting.how_found import how_found
from sevenbar.text.markdown import escaped, table

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from sevenbar.kinematics.circuits.poses_at import PosesAt

__all__ = [
    "as_dict",
    "as_json",
    "joint_value",
    "json_text",
    "markdown",
    "modes_json",
    "posed_circuit",
    "print_modes",
    "print_text",
    "without_nan",
    "write",
    "write_figures",
]


def as_dict(motion: Motion, *, ranges: bool = False) -> dict[str, Any]:
    """The report as plain values: angles in radians, lengths in the linkage's unit, null beside a status.

    Values of a sliding input or output are lengths; `linkage.columns` says which slide. With `ranges`, and
    where the linkage has stops, circuits have the ranges, bends and distances of their joints and links.

        >>> import sevenbar as sb
        >>> found = as_dict(sb.load("rssr").motion())
        >>> found["motion_type"], len(found["circuits"])
        ('crank-rocker', 2)
    """
    linkage, four_bar, mobility = motion.linkage, motion.four_bar, motion.mobility
    with_extents = ranges or not linkage.stops.is_empty
    report = {
        "format": 1,
        "linkage": {
            "name": linkage.name,
            "kind": linkage.kind,
            "joints": [{"name": joint.name, "kind": joint.kind} for joint in linkage.joints],
            "columns": _columns(linkage),
            "dimensions": dict(linkage.dimensions),
            "lengths": side_lengths(linkage),
            "planar": linkage.is_planar,
            "four_bar": None if four_bar is None else vars(four_bar),
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
        "change_points": [
            {"input": p.input, "q": p.q.tolist(), "circuits": list(p.circuits)}
            | {"ways": p.ways, "freedoms": p.freedoms}
            for p in motion.change_points
        ],
        "mobility": {name: getattr(mobility, name) for name in ("gruebler", "freedoms", "rank", "finite")},
        "completeness": motion.completeness,
        "how_found": how_found(motion),
        "search_bound": motion.search.bound,
        "open_by": motion.search.open_by.tolist(),
        "agree": motion.agree,
        "near_motion": None if motion.near_motion is None else vars(motion.near_motion),
        "reason": None if motion.reason is None else asdict(motion.reason),
        "circuits": [
            _circuit_dict(circuit)
            | (extents_dict(circuit, linkage) if with_extents else {})
            | {"forces": None if linkage.loading.is_empty else peaks_dict(circuit)}
            for circuit in motion.circuits
        ],
        "idle": list(motion.idle),
        "redundant": list(motion.redundant),
    }
    if linkage.net is not None:
        from sevenbar.reporting.net_facts import net_dict

        report["net"] = net_dict(linkage, linkage.input_column(motion.input))
    return without_nan(report)  # type: ignore[no-any-return]


def _columns(linkage: Loop) -> list[dict[str, str]]:
    return [{"name": column.name, "kind": column.kind} for column in linkage.each_column]


def _circuit_dict(circuit: Circuit) -> dict[str, Any]:
    unbounded = "change-point" if circuit.goes_round else "unbounded"
    return {
        "motion_type": circuit.motion_type,
        "closed": circuit.closed,
        "turns": circuit.turns,
        "rows": circuit.tally.rows,
        "statuses": dict(circuit.tally.statuses),
        "input_range": circuit.input_range,
        "output_range": circuit.output_range,
        "dead_centres": [vars(d) for d in circuit.dead_centres],
        "residual_max": closure_error([circuit]),
        "swing": circuit.swing,
        "time_ratio": circuit.time_ratio,
        "transmission": _extremes_dict(circuit.transmission, "not-defined"),
        "mechanical_advantage": _extremes_dict(circuit.advantage, "unbounded"),
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


def as_json(motion: Motion, *, ranges: bool = False) -> str:
    """`as_dict` as JSON text."""
    return json_text(as_dict(motion, ranges=ranges))


def text(motion: Motion, *, ranges: bool = False, short: bool = False) -> RenderableType:
    """The report for people, to be printed by rich; angles in degrees; with `ranges`, or a `short` one."""
    # rich takes a while to load, and JSON does without it
    from sevenbar.reporting.printed import motion_page

    return motion_page(motion, ranges=ranges, short=short)


def print_text(motion: Motion, console: Console | None = None) -> None:
    """Prints the report for people; angles in degrees."""
    motion_report().print(motion, console)


def markdown(motion: Motion, pictures: Sequence[str] = (), *, ranges: bool = False) -> str:
    """The report for people as Markdown, and pictures by their file names; with `ranges` of all joints.

    >>> import sevenbar as sb
    >>> markdown(sb.load("rssr").motion()).splitlines()[0]
    '# RSSR of Sun and Zhou'
    """
    # only text needs it
    from sevenbar.reporting.summary import summary

    page = summary(motion, ranges=ranges)
    parts = [f"# {escaped(page.title)}"]
    parts.append(
        "\n".join(f"- {name}: {escaped(fact)}" if name else f"  {escaped(fact)}" for name, fact in page.facts)
    )
    for sheet in page.sheets:
        heads, *rows = ([escaped(cell.strip()) for cell in line] for line in (sheet.heads, *sheet.rows))
        parts.append(table(heads, rows, right=sheet.right))
        parts += [sheet.note] if sheet.note else []
    parts += [f"![{name.rpartition('.')[0]}]({name})" for name in pictures]
    return "\n\n".join(parts) + "\n"


def motion_report(
    figures: Sequence[str] = ("png",),
    drawn: Callable[[Motion], Motion] = lambda motion: motion,
    *,
    circuit: int | None = None,
    look: FigureLook | None = None,
    ranges: bool = False,
    short: bool = False,
) -> Report[Motion]:
    """How a motion is reported, with the figures in these formats, of a circuit, drawn in a way.

    With `ranges` those of all joints, bends and distances are part of the page and of the JSON. What is
    printed may be a `short` report.

    `drawn` gives the motion that the figures show, where it is another, such as one of fewer rows.
    """
    plain = partial(as_dict, ranges=ranges)
    files: Files[Motion] = {
        "report.json": json_file(plain),
        "motion.csv": LongTable(
            Motion.column_parts, lambda motion: sum(circuit.tally.rows for circuit in motion)
        ),
    }
    return Report(
        partial(text, ranges=ranges, short=short),
        plain,
        files,
        lambda motion: report_figures(drawn(motion), figures, circuit=circuit, look=look),
        {"report.md": partial(_write_markdown, ranges=ranges)},
        spoken=True,
    )


def _write_markdown(motion: Motion, path: Path, *, ranges: bool = False) -> None:
    # a browser shows no PDF in place; of several formats one is enough
    shown_here = [file.name for file in sorted(path.parent.iterdir()) if file.suffix in (".png", ".svg")]
    stems = {name.rpartition(".")[0]: name for name in reversed(shown_here)}
    path.write_text(
        markdown(motion, [stems[stem] for stem in sorted(stems)], ranges=ranges), encoding="utf-8"
    )


def write(
    motion: Motion,
    folder: str | os.PathLike[str],
    figures: Sequence[str] = ("png",),
    *,
    force: bool = False,
) -> list[Path]:
    """Writes report.md, report.json, motion.csv and the figures into a folder; returns their paths.

    The folder is made if need be. The figures are configuration and motion; except for an RSSR, whose curves
    tell all, also joints, and path_<name> for each named point. All files are finished in a folder beside it
    before the first is put in place. Raises `OutputError` where that cannot be done, and where one of them
    exists and `force` is not given.

        >>> import tempfile
        >>> import sevenbar as sb
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     sorted(path.name for path in write(sb.load("rssr").motion(), folder, ["svg"]))
        ['configuration.svg', 'motion.csv', 'motion.svg', 'report.json', 'report.md']
    """
    return motion_report(figures).write(motion, folder, force=force)


def modes_report(
    linkage: Solvable,
    column: int,
    poses: PosesAt | None = None,
    *,
    limit: float | None = None,
    rates: bool = True,
) -> Report[Modes]:
    """How the assembly modes at a value of a column are reported.

    With `poses`, which has their rates, also these, printed or not; `limit` is the nearest value of the
    column up to which the loop closes, where it does not close at this one.
    """

    def text(modes: Modes) -> RenderableType:
        # rich takes a while to load, and JSON does without it
        from sevenbar.reporting.printed import modes_page

        return modes_page(linkage, column, modes, poses if rates else None, limit)

    return Report(text, partial(_modes_dict, linkage, column, poses, limit), spoken=True)


def modes_json(linkage: Solvable, modes: Modes, column: int) -> str:
    """All assembly modes as JSON text: angles in radians, lengths in the linkage's unit."""
    return modes_report(linkage, column).json(modes)


def print_modes(linkage: Solvable, modes: Modes, column: int, console: Console | None = None) -> None:
    """Prints a table of all assembly modes, one row a mode; angles in degrees."""
    modes_report(linkage, column).print(modes, console)


def _modes_dict(
    linkage: Solvable, column: int, poses: PosesAt | None, limit: float | None, modes: Modes
) -> dict[str, Any]:
    from sevenbar.reporting.pose_text import pose_dict

    own = [None] * len(modes) if poses is None else [poses.nearest(q) for q in modes.q]
    rates = [{} if pose is None else pose_dict(pose) for pose in own]
    drive = None if poses is None else {"speed": poses.speed, "acceleration": poses.acceleration}
    return {
        **head_of(linkage),
        "input": {"joint": linkage.columns[column], "value": modes.input},
        "drive": drive,
        "completeness": modes.completeness,
        "open_by": modes.open_by.tolist(),
        "agree": modes.agree,
        "on_curve": None if modes.on_curve is None else modes.on_curve.tolist(),
        "count": len(modes),
        "columns": _columns(linkage),
        "modes": [
            {"q": q.tolist(), "residual": float(residual), "status": str(status), **each}
            for q, residual, status, each in zip(modes.q, modes.residual, modes.status, rates, strict=True)
        ],
        "nearest_limit": limit,
    }
