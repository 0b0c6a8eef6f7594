"""Figures of a motion: the linkage in space or in its plane, its curves, joints, paths, modes, forces.

The public place of all figures: each makes a figure of its own, or draws in axes that are given as `ax`, so
that a figure of several panels can be composed. `save` writes one by the ending of its name.

    import matplotlib.pyplot as plt
    import sevenbar as sb

    motion = sb.load("planar_4r").motion()
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.7, 2.6), layout="constrained")
    sb.plot.configuration(motion, ax=left)
    sb.plot.curves(motion, "input", quantities=["angle"], ax=right)
    sb.plot.save(figure, "panels.pdf")
"""

from __future__ import annotations

from sevenbar.drawing.configuration import configuration, modes_overview
from sevenbar.drawing.figure import FORMATS, save
from sevenbar.drawing.force_figures import bearings, energies, reactions, shaking, torque
from sevenbar.drawing.joint_curves import joints
from sevenbar.drawing.measure_figures import axodes, transmission
from sevenbar.drawing.output_curves import curves
from sevenbar.drawing.paths import point_path
from sevenbar.drawing.skeleton_figure import skeleton
from sevenbar.drawing.style import STYLES
from sevenbar.drawing.view import NAMED as VIEWS

__all__ = [
    "FORMATS",
    "STYLES",
    "VIEWS",
    "axodes",
    "bearings",
    "configuration",
    "curves",
    "energies",
    "joints",
    "modes_overview",
    "point_path",
    "reactions",
    "save",
    "shaking",
    "skeleton",
    "torque",
    "transmission",
]


def __dir__() -> list[str]:
    return sorted(__all__)
