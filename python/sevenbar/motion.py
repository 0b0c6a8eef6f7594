"""What a linkage does: assembly modes, circuits, traces of points. Values made from the core's arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array
from sevenbar.errors import MissingExtraError, RequestError, shown

if TYPE_CHECKING:
    import pandas as pd

    from sevenbar.linkage import Linkage
    from sevenbar.mobility import Mobility

Integers = npt.NDArray[np.int64]
Words = npt.NDArray[np.str_]

#: What a row can hold, by the core's number: all; the pose but no rates (two reasons); nothing; all but the
#: balls' turns, which a row with the pose but no rates may lack, too.
STATUSES = ("ok", "dead-centre", "change-point", "no-solution", "turns-undefined")

_STATUS_WORDS = np.array(STATUSES)

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


def change_points_from(
    raw: Sequence[tuple[Any, Sequence[int], int, int]], column: int
) -> tuple[ChangePoint, ...]:
    """Change points as the core has them (values, circuits, ways, freedoms); `column`: the input."""
    points = (
        ChangePoint(float(values[column]), np.array(values), tuple(circuits), ways, freedoms)
        for values, circuits, ways, freedoms in raw
    )
    return tuple(sorted(points, key=lambda point: point.input % math.tau))


@dataclass(frozen=True, eq=False)
class Output:
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


@dataclass(frozen=True, eq=False)
class Modes:
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
class Trace:
    """A point of a link along a circuit, in the report frame; arrays of shape (n, 3).

    `position` [length], `velocity` [length/s], `acceleration` [length/s^2], `jerk` [length/s^3]. Rows
    without a value are NaN, with a status.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats
    status: Words


@dataclass(frozen=True, eq=False)
class Sensitivity:
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


@dataclass(frozen=True, eq=False)
class Law:
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


@dataclass(frozen=True, eq=False)
class Circuit:
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
    input_column: int
    output_column: int
    #: Whether the output is an angle, not a slide.
    output_turns: bool
    #: The size of the linkage [length].
    size: float
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

    @property
    def angle(self) -> Extremes | None:
        """The extremes of the output angle [rad]: its dead centres; `None` for an output that turns fully."""
        ends = [d for d in self.dead_centres if d.kind == "output"]
        if self.output_range is None or len(ends) < 2:
            return None
        low, high = min(ends, key=lambda d: d.output), max(ends, key=lambda d: d.output)
        return Extremes(low.output, low.input, high.output, high.input)

    @property
    def swing(self) -> float | None:
        """The angle [rad] through which the output rocks; `None` for one that turns fully."""
        return None if self.output_range is None else self.output_range[1] - self.output_range[0]

    @property
    def time_ratio(self) -> float | None:
        """Time of the slower stroke over that of the quicker, >= 1, for a crank with a rocking output.

        `None` also for a crank that turns back on the way, and at a change point where both ends of the
        output are at one input: a stroke without time.
        """
        if self.angle is None or self.input_range is not None or self.turns_back:
            return None
        stroke = (self.angle.highest_at - self.angle.lowest_at) % math.tau
        slower, quicker = max(stroke, math.tau - stroke), min(stroke, math.tau - stroke)
        return slower / quicker if quicker > 0 else None

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
        return LinkMotion(turn, _axial(spin), _axial(second @ back + rate @ np.swapaxes(rate, -1, -2)))

    def _frame(self, link: object) -> Floats:
        count = len(self._frames)
        if isinstance(link, bool) or not isinstance(link, (int, np.integer)) or not 1 <= link <= count:
            raise RequestError(
                f"link: {shown(link)} is not a link; give 1 to {count}, the last is the ground"
            )
        frame: Floats = self._frames[int(link) - 1]
        return frame


@dataclass(frozen=True, eq=False)
class LinkMotion:
    """How a link turns along a circuit, in the report frame.

    `rotation` (n, 3, 3), its axes as columns; `velocity` [rad/s] and `acceleration` [rad/s^2] are vectors
    (n, 3). Rows without a value are NaN.
    """

    rotation: Floats
    velocity: Floats
    acceleration: Floats


def _axial(matrices: Floats) -> Floats:
    """The vectors w of the skew parts of matrices (n, 3, 3)."""
    odd = 0.5 * (matrices - np.swapaxes(matrices, -1, -2))
    return np.stack([odd[..., 2, 1], odd[..., 0, 2], odd[..., 1, 0]], axis=-1)


@dataclass(frozen=True, eq=False)
class Motion:
    """The circuits of a linkage over the whole input range."""

    linkage: Linkage
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
    completeness: Literal["closed-form", "counted", "algebraic", "searched"]
    #: How the set of circuits was established.
    established: str
    #: Constraints that the others imply, in words.
    redundant: tuple[str, ...]
    law: Law | None = None
    #: Poses that redundant constraints alone keep open: by how much [rad, parts of the size], rising.
    misfits: Floats = field(default_factory=_none)
    #: How the circuits were counted; `None` where they were not.
    count: Count | None = None

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

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """Every row of every circuit, column by column; each name ends in its unit.

        >>> import sevenbar as sb
        >>> list(sb.load("planar_4r").motion().columns())[:6]
        ['circuit', 'branch', 'sample', 'status', 'time_s', 'theta_1_deg']
        """
        unit = self.linkage.length_unit
        parts = [_circuit_columns(circuit, self.linkage, unit) for circuit in self.circuits]
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


