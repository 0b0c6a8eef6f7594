"""One circuit: its rows, rates, extremes and dead centres, points and links along it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers, ReadOnly, Words, counted, finite_array, triple, whole_number
from sevenbar.errors import RequestError, ends_here, shown
from sevenbar.kinematics.circuits.circuit_values import DeadCentre, Extremes, Sensitivity, Tally, Trace
from sevenbar.kinematics.circuits.with_extents import ExtentAnswers, WithExtents
from sevenbar.kinematics.loop.columns import column_named
from sevenbar.kinematics.loop.rigid import placed, pose
from sevenbar.text.printing import Printed

# what a circuit gives when it is asked is imported by the answer, not with every circuit
if TYPE_CHECKING:
    import pandas as pd

    from sevenbar.forces.acting import Load, Spring
    from sevenbar.forces.bodies import Body
    from sevenbar.forces.counterweights import Balance
    from sevenbar.forces.free_motion.equilibria import Equilibrium
    from sevenbar.forces.free_motion.result import FreeMotion
    from sevenbar.forces.loading import Loading
    from sevenbar.forces.result import Forces
    from sevenbar.forces.waves import ForceWaves
    from sevenbar.kinematics.circuits.instant_centres import InstantCentres
    from sevenbar.kinematics.circuits.link_motion import LinkMotion
    from sevenbar.kinematics.circuits.one_pose import OnePose
    from sevenbar.kinematics.loop.geometry import Point
    from sevenbar.kinematics.loop.screw_axes import ScrewAxes, Twists

#: Dead centres of input and output whose angles [rad, or relative to the size] differ by less are one pose.
TOGETHER = 1e-7

#: An output that moves less than this compared with the input [rad, or relative to the size] rests.
AT_REST = 1e-12


class Answers(ExtentAnswers, Protocol):
    """What a circuit asks its linkage when it is asked itself: each is its own question of that name."""

    def point(self, name: str) -> Point:
        """A named point; raises `RequestError` where there is none."""

    def place(self, link: int, at: Floats) -> tuple[float, float, float]:
        """A place on a link as the file writes it, from two or three numbers."""

    def transmission_angle(self, circuit: Circuit) -> Floats | None:
        """On each row (n,) [rad]."""

    def transmission(self, circuit: Circuit) -> Extremes | None:
        """The extremes of it [rad]."""

    def advantage(self, circuit: Circuit) -> Extremes | None:
        """The extremes of the mechanical advantage."""

    def velocity(self, circuit: Circuit) -> Extremes | None:
        """The extremes of the output's velocity where it has a limit at dead centres of the input."""

    def rests_together(self, circuit: Circuit) -> Mapping[int, float]:
        """d(output)/d(input) on the rows in which both rest."""

    def sensitivity(self, circuit: Circuit) -> Sensitivity:
        """By every number of the description."""

    def plane_coordinates(self, places: Floats) -> Floats | None:
        """Places (..., 3) in the plane of a planar loop (..., 2), `None` for others."""

    def loading(self, circuit: Circuit, given: Mapping[str, Any]) -> Loading:
        """What acts on one, with what is given in place of what the linkage has."""

    def forces(self, circuit: Circuit, given: Mapping[str, Any], *, at_rest: bool = False) -> Forces:
        """On its rows, with what is given in place of what the linkage has."""

    def force_waves(self, circuit: Circuit) -> ForceWaves | None:
        """Torque and shaking as series, where these are enough for measures."""

    def counterweights(
        self, circuit: Circuit, forces: Forces, links: Sequence[int], how: Mapping[str, Any]
    ) -> Balance:
        """On links, for the least shaking of these forces."""

    def free_motion(
        self, circuit: Circuit, loading: Loading, duration: float | str, **how: Any
    ) -> FreeMotion:
        """How it moves by itself."""

    def equilibria(self, circuit: Circuit, loading: Loading, torque: float) -> tuple[Equilibrium, ...]:
        """Where it can rest."""

    def pose(
        self,
        circuit: Circuit,
        value: float | str,
        branch: int | None,
        speed: float | str | None,
        acceleration: float,
    ) -> OnePose:
        """At a value of the input."""

    def frame(self, circuit: Circuit) -> pd.DataFrame:
        """Its rows as a pandas table."""


