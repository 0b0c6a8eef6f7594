"""Kinematics of closed spatial linkages: every assembly mode, whole circuits, exact rates.

import sevenbar as sb

linkage = sb.load("rssr")
motion = linkage.motion()
print(motion.motion_type)
"""

from __future__ import annotations

import importlib
from types import ModuleType

from sevenbar import errors
from sevenbar._core import __version__
from sevenbar.files import load, loads
from sevenbar.forms import from_axes, from_dh, rssr
from sevenbar.law_file import load_law
from sevenbar.linkage import Drive, Joint, Linkage, Point
from sevenbar.motion import (
    ChangePoint,
    Circuit,
    Count,
    DeadCentre,
    Extremes,
    Law,
    Modes,
    Motion,
    OpenRange,
    Output,
    Search,
    Trace,
)

__all__ = [
    "ChangePoint",
    "Circuit",
    "Count",
    "DeadCentre",
    "Drive",
    "Extremes",
    "Joint",
    "Law",
    "Linkage",
    "Modes",
    "Motion",
    "OpenRange",
    "Output",
    "Point",
    "Search",
    "Trace",
    "__version__",
    "errors",
    "from_axes",
    "from_dh",
    "load",
    "load_law",
    "loads",
    "rssr",
]

#: Modules that bring large libraries with them, imported at their first use.
_ON_DEMAND = ("design", "export", "plot", "report", "simulation", "sweep")


def __getattr__(name: str) -> ModuleType:
    if name in _ON_DEMAND:
        return importlib.import_module(f"sevenbar.{name}")
    raise AttributeError(f"module 'sevenbar' has no attribute '{name}'")
