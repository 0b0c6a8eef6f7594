"""The forces of a circuit by the transpose of its rates: what acts goes to the core, reactions come back.

    A^T W = Q - c                                                                                         (4)

The core (`crates/sevenbar-core/src/loops/forces`) counts lengths relative to the size, so forces in
kg size/s^2; here they become newtons.

Source: docs/theory_forces.md, (1) to (6).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Booleans, Floats, Integers, Words, truth
from sevenbar.errors import RequestError
from sevenbar.forces.acting import Load, Spring, Three
from sevenbar.forces.bodies import Body
from sevenbar.forces.heard import without_rounding
from sevenbar.forces.loading import Loading
from sevenbar.forces.result import OPEN, Forces, Reaction
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.driven import driven
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.dynamics.link_bodies import as_moved, resolved
from sevenbar.kinematics.loop.rigid import half_turn, inverse, placed
from sevenbar.kinematics.numbers.sensitivity import NumberedLoop, Numbers
from sevenbar.text.units import LENGTHS

#: How numbers move a place: which steps, and the twists.
Moves = list[tuple[int, list[float]]]

#: A place as the core takes it: the steps before it, where it is among them, and how numbers move it.
Placed = tuple[int, Floats, Moves]

#: Bodies that move by less than this part of the size for a radian stand still.
STILL = 1e-9


class CoreForces(NamedTuple):
    """What the core finds on n rows with j joints, in kg, s and the size as the length.

    `torque` (n,) is that of the input, or its force; `spin` (n, idle) what holds each idle freedom;
    `energies` (n, 3) are kinetic and potential energy and the power of loads and dampers. `wrenches` (n, j,
    6) are in the frames of the joints, which `seats` (n, j, 12) are: axes, then place. `shaking` (n, 6) is
    about the report origin, `free` (n, redundant, 6) the wrenches that nothing determines, about the origin.
    Wrenches have the moment first. Last the derivatives by the numbers, of none where they are not wanted.
    """

    torque: Floats
    spin: Floats
    energies: Floats
    wrenches: Floats
    seats: Floats
    shaking: Floats
    free: Floats
    torque_by: Floats
    wrenches_by: Floats
    shaking_by: Floats


@dataclass(frozen=True, eq=False)
class ForceSolver:
    """A loop with what acts on it, ready for rows of any circuit of it that this column drives."""

    linkage: Solvable
    loading: Loading
    input: int
    #: Whether derivatives by the description's numbers are wanted.
    by_numbers: bool = False
    _frames: dict[int, Floats] = field(default_factory=dict, repr=False)

    @cached_property
    def numbers(self) -> Numbers:
        """The loop by its numbers."""
        return Numbers(self.linkage)

    @cached_property
    def loop(self) -> NumberedLoop:
        """The loop that this input drives."""
        return self.numbers.loop(self.input) if self.by_numbers else self.numbers.driven(self.input)

    @cached_property
    def size(self) -> float:
        """The length in which the core counts [m]."""
        return self.numbers.size * LENGTHS[self.linkage.length_unit]

    @cached_property
    def bodies(self) -> dict[int, Body]:
        """The bodies of the links, one each; where a link spins idly, as balls without friction move them."""
        return as_moved(self.linkage, resolved(self.loading, self.linkage))

    @property
    def inertia(self) -> float:
        """That of all bodies at a distance of the size [kg m^2]."""
        return sum(body.mass for body in self.bodies.values()) * self.size**2

    def _frame(self, link: int) -> Floats:
        """The frame (4, 4) in which points of a link are written, against the steps before it."""
        if link not in self._frames:
            _, product = self.numbers.word.carrier(int(link))
            self._frames[link] = product.pose(self.numbers.values(self.loop.p))
        return self._frames[link]

    def _place(self, link: int, at: Three) -> Placed:
        steps, product = self.numbers.word.carrier(int(link))
        place = placed(self._frame(link), at) / self.numbers.size
        return steps, place, self.loop.core.twists(product) if self.by_numbers else []

    def _body(self, link: int, body: Body) -> tuple[int, float, Floats, Floats, Moves]:
        assert body.centre is not None
        steps, centre, moves = self._place(link, body.centre)
        axes = self._frame(link)[:3, :3]
        return steps, body.mass, centre, axes @ body.tensor @ axes.T / self.size**2, moves

    def _load(self, load: Load) -> tuple[Placed, Floats, Floats, bool]:
        assert load.at is not None
        force, torque = np.array(load.force) / self.size, np.array(load.torque) / self.size**2
        turns = load.axes == "link"
        if turns:
            axes = self._frame(load.link)[:3, :3]
            force, torque = axes @ force, axes @ torque
        return self._place(load.link, load.at), force, torque, turns

    def _joint_spring(self, spring: Spring) -> tuple[int, Floats]:
        assert spring.joint is not None
        linkage = self.linkage
        column = linkage.column(spring.joint, "joint")
        # of stiffness and damping, and of the value at which the spring is slack
        factor, slack_factor = 1 / self.size**2, 1.0
        if not linkage.turns(column):
            factor, slack_factor = 1 / LENGTHS[linkage.length_unit], 1 / self.numbers.size
        numbers = [factor * spring.stiffness, slack_factor * spring.length, factor * spring.damping]
        return column, np.array(numbers)

    @cached_property
    def acting(self) -> _core.Acting:
        """What acts, as the core takes it."""
        metre = LENGTHS[self.linkage.length_unit]
        springs = []
        for spring in self.loading.springs:
            if spring.links is None:
                continue
            assert spring.at is not None
            ends = [self._place(link, at) for link, at in zip(spring.links, spring.at, strict=True)]
            numbers = [spring.stiffness / metre, spring.length / self.numbers.size, spring.damping / metre]
            springs.append((ends[0], ends[1], np.array(numbers)))
        return _core.Acting(
            np.array(self.loading.gravity) / self.size,
            [self._body(link, body) for link, body in self.bodies.items()],
            [self._load(load) for load in self.loading.loads],
            springs,
            [self._joint_spring(spring) for spring in self.loading.springs if spring.links is None],
        )

    @cached_property
    def seats(self) -> tuple[list[int], Floats]:
        """Where each joint's reaction is counted: before which step of the word, and its frame there."""
        word, values = self.numbers.word, self.numbers.values(self.loop.p)
        linkage = self.linkage
        steps, frames = [], []
        step = 0
        for i, (joint, inside) in enumerate(zip(linkage.joints, word.inner, strict=True)):
            frame = inverse(inside[0].pose(values)) if inside else np.eye(4)
            if joint.value and not joint.backwards:
                # the joint is where it is drawn, whatever value it has there
                frame = joint.to_drawn @ frame
            if joint.backwards and linkage.form == "drawn":
                # its axes are those of the drawing
                frame = frame @ half_turn(joint.row.half_turn)
            frame[:3, 3] /= self.numbers.size
            frames.append(frame)
            steps.append(step)
            step += len(word.freedoms[i])
        return steps, np.array(frames)

    def solved(
        self,
        inputs: Floats,
        poses: Floats,
        speeds: Floats,
        *,
        by: int | None = None,
        factors: Floats | None = None,
    ) -> CoreForces:
        """What the core finds at closed poses (n, columns) of the word, with speeds of the input (n, 2).

        Loads go by the values `inputs` (n,) of the column `by`, the input if it is not given, or act by
        `factors` (n, loads).
        """
        scales = self.numbers.scales
        if factors is None:
            turns = self.linkage.turns(self.input if by is None else by)
            by_load = [load.factors(inputs, turns=turns) for load in self.loading.loads]
            factors = np.reshape(by_load, (-1, len(inputs))).T
        steps, frames = self.seats
        result = _core.reactions(
            self.loop.core,
            self.acting,
            poses / scales,
            speeds / scales[self.input],
            factors,
            steps,
            frames,
            self.by_numbers,
        )
        return CoreForces(*result)


