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
from sevenbar.description.files import load, loads
from sevenbar.description.forms import from_axes, from_dh, rssr
from sevenbar.description.law_file import load_law
from sevenbar.kinematics.circuits import Circuit, DeadCentre, Extremes, Law, Trace
from sevenbar.kinematics.geometry import Drive, Joint, Point
from sevenbar.kinematics.grashof import FourBar
from sevenbar.kinematics.instant_centres import InstantCentre, InstantCentres
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.motion import ChangePoint, Count, Modes, Motion, OpenRange, Output, Search
from sevenbar.kinematics.plane_and_sphere import MotionPlane, MotionSphere
from sevenbar.kinematics.screw_axes import ScrewAxes
from sevenbar.text.printing import SAID_IN

__all__ = [
    "ChangePoint",
    "Circuit",
    "Count",
    "DeadCentre",
    "Drive",
    "Extremes",
    "FourBar",
    "InstantCentre",
    "InstantCentres",
    "Joint",
    "Law",
    "Linkage",
    "Modes",
    "Motion",
    "MotionPlane",
    "MotionSphere",
    "OpenRange",
    "Output",
    "Point",
    "ScrewAxes",
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

#: What is imported at its first use, since it brings large libraries with it: the name and its module.
_ON_DEMAND = {
    "animate": "sevenbar.drawing.animate",
    "design": "sevenbar.design",
    "export": "sevenbar.export",
    "gallery": "sevenbar.description.gallery",
    "plot": "sevenbar.drawing.plot",
    "report": "sevenbar.reporting.report",
    "simulation": "sevenbar.simulation",
    "sweep": "sevenbar.sweep",
}

# what results print is said where the reports' words are, which a program that prints none does without
SAID_IN["sevenbar.kinematics"] = "sevenbar.reporting.results"
for _folder in ("design.maps", "design.points", "measuring", "simulation"):
    SAID_IN[f"sevenbar.{_folder}"] = f"sevenbar.{_folder}.report"


def __dir__() -> list[str]:
    return sorted({*__all__, *_ON_DEMAND})


def _offered(module: ModuleType) -> list[str]:
    own = [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__
    ]
    return list(getattr(module, "__all__", own))


def __getattr__(name: str) -> ModuleType:
    if name in _ON_DEMAND:
        module = importlib.import_module(_ON_DEMAND[name])
        # what it offers, without what it imports
        module.__dict__.setdefault("__dir__", lambda: sorted(_offered(module)))
        return module
    raise AttributeError(f"module 'sevenbar' has no attribute '{name}'")
