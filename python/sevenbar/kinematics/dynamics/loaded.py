"""A linkage with other bodies, loads and springs, which its description keeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy.typing as npt

from sevenbar.arrays import triple
from sevenbar.forces.acting import Load, Spring
from sevenbar.forces.bodies import SHAPES, Body, entries_of
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.dynamics.link_bodies import refuse_no_link
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.listed import listed
from sevenbar.text.units import ANGLES, LENGTHS, MASSES

L = TypeVar("L", bound=Loop)


def loaded(linkage: L, **acting: Any) -> L:
    """The linkage with what acts, as `loading_with` takes it, in the place of its own."""
    given = loading_with(linkage, **acting)
    given.check_input(turns=linkage.turns(linkage.drive.joint))
    tables: dict[str, Any] = {}
    if linkage.description:
        forces = dict(linkage.description.get("forces", {}))
        unit = str(forces.get("mass_unit", "kg"))
        if acting["gravity"] is not None:
            tables["forces"] = forces | {"gravity": list(given.gravity)}
        if acting["bodies"] is not None:
            tables["body"] = [
                _body(link, body, unit, linkage) for link, own in given.bodies.items() for body in own
            ]
        if acting["loads"] is not None:
            tables["load"] = [_load(load, linkage) for load in given.loads]
        if acting["springs"] is not None:
            tables["spring"] = [_spring(spring, linkage) for spring in given.springs]
    selected = {key: value for key, value in (dict(linkage.description) | tables).items() if value != []}
    return replace(linkage, loading=given, description=selected)


def loading_with(
    linkage: Loop,
    *,
    bodies: Mapping[int, Body | Sequence[Body]] | None = None,
    gravity: npt.ArrayLike | None = None,
    loads: Sequence[Load] | None = None,
    springs: Sequence[Spring] | None = None,
) -> Loading:
    """What acts on a linkage, its own where nothing else is given.

    Raises `RequestError` for a link or a joint that does not exist.
    """
    own = linkage.loading
    # with the links that there are, which what acts alone does not know
    for link in bodies if isinstance(bodies, Mapping) else ():
        refuse_no_link("bodies", link, linkage)
    given = Loading(
        own.gravity if gravity is None else triple("gravity", gravity),
        own.bodies if bodies is None else bodies,  # type: ignore[arg-type]
        own.loads if loads is None else loads,  # type: ignore[arg-type]
        own.springs if springs is None else springs,  # type: ignore[arg-type]
    )
    for i, load in enumerate(given.loads):
        refuse_no_link(f"loads[{i}]", load.link, linkage)
    result = []
    for i, spring in enumerate(given.springs):
        for link in spring.links or ():
            refuse_no_link(f"springs[{i}]", link, linkage, or_ground=True)
        if spring.joint is not None:
            column = linkage.column(spring.joint, f"springs[{i}].joint")
            spring = replace(spring, joint=linkage.columns[column])
        result.append(spring)
    return replace(given, springs=tuple(result))


def _body(link: int, body: Body, mass_unit: str, linkage: Loop) -> dict[str, Any]:
    """A body as a table of a file has it."""
    kilogram, metre = MASSES[mass_unit], LENGTHS[linkage.length_unit]
    table: dict[str, Any] = {"link": int(link)}
    if body.mass:
        table["mass"] = body.mass / kilogram
    if body.solid is not None:
        table["solid"] = body.solid
    for key in SHAPES.get(body.solid or "", ()):
        value = getattr(body, key)
        if value is not None:
            table[key] = [list(end) for end in value] if key == "ends" else listed(value)
    if body.centre is not None:
        table["centre"] = list(body.centre)
    if body.tensor.any():
        unit = kilogram * metre**2
        across = body.alone is not None and body.alone[1] is None
        table["inertia"] = body.alone[0] / unit if body.alone and across else entries_of(body.tensor / unit)
    return table


def _load(load: Load, linkage: Loop) -> dict[str, Any]:
    size = _size(linkage, linkage.drive.joint)
    table: dict[str, Any] = {"link": int(load.link)}
    if any(load.force):
        table |= {"at": list(load.at or ()), "force": list(load.force)}
    if any(load.torque):
        table["torque"] = list(load.torque)
    if load.axes != "ground":
        table["axes"] = load.axes
    if load.between is not None:
        table["between"] = [value / size for value in load.between]
    if load.table is not None:
        table["table"] = [[at / size, factor] for at, factor in zip(*load.table, strict=True)]
    return table | ({"name": load.name} if load.name else {})


def _spring(spring: Spring, linkage: Loop) -> dict[str, Any]:
    table: dict[str, Any] = {}
    if spring.joint is not None:
        table |= {"joint": spring.joint, "free": spring.length / _size(linkage, spring.joint)}
    elif spring.links is not None and spring.at is not None:
        ends = [list(end) for end in spring.at]
        table |= {"links": [int(link) for link in spring.links], "at": ends, "length": spring.length}
    table |= {key: value for key in ("stiffness", "damping") if (value := getattr(spring, key))}
    return table | ({"name": spring.name} if spring.name else {})


def _size(linkage: Loop, column: str) -> float:
    """The size [rad, or length] of the unit in which the description has values of a column."""
    return ANGLES[str(linkage.description.get("angle_unit", "deg"))] if linkage.turns(column) else 1.0
