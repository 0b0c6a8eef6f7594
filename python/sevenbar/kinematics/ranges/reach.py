"""How far a circuit goes from a place before a stop of the linkage ends it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.extents import Flags
from sevenbar.kinematics.circuits.timed_walk import SAME_ROW, TimedWalk
from sevenbar.kinematics.paths.circuit_path import NotFollowedError

#: A row at the drawn input is the drawn pose if all joints are nearer to it [rad, or shares of the size]:
#: rows are joined by lines, and other passes are farther off.
DRAWN_NEAR = 0.02


@dataclass(frozen=True, eq=False)
class Reach:
    """A stretch of a walk from row `low` to row `high`, within all stops.

    On a closed circuit `high` may be greater than the last row: the stretch then goes on over the end.
    `first_stop` and `last_stop` are what ends it: "range of rocker", "cone of ball_a", "links 1 and 3"; empty
    where the circuit itself ends.
    """

    walk: TimedWalk
    low: float
    high: float
    first_stop: str
    last_stop: str

    @property
    def _cycle(self) -> float:
        """Rows of a whole cycle of a closed circuit."""
        return float(len(self.walk.path.rows) - 1)

    def holds(self, row: float) -> bool:
        """Whether a row of the path lies on the stretch, its ends with it."""
        return self.low - SAME_ROW <= self.unrolled(row) <= self.high + SAME_ROW

    def unrolled(self, row: float) -> float:
        """A row counted on from the stretch's first, over the end of a closed circuit."""
        if not self.walk.circuit.closed or row >= self.low - SAME_ROW:
            return row
        return row + self._cycle

    def rolled(self, row: float) -> float:
        """A row of the stretch as a row of the path."""
        return row - self._cycle if row > self._cycle else row

    def clamped(self, row: float) -> float:
        """A row as `unrolled` counts it, moved to the nearer stop where it is beyond one."""
        return min(max(row, self.low), self.high)

    def time_at(self, row: float) -> float:
        """The time [s] of a row as `unrolled` counts it."""
        over = row > self._cycle
        return self.walk.time_at(self.rolled(row)) + (self.walk.period if over else 0.0)

    @cached_property
    def times(self) -> tuple[float, float]:
        """The times [s] of both ends."""
        return self.time_at(self.low), self.time_at(self.high)

    def row_at(self, time: float) -> float:
        """The row of the path at a time [s] between those of both ends."""
        first, last = self.times
        if not first < time < last:
            return self.rolled(self.low if time <= first else self.high)
        return self.walk.row_at(time)

    def forth_and_back(self, pictures: int) -> tuple[Floats, Floats]:
        """The rows of so many pictures, evenly in time, from stop to stop and back; and their times [s]."""
        first, last = self.times
        share = 2 * np.arange(pictures) / pictures
        times = first + (last - first) * np.minimum(share, 2 - share)
        return np.array([self.row_at(float(time)) for time in times]), (last - first) * share

    def stop_at(self, row: float) -> str:
        """The stop at which a row of the path is; empty between the stops."""
        place = self.unrolled(row)
        if abs(place - self.high) <= SAME_ROW:
            return self.last_stop
        # of a stretch round a closed circuit that one stop touches, both ends are one row
        return self.first_stop if abs(place - self.low) <= SAME_ROW else ""


def within(walk: TimedWalk) -> Flags:
    """Whether the rows of a walk are within the stops of its linkage (n,); where unknown they are."""
    try:
        return np.asarray(walk.circuit.allowed.within[walk.path.rows])
    except NotFollowedError:
        return np.ones(len(walk.path.rows), dtype=bool)


def stopped_by(walk: TimedWalk, row: float) -> str:
    """Which stops forbid the row of the circuit nearest to a row of a walk; empty where none does."""
    try:
        return str(walk.circuit.allowed.stopped_by[walk.path.rows[round(row)]])
    except NotFollowedError:
        return ""


def reaches(walk: TimedWalk) -> tuple[Reach, ...]:
    """The stretches of a walk within all stops, none where nothing, or everything, is stopped."""
    if not walk.linkage.stops.stops or (free := within(walk)).all() or not free.any():
        return ()
    allowed, last = walk.circuit.allowed, len(free) - 1
    ends = [
        (row, stop)
        for span in allowed.spans
        for value, stop in ((span.start, span.first_stop), (span.end, span.last_stop))
        for row in (walk.rows_at(value) if stop else ())
    ]

    def end(inside: int, outside: int) -> tuple[float, str]:
        """Where the path leaves the stops between two neighbouring rows, and by which stop."""
        if not 0 <= outside <= last:
            return float(inside), ""
        names = str(allowed.stopped_by[walk.path.rows[outside]])
        low = min(inside, outside)
        # several stops may end it at one place; one of them may forbid more rows than the others
        forbidding = set(names.split(", "))
        met = (
            (row, stop)
            for row, stop in ends
            if low <= row <= low + 1 and not forbidding.isdisjoint(stop.split(", "))
        )
        return next(met, (float(inside), names))

    result = []
    for first, past in _runs(free, closed=walk.circuit.closed):
        # a run over the end of a closed circuit is counted on from there
        over = last if past - 1 > last else 0
        low, first_stop = end(first, first - 1)
        high, last_stop = end(past - 1 - over, past - over)
        result.append(Reach(walk, low, high + over, first_stop, last_stop))
    return tuple(result)


def used_reach(walk: TimedWalk) -> Reach | None:
    """The stretch on which the linkage is used: of the drawn pose, else of the first row, else the first.

    `None` where no stop ends the walk. The same rule as `used_stretch` of its path.
    """
    result = reaches(walk)
    for home in (drawn_row(walk), 0.0):
        for one in result:
            if home is not None and one.holds(home):
                return one
    return result[0] if result else None


def drawn_row(walk: TimedWalk) -> float | None:
    """The row of a walk in the drawn pose; `None` where it has none."""
    if walk.linkage.form != "drawn":
        return None
    circuit, turning = walk.circuit, walk.linkage.turning
    scales = np.where(turning, 1.0, circuit.size)
    best, nearest = None, DRAWN_NEAR
    pose = walk.linkage.drawn_pose
    for row in walk.rows_at(float(pose[walk.linkage.columns.index(walk.motion.input)])):
        # a pose between two rows is near the line between them
        low = min(int(row), len(walk.path.rows) - 2)
        a, b = circuit.q[walk.path.rows[low]], circuit.q[walk.path.rows[low + 1]]
        step = b - a
        step[turning] -= math.tau * np.round(step[turning] / math.tau)
        off = a + (row - low) * step - pose
        off[turning] -= math.tau * np.round(off[turning] / math.tau)
        # turns of a ball may be undefined there
        distance = float(np.nanmax(np.abs(off / scales), initial=0.0))
        if distance < nearest:
            best, nearest = row, distance
    return best


def _runs(free: Flags, *, closed: bool) -> list[tuple[int, int]]:
    """The first row of each run within the stops, and the first past it; over the end of a closed circuit."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], free, [False]])))
    runs = [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
    if closed and len(runs) > 1 and free[0] and free[-1]:
        first, last = runs[0], runs[-1]
        # the last row of a closed circuit is its first
        runs = [*runs[1:-1], (last[0], last[1] + first[1] - 1)]
    return runs
