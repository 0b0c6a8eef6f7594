"""Tables as CSV files: whole, by columns, or in parts one under the other."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.text.csv_cells import harmless

#: Rows of a table that are text at once.
ROWS_AT_ONCE = 5_000


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
