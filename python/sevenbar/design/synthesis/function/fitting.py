"""The fit of one RSSR to a wanted function: structural error and limits, with their exact gradients.

Unknown are M, N, L1, L2, D relative to L3 and the zeros u, v of the two dials, unless they are given. The
error at a reading a of the input is

    e(a) = beta(u + a) - v - b(a)                                                                        (1)

on one branch. First the sum of squares is made least (scipy's trust region, limits as penalties). Then

    minimise t   with   -t <= e(a) <= t,   limits >= 0,   and e = 0 at precision points                  (2)

by linear programs (`programs`): at the end the greatest errors are equal and alternate. With precision points
alone, t is minus the least squared sine of the transmission angle. Newton's steps then bring the precision
points to rounding.

Source: docs/theory_design.md, (26).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.closure import (
    output_slopes,
    outputs,
    transmission_slopes,
    transmissions,
)
from sevenbar.design.limits import INPUT_TURNS, Limits, size_room, turning_room
from sevenbar.design.task.programs import MISSED, MinimaxValues, lowered
from sevenbar.design.wish import Wish

#: Columns of a row (6,) that are unknown: all but L3.
FREE = (0, 1, 2, 3, 5)

#: Squared sine below which an output is at a dead centre, where its slope is infinite.
DEAD = 1e-6

#: Weight of a missed limit [rad per unit of its room] relative to the error.
PENALTY = 1.0

#: Room that a fit leaves at each limit, so that the check between its samples does not miss it.
MARGIN = 1e-4

#: Most evaluations of a least squares fit: along a valley its steps are short.
MOST_SQUARES = 200

#: Error at precision points [rad] that Newton's steps end at, and how many there are at most.
MET, MOST_NEWTON = 1e-14, 12


@dataclass(frozen=True, eq=False)
class Estimate:
    """A design on the way: its row (6,) with L3 = 1, zeros (2,) [rad], branch."""

    row: Floats
    zeros: Floats
    branch: int


class Fit:
    """The errors and limits of a wish as functions of the unknowns z (7,), or (5,) where zeros are given."""

    def __init__(self, wish: Wish, limits: Limits) -> None:
        self.wish = wish
        self.limits = replace(
            limits, transmission_lowest=limits.transmission_lowest and limits.transmission_lowest + MARGIN
        )
        self.input = np.concatenate([wish.input, wish.point_input])
        self.wanted = np.concatenate([wish.output, wish.point_output])
        self.range = slice(0, wish.input.size)
        self.points = slice(wish.input.size, None)
        # between pairs the input must move, too
        self.used = wish.input
        if wish.function is None:
            self.used = np.linspace(wish.input[0], wish.input[-1], 41)

    def packed(self, point: Estimate) -> Floats:
        """The unknowns of a design."""
        zeros = np.empty(0) if self.wish.zeros is not None else point.zeros
        return np.concatenate([point.row[list(FREE)], zeros])

    def unpacked(self, z: Floats, branch: int) -> Estimate:
        """The design of unknowns, lengths positive; a negative L1 is half a turn of the input's zero."""
        row = np.ones(6)
        row[list(FREE)] = z[:5]
        zeros = np.array(self.wish.zeros if self.wish.zeros is not None else z[5:], dtype=float)
        row[3] = abs(row[3])
        if row[2] < 0:
            row[2], zeros = -row[2], zeros + np.array([math.pi, 0.0])
        return Estimate(row, zeros, branch)

    def errors(self, z: Floats, branch: int) -> tuple[Floats, Floats]:
        """The errors (1) (m + n,) [rad] at samples and precision points, and their slopes (m + n, k)."""
        row, zeros = self._row(z)
        inputs = (zeros[0] + self.input)[None]
        angles = outputs(row, inputs, branch, floor=0.0)
        by_row, by_input = output_slopes(row, inputs, outputs(row, inputs, branch, floor=DEAD))
        off = short_way(angles[0] - zeros[1] - self.wanted)
        slopes = by_row[0][:, FREE]
        if self.wish.zeros is None:
            slopes = np.column_stack([slopes, by_input[0], -np.ones(len(off))])
        return off, slopes

    def transmission(self, z: Floats) -> tuple[Floats, Floats]:
        """The squared sine of the transmission angle over the used range (r,), and its slopes (r, k)."""
        row, zeros = self._row(z)
        inputs = (zeros[0] + self.used)[None]
        by_row, by_input = transmission_slopes(row, inputs)
        slopes = by_row[0][:, FREE]
        if self.wish.zeros is None:
            slopes = np.column_stack([slopes, by_input[0], np.zeros(slopes.shape[0])])
        return transmissions(row, inputs)[0], slopes

    def room(self, z: Floats) -> tuple[Floats, Floats]:
        """All limits, negative where missed (r,), and their slopes (r, k)."""
        row, _ = self._row(z)
        square, by_z = self.transmission(z)
        rooms = [square - max(math.sin(self.limits.transmission_lowest) ** 2, MARGIN)]
        slopes = [by_z]
        others = [size_room(row[0], self.limits, scale_free=True)]
        if self.limits.motion_type in INPUT_TURNS:
            others.append(turning_room(row[0]))
        for value, by_row in others:
            rooms.append(value - MARGIN)
            wide = np.zeros((len(value), len(z)))
            wide[:, :5] = by_row[:, FREE]
            slopes.append(wide)
        return np.concatenate(rooms), np.concatenate(slopes)

    def _row(self, z: Floats) -> tuple[Floats, Floats]:
        row = np.ones((1, 6))
        row[0, list(FREE)] = z[:5]
        return row, np.asarray(self.wish.zeros if self.wish.zeros is not None else z[5:], dtype=float)

    def least_squares(self, start: Estimate) -> Estimate:
        """The design of least squared error near another; missed limits and precision points weigh more."""
        from scipy.optimize import least_squares

        weights = np.ones(len(self.input))
        weights[self.points] = MISSED

        known: dict[bytes, tuple[Floats, Floats]] = {}

        def both(z: Floats) -> tuple[Floats, Floats]:
            # the solver requests values and slopes at the same place
            if z.tobytes() not in known:
                (error, error_slopes), (room, room_slopes) = self.errors(z, start.branch), self.room(z)
                missed = np.where(room < 0, PENALTY, 0.0)
                known.clear()
                known[z.tobytes()] = (
                    np.concatenate([weights * error, missed * room]),
                    np.concatenate([weights[:, None] * error_slopes, missed[:, None] * room_slopes]),
                )
            return known[z.tobytes()]

        def values(z: Floats) -> Floats:
            return both(z)[0]

        def slopes(z: Floats) -> Floats:
            return both(z)[1]

        with np.errstate(all="ignore"):
            found = least_squares(
                values,
                self.packed(start),
                jac=slopes,
                method="lm",
                max_nfev=MOST_SQUARES,
                ftol=1e-12,
                xtol=1e-12,
                gtol=1e-14,
            )
        return self.unpacked(found.x, start.branch)

    def equalised(self, start: Estimate, *, hold: bool = False) -> Estimate:
        """The design of least greatest error near another, within the limits; its precision points met.

        With `hold` the input's zero stays: designs lie along valleys, and so each start keeps its place.
        """
        held = (5,) if hold and self.wish.zeros is None else ()
        z = lowered(lambda z: self._heights(z, start.branch), self.packed(start), held)
        return self.unpacked(z, start.branch)

    def _heights(self, z: Floats, branch: int) -> MinimaxValues:
        """What is to be made low, and what is to stay at or above zero, with slopes."""
        room, room_slopes = self.room(z)
        error, slopes = self.errors(z, branch)
        if self.wish.function is not None or not self.wish.exact:
            own, own_slopes = error[self.range], slopes[self.range]
            height, height_slopes = np.concatenate([own, -own]), np.concatenate([own_slopes, -own_slopes])
        else:
            square, square_slopes = self.transmission(z)
            height, height_slopes = 1.0 - square, -square_slopes
        at, at_slopes = error[self.points], slopes[self.points]
        return MinimaxValues(
            height,
            height_slopes,
            np.concatenate([room, at, -at]),
            np.concatenate([room_slopes, at_slopes, -at_slopes]),
        )

    def exact(self, start: Estimate) -> Estimate:
        """The design near by that meets the precision points to rounding, by Newton's shortest steps."""
        z = self.packed(start)
        for _ in range(MOST_NEWTON):
            error, slope = (values[self.points] for values in self.errors(z, start.branch))
            if not np.isfinite(slope).all() or np.abs(error).max(initial=0.0) < MET:
                break
            z = z - np.linalg.lstsq(slope, error, rcond=None)[0]
        return self.unpacked(z, start.branch)
