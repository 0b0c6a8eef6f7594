"""What keeps a linkage from moving on: ranges of joints, cones of balls, thick links."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy.typing as npt

from sevenbar.arrays import finite_array, finite_number, triple
from sevenbar.curves.turn import is_beyond_a_turn
from sevenbar.errors import RequestError, shown
from sevenbar.text.given import given_number

Three = tuple[float, float, float]


def direction(key: str, value: npt.ArrayLike) -> Three:
    """Three finite numbers, not all 0, or `RequestError`."""
    array = finite_array(key, value)
    if array.size != 3 or not array.any():
        raise RequestError(f"{key}: {shown(value)} is not a direction; give three numbers, not all 0")
    return triple(key, array)


@dataclass(frozen=True)
class Cone:
    """How far a ball or universal joint may be bent, and from where.

    `angle` [rad], or a text as in "45 deg", is the greatest between `seat` and `stud`, directions of the link
    before and of the link after, written as points of these are; `None` for no limit. A direction left out:
    of an idle link that of its rod; else the stud is the rod of the link after, and the seat the middle of
    the motion.
    """

    angle: float | None = None
    seat: Three | None = None
    stud: Three | None = None

    def __post_init__(self) -> None:
        for key in ("seat", "stud"):
            if (value := getattr(self, key)) is not None:
                object.__setattr__(self, key, direction(key, value))
        if self.angle is None:
            return
        angle = finite_number("cone", given_number("cone", self.angle, "rad"))  # type: ignore[arg-type]
        object.__setattr__(self, "angle", angle)
        if not 0 < angle <= math.pi:
            raise RequestError(
                f"cone: {math.degrees(angle):.6g} deg is no cone; give an angle above 0, up to 180 deg"
            )


@dataclass(frozen=True)
class Stops:
    """The stops of a linkage.

    `ranges` of columns by name, each low and high [rad, or length], a turn at most; `cones` by joint; `radii`
    [length] of links by number, the ground last.
    """

    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    cones: Mapping[str, Cone] = field(default_factory=dict)
    radii: Mapping[int, float] = field(default_factory=dict)

    @property
    def is_empty(self) -> bool:
        """Whether nothing is given."""
        return not (self.ranges or self.cones or self.radii)

    @property
    def stops(self) -> bool:
        """Whether anything is given that a motion can run into: not directions of seats alone."""
        return bool(self.ranges or self.radii or any(c.angle is not None for c in self.cones.values()))


NO_STOPS = Stops()


def check_range(key: str, low: float, high: float, *, turns: bool) -> tuple[float, float]:
    """A range of a joint [rad, or length], or `RequestError`."""
    ends = finite_number(key, low), finite_number(key, high)
    if not ends[0] < ends[1]:
        raise RequestError(f"{key}: the low end is not below the high end; give [low, high]")
    if turns and is_beyond_a_turn(*ends):
        degrees = math.degrees(ends[1] - ends[0])
        raise RequestError(f"{key}: {degrees:.6g} deg is more than a turn; a stop is within one")
    return ends
