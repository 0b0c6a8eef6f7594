"""The figures of a motion as files: those that somebody asks for, and those of its report."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sevenbar.kinematics.motion import Motion, chosen_circuit
from sevenbar.reporting.folder import fill_folder

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Points of links by name: the link, and the place on it.
Places = Mapping[str, tuple[int, tuple[float, float, float]]]

#: What can be drawn of a motion.
KINDS = ("curves", "joints", "modes", "configuration", "point")


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

    `kinds` of `KINDS`; `points` (link, at) by name, for the kind point. Raises `OutputError` where one of the
    files exists and `force` is not given.
    """
    return fill_folder(
        Path(folder), lambda staging: _draw(motion, staging, kinds, points, circuit, figures), force=force
    )


def draw_for_report(motion: Motion, folder: Path, formats: Sequence[str]) -> None:
    """Draws configuration and motion; but for an RSSR, whose curves show all, also joints and points."""
    if not motion.circuits:
        return
    general = motion.linkage.kind != "RSSR"
    posed = posed_circuit(motion)
    kinds = ["curves", *(["joints"] if general else [])]
    if posed is not None:
        # a law that rests leaves no path
        inputs = motion.circuits[posed].input
        moves = np.unique(inputs[np.isfinite(inputs)]).size > 1
        kinds += ["configuration", *(["point"] if general and moves else [])]
    points = {point.name: (point.link, point.at) for point in motion.linkage.points}
    _draw(motion, folder, kinds, points, posed or 0, formats)


def posed_circuit(motion: Motion) -> int | None:
    """The first circuit with a pose to draw; `None` where a law leaves the range of all."""
    posed = (circuit.index for circuit in motion if (circuit.status != "no-solution").any())
    return next(posed, None)


def _draw(
    motion: Motion, folder: Path, kinds: Sequence[str], points: Places, circuit: int, formats: Sequence[str]
) -> None:
    from sevenbar.drawing import plot

    def made() -> Iterator[tuple[str, Figure]]:
        if "curves" in kinds:
            yield "motion", plot.curves(motion)
        if "joints" in kinds:
            yield "joints", plot.joints(motion)
        if "configuration" in kinds:
            yield "configuration", plot.configuration(motion, circuit)
        if "point" in kinds:
            for name, point in points.items():
                yield f"path_{_file_name(name)}", plot.point_path(motion, point, circuit, name=name)
        if "modes" in kinds:
            chosen = chosen_circuit(motion, circuit)
            # a limit is no place to show modes at: there two are one
            ends = chosen.pass_range(0)
            value = float(chosen.input[0]) if ends is None else (ends[0] + ends[1]) / 2
            modes = motion.linkage.assembly_modes(value, input=motion.input, agree=motion.agree)
            yield (
                "modes",
                plot.modes_overview(motion.linkage, modes, input=motion.input, output=motion.output),
            )

    for name, figure in made():
        for ending in formats:
            plot.save(figure, folder / f"{name}.{ending}")


def _file_name(name: str) -> str:
    """The name of a point as a part of a file's name."""
    return re.sub(r"[^\w.-]+", "_", name).strip("_.") or "point"
