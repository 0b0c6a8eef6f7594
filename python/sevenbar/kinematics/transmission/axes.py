"""The axes of a loop's joints along a circuit, and how they move where its input rests.

In a pose the rates q' of all joints, as it goes along the circuit, and their second derivatives keep the loop
closed: with the screws S of the joints about one origin, each moved by the twist V of the link before it,

    sum q'_i S_i = 0,    sum q''_i S_i = -sum q'_i [V_i, S_i],    V_i = sum_(j < i) q'_j S_j               (1)

A ball is three turns about its centre. Where input and output rest together, one moves with the other
as their second derivatives do.

Source: docs/theory_measures.md, (11).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import frames_on, poses_along
from sevenbar.kinematics.loop.geometry import Loop, moved_by
from sevenbar.kinematics.solvers.general import Steps, steps_of

#: The complex step: its square is nothing next to 1.
COMPLEX_STEP = 1e-30

#: Singular values below this part of the greatest are zero: rank is lost up to rounding of the pose.
NO_RANK = 1e-9

#: A joint rests that moves by less of all joints' motion [rad, or relative to the size].
STILL = 1e-6


@dataclass(frozen=True, eq=False)
class Axes:
    """The joints of one freedom, screws and balls, as `parts` has them, with their axes on n rows.

    `directions` and `places` (parts, n, 3); a ball has no direction that means anything.
    """

    parts: Steps
    directions: Floats
    places: Floats

    def velocity(self, part: int, at: Floats) -> Floats:
        """How places (n, 3) move with one of the joints, for each radian or length unit of it, (n, 3)."""
        direction: Floats = self.directions[part]
        if self.parts.letters[part] == "P":
            return direction
        turned = np.cross(direction, at - self.places[part])
        return np.asarray(turned + self.parts.advances[part] * direction)

    def at(self, row: int) -> Axes:
        """Those of one row."""
        return replace(
            self, directions=self.directions[:, row : row + 1], places=self.places[:, row : row + 1]
        )

    def moving(self, size: float) -> Axes | None:
        """A pose's axes of a single loop a complex step along the circuit.

        `None` where no one direction leads on.
        """
        screws, owners = self._screws(size)
        rates = _tangent(screws)
        if rates is None:
            return None
        twists = _twists(screws, rates)
        first = [owners.index(part) for part in range(len(self.parts.letters))]
        turn, shift = twists[first, :3], size * twists[first, 3:]
        arms = self.places[:, 0] - self._origin
        return replace(
            self,
            directions=self.directions + 1j * COMPLEX_STEP * np.cross(turn, self.directions[:, 0])[:, None],
            places=self.places + 1j * COMPLEX_STEP * (shift + np.cross(turn, arms))[:, None],
        )

    def ratio(self, input: int, output: int, size: float) -> float | None:
        """d(output)/d(input) of parts that rest together in a pose; `None` where they do not."""
        screws, owners = self._screws(size)
        rates = _tangent(screws)
        columns = [owners.index(input), owners.index(output)]
        if rates is None or np.abs(rates[columns]).max() > STILL:
            return None
        turn, shift = np.split(screws, 2, axis=1)
        by_turn, by_shift = np.split(_twists(screws, rates), 2, axis=1)
        brackets = np.concatenate(
            [np.cross(by_turn, turn), np.cross(by_turn, shift) + np.cross(by_shift, turn)], axis=1
        )
        second = np.linalg.lstsq(screws.T, -(rates @ brackets), rcond=NO_RANK)[0]
        if not abs(second[columns[0]]) > STILL * np.abs(second).max():
            return None
        bend_in, bend_out = (
            second[column] * (size if self.parts.letters[part] == "P" else 1.0)
            for column, part in zip(columns, (input, output), strict=True)
        )
        return float(bend_out / bend_in)

    @property
    def _origin(self) -> Floats:
        return np.asarray(self.places[:, 0].mean(axis=0))

    def _screws(self, size: float) -> tuple[Floats, list[int]]:
        """The screws (m, 6) of a pose's joints in order, lengths by the size, and the part of each."""
        result, owners = [], []
        for part, letter in enumerate(self.parts.letters):
            arm = (self.places[part, 0] - self._origin) / size
            for direction in np.eye(3) if letter == "S" else [self.directions[part, 0]]:
                moment = np.cross(arm, direction) + self.parts.advances[part] / size * direction
                still = np.zeros(3)
                result.append(np.concatenate([still, direction] if letter == "P" else [direction, moment]))
                owners.append(part)
        return np.array(result), owners


def _tangent(screws: Floats) -> Floats | None:
    """The rates (m,) of joints that keep a loop closed; `None` where there are more than one way, or none."""
    _, sizes, ways = np.linalg.svd(screws.T)
    rank = int((sizes > NO_RANK * sizes[0]).sum())
    return np.asarray(ways[-1]) if len(screws) - rank == 1 else None


def _twists(screws: Floats, rates: Floats) -> Floats:
    """The twist (m, 6) of the link before each joint."""
    moved = rates[:, None] * screws
    return np.asarray(np.cumsum(moved, axis=0) - moved)


def axes_along(loop: Loop, circuit: Circuit, rows: Integers | None = None) -> Axes:
    """The axes of the joints on all rows of a circuit, or on some; NaN where it has no pose."""
    rows = np.arange(len(circuit.time)) if rows is None else rows
    before = frames_on(loop, poses_along(loop, circuit, rows), 0)
    directions, places = [], []
    for i, (joint, own) in enumerate(zip(loop.joints, loop.places, strict=True)):
        now = before[:, i]
        steps = joint.steps(circuit.q[rows, own])
        whole = joint.row.is_screw or joint.row.is_ball
        for number, (step, _) in enumerate(steps[:1] if whole else steps):
            now = now @ moved_by(*steps[number - 1]) if number else now
            now = now @ joint.before(step) if step.tilted else now
            directions.append(now[:, :3, step.axis])
            places.append(now[:, :3, 3])
    return Axes(steps_of(loop), np.stack(directions), np.stack(places))


def ratios_at_rest(loop: Solvable, circuit: Circuit) -> dict[int, float]:
    """d(output)/d(input) on the rows of dead centres of the input where the output rests, too."""
    rows = np.flatnonzero((circuit.status == "dead-centre") & np.isfinite(circuit.q).all(axis=1))
    first, second = circuit.input_column, circuit.output_column
    if loop.net is not None:
        result = {int(row): loop._net_ratio_at_rest(circuit.q[row], first, second) for row in rows}
    else:
        parts = steps_of(loop)
        ends = [parts.columns.index(column) for column in (first, second)]
        axes = axes_along(loop, circuit, rows)
        result = {int(row): axes.at(i).ratio(ends[0], ends[1], circuit.size) for i, row in enumerate(rows)}
    return {row: ratio for row, ratio in result.items() if ratio is not None}


def best_row(circuit: Circuit) -> int | None:
    """The row of a circuit with the best condition, from which it is followed anew; `None` without one."""
    sound = np.isfinite(circuit.q).all(axis=1) & (circuit.status == "ok") & np.isfinite(circuit.condition)
    rows = np.flatnonzero(sound)
    return int(rows[np.argmin(circuit.condition[rows])]) if rows.size else None
