"""The figures of a motion as files: those that somebody asks for, and those of its report."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.reporting.files import Files, Report, Write, figure_files

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Points of links by name: the link, and the place on it.
Places = Mapping[str, tuple[int, tuple[float, float, float]]]

#: What can be drawn of a motion.
KINDS = (
    "curves",
    "joints",
    "modes",
    "configuration",
    "point",
    "transmission",
    "coupler",
    "axodes",
    "skeleton",
)
#: Those that are drawn where none is named: not a point's path alone, nor axodes, nor the linkage alone.
USUAL_KINDS = KINDS[:-3]


@dataclass(frozen=True)
class FigureLook:
    """How figures are drawn: the view of pictures, the size of the page [inch], the style, the title.

    `parts` are what a point's figure shows; `None` for the usual ones.
    """

    view: str | tuple[float, float] | None = None
    size: tuple[float, float] | None = None
    style: str | None = None
    title: bool = True
    parts: tuple[str, ...] | None = None

    @property
    def of_curves(self) -> dict[str, Any]:
        """The arguments of a figure without a picture of the linkage."""
        return {"figsize": self.size, "style": self.style}

    @property
    def of_pictures(self) -> dict[str, Any]:
        """The arguments of a figure with one."""
        return {"view": self.view, **self.of_curves}


def write_figures(
    motion: Motion,
    folder: str | os.PathLike[str],
    kinds: Sequence[str],
    points: Places,
    *,
    circuit: int = 0,
    figures: Sequence[str] = ("png",),
    look: FigureLook | None = None,
    force: bool = False,
) -> list[Path]:
    """Writes figures of these kinds into a folder, all or none; returns their paths.

    `kinds` of `KINDS`; `points` (link, at) by name, for the kind point. Raises `OutputError` where one of the
    files exists and `force` is not given.
    """
    return figures_report(kinds, points, circuit, figures, look).write(motion, folder, force=force)


def figures_report(
    kinds: Sequence[str],
    points: Places,
    circuit: int,
    formats: Sequence[str],
    look: FigureLook | None = None,
) -> Report[Motion]:
    """Figures alone, for who writes them: as `write_figures`."""
    return Report(
        lambda motion: "",  # noqa: ARG005
        lambda motion: {},  # noqa: ARG005
        figures=lambda motion: _files(motion, kinds, points, circuit, formats, look or FigureLook()),
    )


def report_figures(
    motion: Motion,
    formats: Sequence[str],
    *,
    circuit: int | None = None,
    look: FigureLook | None = None,
) -> Files[Motion]:
    """Configuration and motion; also joints and points, save of an RSSR, whose curves show all.

    Linkage and points are drawn on `circuit`, the first with a pose by default.
    """
    if not motion.circuits:
        return {}
    general = motion.linkage.kind != "RSSR"
    posed = posed_circuit(motion) if circuit is None else circuit
    kinds = ["curves", *(["joints"] if general else [])]
    if posed is not None:
        # a law that rests leaves no path
        inputs = motion.circuits[posed].input
        moves = np.unique(inputs[np.isfinite(inputs)]).size > 1
        kinds += ["configuration", *(["point"] if general and moves else [])]
    points = {point.name: (point.link, point.at) for point in motion.linkage.points}
    return _files(motion, kinds, points, posed or 0, formats, look or FigureLook())


def posed_circuit(motion: Motion) -> int | None:
    """The first circuit with a pose to draw; `None` where a law leaves the range of all."""
    posed = (circuit.index for circuit in motion if set(circuit.tally.statuses) - {"no-solution"})
    return next(posed, None)


def _files(
    motion: Motion,
    kinds: Sequence[str],
    points: Places,
    circuit: int,
    formats: Sequence[str],
    look: FigureLook,
) -> Files[Motion]:
    """What draws and writes each figure, by the file's name."""
    from sevenbar.drawing import plot

    curves, pictures = ({**given, "title": look.title} for given in (look.of_curves, look.of_pictures))
    known: tuple[tuple[str, str, Callable[[], Figure]], ...] = (
        ("curves", "motion", partial(plot.curves, motion, **curves)),
        ("joints", "joints", partial(plot.joints, motion, **curves)),
        ("transmission", "transmission", partial(plot.transmission, motion, **curves)),
        ("axodes", "axodes", partial(plot.axodes, motion, circuit=circuit, **pictures)),
        ("skeleton", "skeleton", partial(plot.skeleton, motion, circuit, **look.of_pictures)),
        ("configuration", "configuration", partial(plot.configuration, motion, circuit, **pictures)),
    )
    draw = {name: one for kind, name, one in known if kind in kinds}
    wanted: dict[str, Any] = {} if look.parts is None else {"parts": look.parts}
    shown = {"point": ("path", wanted), "coupler": ("coupler", {"parts": ("path",)})}
    for kind, (prefix, parts) in shown.items():
        for name, point in points.items() if kind in kinds else ():
            own = re.sub(r"[^\w.-]+", "_", name).strip("_.") or "point"
            draw[f"{prefix}_{own}"] = partial(
                plot.point_path, motion, point, circuit, name=name, **parts, **pictures
            )
    if "modes" in kinds:
        chosen = chosen_circuit(motion, circuit)
        # a limit is no place to show modes at: there two are one
        ends = chosen.pass_range(0)
        value = float(chosen.input[0]) if ends is None else (ends[0] + ends[1]) / 2
        modes = motion.linkage.assembly_modes(value, input=motion.input, agree=motion.agree)
        held: dict[str, Any] = {"input": motion.input, "output": motion.output, **pictures}
        draw["modes"] = partial(plot.modes_overview, motion.linkage, modes, **held)
    files: dict[str, Write[Motion]] = {}
    for name, one in draw.items():
        files |= figure_files(name, formats, partial(_drawn, one))
    return files


def _drawn(draw: Callable[[], Figure], _motion: Motion) -> Figure:
    return draw()
