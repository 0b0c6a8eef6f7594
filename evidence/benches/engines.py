"""The tables of docs/simulation.md: every gallery linkage in both engines, and what a smaller step does.

python evidence/benches/engines.py
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

import sevenbar as sb
from sevenbar.description.gallery import names
from sevenbar.simulation.agreement import Simulation
from sevenbar.simulation.run import ENGINES, simulate

#: Steps a turn whose errors are set beside each other.
STEPS = (1800, 3600, 7200)


def numbers(run: Simulation) -> list[float]:
    """Differences of the output and of any joint's turn; the closure error by the size, and as an angle."""
    turns = [found.greatest for found in run.differences if found.quantity.endswith(" angle")]
    size = run.course.circuit.size
    return [*(found.greatest for found in run.differences[:3]), max(turns), run.gap / size, run.tilt]


def shown(values: Sequence[float]) -> str:
    """Cells of a table; below 1e-10 a difference is rounding, and only its size is told."""
    return " | ".join("< 1e-10" if value < 1e-10 else f"{value:.1e}" for value in values)


def by_steps(engine: str, steps: int) -> str:
    """A row of the first table."""
    run = simulate(sb.load("rssr"), engine, steps=steps)
    return f"| {run.record.engine} | {steps} | {shown([*numbers(run)[:3], run.gap, run.tilt])} |"


def by_linkage(engine: str, name: str) -> str:
    """A row of an engine's table of the gallery."""
    linkage = sb.load(name)
    run = simulate(linkage, engine)
    way = "one pass" if not run.course.closes else "cycle"
    kind = " ".join(joint.kind for joint in linkage.joints)
    return f"| {name} | {kind} | {len(run.model.redundant)} | {way} | {shown(numbers(run))} |"


def main() -> None:
    """Prints the tables."""
    for engine in ENGINES:
        print(*(by_steps(engine, steps) for steps in STEPS), sep="\n")
    for engine in ENGINES:
        print(f"\n{engine} {version(engine)}")
        for name in names():
            print(by_linkage(engine, name))


if __name__ == "__main__":
    main()
