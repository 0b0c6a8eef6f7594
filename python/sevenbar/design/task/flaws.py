"""What is wrong with wants and musts, as messages: rules that several kinds of them share."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.idle_link import refuse_idle_link
from sevenbar.design.task.wanted_path import turning_back
from sevenbar.errors import NotCoveredError, shown, suggestion
from sevenbar.kinematics.linkage import Linkage

#: Messages, each with the key that it is of; "" for a whole table.
Flaws = Iterator[tuple[str, str]]

#: Of a range.
NOT_RISING = "its first end is not below its second one; give the lower end first"

#: Fewest samples of a range of inputs.
FEWEST_SAMPLES = 3

#: Relative rounding of a range of inputs that is a turn.
ROUNDING = 1e-12


def not_positive(key: str, value: float, what: str, give: str = "a number") -> Flaws:
    """That a value is none of what must be greater than 0."""
    if not (math.isfinite(value) and value > 0):
        yield key, f"{value:g} is no {what}; give {give} > 0"


def point_flaws(linkage: Linkage, name: str) -> Flaws:
    """What is wrong with the name of a point whose path is wanted."""
    known = {point.name: point.link for point in linkage.points}
    moving = [point for point, link in known.items() if link in linkage.graph.moving]
    if name not in known:
        has = (
            f"this linkage has {', '.join(moving)}" if moving else "the linkage names none, so add one to it"
        )
        yield "point", f"no point {shown(name)}; {suggestion(name, known)}{has}"
    elif known[name] == linkage.graph.ground:
        yield "point", f"'{name}' is on the ground, which stands still; give one of {', '.join(moving)}"
    else:
        yield from _idle("point", linkage, known[name], "a path on it")


def link_flaws(linkage: Linkage, link: int) -> Flaws:
    """What is wrong with the number of a link of which poses are wanted."""
    ground = linkage.graph.ground
    if link not in linkage.graph.moving:
        yield "link", f"{link} is no moving link; give 1 to {ground - 1}, link {ground} is the ground"
    else:
        yield from _idle("link", linkage, link, "a pose of it")


def _idle(key: str, linkage: Linkage, link: int, what: str) -> Flaws:
    try:
        refuse_idle_link(linkage, link, what)
    except NotCoveredError as error:
        yield key, str(error).partition(": ")[2]


def order_flaws(values: Floats, key: str, what: str) -> Flaws:
    """That values neither rise nor fall throughout."""
    if number := turning_back(values):
        yield key, f"the {what} {number} turns back; inputs must rise, or fall, from one to the next"


def range_flaws(linkage: Linkage, ends: tuple[float, float], samples: int) -> Flaws:
    """What is wrong with a range of inputs, and with how many of it count."""
    low, high = ends
    if samples < FEWEST_SAMPLES:
        yield "samples", f"{samples} are too few; give {FEWEST_SAMPLES} or more"
    if not (np.isfinite(ends).all() and low < high):
        yield "range", NOT_RISING
    elif over_a_turn(linkage, high - low):
        yield "range", f"goes over {math.degrees(high - low):g} deg of the input; give a turn at most"


def over_a_turn(linkage: Linkage, extent: float) -> bool:
    """Whether inputs that turn go over more than a turn."""
    return linkage.turns(linkage.drive.joint) and extent > math.tau * (1 + ROUNDING)
