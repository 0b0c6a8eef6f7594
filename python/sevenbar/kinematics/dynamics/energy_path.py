"""What moves and acts along a circuit by its arc length: mass, slope of the potential, damping.

At the scaled rates u by the joint that drives a piece, ds = |u| dx, so

    m = 2 T(x' = 1) / |u|^2,    U' = torque(at rest) / |u|,    D = loss(x' = 1) / |u|^2                   (5)

The torque at rest is that of statics: weights, springs and loads are in it.

Source: docs/theory_free.md, (5).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.curves.along import Along
from sevenbar.curves.stationary import nodes_between, series_through
from sevenbar.forces.free_motion.course import EnergyCourse
from sevenbar.kinematics.dynamics.forces import ForceSolver
from sevenbar.kinematics.paths.circuit_path import TERMS, CircuitPath, divided
from sevenbar.kinematics.paths.covered_path import closed_on
from sevenbar.text.units import LENGTHS

#: A piece is fine enough where the last terms are below this part of a quantity's greatest value.
RESOLVED = 1e-13

#: Most times a piece is divided.
DIVISIONS = 7

#: A slope of the potential below this part of all that acts is rounding.
NOTHING = 1e-13

#: Edges nearer than this part of the circuit are one.
SAME = 1e-10


class EnergyBuilder:
    """Asks the core along a path for one loading."""

    def __init__(self, solver: ForceSolver, path: CircuitPath) -> None:
        self.solver, self.path = solver, path
        self.numbers = solver.numbers
        self.scales = self.numbers.scales
        self.smooth = np.flatnonzero(~self.numbers.is_ball)
        self.solvers: dict[int, ForceSolver] = {}
        #: The derivatives of all columns but those of balls by arc length, once the course is built.
        self.tangents: Along | None = None
        linkage = solver.linkage
        turns = [s for s in solver.loading.springs if s.joint is not None and s.stiffness]
        #: Springs that wind up: their column, and the torque [N m] that a lap adds.
        self.wound = []
        for spring in turns:
            column = linkage.columns.index(str(spring.joint))
            if path.gain[column]:
                self.wound.append((column, spring.stiffness * path.gain[column]))

    def _solver(self, column: int) -> ForceSolver:
        if column not in self.solvers:
            result = replace(self.solver, input=column)
            # what does not depend on the input is worked out once
            result.__dict__["numbers"] = self.numbers
            result.__dict__["bodies"] = self.solver.bodies
            self.solvers[column] = result
        return self.solvers[column]

    def breaks(self) -> Floats:
        """Places where a load sets in, ends, or changes by another line."""
        turns = self.solver.linkage.turns(self.path.input)
        values: list[float] = []
        for load in self.solver.loading.loads:
            values += load.corners(turns=turns)
        result = [self.path.places(value, turns=turns) for value in values]
        return np.unique(np.concatenate([np.empty(0), *result]))

    def built(self) -> EnergyCourse:
        """The course of the circuit."""
        path, length = self.path, self.path.length
        breaks = self.breaks()
        edges = np.union1d(path.poses.edges, breaks)
        edges = edges[np.diff(edges, prepend=-np.inf) > SAME * length]
        edges[0], edges[-1] = 0.0, length
        # a break that rounding has beside an edge lies on it
        breaks = np.unique(edges[np.abs(edges[:, None] - breaks).argmin(axis=0)])
        todo = np.column_stack([edges[:-1], edges[1:]])
        done: list[tuple[float, float, Floats]] = []
        width = 5 + len(self.smooth)
        scale = np.zeros(width)
        potentials: list[tuple[Floats, Floats]] = []
        tail = 0.0
        floor = NOTHING * self._acting()
        for division in range(DIVISIONS + 1):
            middle, grid = todo.mean(axis=1), nodes_between(todo[:, 0], todo[:, 1], TERMS)
            pieces = np.searchsorted(path.poses.edges, middle, "right") - 1
            values, potential = self._values(np.repeat(pieces, TERMS), grid.ravel())
            potentials.append((grid.ravel(), potential))
            scale = np.maximum(scale, np.abs(values).max(axis=0))
            if scale[1] < floor:
                values[:, 1] = 0.0
            values = values.reshape(len(todo), TERMS, width)
            series = series_through(values)
            size = np.where(scale > 0, scale, 1.0)
            size[1] = max(size[1], 1e3 * floor)
            # a joint that stands still has slopes of rounding
            size[3], size[5:] = self.scales[path.input], self.scales[self.smooth]
            worst = (np.abs(series[:, -2:]) / size).max(axis=(1, 2))
            rough = worst > RESOLVED
            if division == DIVISIONS:
                rough[:] = False
            tail = max(tail, float(worst[~rough].max(initial=0.0)))
            done += [(a, b, own) for (a, b), own in zip(todo[~rough], series[~rough], strict=True)]
            parts = [part for a, b in todo[rough] for part in divided(a, b, path.centres, SAME)]
            todo = np.array(parts).reshape(-1, 2)
            if not len(todo):
                break
        done.sort(key=lambda piece: piece[0])
        result = Along(np.array([piece[0] for piece in done] + [length]), np.stack([p[2] for p in done]))
        quantities = result.part(*range(5))
        self.tangents = result.part(*range(5, width))
        course = EnergyCourse(quantities, path.closed, breaks, 0.0, max(tail, path.tail))
        return replace(course, start=self._start(course, potentials))

    def _start(self, course: EnergyCourse, potentials: list[tuple[Floats, Floats]]) -> float:
        """The potential energy of weights and springs at the path's beginning."""
        s, own = potentials[0]
        first = int(np.argmin(s))
        if self.solver.loading.loads:
            # what loads have done up to there is no potential
            return float(own[first])
        return float(own[first] - course.at(s[first : first + 1])[2][0])

    def _acting(self) -> float:
        """A bound of what acts, in joule for a radian or for the size."""
        solver, size = self.solver, self.solver.size
        weight = float(np.linalg.norm(solver.loading.gravity)) * sum(b.mass for b in solver.bodies.values())
        metre = LENGTHS[solver.linkage.length_unit]
        total = weight * size
        for load in solver.loading.loads:
            total += float(np.linalg.norm(load.force)) * size + float(np.linalg.norm(load.torque))
        for spring in solver.loading.springs:
            way = size / metre
            total += spring.stiffness * (way * size if spring.links is not None else 1.0)
        return total

    def _values(self, pieces: Integers, s: Floats) -> tuple[Floats, Floats]:
        """m, U', D, dx/ds, winding and the columns' slopes (j, 5 + k), and the potential (j,), at places."""
        poses = closed_on(self.path, self.numbers, pieces, s)
        out, potential = np.empty((len(s), 5 + len(self.smooth))), np.empty(len(s))
        inputs = poses[:, self.path.input]
        joule = self.solver.size**2
        # what loads give and take at once leaves rounding
        damped = any(spring.damping for spring in self.solver.loading.springs)
        for driver in np.unique(self.path.drivers[pieces]):
            mine = np.flatnonzero(self.path.drivers[pieces] == driver)
            solver = self._solver(int(driver))
            own, scale = poses[mine], self.scales[driver]
            rates = solver.loop.slopes(own, 0).rates[:, 0] / self.scales * scale
            towards = np.sign(self.path.poses.slope.on(pieces[mine], s[mine])[:, driver])
            factor = towards / np.linalg.norm(rates[:, self.smooth], axis=1)
            still, moving = np.zeros((len(mine), 2)), np.zeros((len(mine), 2))
            moving[:, 0] = scale
            energies = []
            for speeds in (still, moving, -moving):
                result = solver.solved(inputs[mine], own, speeds, by=self.path.input)
                energies.append(result.energies * joule)
                if speeds is still:
                    out[mine, 1] = result.torque * joule * factor
            out[mine, 0] = 2 * energies[1][:, 0] * factor**2
            out[mine, 2] = -(energies[1][:, 2] + energies[2][:, 2]) / 2 * factor**2 if damped else 0.0
            by_s = rates * self.scales * factor[:, None]
            out[mine, 3] = by_s[:, self.path.input]
            out[mine, 4] = sum((torque * by_s[:, c] for c, torque in self.wound), np.zeros(len(mine)))
            out[mine, 5:] = by_s[:, self.smooth]
            potential[mine] = energies[0][:, 1]
        if not self.solver.linkage.turns(self.path.input):
            out[:, 3] *= LENGTHS[self.solver.linkage.length_unit]
        return out, potential
