"""What a drive and its bearings have to bear over a cycle: peaks with their places, means, a flywheel.

At constant speed, with torque M over the input x and its mean,

    E(x) = integral (M - mean M) dx,   dE = max E - min E,   J = dE / (delta w^2)                         (14)

A drive that gives the mean torque runs slowest where E is highest and fastest where it is lowest. A bearing's
loads are the sizes of components of the force and moment in its joint, as peak and as cubic mean.

Source: docs/theory_forces.md, (14) to (16); ISO 281 for the third power.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter
from typing import Any, Literal, Protocol

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Booleans, Floats, finite_number
from sevenbar.curves.curve import Curve, Peak, greatest, mean
from sevenbar.curves.cycle_series import CycleSeries, filled
from sevenbar.curves.pieces import cycle_curve, pieces
from sevenbar.curves.timed_rows import TimedRows
from sevenbar.errors import RequestError, shown
from sevenbar.forces.heard import heard
from sevenbar.text.printing import Printed

#: Parts of a wrench (moment x, y, z, force x, y, z in the joint's frame, z its axis) whose size loads a
#: bearing.
PARTS: Mapping[str, tuple[int, ...]] = {
    "force": (3, 4, 5),
    "radial": (3, 4),
    "axial": (5,),
    "tilting": (0, 1),
    "turning": (2,),
}


#: A force has a bound at change points where its last waves are below this part of its greatest value.
ACROSS = 1e-6

#: Figures of which more than this part of the greatest value may be missed are withheld.
WITHHELD = 1e-3

#: How a sizing was found; see `Sizing`.
Found = Literal["series", "pieces", "refined", "rows"]

#: A moment or force below this part of the others of its kind is rounding.
ROUNDING = 1e-9


class Wrenches(Protocol):
    """Force (n, 3) [N] and moment (n, 3) [N m] in a joint; (6,) flags: moment x, y, z, then force."""

    @property
    def force(self) -> Floats:
        """Of the link before on the link after."""

    @property
    def moment(self) -> Floats:
        """About the place of the joint."""

    @property
    def determinate(self) -> Booleans:
        """Whether equilibrium determines each part."""


class Rows(Protocol):
    """What a circuit takes at n rows: torque [N m | N], power [W], wrenches of its joints."""

    @property
    def input(self) -> Floats:
        """The input [rad, or length]."""

    @property
    def time(self) -> Floats:
        """The time [s]."""

    @property
    def torque(self) -> Floats:
        """What the input gives."""

    @property
    def power(self) -> Floats:
        """The drive's power."""

    @property
    def reactions(self) -> Mapping[str, Wrenches]:
        """By the names of the joints."""


@dataclass(frozen=True)
class Burden:
    """The size of a force [N] or moment [N m] over a cycle: its peak, and `(mean size^3)^(1/3)` by time.

    NaN where equilibrium does not determine it, or it grows without bound at a change point.
    """

    peak: Peak
    mean_cube: float


@dataclass(frozen=True, eq=False, repr=False)
class Bearing(Printed):
    """What the bearing of a joint bears, in the joint's frame on the side of the link before, z its axis.

    `force` [N] is the whole force, `radial` its part square to the axis, `axial` that along it; `tilting`
    [N m] the moment about x and y, `turning` that about the axis, which a guide bears and a drive gives.
    `in_plane` [N] is the force without the one component that equilibrium leaves open: of a planar loop the
    force in its plane of motion. NaN where none or more of them are open.
    `direction` (n,) [rad] is that of the radial force from x towards y, row by row, and `size` (n,) [N].
    """

    force: Burden
    radial: Burden
    axial: Burden
    tilting: Burden
    turning: Burden
    in_plane: Burden
    direction: Floats
    size: Floats
    input_unit: str = "rad"


