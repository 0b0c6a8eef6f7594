"""The paper's RSSR and the 7R in two simulators: how long they take to come how near to the curve."""

from __future__ import annotations

import time
from typing import Any

import sevenbar as sb
from evidence.benches.harness import seconds, spread
from evidence.benches.outcome import Cell, Outcome, Plot, Series, Table
from evidence.benches.peers import AbsentError, reason_of
from evidence.benches.setting import Setting

TITLE = "Simulators: time to reach an accuracy"
ABOUT = """\
The same curve, one turn of the input, in Exudyn and in MuJoCo with more and more steps, as `sevenbar
simulate` runs them ([how](simulation.md)): CPU time of the engine's run alone, and the greatest
difference of any joint's angle from Sevenbar's. Sevenbar's own line: all circuits with exact rates at as
many samples, and the greatest closure error in parts of the linkage's size; it does not depend on their
number. An engine can do much that Sevenbar cannot: forces, contact, flexible bodies."""

STEPS = (225, 450, 900, 1800, 3600, 7200)

#: Position errors [rad] that a time is told for.
ASKED = (1e-3, 1e-4, 1e-5, 1e-6)

#: A turn of a joint's angle below this [rad] is the same up to rounding; logarithms need a number.
ROUNDING = 1e-16


def run(setting: Setting) -> Outcome:
    """A table and a plot for each linkage."""
    tables, plots = [], []
    for name, title in (("rssr", "The paper's RSSR"), ("seven_r", "The 7R paper's linkage")):
        linkage = sb.load(name)
        steps = setting.choose(STEPS, STEPS[1:3])
        curves: dict[str, list[tuple[int, float, float]]] = {"Sevenbar": ours(linkage, steps)}
        notes = {"Sevenbar": ""}
        for engine, who in (("exudyn", "Exudyn"), ("mujoco", "MuJoCo")):
            try:
                setting.peers.module(engine)
            except AbsentError as error:
                curves[who], notes[who] = [], str(error)
                continue
            curves[who], notes[who] = theirs(linkage, engine, steps)
        tables.append(table(title, curves, notes))
        plots.append(plot(f"bench_simulators_{name}", title, curves))
    return Outcome(TITLE, ABOUT, tables, plots)


def ours(linkage: sb.Linkage, steps: tuple[int, ...]) -> list[tuple[int, float, float]]:
    """Samples, seconds, and the greatest closure error relative to the size."""
    found = []
    for count in steps:
        motion = linkage.motion(count)
        error = max(float(circuit.residual.max()) / circuit.size for circuit in motion)
        took = [seconds(lambda: linkage.motion(count), 3) / 3 for _ in range(5)]  # noqa: B023
        found.append((count, spread(took)[0], max(error, ROUNDING)))
    return found


def theirs(
    linkage: sb.Linkage, engine: str, steps: tuple[int, ...]
) -> tuple[list[tuple[int, float, float]], str]:
    """Steps, seconds, and the greatest difference [rad]; and what went wrong at which number of steps."""
    from sevenbar.simulation.run import moved, prepared

    found, note = [], ""
    for count in steps:
        way, model = prepared(linkage, steps=count)
        start = time.process_time()
        try:
            run: Any = moved(way, model, engine)
        except Exception as error:
            note = f"{count} steps: {reason_of(error)}"
            continue
        took = time.process_time() - start
        turns = [found.greatest for found in run.differences if found.quantity.endswith(" angle")]
        found.append((count, took, max(*turns, ROUNDING)))
    return found, note


def table(title: str, curves: dict[str, list[tuple[int, float, float]]], notes: dict[str, str]) -> Table:
    """The least time [ms] in which each reaches each error, with its steps."""
    columns = ["", *(f"to {asked:.0e} rad [ms]" for asked in ASKED), "least error", "note"]
    rows: list[list[Cell]] = []
    for who, points in curves.items():
        row: list[Cell] = [who]
        for asked in ASKED:
            near = [took for _, took, error in points if error <= asked]
            row.append(1e3 * min(near) if near else None)
        least = min(error for *_, error in points) if points else None
        reached = f"{points[0][0]} to {points[-1][0]} steps" if points else ""
        rows.append([*row, least, "; ".join(part for part in (reached, notes[who]) if part)])
    return Table(title, columns, rows)


def plot(name: str, title: str, curves: dict[str, list[tuple[int, float, float]]]) -> Plot:
    """Error over time."""
    series = [
        Series(who, [1e3 * took for _, took, _ in points], [error for *_, error in points])
        for who, points in curves.items()
        if points
    ]
    return Plot(name, title, "CPU time [ms]", "greatest error [rad]", series)
