"""The command line: `sevenbar analyze`, `modes`, `plot`, `simulate` with FILE|NAME; `gallery`."""

from __future__ import annotations

import math
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, NoReturn

import typer

import sevenbar as sb
from sevenbar.errors import RequestError, SevenbarError, shown

app = typer.Typer(
    name="sevenbar",
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
    out: Annotated[
        Path | None, typer.Option(help="Folder for report.json, motion.csv and the figures.")
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
    motion = sb.load(linkage).motion(samples, input=input_joint, output=output, speed=speed)
    if animate is not None:
        from sevenbar.animate import animate as write_animation
        from sevenbar.animate import check_target
        from sevenbar.figure import chosen_circuit

        # before anything is written
        check_target(animate)
        chosen_circuit(motion, 0)
    written = report.write(motion, out, endings) if out is not None else []
    if animate is not None:
        with _progress_bar(f"drawing {animate.name}") as progress:
            write_animation(motion, animate, progress=progress)
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
    words = list(dict.fromkeys(given or ["all"]))
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
def gallery() -> None:
    """List the linkages that come with Sevenbar."""
    from sevenbar.gallery import names

    known = names()
    width = max(len(name) for name in known)
    for name in known:
        typer.echo(f"{name:<{width}}  {sb.load(name).name}")


def _figure_formats(given: list[str] | None) -> tuple[str, ...]:
    if given is None:
        return ("png",)
    from sevenbar.figure import FORMATS

    endings = tuple(dict.fromkeys(word.lower().removeprefix(".") for word in given))
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
        app(standalone_mode=True)
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
