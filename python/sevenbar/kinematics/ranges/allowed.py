"""What part of a circuit lies within the stops of its linkage, and which stop ends each part."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.curves.least_cone import angles, dotted, least_cone
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.extents import Allowed, AllowedSpan, Flags
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import joint_places, poses_along
from sevenbar.kinematics.loop.column import Column
from sevenbar.kinematics.loop.rods import rod_distance
from sevenbar.kinematics.loop.stops import Cone
from sevenbar.kinematics.paths.circuit_path import CircuitPath
from sevenbar.kinematics.paths.stretch import RANGE_OF, StopStretch
from sevenbar.kinematics.ranges.circuit_extents import chosen, rod_pairs
from sevenbar.kinematics.ranges.joint_course import JointCourse, joint_course

#: A pose beyond a stop by less [rad, or relative to the size] touches it.
TOUCH = 1e-11

#: Places nearer to each other than this part of the circuit are one.
SAME = 1e-12

#: The same of zeros that are found from two pieces of a path, each up to its end and a little beyond.
SEAM = 1e-9


@dataclass(frozen=True, eq=False)
class _Stop:
    """A stop along a circuit: where it is passed, and whether places on the path, or rows, are within it."""

    name: str
    crossings: Floats
    within: Callable[[Floats], Flags]
    rows: Callable[[Floats], Flags]


def allowed(linkage: Solvable, circuit: Circuit) -> Allowed:
    """The parts of a circuit within its linkage's stops; see `Circuit.allowed`."""
    known: Flags = np.asarray(np.isfinite(circuit.q).any(axis=1))
    if not linkage.stops.stops:
        start, end = _ends(circuit)
        whole = (AllowedSpan(start, end, "", "", 1.0, _back(circuit)),)
        return Allowed(whole, known, np.full(len(known), "", dtype="<U1"))
    course = joint_course(linkage, circuit)
    stops = _stops(linkage, circuit, course)
    inside = np.array([stop.rows(circuit.q) | ~known for stop in stops]).reshape(len(stops), len(known))
    stopped = np.array([_passed(stops, row) for row in inside.T], dtype=np.str_)
    return Allowed(tuple(_spans(course, circuit, stops)), known & inside.all(axis=0), stopped)


def _passed(stops: list[_Stop], inside: Flags) -> str:
    """The names of the stops that a place or row is not within."""
    return ", ".join(stop.name for stop, own in zip(stops, inside, strict=True) if not own)


def _ends(circuit: Circuit) -> tuple[float, float]:
    """The input at the first row, and where the circuit ends."""
    inputs = circuit.input[np.isfinite(circuit.input)]
    if not inputs.size:
        return math.nan, math.nan
    if circuit.closed:
        gain = circuit.turns * math.tau if circuit.input_turns else 0.0
        return float(inputs[0]), float(inputs[0]) + math.copysign(gain, circuit.speed)
    return float(inputs[0]), float(inputs[-1])


def _back(circuit: Circuit) -> int:
    return sum(centre.kind == "input" for centre in circuit.dead_centres)


def stretches(linkage: Solvable, circuit: Circuit) -> tuple[StopStretch, ...]:
    """The parts of a circuit's path within all stops, in order; all of it where nothing stops it."""
    course = joint_course(linkage, circuit)
    return tuple(_stretches(course, _stops(linkage, circuit, course)))


def _stops(linkage: Solvable, circuit: Circuit, course: JointCourse) -> list[_Stop]:
    return [*_ranges(linkage, course), *_cones(linkage, course), *_rods(linkage, circuit, course)]


def _stretches(course: JointCourse, stops: list[_Stop]) -> Iterator[StopStretch]:
    length, closed = course.path.length, course.path.closed
    marks = np.unique(np.concatenate([[0.0, length], *(stop.crossings for stop in stops)]))
    marks = marks[np.append(np.diff(marks) > SAME * length, True)]
    middles = (marks[:-1] + marks[1:]) / 2
    inside = np.array([stop.within(middles) for stop in stops]).reshape(len(stops), len(middles))
    free: Flags = np.asarray(inside.all(axis=0))
    if free.all():
        yield StopStretch(0.0, length, "", "")
        return
    count = len(middles)
    # of a closed circuit the stretches go on over its end
    first = int(np.argmin(free)) if closed else 0
    run = list[int]()
    for stretch in [*((first + k) % count for k in range(count)), None]:
        if stretch is not None and free[stretch]:
            run.append(stretch)
            continue
        if run:
            before, after = run[0] - 1, run[-1] + 1
            begin = float(marks[run[0]])
            yield StopStretch(
                begin,
                begin + float(sum(marks[k + 1] - marks[k] for k in run)),
                _passed(stops, inside[:, before % count]) if closed or before >= 0 else "",
                _passed(stops, inside[:, after % count]) if closed or after < count else "",
            )
        run = []


