"""The loop of a task at any values of its free numbers: poses, and what is there with exact slopes.

About crank and rocker of an RSSR with square axes in closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.description.draft import Draft
from sevenbar.design.closure import NAMES, output_slopes, outputs
from sevenbar.errors import DescriptionError, NotCoveredError, RequestError
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.numbers.dimensions import Following
from sevenbar.kinematics.numbers.sensitivity import NumberedLoop, Numbers
from sevenbar.kinematics.numbers.word import Carried

#: Slacks (n, r) at n poses, numbers that must not be negative, and their slopes (n, r, unknowns).
Slacks = tuple[Floats, Floats]

#: Inputs of a turn at which circuits are measured and wants started: what lies between rows is found there.
SAMPLES = 72


@dataclass(frozen=True, eq=False)
class Here:
    """A loop at closed poses (n, columns): columns and points (n, points, 3), with slopes (.., k + 1).

    Slopes are by the k free numbers, then by the input, or (.., 0) by nothing. A ball's columns are its
    rotation in their slopes.
    """

    q: Floats
    q_by: Floats
    points: Floats
    points_by: Floats

    def part(self, rows: slice) -> Here:
        """Some of its poses."""
        return Here(self.q[rows], self.q_by[rows], self.points[rows], self.points_by[rows])

    def along(self, inputs_by: Floats) -> Here:
        """The same with slopes by free numbers and unknowns, by which the inputs change so (n, unknowns)."""

        def chained(by: Floats) -> Floats:
            if not by.shape[-1]:
                return by
            own = inputs_by.reshape(len(inputs_by), *(1,) * (by.ndim - 2), -1)
            return np.concatenate([by[..., :-1], by[..., -1:] * own], axis=-1)

        return Here(self.q, chained(self.q_by), self.points, chained(self.points_by))


class TaskLoop:
    """The loop of a draft whose `free` numbers, by name, may change; `values` (k,) are theirs.

    Points of which something is wanted are known by their number.
    A coupler that the draft leaves out follows unless it is one of the free numbers.
    """

    def __init__(self, draft: Draft, free: Sequence[str]) -> None:
        self.draft, self.linkage = draft, draft.linkage
        self.numbers = Numbers(self.linkage)
        #: The numbers that move something, then the masses of bodies.
        self.dimensions = (*self.numbers.dimensions, *draft.masses)
        places = {d.name: i for i, d in enumerate(self.dimensions)}
        self.free = [places[name] for name in free]
        #: Which of the free numbers move something: these have slopes at poses.
        self._moving = [k for k, i in enumerate(self.free) if i < len(self.numbers.names)]
        self.input = self.linkage.columns.index(self.linkage.drive.joint)
        self.output = self.linkage.columns.index(self.linkage.drive.output)
        #: The longest dimension [length], and what is 1 of each column: a radian, or the size.
        self.size, self.units = self.numbers.size, self.numbers.scales
        #: What is 1 of each free number, as a radian is of an angle.
        masses = [abs(d.value) or 1.0 for d in draft.masses]
        self.scales = np.concatenate([self.numbers.units, masses])[self.free]
        self.coupler = Following.among(self.numbers.dimensions, [self.free[k] for k in self._moving])
        self._loop: tuple[bytes, NumberedLoop] | None = None
        self._motion: tuple[bytes, Motion | None] | None = None

    @property
    def start(self) -> Floats:
        """The description's own values (k,)."""
        return np.array([self.dimensions[i].value for i in self.free])

    def named(self, name: str) -> int:
        """The number of a named point."""
        return [point.name for point in self.linkage.points].index(name)

    def place(self, link: int, at: tuple[float, float, float]) -> int:
        """The number of a place on a link, as points of it are written."""
        return self._number(self.numbers.word.place(link, at))

    def rod(self, link: int) -> tuple[int, int]:
        """The numbers of the places of the joints before a link and behind it, both on the link."""
        before, behind = map(self._number, self.numbers.word.rod(link))
        return before, behind

    def joint(self, name: str) -> int:
        """The number of the place of a joint on the link behind it."""
        place = [joint.name for joint in self.linkage.joints].index(name)
        return self._number(self.numbers.word.rod(self.linkage.graph.between[place][1])[0])

    def marked(self, points: Sequence[Carried]) -> list[int]:
        """The numbers of points of links."""
        return [self._number(point) for point in points]

    def _number(self, carried: Carried) -> int:
        points = self.numbers.points
        if carried not in points:
            points.append(carried)
            self._loop = None
        return points.index(carried)

    def whole(self, values: Floats) -> Floats:
        """All numbers of the description (all,)."""
        result = self.numbers.nominal.copy()
        result[[self.free[k] for k in self._moving]] = values[self._moving]
        return result if self.coupler is None else self.coupler.whole(result)

    def at(self, values: Floats) -> NumberedLoop:
        """The loop of these values, kept for the next question."""
        key = values.tobytes()
        if self._loop is None or self._loop[0] != key:
            moving = [self.free[k] for k in self._moving]
            only = [*moving, *([self.coupler.own] if self.coupler else ())]
            self._loop = key, self.numbers.loop(self.input, self.whole(values), only)
        return self._loop[1]

    def poses(self, values: Floats, q: Floats) -> Floats:
        """Rows of the analysis (n, columns) as poses of the loop."""
        return self.numbers.poses(q, self.whole(values))

    def closed(self, values: Floats, x: Floats, q: Floats) -> Floats:
        """The poses (n, columns) at inputs x (n,), by Newton's method from those nearby; NaN where lost."""
        return np.asarray(self.at(values).followed(x, q)[0][0])

    def here(self, values: Floats, q: Floats, *, slopes: bool = True) -> Here:
        """What is at closed poses (n, columns); slopes are NaN at dead centres of the input."""
        if not slopes:
            points = self.at(values).places(q)
            return Here(q, np.empty((*q.shape, 0)), points, np.empty((*points.shape, 0)))
        result = self.at(values).slopes(q, 0)
        by_q = np.moveaxis(result.by_number[:, 0], 1, 2)
        by_points = np.moveaxis(result.points_by_number[:, :, 0], 2, 3)
        return Here(
            q,
            np.concatenate([self._led(values, by_q), result.by_input[:, 0, :, None]], axis=2),
            result.points[:, :, 0],
            np.concatenate([self._led(values, by_points), result.points_by_input[:, :, 0, :, None]], axis=3),
        )

    def _led(self, values: Floats, by: Floats) -> Floats:
        """Slopes (.., k), none by masses, those by the coupler passed on to what it follows from."""
        result = np.zeros((*by.shape[:-1], len(self.free)))
        result[..., self._moving] = by[..., : len(self._moving)]
        if self.coupler is None:
            return result
        whole = self.whole(values)
        for number, part in zip(self.coupler.leaders, self.coupler.slopes(whole), strict=True):
            if number in self.free:
                result[..., self.free.index(number)] += part * by[..., -1]
        return result

    def all_slopes(self, values: Floats, by: Floats) -> Floats:
        """Slopes (.., all) by all numbers of the description, as slopes (.., k) by the free ones."""
        by = by if self.coupler is None else self.coupler.chained(by, self.whole(values))
        result = np.zeros((*by.shape[:-1], len(self.free)))
        result[..., self._moving] = by[..., [self.free[k] for k in self._moving]]
        return result

    @property
    def _dimensions(self) -> list[int]:
        """The numbers of an RSSR given by its dimensions, in the order of `NAMES`."""
        return [self.numbers.names.index(name) for name in NAMES]

    def row(self, values: Floats) -> Floats:
        """The design (1, 6) of an RSSR given by its dimensions, as `closure` takes it."""
        return np.asarray(self.whole(values)[None, self._dimensions])

    def row_slopes(self, values: Floats, by: Floats) -> Floats:
        """Slopes (n, 6) by these dimensions, as slopes (n, k) by the free numbers."""
        every = np.zeros((len(by), len(self.numbers.names)))
        every[:, self._dimensions] = by
        return self.all_slopes(values, every)

    def mass_slopes(self, by: Floats) -> Floats:
        """Slopes by the masses of all links that have a body [1/kg], as slopes (k,) by the free numbers.

        NaN by a mass that is not all of its link, or whose inertia the file gives: it stays as it is.
        """
        result = np.zeros(len(self.free))
        bodies = self.linkage.description.get("body", ())
        links = sorted({body["link"] for body in bodies})
        for k, i in enumerate(self.free):
            one = self.dimensions[i]
            if one.kind == "mass":
                body = bodies[one.place[1]]
                whole = one.name == f"mass_{body['link']}" and "inertia" not in body
                result[k] = one.scale * by[links.index(body["link"])] if whole else np.nan
        return result

    @property
    def free_masses(self) -> bool:
        """Whether a mass is free."""
        return len(self._moving) < len(self.free)

    def openings(self, values: Floats, q: Floats) -> list[int]:
        """The free numbers that cannot change alone without opening the loop, at closed poses."""
        opening = self.at(values).slopes(q, 0).opening
        return [k for k, opens in zip(self._moving, opening, strict=False) if opens]

    def near(self, values: Floats, row: Floats) -> Floats | None:
        """The pose (1, columns) at these values near a row of others, at its input; `None` where none is."""
        q = self.closed(values, row[[self.input]], self.poses(values, row[None]))
        return q if np.isfinite(q).all() else None

    def drawn(self, values: Floats) -> Draft:
        """The draft with these values (k,)."""
        own = [(self.dimensions[i], float(x)) for i, x in zip(self.free, values, strict=True)]
        return self.draft.with_places({d.place: self.draft.written(d, x) for d, x in own})

    def motion(self, values: Floats) -> Motion | None:
        """The motion at these values (k,), kept for the next question; `None` where they make no linkage."""
        key = values.tobytes()
        if self._motion is None or self._motion[0] != key:
            try:
                self._motion = key, self.drawn(values).linkage.motion(SAMPLES)
            except (DescriptionError, RequestError, NotCoveredError):
                self._motion = key, None
        return self._motion[1]


