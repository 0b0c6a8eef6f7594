"""A loop of seven turning joints, input held, as solvers of robot arms know it: six joints that reach a pose.

`Z(q1) G1 Z(q2) .. Z(q7) G7 = 1` is `Z(q2) G2 .. Z(q7) = target` with `target = (Z(q1) G1)^-1 G7^-1`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

#: Sine of the angle between axes that are parallel, up to rounding.
PARALLEL = 1e-9

#: Distance relative to the arm's size of lines that meet, up to rounding.
MEETS = 1e-9


@dataclass(frozen=True, eq=False)
class Arm:
    """The six joints 2 to 7 of a loop: `links` (7, 4, 4) its transforms."""

    links: np.ndarray

    @cached_property
    def zero(self) -> np.ndarray:
        """The frames of the six joints where all angles are zero, (6, 4, 4)."""
        frames = [np.eye(4)]
        for link in self.links[1:6]:
            frames.append(frames[-1] @ link)
        return np.array(frames)

    @cached_property
    def size(self) -> float:
        """The longest distance of two joints [length]."""
        return float(np.linalg.norm(np.diff(self.zero[:, :3, 3], axis=0), axis=1).max()) or 1.0

    @cached_property
    def _ends(self) -> tuple[np.ndarray, np.ndarray]:
        """The links before and after the arm, back: `G1^-1` and `G7^-1`."""
        return np.linalg.inv(self.links[0]), np.linalg.inv(self.links[6])

    @cached_property
    def _untwisted(self) -> np.ndarray:
        """Takes the tool's own turn at zero away, (4, 4)."""
        turn = np.eye(4)
        turn[:3, :3] = self.zero[5, :3, :3].T
        untwisted: np.ndarray = self._ends[1] @ turn
        return untwisted

    def target(self, theta: float) -> np.ndarray:
        """Where the frame of joint 7, turned, has to be with the input at `theta` [rad], (4, 4)."""
        target: np.ndarray = self._ends[0] @ _turned_back(theta) @ self._ends[1]
        return target

    def screwed(self, theta: float) -> np.ndarray:
        """The target of the product of exponentials, whose tool has no turn of its own at zero, (4, 4)."""
        target: np.ndarray = self._ends[0] @ _turned_back(theta) @ self._untwisted
        return target

    @cached_property
    def axes(self) -> np.ndarray:
        """Directions of the axes at zero, (6, 3)."""
        return self.zero[:, :3, 2].copy()

    @cached_property
    def places(self) -> np.ndarray:
        """A point of each axis at zero, (6, 3): where it meets its neighbour, else its frame's."""
        places = self.zero[:, :3, 3].copy()
        for k in range(5):
            meeting = self._meeting(k)
            if meeting is not None:
                places[k] = places[k + 1] = meeting
        return places

    @cached_property
    def offsets(self) -> np.ndarray:
        """From the base to joint 2, from each joint's point to the next one's, to the tool, (7, 3)."""
        points = np.concatenate([np.zeros((1, 3)), self.places, self.zero[5:, :3, 3]])
        return np.diff(points, axis=0)

    def _meeting(self, k: int) -> np.ndarray | None:
        """The point where axes k and k + 1 meet; none where they are parallel or pass each other."""
        z, w = self.axes[k], self.axes[k + 1]
        normal = np.cross(z, w)
        if np.linalg.norm(normal) < PARALLEL:
            return None
        p, q = self.zero[k, :3, 3], self.zero[k + 1, :3, 3]
        along, back, distance = np.linalg.solve(np.stack([z, -w, normal], axis=1), q - p)
        if abs(distance) * np.linalg.norm(normal) > MEETS * self.size:
            return None
        meeting: np.ndarray = 0.5 * (p + along * z + q + back * w)
        return meeting

    def parallel(self, first: int, last: int) -> bool:
        """Whether the axes first .. last, counted from 0, are parallel."""
        return all(
            np.linalg.norm(np.cross(self.axes[first], self.axes[k])) < PARALLEL
            for k in range(first + 1, last + 1)
        )

    def meet(self, first: int, last: int) -> bool:
        """Whether the axes first .. last, counted from 0, meet in one point."""
        at = [self._meeting(k) for k in range(first, last)]
        return all(point is not None and np.linalg.norm(point - at[0]) < MEETS * self.size for point in at)

    @cached_property
    def rows(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Standard Denavit-Hartenberg rows: lengths, twists, offsets, zeros of the angles, each (6,).

        Each link is `Rz(b) Tz(c) Tx(a) Rx(alpha) Tz(d) Rz(e)`, both ends of which go to the joints beside it;
        the last row has neither length nor twist.
        """
        length, twist, offset, zero = np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6)
        for k, link in enumerate(self.links[1:6]):
            b, c, a, alpha, d, e = normal_form(link)
            zero[k] += b
            offset[k] += c
            length[k], twist[k] = a, alpha
            offset[k + 1] += d
            zero[k + 1] += e
        return length, twist, offset, zero


def _turned_back(theta: float) -> np.ndarray:
    """`Z(-theta)`, (4, 4)."""
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, s, 0, 0], [-s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def normal_form(link: np.ndarray) -> tuple[float, float, float, float, float, float]:
    """b, c, a, alpha, d, e of `Rz(b) Tz(c) Tx(a) Rx(alpha) Tz(d) Rz(e)`, which any transform (4, 4) is."""
    place, z, w = link[:3, 3], np.array([0.0, 0.0, 1.0]), link[:3, 2]
    normal = np.cross(z, w)
    if np.linalg.norm(normal) > PARALLEL:
        x = normal / np.linalg.norm(normal)
        c, a, d = np.linalg.solve(np.stack([z, x, w], axis=1), place)
    else:
        across = place * [1.0, 1.0, 0.0]
        a = float(np.linalg.norm(across))
        x = across / a if a > 0 else link[:3, 0] * [1.0, 1.0, 0.0]
        c, d = place[2], 0.0
    alpha = np.arctan2(np.cross(z, w) @ x, z @ w)
    e = np.arctan2(np.cross(x, link[:3, 0]) @ w, x @ link[:3, 0])
    b = np.arctan2(x[1], x[0])
    return float(b), float(c), float(a), float(alpha), float(d), float(e)
