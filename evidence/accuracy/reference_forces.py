"""Forces in any single loop a second time: Newton's and Euler's equations of every link at once.

Source: the laws of Newton and Euler alone, with the motion of `reference_motion`. At one pose all is asked in one system:
six unknowns in every joint, the torque or force of the input, and what holds an idle freedom; six equations for
every moving link about its own centre, and one for every freedom of a joint, along which only a motor, a
spring or a damper acts. It is solved whole, by singular values. What a component's row of the null space says is
whether equilibrium determines it.

Nothing is eliminated, no wrench is carried round the loop, and virtual work is not used: no formula is that of the core.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy.reference_motion import RANK, Carried, Numbers, State, crossed, from_mp, length
from sevenbar.forces.acting import Load, Spring
from sevenbar.forces.bodies import Body
from sevenbar.forces.loading import Loading

#: A component whose row of the null space is longer is not determined by equilibrium.
OPEN = 1e-6


@dataclass(frozen=True, eq=False)
class Forces:
    """What acts at one pose: SI units, joints in loop order.

    `moment` and `force` (joints, 3) are what the link before a joint puts on the link after it, along the
    axes of the joint's frame on the side of the link before, the moment about its origin there, `places` (joints, 3) in the
    report frame. `determinate` (joints, 6): moment, then force; `open` dimensions
    are those of the null space. `spin` is the moment of each rule of an idle spin,
    `held` that of each other idle freedom. `condition` is that of the whole system, its null space left out.
    """

    torque: Any
    moment: Numbers
    force: Numbers
    places: Numbers
    frames: Numbers
    determinate: np.ndarray
    open: int
    spin: Numbers
    held: Numbers
    shaking: Numbers
    kinetic: Any
    potential: Any
    loss: Any
    condition: float
    q: Numbers
    dq: Numbers
    ddq: Numbers


class NewtonEuler:
    """A linkage driven by a column, with what acts on it; bodies are given by mass, centre and inertia, or as points."""

    def __init__(
        self, linkage: sb.Linkage, column: int, loading: Loading, metre: float, *, precise: bool = False
    ) -> None:
        self.linkage, self.column, self.loading, self.metre = linkage, column, loading, metre
        self.motion = Carried(linkage, column, metre, precise=precise)
        self.length = self.motion.length

    def at(self, q: Numbers, speed: Any, acceleration: Any, axes: np.ndarray | None = None) -> Forces:
        """All forces at a closed pose (m,), the input moving so; components along `axes` (joints, 3, 3), if given."""
        q = np.asarray(q)
        dq, ddq = self.motion.rates(q, speed, acceleration)
        links, freedoms, _ = self.motion.carried(q, dq[None], ddq[None])
        rules = self.motion.rules(links)
        links = [link.only(0) for link in links]
        n, m = self.motion.count, self.motion.loop.count
        size = 6 * n + 1 + len(rules) + len(self.motion.held)
        rows = 6 * (n - 1) + m
        zero: Any = mp.mpf(0) if self.motion.precise else 0.0
        matrix = np.full((rows, size), zero)
        right = np.full(rows, zero)
        frames = [self.motion.joint_frame(links, joint) for joint in range(n)]
        if axes is not None:
            frames = [(turn, place) for turn, (_, place) in zip(axes, frames, strict=True)]
        wrenches = self._acting(links, q, dq)
        kinetic, potential, shaking = zero, wrenches.potential, np.full(6, zero)
        for i in range(1, n):
            about, rate, energy, weight = self._momentum(i, links[i])
            kinetic, potential = kinetic + energy, potential + weight
            arm = about - np.zeros(3)
            shaking = shaking - np.concatenate([rate[:3] + crossed(arm, rate[3:]), rate[3:]])
            at = slice(6 * (i - 1), 6 * i)
            for joint, sign in ((i - 1, 1), (i, -1)):
                frame, place = frames[joint]
                moment = slice(6 * joint, 6 * joint + 3)
                force = slice(6 * joint + 3, 6 * joint + 6)
                block = matrix[at]
                block[:3, moment] += sign * frame
                block[:3, force] += sign * _levered(place - about, frame) / self.length
                block[3:, force] += sign * frame
            acting = wrenches.on(i, about)
            right[at] = np.concatenate([(rate[:3] - acting[:3]) / self.length, rate[3:] - acting[3:]])
        for joint in range(n):
            frame, place = frames[joint]
            for k in range(self.motion.first[joint], self.motion.first[joint + 1]):
                freedom, row = freedoms[k], 6 * (n - 1) + k
                z = freedom.axis
                # M about the axis' own place is M + (place - axis' place) x F
                lever = crossed(z, place - freedom.place) * freedom.turns + z * freedom.slides
                # for one radian, or one metre, in newton
                per = self.length if freedom.turns else self.metre
                matrix[row, 6 * joint : 6 * joint + 3] = freedom.turns * (frame.T @ z) * (self.length / per)
                matrix[row, 6 * joint + 3 : 6 * joint + 6] = (frame.T @ lever) / per
                right[row] = wrenches.joints[k] / (self.length if freedom.turns else 1.0)
                if k == self.column:
                    matrix[row, 6 * n] = zero - 1
                for number, rule in enumerate(rules):
                    if rule.joint == joint:
                        matrix[row, 6 * n + 1 + number] = -(z @ crossed(rule.across, rule.axis))
                if k in self.motion.held:
                    matrix[row, 6 * n + 1 + len(rules) + self.motion.held.index(k)] = zero - 1
        x, null, left, condition = self._whole(matrix, right)
        joints = x[: 6 * n].reshape(n, 6)
        inner = self.length if self.motion.loop.turns[self.column] else 1.0
        others = slice(6 * n + 1 + len(rules), None)
        return Forces(
            torque=x[6 * n] * inner,
            moment=joints[:, :3] * self.length,
            force=joints[:, 3:],
            places=np.array([place for _, place in frames]),
            frames=np.array([frame for frame, _ in frames]),
            determinate=(null[: 6 * n] < OPEN).reshape(n, 6),
            open=left,
            spin=x[6 * n + 1 : 6 * n + 1 + len(rules)] * self.length,
            held=x[others],
            shaking=shaking,
            kinetic=kinetic,
            potential=potential,
            loss=wrenches.power,
            condition=condition,
            q=q,
            dq=dq,
            ddq=ddq,
        )

    def potential(self, q: Numbers) -> Any:
        """The energy of weights and springs at a pose (m,)."""
        still = 0 * q
        links = [link.only(0) for link in self.motion.carried(q, still[None], still[None])[0]]
        weights = [self._momentum(i, links[i])[3] for i in range(1, self.motion.count)]
        return sum(weights, self._acting(links, q, still).potential)

    def _whole(self, matrix: Numbers, right: Numbers) -> tuple[Numbers, np.ndarray, int, float]:
        """Solution of least norm, the length of each unknown's row of the null space, its dimension, and the condition."""
        doubles = matrix.astype(np.float64)
        u, values, rows = np.linalg.svd(doubles, full_matrices=True)
        rank = int((values > RANK * values[0]).sum())
        null = np.linalg.norm(rows[rank:], axis=0)
        condition = float(values[0] / values[rank - 1])
        if not self.motion.precise:
            return rows[:rank].T @ ((u.T @ right)[:rank] / values[:rank]), null, len(rows) - rank, condition
        # the rows are independent wherever the input moves the loop
        gram = mp.matrix((matrix @ matrix.T).tolist())
        return (
            matrix.T @ from_mp(mp.lu_solve(gram, mp.matrix(right.tolist()))),
            null,
            len(rows) - rank,
            condition,
        )

    def _momentum(self, i: int, link: State) -> tuple[Numbers, Numbers, Any, Any]:
        """A link's centre, the rate of its momentum about it (moment, force), kinetic and potential energy."""
        frame = self.linkage.point_frames[i - 1]
        about, rate, energy, weight = link.place, np.concatenate([link.spin, link.spin]) * 0, 0, 0
        bodies: Sequence[Body] = self.loading.bodies.get(i, ())
        own = [frame[:3, :3] @ np.array(body.centre) + frame[:3, 3] for body in bodies]
        arms = [link.rotation @ (place * self.metre) for place in own]
        if bodies:
            whole = sum(body.mass for body in bodies)
            about = link.place + sum(body.mass * arm for body, arm in zip(bodies, arms, strict=True)) / whole
        w = link.spin
        for body, arm in zip(bodies, arms, strict=True):
            seen = link.shifted(arm)
            turn = link.rotation @ frame[:3, :3]
            tensor = turn @ body.tensor @ turn.T
            spun = tensor @ link.spin_rate + crossed(w, tensor @ w)
            force = body.mass * seen.acceleration
            rate = rate + np.concatenate([spun + crossed(seen.place - about, force), force])
            energy = energy + (body.mass * (seen.velocity @ seen.velocity) + w @ tensor @ w) / 2
            weight = weight - body.mass * (np.array(self.loading.gravity) @ seen.place)
        return about, rate, energy, weight

    def _acting(self, links: list[State], q: Numbers, dq: Numbers) -> Acting:
        """Weights, loads, springs and dampers."""
        joints = q * 0
        pulls: list[tuple[int, Numbers, Numbers, Numbers]] = []
        potential, power = q[0] * 0, q[0] * 0
        for i in range(1, self.motion.count):
            for body in self.loading.bodies.get(i, ()):
                place = self.motion.point(links, i, body.centre).place
                pulls.append((i, place, body.mass * np.array(self.loading.gravity), np.zeros(3)))
        for load in self.loading.loads:
            i, seen, force, torque = self._load(links, load, q)
            pulls.append((i, seen.place, force, torque))
            power = power + force @ seen.velocity + torque @ seen.spin
        for spring in self.loading.springs:
            if spring.joint is not None:
                k = self.linkage.columns.index(spring.joint)
                stretch = q[k] - spring.length
                joints[k] = joints[k] - spring.stiffness * stretch - spring.damping * dq[k]
                # of a slide, N by the length unit times a length
                unit = 1.0 if self.motion.loop.turns[k] else self.metre
                potential = potential + spring.stiffness * stretch**2 / 2 * unit
                power = power - spring.damping * dq[k] ** 2 * unit
                continue
            potential, power = self._between(links, spring, pulls, potential, power)
        return Acting(pulls, joints, potential, power)

    def _between(
        self,
        links: list[State],
        spring: Spring,
        pulls: list[tuple[int, Numbers, Numbers, Numbers]],
        potential: Any,
        power: Any,
    ) -> tuple[Any, Any]:
        assert spring.links is not None
        assert spring.at is not None
        one, other = (
            self.motion.point(links, link, at) for link, at in zip(spring.links, spring.at, strict=True)
        )
        line = other.place - one.place
        distance = length(line)
        line = line / distance
        pace = line @ (other.velocity - one.velocity) / self.metre
        stretch = distance / self.metre - spring.length
        pull = spring.stiffness * stretch + spring.damping * pace
        nothing = np.zeros(3)
        pulls.append((spring.links[0], one.place, pull * line, nothing))
        pulls.append((spring.links[1], other.place, -pull * line, nothing))
        return (
            potential + spring.stiffness * stretch**2 / 2 * self.metre,
            power - spring.damping * pace**2 * self.metre,
        )

    def _load(self, links: list[State], load: Load, q: Numbers) -> tuple[int, State, Numbers, Numbers]:
        (share,) = load.factors(
            [float(q[self.column])], turns=self.linkage.column_kinds[self.column] == "turn"
        )
        assert load.at is not None
        seen = self.motion.point(links, load.link, load.at)
        force, torque = np.array(load.force), np.array(load.torque)
        if load.axes == "link":
            turn = seen.rotation @ self.linkage.point_frames[load.link - 1][:3, :3]
            force, torque = turn @ force, turn @ torque
        return load.link, seen, float(share) * force, float(share) * torque


@dataclass(frozen=True, eq=False)
class Acting:
    """Forces at places with torques, by link; what acts in each column; the springs' energy; power of loads and dampers."""

    pulls: list[tuple[int, Numbers, Numbers, Numbers]]
    joints: Numbers
    potential: Any
    power: Any

    def on(self, link: int, about: Numbers) -> Numbers:
        """The sum on one link: moment about a place, force."""
        total = np.concatenate([about, about]) * 0
        for i, place, force, torque in self.pulls:
            if i == link:
                total = total + np.concatenate([torque + crossed(place - about, force), force])
        return total


def _levered(arm: Numbers, frame: Numbers) -> Numbers:
    """The moments of a joint's three unit forces that act `arm` away."""
    return np.stack([crossed(arm, frame[:, k]) for k in range(3)], axis=1)
