"""A motion as an Excel workbook: sheets of circuits, the linkage, its points (openpyxl, extra `excel`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from sevenbar.description.table_files import SHEET
from sevenbar.description.table_writer import linkage_table, points_table
from sevenbar.errors import RequestError, of_extra
from sevenbar.export.tables import Units
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.text.progress import Progress, silent

#: Rows that a sheet of Excel holds, the head not counted.
MOST_ROWS = 1_048_575

#: Width of a column [characters], and the most that a head makes it.
WIDTH, WIDEST = 11, 32


def write_xlsx(motion: Motion, path: Path, units: Units, _progress: Progress = silent) -> None:
    """Writes a workbook: sheets `circuit 0`, `circuit 1` .., `linkage` as tables are read, `points`.

    A value that does not exist is an empty cell. The sheet `linkage` is in the file's units whatever `units`
    of the motion are. Raises `RequestError` for more rows than a sheet holds.
    """
    with of_extra("excel", "xlsx needs openpyxl"):
        from openpyxl import Workbook
    for circuit in motion.circuits:
        if len(circuit.time) > MOST_ROWS:
            raise RequestError(
                f"samples: circuit {circuit.index} has {len(circuit.time):,} rows and a sheet of Excel holds "
                f"{MOST_ROWS:,}; give fewer samples, or csv"
            )
    book = Workbook(write_only=True)
    columns = motion.columns(si=units == "si")
    for circuit in motion.circuits:
        own = columns["circuit"] == circuit.index
        lines = zip(*(np.asarray(values)[own].tolist() for values in columns.values()), strict=True)
        _add_sheet(book, f"circuit {circuit.index}", list(columns), lines)
    head, rows = linkage_table(motion.linkage)
    _add_sheet(book, SHEET, head, rows, title=motion.linkage.name)
    head, rows = points_table(motion.linkage)
    if rows:
        _add_sheet(book, "points", head, rows)
    # a full disk would leave openpyxl's archive open, which says so in words of its own when it goes
    content = BytesIO()
    book.save(content)
    path.write_bytes(content.getvalue())


def _add_sheet(
    book: Any, name: str, head: Sequence[str], rows: Iterable[Sequence[Any]], *, title: str = ""
) -> None:
    """Adds a sheet with its head in bold and in view; a title goes above it."""
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.styles import Font
    from openpyxl.utils import get_column_letter

    sheet = book.create_sheet(name)
    for place, label in enumerate(head, 1):
        sheet.column_dimensions[get_column_letter(place)].width = min(max(WIDTH, len(label) + 2), WIDEST)
    sheet.freeze_panes = f"A{2 + bool(title)}"

    def text(value: str, *, bold: bool = False) -> Any:
        cell = WriteOnlyCell(sheet, value=value)
        if bold:
            cell.font = Font(bold=True)
        # a name that begins with '=' is no formula
        cell.data_type = "s"
        return cell

    def plain(value: Any) -> Any:
        """A value as a sheet takes it: nothing for NaN, text as text."""
        if value is None or value != value:
            return None
        return text(value) if isinstance(value, str) and value.startswith("=") else value

    if title:
        sheet.append([text(title, bold=True)])
    sheet.append([text(label, bold=True) for label in head])
    for row in rows:
        sheet.append(list(map(plain, row)))
