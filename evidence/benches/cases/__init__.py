"""One file for each comparison: `TITLE`, `ABOUT` and `run(setting)`, which gives an `Outcome`."""

from __future__ import annotations

import importlib
from types import ModuleType

#: In the order of the page.
CASES = (
    "rssr_array",
    "circuit",
    "nets",
    "forces",
    "modes",
    "simulators",
    "sweeps",
    "growth",
    "footprint",
    "studio",
)


def case(name: str) -> ModuleType:
    """The module of a case."""
    return importlib.import_module(f"evidence.benches.cases.{name}")
