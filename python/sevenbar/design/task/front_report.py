"""A front of two wants as people and programs read it: a table, a figure, a file of each design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import RenderableType

from sevenbar.arrays import Floats
from sevenbar.design.tables import design_table
from sevenbar.design.task.front import ParetoFront
from sevenbar.design.task.report import TaskDesigns, as_dict, task_report
from sevenbar.design.task.task import DesignTask, MeasureWant
from sevenbar.design.task.words import task_facts
from sevenbar.drawing.figure import headline, page_figure
from sevenbar.drawing.names import short
from sevenbar.drawing.style import COMPUTED, styled
from sevenbar.reporting.csv_tables import write_csv
from sevenbar.reporting.files import Report, figure_files
from sevenbar.reporting.page import Facts, page
from sevenbar.text.words import say


@dataclass(frozen=True, eq=False)
class FrontFound(TaskDesigns):
    """A front, with its designs as those of a search."""

    front: ParetoFront = field(kw_only=True)

    @property
    def axes(self) -> list[tuple[str, str, float]]:
        """Of both wants: a name for tables, the unit, and what 1 of its value is there."""
        linkage = self.task.draft.linkage
        return [self.task.wants[place].axis(place, linkage) for place in self.front.wants]

    @property
    def values(self) -> Floats:
        """The two values of each point (n, 2) in the units of the axes."""
        return np.asarray(self.front.values * [scale for *_, scale in self.axes])

    @property
    def columns(self) -> dict[str, list[float]]:
        """The values of the points by the names that they have in tables."""
        names = (f"{name}_{unit.replace(' ', '_')}" if unit else name for name, unit, _ in self.axes)
        return {name: own.tolist() for name, own in zip(names, self.values.T, strict=True)}


def front_report(
    task: DesignTask, count: int, command: str, formats: Sequence[str] = ("png",)
) -> Report[FrontFound]:
    """How a front of at most `count` points is reported; the heads of its files name the `command`."""
    files: dict[str, Any] = {"front.csv": _write_table}
    files |= figure_files("front", formats, front_figure)
    return Report(_text, _as_dict, files | dict(task_report(task, count, command, formats).files))


def _write_table(result: FrontFound, path: Path) -> None:
    own = zip(result.values.tolist(), result.front.points, strict=True)
    rows = [[i, *pair, p.design.optimality, *p.design.values] for i, (pair, p) in enumerate(own, 1)]
    write_csv(path, ["design", *result.columns, "kkt_residual", *result.task.names], rows)


def _text(result: FrontFound) -> RenderableType:
    front = result.front
    facts = Facts()
    # whatever the goal of the task
    facts.add_all(task_facts(replace(result.task, goal="minimax")), bold=["wanted"])
    both = " and ".join(str(place + 1) for place in front.wants)
    points, searches = len(front.points), front.solved
    facts.add(
        "front",
        f"of wants {both}: {points} point{'s' * (points != 1)} of {searches} search{'es' * (searches != 1)}, "
        f"seed {result.seed}",
    )
    if points == 1 and not front.unfinished and not front.missing:
        facts.add("", "no design that was met is better in either")
    if front.missing:
        facts.add("", f"{front.missing} bound{'s' * (front.missing != 1)} had no design")
    if front.unfinished:
        facts.add("unfinished", front.unfinished, "bold yellow")
    heads = [f"{name.replace('_', ' ')}\n[{unit}]" if unit else name for name, unit, _ in result.axes]
    rows = [
        [
            *(f"{value:.5g}" for value in pair),
            f"{point.design.optimality:.1e}",
            f"{point.design.candidate.size:.5g}",
            point.design.candidate.motion_type,
        ]
        for pair, point in zip(result.values, front.points, strict=True)
    ]
    unit = result.task.draft.linkage.length_unit
    heads += ["KKT\nresidual", f"size\n[{unit}]", "motion type"]
    return page(f"Front: {result.name}", facts, design_table(heads, rows, words=heads[-1:]))


def _as_dict(result: FrontFound) -> dict[str, Any]:
    columns = result.columns
    rows = zip(*columns.values(), strict=True)
    points = [{"design": i, **dict(zip(columns, row, strict=True))} for i, row in enumerate(rows, 1)]
    front = result.front
    wants = [place + 1 for place in front.wants]
    own = {"wants": wants, "searches": front.solved, "missing": front.missing, "points": points}
    return {**as_dict(result), "front": own}


def front_figure(result: FrontFound) -> Any:
    """The points of a front, numbered as their files."""
    from matplotlib.ticker import MaxNLocator

    front, values = result.front, result.values
    with styled():
        figure = page_figure(6.4, 5.2, pads=(0.05, 0.06))
        axes = figure.subplots()
        axes.plot(values[:, 0], values[:, 1], color=COMPUTED, lw=0.8, ls=":", marker="o", ms=5.0, mfc="white")
        for i, (x, y) in enumerate(values, 1):
            axes.annotate(str(i), (x, y), xytext=(5, 5), textcoords="offset points")
        pairs = zip(front.wants, result.axes, strict=True)
        x_label, y_label = (_label(front.task, place, *axis[:2]) for place, axis in pairs)
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        axes.xaxis.set_major_locator(MaxNLocator(7))
        axes.grid(lw=0.6)
        headline(figure, f"{short(result.name, 60)}\n{say('none is better in both')}")
    return figure


def _label(task: DesignTask, place: int, name: str, unit: str) -> str:
    """What an axis says: the measure, or the greatest error and of what."""
    want, own = task.wants[place], f" [{unit}]" if unit else ""
    if isinstance(want, MeasureWant):
        return f"{name.replace('_', ' ')}{own}"
    return f"greatest error of want {place + 1}{own}\n{short(want.words(task.draft.linkage), 62)}"
