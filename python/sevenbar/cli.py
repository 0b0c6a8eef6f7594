"""The command line: `sevenbar analyze` and the other commands with FILE|NAME, and `sevenbar gallery`."""

from __future__ import annotations

import math
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
import typer.core

import sevenbar as sb
from sevenbar.errors import RequestError, SevenbarError, shown

if TYPE_CHECKING:
    from sevenbar.measured import Ends, Measured, MeasuredExtremes

class _Commands(typer.core.TyperGroup):
    """The commands; a linkage in the place of one is told what is missing."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        from sevenbar.gallery import names

        word = args[0]
        if word not in self.commands and (word in names() or word.endswith(".toml")):
            raise RequestError(
                f"{word}: is a linkage, where a command should stand; give: sevenbar analyze {word}"
            )
        return super().resolve_command(ctx, args)


app = typer.Typer(
    name="sevenbar",
    cls=_Commands,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Kinematics of closed spatial linkages: every assembly mode, whole circuits, exact rates.",
)


Source = Annotated[str, typer.Argument(metavar="FILE|NAME", help="A TOML file, or a name of the gallery.")]


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    if version:
        typer.echo(sb.__version__)
        raise typer.Exit


@app.command()
def analyze(
    linkage: Source,
    samples: Annotated[int, typer.Option(help="Inputs in a full turn.")] = 360,
    input_joint: Annotated[
        str | None, typer.Option("--input", help="The joint that drives; the file's by default.")
    ] = None,
    output: Annotated[
        str | None, typer.Option("--output", help="The joint whose motion is told; the file's by default.")
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help="Speed of the input, as in '10 rad/s' or '60 rpm'.")
    ] = None,
    law: Annotated[
        Path | None,
        typer.Option(help="CSV file of an input law: time, value of the input, perhaps its rates."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for report.md, report.json, motion.csv and the figures.")
    ] = None,
    figures: Annotated[
        list[str] | None, typer.Option(help="Format of the figures: png, svg, pdf; may be repeated.")
    ] = None,
    animate: Annotated[
        Path | None, typer.Option(help="Write the moving linkage to this .gif or .mp4.")
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the report as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Analyse a linkage: motion type, circuits, limits, rates, and what a designer reads of them."""
    from sevenbar import report

    endings = _figure_formats(figures)
    if figures is not None and out is None:
        raise RequestError("--figures: a folder for them is missing; give --out, as in '--out report'")
    if law is not None and speed is not None:
        raise RequestError("--speed: a law gives the speed; leave --speed or --law out")
    loaded = sb.load(linkage)
    read = None if law is None else sb.load_law(law, loaded, input=input_joint)
    motion = loaded.motion(samples, input=input_joint, output=output, speed=speed, law=read)
    if animate is not None:
        from sevenbar.animate import animate as write_animation
        from sevenbar.animate import check_target
        from sevenbar.figure import chosen_circuit

        # before anything is written
        check_target(animate)
        drawn = chosen_circuit(motion, report.posed_circuit(motion) or 0).index
    written = report.write(motion, out, endings) if out is not None else []
    if animate is not None:
        with _progress_bar(f"drawing {animate.name}") as progress:
            write_animation(motion, animate, circuit=drawn, progress=progress)
        written.append(animate)
    if json:
        typer.echo(report.as_json(motion))
        return
    report.print_text(motion)
    if written:
        typer.echo("\nwritten: " + "\n         ".join(str(path) for path in written))


