"""What acts on a prototype: masses, weight, loads, springs; in newtons, places in the frames of bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.acting import Load, Spring, Three
from sevenbar.forces.bodies import Body
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.dynamics.link_bodies import as_moved, resolved
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import placed
from sevenbar.text.units import LENGTHS

#: Added to the inertia of a body about every axis, as a part of that of its mass at a tenth of the linkage's
#: size: programs take no rod without inertia about its line.
LEAST_INERTIA = 1e-6

#: How far an engine's input may be from Sevenbar's [rad, or as a part of a slide]: rounding over many turns.
EDGE = 1e-9

#: A body of the prototype, or `GROUND`, and a place (3,) [length] in its frame.
Placed = tuple[int, Floats]


@dataclass(frozen=True, eq=False)
class PlacedMass:
    """A mass [kg], its centre (3,) [length] in the body's frame, inertia (3, 3) about it [kg m^2]."""

    mass: float
    centre: Floats
    inertia: Floats

    def never_thin(self, radius: float) -> Floats:
        """The inertia and a little more about every axis, by a radius of gyration [m]."""
        return self.inertia + LEAST_INERTIA * self.mass * radius**2 * np.eye(3)


def in_links(linkage: Loop, bodies: Mapping[int, Body]) -> dict[int, PlacedMass]:
    """Bodies with their centre and inertia, written as points are, in the frames of their links."""
    result = {}
    for link, body in bodies.items():
        assert body.centre is not None
        frame = linkage.point_frames[link - 1]
        turn = frame[:3, :3]
        result[link] = PlacedMass(body.mass, placed(frame, body.centre), turn @ body.tensor @ turn.T)
    return result


@dataclass(frozen=True, eq=False)
class PlacedLoad:
    """A force (3,) [N] and a torque (3,) [N m] at a place, in the frame of the body or of the report.

    `factor` says how much of them acts at a value of the input [rad, or length].
    """

    place: Placed
    force: Floats
    torque: Floats
    turns: bool
    factor: Callable[[float], float]


@dataclass(frozen=True, eq=False)
class PlacedSpring:
    """A spring between two places: stiffness [N/m], slack length [m], damping [N s/m]."""

    ends: tuple[Placed, Placed]
    stiffness: float
    length: float
    damping: float


@dataclass(frozen=True, eq=False)
class JointSpring:
    """A spring in one freedom of a connection; N m/rad, rad, N m s/rad, or N/m, m, N s/m."""

    connection: int
    freedom: int
    stiffness: float
    slack: float
    damping: float


@dataclass(frozen=True, eq=False)
class PlacedLoading:
    """All that acts; `masses` by the bodies' numbers, `gravity` (3,) [m/s^2]."""

    masses: dict[int, PlacedMass] = field(default_factory=dict)
    gravity: Floats = field(default_factory=lambda: np.zeros(3))
    loads: tuple[PlacedLoad, ...] = ()
    springs: tuple[PlacedSpring, ...] = ()
    joint_springs: tuple[JointSpring, ...] = ()


def acting(
    linkage: Solvable, links: dict[int, int], columns: dict[str, tuple[int, int]]
) -> PlacedLoading | None:
    """What acts on a linkage, for the bodies of its links and the connection and freedom of its columns.

    `None` where nothing has a mass and nothing acts. A link that spins idly is moved as balls without
    friction move it.
    """
    loading = linkage.loading
    if loading.is_empty:
        return None
    metre = LENGTHS[linkage.length_unit]
    turning = linkage.turns(linkage.drive.joint)

    def on_link(link: int, at: Three) -> Placed:
        return links[link], placed(linkage.point_frames[link - 1], at)

    def load(own: Load) -> PlacedLoad:
        assert own.at is not None
        turns = own.axes == "link"
        turn = linkage.point_frames[own.link - 1][:3, :3] if turns else np.eye(3)
        force, torque = (turn @ np.array(vector) for vector in (own.force, own.torque))
        return PlacedLoad(on_link(own.link, own.at), force, torque, turns, partial(factor, own))

    def factor(own: Load, value: float) -> float:
        # at both ends of its range a load acts, also where an engine's input is a rounding off
        near = EDGE * (1.0 if turning else abs(value)) if own.between else 0.0
        return float(own.factors([value, value - near, value + near], turns=turning).max())

    def spring(own: Spring) -> PlacedSpring:
        assert own.links is not None
        assert own.at is not None
        first, second = (on_link(link, at) for link, at in zip(own.links, own.at, strict=True))
        return PlacedSpring((first, second), own.stiffness / metre, own.length * metre, own.damping / metre)

    def in_joint(own: Spring) -> JointSpring:
        assert own.joint is not None
        unit = 1.0 if linkage.turns(own.joint) else metre
        return JointSpring(*columns[own.joint], own.stiffness / unit, own.length * unit, own.damping / unit)

    masses = in_links(linkage, as_moved(linkage, resolved(loading, linkage)))
    return PlacedLoading(
        {links[link]: own for link, own in masses.items()},
        np.array(loading.gravity),
        tuple(map(load, loading.loads)),
        tuple(spring(own) for own in loading.springs if own.links is not None),
        tuple(in_joint(own) for own in loading.springs if own.links is None),
    )
