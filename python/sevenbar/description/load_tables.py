"""How large a load is along the input, from a table of text: its rows in a description."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sevenbar.description.named_files import file_below
from sevenbar.description.written import entries
from sevenbar.errors import DescriptionError, Problem, RequestError, SevenbarError, TableError, shown
from sevenbar.text.paths import is_file
from sevenbar.text.units import ANGLES

# most descriptions have none
if TYPE_CHECKING:
    from sevenbar.text.table import TextTable

#: Rows that a table may have: a description holds them.
MOST_ROWS = 1_000


def with_rows(raw: Mapping[str, Any], context: Mapping[str, Any]) -> Mapping[str, Any]:
    """A description with the rows of each load's table in the place of its file's name.

    `context` is that of the description, with the `folder` of its file. A table that cannot be read stays,
    for the schema to refuse it.
    """
    if not any(isinstance(load.get("table"), str) for load in entries(raw, "load")):
        return raw
    return {**raw, "load": [_with_rows(load, context) for load in raw["load"]]}


def _with_rows(load: Any, context: Mapping[str, Any]) -> Any:
    if not isinstance(load, Mapping) or not isinstance(load.get("table"), str):
        return load
    try:
        return {**load, "table": rows_of(load["table"], context)}
    except SevenbarError:
        return load


def refuse_tables(raw: Mapping[str, Any], source: str) -> None:
    """`DescriptionError` for a text from another machine that names a file of this one."""
    problems = [
        Problem(
            f"load[{i}].table",
            f"{shown(load['table'])} is the name of a file, and a text from the browser reads none; "
            "give its rows, as in [[0, 0], [30, 1]], or open the file with sevenbar studio FILE",
        )
        for i, load in enumerate(entries(raw, "load"), 1)
        if isinstance(load.get("table"), str)
    ]
    if problems:
        raise DescriptionError(problems, source)


def folder_of(source: str) -> Path:
    """The folder of a description's file; of a text without one the folder in which the program runs."""
    try:
        return Path(source).parent if source and is_file(source) else Path()
    except (OSError, ValueError):  # a name that no file can have
        return Path()


def rows_of(name: str, context: Mapping[str, Any]) -> list[list[float]]:
    """The rows of a table: values of the input in the file's unit, and the factor of the load there.

    A header names the columns and the unit of the input, as in `crank [deg],factor`. Raises `RequestError`.
    """
    from sevenbar.text.table import read_table

    if not name.strip() or len(name) > 200 or not name.isprintable():
        raise RequestError(f"{shown(name)} is not the name of a table; give a CSV file, as in 'press.csv'")
    try:
        path = file_below(context.get("folder", Path()), name, "press.csv")
        table = read_table(path, "the factor of a load along the input")
        if len(table.rows) > MOST_ROWS:
            raise table.wrong(f"{len(table.rows)} rows; give at most {MOST_ROWS}")
        at, size, factor = _columns(table, context)
        numbers = {at: table.numbers(at), factor: table.numbers(factor)}
        table.refuse_gaps(numbers, "leave such rows out")
    except TableError as error:
        raise RequestError(str(error)) from None
    back = np.flatnonzero(np.diff(numbers[at]) <= 0)
    if len(table.rows) < 2 or back.size:
        row = int(back[0]) + 1 if back.size else None
        column = at if back.size else None
        raise RequestError(str(table.wrong("give two rows or more, inputs rising", row=row, column=column)))
    return [[float(x), float(y)] for x, y in zip(numbers[at] * size, numbers[factor], strict=True)]


def _columns(table: TextTable, context: Mapping[str, Any]) -> tuple[int, float, int]:
    """The column of the input, the size of its unit in the file's, and the column of the factor."""
    slides = context.get("slides")
    kind, what = ("slide", "a length") if slides else ("turn", "an angle")
    inputs = table.columns_of((kind, 0))
    names = [table.name_and_unit(place) for place in range(len(table.names))]
    factors = [i for i, (_, unit) in enumerate(names) if not unit]
    if len(factors) > 1:
        factors = [i for i in factors if names[i][0].lower() == "factor"]
    if len(inputs) != 1 or len(factors) != 1:
        example = f"slide [{slides}],factor" if slides else "crank [deg],factor"
        raise table.wrong(
            f"needs one column of the input, {what} with its unit, and one of the factor without; "
            f"{table.header}; name them as in '{example}'"
        )
    unit = table.unit(inputs[0])
    size = unit.size_in(context["length_unit"]) if unit is not None else 1.0
    own = 1.0 if slides else ANGLES[context.get("angle_unit", "deg")]
    return inputs[0], 1.0 if size == own else size / own, factors[0]
