"""A closed loop by the numbers of its description: poses at other numbers, and exact derivatives by each.

A number that changes moves what stands behind its factors in the loop's word, as a joint there would: a
dimension is a joint that is held. The core has the screws of both, and solves

    A dq/dp = -sum B,        B the screws of one number p, A those of the joints that follow the input    (1)

and the same for rates (`crates/sevenbar-core/src/loops/numbers`). A number with a part of B that no joint
can follow opens the loop if it changes alone: that of an overconstrained linkage.

Idle freedoms are held by the core's rule; where it has none, one of the joints that take part is held at each
pose, so that what does not spin idly has its own derivatives.

Source: docs/theory_design.md, (1) to (5).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import sevenbar._core as _core
from sevenbar.arrays import Booleans, Floats, Integers
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Sensitivity
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.loop.geometry import drawn_off_zero
from sevenbar.kinematics.loop.rigid import about, zyx_turns
from sevenbar.kinematics.loop.single import check_single
from sevenbar.kinematics.numbers.dimensions import Dimension, description_of, dimensions_of
from sevenbar.kinematics.numbers.lengths import across
from sevenbar.kinematics.numbers.word import Slots, holding_axis, points_of, word_of

#: Part of what one of a number moves [rad, or relative to the size, for a radian or the size of it] that no
#: joint can follow: rounding leaves 1e-15 of it, near dead centres 1e-9; tolerances are 1e-6 and more.
OPENING = 1e-9

#: Share of a column, or of a point [share of the size], in an idle motion that is more than rounding.
TAKES_PART = 1e-9

#: Sine by which two turns miss a ball's rotation that is more than rounding.
SPUN = 1e-9

#: Steps in which a change of numbers or inputs is made where it is too great for one.
PARTS = (1, 2, 4, 8)


@dataclass(frozen=True, eq=False)
class Slopes:
    """A loop at closed poses (n, columns), with derivatives by k numbers, in their units, and by the input.

    `rates` (n, 3, columns) are the first three derivatives by the input; `by_number` (n, orders, k, columns)
    the derivatives of values and rates, `by_input` (n, orders, columns) those by the input; `points` (n,
    points, 2, 3) places and their derivatives by the input, `points_by_number` (n, points, 2, k, 3). A ball's
    three columns are its rotation about x, y, z of the frame before it here. Angles in rad. `opening` (k,):
    the number opens the loop; `idle` (columns,) and `idle_points` (points,): what takes part in a motion that
    the input does not determine. NaN at dead centres of the input.
    """

    rates: Floats
    by_number: Floats
    by_input: Floats
    points: Floats
    points_by_number: Floats
    points_by_input: Floats
    opening: Booleans
    idle: Booleans
    idle_points: Booleans


class Numbers:
    """The numbers of a linkage's description, and its loop for any values of them.

    `dimensions` stand in the order of the file, each in its unit there. A length that the file leaves out as
    it follows from others (L2) is a number of its own, as it is of a part that is made. Raises `RequestError`
    for a linkage made without a description.
    """

    def __init__(self, linkage: Solvable) -> None:
        check_single(linkage)
        self.linkage = linkage
        dimensions = dimensions_of(description_of(linkage), linkage)
        self.dimensions: tuple[Dimension, ...] = tuple(d for d in dimensions if d.kind != "speed")
        #: The names of the dimensions.
        self.names = tuple(d.name for d in self.dimensions)
        #: The numbers (k,) as they stand.
        self.nominal: Floats = np.array([d.value for d in self.dimensions])
        lengths = (abs(d.value) for d in self.dimensions if d.kind == "length")
        #: The longest dimension [length], of which lengths are parts in closure errors.
        self.size = max(lengths, default=0.0) or 1.0
        #: What one of each number is worth beside a radian.
        self.units = np.array(
            [self.size if d.kind in ("length", "pitch") else 1 / d.scale for d in self.dimensions]
        )
        self.turns = linkage.turning
        #: What a value of each column is relative to in the core: a radian, or the size.
        self.scales = np.where(self.turns, 1.0, self.size)
        #: Balls, counted among the joints, that stand as two turns.
        self.spun, self.held, self.spins = linkage.held
        #: What one of each number is in radians or lengths.
        self.carried_units = np.array([d.scale for d in self.dimensions])
        #: What the core's numbers are less than these: lengths of a drawing count from the drawn ones.
        self.drawn: Floats = np.array([d.drawn for d in self.dimensions])
        form, kinds, values = linkage.form, linkage.kind, self.values(self.nominal)
        slots = Slots({d.place: k for k, d in enumerate(self.dimensions)})
        slots.across = across(linkage.description.get("joint", ()))
        slots.to_drawn = drawn_off_zero(linkage.joints)
        axes = {
            ball: holding_axis(form, kinds, slots, values, ball, linkage.spin_axes[linkage.joints[ball].name])
            for ball in self.spun
        }
        #: Whether a column (columns,) is a turn of a ball.
        self.is_ball = np.array([not column.is_output for column in linkage.each_column])
        #: The word of the loop, with balls as the core holds them, and its points.
        self.word = word_of(form, kinds, slots, axes)
        self.points = points_of(form, self.word, linkage.description, kinds)
        self._driven: dict[int, NumberedLoop] = {}
        #: What the core knows of it for any numbers.
        self.core = _core.LoopWord(
            "".join(step.letter for step in self.word.steps),
            [step.pitch for step in self.word.steps],
            self.word.fixed,
            self.held,
            self.spins,
            self.carried_units.tolist(),
            self.size,
        )

    def values(self, p: Floats) -> Floats:
        """The numbers p (k,) in radians and lengths, as the word has them."""
        return np.asarray((p - self.drawn) * self.carried_units)

    def loop(
        self,
        input: int,
        p: Floats | None = None,
        only: Sequence[int] | None = None,
        extra: Sequence[_core.Carried] = (),
    ) -> NumberedLoop:
        """The loop driven by a column at numbers p, the description's own by default.

        Derivatives are by all numbers, or `only` by some, (k,) then being these. Points `extra` come last.
        """
        return NumberedLoop(self, input, self.nominal if p is None else p, only, extra)

    def driven(self, column: int) -> NumberedLoop:
        """The loop driven by a column at the description's own numbers, without derivatives; made once."""
        if column not in self._driven:
            self._driven[column] = self.loop(column, only=())
        return self._driven[column]

    def poses(self, q: Floats, p: Floats | None = None) -> Floats:
        """Rows of an analysis (n, columns) as poses of the word.

        In it a ball that holds a spin has two turns, about the axis before and one square to it. Where an
        analysis has held the spin by another axis, the next ball takes it back.
        """
        q = q.copy()
        values = self.values(self.nominal if p is None else p)
        for joint in sorted(self.spun):
            a, b, line = (axis.pose(values)[:3, 2] for axis in self.word.axes_of_spun(joint))
            column = self.word.freedoms[joint][0].columns[0]
            turn = ball_rotations(q[:, column : column + 3])
            if (link := self.word.beyond(joint)) is not None:
                # two turns leave b square to a
                rows = np.flatnonzero(np.abs(turn @ b @ a) > SPUN)
                spin = _spin_beyond(turn[rows], a, b, line)
                behind = link.pose(values)[:3, :3]
                beyond = slice(column + 3, column + 6)
                taken = behind.T @ spin @ behind @ ball_rotations(q[rows, beyond])
                q[rows, beyond] = zyx_turns(taken)
                turn[rows] = turn[rows] @ np.swapaxes(spin, 1, 2)
            square = np.cross(a, b)
            first = np.arctan2(turn @ b @ square, turn @ b @ b)
            rest = np.swapaxes(turn, 1, 2) @ a
            back = np.arctan2(rest @ -square, rest @ a)
            q[:, column], q[:, column + 1], q[:, column + 2] = first, -back, 0.0
        return q

    def by_columns(self, q: Floats, here: Slopes) -> tuple[Floats, Booleans]:
        """Derivatives of the columns as the analysis has them, (n, orders, k, columns), and which spin idly.

        `q` (n, columns) are the analysis' own rows. Of a ball's turns there is the position only.
        """
        joints, idle = here.by_number.copy(), here.idle.copy()
        joints[:, 1:, :, self.is_ball] = np.nan
        for joint, freedoms in enumerate(self.word.freedoms):
            column = freedoms[0].columns[0]
            own = slice(column, column + 3)
            if not self.is_ball[column]:
                continue
            if joint not in self.spun:
                joints[:, 0, :, own] = ball_turns(q[:, own], joints[:, 0, :, own])
                idle[own] = idle[own].any()
            elif self.linkage.form != "rssr":
                # the axes it is held to are not those of its turns
                idle[own] = True
        return joints, idle


