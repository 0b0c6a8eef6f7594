"""The kinds of musts, each a module of its own, in the order in which messages name them."""

from sevenbar.design.task.musts.apart import Apart
from sevenbar.design.task.musts.box import InBox
from sevenbar.design.task.musts.cone import InCone
from sevenbar.design.task.musts.figure import FigureMust
from sevenbar.design.task.musts.most import Most
from sevenbar.design.task.musts.range import InRange
from sevenbar.design.task.task import MeasureMust, ResidualMust

MUSTS = (InRange, InCone, InBox, Apart, FigureMust, Most)


def measure_within(name: str, least: float | None = None, most: float | None = None) -> MeasureMust:
    """The must that holds a measure, as the engine needs it."""
    return FigureMust(name, least, most)


def residuals_within(want: int, most: float) -> ResidualMust:
    """The must that holds the residuals of a want, by its place, as the engine needs it."""
    return Most(want, most)
