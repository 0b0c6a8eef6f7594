"""The command `sevenbar axes`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands import options
from sevenbar.commands.deliver import deliver
from sevenbar.description.step_axes import axes_of_step
from sevenbar.errors import RequestError
from sevenbar.reporting.axes import PartAxes, axes_report, write_axes
from sevenbar.reporting.folder import check_targets, fill_folder


def axes(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="A STEP file of parts or of an assembly.")],
    out: Annotated[
        Path | None,
        typer.Option(help="Write the table to this .csv, in which you fill in order and kind."),
    ] = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """List the axes of a CAD model's cylinders, as a table from which a linkage is made (extra 'cad')."""
    if out is not None:
        if out.suffix.lower() != ".csv":
            raise RequestError(f"--out: {out}: the table is written as CSV; give a file that ends in .csv")
        check_targets([out], force=force)
    result = PartAxes(model.name, tuple(axes_of_step(model)))

    def write(path: Path) -> None:
        fill_folder(path.parent, lambda aside: write_axes(result, aside / path.name), force=force)

    deliver(result, axes_report(), json=json, also={} if out is None else {out: write})
