"""What a linkage does: assembly modes, circuits, traces of points. Values made from the core's arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array
from sevenbar.errors import MissingExtraError, RequestError, shown
from sevenbar.kinematics.columns import joint_column, point_column
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.rigid import axial
from sevenbar.text.printing import Printed
from sevenbar.text.units import LENGTHS

if TYPE_CHECKING:
    import pandas as pd

    from sevenbar.kinematics.geometry import Loop
    from sevenbar.kinematics.mobility import Mobility

Integers = npt.NDArray[np.int64]
Words = npt.NDArray[np.str_]

#: What a row can hold, by the core's number: all; the pose but no rates (two reasons); nothing; all but the
#: balls' turns, which a row with the pose but no rates may lack, too.
STATUSES = ("ok", "dead-centre", "change-point", "no-solution", "turns-undefined")

#: The status of a row of a trace on the coupler where the spin's rule names no direction.
SPIN_UNDEFINED = "spin-undefined"


@dataclass(frozen=True)
class Extremes:
    """The lowest and the highest value of a quantity, and the input [rad] at which each occurs."""

    lowest: float
    lowest_at: float
    highest: float
    highest_at: float


@dataclass(frozen=True)
class DeadCentre:
    """A pose where the input (`kind` "input") or the output ("output") stands still.

    `input` and `output` are the two angles [rad], `branch` the pass on which it lies, `condition` how much
    a relative change of the squared dimensions is magnified in its place.
    """

    kind: Literal["input", "output"]
    input: float
    output: float
    branch: int
    condition: float


@dataclass(frozen=True, eq=False)
class ChangePoint:
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


@dataclass(frozen=True, eq=False, repr=False)
class Output(Printed):
    """Both branches of the closed form on n inputs; arrays (2, n), `None` above the order asked for.

    `position` [rad], `velocity` [rad/s], `acceleration` [rad/s^2], `jerk` [rad/s^3]. An input without
    solution keeps its place as NaN; so do the rates at an input dead centre. `status` tells which.
    """

    position: Floats
    velocity: Floats | None = None
    acceleration: Floats | None = None
    jerk: Floats | None = None

    @property
    def status(self) -> Words:
        """The status of each value, (2, n): "ok", "dead-centre" (from order 1 on), "no-solution"."""
        status = np.full(self.position.shape, "ok", dtype="<U15")
        if self.velocity is not None:
            status[np.isnan(self.velocity)] = "dead-centre"
        status[np.isnan(self.position)] = "no-solution"
        return status


def _none() -> Floats:
    return np.array([])


@dataclass(frozen=True, eq=False, repr=False)
class Modes(Printed):
    """All assembly modes at one input: joint values (m, columns), angles in (-pi, pi].

    Turns of a ball that have no direction are NaN; `status` tells of such modes.
    """

    q: Floats
    residual: Floats
    completeness: Literal["closed-form", "algebraic", "searched"]
    columns: tuple[str, ...]
    input: float
    #: Other poses that redundant constraints alone keep open: by how much [rad, parts of the size], rising.
    misfits: Floats = field(default_factory=_none)

    @property
    def status(self) -> Words:
        """The status of each mode, (m,): "ok", or "turns-undefined" where those of a ball are."""
        return np.where(np.isnan(self.q).any(axis=1), "turns-undefined", "ok")

    def __len__(self) -> int:
        return len(self.q)


@dataclass(frozen=True)
class OpenRange:
    """A range of a joint [rad] in which its branch points are not all accounted for."""

    start: float
    end: float
    #: Dead centres counted there and not known; `None` where solutions run to infinity, or were lost.
    missing: int | None


@dataclass(frozen=True)
class Count:
    """The account of a joint's branch points: all of them, and the modes at one value, mean all circuits.

    The joint is the input, or the first that turns where the input slides.
    """

    joint: str
    #: Real branch points, where this joint turns back on a circuit, or farther out than these are followed.
    dead_centres: int
    #: Complex ones near the real values, located and counted off.
    complex_branch_points: int
    #: Joints, of those watched, that become infinite near the real values; kept out of the count.
    poles: int
    #: Ranges that do not balance; none where circuits are `counted`.
    open: tuple[OpenRange, ...]


@dataclass(frozen=True, eq=False)
class Search:
    """What a search for the circuits came to; of the closed form no more than that.

    All modes were found at so many `values` of each of the `columns`; from `unfollowed` of them no motion
    could be followed. `rank` is that of the joints' screws in these poses and `freedoms` those of the
    motions out of them, `None` where there are none.
    """

    completeness: Literal["closed-form", "counted", "algebraic", "searched"]
    columns: tuple[str, ...] = ()
    values: int = 0
    unfollowed: int = 0
    rank: int | None = None
    freedoms: int | None = None
    #: Poses that redundant constraints alone keep open: by how much [rad, parts of the size], rising.
    misfits: Floats = field(default_factory=_none)
    #: How the circuits were counted; `None` where they were not.
    count: Count | None = None
    #: Why they were not: modes were "searched", a solution was "lost", or with the input "still" others move.
    uncounted: Literal["searched", "lost", "still"] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Trace(Printed):
    """A point of a link along a circuit, in the report frame; arrays of shape (n, 3).

    `position` [length], `velocity` [length/s], `acceleration` [length/s^2], `jerk` [length/s^3]. Rows
    without a value are NaN, with a status.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats
    status: Words


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(Printed):
    """Derivatives of a circuit by the k numbers of its linkage's description, on its n rows.

    `names` and `units` (k,) are those of the numbers, as in the file. `position` (n, columns, k) [rad, or
    length, by the number's unit], `velocity` and `acceleration` by time at the circuit's own input, which
    stays as it is; of a ball's turns there is the position only. `points` has each named point's derivative
    (n, 3, k), `point_velocities` that of its velocity. NaN in rows without rates (`status` tells why), for
    numbers that open the loop if they change alone (`opening`), and for what spins idly.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    columns: tuple[str, ...]
    position: Floats
    velocity: Floats
    acceleration: Floats
    points: Mapping[str, Floats]
    point_velocities: Mapping[str, Floats]
    opening: tuple[str, ...]
    status: Words


@dataclass(frozen=True, eq=False, repr=False)
class Law(Printed):
    """An input law: time [s], input [rad] and its derivatives by time, each of shape (n,).

    Laws of the same numbers are equal; its arrays are its own and read-only.
    """

    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    dddq: Floats

    def __post_init__(self) -> None:
        for name in ("t", "q", "dq", "ddq", "dddq"):
            array = np.array(getattr(self, name), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __reduce__(self) -> tuple[type[Law], tuple[Floats, ...]]:
        return Law, (self.t, self.q, self.dq, self.ddq, self.dddq)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Law):
            return NotImplemented
        return np.array_equal(self.t, other.t) and np.array_equal(self.table, other.table)

    def __hash__(self) -> int:
        # equal zeros differ in their sign bit, which adding 0 takes away
        return hash(((self.t + 0.0).tobytes(), (self.table + 0.0).tobytes()))

    @staticmethod
    def of(
        t: npt.ArrayLike, q: npt.ArrayLike, dq: npt.ArrayLike, ddq: npt.ArrayLike, dddq: npt.ArrayLike = 0.0
    ) -> Law:
        """A law from array-likes; a single number stands for every sample.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> t = np.linspace(0, 1, 50)
        >>> law = sb.Law.of(t, q=3 * t**2, dq=6 * t, ddq=6)
        >>> sb.load("rssr").motion(law=law).circuits[0].time.size
        50
        """
        arrays = {"t": t, "q": q, "dq": dq, "ddq": ddq, "dddq": dddq}
        checked = {name: finite_array(name, values) for name, values in arrays.items()}
        count = checked["t"].size
        if count == 0:
            raise RequestError("t: a law needs at least one sample")
        for name, values in checked.items():
            if values.size not in (1, count):
                raise RequestError(
                    f"{name}: {values.size} values where t has {count}; give {count}, or one number"
                )
        if np.any(np.diff(checked["t"]) <= 0):
            raise RequestError("t: times must rise from sample to sample")
        return Law(**{name: np.broadcast_to(values, (count,)) for name, values in checked.items()})

    @property
    def table(self) -> Floats:
        """The input and its derivatives, (n, 4)."""
        return np.column_stack([self.q, self.dq, self.ddq, self.dddq])


@dataclass(frozen=True, eq=False, repr=False)
class Circuit(Printed):
    """One connected motion, row by row along it.

    `q`, `dq`, `ddq`, `dddq` hold one column for each one-freedom joint (`columns` names them), (n,
    columns), unwrapped [rad and derivatives by s]. `time` [s]; `status`, `branch` (the pass between input
    dead centres), `mode` (the branch of the closed form), `residual` (closure error in the length unit),
    `condition` (how much a relative error of the squared lengths is magnified in the velocity), each (n,).
    """

    index: int
    motion_type: str
    closed: bool
    turns: int
    columns: tuple[str, ...]
    q: Floats
    dq: Floats
    ddq: Floats
    dddq: Floats
    time: Floats
    status: Words
    branch: Integers
    mode: Integers
    residual: Floats
    condition: Floats
    dead_centres: tuple[DeadCentre, ...]
    #: Ranges [rad, or length] of input and output; `None` for one that turns fully, though it may turn back
    #: on the way.
    input_range: tuple[float, float] | None
    output_range: tuple[float, float] | None
    #: The transmission angle [rad]; `None` where it is not defined.
    transmission: Extremes | None
    #: Of the output's velocity [rad/s], acceleration [rad/s^2] and jerk [rad/s^3]; `None` where they grow
    #: without bound, or a change point lies within.
    velocity: Extremes | None
    acceleration: Extremes | None
    jerk: Extremes | None
    #: Of the output itself [rad, or length]: its lowest and highest dead centre; `None` where it turns fully.
    angle: Extremes | None
    #: How far the output rocks [rad, or length]; `None` for one that turns fully.
    swing: float | None
    #: Time of the slower stroke over that of the quicker, >= 1, for a crank with a rocking output. `None`
    #: also for a crank that turns back on the way, and at a change point where both ends of the output are at
    #: one input: a stroke without time.
    time_ratio: float | None
    input_column: int
    output_column: int
    #: Whether input and output are angles, not slides.
    input_turns: bool
    output_turns: bool
    #: The size of the linkage [length].
    size: float
    #: d(input)/dt [rad/s, or length/s]; NaN where a law drives.
    speed: float
    _point: Callable[[int, Floats], Trace] = field(repr=False)
    _frames: Floats = field(repr=False)
    _sensitivity: Callable[[Circuit], Sensitivity] = field(repr=False)

    @property
    def input(self) -> Floats:
        """The input angle [rad], (n,)."""
        return self.q[:, self.input_column]

    @property
    def output(self) -> Floats:
        """The output angle [rad], (n,)."""
        return self.q[:, self.output_column]

    @property
    def turns_back(self) -> bool:
        """Whether the input has dead centres: there rates against it grow without bound."""
        return any(d.kind == "input" for d in self.dead_centres)

    @property
    def goes_round(self) -> bool:
        """Whether the input, driven one way, leads all along the circuit: it turns fully and never back."""
        return self.closed and self.input_range is None and not self.turns_back

    def pass_range(self, branch: int) -> tuple[float, float] | None:
        """The range of the input [rad, or length] on one of its passes; `None` where it goes round."""
        if self.goes_round:
            return None
        ends = [d.input for d in self.dead_centres if d.kind == "input"]
        if not self.closed or branch >= len(ends):
            return self.input_range
        ends.append(ends[0] + math.tau * self.turns)
        return min(ends[branch : branch + 2]), max(ends[branch : branch + 2])

    def point(self, link: int, at: tuple[float, float, float]) -> Trace:
        """A point of link 1, 2, .. along the circuit.

        `at` is written as for the points of the file: (u, v, w) in Denavit-Hartenberg rows, in the
        link's frame for `[rssr]`, in ground coordinates of the drawn pose for drawn joints.

        Source: docs/theory.md, (16).

            >>> import numpy as np
            >>> import sevenbar as sb
            >>> circuit = sb.load("rssr").motion().circuits[0]
            >>> trace = circuit.point(link=1, at=(250, 0, 0))  # the crank's ball: 250 mm at 10 rad/s
            >>> bool(np.allclose(np.linalg.norm(trace.acceleration, axis=1), 25000))
            True
        """
        frame = self._frame(link)
        place = finite_array("at", at)
        if place.size != 3:
            raise RequestError(f"at: {place.size} numbers; give three")
        return self._point(int(link), frame[:3, :3] @ place + frame[:3, 3])

    def sensitivity(self) -> Sensitivity:
        """Exact derivatives of all joints and named points by every number of the linkage's description.

        The input stays as it is. Raises `RequestError` for a linkage made without a description.

        Source: docs/theory_design.md, (1) to (5).

            >>> import sevenbar as sb
            >>> found = sb.load("rssr").motion(12).circuits[0].sensitivity()
            >>> found.names, found.position.shape
            (('M', 'N', 'L1', 'L2', 'L3', 'D'), (12, 8, 6))
        """
        return self._sensitivity(self)

    def link_motion(self, link: int) -> LinkMotion:
        """How link 1, 2, .. turns along the circuit: angular velocity and acceleration, report frame.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> crank = sb.load("rssr").motion().circuits[0].link_motion(1)
        >>> bool(np.allclose(crank.velocity, (0, 0, 10)))
        True
        """
        self._frame(link)
        # the axes of the link's frame as far points, so that differences lose nothing
        places = [np.zeros(3), *(self.size * np.eye(3))]
        traces = [self._point(int(link), place) for place in places]

        def axes(name: str) -> Floats:
            origin, *ends = (getattr(trace, name) for trace in traces)
            return np.stack([(end - origin) / self.size for end in ends], axis=-1)

        turn, rate, second = axes("position"), axes("velocity"), axes("acceleration")
        back = np.swapaxes(turn, -1, -2)
        spin = rate @ back
        return LinkMotion(turn, axial(spin), axial(second @ back + rate @ np.swapaxes(rate, -1, -2)))

    def _frame(self, link: object) -> Floats:
        count = len(self._frames)
        if isinstance(link, bool) or not isinstance(link, (int, np.integer)) or not 1 <= link <= count:
            raise RequestError(
                f"link: {shown(link)} is not a link; give 1 to {count}, the last is the ground"
            )
        frame: Floats = self._frames[int(link) - 1]
        return frame


@dataclass(frozen=True, eq=False, repr=False)
class LinkMotion(Printed):
    """How a link turns along a circuit, in the report frame.

    `rotation` (n, 3, 3), its axes as columns; `velocity` [rad/s] and `acceleration` [rad/s^2] are vectors
    (n, 3). Rows without a value are NaN.
    """

    rotation: Floats
    velocity: Floats
    acceleration: Floats


class Solvable(Loop):
    """A loop that answers: what results know of the `Linkage` that was asked."""

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Crank, coupler and rocker of an RSSR [length]."""
        raise NotImplementedError

    @property
    def idle(self) -> tuple[str, ...]:
        """Freedoms that move no other link."""
        raise NotImplementedError

    @property
    def held(self) -> tuple[frozenset[int], list[int], int]:
        """How idle freedoms are held: balls as two turns, columns at zero, and how many spins otherwise."""
        raise NotImplementedError

    @property
    def spin_axes(self) -> dict[str, Floats]:
        """The axis that holds the idle spin beyond a ball, by the ball's name."""
        raise NotImplementedError

    def mobility(self) -> Mobility:
        """How freely the loop moves."""
        raise NotImplementedError

    def assembly_modes(
        self, theta: float, *, input: str | None = None, method: Literal["auto", "general"] = "auto"
    ) -> Modes:
        """Every assembly mode at one value of the input."""
        raise NotImplementedError

    def motion(
        self,
        samples: int = 360,
        *,
        input: str | None = None,
        output: str | None = None,
        speed: float | str | None = None,
        law: Law | None = None,
        method: Literal["auto", "general"] = "auto",
    ) -> Motion:
        """Every circuit over the whole input range."""
        raise NotImplementedError

    def circuit(
        self,
        pose: npt.ArrayLike,
        samples: int = 360,
        *,
        input: str | None = None,
        output: str | None = None,
        speed: float | str | None = None,
        law: Law | None = None,
    ) -> Circuit:
        """The one circuit through a pose."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Printed):
    """The circuits of a linkage over the whole input range."""

    linkage: Solvable
    input: str
    output: str
    #: d(input)/dt [rad/s]; NaN where a law drives.
    speed: float
    samples: int
    motion_type: str
    #: Input dead centres [rad] in [0, 2 pi), rising.
    limits: Floats
    #: Poses at which branches meet, or would by a change of some 1e-12 of a dimension; isolated poses too.
    change_points: tuple[ChangePoint, ...]
    circuits: tuple[Circuit, ...]
    #: How the circuits were looked for, and what was found out.
    search: Search
    #: Constraints that the others imply, in words.
    redundant: tuple[str, ...]
    law: Law | None = None

    @property
    def completeness(self) -> Literal["closed-form", "counted", "algebraic", "searched"]:
        """How it is known that no circuit is missing."""
        return self.search.completeness

    @property
    def change_point_inputs(self) -> Floats:
        """The input at the change points [rad in [0, 2 pi), or length], rising; isolated poses aside."""
        values = np.array([point.input for point in self.change_points if not point.isolated])
        turns = self.linkage.column_kinds[self.linkage.columns.index(self.input)] == "turn"
        return np.sort(np.mod(values, math.tau) if turns else values)

    @property
    def idle(self) -> tuple[str, ...]:
        """Freedoms that move one link only."""
        return self.linkage.idle

    @property
    def mobility(self) -> Mobility:
        """How freely the linkage moves."""
        return self.linkage.mobility()

    def __iter__(self) -> Iterator[Circuit]:
        return iter(self.circuits)

    def columns(self, *, si: bool = False) -> dict[str, npt.NDArray[Any]]:
        """Every row of every circuit, column by column; each name ends in its unit.

        Angles are in degrees and lengths in the linkage's unit; with `si` in radians and metres.

        >>> import sevenbar as sb
        >>> list(sb.load("planar_4r").motion().columns())[:6]
        ['circuit', 'branch', 'sample', 'status', 'time_s', 'theta_1_deg']
        """
        parts = [_circuit_columns(circuit, self.linkage, si) for circuit in self.circuits]
        if not parts:
            return {}
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def to_frame(self) -> pd.DataFrame:
        """`columns` as a pandas table (extra `[frame]`)."""
        try:
            import pandas as pd
        except ImportError:
            raise MissingExtraError(
                "to_frame needs pandas; install it with: pip install 'sevenbar[frame]'"
            ) from None
        return pd.DataFrame(self.columns())


def _circuit_columns(circuit: Circuit, linkage: Loop, si: bool) -> dict[str, npt.NDArray[Any]]:
    count = len(circuit.time)
    length, angle = ("m", "rad") if si else (linkage.length_unit, "deg")
    scale = LENGTHS[linkage.length_unit] if si else 1.0
    columns: dict[str, npt.NDArray[Any]] = {
        "circuit": np.full(count, circuit.index),
        "branch": circuit.branch,
        "sample": np.arange(count),
        "status": circuit.status,
        "time_s": circuit.time,
    }
    for order, values in enumerate((circuit.q, circuit.dq, circuit.ddq, circuit.dddq)):
        for index, (name, kind) in enumerate(zip(circuit.columns, linkage.column_kinds, strict=True)):
            slides = kind == "slide"
            column = values[:, index] * scale if slides else values[:, index]
            head = joint_column(name, slides=slides, order=order, length=length, angle=angle)
            columns[head] = np.degrees(column) if head.endswith("_deg") else column
    for point in linkage.points:
        trace = circuit.point(point.link, point.at)
        for order, values in enumerate((trace.position, trace.velocity, trace.acceleration)):
            for axis, letter in enumerate("xyz"):
                head = point_column(point.name, letter, order=order, length=length)
                columns[head] = values[:, axis] * scale
    columns[f"residual_{length}"] = circuit.residual * scale
    return columns


def chosen_circuit(motion: Motion, index: int) -> Circuit:
    """The circuit of this index, or `RequestError` saying why there is none."""
    count = len(motion.circuits)
    if count == 0:
        closing = "at no input" if motion.motion_type == "cannot-assemble" else "along no circuit"
        raise RequestError(
            f"motion: {motion.motion_type}, the loop closes {closing}, so there is nothing to draw"
        )
    if isinstance(index, bool) or not isinstance(index, (int, np.integer)) or not 0 <= index < count:
        allowed = "0" if count == 1 else f"0 to {count - 1}"
        raise RequestError(f"circuit: {shown(index)} is not a circuit of this motion; give {allowed}")
    return motion.circuits[index]
