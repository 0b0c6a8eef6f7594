"""The axes of a CAD model: of its cylinders, and the middles of its balls, from a STEP file (extra `cad`)."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import TableError, given_path, of_extra, read_start

#: Cylinders are on one axis where their directions agree to this [rad] and their lines to this [mm]: the
#: digits that CAD programs write.
SAME_DIRECTION, SAME_LINE = 1e-7, 1e-5

#: The least part of a turn [rad] that the faces of one radius cover: below it they are a fillet.
LEAST_TURN = math.pi - 1e-6

#: A component of a unit vector below this is rounding of zero.
ZERO = 1e-15


@dataclass(frozen=True, eq=False)
class PartAxis:
    """An axis of a model, with all coaxial cylinders; or the middle of a ball, which has no direction.

    `at` (3,) is the middle of the cylinders along the axis, `direction` (3,) a unit vector, `extent` the
    length that they cover; all in mm. `parts` are the parts that have such a face, `faces` the names of
    faces.
    """

    shape: Literal["cylinder", "ball"]
    at: Floats
    direction: Floats | None
    radii: tuple[float, ...]
    extent: float
    parts: tuple[str, ...]
    faces: tuple[str, ...]
    count: int


@dataclass(frozen=True, eq=False)
class _Face:
    """A cylinder or a ball: its place (3,), its direction, and how far it goes along it."""

    shape: Literal["cylinder", "ball"]
    at: Floats
    direction: Floats | None
    radius: float
    reach: tuple[float, float]
    turn: float
    part: str
    name: str


def axes_of_step(path: str | os.PathLike[str]) -> list[PartAxis]:
    """The axes of the cylinders and the middles of the balls of a STEP file [mm], those of most parts first.

    Coaxial cylinders are one axis, concentric balls one middle. Fillets, which cover less than half a turn,
    are left out. An axis that two parts share is that of a joint, as a rule. A direction points to where its
    first component that is not zero is positive.

    Raises `TableError` for a file that is no STEP file, `MissingExtraError` without build123d.
    """
    faces = list(_faces(given_path("path", path)))
    groups: list[list[_Face]] = []
    for face in sorted(faces, key=lambda face: face.reach[0] - face.reach[1]):
        group = next((group for group in groups if _together(group[0], face)), None)
        if group is None:
            groups.append([face])
        else:
            group.append(face)
    result = [_axis(group) for group in groups if _is_round(group)]
    return sorted(result, key=lambda axis: (-len(axis.parts), axis.shape, [round(x, 6) for x in axis.at]))


def _is_round(group: Sequence[_Face]) -> bool:
    """Whether the faces of one radius and part cover half a turn or more."""
    turns: dict[tuple[str, float], float] = {}
    for face in group:
        key = (face.part, round(face.radius, 6))
        turns[key] = turns.get(key, 0.0) + face.turn
    return max(turns.values()) >= LEAST_TURN


def _together(one: _Face, other: _Face) -> bool:
    """Whether two faces have one axis, or one middle."""
    apart = other.at - one.at
    if one.direction is None or other.direction is None:
        return one.shape == other.shape and bool(np.linalg.norm(apart) < SAME_LINE)
    along = one.direction
    parallel = np.linalg.norm(np.cross(along, other.direction)) < SAME_DIRECTION
    return bool(parallel and np.linalg.norm(apart - (apart @ along) * along) < SAME_LINE)


def _axis(group: Sequence[_Face]) -> PartAxis:
    first = group[0]
    at, direction, extent = first.at, first.direction, 2 * first.radius
    if direction is not None:
        direction = np.where(np.abs(direction) < ZERO, 0.0, direction)
        leading = next(value for value in direction if value)
        direction = direction * np.sign(leading) + 0.0
        ends = []
        for face in group:
            way = 0.0 if face.direction is None else float(face.direction @ direction)
            ends += [float((face.at - at) @ direction) + way * end for end in face.reach]
        at = at + (min(ends) + max(ends)) / 2 * direction
        extent = max(ends) - min(ends)
    return PartAxis(
        first.shape,
        at + 0.0,
        direction,
        tuple(sorted({float(f"{face.radius:.9g}") for face in group})),
        float(extent),
        tuple(dict.fromkeys(face.part for face in group if face.part)),
        tuple(dict.fromkeys(face.name for face in group if face.name)),
        len(group),
    )


def _faces(path: Path) -> Iterator[_Face]:
    """Every cylinder and ball of a file, in the coordinates of the whole."""
    _refuse_other_files(path)
    with of_extra("cad", f"{path}: reading STEP needs build123d"):
        from OCP.BRepAdaptor import BRepAdaptor_Surface
        from OCP.GeomAbs import GeomAbs_SurfaceType
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.TopExp import TopExp_Explorer
        from OCP.TopoDS import TopoDS
    # versions of OCP call it differently
    as_face = TopoDS.Face_s if hasattr(TopoDS, "Face_s") else TopoDS.Face
    for shape, place, part, name_of in _parts(path):
        explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
        while explorer.More():
            face = explorer.Current()
            explorer.Next()
            surface = BRepAdaptor_Surface(as_face(face.Moved(place)))
            turn = abs(surface.LastUParameter() - surface.FirstUParameter())
            name = name_of(face)
            if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Cylinder:
                axis = surface.Cylinder().Axis()
                at, along = (_three(v) for v in (axis.Location(), axis.Direction()))
                reach = tuple(sorted((surface.FirstVParameter(), surface.LastVParameter())))
                radius = surface.Cylinder().Radius()
                yield _Face("cylinder", at, along / np.linalg.norm(along), radius, reach, turn, part, name)
            elif surface.GetType() == GeomAbs_SurfaceType.GeomAbs_Sphere:
                ball = surface.Sphere()
                yield _Face(
                    "ball", _three(ball.Location()), None, ball.Radius(), (0.0, 0.0), turn, part, name
                )


def _three(vector: Any) -> Floats:
    return np.array([vector.X(), vector.Y(), vector.Z()])


def _parts(path: Path) -> Iterator[tuple[Any, Any, str, Any]]:
    """Each part of a STEP file: its shape, where it is in the whole, its name, and what names its faces."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    read = reader.ReadFile(os.fsdecode(path)) == IFSelect_ReturnStatus.IFSelect_RetDone
    if not read or not reader.Transfer(document):
        raise TableError(f"{path}: is damaged, or no model: no part could be read; export it again as STEP")
    transferred = reader.ChangeReader().WS().TransferReader()
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())

    def labelled(label: Any) -> str:
        name = TDataStd_Name()
        result = label.FindAttribute(TDataStd_Name.GetID_s(), name)
        return str(name.Get().ToExtString()) if result else ""

    def face_name(face: Any) -> str:
        entity = transferred.EntityFromShapeResult(face, 1)
        name = entity.Name() if entity is not None and hasattr(entity, "Name") else None
        return str(name.ToCString()).strip() if name is not None else ""

    def walk(label: Any, place: Any, name: str) -> Iterator[tuple[Any, Any, str, Any]]:
        if XCAFDoc_ShapeTool.IsReference_s(label):
            referred = TDF_Label()
            XCAFDoc_ShapeTool.GetReferredShape_s(label, referred)
            inner = place.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(label))
            yield from walk(referred, inner, labelled(label) or name)
        elif XCAFDoc_ShapeTool.IsAssembly_s(label):
            below = _sequence()
            XCAFDoc_ShapeTool.GetComponents_s(label, below)
            for k in range(below.Length()):
                yield from walk(below.Value(k + 1), place, labelled(label))
        else:
            yield XCAFDoc_ShapeTool.GetShape_s(label), place, name or labelled(label), face_name

    labels = _sequence()
    tool.GetFreeShapes(labels)
    for k in range(labels.Length()):
        yield from walk(labels.Value(k + 1), TopLoc_Location(), "")


def _sequence() -> Any:
    """A list of labels, which versions of OCP keep in two places."""
    try:
        from OCP.collections import Sequence_TDF_Label as Labels
    except ImportError:
        from OCP.TDF import TDF_LabelSequence as Labels
    return Labels()


def _refuse_other_files(path: Path) -> None:
    head = read_start(path, 1000, "a STEP file", lambda message: TableError(f"{path}: {message}"))
    if b"ISO-10303-21" not in head:
        raise TableError(f"{path}: is no STEP file; export the model as STEP (.step, .stp)")
