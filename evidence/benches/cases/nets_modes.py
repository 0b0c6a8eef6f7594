"""All modes of nets at one input, and the start that a process makes once for each pattern of links."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys

import numpy as np

import sevenbar as sb
from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Cell, Table
from evidence.benches.setting import Setting

#: Nets of the gallery with the joint that drives, where it is not the file's, and the middle of the inputs.
NETS: tuple[tuple[str, str | None, float], ...] = (
    ("watt", None, 0.0),
    ("jansen", None, 0.0),
    # drawn near a dead centre of this input
    ("stephenson", "lever", 0.3),
    ("rssr_ss", None, 0.0),
    ("double_wishbone", None, 0.0),
    ("five_rod", None, 0.0),
    ("platform", None, 0.0),
)

#: Inputs that are solved in turn, and how far they go from the middle [rad, or relative to the size].
INPUTS, REACH = 16, 0.05

#: What a new process prints: CPU time [s] of its first modes and of the next. Those of a net without a start
#: come before, for what is imported at first use.
FIRST_CALLS = """\
import json, sys, time
import sevenbar as sb
sb.load("watt").assembly_modes(0.1)
linkage, joint = sb.load(sys.argv[1]), sys.argv[2] or None
times = [time.process_time()]
for value in (0.0, 0.0):
    linkage.assembly_modes(value, input=joint)
    times.append(time.process_time())
print(json.dumps([times[1] - times[0], times[2] - times[1]]))
"""


def table(setting: Setting) -> Table:
    """One row for each net."""
    works, counts, words = [], [], []
    for name, joint, middle in NETS:
        linkage = sb.load(name)
        column = linkage.input_column(joint)
        reach = REACH * (1.0 if linkage.turning[column] else linkage.size)
        values = middle + np.linspace(-reach, reach, INPUTS)

        def call(
            linkage: sb.Linkage = linkage, joint: str | None = joint, values: np.ndarray = values
        ) -> list[int]:
            return [len(linkage.assembly_modes(float(value), input=joint)) for value in values]

        works.append(Work(name, call, INPUTS))
        counts.append(sum(call()) / INPUTS)
        words.append(linkage.assembly_modes(middle, input=joint).completeness)
    rows: list[list[Cell]] = []
    timings = compare(works, rounds=setting.choose(15, 3))
    for (name, joint, _), timing, count, word in zip(NETS, timings, counts, words, strict=True):
        who = name if joint is None else f"{name}, {joint} drives"
        times = [1e6 * value for value in (timing.median, timing.low, timing.high)]
        rows.append([who, word, count, *times, times[0] / count, started(setting, name, joint), ""])
    columns = ["", "modes are", "modes", "µs an input", "from", "to", "µs a mode", "start [ms]", "note"]
    return Table("All modes at one input", columns, rows)


def started(setting: Setting, name: str, joint: str | None) -> float:
    """What the first modes in a new process take more than the next [ms]."""
    more: list[float] = []
    for _ in range(setting.choose(7, 2)):
        words = [sys.executable, "-c", FIRST_CALLS, name, joint or ""]
        run = subprocess.run(words, check=True, capture_output=True, text=True)
        first, second = map(float, json.loads(run.stdout))
        more.append(1e3 * (first - second))
    return statistics.median(more)
