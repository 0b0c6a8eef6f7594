"""Any single loop worked out a second time, sharing no formula with the core.

Source: the definition of a linkage alone: the product `Z(q1) G1 Z(q2) G2 .. Z(qn) Gn` is the identity, where Z
is a turn about z (R), a slide along z (P), both coupled (H) or free (C), two turns (U) or three (S). From that
one sentence follows, in NumPy, a search for closed poses: Levenberg-Marquardt's method from many random starts, many
loops side by side. It proves nothing complete, but each pose it finds is there, and a solver must not have missed it.
Derivatives in many digits are in `precise_loops`.

Poses are compared by where the links stand, not by joint values: three turns of a ball have two names.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

#: Random starts of a search, how many steps each has, and after how many the arrived ones are set aside.
STARTS = 2000
STEPS = 28
CLEARED = 4

#: Damping in parts of the squared error, and the longest step [rad, or parts of the size]: what finds most poses a second.
DAMPING = 0.01
LONGEST = 2.0

#: Starts that are worked on side by side: as many as a core's cache holds.
SIDE_BY_SIDE = 4096

#: The closure error (radians, lengths in parts of the size) below which a start has arrived, and that of a pose
#: once polished.
ARRIVED = 1e-8
CLOSED = 1e-11

#: Greatest difference of rotation matrices and of places in parts of the size between two names of one pose.
SAME = 1e-6

#: Least singular value of the loop's Jacobian, input held, of a pose that counts: below, the pose is singular or nearly, lies
#: beside another one, and no method need tell the two apart.
ISOLATED = 1e-4

#: A step of Newton's method so short [rad, or relative to the size] that the next one would be rounding.
ARRIVED = 1e-12

#: Singular value below which a direction is free: far above roundings, far below what holds a pose.
FREE = 1e-6

#: More different poses than a loop has: they belong to a continuum.
MANY = 200


class Jointed(Protocol):
    """A joint of a linkage: kind, pitch [length per turn], angle between the axes of U [rad].

    `backwards`: in its own frame a joint E turns first, then slides.
    """

    @property
    def kind(self) -> str: ...
    @property
    def pitch(self) -> float: ...
    @property
    def angle(self) -> float: ...
    @property
    def backwards(self) -> bool: ...


class Looped(Protocol):
    """What is read of a linkage: its joints and its fixed transforms."""

    @property
    def joints(self) -> Sequence[Jointed]: ...
    @property
    def base(self) -> np.ndarray: ...
    @property
    def ground(self) -> np.ndarray: ...
    @property
    def links(self) -> np.ndarray: ...
    @property
    def point_frames(self) -> np.ndarray: ...


def turn(axis: int, angle: float) -> np.ndarray:
    """A homogeneous turn about x, y or z."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(4)
    matrix[one, one] = matrix[other, other] = np.cos(angle)
    matrix[other, one] = np.sin(angle)
    matrix[one, other] = -matrix[other, one]
    return matrix


