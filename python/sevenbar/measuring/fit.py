"""Least squares over the parameters that the data identify, and the choice of these.

Repeats of an input are one place of the curve: however often a row is measured again, it says no more of the
others. So with m_j rows at place j, N places and k parameters,

    s^2 = sum m_j mean_j(r)^2 / (N - k)                                                                   (1)

which is the residual variance where no input is repeated, and expects the same where repeats have noise of
their own; copies of a row change no interval.

Source: docs/theory_design.md, (10) and (11).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.kinematics.numbers.least_squares import nearest_least, settled
from sevenbar.measuring.doubtful import EXACT, first_of
from sevenbar.measuring.model import CurveModel
from sevenbar.measuring.passes import MAY_BE_OPEN

#: Standard error [share of the linkage's size, or rad] beyond which a direction counts as not identifiable:
#: the curve bends over such a distance, so that (1), which takes it for straight, would mean nothing.
UNIDENTIFIED = 0.03

#: Singular value, relative to the greatest, that is zero up to rounding.
ROUNDING = 1e-9

#: A share in a direction below which a dimension does not take part in it.
TAKES_PART = 1e-2

#: How often the choice of what is held is checked again, and the noise of each quantity.
MOST_ROUNDS, MOST_WEIGHINGS = 8, 40

#: Factor by which the noise of a quantity may still change.
WEIGHED = 1e-10

#: Share of the sum of squares that may still be gained where it is only to be known how large the noise is.
ENOUGH = 1e-2

#: A fall of the sum, relative to it, below which rounding hides it; a share of the sum that is rounding below
#: which there is nothing to gain: the residual to a ten-thousandth.
FLAT, NOTHING = 1e-10, 1e-8

#: How much the first steps are held back, and a step that is so short, where longer ones do not lead on, that
#: the way is closed.
FIRST, CLOSED = 1e-6, 1e-8

#: Evaluations of one search.
MOST_EVALUATIONS = 400

#: Lines that a message names.
MOST_LINES = 8


class CurveFit:
    """The parameters of a model that explain its rows best; `seen(best residual)` is called on the way."""

    def __init__(self, model: CurveModel, wanted: list[int], seen: Callable[[float], object]) -> None:
        self.model, self.wanted, self.seen = model, wanted, seen
        self.z = model.first.copy()
        self.noise = {q: float(np.ptp(v)) or 1.0 for q, v in model.values.items()}
        self.evaluations = 0
        self.held: list[int] = []
        #: Lines of rows that lie, in the end, beyond a limit of the input.
        self.left_out: list[int] = []
        #: Why the parameters are not those of a minimum, if they are not.
        self.unfinished: RequestError | None = None
        self._least = math.inf

    @property
    def free(self) -> list[int]:
        """The parameters that are found."""
        return [k for k in self.wanted if k not in self.held]

    @property
    def sites(self) -> int:
        """How many places of the curve were measured."""
        return int(self.model.sites.max(initial=-1)) + 1

    @property
    def count(self) -> int:
        """How many values were measured at different places."""
        return self.sites * len(self.model.values)

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the residual."""
        return self.count - len(self.free)

    def residual(self, z: Floats) -> Floats | None:
        """Computed less measured relative to the noise; `None` where the loop does not close."""
        computed = self.model.computed(z)
        if computed is None:
            return None
        if (share := self.share(computed)) < self._least:
            self._least = share
            self.seen(share)
        return np.concatenate([(computed[q] - v) / self.noise[q] for q, v in self.model.values.items()])

    def share(self, computed: Mapping[str, Floats]) -> float:
        """Root mean square of the differences relative to the range, of the quantity that fits worst."""
        model = self.model
        parts = [(computed[q] - v) / model.extents[q] for q, v in model.values.items()]
        return math.sqrt(max(float(np.mean(part**2)) for part in parts))

    def found(self) -> Floats:
        """The residual of the parameters that were found."""
        residual = self.residual(self.z)
        if residual is None:
            raise ArithmeticError("the poses of a fit were lost")
        return residual

    def jacobian(self, columns: Sequence[int]) -> Floats:
        """Derivatives (n, columns) of the residual at the parameters that were found."""
        return self._slopes(self.z, columns)

    def _slopes(self, z: Floats, columns: Sequence[int]) -> Floats:
        slopes = self.model.slopes(z)
        return np.concatenate([slopes[q][:, columns] / self.noise[q] for q in slopes])

    def run(self) -> dict[int, tuple[int, ...]]:
        """Finds the parameters; gives what is held as the data do not identify it, and what undoes each."""
        unidentified = self._unidentified(0.0)
        exactly = False
        for turn in range(MOST_ROUNDS):
            self.held = list(unidentified)
            # what the noise hides shows long before the minimum is known to all digits
            exactly = exactly or turn >= MOST_ROUNDS // 2
            end = self._weigh(exactly=exactly)
            again = self._unidentified(self.deviation())
            if turn >= MOST_ROUNDS // 2:
                # a choice that would come and go stays
                both = [*unidentified, *again]
                again = {k: again.get(k, unidentified.get(k, ())) for k in both}
            if set(again) == set(unidentified):
                if exactly:
                    break
                exactly = True
            unidentified = again
        if end == "unsettled":
            self.unfinished = RequestError(
                f"{self.model.before.source}: no best dimensions were found in {self.evaluations} "
                "evaluations; free fewer with --free or --hold"
            )
        elif end == "settled":
            self.unfinished = None
        return again

    def _closed_way(self) -> RequestError:
        """What keeps the fit from its minimum."""
        model, source = self.model, self.model.before.source
        if short := model.too_short:
            return RequestError(
                f"{source}: the least residual is where {short} is no length any more; "
                f"hold it with --hold {short}, or check which joint was measured, units and zeros"
            )
        lines = first_of(model.before.line[model.rows[model.lost]].tolist(), MOST_LINES)
        return RequestError(
            f"{source}: the dimensions that would explain these data do not let the loop close at the inputs "
            f"of lines {lines}; check the circuit, units and zeros, or hold more dimensions"
        )

    def _weigh(self, *, exactly: bool) -> str:
        """Least squares, the noise of each quantity being taken from its own differences."""
        self._begin()
        for _ in range(MOST_WEIGHINGS):
            end = self._least_squares(0.0 if exactly else ENOUGH)
            if len(self.noise) == 1 or not self.free:
                break
            parts = np.split(self.found(), len(self.noise))
            share = math.sqrt(1 - len(self.free) / self.count)
            factors = {}
            for (quantity, noise), part in zip(self.noise.items(), parts, strict=True):
                deviation = math.sqrt(self._squares(part) / self.sites) / share
                # of exact data there is no noise to weigh by
                factors[quantity] = max(deviation, EXACT * self.model.extents[quantity] / noise)
            self.noise = {quantity: noise * factors[quantity] for quantity, noise in self.noise.items()}
            if max(abs(math.log(factor)) for factor in factors.values()) < (WEIGHED if exactly else ENOUGH):
                break
        return end

    def _begin(self) -> None:
        """Begins a search where the last one ended, or at the design, where the residual is less."""
        start = self.model.first.copy()
        start[self.free] = self.z[self.free]
        start = self.model.filled(start)
        if np.array_equal(start, self.z):
            return
        values = self.model.values
        design = sum(
            float(np.sum(((self.model.at_first[q] - v) / self.noise[q]) ** 2)) for q, v in values.items()
        )
        residual = self.residual(start)
        self.evaluations += 1
        if residual is not None and float(residual @ residual) < design:
            self.z = start
        else:
            self.z = self.model.first.copy()
            self.model.back_to(self.z)

    def _least_squares(self, enough: float) -> str:
        free, scales = self.free, self.model.scales
        if self.count <= len(free):
            rows = len(self.model.begin)
            repeats = ""
            if self.sites < rows:
                repeats = f" at {self.sites} places, as {rows - self.sites} rows repeat the input of another,"
            raise RequestError(
                f"{self.model.before.source}: {self.count} measured values{repeats} cannot identify "
                f"{len(free)} dimensions; measure at more inputs, or free fewer with --free or --hold"
            )
        if not free:
            return "settled"

        def spread(part: Floats) -> Floats:
            z: Floats = self.z.copy()
            z[free] = part * scales[free]
            return self.model.filled(z)

        def residual(part: Floats) -> Floats | None:
            return self.residual(spread(part))

        def slopes(part: Floats) -> Floats:
            return self._slopes(spread(part), free)

        extents = self.model.extents
        exact = sum(len(v) * (EXACT * extents[q] / self.noise[q]) ** 2 for q, v in self.model.values.items())
        while True:
            nearest = nearest_least(
                residual, slopes, self.z[free] / scales[free], evaluations=MOST_EVALUATIONS, first=FIRST,
                enough=enough or FLAT, shortest=CLOSED, nothing=NOTHING * exact)  # fmt: skip
            assert nearest is not None
            self.evaluations += nearest.evaluations
            self.z = spread(nearest.z)
            lost, total = self.model.lost, len(self.model.before.line)
            if nearest.end == "settled" or nearest.cost <= exact or enough:
                if not enough:
                    self.z = spread(settled(residual, slopes, nearest.z))
                return "settled"
            if nearest.end != "closed":
                return "unsettled"
            self.unfinished = self._closed_way()
            if not lost.size or len(self.left_out) + lost.size > MAY_BE_OPEN * total:
                return "closed"
            # a few rows at a limit of the input, which has moved
            self.left_out += self.model.before.line[self.model.rows[lost]].tolist()
            self.model.leave_out(lost)
            if not self.model.back_to(self.z):
                return "closed"

    def _squares(self, part: Floats) -> float:
        """The sum of squares of (1), of one quantity."""
        sites = self.model.sites
        sums, counts = np.bincount(sites, part), np.bincount(sites)
        return float(np.sum(sums**2 / counts))

    def deviation(self) -> float:
        """The standard deviation s of the residual, relative to the noise, (1)."""
        parts = np.split(self.found(), len(self.noise))
        return math.sqrt(sum(map(self._squares, parts)) / max(self.freedom, 1))

    def _unidentified(self, deviation: float) -> dict[int, tuple[int, ...]]:
        """What the data cannot identify, given the residual's deviation, and what undoes a change of each."""
        triangle = np.linalg.qr(self.jacobian(self.wanted), mode="r")
        _, values, rows = np.linalg.svd(triangle, full_matrices=True)
        values = np.concatenate([values, np.zeros(len(self.wanted) - len(values))])
        blind = (values <= ROUNDING * values.max(initial=0.0)) | (deviation > UNIDENTIFIED * values)
        directions = rows[blind].T
        held: list[int] = []
        left = directions.copy()
        for _ in range(directions.shape[1]):
            shares = np.linalg.norm(left, axis=1)
            # zeros of the test bench are guesses, dimensions come from a drawing and stay
            worth = shares * np.where(np.array(self.wanted) >= len(self.model.names) - 2, 0.1, 1.0)
            place = next(k for k, w in enumerate(worth) if w >= 0.5 * worth.max())
            held.append(place)
            along = left[place] / np.linalg.norm(left[place])
            left = left - np.outer(left @ along, along)
        if not held:
            return {}
        own = directions @ np.linalg.inv(directions[held])
        result = {}
        for column, place in enumerate(held):
            shares = np.abs(own[:, column])
            others = [k for k in range(len(shares)) if k != place and shares[k] > TAKES_PART * shares.max()]
            result[self.wanted[place]] = tuple(self.wanted[k] for k in others)
        return dict(sorted(result.items()))
