"""The table of docs/simulation.md: what a smaller step does in both engines.

python evidence/benches/engines.py
"""

from __future__ import annotations

from collections.abc import Sequence

import sevenbar as sb
from sevenbar.simulation.run import ENGINES, simulate

#: Steps a turn whose errors are set beside each other.
STEPS = (1800, 3600, 7200)


def shown(values: Sequence[float]) -> str:
    """Cells of a table; below 1e-10 a difference is rounding, and only its size is told."""
    return " | ".join("< 1e-10" if value < 1e-10 else f"{value:.1e}" for value in values)


def by_steps(engine: str, steps: int) -> str:
    """A row of the table."""
    run = simulate(sb.load("rssr"), engine, steps=steps)
    output = [found.greatest for found in run.differences[:3]]
    return f"| {run.record.engine} | {steps} | {shown([*output, run.gap, run.tilt])} |"


def main() -> None:
    """Prints the table."""
    for engine in ENGINES:
        print(*(by_steps(engine, steps) for steps in STEPS), sep="\n")


if __name__ == "__main__":
    main()
