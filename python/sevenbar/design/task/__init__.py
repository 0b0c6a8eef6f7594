"""One design task, one engine for any loop: free numbers within bounds, what is wanted, what must hold."""

from sevenbar.design.task.check import Met, TaskDesign
from sevenbar.design.task.file.reader import read_task
from sevenbar.design.task.front import ParetoFront, ParetoPoint, pareto
from sevenbar.design.task.search import DesignsFound, designed
from sevenbar.design.task.task import (
    Apart,
    DesignTask,
    DwellWant,
    FigureMust,
    FigureWant,
    FreeNumber,
    FunctionWant,
    InBox,
    InCone,
    InRange,
    Most,
    Must,
    PathWant,
    PoseWant,
    StraightWant,
    Want,
)

__all__ = [
    "Apart",
    "DesignTask",
    "DesignsFound",
    "DwellWant",
    "FigureMust",
    "FigureWant",
    "FreeNumber",
    "FunctionWant",
    "InBox",
    "InCone",
    "InRange",
    "Met",
    "Most",
    "Must",
    "ParetoFront",
    "ParetoPoint",
    "PathWant",
    "PoseWant",
    "StraightWant",
    "TaskDesign",
    "Want",
    "designed",
    "pareto",
    "read_task",
]
