"""How every command ends: files are written, what was found is printed, and the files are named."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import typer

from sevenbar.reporting.files import Report
from sevenbar.reporting.folder import check_targets

T = TypeVar("T")


def check_out(report: Report[T], out: Path | None, *, force: bool) -> None:
    """Raises `OutputError`, before long work, where the files of `--out` cannot be written."""
    if out is not None:
        check_targets(report.targets(out), force=force)


def deliver(
    found: T,
    report: Report[T],
    out: Path | None = None,
    *,
    json: bool,
    force: bool = False,
    also: Sequence[Path] = (),
) -> None:
    """Writes the files of a result into `out`, then prints it: for people with the files, or as JSON alone.

    `also` are files that the command wrote elsewhere.
    """
    written = [*([] if out is None else report.write(found, out, force=force)), *also]
    if json:
        typer.echo(report.json(found))
        return
    report.print(found)
    tell_written(written)


def command_line() -> str:
    """The command as it was given, for files that say how they were made."""
    return shlex.join(["sevenbar", *sys.argv[1:]])


def tell_written(paths: Sequence[Path], *, below: bool = True) -> None:
    """Names the files that were written, if any; `below` other text, a line is left free."""
    if paths:
        typer.echo("\n" * below + "written: " + "\n         ".join(str(path) for path in paths))
