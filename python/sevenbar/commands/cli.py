"""The command line: `sevenbar analyze` and the other commands with FILE|NAME, and `sevenbar gallery`."""

from __future__ import annotations

import importlib
import os
import sys
import traceback
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, NoReturn, TextIO

import typer
import typer.core

import sevenbar as sb
from sevenbar.commands import options
from sevenbar.commands.command import Command
from sevenbar.commands.consent import confirm, long_motion, table_ahead
from sevenbar.commands.deliver import check_out, deliver, tell_written, write_files
from sevenbar.commands.given import check_law, film_of, input_value, law_of, look_of, opened, point_of
from sevenbar.commands.output import safe_output
from sevenbar.commands.progress import progress_bar
from sevenbar.commands.signals import NOTHING, at_work, has_just_come, heed_signals, stopped
from sevenbar.drawing.asked import PATH_PARTS
from sevenbar.errors import (
    AngleUnitWarning,
    MissingFontWarning,
    RequestError,
    SevenbarError,
    check_word,
    shown,
)
from sevenbar.kinematics.circuits.motion import chosen_circuit
from sevenbar.kinematics.linkage import sample_count
from sevenbar.reporting.facts import idle_note
from sevenbar.reporting.figures import KINDS, USUAL_KINDS, FigureLook, Places, figures_report
from sevenbar.reporting.folder import Stopped, check_folder_name, check_targets
from sevenbar.text.ranges import Place

#: Samples a turn of a motion that is drawn: two for each dot of a wide figure.
MOST_DRAWN = 3600

#: Commands that live with what they do, imported when one of them is called: a report should not wait for
#: the studio.
_ELSEWHERE = {
    "axodes": "sevenbar.commands.axodes:axodes",
    "forces": "sevenbar.commands.forces:forces",
    "studio": "sevenbar.commands.studio:studio",
    "compare": "sevenbar.commands.compare:compare",
    "calibrate": "sevenbar.commands.compare:calibrate",
    "simulate": "sevenbar.commands.simulate:simulate",
    "export": "sevenbar.commands.export:export",
    "axes": "sevenbar.commands.axes:axes",
    "free": "sevenbar.commands.free:free",
    "sweep": "sevenbar.commands.sweep:sweep",
    "map": "sevenbar.commands.maps:map_",
    "tolerance": "sevenbar.commands.tolerance:tolerance",
    "design": "sevenbar.commands.design:design",
}


class _Commands(typer.core.TyperGroup):
    """The commands; a linkage in the place of one gets a message."""

    def list_commands(self, ctx: Any) -> list[str]:
        return [*super().list_commands(ctx), *_ELSEWHERE]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in _ELSEWHERE:
            return super().get_command(ctx, cmd_name)
        module, _, name = _ELSEWHERE[cmd_name].partition(":")
        command = getattr(importlib.import_module(module), name)
        if isinstance(command, typer.Typer):
            return typer.main.get_command(command)
        alone = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
        alone.command(cmd_name, cls=Command)(command)
        return typer.main.get_command(alone)

    def invoke(self, ctx: Any) -> Any:
        """Runs the command; Ctrl+C outside of what has a bar of its own names whole files, if any."""
        try:
            with at_work():
                return super().invoke(ctx)
        except (KeyboardInterrupt, Exception) as error:
            # a signal in the import of a library may come out as that it is missing
            if isinstance(error, KeyboardInterrupt) or (_is_error(error) and has_just_come()):
                words = f"stopped; {error.kept}" if isinstance(error, Stopped) else NOTHING
                typer.echo(f"sevenbar: {words}", err=True)
                raise typer.Exit(stopped()) from None
            raise

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        from sevenbar.description.files import TABLE_ENDINGS
        from sevenbar.description.gallery import names

        word = args[0]
        endings = (".toml", *TABLE_ENDINGS)
        if word not in self.list_commands(ctx) and (word in names() or word.lower().endswith(endings)):
            raise RequestError(
                f"{word}: is a linkage, where a command should stand; give: sevenbar analyze {word}"
            )
        return super().resolve_command(ctx, args)


def _is_error(error: Exception) -> bool:
    """Whether it is an error, and not the end of a command in good order."""
    return not isinstance(error, typer.Exit | typer.Abort) and not hasattr(error, "exit_code")


