"""The command `sevenbar export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import sevenbar as sb
from sevenbar.commands.deliver import tell_written
from sevenbar.commands.given import agreed, input_value
from sevenbar.commands.options import Agree, Force, InputJoint, OutputJoint, Samples, Source, Speed
from sevenbar.errors import RequestError


def export(
    linkage: Source,
    to: Annotated[
        str | None,
        typer.Option(
            help="csv, parquet, npz, mat, json, glb, stl, step, urdf, mjcf, cmd; by --out's ending."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="The file to write; the linkage's name with --to's ending by default.")
    ] = None,
    circuit: Annotated[
        int | None, typer.Option(help="The circuit whose pose is written; 0 by default.")
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(
            help="Input of the pose: '30deg', '0.5rad', '12mm'; a plain number is in degrees or lengths."
        ),
    ] = None,
    branch: Annotated[
        int | None, typer.Option(help="The pass of a circuit that rocks; 0 by default.")
    ] = None,
    samples: Samples = 360,
    input_joint: InputJoint = None,
    output: OutputJoint = None,
    speed: Speed = None,
    agree: Agree = None,
    units: Annotated[
        str | None, typer.Option(help="Of tables: file (the default), or si for metres and radians.")
    ] = None,
    force: Force = False,
) -> None:
    """Write files for other programs: motion, bodies in a pose, models (some: extras 'export', 'cad')."""
    from sevenbar.export import FORMATS, ending_of, format_of
    from sevenbar.export import export as write_export

    if out is None:
        if to is None:
            raise RequestError(f"--to: missing; give a format, {', '.join(FORMATS)}, or --out")
        out = Path(f"{Path(linkage).stem}{ending_of(to)}")
    format_of(out, to)
    loaded = sb.load(linkage)
    value = None if at is None else input_value("--at", at, loaded, input_joint)
    written = write_export(
        loaded.motion(samples, input=input_joint, output=output, speed=speed, agree=agreed(agree)),
        to,
        out,
        circuit=circuit,
        at=value,
        branch=branch,
        units=units,  # type: ignore[arg-type]
        force=force,
    )
    tell_written(written, below=False)
    if out.suffix.lower() == ".urdf":
        typer.echo("URDF holds trees only: the joint that closes the loop is in the .loop.json file")
