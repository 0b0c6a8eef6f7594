"""The answer of a survey: the designs, why others were refused, and what came nearest where there is none."""

from __future__ import annotations

from dataclasses import dataclass

from sevenbar.design.candidates import Candidate, Refusal
from sevenbar.design.survey.loops import LoopSurvey
from sevenbar.design.survey.tally import SurveyTally
from sevenbar.design.survey.task import SurveyTask
from sevenbar.design.task.search import DesignsFound
from sevenbar.text.printing import Printed, lines, text_of


@dataclass(frozen=True, eq=False, repr=False)
class SurveyResult(Printed):
    """The answer of a survey: designs polished and checked, best first, and the tally of all linkages.

    `refusals` say why others of the best were no designs after all; `polished` were made better.
    """

    task: SurveyTask | LoopSurvey
    tally: SurveyTally
    candidates: tuple[Candidate, ...]
    refusals: tuple[Refusal, ...]
    polished: int
    #: The remark about a survey that was stopped; empty for one that ended by itself.
    unfinished: str = ""
    #: Of a design task: what the search that began with the best hundred found.
    found: DesignsFound | None = None

    @property
    def nearest(self) -> dict[str, str]:
        """By verdict, what came nearest to pass it: its figures and its numbers."""
        verdicts = self.task.verdicts
        return {verdicts[k]: self.task.words_of(verdicts[k], kept) for k, kept in self.tally.nearest.items()}

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
        found.task.heading,
        [
            ("answer", found.answer),
            ("designs", str(len(found.candidates))),
            ("unfinished", found.unfinished),
        ],
    )