def _spans(course: JointCourse, circuit: Circuit, stops: list[_Stop]) -> Iterator[AllowedSpan]:
    path = course.path
    back = path.poses.stationary(path.input) if circuit.turns_back else np.empty(0)
    for one in _stretches(course, stops):
        if one.is_whole:
            yield AllowedSpan(*_ends(circuit), "", "", 1.0, _back(circuit))
            return
        way = one.end - one.begin
        # the end of a path is its seam only where another piece begins there
        end = one.end - path.length if path.closed and one.end > path.length else one.end
        yield AllowedSpan(
            course.input_at(one.begin),
            course.input_at(end),
            one.first_stop,
            one.last_stop,
            way / path.length,
            _between(back, one.begin, way, path),
        )


def _between(places: Floats, begin: float, way: float, path: CircuitPath) -> int:
    """How many of some places lie on the way from one place of a path; one at the seam counts once."""
    ahead = np.sort((places - begin) % path.length if path.closed else places - begin)
    one = SEAM * path.length
    return int(((ahead > one) & (ahead < way - one) & (np.diff(ahead, prepend=-np.inf) > one)).sum())


def _ranges(linkage: Solvable, course: JointCourse) -> Iterator[_Stop]:
    for name, (low, high) in linkage.stops.ranges.items():
        column = linkage.column_of(name)
        slack = TOUCH * (1.0 if column.turns else course.size)
        if not (column.turns and high - low >= math.tau - slack):
            yield _range(course, column, low, high, slack)


def _range(course: JointCourse, column: Column, low: float, high: float, slack: float) -> _Stop:
    """The stop of a column that a turn does not pass by; beyond an end by a `slack` it touches."""
    turns, width = column.turns, high - low
    one = course.path.poses.part(column.number)
    marks = np.union1d(one.stationary(0), one.edges)
    heights = one.at(marks)[:, 0]
    laps = [0]
    if turns:
        first, last = (heights.min() - high) / math.tau, (heights.max() - low) / math.tau
        laps = list(range(math.floor(first), math.ceil(last) + 1))
    values = [end + math.tau * k for k in laps for end in (low, high)]

    def between(values: Floats) -> Flags:
        """Whether values are between the ends, a turn by whole turns."""
        beyond = values - low
        if turns:
            spare = (math.tau - width) / 2
            beyond = (beyond + spare) % math.tau - spare
        return np.asarray((beyond >= -slack) & (beyond <= width + slack))

    return _Stop(
        f"{RANGE_OF}{column.name}",
        np.concatenate([one.crossings(0, value, marks) for value in values]),
        lambda s: between(one.at(s)[:, 0]),
        lambda q: between(q[:, column.number]),
    )


def _cones(linkage: Solvable, course: JointCourse) -> Iterator[_Stop]:
    for joint, cone in linkage.stops.cones.items():
        if cone.angle is not None:
            yield _cone(linkage, course, joint, cone, cone.angle)


def _cone(linkage: Solvable, course: JointCourse, joint: str, cone: Cone, limit: float) -> _Stop:
    """The stop of a ball or universal joint."""
    bend, free, known = chosen(linkage, joint, cone)
    curve = course.directions(bend, of_stud=free == "seat")
    axis = (bend.seat if free == "seat" else bend.stud) if known else least_cone(curve).axis
    seated = replace(bend, seat=axis) if free == "seat" else replace(bend, stud=axis)
    height = dotted(curve, axis)
    marks = np.union1d(height.stationary(0), height.edges)
    return _Stop(
        f"cone of {joint}",
        height.crossings(0, math.cos(limit), marks),
        lambda s: angles(curve.at(s), axis) <= limit + TOUCH,
        lambda q: seated.at(q) <= limit + TOUCH,
    )


def _rods(linkage: Solvable, circuit: Circuit, course: JointCourse) -> Iterator[_Stop]:
    radii = linkage.stops.radii
    for first, second in rod_pairs(linkage):
        thick = radii.get(first, 0.0) + radii.get(second, 0.0)
        if thick > 0:
            yield _rod_pair(course, circuit, (first, second), thick - TOUCH * course.size)


def _rod_pair(course: JointCourse, circuit: Circuit, links: tuple[int, int], least: float) -> _Stop:
    """The stop of two links that come nearer to each other than their radii."""
    first, second = links
    pair = course.rods(first, second)
    return _Stop(
        f"links {first} and {second}",
        pair.reaches(least),
        lambda s: pair.distance(s) >= least,
        lambda _: distances(course.linkage, circuit, links) >= least,
    )


def distances(linkage: Solvable, circuit: Circuit, links: tuple[int, int]) -> Floats:
    """The distances (n,) [length] of two links as rods on the rows of a circuit."""
    rows: Integers = np.arange(len(circuit.q))
    frames = poses_along(linkage, circuit, rows)
    return rod_distance(*(place for link in links for place in joint_places(linkage, frames, link)))
