"""What a survey is asked: bounds of the numbers, what is wanted, what must hold. Any part follows from it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sevenbar.arrays import Floats, real_array
from sevenbar.design.limits import MOST_RATIO, USUAL_SIZE, Limits
from sevenbar.design.survey.drawn import FORMAT, Drawn
from sevenbar.design.survey.tally import Kept, SurveyTally
from sevenbar.design.wish import Wish
from sevenbar.errors import RequestError, check_word, shown, suggestion
from sevenbar.kinematics.solvers.batches import CODES, NUMBERS, VERDICTS, CoreSurvey, core_survey

#: Readings at which linkages are compared: about so far apart [rad], and how many.
READING_STEP, FEWEST_READINGS, MOST_READINGS = math.radians(7.5), 7, 16

#: Ratios to L3 where no bounds are given, and the angle between the axes [rad].
USUAL_BOUNDS: Mapping[str, tuple[float, float]] = {
    "M": (-3.0, 3.0),
    "N": (-3.0, 3.0),
    "L1": (0.1, 3.0),
    "L2": (0.2, 4.0),
    "L3": (1.0, 1.0),
    "D": (-3.0, 3.0),
    "angle": (0.0, math.pi),
}

#: How the linkage that came nearest to pass a verdict is described.
NEAREST = {
    "transmission": "near enough, least transmission angle {transmission:.4g} deg",
    "error": "error {error:.4g} deg",
    "ball angle": "near enough, ball angles {crank:.4g} and {rocker:.4g} deg",
}

#: By what linkages that do what is wanted are ranked.
RANKS = ("error", "transmission", "ball angle")


@dataclass(frozen=True, eq=False)
class Travel:
    """The output moves one way through `output` while the input turns through `input` [rad].

    Raises `RequestError`.
    """

    input: float
    output: float

    def __post_init__(self) -> None:
        for name, value in (("input", self.input), ("output", abs(self.output))):
            if not 0 < value < math.tau:
                raise RequestError(
                    f"{name} range: {math.degrees(value):g} deg is no part of a turn; "
                    "give two angles less than 360 deg apart, as in 0:90deg"
                )

    @property
    def title(self) -> str:
        """The travel in words."""
        return f"{math.degrees(self.input):g} deg in, {math.degrees(self.output):g} deg out"


@dataclass(frozen=True, eq=False)
class SwingWish:
    """The output of a crank-rocker swings through `angle` [rad], slower one way by `time_ratio` >= 1.

    Raises `RequestError`.
    """

    angle: float
    time_ratio: float = 1.0

    def __post_init__(self) -> None:
        if not 0 < self.angle < math.tau:
            raise RequestError(
                f"swing: {math.degrees(self.angle):g} deg is no swing of a rocker; "
                "give an angle between 0 and 360 deg"
            )
        # beyond it the crank would stand still for all purposes on its quick way
        if not 1 <= self.time_ratio <= MOST_RATIO:
            raise RequestError(
                f"time ratio: {self.time_ratio:g} is not offered; it is the slower stroke over the quicker: "
                f"give 1 to {MOST_RATIO:g}"
            )

    @property
    def slow(self) -> float:
        """The turn of the input on the slower stroke [rad]."""
        return math.tau * self.time_ratio / (1 + self.time_ratio)

    @property
    def title(self) -> str:
        """The swing in words."""
        return f"swing {math.degrees(self.angle):g} deg, time ratio {self.time_ratio:g}"


@dataclass(frozen=True, eq=False)
class SurveyTask(Drawn):
    """What is wanted of RSSRs within bounds.

    `bounds` of `NUMBERS`: lengths relative to one another, the angle between the axes in radians; those not
    given are `USUAL_BOUNDS`. `want` is a function or pairs (`Wish`), a `Travel` or a `SwingWish`; within
    `tolerance` [rad] of it a linkage does what is wanted. It must keep `transmission_lowest` [rad] over the
    range that is used, `motion_type`, `ratio` (longest length over shortest link), and turn its balls no
    further than `ball_angle` [rad] from the best seat of each. Raises `RequestError`.
    """

    #: What a processor judges in some tenths of a second.
    part_size = 2**18
    verdicts = VERDICTS

    want: Wish | Travel | SwingWish
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    count: int = 10**6
    seed: int = 0
    tolerance: float = math.radians(1)
    transmission_lowest: float = math.radians(30)
    ball_angle: float = math.pi
    motion_type: str | None = None
    ratio: float = MOST_RATIO
    rank: str = "error"

    def __post_init__(self) -> None:
        if not isinstance(self.bounds, Mapping):
            raise RequestError(
                f"bounds: {shown(self.bounds)} are none; give ranges by name, as in {{'L1': (0.2, 1)}}"
            )
        for name, ends in self.bounds.items():
            if name not in NUMBERS:
                known = ", ".join(NUMBERS)
                raise RequestError(
                    f"bounds: {shown(name)} is no number of an RSSR; "
                    f"{suggestion(name, NUMBERS)}give some of {known}"
                )
            if real_array(name, ends).size != 2:
                raise RequestError(f"{name}: {shown(ends)} is no range; give two numbers that rise")
        for name, (low, high) in self.table.items():
            if not (math.isfinite(low) and math.isfinite(high) and low <= high):
                raise RequestError(f"{name}: {low:g}:{high:g} is no range; give two numbers that rise")
            if name in ("L1", "L2", "L3") and low <= 0:
                raise RequestError(f"{name}: {low:g}:{high:g} holds no length only; give numbers > 0")
        lengths = [table for name, table in self.table.items() if name != "angle"]
        longest = max(abs(x) for ends in lengths for x in ends)
        shortest = min(self.table[name][1] for name in ("L1", "L2", "L3"))
        if longest > 1e6 * shortest:
            raise RequestError(f"bounds: lengths from {shortest:g} to {longest:g} are no linkage to build")
        self.check_counts()
        if not 0 < self.tolerance <= math.pi:
            degrees = math.degrees(self.tolerance)
            raise RequestError(f"tolerance: {degrees:g} deg is none; give an angle > 0")
        Limits(self.transmission_lowest, motion_type=self.motion_type)
        # the core's smallest cones are those within half a space
        if not (0 < self.ball_angle <= math.pi / 2 or self.ball_angle == math.pi):
            degrees = math.degrees(self.ball_angle)
            raise RequestError(
                f"ball angle: {degrees:g} deg is no limit; give an angle up to 90 deg, or 180 deg for none"
            )
        if not self.ratio > 1:
            raise RequestError(f"ratio: {self.ratio:g} is no ratio of lengths; give a number > 1")
        check_word("rank", self.rank, RANKS)
        if isinstance(self.want, Wish) and self.want.zeros is not None:
            raise RequestError("zeros: are chosen by a survey; leave them out")
        if isinstance(self.want, SwingWish):
            refuse_without_swing(self.motion_type)

    @property
    def table(self) -> dict[str, tuple[float, float]]:
        """The bounds of all numbers."""
        return {name: self.bounds.get(name, USUAL_BOUNDS[name]) for name in NUMBERS}

    def tally(self, part: int) -> SurveyTally:
        """The tally of a part."""
        linkages = self.linkages(part)
        return SurveyTally.of(self.core().tally(linkages.start, len(linkages)))

    @property
    def readings(self) -> tuple[Floats, Floats]:
        """The readings (n,) [rad] of input and output at which linkages are compared, from 0."""
        if isinstance(self.want, SwingWish):
            return np.empty(0), np.empty(0)
        if isinstance(self.want, Travel):
            inputs = np.linspace(0.0, self.want.input, _readings_over(self.want.input))
            return inputs, self.want.output * inputs / self.want.input
        wish = self.want
        if wish.function is not None:
            span = wish.input[-1] - wish.input[0]
            inputs = np.linspace(wish.input[0], wish.input[-1], _readings_over(span))
            outputs = wish.function(inputs)
        else:
            places = np.unique(np.linspace(0, wish.input.size - 1, MOST_READINGS).round().astype(int))
            inputs, outputs = wish.input[places], wish.output[places]
        return inputs - inputs[0], outputs - outputs[0]

    def core(self) -> CoreSurvey:
        """The core's survey of this task."""
        wish: dict[str, Any] = {
            "tolerance": self.tolerance,
            "motion_type": None if self.motion_type is None else CODES.index(self.motion_type),
            "ratio": self.ratio,
            "transmission": self.transmission_lowest,
            "cones": [self.ball_angle] * 2,
            "seats": [None, None],
            "rank": self.rank.replace("ball angle", "cone"),
        }
        if isinstance(self.want, SwingWish):
            wish["swing"] = [self.want.angle, self.want.slow]
        else:
            wish["readings"] = np.array(self.readings)
            wish["ends_only"] = wish["monotone"] = isinstance(self.want, Travel)
        return core_survey(np.array(list(self.table.values())), self.seed, **wish)

    def request(self) -> dict[str, Any]:
        """What the survey is, as plain values: two surveys with one request have the same answer."""
        return {
            "format": FORMAT,
            "wanted": self.want.title,
            "readings": [own.tolist() for own in self.readings],
            **{name: value for name, value in vars(self).items() if name != "want"},
            "bounds": {name: list(ends) for name, ends in self.table.items()},
            "part_size": self.part_size,
        }

    @property
    def heading(self) -> str:
        """What it is."""
        return f"Survey of RSSRs for {self.want.title}"

    def words_of(self, verdict: str, kept: Kept) -> str:
        """A linkage that came nearest to pass a verdict: its figures and its numbers."""
        figures = NEAREST[verdict].format(
            transmission=math.degrees(kept.transmission),
            error=math.degrees(kept.error),
            crank=math.degrees(kept.balls[0]),
            rocker=math.degrees(kept.balls[1]),
        )
        (row,) = drawn_numbers(self, [kept.index])
        numbers = [
            f"{name} {math.degrees(value) if name == 'angle' else value:.4g}"
            for name, value in zip(NUMBERS, row, strict=True)
        ]
        return f"{figures}: linkage {kept.index}, {', '.join(numbers)} deg"

    def text(self) -> str:
        """What must hold, in words."""
        parts = [f"within {math.degrees(self.tolerance):g} deg"]
        if self.transmission_lowest:
            parts.append(f"transmission angle >= {math.degrees(self.transmission_lowest):g} deg")
        if self.ball_angle < math.pi:
            parts.append(f"ball angles <= {math.degrees(self.ball_angle):g} deg")
        if self.motion_type is not None:
            parts.append(self.motion_type)
        return "; ".join([*parts, f"longest length <= {self.ratio:g} shortest links"])


def _readings_over(span: float) -> int:
    return min(max(round(span / READING_STEP) + 1, FEWEST_READINGS), MOST_READINGS)


def refuse_without_swing(motion_type: str | None) -> None:
    """Raises `RequestError` for a motion type that has no swing with a time ratio."""
    if motion_type not in (None, "crank-rocker"):
        raise RequestError(
            f"motion type: a {motion_type} has no swing with a time ratio; give crank-rocker, or none"
        )


def drawn_numbers(task: SurveyTask, indices: Sequence[int]) -> Floats:
    """The numbers (n, 7) of linkages by their indices."""
    return task.core().numbers(np.array(indices, dtype=np.int64))


def scale_of(numbers: Floats) -> float:
    """What makes the longest of the numbers (7,) the usual size [mm]."""
    return USUAL_SIZE / float(np.abs(numbers[:6]).max())