class NumberedLoop:
    """The loop of some values of its numbers, driven by a column."""

    def __init__(
        self,
        numbers: Numbers,
        input: int,
        p: Floats,
        only: Sequence[int] | None = None,
        extra: Sequence[_core.Carried] = (),
    ) -> None:
        self.numbers, self.input, self.p = numbers, input, p
        self.only = range(len(p)) if only is None else only
        points = list(numbers.points)
        #: What the core knows of it.
        self.core = numbers.core.at(p - numbers.drawn, input, self.only, [*points, *extra])

    def followed(
        self, x: npt.ArrayLike, q: Floats, designs: Floats | None = None, steps: Floats | None = None
    ) -> tuple[Floats, Floats]:
        """Poses (designs, n, columns) at inputs x (n,) and other numbers (designs, k), from poses q nearby.

        `steps` (designs, n, columns) are added first. NaN where Newton's method leads nowhere, or to the
        other side of a dead centre of the input, where the determinant of the passive joints' screws changes
        its sign: that determinant (designs, n) comes second.
        """
        scales = self.numbers.scales
        inputs = np.broadcast_to(np.asarray(x) / scales[self.input], (len(q),))
        scaled = None if steps is None else steps / scales
        start = q / scales
        start[:, self.numbers.held] = 0.0
        own = None if designs is None else designs - self.numbers.drawn
        result, sides = self.core.follow(start, inputs, own, scaled)
        return result * scales, sides

    def opening(self, circuit: Circuit) -> Booleans:
        """Which numbers (k,) cannot change alone without opening the loop, on the rows of a circuit."""
        return self.slopes(self.poses(circuit)[1], 0).opening

    def poses(self, circuit: Circuit) -> tuple[Integers, Floats]:
        """Closed poses (n, columns) on rows (n,) of a circuit; those that are lost are left out."""
        q = self.closed(circuit.q[:, self.input], self.numbers.poses(circuit.q))
        rows = np.flatnonzero(np.isfinite(q).all(axis=1))
        return rows, q[rows]

    def closed(self, x: npt.ArrayLike, q: Floats, p: Floats | None = None) -> Floats:
        """The poses (n, columns) at inputs x (n,), from poses q of this loop, in as few steps as it takes.

        At numbers p (k,), its own by default. NaN where poses are lost.
        """
        begin = q[:, self.input]
        way = np.broadcast_to(np.asarray(x, dtype=np.float64), begin.shape) - begin
        result = np.full(q.shape, np.nan)
        left = np.flatnonzero(np.isfinite(q).all(axis=1) & np.isfinite(way))
        for parts in PARTS:
            if not left.size:
                break
            loop, at = self, q[left]
            for share in np.arange(1, parts + 1) / parts:
                p_here = None if p is None else self.p + share * (p - self.p)
                designs = None if p_here is None else p_here[None]
                at = loop.followed(begin[left] + share * way[left], at, designs)[0][0]
                if p_here is not None and parts > 1:
                    loop = NumberedLoop(self.numbers, self.input, p_here, ())
            result[left] = at
            left = left[~np.isfinite(at).all(axis=1)]
        return result

    def places(self, q: Floats) -> Floats:
        """The points (n, points, 3) at poses q (n, columns)."""
        return self.core.places(q / self.numbers.scales) * self.numbers.size

    def slopes(self, q: Floats, order: int = 2) -> Slopes:
        """Rates and derivatives up to an order (0 to 3) at closed poses q (n, columns)."""
        numbers, own = self.numbers, self.numbers.scales[self.input]
        scales, size = numbers.scales, numbers.size
        rates, by, points, points_by, aside, idle, points_idle = self.core.slopes(q / scales, order)
        by_time = own ** -np.arange(4.0)
        by = by * scales * by_time[: order + 1, None, None]
        points_by = points_by * size * by_time[:2, None, None]
        points = points * size * by_time[:2, None]
        with np.errstate(invalid="ignore"):
            worst = np.where(np.isnan(aside), 0.0, aside).max(axis=0, initial=0.0)
            opening = worst * numbers.units[list(self.only)] > OPENING
            columns = np.nan_to_num(np.abs(idle)).max(axis=(0, 1), initial=0.0) > TAKES_PART
            spinning = np.nan_to_num(np.abs(points_idle)).max(axis=(0, 1, 3), initial=0.0) > TAKES_PART
        return Slopes(
            rates=rates * scales * by_time[1:, None],
            by_number=by[:, :, :-1],
            by_input=by[:, :, -1] / own,
            points=points,
            points_by_number=points_by[:, :, :, :-1],
            points_by_input=points_by[:, :, :, -1] / own,
            opening=opening,
            idle=columns,
            idle_points=spinning,
        )


