"""The command line: `sevenbar analyze` and the other commands with FILE|NAME, and `sevenbar gallery`."""

from __future__ import annotations

import importlib
import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
import typer.core

import sevenbar as sb
from sevenbar.commands.deliver import check_out, deliver, tell_written
from sevenbar.commands.given import check_law, input_column, input_value, law_of, point_of
from sevenbar.commands.options import (
    Figures,
    Force,
    InputJoint,
    InputValue,
    Json,
    Law,
    OutputJoint,
    PointLink,
    PointName,
    PointPlace,
    Samples,
    Source,
    Speed,
    figure_formats,
    progress_bar,
    words,
)
from sevenbar.errors import RequestError, SevenbarError, shown
from sevenbar.reporting.figures import KINDS, Places, write_figures
from sevenbar.reporting.folder import check_targets
from sevenbar.text.ranges import Place

#: Commands that live with what they do, imported when one of them is asked for: a report should not wait for
#: the studio.
_ELSEWHERE = {
    "axodes": "sevenbar.commands.axodes:axodes",
    "studio": "sevenbar.commands.studio:studio",
    "compare": "sevenbar.commands.compare:compare",
    "calibrate": "sevenbar.commands.compare:calibrate",
    "simulate": "sevenbar.commands.simulate:simulate",
    "export": "sevenbar.commands.export:export",
    "sweep": "sevenbar.commands.sweep:sweep",
    "map": "sevenbar.commands.maps:map_",
    "tolerance": "sevenbar.commands.tolerance:tolerance",
    "design": "sevenbar.commands.design:design",
}


class _Commands(typer.core.TyperGroup):
    """The commands; a linkage in the place of one is told what is missing."""

    def list_commands(self, ctx: Any) -> list[str]:
        return [*super().list_commands(ctx), *_ELSEWHERE]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in _ELSEWHERE:
            return super().get_command(ctx, cmd_name)
        module, _, name = _ELSEWHERE[cmd_name].partition(":")
        found = getattr(importlib.import_module(module), name)
        if isinstance(found, typer.Typer):
            return typer.main.get_command(found)
        alone = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
        alone.command(cmd_name)(found)
        return typer.main.get_command(alone)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        from sevenbar.description.gallery import names

        word = args[0]
        if word not in self.list_commands(ctx) and (word in names() or word.endswith(".toml")):
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
    samples: Samples = 360,
    input_joint: InputJoint = None,
    output: OutputJoint = None,
    speed: Speed = None,
    law: Law = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for report.md, report.json, motion.csv and the figures.")
    ] = None,
    figures: Figures = None,
    animate: Annotated[
        Path | None, typer.Option(help="Write the moving linkage to this .gif or .mp4.")
    ] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Analyse a linkage: motion type, circuits, limits, rates, and what a designer reads of them."""
    from sevenbar.reporting.report import motion_report

    report = motion_report(figure_formats(figures, out))
    check_law(law, speed)
    loaded = sb.load(linkage)
    check_out(report, out, force=force)
    read = law_of(law, loaded, input_joint)
    motion = loaded.motion(samples, input=input_joint, output=output, speed=speed, law=read)
    elsewhere = []
    if animate is not None:
        film = _film(motion, animate, out, force=force)
        if out is not None and _same_folder(animate.parent, out):
            # of the files that appear together
            report = replace(report, files={**report.files, animate.name: film})
        else:
            film(motion, animate)
            elsewhere = [animate]
    deliver(motion, report, out, json=json, force=force, also=elsewhere)


def _film(
    motion: sb.Motion, file: Path, out: Path | None, *, force: bool
) -> Callable[[sb.Motion, Path], object]:
    """What draws the animation; raises where it cannot be, before anything is written."""
    from sevenbar.drawing.animate import animate, check_ending, check_target
    from sevenbar.kinematics.motion import chosen_circuit
    from sevenbar.reporting.figures import posed_circuit

    if out is not None and _same_folder(file.parent, out):
        # a folder that may still have to be made
        check_ending(file)
    else:
        check_target(file)
    check_targets([file], force=force)
    drawn = chosen_circuit(motion, posed_circuit(motion) or 0).index

    def draw(motion: sb.Motion, path: Path) -> None:
        with progress_bar(f"drawing {path.name}") as progress:
            animate(motion, path, circuit=drawn, progress=progress)

    return draw


def _same_folder(folder: Path, other: Path) -> bool:
    """Whether two paths are one folder, which may be there or not."""
    return folder.resolve() == other.resolve()


@app.command()
def modes(
    linkage: Source,
    at: InputValue = "0",
    input_joint: Annotated[
        str | None, typer.Option("--input", help="The joint that is held; the file's input by default.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Draw all modes into this .png, .svg or .pdf.")] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Every assembly mode at one value of the input: each way the loop can be put together."""
    from sevenbar.reporting.report import modes_report

    loaded = sb.load(linkage)
    column = input_column(loaded, input_joint)
    check_targets([] if out is None else [out], force=force)
    found = loaded.assembly_modes(input_value("--at", at, loaded, input_joint), input=loaded.columns[column])
    if out is not None:
        from sevenbar.drawing import plot

        plot.save(plot.modes_overview(loaded, found, input=loaded.columns[column]), out)
    deliver(found, modes_report(loaded, column), json=json, also=[] if out is None else [out])


