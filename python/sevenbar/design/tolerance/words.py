"""How outputs and inputs of an estimate are named, and in which units people read them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.linear import Linear
from sevenbar.text.words import say


def output_words(linear: Linear) -> str:
    """The output as a sentence has it: "angle of rocker", "velocity of slider", "P.x"."""
    one = linear.found.outputs[linear.found.place(linear.output, linear.quantity)]
    if not one.joint:
        return one.name
    word = "angle" if one.quantity == "position" and one.unit == "rad" else one.quantity
    return say("{quantity} of {joint}", quantity=say(word), joint=one.owner)


def output_unit(linear: Linear) -> str:
    """The unit in which people read the output: degrees for angles."""
    return "deg" if linear.unit == "rad" else linear.unit.replace("^2", "²")


def output_values(linear: Linear, values: npt.ArrayLike) -> Floats:
    """Values of the output in that unit."""
    array = np.asarray(values, dtype=np.float64)
    return np.degrees(array) if linear.unit == "rad" else array


def shown_input(linear: Linear, value: float) -> str:
    """An input as people read it."""
    found = linear.found
    if found.input_turns:
        return f"{math.degrees(value):.4g}°"
    return f"{value:.4g} {found.linkage.length_unit}"
