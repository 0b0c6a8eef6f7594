"""The answer of a survey: the designs, why others were refused, and what came nearest where there is none."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sevenbar.design.candidates import Candidate, Refusal
from sevenbar.design.survey.tally import SurveyTally
from sevenbar.design.survey.task import SurveyTask, drawn_numbers
from sevenbar.kinematics.surveys import NUMBERS, VERDICTS
from sevenbar.text.printing import Printed, lines, text_of

#: How the linkage that came nearest to pass a question is described.
NEAREST = {
    "transmission": "near enough, least transmission angle {transmission:.4g} deg",
    "error": "error {error:.4g} deg",
    "ball angle": "near enough, ball angles {crank:.4g} and {rocker:.4g} deg",
}


@dataclass(frozen=True, eq=False, repr=False)
class SurveyResult(Printed):
    """The answer of a survey: designs polished and checked, best first, and the tally of all linkages.

    `refusals` say why others of the best were no designs after all; `polished` were made better.
    """

    task: SurveyTask
    tally: SurveyTally
    candidates: tuple[Candidate, ...]
    refusals: tuple[Refusal, ...]
    polished: int
    #: The remark about a survey that was stopped; empty for one that ended by itself.
    unfinished: str = ""

    @property
    def nearest(self) -> dict[str, str]:
        """By verdict, what came nearest to pass it: its figures and its numbers."""
        found = {}
        for verdict, kept in self.tally.nearest.items():
            crank, rocker = map(math.degrees, kept.balls)
            figures = NEAREST[VERDICTS[verdict]].format(
                transmission=math.degrees(kept.transmission),
                error=math.degrees(kept.error),
                crank=crank,
                rocker=rocker,
            )
            (row,) = drawn_numbers(self.task, [kept.index])
            numbers = [
                f"{name} {math.degrees(value) if name == 'angle' else value:.4g}"
                for name, value in zip(NUMBERS, row, strict=True)
            ]
            found[VERDICTS[verdict]] = f"{figures}: linkage {kept.index}, {', '.join(numbers)} deg"
        return found

    @property
    def answer(self) -> str:
        """The answer in one sentence."""
        count = f"{self.tally.count:,}".replace(",", " ")
        if self.tally.found:
            return f"{self.tally.found} of {count} do it"
        return f"none of {count} does it"


@text_of.register(SurveyResult)
def _(found: SurveyResult) -> str:
    return lines(
        f"Survey of RSSRs for {found.task.want.title}",
        [
            ("answer", found.answer),
            ("designs", str(len(found.candidates))),
            ("unfinished", found.unfinished),
        ],
    )
