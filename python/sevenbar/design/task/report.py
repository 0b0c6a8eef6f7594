"""Designs of a task as people and programs read them: printed, as JSON, as a folder of files."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from sevenbar.design.candidates import CHECK_SAMPLES, Candidate
from sevenbar.design.files import design_files
from sevenbar.design.tables import plain_designs, sheets
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.check import TaskDesign
from sevenbar.design.task.effort import WHOLE
from sevenbar.design.task.figures import musts_figure, want_figure
from sevenbar.design.task.search import DesignsFound
from sevenbar.design.task.task import DesignTask, PoseMust
from sevenbar.design.task.words import task_facts
from sevenbar.drawing.configuration import configuration
from sevenbar.reporting.files import Report, figure_files
from sevenbar.reporting.page import Facts, page

#: Numbers in a printed table, side by side.
ACROSS = 7

#: A free number this near to its bound, relative to the range, lies on it.
ON_BOUND = 1e-9


@dataclass(frozen=True, eq=False)
class TaskDesigns:
    """What a search found, with the name and source of the task and what the search was given.

    `survey` has what a survey says that went before, by labels, and `plain` the same as plain values.
    """

    found: DesignsFound
    name: str
    source: str
    starts: int
    seed: int
    survey: Sequence[tuple[str, str]] = ()
    plain: Mapping[str, Any] = field(default_factory=dict)

    @property
    def task(self) -> DesignTask:
        """The task."""
        return self.found.task

    @property
    def unfinished(self) -> str:
        """That the search was stopped; empty where it ended."""
        return self.found.unfinished

    @cached_property
    def candidates(self) -> Sequence[Candidate]:
        """The designs with all that is reported of them as columns."""
        return tuple(
            replace(
                one.candidate,
                claim=replace(one.candidate.claim, figures=design_figures(self.task, one)),
            )
            for one in self.found.designs
        )


def design_figures(task: DesignTask, design: TaskDesign) -> dict[str, float]:
    """Numbers of a design besides those of its first want: names end in the unit."""
    figures = dict(design.candidate.claim.figures)
    along = DesignAlong(task, design)
    for number, ((place, _), met) in enumerate(zip(task.sampled, design.met, strict=True)):
        unit, scale = met.shown
        own = f"want_{place + 1}_" if len(task.wants) > 1 else ""
        if own:
            figures[f"{own}greatest_{unit}"] = met.greatest * scale
            figures[f"{own}rms_{unit}"] = met.rms * scale
        figures |= {f"{own}{fact.name}_{fact.unit}": fact.value for fact in along.facts(number)}
    figures |= design.figures
    if design.transmission is not None:
        figures["transmission_of_circuit_deg"] = math.degrees(design.transmission)
    figures |= {"cost": design.cost, "kkt_residual": design.optimality}
    if math.isfinite(design.room):
        figures["least_room"] = design.room
    return figures


def task_report(
    task: DesignTask, count: int, command: str, formats: Sequence[str] = ("png",)
) -> Report[TaskDesigns]:
    """How at most `count` designs of a task are reported; the heads of their files name the `command`."""
    files: dict[str, Any] = {}
    toml = design_files(count, (), head=partial(_head, command), as_dict=as_dict)
    for place in range(count):
        name = f"design_{place + 1}"
        files[f"{name}.toml"] = toml[f"{name}.toml"]
        drawn: dict[str, Callable[[DesignAlong], Any]] = {"linkage": _linkage}
        for number, (want, _) in enumerate(task.sampled):
            drawn[f"want_{want + 1}"] = partial(want_figure, number=number)
        if any(isinstance(must, PoseMust) for must in task.musts):
            drawn["musts"] = musts_figure
        for what, draw in drawn.items():
            files |= figure_files(f"{name}_{what}", formats, partial(_drawn, place=place, draw=draw))
    return Report(text, as_dict, files | {name: toml[name] for name in ("summary.csv", "summary.json")})


def _drawn(result: TaskDesigns, *, place: int, draw: Callable[[DesignAlong], Any]) -> Any:
    """A figure of a design, if there are as many."""
    designs = result.found.designs
    return draw(DesignAlong(result.task, designs[place])) if place < len(designs) else None


def _linkage(along: DesignAlong) -> Any:
    own = along.design.candidate
    return configuration(own.draft.linkage.motion(CHECK_SAMPLES), own.circuit)


def _facts(result: TaskDesigns) -> list[tuple[str, str]]:
    facts = task_facts(result.task)
    if result.survey:
        facts += [("drawn", f"{result.starts} linkages, seed {result.seed}"), *result.survey]
    else:
        searched = (
            f"{result.found.starts} ways to begin from {result.starts + 1} linkages, seed {result.seed}"
        )
        facts.append(("searched", searched))
    if result.found.ended_early:
        count = result.found.ended_early
        early = f"{count} start{'s' * (count != 1)} ended after {WHOLE} measured motions each"
        facts.append(("", early))
    if result.found.refusals:
        facts.append(("of the best" if result.survey else "refused", result.found.refused))
    return facts


def _head(command: str, result: TaskDesigns) -> list[str]:
    lines = [f"{label}: {words}" if label else f"  {words}" for label, words in _facts(result)]
    if result.unfinished:
        lines.append(f"unfinished: {result.unfinished}")
    return [f"task: {result.name}", *lines, f"made by: {command}"]


def text(result: TaskDesigns) -> RenderableType:
    """The designs for people."""
    facts = Facts()
    facts.add_all(_facts(result), bold=("wanted", "answer"))
    if result.unfinished:
        facts.add("unfinished", result.unfinished, "bold yellow")
    tables = _tables(result) if result.found.designs else []
    tables += _reasons(result.found.designs)
    return page(f"Design: {result.name}", facts, *tables)


#: Why the conditions of an optimum are missed, by how the search ended.
REASONS = {
    "edge": "ends at an edge: a small step further the linkage does not close, or a measure jumps as the "
    "motion type changes. There may be better designs along the edge. Bound a measure or a range so that "
    "designs stay away from it, or take another design",
    "valley": "ends in a narrow valley, where the error falls too slowly to reach its bottom. Begin again "
    "with this design as the linkage, give a measure a greater unit, or take more --starts",
}


def _reasons(designs: Sequence[TaskDesign]) -> list[RenderableType]:
    """A line for each way in which designs ended before an optimum."""
    lines: list[RenderableType] = []
    for ended, words in REASONS.items():
        numbers = [str(i + 1) for i, design in enumerate(designs) if design.solution.ended == ended]
        if numbers:
            some = f"design{'s' * (len(numbers) > 1)} {', '.join(numbers)}"
            lines.append(Text(f"KKT residual of {some}: {words}", style="yellow"))
    return lines


def _bounded(design: TaskDesign, place: int, low: float, high: float) -> str:
    """A value; on a bound the bound itself, with a star: a zero is no 6e-15."""
    value, gap = float(design.values[place]), ON_BOUND * (high - low)
    for bound in (low, high):
        if abs(value - bound) <= gap:
            return f"{bound:.5g}*"
    return f"{value:.5g}"


def _tables(result: TaskDesigns) -> list[RenderableType]:
    """Tables with a line for each design: how well each want is met, what it is, its free numbers."""
    task, designs, unit = result.task, result.found.designs, result.task.draft.linkage.length_unit
    met: list[tuple[str, list[str]]] = []
    alongs = [DesignAlong(task, design) for design in designs]
    for number, (place, _) in enumerate(task.sampled):
        mets = [design.met[number] for design in designs]
        own, scale = mets[0].shown
        met += [
            (f"want {place + 1}\ngreatest\n[{own}]", [f"{one.greatest * scale:.4g}" for one in mets]),
            (f"want {place + 1}\nRMS\n[{own}]", [f"{one.rms * scale:.4g}" for one in mets]),
        ]
        each = [[f for f in along.facts(number) if f.tabled] for along in alongs]
        for facts in zip(*each, strict=True):
            head = f"want {place + 1}\n{facts[0].name}\n[{facts[0].unit}]"
            met.append((head, [f"{fact.value:.5g}" for fact in facts]))
    for name in dict.fromkeys(name for design in designs for name in design.figures):
        met.append((name.replace("_", "\n"), [f"{design.figures[name]:.5g}" for design in designs]))
    angles = (
        ("used", [design.candidate.transmission_lowest for design in designs]),
        ("circuit", [design.transmission for design in designs]),
    )
    for where, found_there in angles:
        if any(one is not None for one in found_there):
            cells = ["-" if one is None else f"{math.degrees(one):.4g}" for one in found_there]
            met.append((f"transmission\n{where}\n[deg]", cells))
    rest = [("least\nroom", [f"{design.room:.2g}" for design in designs])]
    if not any(math.isfinite(design.room) for design in designs):
        rest = []
    rest += [
        ("KKT\nresidual", [f"{design.optimality:.1e}" for design in designs]),
        (f"size\n[{unit}]", [f"{design.candidate.size:.5g}" for design in designs]),
        ("motion type", [design.candidate.motion_type for design in designs]),
        ("circuit", [str(design.candidate.circuit) for design in designs]),
    ]
    free: list[tuple[str, list[str]]] = []
    for k, one in enumerate(task.free):
        own = task.draft.dimension(one.name).unit
        cells = [_bounded(design, k, one.low, one.high) for design in designs]
        free.append((f"{one.name}\n[{own}]" if own else one.name, cells))
    tables: list[RenderableType] = [*sheets(met, ACROSS)]
    tables += [*sheets(rest, len(rest), words=["motion type"]), *sheets(free, ACROSS)]
    if any(cell.endswith("*") for _, cells in free for cell in cells):
        tables[-1] = Group(tables[-1], Text("* on its bound", style="dim"))
    return tables


def as_dict(result: TaskDesigns) -> dict[str, Any]:
    """The designs as plain values; what has a unit has it in its name."""
    task = result.task
    linkage = task.draft.linkage
    return {
        "format": 1,
        "task": result.name,
        "source": result.source,
        "goal": task.goal,
        "placement": task.placement,
        "limits": task.limits.text(),
        "wanted": [want.words(linkage) for want in task.wants],
        "must_hold": [must.words(linkage) for must in task.musts],
        "free": {one.name: [one.low, one.high] for one in task.free},
        "starts": result.starts,
        "begun": result.found.starts,
        "ended_early": result.found.ended_early,
        "seed": result.seed,
        "unfinished": result.unfinished or None,
        "refused": list(map(vars, result.found.refusals)),
        "designs": [
            {
                **own,
                "wants": [
                    {"want": place + 1, "greatest": met.greatest, "rms": met.rms, "unit": met.unit}
                    for (place, _), met in zip(task.sampled, design.met, strict=True)
                ],
                "musts": _slacks(task, design),
                "ended": design.solution.ended,
                "values": dict(zip(task.names, map(float, design.values), strict=True)),
            }
            for own, design in zip(plain_designs(result), result.found.designs, strict=True)
        ],
        **result.plain,
    }


def _slacks(task: DesignTask, design: TaskDesign) -> list[Mapping[str, Any]]:
    """The least slack of each must about poses, over all wants."""
    along = DesignAlong(task, design)
    least: dict[int, float] = {}
    for place, _, _, values in along.slacks():
        least[place] = min(least.get(place, math.inf), float(values.min()))
    return [
        {"must": place + 1, "room": slack, "unit": along.slack_unit(place)} for place, slack in least.items()
    ]
