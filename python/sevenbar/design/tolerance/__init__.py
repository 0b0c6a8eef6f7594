"""What tolerances of the dimensions do to the motion: exact sensitivities, worst case, Monte Carlo."""

from sevenbar.design.tolerance.inverse import tolerances_for
from sevenbar.design.tolerance.linear import Linear, linear_estimate
from sevenbar.design.tolerance.samples import MonteCarlo, monte_carlo
from sevenbar.design.tolerance.sensitivities import Sensitivities, sensitivities
from sevenbar.design.tolerance.worst import WorstCase, worst_case

__all__ = [
    "Linear",
    "MonteCarlo",
    "Sensitivities",
    "WorstCase",
    "linear_estimate",
    "monte_carlo",
    "sensitivities",
    "tolerances_for",
    "worst_case",
]
