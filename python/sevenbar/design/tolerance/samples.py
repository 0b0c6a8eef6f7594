"""Monte Carlo: designs with errors at random, each analysed exactly, beside the linear estimate.

The same errors go into the linear estimate, whose variance V is known. So with y the exact deviations of a
design along the cycle, l those of the linear estimate, and means over samples,

    bias b = mean(y - l),        ratio^2 = 1 + (mean(y^2 - l^2) - b^2) / V                                 (1)

estimate bias and ratio of standard deviations with the statistical error of the differences only, which is
far below that of either side alone.

Source: docs/theory_design.md, (8).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, whole_number
from sevenbar.design.course import SearchCourse
from sevenbar.design.tolerance.exact import ChangedDesigns
from sevenbar.design.tolerance.linear import Given, Linear, linear_estimate
from sevenbar.design.tolerance.sensitivities import Sensitivities
from sevenbar.errors import RequestError, SevenbarError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress, silent
from sevenbar.text.words import retold, say

#: Quantiles that are kept: the median, 95 % and the 3 sigma of a normal distribution.
LEVELS = (0.00135, 0.025, 0.5, 0.975, 0.99865)

#: The linear estimate holds where the ratio of standard deviations is within this of 1, and the bias within
#: this share of the standard deviation: tolerances are seldom known better than to a few per cent.
RATIO_HOLDS, BIAS_HOLDS = 0.05, 0.1

#: Statistical errors that are no sign of anything.
SURE = 3.0

#: Poses that are solved at once, so that their arrays stay in the processor's memory.
BLOCK = 20_000

#: Lost samples that are checked by the ordinary analysis.
LOOKED_AT = 40

#: The most samples.
MOST = 1_000_000


@dataclass(frozen=True, eq=False, repr=False)
class MonteCarlo(Printed):
    """Designs with errors at random, and what they tell of the linear estimate.

    Along the `linear.rows` (n,): `quantiles` (levels, n) of the deviations, at `LEVELS`, `mean` and
    `deviation` (n,), the standard deviation; all in the output's unit, of the samples that go round. Of the
    `count` samples `lost` do not, for reasons counted in `reasons` of `looked_at` of them. `ratio` is that of
    standard deviations over the cycle, exact to linear; `bias` the greatest along the cycle relative to the
    linear standard deviation, each with its statistical error. `greatest` is the greatest deviation seen.
    """

    linear: Linear
    seed: int
    count: int
    lost: int
    looked_at: int
    reasons: Mapping[str, int]
    quantiles: Floats
    mean: Floats
    deviation: Floats
    greatest: float
    ratio: float
    ratio_error: float
    bias: float
    bias_error: float

    @property
    def holds(self) -> bool | None:
        """Whether the linear estimate holds; `None` where the samples are too few to tell."""
        if self.lost or self._off_ratio(-SURE) or self._off_bias(-SURE):
            return False
        return None if self._off_ratio(SURE) or self._off_bias(SURE) else True

    def _off_ratio(self, errors: float) -> bool:
        """Whether the ratio is off, so many statistical errors farther."""
        return abs(self.ratio - 1) + errors * self.ratio_error > RATIO_HOLDS

    def _off_bias(self, errors: float) -> bool:
        return abs(self.bias) + errors * self.bias_error > BIAS_HOLDS

    @property
    def verdict(self) -> str:
        """Whether the linear estimate holds, and why."""
        if self.holds:
            return say(
                "the linear estimate holds: standard deviations agree within {ratio:g} %, the mean is off by "
                "less than {bias:g} of one",
                ratio=100 * RATIO_HOLDS, bias=BIAS_HOLDS,
            )  # fmt: skip
        if self.holds is None:
            return say(
                "whether the linear estimate holds cannot be decided with {count} samples; take more",
                count=self.count,
            )
        because = []
        if self.lost:
            lost = 100 * self.lost / self.count
            because.append(
                say("{share:.3g} % of the samples do not go round ({why})", share=lost, why=self.why_lost)
            )
        if self._off_ratio(-SURE):
            share = 100 * abs(self.ratio - 1)
            because.append(
                say("the standard deviation is {share:.3g} % greater", share=share)
                if self.ratio > 1
                else say("the standard deviation is {share:.3g} % smaller", share=share)
            )
        if self._off_bias(-SURE):
            because.append(say("the mean is off by {bias:.2g} standard deviations", bias=abs(self.bias)))
        return say("the linear estimate does not hold, because {reasons}", reasons=say(" and ").join(because))

    @property
    def why_lost(self) -> str:
        """What became of the samples that do not go round."""
        parts = say(", ").join(f"{count} {retold(reason)}" for reason, count in self.reasons.items())
        if self.looked_at < self.lost:
            return say("of {count} looked at {parts}", count=self.looked_at, parts=parts)
        return parts


def monte_carlo(
    of: Linkage | Sensitivities,
    given: Given | Linear,
    count: int = 2000,
    *,
    seed: int = 0,
    distribution: str = "normal",
    output: str | None = None,
    quantity: str = "position",
    progress: Progress = silent,
) -> MonteCarlo:
    """Exact deviations of an output for `count` designs with errors at random within their tolerances.

    Errors are independent and spread by `distribution`: uniform or triangular over the tolerance, or normal
    with the half width as three standard deviations, cut there. Each design is followed from the nominal one
    along the same pass of the circuit. The rest is as for `linear_estimate`. `progress` is called with
    (designs done, of how many, ""). Raises `RequestError` for a
    count below 2 and a seed that is none.

        >>> import sevenbar as sb
        >>> found = monte_carlo(sb.load("rssr"), {"L1": 0.1, "L2": 0.1}, 200)
        >>> found.lost, found.holds
        (0, True)
    """
    count = whole_number("count", count, 2, MOST, "a number of samples")
    seed = whole_number("seed", seed, 0, None, "a seed")
    if isinstance(given, Linear):
        linear = given
    else:
        linear = linear_estimate(of, given, distribution=distribution, output=output, quantity=quantity)
    changes = linear.tolerances.drawn(count, linear.distribution, np.random.default_rng(seed))
    exact = np.empty((changes.shape[1], len(linear.rows)))
    gap = np.zeros(changes.shape[1], dtype=bool)
    whole_turn = linear.found.circuit.goes_round and len(linear.rows) == len(linear.status)
    block = max(1, BLOCK // len(linear.rows))
    course = SearchCourse(len(exact), progress)
    for part, result, determinants in ChangedDesigns(linear).in_blocks(changes.T, block):
        exact[part] = result
        if whole_turn:
            gap[part] = _gaps(determinants)
        course.step(done=len(determinants))
    lost = gap | np.isnan(exact).any(axis=1)
    selected = exact[~lost]
    reasons, looked_at = _reasons(linear, changes.T[lost])
    if len(selected) < 2:
        raise RequestError(
            f"tolerance: {int(lost.sum())} of {count} samples do not go round; give smaller tolerances"
        )
    return MonteCarlo(
        linear=linear,
        seed=seed,
        count=count,
        lost=int(lost.sum()),
        looked_at=looked_at,
        reasons=reasons,
        quantiles=np.quantile(selected, LEVELS, axis=0),
        mean=selected.mean(axis=0),
        deviation=selected.std(axis=0, ddof=1),
        greatest=float(np.abs(selected).max()),
        **_agreement(linear, selected, (linear.slopes @ changes).T[~lost]),
    )


def _agreement(linear: Linear, exact: Floats, estimate: Floats) -> dict[str, float]:
    """Ratio and bias by (1), with their statistical errors; `exact` and `estimate` are (samples, rows)."""
    root = math.sqrt(len(exact))
    beside = exact - estimate
    off = beside.mean(axis=0)
    variance = float((linear.deviation**2).mean())
    if variance == 0.0:
        # the output does not depend on any of the dimensions
        return {"ratio": 1.0, "ratio_error": 0.0, "bias": 0.0, "bias_error": 0.0}
    more = (exact**2 - estimate**2).mean(axis=1)
    ratio = math.sqrt(max(1 + (float(more.mean()) - float((off**2).mean())) / variance, 0.0))
    scale = math.sqrt(variance)
    row = int(np.argmax(np.abs(off)))
    return {
        "ratio": ratio,
        "ratio_error": float(more.std(ddof=1)) / root / (2 * max(ratio, np.finfo(float).tiny) * variance),
        "bias": float(off[row]) / scale,
        "bias_error": float(beside[:, row].std(ddof=1)) / root / scale,
    }


def _gaps(determinants: Floats) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which samples have inputs between two rows at which their loop does not close.

    The determinant goes as the root of the distance from a dead centre, so its square is smooth and would be
    negative in a gap: as the parabola through the lowest three of it shows.
    """
    squares = determinants**2
    place = np.argmin(squares, axis=1)
    index = np.arange(len(squares))
    low = squares[index, place]
    before, after = squares[index, place - 1], squares[index, (place + 1) % squares.shape[1]]
    bend, slope = before + after - 2 * low, (after - before) / 2
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(low - slope**2 / (2 * bend) < 0)


def _reasons(linear: Linear, changes: Floats) -> tuple[dict[str, int], int]:
    """What the ordinary analysis says of the first lost designs, counted, and how many it looked at."""
    result = linear.found
    counts: Counter[str] = Counter()
    for change in changes[:LOOKED_AT]:
        try:
            motion = result.changed(change).motion(
                result.samples, input=result.input_name, output=result.output_name
            )
        except SevenbarError:
            counts["cannot be analysed"] += 1
            continue
        types = {circuit.motion_type for circuit in motion.circuits}
        if not types:
            counts["cannot be assembled"] += 1
        elif result.circuit.motion_type in types:
            counts["left their pass of the circuit"] += 1
        else:
            counts[f"became {motion.motion_type}"] += 1
    return dict(counts.most_common()), int(sum(counts.values()))
