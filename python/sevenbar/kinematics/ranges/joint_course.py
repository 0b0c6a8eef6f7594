"""Joint values, places and directions along a circuit by its own length, as polynomials."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.along import Along
from sevenbar.curves.curve import Peak
from sevenbar.curves.least_cone import angles, dotted
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import joint_frames, opening, poses
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.loop.rods import RodPair
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.paths.circuit_path import CircuitPath, NotFollowedError
from sevenbar.kinematics.paths.covered_path import closed_on, covered_path, curve_on, rows_on
from sevenbar.kinematics.ranges.ball_angle import BallAngle

#: Poses that miss the ground by more [relative to the size] are lost ones.
CLOSED = 1e-8

#: A column that comes back by less of a turn, or of the size, does not go on and on.
GOES_ON = 1e-6

#: Angles, or shares of a size, that differ by less are one: of these the first place counts.
ALIKE = 1e-12


@dataclass(frozen=True, eq=False)
class JointCourse:
    """A circuit's joints along its path.

    `size` [length] is that of the circuit, `start` [rad, or length] the input of its first row, from which on
    it moves `forwards`, or backwards.
    """

    linkage: Solvable
    numbers: Numbers
    path: CircuitPath
    size: float
    start: float
    forwards: bool

    @cached_property
    def rows(self) -> Floats:
        """Rows of an analysis at the nodes of the path's pieces (m * terms, columns)."""
        return rows_on(self.path, self.numbers)[1]

    def curve(self, values: Floats) -> Along:
        """Quantities along the path by their values (m * terms, k) at the nodes."""
        return curve_on(self.path, values)

    @cached_property
    def _places(self) -> Floats:
        """The places (m * terms, joints, 2, 3) of the joints on the links before and after them."""
        linkage = self.linkage
        frames = poses(linkage, self.rows)
        off = opening(linkage, frames, self.rows)
        off[:, :3, 3] /= self.size
        if not off.max() < CLOSED:
            raise NotFollowedError("circuit: the turns of its balls cannot be followed all along it")
        return np.stack([side[:, :, :3, 3] for side in joint_frames(linkage, frames)], axis=2)

    def rods(self, first: int, second: int) -> RodPair:
        """Two links, counted from 1, the ground last, as lines between the places of their joints."""
        graph = self.linkage.graph
        ends = [
            self._places[:, joint, graph.side(joint, link)]
            for link in (first, second)
            for joint in graph.joints_of(link)
        ]
        return RodPair(self.curve(np.concatenate(ends, axis=1)), self.size)

    def directions(self, bend: BallAngle, *, of_stud: bool) -> Along:
        """The stud's direction seen from the frame before a joint; or the seat's from that after it."""
        if of_stud:
            return self.curve(bend.studs(self.rows))
        return self.curve(np.einsum("nji,j->ni", bend.rotation(self.rows), bend.seat))

    def goes_on(self, column: int) -> bool:
        """Whether a column has turned whole turns, or run on, when the circuit closes."""
        return bool(abs(self.path.gain[column]) > GOES_ON * self.numbers.scales[column])

    def pose(self, s: float) -> tuple[Floats, int]:
        """The pose of the word (1, columns) at a place, and the column that drives its piece."""
        edges = self.path.poses.edges
        pieces = np.clip(np.searchsorted(edges, [s], "right") - 1, 0, len(self.path.drivers) - 1)
        place = np.array([s])
        return closed_on(self.path, self.numbers, pieces, place), int(self.path.drivers[pieces[0]])

    def input_at(self, s: float) -> float:
        """The input [rad, or length] at a place, on the lap that the circuit's rows begin."""
        value = float(self.path.poses.part(self.path.input).at(np.array([s]))[0, 0])
        gain = float(self.path.gain[self.path.input])
        if gain:
            lap, way = abs(gain), 1.0 if self.forwards else -1.0
            ahead = way * (value - self.start) % lap
            # rounding before the start is the start
            value = self.start + way * (0.0 if lap - ahead < ALIKE * lap else ahead)
        return value

    def extremes(self, one: Along) -> tuple[tuple[float, Peak], tuple[float, Peak]]:
        """The lowest and the highest value of a single quantity, each with its place on the path."""
        places = np.concatenate([[0.0], one.stationary(0), [self.path.length]])
        values = one.at(places)[:, 0]
        alike = ALIKE * max(1.0, float(np.abs(values).max()))
        result = []
        for best in (values.min(), values.max()):
            # of places alike up to rounding the one at the lowest input
            same = places[np.abs(values - best) <= alike]
            inputs = [self.input_at(float(s)) for s in same]
            first = int(np.argmin(inputs))
            result.append((float(same[first]), Peak(float(best), inputs[first])))
        return result[0], result[1]

    def bends(self, curve: Along, axis: Floats) -> tuple[tuple[float, Peak], tuple[float, Peak]]:
        """The least and the greatest angle [rad] of a curve of directions from an axis, with their places."""
        (far, low), (near, high) = self.extremes(dotted(curve, axis))
        least, greatest = angles(curve.at(np.array([near, far])), axis)
        return (near, Peak(float(least), high.input)), (far, Peak(float(greatest), low.input))


@once_for(1)
def joint_course(linkage: Solvable, circuit: Circuit) -> JointCourse:
    """The course of a circuit's joints, made once; raises `RequestError` where it cannot be followed."""
    numbers = Numbers(linkage)
    path = covered_path(linkage, circuit, numbers)
    inputs = circuit.fleeting().input
    start = float(inputs[np.isfinite(inputs)][0]) if np.isfinite(inputs).any() else 0.0
    return JointCourse(linkage, numbers, path, circuit.size, start, not circuit.speed < 0)
