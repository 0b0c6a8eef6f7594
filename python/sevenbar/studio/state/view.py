"""What is on view: a motion, one of its circuits, and the pose at a moment of that circuit's cycle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.drawing.figure import shown_value
from sevenbar.drawing.skeleton import Skeleton, skeleton
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import Walk, along, at_row, frames_of, joint_frames, walk
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.reporting.shown import value_text

#: Inputs [rad, or parts of the linkage's size] nearer to a limit are at it.
SAME_INPUT = 1e-9
#: Rows nearer to a sample are the sample.
SAME_ROW = 1e-9

#: Poses so much more unlike at the same input than at another [rad] are another circuit's.
FARTHER = 0.1
#: What another direction counts beside another place [rad].
COURSE = 0.1


#: How many screw axes are drawn, half their length, and how far the farthest is from the linkage, in extents.
MOST_AXES, HALF_AXIS, FAR_AXIS = 120, 0.15, 1.5


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of a path: its first row, the input on its rows, and whether it stands still at either end.

    Near a dead centre the joints move as the root of what is left of the input. So a place between two rows
    is given by a phase, an angle of which the input is the cosine: by that the joints run evenly.
    """

    start: int
    input: Floats
    stands_first: bool
    stands_last: bool

    @property
    def last(self) -> int:
        """Its last row on the path."""
        return self.start + len(self.input) - 1

    def row_of(self, value: float) -> float:
        """The row of the path at which the pass meets an input within its range."""
        sign = 1.0 if self.input[-1] >= self.input[0] else -1.0
        low = int(np.searchsorted(sign * self.input, sign * value, side="right")) - 1
        low = min(max(low, 0), len(self.input) - 2)
        before, after = self._phase(float(self.input[low])), self._phase(float(self.input[low + 1]))
        share = (self._phase(value) - before) / (after - before) if after != before else 0.0
        return self.start + low + share

    def input_at(self, row: float) -> float:
        """The input at a row of the path within the pass."""
        low = int(row) - self.start
        before, after = self._phase(float(self.input[low])), self._phase(float(self.input[low + 1]))
        first, last = float(self.input[0]), float(self.input[-1])
        return first + self._share(before + (row - int(row)) * (after - before)) * (last - first)

    def _phase(self, value: float) -> float:
        first, last = float(self.input[0]), float(self.input[-1])
        share = min(max((value - first) / (last - first), 0.0), 1.0) if last != first else 0.0
        if self.stands_first and self.stands_last:
            return 2 * math.atan2(math.sqrt(share), math.sqrt(1 - share))
        if self.stands_first:
            return math.sqrt(share)
        return 1 - math.sqrt(1 - share) if self.stands_last else share

    def _share(self, phase: float) -> float:
        """How much of its input a pass has gone at a phase."""
        if self.stands_first and self.stands_last:
            return math.sin(phase / 2) ** 2
        if self.stands_first:
            return phase**2
        return 1 - (1 - phase) ** 2 if self.stands_last else phase


