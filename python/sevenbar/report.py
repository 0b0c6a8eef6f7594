"""What a motion comes to: one object for programs, a page of text for people, a folder of files to keep.

A report only writes down what the motion holds; it solves nothing.
"""

from __future__ import annotations

import csv
import json
import math
import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.errors import OutputError
from sevenbar.linkage import Linkage
from sevenbar.motion import Circuit, DeadCentre, Extremes, Motion


def as_dict(motion: Motion) -> dict[str, Any]:
    """The report as plain values: angles in radians, lengths in the linkage's unit, null beside a status."""
    linkage = motion.linkage
    report = {
        "format": 1,
        "linkage": {
            "name": linkage.name,
            "kind": linkage.kind,
            "joints": [{"name": joint.name, "kind": joint.kind} for joint in linkage.joints],
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
        "completeness": motion.completeness,
        "circuits": [_circuit_dict(circuit) for circuit in motion.circuits],
        "idle": list(motion.idle),
        "redundant": list(motion.redundant),
    }
    return _without_nan(report)  # type: ignore[no-any-return]


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
            "angle": _extremes_dict(circuit.angle, "turns-fully"),
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


def _without_nan(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _without_nan(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(v) for v in value]
    return value


def as_json(motion: Motion) -> str:
    """`as_dict` as JSON text."""
    return json.dumps(as_dict(motion), indent=2, allow_nan=False)


def text(motion: Motion) -> RenderableType:
    """The report for people, to be printed by rich; angles in degrees."""
    linkage = motion.linkage
    unit = linkage.length_unit
    numbers = dict(linkage.dimensions) or dict(_side_lengths(linkage).items())
    facts = Table.grid(padding=(0, 2))
    facts.add_column(style="dim")
    facts.add_column()
    facts.add_row("loop", " ".join(f"{j.kind} {j.name}" for j in linkage.joints))
    facts.add_row(
        "dimensions", "  ".join(f"{key} = {value:.6g}" for key, value in numbers.items()) + f"  [{unit}]"
    )
    drive = "an input law" if motion.law is not None else f"{motion.speed:.6g} rad/s"
    facts.add_row("drive", f"{motion.input} at {drive}, output {motion.output}")
    facts.add_row("motion type", Text(motion.motion_type, style="bold"))
    facts.add_row("circuits", _circuit_count(motion))
    facts.add_row(
        "input limits", "  ".join(_degrees(x) for x in motion.limits) or "none: the input turns fully"
    )
    if motion.motion_type == "cannot-assemble":
        facts.add_row("input limits", "no input closes the loop: the coupler is too short or too long")
    if motion.change_points.size:
        where = "  ".join(_degrees(x) for x in motion.change_points)
        facts.add_row(
            "change point",
            f"input {where}: two limits lie within 1e-6 rad; the least change of a dimension decides",
        )
    facts.add_row("completeness", f"{motion.completeness}: all modes are found")
    facts.add_row("idle freedom", "; ".join(motion.idle) + ", held by convention")
    facts.add_row("redundant", "; ".join(motion.redundant) or "no constraints")
    parts: list[RenderableType] = [Text(linkage.name, style="bold underline"), facts]
    if motion.circuits:
        parts += [Text(), _circuit_table(motion)]
    return Group(*parts)


def _circuit_count(motion: Motion) -> str:
    turning = [c for c in motion.circuits if c.turns]
    if not motion.circuits:
        return "none: it closes only at the change point" if motion.change_points.size else "none"
    how = (
        f"each closes after {'one turn' if turning[0].turns == 1 else 'two turns'} of the input"
        if turning
        else "each goes forth and back"
    )
    return f"{len(motion.circuits)}, {how if len(motion.circuits) > 1 else how.replace('each ', 'it ')}"


def _circuit_table(motion: Motion) -> Table:
    output = motion.output
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column(f"value @ angle of {motion.input}", overflow="fold")
    for circuit in motion.circuits:
        table.add_column(f"circuit {circuit.index}", overflow="fold")
    rows: list[tuple[str, Callable[[Circuit], str]]] = [
        ("motion type", lambda c: c.motion_type),
        (f"range of {motion.input}", lambda c: _range(c.input_range)),
        (f"range of {output}", lambda c: _range(c.output_range)),
        (f"swing of {output}", lambda c: "full turns" if c.swing is None else _degrees(c.swing)),
        ("time ratio", lambda c: "-" if c.time_ratio is None else f"{c.time_ratio:.6g}"),
        ("transmission angle min", lambda c: _transmission(c, "lowest")),
        ("transmission angle max", lambda c: _transmission(c, "highest")),
    ]
    quantities: list[tuple[str, str, Callable[[Circuit], Extremes | None]]] = [
        ("angle", "rad", lambda c: c.angle),
        ("velocity", "rad/s", lambda c: c.velocity),
        ("acceleration", "rad/s\u00b2", lambda c: c.acceleration),
    ]
    for name, unit, pick in quantities:
        for end, word in (("lowest", "min"), ("highest", "max")):
            rows.append((f"{output} {name} {word} \\[{unit}]", _extreme_cell(pick, end, name)))
    rows.append(("dead centres of the input", lambda c: _dead_centres(c, "input")))
    rows.append(("dead centres of the output", lambda c: _dead_centres(c, "output")))
    rows.append((f"closure error max \\[{motion.linkage.length_unit}]", lambda c: f"{_residual(c):.1e}"))
    for label, cell in rows:
        table.add_row(label, *(cell(circuit) for circuit in motion.circuits))
    return table


def _extreme_cell(
    pick: Callable[[Circuit], Extremes | None], end: str, name: str
) -> Callable[[Circuit], str]:
    def cell(circuit: Circuit) -> str:
        extremes = pick(circuit)
        if extremes is None:
            return (
                "turns fully"
                if name == "angle"
                else "no bound at limits"
                if circuit.input_range
                else "change point"
            )
        return _at(f"{getattr(extremes, end):.6g}", getattr(extremes, f"{end}_at"))

    return cell


def _transmission(circuit: Circuit, end: str) -> str:
    extremes = circuit.transmission
    if extremes is None:
        return "not defined"
    return _at(_degrees(getattr(extremes, end)), getattr(extremes, f"{end}_at"))


def _dead_centres(circuit: Circuit, kind: str) -> str:
    found: Sequence[DeadCentre] = [d for d in circuit.dead_centres if d.kind == kind]
    return ", ".join(_degrees(d.input % math.tau) for d in found) or "none"


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.3f}\u00b0"


def _range(ends: tuple[float, float] | None) -> str:
    return "full turns" if ends is None else f"{_degrees(ends[0])} to {_degrees(ends[1])}"


def _at(value: str, angle: float) -> str:
    return f"{value} @ {_degrees(angle % math.tau)}"


def print_text(motion: Motion, console: Console | None = None) -> None:
    """Prints the report for people."""
    (console or Console()).print(text(motion))


def write(motion: Motion, folder: str | os.PathLike[str], figures: Sequence[str] = ("png",)) -> list[Path]:
    """Writes report.json, motion.csv and the two figures into a folder, made if need be; returns their paths.

    All files are finished in a folder beside it before the first is put in place. Raises `OutputError`
    where that cannot be done.
    """
    from sevenbar import plot

    def fill(staging: Path) -> None:
        (staging / "report.json").write_text(as_json(motion) + "\n", encoding="utf-8")
        write_csv(motion, staging / "motion.csv")
        if motion.circuits:
            drawn = {"configuration": plot.configuration(motion), "motion": plot.curves(motion)}
            for name, figure in drawn.items():
                for ending in figures:
                    plot.save(figure, staging / f"{name}.{ending}")

    return fill_folder(Path(folder), fill)


def write_csv(motion: Motion, path: Path) -> None:
    """Writes every row of every circuit; a value that does not exist is an empty cell beside its status."""
    columns = motion.columns()
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        cells = [["" if v != v else v for v in column.tolist()] for column in columns.values()]
        writer.writerows(zip(*cells, strict=True))


def fill_folder(folder: Path, fill: Callable[[Path], None]) -> list[Path]:
    """Lets `fill` write into a folder aside, then moves its files into `folder`: whole, or not at all."""
    made = [p for p in (folder, *folder.parents) if not p.exists()]
    staging = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".partial-", dir=folder))
        fill(staging)
        files = sorted(staging.iterdir())
        for file in files:
            if (folder / file.name).is_dir():
                raise OutputError(
                    f"{folder / file.name}: is a folder where a file should go; give another folder"
                )
        return [file.replace(folder / file.name) for file in files]
    except OSError as error:
        _undo(made, staging)
        reason = (error.strerror or str(error)).lower()
        raise OutputError(
            f"{folder}: cannot be written: {reason}; give a folder that can be made or written"
        ) from None
    except BaseException:
        _undo(made, staging)
        raise
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)


def _undo(made: Sequence[Path], staging: Path | None) -> None:
    if staging is not None:
        shutil.rmtree(staging, ignore_errors=True)
    for path in made:
        with suppress(OSError):
            path.rmdir()
