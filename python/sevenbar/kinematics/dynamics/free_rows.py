"""Rows of a linkage that moves along a circuit as it likes: columns, points and links by arc length.

    dq/dt = q' s',   d2q/dt2 = q'' s'^2 + q' s''                                                          (13)

Source: docs/theory_free.md, (13).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, Words
from sevenbar.curves.along import Along
from sevenbar.curves.stationary import series_through
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.dynamics.energy_path import EnergyBuilder
from sevenbar.kinematics.paths.covered_path import curve_on, rows_on

#: A ball whose turns' series end above this [rad] is near a singular pose, where they have no rates.
UNDEFINED = 1e-8


@dataclass(frozen=True, eq=False)
class CourseRows:
    """The columns of an analysis along a path, balls as their turns about z, y and x."""

    builder: EnergyBuilder

    @cached_property
    def _places(self) -> tuple[Floats, Floats]:
        """Nodes on the path's pieces (m, terms), and the rows there (m * terms, columns)."""
        return rows_on(self.builder.path, self.builder.numbers)

    @cached_property
    def columns(self) -> Along:
        """All columns by arc length."""
        path, numbers = self.builder.path, self.builder.numbers
        series = path.poses.series.copy()
        balls = np.flatnonzero(numbers.is_ball)
        if balls.size:
            grid, rows = self._places
            # from the first node of the circuit on
            order = np.argsort(grid.ravel())
            turns = np.empty((len(order), balls.size))
            turns[order] = np.unwrap(rows[np.ix_(order, balls)], axis=0)
            turns = turns.reshape(*grid.shape, balls.size)
            series[:, :, balls] = series_through(turns)
        return Along(path.poses.edges, series)

    @cached_property
    def gain(self) -> Floats:
        """What a closed circuit adds to the columns (columns,)."""
        gain = self.builder.path.gain.copy()
        balls = np.flatnonzero(self.builder.numbers.is_ball)
        ends = self.columns.series[-1].sum(axis=0) - self.columns.at(np.zeros(1))[0]
        gain[balls] = math.tau * np.round(ends[balls] / math.tau)
        return gain

    @cached_property
    def _undefined(self) -> Floats:
        """Whether a ball's turns are undefined on a piece (m, columns)."""
        last = np.abs(self.columns.series[:, -2:]).max(axis=1)
        return np.asarray((last > UNDEFINED) & self.builder.numbers.is_ball)

    def at(
        self, place: Floats, rates: tuple[Floats, Floats, Floats]
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Columns and three derivatives by time (n, columns) at places (n,) with s', s'' and s'''."""
        path = self.builder.path
        laps = np.floor(place / path.length) if path.closed else np.zeros_like(place)
        inside = place - laps * path.length
        known = np.isfinite(inside)
        inside = np.where(known, inside, 0.0)
        q = self.columns.at(inside) + laps[:, None] * self.gain
        result = _by_time([q, *self._slopes(inside)], rates)
        piece = np.clip(np.searchsorted(path.poses.edges, inside, "right") - 1, 0, len(self._undefined) - 1)
        for values in result:
            values[self._undefined[piece]] = np.nan
            values[~known] = np.nan
        return result

    def _slopes(self, inside: Floats) -> list[Floats]:
        first = self.columns.slope
        result = [first.at(inside), first.slope.at(inside), first.slope.slope.at(inside)]
        exact = self.builder.tangents
        if exact is not None:
            # those of the core, which lose a derivative less
            smooth = self.builder.smooth
            for values, own in zip(result, (exact, exact.slope, exact.slope.slope), strict=True):
                values[:, smooth] = own.at(inside)
        return result

    def trace(
        self, place: Floats, rates: tuple[Floats, Floats, Floats], status: Words, link: int, at: Floats
    ) -> Trace:
        """A point, `at` in its link's own frame, on rows at places (n,)."""
        linkage, path = self.builder.solver.linkage, self.builder.path
        if link == linkage.graph.ground:
            position = np.broadcast_to(at, (len(place), 3)).copy()
            rest = np.zeros_like(position)
            return Trace(position, rest, rest.copy(), rest.copy(), status)
        frames = poses(linkage, self._places[1])[:, link - 1]
        along = curve_on(path, frames[:, :3, :3] @ at + frames[:, :3, 3])
        inside = place % path.length if path.closed else place
        known = np.isfinite(inside)
        inside = np.where(known, inside, 0.0)
        first = along.slope
        derived = [along.at(inside), first.at(inside), first.slope.at(inside), first.slope.slope.at(inside)]
        result = _by_time(derived, rates)
        for values in result:
            values[~known] = np.nan
        return Trace(*result, status)


def _by_time(
    by_s: list[Floats], rates: tuple[Floats, Floats, Floats]
) -> tuple[Floats, Floats, Floats, Floats]:
    """A quantity and its derivatives by arc length (n, k) each, as derivatives by time."""
    value, one, two, three = by_s
    v, a, j = (rate[:, None] for rate in rates)
    return value, one * v, two * v**2 + one * a, three * v**3 + 3 * two * v * a + one * j