app = typer.Typer(
    name="sevenbar",
    cls=_Commands,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
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


@app.command(cls=Command)
def analyze(
    linkage: options.Source,
    samples: options.Samples = 360,
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    speed: options.Speed = None,
    law: options.Law = None,
    law_joint: options.LawJoint = None,
    law_circuit: options.LawCircuit = None,
    agree: options.Agree = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for report.md, report.json, motion.csv and the figures.")
    ] = None,
    figures: options.Figures = None,
    animate: Annotated[
        Path | None, typer.Option(help="Write the moving linkage to this .gif, .mp4 or .html.")
    ] = None,
    circuit: Annotated[
        int | None, typer.Option(help="The circuit that is drawn and filmed; the first by default.")
    ] = None,
    ranges: Annotated[
        bool, typer.Option("--ranges", help="Tables of the ranges of all joints, and the bends of balls.")
    ] = False,
    brief: Annotated[
        bool,
        typer.Option("--brief", help="Print what the linkage does, not how it is written and was found."),
    ] = False,
    view: options.FigureView = None,
    size: options.FigureSize = None,
    style: options.FigureStyle = None,
    fps: Annotated[
        float | None, options.number_option("--fps", "30", "Pictures a second of the film.")
    ] = None,
    seconds: Annotated[float | None, options.number_option("--seconds", "10", "Length of the film.")] = None,
    force: options.Force = False,
    yes: options.Yes = False,
    json: options.Json = False,
) -> None:
    """Analyse a linkage: motion type, circuits, limits, rates, and what a designer reads of them."""
    from sevenbar.reporting.report import motion_report

    look = look_of(view, size, style)
    formats = options.figure_formats(figures, out)
    film_look = film_of(fps, seconds, animate)
    if out is None and animate is None:
        unused = {"--circuit": circuit, "--view": view, "--size": size, "--style": style}
        options.refuse_unused(unused, "--out, --animate, or both")
    check_law(law, speed)
    if not json:
        # the report has it
        warnings.simplefilter("ignore", AngleUnitWarning)
    loaded = opened(linkage, agree)
    read = law_of(law, loaded, input_joint, law_joint, law_circuit)
    if loaded.net is not None:
        from sevenbar.reporting.net import NET, driven_by

    if loaded.net is not None and (moved_net := driven_by(loaded, input_joint, speed)).mobility().finite != 1:
        # there is no motion to report
        if animate is not None:
            raise RequestError("--animate: no one input moves it; leave it out, the report says why")
        sample_count("samples", samples)
        loaded.end_columns(input_joint, output)
        check_out(NET, out, force=force)
        deliver(moved_net, NET, out, json=json, force=force)
        return
    report = motion_report(formats)
    check_out(report, out, force=force)
    moved = partial(loaded.motion, input=input_joint, output=output, speed=speed, law=read)
    if out is not None and read is None:
        confirm(table_ahead(moved, samples, "motion.csv"), yes=yes)
    motion = long_motion(moved, samples)
    if circuit is not None:
        chosen_circuit(motion, circuit)
    # more rows than that are no better to look at
    seen = motion if motion.samples <= MOST_DRAWN or read is not None else moved(MOST_DRAWN)
    report = motion_report(formats, lambda _: seen, circuit=circuit, look=look, ranges=ranges, short=brief)
    elsewhere: dict[Path, Callable[[Path], object]] = {}
    if animate is not None:
        film = _film(seen, animate, out, circuit, look, film_look, force=force)
        if out is not None and _same_folder(animate.parent, out):
            # of the files that appear together
            report = replace(report, pages={**report.pages, animate.name: lambda _, path: film(path)})
        else:
            elsewhere[animate] = film
    deliver(motion, report, out, json=json, force=force, also=elsewhere)


def _film(
    motion: sb.Motion,
    file: Path,
    out: Path | None,
    circuit: int | None,
    look: FigureLook,
    film: dict[str, Any],
    *,
    force: bool,
) -> Callable[[Path], object]:
    """What draws the animation; raises where it cannot be, before anything is written."""
    from sevenbar.drawing.animate import animate, check_ending, check_film, check_target
    from sevenbar.reporting.figures import posed_circuit

    if out is not None and _same_folder(file.parent, out):
        # a folder that may still have to be made
        check_ending(file)
    else:
        check_target(file)
    check_targets([file], force=force)
    check_film(file, **film)
    if not motion.circuits:
        raise RequestError(
            f"--animate: {motion.motion_type}, there is no motion to draw; leave it out, the report says why"
        )
    posed = posed_circuit(motion) or 0 if circuit is None else circuit
    drawn = chosen_circuit(motion, posed).index

    def draw(path: Path) -> None:
        with progress_bar(f"drawing {path.name}", kept=None) as progress:
            animate(motion, path, circuit=drawn, progress=progress, **look.of_pictures, **film)

    return draw


def _same_folder(folder: Path, other: Path) -> bool:
    """Whether two paths are one folder, which may be there or not."""
    return folder.resolve() == other.resolve()