def _circuit_columns(circuit: Circuit, linkage: Linkage, unit: str) -> dict[str, npt.NDArray[Any]]:
    count = len(circuit.time)
    columns: dict[str, npt.NDArray[Any]] = {
        "circuit": np.full(count, circuit.index),
        "branch": circuit.branch,
        "sample": np.arange(count),
        "status": circuit.status,
        "time_s": circuit.time,
    }
    slides = [kind == "slide" for kind in linkage.column_kinds]
    for index, (name, slide) in enumerate(zip(circuit.columns, slides, strict=True)):
        if slide:
            columns[f"{name}_{unit}"] = circuit.q[:, index]
        else:
            columns[f"{name}_deg"] = np.degrees(circuit.q[:, index])
    for suffix, values in (("s", circuit.dq), ("s2", circuit.ddq), ("s3", circuit.dddq)):
        for index, (name, slide) in enumerate(zip(circuit.columns, slides, strict=True)):
            columns[f"{name}_{unit if slide else 'rad'}_{suffix}"] = values[:, index]
    for point in linkage.points:
        trace = circuit.point(point.link, point.at)
        for letter, suffix, values in (
            ("", unit, trace.position),
            ("v", f"{unit}_s", trace.velocity),
            ("a", f"{unit}_s2", trace.acceleration),
        ):
            for axis, name in enumerate("xyz"):
                columns[f"{point.name}_{letter}{name}_{suffix}"] = values[:, axis]
    columns[f"residual_{unit}"] = circuit.residual
    return columns


def status_words(numbers: Integers) -> Words:
    """The status of each row by the core's number."""
    return _STATUS_WORDS[numbers]


def circuit_from(
    raw: Mapping[str, Any],
    *,
    linkage: Linkage,
    index: int,
    columns: tuple[int, int],
    speed: float,
    law: Law | None,
    size: float,
    **own: Any,
) -> Circuit:
    """A circuit from the core's arrays; `columns`: input and output; `own`: what its solver adds."""
    q, dq, ddq, dddq = raw["joints"]
    input_column, output_column = columns
    inputs = q[:, input_column]
    if law is None:
        velocity = scaled_extremes(raw["velocity"], speed)
        acceleration = scaled_extremes(raw["acceleration"], speed * speed)
        jerk = scaled_extremes(raw["jerk"], speed**3)
    else:
        velocity = sampled_extremes(dq[:, output_column], inputs)
        acceleration = sampled_extremes(ddq[:, output_column], inputs)
        jerk = sampled_extremes(dddq[:, output_column], inputs)
    if "status" not in own:
        own["status"] = status_words(raw["status"])
    own.setdefault("output_range", raw["output"])
    return Circuit(
        index=index,
        turns=raw["turns"],
        columns=linkage.columns,
        q=q,
        dq=dq,
        ddq=ddq,
        dddq=dddq,
        time=driven_time(inputs, speed, law),
        branch=raw["branch"],
        residual=raw["residual"] * size,
        condition=raw["condition"],
        dead_centres=tuple(DeadCentre(*d) for d in raw["dead_centres"]),
        input_range=raw["input"],
        velocity=velocity,
        acceleration=acceleration,
        jerk=jerk,
        input_column=input_column,
        output_column=output_column,
        output_turns=linkage.column_kinds[output_column] == "turn",
        size=size,
        _frames=linkage.point_frames,
        **own,
    )


def driven_time(inputs: Floats, speed: float, law: Law | None) -> Floats:
    """The time [s] of each row: along the input's travel, or the law's once for each pass."""
    if law is not None:
        return np.tile(law.t, len(inputs) // law.t.size)
    if inputs.size == 0:
        return np.array([])
    steps = np.abs(inputs[1:] - inputs[:-1])
    steps[np.isnan(steps)] = 0.0
    time = np.zeros(len(inputs))
    np.cumsum(steps, out=time[1:])
    return time / abs(speed)


def scaled_extremes(raw: list[tuple[float, float]] | None, factor: float) -> Extremes | None:
    """The extremes of a rate at another speed than the core's one."""
    if raw is None:
        return None
    ends = sorted((value * factor, at) for value, at in raw)
    return Extremes(*ends[0], *ends[1])


def sampled_extremes(values: Floats, inputs: Floats) -> Extremes | None:
    """Extremes as sampled: all that a law given by samples can tell."""
    if np.isnan(values).all():
        return None
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return Extremes(float(values[low]), float(inputs[low]), float(values[high]), float(inputs[high]))


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