@dataclass(frozen=True, eq=False)
class View:
    """A circuit of a motion, to be walked in time."""

    motion: Motion
    circuit: Circuit

    @property
    def linkage(self) -> Loop:
        """The linkage that moves."""
        return self.motion.linkage

    @cached_property
    def path(self) -> Walk:
        """The circuit's rows in the order of its motion."""
        return walk(self.circuit)

    @cached_property
    def frame(self) -> Skeleton:
        """The places of joints and points along the path."""
        return skeleton(self.motion, self.circuit)

    @property
    def shown_input(self) -> Floats:
        """The input along the path [deg, or length], (n,)."""
        values: Floats = shown_value(self.motion, self.motion.input, self.path.input)
        return values

    @property
    def period(self) -> float:
        """The time [s] of one cycle."""
        return float(self.path.time[-1])

    def row_at(self, time: float) -> float:
        """The row of the path at a time [s], which runs on over the cycle of a closed circuit."""
        times = self.path.time
        time = time % self.period if self.circuit.closed else min(max(time, 0.0), self.period)
        low = min(int(np.searchsorted(times, time, side="right")) - 1, len(times) - 2)
        share = (time - times[low]) / (times[low + 1] - times[low])
        inputs = self.path.input
        return self.pass_of(low).row_of(float(inputs[low] + share * (inputs[low + 1] - inputs[low])))

    def time_at(self, row: float) -> float:
        """The time [s] of a row of the path."""
        times, inputs = self.path.time, self.path.input
        low = int(row)
        if row == low:
            return float(times[low])
        share = (self.input_at(row) - inputs[low]) / (inputs[low + 1] - inputs[low])
        return float(times[low] + share * (times[low + 1] - times[low]))

    def input_at(self, row: float) -> float:
        """The input [rad, or length] at a row: between two rows not on the straight line, as joints are."""
        low = int(row)
        return float(self.path.input[low]) if row == low else self.pass_of(low).input_at(row)

    def rows_at(self, value: float) -> list[float]:
        """The rows, rising, at which the circuit meets a value of the input; an angle is met in every turn.

        Two passes that meet it are two rows; at the dead centre between them there is one.
        """
        turns = self.linkage.turns(self.circuit.input_column)
        slack = SAME_INPUT * (1.0 if turns else self.circuit.size)
        last = len(self.path.rows) - 1
        found: set[float] = set()
        for part in self.passes:
            low, high = sorted((float(part.input[0]), float(part.input[-1])))
            values = [value]
            if turns:
                first, past = (math.floor((end - value) / math.tau) for end in (low - slack, high + slack))
                values = [value + k * math.tau for k in range(first + 1, past + 1)]
            for met in values:
                if low - slack <= met <= high + slack:
                    row = part.row_of(min(max(met, low), high))
                    near = float(round(row))
                    row = near if abs(row - near) < SAME_ROW else row
                    found.add(0.0 if row == last and self.circuit.closed else row)
        return sorted(found)

    @cached_property
    def passes(self) -> tuple[Stretch, ...]:
        """The stretches between input dead centres, each with both of its ends."""
        status, past = self.circuit.status[self.path.rows], len(self.path.rows)
        stretches = [
            (part.start, min(part.stop + (not self.circuit.closed), past)) for part in self.path.passes
        ]
        return tuple(
            Stretch(
                start,
                self.path.input[start:stop],
                bool(status[start] == "dead-centre"),
                bool(status[stop - 1] == "dead-centre"),
            )
            for start, stop in stretches
            if stop - start > 1
        )

    def pass_of(self, row: float) -> Stretch:
        """The pass that holds a row of the path, and goes on from it."""
        return next((part for part in self.passes if part.start <= row < part.last), self.passes[-1])

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
        return tuple(self.circuit.point(point.link, point.at) for point in self.linkage.points)

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
        if link == len(self.linkage.joints):
            return own
        _, after = joint_frames(self.linkage, frames_of(self.linkage, self.joints(row)[None]))
        return np.asarray(after[0, link - 1] @ own)

    def axodes(self, link: int) -> tuple[Floats, Floats]:
        """The lines (n, 2, 3) of the screw axes of a link against the ground, at all moments.

        The first in the frame of the report, the second in that in which points of the link are written; as
        long as a share of the linkage, and without those that are far from it.
        """
        axes = self.circuit.screw_axes(link)
        near = np.linalg.norm(axes.point - np.nanmean(self.frame.places, axis=(0, 1)), axis=1)
        kept = np.flatnonzero(near < FAR_AXIS * self.frame.span)
        kept = kept[:: max(1, len(kept) // MOST_AXES)]
        half = HALF_AXIS * self.frame.span

        def lines(point: Floats, direction: Floats) -> Floats:
            return np.stack([point - half * direction, point + half * direction], axis=1)[kept]

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
    gaps = [measure.apart(other.circuit.q, q) for other in views]
    tops = [int(np.nanargmin(gap)) for gap in gaps]
    top = min(range(len(views)), key=lambda i: float(gaps[i][tops[i]]))
    alike, gap = tops[top], float(gaps[top][tops[top]])
    if not here or min(here)[0] > gap + FARTHER:
        # the pose may only have gone on far, beside a dead centre
        here = [one for one in here if one[1] == top and measure.adjoins(views[top], alike, one[2], gap)]
    if here:
        _, index, at = min(here)
        return views[index], at
    return views[top], float(alike)


def distance_from_zero(view: View, row: float) -> float:
    """How far the joints of a view are from zero at a row; turns of balls are left out."""
    measure = _Measure(view.motion)
    return float(measure.apart(view.joints(row), np.zeros(len(view.linkage.columns))))


class _Measure:
    """How far apart poses of a motion's linkage are."""

    def __init__(self, motion: Motion) -> None:
        own = motion.linkage
        self._size = motion.circuits[0].size
        self._kept = [i for i, name in enumerate(own.columns) if name in own.drivable()]
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
