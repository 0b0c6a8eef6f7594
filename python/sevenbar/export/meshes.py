"""Watertight meshes of a linkage's parts, and GLB and STL made of them (trimesh, extra `[export]`)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from sevenbar.errors import of_extra
from sevenbar.export.libraries import installed
from sevenbar.export.parts import Assembly, Ball, Part, Rod, Solid, frame_of, length_of
from sevenbar.text.progress import Progress, silent
from sevenbar.text.units import LENGTHS

#: Flat faces round a rod, and rings of a ball: 0.2 % of the radius from round.
SECTIONS = 48

#: glTF has y up and lengths in metres; the report frame's z becomes its y.
TO_GLTF = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def write_glb(assembly: Assembly, path: Path, progress: Progress = silent) -> None:
    """Writes the assembly as a scene [m]: a node for each link, in place by its matrix, parts below it."""
    solids = list(_meshes(assembly, progress))
    library = _trimesh()
    scene = library.Scene(base_frame="world")
    scale = LENGTHS[assembly.pose.linkage.length_unit]
    metres = np.diag([scale, scale, scale, 1.0])
    back = np.diag([1 / scale, 1 / scale, 1 / scale, 1.0])
    scene.graph.update(frame_to="linkage", frame_from="world", matrix=TO_GLTF)
    for name, frame in zip(assembly.bodies, assembly.frames, strict=True):
        scene.graph.update(frame_to=name, frame_from="linkage", matrix=metres @ frame @ back)
    for part, solid in solids:
        solid.apply_transform(metres)
        solid.visual = library.visual.TextureVisuals(
            material=library.visual.material.PBRMaterial(
                name=part.colour,
                baseColorFactor=[*bytes.fromhex(part.colour.removeprefix("#")), 255],
                metallicFactor=0.35,
                roughnessFactor=0.45,
            )
        )
        scene.add_geometry(
            solid,
            geom_name=part.name,
            node_name=f"{part.name}_solid",
            parent_node_name=assembly.bodies[part.body],
        )
    path.write_bytes(scene.export(file_type="glb"))
    progress(len(solids), len(solids), "")


def write_stl(assembly: Assembly, path: Path, progress: Progress = silent) -> None:
    """Writes all parts in the pose into one binary STL, in the linkage's own length unit and report frame."""
    placed = []
    for part, solid in _meshes(assembly, progress):
        solid.apply_transform(assembly.frames[part.body])
        placed.append(solid)
    path.write_bytes(_trimesh().util.concatenate(placed).export(file_type="stl"))
    progress(len(placed), len(placed), "")


def write_stl_parts(assembly: Assembly, folder: Path, progress: Progress = silent) -> None:
    """Writes each part into a binary STL of its own, in its link's frame and the linkage's length unit."""
    for part, solid in _meshes(assembly, progress):
        (folder / f"{part.name}.stl").write_bytes(solid.export(file_type="stl"))


def _meshes(assembly: Assembly, progress: Progress) -> Iterator[tuple[Part, Any]]:
    """Each part and its mesh, one after the other; says which."""
    total = len(assembly.parts)
    if installed("trimesh", "manifold3d"):
        # their import takes its time
        progress(0, total, "trimesh")
    for done, part in enumerate(assembly.parts, 1):
        solid = mesh(part)
        progress(done, total, part.name)
        yield part, solid


def mesh(part: Part) -> Any:
    """The watertight mesh of a part, in its body's frame and the linkage's length unit."""
    library = _trimesh()
    solid = library.boolean.union([_primitive(s) for s in part.add], engine="manifold")
    if part.cut:
        solid = library.boolean.difference([solid, *map(_primitive, part.cut)], engine="manifold")
    return solid


def _primitive(solid: Solid) -> Any:
    creation = _trimesh().creation
    match solid:
        case Ball():
            ball = creation.uv_sphere(solid.radius, count=[SECTIONS // 2, SECTIONS])
            ball.apply_translation(solid.centre)
            return ball
        case Rod():
            return creation.cylinder(solid.radius, segment=[solid.start, solid.end], sections=SECTIONS)
    return creation.box((solid.width, solid.width, length_of(solid)), transform=frame_of(solid))


def _trimesh() -> Any:
    with of_extra("export", "meshes need trimesh and manifold3d"):
        import manifold3d  # noqa: F401  # what trimesh joins and cuts solids with
        import trimesh
    return trimesh
