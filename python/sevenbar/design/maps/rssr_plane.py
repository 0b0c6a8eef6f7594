"""The plane of an RSSR in the paper's dimensions: many points at once, and how far each is from a change.

With crank and rocker turned at will, the distance of the balls is a function on the torus of both angles. The
poses that a coupler allows are one level of it, and a level changes its shape only at a critical value.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.description.draft import Draft
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

#: Powers of the trigonometric polynomial whose zeros are the critical angles, and samples that give it.
DEGREE, SAMPLES = 4, 16

#: Complex zeros this near to the real circle [rad] count as real: a fourfold zero is known to 1e-4 only. One
#: too many costs time and no truth, since it can only cause a cell to be examined more closely.
NEARLY_REAL = 1e-3

#: Of two signs that fit about as well both are kept: shares of the slope's terms.
EITHER_SIGN = 1e-6

#: Rounding of a critical distance, relative to the greatest dimension; a double zero keeps half its digits.
ROUNDING = 1e-7

#: Problems whose companion matrices are solved in one call.
CHUNK = 4096


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
        result = np.empty(len(points), dtype=np.int64)
        for code, count in {*zip(codes.tolist(), circuits.tolist(), strict=True)}:
            result[(codes == code) & (circuits == count)] = self.number(Kind(CODES[code], count))
        return result

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
        if not all(measure.batch and measure.per == "circuit" for measure in measures):
            return super().values_at(points, measures, take)
        speed = np.full(len(points), self._speed)
        for axis, shares in zip(self.axes, points.T, strict=True):
            if axis.dimension.place[0] == "drive":
                speed = axis.value(shares)
        motions = rssr_motions(self.dimensions(points), self._side, speed, THREADS)
        self.count(len(points))
        pick = np.fmin if take == "lowest" else np.fmax
        selected = (
            np.ones(len(motions.circuit), dtype=bool) if isinstance(take, str) else motions.circuit == take
        )
        result = np.full((len(points), len(measures)), np.nan)
        for column, measure in enumerate(measures):
            assert measure.batch is not None
            values = measure.batch(motions)[selected]
            pick.at(
                result[:, column], motions.linkage[selected], np.where(np.isfinite(values), values, np.nan)
            )
        return result


def _half_angle() -> Floats:
    """Coefficients in t (9, 9) of `exp(i k x) (1 + t^2)^4` for k = -4 .. 4, with `t = tan(x / 2)`."""
    rows = []
    for k in range(-DEGREE, DEGREE + 1):
        row = np.ones(1, dtype=complex)
        for sign, count in ((1j, DEGREE + k), (-1j, DEGREE - k)):
            for _ in range(count):
                row = np.convolve(row, [1.0, sign])
        rows.append(row)
    return np.array(rows)


_HALF_ANGLE = _half_angle()


def critical_gaps(dimensions: Floats, near: Floats) -> Floats:
    """Critical distances of the balls less the coupler's length [length], NaN where there is none: (n, 16).

    `dimensions` (6, n) are M, N, L1, L2, L3, D; complex zeros nearer to the real circle than `near` (n,)
    [rad] count, too. For a crank angle a the balls are nearest and farthest at
    `f = g -+ L3 sqrt(H)`, `H = (D - L1 sin a)^2 + N^2`, twice f the squared distance; the critical a are
    zeros of `(M sin a - D cos a)^2 H - L3^2 cos^2 a (D - L1 sin a)^2`, of degree four.

    Source: docs/theory_design.md, (12) to (14).
    """
    parts = [
        _gaps(dimensions[:, start : start + CHUNK], near[start : start + CHUNK])
        for start in range(0, dimensions.shape[1], CHUNK)
    ]
    return np.concatenate(parts) if parts else np.empty((0, 4 * DEGREE))


def _gaps(dimensions: Floats, nearly: Floats) -> Floats:
    size = np.abs(dimensions).max(axis=0)
    M, N, L1, L2, L3, D = (row[:, None] for row in dimensions / size)

    def polynomial(a: Floats) -> Floats:
        sin, cos = np.sin(a), np.cos(a)
        reach = D - L1 * sin
        return np.asarray((M * sin - D * cos) ** 2 * (reach**2 + N**2) - (L3 * cos * reach) ** 2)

    # where the polynomial is greatest there is no zero, so none is near t = infinity
    circle: Floats = np.arange(SAMPLES, dtype=np.float64) * (math.tau / SAMPLES)
    values = polynomial(circle[None, :])
    turn = circle[np.abs(values).argmax(axis=1)] + math.pi
    values = polynomial(circle[None, :] + turn[:, None])
    powers = np.fft.fft(values, axis=1)[:, np.arange(-DEGREE, DEGREE + 1)] / SAMPLES
    coefficients = (powers @ _HALF_ANGLE).real
    companion = np.zeros((len(turn), 2 * DEGREE, 2 * DEGREE))
    companion[:, 1:, :-1] = np.eye(2 * DEGREE - 1)
    companion[:, :, -1] = -coefficients[:, :-1] / coefficients[:, -1:]
    zeros = np.linalg.eigvals(companion)
    near = np.abs(zeros.imag) < nearly[:, None] * (1 + np.abs(zeros) ** 2) / 2
    a = turn[:, None] + 2 * np.arctan(zeros.real)

    sin, cos = np.sin(a), np.cos(a)
    reach = D - L1 * sin
    root = np.hypot(reach, N)
    middle = 0.5 * (M * M + N * N + L1 * L1 + L3 * L3 + D * D) - L1 * (M * cos + D * sin)
    # the slope of f by a, both parts times the root
    first, second = L1 * (M * sin - D * cos) * root, -L1 * L3 * cos * reach
    both = np.abs(first) + np.abs(second) + root
    gaps = []
    for sign in (-1.0, 1.0):
        slope, other = np.abs(first + sign * second), np.abs(first - sign * second)
        fits = near & ((slope <= other) | (slope <= EITHER_SIGN * both))
        squared = np.maximum(2 * (middle + sign * L3 * root), 0.0)
        gaps.append(np.where(fits, np.sqrt(squared) - L2, np.nan))
    return np.asarray(np.concatenate(gaps, axis=1) * size[:, None])
