"""One design task for any loop: which numbers are free, what is wanted, and what must hold.

Angles [rad] and lengths in the linkage's own unit throughout, except the bounds of free numbers, which are in
the unit in which the description has each of them, and measures, which are in the unit in which people read
them.

A want, an objective, has residuals, each relative to its own unit: a radian, or for lengths what its
docstring says. A must is a constraint. With n residuals r of a want of weight w, the task makes least

    sum over wants of  (w^2 / n) sum r^2                     goal "least squares"                          (1)
    the greatest  w |r|  of all                              goal "minimax"                                (2)
    1 - sin^2 of the transmission angle, the greatest of all goal "transmission"                           (3)

(3) is for RSSRs of square axes, over the range that is used; what is wanted must then be met to within
bounds (`Most`).

Each kind of want or must is one file in `wants` or `musts`; everything else knows the classes of this module
alone.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.description.values import TableForm
from sevenbar.design.limits import Limits
from sevenbar.design.task.flaws import Flaws
from sevenbar.design.task.loop import Here, Slacks, TaskLoop
from sevenbar.design.task.wanted import Wanted
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.columns import shown_in
from sevenbar.kinematics.numbers.sensitivity import Numbers

#: What is made least of the residuals.
Goal = Literal["least squares", "minimax", "transmission"]

#: How the linkage may stand: as described; anywhere in space; anywhere and in any size.
Placement = Literal["fixed", "free", "free with scale"]

#: The most that residuals are where points are to be met exactly.
EXACT = 1e-6


@dataclass(frozen=True)
class FreeNumber:
    """A number that may change: a dimension by its name ("L1", "crank.axis_x", "P.u"), with its bounds.

    `low` and `high` are in the dimension's unit in the description (`Draft.dimension(name).unit`).
    """

    name: str
    low: float
    high: float


class WantForm(TableForm):
    """A table `[[want]]` of a task file: the keys of a kind of want, its first `kind`."""

    #: Other words for the kind.
    synonyms: ClassVar[tuple[str, ...]] = ()

    def want(self, linkage: Linkage, folder: Path) -> Want:
        """The want; files lie in `folder`. Raises `RequestError` with the key at fault."""
        raise NotImplementedError

    @property
    def is_exact(self) -> bool:
        """Whether its residuals must vanish, for which several kinds have a key."""
        return bool(getattr(self, "exact", False))

    def hints(self) -> Iterator[tuple[str, str]]:
        """What may be a mistake, each with its key."""
        return iter(())


class MustForm(TableForm):
    """A table `[[must]]` of a task file: the keys of a kind of must, its first `kind`."""

    #: Other words for the kind.
    synonyms: ClassVar[tuple[str, ...]] = ()

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> Must:
        """The must of a task with these wants. Raises `RequestError` with the key at fault."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class Asked(ABC):
    """What wants and musts have in common."""

    #: What is at fault where it is missed, and what may be given up then; "" where it never is.
    fault: ClassVar[str] = ""
    ease: ClassVar[str] = ""
    #: What it puts in space, so that the linkage may not be placed anywhere; "" for nothing.
    in_space: ClassVar[str] = ""

    @property
    def points(self) -> tuple[str, ...]:
        """The names of points that it is about."""
        return ()

    @property
    def measures(self) -> tuple[str, ...]:
        """The names of measures that it is about."""
        return ()

    @abstractmethod
    def flaws(self, task: DesignTask) -> Flaws:
        """What contradicts itself, the linkage or another want or must, each with the key it is of."""

    @abstractmethod
    def words(self, linkage: Linkage) -> str:
        """What is asked, in a line."""


class Want(Asked):
    """An objective of a design task."""

    form: ClassVar[type[WantForm]]
    weight: float

    def weighted(self, weight: float) -> Want:
        """The same with another weight."""
        return replace(self, weight=weight)  # type: ignore[call-arg]

    @abstractmethod
    def axis(self, place: int, linkage: Linkage) -> tuple[str, str, float]:
        """Of its value in tables: a name, the unit, and what 1 is there; `place` is that among the wants."""


class SampledWant(Want):
    """An objective at poses, by residuals (`Wanted`)."""

    #: Whether it reads nothing but input and output; whether its places go with the placing of the linkage.
    of_output: ClassVar[bool] = False
    placeable: ClassVar[bool] = False

    @abstractmethod
    def in_loop(self, loop: TaskLoop) -> Wanted:
        """Its residuals in a loop, starts, facts and curve."""

    def residual_unit(self, linkage: Linkage) -> float:
        """What its residuals are relative to [rad, or length]."""
        turns = self.of_output and linkage.turns(linkage.drive.output)
        return 1.0 if turns else linkage_size(linkage)

    def input_range(self) -> tuple[float, float] | None:
        """The least and the greatest input; `None` where the search has to find them."""
        return None

    def readings_of(self, column: str, linkage: Linkage) -> Floats | None:  # noqa: ARG002
        """Values (n,) that a column is wanted to take; `None` for others."""
        return None

    def places_of(self, point: str) -> Floats | None:  # noqa: ARG002
        """Places (n, 3) in space that a point is wanted to take; `None` for others."""
        return None

    def axis(self, place: int, linkage: Linkage) -> tuple[str, str, float]:
        """The greatest error."""
        unit = shown_in(linkage, linkage.drive.output) if self.of_output else (linkage.length_unit, 1.0)
        return f"want_{place + 1}_greatest", *unit

    def exact_flaws(self, task: DesignTask, conditions: int, want_free: int) -> Flaws:
        """More conditions to be met exactly than free numbers; `want_free` are those of the want itself."""
        place = next(i for i, other in enumerate(task.wants) if other is self)
        bounds = (must for must in task.musts if isinstance(must, ResidualMust))
        if not any(must.want == place and must.most <= EXACT for must in bounds):
            return
        count = len(task.free) + want_free
        if conditions > count:
            yield (
                "exact",
                f"{conditions} conditions are to be met exactly, and {count} numbers are free; leave points "
                "out, free more numbers, or leave exact out",
            )


