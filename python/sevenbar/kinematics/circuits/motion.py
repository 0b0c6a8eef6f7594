"""What a linkage does: its motion of every circuit and change point, and what answers for it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, SupportsIndex, overload

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, ReadOnly, whole_number, within_turn
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.search import NearMotion, Search
from sevenbar.kinematics.circuits.table import circuit_columns, frame_of
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.printing import Drawable

#: The least and the greatest closure error [rad, or relative to the size] up to which redundant constraints
#: may be taken to agree: rounding is near the one, and another linkage near the other.
LEAST_AGREE, MOST_AGREE = 1e-12, 1e-3

#: What is proposed is greater than the closure error on the rows by this: there may be more between them.
NEAR_ENOUGH = 2.0

#: Inputs in a turn at which that error is computed.
NEAR_SAMPLES = 72

#: A loop of so many freedoms moves without redundant constraints.
SPARE_FREEDOMS = 7

if TYPE_CHECKING:
    import pandas as pd

    from sevenbar.kinematics.circuits.extents import JointRange
    from sevenbar.kinematics.circuits.modes import Modes
    from sevenbar.kinematics.loop.grashof import FourBar
    from sevenbar.kinematics.loop.law import Law
    from sevenbar.kinematics.loop.mobility import Mobility
    from sevenbar.kinematics.loop.reason import Reason


@dataclass(frozen=True, eq=False)
class ChangePoint(ReadOnly):
    """A pose from which the loop can go on in more than one way, or that stands alone.

    `q` (columns,) are its joint values [rad in (-pi, pi], or length], `input` that of the input; `circuits`
    the numbers of those that meet there; `ways` how many curves lead out of it, two for each branch that
    passes. An isolated pose has none. `freedoms` is the most that a motion out of it has: 1 where all are
    circuits, more where one begins that the input does not determine, which is not followed.

    Source: docs/theory.md, (19) to (22).
    """

    input: float
    q: Floats
    circuits: tuple[int, ...]
    ways: int
    freedoms: int

    @property
    def isolated(self) -> bool:
        """Whether no motion leads out of it."""
        return self.ways == 0


class HeldFreedoms(NamedTuple):
    """How idle freedoms are held: `balls` as two turns, `columns` at zero, and how many `spins` otherwise.

    Balls are joints counted from 0; their third turns are among the columns.
    """

    balls: frozenset[int]
    columns: list[int]
    spins: int


class Solvable(Loop, ABC):
    """A loop that answers: what results know of the `Linkage` of which they are."""

    @property
    @abstractmethod
    def lengths(self) -> tuple[float, float, float]:
        """Crank, coupler and rocker of an RSSR [length]."""

    @property
    @abstractmethod
    def idle(self) -> tuple[str, ...]:
        """Freedoms that move no other link."""

    @property
    @abstractmethod
    def idle_links(self) -> frozenset[int]:
        """The links that take part in them, counted from 1."""

    @cached_property
    @abstractmethod
    def held(self) -> HeldFreedoms:
        """How idle freedoms are held."""

    @property
    @abstractmethod
    def spin_axes(self) -> dict[str, Floats]:
        """The axis that holds the idle spin beyond a ball, by the ball's name."""

    @cached_property
    @abstractmethod
    def answers(self) -> Any:
        """What its circuits take from it."""

    @property
    @abstractmethod
    def is_planar(self) -> bool:
        """Whether it can only move in a plane."""

    @property
    @abstractmethod
    def normal(self) -> Floats | None:
        """The direction (3,) across its plane, in the report frame; `None` of a loop that is not planar."""

    @abstractmethod
    def as_four_bar(self, input: str | None = None, output: str | None = None) -> FourBar | None:
        """The links by Grashof's rule; `None` for a loop that is no four-bar or slider-crank."""

    @abstractmethod
    def reason_of(self, motion: Motion) -> Reason | None:
        """Why a motion of it has no circuit, or which link has no length."""

    @abstractmethod
    def _net_ratio_at_rest(self, pose: Floats, column: int, output: int) -> float | None:
        """d(output)/d(input) of a net at a pose (columns,) where both rest; `None` where one moves."""

    @abstractmethod
    def mobility(self, *, input: str | None = None, agree: float | None = None) -> Mobility:
        """How freely the loop moves where the input does."""

    @abstractmethod
    def assembly_modes(
        self,
        theta: float | str,
        *,
        input: str | None = None,
        method: Literal["auto", "general"] = "auto",
        agree: float | None = None,
    ) -> Modes:
        """Every assembly mode at one value of the input."""

    @abstractmethod
    def motion(
        self,
        samples: int = 360,
        *,
        input: str | None = None,
        output: str | None = None,
        speed: float | str | None = None,
        law: Law | None = None,
        method: Literal["auto", "general"] = "auto",
        agree: float | None = None,
    ) -> Motion:
        """Every circuit over the whole input range."""

    @abstractmethod
    def circuit(
        self,
        pose: npt.ArrayLike,
        samples: int = 360,
        *,
        input: str | None = None,
        output: str | None = None,
        speed: float | str | None = None,
        law: Law | None = None,
        agree: float | None = None,
    ) -> Circuit:
        """The one circuit through a pose."""


