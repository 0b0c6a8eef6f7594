"""Where a point of any loop is, for any values of its numbers, and how it follows them and the input."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.kinematics.following import Following
from sevenbar.kinematics.geometry import Point
from sevenbar.kinematics.sensitivity import NumberedLoop, Numbers, Slopes


@dataclass(frozen=True, eq=False)
class Reached:
    """A point (n, 3) at closed poses, its derivative by the input (n, 3), and by dimensions (n, 3, k)."""

    position: Floats
    by_input: Floats
    by_dimension: Floats


class PointLoop:
    """The loop of a draft with one point: values (all,) are those of its dimensions in the file's units.

    `varied` are the numbers, among `dimensions`, of those that may change, by which derivatives are. A
    coupler that the draft lets follow does so unless it is one of them.
    """

    def __init__(self, draft: Draft, point: Point, varied: Sequence[int] = ()) -> None:
        linkage = draft.linkage
        self._numbers = Numbers(linkage)
        self._place = [known.name for known in linkage.points].index(point.name)
        self.dimensions = self._numbers.dimensions
        self.start = self._numbers.nominal
        self.varied = tuple(varied)
        self.input = linkage.columns.index(linkage.drive.joint)
        #: The longest dimension [length].
        self.size = self._numbers.size
        #: What is 1 of each column (columns,): a radian, or the size.
        self.units = self._numbers.scales
        self._coupler = Following.among(self.dimensions, self.varied)
        self._loop: tuple[bytes, NumberedLoop] | None = None
        self._slopes: tuple[bytes, Slopes] | None = None

    def _whole(self, values: Floats) -> Floats:
        """The values with a coupler that follows."""
        return values if self._coupler is None else self._coupler.whole(values)

    def _at(self, values: Floats) -> NumberedLoop:
        """The loop of these values, kept for the next question."""
        key = values.tobytes()
        if self._loop is None or self._loop[0] != key:
            only = [*self.varied, *([self._coupler.own] if self._coupler else ())]
            self._loop = key, self._numbers.loop(self.input, self._whole(values), only)
        return self._loop[1]

    def _here(self, values: Floats, q: Floats) -> Slopes:
        """The derivatives at poses (n, columns), kept for the next question."""
        key = values.tobytes() + q.tobytes()
        if self._slopes is None or self._slopes[0] != key:
            self._slopes = key, self._at(values).slopes(q, 0)
        return self._slopes[1]

    def poses(self, values: Floats, q: Floats) -> Floats:
        """Rows of the analysis (n, columns) as poses of the loop."""
        return self._numbers.poses(q, self._whole(values))

    def position(self, values: Floats, q: Floats) -> Floats:
        """The point (n, 3) at poses (n, columns)."""
        return self._here(values, q).points[:, self._place, 0]

    def closed(self, values: Floats, x: Floats, q: Floats) -> Floats:
        """The poses (n, columns) at inputs x (n,), by Newton's method from those nearby.

        NaN where it leads nowhere, to a dead centre of the input, or over one.
        """
        found = self._at(values).followed(x, q)[0][0]
        found[np.isnan(self._here(values, found).by_input[:, 0]).all(axis=1)] = np.nan
        return np.asarray(found)

    def reached(self, values: Floats, q: Floats) -> Reached:
        """The point at closed poses (n, columns), with its exact derivatives."""
        here = self._here(values, q)
        by = np.swapaxes(here.points_by_number[:, self._place, 0], 1, 2)
        count = len(self.varied)
        by_dimension = by[:, :, :count].copy()
        if self._coupler is not None:
            for number, part in zip(self._coupler.leaders, self._coupler.slopes(values), strict=True):
                if number in self.varied:
                    by_dimension[:, :, self.varied.index(number)] += part * by[:, :, count]
        place = self._place
        return Reached(here.points[:, place, 0], here.points_by_input[:, place, 0], by_dimension)

    def openings(self, values: Floats, q: Floats) -> tuple[int, ...]:
        """The varied dimensions that cannot change without opening the loop, at closed poses (n, columns)."""
        opening = self._here(values, q).opening
        return tuple(number for number, opens in zip(self.varied, opening, strict=False) if opens)

    def reach(self, most: Mapping[int, float]) -> float | None:
        """How far the point can be from the origin if each number is `most` or less; `None` if that is open.

        It is open where joints slide, and of a drawing.
        """
        word, point = self._numbers.word, self._numbers.points[self._place]
        letters = {step.letter for step in word.steps[: point.steps]}
        if self.dimensions[0].place[0] == "joint" or letters & {"P", "H"}:
            return None
        slides = [k for product in (*word.fixed[: point.steps], point.frame) for k in product.slides]
        coordinates = point.at if point.place is None else [most[k] for k in point.place]
        return sum(most[k] for k in slides) + math.hypot(*coordinates)
