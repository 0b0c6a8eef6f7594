"""The command `sevenbar simulate`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.consent import Ahead, confirm
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import opened
from sevenbar.commands.progress import progress_bar

#: Steps that an engine makes in a second, for an RSSR or a 7R on a machine of today.
STEPS = {"exudyn": 1000.0, "mujoco": 10000.0}


def simulate(
    linkage: options.Source,
    engine: Annotated[str, typer.Option(help="exudyn (hard constraints) or mujoco (soft ones).")] = "exudyn",
    steps: Annotated[
        int, options.count_option("--steps", "Steps in a full turn of the input, as in 1e4.")
    ] = 3600,
    circuit: Annotated[int, typer.Option(help="The circuit that is followed, counted from 0.")] = 0,
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the JSON, the CSV and the figures.")] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    yes: options.Yes = False,
    json: options.Json = False,
) -> None:
    """Build the linkage in another program, drive it, and compare (extra 'simulate')."""
    from sevenbar.simulation.report import simulation_report
    from sevenbar.simulation.run import moved, prepared, ready

    formats = options.figure_formats(figures, out)
    ready(engine)
    loaded = opened(linkage, agree)
    report = simulation_report(engine, formats)
    check_out(report, out, force=force)
    ahead = Ahead("--steps", f"{steps} steps in {engine}", seconds=steps / STEPS[engine])
    confirm(ahead, yes=yes)
    with progress_bar(f"{engine}: {loaded.heading}") as progress:
        if sys.stderr.isatty():
            # a refusal takes it away
            progress(0, 0)
        way, model = prepared(
            loaded, steps=steps, circuit=circuit, input=input_joint, output=output, speed=speed
        )
        run = moved(way, model, engine, progress)
    deliver(run, report, out, json=json, force=force)
