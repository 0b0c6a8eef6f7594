"""What a file with a table describes: CSV in any of its forms, a sheet of a workbook."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

from sevenbar.description.table_columns import is_header
from sevenbar.description.table_reader import (
    EXAMPLES,
    TableDescription,
    add_points,
    described,
    described_frame,
)
from sevenbar.errors import DescriptionError, given_path, shown
from sevenbar.text.grid import grid_of_sheet, grid_of_text
from sevenbar.text.table import read_bytes, text_of_bytes
from sevenbar.text.workbook import ZIP, sheets_of

#: Sheets of this title are taken before others: Sevenbar's own workbooks have it.
SHEET = "linkage"


def table_of(source: str | os.PathLike[str] | Any, ground: str = "") -> tuple[TableDescription, str]:
    """What a table describes, a file or a data frame, and what messages call it; `ground` stands still."""
    if isinstance(source, str | os.PathLike):
        path = given_path("source", source)
        return description_of_bytes(read_bytes(path, "a linkage"), str(path), ground), str(source)
    return described_frame(source, ground), "table"


def description_of_bytes(content: bytes, source: str, ground: str = "") -> TableDescription:
    """What a file's bytes describe; `source` is its name in messages, `ground` the link that stands still."""
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
        return described(grid, source, stem or "linkage", ground)
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
    result = described(grid, source, stem or "linkage", ground)
    if len(sheets) > 1:
        result.note += f", sheet {shown(first)}"
    points = next(
        (grid for title, grid in grids.items() if title.lower() == "points" and title != first), None
    )
    if points is not None:
        add_points(result, points, source)
    return result
