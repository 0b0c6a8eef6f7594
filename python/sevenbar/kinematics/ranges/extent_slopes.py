"""Derivatives of joint ranges, bends of balls and distances of links by the numbers of a description.

An extreme over a circuit changes with a number as the quantity itself does at its place (the envelope
theorem), with any joint held that moves there: not the input where that stands still. The smallest cone
touches a curve of directions at places k, at each of which the angle from its axis is the cone's; with the
multipliers of that optimum, `sum m_k grad_u angle_k = 0`, `m_k >= 0`, `sum m_k = 1`,

    d cone / dp = sum m_k  d angle_k / dp,      the axis u held                                           (16)

Source: docs/theory_measures.md, (16).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.along import Along
from sevenbar.curves.least_cone import angles, least_cone
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.rods import distance_slopes
from sevenbar.kinematics.loop.stops import Cone
from sevenbar.kinematics.numbers.gradients import MeasureSlopes
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.numbers.word import Carried
from sevenbar.kinematics.ranges.ball_angle import KINK, joint_at, line_angles, sides
from sevenbar.kinematics.ranges.circuit_extents import chosen, rod_pairs
from sevenbar.kinematics.ranges.joint_course import JointCourse, joint_course

#: Places at which a curve that runs on a cone is [rad] on it.
EVEN, ON_CONE = 17, 1e-9

#: What multipliers may leave of a gradient that they should bring to zero.
BALANCED = 1e-6

#: A distance below this part of the size is that of rods that cross, which has no derivative.
CROSSED = 1e-9


def extent_slopes(
    numbers: Numbers, circuit: Circuit, wanted: Sequence[str] | None = None
) -> Iterator[MeasureSlopes]:
    """The measures `range:JOINT`, `ball_angle:JOINT` and `clearance` that are `wanted`, with derivatives.

    Without a word those of the linkage's stops. How much of a circuit is usable has none.
    """
    linkage = numbers.linkage
    names = stopped_measures(numbers) if wanted is None else list(wanted)
    if not names:
        return
    course = joint_course(linkage, circuit)
    for name in names:
        kind, _, joint = name.partition(":")
        if kind == "range":
            result = _of_range(course, numbers, name, linkage.column(joint, "measure"))
        elif kind == "ball_angle":
            result = _of_bend(course, numbers, name, joint)
        else:
            result = _of_clearance(course, numbers, name) if name == "clearance" else None
        if result is not None:
            result.slopes[numbers.loop(circuit.input_column).opening(circuit)] = np.nan
            yield result


def stopped_measures(numbers: Numbers) -> list[str]:
    """The measures of what the stops of a linkage are about."""
    stops = numbers.linkage.stops
    return [
        *(f"range:{name}" for name in stops.ranges),
        *(f"ball_angle:{name}" for name in stops.cones),
        *(["clearance"] if stops.radii else []),
    ]


def _of_range(course: JointCourse, numbers: Numbers, name: str, column: int) -> MeasureSlopes | None:
    if course.goes_on(column):
        return None
    ends = course.extremes(course.path.poses.part(column))
    slopes = []
    for place, _ in ends:
        q, driver = course.pose(place)
        slopes.append(numbers.loop(driver).slopes(q, 0).by_number[0, 0, :, column])
    unit, scale = numbers.linkage.column_of(column).shown
    value = ends[1][1].value - ends[0][1].value
    return MeasureSlopes(name, unit, value * scale, (slopes[1] - slopes[0]) * scale, 1 / scale)


def _of_bend(course: JointCourse, numbers: Numbers, name: str, joint: str) -> MeasureSlopes:
    linkage = course.linkage
    cone = linkage.stops.cones.get(joint, Cone())
    bend, free, known = chosen(linkage, joint, cone)
    curve = course.directions(bend, of_stud=free == "seat")
    axis = bend.seat if free == "seat" else bend.stud
    if known:
        (_, _), (place, greatest) = course.bends(curve, axis)
        value, places = greatest.value, np.array([place])
        shares: Floats | None = np.ones(1)
    else:
        best = least_cone(curve)
        axis, value, places = best.axis, best.angle, best.places
        shares = None if _is_circle(curve, axis, value) else _multipliers(curve.at(places), axis)
    given: dict[str, tuple[float, ...] | None] = {"seat": cone.seat, "stud": cone.stud}
    if not known:
        turn = sides(linkage, joint_at(linkage, joint))[0 if free == "seat" else 1]
        given[free] = tuple(turn.T @ axis)
    points = _arms(numbers, joint_at(linkage, joint), given)
    total = np.full(len(numbers.names), np.nan if shares is None else 0.0)
    for place, share in [] if shares is None else zip(places, shares, strict=True):
        if share:
            _, slopes = line_angles(*_places_at(course, numbers, float(place), points))
            total = total + share * slopes[0]
    scale = math.degrees(1.0)
    return MeasureSlopes(name, "deg", value * scale, total * scale, 1 / scale)


def _is_circle(curve: Along, axis: Floats, angle: float) -> bool:
    """Whether a curve runs on its cone, which then has a kink: any change of it moves other places out."""
    even = np.linspace(curve.edges[0], curve.edges[-1], EVEN)
    return bool(np.abs(angles(curve.at(even), axis) - angle).max() < ON_CONE)


def _multipliers(directions: Floats, axis: Floats) -> Floats | None:
    """The multipliers (k,) of the places that hold a smallest cone; `None` where they are not found."""
    from scipy.optimize import nnls

    cosines = directions @ axis
    sines = np.sqrt(np.maximum(1 - cosines**2, 0.0))
    if (sines < KINK).any():
        return None
    ways = (directions - cosines[:, None] * axis) / sines[:, None]
    result, rest = nnls(np.vstack([ways.T, np.ones(len(ways))]), np.array([0.0, 0.0, 0.0, 1.0]))
    return result if rest < BALANCED else None


def _arms(numbers: Numbers, place: int, given: Mapping[str, tuple[float, ...] | None]) -> list[Carried]:
    """Two points on the seat's line and two on the stud's, each line by its direction, or along its rod."""
    points = []
    for side, link in zip(("seat", "stud"), numbers.linkage.graph.between[place], strict=True):
        direction = given[side]
        if direction is None:
            start, end = numbers.word.rod(link)
            points += [start, end] if side == "stud" else [end, start]
        else:
            x, y, z = (numbers.size * value / math.hypot(*direction) for value in direction)
            points += [numbers.word.place(link, at) for at in ((0.0, 0.0, 0.0), (x, y, z))]
    return points


def _places_at(
    course: JointCourse, numbers: Numbers, place: float, points: Sequence[Carried]
) -> tuple[Floats, Floats]:
    """Where points are at a place on the path (1, points, 3), and their slopes (1, points, 3, k)."""
    q, driver = course.pose(place)
    here, own = numbers.loop(driver, extra=points).slopes(q, 0), slice(-len(points), None)
    return here.points[:, own, 0], here.points_by_number[:, own, 0].swapaxes(2, 3)


def _of_clearance(course: JointCourse, numbers: Numbers, name: str) -> MeasureSlopes | None:
    """The least gap of all pairs of links, of those with a radius where there are any."""
    linkage, radii = course.linkage, course.linkage.stops.radii
    pairs = list(rod_pairs(linkage))
    thick = {pair: sum(radii.get(link, 0.0) for link in pair) for pair in pairs}
    pairs = [pair for pair in pairs if thick[pair]] or pairs
    if not pairs:
        return None
    least = {pair: course.rods(*pair).least() for pair in pairs}
    pair = min(pairs, key=lambda one: least[one][1] - thick[one])
    place, distance, _ = least[pair]
    slopes = np.full(len(numbers.names), np.nan)
    if distance > CROSSED * course.size:
        points = [point for link in pair for point in numbers.word.rod(link)]
        slopes = distance_slopes(*_places_at(course, numbers, place, points))[1][0]
    return MeasureSlopes(name, linkage.length_unit, distance - thick[pair], slopes)
