"""Sixty design tasks with a known answer: how many are found, how exactly, and whether any is defective.

python -m evidence.design [FAMILY ..]        path, function, poses, cusp; all where none is given
"""

from __future__ import annotations

import sys
import time

import numpy as np

from evidence.design.tasks import tasks
from sevenbar.design.task import DesignTask, FunctionWant, PathWant, PoseWant
from sevenbar.design.task.check import TaskDesign
from sevenbar.design.task.search import DesignsFound, designed
from sevenbar.kinematics.loop.law import Law

#: A known answer is found where no error is greater [rad, or relative to size, extent of the path, arm].
FOUND = 1e-9

#: Starts besides the linkage itself.
STARTS = 32

#: Inputs from the first to the last at which an accepted design is searched for a dead centre between.
BETWEEN = 721


def unit_of(task: DesignTask) -> float:
    """What errors of the want are relative to."""
    want = task.wants[0]
    if isinstance(want, FunctionWant):
        linkage = task.draft.linkage
        slides = linkage.unit_of(linkage.drive.output) != "rad"
        return max(abs(d.value) for d in task.draft.dimensions if d.kind == "length") if slides else 1.0
    if isinstance(want, PathWant):
        return float(np.ptp(want.places, axis=0).max())
    assert isinstance(want, PoseWant)
    return want.arm


def is_whole(design: TaskDesign) -> bool:
    """Whether one pass of the design's linkage leads from its first input to its last, asked anew."""
    inputs = design.candidate.claim.inputs
    between = np.linspace(inputs.min(), inputs.max(), BETWEEN)
    law = Law.of(np.arange(BETWEEN, dtype=float), between, 1.0, 0.0)
    circuit = design.draft.linkage.motion(law=law).circuits[design.candidate.circuit]
    passes = circuit.q[:, circuit.output_column].reshape(-1, BETWEEN)
    at = np.searchsorted(between, inputs).clip(0, BETWEEN - 1)
    outputs = design.candidate.claim.outputs
    near = (
        np.abs(np.sin((passes[:, at] - outputs) / 2))
        if circuit.output_turns
        else np.abs(passes[:, at] - outputs)
    )
    limit = 0.05 if circuit.output_turns else 0.05 * max(float(np.ptp(outputs)), 1.0)
    return bool((np.isfinite(passes).all(axis=1) & (near < limit).all(axis=1)).any())


def main(families: list[str]) -> int:
    """Prints a row for each task, and the sums."""
    print(f"{'task':50} {'off':>4} {'error':>9} {'optimality':>10} {'time':>6}  refused")
    sums = {}
    for family in families or ["path", "function", "poses", "cusp"]:
        found, defective, number = 0, 0, 0
        for made in tasks(family):
            begin = time.perf_counter()
            result: DesignsFound = designed(made.task, count=1, starts=STARTS)
            seconds = time.perf_counter() - begin
            number += 1
            best = result.designs[0] if result.designs else None
            error = np.inf if best is None else best.met[0].greatest / unit_of(made.task)
            found += error < FOUND
            defective += best is not None and not is_whole(best)
            optimality = np.nan if best is None else best.optimality
            print(
                f"{made.name:50} {made.share:4.0%} {error:9.1e} {optimality:10.1e} {seconds:5.1f}s"
                f"  {result.refused}",
                flush=True,
            )
        sums[family] = f"{family}: {found} of {number} found within {FOUND:g}, {defective} defective"
    print(*sums.values(), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
