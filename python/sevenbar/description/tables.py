"""A linkage in a table: Denavit-Hartenberg rows, joints as drawn, or the RSSR paper's dimensions.

The table becomes the description that a TOML file would hold, and is checked as such; each mistake has its
line and its column.
"""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

from sevenbar.description.forms import from_description
from sevenbar.description.table_columns import is_header
from sevenbar.description.table_reader import (
    EXAMPLES,
    TableDescription,
    add_points,
    described,
    described_frame,
)
from sevenbar.errors import DescriptionError, given_path, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.grid import grid_of_sheet, grid_of_text
from sevenbar.text.table import read_bytes, text_of_bytes
from sevenbar.text.workbook import ZIP, sheets_of

#: Sheets of this title are taken before others: Sevenbar's own workbooks have it.
SHEET = "linkage"


def from_table(
    source: str | os.PathLike[str] | Any, *, name: str | None = None, speed: float | str | None = None
) -> Linkage:
    """The linkage of a table: a CSV or Excel file, or a data frame with the same columns.

    Denavit-Hartenberg rows (classic: `A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)`, the ground last) have the
    columns length or a, twist or alpha, offset or d, perhaps kind, name, theta, pitch; joints as drawn have
    name, kind, x, y, z, axis x, axis y, axis z. Units are written as in `a [mm]`, `alpha [deg]`. A column
    `input` marks the input, or holds its speed. Raises `DescriptionError` with each mistake at its line and
    column.

        >>> import sevenbar as sb
        >>> columns = {"a [mm]": [60, 90.16282937626413] * 2, "alpha [deg]": [40, 75] * 2}
        >>> sb.from_table(columns).motion().motion_type
        'double-crank'
    """
    if isinstance(source, str | os.PathLike):
        path, place = given_path("source", source), str(source)
        result = description_of_bytes(read_bytes(path, "a linkage"), str(path))
    else:
        result, place = described_frame(source), "table"
    result.raw["name"] = name or result.raw["name"]
    if speed is not None:
        result.raw["drive"] = {**result.raw.get("drive", {}), "speed": speed}
    return result.linkage(from_description, place)


def description_of_bytes(content: bytes, source: str) -> TableDescription:
    """What a file's bytes describe; `source` is its name in messages."""
    stem = Path(source).stem
    if not content.strip():
        raise DescriptionError.of_all(source, "is empty; give a table with a header and a row for each joint")
    if not content.startswith(ZIP):
        text = text_of_bytes(content, source).replace("\r\n", "\n").replace("\r", "\n")
        try:
            grid = grid_of_text(text, is_header)
        except csv.Error:  # a cell of many thousand characters
            raise DescriptionError.of_all(
                source, "a cell goes on over many lines; close the quotes of its text, or leave them out"
            ) from None
        if grid is None:
            raise DescriptionError.of_all(
                source, f"no header of a linkage's table; name the columns as in {EXAMPLES}"
            )
        return described(grid, source, stem or "linkage")
    sheets = sheets_of(content, source)
    grids = {sheet.title: grid_of_sheet(sheet, is_header) for sheet in sheets}
    first = next((title for title in grids if title.lower() == SHEET and grids[title]), None)
    first = first or next((title for title, grid in grids.items() if grid is not None), None)
    if first is None:
        known = ", ".join(map(shown, grids))
        raise DescriptionError.of_all(
            source,
            f"no sheet has the header of a linkage's table ({known}); name the columns as in {EXAMPLES}",
        )
    grid = grids[first]
    assert grid is not None
    result = described(grid, source, stem or "linkage")
    if len(sheets) > 1:
        result.note += f", sheet {shown(first)}"
    points = next(
        (grid for title, grid in grids.items() if title.lower() == "points" and title != first), None
    )
    if points is not None:
        add_points(result, points, source)
    return result
