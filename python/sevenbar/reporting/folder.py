"""A folder of files to keep: all of them appear, or none; and tables as CSV."""

from __future__ import annotations

import csv
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.errors import OutputError
from sevenbar.text.aside import aside_prefix, clear_left
from sevenbar.text.csv_cells import harmless
from sevenbar.text.paths import is_folder, is_there

#: Rows of a table that are text at once.
ROWS_AT_ONCE = 5_000


def check_targets(files: Iterable[Path], *, force: bool) -> None:
    """Raises `OutputError` where files cannot go, or would replace others without `force`; changes nothing.

    Asked before long work, so that it is not done in vain.
    """
    for file in files:
        _check_folder(file.parent)
        _check_name(file)
        if is_folder(file):
            raise OutputError(f"{file}: is a folder where a file should go; give another path")
        if not force and is_there(file):
            raise OutputError(f"{file}: exists already; give another path, or --force to replace it")


def _check_name(file: Path) -> None:
    """Raises `OutputError` for a name that the system does not take, as one of 5,000 letters."""
    try:
        file.lstat()
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        pass
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise OutputError(f"{file}: cannot be written: {reason.lower()}; give another name") from None


def _check_folder(folder: Path) -> None:
    """Raises `OutputError` for a folder that can be neither made nor written."""
    # a path that is too long for the system has no file, where `Path` would raise
    nearest = next((place for place in (folder, *folder.parents) if is_there(place)), folder)
    if not is_folder(nearest):
        who = "it" if nearest == folder else str(nearest)
        raise _unwritable(folder, f"{who} is a file")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise _unwritable(folder, "permission denied")


def _unwritable(folder: Path, reason: str) -> OutputError:
    return OutputError(f"{folder}: cannot be written: {reason}; give a folder that can be made or written")


class Stopped(KeyboardInterrupt):
    """Ctrl+C while files were written, which left those that were whole by then."""

    def __init__(self, files: Sequence[Path]) -> None:
        super().__init__()
        self.files = tuple(files)

    @property
    def kept(self) -> str:
        """What is left, in words."""
        return f"these files are whole and kept: {', '.join(map(str, self.files))}"


def fill_folder(folder: Path, fill: Callable[[Path], object], *, force: bool = False) -> list[Path]:
    """Lets `fill` write into a folder aside, then moves its files into `folder`: whole, or not at all.

    Without `force` a file that is there already is an `OutputError`, and nothing is changed. Where `fill` is
    a generator of its files, each yielded once it is whole, those that are whole outlive Ctrl+C: `Stopped`.
    """
    _check_folder(folder)
    made = [p for p in (folder, *folder.parents) if not is_there(p)]
    staging = None
    whole: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        clear_left(folder)
        staging = Path(tempfile.mkdtemp(prefix=aside_prefix(), dir=folder))
        filling = fill(staging)
        if isinstance(filling, Iterator):
            whole.extend(filling)
        files = sorted(staging.iterdir())
        check_targets([folder / file.name for file in files], force=force)
        return [file.replace(folder / file.name) for file in files]
    except OSError as error:
        _undo(made, staging)
        raise _unwritable(folder, (error.strerror or str(error)).lower()) from None
    except KeyboardInterrupt:
        selected = _keep(whole, folder, force=force)
        _undo([] if selected else made, staging)
        if selected:
            raise Stopped(selected) from None
        raise
    except BaseException:
        _undo(made, staging)
        raise
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)


def _keep(whole: Sequence[Path], folder: Path, *, force: bool) -> list[Path]:
    """Moves files that are there and may be put into a folder."""
    return [
        file.replace(folder / file.name)
        for file in whole
        if file.exists() and (force or not (folder / file.name).exists())
    ]


def _undo(made: Sequence[Path], staging: Path | None) -> None:
    if staging is not None:
        shutil.rmtree(staging, ignore_errors=True)
    for path in made:
        with suppress(OSError):
            path.rmdir()


def write_columns(path: Path, columns: Mapping[str, npt.ArrayLike]) -> None:
    """Writes columns of one length (n,) as CSV, their names as its head; as `write_csv` for the rest."""
    write_parts(path, [columns])


def write_parts(
    path: Path,
    parts: Iterable[Mapping[str, npt.ArrayLike]],
    wrote: Callable[[int], object] = lambda rows: None,  # noqa: ARG005
) -> None:
    """Writes columns (n,) that come in parts with the same names, one under the other, as CSV.

    One part is held at a time, and a piece of it as text; `wrote(rows)` is called after each piece with the
    number of rows that there are by then.
    """
    done, head = 0, False
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        for part in parts:
            if not head:
                writer.writerow(map(harmless, part))
                head = True
            arrays = [np.asarray(column) for column in part.values()]
            count = len(arrays[0]) if arrays else 0
            for first in range(0, count, ROWS_AT_ONCE):
                pieces = [array[first : first + ROWS_AT_ONCE].tolist() for array in arrays]
                writer.writerows(map(_cells, zip(*pieces, strict=True)))
                wrote(done + first + len(pieces[0]))
            done += count
            # or they would live until the next ones are made
            del part, arrays
        if not head:
            writer.writerow([])


def write_csv(path: Path | StringIO, head: Sequence[str], lines: Iterable[Iterable[Any]]) -> None:
    """Writes a table as CSV; a value that does not exist, NaN or None, is an empty cell."""
    written = path.open("w", newline="", encoding="utf-8") if isinstance(path, Path) else nullcontext(path)
    with written as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(harmless, head))
        writer.writerows(map(_cells, lines))


def _cells(line: Iterable[Any]) -> list[Any]:
    """Cells without a value empty, and text as no spreadsheet runs it."""
    return [
        "" if cell is None or cell != cell else harmless(cell) if isinstance(cell, str) else cell
        for cell in line
    ]
