"""Free motion of a closed chain of hinges by Newton-Euler, multipliers and an integrator of its own.

It shares nothing with the core. Bodies hang on each other from a fixed hinge on, with relative angles q; the
last hinge to the ground is held by equations phi = 0 on its place and axis. With the bodies' Jacobians J,

    sum J^T (inertia of q'') = sum J^T (weights - inertia of q' alone) + phi_q^T lambda,   phi_q q'' = gamma

is solved by least squares, so redundant equations do no harm, integrated by DOP853 at a tolerance of 1e-13,
and brought back to phi = 0 after each short stretch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Floats = npt.NDArray[np.float64]

#: Relative tolerance of the integrator, and how often the loop is closed again [s].
TOLERANCE = 1e-13
STRETCH = 0.05

#: Singular values below this part of the greatest are those of redundant equations.
REDUNDANT = 1e-9


@dataclass(frozen=True)
class HingedChain:
    """Hinges in one drawn pose: places and axes (n, 3), and the bodies between: mass, centre, inertia."""

    places: Floats
    axes: Floats
    masses: Sequence[float]
    centres: Floats
    inertias: Floats
    gravity: Floats

    def walk(self, q: Floats, rate: Floats) -> list[tuple[Floats, Floats, Floats, Floats]]:
        """Of each body: its turn, where its first hinge is, its angular velocity, the hinge's axis."""
        turn, place, spin = np.eye(3), self.places[0], np.zeros(3)
        found = []
        for i in range(len(self.masses)):
            axis = turn @ self.axes[i]
            if i:
                place = place + turn @ (self.places[i] - self.places[i - 1])
            turn = Rotation.from_rotvec(axis * q[i]).as_matrix() @ turn
            spin = spin + axis * rate[i]
            found.append((turn, place, spin, axis))
        return found

    def accelerations(self, q: Floats, rate: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """The angles' second derivatives, phi, phi_q and phi_q q'."""
        count = len(self.masses)
        walk = self.walk(q, rate)
        mass, force = np.zeros((count, count)), np.zeros(count)
        bias_turn = np.zeros(3)
        bias, speed = np.zeros(3), np.zeros(3)
        last_place, last_spin = walk[0][1], np.zeros(3)
        for i, (turn, place, spin, axis) in enumerate(walk):
            arm = place - last_place
            bias = bias + np.cross(bias_turn, arm) + np.cross(last_spin, np.cross(last_spin, arm))
            speed = speed + np.cross(last_spin, arm)
            # the hinge's axis turns with the body before it
            bias_turn = bias_turn + np.cross(last_spin, axis * rate[i])
            last_place, last_spin = place, spin
            c = turn @ (self.centres[i] - self.places[i])
            inertia = turn @ self.inertias[i] @ turn.T
            angular = np.array([walk[k][3] if k <= i else np.zeros(3) for k in range(count)]).T
            linear = np.array(
                [
                    np.cross(walk[k][3], place + c - walk[k][1]) if k <= i else np.zeros(3)
                    for k in range(count)
                ]
            ).T
            own = bias + np.cross(bias_turn, c) + np.cross(spin, np.cross(spin, c))
            mass += self.masses[i] * linear.T @ linear + angular.T @ inertia @ angular
            force += linear.T @ (self.masses[i] * (self.gravity - own))
            force -= angular.T @ (inertia @ bias_turn + np.cross(spin, inertia @ spin))
        turn, place, spin, _ = walk[-1]
        c = turn @ (self.places[-1] - self.places[count - 1])
        end = place + c
        axis = turn @ self.axes[-1]
        own = bias + np.cross(bias_turn, c) + np.cross(spin, np.cross(spin, c))
        linear = np.array([np.cross(walk[k][3], end - walk[k][1]) for k in range(count)]).T
        angular = np.array([walk[k][3] for k in range(count)]).T
        turned = np.array([np.cross(angular[:, k], axis) for k in range(count)]).T
        across = np.linalg.svd(self.axes[-1][None])[2][1:]
        slopes = np.concatenate([linear, across @ turned])
        change = np.cross(bias_turn, axis) + np.cross(spin, np.cross(spin, axis))
        phi = np.concatenate([end - self.places[-1], across @ axis])
        system = np.block([[mass, slopes.T], [slopes, np.zeros((len(phi), len(phi)))]])
        right = np.concatenate([force, -own, -across @ change])
        found = np.linalg.lstsq(system, right, rcond=REDUNDANT)[0]
        return found[:count], phi, slopes, slopes @ rate

    def closed(self, q: Floats, rate: Floats) -> tuple[Floats, Floats]:
        """The nearest state that closes the loop."""
        for _ in range(4):
            _, phi, slopes, _ = self.accelerations(q, rate)
            q = q - np.linalg.pinv(slopes, rcond=REDUNDANT) @ phi
        _, _, slopes, open_rate = self.accelerations(q, rate)
        return q, rate - np.linalg.pinv(slopes, rcond=REDUNDANT) @ open_rate

    def states(self, q: Floats, rate: Floats, times: Sequence[float]) -> Floats:
        """Angles and rates (times, 2, n) from a state at time 0."""

        def push(t: float, y: Floats) -> Any:  # noqa: ARG001
            own, speed = np.split(y, 2)
            return np.concatenate([speed, self.accelerations(own, speed)[0]])

        state, now, found = self.closed(q, rate), 0.0, []
        for aim in times:
            parts = max(1, round((aim - now) / STRETCH))
            step = (aim - now) / parts
            for _ in range(parts if aim > now else 0):
                solved = solve_ivp(
                    push, (0, step), np.concatenate(state), method="DOP853", rtol=TOLERANCE, atol=TOLERANCE
                )
                state = self.closed(*np.split(solved.y[:, -1], 2))
            now = aim
            found.append(np.stack(state))
        return np.stack(found)
