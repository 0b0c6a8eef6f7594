"""Ranges of joints, cones of balls and distances of links along a circuit, exact: where their rates are zero.

Source: docs/theory_measures.md, (12) to (15).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, triple
from sevenbar.curves.curve import Peak
from sevenbar.curves.least_cone import least_cone
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.extents import BallCone, Clearance, JointRange
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.stops import Cone
from sevenbar.kinematics.ranges.ball_angle import BallAngle, ball_angle, joint_at, rod, sides
from sevenbar.kinematics.ranges.joint_course import JointCourse, joint_course

#: Sine of the angle between a given direction of an idle link and its rod that is more than rounding.
OFF_THE_ROD = 1e-9

Side = Literal["seat", "stud"]


def joint_ranges(linkage: Solvable, circuit: Circuit) -> dict[str, JointRange]:
    """The range of every column but a ball's, by name; see `Circuit.joint_ranges`."""
    course = joint_course(linkage, circuit)
    return {
        column.name: range_of(course, column.number) for column in linkage.each_column if column.is_output
    }


def range_of(course: JointCourse, column: int) -> JointRange:
    """The range of one column."""
    own = course.linkage.each_column[column]
    if course.goes_on(column):
        return JointRange(own.name, own.turns, None, None)
    (_, low), (_, high) = course.extremes(course.path.poses.part(column))
    return JointRange(own.name, own.turns, low, high)


def coned(linkage: Solvable) -> list[str]:
    """The joints whose bend means something: all S and U, but next to links that spin together."""
    spins = linkage.held.spins if any(joint.row.bends for joint in linkage.joints) else 0
    return [] if spins else [joint.name for joint in linkage.joints if joint.row.bends]


def ball_cones(linkage: Solvable, circuit: Circuit) -> dict[str, BallCone]:
    """How far each ball and universal joint is bent, by name; see `Circuit.ball_cones`."""
    return {name: cone_of(linkage, circuit, name) for name in coned(linkage)}


def bends(linkage: Solvable, circuit: Circuit) -> dict[str, Floats]:
    """The bend [rad] of each ball and universal joint on the rows (n,) of a circuit; see `Circuit.bends`."""
    return {
        name: ball_angle(linkage, name, cone.seat, cone.stud).at(circuit.q)
        for name, cone in circuit.ball_cones.items()
    }


def cone_of(linkage: Solvable, circuit: Circuit, joint: str, given: Cone | None = None) -> BallCone:
    """How far one joint is bent, with directions given or those of the linkage's stops."""
    joint_at(linkage, joint)
    course = joint_course(linkage, circuit)
    cone = linkage.stops.cones.get(joint, Cone()) if given is None else given
    bend, free, known = chosen(linkage, joint, cone)
    curve = course.directions(bend, of_stud=free == "seat")
    best = least_cone(curve)
    place = joint_at(linkage, joint)
    seat, stud = sides(linkage, place)
    middle = triple("middle", (seat if free == "seat" else stud).T @ best.axis + 0.0)
    axis = (bend.seat if free == "seat" else bend.stud) if known else best.axis
    (_, least), (_, greatest) = course.bends(curve, axis)
    written = {
        "seat": triple("seat", seat.T @ bend.seat + 0.0),
        "stud": triple("stud", stud.T @ bend.stud + 0.0),
    }
    if not known:
        written[free] = middle
    return BallCone(
        joint, written["seat"], written["stud"], least, greatest, middle, free, best.angle, cone.angle
    )


def chosen(linkage: Solvable, joint: str, cone: Cone) -> tuple[BallAngle, Side, bool]:
    """The angle of a joint, the side whose direction may be chosen, and whether it is given.

    On an idle link only the direction of its rod has a bend that its spin does not change.
    """
    place = joint_at(linkage, joint)
    before, after = linkage.graph.between[place]
    if joint not in coned(linkage):
        raise RequestError(
            f"joint: {shown(joint)} is next to links that spin together, so its bend is not determined"
        )
    idle = linkage.idle_links
    for key, link, value in (("seat", before, cone.seat), ("stud", after, cone.stud)):
        if value is None or link not in idle:
            continue
        along = rod(linkage, link, place)
        if np.linalg.norm(np.cross(value, along)) > OFF_THE_ROD * np.linalg.norm(value):
            raise RequestError(
                f"{key}: {shown(list(value))} of {joint} is not along link {link}, which spins idly about "
                f"its line; leave {key} out, or give {[round(float(x), 6) for x in along]}"
            )
    free: Side = "stud" if before in idle and after not in idle else "seat"
    known = (cone.seat if free == "seat" else cone.stud) is not None
    return ball_angle(linkage, joint, cone.seat, cone.stud), free, known


def rod_pairs(linkage: Loop) -> Iterator[tuple[int, int]]:
    """Links that share no joint, two by two; the ground only where it has a radius."""
    graph = linkage.graph
    for first, second in combinations(
        graph.links if graph.ground in linkage.stops.radii else graph.moving, 2
    ):
        if second not in graph.neighbours(first):
            yield first, second


def clearances(linkage: Solvable, circuit: Circuit) -> tuple[Clearance, ...]:
    """The least distance of every two links that share no joint; see `Circuit.clearances`."""
    return tuple(clearance_of(linkage, circuit, *pair) for pair in rod_pairs(linkage))


def clearance_of(linkage: Solvable, circuit: Circuit, first: int, second: int) -> Clearance:
    """The least distance of two links."""
    course = joint_course(linkage, circuit)
    place, value, missed = course.rods(first, second).least()
    radii = linkage.stops.radii
    return Clearance(
        (first, second),
        Peak(value, course.input_at(place)),
        radii.get(first, 0.0) + radii.get(second, 0.0),
        missed,
    )
