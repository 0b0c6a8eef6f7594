"""A task at its unknowns: residuals and slacks with exact slopes, about poses that are followed.

The unknowns z are the free numbers, then the own ones of each want (free inputs, phases, zeros), each
relative to its unit. Where the linkage may stand anywhere, each evaluation is placed anew. What is left is
then square to every small rigid motion B of the places, so with the part of the slopes along B taken off the
gradient of the sum of squares stays exact (variable projection). For the greatest residual, where that does
not hold, the placing is six unknowns more.

Source: docs/theory_design.md, (29).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.limits import INPUT_TURNS, transmission_slack, turning_slack
from sevenbar.design.task.effort import Effort
from sevenbar.design.task.loop import Here, RssrLoop, Slacks, TaskLoop
from sevenbar.design.task.measured import Figures
from sevenbar.design.task.musts import measure_within
from sevenbar.design.task.placing import (
    STILL,
    Placing,
    left_jacobian,
    placed,
    rigid_moves,
    rotation_of_vector,
)
from sevenbar.design.task.task import (
    DesignTask,
    MeasureMust,
    MeasureWant,
    Must,
    PoseMust,
    ResidualMust,
    SampledWant,
)
from sevenbar.design.task.transmitting import AngleSlack, LeastAngle
from sevenbar.design.task.wanted import Stations, Wanted
from sevenbar.design.task.wants.places import PlacesWanted

#: A step after which a passive joint is further away [rad, or of the size] has left its branch.
LONGEST_STEP = 1.2

#: Poses of a want, with those between its stations, at which musts are held.
HELD = 73

#: Columns of the slopes that a small rigid motion leaves, below this part of the greatest.
FLAT = 1e-9


@dataclass(frozen=True, eq=False)
class TaskSeed:
    """A start: numbers (k,), each want's unknowns, poses of all its stations (n, columns), and how far off.

    `anchor` (columns,) is a row of the circuit; `error` the sum of weighted mean squares; `period` what the
    input gains in a round of the circuit, 0 where it does not go round; `circuit` is its number at the start.
    """

    values: Floats
    own: tuple[Floats, ...]
    poses: Floats
    anchor: Floats
    error: float
    placing: Placing = STILL
    period: float = 0.0
    circuit: int = 0


@dataclass(frozen=True, eq=False)
class TaskValues:
    """Residuals (r,) and slacks (c,) at unknowns z, with their slopes (.., unknowns or 0), and the placing.

    `least` has the least slack of each kind of must, by what is at fault where it is missed.
    """

    residuals: Floats
    residuals_by: Floats
    slack: Floats
    slack_by: Floats
    placing: Placing
    least: Mapping[str, float]


class TaskModel:
    """The parts of a task that stay as they are: its loop, its wants and musts in it.

    Musts about poses are held by `margins` more, by their places [rad, or relative to the size].
    """

    def __init__(self, task: DesignTask, margins: Mapping[int, float] | None = None) -> None:
        self.task, self.margins = task, margins or {}
        self.loop = loop = loop_of(task)
        self.wanted: list[Wanted] = [want.in_loop(loop) for _, want in task.sampled]
        self.figure_wants = [want for want in task.wants if isinstance(want, MeasureWant)]
        #: The places among the task's wants of those at poses.
        self.sampled = [i for i, _ in task.sampled]
        self.figure_musts = [must for must in task.musts if isinstance(must, MeasureMust)]
        least = task.limits.transmission_lowest
        if least > 0 and not self.wanted:
            # nothing says what is used of the circuit: all of it
            self.figure_musts.append(measure_within("transmission_lowest", math.degrees(least)))
        names = [w.name for w in self.figure_wants] + [m.name for m in self.figure_musts]
        self.figures = Figures(loop, list(dict.fromkeys(names)))
        #: Wants and musts of the least transmission angle in closed form, and the measures worked out.
        self.in_line = LeastAngle(loop)
        self.angle_wants = [want for want in self.figure_wants if self._in_line(want)]
        self.angle_musts = [must for must in self.figure_musts if self._in_line(must) and must.most is None]
        names = [want.name for want in self.figure_wants if want not in self.angle_wants]
        names += [must.name for must in self.figure_musts if must not in self.angle_musts]
        self.searched = Figures(loop, list(dict.fromkeys(names)))
        self.slacks = pose_slacks(loop, task.musts)
        #: What the present start has taken.
        self.effort = Effort()
        self.placed = task.placement != "fixed"
        linkage = loop.linkage
        closed_form = linkage.form == "rssr" and loop.input == 0
        self.transmits = closed_form and (task.limits.transmission_lowest > 0 or task.goal == "transmission")
        #: The slack of the transmission angle of any other loop.
        self.angle = AngleSlack(loop, task.limits) if least > 0 and self.wanted and not closed_form else None
        self.turns = closed_form and task.limits.motion_type in INPUT_TURNS
        #: Wants, by their places among the sampled, whose residuals have been asked to stay small.
        self.most = [(self.sampled.index(m.want), m) for m in task.musts if isinstance(m, ResidualMust)]

    def _in_line(self, asked: MeasureWant | MeasureMust) -> bool:
        return self.in_line.known and asked.name == "transmission_lowest"

    @property
    def measures(self) -> bool:
        """Whether the search reads measures of circuits."""
        return bool(self.searched.names or self.angle_wants)

    @property
    def holds(self) -> bool:
        """Whether anything must hold at poses between the stations."""
        return bool(self.slacks or self.transmits or self.angle)


class TaskProblem:
    """A task about a seed; `minimax` for the greatest residual, with the placing among the unknowns."""

    def __init__(self, model: TaskModel, seed: TaskSeed, *, minimax: bool = False) -> None:
        self.model, self.loop, self.minimax = model, model.loop, minimax
        self._poses, self._anchor = seed.poses, seed.anchor
        self._period = seed.period
        self._base, self._turned = seed.placing, minimax and model.placed
        self._k = k = len(seed.values)
        scales = [model.loop.scales, *(one.stations.scales for one in model.wanted)]
        starts = [seed.values, *seed.own]
        if self._turned:
            scales.append(np.array([1.0, 1.0, 1.0, *[model.loop.size] * 3]))
            starts.append(np.zeros(6))
        self.scales = np.concatenate(scales)
        self.start = np.concatenate(starts) / self.scales
        ends = np.cumsum([k, *(len(own) for own in seed.own)])
        self._own = [slice(a, b) for a, b in pairwise(ends)]
        self.low, self.high = (np.full(len(self.start), way * math.inf) for way in (-1, 1))
        self.low[:k], self.high[:k] = (
            bound / model.loop.scales for bound in (model.task.low, model.task.high)
        )
        #: Which way the inputs of each want go, and by how much they may in all [rad].
        self._senses = [
            _sense(one.stations.inputs(own)) for one, own in zip(model.wanted, seed.own, strict=True)
        ]
        self._periods = [way * seed.period for way in self._senses]
        self._stations = self._all_stations()
        if (model.slacks or model.angle) and len(self._poses) < len(self._stations.fixed):
            self._poses = self._between(seed)
        places = [one.places.reshape(-1, 3) for _, one in self._places()]
        self._middle = np.concatenate(places).mean(axis=0) if places else np.zeros(3)
        self._taken: tuple[bytes, TaskValues | None] = b"", None
        self._asked: tuple[bytes, Floats | None] | None = None
        self._known: tuple[bytes, TaskValues | None] | None = None
        self._valued: tuple[bytes, TaskValues | None] | None = None

    # ---- the inputs at which the linkage is seen

    def _all_stations(self) -> Stations:
        """Those of the wants, then those between them where something must hold there."""
        width, count = len(self.start), 0
        own, held = [(np.empty(0), np.empty((0, width)))], []
        self._rows: list[slice] = []
        for one, place, period in zip(self.model.wanted, self._own, self._periods, strict=True):
            steady = one.stations.fixed
            by = np.zeros((len(steady), width))
            by[:, place] = one.stations.by * one.stations.scales
            own.append((steady, by))
            self._rows.append(slice(count, count + len(steady)))
            count += len(steady)
            if self.model.holds and len(steady) > 1:
                held.append(_spread(steady, by, one.stations, period))
        self._count = count
        fixed, slopes = zip(*own, *held, strict=True)
        return Stations(np.concatenate(fixed), np.concatenate(slopes), np.ones(width))

    def _between(self, seed: TaskSeed) -> Floats:
        """Poses of all stations, those between followed from the nearest."""
        inputs = self._stations.inputs(self.start)
        known = self.loop.closed(seed.values, inputs[: self._count], seed.poses)
        more = inputs[self._count :]
        from_row = np.abs(more[:, None] - inputs[: self._count]).argmin(axis=1)
        return np.concatenate([known, self.loop.closed(seed.values, more, known[from_row])])

    def within(self, z: Floats) -> Floats:
        """The unknowns within their bounds."""
        return np.clip(z, self.low, self.high)

    def size(self, z: Floats) -> float:
        """The root of the weighted mean squares at z; infinite where there are none."""
        here = self.at(z)
        return math.inf if here is None else float(np.linalg.norm(here.residuals))

    def values(self, z: Floats) -> Floats:
        """The free numbers (k,)."""
        return np.asarray(z[: self._k] * self.scales[: self._k])

    def own(self, z: Floats) -> tuple[Floats, ...]:
        """The unknowns of each want."""
        return tuple(z[place] * self.scales[place] for place in self._own)

    @property
    def looked_at(self) -> int:
        """The number of inputs at which the linkage is seen."""
        return len(self._stations.fixed)

    def inputs(self, z: Floats) -> list[Floats]:
        """The inputs (n,) of each want."""
        inputs = self._stations.inputs(z)
        return [inputs[rows] for rows in self._rows]

    def poses(self, z: Floats) -> Floats | None:
        """The closed poses (n, columns) of all stations, from those last taken; `None` off the branch.

        Those between the wants' are left out where only the closed form is asked there.
        """
        key = z.tobytes()
        if self._asked is None or self._asked[0] != key:
            inputs = self._stations.inputs(z)[: len(self._poses)]
            poses = self.loop.closed(self.values(z), inputs, self._poses)
            step = np.abs(poses - self._poses) / self.loop.units
            step[:, self.loop.input] = 0.0
            good = bool(np.isfinite(poses).all()) and bool((step <= LONGEST_STEP).all())
            self._asked = key, poses if good else None
        return self._asked[1]

    def take(self, z: Floats) -> None:
        """Later poses are followed from those at z."""
        poses = self.poses(z)
        self._taken = z.tobytes(), self.at(z)
        if poses is not None:
            self._poses = poses
            near = poses[:1] if len(poses) else self.loop.near(self.values(z), self._anchor)
            if near is not None:
                self._anchor = near[0]

    def seed(self, z: Floats) -> TaskSeed:
        """The start that z is."""
        result = self.at(z)
        self.take(z)
        placing = STILL if result is None else result.placing
        poses = self._poses[: self._count]
        return TaskSeed(self.values(z), self.own(z), poses, self._anchor, math.nan, placing, self._period)

    # ---- what is left there

    def at(self, z: Floats) -> TaskValues | None:
        """Residuals and slacks at z; `None` where the linkage does not close on its branch."""
        key = z.tobytes()
        if key == self._taken[0]:
            # at the edge of where the linkage closes it may not be found twice
            return self._taken[1]
        if self._known is None or self._known[0] != key:
            self._known = key, self._at(z)
        return self._known[1]

    def tried(self, z: Floats) -> TaskValues | None:
        """Residuals and slacks at z without their slopes, which cost the most."""
        return self._at(z, slopes=False)

    def valued(self, z: Floats) -> TaskValues | None:
        """Residuals and slacks at z, with their slopes only where these are known already."""
        key = z.tobytes()
        for known in (self._taken, self._known, self._valued):
            if known is not None and known[0] == key:
                return known[1]
        self._valued = key, self.tried(z)
        return self._valued[1]

    def _at(self, z: Floats, *, slopes: bool = True) -> TaskValues | None:
        poses = self.poses(z)
        if poses is None:
            return None
        values, own = self.values(z), self.own(z)
        here = self.loop.here(values, poses, slopes=slopes)
        parts = []
        bounds: list[tuple[str, Floats, Floats]] = []
        parts_of = zip(self.model.task.sampled, self.model.wanted, own, self._rows, self._own, strict=True)
        for (_, want), one, u, rows, place in parts_of:
            seen = here.part(rows).along(one.stations.by)
            residuals, by = one.residuals(seen, u)
            parts.append((residuals, self._by_all(by, place) if slopes else by))
            if bound := one.bound(seen):
                by = self._by_all(bound.slack_by, place) if slopes else bound.slack_by
                bounds.append((want.fault, bound.slack, by))
        placing = self._placing(z, [residuals for residuals, _ in parts])
        each, each_by = self._placed(z, parts, placing)
        figures = self._figures(values, slopes=slopes)
        if figures is None:
            return None
        slacks = self._slacks(z, here, list(zip(each, each_by, strict=True))) + bounds
        slacks.append(("figure", *figures[1]))
        least: dict[str, float] = {"figure": math.inf}
        for fault, fault_slack, _ in slacks:
            least[fault] = min(least.get(fault, math.inf), float(fault_slack.min(initial=math.inf)))
        weights = [one.weight / math.sqrt(one.count) for one in self.model.wanted]
        residuals = np.concatenate([*(w * r for w, r in zip(weights, each, strict=True)), figures[0][0]])
        slack = np.concatenate([fault_slack for _, fault_slack, _ in slacks])
        residuals_by, slack_by = np.empty((len(residuals), 0)), np.empty((len(slack), 0))
        if slopes:
            by_all = (w * r for w, r in zip(weights, each_by, strict=True))
            residuals_by = np.concatenate([*by_all, figures[0][1]])
            slack_by = np.concatenate([by for _, _, by in slacks])
        good = all(np.isfinite(part).all() for part in (residuals, residuals_by, slack, slack_by))
        return TaskValues(residuals, residuals_by, slack, slack_by, placing, least) if good else None

    def _by_all(self, by: Floats, place: slice) -> Floats:
        """Slopes (.., k + m) by the free numbers and a want's unknowns as those by all unknowns."""
        wide = np.zeros((*by.shape[:-1], len(self.scales)))
        wide[..., : self._k], wide[..., place] = by[..., : self._k], by[..., self._k :]
        return np.asarray(wide * self.scales)

    def _wide(self, by: Floats) -> Floats:
        """Slopes (r, k) by the free numbers as those by all unknowns."""
        result = np.zeros((len(by), len(self.start)))
        result[:, : self._k] = by * self.scales[: self._k]
        return result

    def _places(self) -> list[tuple[int, PlacesWanted]]:
        return [(i, one) for i, one in enumerate(self.model.wanted) if isinstance(one, PlacesWanted)]

    def _placing(self, z: Floats, reached: Sequence[Floats]) -> Placing:
        if not self.model.placed:
            return STILL
        if self._turned:
            return self._moved(z)
        own = self._places()
        shares = [(one.weight / one.unit) ** 2 / one.count for _, one in own]
        return placed(
            np.concatenate([one.places.reshape(-1, 3) for _, one in own]),
            np.concatenate([reached[i] for i, _ in own]),
            shares=np.repeat(shares, [len(reached[i]) for i, _ in own]),
        )

    def _placed(
        self, z: Floats, parts: Sequence[tuple[Floats, Floats]], placing: Placing
    ) -> tuple[list[Floats], list[Floats]]:
        """Residuals and slopes of every want, those of places as the linkage is placed."""
        residuals, slopes = [part[0] for part in parts], [part[1] for part in parts]
        own = self._places()
        for i, one in own:
            put = placing.put(residuals[i])
            by = np.einsum("ij,njk->nik", placing.rotation, slopes[i])
            if self._turned and by.shape[-1]:
                by[..., -6:] = self._by_moves(z, put)
            residuals[i] = (put - one.places.reshape(-1, 3)).ravel() / one.unit
            slopes[i] = by.reshape(residuals[i].size, -1) / one.unit
        if self.model.placed and not self._turned and slopes[own[0][0]].size:
            self._project(own, parts, placing, slopes)
        return residuals, slopes

    def _project(
        self,
        own: Sequence[tuple[int, PlacesWanted]],
        parts: Sequence[tuple[Floats, Floats]],
        placing: Placing,
        slopes: list[Floats],
    ) -> None:
        """Takes off the slopes what a small rigid motion of all places does."""
        counts = [one.count for _, one in own]
        weight = np.repeat([one.weight / math.sqrt(one.count) for _, one in own], counts)[:, None]
        unit = np.repeat([one.unit for _, one in own], counts)[:, None]
        every = np.concatenate([placing.put(parts[i][0]) for i, _ in own])
        moves = weight / unit * rigid_moves(every - every.mean(axis=0))
        basis, sizes, _ = np.linalg.svd(moves, full_matrices=False)
        basis = basis[:, sizes > FLAT * sizes[0]]
        joined = weight * np.concatenate([slopes[i] for i, _ in own])
        joined = (joined - basis @ (basis.T @ joined)) / weight
        for (i, _), part in zip(own, np.split(joined, np.cumsum(counts)[:-1]), strict=True):
            slopes[i] = part

    def _moved(self, z: Floats) -> Placing:
        """The placing moved by the last six unknowns: a turn about the middle of the places, and a shift."""
        turn, shift = np.split(z[-6:] * self.scales[-6:], 2)
        rotation = rotation_of_vector(turn)
        at = rotation @ (self._base.shift - self._middle) + self._middle + shift
        return Placing(rotation @ self._base.rotation, at, self._base.scale)

    def _by_moves(self, z: Floats, put: Floats) -> Floats:
        """The slopes (n, 3, 6) of places (n, 3) as put, by these unknowns."""
        turn, shift = np.split(z[-6:] * self.scales[-6:], 2)
        own = put - self._middle - shift
        by = np.zeros((len(put), 3, 6))
        by[:, :, :3] = np.cross(left_jacobian(turn).T[None], own[:, None], axis=2).swapaxes(1, 2)
        by[:, :, 3:] = np.eye(3)
        return np.asarray(by * self.scales[-6:])

    # ---- what must hold

    def _slacks(
        self, z: Floats, here: Here, wants: Sequence[tuple[Floats, Floats]]
    ) -> list[tuple[str, Floats, Floats]]:
        """Slacks with their slopes, each with what is at fault where it is missed."""
        slacks: list[tuple[str, Floats, Floats]] = []
        if self.model.transmits or self.model.turns:
            slacks += self._transmission(z)  # first, where the goal "transmission" looks for them
        wide = here.along(self._stations.by) if self.model.slacks or self.model.angle else here
        if self.model.angle is not None:
            values, by = self.model.angle(wide)
            slacks.append(("transmission", values.ravel(), self._joined(by.reshape(values.size, -1))))
        if self.model.slacks:
            for place, slack in self.model.slacks:
                values, by = slack(wide)
                values = values - self.model.margins.get(place, 0.0)
                fault = self.model.task.musts[place].fault
                slacks.append((fault, values.ravel(), self._joined(by.reshape(values.size, -1))))
        for i, one in enumerate(self.model.wanted):
            if one.stations.free:
                slacks.append(("order", *self._order(z, i)))
        for i, must in self.model.most:
            at = slice(None) if must.at is None else list(must.at)
            residuals, by = wants[i][0][at], wants[i][1][at]
            height, height_by = self.model.wanted[i].heights(residuals, by)
            slacks.append(("error", must.most - height, -height_by))
        return slacks

    def _order(self, z: Floats, number: int) -> tuple[Floats, Floats]:
        """The ways between free inputs that follow each other, a round at most, in the seed's sense."""
        inputs, by = self.inputs(z)[number], self._stations.by[self._rows[number]]
        steps, steps_by = np.diff(inputs), np.diff(by, axis=0)
        period = self._periods[number]
        if period:
            steps = np.append(steps, inputs[0] + period - inputs[-1])
            steps_by = np.concatenate([steps_by, by[:1] - by[-1:]])
        way, unit = self._senses[number], float(self.loop.units[self.loop.input])
        return way * steps / unit, way * steps_by / unit

    def _joined(self, by: Floats) -> Floats:
        """Slopes (r, k + all unknowns), those by the free numbers and through the inputs, by all unknowns."""
        if not by.size:
            return by
        result = by[:, self._k :].copy()
        result[:, : self._k] += by[:, : self._k] * self.scales[: self._k]
        return result

    def _transmission(self, z: Floats) -> list[tuple[str, Floats, Floats]]:
        """The transmission angle of an RSSR over what is used, and that its input turns."""
        values, limits = self.values(z), self.model.task.limits
        (row,) = self.loop.row(values)
        result: list[tuple[str, Floats, Floats]] = []
        if self.model.transmits and len(self._stations.fixed):
            slack, by_row, by_input = transmission_slack(row, self._stations.inputs(z), limits)
            by = self._wide(self.loop.row_slopes(values, by_row)) + by_input[:, None] * self._stations.by
            result.append(("transmission", slack, by))
        if self.model.turns:
            slack, by_row = turning_slack(row)
            result.append(("motion type", slack, self._wide(self.loop.row_slopes(values, by_row))))
        return result

    def _figures(self, values: Floats, *, slopes: bool) -> tuple[Slacks, Slacks] | None:
        """Residuals of figures, and their slacks, each with its slopes."""
        model = self.model
        result: tuple[Any, Any] | None = ((), ())
        if model.searched.names:
            before = model.searched.motions
            result = model.searched.at(values, self._anchor, slopes=slopes)
            model.effort.take(model.searched.motions - before)
        if result is None:
            return None
        read = {
            name: [(float(own[0]), own[1])] for name, *own in zip(model.searched.names, *result, strict=True)
        }
        ends: list[tuple[float, Floats]] = []
        if model.angle_wants or model.angle_musts:
            both = model.in_line.ends(values, self._anchor, slopes=slopes)
            if both is None:
                return None
            ends, read["transmission_lowest"] = both, [min(both, key=lambda end: end[0])]
        each = [
            (want.weight * value, want.weight * by)
            for want in model.figure_wants
            # each end a height of its own: the lower of two has a kink where they are equal
            for own in (ends if self.minimax and self._by_ends(want) else read[want.name])
            for value, by in [want.residual(*own)]
        ]
        slacks = [
            (way * (value - end) / unit, way * by / unit)
            for must in model.figure_musts
            if must not in model.angle_musts
            for value, by in read[must.name]
            for way, end in ((1.0, must.least), (-1.0, must.most))
            if end is not None
            for unit in [max(abs(end), 1e-3)]
        ]
        for must in model.angle_musts:
            least = must.least or 0.0
            slacks += [((value - least) / max(least, 1.0), by / max(least, 1.0)) for value, by in ends]
        return self._stacked(each), self._stacked(slacks)

    def _by_ends(self, want: MeasureWant) -> bool:
        """Whether it is the least of two angles that shall be great."""
        return want in self.model.angle_wants and want.value == "great"

    def _stacked(self, rows: Sequence[tuple[float, Floats]]) -> Slacks:
        """Single values with slopes (k,) by the free numbers, as (r,) with those by all unknowns."""
        by = np.array([own for _, own in rows]).reshape(-1, self._k)
        return np.array([value for value, _ in rows]), self._wide(by)


