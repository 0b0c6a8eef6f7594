"""The report of a map: a page of text for people, JSON and CSV for programs, a folder with all of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console, Group, RenderableType
from rich.text import Text

from sevenbar.arrays import Floats
from sevenbar.design.maps.atlas import Map, Step
from sevenbar.design.maps.heights import Heights
from sevenbar.reporting.folder import fill_folder, write_csv
from sevenbar.reporting.page import Facts, number_table
from sevenbar.reporting.report import json_text


def as_dict(of: Map, heights: Sequence[Heights] = ()) -> dict[str, Any]:
    """The map as plain values; places of lines in the dimensions' units, null where there is none."""
    x, y = of.axes
    design = of.design
    return {
        "format": 1,
        "linkage": of.linkage.name,
        "input": of.input,
        "axes": [
            {"dimension": axis.name, "unit": axis.dimension.unit, "low": axis.low, "high": axis.high}
            for axis in of.axes
        ],
        "kinds": [
            {"motion_type": kind.motion_type, "circuits": kind.circuits, "share": share}
            for kind, share in of.areas.items()
        ],
        "design": {
            x.name: design.x,
            y.name: design.y,
            "inside": design.inside,
            "motion_type": design.kind.motion_type,
            "circuits": design.kind.circuits,
            "changes": [_step_dict(step) for step in design.steps],
        },
        "precision": {"tolerance": of.tolerance, "widest_hidden": of.widest, "open_area": of.open},
        "boundaries": [
            {
                "left": vars(of.kinds[line.left]),
                "right": vars(of.kinds[line.right]),
                "points": of.values(line.places).tolist(),
            }
            for line in of.boundaries
        ],
        "regions": [
            {
                **vars(of.kinds[region.kind]),
                "share": region.area,
                "outline": of.values(region.outline).tolist(),
                "holes": [of.values(hole).tolist() for hole in region.holes],
            }
            for region in of.regions
        ],
        "measures": [_heights_dict(of, found) for found in heights],
    }


def _step_dict(step: Step) -> dict[str, Any]:
    kind = None if step.kind is None else vars(step.kind)
    return {"dimension": step.axis.name, "way": step.way, "at": step.value, "becomes": kind}


def _heights_dict(of: Map, heights: Heights) -> dict[str, Any]:
    return {
        "name": heights.measure.name,
        "unit": heights.unit,
        "take": heights.take if heights.measure.per == "circuit" else None,
        "design": heights.here,
        "levels": list(heights.levels),
        "contours": [
            {
                "level": line.level,
                "region": vars(of.kinds[line.kind]),
                "points": of.values(line.places).tolist(),
            }
            for line in heights.contours
        ],
    }


def as_json(of: Map, heights: Sequence[Heights] = ()) -> str:
    """The map as JSON text."""
    return json_text(as_dict(of, heights))


def print_text(of: Map, heights: Sequence[Heights] = (), console: Console | None = None) -> None:
    """Prints for people what kinds there are, and how far the design is from each change."""
    (console or Console()).print(text(of, heights))


def text(of: Map, heights: Sequence[Heights] = ()) -> RenderableType:
    """The page for people, to be printed by rich."""
    x, y = of.axes
    design = of.design
    facts = Facts()
    for label, axis in (("across", x), ("up", y)):
        facts.add(label, f"{axis.name} from {axis.text(axis.low)} to {axis.text(axis.high)}")
    facts.add("input", of.input)
    facts.add("boundaries", _precision(of))
    where = "" if design.inside else "; outside the map"
    facts.add("design", f"{x.name} = {x.text(design.x)}, {y.name} = {y.text(design.y)}{where}")
    facts.add("", of.name(design.kind), "bold")
    for found in heights:
        value = "none" if found.here is None else f"{found.here:.6g} {found.unit}".rstrip()
        facts.add("", f"{found.measure.name} {value}")
        if not np.isfinite(found.values).any():
            facts.add("", f"{found.measure.name}: no linkage on the map has it", "yellow")
    shares = number_table(
        ["on the map", "share"], [[of.name(kind), f"{100 * share:.3f} %"] for kind, share in of.areas.items()]
    )
    parts: list[RenderableType] = [Text(of.linkage.name, style="bold underline"), facts.grid, Text(), shares]
    if design.inside:
        rows = [_row(of, step) for step in design.steps]
        parts += [
            Text(),
            number_table(["the design changes", "by", "at", "and becomes"], rows, words=(3,)),
        ]
    return Group(*parts)


def _precision(of: Map) -> str:
    within = f"within {of.tolerance:.0e} of the ranges".replace("e-0", "e-")
    if of.open == 1.0:
        return f"{within}; what is narrower than a cell of the grid may be missing"
    return f"{within}; no region wider than {max(of.widest, of.tolerance):.1e} of them is missing".replace(
        "e-0", "e-"
    )


def _row(of: Map, step: Step) -> list[str]:
    axis = step.axis
    end = axis.low if step.way == "down" else axis.high
    if step.value is None or step.kind is None:
        return [f"{axis.name} {step.way}", "", f"not before {axis.text(end)}", ""]
    by = step.value - axis.dimension.value
    return [f"{axis.name} {step.way}", f"{by:+.6g}", axis.text(step.value, 9), of.name(step.kind)]


def write(
    of: Map,
    heights: Sequence[Heights],
    folder: Path,
    figures: Sequence[str] = ("png",),
    *,
    size: str = "A4",
    force: bool = False,
) -> list[Path]:
    """Writes map.json, boundaries.csv, the map's figure and one of each measure: all or none."""

    def fill(staging: Path) -> None:
        from sevenbar.design.maps.figures import draw
        from sevenbar.drawing.figure import save

        (staging / "map.json").write_text(as_json(of, heights) + "\n", encoding="utf-8")
        columns = [axis.dimension.column for axis in of.axes]
        lines = [
            (line.places, (index, of.name(of.kinds[line.left]), of.name(of.kinds[line.right])))
            for index, line in enumerate(of.boundaries)
        ]
        write_csv(staging / "boundaries.csv", ["boundary", "left", "right", *columns], _rows(of, lines))
        if heights:
            rows = _rows(of, [(h.places, (i, m, h.level)) for m, i, h in _contours(heights)])
            write_csv(staging / "contours.csv", ["contour", "measure", "level", *columns], rows)
        for ending in figures:
            save(draw(of, size=size), staging / f"map.{ending}")
            for found in heights:
                save(draw(of, found, size=size), staging / f"{found.measure.name}.{ending}")

    return fill_folder(folder, fill, force=force)


def _contours(heights: Sequence[Heights]) -> list[tuple[str, int, Any]]:
    return [(found.measure.name, i, line) for found in heights for i, line in enumerate(found.contours)]


def _rows(of: Map, lines: Sequence[tuple[Floats, tuple[Any, ...]]]) -> list[list[Any]]:
    """Rows of a table of lines: what each line is, and one after the other its places."""
    return [[*line, *place] for places, line in lines for place in np.asarray(of.values(places)).tolist()]


def targets(folder: Path, measures: Sequence[str], figures: Sequence[str]) -> list[Path]:
    """The files that `write` is going to write."""
    names = ["map.json", "boundaries.csv", *(["contours.csv"] if measures else [])]
    names += [f"{stem}.{ending}" for stem in ("map", *measures) for ending in figures]
    return [folder / name for name in names]
