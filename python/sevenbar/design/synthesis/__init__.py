"""Linkages for a wanted motion: a function, a path, a swing with its time ratio."""

from sevenbar.design.candidates import Candidate
from sevenbar.design.limits import Limits
from sevenbar.design.synthesis.function.generation import function_generation
from sevenbar.design.synthesis.function.swing import swing_generation
from sevenbar.design.synthesis.path.generation import path_generation

__all__ = ["Candidate", "Limits", "function_generation", "path_generation", "swing_generation"]
