"""One design task, one engine for any loop: free numbers within bounds, what is wanted, what must hold."""

from sevenbar.design.task.check import Met, TaskDesign
from sevenbar.design.task.file.reader import read_task
from sevenbar.design.task.front import ParetoFront, ParetoPoint, pareto
from sevenbar.design.task.musts.apart import Apart
from sevenbar.design.task.musts.box import InBox
from sevenbar.design.task.musts.cone import InCone
from sevenbar.design.task.musts.figure import FigureMust
from sevenbar.design.task.musts.most import Most
from sevenbar.design.task.musts.range import InRange
from sevenbar.design.task.search import DesignsFound, designed
from sevenbar.design.task.task import DesignTask, FreeNumber, Must, Want
from sevenbar.design.task.wants.dwell import DwellWant
from sevenbar.design.task.wants.figure import FigureWant
from sevenbar.design.task.wants.function import FunctionWant
from sevenbar.design.task.wants.path import PathWant
from sevenbar.design.task.wants.pose_at import PoseAtWant
from sevenbar.design.task.wants.poses import PoseWant
from sevenbar.design.task.wants.straight import StraightWant

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
    "PoseAtWant",
    "PoseWant",
    "StraightWant",
    "TaskDesign",
    "Want",
    "designed",
    "pareto",
    "read_task",
]
