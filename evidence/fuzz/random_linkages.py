"""Random RSSR linkages, each as the product takes it and as `reference_rssr` takes it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import sevenbar as sb
from evidence.accuracy.reference_rssr import Rssr, Side


@dataclass(frozen=True)
class Dimensions:
    """The layout of Sun and Zhou: crank about z at height N, rocker about x at (M, D, 0)."""

    M: float
    N: float
    L1: float
    L3: float
    D: float
    L2: float

    def linkage(self) -> sb.Linkage:
        """As the product takes it."""
        return sb.rssr(M=self.M, N=self.N, L1=self.L1, L3=self.L3, D=self.D, L2=self.L2)

    def reference(self) -> Rssr:
        """By the paper's free positions A = (L1 cos a, L1 sin a, N), B = (M, D + L3 cos b, L3 sin b)."""
        crank = Side(np.array([0, 0, self.N]), np.array([0.0, 0, 1]), np.array([self.L1, 0, self.N]))
        rocker = Side(
            np.array([self.M, self.D, 0]), np.array([1.0, 0, 0]), np.array([self.M, self.D + self.L3, 0])
        )
        return Rssr(crank, rocker, self.L2)


@dataclass(frozen=True)
class Drawing:
    """Two axes and two balls in one assembled pose."""

    crank_at: np.ndarray
    crank_axis: np.ndarray
    ball_a: np.ndarray
    ball_b: np.ndarray
    rocker_at: np.ndarray
    rocker_axis: np.ndarray

    def joints(self) -> list[dict[str, object]]:
        """The tables of its file."""
        return [
            {"kind": "R", "at": self.crank_at, "axis": self.crank_axis, "name": "crank"},
            {"kind": "S", "at": self.ball_a, "name": "ball_a"},
            {"kind": "S", "at": self.ball_b, "name": "ball_b"},
            {"kind": "R", "at": self.rocker_at, "axis": self.rocker_axis, "name": "rocker"},
        ]

    def linkage(self) -> sb.Linkage:
        """As the product takes it."""
        return sb.from_axes(self.joints())

    def reference(self) -> Rssr:
        """Crank and rocker are turned against the ground."""
        crank = Side(self.crank_at, self.crank_axis, self.ball_a)
        rocker = Side(self.rocker_at, self.rocker_axis, self.ball_b)
        return Rssr(crank, rocker, float(np.linalg.norm(self.ball_a - self.ball_b)), drawn=True)

    def moved(self, rotation: np.ndarray, shift: np.ndarray, scale: float = 1.0) -> Drawing:
        """The same linkage in another frame and another unit of length."""
        places = [
            scale * (rotation @ p + shift) for p in (self.crank_at, self.ball_a, self.ball_b, self.rocker_at)
        ]
        crank_axis, rocker_axis = rotation @ self.crank_axis, rotation @ self.rocker_axis
        return Drawing(places[0], crank_axis, places[1], places[2], places[3], rocker_axis)


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    """Uniform over all rotations: a uniform unit quaternion."""
    w, x, y, z = (q := rng.normal(size=4)) / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def square(rng: np.random.Generator, decades: float = 1.0) -> Dimensions:
    """Lengths log-uniform over so many decades; M, N, D of either sign, each 0 once in ten."""
    m, n, d, crank, rocker, coupler = 10 ** rng.uniform(-decades / 2, decades / 2, size=6)
    m, n, d = np.where(rng.random(3) < 0.1, 0.0, rng.choice([-1, 1], size=3) * [m, n, d])
    return Dimensions(*map(float, (m, n, crank, rocker, d, coupler)))


def assembled_square(rng: np.random.Generator, decades: float = 1.0) -> Dimensions:
    """As `square`, with the coupler as long as it is in a random pose, so that the loop closes somewhere."""
    free = square(rng, decades)
    a, b = rng.uniform(-np.pi, np.pi, size=2)
    ball_a = np.array([free.L1 * np.cos(a), free.L1 * np.sin(a), free.N])
    ball_b = np.array([free.M, free.D + free.L3 * np.cos(b), free.L3 * np.sin(b)])
    return Dimensions(free.M, free.N, free.L1, free.L3, free.D, float(np.linalg.norm(ball_a - ball_b)))


def skew(rng: np.random.Generator, decades: float = 1.0) -> Drawing:
    """Axes of any direction at any distance; lengths log-uniform over so many decades."""

    def length() -> float:
        return float(10 ** rng.uniform(-decades / 2, decades / 2))

    def direction() -> np.ndarray:
        v = rng.normal(size=3)
        return v / np.linalg.norm(v)

    crank_at, crank_axis = length() * direction(), direction()
    rocker_at, rocker_axis = length() * direction(), direction()
    ball_a, ball_b = crank_at + length() * direction(), rocker_at + length() * direction()
    return Drawing(crank_at, length() * crank_axis, ball_a, ball_b, rocker_at, length() * rocker_axis)


def nearly_parallel(rng: np.random.Generator, tilt: float = 0.2) -> Drawing:
    """A planar four-bar, its axes tilted and its balls lifted a little: this holds double-cranks."""
    crank_at, rocker_at = np.zeros(3), np.array([10 ** rng.uniform(-0.8, 0.4), 0.0, rng.normal() * tilt])
    axes = [np.array([0.0, 0.0, 1.0]) + tilt * rng.normal(size=3) for _ in range(2)]
    sign = rng.choice([-1.0, 1.0])
    angles, radii = rng.uniform(-np.pi, np.pi, size=2), 10 ** rng.uniform(-0.4, 0.4, size=2)
    arms = [
        r * np.array([np.cos(t), np.sin(t), tilt * rng.normal()]) for r, t in zip(radii, angles, strict=True)
    ]
    return Drawing(crank_at, axes[0], crank_at + arms[0], rocker_at + arms[1], rocker_at, sign * axes[1])


def short_coupler(rng: np.random.Generator, share: float) -> Drawing:
    """A drawing whose coupler is `share` of the size: both circles pass almost through one point."""
    drawing = skew(rng, 0.5)
    step = rng.normal(size=3)
    ball_b = drawing.ball_a + share * step / np.linalg.norm(step)
    return Drawing(
        drawing.crank_at, drawing.crank_axis, drawing.ball_a, ball_b, drawing.rocker_at, drawing.rocker_axis
    )


def mixed(rng: np.random.Generator, count: int) -> Iterator[Dimensions | Drawing]:
    """Axes of all kinds in turn; one in ten of extreme proportions, one in twenty with a tiny coupler."""
    kinds = (assembled_square, skew, nearly_parallel)
    for index in range(count):
        if index % 10 == 9:
            yield (assembled_square, skew)[index // 10 % 2](rng, 4.0)
        elif index % 20 == 4:
            yield short_coupler(rng, 10 ** rng.uniform(-6, -2))
        else:
            yield kinds[index % 3](rng)
