"""The command `sevenbar simulate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import sevenbar as sb
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.options import (
    Figures,
    Force,
    InputJoint,
    Json,
    OutputJoint,
    Source,
    Speed,
    figure_formats,
)
from sevenbar.commands.progress import progress_bar


def simulate(
    linkage: Source,
    engine: Annotated[str, typer.Option(help="exudyn (hard constraints) or mujoco (soft ones).")] = "exudyn",
    steps: Annotated[int, typer.Option(help="Steps in a full turn of the input.")] = 3600,
    circuit: Annotated[int, typer.Option(help="The circuit that is followed.")] = 0,
    input_joint: InputJoint = None,
    output: OutputJoint = None,
    speed: Speed = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the JSON, the CSV and the figures.")] = None,
    figures: Figures = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Build the linkage in another program, drive it, and compare (extra 'simulate')."""
    from sevenbar.simulation.report import simulation_report
    from sevenbar.simulation.run import moved, prepared, ready

    formats = figure_formats(figures, out)
    ready(engine)
    loaded = sb.load(linkage)
    report = simulation_report(engine, formats)
    check_out(report, out, force=force)
    way, model = prepared(loaded, steps=steps, circuit=circuit, input=input_joint, output=output, speed=speed)
    with progress_bar(f"{engine}: {loaded.name}") as progress:
        run = moved(way, model, engine, progress)
    deliver(run, report, out, json=json, force=force)
