"""Loads and springs, each checked; values in newton and newton metre."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeGuard

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array, finite_number, place_of_link, triple, whole_number
from sevenbar.curves.turn import is_a_turn, is_beyond_a_turn
from sevenbar.errors import RequestError, check_name, check_word, shown
from sevenbar.text.given import given_number
from sevenbar.text.units import LENGTHS, split_quantity

if TYPE_CHECKING:
    from sevenbar.text.quantities import QuantityKind

Three = tuple[float, float, float]


@dataclass(frozen=True)
class Load:
    """A force and a torque on a link.

    `force` (3,) [N] acts at the point `at` [length], written as a point of its link is, and `torque` (3,)
    [N m]; both along the axes of the report frame, or with `axes` "link" along those in which the link's
    points are written. It acts all the time, or where the input [rad, or length] lies `between` two values
    (from the first up to the second, angles by whole turns, a turn at most), or as large as `table` says:
    inputs (k,) and the factors (k,) there, straight lines between them, 0 outside; of a turning input by
    whole turns. Forces and torques may be texts, as in "2 kN", and angles of the input, as in "30 deg".
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
        object.__setattr__(self, "link", whole_number("link", self.link, 1, None, "a link"))
        check_name("name", self.name, may_be_empty=True)
        for key, kind in _KINDS.items():
            object.__setattr__(self, key, triple(key, _in_newtons(key, getattr(self, key), kind)))
        check_word("axes", self.axes, ("ground", "link"))
        if any(self.force) and self.at is None:
            raise RequestError("at: is missing; give the point at which the force acts")
        object.__setattr__(self, "at", place_of_link("at", (0.0, 0.0, 0.0) if self.at is None else self.at))
        if not any(self.force) and not any(self.torque):
            raise RequestError("force: is missing; give a force [N] at a point, or a torque [N m]")
        if self.between is not None and self.table is not None:
            raise RequestError("table: a load has one of between and table")
        if self.between is not None:
            ends = finite_array("between", _inputs("between", self.between))
            if ends.size != 2 or ends[0] == ends[1]:
                raise RequestError("between: give two different values of the input")
            object.__setattr__(self, "between", (float(ends[0]), float(ends[1])))
        if self.table is not None:
            if not _is_pair(self.table):
                raise RequestError("table: give two lists, the inputs and the factors there")
            inputs = finite_array("table", _inputs("table", self.table[0]))
            factors = finite_array("table", self.table[1])
            if inputs.size != factors.size or inputs.size < 2 or np.any(np.diff(inputs) <= 0):
                raise RequestError("table: give as many factors as inputs, two or more, inputs rising")
            object.__setattr__(self, "table", (tuple(inputs.tolist()), tuple(factors.tolist())))

    def check_input(self, *, turns: bool) -> None:
        """Refuses a range or a table that is none of the input; `turns`: the input is an angle."""
        if self.between is not None:
            low, high = self.between
            if not turns and low > high:
                raise RequestError(
                    f"between: {low:.6g} is above {high:.6g}, and the input slides; give [low, high]"
                )
            if turns and is_beyond_a_turn(low, high):
                raise RequestError(
                    f"between: {_degrees(high - low)} is more than a turn; give a turn at most, after "
                    "which the load acts again"
                )
            if turns and low > high and (is_a_turn(high, low) or is_beyond_a_turn(high, low)):
                raise RequestError(
                    f"between: {_degrees(low)} is a turn or more above {_degrees(high)}; give ends within a "
                    "turn, as in [0, 360] for a whole one"
                )
        if self.table is not None and turns and is_beyond_a_turn(self.table[0][0], self.table[0][-1]):
            over = _degrees(self.table[0][-1] - self.table[0][0])
            raise RequestError(
                f"table: its inputs go over {over}, more than a turn; give those of a turn at most, after "
                "which it acts again"
            )

    def acts_always(self, *, turns: bool) -> bool:
        """Whether it acts as it is at every input: without a range, or with one of a whole turn."""
        if self.between is not None:
            return turns and is_a_turn(*self.between)
        return self.table is None

    def corners(self, *, turns: bool) -> tuple[float, ...]:
        """Inputs [rad, or length] at which it sets in, ends, or its table has a corner."""
        if self.between is None:
            return () if self.table is None else self.table[0]
        return () if self.acts_always(turns=turns) else self.between

    def factors(self, inputs: npt.ArrayLike, *, turns: bool) -> Floats:
        """How much of it acts at inputs (n,) [rad, or length]; `turns`: the input is an angle."""
        x = np.asarray(inputs, dtype=np.float64)
        if self.acts_always(turns=turns):
            return np.ones_like(x)
        if self.between is not None:
            first, second = self.between
            if turns:
                return np.asarray((x - first) % math.tau <= (second - first) % math.tau, dtype=np.float64)
            return np.asarray((x >= first) & (x <= second), dtype=np.float64)
        assert self.table is not None
        at, factors = (np.array(part) for part in self.table)
        if turns:
            x = at[0] + (x - at[0]) % math.tau
            if is_a_turn(at[0], at[-1]):
                # of rounding no input is outside
                at[-1] = max(at[-1], at[0] + math.tau)
        return np.asarray(np.interp(x, at, factors, left=0.0, right=0.0))


#: What the numbers of a load are in newton.
_KINDS: dict[str, QuantityKind] = {"force": "force", "torque": "torque"}


def _in_newtons(key: str, values: Any, kind: QuantityKind) -> Any:
    """Three numbers [N, or N m] of which some may be texts with a unit."""
    if not isinstance(values, (list, tuple)) or not any(isinstance(value, str) for value in values):
        return values
    # `import sevenbar` needs no reader of units
    from sevenbar.text.quantities import quantity_of

    try:
        return [quantity_of(value, kind) if isinstance(value, str) else value for value in values]
    except RequestError as error:
        raise RequestError(f"{key}: {error}") from None


def _inputs(key: str, values: Any) -> Any:
    """Values of the input of which some may be texts of angles."""
    if not isinstance(values, (list, tuple)):
        return values
    # a load does not know the length unit of its linkage
    if any(isinstance(value, str) and _is_length(value) for value in values):
        raise RequestError(
            f"{key}: {shown(list(values))}: give numbers in the linkage's length unit where the input slides"
        )
    return [given_number(key, value, "rad") for value in values]


def _is_length(text: str) -> bool:
    parts = split_quantity(text)
    return parts is not None and parts[1] in LENGTHS


def _is_pair(values: object) -> TypeGuard[Sequence[Any]]:
    return isinstance(values, (tuple, list, np.ndarray)) and len(values) == 2


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.6g} deg"


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
        check_name("name", self.name, may_be_empty=True)
        if self.links is None:
            check_name("joint", self.joint)
            if self.at is not None:
                raise RequestError("at: a spring in a joint has no points; leave it out")
            return
        if self.length < 0:
            raise RequestError(f"length: {shown(self.length)} is not a length; give one >= 0")
        if not _is_pair(self.links):
            raise RequestError(f"links: {shown(self.links)} are not two different links")
        first, second = (
            whole_number(f"links[{i}]", link, 1, None, "a link") for i, link in enumerate(self.links)
        )
        if first == second:
            raise RequestError(f"links: {shown(self.links)} are not two different links")
        object.__setattr__(self, "links", (first, second))
        if not _is_pair(self.at):
            raise RequestError("at: give two points, one on each link")
        object.__setattr__(
            self, "at", (place_of_link("at[0]", self.at[0]), place_of_link("at[1]", self.at[1]))
        )
