"""Forces along a circuit: the input's torque, energies, what every joint bears, shaking; arrays over rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Booleans, Floats, Integers, ReadOnly, Words
from sevenbar.errors import RequestError, ends_here, shown
from sevenbar.forces.bodies import Body
from sevenbar.forces.closing import Closing, closing
from sevenbar.forces.loading import Loading
from sevenbar.forces.sizing import WITHHELD, CycleLoads, Sizing, cycle_loads, unevenness_of
from sevenbar.text.printing import Drawable, Printed
from sevenbar.text.units import LENGTHS

#: Which rows are meant: a mask, their numbers or a slice.
Rows = Booleans | npt.NDArray[np.integer[Any]] | slice

#: The components of a reaction, in the frame of its joint, whose z is the joint's axis.
COMPONENTS = ("Mx", "My", "Mz", "Fx", "Fy", "Fz")

#: An input nearer to an end of a part than this share of it is the end.
AT_END = 1e-9

#: The moment of an idle spin below this part of the greatest moment in a joint is rounding.
NO_MOMENT = 1e-9

#: A component is open if a wrench that nothing determines has more than this part of its length in it.
OPEN = 1e-8


#: A torque below this part of what acts has lost so many digits that power need not close.
LITTLE = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Reaction(ReadOnly, Printed):
    """What the link before a joint puts on the link after it, row by row; the last joint's is the ground.

    `joint` and `kind` are its name and kind (R, S ..). `force` (n, 3) [N] and `moment` (n, 3) [N m] about
    `at` (n, 3) [length], in the joint's own frame on the side of the link before it, whose `axes` (n, 3, 3)
    are columns in the report frame; z is the joint's axis.
    `determinate` (6,) says which of Mx, My, Mz, Fx, Fy, Fz equilibrium determines; the others are NaN.
    `known` (n, k, 6) are the combinations of these six that it does determine, as orthonormal rows with
    moments by the linkage's size, and `known_values` (n, k) [N] their values.
    """

    joint: str
    kind: str
    force: Floats
    moment: Floats
    at: Floats
    axes: Floats
    determinate: Booleans
    known: Floats
    known_values: Floats
    #: By which moments are divided in `known` [m].
    size: float = 1.0

    @property
    def force_in_report(self) -> Floats:
        """The force (n, 3) [N] in the report frame; NaN in components that equilibrium leaves open."""
        return self._in_report(slice(3, 6))

    @property
    def moment_in_report(self) -> Floats:
        """The moment (n, 3) [N m] in the report frame; NaN in components that equilibrium leaves open."""
        return self.size * self._in_report(slice(0, 3))

    def _in_report(self, part: slice) -> Floats:
        """Moment or force along the axes of the report frame, moments by the size [N]."""
        # each axis as a combination of the six components: what the known ones do not reach is open
        ways = np.zeros((len(self.axes), 3, 6))
        ways[:, :, part] = self.axes
        shares = ways @ np.swapaxes(self.known, 1, 2)
        left = np.linalg.norm(ways - shares @ self.known, axis=2)
        values = np.einsum("nik,nk->ni", shares, self.known_values)
        rest = np.where(np.isfinite(left), left, 0.0).max(axis=0, initial=0.0)
        return np.asarray(np.where(rest < OPEN, values, np.nan))

    def on(self, rows: Rows) -> Reaction:
        """The same on some rows: a mask, numbers of rows or a slice."""
        arrays = ("force", "moment", "at", "axes", "known", "known_values")
        return replace(self, **{name: getattr(self, name)[rows] for name in arrays})


@dataclass(frozen=True)
class StopPart:
    """A part of a circuit between stops: from an input to an input [rad, or length], and what ends it."""

    start: float
    end: float
    first_stop: str
    last_stop: str

    def moves(self, input: float, driver: str) -> bool:
        """Whether an input is an end of it at which another stop than the range of the driver is met."""
        near = AT_END * abs(self.end - self.start)
        return any(
            abs(input - end) <= near and stop not in ("", f"range of {driver}")
            for end, stop in ((self.start, self.first_stop), (self.end, self.last_stop))
        )


@dataclass(frozen=True, eq=False, repr=False)
class Forces(ReadOnly, Drawable):
    """What the input has to give, and what the joints bear, on the n rows of a circuit.

    `input` [rad, or length], `time` [s], `speed` [rad/s, or length/s], `status` and `branch` are those of the
    rows (n,). `torque` (n,) is what the input has to give, along its own positive turn [N m], or as it slides
    the force [N]; `power` [W] is that by the input's speed, `kinetic` and `potential` [J] the energies of
    bodies, weights and springs, `supplied` [W] the power of loads and dampers, `shaking` (n, 6) the moment
    about the report's origin [N m] and the force [N] of all inertia on the ground. `reactions` has each
    joint's by its name. `spin` has for each link that spins idly the moment (n,) [N m] that the rule of its
    spin needs and no ball gives: 0 for a rod. `indeterminate` names the redundant constraints, whose share of
    the reactions rigid bodies leave open. Rows without rates, as dead centres of the input, are NaN.

    Source: docs/theory_forces.md, (1) to (9).
    """

    input: Floats
    time: Floats
    speed: Floats
    status: Words
    branch: Integers
    torque: Floats
    power: Floats
    kinetic: Floats
    potential: Floats
    supplied: Floats
    shaking: Floats
    reactions: Mapping[str, Reaction]
    spin: Mapping[str, Floats]
    indeterminate: tuple[str, ...]
    #: Whether the input slides, so that `torque` is a force.
    slides: bool
    length_unit: str
    #: Whether the rows are one period of a closed cycle at constant speed, evenly spaced.
    periodic: bool
    loading: Loading = field(repr=False)
    #: The body of each link that has one, as it acted: of several one, a rod or drawn solids worked out.
    bodies: Mapping[int, Body]
    #: The joint that drives, and the linkage.
    driver: str
    heading: str
    #: How large what acts is [N m, of an input that slides N]: below 1e-12 of it a torque is rounding, and 0.
    pull: float = 0.0
    #: Whether the linkage is held still on every row: statics, without inertia and damping.
    at_rest: bool = False
    #: Whether the circuit passes change points, where torque and reactions have no values of their own.
    through_change_points: bool = False
    #: The same at any inputs (m,) of the cycle, where it is periodic.
    between: Callable[[Floats], Forces] | None = field(default=None, repr=False)
    #: The part between stops that the rows are: from stop to stop, both ends among them.
    part: StopPart | None = None
    #: The same on the parts between stops, and the number of that on which the linkage is used; where it has
    #: stops and they end the circuit.
    _parts: Callable[[], tuple[tuple[Forces, ...], int] | None] | None = field(default=None, repr=False)

    @cached_property
    def _found_parts(self) -> tuple[tuple[Forces, ...], int] | None:
        return None if self._parts is None else self._parts()

    @property
    def parts(self) -> tuple[Forces, ...]:
        """The forces on each part of the circuit between its stops, on these passes: rows from stop to stop.

        These forces alone where no stop ends the circuit; none where it has no pose within them.
        """
        if self._found_parts is None:
            return (self,)
        passes = np.unique(self.branch)
        return tuple(one for one in self._found_parts[0] if np.isin(one.branch, passes).all())

    @property
    def within_stops(self) -> Forces | None:
        """The forces on the part between stops on which the linkage is used; `None` where there is none.

        That of the drawn pose, else of the first row, else the first. Of rows that no stop ends these forces.
        """
        if self._found_parts is None:
            return self
        every, used = self._found_parts
        parts = self.parts
        if every and any(one is every[used] for one in parts):
            return every[used]
        return parts[0] if parts else None

    @property
    def idle_spin(self) -> dict[str, float]:
        """The greatest moment [N m] that the rule of each idle spin needs, by its link; 0 for rounding.

        Of a link whose body is a rod, or which has none, the spin moves nothing.
        """
        moments = [_greatest(reaction.moment) for reaction in self.reactions.values()]
        rounding = NO_MOMENT * max([*moments, 0.0])
        result = {link: _greatest(moment) for link, moment in self.spin.items()}
        return {link: most if most > rounding else 0.0 for link, most in result.items()}

    @property
    def unit(self) -> str:
        """The unit of `torque`."""
        return "N" if self.slides else "N m"

    @property
    def metre(self) -> float:
        """What a unit of the input's way is in metres where it slides, else 1."""
        return LENGTHS[self.length_unit] if self.slides else 1.0

    @property
    def period(self) -> float | None:
        """The way of the input [rad] round a periodic cycle, negative where it falls from row to row."""
        return float(self.input[1] - self.input[0]) * len(self.input) if self.periodic else None

    @property
    def _way(self) -> float | None:
        """The way of the input [rad, or length] along a periodic cycle, or from stop to stop."""
        if self.part is None or self.between is None:
            return self.period
        return self.part.end - self.part.start

    @property
    def _breaks(self) -> tuple[float, ...]:
        """Inputs [rad, or length] between which all is smooth: of a part its beginning is one."""
        if self.part is None:
            turns = 0 if self.period is None else round(abs(self.period) / math.tau)
            return self.loading.breaks(turns=turns)
        low, high = sorted((self.part.start, self.part.end))
        corners = self.loading.breaks(turns=1)
        if not self.slides:
            laps = range(math.ceil((high - low) / math.tau) + 1)
            corners = tuple(low + (x - low) % math.tau + math.tau * k for x in corners for k in laps)
        return (self.part.start, *(x for x in corners if low < x < high))

    @property
    def even_speed(self) -> float:
        """The one speed [rad/s] of a periodic cycle; NaN where no row has one."""
        # a row at a change point has no rates
        known = self.speed[np.isfinite(self.speed)]
        return float(known[0]) if known.size else math.nan

    def on(self, rows: Rows) -> Forces:
        """The same on some rows, as `forces.on(forces.branch == 1)`: a mask, numbers of rows or a slice."""
        arrays = ("input", "time", "speed", "status", "branch", "torque", "power", "kinetic", "potential")
        try:
            ways = np.ndim(self.input[rows])
        except (IndexError, ValueError, TypeError):
            ways = 0
        if ways != 1:
            raise RequestError(
                f"rows: {shown(rows)} chooses no rows; give a mask, numbers of rows or a slice"
            )
        chosen: dict[str, Any] = {
            name: getattr(self, name)[rows] for name in (*arrays, "supplied", "shaking")
        }
        if len(chosen["input"]) != len(self.input):
            chosen["periodic"] = False
            passes = np.isin(self.branch, chosen["branch"])
            if len(chosen["input"]) != passes.sum():
                # rows that were chosen, not passes with their stops
                chosen |= {"_parts": None, "part": None}
        return replace(
            self,
            reactions={name: reaction.on(rows) for name, reaction in self.reactions.items()},
            spin={link: moment[rows] for link, moment in self.spin.items()},
            **chosen,
        )

    @ends_here
    def sizing(self, *, unevenness: float | None = None) -> Sizing | None:
        """Peaks of torque and power with their places, means, fluctuation of energy, bearing loads.

        With an `unevenness`, (highest less lowest speed) / mean speed, also the flywheel for it. `None` for
        rows without a torque, as of a circuit that rocks at constant speed: there it has no bound. Of a
        circuit that passes change points the series through its rows goes across these; forces in joints
        that grow without bound there are NaN. Of loads that set in or end on such a circuit `None`, too, and
        where more than a thousandth of the greatest value may be missed between the rows, or power does not
        close along the cycle to that.

            >>> import sevenbar as sb
            >>> circuit = sb.load("rssr").motion().circuits[0]
            >>> found = circuit.forces(bodies={3: sb.Body(2.0, solid="rod")}).sizing(unevenness=0.01)
            >>> found.found, bool(found.flywheel > 0), bool(abs(found.mean_torque) < 1e-12)
            ('series', True, True)

        Source: docs/theory_forces.md, (10) to (16).
        """
        own = self.within_stops
        if own is not None and own.part is not None and unevenness is not None:
            raise RequestError(
                "unevenness: stops end the motion, so that the input does not go round and no flywheel "
                "evens it; leave it out"
            )
        delta = unevenness_of(unevenness)
        result = loads_of(self)
        if own is None or result is None:
            return None
        return result.sizing(delta).in_units(own.unit, own.length_unit if own.slides else "rad")

    @property
    def balance(self) -> float | None:
        """How far power closes along the cycle, as a part of its peak: `torque q' + supplied - d(T + V)/dt`.

        The derivative by time is that of the trigonometric polynomial through all rows. `None` where the rows
        are no closed cycle at constant speed, or a row has no value. At rest it is that of work: how far the
        torque is from the slope of the potential energy, `None` where loads act.

        Source: docs/theory_forces.md, (7).
        """
        return None if self._closing is None else self._closing.power

    @property
    def work(self) -> float | None:
        """What drive, loads and dampers give over a closed cycle, as a part of the peak power; 0 if right.

        `None` as `balance` is, and at rest.
        """
        return None if self._closing is None or self.at_rest else self._closing.work

    @property
    def unclosed(self) -> float:
        """The greater of `balance` and `work`; 0 where there is none, or torque is next to nothing."""
        if float(np.abs(self.torque).max(initial=0.0)) < LITTLE * self.pull:
            return 0.0
        return max(self.balance or 0.0, self.work or 0.0)

    @property
    def closes(self) -> bool:
        """Whether power closes along the cycle as far as figures need, as `unclosed` says it.

        Pieces are made only where the series of the rows do not say so: they never close worse.
        """
        if float(np.abs(self.torque).max(initial=0.0)) < LITTLE * self.pull:
            return True
        rows = self._closed(None)
        if rows is None or max(rows.power, 0.0 if self.at_rest else rows.work) <= WITHHELD:
            return True
        return self.unclosed <= WITHHELD

    @cached_property
    def _closing(self) -> Closing | None:
        return self._closed(None if self.through_change_points else self.between)

    def _closed(self, between: Callable[[Floats], Forces] | None) -> Closing | None:
        """How power closes along the rows, and where these are too few between them, too."""
        if self.at_rest and self.loading.loads:
            return None
        period = self.period
        if period is None or len(self.input) < 3 or not np.isfinite(self.power + self.supplied).all():
            return None

        def rows(own: Forces) -> Floats:
            given = (own.torque, np.zeros(len(own.input))) if own.at_rest else (own.power, own.supplied)
            return np.stack([own.kinetic + own.potential, *given])

        return closing(
            rows(self),
            1.0 if self.at_rest else self.even_speed,
            pull=self.pull,
            first=float(self.input[0]),
            period=period,
            evaluate=None if between is None else lambda inputs: rows(between(inputs)),
        )

    @property
    def ground_balance(self) -> float | None:
        """How far the ground's reactions are from weights, loads and shaking, as a part of the greatest.

        The ground's forces on the linkage in its first and last joint, weights, loads and inertia forces add
        up to zero. `None` where equilibrium leaves one of the two open, a spring ends on the ground, or a
        load turns with its link.

        Source: docs/theory_forces.md, (2).
        """
        first, *_, last = self.reactions.values()
        ground = len(self.reactions)
        loads = [load for load in self.loading.loads if load.link != ground and any(load.force)]
        if (
            not (first.determinate[3:].all() and last.determinate[3:].all())
            or any(load.axes == "link" for load in loads)
            or any(ground in (spring.links or ()) for spring in self.loading.springs)
        ):
            return None
        weight = sum(body.mass for body in self.bodies.values()) * np.array(self.loading.gravity)
        outer = weight + sum(
            (
                load.factors(self.input, turns=not self.slides)[:, None] * np.array(load.force)
                for load in loads
            ),
            np.zeros(3),
        )
        ends = first.force_in_report, last.force_in_report
        known = np.isfinite(ends[0]).all(axis=1)
        if not known.any():
            return None
        left = (ends[0] - ends[1] + outer + self.shaking[:, 3:])[known]
        greatest = max(float(np.abs(end[known]).max()) for end in ends)
        return float(np.abs(left).max() / greatest) if greatest else 0.0


def _greatest(values: Floats) -> float:
    """The greatest size of known values, 0 without any."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def loads_of(forces: Forces) -> CycleLoads | None:
    """The loads of a cycle, of which a sizing is made, between stops those of the part that is used.

    `None` where `Forces.sizing` is; raises what that does for rows that are several passes.
    """
    own = forces.within_stops
    if own is None:
        return None
    period = own._way
    passes = 1 if own.part is not None else len(np.unique(own.branch))
    if period is None and passes > 1 and np.isfinite(own.torque).all():
        raise RequestError(
            "sizing: the rows are passes one after the other; give one, as in "
            "forces.on(forces.branch == 0).sizing()"
        )
    breaks = own._breaks
    if own.part is not None and own.between is None:
        return None
    if own.through_change_points and len(breaks):
        return None
    result = cycle_loads(
        own,
        period=period,
        speed=own.even_speed * own.metre if period is not None else None,
        evaluate=None if own.through_change_points else own.between,
        breaks=breaks,
        gaps=own.status == "change-point" if own.through_change_points else None,
    )
    if result is None or result.tail > WITHHELD or not own.closes:
        return None
    # between stops force by length unit, in joule
    return result if own.part is None else replace(result, work=own.metre)
