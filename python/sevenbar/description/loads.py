"""From the checked tables of a file to what acts on its linkage, in kilograms and newtons."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, cast

from sevenbar.forces.acting import Load, Spring
from sevenbar.forces.bodies import Body, Solid, tensor_of
from sevenbar.text.units import LENGTHS, MASSES

if TYPE_CHECKING:
    from sevenbar.description.load_schema import BodyForm, LoadForm, SpringForm


def body_of(body: BodyForm, mass_unit: str, length_unit: str) -> Body:
    """A body in kg and kg m^2; raises `RequestError` for keys that do not go together."""
    kilogram, metre = MASSES[mass_unit], LENGTHS[length_unit]
    inertia = None if body.inertia is None else tensor_of(body.inertia) * (kilogram * metre**2)
    mass = 0.0 if body.mass is None else body.mass * kilogram
    return Body(mass, body.centre, inertia, cast("Solid | None", body.solid))


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
