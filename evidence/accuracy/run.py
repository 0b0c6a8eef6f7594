"""All measurements, as tasks on the cores; the results as one value that JSON can hold."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from evidence.accuracy import (
    closed_forms,
    dead_centres,
    extremes,
    finite_differences,
    gallery_rows,
    published,
    simulators,
)
from evidence.accuracy.dead_centres import DISTANCES
from evidence.accuracy.gallery_rows import SEED, Amount
from evidence.circumstances import circumstances
from sevenbar.description import gallery
from sevenbar.errors import SevenbarError


@dataclass(frozen=True)
class Budget:
    """How much is compared.

    Rows of a circuit; inputs of a closed form; steps a turn of an engine; dead centres of a motion, and the
    distances from them; circuits whose extremes are compared.
    """

    rows: Amount
    inputs: int
    steps: int
    dead_centres: int
    distances: tuple[float, ...]
    extremes: int


#: Some eight minutes of processor time, and one.
FULL = Budget(Amount(random=200, worst=20, grid=360), 500, 3600, 4, DISTANCES, 100)
QUICK = Budget(Amount(random=8, worst=2, grid=180), 30, 360, 1, DISTANCES[::5], 1)


@dataclass(frozen=True)
class Task:
    """One piece of work for one process: the section of the results, and what it is of."""

    section: str
    name: str


def tasks(names: Sequence[str]) -> list[Task]:
    """For the named linkages, the longest first."""
    found = [Task("rows", name) for name in names]
    found += [Task(section, name) for section in ("dead_centres", "extremes") for name in names]
    found += [Task(engine, name) for engine in simulators.ENGINES for name in names]
    found += [Task("closed_forms", form.linkage) for form in closed_forms.FORMS if form.linkage in names]
    return [*found, Task("published", "all"), Task("differences", "all")]


def done(task: Task, budget: Budget) -> dict[str, object]:
    """The results of one task."""
    name = task.name
    if task.section in simulators.ENGINES:
        try:
            return simulators.measured(name, task.section, budget.steps)
        except SevenbarError as error:
            return {"engine": task.section, "missing": str(error)}
    work: dict[str, Callable[[], dict[str, object]]] = {
        "rows": lambda: gallery_rows.measured(name, budget.rows),
        "dead_centres": lambda: dead_centres.measured(
            name, distances=budget.distances, most=budget.dead_centres
        ),
        "extremes": lambda: extremes.measured(name, budget.extremes),
        "closed_forms": lambda: closed_forms.measured(
            next(form for form in closed_forms.FORMS if form.linkage == name), budget.inputs
        ),
        "published": published.measured,
        "differences": finite_differences.measured,
    }
    return work[task.section]()


def _timed(task: Task, budget: Budget) -> tuple[dict[str, object], float]:
    start = time.process_time()
    return done(task, budget), time.process_time() - start


def results(names: Sequence[str], budget: Budget, *, processes: int | None = None) -> dict[str, object]:
    """Everything, by section and name."""
    todo = tasks(names)
    found: dict[str, dict[str, object]] = {}
    spent = 0.0
    with ProcessPoolExecutor(processes or os.cpu_count()) as pool:
        pending = [(task, pool.submit(_timed, task, budget)) for task in todo]
        for number, (task, future) in enumerate(pending, 1):
            result, seconds = future.result()
            found.setdefault(task.section, {})[task.name] = result
            spent += seconds
            print(f"[{number}/{len(todo)}] {task.section} {task.name}: {seconds:.1f} s", file=sys.stderr)
    return framed(found, names, budget, spent)


def framed(
    found: Mapping[str, Mapping[str, object]], names: Sequence[str], budget: Budget, spent: float
) -> dict[str, object]:
    """Results with the circumstances and settings that they were made in; `spent` [s] of processor time."""
    return {
        "made": circumstances("mpmath", "exudyn", "mujoco"),
        "settings": {
            "seed": SEED,
            "random": budget.rows.random,
            "worst": budget.rows.worst,
            "grid": budget.rows.grid,
            "inputs": budget.inputs,
            "steps": budget.steps,
            "near": gallery_rows.NEAR,
            "distances": [budget.distances[0], budget.distances[-1]],
            "whole": budget == FULL and list(names) == list(gallery.loops()),
            "seconds": round(spent),
        },
        **found,
    }
