"""Masses at points of links: the inertia forces over the cycle, and the torque that the input needs for them.

These are the forces of bodies that are points, and nothing else acts (`kinematics.dynamics.forces`). Over a
closed cycle the mean by time of power is zero.

Source: docs/theory_design.md, (22).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array, is_number
from sevenbar.design.points.cycle import Cycle, cycle_of, driven
from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.forces.bodies import Body
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.single import check_single
from sevenbar.text.printing import Printed
from sevenbar.text.units import LENGTHS


@dataclass(frozen=True)
class Mass:
    """A mass [kg] at a point of link 1, 2, ..; `at` [length] as points are written."""

    name: str
    link: int
    at: tuple[float, float, float]
    mass: float


@dataclass(frozen=True, eq=False, repr=False)
class Inertia(Printed):
    """What k masses do over a cycle of n rows; `input` (n,) [rad, or length], `time` (n,) [s].

    `force` (k, n, 3) [N] are the inertia forces in the report frame, `acceleration` (k, n, 3) [m/s^2],
    `torque` (n,) [N m] is what the input has to give, for a sliding input a force [N]; `power` (n,) [W],
    `kinetic` (n,) [J] the masses' energy. Lengths are in metres throughout.
    """

    masses: tuple[Mass, ...]
    cycle: Cycle
    gravity: tuple[float, float, float]
    input: Floats
    time: Floats
    acceleration: Floats
    force: Floats
    torque: Floats
    power: Floats
    kinetic: Floats

    @property
    def slides(self) -> bool:
        """Whether the input slides, so that it takes a force and no torque."""
        return not self.cycle.motion.linkage.turns(self.cycle.circuit.input_column)

    @property
    def unit(self) -> str:
        """The unit of `torque`."""
        return "N" if self.slides else "N m"

    @property
    def mean(self) -> float:
        """The mean torque over the cycle: zero up to rounding at constant speed."""
        return self.cycle.mean(self.torque)

    @property
    def sizes(self) -> Floats:
        """The sizes of the inertia forces, (k, n) [N]."""
        return np.asarray(np.linalg.norm(self.force, axis=2))

    @property
    def shaking(self) -> Floats:
        """The sum of all inertia forces, (n, 3) [N]: what the ground has to hold."""
        return np.asarray(self.force.sum(axis=0))


def inertia(
    motion: Motion,
    masses: Mapping[str, float] | Sequence[Mass],
    *,
    gravity: npt.ArrayLike | None = None,
    circuit: int = 0,
    branch: int = 0,
) -> Inertia:
    """Inertia forces and input torque of masses [kg], by the names of the linkage's points or as `Mass`.

    `gravity` (3,) [m/s^2] is in the report frame, as in (0, 0, -9.80665); none where it is left out.

    Raises `RequestError` for a mass that is not positive, a point that does not exist, a circuit that rocks
    at constant speed.

        >>> import sevenbar as sb
        >>> found = inertia(sb.load("seven_r").motion(), {"P": 2.5})
        >>> bool(abs(found.mean) < 1e-12 * abs(found.torque).max())
        True
    """
    check_single(motion.linkage)
    checked = _masses(motion, masses)
    pull = np.zeros(3) if gravity is None else finite_array("gravity", gravity)
    if pull.size != 3:
        raise RequestError(f"gravity: {pull.size} numbers; give three, as in (0, 0, -9.80665)")
    metre = LENGTHS[motion.linkage.length_unit]
    ground = motion.linkage.graph.ground
    moving = [mass.link for mass in checked if mass.link != ground]
    if not moving:
        raise RequestError("masses: all lie on the ground, which stands still; give one on a moving link")
    cycles = {
        link: cycle_of(motion, link, circuit, branch, order="acceleration", rows=motion.samples)
        for link in moving
    }
    cycle = cycles[moving[0]]
    acceleration = np.zeros((len(checked), len(cycle.rates.input), 3))
    bodies: dict[int, list[Body]] = {link: [] for link in cycles}
    for i, mass in enumerate(checked):
        if mass.link in cycles:
            acceleration[i] = metre * cycles[mass.link].rates.of("acceleration", mass.at)
            bodies[mass.link].append(Body(mass.mass, mass.at, solid="point"))
    rows, own = cycle.circuit, cycle.circuit.branch == branch
    if cycle.closed:
        rows, own = driven(motion, cycle.circuit, 0, cycle.rates.input)
    # the masses alone, whatever else the file has
    result = rows.forces(bodies=bodies, gravity=tuple(pull), loads=(), springs=())
    weights = np.array([mass.mass for mass in checked])
    return Inertia(
        masses=checked,
        cycle=cycle,
        gravity=(float(pull[0]), float(pull[1]), float(pull[2])),
        input=cycle.rates.input,
        time=cycle.rates.time,
        acceleration=acceleration,
        force=-weights[:, None, None] * acceleration,
        torque=result.torque[own],
        power=result.power[own],
        kinetic=result.kinetic[own],
    )


def _masses(motion: Motion, masses: Mapping[str, float] | Sequence[Mass]) -> tuple[Mass, ...]:
    """The masses with their places, checked."""
    points = {point.name: point for point in motion.linkage.points}
    checked: list[Mass] = []
    if isinstance(masses, Mapping):
        for name, value in masses.items():
            if name not in points:
                known = ", ".join(points) or "none; add one as [[point]]"
                near = suggestion(name, points)
                raise RequestError(f"masses: no point {shown(name)}; {near}this linkage has {known}")
            checked.append(Mass(name, points[name].link, points[name].at, value))
    else:
        checked.extend(masses)
    if not checked:
        raise RequestError("masses: none given; give one, as in P=2.5")
    for mass in checked:
        value = mass.mass
        if not is_number(value) or not math.isfinite(value) or value <= 0:
            raise RequestError(f"mass of {mass.name}: {shown(value)} is not a mass; give kilograms > 0")
    return tuple(checked)
