"""What the commands share: arguments and options, and how progress is shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from sevenbar.errors import RequestError, shown

Source = Annotated[str, typer.Argument(metavar="FILE|NAME", help="A TOML file, or a name of the gallery.")]
Samples = Annotated[int, typer.Option(help="Inputs in a full turn.")]
Figures = Annotated[
    list[str] | None, typer.Option(help="Format of the figures: png, svg, pdf; may be repeated.")
]
Agree = Annotated[
    float | None,
    typer.Option(
        help="Closure error up to which redundant constraints agree, in rad or relative to the size: "
        "1e-9 by default, 1e-3 at most."
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace files that are there already.")]
InputJoint = Annotated[
    str | None, typer.Option("--input", help="The joint that drives; the file's by default.")
]
OutputJoint = Annotated[
    str | None, typer.Option("--output", help="The joint whose motion is told; the file's by default.")
]
InputValue = Annotated[
    str,
    typer.Option(
        "--at", help="Value of the input: '30deg', '0.5rad', '12mm'; a plain number is in degrees or lengths."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as one JSON object and nothing else.")]
Law = Annotated[
    Path | None, typer.Option(help="CSV file of an input law: time, value of the input, perhaps its rates.")
]
PointName = Annotated[str | None, typer.Option("--point", help="A named point of the linkage.")]
PointLink = Annotated[int | None, typer.Option("--link", help="The link of a point given by --at.")]
PointPlace = Annotated[str | None, typer.Option("--at", help="Where on the link, as in '-100,-90,-80'.")]
Speed = Annotated[str | None, typer.Option(help="Speed of the input, as in '10 rad/s' or '60 rpm'.")]


def words(given: list[str]) -> list[str]:
    """The words of an option that is repeated, or has several parted by commas; each once."""
    parts = [part.strip() for word in given for part in word.split(",")]
    return list(dict.fromkeys(part for part in parts if part))


def figure_formats(given: list[str] | None, out: Path | None) -> tuple[str, ...]:
    """Endings of figures, png where none is given; raises `RequestError` for others, and without a folder."""
    if given is None:
        return ("png",)
    from sevenbar.drawing.figure import FORMATS

    endings = tuple(word.lower().removeprefix(".") for word in words(given))
    if not endings:
        raise RequestError(f"--figures: none given; give some of {', '.join(FORMATS)}, or leave it out")
    for ending in endings:
        if ending not in FORMATS:
            raise RequestError(
                f"--figures: {shown(ending)} is not a figure format; allowed: {', '.join(FORMATS)}"
            )
    if out is None:
        raise RequestError("--figures: a folder for them is missing; give --out, as in '--out report'")
    return endings


@contextmanager
def progress_bar(title: str, *, rate: bool = False) -> Iterator[Callable[[int, int], None]]:
    """A bar on the error stream, so that what is printed can be piped on; with `rate` how many a second.

    It is shown when the first progress is told, so that a refusal stands alone and short work has none.
    """
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        Task,
        TaskID,
        TextColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        """Steps a second."""

        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text("" if speed is None else f"{speed:,.0f}/s")

    columns = [TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()]
    bar = Progress(*columns, *([Rate()] if rate else []), TimeRemainingColumn(), console=Console(stderr=True))
    task: TaskID | None = None

    def progress(done: int, total: int) -> None:
        nonlocal task
        if task is None:
            bar.start()
            # what was there already is no rate
            task = bar.add_task(title, total=total, completed=done)
        bar.update(task, completed=done, total=total)

    try:
        yield progress
    finally:
        if task is not None:
            bar.stop()
