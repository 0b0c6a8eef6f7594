"""The command `sevenbar export`."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.consent import confirm, long_motion, table_ahead
from sevenbar.commands.deliver import tell_written
from sevenbar.commands.given import input_value, opened
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError
from sevenbar.reporting.folder import check_targets

if TYPE_CHECKING:
    from sevenbar.export import Bodies, Table
    from sevenbar.kinematics.linkage import Linkage


#: Tables that hold numbers as text.
TEXT = (".csv", ".json", ".xlsx")


def _formats(incomplete: str) -> list[str]:
    from sevenbar.export import ALIASES, FORMATS

    return [word for word in (*FORMATS, *ALIASES) if word.startswith(incomplete)]


def export(
    linkage: options.Source,
    to: Annotated[
        str | None,
        typer.Option(
            autocompletion=_formats,
            help="Tables: csv, xlsx (or excel), parquet, npz, mat (or matlab), json. Bodies: glb, stl, step. "
            "Models: urdf, mjcf (or mujoco), cmd (or adams). By the ending of --out where left out.",
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
    samples: options.Samples = 360,
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    units: Annotated[
        str | None, typer.Option(help="Of tables: file (the default), or si for metres and radians.")
    ] = None,
    drive: Annotated[
        str | None,
        typer.Option(
            help="How mjcf drives the input: velocity (the default), position, motor (a torque), or flywheel."
        ),
    ] = None,
    force: options.Force = False,
    yes: options.Yes = False,
) -> None:
    """Write files for other programs: motion, bodies in a pose, models (some: extras 'export', 'cad')."""
    from sevenbar.export import FORMATS, Table, ending_of, format_of
    from sevenbar.export import export as write_export

    if out is None:
        if to is None:
            raise RequestError(f"--to: missing; give a format, {', '.join(FORMATS)}, or --out")
        out = Path(f"{Path(linkage).stem}{ending_of(to)}")
    form = FORMATS[format_of(out, to)]
    # a folder of many parts has no ending
    check_targets([out] if out.suffix else [], force=force)
    loaded = opened(linkage, agree)
    value = None if at is None else input_value("--at", at, loaded, input_joint)
    moved = partial(loaded.motion, input=input_joint, output=output, speed=speed)
    if isinstance(form, Table):
        text = out.suffix.lower() in TEXT
        confirm(table_ahead(moved, samples, out.name, text=text), yes=yes)
    motion = long_motion(moved, samples)
    with progress_bar(f"writing {out}") as progress:
        if sys.stderr.isatty():
            # a refusal takes it away
            progress(0, 0)
        written = write_export(
            motion,
            to,
            out,
            circuit=circuit,
            at=value,
            branch=branch,
            units=units,  # type: ignore[arg-type]
            drive=drive,
            force=force,
            progress=progress,
        )
    tell_written(written, below=False)
    for line in _notes(out, form, loaded):
        typer.echo(line)


def _notes(out: Path, form: Table | Bodies, loaded: Linkage) -> list[str]:
    """What to know of a file besides its name."""
    from sevenbar.export import Bodies, Table

    notes = []
    if out.suffix.lower() == ".urdf":
        notes.append("URDF holds trees only: the joint that closes the loop is in the .loop.json file")
    if isinstance(form, Table):
        from sevenbar.reporting.facts import idle_note

        if idle := idle_note(loaded, [point.link for point in loaded.points]):
            notes.append(idle)
    if isinstance(form, Bodies) and form.masses:
        # after the writer has imported what this does: a table needs neither figures nor engines
        from sevenbar.export.mass import has_masses

        if has_masses(loaded):
            notes.append("masses are the linkage's own; bodies that have none weigh next to nothing")
        else:
            notes.append(f"masses are assumed: {form.masses}; put in your own where forces matter")
    return notes
