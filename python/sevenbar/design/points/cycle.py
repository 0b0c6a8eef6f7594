"""The motion of every point of a link over a cycle: place and rates, which are affine in the point."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Booleans, Floats, finite_array, whole_number
from sevenbar.curves.stationary import highest_between
from sevenbar.curves.timed_rows import shares_of
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.driven import driven as driven_circuit
from sevenbar.kinematics.circuits.link_motion import rates_of_frame
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit

#: Derivatives by time of a point's place, in the order of `LinkRates`.
ORDERS = ("position", "velocity", "acceleration", "jerk")

#: Rows in a turn of the input, at least: two greatest values of a rate nearer than a degree would count as
#: one.
LEAST_ROWS = 720

#: A row lower than this part of the greatest is not followed between rows: rows half a degree apart differ by
#: less.
NEAR_GREATEST = 0.9


@dataclass(frozen=True, eq=False)
class LinkRates:
    """How all points of a link move at n rows: `constant[order] + gradient[order] @ at`, report frame.

    `constant` (4, n, 3) is the motion [length/s^order] of the point written (0, 0, 0), `gradient` (4, n, 3,
    3) [1/s^order] what a change of the written point adds; `input` (n,) [rad, or length], `time` (n,) [s].

    The acceleration's gradient is `(alpha x + omega x omega x) R`.

    Source: docs/theory_design.md, (16).
    """

    input: Floats
    time: Floats
    constant: Floats
    gradient: Floats

    def of(self, order: str, at: npt.ArrayLike) -> Floats:
        """The position, velocity, acceleration or jerk of a point as it is written, (n, 3)."""
        index = ORDERS.index(order)
        return np.asarray(self.constant[index] + self.gradient[index] @ np.asarray(at, dtype=np.float64))


@dataclass(frozen=True, eq=False)
class Cycle:
    """A link along one cycle of a circuit: its `rates` row by row, and at inputs between the rows.

    A cycle is the circuit until it closes, or where a law drives the law's rows on one pass.
    """

    motion: Motion
    circuit: Circuit
    link: int
    branch: int
    rates: LinkRates

    @property
    def closed(self) -> bool:
        """Whether the rows go round at constant speed, so that what lies between them can be computed."""
        return self.motion.law is None and self.circuit.goes_round

    @property
    def step(self) -> float:
        """The way of the input [rad] from row to row of a closed cycle."""
        return float(self.rates.input[1] - self.rates.input[0])

    @property
    def turn(self) -> float:
        """The way of the input [rad] round a closed cycle, > 0."""
        return abs(self.step) * len(self.rates.input)

    @property
    def period(self) -> float:
        """The time [s] of a closed cycle; of a law's rows that from the first to the last."""
        if self.closed:
            return self.turn / abs(self.motion.speed)
        return float(self.rates.time[-1] - self.rates.time[0])

    def at(self, inputs: Floats) -> LinkRates:
        """The rates at any inputs (n,) [rad, or length], at the motion's constant speed."""
        return link_rates(*driven(self.motion, self.circuit, self.branch, inputs), self.link)

    @property
    def shares(self) -> Floats:
        """The share of each row (n,) in a mean by time: alike in a closed cycle, by trapezoids over a law."""
        if self.closed:
            return np.full(len(self.rates.input), 1 / len(self.rates.input))
        return shares_of(self.rates.time)

    def mean(self, values: Floats) -> float:
        """The mean by time of values (n,); over a closed cycle exact to rounding."""
        return float(self.shares @ values)

    def sizes(self, order: str, at: Floats) -> Floats:
        """The sizes (n,) of a point's velocities, accelerations or jerks at the rows."""
        return np.asarray(np.linalg.norm(self.rates.of(order, at), axis=1))

    def peaks(self, order: str, at: Floats) -> tuple[Floats, Floats]:
        """Inputs and sizes of the greatest velocities, accelerations or jerks of a point, (k,) each.

        Every row that is greater than its neighbours and near the greatest is followed between the rows; of a
        law's rows the greatest is returned as it is.
        """
        sizes = self.sizes(order, at)
        if not self.closed:
            top = np.flatnonzero(sizes == sizes.max())[:1]
            return self.rates.input[top], sizes[top]
        tops = (sizes >= np.roll(sizes, 1)) & (sizes > np.roll(sizes, -1))
        tops &= sizes >= NEAR_GREATEST * sizes.max()
        if not tops.any():
            tops[int(np.argmax(sizes))] = True
        centres = self.rates.input[tops]
        return highest_between(
            lambda inputs: np.linalg.norm(self.at(inputs).of(order, at), axis=1),
            centres - self.step,
            centres + self.step,
        )