@app.command("plot")
def plot_(
    linkage: Source,
    out: Annotated[Path, typer.Option(help="Folder for the figures.")],
    kind: Annotated[
        list[str] | None, typer.Option(help=f"{', '.join(KINDS)} or all; may be repeated.")
    ] = None,
    point: PointName = None,
    link: PointLink = None,
    at: PointPlace = None,
    circuit: Annotated[int, typer.Option(help="The circuit that is drawn in space.")] = 0,
    samples: Samples = 360,
    input_joint: InputJoint = None,
    output: OutputJoint = None,
    speed: Speed = None,
    figures: Figures = None,
    force: Force = False,
) -> None:
    """Draw a linkage: curves of the output, all joints, all modes, the linkage in space, a point's path."""
    formats = figure_formats(figures, out)
    kinds = _kinds(kind)
    loaded = sb.load(linkage)
    points = _points(loaded, point_of(point, link, at))
    if "point" in kinds and not points:
        if kind is not None and "point" in kind:
            raise RequestError("--kind: point needs a point; give --link and --at, as the linkage names none")
        kinds.remove("point")
    motion = loaded.motion(samples, input=input_joint, output=output, speed=speed)
    written = write_figures(motion, out, kinds, points, circuit=circuit, figures=formats, force=force)
    tell_written(written, below=False)


def _kinds(given: list[str] | None) -> list[str]:
    kinds = words(given or ["all"])
    if not kinds:
        raise RequestError(f"--kind: none given; give some of {', '.join(KINDS)}, all")
    for word in kinds:
        if word not in (*KINDS, "all"):
            raise RequestError(f"--kind: {shown(word)} is not a figure; allowed: {', '.join(KINDS)}, all")
    return list(KINDS) if "all" in kinds else kinds


def _points(linkage: sb.Linkage, asked: str | tuple[int, Place] | None) -> Places:
    """The points to be drawn, by name: the one asked for, else all that the linkage names."""
    named = {point.name: (point.link, point.at) for point in linkage.points}
    if asked is None:
        return named
    if isinstance(asked, str):
        if asked not in named:
            known = ", ".join(named) or "none; give --link and --at"
            raise RequestError(f"--point: no point {shown(asked)}; this linkage has {known}")
        return {asked: named[asked]}
    link, (u, v, w) = asked
    count = len(linkage.joints)
    if not 1 <= link <= count:
        raise RequestError(f"--link: {link} is not a link; give 1 to {count}, the last is the ground")
    return {f"link {link} ({u:g}, {v:g}, {w:g})": (link, (u, v, w))}


@app.command()
def gallery(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="The one whose file is printed.")
    ] = None,
) -> None:
    """List the linkages that come with Sevenbar, or print the file of one to begin with."""
    from sevenbar.description.gallery import names, nearest, text

    known = names()
    if name is not None and name not in known:
        near = " or ".join(f"'{word}'" for word in nearest(name))
        offer = f"did you mean {near}? " if near else ""
        raise RequestError(f"{name or shown(name)}: no such linkage; {offer}'sevenbar gallery' lists all")
    if name is not None:
        typer.echo(text(name), nl=False)
        return
    width = max(len(name) for name in known)
    for name in known:
        typer.echo(f"{name:<{width}}  {sb.load(name).name}")


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
