"""One design task, one engine for any loop: free numbers within bounds, what is wanted, what must hold."""

from sevenbar.design.task.check import Design, Met
from sevenbar.design.task.file.reader import read_task
from sevenbar.design.task.front import ParetoFront, ParetoPoint, pareto
from sevenbar.design.task.search import DesignsFound, designed
from sevenbar.design.task.task import (
    Apart,
    Cone,
    DesignTask,
    DwellWant,
    FigureMust,
    FigureWant,
    FreeNumber,
    FunctionWant,
    InBox,
    JointRange,
    Most,
    Must,
    PathWant,
    PoseWant,
    StraightWant,
    Want,
)

__all__ = [
    "Apart",
    "Cone",
    "Design",
    "DesignTask",
    "DesignsFound",
    "DwellWant",
    "FigureMust",
    "FigureWant",
    "FreeNumber",
    "FunctionWant",
    "InBox",
    "JointRange",
    "Met",
    "Most",
    "Must",
    "ParetoFront",
    "ParetoPoint",
    "PathWant",
    "PoseWant",
    "StraightWant",
    "Want",
    "designed",
    "pareto",
    "read_task",
]
