"""All linkages for tasks whose number of answers theory counts: pairs of angles, poses of a link."""

from sevenbar.design.exact.answers import ExactAnswer, ExactAnswers
from sevenbar.design.exact.planar import planar_poses

__all__ = ["ExactAnswer", "ExactAnswers", "planar_poses"]
