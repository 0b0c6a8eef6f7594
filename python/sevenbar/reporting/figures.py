"""The figures of a motion as files: those that somebody asks for, or those of its report."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.motion import Motion, chosen_circuit
from sevenbar.reporting.files import Files, figure_files, write_files

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Points of links by name: the link, and the place on it.
Places = Mapping[str, tuple[int, tuple[float, float, float]]]

#: What can be drawn of a motion.
KINDS = ("curves", "joints", "modes", "configuration", "point")


class _Draw(Protocol):
    """Draws a motion, and one of its circuits where the figure shows one."""

    def __call__(self, motion: Motion, circuit: int) -> Figure: ...


def write_figures(
    motion: Motion,
    folder: str | os.PathLike[str],
    kinds: Sequence[str],
    points: Places,
    *,
    circuit: int = 0,
    figures: Sequence[str] = ("png",),
    force: bool = False,
) -> list[Path]:
    """Writes figures of these kinds into a folder, all or none; returns their paths.

    `kinds` of `KINDS`; `points` (link, at) by name, for the kind point. Raises `RequestError` for another
    kind, `OutputError` where one of the files exists and `force` is not given.
    """
    files: dict[str, Callable[[Motion, Path], object]] = {}
    for _, stem, draw in _drawings(kinds, points):
        files |= figure_files(stem, figures, partial(draw, circuit=circuit))
    return write_files(motion, files, folder, force=force)


def report_figures(linkage: Loop, formats: Sequence[str]) -> Files[Motion]:
    """The figures of a motion's report, with the first circuit that has a pose.

    They are configuration and motion; but for an RSSR, whose curves show all, also joints, and path_<name>
    for each named point.
    """
    kinds = ["curves", "configuration", *(["joints", "point"] if linkage.kind != "RSSR" else [])]
    points = {point.name: (point.link, point.at) for point in linkage.points}
    files: dict[str, Callable[[Motion, Path], object]] = {}
    for kind, stem, draw in _drawings(kinds, points):

        def drawn(motion: Motion, kind: str = kind, draw: _Draw = draw) -> Figure | None:
            posed = posed_circuit(motion)
            if not motion.circuits or (posed is None and kind in ("configuration", "point")):
                return None
            # a law that rests leaves no path
            if kind == "point" and not _moves(motion, posed or 0):
                return None
            return draw(motion, posed or 0)

        files |= figure_files(stem, formats, drawn)
    return files


def posed_circuit(motion: Motion) -> int | None:
    """The first circuit with a pose to draw; `None` where a law leaves the range of all."""
    posed = (circuit.index for circuit in motion if (circuit.status != "no-solution").any())
    return next(posed, None)


def _moves(motion: Motion, circuit: int) -> bool:
    inputs = motion.circuits[circuit].input
    return np.unique(inputs[np.isfinite(inputs)]).size > 1


def _drawings(kinds: Sequence[str], points: Places) -> Iterator[tuple[str, str, _Draw]]:
    """The figures of these kinds: the kind, the file's name without an ending, and what draws it."""
    for kind in kinds:
        if kind not in KINDS:
            raise RequestError(f"kinds: {shown(kind)} is not a figure; allowed: {', '.join(KINDS)}")
        if kind == "point":
            for name, point in points.items():
                yield kind, f"path_{_file_name(name)}", partial(_path, name=name, point=point)
        else:
            yield kind, "motion" if kind == "curves" else kind, partial(_drawn, kind=kind)


def _drawn(motion: Motion, circuit: int, kind: str) -> Figure:
    from sevenbar.drawing import plot

    if kind == "curves":
        return plot.curves(motion)
    if kind == "joints":
        return plot.joints(motion)
    if kind == "configuration":
        return plot.configuration(motion, circuit)
    chosen = chosen_circuit(motion, circuit)
    # a limit is no place to show modes at: there two are one
    ends = chosen.pass_range(0)
    value = float(chosen.input[0]) if ends is None else (ends[0] + ends[1]) / 2
    modes = motion.linkage.assembly_modes(value, input=motion.input)
    return plot.modes_overview(motion.linkage, modes, input=motion.input, output=motion.output)


def _path(motion: Motion, circuit: int, name: str, point: tuple[int, tuple[float, float, float]]) -> Figure:
    from sevenbar.drawing import plot

    return plot.point_path(motion, point, circuit, name=name)


def _file_name(name: str) -> str:
    """The name of a point as a part of a file's name."""
    return re.sub(r"[^\w.-]+", "_", name).strip("_.") or "point"
