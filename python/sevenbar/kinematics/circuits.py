"""One circuit: its rows, rates, extremes and dead centres, points and links along it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.rigid import axial
from sevenbar.text.printing import Printed

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


@dataclass(frozen=True)
class Tally:
    """How many rows a circuit has, how many of each status, and their greatest closure error [length]."""

    rows: int
    statuses: Mapping[str, int]
    #: NaN where no row has one.
    residual: float


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

    @cached_property
    def tally(self) -> Tally:
        """What there is to say of the rows as a whole."""
        words, counts = np.unique(self.status, return_counts=True)
        known = self.residual[np.isfinite(self.residual)]
        return Tally(
            len(self.time),
            {str(word): int(count) for word, count in zip(words, counts, strict=True)},
            float(known.max()) if known.size else math.nan,
        )

    def fleeting(self) -> Circuit:
        """The circuit for one look at its rows: those of a long one are not kept with it."""
        return self

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
