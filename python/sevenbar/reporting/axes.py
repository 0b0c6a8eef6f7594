"""What is reported of the axes of a CAD model: a list, and a table from which a linkage is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.description.step_axes import PartAxis
from sevenbar.reporting.csv_tables import write_csv
from sevenbar.reporting.files import Report

#: The head of the table: `order` and `kind` are for a person to fill in.
HEAD = (
    "order", "name", "kind", "x [mm]", "y [mm]", "z [mm]", "axis x", "axis y", "axis z",
    "shape", "radius [mm]", "extent [mm]", "parts", "faces",
)  # fmt: skip

#: Axes that are printed; the table has all.
MOST_PRINTED = 30


@dataclass(frozen=True)
class PartAxes:
    """The axes of a model, and the file they are from."""

    source: str
    axes: tuple[PartAxis, ...]


def axes_rows(axes: Sequence[PartAxis]) -> list[list[Any]]:
    """The rows of the table, without order and kind."""
    rows = []
    for name, axis in zip(_names(axes), axes, strict=True):
        direction = (None,) * 3 if axis.direction is None else axis.direction.tolist()
        radii = " ".join(f"{radius:.9g}" for radius in axis.radii)
        place = [*axis.at.tolist(), *direction]
        about = [axis.shape, radii, axis.extent, " ".join(axis.parts), " ".join(axis.faces)]
        rows.append([None, name, None, *place, *about])
    return rows


def _names(axes: Sequence[PartAxis]) -> list[str]:
    """Names of their own: that of the only named face, else a number."""
    named = [axis.faces[0] if len(axis.faces) == 1 else "" for axis in axes]
    return [
        name if name and named.count(name) == 1 else f"{'ball' if axis.shape == 'ball' else 'axis'}_{k}"
        for k, (name, axis) in enumerate(zip(named, axes, strict=True), 1)
    ]


def write_axes(result: PartAxes, path: Path) -> None:
    """Writes the table as CSV."""
    write_csv(path, HEAD, axes_rows(result.axes))


def axes_report() -> Report[PartAxes]:
    """How axes are reported."""
    return Report(_text, _as_dict, {"axes.csv": write_axes})


def _text(result: PartAxes) -> RenderableType:
    table = Table(box=None, pad_edge=False)
    for head in ("name", "shape", "point [mm]", "direction", "radius [mm]", "extent [mm]", "parts"):
        table.add_column(head, overflow="fold")
    for name, axis in list(zip(_names(result.axes), result.axes, strict=True))[:MOST_PRINTED]:
        direction = "" if axis.direction is None else _vector(axis.direction)
        radii = " to ".join(f"{radius:.6g}" for radius in dict.fromkeys((axis.radii[0], axis.radii[-1])))
        parts = ", ".join(axis.parts)
        table.add_row(name, axis.shape, _vector(axis.at), direction, radii, f"{axis.extent:.6g}", parts)
    shared = sum(len(axis.parts) > 1 for axis in result.axes)
    count = len(result.axes)
    first = Text(f"{result.source}: {count} axes and balls, {shared} of them shared by several parts")
    more = max(count - MOST_PRINTED, 0)
    below = [Text(), Text(f"and {more} more, which the table of --out has")] if more else []
    return Group(first, Text(), table, *below)


def _vector(values: Any) -> str:
    # a millionth of a micrometre is rounding
    return ", ".join(f"{round(value, 9) + 0.0:.6g}" for value in values)


def _as_dict(result: PartAxes) -> dict[str, Any]:
    keys = ("shape", "at", "direction", "radii", "extent", "parts", "faces", "count")
    rows = []
    for name, axis in zip(_names(result.axes), result.axes, strict=True):
        values = {key: getattr(axis, key) for key in keys}
        plain = {key: value.tolist() if hasattr(value, "tolist") else value for key, value in values.items()}
        rows.append({"name": name, **plain})
    return {"format": 1, "source": result.source, "length_unit": "mm", "axes": rows}
