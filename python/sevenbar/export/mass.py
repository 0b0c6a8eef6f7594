"""Mass and inertia of bodies: the linkage's own, or from the rods, bars and balls they are drawn with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.acting import in_links
from sevenbar.export.layout import arrange
from sevenbar.export.parts import Assembly, Ball, Rod, Solid
from sevenbar.export.pose import take
from sevenbar.export.prototype import GYRATION
from sevenbar.forces.bodies import inertia_at
from sevenbar.forces.solids import DENSITIES, ball, cylinder, square_bar
from sevenbar.kinematics.dynamics.link_bodies import resolved
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.units import LENGTHS

#: The mass of a body that has none where others do, as a part of the heaviest one's: programs take none
#: without.
MASSLESS = 1e-6


@dataclass(frozen=True, eq=False)
class BodyMass:
    """Mass [kg]; its centre (3,) in the body's frame; inertia (3, 3) about the centre [kg length^2]."""

    mass: float
    centre: Floats
    inertia: Floats


def masses(assembly: Assembly) -> list[BodyMass]:
    """The mass of each body: the linkage's own where it has any, else that of the drawn bodies in steel.

    Of a linkage that has some, bodies without, crosses too, have a very small one.
    """
    linkage, size = assembly.pose.linkage, assembly.pose.circuit.size
    if not has_masses(linkage):
        return drawn_masses(assembly)
    metre = LENGTHS[linkage.length_unit]
    radius = GYRATION * size
    own = in_links(linkage, resolved(linkage.loading, linkage, circuit=assembly.pose.circuit.index))
    light = MASSLESS * max(one.mass for one in own.values())
    result = [BodyMass(light, np.zeros(3), light * radius**2 * np.eye(3)) for _ in assembly.frames]
    for link, one in own.items():
        result[link - 1] = BodyMass(one.mass, one.centre, one.never_thin(metre * radius) / metre**2)
    return result


def has_masses(linkage: Loop) -> bool:
    """Whether a linkage has bodies of its own."""
    return any(linkage.loading.bodies.values())


def drawn_masses(assembly: Assembly) -> list[BodyMass]:
    """The mass of each body, as if its solids of steel did not overlap and had no holes."""
    scale = LENGTHS[assembly.pose.linkage.length_unit]
    density = DENSITIES["steel"] * scale**3
    return [
        _sum([s for part in assembly.parts if part.body == body for s in part.add], density)
        for body in range(len(assembly.frames))
    ]


def drawn_bodies(linkage: Linkage, circuit: int) -> list[tuple[float, Floats, Floats]]:
    """Of each moving link the mass [kg] in steel, its centre (3,) in the link's frame, the inertia (3, 3).

    Inertia about the centre, kg times the square of the length unit. The layout is that of an export of this
    circuit.
    """
    assembly = arrange(take(linkage.motion(), circuit))
    every = drawn_masses(assembly)[: len(linkage.graph.moving)]
    return [(one.mass, one.centre, one.inertia) for one in every]


def _sum(solids: Sequence[Solid], density: float) -> BodyMass:
    single = [_of(solid, density) for solid in solids]
    mass = sum(one.mass for one in single)
    centre: Floats = np.sum([one.mass * one.centre for one in single], axis=0) / mass
    inertia = np.zeros((3, 3))
    for one in single:
        inertia += one.inertia + inertia_at(one.mass, one.centre - centre)
    return BodyMass(float(mass), centre, inertia)


def _of(solid: Solid, density: float) -> BodyMass:
    if isinstance(solid, Ball):
        own = ball(solid.centre, solid.radius)
    elif isinstance(solid, Rod):
        own = cylinder(solid.start, solid.end, 2 * solid.radius)
    else:
        own = square_bar(solid.start, solid.end, solid.width)
    mass = density * own.volume
    return BodyMass(mass, own.centre, mass * own.inertia)
