"""Free motion and equilibria of a circuit: the path, what acts along it, and the state at any time.

Source: docs/theory_free.md, (1) to (15).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Words, finite_array, finite_number, truth, whole_number
from sevenbar.errors import RequestError, shown
from sevenbar.forces.free_motion.conservative import BALANCED
from sevenbar.forces.free_motion.course import DAMPING, INPUT, MASS, EnergyCourse
from sevenbar.forces.free_motion.driven import COARSE, TOLERANCE, Motor, force_at
from sevenbar.forces.free_motion.equilibria import Equilibrium, Resting, resting_places
from sevenbar.forces.free_motion.result import FreeMotion, FreeStates, Impact, TurningPoint
from sevenbar.forces.free_motion.stages import Stages, Walls, elastic, staged, stepped, without_losses
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.dynamics.free_course import FreeCourse
from sevenbar.kinematics.loop.columns import joint_columns
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.paths.stretch import StopStretch
from sevenbar.text.amounts import amount_in
from sevenbar.text.units import LENGTHS

#: A torque: a number, a table of speeds and torques, or a function of the speed.
Torque = float | tuple[npt.ArrayLike, npt.ArrayLike] | Callable[[float], float]

#: Damping below this part of the mass in a second is none.
UNDAMPED = 1e-15

#: Courses live as long as their circuits.
_COURSES: WeakKeyDictionary[Circuit, list[tuple[object, FreeCourse]]] = WeakKeyDictionary()


def course_of(
    linkage: Solvable, circuit: Circuit, loading: Loading, stretches: tuple[StopStretch, ...] | None = None
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
    stretches: tuple[StopStretch, ...] | None = None,
) -> tuple[Equilibrium, ...]:
    """All equilibria of a circuit within its stops; see `Circuit.equilibria`."""
    course = course_of(linkage, circuit, loading, stretches)
    energy = course.energy.driven_by(finite_number("torque", torque))
    if stretches is None or any(one.is_whole for one in stretches):
        begin = course.home if energy.winds else 0.0
        result = []
        for place, kind, frequency, rate, end in resting_places(energy, begin):
            off = 0.0 if energy.winds else course.on_rows_lap(place) - place
            result.append(_equilibrium(course, energy, (place + off, kind, frequency, rate, end + off)))
        return tuple(result)
    result = []
    for one in stretches:
        own, begin = course.cut(energy, course.laid(one))
        inner = [_equilibrium(course, own, each, begin=begin) for each in resting_places(own)]
        first, last = (
            [_on_stop(course, own, begin, place, stop, None, 0.0)]
            if stop and way * force_at(own, place, np.zeros(1), None)[0] > BALANCED * energy.steepest
            else []
            for place, stop, way in ((0.0, one.first_stop, -1), (own.length, one.last_stop, 1))
        )
        result += [*first, *inner, *last]
    return tuple(result)


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
    result = _equilibrium(course, energy, (place, "on its stop", none, none, none), begin=begin)
    return replace(result, stop=stop, holding=holding, holding_unit=unit)


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
    stretches: tuple[StopStretch, ...] | None = None,
) -> FreeMotion:
    """A free motion; see `Circuit.free_motion`."""
    seconds = time_of("duration", duration)
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


def _restitution(given: float | None, stretches: tuple[StopStretch, ...] | None) -> float:
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


def _impacts(course: FreeCourse, begin: float, result: Stages) -> tuple[Impact, ...]:
    """The stops that are met, by the input."""
    if not result.met:
        return ()
    places = np.array([begin + one.place for one in result.met])
    rates = np.array([one.rate for one in result.met])
    none = np.zeros(len(rates))
    q, dq, *_ = course.rows.at(places, (rates, none, none))
    column = course.path.input
    return tuple(
        Impact(one.time, one.stop, float(value), float(speed))
        for one, value, speed in zip(result.met, q[:, column], dq[:, column], strict=True)
    )


def time_of(name: str, duration: float | str) -> float:
    """A time [s] from a number or a text with a unit, or `RequestError`."""
    value = amount_in(duration, "s") if isinstance(duration, str) else finite_number(name, duration)
    if value is None or value <= 0:
        raise RequestError(f"{name}: {shown(duration)} is not a time; give one > 0, as in 10, 10s or 500ms")
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
        return 0.0, Motor(function=lambda speed: finite_number("torque: at a speed", asked(speed * unit)))
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


def _as_law(result: FreeMotion) -> Law:
    """The input over time, rows past the end left out."""
    column, rows = result.input_column, np.isfinite(result.input)
    value, rate, second, third = (
        part[rows, column] for part in (result.q, result.dq, result.ddq, result.dddq)
    )
    return Law.of(result.time[rows], value, rate, second, third if np.isfinite(third).all() else 0.0)


def _as_table(linkage: Solvable, result: FreeMotion, si: bool) -> dict[str, npt.NDArray[Any]]:
    """Columns by names that end in their units."""
    si = truth("si", si)
    length, angle = ("m", "rad") if si else (result.length_unit, "deg")
    scale = LENGTHS[result.length_unit] if si else 1.0
    rates = (result.q, result.dq, result.ddq)
    joints = joint_columns(linkage, rates, length=length, angle=angle, scale=scale)
    return {"time_s": result.time, **joints, "kinetic_J": result.kinetic, "potential_J": result.potential}


def _as_motion(
    course: FreeCourse,
    state: Stages,
    motor: Motor | None,
    own: EnergyCourse,
    begin: float,
    result: FreeMotion,
) -> Motion:
    """A motion whose one circuit has the rows of a free motion."""
    circuit, linkage = course.circuit, course.linkage
    place, rates, *_ = _rates(own, state, motor, result.time)
    place = begin + place
    count = len(result.time)
    status: Words = np.where(np.isfinite(place), "ok", "no-solution").astype("<U15")
    status[(status == "ok") & np.isnan(result.q).any(axis=1)] = "turns-undefined"

    def point(link: int, at: Floats) -> object:
        return course.rows.trace(place, rates, status, link, at)

    rows = replace(
        circuit,
        q=result.q,
        dq=result.dq,
        ddq=result.ddq,
        dddq=result.dddq,
        time=result.time,
        status=status,
        branch=np.zeros(count, dtype=np.int64),
        mode=np.full(count, int(circuit.mode[0]) if len(circuit.mode) else 0),
        residual=np.zeros(count),
        condition=np.full(count, np.nan),
        speed=math.nan,
        _velocity=None,
        acceleration=None,
        jerk=None,
        _point=point,  # type: ignore[arg-type]
    )
    whole = linkage.motion(36, input=circuit.columns[circuit.input_column])
    return replace(
        whole, circuits=(rows,), law=_as_law(result), speed=math.nan, samples=count, speed_written=""
    )
