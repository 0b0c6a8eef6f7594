"""Free motion and equilibria of a circuit: the path, what acts along it, and the state at any time.

Source: docs/theory_free.md, (1) to (13).
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

from sevenbar.arrays import Floats, Words, finite_array, finite_number, truth, whole_number
from sevenbar.errors import RequestError, shown
from sevenbar.forces.free_motion.conservative import conservative
from sevenbar.forces.free_motion.course import DAMPING, INPUT, MASS, MASSLESS_WAY, EnergyCourse
from sevenbar.forces.free_motion.driven import COARSE, TOLERANCE, Motor, driven
from sevenbar.forces.free_motion.equilibria import Equilibrium, resting_places
from sevenbar.forces.free_motion.result import FreeMotion, FreeStates, TurningPoint
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.dynamics.energy_path import EnergyBuilder
from sevenbar.kinematics.dynamics.forces import STILL, ForceSolver
from sevenbar.kinematics.dynamics.free_rows import CourseRows
from sevenbar.kinematics.loop.columns import joint_columns
from sevenbar.kinematics.loop.joint_text import joint_number, joint_speed
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.paths.circuit_path import CircuitPath
from sevenbar.kinematics.paths.covered_path import covered_path
from sevenbar.text.amounts import amount_in
from sevenbar.text.units import LENGTHS

#: A torque: a number, a table of speeds and torques, or a function of the speed.
Torque = float | tuple[npt.ArrayLike, npt.ArrayLike] | Callable[[float], float]

#: Damping below this part of the mass in a second is none.
UNDAMPED = 1e-15

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

    @property
    def turns(self) -> bool:
        """Whether the input is an angle."""
        return self.linkage.turns(self.path.input)

    @property
    def first_row(self) -> int:
        """The circuit's first row that has a pose."""
        return int(np.flatnonzero(np.isfinite(self.circuit.q).all(axis=1))[0])

    def start(self, value: float | str | None, branch: int | None) -> float:
        """The place of a start: an input [rad, or length], on a pass between dead centres of the input."""
        if value is None and branch is None:
            return self._on_lap(self._first, float(self.circuit.q[self.first_row, self.path.input]))
        if value is None:
            raise RequestError("start: is missing; give the input at which the pass `branch` is entered")
        number = joint_number("start", value, self.linkage, self.path.input)
        if self.turns and abs(number) > FARTHEST:
            raise RequestError(f"start: {number:.6g} rad is lost in its turns; give an angle of fewer")
        places = self.path.places(number, turns=self.turns)
        if not places.size:
            unit = self.linkage.length_unit
            place = f"{math.degrees(number):.9g} deg" if self.turns else f"{number:.9g} {unit}"
            raise RequestError(f"start: the circuit has no pose at {place}; see its input_range")
        first = self._first
        ordered = places[np.argsort((places - first + 1e-9 * self.path.length) % self.path.length)]
        if branch is None:
            return self._on_lap(float(ordered[0]), number)
        if (
            isinstance(branch, bool)
            or not isinstance(branch, (int, np.integer))
            or not 0 <= branch < len(ordered)
        ):
            raise RequestError(
                f"branch: {shown(branch)} is not offered; {len(ordered)} poses have this start, "
                f"give 0 to {len(ordered) - 1}"
            )
        return self._on_lap(float(ordered[branch]), number)

    def _on_lap(self, place: float, value: float) -> float:
        """A place on the lap where the input has a value, not one by whole turns away."""
        gain = float(self.path.gain[self.path.input])
        if not gain:
            return place
        own = float(self.path.poses.part(self.path.input).at(np.array([place]))[0, 0])
        return place + round((value - own) / gain) * self.path.length

    @cached_property
    def _first(self) -> float:
        """The place of that row."""
        circuit, path, row = self.circuit, self.path, self.first_row
        value = float(circuit.q[row, path.input])
        places = path.places(value, turns=self.turns)
        if not places.size:
            return 0.0
        smooth = ~self.solver.numbers.is_ball
        here = self.solver.numbers.poses(circuit.q[row : row + 1])[0]
        off = path.poses.at(places)[:, smooth] - here[smooth]
        turning = self.solver.numbers.turns[smooth]
        off[:, turning] -= math.tau * np.round(off[:, turning] / math.tau)
        return float(places[np.linalg.norm(off / self.solver.numbers.scales[smooth], axis=1).argmin()])

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


#: Courses live as long as their circuits.
_COURSES: WeakKeyDictionary[Circuit, list[tuple[object, FreeCourse]]] = WeakKeyDictionary()


def course_of(linkage: Solvable, circuit: Circuit, loading: Loading) -> FreeCourse:
    """The course of a circuit under a loading, made once for each."""
    if not any(loading.bodies.values()):
        raise RequestError("bodies: nothing has a mass; give bodies, or write [[body]]")
    key = (loading.gravity, tuple(sorted(loading.bodies.items())), loading.loads, loading.springs)
    known = _COURSES.setdefault(circuit, [])
    for own, course in known:
        if own == key:
            return course
    course = FreeCourse(linkage, circuit, loading)
    if known:
        # the path is that of the circuit, whatever acts
        course.__dict__["path"] = known[0][1].path
    known.append((key, course))
    return course