@dataclass(frozen=True, eq=False, repr=False)
class Sizing(Printed):
    """What motor, flywheel and bearings one cycle needs.

    `peak_torque` [N m, of a slide N] is the value that is farthest from zero, `peak_power` and
    `braking_power` [W] the highest and the lowest; the lowest is `None` where the drive never brakes.
    `fluctuation` [J] is that of the energy about a drive of constant torque, of a law's rows about constant
    power; such a drive runs `fastest` and `slowest` at these inputs. `flywheel` [kg m^2] keeps the unevenness
    `(highest - lowest) / mean speed` at `unevenness`: all inertia that is needed, of which the mean of the
    linkage's own may be taken off. `None` without a constant speed.

    `found` says how: by a "series" through the rows, in "pieces" between jumps, in pieces that are "refined"
    where a quantity is too sharp for a series, or from the "rows" as they are; `tail` how much may lie
    between the rows, as a part of the greatest torque, force or moment. The torque is in the `unit`, inputs
    are in the `input_unit`, "rad" or the length unit.
    """

    peak_torque: Peak
    rms_torque: float
    mean_torque: float
    peak_power: Peak
    braking_power: Peak | None
    fluctuation: float
    fastest: float
    slowest: float
    unevenness: float | None
    flywheel: float | None
    bearings: Mapping[str, Bearing]
    found: Found
    tail: float
    unit: str = "N m"
    input_unit: str = "rad"

    def in_units(self, unit: str, input_unit: str) -> Sizing:
        """The same with the units of its torque and inputs."""
        bearings = {name: replace(one, input_unit=input_unit) for name, one in self.bearings.items()}
        return replace(self, unit=unit, input_unit=input_unit, bearings=bearings)


def cycle_loads(
    rows: Rows,
    *,
    period: float | None,
    speed: float | None = None,
    evaluate: Callable[[Floats], Rows] | None = None,
    breaks: Sequence[float] = (),
    gaps: npt.NDArray[np.bool_] | None = None,
) -> CycleLoads | None:
    """Torque and wrenches of a cycle; `None` where a row has no torque.

    Of a circuit whose input goes round at constant `speed` [rad/s], `period` [rad] is its way till it closes,
    negative for a negative speed, and the n rows are at equal steps; `evaluate` gives rows at any inputs, and
    `breaks` are inputs where loads set in or end. Of a law's rows `period` is `None`. `gaps` (n,) are rows
    without values, which the series through the others goes across.

    Raises `RequestError` for breaks without `evaluate`.
    """
    names = tuple(rows.reactions)
    table = _table(rows, names)
    known = np.array(
        [True, *np.concatenate([*(rows.reactions[name].determinate for name in names), []])], dtype=bool
    )
    if gaps is not None and gaps.any():
        table = filled(table, gaps)
    if gaps is not None and np.isfinite(table[:, 0]).all():
        # what grows without bound at a change point has no series that ends
        bounded = [
            not part.size or CycleSeries(part, 0.0, math.tau).last_waves <= ACROSS
            for part in _wrench_parts(table, known)
        ]
        known[1:] &= np.repeat(np.array(bounded, dtype=bool), 3)
    if not len(table) or not np.isfinite(table[:, known]).all():
        return None
    if len(breaks) and period is not None and evaluate is None:
        raise RequestError("breaks: a torque that jumps needs rows between the rows; give evaluate")
    table = np.where(known, table, 0.0)
    units = _units(table)

    def between(inputs: Floats) -> Floats:
        assert evaluate is not None
        return np.where(known, _table(evaluate(inputs), names), 0.0) / units

    every: Curve
    result: Found
    if period is None:
        every, result = TimedRows(table / units, rows.input, rows.time), "rows"
    elif len(breaks):
        every, result = pieces(between, table / units, float(rows.input[0]), period, breaks), "pieces"
    else:
        ask = between if evaluate is not None else None
        every = cycle_curve(ask, table / units, float(rows.input[0]), period)
        result = "series" if isinstance(every, CycleSeries) else "refined"
    return CycleLoads(rows, every, units, known, result, period, speed or 0.0)


