"""All poses at one value of the input, and the one that is meant, as rows of a motion by a law."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.circuits.one_pose import OnePose
from sevenbar.kinematics.loop.law import Law

#: Poses nearer than this [rad, or relative to the size] are one: a mode at a dead centre is known to the root
#: of rounding.
SAME_POSE = 1e-5

#: Poses farther than this from a given one [rad, or relative to the size] are not what it means.
NEAR_POSE = 1e-2

#: How far the inputs next to a pose are [rad, or relative to the size], from which forces begin where a ball
#: has no turns in the pose itself.
NEXT = 1e-2


@dataclass(frozen=True, eq=False)
class PosesAt:
    """All poses of all circuits at one value of the input, as rows of a motion by a law.

    The law has the input, and inputs next to it, on each turn of the circuits; after these, on each turn, the
    input `known`, where one is given.
    """

    linkage: Solvable
    motion: Motion
    speed: float
    acceleration: float
    turns: int
    poses: tuple[OnePose, ...]

    @classmethod
    def of(
        cls,
        linkage: Solvable,
        value: float,
        *,
        input: str | None = None,
        output: str | None = None,
        speed: float | None = None,
        acceleration: float = 0.0,
        known: float | None = None,
    ) -> PosesAt:
        """Those at a value of the input, which has there this `speed`, the linkage's own by default."""
        column, _ = linkage.end_columns(input, output)
        rate = linkage.speed_of(column) if speed is None else speed
        step = NEXT * (1.0 if linkage.turns(column) else linkage.size) * np.arange(-1.0, 2.0)
        turns = 1
        while True:
            laps = math.tau * np.arange(turns)[:, None]
            inputs = (value + laps + step).ravel()
            if known is not None:
                inputs = np.append(inputs, known + laps)
            law = Law.of(np.arange(float(len(inputs))), inputs, rate, acceleration)
            motion = linkage.motion(input=input, output=output, law=law)
            most = max((circuit.turns for circuit in motion), default=0)
            if most <= turns:
                break
            # a circuit that closes after several turns has a pose on each
            turns = most
        result = []
        for circuit in motion:
            for row in range(len(circuit.q)):
                lap, place = divmod(row % len(inputs), len(step))
                is_pose = lap < max(circuit.turns, 1) and place == 1
                if is_pose and circuit.status[row] != "no-solution":
                    result.append(_pose(linkage, motion, circuit, row, rate, acceleration))
        return cls(linkage, motion, rate, acceleration, turns, tuple(result))

    def nearest(self, q: Floats, *, within: float = SAME_POSE) -> OnePose | None:
        """The pose nearest to joint values (columns,), `within` [rad, or relative to the size]; or `None`."""
        if not self.poses:
            return None
        far = apart(self.linkage, np.array([pose.q for pose in self.poses]), q)
        k = int(far.argmin())
        return self.poses[k] if far[k] <= within else None

    def along(self, q: Floats) -> tuple[OnePose, ...]:
        """The poses on the circuit, and on its turn, that has joint values (columns,) at the known input."""
        count, best = (3 + 1) * self.turns, (math.inf, 0, 0)
        for circuit in self.motion:
            for lap in range(max(circuit.turns, 1)):
                rows = circuit.q[3 * self.turns + lap :: count]
                here = np.isfinite(rows[:, circuit.input_column])
                if here.any():
                    far = float(apart(self.linkage, rows[here], q).min())
                    best = min(best, (far, circuit.index, lap))
        _, index, lap = best
        return tuple(pose for pose in self.poses if pose.circuit == index and pose._row % count // 3 == lap)


def apart(linkage: Solvable, q: Floats, other: Floats) -> Floats:
    """How far poses (n, columns) are from one (columns,) [rad, or relative to the size], (n,).

    Turns of balls without a direction are left out.
    """
    off = np.where(linkage.turning, np.abs(short_way(q - other)), np.abs(q - other) / linkage.size)
    return np.asarray(np.where(np.isfinite(off), off, 0.0).max(axis=-1))


def _pose(
    linkage: Solvable, motion: Motion, circuit: Circuit, row: int, speed: float, acceleration: float
) -> OnePose:
    q = circuit.q[row].copy()
    # in (-pi, pi], as modes are
    q[linkage.turning] = -short_way(-q[linkage.turning])
    return OnePose(
        columns=circuit.columns,
        input=motion.input,
        output=motion.output,
        speed=speed,
        acceleration=acceleration,
        circuit=circuit.index,
        branch=int(circuit.branch[row]),
        status=str(circuit.status[row]),
        q=q,
        dq=circuit.dq[row],
        ddq=circuit.ddq[row],
        dddq=circuit.dddq[row],
        residual=float(circuit.residual[row]),
        idle=linkage.idle,
        _linkage=linkage,
        _rows=circuit,
        _row=row,
    )


def pose_near(
    linkage: Solvable, q: Floats, *, input: str | None, speed: float | None, acceleration: float
) -> OnePose:
    """The pose of a linkage that joint values (columns,) mean; raises `RequestError` where there is none."""
    value = float(q[linkage.input_column(input)])
    result = PosesAt.of(linkage, value, input=input, speed=speed, acceleration=acceleration)
    pose = result.nearest(q, within=NEAR_POSE)
    if pose is None:
        raise RequestError(
            f"pose: no circuit has it, of {len(result.poses)} poses at this {result.motion.input}; "
            "give a row of assembly_modes() or of a circuit"
        )
    return pose


def pose_of(
    linkage: Solvable,
    circuit: Circuit,
    value: float,
    known: int,
    *,
    branch: int | None,
    speed: float | None,
    acceleration: float,
) -> OnePose:
    """The pose of a circuit at a value of the input, by its row `known`; see `Circuit.at`."""
    names = circuit.columns
    own = None if math.isnan(circuit.speed) else circuit.speed
    result = PosesAt.of(
        linkage, value,
        input=names[circuit.input_column], output=names[circuit.output_column],
        speed=own if speed is None else speed, acceleration=acceleration,
        known=float(circuit.q[known, circuit.input_column]),
    )  # fmt: skip
    poses = result.along(circuit.q[known])
    if not poses:
        raise RequestError(f"at: circuit {circuit.index} has no pose there{_where(circuit)}")
    passes = [pose.branch for pose in poses]
    if branch is None and len(poses) == 1:
        return poses[0]
    # an array is equal to no pass, and to each in every place
    if not isinstance(branch, (int, np.integer)) or branch not in passes:
        which = "is missing" if branch is None else f"{shown(branch)} is no pass with this pose"
        raise RequestError(
            f"branch: {which}; circuit {circuit.index} is there on {len(poses)} of its passes between dead "
            f"centres of {result.motion.input}; give {' or '.join(map(str, passes))}"
        )
    return poses[passes.index(branch)]


def _where(circuit: Circuit) -> str:
    """Where a circuit has poses, for a message."""
    if circuit.input_range is None:
        return ""
    turn = 180 / math.pi if circuit.input_turns else 1.0
    low, high = (f"{turn * end:.6g}" for end in circuit.input_range)
    unit = " deg" * circuit.input_turns
    return f"; it goes from {circuit.columns[circuit.input_column]} = {low}{unit} to {high}{unit}"
