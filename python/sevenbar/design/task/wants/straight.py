"""The want of a straight line: a named point goes along one over a range of inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.values import Length, Text, key
from sevenbar.design.task.flaws import Flaws, not_positive, point_flaws, range_flaws
from sevenbar.design.task.given import reading_span
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.passes import InputPass
from sevenbar.design.task.placing import Placing
from sevenbar.design.task.task import DesignTask, SampledWant, WantForm, linkage_size
from sevenbar.design.task.values import OF_INPUT, Samples, Span, Weight
from sevenbar.design.task.wanted import (
    Bound,
    PlacesCurve,
    Stations,
    TaskStart,
    Used,
    Wanted,
    WantFact,
    distances,
)
from sevenbar.design.task.words import ends_in_words
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage


class StraightForm(WantForm):
    """A named point goes along a straight line."""

    kind: Annotated[Literal["straight"], key("this want")]
    point: Annotated[Text, key("the name of the linkage's point")]
    range: Annotated[Span, key("of the input", OF_INPUT)]
    length: Annotated[Length | None, key("how far it must go at least", "length")] = None
    samples: Annotated[Samples, key("inputs of the range that count")] = 41
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> StraightWant:
        ends = reading_span("range", self.range, linkage, linkage.drive.joint)
        return StraightWant(self.point, ends, self.length, self.samples, self.weight)


@dataclass(frozen=True)
class StraightWant(SampledWant):
    """A named point moves along a straight line, a free one, while the input goes over a range (low, high).

    `length` is how far it must go at least [length], between the two places farthest along the line; a design
    that goes less far is refused. Residuals, its distances from the line at `samples` inputs, are relative to
    it; without one they are relative to the linkage's size, and a point that rests is straight.
    """

    form = StraightForm
    fault = "length"
    ease = "a shorter length of the straight line"

    point: str
    inputs: tuple[float, float]
    length: float | None = None
    samples: int = 41
    weight: float = 1.0

    @property
    def points(self) -> tuple[str, ...]:
        return (self.point,)

    def residual_unit(self, linkage: Linkage) -> float:
        return linkage_size(linkage) if self.length is None else self.length

    def flaws(self, task: DesignTask) -> Flaws:
        yield from point_flaws(task.draft.linkage, self.point)
        yield from range_flaws(task.draft.linkage, self.inputs, self.samples)
        if self.length is not None:
            yield from not_positive("length", self.length, "length")

    def words(self, linkage: Linkage) -> str:
        length = "" if self.length is None else f", {self.length:g} {linkage.length_unit} or longer"
        ends = ends_in_words(self.inputs, linkage, linkage.drive.joint)
        return f"{self.point} along a straight line over {ends}{length}"

    def input_range(self) -> tuple[float, float]:
        return min(self.inputs), max(self.inputs)

    def in_loop(self, loop: TaskLoop) -> LineWanted:
        return LineWanted(loop, self)


class LineWanted(Wanted):
    """Distances of a point p from the line through two unknown places a and b, in three parts.

    r = p - a - t (b - a),    t = (p - a) . (b - a) / |b - a|^2

    Where a length is given, the point must go as far: the distance of the two places farthest along the line.
    """

    turns = False

    def __init__(self, loop: TaskLoop, want: StraightWant) -> None:
        self.weight = want.weight
        self.numbers, self._name = [loop.named(want.point)], want.point
        self._length = want.length
        self.unit = want.residual_unit(loop.linkage)
        inputs = np.linspace(*want.inputs, want.samples)
        self.stations = Stations(inputs, np.zeros((want.samples, 6)), np.full(6, loop.size))
        self.count = 3 * want.samples
        self._length_unit = loop.linkage.length_unit

    def residuals(self, here: Here, u: Floats) -> tuple[Floats, Floats]:
        p, by = here.points[:, self.numbers[0]], here.points_by[:, self.numbers[0]]
        a, direction = u[:3], u[3:] - u[:3]
        square = float(direction @ direction)
        off = p - a
        t = off @ direction / square
        across = np.eye(3) - np.outer(direction, direction) / square
        apart = (off - t[:, None] * direction).ravel()
        if not by.shape[-1]:
            return apart / self.unit, np.empty((len(apart), 0))
        slopes = np.einsum("ij,njk->nik", across, by)
        t_a = (-direction - off + 2 * t[:, None] * direction) / square
        t_b = (off - 2 * t[:, None] * direction) / square
        slopes[:, :, -6:-3] += (t[:, None, None] - 1) * np.eye(3) - np.einsum("i,nj->nij", direction, t_a)
        slopes[:, :, -3:] += -t[:, None, None] * np.eye(3) - np.einsum("i,nj->nij", direction, t_b)
        return apart / self.unit, slopes.reshape(3 * len(p), -1) / self.unit

    def heights(self, residuals: Floats, by: Floats) -> tuple[Floats, Floats]:
        return distances(residuals, by)

    def bound(self, here: Here) -> Bound | None:
        if self._length is None:
            return None
        p, by = here.points[:, self.numbers[0]], here.points_by[:, self.numbers[0]]
        first, last = farthest(p)
        gone = p[last] - p[first]
        size = float(np.linalg.norm(gone))
        slopes = gone @ (by[last] - by[first]) / max(size, 1e-300) / self.unit
        asked = f"at least {self._length:g} {self._length_unit} is asked"
        missed = f"the point goes {size:.4g} {self._length_unit}, {asked}"
        return Bound(np.array([size - self._length]) / self.unit, slopes[None], missed)

    def starts(self, one: InputPass, placing: Placing | None, *, scaled: bool) -> list[TaskStart]:
        curve = one.point(self._name)
        result = []
        for rows in one.begins(self.stations.fixed, free=False)[1][:1]:
            p = curve[rows]
            middle = p.mean(axis=0)
            direction = np.linalg.svd(p - middle)[2][0]
            along = (p - middle) @ direction
            error = float(((p - middle - along[:, None] * direction) ** 2).sum() / p.size / self.unit**2)
            u = np.concatenate([middle + along.min() * direction, middle + along.max() * direction])
            result.append(TaskStart(u, rows, error, placing))
        return result

    def errors(self, circuit: Circuit, rows: slice, u: Floats, placing: Placing) -> Floats:
        direction = (u[3:] - u[:3]) / np.linalg.norm(u[3:] - u[:3])
        off = np.cross(circuit.point(self._name).position[rows] - u[:3], direction)
        return np.asarray(np.linalg.norm(off, axis=1))

    def _taken(self, used: Used, q: Floats) -> Floats:
        """Where the point is (n, 3)."""
        return used.points(self.numbers, q)[:, 0]

    def facts(self, used: Used) -> Sequence[WantFact]:
        p = self._taken(used, used.poses)
        first, last = farthest(p)
        travel = float(np.linalg.norm(p[last] - p[first]))
        return (WantFact("travel", self._length_unit, travel, tabled=True),)

    def curve(self, used: Used) -> PlacesCurve:
        taken = self._taken(used, used.station_poses)
        begin, line = used.u[:3], used.u[3:] - used.u[:3]
        along = (taken - begin) @ line / float(line @ line)
        wanted = begin + along[:, None] * line
        return PlacesCurve(self._taken(used, used.poses), wanted, np.linalg.norm(taken - wanted, axis=1))


def farthest(p: Floats) -> tuple[int, int]:
    """The two of some places (n, 3) that are farthest from each other along their best line."""
    along = p @ np.linalg.svd(p - p.mean(axis=0), full_matrices=False)[2][0]
    return int(along.argmin()), int(along.argmax())