def equilibria_of(
    linkage: Solvable, circuit: Circuit, loading: Loading, torque: float
) -> tuple[Equilibrium, ...]:
    """All equilibria of a circuit; see `Circuit.equilibria`."""
    course = course_of(linkage, circuit, loading)
    energy = course.energy.driven_by(finite_number("torque", torque))
    found = []
    begin = course.start(None, None) if energy.winds else 0.0
    gain = course.path.gain[course.path.input]
    first = float(circuit.q[course.first_row, course.path.input])
    for inside, kind, frequency, rate in resting_places(energy, begin):
        place = inside
        if gain and not energy.winds:
            # on the lap of the circuit's rows
            own = float(course.path.poses.at(np.array([inside]))[0, course.path.input])
            place -= math.floor((own - first) / gain + 1e-12) * course.path.length
        here, still = np.array([place]), (np.zeros(1),) * 3
        q = course.rows.at(here, still)[0][0]
        found.append(
            Equilibrium(
                float(q[course.path.input]), circuit.columns, q, kind, frequency, rate,
                float(energy.at(here)[2][0]), place,
            )
        )  # fmt: skip
    return tuple(found)


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
) -> FreeMotion:
    """A free motion; see `Circuit.free_motion`."""
    seconds = _seconds(duration)
    samples = whole_number("samples", samples, 2, None, "a number of rows")
    course = course_of(linkage, circuit, loading)
    constant, motor = _motor(torque, torque_by_time, course)
    own = course.energy.driven_by(constant)
    place = course.start(start, branch)
    rate = course.rate(place, speed, energy)
    times = np.linspace(0.0, seconds, samples)
    damped = own.quantities.reach[DAMPING] > UNDAMPED * own.quantities.reach[MASS]
    difference = math.nan
    period: float | None = None
    turns: tuple[float, ...] = ()
    if damped or motor is not None:
        solved, coarse = (driven(own, place, rate, seconds, motor, tol) for tol in (TOLERANCE, COARSE))
        kind = "ends" if solved.ended else "driven"
        difference = float(np.nanmax(np.abs(solved.at(times)[0] - coarse.at(times)[0])))
        state = solved.at
    else:
        found = conservative(own, place, rate, seconds)
        kind, period, turns, state = found.kind, found.period, found.turning, found.at
    states = partial(_states, course, own, state, motor)
    rows = states(times)
    still = (np.zeros(len(turns)),) * 3
    at_turns = course.rows.at(np.array(turns, dtype=np.float64), still)[0][:, course.path.input]
    heights = own.at(np.array(turns, dtype=np.float64))[2]
    error = math.nan
    if not (damped or motor is not None):
        total = rows.kinetic + rows.potential
        most = float(np.nanmax(rows.kinetic))
        error = float(np.nanmax(np.abs(total - total[0]))) / most if most else 0.0
    return FreeMotion(
        time=times,
        columns=circuit.columns,
        q=rows.q,
        dq=rows.dq,
        ddq=rows.ddq,
        dddq=rows.dddq,
        kinetic=rows.kinetic,
        potential=rows.potential,
        kind=kind,
        period=period,
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
        heading=linkage.heading,
        _states=states,
        _law=_as_law,
        _motion=partial(_as_motion, course, state, motor, own),
        _table=partial(_as_table, linkage),
    )


def _seconds(duration: float | str) -> float:
    value = amount_in(duration, "s") if isinstance(duration, str) else finite_number("duration", duration)
    if value is None or value <= 0:
        raise RequestError(f"duration: {shown(duration)} is not a time; give seconds > 0, as in 10 or '10s'")
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


State = Callable[[Floats], tuple[Floats, Floats]]


def _rates(
    own: EnergyCourse, state: State, motor: Motor | None, times: Floats
) -> tuple[Floats, tuple[Floats, Floats, Floats], Floats, Floats]:
    """Places, s', s'' and s''', kinetic and potential energy at times."""
    place, v = state(times)
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
        massless = own.is_massless(mass)
        a = np.where(massless, 0.0, force / mass)
        curvature = by[:, 1] + lap * by[:, 4]
        by_place = -(curvature + by[:, DAMPING] * v + second[:, MASS] * v**2 / 2 + a * by[:, MASS]) / mass
        by_speed = -(damping + by[:, MASS] * v) / mass
        j = np.where(massless, 0.0, by_place * v + by_speed * a)
        if motor is not None:
            j = np.full(v.shape, np.nan)
    kinetic = mass * v**2 / 2
    for part in (kinetic, potential, a, j):
        part[~known] = np.nan
    return place, (v, a, j), kinetic, potential


def _states(
    course: FreeCourse, own: EnergyCourse, state: State, motor: Motor | None, times: Floats
) -> FreeStates:
    place, rates, kinetic, potential = _rates(own, state, motor, times)
    q, dq, ddq, dddq = course.rows.at(place, rates)
    return FreeStates(q, dq, ddq, dddq, kinetic, potential, place, rates[0])


def _as_law(found: FreeMotion) -> Law:
    """The input over time, rows past the end left out."""
    column, rows = found.input_column, np.isfinite(found.input)
    value, rate, second, third = (part[rows, column] for part in (found.q, found.dq, found.ddq, found.dddq))
    return Law.of(found.time[rows], value, rate, second, third if np.isfinite(third).all() else 0.0)


def _as_table(linkage: Solvable, found: FreeMotion, si: bool) -> dict[str, npt.NDArray[Any]]:
    """Columns by names that end in their units."""
    si = truth("si", si)
    length, angle = ("m", "rad") if si else (found.length_unit, "deg")
    scale = LENGTHS[found.length_unit] if si else 1.0
    rates = (found.q, found.dq, found.ddq)
    joints = joint_columns(linkage, rates, length=length, angle=angle, scale=scale)
    return {"time_s": found.time, **joints, "kinetic_J": found.kinetic, "potential_J": found.potential}


def _as_motion(
    course: FreeCourse, state: State, motor: Motor | None, own: EnergyCourse, found: FreeMotion
) -> Motion:
    """A motion whose one circuit has the rows of a free motion."""
    circuit, linkage = course.circuit, course.linkage
    place, rates, *_ = _rates(own, state, motor, found.time)
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
