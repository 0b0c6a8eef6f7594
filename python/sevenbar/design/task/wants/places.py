"""Wants of places that points of one link shall reach, the linkage placed as it may be: paths and poses."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task.flaws import Flaws
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.match import Match, by_length, in_order, matched
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing, placed
from sevenbar.design.task.task import SampledWant
from sevenbar.design.task.wanted import PlacesCurve, Stations, TaskStart, Used, Wanted, distances
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.stops import Three

#: Of the rows of a pass one in so many is tried as the one that takes the first pose.
FIRST_AT = 2


class TimedWant(SampledWant):
    """An objective of places in order, at inputs `timing` (n,) if any, with `phase` from an unknown start."""

    placeable = True

    timing: Floats | None
    phase: bool

    def input_range(self) -> tuple[float, float] | None:
        if self.timing is None or self.phase:
            return None
        return float(np.min(self.timing)), float(np.max(self.timing))

    def phase_flaws(self) -> Flaws:
        """That the start of inputs shall be free, and there are none."""
        if self.phase and self.timing is None:
            yield "phase", "there are no inputs whose start could be free; give timing, too"

    @property
    def timed(self) -> str:
        """That the inputs are given, in words."""
        if self.timing is None:
            return ""
        return ", at given inputs" + (" from a free start" if self.phase else "")


class PlacesWanted(Wanted):
    """Places (n, p, 3) that p points of one link shall take at n stations, relative to its unit [length].

    `seen` are the points as a circuit knows them: by a name, or each as a link and a place on it. `timing`
    (n,) are the inputs, from an unknown start on with `phase`; without it each is an unknown.
    """

    turns = False
    placeable = True

    def __init__(
        self,
        loop: TaskLoop,
        want: SampledWant,
        seen: Sequence[tuple[int | str, Three | None]],
        places: Floats,
        timing: Floats | None,
        *,
        phase: bool = False,
        closed: bool = False,
    ) -> None:
        self._seen, self.places = seen, places
        self.unit, self.weight = want.residual_unit(loop.linkage), want.weight
        self.timing, self.phase, self.closed = timing, phase, closed
        self.numbers = [
            loop.named(str(which)) if at is None else loop.place(int(which), at) for which, at in seen
        ]
        n, own = len(places), float(loop.units[loop.input])
        if timing is None:
            self.stations = Stations(np.zeros(n), np.eye(n), np.full(n, own), round=closed, free=True)
        else:
            by = np.ones((n, int(phase)))
            self.stations = Stations(timing, by, np.full(by.shape[1], own), round=closed)
        self.count = places.size

    def residuals(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        result, by = here.points[:, self.numbers], here.points_by[:, self.numbers]
        places = result.reshape(-1, 3)
        return places, by.reshape(*places.shape, by.shape[-1])

    def missed(self, here: Here, u: Floats, placing: Placing) -> Floats:
        return placing.put(self.residuals(here, u)[0]) - self.places.reshape(-1, 3)

    def heights(self, residuals: Floats, by: Floats) -> tuple[Floats, Floats]:
        return distances(residuals, by)

    def _along(self, one: InputPass) -> Floats:
        """The points along a pass (rows, p, 3)."""
        return np.stack([one.point(*which) for which in self._seen], axis=1)

    def starts(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[TaskStart]:
        curve = self._along(one)
        if not np.isfinite(curve).all() or (self.closed and not one.closed):
            return []
        if self.timing is not None:
            return self._timed(one, curve, placing)
        if len(self._seen) > 1:
            return self._poses(one, curve, placing)
        return self._path(one, curve[:, 0], placing, scaled=scaled)

    def _timed(self, one: InputPass, curve: Floats, placing: Placing | None) -> list[TaskStart]:
        assert self.timing is not None
        result = [
            self._start(np.array([phase] * self.phase), rows, curve, placing)
            for phase, rows in zip(*one.begins(self.timing, free=self.phase), strict=True)
        ]
        return sorted(result, key=lambda start: start.error)[:1]

    def _start(self, u: Floats, rows: Integers, curve: Floats, placing: Placing | None) -> TaskStart:
        wanted, result = self.places.reshape(-1, 3), curve[rows].reshape(-1, 3)
        own = placed(wanted, result) if placing is None else placing
        error = float(((own.put(result) - wanted) ** 2).sum()) / self.count / self.unit**2
        return TaskStart(u, rows, error, own)

    def _path(
        self, one: InputPass, curve: Floats, placing: Placing | None, *, scaled: bool
    ) -> list[TaskStart]:
        wanted = self.places[:, 0]
        ways = {"curve_closed": one.closed, "closed": self.closed}
        if placing is not None:
            match: Match | None = Match(*in_order(placing.put(curve), wanted, closed=one.closed), placing)
        else:
            match = matched(curve, wanted, **ways, scaled=scaled)
        if match is None or not math.isfinite(match.error):
            return []
        # the same as before, and by lengths along the curve, which tell the sides of a cusp apart
        other = by_length(match.placing.put(curve), wanted, **ways)
        error = match.error / 3 / self.unit**2
        result = (match.rows, other) if other is not None else (match.rows,)
        return [TaskStart(one.unwound(rows), rows, error, match.placing) for rows in result]

    def _poses(self, one: InputPass, curve: Floats, placing: Placing | None) -> list[TaskStart]:
        """In order, the linkage placed so that some row takes the first pose."""
        n = len(self.places)
        # that bring every other row of the curve to the first pose
        firsts = (placed(self.places[0], curve[row]) for row in range(0, len(curve), FIRST_AT))
        tried = firsts if placing is None else [placing]
        best: TaskStart | None = None
        for put in tried:
            rows, error = in_order(
                put.put(curve).reshape(len(curve), -1), self.places.reshape(n, -1), closed=one.closed
            )
            if math.isfinite(error) and (best is None or error < best.error):
                best = TaskStart(one.unwound(rows), rows, error, put)
        if best is None:
            return []
        return [self._start(best.u, best.rows, curve, placing)]

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:
        one = InputPass(circuit, np.arange(len(circuit.q))[rows], closed=False, turns=True)
        off = placing.put(self._along(one)) - self.places
        return np.asarray(np.linalg.norm(off, axis=2).ravel())

    def curve(self, used: Used) -> PlacesCurve:
        both = used.poses, used.station_poses
        path, taken = (used.placing.put(used.points(self.numbers, q)) for q in both)
        errors = np.linalg.norm(taken[:, 0] - self.places[:, 0], axis=1)
        frames = (self.places, taken) if len(self._seen) > 1 else None
        return PlacesCurve(path[:, 0], self.places[:, 0], errors, frames)


def frame_ends(arm: float) -> list[Three]:
    """The origin of a frame and the ends of its three axes, each an `arm` long."""
    return [(0.0, 0.0, 0.0), (arm, 0.0, 0.0), (0.0, arm, 0.0), (0.0, 0.0, arm)]


def frame_places(poses: Floats, arm: float) -> Floats:
    """Where these are (n, 4, 3) in poses (n, 4, 4)."""
    return np.asarray(np.einsum("nij,pj->npi", poses[:, :3, :3], frame_ends(arm)) + poses[:, None, :3, 3])