@app.command()
def modes(
    linkage: Source,
    at: Annotated[
        str,
        typer.Option(
            help="Value of the input: '30deg', '0.5rad', '12mm'; a plain number is in degrees or lengths."
        ),
    ] = "0",
    input_joint: Annotated[
        str | None, typer.Option("--input", help="The joint that is held; the file's input by default.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Draw all modes into this .png, .svg or .pdf.")] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the modes as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Every assembly mode at one value of the input: each way the loop can be put together."""
    from sevenbar import report

    loaded = sb.load(linkage)
    column = loaded.column(loaded.drive.joint if input_joint is None else input_joint, "--input")
    found = loaded.assembly_modes(
        report.joint_value(at, "--at", loaded, column), input=loaded.columns[column]
    )
    if out is not None:
        from sevenbar import plot

        plot.save(plot.modes_overview(loaded, found, input=loaded.columns[column]), out)
    if json:
        typer.echo(report.modes_json(loaded, found, column))
        return
    report.print_modes(loaded, found, column)
    if out is not None:
        typer.echo(f"\nwritten: {out}")


#: What `sevenbar plot` can draw.
KINDS = ("curves", "joints", "modes", "configuration", "point")


@app.command("plot")
def plot_(
    linkage: Source,
    out: Annotated[Path, typer.Option(help="Folder for the figures.")],
    kind: Annotated[
        list[str] | None, typer.Option(help=f"{', '.join(KINDS)} or all; may be repeated.")
    ] = None,
    point: Annotated[str | None, typer.Option(help="A named point of the linkage.")] = None,
    link: Annotated[int | None, typer.Option(help="The link of a point given by --at.")] = None,
    at: Annotated[str | None, typer.Option(help="Where on the link, as in '-100,-90,-80'.")] = None,
    circuit: Annotated[int, typer.Option(help="The circuit that is drawn in space.")] = 0,
    samples: Annotated[int, typer.Option(help="Inputs in a full turn.")] = 360,
    input_joint: Annotated[str | None, typer.Option("--input", help="The joint that drives.")] = None,
    output: Annotated[str | None, typer.Option("--output", help="The joint that is driven.")] = None,
    figures: Annotated[
        list[str] | None, typer.Option(help="Format of the figures: png, svg, pdf; may be repeated.")
    ] = None,
) -> None:
    """Draw a linkage: curves of the output, all joints, all modes, the linkage in space, a point's path."""
    from sevenbar import report

    endings = _figure_formats(figures)
    kinds = _kinds(kind)
    loaded = sb.load(linkage)
    points = _points(loaded, point, link, at)
    if "point" in kinds and not points:
        if kind is not None and "point" in kind:
            raise RequestError("--kind: point needs a point; give --link and --at, as the linkage names none")
        kinds.remove("point")
    motion = loaded.motion(samples, input=input_joint, output=output)
    written = report.write_figures(motion, out, kinds, points, circuit=circuit, figures=endings)
    typer.echo("written: " + "\n         ".join(str(path) for path in written))


def _kinds(given: list[str] | None) -> list[str]:
    words = _words(given or ["all"])
    for word in words:
        if word not in (*KINDS, "all"):
            raise RequestError(f"--kind: {shown(word)} is not a figure; allowed: {', '.join(KINDS)}, all")
    return list(KINDS) if "all" in words else words


def _points(
    linkage: sb.Linkage, name: str | None, link: int | None, at: str | None
) -> dict[str, tuple[int, tuple[float, float, float]]]:
    """The points to be drawn, by name: the one asked for, else all that the linkage names."""
    named = {point.name: (point.link, point.at) for point in linkage.points}
    if name is not None:
        if link is not None or at is not None:
            raise RequestError("--point: a name or --link with --at, not both; give one of them")
        if name not in named:
            known = ", ".join(named) or "none; give --link and --at"
            raise RequestError(f"--point: no point {shown(name)}; this linkage has {known}")
        return {name: named[name]}
    if (link is None) != (at is None):
        missing = "--at" if at is None else "--link"
        raise RequestError(f"{missing}: missing; a point of a link needs --link and --at")
    if link is None or at is None:
        return named
    count = len(linkage.joints)
    if not 1 <= link <= count:
        raise RequestError(f"--link: {link} is not a link; give 1 to {count}, the last is the ground")
    try:
        u, v, w = (float(word) for word in at.split(","))
    except ValueError:
        u = v = w = math.nan
    if not all(math.isfinite(value) for value in (u, v, w)):
        raise RequestError(f"--at: {shown(at)} is not a place; give three numbers, as in '-100,-90,-80'")
    return {f"link {link} ({u:g}, {v:g}, {w:g})": (link, (u, v, w))}


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
Force = Annotated[bool, typer.Option("--force", help="Replace files that are there already.")]
Figures = Annotated[
    list[str] | None, typer.Option(help="Format of the figures: png, svg, pdf; may be repeated.")
]
InputJoint = Annotated[str | None, typer.Option("--input", help="The joint that drives.")]
Output = Annotated[str | None, typer.Option("--output", help="The joint that was measured.")]
Speed = Annotated[str | None, typer.Option(help="Speed of the input, as in '10 rad/s' or '60 rpm'.")]
Start = Annotated[
    str, typer.Option(help="Input at time 0 where the table has no input, as in '30deg' or '5mm'.")
]
ChosenCircuit = Annotated[int | None, typer.Option(help="The circuit; the one of least misfit by default.")]
ChosenBranch = Annotated[int | None, typer.Option(help="The pass of the circuit, for an input that rocks.")]


@app.command("compare")
def compare_(
    linkage: Source,
    table: Table,
    align: Annotated[
        list[str] | None, typer.Option(help="Find the zero of the input (phase), of the output (offset).")
    ] = None,
    column: Columns = None,
    unit: Units = None,
    skip_nan: SkipNan = False,
    input_joint: InputJoint = None,
    output: Output = None,
    speed: Speed = None,
    start: Start = "0",
    circuit: ChosenCircuit = None,
    branch: ChosenBranch = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for comparison.json, table.csv, rows.csv and the figure.")
    ] = None,
    figures: Figures = None,
    force: Force = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the comparison as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Compare measured values with the computed motion: differences, and the paper's Table 1."""
    from sevenbar import findings
    from sevenbar.compare import Comparison, compare
    from sevenbar.extremes import ExtremesComparison, compare_extremes
    from sevenbar.measured import MeasuredExtremes

    endings = _figure_formats(figures)
    loaded = sb.load(linkage)
    ends, measured = _measured(loaded, table, input_joint, output, column, unit, skip_nan)
    found: Comparison | ExtremesComparison
    if isinstance(measured, MeasuredExtremes):
        if align:
            raise RequestError(
                "--align: a table of lowest and highest values has no rows to align; leave it out"
            )
        found = compare_extremes(loaded, measured, ends, speed=speed, circuit=circuit)
    else:
        begin = _start(loaded, ends.input, start)
        found = compare(
            loaded,
            measured,
            ends,
            align=align or (),
            speed=speed,
            start=begin,
            circuit=circuit,
            branch=branch,
        )
    written = [] if out is None else findings.write_comparison(found, out, endings, force=force)
    if json:
        typer.echo(findings.comparison_json(found))
        return
    findings.print_comparison(found)
    if written:
        typer.echo("\nwritten: " + "\n         ".join(str(path) for path in written))


@app.command("calibrate")
def calibrate_(
    linkage: Source,
    table: Table,
    free: Annotated[
        list[str] | None,
        typer.Option(help="A dimension to be found, or a pattern; may be repeated. All by default."),
    ] = None,
    hold: Annotated[
        list[str] | None, typer.Option(help="A dimension to be kept, or a pattern; may be repeated.")
    ] = None,
    offset: Annotated[
        list[str] | None, typer.Option(help="Find the zero of a measured joint too: input, output.")
    ] = None,
    column: Columns = None,
    unit: Units = None,
    skip_nan: SkipNan = False,
    input_joint: InputJoint = None,
    output: Output = None,
    speed: Speed = None,
    start: Start = "0",
    circuit: ChosenCircuit = None,
    branch: ChosenBranch = None,
    confidence: Annotated[float, typer.Option(help="How often an interval holds the true value.")] = 0.95,
    out: Annotated[
        Path | None, typer.Option(help="Folder for calibrated.toml, calibration.json, tables and the figure.")
    ] = None,
    figures: Figures = None,
    force: Force = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the calibration as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Find the real dimensions that explain a measured curve, with intervals, and write them as a linkage."""
    from sevenbar import findings
    from sevenbar.calibrate import calibrate
    from sevenbar.files import text_of
    from sevenbar.measured import MeasuredExtremes
    from sevenbar.rewrite import calibrated_toml

    endings = _figure_formats(figures)
    loaded = sb.load(linkage)
    ends, measured = _measured(loaded, table, input_joint, output, column, unit, skip_nan)
    if isinstance(measured, MeasuredExtremes):
        raise RequestError(
            f"{table}: lowest and highest values are too few to tell dimensions; give the measured rows"
        )
    found = calibrate(
        loaded,
        measured,
        ends,
        free=free or ("*",),
        hold=hold or (),
        offsets=offset or (),
        speed=speed,
        start=_start(loaded, ends.input, start),
        circuit=circuit,
        branch=branch,
        confidence=confidence,
    )
    toml = calibrated_toml(text_of(linkage), found)
    written = [] if out is None else findings.write_calibration(found, toml, out, endings, force=force)
    if json:
        typer.echo(findings.calibration_json(found))
        return
    findings.print_calibration(found)
    if written:
        typer.echo("\nwritten: " + "\n         ".join(str(path) for path in written))


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
    from sevenbar.compare import ends_of
    from sevenbar.measured import pairs, read_measured

    ends = ends_of(linkage, input_joint, output)
    columns, units = pairs(column or (), "--column"), pairs(unit or (), "--unit")
    return ends, read_measured(table, ends, columns=columns, units=units, skip_nan=skip_nan)


def _start(linkage: sb.Linkage, input_joint: str, start: str) -> float:
    from sevenbar import report

    return report.joint_value(start, "--start", linkage, linkage.columns.index(input_joint))


@app.command()
def simulate(
    linkage: Source,
    engine: Annotated[str, typer.Option(help="exudyn (hard constraints) or mujoco (soft ones).")] = "exudyn",
    steps: Annotated[int, typer.Option(help="Steps in a full turn of the input.")] = 3600,
    circuit: Annotated[int, typer.Option(help="The circuit that is followed.")] = 0,
    input_joint: Annotated[
        str | None, typer.Option("--input", help="The joint that drives; the file's by default.")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("--output", help="The joint whose rates are compared; the file's by default."),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help="Speed of the input, as in '10 rad/s' or '60 rpm'.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the JSON, the CSV and the figures.")] = None,
    figures: Annotated[
        list[str] | None, typer.Option(help="Format of the figures: png, svg, pdf; may be repeated.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over files that exist.")] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print the result as one JSON object and nothing else.")
    ] = False,
) -> None:
    """Build the linkage in another program, drive it, and compare (extra 'simulate')."""
    from sevenbar import simulation_report
    from sevenbar.simulate import moved, prepared, ready

    endings = _figure_formats(figures)
    ready(engine)
    loaded = sb.load(linkage)
    if out is not None and not force:
        # before the long run
        simulation_report.refuse_existing(
            simulation_report.targets(engine, out, endings, bool(loaded.points))
        )
    way, model = prepared(loaded, steps=steps, circuit=circuit, input=input_joint, output=output, speed=speed)
    with _progress_bar(f"{engine}: {loaded.name}") as progress:
        run = moved(way, model, engine, progress)
    written = simulation_report.write(run, out, endings, force=force) if out is not None else []
    if json:
        typer.echo(simulation_report.as_json(run))
        return
    simulation_report.print_text(run)
    if written:
        typer.echo("\nwritten: " + "\n         ".join(str(path) for path in written))


@app.command()
def export(
    linkage: Source,
    to: Annotated[
        str | None,
        typer.Option(help="csv, parquet, npz, mat, json, glb, stl, step, urdf, cmd; by --out's ending."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="The file to write; the linkage's name with --to's ending by default.")
    ] = None,
    circuit: Annotated[
        int | None, typer.Option(help="The circuit whose pose is written; 0 by default.")
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(help="The input of the pose: '30deg', '0.5rad', '12mm'; a plain number is in degrees."),
    ] = None,
    branch: Annotated[
        int | None, typer.Option(help="The pass of a circuit that rocks; 0 by default.")
    ] = None,
    samples: Annotated[int, typer.Option(help="Inputs in a full turn.")] = 360,
    input_joint: Annotated[str | None, typer.Option("--input", help="The joint that drives.")] = None,
    output: Annotated[str | None, typer.Option("--output", help="The joint that is driven.")] = None,
    speed: Annotated[str | None, typer.Option(help="Speed of the input, as in '10 rad/s'.")] = None,
    units: Annotated[
        str | None, typer.Option(help="Of tables: file (the default), or si for metres and radians.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that exist.")] = False,
) -> None:
    """Write a linkage for another program: its motion as a table, its bodies in one pose, a model."""
    from sevenbar import report
    from sevenbar.export import FORMATS, format_of
    from sevenbar.export import export as write_export

    if out is None:
        if to is None:
            raise RequestError(f"--to: missing; give a format, {', '.join(FORMATS)}, or --out")
        out = Path(f"{Path(linkage).stem}.{to.lower().removeprefix('.')}")
    format_of(out, to)
    loaded = sb.load(linkage)
    value = None
    if at is not None:
        column = loaded.column(loaded.drive.joint if input_joint is None else input_joint, "--input")
        value = report.joint_value(at, "--at", loaded, column)
    written = write_export(
        loaded.motion(samples, input=input_joint, output=output, speed=speed),
        to,
        out,
        circuit=circuit,
        at=value,
        branch=branch,
        units=units,  # type: ignore[arg-type]
        force=force,
    )
    typer.echo("written: " + "\n         ".join(str(path) for path in written))
    if out.suffix.lower() == ".urdf":
        typer.echo("URDF holds trees only: the joint that closes the loop is in the .loop.json file")


@app.command()
def gallery(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="The one whose file is printed.")
    ] = None,
) -> None:
    """List the linkages that come with Sevenbar, or print the file of one to begin with."""
    from sevenbar.gallery import names, nearest, text

    known = names()
    if name is not None and name not in known:
        near = " or ".join(f"'{word}'" for word in nearest(name))
        offer = f"did you mean {near}? " if near else ""
        raise RequestError(f"{name}: no such linkage; {offer}'sevenbar gallery' lists all")
    if name is not None:
        typer.echo(text(name), nl=False)
        return
    width = max(len(name) for name in known)
    for name in known:
        typer.echo(f"{name:<{width}}  {sb.load(name).name}")


def _words(given: list[str]) -> list[str]:
    """The words of an option that is repeated, or has several parted by commas; each once."""
    parts = [part.strip() for word in given for part in word.split(",")]
    return list(dict.fromkeys(part for part in parts if part))


def _figure_formats(given: list[str] | None) -> tuple[str, ...]:
    if given is None:
        return ("png",)
    from sevenbar.figure import FORMATS

    endings = tuple(word.lower().removeprefix(".") for word in _words(given))
    for ending in endings:
        if ending not in FORMATS:
            raise RequestError(
                f"--figures: {shown(ending)} is not a figure format; allowed: {', '.join(FORMATS)}"
            )
    return endings


@contextmanager
def _progress_bar(title: str) -> Iterator[Callable[[int, int], None]]:
    """A bar on the error stream, so that what is printed can be piped on."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(title, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def main() -> NoReturn:
    """The program: exit 0 well, 2 the caller's mistake, 1 our own fault."""
    try:
        app(standalone_mode=True, prog_name="sevenbar")
    except SevenbarError as error:
        sys.stderr.write("".join(f"sevenbar: {line}\n" for line in str(error).splitlines()))
        sys.exit(2)
    except Exception:
        traceback.print_exc()
        sys.stderr.write(
            "sevenbar: this is a fault of Sevenbar, not yours; please report it with the lines above\n"
        )
        sys.exit(1)
    sys.exit(0)


if __name__ == "__main__":
    main()