def sensitivity_of(linkage: Solvable, circuit: Circuit) -> Sensitivity:
    """Derivatives of a circuit by all numbers of its linkage's description; see `Circuit.sensitivity`."""
    numbers = Numbers(linkage)
    loop = numbers.loop(circuit.input_column)
    rows, q = loop.poses(circuit)
    here = loop.slopes(q)
    joints, idle = numbers.by_columns(circuit.q[rows], here)
    first, second = (rates[rows, circuit.input_column, None, None] for rates in (circuit.dq, circuit.ddq))
    joints = np.stack(
        [joints[:, 0], joints[:, 1] * first, joints[:, 2] * first**2 + joints[:, 1] * second]
    ).swapaxes(2, 3)
    joints[:, :, idle] = np.nan
    places = np.moveaxis(here.points_by_number, 3, 4)
    places = np.stack([places[:, :, 0], places[:, :, 1] * first[:, None]])
    places[:, :, here.idle_points] = np.nan
    joints[..., here.opening] = places[..., here.opening] = np.nan

    def on_all_rows(result: Floats) -> Floats:
        out = np.full((len(circuit.q), *result.shape[1:]), np.nan)
        out[rows] = result
        out[np.isin(circuit.status, ("dead-centre", "change-point"))] = np.nan
        return out

    position, velocity, acceleration = map(on_all_rows, joints)
    points, velocities = (
        {point.name: on_all_rows(each[:, k]) for k, point in enumerate(linkage.points)} for each in places
    )
    return Sensitivity(
        names=numbers.names,
        units=tuple(dimension.unit for dimension in numbers.dimensions),
        columns=linkage.columns,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        points=points,
        point_velocities=velocities,
        opening=tuple(name for name, opens in zip(numbers.names, here.opening, strict=True) if opens),
        status=circuit.status,
    )


