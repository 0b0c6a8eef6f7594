"""Options that several of the commands `sevenbar design ..` have, and the checks of their numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sevenbar.commands.options import number_option
from sevenbar.errors import RequestError, shown
from sevenbar.text.expression import IN_DEGREES, calls_in
from sevenbar.text.units import ANGLES

FunctionX = Annotated[str, typer.Option(help="Range of x: 0:1, 0:pi/2 or 0:90deg (radians then).")]
Pairs = Annotated[
    Path | None, typer.Option(help="CSV of pairs of angles in place of a function: input_deg,output_deg.")
]
TimeRatio = Annotated[
    float, number_option("--time-ratio", "1.2", "Time of the slower stroke over the quicker, >= 1.")
]
Transmission = Annotated[str, typer.Option(help="Least transmission angle; 0 for none.")]
MotionType = Annotated[
    str | None,
    typer.Option(help="crank-rocker, double-crank, rocker-crank or double-rocker; any by default."),
]
Designs = Annotated[int, typer.Option(help="How many designs that differ, at most.")]
Starts = Annotated[int, typer.Option(help="Linkages within the bounds that are tried.")]
Seed = Annotated[int, typer.Option(help="Seed of the search.")]
OutDesigns = Annotated[
    Path | None, typer.Option(help="Folder for design_1.toml, .., summary.csv and summary.json.")
]
OutFigures = Annotated[
    Path | None, typer.Option(help="Folder for design_1.toml, .. with figures, summary.csv and summary.json.")
]

#: Most designs that one command gives.
MOST_DESIGNS = 50


def checked_designs(count: int, most: int = MOST_DESIGNS) -> None:
    """Raises `RequestError` for a number of designs that one command does not give."""
    if not 1 <= count <= most:
        raise RequestError(f"--designs: {count} designs are not offered; give 1 to {most}")


def refuse_degrees_twice(y: str, x: str) -> None:
    """Raises `RequestError` where sind and the like would take an x in radians."""
    with_unit = any(unit in x for unit in (*ANGLES, "\u00b0"))
    if with_unit and (called := sorted(calls_in(y) & IN_DEGREES.keys())):
        raise RequestError(
            f"--x: {shown(x)} counts in radians, and {called[0]} takes degrees; "
            f"write {IN_DEGREES[called[0]]}, or leave the unit of x out"
        )