def _given(**acting: object) -> dict[str, object]:
    """What is given of what acts, in the place of what the linkage has."""
    return {key: value for key, value in acting.items() if value is not None}


@dataclass(frozen=True, eq=False, repr=False)
class Circuit(ReadOnly, Printed, WithExtents):
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
    #: Of the output's velocity [rad/s] as the core has it, acceleration [rad/s^2] and jerk [rad/s^3]; `None`
    #: where they grow without bound, or a change point lies within.
    _velocity: Extremes | None = field(repr=False)
    acceleration: Extremes | None
    jerk: Extremes | None
    #: Of the output itself [rad, or length]: its lowest and highest dead centre; `None` where it turns fully.
    angle: Extremes | None
    #: How far the output rocks [rad, or length]; `None` for one that turns fully.
    swing: float | None
    #: Time of the slower stroke over that of the quicker, >= 1, for a crank with a rocking output. `None`
    #: also for a crank that turns back on the way, at a change point where both ends of the output are at
    #: one input, a stroke without time, and where `many_strokes` leave it open which count.
    time_ratio: float | None
    #: Whether the output is at its highest, or lowest, at several inputs: more than two strokes.
    many_strokes: bool
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
    _answers: Answers = field(repr=False)
    #: The extremes of the transmission angle where the closed form has them.
    _transmission: Extremes | None = field(repr=False)

    @cached_property
    def velocity(self) -> Extremes | None:
        """The extremes of the output's velocity [rad/s, or length/s].

        `None` where it grows without bound, or a change point lies within. At a dead centre of the input at
        which the output rests, too, it has a limit.
        """
        ends = [d for d in self.dead_centres if d.kind == "input"]
        if self._velocity is None and ends and len(self._together) == len(ends):
            return self._answers.velocity(self.fleeting())
        return self._velocity

    @property
    def _together(self) -> list[DeadCentre]:
        """Dead centres of the input at which the output rests, too."""
        units = [1.0 if turns else self.size for turns in (self.input_turns, self.output_turns)]

        def same(one: DeadCentre, other: DeadCentre) -> bool:
            apart = max(abs(one.input - other.input) / units[0], abs(one.output - other.output) / units[1])
            return apart < TOGETHER

        ends, turns = ([d for d in self.dead_centres if d.kind == kind] for kind in ("input", "output"))
        return [one for one in ends if any(same(one, other) for other in turns)]

    @property
    def output_rests(self) -> bool:
        """Whether the output rests while the input moves: there the advantage has no bound."""
        turns = sum(d.kind == "output" for d in self.dead_centres)
        return turns > len(self._together)

    @cached_property
    def transmission(self) -> Extremes | None:
        """The lowest and the highest transmission angle [rad]; `None` where it is not defined.

        >>> import math
        >>> import sevenbar as sb
        >>> lowest = sb.load("planar_4r").motion().circuits[0].transmission.lowest
        >>> round(math.degrees(lowest), 6)  # cos mu = (100^2 + 80^2 - 130^2) / (2 * 100 * 80), supplement
        29.686295

        Source: docs/theory_measures.md, (4) to (7).
        """
        return self._transmission or self._answers.transmission(self.fleeting())

    @cached_property
    def transmission_angle(self) -> Floats | None:
        """The transmission angle [rad] on each row (n,), from 0 to a right angle; `None` where not defined.

        0 at dead centres of the input, but its limit where the output rests, too; NaN on rows without
        a pose. The pressure angle is a right angle less it.

        Source: docs/theory_measures.md, (4) to (6).
        """
        angle = self._answers.transmission_angle(self)
        if angle is not None:
            angle.setflags(write=False)
        return angle

    @property
    def mechanical_advantage(self) -> Floats:
        """Torque or force of the output over that of the input, without losses, (n,): d(input)/d(output).

        Torque over torque has no unit; a force at a slide over a torque is in 1/length, a torque over a
        force in length. Negative where they go opposite ways; without bound (inf) at dead centres of the
        output, 0 at those of the input, its limit at those of both, NaN where a row has no rates.

        Source: docs/theory_measures.md, (11).
        """
        rates = self.dq[:, [self.input_column, self.output_column]]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = rates[:, 0] / rates[:, 1]
        driving, driven = np.abs(
            rates / [1.0 if turns else self.size for turns in (self.input_turns, self.output_turns)]
        ).T
        ratio[driven <= AT_REST * driving] = np.inf
        ratio[self.status == "dead-centre"] = 0.0
        if self._together:
            for row, rate in self._answers.rests_together(self).items():
                ratio[row] = 1 / rate if rate else np.inf
        return np.asarray(ratio)

    @cached_property
    def advantage(self) -> Extremes | None:
        """The lowest and the highest mechanical advantage; `None` where the output stands still on the way.

        >>> import sevenbar as sb
        >>> joint = sb.load("universal_joint").motion().circuits[0]  # a bend of acos(0.8)
        >>> sorted(abs(round(x, 12)) for x in (joint.advantage.lowest, joint.advantage.highest))
        [0.8, 1.25]
        """
        return self._answers.advantage(self.fleeting())

    @cached_property
    def tally(self) -> Tally:
        """What there is to say of the rows as a whole."""
        known = self.residual[np.isfinite(self.residual)]
        return Tally(len(self.time), counted(self.status), float(known.max()) if known.size else math.nan)

    def fleeting(self) -> Circuit:
        """The circuit for one look at its rows: those of a long one are not kept with it."""
        return self

    def __getitem__(self, name: str) -> Floats:
        """A joint along the rows (n,) [rad, or length], by the name of its column: `circuit["theta_4"]`.

        `KeyError` names the columns there are.
        """
        return self.q[:, column_named(self.columns, name)]

    @ends_here
    def at(
        self,
        value: float | str,
        *,
        branch: int | None = None,
        speed: float | str | None = None,
        acceleration: float = 0.0,
    ) -> OnePose:
        """The pose at a value of the input, as in "45 deg": rates, points, links, forces.

        The input has there the `speed` of the circuit, or this one, and this `acceleration` [rad/s, rad/s^2,
        or lengths]; where a law drives, the linkage's own speed. `branch` is the pass between dead centres of
        the input where more than one of them has the value.

            >>> import sevenbar as sb
            >>> pose = sb.load("planar_4r").motion().circuits[0].at("45 deg")
            >>> round(pose["theta_4"], 6), round(float(pose.dq[3]), 6)
            (-2.418254, -0.081445)
        """
        return self._answers.pose(self, value, branch, speed, acceleration)

    @ends_here
    def to_frame(self) -> pd.DataFrame:
        """Its rows as a pandas table (extra `[frame]`), with the columns of `Motion.to_frame`.

        `attrs["units"]` has the unit of each column.
        """
        return self._answers.frame(self)

    @property
    def input(self) -> Floats:
        """The input [rad, or length], (n,)."""
        return self.q[:, self.input_column]

    @property
    def output(self) -> Floats:
        """The output [rad, or length], (n,)."""
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

    @ends_here
    def point(self, link: int | str, at: Sequence[float] | None = None) -> Trace:
        """A point of link 1, 2, .. along the circuit, or a point of the linkage by its name.

        Of a planar linkage two numbers will do for `at`, (u, v): u along the link from its first joint to the
        next, v to its left. Three are written as for the points of the file: (u, v, w) in Denavit-Hartenberg
        rows, in the link's frame for `[rssr]`, in ground coordinates of the drawn pose for drawn joints.
        Raises `RequestError` for a link or a name that does not exist, and for three numbers of a linkage
        whose points are written by two, as those of `sevenbar.slider_crank`.

        Source: docs/theory.md, (16).

            >>> import numpy as np
            >>> import sevenbar as sb
            >>> circuit = sb.load("rssr").motion().circuits[0]
            >>> trace = circuit.point(link=1, at=(250, 0, 0))  # the crank's ball: 250 mm at 10 rad/s
            >>> bool(np.allclose(np.linalg.norm(trace.acceleration, axis=1), 25000))
            True
            >>> bool(np.array_equal(circuit.point("A").position, trace.position))
            True
        """
        if isinstance(link, str):
            if at is not None:
                remedy = "leave `at` out, or give a link by its number"
                raise RequestError(f"at: point {shown(link)} has its place; {remedy}")
            named = self._answers.point(link)
            return self.written_point(named.link, named.at)
        self._frame(link)
        if at is None:
            raise RequestError("at: a link needs a place on it; give three numbers, or a point by its name")
        return self.written_point(link, self._answers.place(link, finite_array("at", at)))

    @ends_here
    def written_point(self, link: int, at: tuple[float, float, float]) -> Trace:
        """A place of a link along the circuit, in the coordinates in which the file writes its points."""
        frame = self._frame(link)
        return self._point(int(link), placed(frame, triple("at", at)))

    @ends_here
    def sensitivity(self) -> Sensitivity:
        """Exact derivatives of all joints and named points by every number of the linkage's description.

        The input stays as it is. Raises `RequestError` for a linkage made without a description.

        Source: docs/theory_design.md, (1) to (5).

            >>> import sevenbar as sb
            >>> found = sb.load("rssr").motion(12).circuits[0].sensitivity()
            >>> found.names, found.position.shape
            (('M', 'N', 'L1', 'L2', 'L3', 'D'), (12, 8, 6))
        """
        return self._answers.sensitivity(self)

    @ends_here
    def forces(
        self,
        *,
        bodies: Mapping[int, Body | Sequence[Body]] | None = None,
        gravity: tuple[float, float, float] | None = None,
        loads: Sequence[Load] | None = None,
        springs: Sequence[Spring] | None = None,
        at_rest: bool = False,
    ) -> Forces:
        """What the input has to give, and what every joint bears, on each row.

        Bodies (by their link), gravity [m/s^2], loads and springs are those of the linkage's file, or the
        given ones. Rates are those of the circuit, or with `at_rest` zero: statics on every row, where
        nothing has inertia and dampers do nothing. Raises `RequestError` where nothing has a mass and nothing
        acts.

            >>> import sevenbar as sb
            >>> crank = sb.Body(mass=2.0, centre=(125, 0, 0))
            >>> found = sb.load("rssr").motion().circuits[0].forces(bodies={1: crank}, gravity=(0, 0, -9.81))
            >>> round(float(found.reactions["crank"].force[0, 2]), 6)  # the ground lifts 2 kg
            19.62

        Source: docs/theory_forces.md, (1) to (7).
        """
        given = _given(bodies=bodies, gravity=gravity, loads=loads, springs=springs)
        return self._answers.forces(self, given, at_rest=at_rest)

    @cached_property
    def force_waves(self) -> ForceWaves | None:
        """Torque and shaking as series, as measures take them; `None` where they need all of `forces`."""
        return self._answers.force_waves(self)

    @ends_here
    def counterweights(
        self,
        links: Sequence[int],
        *,
        radius: float | Mapping[int, float] | None = None,
        most_mass: float | Mapping[int, float] | None = None,
        measure: Literal["rms", "greatest"] = "rms",
        force: float = 1.0,
        moment: float = 0.0,
        bodies: Mapping[int, Body | Sequence[Body]] | None = None,
    ) -> Balance:
        """Counterweights on some links for the least shaking of all bodies, the linkage's or those given.

        Least squares over the cycle give mass times radius for each link, and the mass at a `radius` [length]
        from its joint at the ground, or from the joint before it. With `most_mass` [kg] no mass is above and
        none farther than `radius`, each a number or one by link; then the `measure` "rms" over the cycle or
        the "greatest" of the rows is the least there is, with its proof. What counts is the size of `force`
        times the force and `moment` [1/m] times the moment about the report's origin, without that of the
        counterweights' own inertia.

        Raises `RequestError` for arguments that do not fit, and where the shaking has no bound.

            >>> import sevenbar as sb
            >>> rod = {2: sb.Body(mass=1.3, solid="rod")}
            >>> found = sb.load("rssr").motion().circuits[0].counterweights([1, 3], bodies=rod)
            >>> found.rank, found.unknowns, bool(found.after < 1e-12 * found.before)
            (4, 6, True)
            >>> [round(one.product, 6) for one in found.counterweights]  # half of 1.3 kg at 250 and 550 mm
            [162.5, 357.5]

        Source: docs/theory_forces.md, (17) to (23).
        """
        how = {"radius": radius, "most_mass": most_mass, "measure": measure, "force": force, "moment": moment}
        forces = self._answers.forces(self, _given(bodies=bodies))
        return self._answers.counterweights(self, forces, links, how)

    @ends_here
    def free_motion(
        self,
        duration: float | str,
        *,
        speed: float | str | None = None,
        energy: float | None = None,
        start: float | str | None = None,
        branch: int | None = None,
        torque: Any = None,
        torque_by_time: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
        samples: int = 361,
        restitution: float | None = None,
        bodies: Mapping[int, Body | Sequence[Body]] | None = None,
        gravity: tuple[float, float, float] | None = None,
        loads: Sequence[Load] | None = None,
        springs: Sequence[Spring] | None = None,
    ) -> FreeMotion:
        """How the linkage moves by itself along this circuit for a `duration` [s, or "10s"].

        It starts at the input `start` [rad, length, or text], by default in the drawn pose, or the circuit's
        first row where it has none, with the input's `speed` [rad/s, length/s, or text] or the kinetic
        `energy` [J], at rest by default; `branch` counts the poses that have this input. Stops of the linkage
        end the way: they give back the part `restitution` of the speed, 0 (the default) to 1, and hold what
        is pressed against them; by default it then starts in the first pose that they allow. `torque` acts
        on the input [N m, of a slide N]: a number, a curve (speeds, torques), or a function of the speed;
        `torque_by_time` is a curve (times, torques). Without dampers and with a torque that is a number at
        most, time is an integral along the circuit and nothing is stepped. Change points are passed along the
        circuit's smooth continuation. Rows are `samples` even times; the rest is as for `forces`.

        Raises `RequestError` where nothing has a mass, and for a start that the circuit does not have.

            >>> import sevenbar as sb
            >>> linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
            >>> crank = sb.Body(mass=2.0, centre=(0, 20, 0))
            >>> circuit = linkage.motion().circuits[0]
            >>> fall = circuit.free_motion("10s", start="30deg", bodies={1: crank}, gravity=(0, -9.81, 0))
            >>> fall.kind
            'oscillation'

        Source: docs/theory_free.md, (1) to (15).
        """
        given = _given(bodies=bodies, gravity=gravity, loads=loads, springs=springs)
        return self._answers.free_motion(
            self,
            self._answers.loading(self, given),
            duration,
            speed=speed,
            energy=energy,
            start=start,
            branch=branch,
            torque=torque,
            torque_by_time=torque_by_time,
            samples=samples,
            restitution=restitution,
        )

    @ends_here
    def equilibria(
        self,
        *,
        torque: float = 0.0,
        bodies: Mapping[int, Body | Sequence[Body]] | None = None,
        gravity: tuple[float, float, float] | None = None,
        loads: Sequence[Load] | None = None,
        springs: Sequence[Spring] | None = None,
    ) -> tuple[Equilibrium, ...]:
        """All poses of this circuit within the stops in which the linkage can rest, along the circuit.

        Under a constant `torque` [N m, of a slide N] at the input; the rest is as for `forces`. None where
        the potential is constant, as without gravity and springs: then it rests anywhere. Where a spring in a
        joint winds up from lap to lap they are those on the lap of the rows.

            >>> import sevenbar as sb
            >>> crank = sb.Body(mass=2.0, centre=(125, 0, 0))
            >>> circuit = sb.load("rssr").motion().circuits[0]
            >>> found = circuit.equilibria(bodies={1: crank}, gravity=(0, -9.81, 0))
            >>> [(place.kind, round(place.input % 6.283185307, 9)) for place in found]
            [('unstable', 1.570796327), ('stable', 4.71238898)]

        Source: docs/theory_free.md, (11).
        """
        given = _given(bodies=bodies, gravity=gravity, loads=loads, springs=springs)
        return self._answers.equilibria(self, self._answers.loading(self, given), torque)

    @ends_here
    def link_motion(self, link: int) -> LinkMotion:
        """How link 1, 2, .. turns along the circuit: angular velocity and acceleration, report frame.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> crank = sb.load("rssr").motion().circuits[0].link_motion(1)
        >>> bool(np.allclose(crank.velocity, (0, 0, 10)))
        True
        """
        from sevenbar.kinematics.circuits.link_motion import link_motion

        self._frame(link)
        return link_motion(partial(self._point, int(link)), self.size)

    @ends_here
    def screw_axes(self, link: int, relative_to: int | None = None) -> ScrewAxes:
        """The instantaneous screw axis of a link on each row, against the ground or another link.

        Source: docs/theory_measures.md, (8) and (9).

            >>> import sevenbar as sb
            >>> circuit = sb.load("rssr").motion().circuits[0]
            >>> axes = circuit.screw_axes(2)  # of the coupler
            >>> axes.point.shape, axes.pitch.shape
            ((360, 3), (360,))
            >>> circuit.screw_axes(1).direction[0].tolist()  # the crank turns about its axis
            [0.0, 0.0, 1.0]
        """
        from sevenbar.kinematics.loop.screw_axes import screw_axes

        self._frame(link)
        other = len(self._frames) if relative_to is None else relative_to
        if relative_to is not None:
            self._frame(relative_to)
        if link == other:
            raise RequestError(f"relative_to: link {link} is the link itself; give another")
        (own, words), (base, others) = self._twists(int(link)), self._twists(int(other))
        status = np.where(words == "ok", others, words)
        return screw_axes(int(link), int(other), own, base, self.size, status)

    @ends_here
    def instant_centres(self) -> InstantCentres:
        """The instant centres of all pairs of links of a planar loop, on each row.

        Raises `RequestError` for other loops, whose links have screw axes.

            >>> import sevenbar as sb
            >>> centres = sb.load("planar_4r").motion().circuits[0].instant_centres()
            >>> len(centres), centres[4, 1].in_plane[0].tolist()  # the crank's axis
            (6, [90.0, 0.0])

        Source: docs/theory_measures.md, (10).
        """
        from sevenbar.kinematics.circuits.instant_centres import instant_centres

        return instant_centres(self.screw_axes, len(self._frames), self._answers.plane_coordinates)

    def _twists(self, link: int) -> tuple[Twists, Words]:
        """How a link moves, by the frame in which its points are written; and the status of each row."""
        from sevenbar.kinematics.loop.screw_axes import Twists

        origin, turning = self.written_point(link, (0.0, 0.0, 0.0)), self.link_motion(link)
        frame = pose(turning.rotation @ self._frame(link)[:3, :3], origin.position)
        return Twists(frame, turning.velocity, origin.velocity), origin.status

    def _frame(self, link: object) -> Floats:
        count = len(self._frames)
        number = whole_number("link", link, 1, count, "a link", ", the last is the ground")
        frame: Floats = self._frames[number - 1]
        return frame
