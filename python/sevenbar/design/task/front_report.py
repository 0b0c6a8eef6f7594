"""A front of two wants as people and programs read it: a table, a figure, a file of each design."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from sevenbar.design.task.front import ParetoFront
from sevenbar.design.task.report import TaskDesigns, as_dict, task_report
from sevenbar.design.task.task import DesignTask, FigureWant, PathWant, PoseWant, StraightWant
from sevenbar.design.task.words import task_facts, want_words
from sevenbar.drawing.figure import page_figure
from sevenbar.drawing.names import short
from sevenbar.drawing.style import COMPUTED, styled
from sevenbar.kinematics.measures import measures_named
from sevenbar.reporting.files import Report, figure_files
from sevenbar.reporting.folder import write_csv
from sevenbar.reporting.page import Facts, number_table
from sevenbar.text.words import say


@dataclass(frozen=True, eq=False)
class FrontFound:
    """A front, with the name and source of its task and what the search was given."""

    front: ParetoFront
    name: str
    source: str
    starts: int
    seed: int

    @cached_property
    def designs(self) -> TaskDesigns:
        """Its designs as those of a search."""
        return TaskDesigns(self.front.found, self.name, self.source, self.starts, self.seed)

    @property
    def axes(self) -> list[tuple[str, str, float]]:
        """Of both wants: a name for tables, the unit, and what a value is multiplied by for it."""
        task = self.front.task
        return [_axis(task, place) for place in self.front.wants]


def _axis(task: DesignTask, place: int) -> tuple[str, str, float]:
    want, linkage = task.wants[place], task.draft.linkage
    if isinstance(want, FigureWant):
        (measure,) = measures_named([want.name])
        off = "" if isinstance(want.value, str) else "off_"
        return f"{off}{want.name}", measure.unit(linkage, linkage.drive.output).replace("_", " "), 1.0
    if isinstance(want, PathWant | PoseWant | StraightWant) or not linkage.turns(linkage.drive.output):
        return f"want_{place + 1}_greatest", linkage.length_unit, 1.0
    return f"want_{place + 1}_greatest", "deg", math.degrees(1.0)


def front_report(
    task: DesignTask, count: int, command: str, formats: Sequence[str] = ("png",)
) -> Report[FrontFound]:
    """How a front of at most `count` points is reported; the heads of its files name the `command`."""
    inner = task_report(task, count, command, formats)
    files: dict[str, Any] = {"front.csv": _write_table}
    files |= figure_files("front", formats, front_figure)
    for name, write in inner.files.items():
        files[name] = _through(write)
    return Report(_text, _as_dict, files)


def _through(write: Any) -> Any:
    def written(found: FrontFound, path: Path) -> None:
        write(found.designs, path)

    return written


def _write_table(found: FrontFound, path: Path) -> None:
    names = [f"{name}_{unit.replace(' ', '_')}" if unit else name for name, unit, _ in found.axes]
    scales = [scale for *_, scale in found.axes]
    free = list(found.front.task.names)
    rows = [
        [
            i,
            *(v * s for v, s in zip(point.values, scales, strict=True)),
            point.design.optimality,
            *point.design.values,
        ]
        for i, point in enumerate(found.front.points, 1)
    ]
    write_csv(path, ["design", *names, "kkt_residual", *free], rows)


def _text(found: FrontFound) -> RenderableType:
    front, task = found.front, found.front.task
    facts = Facts()
    for label, words in task_facts(task):
        facts.add(label, words, "bold" if label == "wanted" else "")
    both = " and ".join(str(place + 1) for place in front.wants)
    facts.add(
        "front", f"of wants {both}: {len(front.points)} points of {front.solved} searches, seed {found.seed}"
    )
    if front.missing:
        facts.add("", f"{front.missing} bounds had no design")
    if front.unfinished:
        facts.add("unfinished", front.unfinished, "bold yellow")
    heads = [f"{name.replace('_', ' ')}\n[{unit}]" if unit else name for name, unit, _ in found.axes]
    scales = [scale for *_, scale in found.axes]
    rows = [
        [
            str(i),
            *(f"{v * s:.5g}" for v, s in zip(point.values, scales, strict=True)),
            f"{point.design.optimality:.1e}",
            f"{point.design.candidate.size:.5g}",
            point.design.candidate.motion_type,
        ]
        for i, point in enumerate(front.points, 1)
    ]
    unit = task.draft.linkage.length_unit
    table = number_table(
        ["design", *heads, "KKT\nresidual", f"size\n[{unit}]", "motion type"], rows, words=[5]
    )
    return Group(Text(f"Front: {found.name}", style="bold underline"), facts.grid, Text(), table)


def _as_dict(found: FrontFound) -> dict[str, Any]:
    scales = [scale for *_, scale in found.axes]
    names = [f"{name}_{unit.replace(' ', '_')}" if unit else name for name, unit, _ in found.axes]
    points = [
        {"design": i, **{n: v * s for n, v, s in zip(names, point.values, scales, strict=True)}}
        for i, point in enumerate(found.front.points, 1)
    ]
    wants = [place + 1 for place in found.front.wants]
    return {
        **as_dict(found.designs),
        "front": {
            "wants": wants,
            "searches": found.front.solved,
            "missing": found.front.missing,
            "points": points,
        },
    }


def front_figure(found: FrontFound) -> Any:
    """The points of a front, numbered as their files."""
    from matplotlib.ticker import MaxNLocator

    front = found.front
    scales = [scale for *_, scale in found.axes]
    values = front.values * scales
    with styled():
        figure = page_figure(6.4, 5.2, pads=(0.05, 0.06))
        axes = figure.subplots()
        axes.plot(values[:, 0], values[:, 1], color=COMPUTED, lw=1.0, marker="o", ms=5.0, mfc="white")
        for i, (x, y) in enumerate(values, 1):
            axes.annotate(str(i), (x, y), xytext=(5, 5), textcoords="offset points")
        linkage = front.task.draft.linkage
        labels = [
            f"{short(want_words(front.task.wants[place], linkage), 70)}" + (f"\n[{unit}]" if unit else "")
            for place, (_, unit, _) in zip(front.wants, found.axes, strict=True)
        ]
        axes.set_xlabel(labels[0])
        axes.set_ylabel(labels[1])
        axes.xaxis.set_major_locator(MaxNLocator(7))
        axes.grid(lw=0.6)
        figure.suptitle(f"{short(found.name, 60)}\n{say('none is better in both')}")
    return figure
