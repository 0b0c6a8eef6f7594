"""All linkages for tasks whose number of answers theory counts: pairs of angles, poses of a link."""

from sevenbar.design.exact.answers import ExactAnswer, ExactAnswers
from sevenbar.design.exact.bennett import bennett_poses
from sevenbar.design.exact.cylinders import cc_dyads, rccc_poses
from sevenbar.design.exact.function import function_pairs
from sevenbar.design.exact.planar import planar_poses
from sevenbar.design.exact.spherical import spherical_orientations

__all__ = [
    "ExactAnswer",
    "ExactAnswers",
    "bennett_poses",
    "cc_dyads",
    "function_pairs",
    "planar_poses",
    "rccc_poses",
    "spherical_orientations",
]
