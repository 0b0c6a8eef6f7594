"""Surveys of RSSRs with axes at any angle: the core draws them by their index, judges, and stores none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Floats
from sevenbar.kinematics.solvers.batches import WORDS, MotionTypes

#: The numbers of an RSSR with axes at any angle, in the order of the core's rows.
NUMBERS = ("M", "N", "L1", "L2", "L3", "D", "angle")

#: Verdicts in the core's order; the first is that a linkage does what is wanted.
VERDICTS = (
    "found",
    "size",
    "assembly",
    "change point",
    "motion type",
    "dead centre",
    "transmission",
    "error",
    "ball angle",
)

#: The core's survey and the tally of a part of it.
CoreSurvey = _core.Survey
RawTally = _core.RawTally


def core_survey(bounds: Floats, seed: int, **wish: Any) -> CoreSurvey:
    """The core's survey of linkages between bounds (7, 2) [parts of a length, rad]; `wish` as it takes it."""
    return _core.Survey(np.asarray(bounds, np.float64), seed, **wish)


@dataclass(frozen=True, eq=False)
class SurveyFigures:
    """What RSSRs (n,) are measured by; NaN where there is nothing.

    Motion types, limits (n, 4) [rad], swings [rad] and time ratios of both circuits (n, 2), and the least
    transmission angle over a whole turn of the input (n,) [rad].
    """

    types: MotionTypes
    limits: Floats
    swing: Floats
    time_ratio: Floats
    transmission: Floats


def survey_figures(numbers: Floats) -> SurveyFigures:
    """The figures of RSSRs (n, 7) with the numbers `NUMBERS`: the crank turns about z, its ball N above 0.

    The rocker turns about (sin, 0, cos) of the angle, M along it from (0, D, 0).
    Source: docs/theory_many.md, (21) and (22).
    """
    flat = np.asarray(numbers, np.float64).reshape(-1)
    codes, limits, swing, time_ratio, transmission = _core.survey_figures(flat)
    return SurveyFigures(WORDS[codes], limits, swing, time_ratio, transmission)
