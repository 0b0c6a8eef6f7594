"""The command line: `sevenbar analyze FILE|NAME`, `sevenbar gallery`."""

from __future__ import annotations

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


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    if version:
        typer.echo(sb.__version__)
        raise typer.Exit


@app.command()
def analyze(
    linkage: Annotated[
        str, typer.Argument(metavar="FILE|NAME", help="A TOML file, or a name of the gallery.")
    ],
    samples: Annotated[int, typer.Option(help="Inputs in a full turn.")] = 360,
    input_joint: Annotated[
        str | None, typer.Option("--input", help="The joint that drives; the file's by default.")
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
    motion = sb.load(linkage).motion(samples, input=input_joint, speed=speed)
    if animate is not None:
        from sevenbar.animate import animate as write_animation
        from sevenbar.animate import check_target
        from sevenbar.plot import chosen_circuit

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
def gallery() -> None:
    """List the linkages that come with Sevenbar."""
    from sevenbar.gallery import names

    for name in names():
        typer.echo(f"{name:<12} {sb.load(name).name}")


def _figure_formats(given: list[str] | None) -> tuple[str, ...]:
    if given is None:
        return ("png",)
    from sevenbar.plot import FORMATS

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
