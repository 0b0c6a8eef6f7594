"""How a kind of result is reported: printed for people, as one object for programs, as files to keep."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy.typing as npt

from sevenbar.reporting.folder import check_targets, fill_folder
from sevenbar.text.progress import Progress, silent
from sevenbar.text.words import language

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console, RenderableType

    from sevenbar.kinematics.loop.geometry import Loop

T = TypeVar("T")

#: Writes one file of a result to a path; a file that the result does not have is not written.
Write = Callable[[T, Path], object]

#: What writes each file that a result may have, by the file's name.
Files = Mapping[str, Write[T]]


@dataclass(frozen=True)
class LongTable(Generic[T]):
    """Writes a table and reports its progress: columns (n,) in parts, and how many rows there will be."""

    parts: Callable[[T], Iterable[Mapping[str, npt.ArrayLike]]]
    rows: Callable[[T], int]

    def __call__(
        self,
        result: T,
        path: Path,
        progress: Callable[[float], object] = lambda share: None,  # noqa: ARG005
    ) -> None:
        """Writes it as CSV; `progress(share)` is called with the share that is written, 0 to 1."""
        total = max(1, self.rows(result))
        # only what writes tables needs it
        from sevenbar.reporting.csv_tables import write_parts

        write_parts(path, self.parts(result), lambda done: progress(done / total))


@dataclass(frozen=True)
class Report(Generic[T]):
    """How results of one kind are reported; the names of files are known before there is a result."""

    text: Callable[[T], RenderableType]
    as_dict: Callable[[T], dict[str, Any]]
    files: Files[T] = field(default_factory=dict)
    #: figures whose names the result decides; written after the files
    figures: Callable[[T], Files[T]] | None = None
    #: files that show the figures; written last
    pages: Files[T] = field(default_factory=dict)
    #: whether its text may be in another language than English, by `sb.language`
    spoken: bool = False

    def targets(self, folder: Path) -> list[Path]:
        """The files that `write` may write, to be checked before long work."""
        return [folder / name for name in (*self.files, *self.pages)]

    def files_of(self, result: T) -> Files[T]:
        """The files of a result, in the order in which they are written."""
        return {**self.files, **({} if self.figures is None else self.figures(result)), **self.pages}

    def without_figures(self) -> Report[T]:
        """The report with its numbers only: figures take time, which a command that was stopped has not."""
        files = {name: write for name, write in self.files.items() if not isinstance(write, FigureFile)}
        return replace(self, files=files, figures=None, pages={})

    def json(self, result: T) -> str:
        """A result as JSON text."""
        with language("en"):
            return json_text(self.as_dict(result))

    def print(self, result: T, console: Console | None = None) -> None:
        """Prints a result for people."""
        # rich takes a while to load, and JSON does without it
        from rich.console import Console

        with language(None if self.spoken else "en"):
            (console or Console()).print(self.text(result))

    def write(
        self,
        result: T,
        folder: str | os.PathLike[str],
        *,
        force: bool = False,
        progress: Progress = silent,
    ) -> list[Path]:
        """Writes the files of a result into a folder, all or none; returns their paths.

        The folder is made if need be. All are finished in a folder aside before the first is put in place;
        Ctrl+C raises `Stopped`, which keeps those that are whole by then. `progress(done, total, name)` is
        called before each file, and within long tables. Raises `OutputError` where the folder cannot be
        written, and where a file exists and `force` is not given.
        """
        files = self.files_of(result)
        check_targets([Path(folder) / name for name in files], force=force)

        def fill(staging: Path) -> Iterator[Path]:
            for done, (name, write) in enumerate(files.items()):
                progress(done, len(files), name)
                if isinstance(write, LongTable):
                    write(result, staging / name, partial(_within, progress, done, len(files), name))
                else:
                    write(result, staging / name)
                yield staging / name
            progress(len(files), len(files), "")

        return fill_folder(Path(folder), fill, force=force)


def _within(progress: Progress, done: int, total: int, name: str, share: float) -> None:
    """Reports the share of a file that is written as a part of all files."""
    progress(done + share, total, name)


def text_file(text: Callable[[T], str]) -> Write[T]:
    """Writes a text in UTF-8, in English: programs read it."""

    def write(result: T, path: Path) -> None:
        with language("en"):
            path.write_text(text(result), encoding="utf-8")

    return write


def json_file(as_dict: Callable[[T], Any]) -> Write[T]:
    """Writes plain values as JSON."""
    return text_file(lambda result: json_text(as_dict(result)) + "\n")


def columns_file(columns: Callable[[T], Mapping[str, npt.ArrayLike]]) -> Write[T]:
    """Writes columns of one length (n,) as CSV."""

    def write(result: T, path: Path) -> None:
        from sevenbar.reporting.csv_tables import write_columns

        with language("en"):
            write_columns(path, columns(result))

    return write


class FigureFile(Generic[T]):
    """Writes one figure in each of the formats, drawn once; no file where `draw` returns `None`."""

    def __init__(self, draw: Callable[[T], Figure | None], last: str) -> None:
        self._draw, self._last = draw, last
        self._drawn: list[tuple[T, Figure | None]] = []

    def __call__(self, result: T, path: Path) -> None:
        """Writes the figure of a result in the format of the path's ending."""
        from sevenbar.drawing.figure import save

        if not self._drawn or self._drawn[0][0] is not result:
            self._drawn[:] = [(result, self._draw(result))]
        figure = self._drawn[0][1]
        if path.suffix == self._last:
            # a figure is large, and this was its last format
            self._drawn.clear()
        if figure is not None:
            save(figure, path)


def figure_files(stem: str, formats: Sequence[str], draw: Callable[[T], Figure | None]) -> Files[T]:
    """A figure in each of these formats, drawn once; no file where `draw` returns `None`."""
    if not formats:
        return {}
    write = FigureFile(draw, f".{formats[-1]}")
    return {f"{stem}.{ending}": write for ending in formats}


def without_nan(value: Any) -> Any:
    """Plain values with null in place of each number that is not finite, as JSON needs it."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: without_nan(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(v) for v in value]
    return value


def json_text(value: Any) -> str:
    """Plain values as JSON text, null in place of each number that is not finite."""
    return json.dumps(without_nan(value), indent=2, allow_nan=False)


def head_of(linkage: Loop, **units: str) -> dict[str, Any]:
    """What objects for programs begin with: the version of their form, the linkage, the units."""
    return {
        "format": 1,
        "linkage": {"name": linkage.name, "kind": linkage.kind},
        "units": {"length": linkage.length_unit, "angle": "rad", "time": "s", **units},
    }