@dataclass(frozen=True, eq=False)
class PosedRows:
    """Rows (n,) of a circuit with the poses (n, columns) of the word; NaN where there are no rates.

    `rates` (n, 2) are speed and acceleration of the input.
    """

    input: Floats
    time: Floats
    status: Words
    branch: Integers
    poses: Floats
    rates: Floats


def forces_of(solver: ForceSolver, circuit: Circuit, *, at_rest: bool = False) -> Forces:
    """The forces on the rows of a circuit; see `Circuit.forces`."""
    poses = _poses(solver, circuit)
    poses[np.isin(circuit.status, ("dead-centre", "change-point", "no-solution"))] = np.nan
    rates = np.stack([rate[:, circuit.input_column] for rate in (circuit.dq, circuit.ddq)], axis=1)
    rows = PosedRows(circuit.input, circuit.time, circuit.status, circuit.branch, poses, rates)
    return replace(
        forces_on(solver, circuit, rows, at_rest=at_rest),
        periodic=circuit.goes_round and not np.isnan(circuit.speed) and not winds_up(circuit, solver.loading),
        through_change_points=circuit.motion_type == "change-point",
        between=partial(_between, solver, circuit, at_rest),
    )


def forces_on(solver: ForceSolver, circuit: Circuit, rows: PosedRows, *, at_rest: bool = False) -> Forces:
    """The forces on rows of a circuit, which are no cycle."""
    linkage, loading = solver.linkage, solver.loading
    if loading.is_empty:
        raise RequestError(
            "forces: nothing has a mass and nothing acts; give bodies, loads or springs, or write [[body]]"
        )
    at_rest = truth("at_rest", at_rest)
    # rows without rates stay without
    speeds = np.where(np.isfinite(rows.rates), 0.0, np.nan) if at_rest else rows.rates
    result = solver.solved(rows.input, rows.poses, speeds)
    torque, wrenches, shaking = result.torque, result.wrenches, result.shaking
    size, metre = solver.size, LENGTHS[linkage.length_unit]
    energies = result.energies * size**2
    if nothing_pulls(solver, speeds, energies[:, 0], shaking[:, 3:] * size):
        # not the rounding of a linkage that takes nothing; rows without values keep none
        torque, wrenches, shaking = 0.0 * torque, 0.0 * wrenches, 0.0 * shaking
    slides = not linkage.turns(circuit.input_column)
    pull, inertia = acting_forces(solver, energies, shaking[:, 3:] * size)
    torque = without_rounding(torque[:, None], pull / size)[:, 0] * (size if slides else size**2)
    wrenches = without_rounding(wrenches, pull / size)
    shaking = without_rounding(shaking, inertia / size)
    speed = speeds[:, 0]
    reactions = _reactions(solver, wrenches, result.seats, result.free)
    return Forces(
        input=rows.input,
        time=rows.time,
        speed=speed,
        status=rows.status,
        branch=rows.branch,
        torque=torque,
        power=torque * speed * (metre if slides else 1.0),
        kinetic=energies[:, 0],
        potential=energies[:, 1],
        supplied=energies[:, 2],
        shaking=shaking * np.repeat([size**2, size], 3),
        reactions=reactions,
        spin=_spins(solver, result.spin * size**2, reactions),
        indeterminate=linkage.mobility().redundant if result.free.shape[1] else (),
        slides=slides,
        length_unit=linkage.length_unit,
        periodic=False,
        loading=loading,
        bodies=solver.bodies,
        driver=linkage.columns[circuit.input_column],
        heading=linkage.heading,
        at_rest=at_rest,
        pull=pull * (1.0 if slides else size),
    )