def _spin_beyond(turn: Floats, a: Floats, b: Floats, line: Floats) -> Floats:
    """What of a ball's rotations (n, 3, 3) is spin about a line, behind turns about a and then b.

    Of the link's directions across the line the one nearest to a is at the same side of it as unturned.
    """
    ahead = turn @ line
    across = np.cross(ahead, a) * math.copysign(1.0, float(np.cross(line, a) @ b))
    carried = across / np.linalg.norm(across, axis=1, keepdims=True)
    # the frame of line and b, before and after the two turns
    before = np.stack([line, b, np.cross(line, b)], axis=1)
    after = np.stack([ahead, carried, np.cross(ahead, carried)], axis=2)
    spin: Floats = np.swapaxes(after @ before.T, 1, 2) @ turn
    return spin


def ball_rotations(turns: Floats) -> Floats:
    """The rotations (n, 3, 3) of turns (n, 3) about z, y and x, one after the other."""
    z, y, x = turns.T
    return np.asarray(about(2, z) @ about(1, y) @ about(0, x))


def ball_turns(turns: Floats, rotations: Floats) -> Floats:
    """The rates (n, .., 3) of a ball's turns (n, 3) about z, y, x at angular velocities (n, .., 3) before it.

    NaN where the middle turn is a quarter: the others go about one line there.
    """
    first, second = turns[:, 0], turns[:, 1]
    zero, one = np.zeros_like(first), np.ones_like(first)
    axes = [
        [zero, zero, one],
        [-np.sin(first), np.cos(first), zero],
        [np.cos(first) * np.cos(second), np.sin(first) * np.cos(second), -np.sin(second)],
    ]
    matrix = np.moveaxis(np.array(axes), 2, 0)
    with np.errstate(all="ignore"):
        inverse = np.array([np.linalg.inv(m) if abs(np.cos(b)) > 1e-12 else np.full((3, 3), np.nan)
                            for m, b in zip(matrix, second, strict=True)]).reshape(-1, 3, 3)  # fmt: skip
    return np.asarray(np.einsum("n...j,njk->n...k", rotations, inverse))
