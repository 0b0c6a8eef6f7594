"""What is on view: a motion, one of its circuits, and the pose at a moment of that circuit's cycle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.drawing.skeleton import Skeleton, skeleton
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import along, at_row, poses
from sevenbar.kinematics.circuits.timed_walk import SAME_INPUT, TimedWalk
from sevenbar.kinematics.ranges.reach import drawn_row
from sevenbar.reporting.shown import value_text

#: What an angle may be beyond half a turn by rounding [rad].
ROUNDED = 1e-8
#: Poses so much more unlike at the same input than at another [rad] are another circuit's.
FARTHER = 0.1
#: What another direction counts beside another place [rad].
COURSE = 0.1


#: How many screw axes are drawn, half their length, and how far the farthest is from the linkage, in extents.
MOST_AXES, HALF_AXIS, FAR_AXIS = 120, 0.15, 1.5


@dataclass(frozen=True, eq=False)
class View(TimedWalk):
    """A circuit of a motion on view: what is drawn of it, and its values at a row."""

    @cached_property
    def frame(self) -> Skeleton:
        """The places of joints and points along the path."""
        return skeleton(self.motion, self.circuit)

    def input_between(self, row: float, other: float) -> float:
        """How far the input runs [rad, or length] from row to row of one pass; infinite between two passes.

        The first and the last row of a closed circuit are one place, over which a pass goes on unless a dead
        centre stands there. Of two ways it is the shorter one.
        """
        low, high = sorted((row, other))
        ways = [
            abs(self.input_at(high) - self.input_at(low))
            for part in self.passes
            if part.start <= low and high <= part.last
        ]
        first, last = self.passes[0], self.passes[-1]
        ends_there = low == first.start or high == last.last
        goes_on = self.circuit.closed and (ends_there or not first.stands_first)
        if goes_on and low <= first.last and last.start <= high:
            to_the_end = abs(self.path.input[-1] - self.input_at(high))
            ways.append(float(to_the_end + abs(self.input_at(low) - self.path.input[0])))
        return min(ways, default=math.inf)

    def joints(self, row: float) -> Floats:
        """The joint values (columns,) at a row."""
        q = np.array(at_row(self._joints, row))
        q[self.circuit.input_column] = self.input_at(row)
        return q

    @cached_property
    def traces(self) -> tuple[Trace, ...]:
        """The named points along the circuit's own rows."""
        return tuple(self.circuit.point(point.name) for point in self.linkage.points)

    @cached_property
    def speeds(self) -> tuple[Floats, ...]:
        """The speed [length/s] of each named point on the path's rows, (n,)."""
        return tuple(np.linalg.norm(trace.velocity, axis=1)[self.path.rows] for trace in self.traces)

    def speed_extremes(self, point: int) -> tuple[tuple[str, int], ...]:
        """The rows of the path where a named point is fastest and slowest; none where it has no speed."""
        speeds = self.speeds[point]
        if not np.isfinite(speeds).any():
            return ()
        return ("fastest", int(np.nanargmax(speeds))), ("slowest", int(np.nanargmin(speeds)))

    def input_text(self, row: float) -> str:
        """The input at a row with its unit, an angle within a turn."""
        value, column = self.input_at(row), self.circuit.input_column
        turns = self.linkage.turns(column)
        return value_text(self.linkage, column, value % math.tau if turns else value)

    @cached_property
    def home(self) -> float | None:
        """The row of the drawn pose; `None` where the circuit has none."""
        return drawn_row(self)

    def whole_turns(self, column: int) -> float:
        """The whole turns [rad] that bring a column into (-pi, pi], as drawn or at first; 0 of a slide."""
        if not self.linkage.turns(column):
            return 0.0
        values = self.circuit.q[:, column]
        if self.home is not None:
            values = np.array([at_row(along(self.linkage, self.circuit, column), self.home)])
        known = values[np.isfinite(values)]
        # a start at half a turn up to rounding stays at +pi
        first = float(known[0]) if known.size else 0.0
        return -math.tau * math.ceil((first - math.pi - ROUNDED) / math.tau)

    def rates(self, point: int, row: float) -> tuple[Floats, Floats, Floats]:
        """Position, velocity and acceleration (3,) of a named point at a row; NaN where there is none.

        The velocity is that of the motion as it is seen: turned where the input goes back.
        """
        trace, path = self.traces[point], self.path
        return (
            at_row(trace.position[path.rows], row),
            path.sign[min(int(row), len(path.rows) - 1)] * at_row(trace.velocity[path.rows], row),
            at_row(trace.acceleration[path.rows], row),
        )

    def point_frame(self, link: int, row: float) -> Floats:
        """The frame (4, 4) in which points of a link are written, at a row; links are counted from 1."""
        own: Floats = self.linkage.point_frames[link - 1]
        return np.asarray(poses(self.linkage, self.joints(row)[None])[0, link - 1] @ own)

    def axodes(self, link: int) -> tuple[Floats, Floats]:
        """The lines (n, 2, 3) of the screw axes of a link against the ground, at all moments.

        The first in the frame of the report, the second in that in which points of the link are written; as
        long as a share of the linkage, and without those that are far from it.
        """
        axes = self.circuit.screw_axes(link)
        near = np.linalg.norm(axes.point - np.nanmean(self.frame.places, axis=(0, 1)), axis=1)
        selected = np.flatnonzero(near < FAR_AXIS * self.frame.span)
        selected = selected[:: max(1, len(selected) // MOST_AXES)]
        half = HALF_AXIS * self.frame.span

        def lines(point: Floats, direction: Floats) -> Floats:
            return np.stack([point - half * direction, point + half * direction], axis=1)[selected]

        return lines(axes.point, axes.direction), lines(axes.moving_point, axes.moving_direction)

    @cached_property
    def _joints(self) -> Floats:
        """Joint values (n, columns) along the path; in its closing row a turn on, where the joints are."""
        columns = range(len(self.linkage.columns))
        return np.stack([along(self.linkage, self.circuit, column) for column in columns], axis=1)


def own_points(view: View) -> range:
    """The places of the points that a person has added, among those of the linkage: the last ones."""
    count = len(view.linkage.points)
    return range(count - len(view.linkage.added_points), count)


def views_of(motion: Motion) -> tuple[View, ...]:
    """A view of each circuit of a motion, in their order."""
    return tuple(View(motion, circuit) for circuit in motion)


def modes_at(views: Sequence[View], value: float) -> list[tuple[View, float]]:
    """Where the views of a motion's circuits meet a value of the input: each with a row of its path.

    An angle is met in every turn. Two passes of a circuit that rocks are two modes.
    """
    return [(view, row) for view in views for row in view.rows_at(value)]


def nearest(views: Sequence[View], view: View, row: float) -> tuple[View, float]:
    """The mode of a motion, by its views, that goes on the pose of another, of a linkage little different.

    It is one at the same input, unless only a circuit that does not get there any more is alike. Near a dead
    centre, and where circuits come close, two poses are alike that move in other ways: of them it is the one
    that moves alike. Turns of balls are left out: they say little of the pose, and of a coupler that spins
    idly nothing.
    """
    measure = _Measure(views[0].motion)
    q, course = view.joints(row), measure.course(view, row)

    def unlike(other: View, at: float) -> float:
        bent = float(np.linalg.norm(measure.course(other, at) - course))
        return float(measure.apart(other.joints(at), q)) + COURSE * bent

    value = float(q[measure.input])
    here = [(unlike(other, at), i, at) for i, other in enumerate(views) for at in other.rows_at(value)]
    # a nearer pose at another input counts only where it is nearer by that
    if not here or min(here)[0] > FARTHER:
        gaps = [measure.apart(other.circuit.q, q) for other in views]
        tops = [int(np.nanargmin(gap)) for gap in gaps]
        top = min(range(len(views)), key=lambda i: float(gaps[i][tops[i]]))
        alike, gap = tops[top], float(gaps[top][tops[top]])
        if not here or min(here)[0] > gap + FARTHER:
            # the pose may only have gone on far, beside a dead centre
            here = [one for one in here if one[1] == top and measure.adjoins(views[top], alike, one[2], gap)]
        if not here:
            return views[top], float(alike)
    _, index, at = min(here)
    return views[index], at


def distance_from_drawn(view: View, row: float) -> float:
    """How far the joints of a view are from the drawn pose at a row; turns of balls are left out."""
    return float(_Measure(view.motion).apart(view.joints(row), view.linkage.drawn_pose))


class _Measure:
    """How far apart poses of a motion's linkage are."""

    def __init__(self, motion: Motion) -> None:
        own = motion.linkage
        self._size = motion.circuits[0].size
        self._kept = [column.number for column in own.each_column if column.is_output]
        self._turns = own.turning[self._kept]
        self.input = own.columns.index(motion.input)

    def _step(self, joints: Floats, q: Floats) -> Floats:
        step = joints[..., self._kept] - q[self._kept]
        turned = short_way(step)
        return np.asarray(np.where(self._turns, turned, step / self._size))

    def apart(self, joints: Floats, q: Floats) -> Floats:
        """How far joint values (.., columns) are from others (columns,) [rad, or relative to the size]."""
        return np.asarray(np.linalg.norm(self._step(joints, q), axis=-1))

    def adjoins(self, view: View, row: int, at: float, gap: float) -> bool:
        """Whether a pass leads from a row of a view to another whose input is no more than a gap away."""
        unit = 1.0 if view.linkage.turns(self.input) else self._size
        return view.input_between(row, at) <= (gap + SAME_INPUT) * unit

    def course(self, view: View, row: float) -> Floats:
        """The direction (kept columns,) in which the joints of a view go at a row, where the input rises."""
        last = len(view.path.rows) - 1
        ends = np.array([row - 0.5, row + 0.5])
        before, after = ends % last if view.circuit.closed and last else np.clip(ends, 0, last)
        step = self._step(view.joints(float(after)), view.joints(float(before)))
        length = float(np.linalg.norm(step))
        rises = step[self._kept.index(self.input)] >= 0
        return step / (length or 1.0) * (1.0 if rises else -1.0)