def shift(x: float, y: float, z: float) -> np.ndarray:
    """A homogeneous translation."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Of a rigid motion."""
    result = np.eye(4)
    result[:3, :3] = matrix[:3, :3].T
    result[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
    return result


#: Turns that carry z to y and to x; y and x are turned about exactly, so that no digit is lost in the middle of a ball.
_Z_TO_Y = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
_Z_TO_X = np.array([[0.0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])


@dataclass(frozen=True, eq=False)
class Loop:
    """`E(q1) F1 E(q2) F2 .. E(qm) Fm = 1` in one-freedom joints, each about or along its own z.

    `turns` and `slides` (m,) tell how far E turns [rad] and slides [length] for one unit of q; `fixed` (m, 4, 4) are
    the F's; `ends` for each joint of the description the number of its last freedom, `backs` the rotation (joints, 3, 3)
    from the frame after that freedom, whose z is its axis, to the frame of the link; `base` the frame of the first.
    """

    turns: np.ndarray
    slides: np.ndarray
    fixed: np.ndarray
    ends: tuple[int, ...]
    backs: np.ndarray
    base: np.ndarray
    point_frames: np.ndarray

    @staticmethod
    def of(linkage: Looped) -> Loop:
        """From the joints and the fixed transforms of a linkage."""
        closing = inverse(np.asarray(linkage.ground)) @ linkage.base
        turns, slides, fixed, ends, backs = [], [], [], [], []
        fronts: dict[int, np.ndarray] = {}
        for joint, after in zip(linkage.joints, [*linkage.links, closing], strict=True):
            between: list[np.ndarray] = []
            front = back = np.eye(4)
            match joint.kind:
                case "R":
                    rates = [(1.0, 0.0)]
                case "P":
                    rates = [(0.0, 1.0)]
                case "H":
                    rates = [(1.0, joint.pitch / (2 * np.pi))]
                case "C":
                    rates, between = [(1.0, 0.0), (0.0, 1.0)], [np.eye(4)]
                case "U":
                    rates, between = [(1.0, 0.0)] * 2, [turn(0, joint.angle)]
                case "E" if joint.backwards:
                    rates = [(1.0, 0.0), (0.0, 1.0), (0.0, 1.0)]
                    between, back = [_Z_TO_X, _Z_TO_X.T @ _Z_TO_Y], _Z_TO_Y.T
                case "E":
                    rates = [(0.0, 1.0), (0.0, 1.0), (1.0, 0.0)]
                    front, between = _Z_TO_X, [_Z_TO_X.T @ _Z_TO_Y, _Z_TO_Y.T]
                case "K":
                    rates, front, between = [(0.0, 1.0), (1.0, 0.0)], _Z_TO_Y, [_Z_TO_Y.T]
                case "L":
                    rates, between, back = [(1.0, 0.0), (0.0, 1.0)], [_Z_TO_Y], _Z_TO_Y.T
                case "S":
                    rates, between = [(1.0, 0.0)] * 3, [_Z_TO_Y, _Z_TO_Y.T @ _Z_TO_X]
                    back = _Z_TO_X.T
                case kind:
                    raise ValueError(f"no joint {kind}")
            fronts[len(turns) - 1] = front
            turns += [rate[0] for rate in rates]
            slides += [rate[1] for rate in rates]
            fixed += [*between, back @ after]
            ends.append(len(turns) - 1)
            backs.append(back[:3, :3])
        # the frame of a joint's first freedom, seen from the transform before it; of the first joint from the last one
        for number, front in fronts.items():
            fixed[number] = fixed[number] @ front
        return Loop(
            turns=np.array(turns),
            slides=np.array(slides),
            fixed=np.array(fixed, dtype=np.float64),
            ends=tuple(ends),
            backs=np.array(backs),
            base=np.asarray(linkage.base @ fronts[-1], dtype=np.float64),
            point_frames=np.asarray(linkage.point_frames, dtype=np.float64),
        )

    @property
    def count(self) -> int:
        """How many one-freedom joints."""
        return len(self.turns)

    @cached_property
    def periodic(self) -> np.ndarray:
        """Which joint values (m,) come round after a turn: neither slides nor screws."""
        return (self.turns != 0) & (self.slides == 0)

    @cached_property
    def size(self) -> float:
        """The longest link, or 1 where all axes meet in one point."""
        longest = float(np.linalg.norm(self.fixed[:, :3, 3], axis=1).max())
        return max(longest, float(np.abs(self.slides * (self.turns != 0)).max())) or 1.0

    @cached_property
    def scales(self) -> np.ndarray:
        """The unit of each joint value: 1 for a turn, the size for a slide."""
        return np.where(self.turns != 0, 1.0, self.size)

    def walk(self, q: np.ndarray) -> Walk:
        """Along the loop at joint values (n, m)."""
        return _walk(
            self.turns, self.slides, self.fixed[:, :3, :, None] * np.ones(1), np.ascontiguousarray(q.T)
        )

    def errors(self, q: np.ndarray) -> np.ndarray:
        """How far the product is from the identity at (n, m), greatest entry, lengths in parts of the size."""
        walk = self.walk(np.atleast_2d(q))
        rotation = np.abs(walk.rotation - np.eye(3)[:, :, None]).max(axis=(0, 1))
        return np.maximum(rotation, np.abs(walk.place).max(axis=0) / self.size)

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """(n, 6, m): turning over moving, the latter in parts of the size, by joint values in their units."""
        return self._jacobian_of(self.walk(np.atleast_2d(q)))

    def _jacobian_of(self, walk: Walk) -> np.ndarray:
        columns = np.moveaxis(walk.jacobian(self.turns, self.slides), -1, 0).copy()
        columns[:, 3:] /= self.size
        return columns * self.scales

    def poses(self, q: np.ndarray) -> np.ndarray:
        """Where the moving links stand in the report frame, (n, links, 3, 4), lengths in parts of the size."""
        q = np.atleast_2d(q)
        frames = np.moveaxis(self.walk(q).frames, -1, 0)
        poses = self.base[:3, :3] @ frames[:, list(self.ends[:-1])]
        poses[..., :3] = poses[..., :3] @ self.backs[:-1]
        poses[..., 3] += self.base[:3, 3]
        poses[..., 3] /= self.size
        return poses

    def free(self, column: int) -> np.ndarray:
        """All columns but the input's."""
        return np.delete(np.arange(self.count), column)

    def stiffness(self, q: np.ndarray, column: int) -> np.ndarray:
        """Singular values of the Jacobian, input held, falling, (n, m - 1)."""
        held = self.jacobian(q)[:, :, self.free(column)]
        values = np.zeros((len(held), held.shape[2]))
        found = np.linalg.svd(held, compute_uv=False)
        values[:, : found.shape[1]] = found
        return values

    def idle(self, q: np.ndarray, column: int) -> tuple[int, np.ndarray, np.ndarray]:
        """What the closed pose (m,) leaves free with the input held.

        The number of free directions; which columns (m,) and which moving links (links,) they move.
        """
        free = self.free(column)
        held = self.jacobian(q)[0][:, free]
        _, values, rows = np.linalg.svd(held, full_matrices=True)
        values = np.concatenate([values, np.zeros(len(free) - len(values))])
        null = rows[values < FREE]
        columns = np.zeros(self.count, bool)
        columns[free] = np.abs(null).max(axis=0, initial=0.0) > SAME
        moved = np.zeros(len(self.ends) - 1, bool)
        for direction in null:
            step = np.zeros(self.count)
            step[free] = direction * self.scales[free] * 1e-4
            apart = np.abs(self.poses(q + step) - self.poses(q - step))[0]
            # near a ball's quarter turn most of a free direction is two turns that undo each other
            moved |= apart.max(axis=(1, 2)) > 1e-9
        return len(null), columns, moved

    def span(self, q: np.ndarray, column: int, step: float = 0.01, most: int = 20_000) -> float:
        """How far the input runs on the circuit through a closed pose (m,), in its unit; infinite if it does not return."""
        start, held = q / self.scales, column
        here, low, high = start.copy(), start[held], start[held]
        along = np.zeros(self.count)
        along[held] = 1.0
        for number in range(most):
            _, values, rows = np.linalg.svd(self.jacobian(here * self.scales)[0], full_matrices=True)
            null = rows[np.concatenate([values, np.zeros(self.count - len(values))]) < FREE]
            # of several directions the one that goes on as before, so that idle freedoms rest
            following = null.T @ (null @ along)
            along = following / np.linalg.norm(following)
            guess = here + step * along
            for _ in range(8):
                residual = self.walk((guess * self.scales)[None]).residual(self.size)[:, 0]
                guess = guess - np.linalg.pinv(self.jacobian(guess * self.scales)[0], rcond=1e-9) @ residual
            here, low, high = guess, min(low, guess[held]), max(high, guess[held])
            apart = here - start
            apart[self.periodic] -= 2 * np.pi * np.round(apart[self.periodic] / (2 * np.pi))
            if number > 3 and np.linalg.norm(apart) < step:
                return float((high - low) * self.scales[held])
        return np.inf

    def polished(self, q: np.ndarray, column: int, steps: int = 6) -> np.ndarray:
        """Newton's method in double precision from (n, m), the input held; at most so many steps."""
        q = np.array(np.atleast_2d(q), dtype=np.float64)
        free = self.free(column)
        for _ in range(steps):
            walk = self.walk(q)
            residual = walk.residual(self.size).T
            held = self._jacobian_of(walk)[:, :, free]
            step = np.linalg.pinv(held, rcond=1e-8) @ residual[:, :, None]
            length = np.abs(step).max(axis=1, keepdims=True)
            step *= np.minimum(1.0, 0.3 / np.maximum(length, 1e-300))
            q[:, free] -= step[:, :, 0] * self.scales[free]
            if not length.max(initial=0.0) > ARRIVED:
                break
        return q


@dataclass(frozen=True, eq=False)
class Walk:
    """A loop walked once round at n sets of joint values, starts last in every array.

    `axis` and `at` (m, 3, n) of each joint; `frames` (m, 3, 4, n) after each; `rotation` (3, 3, n) and `place` (3, n)
    of the whole product, which is the identity where the loop closes.
    """

    axis: np.ndarray
    at: np.ndarray
    frames: np.ndarray
    rotation: np.ndarray
    place: np.ndarray

    def residual(self, size: float | np.ndarray) -> np.ndarray:
        """(6, n): the rotation vector of the product over its place in parts of the size."""
        r = self.rotation
        skew = np.stack([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
        twice_sine = np.sqrt((skew * skew).sum(axis=0))
        angle = np.arctan2(twice_sine, r[0, 0] + r[1, 1] + r[2, 2] - 1)
        factor = np.where(twice_sine > 1e-9, angle / np.maximum(twice_sine, 1e-9), 0.5)
        return np.concatenate([factor * skew, self.place / size])

    def jacobian(self, turns: np.ndarray, slides: np.ndarray) -> np.ndarray:
        """(6, m, n): how the product turns, and how its place moves."""
        arm = self.place - self.at
        columns = np.empty((6, *self.axis.shape[::2]))
        for k, (z, a) in enumerate(zip(self.axis, arm, strict=True)):
            columns[:3, k] = turns[k] * z
            columns[3, k] = turns[k] * (z[1] * a[2] - z[2] * a[1]) + slides[k] * z[0]
            columns[4, k] = turns[k] * (z[2] * a[0] - z[0] * a[2]) + slides[k] * z[1]
            columns[5, k] = turns[k] * (z[0] * a[1] - z[1] * a[0]) + slides[k] * z[2]
        return columns


def _walk(turns: np.ndarray, slides: np.ndarray, fixed: np.ndarray, q: np.ndarray) -> Walk:
    """`fixed` (m, 3, 4, n or 1), `q` (m, n)."""
    m, n = q.shape
    axes, places = np.empty((m, 3, n)), np.empty((m, 3, n))
    frames = np.empty((m, 3, 4, n))
    x, y, z = (np.repeat(np.eye(3)[k][:, None], n, axis=1) for k in range(3))
    place = np.zeros((3, n))
    for k in range(m):
        axes[k], places[k] = z, place
        if turns[k]:
            angle = turns[k] * q[k]
            c, s = np.cos(angle), np.sin(angle)
            x, y = c * x + s * y, c * y - s * x
        if slides[k]:
            place = place + (slides[k] * q[k]) * z
        frames[k, :, 0], frames[k, :, 1], frames[k, :, 2], frames[k, :, 3] = x, y, z, place
        f = fixed[k]
        place = place + x * f[0, 3] + y * f[1, 3] + z * f[2, 3]
        x, y, z = (x * f[0, j] + y * f[1, j] + z * f[2, j] for j in range(3))
    return Walk(axes, places, frames, np.stack([x, y, z], axis=1), place)


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Of positive definite (m, m, n) and (m, n) by Cholesky's method, all n side by side; spoils its arguments."""
    m = len(right)
    for j in range(m):
        matrix[j, j] = np.sqrt(np.maximum(matrix[j, j], 1e-300))
        matrix[j + 1 :, j] /= matrix[j, j]
        right[j] /= matrix[j, j]
        for k in range(j + 1, m):
            matrix[k:, k] -= matrix[k:, j] * matrix[k, j]
        right[j + 1 :] -= matrix[j + 1 :, j] * right[j]
    for j in range(m - 1, -1, -1):
        right[j] /= matrix[j, j]
        right[:j] -= matrix[j, :j] * right[j]
    return right


def _arrivals(
    loops: Sequence[Loop], thetas: np.ndarray, column: int, starts: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Joint values (n, m) at which starts arrived, and the number of the loop (n,); loops alike in their joints."""
    rng = np.random.default_rng(seed)
    first = loops[0]
    free, turns, slides = first.free(column), first.turns, first.slides
    scales = np.array([loop.scales for loop in loops]).T
    sizes = np.array([loop.size for loop in loops])
    fixed = np.moveaxis(np.array([loop.fixed[:, :3] for loop in loops]), 0, -1)
    number = np.repeat(np.arange(len(loops)), starts)
    q = rng.uniform(-np.pi, np.pi, (first.count, number.size))
    far = (turns == 0)[:, None] & np.ones((1, number.size), bool)
    # slides have no end: most starts near, some far
    q = np.where(far, 0.6 * rng.standard_t(3, size=q.shape) * scales[:, number], q)
    q[column] = thetas[number]
    arrived_q, arrived_number = [], []
    m = len(free)
    for step in range(STEPS + 1):
        if step % CLEARED == 0 or step == STEPS:
            f = np.ascontiguousarray(fixed[..., number])
            residual = _walk(turns, slides, f, q).residual(sizes[number])
            there = (residual * residual).sum(axis=0) < ARRIVED**2
            arrived_q.append(q[:, there].T)
            arrived_number.append(number[there])
            q, number, f = q[:, ~there], number[~there], f[..., ~there]
            size, scale = sizes[number], scales[:, number]
            if number.size == 0:
                break
        walk = _walk(turns, slides, f, q)
        residual = walk.residual(size)
        square = (residual * residual).sum(axis=0)
        jacobian = walk.jacobian(turns, slides)[:, free]
        jacobian[3:] /= size
        jacobian *= scale[free]
        matrix = np.empty((m, m, number.size))
        right = np.empty((m, number.size))
        for a in range(m):
            for b in range(a + 1):
                matrix[a, b] = (jacobian[:, a] * jacobian[:, b]).sum(axis=0)
            # damped by the error itself: far away downhill, close by Newton's method with its quadratic convergence
            matrix[a, a] += DAMPING * square + 1e-13
            right[a] = (jacobian[:, a] * residual).sum(axis=0)
        change = _solved(matrix, right)
        length = np.sqrt((change * change).sum(axis=0))
        change *= np.minimum(1.0, LONGEST / np.maximum(length, 1e-300))
        q[free] -= change * scale[free]
    return np.concatenate(arrived_q), np.concatenate(arrived_number)


def _kinds_first(places: np.ndarray) -> list[int]:
    """The first of each kind among (n, ...) places that differ by more than `SAME`; at most `MANY`."""
    left = np.arange(len(places))
    firsts: list[int] = []
    while left.size and len(firsts) < MANY:
        firsts.append(int(left[0]))
        apart = np.abs(places[left] - places[left[0]]).reshape(left.size, -1).max(axis=1)
        left = left[apart > SAME]
    return firsts


@dataclass(frozen=True, eq=False)
class Found:
    """Closed poses of a loop at one input: joint values (n, m), and what was found out of each.

    `places` (n, links, 3, 4) of the links that are not idle; `stiffness` (n,) the least singular value that holds them.
    `idle` (m,) tells the columns that are left free in every pose, `idle_links` the moving links.
    """

    q: np.ndarray
    places: np.ndarray
    stiffness: np.ndarray
    idle: np.ndarray
    idle_links: np.ndarray

    @property
    def isolated(self) -> np.ndarray:
        """Which poses stand alone, as assembly modes do."""
        return self.stiffness > ISOLATED


def _sorted_out(loop: Loop, column: int, q: np.ndarray) -> Found:
    """The different poses among closed ones."""
    # two names of a pose are told apart only after polishing; there are many starts, so first a coarse sieve
    whole = loop.poses(q)
    coarse = _kinds_first(np.round(whole / (100 * SAME)) * 100 * SAME) if len(q) else []
    q = loop.polished(q[coarse], column)
    q = q[loop.errors(q) < CLOSED] if len(q) else q
    if len(q) == 0:
        links = len(loop.ends) - 1
        return Found(
            q, np.empty((0, links, 3, 4)), np.empty(0), np.zeros(loop.count, bool), np.zeros(links, bool)
        )
    values = loop.stiffness(q, column)
    free = (values < ISOLATED).sum(axis=1)
    count, idle, idle_links = loop.idle(q[int(np.argmin(free))], column)
    places = loop.poses(q)[:, ~idle_links]
    firsts = _kinds_first(places) if places.shape[1] else [0]
    stiffness = values[:, len(values[0]) - count - 1] if count < len(values[0]) else np.zeros(len(q))
    return Found(q[firsts], places[firsts], stiffness[firsts], idle, idle_links)


def closed_poses(
    loops: Sequence[Loop],
    thetas: Sequence[float],
    column: int = 0,
    *,
    starts: int = STARTS,
    seed: int = 0,
    workers: int = 2,
) -> list[Found]:
    """What a search from many random starts finds for each loop with its input held; the loops have the same joints."""
    together = max(1, SIDE_BY_SIDE // starts)
    parts = max(1, starts // SIDE_BY_SIDE)
    tasks = [(i, k) for i in range(0, len(loops), together) for k in range(parts)]
    inputs = np.asarray(thetas, dtype=np.float64)

    def work(task: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
        i, k = task
        chosen = slice(i, i + together)
        found, number = _arrivals(loops[chosen], inputs[chosen], column, starts // parts, seed + 1000 * i + k)
        return found, number + i

    def finish(index: int) -> Found:
        return _sorted_out(loops[index], column, arrived[index])

    with ThreadPoolExecutor(workers) as pool:
        gathered: dict[int, list[np.ndarray]] = defaultdict(list)
        for q, number in pool.map(work, tasks):
            for index in np.unique(number):
                gathered[int(index)].append(q[number == index])
        arrived = [
            np.concatenate(gathered[i]) if i in gathered else np.empty((0, loops[0].count))
            for i in range(len(loops))
        ]
        return list(pool.map(finish, range(len(loops))))


def searched(
    loops: Sequence[Loop], thetas: Sequence[float], *, starts: int = STARTS, seed: int = 0
) -> list[Found]:
    """`closed_poses` of loops of any joints with their first joints held, those alike side by side."""
    alike: dict[tuple[tuple[float, ...], tuple[int, ...]], list[int]] = defaultdict(list)
    for index, loop in enumerate(loops):
        # a screw's own slide goes with the loop, so each screw is a kind of its own
        alike[tuple(zip(loop.turns, loop.slides, strict=True)), loop.ends].append(index)
    found: dict[int, Found] = {}
    for indices in alike.values():
        group = closed_poses(
            [loops[i] for i in indices], [thetas[i] for i in indices], starts=starts, seed=seed
        )
        found.update(zip(indices, group, strict=True))
    return [found[i] for i in range(len(loops))]


def nearest(loop: Loop, places: np.ndarray, q: np.ndarray, idle_links: np.ndarray) -> np.ndarray:
    """How far (n,) each of the places (n, links, 3, 4) is from the nearest of the poses q (k, m)."""
    if len(places) == 0 or len(q) == 0:
        return np.full(len(places), np.inf)
    given = loop.poses(q)[:, ~idle_links].reshape(len(q), -1)
    return np.abs(places.reshape(len(places), 1, -1) - given).max(axis=2).min(axis=1)


def missed(loop: Loop, found: Found, modes: np.ndarray) -> np.ndarray:
    """Isolated closed poses (k, m) of a search that are not among the modes (n, m)."""
    apart = nearest(loop, found.places, modes, found.idle_links)
    return found.q[(apart > 10 * SAME) & found.isolated]


def missing(
    linkage: Looped, modes: np.ndarray, theta: float, *, column: int = 0, starts: int = STARTS, seed: int = 0
) -> np.ndarray:
    """Isolated closed poses (k, m) at an input that the modes (n, m) of a linkage lack."""
    loop = Loop.of(linkage)
    (found,) = closed_poses([loop], [theta], column, starts=starts, seed=seed)
    return missed(loop, found, modes)


def doubles(loop: Loop, modes: np.ndarray, column: int = 0) -> int:
    """How many isolated modes (n, m) are the same pose as an earlier one."""
    if len(modes) == 0:
        return 0
    values = loop.stiffness(modes, column)
    count, _, idle_links = loop.idle(modes[int(np.argmin((values < ISOLATED).sum(axis=1)))], column)
    kept = values[:, values.shape[1] - count - 1] > ISOLATED
    places = loop.poses(modes[kept])[:, ~idle_links]
    return int(kept.sum()) - len(_kinds_first(places)) if places.shape[1] else 0
