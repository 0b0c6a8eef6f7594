"""Extremes along a circuit of what its rows have: the transmission angle, the output's velocity.

They are searched between the rows of many even inputs, or, on a pass between two dead centres, along (7),
in which everything is smooth: by the polynomial through exact poses about each row that is lower or higher
than its neighbours, and about each end of such a pass.

Source: docs/theory_measures.md, (7).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev

from sevenbar.arrays import Booleans, Floats
from sevenbar.curves.stationary import curve_through, nodes, nodes_between, real_roots
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import Walk, walk
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.transmission.angle import (
    ALIKE,
    AT_DEAD_CENTRE,
    Angles,
    Coupling,
    angles_along,
    coupling_of,
)
from sevenbar.kinematics.transmission.axes import axes_along, best_row, ratios_at_rest
from sevenbar.kinematics.transmission.closed import closed_extremes

#: Values that differ from their neighbours by less than this part of the greatest are alike up to rounding.
FLAT = 1e-12

#: Rows in a turn between which extremes are searched, whatever the motion's samples; on a pass; and most.
SAMPLES, ON_A_PASS, MANY = 360, 72, 19_440

#: Rows in a turn by which a circuit is recognised; ranges of the input [rad, or relative to the size] nearer
#: than this are alike.
FEWEST, SAME_RANGE = 36, 1e-6

#: Inputs nearer than this part of the range are one; nearer to a change point rates lose digits, and so many
#: nodes of a bracket may be.
SAME_PLACE, LOSES_DIGITS, MOST_LOST = 1e-12, 1e-4, 4

#: The last coefficients of a series that has a limit are smaller than this part of the greatest.
BOUNDED = 1e-5

#: Where u or w is a smaller part of what it could be an angle is left to the limit near by: it is known to
#: 1e-11, and differs from the limit by 1e-10.
NEAR_LIMIT = 1e-5

#: A polynomial whose last terms are above this part of the greatest does not resolve its curve; rounds in
#: which its bracket is narrowed to what lies about the least value.
RESOLVED, ROUNDS = 1e-11, 12


def transmission_extremes(linkage: Solvable, circuit: Circuit) -> Extremes | None:
    """The lowest and highest transmission angle [rad] of a circuit; `None` where it is not defined.

    Of four-bars and slider-cranks in closed form. Else they are at dead centres of the input, where it is 0
    or has a limit, where it passes 0 at a change point, and where the derivative of (4) or (5) is zero.

    Source: docs/theory_measures.md, (7).
    """
    coupling = coupling_of(linkage, circuit.input_column, circuit.output_column)
    if coupling is None:
        return None
    circuit = _with_rows(linkage, circuit)
    row = best_row(circuit)
    if row is None:
        return None
    if not coupling.is_dyad:
        axes = axes_along(linkage, circuit, np.array([row]))
        if result := closed_extremes(coupling, axes, circuit, row):
            return result
    return _AngleSearch(linkage, circuit, circuit.q[row], coupling).extremes()


def velocity_extremes(linkage: Solvable, circuit: Circuit) -> Extremes | None:
    """Those of the output's velocity where the output rests at each dead centre of the input.

    There it has a limit. `None` for a circuit with another dead centre, where it grows without bound.
    """
    circuit = _with_rows(linkage, circuit)
    row = best_row(circuit)
    if row is None or math.isnan(circuit.speed):
        return None
    return _VelocitySearch(linkage, circuit, circuit.q[row]).extremes()


def _with_rows(linkage: Solvable, circuit: Circuit) -> Circuit:
    """The circuit, at more inputs where it turns back before the next one of its rows."""
    if best_row(circuit) is not None or not circuit.turns_back or math.isnan(circuit.speed):
        return circuit
    names = linkage.columns
    first, second = names[circuit.input_column], names[circuit.output_column]
    motion = linkage.motion(MANY, input=first, output=second, speed=circuit.speed)
    return motion.circuits[circuit.index] if circuit.index < len(motion.circuits) else circuit


@dataclass(frozen=True, eq=False)
class _Search:
    """A search on the circuit through a pose (columns,), with the input and output of `like`."""

    linkage: Solvable
    like: Circuit
    pose: Floats

    def dense(self) -> Circuit:
        """The circuit at so many inputs that every pass has rows enough."""
        passes = [self.like.pass_range(int(number)) for number in np.unique(self.like.branch)]
        ranges = [ends[1] - ends[0] for ends in passes if ends is not None and self.like.input_turns]
        least = min((extent for extent in ranges if extent > 0), default=math.tau)
        wanted = math.ceil(ON_A_PASS * math.tau / least)
        return self.rows(min(max(SAMPLES, wanted), MANY))

    def brackets(self, walked: Walk, sizes: Floats) -> list[tuple[int, _Stretch, float, float]]:
        """About each row of a walk where a size (n,) is lower or higher than its neighbours, and the ends."""
        result: list[tuple[int, _Stretch, float, float]] = []
        for number, part in enumerate(walked.passes):
            known = np.isfinite(walked.input[part])
            # a row without a solution has no place
            x, s = walked.input[part][known], sizes[part][known]
            if len(x) < 3:
                continue
            stretch = _Stretch.of(x, turns_back=len(walked.passes) > 1)
            if stretch.round and len(x) > 3:
                # once more over the start, which may be an extreme itself
                x, s = np.append(x, x[-1] + x[1] - x[0]), np.append(s, s[1])
            u = stretch.place(x)
            before, after = s[1:-1] - s[:-2], s[1:-1] - s[2:]
            # where it is alike up to rounding a row itself has the extreme
            flat = np.maximum(np.abs(before), np.abs(after)) < FLAT * np.nanmax(np.abs(s))
            peaks = (before * after >= 0) & ~flat
            if not stretch.round:
                peaks[[0, -1]] = True
            result += [(number, stretch, u[i], u[i + 2]) for i in np.flatnonzero(peaks)]
        return result

    def at(
        self, values: Callable[[Circuit], Floats], passes: list[int], inputs: list[Floats]
    ) -> list[Floats]:
        """Values (n, ..) at inputs, each list of them on one of the passes; NaN where rows are missing."""
        every = np.concatenate(inputs)
        rows = self.rows(Law.of(np.arange(float(every.size)), every, 1.0, 0.0))
        known = values(rows)
        result, start = [], 0
        on_pass = {number: np.flatnonzero(rows.branch == number) for number in set(passes)}
        for number, own in zip(passes, inputs, strict=True):
            here = on_pass[number]
            place = here[start : start + own.size] if here.size == every.size else np.array([], dtype=int)
            start += own.size
            result.append(known[place] if place.size else np.full((own.size, *known.shape[1:]), np.nan))
        return result

    def rows(self, how: int | Law) -> Circuit:
        """The circuit through the pose at so many samples in a turn, or at the inputs of a law."""
        names = self.linkage.columns
        first, second = names[self.like.input_column], names[self.like.output_column]
        samples, law = (SAMPLES, how) if isinstance(how, Law) else (how, None)
        if self._follows:
            with suppress(RequestError):
                return self.linkage.circuit(self.pose, samples, input=first, output=second, law=law)
        # through change points where the input may stand still, only the whole motion finds the way
        motion = self.linkage.motion(samples, input=first, output=second, law=law, method="general")
        return motion.circuits[self.like.index]

    @cached_property
    def _follows(self) -> bool:
        """Whether the circuit through the pose is all of it: at change points it may follow others."""
        like, names = self.like, self.linkage.columns
        if like.motion_type != "change-point":
            return True
        first, second = names[like.input_column], names[like.output_column]
        try:
            alone = self.linkage.circuit(self.pose, FEWEST, input=first, output=second)
        except RequestError:
            return False
        counts = [(one.closed, one.turns, len(one.dead_centres)) for one in (like, alone)]
        extents = [float(np.ptp(one.input_range or 0.0)) for one in (like, alone)]
        unit = 1.0 if like.input_turns else like.size
        return counts[0] == counts[1] and abs(extents[0] - extents[1]) < SAME_RANGE * unit


@dataclass(frozen=True, eq=False)
class _AngleSearch(_Search):
    coupling: Coupling

    def extremes(self) -> Extremes | None:
        """The lowest and highest angle, with their inputs."""
        rows = self.dense()
        angle, made = angles_along(self.linkage, self.coupling, rows)
        limits = rows.status == "dead-centre"
        on_rows = limits | ~(made.share < NEAR_LIMIT)
        result = list(zip(angle[on_rows], rows.input[on_rows], strict=True))
        walked = walk(rows)
        result += self.between(walked, np.sin(angle)[walked.rows], rows.input[rows.status == "change-point"])
        dead = [centre.input for centre in self.like.dead_centres if centre.kind == "input"]
        # of a circuit of which no row is there, all that is known is that it is a dead centre
        exact = [
            (angle, x) for angle, x in zip(angle[limits], rows.input[limits], strict=True) if angle == 0.0
        ]
        if exact or (dead and not limits.any() and not self.coupling.is_dyad):
            # near them rounding leaves a little
            ends = exact or [(0.0, x) for x in dead]
            result = [one for one in result if one[0] > AT_DEAD_CENTRE] + ends
        selected = [(float(angle), float(x)) for angle, x in result if math.isfinite(angle)]
        if not selected:
            return None
        lowest, highest = min(selected)[0], max(selected)[0]
        # of places alike up to rounding always the same one
        lowest_at = min(x for angle, x in selected if angle <= lowest + ALIKE)
        highest_at = max(x for angle, x in selected if angle >= highest - ALIKE)
        if rows.goes_round and rows.input_turns:
            # between the first row and the first again
            start, whole = float(rows.input[0]), math.tau * rows.turns
            lowest_at, highest_at = (start + (x - start) % whole for x in (lowest_at, highest_at))
        return Extremes(lowest, lowest_at, highest, highest_at)

    def between(self, walked: Walk, sine: Floats, touched: Floats) -> list[tuple[float, float]]:
        """Angles and inputs where the sine (n,) along a walk is stationary, passes zero, or ends `touched`.

        Those are the inputs of change points.
        """
        places: list[tuple[int, float]] = []
        zeros: list[tuple[float, float]] = []
        left = self.brackets(walked, sine)
        near = SAME_PLACE * float(np.ptp(walked.input[np.isfinite(walked.input)]))
        for _ in range(ROUNDS):
            if not left:
                break
            nodes = [nodes_between(a, b) for _, _, a, b in left]
            inputs = [one[1].input(u) for one, u in zip(left, nodes, strict=True)]
            values = self.at(self.values, [number for number, *_ in left], inputs)
            narrower = []
            for (number, stretch, a, b), u, own in zip(left, nodes, values, strict=True):
                sines, cosines, _ = own.T
                if not np.isfinite(own).all():
                    continue
                # a right angle is a double zero of the sine's derivative, or a zero of the cosine
                curves = [curve_through(v) for v in (sines, np.unwrap(np.arctan2(sines, cosines)), cosines)]
                tail = np.abs(curves[0].coef[-2:]).max()
                if tail > RESOLVED * np.abs(curves[0].coef).max():
                    # the fold of a loop next to a change point is narrower than its bracket
                    least = int(np.abs(sines).argmin())
                    ends = u[min(least + 1, len(u) - 1)], u[max(least - 1, 0)]
                    narrower.append((number, stretch, float(min(ends)), float(max(ends))))
                elif not stretch.round:
                    # a row at a change point has no angle; those of its pass lead up to a limit
                    for end, place in ((-1.0, a), (1.0, b)):
                        x = float(stretch.input(place))
                        limit = math.atan2(abs(curves[0](end)), abs(curves[2](end)))
                        if _nearest(touched, x) < near:
                            zeros.append((limit if limit > AT_DEAD_CENTRE else 0.0, x))
                passed = _passed(curves[0])
                zeros += [(0.0, float(stretch.input((a + b) / 2 + (b - a) / 2 * root))) for root in passed]
                for curve in (curves[0].deriv(), curves[1].deriv(), curves[2]):
                    for root in real_roots(curve):
                        places.append((number, float(stretch.input((a + b) / 2 + (b - a) / 2 * root))))
            left = narrower
        if not places:
            return zeros
        ends_at = [np.array([x]) for _, x in places]
        known = self.at(self.values, [number for number, _ in places], ends_at)
        return zeros + [
            (math.atan2(abs(own[0, 0]), abs(own[0, 1])), x)
            for (_, x), own in zip(places, known, strict=True)
            if own[0, 2] >= NEAR_LIMIT
        ]

    def values(self, rows: Circuit) -> Floats:
        """Sine, cosine and share on rows (n, 3)."""
        result = Angles.of(self.coupling, axes_along(self.linkage, rows), rows.size)
        return np.column_stack([result.sine, result.cosine, result.share])


def _passed(curve: Chebyshev) -> Floats:
    """Where a polynomial changes its sign in [-1, 1]."""
    roots = np.unique(real_roots(curve))
    if not roots.size:
        return roots
    between = curve(np.convolve([-1.0, *roots, 1.0], [0.5, 0.5], "valid"))
    changes = between[:-1] * between[1:] < 0
    return np.asarray(roots[changes & (np.abs(roots) < 1)])


def _nearest(places: Floats, x: float) -> float:
    """How far from the nearest of places (n,); infinite without one."""
    return float(np.abs(places - x).min(initial=math.inf))


def _through(values: Floats, some: Booleans) -> Chebyshev:
    """The polynomial on [-1, 1] through `some` of the values (count,) at its nodes."""
    at = nodes(len(values))[some]
    return Chebyshev.fit(at, values[some], len(at) - 1, domain=[-1, 1])


@dataclass(frozen=True, eq=False)
class _VelocitySearch(_Search):
    def extremes(self) -> Extremes | None:
        """The lowest and highest velocity [rad/s, or length/s], with their inputs."""
        rows = self.dense()
        limits = ratios_at_rest(self.linkage, rows)
        velocity = self.values(rows)[:, 0]
        for row, ratio in limits.items():
            velocity[row] = ratio * self.like.speed
        dead = np.flatnonzero(rows.status == "dead-centre")
        if not dead.size or not np.isfinite(velocity[dead]).all():
            return None
        result = list(zip(velocity, rows.input, strict=True))
        walked = walk(rows)
        left = self.brackets(walked, velocity[walked.rows])
        if left:
            passes = [number for number, *_ in left]
            inputs = [stretch.input(nodes_between(a, b)) for _, stretch, a, b in left]
            places: list[tuple[int, float]] = []
            touched, extent = rows.input[rows.status == "change-point"], float(np.ptp(rows.input))
            values = self.at(self.values, passes, inputs)
            for (number, stretch, a, b), at, own in zip(left, inputs, values, strict=True):
                # a row at a change point has no rates; those of its pass lead up to a limit, and lose digits
                ends = {-1.0: float(stretch.input(a)), 1.0: float(stretch.input(b))}
                touching = {u: x for u, x in ends.items() if _nearest(touched, x) < SAME_PLACE * extent}
                sound: Booleans = np.asarray(np.isfinite(own).all(axis=1))
                if touching:
                    sound &= [_nearest(touched, x) > LOSES_DIGITS * extent for x in at]
                if sound.sum() < len(own) - MOST_LOST * len(touching):
                    continue
                curve = curve_through(own[:, 0]) if sound.all() else _through(own[:, 0], sound)
                if touching and np.abs(curve.coef[-2:]).max() > BOUNDED * np.abs(curve.coef).max():
                    # it grows towards the change point
                    return None
                result += [(float(curve(u)), x) for u, x in touching.items()]
                roots = real_roots(curve.deriv())
                places += [(number, float(stretch.input((a + b) / 2 + (b - a) / 2 * r))) for r in roots]
            if places:
                known = self.at(self.values, [n for n, _ in places], [np.array([x]) for _, x in places])
                result += [(own[0, 0], x) for (_, x), own in zip(places, known, strict=True) if own[0, 1]]
        selected = [(float(value), float(x)) for value, x in result if math.isfinite(value)]
        (lowest, lowest_at), (highest, highest_at) = min(selected), max(selected)
        return Extremes(lowest, lowest_at, highest, highest_at)

    def values(self, rows: Circuit) -> Floats:
        """The output's velocity on rows, and whether a dead centre is far enough for its digits, (n, 2)."""
        rates = rows.dq[:, self.like.output_column] / rows.dq[:, self.like.input_column]
        ends = np.array([centre.input for centre in self.like.dead_centres])
        far = np.abs(rows.input[:, None] - ends).min(axis=1) > NEAR_LIMIT**2 * np.ptp(ends)
        return np.column_stack([rates * self.like.speed, far])


@dataclass(frozen=True)
class _Stretch:
    """A pass by a place along it in which its curves are smooth.

    That is the input itself; where the pass ends at dead centres, about which the pose changes with the root
    of the input, an angle from 0 to pi.
    """

    middle: float
    half: float
    round: bool

    @staticmethod
    def of(inputs: Floats, *, turns_back: bool) -> _Stretch:
        low, high = float(inputs.min()), float(inputs.max())
        return _Stretch((low + high) / 2, (high - low) / 2, not turns_back)

    def place(self, inputs: Floats) -> Floats:
        """The places (n,) of inputs (n,)."""
        if self.round:
            return inputs
        return np.asarray(np.arccos(np.clip((inputs - self.middle) / self.half, -1, 1)))

    def input(self, places: Floats | float) -> Floats:
        """The inputs (n,) of places (n,)."""
        if self.round:
            return np.asarray(places)
        return np.asarray(self.middle + self.half * np.cos(places))
