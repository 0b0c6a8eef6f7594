"""The command `sevenbar free`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import sevenbar as sb
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import agreed, input_value
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.motion import chosen_circuit
from sevenbar.kinematics.loop.single import check_single
from sevenbar.reporting.folder import check_targets


def free(
    linkage: options.Source,
    duration: Annotated[
        str, typer.Option("--time", help="How long it moves, as in '10s' or '500ms'.")
    ] = "10s",
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="Value of the input at the start: '30deg', '12mm'; a plain number is in degrees or lengths; "
            "by default the drawn pose, or the first one.",
        ),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help="Speed of the input at the start, as in '60 rpm'; at rest by default.")
    ] = None,
    energy: Annotated[
        float | None, typer.Option(help="Kinetic energy at the start in J, in place of --speed.")
    ] = None,
    torque: Annotated[
        float | None, typer.Option(help="A constant torque at the input in N m, of a slide a force in N.")
    ] = None,
    circuit: Annotated[int, typer.Option(help="The circuit on which it moves.")] = 0,
    branch: Annotated[
        int | None, typer.Option(help="Which of the poses with this start, counted along the circuit.")
    ] = None,
    restitution: Annotated[
        float | None,
        typer.Option(
            help="What part of its speed a stop gives back: 0, the default, takes all, 1 gives all back."
        ),
    ] = None,
    rows: options.Samples = 361,
    input_joint: options.InputJoint = None,
    agree: options.Agree = None,
    film: Annotated[
        Path | None, typer.Option(help="Film of the motion: .html, .gif or .mp4; a second for a second.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for free.json, free.csv and the figure.")] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """How the linkage moves by itself: falling, swinging, coasting, starting up; and where it can rest."""
    from sevenbar.drawing.animate import animate
    from sevenbar.kinematics.dynamics.free import time_of
    from sevenbar.reporting.force_words import NOTHING_ACTS
    from sevenbar.reporting.free_motion import free_report

    report = free_report(options.figure_formats(figures, out))
    seconds = time_of("--time", duration)
    check_out(report, out, force=force)
    if film is not None:
        check_targets([film], force=force)
    loaded = sb.load(linkage, agree=agreed(agree))
    check_single(loaded)
    if loaded.loading.is_empty:
        raise RequestError(f"{linkage}: {NOTHING_ACTS.format(place='it')}")
    chosen = chosen_circuit(loaded.motion(input=input_joint), circuit)
    start_value = None if start is None else input_value("--from", start, loaded, input_joint)
    result = chosen.free_motion(
        seconds,
        start=start_value,
        speed=speed,
        energy=energy,
        branch=branch,
        torque=torque,
        samples=rows,
        restitution=restitution,
    )
    equilibria = chosen.equilibria(torque=torque or 0.0)
    also = {}
    if film is not None:
        also[film] = lambda path: animate(result.motion(), path, seconds=seconds)
    deliver((result, equilibria), report, out, json=json, force=force, also=also)