def acting_forces(solver: ForceSolver, energies: Floats, shaking: Floats) -> tuple[float, float]:
    """How large the forces are [N] that act on the links, of all kinds and of inertia; torques by the size.

    From energies (n, 3) [J, and W] and the shaking force (n, 3) [N].
    """
    loading, size = solver.loading, solver.size
    sizes = np.where(np.isfinite(energies), np.abs(energies), 0.0)
    kinetic, potential = sizes[:, :2].max(axis=0, initial=0.0)
    shaken = np.abs(shaking[np.isfinite(shaking)]).max(initial=0.0)
    inertia = float(2 * kinetic / size + shaken)
    weight = sum(body.mass for body in solver.bodies.values()) * float(np.linalg.norm(loading.gravity))
    loads = [np.linalg.norm(load.force) + np.linalg.norm(load.torque) / size for load in loading.loads]
    springs = float(potential) / size if loading.springs else 0.0
    return float(weight + sum(loads) + springs) + inertia, inertia


def nothing_pulls(solver: ForceSolver, speeds: Floats, kinetic: Floats, shaking: Floats) -> bool:
    """Whether all that acts is the inertia of bodies, which stand still while others move.

    From speeds and accelerations of the input (n, 2), kinetic energy (n,) [J] and shaking force (n, 3) [N].
    """
    loading = solver.loading
    if any(loading.gravity) or loading.loads or loading.springs:
        return False
    rates = speeds / solver.numbers.scales[solver.input]
    squared = float(np.nanmax(rates[:, 0] ** 2 + np.abs(rates[:, 1]), initial=0.0))
    moves = float(np.nanmax(kinetic, initial=0.0)) > STILL**2 * solver.inertia * squared
    pulls = float(np.nanmax(np.abs(shaking), initial=0.0)) > STILL * solver.inertia / solver.size * squared
    return not (moves or pulls)


