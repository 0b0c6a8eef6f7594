"""What forces are measured by: peak and RMS torque, power, bearing loads, shaking; exact derivatives.

A peak of y(x, p) over the input x changes with a number p as y does at that place (the envelope theorem), and
the mean of y^2 over a whole cycle by the mean of 2 y dy/dp. The core has dy/dp for every dimension. Torque
and reactions are linear in each mass, so their derivative by it is what that body alone needs for a kilogram.

Source: docs/theory_forces.md, (8) and (9).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, no_joint
from sevenbar.forces.loading import Loading
from sevenbar.forces.shaking import shaking_along
from sevenbar.forces.sizing import Sizing
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.dynamics.forces import ForceSolver
from sevenbar.kinematics.numbers.gradients import MeasureSlopes, poses_at
from sevenbar.kinematics.numbers.sensitivity import Numbers

#: A pose found is the peak's own where it gives its value to this share of it.
SAME_VALUE = 1e-6


def sized(circuit: Circuit, joints: Sequence[str] = ()) -> Sizing | None:
    """The sizing of a circuit's torque, with the bearings of these joints only.

    `None` for a circuit that rocks: its measures are of constant speed.
    """
    found = circuit.forces()
    for name in joints:
        if name not in found.reactions:
            raise RequestError(f"measure: {no_joint(name, list(found.reactions))}")
    if not circuit.goes_round:
        return None
    return replace(found, reactions={name: found.reactions[name] for name in joints}).sizing()


def peak_shaking(circuit: Circuit) -> float | None:
    """The greatest shaking force [N], between the rows, too; `None` where a row has none, or it rocks."""
    forces = circuit.forces()
    found = shaking_along(forces) if circuit.goes_round else None
    return None if found is None else found.force.value


@dataclass(frozen=True, eq=False)
class _Slopes:
    """Torque (n,) and reactions (n, joints, 6) at poses, with derivatives (n, k) and (n, k, joints, 6)."""

    torque: Floats
    torque_by: Floats
    forces: Floats
    forces_by: Floats


def force_slopes(numbers: Numbers, circuit: Circuit, speed: float) -> Iterator[MeasureSlopes]:
    """Peak and RMS torque and the peak force of each joint, by the description's numbers.

    Nothing where nothing acts, or the circuit does not go round at constant speed.
    """
    loading = numbers.linkage.loading
    if loading.is_empty or not circuit.goes_round:
        return
    solver = ForceSolver(numbers.linkage, loading, circuit.input_column, by_numbers=True)

    def slopes(inputs: Floats, q: Floats) -> _Slopes:
        return _by_dimensions(solver, inputs, q, speed)

    yield from _measured(solver, circuit, slopes)


def mass_slopes(numbers: Numbers, circuit: Circuit, speed: float) -> Iterator[MeasureSlopes]:
    """The same by the mass of each link's body [kg], by their numbers rising; inertia grows along with it."""
    linkage = numbers.linkage
    if not any(linkage.loading.bodies.values()) or not circuit.goes_round:
        return
    solver = ForceSolver(linkage, linkage.loading, circuit.input_column)
    alone = [
        ForceSolver(linkage, Loading(linkage.loading.gravity, {link: (body,)}), circuit.input_column)
        for link, body in sorted(solver.bodies.items())
    ]

    def slopes(inputs: Floats, q: Floats) -> _Slopes:
        torque, forces, *_ = _solved(solver, inputs, q, speed)
        parts = []
        for one in alone:
            (body,) = one.bodies.values()
            own = _solved(one, inputs, q, speed)
            parts.append((own[0] / body.mass, own[1] / body.mass))
        return _Slopes(
            torque, np.stack([p[0] for p in parts], axis=1), forces, np.stack([p[1] for p in parts], axis=1)
        )

    yield from _measured(solver, circuit, slopes)


def _solved(solver: ForceSolver, inputs: Floats, q: Floats, speed: float) -> list[Floats]:
    """Torque [N m, or N] and forces (n, joints, 3) [N], then their derivatives where the solver has them."""
    rates = np.broadcast_to([speed, 0.0], (len(q), 2))
    torque, _, _, wrenches, _, _, _, torque_by, wrenches_by = solver.solved(inputs, q, rates)
    size = solver.size
    unit = size**2 if solver.linkage.turns(solver.input) else size
    return [unit * torque, size * wrenches[:, :, 3:], unit * torque_by, size * wrenches_by[..., 3:]]


def _by_dimensions(solver: ForceSolver, inputs: Floats, q: Floats, speed: float) -> _Slopes:
    torque, forces, torque_by, forces_by = _solved(solver, inputs, q, speed)
    return _Slopes(torque, torque_by, forces, forces_by)


def _measured(
    solver: ForceSolver, circuit: Circuit, slopes: Callable[[Floats, Floats], _Slopes]
) -> Iterator[MeasureSlopes]:
    """Each measure at its own place, or over all rows."""
    found = circuit.forces()
    joints = {name: one for name, one in found.reactions.items() if one.determinate[3:].all()}
    sizing = replace(found, reactions=joints).sizing()
    if sizing is None:
        return
    names = list(found.reactions)
    unit = found.unit
    peak = sizing.peak_torque

    def at(value: float, of: Callable[[_Slopes], tuple[Floats, Floats]]) -> Floats | None:
        """The derivatives where the quantity has its value, at an input."""
        q = poses_at(solver.loop, circuit, place)
        here = slopes(q[:, solver.input], q)
        values, by = of(here)
        apart = np.abs(values - value)
        if not np.isfinite(apart).any():
            return None
        best = int(np.nanargmin(apart))
        return by[best].copy() if apart[best] <= SAME_VALUE * (abs(value) or 1.0) else None

    place = peak.input
    by = at(peak.value, lambda here: (here.torque, here.torque_by))
    if by is not None:
        yield MeasureSlopes("peak_torque", unit, abs(peak.value), math.copysign(1.0, peak.value) * by)
    q = solver.numbers.poses(circuit.q)
    rows = slopes(circuit.input, q)
    if sizing.found == "series" and sizing.rms_torque > 0 and np.isfinite(rows.torque).all():
        mean = (rows.torque[:, None] * rows.torque_by).mean(axis=0)
        yield MeasureSlopes("rms_torque", unit, sizing.rms_torque, mean / sizing.rms_torque)
    for name, bearing in sizing.bearings.items():
        number, top = names.index(name), bearing.force.peak
        place = top.input

        def size_of(here: _Slopes, number: int = number) -> tuple[Floats, Floats]:
            force = here.forces[:, number]
            sizes = np.linalg.norm(force, axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                return sizes, np.einsum("nj,nkj->nk", force, here.forces_by[:, :, number]) / sizes[:, None]

        by = at(top.value, size_of)
        if by is not None:
            yield MeasureSlopes(f"peak_force:{name}", "N", top.value, by)