@app.command(cls=Command)
def modes(
    linkage: options.Source,
    at: Annotated[
        str | None,
        typer.Option(
            help="Value of the input: '30deg', '0.5rad', '12mm'; a plain number is in degrees or lengths. "
            "Where it is given, rates of joints, points and links are printed, too; else it is 0."
        ),
    ] = None,
    input_joint: Annotated[
        str | None, typer.Option("--input", help="The joint that is held; the file's input by default.")
    ] = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    out: Annotated[Path | None, typer.Option(help="Draw all modes into this .png, .svg or .pdf.")] = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Every assembly mode at one value of the input, each way the loop can be put together; its rates."""
    from sevenbar.commands.poses import rates_at
    from sevenbar.reporting.report import modes_report

    loaded = opened(linkage, agree)
    column = loaded.input_column(input_joint, "--input")
    if out is not None:
        from sevenbar.drawing.figure import format_of

        format_of(out)
        check_targets([out], force=force)
    value = input_value("--at", "0" if at is None else at, loaded, input_joint)
    result = loaded.assembly_modes(value, input=loaded.columns[column])
    poses, limit = rates_at(loaded, column, value, speed, result)

    def draw(path: Path) -> None:
        from sevenbar.drawing import plot

        plot.save(plot.modes_overview(loaded, result, input=loaded.columns[column]), path)

    report = modes_report(loaded, column, poses, limit=limit, rates=at is not None)
    deliver(result, report, json=json, also={} if out is None else {out: draw})


@app.command("plot", cls=Command)
def plot_(
    linkage: options.Source,
    out: Annotated[Path, typer.Option(help="Folder for the figures.")],
    kind: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{', '.join(KINDS)}, or all (the default), without the last three; may be repeated. "
            "coupler: a point's path alone; skeleton: the linkage in one pose, without numbers and legend."
        ),
    ] = None,
    point: options.PointName = None,
    link: options.PointLink = None,
    at: options.PointPlace = None,
    circuit: Annotated[
        int, typer.Option(help="The circuit of the pictures of the linkage, counted from 0.")
    ] = 0,
    samples: options.Samples = 360,
    input_joint: options.InputJoint = None,
    output: options.OutputJoint = None,
    speed: options.Speed = None,
    agree: options.Agree = None,
    figures: options.Figures = None,
    view: options.FigureView = None,
    size: options.FigureSize = None,
    style: options.FigureStyle = None,
    parts: Annotated[
        list[str] | None,
        typer.Option(
            help="Of a point's figure: path, velocity, acceleration, speed; all but path by default."
        ),
    ] = None,
    no_title: Annotated[bool, typer.Option("--no-title", help="Figures without titles.")] = False,
    force: options.Force = False,
) -> None:
    """Draw a linkage: curves of the output, all joints, all modes, the linkage in space, a point's path."""
    check_folder_name(out)
    formats = options.figure_formats(figures, out)
    kinds = _kinds(kind)
    chosen = None if parts is None else tuple(options.words(parts))
    for part in chosen or ():
        check_word("--parts", part, PATH_PARTS, "a part of a point's figure")
    look = replace(look_of(view, size, style), title=not no_title, parts=chosen)
    loaded = opened(linkage, agree)
    points = _points(loaded, point_of(point, link, at, loaded))
    for one in {"point", "coupler"} & set(kinds) if not points else ():
        if kind is not None and one in options.words(kind):
            raise RequestError(
                f"--kind: {one} needs a point; give --link and --at, as the linkage names none"
            )
        kinds.remove(one)
    # more rows than that are no better to look at
    motion = loaded.motion(
        min(sample_count("samples", samples), MOST_DRAWN),
        input=input_joint, output=output, speed=speed,
    )  # fmt: skip
    if "transmission" in kinds and all(one.transmission_angle is None for one in motion):
        if kind is not None and "transmission" in kind:
            raise RequestError("--kind: this linkage has no transmission angle; leave transmission out")
        kinds.remove("transmission")
    report = figures_report(kinds, points, circuit, formats, look)
    tell_written(write_files(report, motion, out, force=force), below=False)
    drawn = [link for link, _ in points.values()] if {"point", "coupler"} & set(kinds) else []
    if idle := idle_note(loaded, drawn):
        typer.echo(idle)


def _kinds(given: list[str] | None) -> list[str]:
    kinds = options.words(given or ["all"])
    if not kinds:
        raise RequestError(f"--kind: none given; give some of {', '.join(KINDS)}, all")
    for word in kinds:
        check_word("--kind", word, (*KINDS, "all"), "a figure")
    return list(USUAL_KINDS) if "all" in kinds else kinds


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
    return {f"{linkage.link_name(link)} ({u:g}, {v:g}, {w:g})": (link, (u, v, w))}


@app.command(cls=Command)
def gallery(
    name: options.GalleryName = None,
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


#: Warnings of fonts that this program has written.
_warned: set[str] = set()


def _tell_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Writes a warning of ours as one line on the error stream, any other as Python does."""
    text = warnings.formatwarning(message, category, filename, lineno, line)
    if issubclass(category, MissingFontWarning):
        # of each figure, and the registry of what was said once is emptied on the way
        if str(message) in _warned:
            return
        _warned.add(str(message))
    if issubclass(category, (AngleUnitWarning, MissingFontWarning)):
        text = f"sevenbar: {message}\n"
    (file or sys.stderr).write(text)


def main() -> NoReturn:
    """The program: exit 0 well, 2 the caller's mistake, 1 our own fault."""
    # looking for plugins reads the metadata of every package that is installed
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # no window is opened, whatever backend matplotlib is set to
    os.environ["MPLBACKEND"] = "agg"
    heed_signals()
    with warnings.catch_warnings():
        warnings.showwarning = _tell_warning
        warnings.simplefilter("always", AngleUnitWarning)
        warnings.simplefilter("always", MissingFontWarning)
        _run()


def _run() -> NoReturn:
    try:
        with safe_output():
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
