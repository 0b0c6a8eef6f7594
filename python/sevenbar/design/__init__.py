"""Design: maps, tolerances, linkages for a wanted motion, and points of links with wanted paths."""

from __future__ import annotations

import importlib
from types import ModuleType

__all__ = ["exact", "maps", "points", "survey", "synthesis", "task", "tolerance"]


def __getattr__(name: str) -> ModuleType:
    # each at its first use, since each needs other extras
    if name in __all__:
        return importlib.import_module(f"sevenbar.design.{name}")
    raise AttributeError(f"module 'sevenbar.design' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(__all__)
