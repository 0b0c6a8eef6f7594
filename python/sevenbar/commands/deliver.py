"""How every command ends: what was found is printed, files are written, and they are named."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

import typer

from sevenbar.commands.progress import progress_bar
from sevenbar.commands.signals import stopped
from sevenbar.reporting.files import Report
from sevenbar.reporting.folder import Stopped, check_folder_name, check_targets

T = TypeVar("T")


def check_out(report: Report[T], out: Path | None, *, force: bool) -> None:
    """Raises `OutputError`, before long work, where the files of `--out` cannot be written."""
    if out is not None:
        check_folder_name(out)
        check_targets(report.targets(out), force=force)


def deliver(
    result: T,
    report: Report[T],
    out: Path | None = None,
    *,
    json: bool,
    force: bool = False,
    also: Mapping[Path, Callable[[Path], object]] = MappingProxyType({}),
    unfinished: str = "",
) -> None:
    """Prints a result for people, writes its files into `out` and names them; JSON is printed at the end.

    `also` are files elsewhere, each with what writes it. A result of a search that Ctrl+C stopped is
    `unfinished`: it is written without its figures, and the command ends as Ctrl+C does.
    """
    whole = report
    if unfinished:
        report = report.without_figures()
    if out is not None:
        # nothing is printed before it is certain that files can go there
        check_targets([out / name for name in report.files_of(result)], force=force)
    if not json:
        report.print(result)
        sys.stdout.flush()
    written: list[Path] = []
    if out is not None:
        written += write_files(report, result, out, force=force)
    for path, write in also.items():
        try:
            write(path)
        except KeyboardInterrupt:
            if written:
                raise Stopped(written) from None
            raise
        written.append(path)
    if json:
        typer.echo(report.json(result))
    else:
        tell_written(written)
    if unfinished:
        if out is not None and report != whole:
            typer.echo("figures are left out: the search was stopped", err=True)
        raise typer.Exit(stopped())


def write_files(report: Report[T], result: T, out: Path, *, force: bool) -> list[Path]:
    """Writes the files of a result with a bar that names the one at work."""
    with progress_bar(f"writing {out}") as progress:
        return report.write(result, out, force=force, progress=progress)


def command_line() -> str:
    """The command as it was given, for files that say how they were made."""
    return shlex.join(["sevenbar", *sys.argv[1:]])


def tell_written(paths: Sequence[Path], *, below: bool = True) -> None:
    """Names the files that were written, if any; `below` other text, a line is left free."""
    if paths:
        typer.echo("\n" * below + "written: " + "\n         ".join(str(path) for path in paths))
