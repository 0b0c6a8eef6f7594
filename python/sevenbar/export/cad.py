"""The parts of a linkage as exact solids, in a STEP assembly (build123d, extra `[cad]`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import OutputError, of_extra
from sevenbar.export.libraries import installed
from sevenbar.export.parts import Assembly, Ball, Bar, Part, Rod, Solid, foot_of, length_of
from sevenbar.kinematics.loop.rigid import perpendicular
from sevenbar.text.progress import Progress, silent
from sevenbar.text.units import LENGTHS


def write_step(assembly: Assembly, path: Path, progress: Progress = silent) -> None:
    """Writes an assembly of one component for each part, in place in the pose, in millimetres.

    Each component has its part's name and colour, and its own coordinates are those of its link's frame.
    """
    steps = len(assembly.parts) + 1
    if installed("build123d"):
        progress(0, steps, "build123d")
    library = _build123d()
    linkage = assembly.pose.linkage
    scale = LENGTHS[linkage.length_unit] / LENGTHS["mm"]
    components = []
    for done, part in enumerate(assembly.parts):
        progress(done, steps, part.name)
        shape = solid(part, scale)
        frame = assembly.frames[part.body]
        shape.label = part.name
        shape.color = library.Color(*(c / 255 for c in bytes.fromhex(part.colour[1:])))
        shape.location = library.Location(_plane(scale * frame[:3, 3], frame[:3, 0], frame[:3, 2]))
        components.append(shape)
    progress(steps - 1, steps, path.name)
    whole = library.Compound(label=linkage.name, children=components)
    if not library.export_step(whole, path):
        raise OutputError(f"{path}: the STEP writer of build123d failed; nothing was written")
    progress(steps, steps, "")


def solid(part: Part, scale: float) -> Any:
    """The exact solid of a part in its body's frame, lengths times `scale`."""
    first, *rest = [_primitive(s, scale, part) for s in part.add]
    whole = first.fuse(*rest) if rest else first
    if part.cut:
        whole = whole.cut(*[_primitive(s, scale, part) for s in part.cut])
    return whole.solids()[0] if len(whole.solids()) == 1 else whole


def _primitive(piece: Solid, scale: float, part: Part) -> Any:
    solid = _build123d().Solid
    if isinstance(piece, Ball):
        plane = _plane(scale * piece.centre, *_free_of_arms(piece, part))
        return solid.make_sphere(scale * piece.radius, plane)
    frame, length = foot_of(piece), scale * length_of(piece)
    plane = _plane(scale * frame[:3, 3], frame[:3, 0], frame[:3, 2])
    if isinstance(piece, Bar):
        return solid.make_box(scale * piece.width, scale * piece.width, length, plane)
    return solid.make_cylinder(scale * piece.radius, length, plane)


def _free_of_arms(ball: Ball, part: Part) -> tuple[Floats, Floats]:
    """Where a ball's seam and pole are free of the arms that leave it: cut by them, STEP readers go wrong."""
    arms = [
        (end - start) / np.linalg.norm(end - start)
        for rod in part.add
        if isinstance(rod, Rod)
        for start, end in ((rod.start, rod.end), (rod.end, rod.start))
        if np.linalg.norm(start - ball.centre) < 1e-9 * np.linalg.norm(end - start)
    ]
    if not arms:
        return np.eye(3)[0], np.eye(3)[2]
    seam = -np.sum(arms[:2], axis=0)
    if np.linalg.norm(seam) < 1e-3:
        seam = perpendicular(arms[0])
    pole = np.cross(arms[0], seam)
    if np.linalg.norm(pole) < 1e-3:
        pole = perpendicular(seam)
    return seam, pole


def _plane(origin: Floats, x: Floats, z: Floats) -> Any:
    return _build123d().Plane(origin=tuple(origin), x_dir=tuple(x), z_dir=tuple(z))


def _build123d() -> Any:
    with of_extra("cad", "step needs build123d"):
        import build123d
    return build123d
