"""One design task, one engine for any loop: free numbers within bounds, what is wanted, what must hold."""

from sevenbar.design.task.task import (
    Apart,
    Box,
    Cone,
    DesignTask,
    DwellWant,
    FigureMust,
    FigureWant,
    Free,
    FunctionWant,
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
    "Box",
    "Cone",
    "DesignTask",
    "DwellWant",
    "FigureMust",
    "FigureWant",
    "Free",
    "FunctionWant",
    "JointRange",
    "Most",
    "Must",
    "PathWant",
    "PoseWant",
    "StraightWant",
    "Want",
]
