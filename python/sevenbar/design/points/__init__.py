"""Points of moving links: acceleration poles, least acceleration, wanted paths, inertia."""

from sevenbar.design.points.inertia import Inertia, Mass, inertia
from sevenbar.design.points.least import LeastPoint, least_acceleration_point, least_point
from sevenbar.design.points.nearest import NearestPath, nearest_path_point
from sevenbar.design.points.poles import AccelerationPoles, acceleration_poles

__all__ = [
    "AccelerationPoles",
    "Inertia",
    "LeastPoint",
    "Mass",
    "NearestPath",
    "acceleration_poles",
    "inertia",
    "least_acceleration_point",
    "least_point",
    "nearest_path_point",
]