@dataclass(frozen=True, eq=False)
class CycleLoads:
    """Torque and wrenches along a cycle as one curve, from which each number of a sizing is made when asked.

    `every` has the torque, then moment and force of each joint, in `units`; where not `known` it is 0.
    `period` is `None` of a law's rows, `speed` that of the input.
    """

    rows: Rows
    every: Curve
    units: Floats
    known: Booleans
    found: Found
    period: float | None
    speed: float
    #: What a torque times the input is in joule.
    work: float = 1.0

    @property
    def tail(self) -> float:
        """How much may lie between the rows, as a part of the greatest value."""
        return self.every.tail

    @cached_property
    def _torque(self) -> Curve:
        return self.every.part(0)

    @property
    def _unit(self) -> float:
        return float(self.units[0])

    @cached_property
    def _peak(self) -> Peak:
        return greatest(self._torque)

    @cached_property
    def peak_torque(self) -> Peak:
        """The torque that is farthest from zero."""
        return Peak(self._unit * self._peak.value + 0.0, self._peak.input)

    @cached_property
    def rms_torque(self) -> float:
        """The root of the mean square of the torque."""
        return self._unit * math.sqrt(max(0.0, self._torque.mean_of(np.square)))

    @cached_property
    def mean_torque(self) -> float:
        """The mean of the torque."""
        return self._unit * heard(mean(self._torque), self._peak.value)

    @cached_property
    def _powers(self) -> tuple[Peak, Peak]:
        """The highest and the lowest power [W]."""
        if self.period is None:
            power = TimedRows(self.rows.power, self.rows.input, self.rows.time)
            return power.highest(), power.lowest()
        rate = self.speed * self._unit
        ends = [
            Peak(rate * one.value + 0.0, one.input) for one in (self._torque.highest(), self._torque.lowest())
        ]
        value_of = attrgetter("value")
        return max(ends, key=value_of), min(ends, key=value_of)

    @property
    def peak_power(self) -> Peak:
        """The highest power [W]."""
        return self._powers[0]

    @property
    def braking_power(self) -> Peak | None:
        """The lowest power [W]; `None` where the drive never brakes."""
        lowest = self._powers[1]
        return lowest if heard(lowest.value, self.peak_power.value) < 0 else None

    @cached_property
    def _energy(self) -> tuple[float, float, float]:
        """The fluctuation [J], and the inputs where a drive of constant torque runs fastest and slowest."""
        if self.period is None:
            curve: Curve = TimedRows(self.rows.power, self.rows.input, self.rows.time)
            # energies of what goes to and fro are parts of the peak's over the cycle
            unit, way = 1.0, float(np.abs(self.peak_power.value)) * float(np.ptp(self.rows.time))
        else:
            curve, unit = self._torque, self._unit
            way = self._peak.value * self.period * unit
        energy = curve.running()
        top, bottom = energy.highest(), energy.lowest()
        fluctuation = heard(unit * (top.value - bottom.value), way)
        if not fluctuation:
            top = bottom = Peak(0.0, float(self.rows.input[0]))
        return self.work * fluctuation, self._within_cycle(bottom.input), self._within_cycle(top.input)

    def _within_cycle(self, input: float) -> float:
        """An input as the rows of the cycle count: the end of pieces that begin at a break is their first."""
        start = float(self.rows.input[0])
        if self.period is None or abs(input - start) < abs(self.period):
            return input
        return start + (input - start) % self.period

    @property
    def fluctuation(self) -> float:
        """That of the energy about a drive of constant torque [J]."""
        return self._energy[0]

    def bearing(self, name: str) -> Bearing:
        """What the bearing of a joint bears."""
        names = list(self.rows.reactions)
        wrenches, start = self.rows.reactions[name], 1 + 6 * names.index(name)
        return _bearing(self.every, self.units, self.known, wrenches, start)

    def sizing(self, unevenness: float | None = None) -> Sizing:
        """All numbers, with the flywheel for an unevenness."""
        fluctuation, fastest, slowest = self._energy
        wheel = unevenness and self.period and self.speed
        return Sizing(
            peak_torque=self.peak_torque,
            rms_torque=self.rms_torque,
            mean_torque=self.mean_torque,
            peak_power=self.peak_power,
            braking_power=self.braking_power,
            fluctuation=fluctuation,
            fastest=fastest,
            slowest=slowest,
            unevenness=unevenness,
            flywheel=flywheel(fluctuation, self.speed, unevenness) if wheel and unevenness else None,
            bearings={name: self.bearing(name) for name in self.rows.reactions},
            found=self.found,
            tail=self.tail,
        )