class RssrLoop(TaskLoop):
    """An RSSR of which crank and rocker alone are seen: the columns of its balls are not followed.

    With a point to be seen it is a loop as any other.
    """

    @property
    def _sees_points(self) -> bool:
        return len(self.numbers.points) > len(self.linkage.points)

    def on_branch(self, values: Floats, x: Floats, branch: int) -> Floats:
        """The poses (n, columns) at inputs x (n,) on a branch; NaN where there is none."""
        result = np.zeros((len(x), len(self.linkage.columns)))
        result[:, self.input] = x
        result[:, self.output] = outputs(self.row(values), x, branch)[0]
        return result

    def closed(self, values: Floats, x: Floats, q: Floats) -> Floats:
        """The poses (n, columns) at inputs x (n,), on the branch nearest to q; NaN where there is none."""
        if self._sees_points:
            return super().closed(values, x, q)
        result = q.copy()
        ways = [self.on_branch(values, x, branch)[:, self.output] - q[:, self.output] for branch in (0, 1)]
        first, second = short_way(ways[0]), short_way(ways[1])
        result[:, self.input] = x
        result[:, self.output] += np.where(np.abs(second) < np.abs(first), second, first)
        return result

    def here(self, values: Floats, q: Floats, *, slopes: bool = True) -> Here:
        """What is at closed poses (n, columns); slopes are infinite at dead centres of the input."""
        if self._sees_points:
            return super().here(values, q, slopes=slopes)
        none = np.empty((len(q), 0, 3))
        if not slopes:
            return Here(q, np.empty((*q.shape, 0)), none, np.empty((*none.shape, 0)))
        at = q[None, :, self.input], q[None, :, self.output]
        by_row, by_input = output_slopes(self.row(values), *at)
        by = np.zeros((*q.shape, len(self.free) + 1))
        by[:, self.output] = np.column_stack([self.row_slopes(values, by_row[0]), by_input[0]])
        by[:, self.input, -1] = 1.0
        return Here(q, by, none, np.empty((*none.shape, by.shape[-1])))