def loop_of(task: DesignTask) -> TaskLoop:
    """The loop of a task, in closed form where output over input of an RSSR is all that is wanted."""
    draft = task.draft.holding(task.follow)
    linkage = draft.linkage
    ends = (linkage.drive.joint, linkage.drive.output) == (linkage.columns[0], linkage.columns[-1])
    readings = all(isinstance(want, SampledWant) and want.of_output for want in task.wants)
    bounds = all(isinstance(must, ResidualMust) for must in task.musts)
    plain = linkage.form == "rssr" and ends and readings and bounds
    return (RssrLoop if plain and task.wants else TaskLoop)(draft, task.names)


def pose_slacks(loop: TaskLoop, musts: Sequence[Must]) -> list[tuple[int, Callable[[Here], Slacks]]]:
    """What gives the slacks of each must about poses, with its place among the musts."""
    return [(i, must.slacks(loop)) for i, must in enumerate(musts) if isinstance(must, PoseMust)]


def _sense(inputs: Floats) -> float:
    """Which way inputs go, by most of their steps."""
    return 1.0 if (np.diff(inputs) >= 0).sum() * 2 >= len(inputs) - 1 else -1.0


def _spread(steady: Floats, by: Floats, stations: Stations, period: float) -> tuple[Floats, Floats]:
    """Inputs between those of a want, as many between any two: their fixed parts and slopes."""
    n = len(steady)
    first = np.arange(n if stations.round else n - 1)
    then = (first + 1) % n
    each = math.ceil(HELD / n)
    share = (np.arange(1, each) / each)[:, None]
    inputs = (1 - share) * steady[first] + share * (steady[then] + np.where(then == 0, period, 0.0))
    slopes = (1 - share)[:, :, None] * by[first] + share[:, :, None] * by[then]
    # between the first two, then between the next
    return inputs.T.ravel(), slopes.swapaxes(0, 1).reshape(-1, by.shape[1])
