"""Masses at points of links: the inertia forces over the cycle, and the torque that the input needs for them.

By virtual power, with m the mass, a the acceleration, g gravity, and dp/dq the place's derivative by the
input:

    force = -m a,     torque = sum m (a - g) . dp/dq

which at constant speed is `sum m (a - g) . v / omega`. Over a closed cycle the mean by time of power is zero.

Source: docs/theory_design.md, (22).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array
from sevenbar.design.points.cycle import Cycle, cycle_of
from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.kinematics.motion import Motion
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
        return self.cycle.motion.linkage.column_kinds[self.cycle.circuit.input_column] == "slide"

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
        sizes: Floats = np.linalg.norm(self.force, axis=2)
        return sizes

    @property
    def shaking(self) -> Floats:
        """The sum of all inertia forces, (n, 3) [N]: what the ground has to hold."""
        total: Floats = self.force.sum(axis=0)
        return total


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
    checked = _masses(motion, masses)
    pull = np.zeros(3) if gravity is None else finite_array("gravity", gravity)
    if pull.size != 3:
        raise RequestError(f"gravity: {pull.size} numbers; give three, as in (0, 0, -9.80665)")
    metre = LENGTHS[motion.linkage.length_unit]
    last = len(motion.linkage.joints)
    moving = [mass.link for mass in checked if mass.link != last]
    if not moving:
        raise RequestError("masses: all lie on the ground, which stands still; give one on a moving link")
    cycles = {
        link: cycle_of(motion, link, circuit, branch, order="acceleration", rows=motion.samples)
        for link in moving
    }
    cycle = cycles[moving[0]]
    speeds = _speeds(cycle)
    rows = len(cycle.rates.input)
    acceleration, torque, kinetic = np.zeros((len(checked), rows, 3)), np.zeros(rows), np.zeros(rows)
    geometry = {link: cycles[link].geometry() for link in cycles}
    for i, mass in enumerate(checked):
        if mass.link not in cycles:
            continue
        rates = cycles[mass.link].rates
        acceleration[i] = metre * rates.of("acceleration", mass.at)
        # the input's length cancels where it slides
        scale = 1.0 if cycle.motion.linkage.column_kinds[cycle.circuit.input_column] == "slide" else metre
        along = scale * geometry[mass.link].of("velocity", mass.at)
        torque += mass.mass * ((acceleration[i] - pull) * along).sum(axis=1)
        velocity = metre * rates.of("velocity", mass.at)
        kinetic += 0.5 * mass.mass * (velocity**2).sum(axis=1)
    slides = cycle.motion.linkage.column_kinds[cycle.circuit.input_column] == "slide"
    weights = np.array([mass.mass for mass in checked])
    return Inertia(
        masses=checked,
        cycle=cycle,
        gravity=(float(pull[0]), float(pull[1]), float(pull[2])),
        input=cycle.rates.input,
        time=cycle.rates.time,
        acceleration=acceleration,
        force=-weights[:, None, None] * acceleration,
        torque=torque,
        power=torque * speeds * (metre if slides else 1.0),
        kinetic=kinetic,
    )


def _speeds(cycle: Cycle) -> Floats:
    """The input's speed [rad/s, or length/s] at the rows of a cycle, (n,)."""
    if cycle.motion.law is None:
        return np.full(len(cycle.rates.input), cycle.motion.speed)
    return cycle.motion.law.dq


def _masses(motion: Motion, masses: Mapping[str, float] | Sequence[Mass]) -> tuple[Mass, ...]:
    """The masses with their places, checked."""
    points = {point.name: point for point in motion.linkage.points}
    checked: list[Mass] = []
    if isinstance(masses, Mapping):
        for name, value in masses.items():
            if name not in points:
                known = ", ".join(points) or "none; add one as [[point]]"
                near = suggestion(str(name), points)
                raise RequestError(f"masses: no point {shown(name)}; {near}this linkage has {known}")
            checked.append(Mass(name, points[name].link, points[name].at, value))
    else:
        checked.extend(masses)
    if not checked:
        raise RequestError("masses: none given; give one, as in P=2.5")
    for mass in checked:
        value = mass.mass
        number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
        if not number or not math.isfinite(value) or value <= 0:
            raise RequestError(f"mass of {mass.name}: {shown(value)} is not a mass; give kilograms > 0")
    return tuple(checked)
