"""The kinds of wants, each a module of its own, in the order in which messages name them."""

from sevenbar.design.task.wants.dwell import DwellWant
from sevenbar.design.task.wants.figure import FigureWant
from sevenbar.design.task.wants.function import FunctionWant
from sevenbar.design.task.wants.path import PathWant
from sevenbar.design.task.wants.pose_at import PoseAtWant
from sevenbar.design.task.wants.poses import PoseWant
from sevenbar.design.task.wants.straight import StraightWant

WANTS = (FunctionWant, PathWant, PoseWant, FigureWant, DwellWant, StraightWant, PoseAtWant)
