"""From the checked tables of a file to what acts on its linkage, in kg and N; what is wrong between keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, cast

from sevenbar.description.load_schema import BodyForm, LoadForm, SpringForm
from sevenbar.description.values import flaws_of_value, valid_tables
from sevenbar.description.written import Written, named_column, unknown_link
from sevenbar.errors import Problem
from sevenbar.forces.acting import Load, Spring
from sevenbar.forces.bodies import SHAPES, Body, Solid, tensor_of
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.dynamics.link_bodies import flaw_in_plane
from sevenbar.kinematics.loop.graph import loop_graph
from sevenbar.text.units import LENGTHS, MASSES


def body_of(body: BodyForm, mass_unit: str, length_unit: str) -> Body:
    """A body in kg and kg m^2; raises `RequestError` for keys that do not go together."""
    kilogram, metre = MASSES[mass_unit], LENGTHS[length_unit]
    own = body.inertia
    entries = tensor_of(own) if isinstance(own, tuple) else own
    inertia = None if entries is None else entries * (kilogram * metre**2)
    mass = 0.0 if body.mass is None else body.mass * kilogram
    return Body(
        mass, body.centre, inertia, cast("Solid | None", body.solid), density=body.density,
        diameter=body.diameter, bore=body.bore, ends=body.ends,
        size=body.size, along=body.along, side=body.side,
    )  # fmt: skip


def planar_flaws(bodies: Sequence[BodyForm], linkage: Solvable, mass_unit: str) -> list[Problem]:
    """What is wrong with inertias about one axis alone, which say enough of a planar linkage only."""
    result = []
    for i, form in enumerate(bodies, 1):
        if flaw := flaw_in_plane(body_of(form, mass_unit, linkage.length_unit), form.link, linkage):
            result.append(Problem(f"body[{i}].inertia", flaw))
    return result


def load_of(load: LoadForm) -> Load:
    """A load; raises `RequestError` for keys that do not go together."""
    table = None
    if load.table is not None:
        table = (tuple(at for at, _ in load.table), tuple(factor for _, factor in load.table))
    return Load(
        load.link,
        load.force,
        load.torque,
        load.at,
        cast('Literal["ground", "link"]', load.axes),
        load.between,
        table,
        load.name or "",
    )


def spring_of(spring: SpringForm, columns: Mapping[str, str]) -> Spring:
    """A spring; `columns` are those that the names of joints mean. Raises `RequestError` likewise."""
    own: Any = spring.length if spring.joint is None else spring.free
    joint = None if spring.joint is None else columns.get(spring.joint, spring.joint)
    return Spring(
        spring.stiffness, own or 0.0, spring.damping, spring.links, spring.at, joint, spring.name or ""
    )


def load_contradictions(
    raw: Mapping[str, Any], joints: Sequence[Written], context: Mapping[str, Any]
) -> list[Problem]:
    """What is wrong with tables whose values are each right; wrong values are reported elsewhere."""
    problems: list[Problem] = []
    turns = not context["slides"]
    units = str(context["mass_unit"]), str(context["length_unit"])
    for place, body in valid_tables(raw, "body", BodyForm, context):
        problems += _on_ground(place, body.link, joints, "a body there moves nothing, leave it out")
        if body.mass is None and body.solid != "drawn" and body.density is None:
            problems.append(
                Problem(
                    f"{place}.mass",
                    "is missing; give one, or a density, as in density = 'steel'"
                    if body.solid in SHAPES
                    else "is missing; give one, or solid = 'drawn' for the drawn solids in steel",
                )
            )
        else:
            problems += flaws_of_value(place, lambda body=body: body_of(body, *units))
    for place, load in valid_tables(raw, "load", LoadForm, context):
        problems += _on_ground(place, load.link, joints, "a load on it moves nothing, leave it out")
        problems += flaws_of_value(place, lambda load=load: load_of(load).check_input(turns=turns))
    for place, spring in valid_tables(raw, "spring", SpringForm, context):
        problems += _of_spring(place, spring, joints)
    return problems


def _on_ground(place: str, link: int, joints: Sequence[Written], why: str) -> list[Problem]:
    if joints and link == loop_graph(joints).ground:
        message = f"link {link} is the ground; {why}, or give 1 to {link - 1}"
        return [Problem(f"{place}.link", message)]
    return unknown_link(f"{place}.link", link, joints)


def _of_spring(place: str, spring: SpringForm, joints: Sequence[Written]) -> list[Problem]:
    if spring.joint is not None:
        kind, others = "in a joint", {"links": spring.links, "at": spring.at, "length": spring.length}
        remedy = {"length": "give its value there as free"}
    else:
        kind, others = "between links", {"free": spring.free}
        remedy = {"free": "give its length there as length"}
    problems = [
        Problem(f"{place}.{key}", f"does not belong to a spring {kind}; {remedy.get(key, 'leave it out')}")
        for key, value in others.items()
        if value is not None
    ]
    if spring.joint is not None and joints:
        _, wrong = named_column(spring.joint, joints)
        problems += [Problem(f"{place}.joint", wrong)] if wrong else []
    for i, link in enumerate(spring.links or (), 1):
        problems += unknown_link(f"{place}.links[{i}]", link, joints)
    return problems or flaws_of_value(place, lambda: spring_of(spring, {}))
