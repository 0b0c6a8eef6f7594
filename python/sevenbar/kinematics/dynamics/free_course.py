"""A circuit with its path, its stops and what acts along it: where motions start, and at what rate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, finite_number
from sevenbar.errors import RequestError, shown
from sevenbar.forces.free_motion.course import MASS, MASSLESS_WAY, EnergyCourse
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.dynamics.energy_path import EnergyBuilder
from sevenbar.kinematics.dynamics.forces import STILL, ForceSolver, PosedRows, forces_on
from sevenbar.kinematics.dynamics.free_rows import CourseRows
from sevenbar.kinematics.loop.joint_text import joint_number, joint_speed
from sevenbar.kinematics.paths.circuit_path import HAS, CircuitPath
from sevenbar.kinematics.paths.covered_path import closed_on, covered_path
from sevenbar.kinematics.paths.stretch import (
    StopStretch,
    first_place,
    laps_by_range,
    stopped_column,
    used_stretch,
)
from sevenbar.text.units import LENGTHS

#: Farthest start [rad]: the rounding of a greater angle is more than 1e-7.
FARTHEST = 1e9

#: A start is a dead centre of the input where that moves by less than this along the circuit.
AT_DEAD_CENTRE = 1e-9


@dataclass(frozen=True, eq=False)
class FreeCourse:
    """A circuit with its path and what acts along it, worked out once."""

    linkage: Solvable
    circuit: Circuit
    loading: Loading
    #: The stretches of its path between stops; `None` where the linkage has no stops.
    stretches: tuple[StopStretch, ...] | None

    @cached_property
    def solver(self) -> ForceSolver:
        """The loop with what acts on it."""
        return ForceSolver(self.linkage, self.loading, self.circuit.input_column)

    @cached_property
    def path(self) -> CircuitPath:
        """The circuit by its arc length."""
        return covered_path(self.linkage, self.circuit, self.solver.numbers)

    @cached_property
    def builder(self) -> EnergyBuilder:
        """What asks the core along the path."""
        return EnergyBuilder(self.solver, self.path)

    @cached_property
    def energy(self) -> EnergyCourse:
        """Mass, potential and damping along it."""
        course = self.builder.built()
        if not course.quantities.reach[MASS] > STILL**2 * self.solver.inertia:
            raise RequestError(
                "bodies: nothing that moves on this circuit has a mass; give a body to a link that moves, as "
                "[[body]], or take another circuit"
            )
        return course

    @cached_property
    def rows(self) -> CourseRows:
        """All columns along it."""
        return CourseRows(self.builder)

    def spin_at(self, places: Floats, rates: Floats) -> dict[str, float]:
        """The greatest moment [N m] of each idle spin at places (n,), with rates (n, 2) of the input."""
        if not self.linkage.held.balls:
            return {}
        inside = places % self.path.length if self.path.closed else places
        known = np.isfinite(inside) & np.isfinite(rates).all(axis=1)
        inside, edges = inside[known], self.path.poses.edges
        pieces = np.clip(np.searchsorted(edges, inside, "right") - 1, 0, len(edges) - 2)
        poses = closed_on(self.path, self.solver.numbers, pieces, inside)
        none = np.zeros(len(inside))
        rows = PosedRows(
            poses[:, self.path.input], none, none.astype("<U15"), none.astype(np.int64), poses, rates[known]
        )
        return forces_on(self.solver, self.circuit, rows).idle_spin

    @property
    def turns(self) -> bool:
        """Whether the input is an angle."""
        return self.linkage.turns(self.path.input)

    @property
    def first_row(self) -> int:
        """The circuit's first row that has a pose."""
        return int(np.flatnonzero(np.isfinite(self.circuit.q).all(axis=1))[0])

    def start(self, value: float | str | None, branch: int | None) -> float:
        """The place of a start: an input [rad, or length], on a pass between dead centres of the input.

        On a stretch between stops, where the linkage has some.
        """
        if value is None and branch is None:
            return self.home
        if value is None:
            raise RequestError("start: is missing; give the input at which the pass `branch` is entered")
        number = joint_number("start", value, self.linkage, self.path.input)
        if self.turns and abs(number) > FARTHEST:
            raise RequestError(f"start: {number:.6g} rad is lost in its turns; give an angle of fewer")
        places = self.path.places(number, turns=self.turns)
        if not places.size:
            raise RequestError(f"start: the circuit has no pose at {self.shown(number)}; {self._inputs}")
        ordered = places[np.argsort((places - self._first + 1e-9 * self.path.length) % self.path.length)]
        if branch is not None:
            if (
                isinstance(branch, bool)
                or not isinstance(branch, (int, np.integer))
                or not 0 <= branch < len(ordered)
            ):
                raise RequestError(
                    f"branch: {shown(branch)} is not offered; {len(ordered)} poses have this start, "
                    f"give 0 to {len(ordered) - 1}"
                )
            ordered = ordered[branch : branch + 1]
        free = [place for place in ordered if self.stretch_at(float(place)) is not None]
        if not free:
            raise RequestError(f"start: {self.shown(number)} is beyond the stops; {self._between_stops}")
        # of several the one that is reached from where the linkage is at home
        home = self.stretch_at(self.home)
        own = [place for place in free if home is not None and home.held(place, self.path) is not None]
        return self._on_lap(float((own or free)[0]), number)

    def shown(self, value: float) -> str:
        """An input with its unit, without rounding."""
        value = 0.0 if abs(value) < HAS * (1.0 if self.turns else self.solver.numbers.size) else value
        return self.linkage.column_of(self.path.input).text(value, 9)

    @property
    def _inputs(self) -> str:
        """What inputs the circuit has, for a message."""
        if self.circuit.input_range is None:
            return "give another start"
        low, high = self.circuit.input_range
        return f"its input goes from {self.shown(low)} to {self.shown(high)}"

    @property
    def _between_stops(self) -> str:
        """What inputs are within the stops, for a message."""
        ends = [
            " to ".join(self.shown(self.input_at(place)) for place in (one.begin, one.end))
            for one in self._found
        ]
        return f"they allow {', and '.join(ends)}"

    def input_at(self, place: float) -> float:
        """The input [rad, or length] at a place."""
        lap = math.floor(place / self.path.length) if self.path.closed else 0
        own = float(
            self.path.poses.part(self.path.input).at(np.array([place - lap * self.path.length]))[0, 0]
        )
        return own + lap * float(self.path.gain[self.path.input])

    def _on_lap(self, place: float, value: float) -> float:
        """A place on the lap where the input has a value, not one by whole turns away."""
        gain = float(self.path.gain[self.path.input])
        if not gain:
            return place
        return place + round((value - self.input_at(place)) / gain) * self.path.length

    def on_rows_lap(self, place: float) -> float:
        """A place on the lap of the circuit's rows."""
        gain = float(self.path.gain[self.path.input])
        if not gain:
            return place
        first = float(self.circuit.q[self.first_row, self.path.input])
        return place - math.floor((self.input_at(place) - first) / gain + 1e-12) * self.path.length

    @cached_property
    def _first(self) -> float:
        """The place of the first row."""
        return first_place(self.linkage, self.circuit, self.path, self.solver.numbers)

    @cached_property
    def _found(self) -> tuple[StopStretch, ...]:
        """The stretches, one of the whole path without stops."""
        whole = (StopStretch(0.0, self.path.length, "", ""),)
        return whole if self.stretches is None else self.stretches

    @cached_property
    def home(self) -> float:
        """Where it starts by default: the drawn pose, else the first row, within the stops."""
        numbers, circuit = self.solver.numbers, self.circuit
        if not self._found:
            raise RequestError(
                f"circuit: no pose of circuit {circuit.index} is within the stops of the linkage; take "
                "another circuit, or leave a [[stop]] out"
            )
        used = used_stretch(self.linkage, circuit, self.path, numbers, self._found)
        assert used is not None
        return self.on_rows_lap(used[1])

    def stretch_at(self, place: float) -> StopStretch | None:
        """The stretch between stops that holds a place, on its lap; `None` beyond the stops."""
        for one in self._found:
            own = one.held(place, self.path)
            if own is not None:
                # by whole laps
                off = round((place - own) / self.path.length) * self.path.length
                return replace(one, begin=one.begin + off, end=one.end + off)
        return None

    def laid(self, one: StopStretch) -> StopStretch:
        """A stretch on the lap of the range that ends it, of where it is at home, or of the rows."""
        gain, length = float(self.path.gain[self.path.input]), self.path.length
        if not gain:
            return one
        own = one.held(self.home, self.path)
        off = self.on_rows_lap(one.begin) - one.begin if own is None else self.home - own
        first, last = self.input_at(one.begin + off), self.input_at(one.end + off)
        off += laps_by_range(self.linkage, self.path.input, one, first, last) * math.tau / gain * length
        return replace(one, begin=one.begin + off, end=one.end + off)

    def cut(self, energy: EnergyCourse, one: StopStretch) -> tuple[EnergyCourse, float]:
        """The course on a stretch, and where on the path it begins; the whole one where no stop ends it."""
        if one.is_whole:
            return energy, 0.0
        return energy.between(one.begin, one.end), one.begin

    def pushed(self, force: float, place: float, stop: str) -> tuple[float, str]:
        """What a stop gives at rest, against a force along the path [J for a unit of it], and its unit."""
        named = stopped_column(stop)
        column = self.path.input if named is None else self.linkage.columns.index(named)
        inside = np.array([place % self.path.length if self.path.closed else place])
        by_s = float(self.path.poses.slope.at(inside)[0, column])
        if abs(by_s) < AT_DEAD_CENTRE * float(self.solver.numbers.scales[column]):
            by_s = math.nan
        turns = self.linkage.turns(column)
        unit = 1.0 if turns else LENGTHS[self.linkage.length_unit]
        return -force / (by_s * unit), "N m" if turns else "N"

    def rate(self, place: float, speed: float | str | None, energy: float | None) -> float:
        """The rate s' at a place, from the input's speed [rad/s, or length/s] or the kinetic energy [J]."""
        if speed is not None and energy is not None:
            raise RequestError("energy: speed and energy are both given; give one of them")
        joule = None if energy is None else finite_number("energy", energy)
        inside = np.array([place % self.path.length if self.path.closed else place])
        quantities = self.energy.quantities.at(inside)[0]
        if (speed is not None or joule) and self.energy.is_massless(quantities[:1])[0]:
            raise RequestError(MASSLESS_WAY)
        by_s = float(self.path.poses.slope.at(inside)[0, self.path.input])
        if joule is not None:
            if joule < 0:
                raise RequestError(f"energy: {shown(energy)} is not a kinetic energy; give one >= 0")
            way = -1.0 if by_s < 0 else 1.0
            return way * math.sqrt(2 * joule / float(quantities[MASS]))
        if speed is None:
            return 0.0
        value = joint_speed(speed, self.linkage, self.path.input)
        scale = 1.0 if self.turns else self.solver.numbers.size
        if abs(by_s) < AT_DEAD_CENTRE * scale and value:
            raise RequestError(
                "speed: the input stands still at this start, a dead centre; give energy, or another start"
            )
        return value / by_s if value else 0.0
