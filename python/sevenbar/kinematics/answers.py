"""What a circuit asks its linkage: measures that need more than its rows, named points, the plane."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from sevenbar.arrays import Floats, finite_number
from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.kinematics.circuits.circuit import AT_REST, Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.table import circuit_columns, frame_of
from sevenbar.kinematics.loop.geometry import Point

# the engines are for those who ask
if TYPE_CHECKING:
    import pandas as pd

    from sevenbar.forces.counterweights import Balance
    from sevenbar.forces.free_motion.equilibria import Equilibrium
    from sevenbar.forces.free_motion.result import FreeMotion
    from sevenbar.forces.loading import Loading
    from sevenbar.forces.result import Forces
    from sevenbar.forces.waves import ForceWaves
    from sevenbar.kinematics.circuits.circuit_values import Sensitivity
    from sevenbar.kinematics.circuits.extents import Allowed, BallCone, Clearance, JointRange
    from sevenbar.kinematics.circuits.one_pose import OnePose
    from sevenbar.kinematics.dynamics.forces import ForceSolver
    from sevenbar.kinematics.loop.stops import Cone
    from sevenbar.kinematics.paths.stretch import StopStretch

#: A mechanical advantage, and the input [rad, or length] at which it is had.
Place = tuple[float, float]


def _by_rates(circuit: Circuit) -> list[Place] | None:
    """Both extremes of the advantage where the output's rate has its own, as the one is 1 over the other.

    `None` where that has none, or nearly rests.
    """
    rates, speed = circuit.velocity, circuit.speed
    if rates is None or not math.isfinite(speed) or rates.lowest * rates.highest <= 0:
        return None
    driving, driven = (
        1.0 if turns else circuit.size for turns in (circuit.input_turns, circuit.output_turns)
    )
    if min(abs(rates.lowest), abs(rates.highest)) / driven <= AT_REST * abs(speed) / driving:
        return None
    return [(speed / rates.lowest, rates.lowest_at), (speed / rates.highest, rates.highest_at)]


@dataclass(frozen=True, eq=False)
class LinkageAnswers:
    """The answers of a linkage; its circuits keep them and ask when they are asked."""

    linkage: Solvable
    #: What solves for its forces, by the driving column, made at the first asking.
    _solvers: dict[int, ForceSolver] = field(default_factory=dict, repr=False)

    def __reduce__(self) -> tuple[type[LinkageAnswers], tuple[Solvable]]:
        """Copied and pickled by the linkage."""
        return LinkageAnswers, (self.linkage,)

    def point(self, name: str) -> Point:
        """A named point; `RequestError` where there is none of the name."""
        points = {point.name: point for point in self.linkage.points}
        if name in points:
            return points[name]
        known = f"this linkage has {', '.join(points)}" if points else "this linkage has none"
        raise RequestError(
            f"point: no point {shown(name)}; {suggestion(name, list(points))}{known}; "
            "or give a link and a place, as in point(2, at=(10, 0, 0))"
        )

    def place(self, link: int, at: Floats) -> tuple[float, float, float]:
        """A place on a link as the file writes it, from two numbers in the plane, or from three."""
        from sevenbar.kinematics.solvers.link_places import written_place

        return written_place(self.linkage, link, at)

    def transmission_angle(self, circuit: Circuit) -> Floats | None:
        """On each row (n,) [rad]; `None` where it is not defined."""
        from sevenbar.kinematics.transmission.angle import transmission_angle

        return transmission_angle(self.linkage, circuit)

    def transmission(self, circuit: Circuit) -> Extremes | None:
        """The extremes of it [rad]; `None` where it is not defined."""
        from sevenbar.kinematics.transmission.angle import coupling_of

        if coupling_of(self.linkage, circuit.input_column, circuit.output_column) is None:
            return None
        # most loops have no such angle
        from sevenbar.kinematics.transmission.search import transmission_extremes

        return transmission_extremes(self.linkage, circuit)

    def velocity(self, circuit: Circuit) -> Extremes | None:
        """The extremes of the output's velocity where it has a limit at dead centres of the input."""
        from sevenbar.kinematics.transmission.search import velocity_extremes

        return velocity_extremes(self.linkage, circuit)

    def rests_together(self, circuit: Circuit) -> Mapping[int, float]:
        """d(output)/d(input) on the rows in which both rest."""
        from sevenbar.kinematics.transmission.axes import ratios_at_rest

        return ratios_at_rest(self.linkage, circuit)

    def advantage(self, circuit: Circuit) -> Extremes | None:
        """The lowest and highest mechanical advantage; `None` where the output stands still on the way."""
        if circuit.output_rests:
            return None
        ends = _by_rates(circuit) or self._by_driving_back(circuit)
        if ends is None:
            return None
        (low, low_at), (high, high_at) = sorted(ends)
        if circuit.input_turns and circuit.input_range is None:
            low_at, high_at = low_at % math.tau, high_at % math.tau
        return Extremes(low, low_at, high, high_at)

    def _by_driving_back(self, circuit: Circuit) -> list[Place] | None:
        """The extremes of the input's rate, the output driving: where the input turns back, too."""
        from sevenbar.kinematics.loop.law import Law
        from sevenbar.kinematics.transmission.axes import best_row

        row = best_row(circuit)
        if row is None:
            return None
        linkage, pose = self.linkage, circuit.q[row]
        names = [linkage.columns[c] for c in (circuit.output_column, circuit.input_column)]
        try:
            back = linkage.circuit(pose, input=names[0], output=names[1], speed=1.0)
        except RequestError:
            # through a change point where the output may stand still
            return None
        if back.velocity is None:
            return None
        places = np.array([back.velocity.lowest_at, back.velocity.highest_at])
        there = linkage.circuit(
            pose, input=names[0], output=names[1], law=Law.of([0.0, 1.0], places, 1.0, 0.0)
        )
        rates = there.dq[:, circuit.input_column]
        ends = []
        for value in (back.velocity.lowest, back.velocity.highest):
            row = int(np.nanargmin(np.abs(rates - value)))
            ends.append((value, float(there.q[row, circuit.input_column])))
        return ends

    def forces(self, circuit: Circuit, given: Mapping[str, Any], *, at_rest: bool = False) -> Forces:
        """The forces on a circuit's rows, with what is given in place of what the linkage has."""
        from sevenbar.kinematics.dynamics.forces import ForceSolver, forces_of

        if given:
            solver = ForceSolver(self.linkage, self.loading(circuit, given), circuit.input_column)
        else:
            solver = self._solver(circuit)
        result = forces_of(solver, circuit, at_rest=at_rest)
        if not self.linkage.stops.stops or math.isnan(circuit.speed):
            # a law, and a free motion, have their own rows
            return result
        return replace(result, _parts=cache(partial(self._parts, solver, circuit, result, at_rest)))

    def _solver(self, circuit: Circuit) -> ForceSolver:
        """What solves for the forces of a circuit under what acts on its linkage."""
        from sevenbar.kinematics.dynamics.forces import ForceSolver

        selected = self._solvers.get(circuit.input_column)
        if selected is None:
            selected = ForceSolver(self.linkage, self.loading(circuit, {}), circuit.input_column)
            self._solvers[circuit.input_column] = selected
        return selected

    def force_waves(self, circuit: Circuit) -> ForceWaves | None:
        """Torque and shaking of a circuit as series, where these are enough for measures."""
        from sevenbar.kinematics.dynamics.force_waves import force_waves

        return force_waves(self._solver(circuit), circuit)

    def _parts(
        self, solver: ForceSolver, circuit: Circuit, whole: Forces, at_rest: bool
    ) -> tuple[tuple[Forces, ...], int] | None:
        """The forces between stops, and which part is used; `None` where no stop ends the circuit."""
        from sevenbar.kinematics.dynamics.stop_forces import parts_of
        from sevenbar.kinematics.paths.circuit_path import NotFollowedError

        try:
            result = self._stretches(circuit)
        except NotFollowedError:
            return None
        if result is None or any(one.is_whole for one in result):
            return None
        return parts_of(solver, circuit, result, whole, at_rest=at_rest)

    def loading(self, circuit: Circuit, given: Mapping[str, Any]) -> Loading:
        """What acts on the linkage, with what is given in place of what it has; its loads go by the input."""
        loading = self.linkage.loading
        if given:
            from sevenbar.kinematics.dynamics.loaded import loading_with

            loading = loading_with(self.linkage, **given)
        loading.check_input(turns=self.linkage.turns(circuit.input_column))
        return loading

    def sensitivity(self, circuit: Circuit) -> Sensitivity:
        """By every number of the description."""
        from sevenbar.kinematics.numbers.sensitivity import sensitivity_of

        return sensitivity_of(self.linkage, circuit)

    def joint_ranges(self, circuit: Circuit) -> Mapping[str, JointRange]:
        """Of every column but a ball's, by name."""
        if self.linkage.net is not None:
            from sevenbar.kinematics.ranges.net_extents import net_joint_ranges

            return net_joint_ranges(self.linkage, circuit)
        from sevenbar.kinematics.ranges.circuit_extents import joint_ranges

        return joint_ranges(self.linkage, circuit)

    def ball_cones(self, circuit: Circuit) -> Mapping[str, BallCone]:
        """Of balls and universal joints, by name."""
        from sevenbar.kinematics.ranges.circuit_extents import ball_cones

        return ball_cones(self.linkage, circuit)

    def ball_cone(self, circuit: Circuit, joint: str, given: Cone | None) -> BallCone:
        """Of one, between directions that are given."""
        from sevenbar.kinematics.ranges.circuit_extents import cone_of

        return cone_of(self.linkage, circuit, joint, given)

    def bends(self, circuit: Circuit) -> Mapping[str, Floats]:
        """Of balls and universal joints on the rows (n,) [rad], by name."""
        from sevenbar.kinematics.ranges.circuit_extents import bends

        return bends(self.linkage, circuit)

    def clearances(self, circuit: Circuit) -> tuple[Clearance, ...]:
        """Of links that share no joint."""
        from sevenbar.kinematics.ranges.circuit_extents import clearances

        return clearances(self.linkage, circuit)

    def allowed(self, circuit: Circuit) -> Allowed:
        """What part of a circuit is within the stops."""
        from sevenbar.kinematics.ranges.allowed import allowed

        return allowed(self.linkage, circuit)

    def plane_coordinates(self, places: Floats) -> Floats | None:
        """Places (..., 3) of the report frame in the plane of a planar loop (..., 2), `None` for others."""
        from sevenbar.kinematics.solvers.plane_and_sphere import plane_of

        plane = plane_of(self.linkage)
        return None if plane is None else plane.coordinates(places)

    def counterweights(
        self, circuit: Circuit, forces: Forces, links: Sequence[int], how: Mapping[str, Any]
    ) -> Balance:
        """On links, for the least shaking of these forces."""
        from sevenbar.kinematics.dynamics.balance import balance_of

        return balance_of(self.linkage, circuit, forces, links, how)

    def free_motion(
        self, circuit: Circuit, loading: Loading, duration: float | str, **how: Any
    ) -> FreeMotion:
        """How a circuit moves by itself."""
        from sevenbar.kinematics.dynamics.free import free_motion_of

        result = self._stretches(circuit)
        return free_motion_of(self.linkage, circuit, loading, duration, stretches=result, **how)

    def _stretches(self, circuit: Circuit) -> tuple[StopStretch, ...] | None:
        """The parts of a circuit between stops; `None` where the linkage has no stops."""
        if not self.linkage.stops.stops:
            return None
        from sevenbar.kinematics.ranges.allowed import stretches

        return stretches(self.linkage, circuit)

    def pose(
        self,
        circuit: Circuit,
        value: float | str,
        branch: int | None,
        speed: float | str | None,
        acceleration: float,
    ) -> OnePose:
        """At a value of the input."""
        from sevenbar.kinematics.circuits.poses_at import pose_of
        from sevenbar.kinematics.loop.joint_text import joint_number, joint_speed
        from sevenbar.kinematics.transmission.axes import best_row

        linkage, column, rows = self.linkage, circuit.input_column, circuit.fleeting()
        known = best_row(rows)
        if known is None:
            raise RequestError("at: the circuit has no row with rates to begin from; give more samples")
        return pose_of(
            linkage, rows, joint_number("at", value, linkage, column), known,
            branch=branch,
            speed=None if speed is None else joint_speed(speed, linkage, column),
            acceleration=finite_number("acceleration", acceleration),
        )  # fmt: skip

    def frame(self, circuit: Circuit) -> pd.DataFrame:
        """Its rows as a pandas table."""
        return frame_of(circuit_columns(circuit.fleeting(), self.linkage, si=False), self.linkage)

    def equilibria(self, circuit: Circuit, loading: Loading, torque: float) -> tuple[Equilibrium, ...]:
        """Where a circuit can rest."""
        from sevenbar.kinematics.dynamics.free import equilibria_of

        return equilibria_of(self.linkage, circuit, loading, torque, self._stretches(circuit))
