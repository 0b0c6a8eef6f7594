"""The must of a box: points and joints stay in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.values import Vector, key
from sevenbar.design.task.flaws import Flaws
from sevenbar.design.task.loop import Here, Slacks, TaskLoop
from sevenbar.design.task.task import DesignTask, MustForm, PoseMust, SampledWant, Want
from sevenbar.design.task.values import Words
from sevenbar.errors import shown, suggestion
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage

#: A place whose slopes are all below this part of the size stands still.
STILL = 1e-12


class BoxMust(MustForm):
    """Points and joints stay in a box."""

    kind: Annotated[Literal["box"], key("this must")]
    low: Annotated[Vector, key("its least x, y, z in the report frame", "length")]
    high: Annotated[Vector, key("its greatest x, y, z", "length")]
    names: Annotated[Words | None, key("of points and joints; left out, all of them")] = None

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> InBox:
        points = [point.name for point in linkage.points if point.link in linkage.graph.moving]
        every = tuple(dict.fromkeys([*points, *(joint.name for joint in linkage.joints)]))
        return InBox(self.low, self.high, self.names or every)


@dataclass(frozen=True)
class InBox(PoseMust):
    """Named points and joints stay between the corners `low` and `high` (3,) at all poses that are used."""

    form = BoxMust
    fault = "box"
    ease = "a larger box"
    in_space = "a box"

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    names: tuple[str, ...]

    @property
    def points(self) -> tuple[str, ...]:
        return self.names

    def turns(self, linkage: Linkage) -> bool:
        return False

    def flaws(self, task: DesignTask) -> Flaws:
        linkage = task.draft.linkage
        for axis, low, high in zip("xyz", self.low, self.high, strict=True):
            if not low < high:
                yield (
                    "low",
                    f"empty along {axis}: {low:g} is not below {high:g}; give the lower corner in low",
                )
        known = [*(p.name for p in linkage.points), *(j.name for j in linkage.joints)]
        if not self.names:
            yield "names", f"none given; give some of {', '.join(known)}"
        for name in self.names:
            if name not in known:
                yield (
                    "names",
                    f"no point or joint {shown(name)}; {suggestion(name, known)}"
                    f"this linkage has {', '.join(known)}",
                )
        for i, want in enumerate(task.wants if task.placement == "fixed" else ()):
            every = [want.places_of(name) for name in self.names] if isinstance(want, SampledWant) else []
            for places in every:
                out = np.flatnonzero([] if places is None else self._out(places))
                if out.size:
                    yield (
                        "names",
                        f"place {out[0] + 1} of want {i + 1} lies outside the box; widen it, or want less",
                    )

    def _out(self, places: Floats) -> Floats:
        """Which of places (n, 3) lie outside."""
        return np.asarray(((places < self.low) | (places > self.high)).any(axis=1))

    def start_flaws(self, loop: TaskLoop, circuits: Sequence[Circuit], q: Floats) -> Flaws:
        numbers = self._places(loop)
        here = loop.here(loop.start, q)
        for name, number in zip(self.names, numbers, strict=True):
            place = here.points[0, number]
            by = here.points_by[:, number] * [*loop.scales, loop.units[loop.input]]
            if self._out(place[None])[0] and np.abs(by).max() < STILL * loop.size:
                at = ", ".join(f"{x + 0.0:.6g}" for x in place)
                yield (
                    "names",
                    f"{name} stands still at ({at}), outside the box; leave it out, or give a wider box",
                )

    def words(self, linkage: Linkage) -> str:
        sides = ", ".join(f"{low:g}:{high:g}" for low, high in zip(self.low, self.high, strict=True))
        return f"{', '.join(self.names)} in the box {sides} {linkage.length_unit}"

    def _places(self, loop: TaskLoop) -> list[int]:
        """The numbers of its points and joints."""
        points = [point.name for point in loop.linkage.points]
        return [loop.named(name) if name in points else loop.joint(name) for name in self.names]

    def slacks(self, loop: TaskLoop) -> Callable[[Here], Slacks]:
        numbers = self._places(loop)
        low, high = np.array(self.low), np.array(self.high)

        def slacks(here: Here) -> Slacks:
            places, by = here.points[:, numbers], here.points_by[:, numbers]
            values = np.concatenate([places - low, high - places], axis=1) / loop.size
            slopes = np.concatenate([by, -by], axis=1) / loop.size
            result = values.reshape(len(values), -1)
            return result, slopes.reshape(*result.shape, by.shape[-1])

        return slacks
