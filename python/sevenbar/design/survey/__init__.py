"""Searches by number: linkages drawn, each judged, the best polished; or what comes nearest."""

from sevenbar.design.survey.loops import LoopSurvey
from sevenbar.design.survey.run import SurveyResult, survey
from sevenbar.design.survey.tally import Kept, SurveyTally
from sevenbar.design.survey.task import SurveyTask, SwingWish, Travel

__all__ = ["Kept", "LoopSurvey", "SurveyResult", "SurveyTally", "SurveyTask", "SwingWish", "Travel", "survey"]


def __dir__() -> list[str]:
    return sorted(__all__)