@dataclass(frozen=True, eq=False, repr=False)
class Motion(ReadOnly, Drawable):
    """The circuits of a linkage over the whole input range."""

    linkage: Solvable
    input: str
    output: str
    #: d(input)/dt [rad/s]; NaN where a law drives.
    speed: float
    samples: int
    motion_type: str
    #: Input dead centres [rad in [0, 2 pi), or length], rising.
    limits: Floats
    #: Poses at which branches meet, or would by a change of some 1e-12 of a dimension; isolated poses too.
    change_points: tuple[ChangePoint, ...]
    circuits: tuple[Circuit, ...]
    #: How the circuits were looked for, and what was found out.
    search: Search
    #: Constraints that the others imply, in words.
    redundant: tuple[str, ...]
    #: The closure error [rad, relative to the size] up to which redundant constraints agree.
    agree: float
    law: Law | None = None
    #: The speed as it was written, "3000 rpm", where it was a text.
    speed_written: str = ""

    @property
    def completeness(self) -> Literal["closed-form", "counted", "algebraic", "monodromy", "searched"]:
        """How it is known that no circuit is missing."""
        return self.search.completeness

    @property
    def change_point_inputs(self) -> Floats:
        """The input at the change points [rad in [0, 2 pi), or length], rising; isolated poses aside."""
        values = np.array([point.input for point in self.change_points if not point.isolated])
        turns = self.linkage.turns(self.input)
        return np.sort(within_turn(values) if turns else values)

    @property
    def idle(self) -> tuple[str, ...]:
        """Freedoms that move one link only."""
        return self.linkage.idle

    @property
    def mobility(self) -> Mobility:
        """How freely the linkage moves where the input does."""
        return self.linkage.mobility(input=self.input, agree=self.agree)

    @property
    def joint_ranges(self) -> tuple[Mapping[str, JointRange], ...]:
        """The joint ranges of each circuit; see `Circuit.joint_ranges`.

        >>> import sevenbar as sb
        >>> [ranges["crank"].endless for ranges in sb.load("rssr").motion().joint_ranges]
        [True, True]
        """
        return tuple(circuit.joint_ranges for circuit in self.circuits)

    @cached_property
    def near_motion(self) -> NearMotion | None:
        """By how little a linkage without a circuit misses a motion; `None` where it has one, or misses more.

        It is worked out on demand, up to a closure error of 1e-3 of the size.

        >>> import sevenbar as sb
        >>> rows = {"length": [50, 98.48] * 2, "twist": ["30 deg", "100 deg"] * 2, "offset": [0] * 4}
        >>> sb.from_dh("RRRR", **rows).motion().near_motion.agree
        1e-05
        """
        if self.circuits or len(self.linkage.columns) >= SPARE_FREEDOMS:
            return None

        def eased(agree: float) -> Motion:
            return self.linkage.motion(NEAR_SAMPLES, input=self.input, output=self.output, agree=agree)

        widest = eased(MOST_AGREE)
        if not widest.circuits:
            return None
        miss = max(float(np.nanmax(circuit.residual)) for circuit in widest.circuits)
        share = miss / widest.circuits[0].size
        agree = min(MOST_AGREE, float(f"1e{math.ceil(math.log10(NEAR_ENOUGH * share))}"))
        if eased(agree).motion_type != widest.motion_type:
            agree = MOST_AGREE
        return NearMotion(widest.motion_type, miss, share, agree)

    @cached_property
    def reason(self) -> Reason | None:
        """Why a rigid linkage does not move: joints off the plane or the point of the others, by how much.

        Two neighbours that turn about one axis, so that the link between has no length, are named for every
        linkage. `None` where no reason of these kinds is seen; joints that are off are named of drawn loops
        only, since rows tell no pose.

        >>> import sevenbar as sb
        >>> places = {"a": (0, 0, 0), "b": (40, 0, 0), "c": (120, 70, 0), "d": (90, 0, 0)}
        >>> joints = [{"kind": "R", "name": n, "at": p, "axis": (0, 0, 1)} for n, p in places.items()]
        >>> joints[2]["axis"] = (0, 0.02, 1)
        >>> reason = sb.from_axes(joints).motion().reason
        >>> reason.off[0].joint, round(math.degrees(reason.off[0].by), 3), reason.motion_type
        ('c', 1.146, 'crank-rocker')
        """
        return self.linkage.reason_of(self)

    @property
    def four_bar(self) -> FourBar | None:
        """Its links by Grashof's rule; `None` for a loop that is no four-bar or slider-crank.

        >>> import sevenbar as sb
        >>> sb.load("planar_4r").motion().four_bar.grashof
        'crank-rocker'
        """
        return self.linkage.as_four_bar(self.input, self.output)

    def __iter__(self) -> Iterator[Circuit]:
        return iter(self.circuits)

    def __len__(self) -> int:
        return len(self.circuits)

    @overload
    def __getitem__(self, index: SupportsIndex) -> Circuit: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Circuit, ...]: ...

    def __getitem__(self, index: SupportsIndex | slice) -> Circuit | tuple[Circuit, ...]:
        """A circuit by its number, or some by a slice: `motion[0]`, `motion[-1]`."""
        try:
            return self.circuits[index]
        except IndexError:
            count = len(self.circuits)
            raise IndexError(f"motion: no circuit {shown(index)}; it has {count}, counted from 0") from None

    def __bool__(self) -> bool:
        """A motion without circuits is a result as well."""
        return True

    def columns(self, *, si: bool = False) -> dict[str, npt.NDArray[Any]]:
        """Every row of every circuit, column by column; each name ends in its unit.

        Angles are in degrees and lengths in the linkage's unit; with `si` in radians and metres.

        >>> import sevenbar as sb
        >>> list(sb.load("planar_4r").motion().columns())[:6]
        ['circuit', 'branch', 'sample', 'status', 'time_s', 'theta_1_deg']
        """
        parts = list(self.column_parts(si=si))
        if not parts:
            return {}
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def column_parts(self, *, si: bool = False) -> Iterator[dict[str, npt.NDArray[Any]]]:
        """`columns` circuit by circuit: the rows of a long one are dropped with its part.

        >>> import sevenbar as sb
        >>> [len(part["status"]) for part in sb.load("rssr").motion(36).column_parts()]
        [36, 36]
        """
        for circuit in self.circuits:
            yield circuit_columns(circuit.fleeting(), self.linkage, si=si)

    def to_frame(self) -> pd.DataFrame:
        """`columns` as a pandas table (extra `[frame]`); `attrs["units"]` has the unit of each column.

        >>> import sevenbar as sb
        >>> sb.load("planar_4r").motion(12).to_frame().attrs["units"]["theta_4_rad_s"]
        'rad/s'
        """
        return frame_of(self.columns(), self.linkage)


def chosen_circuit(motion: Motion, index: int) -> Circuit:
    """The circuit of this index, or `RequestError` saying why there is none."""
    count = len(motion.circuits)
    if count == 0:
        closing = "at no input" if motion.motion_type == "cannot-assemble" else "along no circuit"
        raise RequestError(
            f"motion: {motion.motion_type}, the loop closes {closing}; 'sevenbar analyze' says why"
        )
    return motion.circuits[whole_number("circuit", index, 0, count - 1, "a circuit of this motion")]
