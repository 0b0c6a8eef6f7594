"""The linkage: joints, fixed transforms, points, drive; a frozen value that asks the core for its motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy.typing as npt

from sevenbar.arrays import Floats, finite_number, is_number, spread_array, whole_number
from sevenbar.errors import NotCoveredError, RequestError, check_kind, check_word, ends_here, shown
from sevenbar.kinematics.answers import LinkageAnswers
from sevenbar.kinematics.circuits.motion import LEAST_AGREE, MOST_AGREE, HeldFreedoms, Motion, Solvable
from sevenbar.kinematics.loop.joint_text import joint_number, joint_numbers, joint_speed, pose_numbers
from sevenbar.kinematics.loop.single import check_single

if TYPE_CHECKING:
    from sevenbar.forces.acting import Load, Spring
    from sevenbar.forces.bodies import Body
    from sevenbar.kinematics.circuits.circuit import Circuit
    from sevenbar.kinematics.circuits.modes import Modes, Output
    from sevenbar.kinematics.circuits.one_pose import OnePose
    from sevenbar.kinematics.loop.grashof import FourBar
    from sevenbar.kinematics.loop.law import Law
    from sevenbar.kinematics.loop.mobility import Mobility
    from sevenbar.kinematics.loop.reason import Reason
    from sevenbar.kinematics.nets.order import Order
    from sevenbar.kinematics.nets.solver import NetSolver
    from sevenbar.kinematics.ranges.stopped import Cones, Radii, Ranges
    from sevenbar.kinematics.solvers.closed_form import ClosedForm
    from sevenbar.kinematics.solvers.general import GeneralLoop
    from sevenbar.kinematics.solvers.plane_and_sphere import MotionPlane, MotionSphere

#: Most samples a turn; beyond, the arrays of one motion would not fit into the memory of a desk machine.
MOST_SAMPLES = 1_000_000


@dataclass(frozen=True, eq=False, repr=False)
class Linkage(Solvable):
    """A closed loop `base Z(q1) G1 Z(q2) G2 .. Z(qn) = ground` that is asked for its modes and its motion.

    Its fields are those of `Loop`.

    Source: docs/theory.md, (1).
    """

    @ends_here
    def loaded(
        self,
        *,
        bodies: Mapping[int, Body | Sequence[Body]] | None = None,
        gravity: npt.ArrayLike | None = None,
        loads: Sequence[Load] | None = None,
        springs: Sequence[Spring] | None = None,
    ) -> Linkage:
        """The linkage with other bodies by their link, gravity (3,) [m/s^2], loads and springs.

        What is left out stays as it is. Raises `RequestError` for a link or a joint that does not exist.

            >>> import sevenbar as sb
            >>> crank = sb.Body(mass=1.2, centre=(125, 0, 0))
            >>> linkage = sb.load("rssr").loaded(bodies={1: crank}, gravity=(0, 0, -9.80665))
            >>> linkage.loading.bodies[1][0].mass
            1.2
        """
        from sevenbar.kinematics.dynamics.loaded import loaded

        check_single(self)
        return loaded(self, bodies=bodies, gravity=gravity, loads=loads, springs=springs)

    @ends_here
    def stopped(
        self, *, ranges: Ranges | None = None, cones: Cones | None = None, radii: Radii | None = None
    ) -> Linkage:
        """The linkage with other stops: ranges of joints by name, cones of S and U, radii of links.

        A range is (low, high) [rad, length, or texts as "30 deg"], a turn at most; a cone an angle [rad, or
        text] or a `Cone` with directions; a radius [length] is that of the link as a rod, the ground the last
        one. What is left out stays as it is. They change no motion: `Circuit.allowed` is what they leave of
        it. Raises `RequestError` for what does not exist or does not fit.

            >>> import sevenbar as sb
            >>> linkage = sb.load("rssr").stopped(ranges={"rocker": ("-30 deg", "10 deg")}, radii={1: 20})
            >>> linkage.description["stop"]
            [{'joint': 'rocker', 'range': [-30.0, 10.0]}]
        """
        from sevenbar.kinematics.ranges.stopped import stopped

        check_single(self)
        return stopped(self, ranges=ranges, cones=cones, radii=radii)

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Crank, coupler and rocker of an RSSR or of a planar four-bar [length].

        >>> import sevenbar as sb
        >>> sb.four_bar(40, 100, 80, 90).lengths
        (40.0, 100.0, 80.0)
        """
        bar = None if self.kind == "RSSR" else self.as_four_bar()
        if bar is not None and bar.kind == "planar" and "input link" in bar.links:
            return bar.links["input link"], bar.links["coupler"], bar.links["output link"]
        return self._rssr("lengths").lengths

    @cached_property
    def _closed_form(self) -> ClosedForm:
        # `import sevenbar` needs no solver, and most linkages need one of them
        from sevenbar.kinematics.solvers.closed_form import ClosedForm

        return ClosedForm(self)

    @cached_property
    def _general(self) -> GeneralLoop:
        from sevenbar.kinematics.solvers.general import AGREE, GeneralLoop

        return GeneralLoop(self, AGREE if self.agree is None else self.agree)

    @cached_property
    def _net(self) -> NetSolver:
        from sevenbar.kinematics.nets.solver import NetSolver

        return NetSolver(self)

    @cached_property
    def _agreeing(self) -> dict[float | None, Linkage]:
        return {self.agree: self}

    @ends_here
    def agreeing(self, agree: float | None) -> Linkage:
        """The same linkage, whose redundant constraints agree up to a closure error; `None` changes nothing.

        Its motion, its modes and linkages made of it with other numbers take that error; see `motion`.

            >>> import sevenbar as sb
            >>> rows = {"length": [50, 98.48] * 2, "twist": ["30 deg", "100 deg"] * 2, "offset": [0] * 4}
            >>> rounded = sb.from_dh("RRRR", **rows)
            >>> rounded.motion().motion_type, rounded.agreeing(1e-5).motion().motion_type
            ('rigid', 'double-crank')
        """
        if agree is None:
            return self
        from sevenbar.kinematics.solvers.general import AGREE

        value = closure_tolerance("agree", agree)
        if value == AGREE and self.agree is None:
            return self
        if self.net is not None:
            raise RequestError(
                f"agree: {value:g} is of a single loop; of a net redundant constraints agree to {AGREE:g}, "
                "so leave it out"
            )
        if value not in self._agreeing:
            self._agreeing[value] = replace(self, agree=value)
        return self._agreeing[value]

    def _rssr(self, what: str) -> ClosedForm:
        if self.kind != "RSSR":
            loop = "a net" if self.net is not None else f"a loop {' '.join(self.kind)}"
            raise NotCoveredError(f"{what}: {loop} has no closed form here; it is offered for R S S R")
        return self._closed_form

    def _speed(self, speed: object, column: int) -> float:
        if speed is None:
            return self.speed_of(column)
        return joint_speed(speed, self, column)

    @ends_here
    def output(
        self,
        values: npt.ArrayLike,
        order: int = 0,
        speed: npt.ArrayLike | str | None = None,
        *,
        acceleration: npt.ArrayLike | None = None,
        jerk: npt.ArrayLike | None = None,
        input: str | None = None,
    ) -> Output:
        """Both branches of the other joint at many inputs: the closed form, vectorised.

        `values` (n,) [rad, or texts as in "30 deg"] are inputs; `order` 0 to 3 how many derivatives. The
        input moves at `speed` [rad/s] (the drive's where none is given); `speed`, `acceleration` [rad/s^2]
        and `jerk` [rad/s^3] may also be arrays (n,), an input law. Branch 0 of `beta = f(alpha)` is eq. (8)
        of Sun and Zhou; with `input` the last joint, branch 0 of `alpha = phi(beta)` is eq. (9).

        Raises `RequestError` for values that are not finite, lengths that differ, an order out of range.

            >>> import sevenbar as sb
            >>> linkage = sb.rssr(M=700, N=700, L1=250, L3=550, D=0)
            >>> round(float(linkage.output([0.3]).position[0, 0]), 6)
            -0.084963

        Source: docs/rssr.md, (3) to (9); Sun and Zhou, eq. (8), (9), and (12), (13) with their signs mended.
        """
        solver = self._rssr("output")
        column = self.input_column(input)
        array = joint_numbers("input", values, self, column)
        order = whole_number("order", order, 0, 3, "offered")
        law = None
        constant = 1.0
        several = isinstance(speed, Sized) and not isinstance(speed, str)
        plain = not several or getattr(speed, "ndim", 1) == 0
        if plain and acceleration is None and jerk is None:
            constant = self._speed(speed, column)
        else:
            first = self._speed(speed, column) if plain else speed
            rates = {"speed": first, "acceleration": acceleration, "jerk": jerk}
            law = tuple(
                spread_array(name, 0.0 if value is None else value, array.size, "the input")
                for name, value in rates.items()
            )
        return solver.outputs(array, order, column, constant, law)

    @ends_here
    def assembly_modes(
        self,
        theta: float | str,
        *,
        input: str | None = None,
        method: Literal["auto", "general"] = "auto",
        agree: float | None = None,
    ) -> Modes:
        """Every assembly mode at one value of the input [rad, or length]; none where the loop does not close.

        An RSSR is solved in closed form, any loop of turning and sliding joints (and joints made of these) by
        following all solutions over the complex numbers; with screws modes are searched. `method` "general"
        takes the general way for an RSSR too; `agree` is that of `motion`. `theta` may be a text with a unit,
        as in "30 deg", too.

            >>> import sevenbar as sb
            >>> len(sb.load("seven_r").assembly_modes(0.3))
            8

        Source: docs/theory.md, (6); docs/rssr.md, (4).
        """
        column = self.input_column(input)
        value = joint_number("theta", theta, self, column)
        agreeing, closed_form = self.agreeing(agree), self._has_closed_form(method)
        if self.net:
            return self._net.modes(column, value)
        if closed_form:
            return self._closed_form.modes(column, value)
        self._refuse_unheld()
        return agreeing._general.modes(column, value)

    def mobility(self, *, input: str | None = None, agree: float | None = None) -> Mobility:
        """How freely the loop moves: the count of freedoms, idle ones and redundant constraints by name.

        That is of poses at values of the input, the drive's where none is given: a loop may have families of
        poses that move with different freedoms. `agree` is that of `motion`.

        >>> import sevenbar as sb
        >>> print(sb.load("bennett").mobility())
        Gruebler -2, redundant constraints 3, moves with 1
        """
        column = self.input_column(input)
        agreeing = self.agreeing(agree)
        return self._net.mobility(column) if self.net else agreeing._general.mobility(column)

    @property
    def order(self) -> Order:
        """The order in which it is solved with its input held: blocks of links, one of a single loop.

        >>> import sevenbar as sb
            >>> [sb.load(name).order.blocks[0].solver for name in ("planar_4r", "rssr")]
            ['dyad', 'loop']
        """
        from sevenbar.kinematics.nets.order import order_of

        return order_of(self, self.input_column())

    @property
    def plane(self) -> MotionPlane | None:
        """The plane of a planar loop; `None` for any other.

        >>> import sevenbar as sb
        >>> sb.load("planar_4r").plane.x.tolist()
        [0.0, 1.0, 0.0]
        """
        from sevenbar.kinematics.solvers.plane_and_sphere import plane_of

        return plane_of(self)

    @property
    def is_planar(self) -> bool:
        """Whether it can only move in its plane."""
        return self.plane is not None

    @property
    def normal(self) -> Floats | None:
        """The direction (3,) across its plane, in the report frame; `None` of a loop that is not planar."""
        return None if self.plane is None else self.plane.normal

    @cached_property
    def sphere(self) -> MotionSphere | None:
        """The centre of a spherical loop, and a radius to draw it with; `None` for any other.

        >>> import sevenbar as sb
        >>> sb.load("spherical_4r").sphere.radius
        1.0
        """
        from sevenbar.kinematics.solvers.plane_and_sphere import sphere_of

        return None if self.net else sphere_of(self)

    @cached_property
    def answers(self) -> LinkageAnswers:
        """What its circuits take from it: named points, transmission, its plane."""
        return LinkageAnswers(self)

    @ends_here
    def as_four_bar(self, input: str | None = None, output: str | None = None) -> FourBar | None:
        """The links by Grashof's rule, driven and read as the drive has it or as given.

        `None` for a loop that is no planar or spherical four-bar and no slider-crank.

            >>> import sevenbar as sb
            >>> bar = sb.load("planar_4r").as_four_bar()
            >>> bar.excess, bar.grashof
            (-30.0, 'crank-rocker')

        Source: docs/theory_measures.md, (1) to (3).
        """
        from sevenbar.kinematics.solvers.four_bar import four_bar_of

        first, second = self.end_columns(input, output)
        if self.net:
            return None
        return four_bar_of(self, self.columns[first], self.columns[second])

    def reason_of(self, motion: Motion) -> Reason | None:
        """Why a motion of it has no circuit, or which link has no length; see `Motion.reason`."""
        from sevenbar.kinematics.loop.no_length import no_length

        check_kind("motion", motion, Motion, "a motion of it; give one, as motion() has it")
        reason = no_length(self)
        if reason is not None or motion.motion_type != "rigid" or self.in_rows:
            return reason
        from sevenbar.kinematics.solvers.why_rigid import off_joints

        return off_joints(motion)

    @property
    def idle(self) -> tuple[str, ...]:
        """Freedoms that move no other link."""
        return self._net.idle() if self.net else self._general.idle()

    @cached_property
    def held(self) -> HeldFreedoms:
        """How idle freedoms are held: balls as two turns, columns at zero, and how many spins otherwise."""
        return self._general.held()

    @property
    def spin_axes(self) -> dict[str, Floats]:
        """The axis (3,) that holds the idle spin beyond a ball, by the ball's name, in the frame before it.

        A direction of the link beyond stays at right angles to it. It is the axis of the joint before the
        ball, or, where the line of the two balls comes near that, one that the line keeps away from.

        The rule is given under "Idle spin" in docs/theory.md.
        """
        if self.kind == "RSSR":
            return {self.joints[1].name: self.joint_on(1, 1)[2, :3]}
        return self._general.spin_axes()

    @property
    def idle_links(self) -> frozenset[int]:
        """Links, counted from 1, with a freedom of their own that moves no other link."""
        return self._net.idle_links() if self.net else self._general.idle_links()

    @property
    def followed_generally(self) -> bool:
        """Whether its motion is that of the general path, with nothing else to be asked of it."""
        return self.kind != "RSSR" and self._general.unheld() is None

    def _refuse_unheld(self) -> None:
        check_single(self)
        spin = self._general.unheld()
        if spin is not None:
            raise NotCoveredError(
                f"linkage: the {spin} moves no other link, and it is not held where a screw or a ball stands "
                "between these balls; describe the loop from another joint on, so that R or P stands there"
            )

    @ends_here
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
        """Every circuit over the whole input range.

        `samples` inputs in a full turn, or over the range of a sliding input. The input moves at `speed`
        [rad/s, or length/s], the drive's where none is given, or by a `law`, whose samples take the place of
        the grid: a circuit that turns back holds them once for each of its passes. `input` and `output` name
        joints. `method` "general" takes the general way for an RSSR too, which has a closed form.

        Redundant constraints, those of an overconstrained loop, agree up to a closure error of 1e-9 (rad, or
        relative to the linkage size), or the linkage's own. With more for `agree`, up to 1e-3, a loop of
        rounded dimensions moves as the exact one next to it would; rows then close up to the error that
        `residual` gives, and `linkage` of the motion is `agreeing(agree)`.

        Raises `RequestError` for an argument that does not fit, `NotCoveredError` for a loop in which links
        spin idly between two balls with a screw among them.

        Source: docs/theory.md, (7) to (16); docs/rssr.md, (3) to (8).

            >>> import sevenbar as sb
            >>> motion = sb.load("rscr").motion()
            >>> [(circuit.motion_type, circuit.turns) for circuit in motion]
            [('crank-rocker', 1), ('double-rocker', 0), ('crank-rocker', 1)]
        """
        column, output_column, samples, rate = self._asked(samples, input, output, speed, law)
        agreeing, closed_form = self.agreeing(agree), self._has_closed_form(method)
        if self.net:
            result = self._net.motion(column, output_column, samples, rate, law)
        elif closed_form:
            result = self._closed_form.motion(column, samples, rate, law)
        else:
            self._refuse_unheld()
            result = agreeing._general.motion(column, output_column, samples, rate, law)
        written = speed if speed is not None else self.speed_written(column)
        return replace(result, speed_written=written) if isinstance(written, str) and written else result

    @ends_here
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
        """The one circuit through a pose, without a search for the others.

        `pose` holds a value for each of `columns` [rad, or length], as a row of `assembly_modes(..).q` or of
        a circuit's `q` does; a rough one is closed with the input held. The rest is as for `motion`, always
        by the general way.

        Raises `RequestError` where the loop does not close near the pose, or does not move.

            >>> import sevenbar as sb
            >>> linkage = sb.load("seven_r")
            >>> linkage.circuit(linkage.assembly_modes(0.3).q[2]).motion_type
            'double-crank'
        """
        column, output_column, samples, rate = self._asked(samples, input, output, speed, law)
        values = self._pose(pose)
        agreeing = self.agreeing(agree)
        if self.net:
            return self._net.circuit(values, column, output_column, samples, rate, law)
        self._refuse_unheld()
        return agreeing._general.circuit(values, column, output_column, samples, rate, law)

    def _net_ratio_at_rest(self, pose: Floats, column: int, output: int) -> float | None:
        """d(output)/d(input) of a net at a pose (columns,) where both rest; `None` where one moves."""
        return self._net.ratio_at_rest(pose, column, output)

    @ends_here
    def at(
        self,
        pose: npt.ArrayLike,
        *,
        input: str | None = None,
        speed: float | str | None = None,
        acceleration: float = 0.0,
    ) -> OnePose:
        """One pose with what there is to know of it: rates, points, links, transmission, torque, reactions.

        `pose` is as for `circuit`. The input has there this `speed` and `acceleration` [rad/s, rad/s^2, or
        lengths]: the drive's speed, and none, where they are not given.

            >>> import sevenbar as sb
            >>> linkage = sb.load("rssr")
            >>> pose = linkage.at(linkage.assembly_modes("45 deg").q[0])
            >>> round(pose["rocker"], 6), round(float(pose.dq[-1]), 6), pose.points["A"].velocity.shape
            (-0.117924, 0.690558, (1, 3))
        """
        from sevenbar.kinematics.circuits.poses_at import pose_near

        column = self.input_column(input)
        return pose_near(
            self,
            self._pose(pose),
            input=input,
            speed=self._speed(speed, column),
            acceleration=finite_number("acceleration", acceleration),
        )

    def _pose(self, pose: npt.ArrayLike) -> Floats:
        """The values of a pose, one for each column."""
        values = pose_numbers("pose", pose, self)
        if values.size != len(self.columns):
            raise RequestError(
                f"pose: {values.size} values where the linkage has {len(self.columns)} columns; "
                f"give one for each of {', '.join(self.columns)}"
            )
        return values

    def _asked(
        self, samples: int, input: str | None, output: str | None, speed: float | str | None, law: Law | None
    ) -> tuple[int, int, int, float]:
        """Columns of input and output, a count, and the speed, once checked, as the law is."""
        if law is not None:
            from sevenbar.kinematics.loop.law import Law

            check_kind("law", law, Law, "a law; make one with sevenbar.Law.of, or load_law")
        column, output_column = self.end_columns(input, output)
        return column, output_column, sample_count("samples", samples), self._speed(speed, column)

    def _has_closed_form(self, method: str) -> bool:
        check_word("method", method, ("auto", "general"))
        if method != "auto" or self.kind != "RSSR":
            return False
        # the general way is not driven by a crank without length, which spins idly as the coupler does
        return not self._closed_form.has_free_side or len(self._general.idle()) > 1


def closure_tolerance(name: str, value: object) -> float:
    """A closure error up to which redundant constraints agree, or `RequestError` that names it."""
    if not is_number(value) or not LEAST_AGREE <= value <= MOST_AGREE:
        raise RequestError(
            f"{name}: {shown(value)} is not a closure error; give {LEAST_AGREE:g} to {MOST_AGREE:g} "
            "(rad, or relative to the linkage size)"
        )
    return float(value)


def sample_count(name: str, value: object) -> int:
    """A number of inputs in a turn, or `RequestError` naming what it was given for."""
    return whole_number(name, value, 4, MOST_SAMPLES, "a count")
