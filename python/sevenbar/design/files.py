"""Designs as files: a description each that opens in the studio, a figure of each, tables of all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from sevenbar.description.files import loads
from sevenbar.design.candidates import Drafted
from sevenbar.reporting.csv_tables import write_csv
from sevenbar.reporting.files import Write, figure_files, json_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Writable(Drafted, Protocol):
    """A design that can be written: its description, and what is reported of it."""

    @property
    def columns(self) -> dict[str, float | str | int | None]:
        """What is reported of it, column by column, its dimensions last."""
        ...


class DesignSet(Protocol):
    """What a search found: the best design first."""

    @property
    def candidates(self) -> Sequence[Writable]:
        """The designs."""
        ...


T = TypeVar("T", bound=DesignSet)


def design_files(
    count: int,
    formats: Sequence[str],
    *,
    head: Callable[[T], Sequence[str]],
    figure: Callable[[T, Any], Figure] | None = None,
    as_dict: Callable[[T], dict[str, Any]],
) -> dict[str, Write[T]]:
    """The files of at most `count` designs: design_1.toml with its figure, .., summary.csv, summary.json.

    `head` are the lines of comment that a design's file begins with: what was wanted. Without a `figure`
    there are none.
    """
    files: dict[str, Write[T]] = {}
    for place in range(count):
        name = f"design_{place + 1}"
        files[f"{name}.toml"] = partial(_write_design, place=place, head=head)
        if figure is not None:
            files |= figure_files(name, formats, partial(_figure, place=place, figure=figure))
    return files | {"summary.csv": write_summary, "summary.json": json_file(as_dict)}


def _figure(result: T, *, place: int, figure: Callable[[T, Any], Figure]) -> Figure | None:
    return figure(result, result.candidates[place]) if place < len(result.candidates) else None


def _write_design(result: T, path: Path, *, place: int, head: Callable[[T], Sequence[str]]) -> None:
    if place < len(result.candidates):
        text = toml_of(result.candidates[place], head(result))
        loads(text, path.name)  # what is written must open
        path.write_text(text, encoding="utf-8")


def write_summary(result: DesignSet, path: Path) -> None:
    """Writes a table with a line for each design; a column that one does not have is empty there."""
    rows = [{"design": i, **c.columns} for i, c in enumerate(result.candidates, 1)]
    names = list(dict.fromkeys(name for row in rows for name in row))
    write_csv(path, names, ([row.get(name) for name in names] for row in rows))


def toml_of(candidate: Writable, head: Sequence[str]) -> str:
    """The design as TOML: comments with what was wanted and what it does, then the description."""
    values = [f"{name} = {_plain(value)}" for name, value in candidate.columns.items() if value is not None]
    measured = values[: len(values) - sum(d.kind != "speed" for d in candidate.draft.dimensions)]
    # a name or a command may hold what would end a comment
    clean = ("".join(c if c.isprintable() else " " for c in line) for line in (*head, "", *measured))
    lines = [f"# {line}" if line else "#" for line in clean]
    return "\n".join(lines) + "\n\n" + candidate.draft.toml()


def _plain(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)
