"""What a simulation comes to: a page of text for people, JSON, and a folder with figures and every row."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.box import SIMPLE_HEAD
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.errors import OutputError
from sevenbar.folder import fill_folder
from sevenbar.simulation.agreement import Difference, Simulation
from sevenbar.simulation.run import as_dict
from sevenbar.skeleton import short

#: The names of figures that a run may have.
FIGURES = ("output", "joints", "points")


def as_json(run: Simulation) -> str:
    """What a run comes to as JSON text."""
    return json.dumps(as_dict(run), indent=2, allow_nan=False)


def print_text(run: Simulation, console: Console | None = None) -> None:
    """Prints the report for people."""
    (console or Console()).print(text(run))


def text(run: Simulation) -> RenderableType:
    """The report for people, to be printed by rich."""
    way, record, linkage = run.course, run.record, run.linkage
    motion, unit = way.motion, run.linkage.length_unit
    facts = Table.grid(padding=(0, 2))
    facts.add_column(style="dim")
    facts.add_column()
    facts.add_row("loop", " ".join(f"{j.kind} {j.name}" for j in linkage.joints))
    facts.add_row("engine", f"{record.engine} {record.version}: {record.method}")
    slide = linkage.column_kinds[way.circuit.input_column] == "slide"
    facts.add_row(
        "drive", f"{motion.input} at {motion.speed:.6g} {unit if slide else 'rad'}/s, output {motion.output}"
    )
    facts.add_row("course", way.told())
    lead = f", after {len(way.lead)} that are not compared" if len(way.lead) else ""
    facts.add_row("steps", f"{len(way.rows) - 1} of {way.step:.6g} s{lead}")
    for number, note in enumerate(record.notes):
        facts.add_row("" if number else "built", note)
    facts.add_row(
        "closure error", f"{_sized(run.gap, unit)} and {_sized(run.tilt, 'rad')} at most, in the engine"
    )
    if run.returned is not None:
        facts.add_row(
            "return",
            f"misses its first pose by {_sized(run.returned[0], unit)} and {_sized(run.returned[1], 'rad')}",
        )
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column(f"{record.engine} less Sevenbar", no_wrap=True)
    for heading in ("greatest", f"at {short(motion.input, 12)}", "median", "values up to"):
        table.add_column(heading, justify="right")
    for found in run.differences:
        table.add_row(*_cells(found, slide, unit))
    return Group(Text(linkage.name, style="bold underline"), facts, Text(), table)


def _sized(value: float, unit: str) -> str:
    return f"{value:.1e} {unit}"


def _cells(found: Difference, slide: bool, unit: str) -> tuple[str, ...]:
    if math.isnan(found.greatest):
        return f"{found.quantity} \\[{found.unit}]", "-", "-", "-", "-"
    at = f"{found.at:.6g} {unit}" if slide else f"{math.degrees(found.at):.3f}°"
    return (
        f"{found.quantity} \\[{found.unit}]",
        f"{found.greatest:.2e}",
        at,
        f"{found.median:.2e}",
        f"{found.scale:.6g}",
    )


def targets(run_engine: str, folder: Path, figures: Sequence[str], points: bool) -> list[Path]:
    """The files that `write` makes for an engine, by its name."""
    names = [f"{run_engine}.json", f"{run_engine}.csv"]
    names += ["mujoco.xml"] if run_engine == "mujoco" else []
    names += [
        f"{run_engine}_{name}.{ending}"
        for name in FIGURES
        if points or name != "points"
        for ending in figures
    ]
    return [folder / name for name in names]


def refuse_existing(files: Sequence[Path]) -> None:
    """Raises `OutputError` naming the first file that is already there."""
    for file in files:
        if file.exists():
            raise OutputError(f"{file}: exists already; give another folder, or --force to write over it")


def write(
    run: Simulation,
    folder: str | os.PathLike[str],
    figures: Sequence[str] = ("png",),
    *,
    force: bool = False,
) -> list[Path]:
    """Writes the report as JSON, every row as CSV and the figures into a folder: all of them, or none.

    Files are named by the engine, so that both engines share a folder; for MuJoCo its model is added.
    Raises `OutputError` where one of them exists and `force` is not given.
    """
    from sevenbar.figure import save
    from sevenbar.simulation.figures import figures as drawn
    from sevenbar.simulation.mjcf import mjcf

    engine = run.record.engine.lower()
    if not force:
        refuse_existing(targets(engine, Path(folder), figures, bool(run.points)))

    def fill(staging: Path) -> None:
        (staging / f"{engine}.json").write_text(as_json(run) + "\n", encoding="utf-8")
        write_csv(run, staging / f"{engine}.csv")
        if engine == "mujoco":
            (staging / "mujoco.xml").write_text(mjcf(run.model, time_step=run.course.step), encoding="utf-8")
        for name, figure in drawn(run):
            for ending in figures:
                save(figure, staging / f"{engine}_{name}.{ending}")

    return fill_folder(Path(folder), fill)


def columns(run: Simulation) -> dict[str, npt.NDArray[Any]]:
    """Every row, column by column, Sevenbar's and the engine's; each name ends in its unit."""
    linkage, unit = run.linkage, run.linkage.length_unit
    engine = run.record.engine.lower()
    found: dict[str, npt.NDArray[Any]] = {"row": np.arange(len(run.time)), "time_s": run.time}
    sides = (("sevenbar", run.theory), (engine, run.engine))
    for index, name in enumerate(linkage.columns):
        slide = linkage.column_kinds[index] == "slide"
        for who, values in sides:
            shown = values.q[:, index] if slide else np.degrees(values.q[:, index])
            found[f"{name}_{who}_{unit if slide else 'deg'}"] = shown
        own = unit if slide else "rad"
        for who, values in sides:
            found[f"{name}_{who}_{own}_s"] = values.dq[:, index]
        for who, values in sides:
            found[f"{name}_{who}_{own}_s2"] = values.ddq[:, index]
    for name, (engine_point, theory_point) in run.points.items():
        for letter, suffix, what in (
            ("", unit, "position"),
            ("v", f"{unit}_s", "velocity"),
            ("a", f"{unit}_s2", "acceleration"),
        ):
            for axis, direction in enumerate("xyz"):
                for who, point in (("sevenbar", theory_point), (engine, engine_point)):
                    found[f"{name}_{letter}{direction}_{who}_{suffix}"] = getattr(point, what)[:, axis]
    found[f"closure_error_{unit}"] = run.engine.gap.max(axis=1)
    found["closure_error_rad"] = run.engine.tilt.max(axis=1)
    return found


def write_csv(run: Simulation, path: Path) -> None:
    """Writes every row; a value that does not exist is an empty cell."""
    table = columns(run)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        cells = [["" if v != v else v for v in column.tolist()] for column in table.values()]
        writer.writerows(zip(*cells, strict=True))
