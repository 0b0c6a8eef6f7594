"""The transmission angle: how squarely the coupler pushes the output.

With the input held, the joint through which the coupler drives the output link can move one way, along u; the
output moves it another way, along w. What the coupler transmits does no work along u. So

    sin(mu) = |u x w| / (|u| |w|)                                                                          (4)

for the pin of a planar loop (u and w in its plane), and for the axis of a spherical loop as a point of the
sphere. A ball can move in a plane with the input held, and the force f is square to that plane,

    sin(mu) = |f . w| / (|f| |w|),                                                                         (5)

f along the coupler where it has a ball at its other end too. The pressure angle is 90 degrees less mu.

Source: docs/theory_measures.md, (4) to (7); H. Alt, Werkstattstechnik 26 (1932) for the plane; G. Sutherland,
B. Roth, J. Eng. Ind. 95 (1973) 589, for the force of a spatial coupler.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.stationary import curve_through, nodes_between, real_roots
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import Walk, frames_along, joint_frames, walk
from sevenbar.kinematics.loop.geometry import Loop, moved_by
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.solvers.general import Expanded, expanded
from sevenbar.kinematics.solvers.plane_and_sphere import InPlane, in_plane, sphere_of

#: Rows in a turn between which extremes are searched, whatever the samples of the motion.
SAMPLES = 360

#: Angles [rad] nearer than this differ by rounding.
ALIKE = 4e-15

#: An angle [rad] below this is that of a dead centre of the input, known to the root of rounding.
AT_DEAD_CENTRE = 1e-7

#: A loop with so many joints that move, in the plane or on the sphere.
FOUR = 4


@dataclass(frozen=True, eq=False)
class Coupling:
    """How the coupler drives the output link, by joints as `expanded` numbers them.

    In a "planar" loop at the place of the joint `at`, which `free` moves along u; in a "spherical" one at the
    axis of `at`; "ball": at the ball `at`, with a force from the ball `free[0]`, or square to how the two
    joints `free` move it. `output` moves it along w.
    """

    kind: Literal["planar", "spherical", "ball"]
    at: int
    free: tuple[int, ...]
    output: int
    #: Of the plane (3,).
    normal: Floats | None = None


def coupling_of(loop: Loop, input: int, output: int) -> Coupling | None:
    """How a loop driven by one column moves another; `None` where no transmission angle is defined."""
    parts = expanded(loop)
    first, second = parts.columns.index(input), parts.columns.index(output)
    if "S" in (parts.letters[first], parts.letters[second]):
        return None
    if parts.letters.count("S") == 2:
        return _through_a_ball(parts.letters, parts.last, first, second)
    plane = in_plane(loop)
    if plane is not None:
        return _in_plane(parts.letters, plane, first, second)
    if parts.letters == "R" * FOUR and sphere_of(loop) is not None:
        passive = _between((0, 1, 2, 3), first, second)
        return None if passive is None else Coupling("spherical", passive[1], passive[:1], second)
    return _through_a_ball(parts.letters, parts.last, first, second)


def _between(moves: tuple[int, ...], first: int, second: int) -> tuple[int, int] | None:
    """Of four joints the one next to the input and the one next to the output, if these are neighbours."""
    if len(moves) != FOUR or first not in moves or second not in moves:
        return None
    a, b = moves.index(first), moves.index(second)
    if (a - b) % FOUR == 1:
        return moves[(a + 1) % FOUR], moves[(b - 1) % FOUR]
    if (b - a) % FOUR == 1:
        return moves[(a - 1) % FOUR], moves[(b + 1) % FOUR]
    return None


def _in_plane(letters: str, found: InPlane, first: int, second: int) -> Coupling | None:
    passive = _between(found.moves, first, second)
    if passive is None:
        return None
    near_input, near_output = passive
    # a force acts at a pin: where the output is driven by a slide, at that before it
    if letters[near_output] != "P":
        return Coupling("planar", near_output, (near_input,), second, found.plane.normal)
    if letters[near_input] != "P":
        return Coupling("planar", near_input, (near_output,), second, found.plane.normal)
    return None


def _through_a_ball(letters: str, last: list[int], first: int, second: int) -> Coupling | None:
    """A ball next to the output joint, not past the input, and what else moves it: a ball or two joints."""
    count = len(letters)
    owner = [sum(end < part for end in last) for part in range(count)]
    for way in (-1, 1):
        part = (second + way) % count
        while owner[part] == owner[second] and part != first:
            part = (part + way) % count
        if part == first or letters[part] != "S":
            continue
        others = tuple(i for i in range(count) if i not in (first, second, part))
        kinds = "".join(letters[i] for i in others)
        if kinds == "S" or (len(kinds) == 2 and "S" not in kinds):
            return Coupling("ball", part, others, second)
    return None


@dataclass(frozen=True, eq=False)
class Axes:
    """The joints of one freedom, screws and balls of a loop, as `parts` has them, with their axes on n rows.

    `directions` and `places` (parts, n, 3); a ball has no direction that means anything.
    """

    parts: Expanded
    directions: Floats
    places: Floats

    def velocity(self, part: int, at: Floats) -> Floats:
        """How places (n, 3) move with one of the joints, for each radian or length unit of it, (n, 3)."""
        direction: Floats = self.directions[part]
        if self.parts.letters[part] == "P":
            return direction
        turned = np.cross(direction, at - self.places[part])
        return np.asarray(turned + self.parts.advances[part] * direction)


def axes_along(loop: Loop, circuit: Circuit) -> Axes:
    """The axes of the joints on all rows of a circuit; NaN where it has no pose."""
    frames = frames_along(loop, circuit, np.arange(len(circuit.time)))
    before, _ = joint_frames(loop, frames)
    directions, places = [], []
    for i, (joint, own) in enumerate(zip(loop.joints, loop.places, strict=True)):
        now = before[:, i]
        steps = joint.steps(circuit.q[:, own])
        for step, values in steps[:1] if joint.row.is_screw or joint.row.is_ball else steps:
            now = now @ joint.before(step)
            directions.append(now[:, :3, step.axis])
            places.append(now[:, :3, 3])
            now = now @ moved_by(step, values)
    return Axes(expanded(loop), np.stack(directions), np.stack(places))


def sine_and_cosine(coupling: Coupling, axes: Axes) -> tuple[Floats, Floats]:
    """Sine and cosine of the transmission angle on each row (n,), with signs that run on along a circuit."""
    at, output = coupling.at, coupling.output
    if coupling.kind == "spherical":
        here = axes.directions[at]
        u, w = (np.cross(axes.directions[i], here) for i in (coupling.free[0], output))
        sine, cosine = (np.cross(u, w) * here).sum(axis=1), (u * w).sum(axis=1)
    elif coupling.normal is not None:
        here, normal = axes.places[at], coupling.normal
        u, w = (
            # a ball is a pin there
            np.cross(normal, here - axes.places[i])
            if axes.parts.letters[i] == "S"
            else axes.velocity(i, here)
            for i in (coupling.free[0], output)
        )
        sine, cosine = (np.cross(u, w) * normal).sum(axis=1), (u * w).sum(axis=1)
    else:
        here = axes.places[at]
        w = axes.velocity(output, here)
        if len(coupling.free) == 1:
            force = axes.places[coupling.free[0]] - here
        else:
            first, second = coupling.free
            force = np.cross(axes.velocity(first, here), axes.velocity(second, here))
        sine, cosine = (force * w).sum(axis=1), np.linalg.norm(np.cross(force, w), axis=1)
    whole = np.hypot(sine, cosine)
    with np.errstate(invalid="ignore", divide="ignore"):
        return sine / whole, cosine / whole


def transmission_angle(loop: Loop, circuit: Circuit) -> Floats | None:
    """The transmission angle [rad] on each row of a circuit (n,), up to a right angle; NaN without a pose.

    `None` where it is not defined. At a dead centre of the input it is 0.

    Source: docs/theory_measures.md, (4) to (6).
    """
    coupling = coupling_of(loop, circuit.input_column, circuit.output_column)
    if coupling is None:
        return None
    sine, cosine = sine_and_cosine(coupling, axes_along(loop, circuit))
    angle = np.arctan2(np.abs(sine), np.abs(cosine))
    angle[circuit.status == "dead-centre"] = 0.0
    return np.asarray(angle)


def transmission_extremes(linkage: Solvable, circuit: Circuit) -> Extremes | None:
    """The lowest and highest transmission angle [rad] of a circuit; `None` where it is not defined.

    They are at dead centres of the input, where it is 0, and where the derivative of (4) or (5) is zero:
    that of the polynomial through exact poses about each row that is lower or higher than its neighbours.

    Source: docs/theory_measures.md, (7).
    """
    coupling = coupling_of(linkage, circuit.input_column, circuit.output_column)
    row = best_row(circuit)
    if coupling is None or row is None:
        return None
    return _Search(linkage, coupling, circuit, circuit.q[row]).extremes()


def best_row(circuit: Circuit) -> int | None:
    """The row of a circuit with the best condition, from which it is followed anew; `None` without one."""
    sound = np.isfinite(circuit.q).all(axis=1) & (circuit.status == "ok") & np.isfinite(circuit.condition)
    rows = np.flatnonzero(sound)
    return int(rows[np.argmin(circuit.condition[rows])]) if rows.size else None


@dataclass(frozen=True, eq=False)
class _Search:
    """A search for extremes on the circuit through a pose (columns,), with the input and output of `like`."""

    linkage: Solvable
    coupling: Coupling
    like: Circuit
    pose: Floats

    def extremes(self) -> Extremes | None:
        """The lowest and highest angle, with their inputs."""
        rows = self.rows(SAMPLES)
        sine, cosine = self.sine_and_cosine(rows)
        way = walk(rows)
        found = [(math.atan2(abs(s), abs(c)), x) for s, c, x in zip(sine, cosine, rows.input, strict=True)]
        found += self.between(way, sine[way.rows])
        dead = [centre.input for centre in self.like.dead_centres if centre.kind == "input"]
        if dead:
            # near them rounding leaves a little
            found = [one for one in found if one[0] > AT_DEAD_CENTRE] + [(0.0, x) for x in dead]
        kept = [(angle, x) for angle, x in found if math.isfinite(angle)]
        if not kept:
            return None
        lowest, highest = min(kept)[0], max(kept)[0]
        # of places alike up to rounding always the same one
        lowest_at = min(x for angle, x in kept if angle <= lowest + ALIKE)
        highest_at = max(x for angle, x in kept if angle >= highest - ALIKE)
        if rows.goes_round and rows.input_turns:
            # between the first row and the first again
            start, whole = float(rows.input[0]), math.tau * rows.turns
            lowest_at, highest_at = (start + (x - start) % whole for x in (lowest_at, highest_at))
        return Extremes(lowest, float(lowest_at), highest, float(highest_at))

    def between(self, way: Walk, sine: Floats) -> list[tuple[float, float]]:
        """Angles and inputs where the sine (n,) along a walk is stationary."""
        brackets: list[tuple[int, _Stretch, float, float]] = []
        for number, part in enumerate(way.passes):
            x, s = way.input[part], np.abs(sine[part])
            if len(x) < 3:
                continue
            stretch = _Stretch.of(x, turns_back=len(way.passes) > 1)
            if stretch.round and len(x) > 3:
                # once more over the start, which may be an extreme itself
                x, s = np.append(x, x[-1] + x[1] - x[0]), np.append(s, s[1])
            u = stretch.place(x)
            peaks = (s[1:-1] - s[:-2]) * (s[1:-1] - s[2:]) >= 0
            brackets += [(number, stretch, u[i], u[i + 2]) for i in np.flatnonzero(peaks)]
        if not brackets:
            return []
        inputs = [stretch.input(nodes_between(a, b)) for _, stretch, a, b in brackets]
        values = self.at([number for number, *_ in brackets], inputs)
        flat: list[tuple[int, float]] = []
        for (number, stretch, a, b), (sines, cosines) in zip(brackets, values, strict=True):
            if np.isfinite(sines).all():
                # a right angle is a double zero of the sine's derivative, or a zero of the cosine
                angle = np.unwrap(np.arctan2(sines, cosines))
                curves = [curve_through(values) for values in (sines, angle, cosines)]
                for curve in (curves[0].deriv(), curves[1].deriv(), curves[2]):
                    places = [(a + b) / 2 + (b - a) / 2 * root for root in real_roots(curve)]
                    flat += [(number, float(stretch.input(place))) for place in places]
        if not flat:
            return []
        ends = self.at([number for number, _ in flat], [np.array([x]) for _, x in flat])
        return [(math.atan2(abs(s[0]), abs(c[0])), x) for (_, x), (s, c) in zip(flat, ends, strict=True)]

    def at(self, passes: list[int], inputs: list[Floats]) -> list[tuple[Floats, Floats]]:
        """Sines and cosines at inputs, each list of them on one of the passes; NaN where rows are missing."""
        every = np.concatenate(inputs)
        rows = self.rows(Law.of(np.arange(float(every.size)), every, 1.0, 0.0))
        sine, cosine = self.sine_and_cosine(rows)
        found, start = [], 0
        for number, own in zip(passes, inputs, strict=True):
            here = np.flatnonzero(rows.branch == number)
            place = here[start : start + own.size] if here.size == every.size else np.array([], dtype=int)
            start += own.size
            ends = [values[place] if place.size else np.full(own.size, np.nan) for values in (sine, cosine)]
            found.append((ends[0], ends[1]))
        return found

    def rows(self, how: int | Law) -> Circuit:
        """The circuit through the pose at so many samples in a turn, or at the inputs of a law."""
        names = self.linkage.columns
        first, second = names[self.like.input_column], names[self.like.output_column]
        samples, law = (SAMPLES, how) if isinstance(how, Law) else (how, None)
        try:
            return self.linkage.circuit(self.pose, samples, input=first, output=second, law=law)
        except RequestError:
            # through change points where the input may stand still, only the whole motion finds the way
            motion = self.linkage.motion(samples, input=first, output=second, law=law, method="general")
            return motion.circuits[self.like.index]

    def sine_and_cosine(self, rows: Circuit) -> tuple[Floats, Floats]:
        """Sine and cosine of the angle on rows (n,)."""
        return sine_and_cosine(self.coupling, axes_along(self.linkage, rows))


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
