"""What is at a point of a map: the motion type and number of circuits, and measures of the motion."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.description.draft import Draft
from sevenbar.design.maps.window import MapAxis
from sevenbar.errors import DescriptionError, NotCoveredError, RequestError
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.measures import Measure, rows_of
from sevenbar.text.progress import Progress, silent
from sevenbar.text.words import say

#: Which circuit's value counts where a linkage has several: the best one, or that of an index.
Take = Literal["highest", "lowest"] | int

#: The type of a point that describes no linkage.
UNMADE = "invalid"

#: Types that may be met on a boundary only; such points take the type a little to one side.
DOUBTFUL = ("change-point", "mixed", "two-inputs", "not-followed")

#: The directions to that side: one for all, so that a line through many points has one side, and one across
#: it where the line itself runs that way.
ASIDE, ACROSS = (1.0, 0.7), (0.7, -1.0)


@dataclass(frozen=True, order=True)
class Kind:
    """What a linkage can do: its motion type, and in how many circuits."""

    motion_type: str
    circuits: int

    @property
    def label(self) -> str:
        """Both in words."""
        if self.circuits == 0:
            return say(self.motion_type)
        return say(
            "{motion_type}, {count} circuit{s}",
            motion_type=say(self.motion_type), count=self.circuits, s="s" * (self.circuits > 1),
        )  # fmt: skip


class Plane(ABC):
    """What a map is drawn of; points are shares of both ranges, (n, 2).

    `kinds` are those met so far, and the number of a kind is its place there.
    """

    #: Boundaries are halved down to this share of the ranges.
    exact: float
    #: How far from a doubtful point its kind is read, one after the other [share of the ranges].
    nudges: tuple[float, ...]

    def __init__(
        self, draft: Draft, axes: tuple[MapAxis, MapAxis], input: str, samples: int, progress: Progress | None
    ) -> None:
        self.draft, self.axes, self.input, self.samples = draft, axes, input, samples
        self.kinds: list[Kind] = []
        self._progress = progress or silent
        self._done = self._planned = 0
        self.count(0)

    def expect(self, count: int) -> None:
        """New work begins: about so many linkages are in sight."""
        self._done, self._planned = 0, count
        self.count(0)

    def count(self, done: int) -> None:
        """Reports that so many more linkages are done, of those in sight."""
        self._done += done
        self._progress(self._done, self._planned)

    @abstractmethod
    def numbers_at(self, points: Floats) -> Integers:
        """The number of the kind at each point as it is, (n,)."""

    def kinds_at(self, points: Floats) -> Integers:
        """The number of the kind at each point, (n,); points on a boundary take the kind next to it."""
        result = self.numbers_at(points)
        ways = [(nudge, ASIDE) for nudge in self.nudges] + [(self.nudges[-1], ACROSS)]
        for nudge, way in ways:
            doubtful = np.isin(
                result, [n for n, kind in enumerate(self.kinds) if kind.motion_type in DOUBTFUL]
            )
            if not doubtful.any():
                break
            result[doubtful] = self.numbers_at(points[doubtful] + nudge * np.array(way))
        return result

    def gaps(self, points: Floats, width: Floats) -> Floats | None:  # noqa: ARG002
        """How far the middles of squares are from changes of the kind (n, m), NaN where there is none.

        `width` (n,) is that of the squares; `None` where such distances are not known.
        """
        return None

    def reach(self, width: Floats) -> Floats:
        """How much a gap can change from the middle of squares of these widths to their corners, (n,)."""
        return np.full(len(width), np.inf)

    def values_at(self, points: Floats, measures: Sequence[Measure], take: Take) -> Floats:
        """Measures at each point (n, measures), NaN where there is none."""
        rows = [[measure_of(motion, m, take) for m in measures] for motion in self.motions(points)]
        return np.array(rows, dtype=np.float64).reshape(len(points), len(measures))

    def number(self, kind: Kind) -> int:
        """The number of a kind, new or met before."""
        if kind not in self.kinds:
            self.kinds.append(kind)
        return self.kinds.index(kind)

    def motions(self, points: Floats) -> Iterator[Motion | None]:
        """The motion at each point, `None` where there is none; each counts when its turn is over."""
        self._planned = max(self._planned, self._done + len(points))
        for share in points:
            values = {axis.name: float(axis.value(s)) for axis, s in zip(self.axes, share, strict=True)}
            try:
                linkage = self.draft.with_values(values).linkage
                yield linkage.motion(self.samples, input=self.input)
            except (DescriptionError, RequestError, NotCoveredError):
                yield None
            self.count(1)


def measure_of(motion: Motion | None, measure: Measure, take: Take) -> float:
    """The measure of a motion, of the circuits that `take` chooses; NaN where it has none."""
    if motion is None:
        return math.nan
    rows = rows_of(motion, [measure])
    if measure.per == "circuit" and isinstance(take, int):
        rows = [row for row in rows if row["circuit"] == take]
    result = [row[measure.name] for row in rows]
    numbers = [float(v) for v in result if isinstance(v, (int, float)) and math.isfinite(v)]
    if not numbers:
        return math.nan
    return min(numbers) if take == "lowest" else max(numbers)


class LoopPlane(Plane):
    """Any loop: every point is a motion of its own, and nothing is known between points."""

    exact = 2.5e-4
    nudges = (1e-5, 1e-4, 1e-3)

    def numbers_at(self, points: Floats) -> Integers:
        """The number of the kind at each point as it is, (n,)."""
        kinds = [
            Kind(UNMADE, 0) if motion is None else Kind(motion.motion_type, len(motion.circuits))
            for motion in self.motions(points)
        ]
        return np.array([self.number(kind) for kind in kinds], dtype=np.int64)
