"""What a simulation comes to: a page of text for people, JSON, and a folder with figures and every row."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.console import Console, Group, RenderableType
from rich.text import Text

from sevenbar.drawing.skeleton import short
from sevenbar.reporting.folder import check_targets, fill_folder, write_columns
from sevenbar.reporting.page import Facts, number_table, opening
from sevenbar.reporting.report import json_text, without_nan
from sevenbar.simulation.agreement import Difference, Simulation
from sevenbar.text.printing import text_of

#: The names of figures that a run may have.
FIGURES = ("output", "joints", "points")


def as_dict(run: Simulation) -> dict[str, Any]:
    """What a run comes to, as plain values: angles in radians, lengths in the linkage's unit."""
    way = run.course
    told = {
        "format": 1,
        "linkage": {"name": run.linkage.name, "kind": run.linkage.kind},
        "units": {"length": run.linkage.length_unit, "angle": "rad", "time": "s"},
        "engine": {"name": run.record.engine, "version": run.record.version, "notes": list(run.record.notes)},
        "drive": {"input": way.motion.input, "output": way.motion.output, "speed": way.motion.speed},
        "course": {
            "circuit": way.circuit.index,
            "closes": way.closes,
            "rows": len(way.rows),
            "lead": len(way.lead),
            "step": way.step,
        },
        "differences": [vars(found) for found in run.differences],
        "closure_error": {"length": run.gap, "angle": run.tilt},
        "returned": None if run.returned is None else {"length": run.returned[0], "angle": run.returned[1]},
    }
    return without_nan(told)  # type: ignore[no-any-return]


def as_json(run: Simulation) -> str:
    """What a run comes to as JSON text."""
    return json_text(as_dict(run))


def print_text(run: Simulation, console: Console | None = None) -> None:
    """Prints the report for people."""
    (console or Console()).print(text(run))


def text(run: Simulation) -> RenderableType:
    """The report for people, to be printed by rich."""
    way, record, linkage = run.course, run.record, run.linkage
    motion, unit = way.motion, run.linkage.length_unit
    facts = Facts()
    facts.add("loop", "  ".join(f"{j.kind} {j.name}" for j in linkage.joints))
    facts.add("engine", f"{record.engine} {record.version}: {record.method}")
    slide = linkage.column_kinds[way.circuit.input_column] == "slide"
    facts.add(
        "drive", f"{motion.input} at {motion.speed:.6g} {unit if slide else 'rad'}/s, output {motion.output}"
    )
    facts.add("course", way.told())
    lead = f", after {len(way.lead)} that are not compared" if len(way.lead) else ""
    facts.add("steps", f"{len(way.rows) - 1} of {way.step:.6g} s{lead}")
    for number, note in enumerate(record.notes):
        facts.add("" if number else "built", note)
    facts.add(
        "closure error", f"{_sized(run.gap, unit)} and {_sized(run.tilt, 'rad')} at most, in the engine"
    )
    if run.returned is not None:
        facts.add(
            "return",
            f"misses its first pose by {_sized(run.returned[0], unit)} and {_sized(run.returned[1], 'rad')}",
        )
    heads = (
        f"{record.engine} less Sevenbar",
        "greatest",
        f"at {short(motion.input, 12)}",
        "median",
        "values up to",
    )
    table = number_table(heads, (_cells(found, slide, unit) for found in run.differences))
    return Group(Text(linkage.name, style="bold underline"), facts.grid, Text(), table)


def _sized(value: float, unit: str) -> str:
    return f"{value:.1e} {unit}"


def _cells(found: Difference, slide: bool, unit: str) -> tuple[str, ...]:
    if math.isnan(found.greatest):
        return f"{found.quantity} [{found.unit}]", "-", "-", "-", "-"
    at = f"{found.at:.6g} {unit}" if slide else f"{math.degrees(found.at):.3f}°"
    return (
        f"{found.quantity} [{found.unit}]",
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
    from sevenbar.drawing.figure import save
    from sevenbar.simulation.figures import figures as drawn
    from sevenbar.simulation.mjcf import mjcf

    engine = run.record.engine.lower()
    check_targets(targets(engine, Path(folder), figures, bool(run.points)), force=force)

    def fill(staging: Path) -> None:
        (staging / f"{engine}.json").write_text(as_json(run) + "\n", encoding="utf-8")
        write_columns(staging / f"{engine}.csv", columns(run))
        if engine == "mujoco":
            (staging / "mujoco.xml").write_text(mjcf(run.model, time_step=run.course.step), encoding="utf-8")
        for name, figure in drawn(run):
            for ending in figures:
                save(figure, staging / f"{engine}_{name}.{ending}")

    return fill_folder(Path(folder), fill, force=force)


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


@text_of.register(Simulation)
def _(run: Simulation) -> str:
    return opening("Simulation", text(run))
