"""The command `sevenbar simulate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import sevenbar as sb
from sevenbar.commands.options import (
    Figures,
    Force,
    InputJoint,
    OutputJoint,
    Source,
    Speed,
    figure_formats,
    progress_bar,
    tell_written,
)
from sevenbar.reporting.folder import check_targets


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
    json: Annotated[
        bool, typer.Option("--json", help="Print the result as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Build the linkage in another program, drive it, and compare (extra 'simulate')."""
    from sevenbar.simulation import report as simulation_report
    from sevenbar.simulation.run import moved, prepared, ready

    endings = figure_formats(figures, out)
    ready(engine)
    loaded = sb.load(linkage)
    if out is not None:
        # before the long run
        check_targets(simulation_report.targets(engine, out, endings, bool(loaded.points)), force=force)
    way, model = prepared(loaded, steps=steps, circuit=circuit, input=input_joint, output=output, speed=speed)
    with progress_bar(f"{engine}: {loaded.name}") as progress:
        run = moved(way, model, engine, progress)
    written = simulation_report.write(run, out, endings, force=force) if out is not None else []
    if json:
        typer.echo(simulation_report.as_json(run))
        return
    simulation_report.print_text(run)
    tell_written(written)