def _poses(solver: ForceSolver, circuit: Circuit) -> Floats:
    """The rows (n, columns) of a circuit as poses of the word.

    Where a ball's turns are undefined the pose is found anew, from the nearest row that has them all.
    """
    poses = solver.numbers.poses(circuit.q)
    undefined = np.flatnonzero(circuit.status == "turns-undefined")
    known = np.flatnonzero(np.isfinite(poses).all(axis=1))
    if len(undefined) and len(known):
        near = known[np.abs(undefined[:, None] - known).argmin(axis=1)]
        poses[undefined] = solver.loop.closed(circuit.input[undefined], poses[near])
    return poses


def _between(solver: ForceSolver, circuit: Circuit, at_rest: bool, inputs: Floats) -> Forces:
    """The forces of a circuit that goes round, at any inputs (n,)."""
    return forces_of(solver, driven(solver.linkage, circuit, inputs, speed=circuit.speed), at_rest=at_rest)


def winds_up(circuit: Circuit, loading: Loading) -> bool:
    """Whether a spring in a joint has more to give with every turn of the joint."""
    columns = [circuit.columns.index(s.joint) for s in loading.springs if s.joint and s.stiffness]
    # rows end one step before the first comes again
    gained = len(circuit.q) / max(len(circuit.q) - 1, 1) * (circuit.q[-1] - circuit.q[0])
    return bool(np.any(np.abs(gained[columns]) > np.pi))


def _reactions(solver: ForceSolver, wrenches: Floats, seats: Floats, free: Floats) -> dict[str, Reaction]:
    """Each joint's reaction; components that the free wrenches (n, redundant, 6) leave open are NaN."""
    size, result = solver.size, {}
    for i, joint in enumerate(solver.linkage.joints):
        axes, place = seats[:, i, :9].reshape(-1, 3, 3), seats[:, i, 9:]
        wrench = wrenches[:, i] * size
        known, determinate = _known(_in_seat(axes, place, free))
        result[joint.name] = Reaction(
            joint=joint.name,
            kind=joint.kind,
            force=np.where(determinate[3:], wrench[:, 3:], np.nan),
            moment=np.where(determinate[:3], wrench[:, :3] * size, np.nan),
            at=place * solver.numbers.size,
            axes=axes,
            determinate=determinate,
            known=known,
            known_values=np.einsum("nkj,nj->nk", known, wrench) if free.shape[1] else wrench,
            size=size,
        )
    return result


def _in_seat(axes: Floats, place: Floats, wrenches: Floats) -> Floats:
    """Wrenches (n, k, 6) about the origin, about a place (n, 3) and along axes (n, 3, 3) there."""
    if not wrenches.shape[1]:
        return wrenches
    force = wrenches[:, :, 3:]
    moment = wrenches[:, :, :3] - np.cross(place[:, None], force)
    return np.concatenate([moment @ axes, force @ axes], axis=2)


def _known(free: Floats) -> tuple[Floats, Booleans]:
    """What free wrenches (n, k, 6) leave known: orthonormal combinations (n, 6 - k, 6), components (6,)."""
    rows, count, _ = free.shape
    if not count:
        return np.broadcast_to(np.eye(6), (rows, 6, 6)), np.ones(6, dtype=bool)
    full = np.isfinite(free).all(axis=(1, 2))
    known = np.full((rows, 6 - count, 6), np.nan)
    determinate = np.ones(6, dtype=bool)
    if full.any():
        _, _, right = np.linalg.svd(free[full], full_matrices=True)
        known[full] = right[:, count:]
        determinate = np.linalg.norm(right[:, :count], axis=1).max(axis=0) < OPEN
    return known, determinate


def _spins(solver: ForceSolver, spin: Floats, reactions: Mapping[str, Reaction]) -> dict[str, Floats]:
    """The size of the moment (n,) [N m] in each ball that the rule of an idle spin needs, by its link.

    The ball is held to two axes, so its moment is square to both; what the core has is its part about the
    third axis of the word.
    """
    linkage = solver.linkage
    result = {}
    for ball in sorted(linkage.held.balls):
        column = linkage.places[ball].stop - 1
        reaction = reactions[linkage.joints[ball].name]
        if column not in solver.numbers.held:
            continue
        about_axis = np.abs(spin[:, solver.numbers.held.index(column)])
        name = "coupler" if linkage.kind == "RSSR" else f"link {linkage.graph.moving_link(ball)}"
        known = bool(reaction.determinate[:3].all())
        result[name] = np.linalg.norm(reaction.moment, axis=1) if known else about_axis
    return result
