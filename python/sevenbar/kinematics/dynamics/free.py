"""Free motion and equilibria of a circuit: the path, what acts along it, and the state at any time.

Source: docs/theory_free.md, (1) to (15).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Words, finite_array, finite_number, whole_number
from sevenbar.errors import RequestError, shown
from sevenbar.forces.free_motion.conservative import BALANCED
from sevenbar.forces.free_motion.course import DAMPING, INPUT, MASS, MASSLESS_WAY, EnergyCourse
from sevenbar.forces.free_motion.driven import COARSE, TOLERANCE, Motor, force_at
from sevenbar.forces.free_motion.equilibria import Equilibrium, Resting, resting_places
from sevenbar.forces.free_motion.result import FreeMotion, FreeStates, Impact, TurningPoint
from sevenbar.forces.free_motion.stages import Stages, Walls, elastic, staged, stepped, without_losses
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.dynamics.energy_path import EnergyBuilder
from sevenbar.kinematics.dynamics.forces import STILL, ForceSolver, PosedRows, forces_on
from sevenbar.kinematics.dynamics.free_rows import CourseRows
from sevenbar.kinematics.loop.columns import joint_columns
from sevenbar.kinematics.loop.joint_text import joint_number, joint_speed
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.paths.circuit_path import HAS, CircuitPath
from sevenbar.kinematics.paths.covered_path import closed_on, covered_path
from sevenbar.kinematics.paths.stretch import (
    Stretch,
    first_place,
    laps_by_range,
    stopped_column,
    used_stretch,
)
from sevenbar.text.amounts import amount_in
from sevenbar.text.units import LENGTHS

#: A torque: a number, a table of speeds and torques, or a function of the speed.
Torque = float | tuple[npt.ArrayLike, npt.ArrayLike] | Callable[[float], float]

#: Damping below this part of the mass in a second is none.
UNDAMPED = 1e-15

#: A start is a dead centre of the input where that moves by less than this along the circuit.
AT_DEAD_CENTRE = 1e-9


@dataclass(frozen=True, eq=False)
class FreeCourse:
    """A circuit with its path and what acts along it, worked out once."""

    linkage: Solvable
    circuit: Circuit
    loading: Loading
    #: The stretches of its path between stops; `None` where the linkage has no stops.
    stretches: tuple[Stretch, ...] | None

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
        if not self.linkage.held[0]:
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
        unit = self.linkage.length_unit
        return f"{math.degrees(value):.9g} deg" if self.turns else f"{value:.9g} {unit}"

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
    def _found(self) -> tuple[Stretch, ...]:
        """The stretches, one of the whole path without stops."""
        whole = (Stretch(0.0, self.path.length, "", ""),)
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

    def stretch_at(self, place: float) -> Stretch | None:
        """The stretch between stops that holds a place, on its lap; `None` beyond the stops."""
        for one in self._found:
            own = one.held(place, self.path)
            if own is not None:
                # by whole laps
                off = round((place - own) / self.path.length) * self.path.length
                return replace(one, begin=one.begin + off, end=one.end + off)
        return None

    def laid(self, one: Stretch) -> Stretch:
        """A stretch on the lap of the range that ends it, of where it is at home, or of the rows."""
        gain, length = float(self.path.gain[self.path.input]), self.path.length
        if not gain:
            return one
        own = one.held(self.home, self.path)
        off = self.on_rows_lap(one.begin) - one.begin if own is None else self.home - own
        first, last = self.input_at(one.begin + off), self.input_at(one.end + off)
        off += laps_by_range(self.linkage, self.path.input, one, first, last) * math.tau / gain * length
        return replace(one, begin=one.begin + off, end=one.end + off)

    def cut(self, energy: EnergyCourse, one: Stretch) -> tuple[EnergyCourse, float]:
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
        inside = np.array([place % self.path.length if self.path.closed else place])
        quantities = self.energy.quantities.at(inside)[0]
        if (speed is not None or energy) and self.energy.is_massless(quantities[:1])[0]:
            raise RequestError(MASSLESS_WAY)
        by_s = float(self.path.poses.slope.at(inside)[0, self.path.input])
        if energy is not None:
            joule = finite_number("energy", energy)
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


#: Courses live as long as their circuits.
_COURSES: WeakKeyDictionary[Circuit, list[tuple[object, FreeCourse]]] = WeakKeyDictionary()


def course_of(
    linkage: Solvable, circuit: Circuit, loading: Loading, stretches: tuple[Stretch, ...] | None
) -> FreeCourse:
    """The course of a circuit under a loading, made once for each."""
    if not any(loading.bodies.values()):
        raise RequestError("bodies: nothing has a mass; give bodies, or write [[body]]")
    key = (loading.gravity, tuple(sorted(loading.bodies.items())), loading.loads, loading.springs)
    known = _COURSES.setdefault(circuit, [])
    for own, course in known:
        if own == key:
            return course
    course = FreeCourse(linkage, circuit, loading, stretches)
    if known:
        # the path is that of the circuit, whatever acts
        course.__dict__["path"] = known[0][1].path
    known.append((key, course))
    return course


def equilibria_of(
    linkage: Solvable,
    circuit: Circuit,
    loading: Loading,
    torque: float,
    stretches: tuple[Stretch, ...] | None = None,
) -> tuple[Equilibrium, ...]:
    """All equilibria of a circuit within its stops; see `Circuit.equilibria`."""
    course = course_of(linkage, circuit, loading, stretches)
    energy = course.energy.driven_by(finite_number("torque", torque))
    if stretches is None or any(one.is_whole for one in stretches):
        begin = course.home if energy.winds else 0.0
        found = []
        for place, kind, frequency, rate, end in resting_places(energy, begin):
            off = 0.0 if energy.winds else course.on_rows_lap(place) - place
            found.append(_equilibrium(course, energy, (place + off, kind, frequency, rate, end + off)))
        return tuple(found)
    found = []
    for one in stretches:
        own, begin = course.cut(energy, course.laid(one))
        inner = [_equilibrium(course, own, each, begin=begin) for each in resting_places(own)]
        first, last = (
            [_on_stop(course, own, begin, place, stop, None, 0.0)]
            if stop and way * force_at(own, place, np.zeros(1), None)[0] > BALANCED * energy.steepest
            else []
            for place, stop, way in ((0.0, one.first_stop, -1), (own.length, one.last_stop, 1))
        )
        found += [*first, *inner, *last]
    return tuple(found)


def _equilibrium(
    course: FreeCourse,
    energy: EnergyCourse,
    one: Resting,
    *,
    begin: float = 0.0,
) -> Equilibrium:
    """An equilibrium of a course that begins at a place of the path."""
    place, kind, frequency, rate, end = one
    until = course.input_at(begin + end) if math.isfinite(end) else math.nan
    q = course.rows.at(np.array([begin + place]), (np.zeros(1),) * 3)[0][0]
    potential = float(energy.at(np.array([place]))[2][0])
    columns = course.circuit.columns
    value = float(q[course.path.input])
    spin = course.spin_at(np.array([begin + place]), np.zeros((1, 2)))
    return Equilibrium(value, columns, q, kind, frequency, rate, potential, begin + place, until, spin=spin)


def _on_stop(
    course: FreeCourse,
    energy: EnergyCourse,
    begin: float,
    place: float,
    stop: str,
    motor: Motor | None,
    time: float,
) -> Equilibrium:
    """A rest at an end of a stretch that begins at a place of the path, and what the stop gives there."""
    force = float(force_at(energy, place, np.array([time]), motor)[0])
    holding, unit = course.pushed(force, begin + place, stop)
    none = math.nan
    found = _equilibrium(course, energy, (place, "on its stop", none, none, none), begin=begin)
    return replace(found, stop=stop, holding=holding, holding_unit=unit)


def free_motion_of(
    linkage: Solvable,
    circuit: Circuit,
    loading: Loading,
    duration: float | str,
    *,
    speed: float | str | None = None,
    energy: float | None = None,
    start: float | str | None = None,
    branch: int | None = None,
    torque: Torque | None = None,
    torque_by_time: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    samples: int = 361,
    restitution: float | None = None,
    stretches: tuple[Stretch, ...] | None = None,
) -> FreeMotion:
    """A free motion; see `Circuit.free_motion`."""
    seconds = _seconds(duration)
    samples = whole_number("samples", samples, 2, None, "a number of rows")
    returned = _restitution(restitution, stretches)
    course = course_of(linkage, circuit, loading, stretches)
    constant, motor = _motor(torque, torque_by_time, course)
    place = course.start(start, branch)
    stretch = course.stretch_at(place)
    assert stretch is not None
    energies = course.energy.driven_by(constant)
    own, begin = course.cut(energies, stretch)
    rate = course.rate(place, speed, energy)
    times = np.linspace(0.0, seconds, samples)
    damped = own.quantities.reach[DAMPING] > UNDAMPED * own.quantities.reach[MASS]
    difference = math.nan
    stepping = damped or motor is not None
    walls = Walls(stretch.first_stop, stretch.last_stop, returned)
    origin = (min(max(place - begin, 0.0), own.length) if begin or not walls.none else place, rate)
    if stepping:
        solved, coarse = (
            staged(own, walls, origin, seconds, stepped(own, motor, tol), motor)
            for tol in (TOLERANCE, COARSE)
        )
        difference = float(np.nanmax(np.abs(solved.at(times)[0] - coarse.at(times)[0])))
    else:
        ideal = elastic(own, walls, origin) if returned == 1.0 else None
        solved = ideal or staged(own, walls, origin, seconds, without_losses(own))
    states = partial(_states, course, own, solved, motor, begin)
    rows = states(times)
    turns = np.array(solved.turning, dtype=np.float64)
    still = (np.zeros(len(turns)),) * 3
    at_turns = course.rows.at(begin + turns, still)[0][:, course.path.input]
    heights = own.at(turns)[2]
    error = math.nan
    if not stepping:
        total = rows.kinetic + rows.potential + solved.lost_at(times)
        most = max(float(np.nanmax(rows.kinetic)), float(solved.lost.max()))
        error = float(np.nanmax(np.abs(total - total[0]))) / most if most else 0.0
    rest = None
    if solved.kind == "on its stop":
        last = float(solved.flights[-1].at(np.zeros(1))[0][0])
        rest = _on_stop(course, own, begin, last, walls.at(last, own)[0], motor, seconds)
    return FreeMotion(
        time=times,
        columns=circuit.columns,
        q=rows.q,
        dq=rows.dq,
        ddq=rows.ddq,
        dddq=rows.dddq,
        kinetic=rows.kinetic,
        potential=rows.potential,
        kind=solved.kind,
        period=solved.period,
        turning=tuple(TurningPoint(float(x), float(h)) for x, h in zip(at_turns, heights, strict=True)),
        energy_error=error,
        difference=difference,
        tail=own.tail,
        duration=seconds,
        input_column=course.path.input,
        input_turns=course.turns,
        column_kinds=linkage.column_kinds,
        length_unit=linkage.length_unit,
        through_change_points=bool(course.path.centres.size),
        impacts=_impacts(course, begin, solved),
        rest=rest,
        spin=course.spin_at(rows.place, np.stack([rows.dq, rows.ddq], axis=2)[:, course.path.input]),
        rests_from=math.nan if rest is None else float(solved.begins[-1]),
        restitution=returned,
        heading=linkage.heading,
        _states=states,
        _law=_as_law,
        _motion=partial(_as_motion, course, solved, motor, own, begin),
        _table=partial(_as_table, linkage),
    )


def _restitution(given: float | None, stretches: tuple[Stretch, ...] | None) -> float:
    """What part of the speed a stop gives back; raises `RequestError` for what is no part."""
    if given is None:
        return 0.0
    value = finite_number("restitution", given)
    if not 0 <= value <= 1:
        raise RequestError(
            f"restitution: {shown(given)} is not a part of the speed; give 0 (no rebound) to 1 (no loss)"
        )
    if stretches is None:
        raise RequestError(
            "restitution: the linkage has no stops to rebound from; write [[stop]], or leave it out"
        )
    return value


def _impacts(course: FreeCourse, begin: float, found: Stages) -> tuple[Impact, ...]:
    """The stops that are met, by the input."""
    if not found.met:
        return ()
    places = np.array([begin + one.place for one in found.met])
    rates = np.array([one.rate for one in found.met])
    none = np.zeros(len(rates))
    q, dq, *_ = course.rows.at(places, (rates, none, none))
    column = course.path.input
    return tuple(
        Impact(one.time, one.stop, float(value), float(speed))
        for one, value, speed in zip(found.met, q[:, column], dq[:, column], strict=True)
    )


def _seconds(duration: float | str) -> float:
    value = amount_in(duration, "s") if isinstance(duration, str) else finite_number("duration", duration)
    if value is None or value <= 0:
        raise RequestError(
            f"duration: {shown(duration)} is not a time; give one > 0, as in 10, '10s' or '500ms'"
        )
    return float(value)


def _curve(key: str, table: tuple[npt.ArrayLike, npt.ArrayLike], what: str) -> tuple[Floats, Floats]:
    if not isinstance(table, (tuple, list)) or len(table) != 2:
        raise RequestError(f"{key}: {shown(table)} is no curve; give {what} and the torques there")
    across, torques = (finite_array(key, part) for part in table)
    if across.size != torques.size or across.size < 2 or np.any(np.diff(across) <= 0):
        raise RequestError(f"{key}: give as many torques as {what}, two or more, {what} rising")
    return across, torques


def _motor(
    torque: Torque | None, by_time: tuple[npt.ArrayLike, npt.ArrayLike] | None, course: FreeCourse
) -> tuple[float, Motor | None]:
    """A constant torque, and what depends on time and speed."""
    if torque is not None and by_time is not None:
        raise RequestError("torque_by_time: torque is given as well; give one of them")
    # the speed of a slide is that of metres here
    unit = 1.0 if course.turns else 1 / LENGTHS[course.linkage.length_unit]
    if by_time is not None:
        return 0.0, Motor(_curve("torque_by_time", by_time, "times"), by_time=True)
    if torque is None:
        return 0.0, None
    if callable(torque):
        asked = torque
        return 0.0, Motor(function=lambda speed: float(asked(speed * unit)))
    if isinstance(torque, (tuple, list)):
        speeds, torques = _curve("torque", torque, "speeds")
        return 0.0, Motor((speeds / unit, torques))
    return finite_number("torque", torque), None


def _rates(
    own: EnergyCourse, state: Stages, motor: Motor | None, times: Floats
) -> tuple[Floats, tuple[Floats, Floats, Floats], Floats, Floats]:
    """Places, s', s'' and s''', kinetic and potential energy at times."""
    place, v = state.at(times)
    known = np.isfinite(place)
    s = np.where(known, place, 0.0)
    mass, slope, potential, damping = own.at(s)
    lap = own.laps(s)
    inside = s - lap * own.length
    first = own.quantities.slope
    by, second = first.at(inside), first.slope.at(inside)
    with np.errstate(all="ignore"):
        force = -slope - damping * v - by[:, MASS] * v**2 / 2
        if motor is not None:
            by_s = own.quantities.at(inside)[:, INPUT]
            force = force + motor.at(times, by_s * v) * by_s
        # at a place without mass nothing is but at rest
        still = own.is_massless(mass) | state.rests(times)
        a = np.where(still, 0.0, force / mass)
        curvature = by[:, 1] + lap * by[:, 4]
        by_place = -(curvature + by[:, DAMPING] * v + second[:, MASS] * v**2 / 2 + a * by[:, MASS]) / mass
        by_speed = -(damping + by[:, MASS] * v) / mass
        j = np.where(still, 0.0, by_place * v + by_speed * a)
        if motor is not None:
            j = np.full(v.shape, np.nan)
    kinetic = mass * v**2 / 2
    for part in (kinetic, potential, a, j):
        part[~known] = np.nan
    return place, (v, a, j), kinetic, potential


def _states(
    course: FreeCourse, own: EnergyCourse, state: Stages, motor: Motor | None, begin: float, times: Floats
) -> FreeStates:
    place, rates, kinetic, potential = _rates(own, state, motor, times)
    place = begin + place
    q, dq, ddq, dddq = course.rows.at(place, rates)
    return FreeStates(q, dq, ddq, dddq, kinetic, potential, place, rates[0])


def _as_law(found: FreeMotion) -> Law:
    """The input over time, rows past the end left out."""
    column, rows = found.input_column, np.isfinite(found.input)
    value, rate, second, third = (part[rows, column] for part in (found.q, found.dq, found.ddq, found.dddq))
    return Law.of(found.time[rows], value, rate, second, third if np.isfinite(third).all() else 0.0)


def _as_table(linkage: Solvable, found: FreeMotion, si: bool) -> dict[str, npt.NDArray[Any]]:
    """Columns by names that end in their units."""
    length, angle = ("m", "rad") if si else (found.length_unit, "deg")
    scale = LENGTHS[found.length_unit] if si else 1.0
    rates = (found.q, found.dq, found.ddq)
    joints = joint_columns(linkage, rates, length=length, angle=angle, scale=scale)
    return {"time_s": found.time, **joints, "kinetic_J": found.kinetic, "potential_J": found.potential}


def _as_motion(
    course: FreeCourse,
    state: Stages,
    motor: Motor | None,
    own: EnergyCourse,
    begin: float,
    found: FreeMotion,
) -> Motion:
    """A motion whose one circuit has the rows of a free motion."""
    circuit, linkage = course.circuit, course.linkage
    place, rates, *_ = _rates(own, state, motor, found.time)
    place = begin + place
    count = len(found.time)
    status: Words = np.where(np.isfinite(place), "ok", "no-solution").astype("<U15")
    status[(status == "ok") & np.isnan(found.q).any(axis=1)] = "turns-undefined"

    def point(link: int, at: Floats) -> object:
        return course.rows.trace(place, rates, status, link, at)

    rows = replace(
        circuit,
        q=found.q,
        dq=found.dq,
        ddq=found.ddq,
        dddq=found.dddq,
        time=found.time,
        status=status,
        branch=np.zeros(count, dtype=np.int64),
        mode=np.full(count, int(circuit.mode[0]) if len(circuit.mode) else 0),
        residual=np.zeros(count),
        condition=np.full(count, np.nan),
        speed=math.nan,
        velocity=None,
        acceleration=None,
        jerk=None,
        _point=point,  # type: ignore[arg-type]
    )
    whole = linkage.motion(36, input=circuit.columns[circuit.input_column])
    return replace(
        whole, circuits=(rows,), law=_as_law(found), speed=math.nan, samples=count, speed_written=""
    )