class MeasureWant(Want):
    """An objective that is a measure of the circuit by its `name`: a value, or small, or great."""

    name: str
    value: float | Literal["small", "great"]

    @property
    def measures(self) -> tuple[str, ...]:
        """Its own."""
        return (self.name,)

    @abstractmethod
    def residual(self, value: float, by: Floats) -> tuple[float, Floats]:
        """The residual at a value of the measure, and its slopes."""

    def loss(self, value: float) -> float:
        """The distance from the value; the measure itself, or its negative where it shall be great."""
        if isinstance(self.value, str):
            return -value if self.value == "great" else value
        return abs(value - self.value)

    def ends(self, loss: float) -> tuple[float | None, float | None]:
        """The least and the greatest value of the measure whose loss is no more than this."""
        if isinstance(self.value, str):
            return (-loss, None) if self.value == "great" else (None, loss)
        return self.value - loss, self.value + loss


class Must(Asked):
    """A constraint of a design task."""

    form: ClassVar[type[MustForm]]

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns whose range it holds."""
        return ()

    def start_flaws(self, loop: TaskLoop, circuits: Sequence[Circuit], q: Floats) -> Flaws:  # noqa: ARG002
        """What contradicts the linkage as a start, with its circuits and closed poses (n, columns) of one."""
        return iter(())


class PoseMust(Must):
    """A constraint at all poses that are used."""

    @abstractmethod
    def slacks(self, loop: TaskLoop) -> Callable[[Here], Slacks]:
        """What gives its slacks at poses: angles [rad], lengths relative to the size."""

    @abstractmethod
    def turns(self, linkage: Linkage) -> bool:
        """Whether its slacks are angles."""

    def slack_unit(self, loop: TaskLoop) -> tuple[str, float]:
        """The unit in which people read its slack, and what 1 of the slack is there."""
        turns = self.turns(loop.linkage)
        return ("deg", math.degrees(1.0)) if turns else (loop.linkage.length_unit, float(loop.size))


class MeasureMust(Must):
    """A constraint of a measure by its `name`, in the unit it is read in."""

    name: str
    least: float | None
    most: float | None

    @property
    def measures(self) -> tuple[str, ...]:
        """Its own."""
        return (self.name,)


class ResidualMust(Must):
    """A constraint of the residuals of a want, by its place among the task's, at some stations or at all."""

    want: int
    most: float
    at: tuple[int, ...] | None


@dataclass(frozen=True, eq=False)
class DesignTask:
    """What is asked: a linkage as the start, its free numbers, wants and musts.

    That all poses of a want lie on one circuit without a dead centre of the input between them, in their
    order, is always required. `limits` hold motion type, size, and the least transmission angle. With a
    placement that is not "fixed" the linkage may be placed anywhere, which only wants of places depend on.
    Dimensions in `follow` (L2 of an RSSR whose file leaves it out) follow from the others. Free lengths of a
    drawing become dimensions of the draft. Raises `RequestError` for a free number that the draft does not
    have.

    >>> import sevenbar as sb
    >>> linkage = sb.load("rssr")
    >>> from sevenbar.design.task import FunctionWant
    >>> want = FunctionWant(np.radians([60.0, 80.0, 100.0]), np.radians([10.0, 20.0, 35.0]))
    >>> free = (FreeNumber("L1", 200, 300), FreeNumber("M", 500, 900))
    >>> task = DesignTask(Draft.of_linkage(linkage), free, (want,))
    >>> task.goal, task.placement
    ('least squares', 'fixed')
    """

    draft: Draft
    free: tuple[FreeNumber, ...]
    wants: tuple[Want, ...]
    musts: tuple[Must, ...] = ()
    placement: Placement = "fixed"
    goal: Goal = "least squares"
    limits: Limits = field(default_factory=Limits)
    follow: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        draft = self.draft.giving(self.names)
        for name in self.names:
            if not any(name == one.name for one in (*draft.dimensions, *draft.masses)):
                # `dimension` raises for an unknown name, and lists those there are
                raise RequestError(
                    f"free: {draft.dimension(name).name} is the name of {shown(name)}; give that"
                )
        object.__setattr__(self, "draft", draft)

    @property
    def low(self) -> Floats:
        """The least values (k,) of the free numbers."""
        return np.array([one.low for one in self.free])

    @property
    def high(self) -> Floats:
        """The greatest values (k,) of the free numbers."""
        return np.array([one.high for one in self.free])

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the free numbers."""
        return tuple(one.name for one in self.free)

    @property
    def sampled(self) -> list[tuple[int, SampledWant]]:
        """The wants at poses, each with its place among all."""
        return [(i, want) for i, want in enumerate(self.wants) if isinstance(want, SampledWant)]

    @property
    def placings(self) -> int:
        """How many numbers place the linkage, and scale it."""
        return {"fixed": 0, "free": 6, "free with scale": 7}[self.placement]


def linkage_size(linkage: Linkage) -> float:
    """The longest dimension of a description [length]."""
    return float(Numbers(linkage).size)
