"""A figure of a path design: wanted points and the path in space and from three sides, and the errors."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from sevenbar.arrays import Floats
from sevenbar.design.candidates import CHECK_SAMPLES
from sevenbar.design.synthesis.path.task import PathTask
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.check import TaskDesign
from sevenbar.design.task.path_page import PathPage, path_page
from sevenbar.design.task.placing import STILL
from sevenbar.design.task.wanted import PlacesCurve
from sevenbar.drawing.names import short
from sevenbar.text.words import say


def drawn(task: PathTask, design: TaskDesign) -> tuple[Floats, Floats]:
    """All the path of a design's circuit (m, 3), and the part along the wanted points (k, 3).

    Both as placed, in the coordinates of the wanted points.
    """
    candidate = design.candidate
    # a drawing is written where the path is wanted
    placing = STILL if candidate.draft.linkage.form == "drawn" else design.placing
    circuit = candidate.draft.linkage.motion(CHECK_SAMPLES).circuits[candidate.circuit]
    whole = placing.put(circuit.point(task.point.name).position)
    if circuit.closed:
        whole = np.concatenate([whole, whole[:1]])
    return whole, whole if task.want.closed else _used(task, design)


def _used(task: PathTask, design: TaskDesign) -> Floats:
    curve = DesignAlong(task.design, design).curve(0)
    assert isinstance(curve, PlacesCurve)
    return curve.path


def path_figure(task: PathTask, design: TaskDesign) -> Figure:
    """Wanted points and path in space (a) and from three sides (b to d), the error at each point (e)."""
    whole, used = drawn(task, design)
    candidate = design.candidate
    near = _near(whole, np.concatenate([task.want.places, used]))
    title = say(
        "{linkage}: {motion_type}, circuit {number}",
        linkage=short(candidate.name, 70),
        motion_type=say(candidate.motion_type),
        number=candidate.circuit,
    )
    page = PathPage(task.want.places, used, candidate.claim.errors, title, whole=near)
    return path_page(task.draft.linkage, page)


def _near(whole: Floats, seen: Floats) -> Floats:
    """A circuit's rows without those far beyond what is checked, which would make the rest small."""
    middle, half = (seen.max(axis=0) + seen.min(axis=0)) / 2, float(np.ptp(seen, axis=0).max())
    rows = whole.copy()
    rows[(np.abs(whole - middle) > half).any(axis=1)] = np.nan
    return rows
