"""Paths of points and poses of links: places that are to be reached, the linkage placed as it may be."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.match import Match, by_length, in_order, matched
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing, placed
from sevenbar.design.task.task import PathWant, PoseWant
from sevenbar.design.task.wants.wanted import Begun, Stations, Wanted, distances
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.stops import Three

#: Of the rows of a pass one in so many is tried as the one that takes the first pose.
FIRST_AT = 2


class PlacesWanted(Wanted):
    """Places (n, p, 3) that p points of one link shall take at n stations, relative to a `unit` [length]."""

    turns = False

    def __init__(self, loop: TaskLoop, want: PathWant | PoseWant) -> None:
        self.weight = want.weight
        #: The points as a circuit knows them: by a name, or each as a link and a place on it.
        self._seen: list[tuple[int | str, Three | None]]
        if isinstance(want, PathWant):
            self._seen, self.numbers = [(want.point, None)], [loop.named(want.point)]
            self.places = want.places[:, None, :]
            self.unit, self.closed = float(np.ptp(want.places, axis=0).max()), want.closed
        else:
            ends: list[Three] = [(0.0, 0.0, 0.0), *(tuple(map(float, e)) for e in want.arm * np.eye(3))]  # type: ignore[list-item]
            self._seen = [(want.link, end) for end in ends]
            self.numbers = [loop.place(want.link, end) for end in ends]
            self.places = np.einsum("nij,pj->npi", want.poses[:, :3, :3], ends) + want.poses[:, None, :3, 3]
            self.unit, self.closed = want.arm, False
        n = len(self.places)
        self.timing, self.phase = want.timing, want.phase
        own = float(loop.units[loop.input])
        if want.timing is None:
            self.stations = Stations(np.zeros(n), np.eye(n), np.full(n, own), round=self.closed, free=True)
        else:
            by = np.ones((n, int(want.phase)))
            self.stations = Stations(want.timing, by, np.full(by.shape[1], own), round=self.closed)
        self.count = self.places.size

    def left(self, here: Here, u: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        """Where the points are (r / 3, 3) at its stations, and their slopes (r / 3, 3, k + m)."""
        found, by = here.points[:, self.numbers], here.points_by[:, self.numbers]
        left = found.reshape(-1, 3)
        return left, by.reshape(*left.shape, by.shape[-1])

    def heights(self, left: Floats, by: Floats) -> tuple[Floats, Floats]:
        """Distances of the places."""
        return distances(left, by)

    def curve(self, one: InputPass) -> Floats:
        """The points along a pass (rows, p, 3)."""
        return np.stack([one.point(*which) for which in self._seen], axis=1)

    def begun(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[Begun]:
        """By the inputs of its timing, or by the best order-keeping match."""
        curve = self.curve(one)
        if not np.isfinite(curve).all() or (self.closed and not one.closed):
            return []
        if self.timing is not None:
            return self._timed(one, curve, placing)
        if len(self._seen) > 1:
            return self._poses(one, curve, placing)
        return self._path(one, curve[:, 0], placing, scaled=scaled)

    def _timed(self, one: InputPass, curve: Floats, placing: Placing | None) -> list[Begun]:
        assert self.timing is not None
        found = [
            self._begun(np.array([phase] * self.phase), rows, curve, placing)
            for phase, rows in zip(*one.begins(self.timing, free=self.phase), strict=True)
        ]
        return sorted(found, key=lambda begun: begun.error)[:1]

    def _begun(self, u: Floats, rows: Integers, curve: Floats, placing: Placing | None) -> Begun:
        wanted, found = self.places.reshape(-1, 3), curve[rows].reshape(-1, 3)
        own = placed(wanted, found) if placing is None else placing
        error = float(((own.put(found) - wanted) ** 2).sum()) / self.count / self.unit**2
        return Begun(u, rows, error, own)

    def _path(self, one: InputPass, curve: Floats, placing: Placing | None, *, scaled: bool) -> list[Begun]:
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
        found = (match.rows, other) if other is not None else (match.rows,)
        return [Begun(one.unwound(rows), rows, error, match.placing) for rows in found]

    def _poses(self, one: InputPass, curve: Floats, placing: Placing | None) -> list[Begun]:
        """In order, the linkage placed so that some row takes the first pose."""
        n = len(self.places)
        # that bring every other row of the curve to the first pose
        firsts = (placed(self.places[0], curve[row]) for row in range(0, len(curve), FIRST_AT))
        tried = firsts if placing is None else [placing]
        best: Begun | None = None
        for put in tried:
            rows, error = in_order(
                put.put(curve).reshape(len(curve), -1), self.places.reshape(n, -1), closed=one.closed
            )
            if math.isfinite(error) and (best is None or error < best.error):
                best = Begun(one.unwound(rows), rows, error, put)
        if best is None:
            return []
        return [self._begun(best.u, best.rows, curve, placing)]

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:  # noqa: ARG002
        """The distances (n p,) on rows of an analysis [length]."""
        one = InputPass(circuit, np.arange(len(circuit.q))[rows], closed=False, turns=True)
        off = placing.put(self.curve(one)) - self.places
        return np.asarray(np.linalg.norm(off, axis=2).ravel())
