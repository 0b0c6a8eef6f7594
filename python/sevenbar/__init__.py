"""Kinematics of closed spatial linkages: every assembly mode, whole circuits, exact rates.

import sevenbar as sb

linkage = sb.load("rssr")
motion = linkage.motion()
print(motion.motion_type)
"""

from __future__ import annotations

import importlib
import sys
from importlib.machinery import ModuleSpec

from sevenbar.text.above import DRAWN_IN, SAID_IN

# as typing has it, whose import takes as long as all else here
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

    from sevenbar import errors
    from sevenbar._core import __version__
    from sevenbar.description.constructors import from_axes, from_dh, from_pins, rssr
    from sevenbar.description.families import (
        bennett,
        bricard_line,
        bricard_plane,
        bricard_trihedral,
        clemens,
        four_bar,
        goldberg,
        myard,
        sarrus,
        slider_crank,
        spherical_four_bar,
        universal_joint,
    )
    from sevenbar.description.files import load, loads
    from sevenbar.description.law_file import load_law
    from sevenbar.description.step_axes import PartAxis, axes_of_step
    from sevenbar.description.tables import from_table
    from sevenbar.forces.acting import Load, Spring
    from sevenbar.forces.bodies import Body
    from sevenbar.forces.free_motion.equilibria import Equilibrium
    from sevenbar.forces.free_motion.result import FreeMotion
    from sevenbar.forces.loading import Loading
    from sevenbar.kinematics.circuits.circuit import Circuit
    from sevenbar.kinematics.circuits.circuit_values import DeadCentre, Extremes, Trace
    from sevenbar.kinematics.circuits.instant_centres import InstantCentre, InstantCentres
    from sevenbar.kinematics.circuits.modes import Modes, Output
    from sevenbar.kinematics.circuits.motion import ChangePoint, Motion
    from sevenbar.kinematics.circuits.one_pose import OnePose
    from sevenbar.kinematics.circuits.search import Count, OpenRange, Search
    from sevenbar.kinematics.linkage import Linkage
    from sevenbar.kinematics.loop.geometry import Drive, Joint, Point
    from sevenbar.kinematics.loop.grashof import FourBar
    from sevenbar.kinematics.loop.law import Law
    from sevenbar.kinematics.loop.screw_axes import ScrewAxes
    from sevenbar.kinematics.loop.stops import Cone
    from sevenbar.kinematics.solvers.plane_and_sphere import MotionPlane, MotionSphere
    from sevenbar.text.words import language

__all__ = [
    "Body",
    "ChangePoint",
    "Circuit",
    "Cone",
    "Count",
    "DeadCentre",
    "Drive",
    "Equilibrium",
    "Extremes",
    "FourBar",
    "FreeMotion",
    "InstantCentre",
    "InstantCentres",
    "Joint",
    "Law",
    "Linkage",
    "Load",
    "Loading",
    "Modes",
    "Motion",
    "MotionPlane",
    "MotionSphere",
    "OnePose",
    "OpenRange",
    "Output",
    "PartAxis",
    "Point",
    "ScrewAxes",
    "Search",
    "Spring",
    "Trace",
    "__version__",
    "axes_of_step",
    "bennett",
    "bricard_line",
    "bricard_plane",
    "bricard_trihedral",
    "clemens",
    "errors",
    "four_bar",
    "from_axes",
    "from_dh",
    "from_pins",
    "from_table",
    "goldberg",
    "language",
    "load",
    "load_law",
    "loads",
    "myard",
    "rssr",
    "sarrus",
    "slider_crank",
    "spherical_four_bar",
    "universal_joint",
]

#: Modules that are imported at their first use, since they bring large libraries with them.
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

#: All names, by the modules that have them. None is imported before its first use, so that a program heeds
#: Ctrl+C from its first moment on, while numpy is still to come.
_NAMES_OF_MODULES = {
    "_core": "__version__",
    "description.constructors": "from_axes from_dh from_pins rssr",
    "description.families": "bennett bricard_line bricard_plane bricard_trihedral clemens four_bar goldberg "
    "myard sarrus slider_crank spherical_four_bar universal_joint",
    "description.files": "load loads",
    "description.law_file": "load_law",
    "description.step_axes": "PartAxis axes_of_step",
    "description.tables": "from_table",
    "forces.acting": "Load Spring",
    "forces.bodies": "Body",
    "forces.free_motion.equilibria": "Equilibrium",
    "forces.free_motion.result": "FreeMotion",
    "forces.loading": "Loading",
    "kinematics.circuits.circuit": "Circuit",
    "kinematics.circuits.circuit_values": "DeadCentre Extremes Trace",
    "kinematics.circuits.instant_centres": "InstantCentre InstantCentres",
    "kinematics.circuits.modes": "Modes Output",
    "kinematics.circuits.motion": "ChangePoint Motion",
    "kinematics.circuits.one_pose": "OnePose",
    "kinematics.circuits.search": "Count OpenRange Search",
    "kinematics.linkage": "Linkage",
    "kinematics.loop.geometry": "Drive Joint Point",
    "kinematics.loop.grashof": "FourBar",
    "kinematics.loop.law": "Law",
    "kinematics.loop.screw_axes": "ScrewAxes",
    "kinematics.loop.stops": "Cone",
    "kinematics.solvers.plane_and_sphere": "MotionPlane MotionSphere",
    "text.words": "language",
}
_NAMES_ON_DEMAND = {name: module for module, names in _NAMES_OF_MODULES.items() for name in names.split()}

# what results print is written where the reports' words are, which a program that prints none does without
SAID_IN["sevenbar.kinematics"] = "sevenbar.reporting.results"
SAID_IN["sevenbar.forces.free_motion"] = "sevenbar.reporting.free_motion"
SAID_IN["sevenbar.forces"] = "sevenbar.reporting.force_results"
for _folder in ("design.exact", "design.maps", "design.points", "measuring", "simulation"):
    SAID_IN[f"sevenbar.{_folder}"] = f"sevenbar.{_folder}.report"
# bodies that are given as drawn are those of exports, which stand above the kinematics
DRAWN_IN["bodies"] = "sevenbar.export.mass"


def __dir__() -> list[str]:
    return sorted({*__all__, *_ON_DEMAND})


def _offered(module: ModuleType) -> list[str]:
    own = [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__
    ]
    return list(getattr(module, "__all__", own))


class _OnDemand:
    """`from sevenbar.plot import curves`: a module on demand by its public name is the module that has it."""

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> ModuleSpec | None:  # noqa: ARG002
        parent, _, name = fullname.rpartition(".")
        own = parent == __name__ and _ON_DEMAND.get(name, fullname) != fullname
        return ModuleSpec(fullname, self) if own else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = importlib.import_module(_ON_DEMAND[spec.name.rpartition(".")[2]])
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        # it has been, under the name that it keeps
        assert module.__spec__ is not None
        module.__spec__ = module.__spec__.loader_state


sys.meta_path.append(_OnDemand())


def __getattr__(name: str) -> Any:
    if name in _NAMES_ON_DEMAND:
        module = importlib.import_module(f"sevenbar.{_NAMES_ON_DEMAND[name]}")
        result = globals()[name] = getattr(module, name)
        return result
    if name == "errors":
        return importlib.import_module("sevenbar.errors")
    if name in _ON_DEMAND:
        module = importlib.import_module(_ON_DEMAND[name])
        # what it offers, without what it imports
        module.__dict__.setdefault("__dir__", lambda: sorted(_offered(module)))
        return module
    raise AttributeError(f"module 'sevenbar' has no attribute '{name}'")
