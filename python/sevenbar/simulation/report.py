"""The result of a simulation: a page of text for people, JSON, and a folder with figures and every row."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sevenbar.drawing.names import short
from sevenbar.kinematics.loop.columns import joint_column, point_column
from sevenbar.reporting.files import Report, columns_file, figure_files, head_of, text_file
from sevenbar.reporting.page import Facts, Page, number_table, page, page_report, prints_its_page
from sevenbar.reporting.shown import drive_text
from sevenbar.simulation.agreement import Difference, Simulation
from sevenbar.text.listed import named

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console


def page_of(run: Simulation) -> Page:
    """The result of a run; plain values are in radians and the file's length unit, NaN for none."""
    way, record, linkage = run.course, run.record, run.linkage
    motion, unit = way.motion, run.linkage.length_unit
    facts = Facts()
    facts.also(**head_of(linkage))
    facts.add("loop", "  ".join(f"{j.kind} {j.name}" for j in linkage.joints))
    engine = {"name": record.engine, "version": record.version, "notes": list(record.notes)}
    facts.add("engine", f"{record.engine} {record.version}: {record.method}", engine=engine)
    drive = drive_text(motion.input, motion.speed, linkage.unit_of(motion.input), motion.output)
    facts.add("drive", drive, drive=named(motion, "input", "output", "speed"))
    rows, lead = len(way.rows), len(way.lead)
    course = {"circuit": way.circuit.index, "closes": way.closes, "rows": rows, "lead": lead}
    facts.add("course", way.text(), course={**course, "step": way.step})
    after = f", after {lead} that are not compared" if lead else ""
    facts.add("steps", f"{rows - 1} of {way.step:.6g} s{after}")
    for number, note in enumerate(record.notes):
        facts.add("" if number else "built", note)
    facts.also(differences=[vars(result) for result in run.differences])
    error = f"{run.gap:.1e} {unit} and {run.tilt:.1e} rad at most, in the engine"
    facts.add("closure error", error, closure_error={"length": run.gap, "angle": run.tilt})
    if run.returned is None:
        facts.also(returned=None)
    else:
        apart, askew = run.returned
        text = f"misses its first pose by {apart:.1e} {unit} and {askew:.1e} rad"
        facts.add("return", text, returned={"length": apart, "angle": askew})
    if run.forces:
        facts.add("forces", _forces_text(run))
    at = f"at {short(motion.input, 12)}"
    heads = (f"{record.engine} minus Sevenbar", "greatest", at, "median", "values up to")
    slide = linkage.unit_of(motion.input) != "rad"
    table = number_table(heads, (_cells(result, slide, unit) for result in run.differences))
    return page(linkage.heading, facts, table)


def _forces_text(run: Simulation) -> str:
    """What of the forces is compared."""
    if len(run.forces) == 1:
        return "those in joints are not compared: this version of the engine leaves springs out of them"
    return (
        "in joints what the link before puts on the link after, as far as equilibrium determines it and not "
        "along the joint's own freedoms; moments about its place on the link before"
    )


def _cells(result: Difference, slide: bool, unit: str) -> tuple[str, ...]:
    name = f"{result.quantity} [{result.unit}]"
    if math.isnan(result.greatest):
        return name, "-", "-", "-", "-"
    at = f"{result.at:.6g} {unit}" if slide else f"{math.degrees(result.at):.3f}°"
    return name, f"{result.greatest:.2e}", at, f"{result.median:.2e}", f"{result.scale:.6g}"


def simulation_report(engine: str, figures: Sequence[str] = ("png",)) -> Report[Simulation]:
    """How a run of an engine is reported; files have its name, so that both engines share a folder."""
    name = engine.lower()
    files = {f"{name}.csv": columns_file(columns)}
    if name == "mujoco":
        files["mujoco.xml"] = text_file(_mjcf)
    for stem in ("output", "joints", "points", "forces"):
        files |= figure_files(f"{name}_{stem}", figures, partial(_figure, stem))
    return page_report(page_of, name, files, spoken=False)


def _mjcf(run: Simulation) -> str:
    from sevenbar.export.mjcf import mjcf

    return mjcf(run.model, time_step=run.course.step)


def _figure(stem: str, run: Simulation) -> Figure | None:
    from sevenbar.simulation.figures import FIGURES

    empty = {"points": not run.points, "forces": not run.forces}
    return None if empty.get(stem) else FIGURES[stem](run)


def write(
    run: Simulation, folder: str | os.PathLike[str], figures: Sequence[str] = ("png",), *, force: bool = False
) -> list[Path]:
    """Writes the report as JSON, every row as CSV and the figures into a folder: all of them, or none.

    Files are named by the engine, so that both engines share a folder; for MuJoCo its model is added.
    Raises `OutputError` where one of them exists and `force` is not given.
    """
    return simulation_report(run.record.engine, figures).write(run, folder, force=force)


def as_json(run: Simulation) -> str:
    """The result of a run as JSON text."""
    return simulation_report(run.record.engine).json(run)


def print_text(run: Simulation, console: Console | None = None) -> None:
    """Prints the report for people."""
    simulation_report(run.record.engine).print(run, console)


def columns(run: Simulation) -> dict[str, npt.NDArray[Any]]:
    """Every row, column by column, Sevenbar's and the engine's; each name ends in its unit."""
    linkage, unit = run.linkage, run.linkage.length_unit
    who = ("sevenbar", run.record.engine.lower())
    result: dict[str, npt.NDArray[Any]] = {"row": np.arange(len(run.time)), "time_s": run.time}
    for column in linkage.each_column:
        name, index, slides = column.name, column.number, not column.turns
        for order, quantity in enumerate(("q", "dq", "ddq")):
            for side, joints in zip(who, (run.theory, run.engine), strict=True):
                head = joint_column(name, slides=slides, order=order, length=unit, angle="deg", who=side)
                values = getattr(joints, quantity)[:, index]
                result[head] = np.degrees(values) if head.endswith("_deg") else values
    for name, (engine, theory) in run.points.items():
        for order, quantity in enumerate(("position", "velocity", "acceleration")):
            for axis, letter in enumerate("xyz"):
                for side, point in zip(who, (theory, engine), strict=True):
                    head = point_column(name, letter, order=order, length=unit, who=side)
                    result[head] = getattr(point, quantity)[:, axis]
    for force in run.forces:
        for place, letter in enumerate(force.axes):
            for side, own in zip(who, (force.theory, force.engine), strict=True):
                words = [force.name, force.what, letter, side, force.unit.replace(" ", "")]
                result["_".join(word for word in words if word)] = own[:, place]
    result[f"closure_error_{unit}"] = run.engine.gap.max(axis=1)
    result["closure_error_rad"] = run.engine.tilt.max(axis=1)
    return result


prints_its_page(Simulation, "Simulation", page_of)
