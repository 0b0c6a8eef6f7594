"""What the commands share: arguments and options, and the checks of what they are given."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from sevenbar.commands.command import STYLE_HELP, VIEW_HELP, count_of, number_of
from sevenbar.errors import RequestError, check_word, shown
from sevenbar.text.expression import IN_DEGREES, calls_in
from sevenbar.text.units import ANGLES

#: Most designs that one command gives.
MOST_DESIGNS = 50


def _noted(source: str) -> str:
    """States on the error stream how a table was read, since its columns leave room for a misreading."""
    from sevenbar.description.files import note_of

    if note := note_of(source):
        typer.echo(f"{source}: {note}", err=True)
    return source


def _known(incomplete: str) -> list[str]:
    """Names of the gallery that begin so; none leaves the shell to its files."""
    from sevenbar.description.gallery import names

    return [name for name in names() if name.startswith(incomplete)]


def number_option(option: str, example: str, help: str) -> Any:
    """An option that takes a number, or a formula."""
    return typer.Option(parser=number_of(option, example), metavar="NUMBER", help=help)


def count_option(option: str, help: str) -> Any:
    """An option that takes a whole number, perhaps with an exponent."""
    return typer.Option(parser=count_of(option), metavar="COUNT", help=help)


Source = Annotated[
    str,
    typer.Argument(
        metavar="FILE|NAME",
        help="A TOML file, a table (.csv, .xlsx), or a name of the gallery.",
        callback=_noted,
        autocompletion=_known,
    ),
]
GalleryName = Annotated[
    str | None,
    typer.Argument(metavar="[NAME]", help="The one whose file is printed.", autocompletion=_known),
]
Opened = Annotated[
    str,
    typer.Argument(
        metavar="[FILE|NAME]", help="A TOML file, or a name of the gallery.", autocompletion=_known
    ),
]
Mixed = Annotated[bool, typer.Option("--mixed", help="Also with parts of another version or vector unit.")]
Threads = Annotated[
    int | None, typer.Option(help="Threads of this machine; one for each processor by default.")
]
Scheduler = Annotated[str | None, typer.Option(help="Address of a Dask scheduler, as in tcp://host:8786.")]
Follow = Annotated[
    list[str] | None,
    typer.Option(help="A dimension that the file leaves out (L2), to follow from the others; else held."),
]
Samples = Annotated[int, count_option("--samples", "Inputs in a full turn, as in 720 or 1e5.")]
Figures = Annotated[
    list[str] | None,
    typer.Option(help="Format of the figures: png (the default), svg, pdf, eps; may be repeated."),
]
FigureView = Annotated[str | None, typer.Option("--view", help=VIEW_HELP)]
FigureSize = Annotated[
    str | None, typer.Option("--size", help="Size of the figures, as in '85x60mm' or '3.3x2.5in'.")
]
FigureStyle = Annotated[str | None, typer.Option("--style", help=STYLE_HELP)]
Agree = Annotated[
    float | None,
    number_option(
        "--agree",
        "1e-5",
        "Closure error up to which redundant constraints agree, in rad or relative to the size: 1e-9 by "
        "default, 1e-3 at most.",
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace files that are there already.")]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Go on without asking where it is much or long.")]
InputJoint = Annotated[
    str | None, typer.Option("--input", help="The joint that drives; the file's by default.")
]
OutputJoint = Annotated[
    str | None, typer.Option("--output", help="The joint whose motion is reported; the file's by default.")
]
InputValue = Annotated[
    str,
    typer.Option(
        "--at", help="Value of the input: '30deg', '0.5rad', '12mm'; a plain number is in degrees or lengths."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as one JSON object and nothing else.")]
Law = Annotated[
    Path | None,
    typer.Option(
        help="CSV file of an input law: time, value of the input, perhaps its rates; in place of --speed."
    ),
]
LawJoint = Annotated[
    str | None,
    typer.Option("--law-joint", help="The joint whose columns are the law, where its table has several."),
]
LawCircuit = Annotated[
    int | None,
    typer.Option(
        "--law-circuit", help="The circuit that is the law, where its table is a motion of several."
    ),
]
PointName = Annotated[str | None, typer.Option("--point", help="A named point of the linkage.")]
PointLink = Annotated[
    str | None,
    typer.Option("--link", help="The link of a point given by --at, counted from 1; of a net, or its name."),
]
PointPlace = Annotated[
    str | None,
    typer.Option("--at", help="Where on the link, in the file's length unit, as in '-100,-90,-80'."),
]
Speed = Annotated[
    str | None, typer.Option(help="Speed of the input, as in '10 rad/s' or '60 rpm'; the file's by default.")
]

#: Those of `sevenbar design ..`.
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


def words(given: list[str] | None, option: str = "", *, twice: bool = True) -> list[str]:
    """The words of an option that is repeated, or has several parted by commas; each once.

    Raises `RequestError` for an `option` that is given without any, and unless one may come `twice` for that.
    """
    parts = [part.strip() for word in given or () for part in word.split(",")]
    result = list(dict.fromkeys(part for part in parts if part))
    if not twice and len(result) < len([part for part in parts if part]):
        several = next(part for part in result if parts.count(part) > 1)
        raise RequestError(f"{option}: {shown(several)} is given twice; leave one out")
    if given and option and not result:
        raise RequestError(f"{option}: is empty; give what it lists, or leave it out")
    return result


def figure_formats(given: list[str] | None, out: Path | None) -> tuple[str, ...]:
    """Endings of figures, png where none is given; raises `RequestError` for others, and without a folder."""
    if given is None:
        return ("png",)
    from sevenbar.drawing.figure import FORMATS

    endings = tuple(word.lower().removeprefix(".") for word in words(given))
    if not endings:
        raise RequestError(f"--figures: none given; give some of {', '.join(FORMATS)}, or leave it out")
    for ending in endings:
        check_word("--figures", ending, FORMATS, "a figure format")
    if out is None:
        raise RequestError("--figures: a folder for them is missing; give --out, as in '--out report'")
    return endings


def refuse_unused(given: Mapping[str, object], remedy: str) -> None:
    """Raises `RequestError` for options of figures that are given where none is drawn."""
    for option, value in given.items():
        if value not in (None, []):
            raise RequestError(f"{option}: no figure is drawn; give {remedy}")


def kept_in(folder: Path | None) -> str:
    """What Ctrl+C leaves of work that keeps its finished parts in a folder, if it has one."""
    if folder is None:
        return "nothing is written"
    return f"the finished parts are kept in {folder}, --resume goes on with them"


def checked_designs(count: int, most: int = MOST_DESIGNS) -> None:
    """Raises `RequestError` for a number of designs that one command does not give."""
    if not 1 <= count <= most:
        raise RequestError(f"--designs: {count} designs are not offered; give 1 to {most}")


def check_degrees(y: str, x: str, ends: tuple[float, float]) -> None:
    """Raises `RequestError` where sind and the like would take an x in radians.

    States on the error stream, before the search begins, that the sine of an x in degrees was perhaps meant.
    """
    from sevenbar.design.wish import degrees_hint

    with_unit = any(unit in x for unit in (*ANGLES, "\u00b0"))
    if with_unit and (called := sorted(calls_in(y) & IN_DEGREES.keys())):
        raise RequestError(
            f"--x: {shown(x)} counts in radians, and {called[0]} takes degrees; "
            f"write {IN_DEGREES[called[0]]}, or leave the unit of x out"
        )
    if hint := degrees_hint(y, ends):
        typer.echo(f"--y: {hint}", err=True)
