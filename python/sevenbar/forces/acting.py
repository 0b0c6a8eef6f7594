"""Loads and springs, each checked; values in newton and newton metre."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array, finite_number, triple
from sevenbar.errors import RequestError, check_word, shown

Three = tuple[float, float, float]


@dataclass(frozen=True)
class Load:
    """A force and a torque on a link.

    `force` (3,) [N] acts at the point `at` [length], written as a point of its link is, and `torque` (3,)
    [N m]; both along the axes of the report frame, or with `axes` "link" along those in which the link's
    points are written. It acts all the time, or where the input [rad, or length] lies `between` two values
    (from the first up to the second, angles by whole turns), or as large as `table` says: inputs (k,) and the
    factors (k,) there, straight lines between them, 0 outside; of a turning input by whole turns.
    """

    link: int
    force: Three = (0.0, 0.0, 0.0)
    torque: Three = (0.0, 0.0, 0.0)
    at: Three | None = None
    axes: Literal["ground", "link"] = "ground"
    between: tuple[float, float] | None = None
    table: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        for key in ("force", "torque"):
            object.__setattr__(self, key, triple(key, getattr(self, key)))
        check_word("axes", self.axes, ("ground", "link"))
        if any(self.force) and self.at is None:
            raise RequestError("at: is missing; give the point at which the force acts")
        object.__setattr__(self, "at", triple("at", (0.0, 0.0, 0.0) if self.at is None else self.at))
        if not any(self.force) and not any(self.torque):
            raise RequestError("force: is missing; give a force [N] at a point, or a torque [N m]")
        if self.between is not None and self.table is not None:
            raise RequestError("table: a load has one of between and table")
        if self.between is not None:
            ends = finite_array("between", self.between)
            if ends.size != 2 or ends[0] == ends[1]:
                raise RequestError("between: give two different values of the input")
            object.__setattr__(self, "between", (float(ends[0]), float(ends[1])))
        if self.table is not None:
            inputs, factors = (finite_array("table", part) for part in self.table)
            if inputs.size != factors.size or inputs.size < 2 or np.any(np.diff(inputs) <= 0):
                raise RequestError("table: give as many factors as inputs, two or more, inputs rising")
            object.__setattr__(self, "table", (tuple(inputs.tolist()), tuple(factors.tolist())))

    def factors(self, inputs: npt.ArrayLike, *, turns: bool) -> Floats:
        """How much of it acts at inputs (n,) [rad, or length]; `turns`: the input is an angle."""
        x = np.asarray(inputs, dtype=np.float64)
        if self.between is not None:
            first, second = self.between
            if turns:
                return np.asarray((x - first) % math.tau <= (second - first) % math.tau, dtype=np.float64)
            return np.asarray((x >= first) & (x <= second), dtype=np.float64)
        if self.table is not None:
            at, factors = (np.array(part) for part in self.table)
            if turns:
                x = at[0] + (x - at[0]) % math.tau
            return np.asarray(np.interp(x, at, factors, left=0.0, right=0.0))
        return np.ones_like(x)


@dataclass(frozen=True)
class Spring:
    """A spring with a damper, between points of two links or in a joint.

    Between `links` it pulls the points `at` (two of (3,), written as points are) together with
    `stiffness (L - length) + damping dL/dt` [N] at the distance L: stiffness in N by the length unit,
    damping in N s by it. In a `joint` (the name of a column) it acts back on its value q [rad, or length]
    with `stiffness (q - length) + damping dq/dt` [N m, or N]: N m/rad and N m s/rad, of a slide N and N s by
    the length unit.
    """

    stiffness: float = 0.0
    length: float = 0.0
    damping: float = 0.0
    links: tuple[int, int] | None = None
    at: tuple[Three, Three] | None = None
    joint: str | None = None
    name: str = ""

    def __post_init__(self) -> None:
        for key in ("stiffness", "length", "damping"):
            object.__setattr__(self, key, finite_number(key, getattr(self, key)))
        if self.damping < 0:
            raise RequestError(f"damping: {shown(self.damping)} feeds the motion; give one >= 0")
        if not self.stiffness and not self.damping:
            raise RequestError("stiffness: is missing; give stiffness or damping")
        if (self.joint is None) == (self.links is None):
            raise RequestError("links: a spring is between two links, or in one joint; give one of these")
        if self.links is None:
            return
        if self.length < 0:
            raise RequestError(f"length: {shown(self.length)} is not a length; give one >= 0")
        if len(self.links) != 2 or self.links[0] == self.links[1]:
            raise RequestError(f"links: {shown(self.links)} are not two different links")
        if self.at is None or len(self.at) != 2:
            raise RequestError("at: give two points, one on each link")
        object.__setattr__(self, "at", (triple("at[0]", self.at[0]), triple("at[1]", self.at[1])))
