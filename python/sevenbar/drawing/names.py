"""Names as figures write them: of joints, of columns, of what is along an axis; numbers with their units."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.units import LENGTHS, length_sizes
from sevenbar.text.words import say

#: The name of a joint that nobody named, and of its columns: theta_5, theta_5.2.
_UNNAMED = re.compile(r"theta_(\d+)(\.\d+)?")

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")

#: The letters of the RSSR paper for its two balls, by their place in the loop.
RSSR_LETTERS = {1: "A", 2: "B"}

#: From this value on a length or its rate is written in metres, if its unit is metric and smaller.
LARGE = 1e4


def short(text: str, width: int) -> str:
    """The text, cut to so many letters."""
    return text if len(text) <= width else text[: width - 1] + "…"


def shown_name(name: str, width: int = 40) -> str:
    """The name of a joint or a column as people write it: as given, but theta_5 as θ₅; cut to a width.

    >>> shown_name("theta_12"), shown_name("theta_3.1"), shown_name("crank")
    ('θ₁₂', 'θ₃.1', 'crank')
    """
    result = _UNNAMED.fullmatch(name)
    if result is None:
        return short(name, width)
    return f"θ{result[1].translate(_SUBSCRIPTS)}{result[2] or ''}"


def joint_label(linkage: Loop, joint: int) -> str:
    """What a joint is called in a picture: A, B in an RSSR of the paper; else its name, pin or number."""
    name = linkage.joints[joint].name
    if linkage.form == "rssr" and joint in RSSR_LETTERS:
        return RSSR_LETTERS[joint]
    return str(joint + 1) if _UNNAMED.fullmatch(name) else short(_pin_of(linkage, name), 24)


def _pin_of(linkage: Loop, name: str) -> str:
    """The pin of more than two links that a joint of this name is a hinge of, or the name itself."""
    pin, _, number = name.rpartition(".")
    hinges = {joint.name for joint in linkage.joints} if number.isdecimal() else set()
    return pin if {f"{pin}.1", f"{pin}.2"} <= hinges else name


def named_together(
    names: Sequence[str], places: Floats, near: float, without: Container[int] = ()
) -> dict[int, list[str]]:
    """The names of places (n, k, ..) in n poses, those of one group together, by the group's first place.

    A group has the places that are nearer to its first one than `near` in every pose, each name once; places
    in `without` are left out.
    """
    named: dict[int, list[str]] = {}
    for place, name in enumerate(names):
        if name and place not in without:
            same = (k for k in named if np.nanmax(np.abs(places[:, k] - places[:, place])) < near)
            own = named.setdefault(next(same, place), [])
            own += [name] * (name not in own)
    return named


def quantity_label(name: str, quantity: str, unit: str) -> str:
    """What is written along an axis: a name or none, the quantity unless its letter says it, the unit.

    >>> quantity_label("rocker", "angle", "deg"), quantity_label("theta_7", "angle", "deg")
    ('rocker angle [deg]', 'θ₇ [deg]')
    """
    if not name:
        return f"{say(quantity)} [{unit}]"
    said = shown_name(name)
    if _UNNAMED.fullmatch(name) and quantity in ("angle", "position"):
        return f"{said} [{unit}]"
    return say("{joint} {quantity} [{unit}]", joint=said, quantity=say(quantity), unit=unit)


def handy_unit(unit: str, largest: float) -> tuple[float, str]:
    """A factor, and the unit in which values up to `largest` [unit] are short: metres for many millimetres.

    >>> handy_unit("mm", 75640.0), handy_unit("mm", 990.0)
    ((0.001, 'm'), (1.0, 'mm'))
    """
    if unit in LENGTHS and LENGTHS[unit] < LENGTHS["m"] and unit not in ("in", "ft") and largest >= LARGE:
        return length_sizes("m")[unit], "m"
    return 1.0, unit


def amount_text(value: float, unit: str, per: str = "") -> str:
    """A length or its rate to three digits or more with its unit, in metres where those are shorter.

    >>> amount_text(75640.0, "mm", "/s²"), amount_text(4378.2, "mm", "/s")
    ('75.6 m/s²', '4378 mm/s')
    """
    factor, unit = handy_unit(unit, abs(value))
    return f"{_digits(value * factor)} {unit}{per}"


def _digits(value: float) -> str:
    """A number to three digits or all before the point, with a power of ten only far from 1."""
    if value == 0 or not 1e-3 <= abs(value) < 1e6:
        return f"{value:.3g}"
    return f"{value:.{max(0, 2 - math.floor(math.log10(abs(value))))}f}"
