"""The plane of an RSSR in the paper's dimensions: many points at once, and how far each is from a change."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.description.draft import Draft
from sevenbar.design.maps.critical import NEARLY_REAL, ROUNDING, critical_gaps
from sevenbar.design.maps.plane import Kind, Plane, Take
from sevenbar.design.maps.window import MapAxis
from sevenbar.kinematics.measures import Measure
from sevenbar.kinematics.solvers.batches import CODES, RSSR_ROWS, rssr_motions, rssr_rows, rssr_types
from sevenbar.text.progress import Progress

#: Threads of the core: a map's batches are small, and its squares are sorted by one thread between them.
THREADS = 1

#: Two critical poses that meet at the edge of a square are so far from real in its middle [rad], times the
#: root of its width.
BIRTH = 2.0

#: Types that have no circuits, or none that can be distinguished.
WITHOUT = ("cannot-assemble", "change-point", "invalid")


class RssrPlane(Plane):
    """An RSSR of the paper's square axes."""

    exact = 1e-12
    # a change point is reported from 1e-6 rad on, which where four limits meet is 1e-6 of a dimension
    nudges = (1e-9, 1e-8, 1e-7, 1e-6)

    def __init__(
        self, draft: Draft, axes: tuple[MapAxis, MapAxis], input: str, samples: int, progress: Progress | None
    ) -> None:
        super().__init__(draft, axes, input, samples, progress)
        self._constant = {row: draft.dimension(f"rssr.{row}").value for row in RSSR_ROWS}
        self._moved = {axis.dimension.label: axis for axis in axes if axis.dimension.place[0] == "rssr"}
        self._follows = draft.dimension("rssr.L2").follows and "L2" not in self._moved
        linkage = draft.linkage
        self._side = "crank" if linkage.columns.index(input) == 0 else "rocker"
        self._speed = linkage.drive.speed

    def dimensions(self, points: Floats) -> Floats:
        """M, N, L1, L2, L3, D at each point, (6, n)."""
        moved = {
            axis.dimension.label: axis.value(shares)
            for axis, shares in zip(self.axes, points.T, strict=True)
            if axis.dimension.label in self._moved
        }
        return rssr_rows({**self._constant, **moved}, len(points), follows=self._follows)

    def numbers_at(self, points: Floats) -> Integers:
        """The number of the kind at each point as it is, (n,)."""
        self.count(len(points))
        codes, limits = rssr_types(self.dimensions(points), self._side, THREADS)
        names = np.array(CODES)[codes]
        circuits = np.where(names == "double-rocker", np.isfinite(limits).sum(axis=1) // 2, 2)
        circuits[np.isin(names, WITHOUT)] = 0
        found = np.empty(len(points), dtype=np.int64)
        for code, count in {*zip(codes.tolist(), circuits.tolist(), strict=True)}:
            found[(codes == code) & (circuits == count)] = self.number(Kind(CODES[code], count))
        return found

    def gaps(self, points: Floats, width: Floats) -> Floats | None:
        """Critical distances of the balls less the coupler [length], (n, 16).

        Those about to be born count too, so that a pair born inside a square is seen from its middle.
        """
        return critical_gaps(self.dimensions(points), np.maximum(NEARLY_REAL, BIRTH * np.sqrt(width)))

    def reach(self, width: Floats) -> Floats:
        """How much a gap [length] can change from the middle of squares of these widths to their corners.

        A dimension that changes by x moves a ball by x, so no distance by more; the coupler is a distance,
        and one that follows is `|(L1 - M, L3, N)|`.

        Source: docs/theory_design.md, (15).
        """
        rate, size = 0.0, max(map(abs, self._constant.values()))
        for label, axis in self._moved.items():
            rate += axis.span * (2.0 if self._follows and label != "D" else 1.0)
            size = max(size, abs(axis.low), abs(axis.high))
        return 0.5 * width * rate + ROUNDING * size

    def values_at(self, points: Floats, measures: Sequence[Measure], take: Take) -> Floats:
        """Measures at each point (n, measures), NaN where there is none."""
        speed = np.full(len(points), self._speed)
        for axis, shares in zip(self.axes, points.T, strict=True):
            if axis.dimension.place[0] == "drive":
                speed = axis.value(shares)
        motions = rssr_motions(self.dimensions(points), self._side, speed, THREADS)
        if not all(measure.name in motions.columns and measure.per == "circuit" for measure in measures):
            return super().values_at(points, measures, take)
        self.count(len(points))
        pick = np.fmin if take == "lowest" else np.fmax
        kept = np.ones(len(motions.circuit), dtype=bool) if isinstance(take, str) else motions.circuit == take
        found = np.full((len(points), len(measures)), np.nan)
        for column, measure in enumerate(measures):
            values = motions.columns[measure.name][kept]
            pick.at(found[:, column], motions.linkage[kept], np.where(np.isfinite(values), values, np.nan))
        return found
