"""The commands `sevenbar compare` and `sevenbar calibrate`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import sevenbar as sb
from sevenbar.commands import options
from sevenbar.commands.deliver import check_out, deliver
from sevenbar.commands.given import opened
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError
from sevenbar.kinematics.loop.joint_text import joint_value
from sevenbar.kinematics.loop.single import check_single

if TYPE_CHECKING:
    from sevenbar.measuring.measured import Ends, Measured, MeasuredExtremes

Table = Annotated[Path, typer.Argument(metavar="TABLE", help="Measured values: CSV or a text table.")]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--column", help="Column of a quantity by header or number, as in angle=2; may be repeated."
    ),
]
Units = Annotated[
    list[str] | None,
    typer.Option(
        "--unit", help="Unit of a quantity the header does not tell, as in angle=deg; may be repeated."
    ),
]
SkipNan = Annotated[bool, typer.Option("--skip-nan", help="Leave out rows in which a number is missing.")]
Output = Annotated[
    str | None, typer.Option("--output", help="The joint that was measured; the file's by default.")
]
Start = Annotated[
    str, typer.Option(help="Input at time 0 where the table has no input, as in '30deg' or '5mm'.")
]
ChosenCircuit = Annotated[int | None, typer.Option(help="The circuit; the one of least residual by default.")]
ChosenBranch = Annotated[int | None, typer.Option(help="The pass of the circuit, for an input that rocks.")]


def compare(
    linkage: options.Source,
    table: Table,
    align: Annotated[
        list[str] | None,
        typer.Option(
            help="Find the zero of the input (phase) or of the output (offset) too; may be repeated."
        ),
    ] = None,
    column: Columns = None,
    unit: Units = None,
    skip_nan: SkipNan = False,
    input_joint: options.InputJoint = None,
    output: Output = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    start: Start = "0",
    circuit: ChosenCircuit = None,
    branch: ChosenBranch = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for comparison.json, table.csv, rows.csv and the figure.")
    ] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Compare measured values with the computed motion: differences, and the paper's Table 1."""
    from sevenbar.measuring.compare import Comparison
    from sevenbar.measuring.compare import compare as compared
    from sevenbar.measuring.extremes import ExtremesComparison, compare_extremes
    from sevenbar.measuring.measured import MeasuredExtremes
    from sevenbar.measuring.report import comparison_report

    report = comparison_report(options.figure_formats(figures, out))
    loaded = opened(linkage, agree)
    check_out(report, out, force=force)
    ends, measured = _measured(loaded, table, input_joint, output, column, unit, skip_nan)
    result: Comparison | ExtremesComparison
    if isinstance(measured, MeasuredExtremes):
        for option, given in (("--align", align), ("--branch", branch)):
            if given not in (None, []):
                raise RequestError(
                    f"{option}: {table} has lowest and highest values of a circuit, no rows; leave it out"
                )
        result = compare_extremes(loaded, measured, ends, speed=speed, circuit=circuit)
    else:
        begin = _start(loaded, ends.input, start)
        result = compared(
            loaded,
            measured,
            ends,
            align=options.words(align, "--align"),
            speed=speed,
            start=begin,
            circuit=circuit,
            branch=branch,
        )
    deliver(result, report, out, json=json, force=force)


def calibrate(
    linkage: options.Source,
    table: Table,
    free: Annotated[
        list[str] | None,
        typer.Option(help="A dimension to be found, or a pattern; may be repeated. All by default."),
    ] = None,
    hold: Annotated[
        list[str] | None, typer.Option(help="A dimension to be kept, or a pattern; may be repeated.")
    ] = None,
    follow: options.Follow = None,
    offset: Annotated[
        list[str] | None,
        typer.Option(help="Find the zero of the input or of the output too; may be repeated."),
    ] = None,
    column: Columns = None,
    unit: Units = None,
    skip_nan: SkipNan = False,
    input_joint: options.InputJoint = None,
    output: Output = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    start: Start = "0",
    circuit: ChosenCircuit = None,
    branch: ChosenBranch = None,
    confidence: Annotated[
        float, options.number_option("--confidence", "0.95", "How often an interval holds the true value.")
    ] = 0.95,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for calibrated.toml, calibration.json, parameters.csv, rows.csv and the figure."
        ),
    ] = None,
    figures: options.Figures = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Find the dimensions that explain a measured curve, with intervals; a new file (extra 'calibrate')."""
    from sevenbar.description.files import toml_text
    from sevenbar.measuring.calibrate import calibrate as calibrated
    from sevenbar.measuring.measured import MeasuredExtremes
    from sevenbar.measuring.report import calibration_report
    from sevenbar.measuring.rewrite import calibrated_toml

    formats = options.figure_formats(figures, out)
    text = toml_text(linkage)
    loaded = opened(linkage, agree)
    check_single(loaded)
    check_out(calibration_report(lambda _: "", formats), out, force=force)
    ends, measured = _measured(loaded, table, input_joint, output, column, unit, skip_nan)
    if isinstance(measured, MeasuredExtremes):
        raise RequestError(
            f"{table}: lowest and highest values are too few to tell dimensions; give the measured rows"
        )
    begin = _start(loaded, ends.input, start)
    with progress_bar(f"calibrating {loaded.heading}") as progress:
        result = calibrated(
            loaded,
            measured,
            ends,
            free=options.words(free or ["*"], "--free"),
            hold=options.words(hold, "--hold"),
            follow=options.words(follow, "--follow"),
            offsets=options.words(offset, "--offset"),
            speed=speed,
            start=begin,
            circuit=circuit,
            branch=branch,
            confidence=confidence,
            progress=progress,
        )
        # read again before anything of it is reported
        written = "" if out is None else calibrated_toml(text, result, source=linkage)
    deliver(result, calibration_report(lambda _: written, formats), out, json=json, force=force)


def _measured(
    linkage: sb.Linkage,
    table: Path,
    input_joint: str | None,
    output: str | None,
    column: list[str] | None,
    unit: list[str] | None,
    skip_nan: bool,
) -> tuple[Ends, Measured | MeasuredExtremes]:
    """The joints that a measured table is about, and what it holds of them."""
    from sevenbar.measuring.compare import ends_of
    from sevenbar.measuring.measured import pairs, read_measured

    ends = ends_of(linkage, input_joint, output)
    columns, units = pairs(column or (), "--column"), pairs(unit or (), "--unit")
    return ends, read_measured(table, ends, columns=columns, units=units, skip_nan=skip_nan)


def _start(linkage: sb.Linkage, input_joint: str, start: str) -> float:
    return joint_value(start, "--start", linkage, linkage.columns.index(input_joint))
