"""One design task for any loop: which numbers are free, what is wanted, and what must hold.

Angles [rad] and lengths in the linkage's own unit throughout, but the bounds of free numbers, which are in
the unit that the description gives each of them in, and figures, which are as people read them (`Measure`).

A want leaves residuals, each relative to its own unit: a radian, or for lengths what its docstring says. With
n residuals r of a want of weight w, the task makes least

    sum over wants of  (w^2 / n) sum r^2                     goal "least squares"                          (1)
    the greatest  w |r|  of all                              goal "minimax"                                (2)
    1 - sin^2 of the transmission angle, the greatest of all goal "transmission"                           (3)

(3) is for RSSRs of square axes, over the range that is used; what is wanted must then be met (`Most`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.limits import Limits
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.numbers.sensitivity import Numbers

#: What is made least of the residuals.
Goal = Literal["least squares", "minimax", "transmission"]

#: How the linkage may stand: as described; anywhere in space; anywhere and in any size.
Placement = Literal["fixed", "free", "free with scale"]


@dataclass(frozen=True)
class FreeNumber:
    """A number that may change: a dimension by its name ("L1", "crank.axis_x", "P.u"), with its bounds.

    `low` and `high` are in the dimension's unit in the description (`Draft.dimension(name).unit`).
    """

    name: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class FunctionWant:
    """The output as a function of the input: readings of the drive's two joints.

    At `input` (n,) the output reads `output` (n,), both [rad, or length], rising or falling in the input. The
    joints stand at `zeros` (input's, output's) plus the readings; a zero that is `None` is free. Residuals:
    what the output is off [rad, or relative to the linkage's size].
    """

    input: Floats
    output: Floats
    zeros: tuple[float | None, float | None] = (0.0, 0.0)
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class PathWant:
    """The path of a named point through places (n, 3) in order, the first not repeated where it is `closed`.

    `timing` (n,) [rad, or length] are the inputs at which they are reached, from an unknown start on with
    `phase`; without timing the inputs are free and follow each other. Residuals: the three parts of the
    distance, relative to the greatest extent of the places.
    """

    point: str
    places: Floats
    closed: bool = False
    timing: Floats | None = None
    phase: bool = False
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class PoseWant:
    """Poses (n, 4, 4) of a link, counted from 1, in order: rotation and shift from its frame to the report's.

    The link's frame is that in which its points are written (`[[point]] at`): of a drawn linkage the report's
    own in the drawn pose. `timing` and `phase` as of a path. Residuals: where the frame's origin and the ends
    of its three axes, each `arm` long, are off; relative to `arm`, so that an angle counts by the radian.
    """

    link: int
    poses: Floats
    arm: float
    timing: Floats | None = None
    phase: bool = False
    weight: float = 1.0


@dataclass(frozen=True)
class FigureWant:
    """A measure of the circuit by its name ("swing", "time_ratio", "peak_torque", ..): a value, or the most.

    `value` is in the unit that the measure is read in (degrees, N m, ..), or "small" or "great". The residual
    is what it is off, relative to `unit`; for "small" the figure itself, and for "great" `unit / figure`,
    below the unit `2 - figure / unit`.
    """

    name: str
    value: float | Literal["small", "great"]
    unit: float = 1.0
    weight: float = 1.0


@dataclass(frozen=True)
class DwellWant:
    """The output rests while the input goes over `inputs` (low, high) [rad, or length].

    It stays at `level`, a free one where that is `None`. Residuals: what it is off at `samples` inputs
    [rad, or relative to the size]. A tolerated deviation is a `Most` as well.
    """

    inputs: tuple[float, float]
    level: float | None = None
    samples: int = 41
    weight: float = 1.0


@dataclass(frozen=True)
class StraightWant:
    """A named point moves along a straight line, a free one, while the input goes over a range (low, high).

    `length` is how far it must go at least [length], between the two places farthest along the line; a design
    that goes less far is refused. Residuals, its distances from the line at `samples` inputs, are relative to
    it; without one they are relative to the linkage's size, and a point that rests is straight.
    """

    point: str
    inputs: tuple[float, float]
    length: float | None = None
    samples: int = 41
    weight: float = 1.0


#: Wants at poses, and all.
SampledWant = FunctionWant | PathWant | PoseWant | DwellWant | StraightWant
Want = SampledWant | FigureWant


@dataclass(frozen=True)
class InRange:
    """A column's value stays within `low` and `high` [rad, or length] at all poses that are used."""

    column: str
    low: float
    high: float


@dataclass(frozen=True)
class InCone:
    """The angle of a ball or a U joint from its seat stays below `angle` [rad] at all poses that are used.

    The angle is that between two directions: `seat` (3,), of the link before the joint, and `stud` (3,), of
    the link after it, each as points of that link are written. One that is `None` goes along the rod, from
    the joint to the link's other joint.
    """

    joint: str
    angle: float
    seat: tuple[float, float, float] | None = None
    stud: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class InBox:
    """Named points and joints stay between the corners `low` and `high` (3,) at all poses that are used."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    names: tuple[str, ...]


@dataclass(frozen=True)
class Apart:
    """Two links, counted from 1, as rods between their joints keep a `least` distance [length]."""

    links: tuple[int, int]
    least: float


@dataclass(frozen=True)
class FigureMust:
    """A measure of the circuit by its name stays within `least` and `most`, in the unit it is read in."""

    name: str
    least: float | None = None
    most: float | None = None


@dataclass(frozen=True)
class Most:
    """The residuals of a want, by its place among the task's, are at most so great, weights left out.

    Those of all its stations, or at the places `at` among them.
    """

    want: int
    most: float
    at: tuple[int, ...] | None = None


#: Musts about poses, and all.
PoseMust = InRange | InCone | InBox | Apart
Must = PoseMust | FigureMust | Most


@dataclass(frozen=True, eq=False)
class DesignTask:
    """What is asked: a linkage as the start, its free numbers, wants and musts.

    That all poses of a want lie on one circuit without a dead centre of the input between them, in their
    order, is always required. `limits` hold motion type, size, and the least transmission angle. With a
    placement that is not "fixed" the linkage may stand anywhere, which paths and poses alone see.
    Dimensions in `follow` (L2 of an RSSR whose file leaves it out) follow from the others. Free lengths of a
    drawing become dimensions of the draft. Raises `RequestError` for a free number that the draft has not.

    >>> import sevenbar as sb
    >>> linkage = sb.load("rssr")
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
                # says which there are
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
        return [(i, want) for i, want in enumerate(self.wants) if not isinstance(want, FigureWant)]


def residual_unit(want: Want, linkage: Linkage) -> float:
    """What a want's residuals are relative to [rad, or length; of a measure as it is read]."""
    match want:
        case FigureWant():
            return want.unit
        case PathWant():
            return float(np.ptp(want.places, axis=0).max())
        case PoseWant():
            return want.arm
        case StraightWant(length=length) if length is not None:
            return length
        case FunctionWant() | DwellWant() if linkage.turns(linkage.drive.output):
            return 1.0
        case _:
            return linkage_size(linkage)


def linkage_size(linkage: Linkage) -> float:
    """The longest dimension of a description [length]."""
    return float(Numbers(linkage).size)