def cycle_of(
    motion: Motion,
    link: int,
    circuit: int = 0,
    branch: int = 0,
    *,
    order: str = "jerk",
    rows: int = LEAST_ROWS,
) -> Cycle:
    """The cycle of a link with rates up to `order`, of so many `rows` a turn unless a law drives.

    Raises `RequestError` for the ground, a circuit or link that does not exist, a circuit that rocks at
    constant speed where rates are needed, and rows without a value.
    """
    chosen = chosen_circuit(motion, circuit)
    ground = motion.linkage.graph.ground
    if link == ground:
        raise RequestError(f"link: {link} is the ground, which stands still; give 1 to {ground - 1}")
    whole_number("link", link, 1, ground - 1, "a link")
    if motion.law is None and order != "position" and not chosen.goes_round:
        raise RequestError(_unbounded(motion, chosen))
    branches = int(chosen.branch.max(initial=0)) + 1
    branch = whole_number("branch", branch, 0, branches - 1, f"a pass of circuit {circuit}")
    if motion.law is None and chosen.goes_round:
        turn = math.copysign(math.tau * chosen.turns, motion.speed)
        inputs = chosen.input[0] + turn * np.arange(rows * chosen.turns) / (rows * chosen.turns)
        time = np.abs(inputs - inputs[0]) / abs(motion.speed)
        rates = replace(link_rates(*driven(motion, chosen, 0, inputs), link), input=inputs, time=time)
    else:
        rates = link_rates(chosen, chosen.branch == branch, link)
    _refuse_gaps(motion, chosen, rates, ORDERS.index(order))
    return Cycle(motion, chosen, int(link), int(branch), rates)


def driven(motion: Motion, circuit: Circuit, branch: int, inputs: Floats) -> tuple[Circuit, Booleans]:
    """A circuit at these inputs (n,) at constant speed, and which of its rows are those of a pass."""
    again = driven_circuit(motion.linkage, circuit, inputs, speed=motion.speed, agree=motion.agree)
    return again, again.branch == branch


def input_text(motion: Motion, value: float) -> str:
    """A value of the input as people read it: degrees, or lengths."""
    return motion.linkage.column_of(motion.input).text(value)


def link_rates(circuit: Circuit, rows: Booleans, link: int) -> LinkRates:
    """The rates of a link at rows of a circuit, from four points that are the circuit's size apart."""
    frame = rates_of_frame(partial(circuit.written_point, link), circuit.size)
    origins, axes = zip(*(frame(order) for order in ORDERS), strict=True)
    constant, gradient = (np.stack([part[rows] for part in parts]) for parts in (origins, axes))
    return LinkRates(circuit.input[rows], circuit.time[rows], constant, gradient)


def box_of(box: npt.ArrayLike, *, name: str = "box") -> tuple[Floats, Floats]:
    """The lowest and highest coordinates (3,) of a box written ((u, u), (v, v), (w, w)) [length].

    Raises `RequestError` for another shape, a number that is not finite, an empty box.
    """
    try:
        array = np.asarray(box, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.array([])
    if array.shape != (3, 2):
        raise RequestError(f"{name}: {shown(box)} is no box; give three pairs, lowest and highest")
    finite_array(name, array.ravel())
    for letter, (low, high) in zip("uvw", array, strict=True):
        if low > high:
            raise RequestError(
                f"{name}: empty along {letter}: lowest {low:g} above highest {high:g}; give the lower first"
            )
    return array[:, 0].copy(), array[:, 1].copy()


def _unbounded(motion: Motion, circuit: Circuit) -> str:
    name = f"circuit: circuit {circuit.index}"
    if not circuit.closed:
        return f"{name} ends at a change point, so it has no cycle; change a dimension a little"
    word = "turns back" if circuit.input_range is None else "rocks"
    others = ", ".join(str(c.index) for c in motion if c.goes_round)
    other = f", or a circuit whose input goes round: {others}" if others else ""
    return (
        f"{name} {word}: at constant speed of {motion.input} its rates grow without bound at the limits; "
        f"give a law that stays off them{other}"
    )


def _refuse_gaps(motion: Motion, circuit: Circuit, rates: LinkRates, order: int) -> None:
    """`RequestError` where a row has no value up to this order."""
    good = np.isfinite(rates.constant[: order + 1]).all(axis=2).all(axis=0)
    bad = np.flatnonzero(~good)
    if not bad.size:
        return
    count = f"at {bad.size} of {good.size} rows, the first at {motion.input} = "
    where = count + input_text(motion, float(rates.input[bad[0]]))
    if motion.law is not None:
        raise RequestError(
            f"law: circuit {circuit.index} has no rates {where}; give a law that stays within its limits"
        )
    raise RequestError(f"circuit: circuit {circuit.index} has no value {where}; give another circuit or link")
