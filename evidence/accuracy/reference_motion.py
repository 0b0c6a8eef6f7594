"""How the links of any single loop move at one pose, worked out a second time, in any precision.

Source: the definition of a linkage, and how velocity and acceleration are carried from joint to joint: a turn
adds to the angular velocity, a slide adds Coriolis' term. The rates of the joints are those that leave the
ground, reached again at the end of the loop, at rest. No series and no screw is used: no formula is that of
the core. The same code runs in double precision and in as many digits as mpmath carries, then from matrices that
`precise_loops` makes rotations in all digits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy.precise_loops import PreciseLoop
from evidence.accuracy.reference_loops import Loop

#: Singular values below this part of the greatest are zero.
RANK = 1e-8

#: Numbers, in double precision or of mpmath.
Numbers = np.ndarray


@dataclass(frozen=True, eq=False)
class State:
    """A frame that is carried along: rotation (3, 3), place (3,), and for each of k sets of rates how it moves (k, 3)."""

    rotation: Numbers
    place: Numbers
    spin: Numbers
    spin_rate: Numbers
    velocity: Numbers
    acceleration: Numbers

    def moved(self, arm: Numbers) -> tuple[Numbers, Numbers]:
        """Velocity and acceleration (k, 3) of a point fixed to it, `arm` (3,) from its place."""
        swept = crossed(self.spin, arm)
        return self.velocity + swept, (
            self.acceleration + crossed(self.spin_rate, arm) + crossed(self.spin, swept)
        )

    def shifted(self, arm: Numbers) -> State:
        """The same body seen from another place."""
        velocity, acceleration = self.moved(arm)
        return State(self.rotation, self.place + arm, self.spin, self.spin_rate, velocity, acceleration)

    def turned_axis(self, axis: Numbers) -> tuple[Numbers, Numbers]:
        """First and second derivative (k, 3) of a direction fixed to it."""
        rate = crossed(self.spin, axis)
        return rate, crossed(self.spin_rate, axis) + crossed(self.spin, rate)

    def only(self, k: int) -> State:
        """With one set of rates, arrays (3,)."""
        return State(
            self.rotation,
            self.place,
            self.spin[k],
            self.spin_rate[k],
            self.velocity[k],
            self.acceleration[k],
        )


@dataclass(frozen=True, eq=False)
class Freedom:
    """One freedom of a joint: its axis (3,) and a place on it (3,) [m], how far it turns and slides [m] for one unit."""

    axis: Numbers
    place: Numbers
    turns: Any
    slides: Any


@dataclass(frozen=True, eq=False)
class Rule:
    """The rule of an idle spin: `axis` (3,) of the link before joint `joint` stays at right angles to `across` (3,) after it."""

    joint: int
    axis: Numbers
    across: Numbers


class Carried:
    """A linkage driven by a column, its places in metres; `metre` is its length unit.

    `precise`: numbers of mpmath, in the digits at work. An idle spin of a link between two neighbouring balls keeps the rule
    of docs/theory.md, other idle freedoms are a column held at zero; `ValueError` for the rest.
    """

    def __init__(self, linkage: sb.Linkage, column: int, metre: float, *, precise: bool = False) -> None:
        self.linkage, self.column, self.metre, self.precise = linkage, column, metre, precise
        self.loop = Loop.of(linkage)
        self.count = len(linkage.joints)
        self.length = float(self.loop.size) * metre
        if precise:
            exact = PreciseLoop(self.loop, column)
            self.fixed = [np.array(rows, dtype=object) for rows in exact.fixed]
            self.base = np.array(exact.base, dtype=object)
        else:
            self.fixed = [rows[:3] for rows in self.loop.fixed]
            self.base = self.loop.base[:3]
        #: The first freedom of each joint.
        self.first = [0, *(end + 1 for end in self.loop.ends)]
        spun, columns, chains = linkage.held
        self.balls = sorted(spun)
        #: Columns that are held at zero.
        self.held = [c for c in columns if not any(self.first[b] <= c < self.first[b + 1] for b in spun)]
        if chains or any(linkage.joints[(ball + 1) % self.count].kind != "S" for ball in self.balls):
            raise ValueError("several links spin together between two balls")

    def units(self, count: int) -> Numbers:
        """The unit matrix."""
        return exactly(np.eye(count)) if self.precise else np.eye(count)

    def carried(self, q: Numbers, dq: Numbers, ddq: Numbers) -> tuple[list[State], list[Freedom], State]:
        """The links 0 to n - 1 (0 is the ground), the freedoms, and the last link as the loop leaves it; rates (k, m)."""
        still = dq[:, :1] * np.zeros(3)
        metre = self.metre
        place = self.base[:, 3] * metre
        state = State(self.base[:, :3], place, still, still, still, still)
        links = [State(self.units(3), place * 0, still, still, still, still)]
        freedoms = []
        ends = {end: j for j, end in enumerate(self.loop.ends)}
        for k, fixed in enumerate(self.fixed):
            turns, slides = self.loop.turns[k], self.loop.slides[k] * metre
            z = state.rotation[:, 2]
            freedoms.append(Freedom(z, state.place, turns, slides))
            rate, second = dq[:, k : k + 1] * z, ddq[:, k : k + 1] * z
            if slides:
                # carried with the body so far, then Coriolis' term twice, and the slide's own
                along = state.shifted(slides * q[k] * z)
                state = State(
                    state.rotation,
                    along.place,
                    state.spin,
                    state.spin_rate,
                    along.velocity + slides * rate,
                    along.acceleration + 2 * slides * crossed(state.spin, rate) + slides * second,
                )
            if turns:
                c, s = cos_sin(turns * q[k])
                x, y = state.rotation[:, 0], state.rotation[:, 1]
                state = State(
                    np.stack([c * x + s * y, c * y - s * x, z], axis=1),
                    state.place,
                    state.spin + turns * rate,
                    state.spin_rate + turns * second + turns * crossed(state.spin, rate),
                    state.velocity,
                    state.acceleration,
                )
            if k in ends and ends[k] < self.count - 1:
                back = self.loop.backs[ends[k]]
                links.append(
                    State(
                        state.rotation @ back,
                        state.place,
                        state.spin,
                        state.spin_rate,
                        state.velocity,
                        state.acceleration,
                    )
                )
            state = state.shifted(state.rotation @ (fixed[:, 3] * metre))
            state = State(
                state.rotation @ fixed[:, :3],
                state.place,
                state.spin,
                state.spin_rate,
                state.velocity,
                state.acceleration,
            )
        return links, freedoms, state

    def joint_frame(self, links: list[State], joint: int) -> tuple[Numbers, Numbers]:
        """Rotation and place [m] of a joint's frame on the side of the link before."""
        if joint == 0:
            frame = self.linkage.base
            return frame[:3, :3], frame[:3, 3] * self.metre
        before, frame = links[joint], self.linkage.links[joint - 1]
        return before.rotation @ frame[:3, :3], before.place + before.rotation @ (frame[:3, 3] * self.metre)

    def rules(self, links: list[State]) -> list[Rule]:
        """The rules of idle spins, as they stand at a pose that obeys them."""
        rules = []
        for ball in self.balls:
            frame, place = self.joint_frame(links, ball)
            axis = frame @ self.linkage.spin_axes[self.linkage.joints[ball].name]
            _, other = self.joint_frame(links, (ball + 1) % self.count)
            across = crossed(axis, other - place)
            rules.append(Rule(ball, axis, across / length(across)))
        return rules

    def _second(self, links: list[State], rules: list[Rule]) -> tuple[Numbers, Numbers]:
        """First and second derivatives (k, rules) of the cosines that rules keep at zero."""
        first, second = [], []
        for rule in rules:
            one, one_second = links[rule.joint].turned_axis(rule.axis)
            two, two_second = links[(rule.joint + 1) % self.count].turned_axis(rule.across)
            first.append(one @ rule.across + two @ rule.axis)
            second.append(one_second @ rule.across + 2 * (one * two).sum(axis=1) + two_second @ rule.axis)
        return np.array(first).T, np.array(second).T

    def _equations(self, q: Numbers, rules: list[Rule] | None = None) -> tuple[Numbers, list[Rule]]:
        """What rates must meet, (rows, m): closure, rules, held columns, input; the rules of the pose."""
        m = self.loop.count
        units = self.units(m)
        links, _, last = self.carried(q, units, units * 0)
        rules = self.rules(links) if rules is None else rules
        parts = [last.spin.T, last.velocity.T / self.length]
        if rules:
            parts.append(self._second(links, rules)[0].T)
        parts += [units[[column]] for column in [*self.held, self.column]]
        return np.concatenate(parts), rules

    def rates(self, q: Numbers, speed: Any, acceleration: Any) -> tuple[Numbers, Numbers]:
        """First and second derivatives (m,) of all joint values at the input's."""
        matrix, rules = self._equations(q)
        right = matrix[:, 0] * 0
        right[-1] = speed
        dq = self._solved(matrix, right)
        links, _, last = self.carried(q, dq[None], dq[None] * 0)
        parts = [-last.spin_rate[0], -last.acceleration[0] / self.length]
        if rules:
            parts.append(-self._second(links, rules)[1][0])
        bias = np.concatenate([*parts, right[-1 - len(self.held) :] * 0])
        bias[-1] = bias[-1] + acceleration
        return dq, self._solved(matrix, bias)

    def pose(self, q: Numbers, angle: Any, steps: int = 5) -> Numbers:
        """The closed pose (m,) next to q with the input at `angle`, idle spins by their rules, by Newton's method."""
        q = exactly(np.asarray(q)) if self.precise else np.array(q, dtype=np.float64)
        still = q[None] * 0
        # a direction fixed to the link is named once, where the pose obeys the rule as well as rounding lets it
        own: list[Numbers] = []
        for _ in range(steps):
            links, _, last = self.carried(q, still, still)
            rules = self.rules(links)
            after = [links[(rule.joint + 1) % self.count].rotation for rule in rules]
            if not own:
                own = [turn.T @ rule.across for turn, rule in zip(after, rules, strict=True)]
            rules = [
                Rule(rule.joint, rule.axis, turn @ fixed)
                for rule, turn, fixed in zip(rules, after, own, strict=True)
            ]
            r = last.rotation @ self.base[:, :3].T
            turned = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / 2
            closing = [turned, (last.place - self.base[:, 3] * self.metre) / self.length]
            closing += [np.array([rule.axis @ rule.across for rule in rules])] if rules else []
            away = np.array([*(q[column] for column in self.held), q[self.column] - angle])
            matrix, _ = self._equations(q, rules)
            q = q - self._solved(matrix, np.concatenate([*closing, away]))
        return q

    def _solved(self, matrix: Numbers, right: Numbers) -> Numbers:
        """Of consistent equations of full column rank."""
        if not self.precise:
            return np.linalg.lstsq(matrix, right, rcond=RANK)[0]
        return from_mp(
            mp.lu_solve(mp.matrix((matrix.T @ matrix).tolist()), mp.matrix((matrix.T @ right).tolist()))
        )

    def point(self, links: list[State], link: int, at: Sequence[float] | None) -> State:
        """A link seen from one of its points, as it is written; the last link is the ground."""
        frame = self.linkage.point_frames[link - 1]
        body = links[link % self.count]
        place = frame[:3, :3] @ np.array(at) + frame[:3, 3]
        return body.shifted(body.rotation @ (place * self.metre))


def crossed(one: Numbers, other: Numbers) -> Numbers:
    """Their vector products (..., 3); NumPy's own is five times as slow on few."""
    a, b, c = one[..., 0], one[..., 1], one[..., 2]
    x, y, z = other[..., 0], other[..., 1], other[..., 2]
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)


def cos_sin(angle: Any) -> tuple[Any, Any]:
    return (mp.cos(angle), mp.sin(angle)) if isinstance(angle, mp.mpf) else (math.cos(angle), math.sin(angle))


def length(vector: Numbers) -> Any:
    square = vector @ vector
    return mp.sqrt(square) if isinstance(square, mp.mpf) else math.sqrt(square)


def exactly(values: Numbers) -> Numbers:
    """Numbers of mpmath."""
    return np.vectorize(lambda x: mp.mpf(x) if isinstance(x, mp.mpf) else mp.mpf(float(x)), otypes=[object])(
        values
    )


def from_mp(column: mp.matrix) -> Numbers:
    return np.array(list(column), dtype=object)
