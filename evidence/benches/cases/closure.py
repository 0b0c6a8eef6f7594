"""The closure of a loop of seven turning joints in NumPy: residual, Jacobian, Newton's method, a search.

It shares nothing with Sevenbar but the transforms `Gk` of the links, of `Z(q1) G1 .. Z(q7) G7 = 1`, and
judges the answers of all programs alike.
"""

from __future__ import annotations

import numpy as np

#: Closure error (radians, lengths relative to the size) of a pose that closes.
CLOSED = 1e-9

#: Greatest difference [rad] in any joint of two names of one mode, both polished.
SAME = 1e-6

#: Sine of a turn below which it is its own sine, up to rounding.
SMALL = 1e-9

#: Damping relative to the squared error, and what keeps a singular matrix solvable.
DAMPING, ROUNDING = 0.01, 1e-15

#: Longest step [rad] of a search in any joint; far from a pose longer ones lead nowhere.
LONGEST = 2.0

#: Steps of a search; from near a pose a handful would do.
STEPS = 30


class Closure:
    """The closure of one loop, `links` (7, 4, 4) its transforms; poses are arrays (n, 7) [rad]."""

    def __init__(self, links: np.ndarray) -> None:
        self.links = links
        self.size = float(np.linalg.norm(links[:, :3, 3], axis=1).max()) or 1.0

    def frames(self, q: np.ndarray) -> np.ndarray:
        """The frames before each joint and after the last link, (n, 8, 4, 4)."""
        out = np.empty((len(q), 8, 4, 4))
        out[:, 0] = np.eye(4)
        turn = np.zeros((len(q), 4, 4))
        turn[:, 2, 2] = turn[:, 3, 3] = 1.0
        for k in range(7):
            c, s = np.cos(q[:, k]), np.sin(q[:, k])
            turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1] = c, -s, s, c
            out[:, k + 1] = out[:, k] @ turn @ self.links[k]
        return out

    def residual(self, frames: np.ndarray) -> np.ndarray:
        """The turn that is left over [rad] about x, y, z, and the place relative to the size, (n, 6)."""
        end = frames[:, 7]
        skew = 0.5 * np.stack(
            [end[:, 2, 1] - end[:, 1, 2], end[:, 0, 2] - end[:, 2, 0], end[:, 1, 0] - end[:, 0, 1]], axis=1
        )
        sine, cosine = np.linalg.norm(skew, axis=1), 0.5 * (np.trace(end[:, :3, :3], axis1=1, axis2=2) - 1)
        factor = np.where(sine > SMALL, np.arctan2(sine, cosine) / np.maximum(sine, SMALL), 1.0)
        turn = skew * factor[:, None]
        # a half turn has no skew part to tell its axis
        turn[(sine < SMALL) & (cosine < 0)] = np.pi
        return np.concatenate([turn, end[:, :3, 3] / self.size], axis=1)

    def error(self, q: np.ndarray) -> np.ndarray:
        """The greatest part of the residual, (n,)."""
        error: np.ndarray = np.abs(self.residual(self.frames(q))).max(axis=1, initial=0.0)
        return error

    def jacobian(self, frames: np.ndarray) -> np.ndarray:
        """How the last frame turns and moves with each joint, (n, 6, 7), lengths relative to the size."""
        axis, apart = frames[:, :7, :3, 2], frames[:, 7:, :3, 3] - frames[:, :7, :3, 3]
        return np.concatenate([axis, np.cross(axis, apart) / self.size], axis=2).swapaxes(1, 2)

    def polished(self, q: np.ndarray, steps: int = 4) -> np.ndarray:
        """Newton's method, damped, with the first joint held."""
        q = np.array(q, dtype=np.float64)
        for _ in range(steps):
            frames = self.frames(q)
            jacobian, residual = self.jacobian(frames)[:, :, 1:], self.residual(frames)
            back = jacobian.swapaxes(1, 2)
            # damped by the error itself: downhill from far, Newton's method near by
            damping = DAMPING * (residual * residual).sum(axis=1) + ROUNDING
            square = back @ jacobian + damping[:, None, None] * np.eye(6)
            step = np.linalg.solve(square, back @ residual[:, :, None])[:, :, 0]
            length = np.abs(step).max(axis=1, keepdims=True)
            q[:, 1:] -= step * np.minimum(1.0, LONGEST / np.maximum(length, LONGEST))
        return q

    def searched(self, theta: float, starts: int, seed: int) -> np.ndarray:
        """Poses (m, 7) that Newton's method reaches from random starts, first joint at `theta` [rad]."""
        q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (starts, 7))
        q[:, 0] = theta
        q = self.polished(q, STEPS)
        return different(q[self.error(q) < CLOSED])


def apart(q: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The greatest difference [rad] in any joint of poses (n, 7) from each of others (m, 7), (n, m)."""
    turn = (q[:, None] - other[None] + np.pi) % (2 * np.pi) - np.pi
    difference: np.ndarray = np.abs(turn).max(axis=2, initial=0.0)
    return difference


def moved(q: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The greatest difference [rad] in any joint of poses (n, 7) from as many others, one by one, (n,)."""
    turn = (q - other + np.pi) % (2 * np.pi) - np.pi
    difference: np.ndarray = np.abs(turn).max(axis=1, initial=0.0)
    return difference


def different(q: np.ndarray) -> np.ndarray:
    """Poses (n, 7) without those that are another name of an earlier one."""
    kept = q[:0]
    for pose in q:
        if not len(kept) or apart(pose[None], kept).min() > SAME:
            kept = np.concatenate([kept, pose[None]])
    return kept
