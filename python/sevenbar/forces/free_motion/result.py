"""A free motion: time, all joint values and rates, energies; how it goes on, and how exact it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy.typing as npt

from sevenbar.arrays import Floats, ReadOnly, finite_array
from sevenbar.errors import RequestError, ends_here
from sevenbar.forces.free_motion.equilibria import Equilibrium
from sevenbar.text.printing import Drawable


@dataclass(frozen=True)
class TurningPoint:
    """A pose where the linkage turns back: the input [rad, or length] and the potential energy [J]."""

    input: float
    potential: float


@dataclass(frozen=True)
class Impact:
    """A stop that is met: when [s], the stop ("range of crank"), the input and its speed before.

    [rad and rad/s, or length and length/s]
    """

    time: float
    stop: str
    input: float
    speed: float


@dataclass(frozen=True, eq=False)
class FreeStates:
    """States (n,) at times: joint values and three derivatives by time (n, columns), energies [J]."""

    q: Floats
    dq: Floats
    ddq: Floats
    dddq: Floats
    kinetic: Floats
    potential: Floats
    #: Arc length [rad, or shares of the size] and its rate.
    place: Floats
    rate: Floats


@dataclass(frozen=True, eq=False, repr=False)
class FreeMotion(ReadOnly, Drawable):
    """How a linkage moves by itself from a start, row by row in time.

    `time` (n,) [s]; `q`, `dq`, `ddq`, `dddq` (n, columns) [rad, or length, and derivatives by s], unwrapped;
    `kinetic` and `potential` (n,) [J], the latter of weights, springs and loads, and of a constant torque.
    `kind`: "rotation" and "oscillation" repeat themselves with `period` [s]; "rest"; "asymptotic" comes ever
    nearer to an unstable equilibrium; "passing" repeats nothing within the duration; "ends" leaves an open
    circuit, rows after that are NaN; "driven" has dampers or a motor; "meets stops" is thrown back by stops
    of the linkage, or leaves them again; "on its stop" ends at rest there, `rest` says where. `impacts` are
    the stops that are met, where nothing is lost those of the first period. `turning` are the points where
    it turns back, found, not sampled. `energy_error` is the greatest change of energy over the rows that
    nothing explains, as a part of the greatest kinetic energy: NaN for what has dampers or a motor, which has
    `difference`, the greatest in arc length [rad, or shares of the size] from a solution at a hundred times
    the tolerance. `tail` is what the polynomials along the circuit leave out, as a part of the greatest
    value.

    Source: docs/theory_free.md, (1) to (15).
    """

    time: Floats
    columns: tuple[str, ...]
    q: Floats
    dq: Floats
    ddq: Floats
    dddq: Floats
    kinetic: Floats
    potential: Floats
    kind: str
    period: float | None
    turning: tuple[TurningPoint, ...]
    energy_error: float
    difference: float
    tail: float
    duration: float
    input_column: int
    input_turns: bool
    column_kinds: tuple[str, ...]
    length_unit: str
    #: Whether change points lie on the circuit; it is passed through them along its smooth continuation.
    through_change_points: bool
    impacts: tuple[Impact, ...]
    #: The rest on a stop with which it ends, and from when on [s].
    rest: Equilibrium | None
    rests_from: float
    #: The greatest moment [N m] that the rule of each idle spin needs on the rows and that no ball gives, by
    #: its link: where it is not 0 the link turns about the line of its balls: this motion is not its own.
    spin: Mapping[str, float]
    #: What part of the speed a stop gives back.
    restitution: float
    heading: str = field(repr=False)
    _states: Callable[[Floats], FreeStates] = field(repr=False)
    _law: Callable[[FreeMotion], Any] = field(repr=False)
    _motion: Callable[[FreeMotion], Any] = field(repr=False)
    _table: Callable[[FreeMotion, bool], dict[str, npt.NDArray[Any]]] = field(repr=False)

    @property
    def input(self) -> Floats:
        """The input [rad, or length], (n,)."""
        return self.q[:, self.input_column]

    @property
    def speed(self) -> Floats:
        """The input's speed [rad/s, or length/s], (n,)."""
        return self.dq[:, self.input_column]

    @property
    def energy(self) -> Floats:
        """Kinetic and potential energy together [J], (n,)."""
        return self.kinetic + self.potential

    @ends_here
    def at(self, times: npt.ArrayLike) -> FreeMotion:
        """The same motion at other times (n,) [s], up to the duration; of one that repeats itself, any times.

        Raises `RequestError` for a time before the start, or after the end of what was solved.
        """
        asked = finite_array("times", times).copy()
        if asked.size and asked.min() < 0:
            raise RequestError(f"times: {asked.min():g} lies before the start; give times from 0 on")
        knows_all = self.kind in ("rotation", "oscillation", "rest", "asymptotic", "on its stop")
        if not knows_all and asked.size and asked.max() > self.duration:
            raise RequestError(
                f"times: {asked.max():g} s is after the duration of {self.duration:g} s; "
                "give a longer duration"
            )
        states = self._states(asked)
        selected = {
            name: getattr(states, name) for name in ("q", "dq", "ddq", "dddq", "kinetic", "potential")
        }
        return replace(self, time=asked, **selected)

    def law(self) -> Any:
        """The input over time as a `Law`, for `linkage.motion(law=..)`: rows in which the input is known.

        A law has the input only; where that turns back, the rows of `motion()` say on which pass the linkage
        is.
        """
        return self._law(self)

    @ends_here
    def motion(self) -> Any:
        """A `Motion` with one circuit, whose rows are these: for films, figures, tables and forces.

        Its rows run through dead centres of the input, where a law alone does not say how to go on. Forces on
        it are those of the free motion: the input's torque is what a motor gives.
        """
        return self._motion(self)

    def table(self, *, si: bool = False) -> dict[str, npt.NDArray[Any]]:
        """Columns (n,) by names that end in their units, as a file has them; SI units with `si`."""
        return self._table(self, si)
