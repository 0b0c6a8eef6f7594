"""The gallery moved by two simulators that know nothing of Sevenbar's equations, row by row beside it."""

from __future__ import annotations

import numpy as np

import sevenbar as sb
from evidence.accuracy.quantiles import quantiles
from sevenbar.simulation.run import simulate

#: Engines, and the steps a turn that each takes.
ENGINES = ("exudyn", "mujoco")


def measured(name: str, engine: str, steps: int) -> dict[str, object]:
    """Quantiles of the output's differences, relative to the greatest value or to the input's pace.

    Angles are not scaled [rad], slides and places are relative to the size.
    """
    run = simulate(sb.load(name), engine, steps=steps)
    circuit = run.course.circuit
    column = circuit.output_column
    unit = 1.0 if circuit.output_turns else circuit.size
    pace = abs(run.course.motion.speed)
    found = {}
    for order, (quantity, theirs, ours) in enumerate(
        (
            ("position", run.engine.q, run.theory.q),
            ("velocity", run.engine.dq, run.theory.dq),
            ("acceleration", run.engine.ddq, run.theory.ddq),
        )
    ):
        values = ours[:, column] / unit
        scale = max(pace**order, float(np.nanmax(np.abs(values)))) if order else 1.0
        off = np.abs(theirs[:, column] - ours[:, column]) / unit / scale
        found[quantity] = quantiles(off[np.isfinite(off)])
    return {
        "engine": run.record.engine,
        "version": run.record.version,
        "steps": steps,
        "rows": len(run.time),
        "course": "cycle" if run.course.closes else "one pass",
        "output": found,
        "gap": run.gap / circuit.size,
    }