def unevenness_of(given: float | None) -> float | None:
    """An unevenness as it may be; raises `RequestError` for one that is not > 0 and up to 2."""
    delta = None if given is None else finite_number("unevenness", given)
    # twice the mean: the lowest speed is 0
    if delta is not None and not 0 < delta <= 2:
        raise RequestError(
            f"unevenness: {shown(given)} is not an unevenness; "
            "give a part of the mean speed > 0 and up to 2, as in 0.01"
        )
    return delta


def flywheel(fluctuation: float, speed: float, unevenness: float) -> float:
    """The inertia [kg m^2] that keeps a drive of constant torque as even as wanted, `dE / (delta w^2)`.

    Source: docs/theory_forces.md, (14).
    """
    return fluctuation / (unevenness * speed**2)


def _bearing(every: Curve, units: Floats, known: Booleans, wrenches: Wrenches, start: int) -> Bearing:
    burdens: dict[str, Any] = {}
    forces = tuple(i for i in PARTS["force"] if known[start + i])
    for name, part in {**PARTS, "in_plane": forces if len(forces) == 2 else PARTS["force"]}.items():
        columns = tuple(start + i for i in part)
        if not known[list(columns)].all() or (name == "in_plane" and len(part) == 3):
            burdens[name] = Burden(Peak(math.nan, math.nan), math.nan)
            continue
        unit = float(units[columns[0]])
        squares = every.part(columns).squared()
        top = squares.highest()
        cubes = squares.mean_of(lambda values: np.maximum(values, 0.0) ** 1.5)
        burdens[name] = Burden(
            Peak(unit * math.sqrt(max(0.0, top.value)), top.input), unit * max(0.0, cubes) ** (1 / 3)
        )
    x, y = wrenches.force[:, 0], wrenches.force[:, 1]
    return Bearing(**burdens, direction=np.arctan2(y, x), size=np.hypot(x, y))


def _wrench_parts(table: Floats, known: npt.NDArray[np.bool_]) -> list[Floats]:
    """Moment and force (n, k) of joint after joint, of each what is known, without what is rounding."""
    sizes = np.where(known, np.abs(np.where(known, table, 0.0)), 0.0)[:, 1:]
    # of most rows: some may have no bound
    typical = np.median(sizes, axis=0).reshape(-1, 2, 3).max(axis=(0, 2), initial=0.0)
    result = []
    for k in range(sizes.shape[1] // 3):
        own = slice(1 + 3 * k, 4 + 3 * k)
        part = table[:, own][:, known[own]]
        heard = np.abs(part).max(initial=0.0) > ROUNDING * typical[k % 2]
        result.append(part if heard else part[:, :0])
    return result


def _table(rows: Rows, names: tuple[str, ...]) -> Floats:
    """Torque, then moment and force of each joint, (n, 1 + 6 joints)."""
    result = [rows.torque[:, None]]
    for name in names:
        result += [rows.reactions[name].moment, rows.reactions[name].force]
    return np.concatenate(result, axis=1)


def _units(table: Floats) -> Floats:
    """The greatest torque, moment and force, for their columns: so that rounding is one size in all."""
    greatest_of = np.abs(table).max(axis=0)
    joints = (len(greatest_of) - 1) // 6
    kinds = np.concatenate([[0], np.tile([1, 1, 1, 2, 2, 2], joints)])
    sizes = np.array([greatest_of[kinds == kind].max(initial=0.0) for kind in range(3)])
    return np.asarray(np.where(sizes > 0, sizes, 1.0)[kinds])
