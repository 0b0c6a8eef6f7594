"""The report of a map: a page of text for people, JSON and CSV for programs, a folder with all of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from sevenbar.arrays import Floats
from sevenbar.design.maps.atlas import Map, NearestChange
from sevenbar.design.maps.figures import draw
from sevenbar.design.maps.heights import Heights
from sevenbar.reporting.csv_tables import write_csv
from sevenbar.reporting.files import Report, Write, figure_files
from sevenbar.reporting.page import Facts, Page, number_table, page, page_report, prints_its_page
from sevenbar.text.words import say


@dataclass(frozen=True, eq=False)
class MapFindings:
    """A map, and the contours of measures on it."""

    map: Map
    heights: Sequence[Heights] = ()


def page_of(findings: MapFindings) -> Page:
    """What kinds there are, and how far the design is from each change.

    Of plain values places of lines are in the dimensions' units, null where there is none.
    """
    of, heights = findings.map, findings.heights
    x, y = of.axes
    design = of.design
    facts = Facts()
    facts.also(format=1, linkage=of.linkage.name, input=of.input)
    axes = []
    for label, axis in (("across", x), ("up", y)):
        low, high = axis.text(axis.low), axis.text(axis.high)
        facts.add(label, say("{dimension} from {low} to {high}", dimension=axis.name, low=low, high=high))
        unit = axis.dimension.unit
        axes.append({"dimension": axis.name, "unit": unit, "low": axis.low, "high": axis.high})
    facts.also(axes=axes)
    facts.add("held", of.held.text, **of.held.as_dict)
    facts.add("input", of.input)
    facts.add("boundaries", _precision(of))
    facts.also(kinds=[{**vars(kind), "share": share} for kind, share in of.areas.items()])
    place = f"{x.name} = {x.text(design.x)}, {y.name} = {y.text(design.y)}"
    plain: dict[str, Any] = {x.name: design.x, y.name: design.y, "inside": design.inside}
    plain |= {**vars(design.kind), "changes": [_step_dict(step) for step in design.steps]}
    where = place if design.inside else say("{design}; outside the map", design=place)
    facts.add("design", where, design=plain)
    facts.add("", of.name(design.kind), "bold")
    for result in heights:
        name = result.measure.name
        value = say("none") if result.here is None else f"{result.here:.6g} {result.unit}".rstrip()
        facts.add("", f"{name} {value}")
        if not np.isfinite(result.values).any():
            facts.add("", say("{measure}: no linkage on the map has it", measure=name), "yellow")
    facts.also(
        precision={"tolerance": of.tolerance, "widest_hidden": of.widest, "open_area": of.open},
        boundaries=[
            {
                "left": vars(of.kinds[line.left]),
                "right": vars(of.kinds[line.right]),
                "points": of.values(line.places).tolist(),
            }
            for line in of.boundaries
        ],
        regions=[
            {
                **vars(of.kinds[region.kind]),
                "share": region.area,
                "outline": of.values(region.outline).tolist(),
                "holes": [of.values(hole).tolist() for hole in region.holes],
            }
            for region in of.regions
        ],
        measures=[_heights_dict(of, result) for result in heights],
    )
    shares = [[of.name(kind), f"{100 * share:.3f} %"] for kind, share in of.areas.items()]
    tables = [number_table(["on the map", "share"], shares)]
    if design.inside:
        rows = [_row(of, step) for step in design.steps]
        tables.append(number_table(["the design changes", "by", "at", "and becomes"], rows, words=(3,)))
    return page(of.linkage.heading, facts, *tables)


def _step_dict(step: NearestChange) -> dict[str, Any]:
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


def _precision(of: Map) -> str:
    within = f"{of.tolerance:.0e}".replace("e-0", "e-")
    if of.open == 1.0:
        return say(
            "within {share} of the ranges; what is narrower than a cell of the grid may be missing",
            share=within,
        )
    return say(
        "within {share} of the ranges; no region wider than {widest} of them is missing",
        share=within,
        widest=f"{max(of.widest, of.tolerance):.1e}".replace("e-0", "e-"),
    )


def _row(of: Map, step: NearestChange) -> list[str]:
    axis = step.axis
    end = axis.low if step.way == "down" else axis.high
    way = (
        say("{dimension} down", dimension=axis.name)
        if step.way == "down"
        else say("{dimension} up", dimension=axis.name)
    )
    if step.value is None or step.kind is None:
        return [way, "", say("not before {value}", value=axis.text(end)), ""]
    by = step.value - axis.dimension.value
    return [way, f"{by:+.6g}", axis.text(step.value, 9), of.name(step.kind)]


def map_report(
    measures: Sequence[str] = (),
    figures: Sequence[str] = ("png",),
    *,
    size: str | None = None,
    side: bool = True,
) -> Report[MapFindings]:
    """How a map with contours of these measures is reported; a figure for the map and for each measure."""
    files: dict[str, Write[MapFindings]] = {
        "boundaries.csv": partial(_write_lines, ["boundary", "left", "right"], _boundaries),
    }
    if measures:
        files["contours.csv"] = partial(_write_lines, ["contour", "measure", "level"], _contours)
    for place, stem in enumerate(("map", *measures)):
        files |= figure_files(stem, figures, partial(_sheet, size, side, place))
    return page_report(page_of, "map", files)


def _sheet(size: str | None, side: bool, place: int, result: MapFindings) -> Figure:
    return draw(result.map, result.heights[place - 1] if place else None, size=size, side=side)


#: Places of lines (n, 2) [shares], each with what the line is.
Lines = Iterable[tuple[Floats, tuple[Any, ...]]]


def _boundaries(findings: MapFindings) -> Lines:
    of = findings.map
    for index, line in enumerate(of.boundaries):
        yield line.places, (index, of.name(of.kinds[line.left]), of.name(of.kinds[line.right]))


def _contours(findings: MapFindings) -> Lines:
    for result in findings.heights:
        for i, line in enumerate(result.contours):
            yield line.places, (i, result.measure.name, line.level)


def _write_lines(
    names: Sequence[str], lines: Callable[[MapFindings], Lines], findings: MapFindings, path: Path
) -> None:
    """Writes a table of lines: what each is, and one after the other its places in the dimensions' units."""
    of = findings.map
    head = [*names, *(axis.dimension.column for axis in of.axes)]
    rows = ([*what, *place] for places, what in lines(findings) for place in of.values(places).tolist())
    write_csv(path, head, rows)


prints_its_page(Map, "Map", lambda of: page_of(MapFindings(of)))
