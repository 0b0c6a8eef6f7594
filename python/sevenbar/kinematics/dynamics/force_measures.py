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
from functools import partial

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.curves.curve import Peak
from sevenbar.errors import RequestError, no_joint
from sevenbar.forces.loading import Loading
from sevenbar.forces.result import loads_of
from sevenbar.forces.shaking import shaking_along
from sevenbar.forces.sizing import CycleLoads
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.dynamics.forces import ForceSolver
from sevenbar.kinematics.numbers.gradients import MeasureSlopes, nearest, poses_at
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.text.units import LENGTHS


def sized(circuit: Circuit, joints: Sequence[str] = ()) -> CycleLoads | None:
    """The loads of a circuit's cycle, of which a sizing is made, with the bearings of these joints only.

    `None` for a circuit that rocks: its measures are of constant speed. Between stops those of the part on
    which the linkage is used.
    """
    if not joints and (waves := circuit.force_waves) is not None:
        return waves.loads
    result = circuit.forces()
    for name in joints:
        if name not in result.reactions:
            raise RequestError(f"measure: {no_joint(name, list(result.reactions))}")
    own = result.within_stops
    if own is None or (own.part is None and not circuit.goes_round):
        return None
    return loads_of(replace(own, reactions={name: own.reactions[name] for name in joints}))


def peak_shaking(circuit: Circuit) -> float | None:
    """The greatest shaking force [N], between the rows, too; `None` where a row has none, or it rocks."""
    if (waves := circuit.force_waves) is not None:
        return waves.peak_shaking
    own = circuit.forces().within_stops
    if own is None or (own.part is None and not circuit.goes_round):
        return None
    result = shaking_along(own)
    return None if result is None else result.force.value


@dataclass(frozen=True, eq=False)
class _Slopes:
    """Torque (n,), joint forces (n, joints, 3) and shaking force (n, 3), with derivatives by k numbers."""

    torque: Floats
    forces: Floats
    shaking: Floats
    #: (n, k), (n, k, joints, 3), (n, k, 3)
    torque_by: Floats
    forces_by: Floats
    shaking_by: Floats


#: The measures that have derivatives, those of a joint by their kind.
WITH_SLOPES = ("peak_torque", "rms_torque", "peak_power", "peak_shaking", "peak_force")


def force_slopes(
    numbers: Numbers, circuit: Circuit, speed: float, only: Sequence[str] | None = None
) -> Iterator[MeasureSlopes]:
    """Peaks of torque, power, shaking and joint forces, and the RMS torque, by the description's numbers.

    Nothing where nothing acts, or the circuit does not go round at constant speed. `only` measures of these
    names, of all that there are.
    """
    loading = numbers.linkage.loading
    if loading.is_empty or not _are_wanted(circuit, only):
        return
    solver = ForceSolver(numbers.linkage, loading, circuit.input_column, by_numbers=True)

    yield from _measured(solver, circuit, lambda inputs, q: _solved(solver, inputs, q, speed), only)


def mass_slopes(
    numbers: Numbers, circuit: Circuit, speed: float, only: Sequence[str] | None = None
) -> Iterator[MeasureSlopes]:
    """The same by the mass of each link's body [kg], by their numbers rising; inertia grows along with it."""
    linkage = numbers.linkage
    if not any(linkage.loading.bodies.values()) or not _are_wanted(circuit, only):
        return
    solver = ForceSolver(linkage, linkage.loading, circuit.input_column)
    alone = [
        ForceSolver(linkage, Loading(linkage.loading.gravity, {link: (body,)}), circuit.input_column)
        for link, body in sorted(solver.bodies.items())
    ]

    def slopes(inputs: Floats, q: Floats) -> _Slopes:
        whole = _solved(solver, inputs, q, speed)
        parts = []
        for one in alone:
            (body,) = one.bodies.values()
            own = _solved(one, inputs, q, speed)
            parts.append([part / body.mass for part in (own.torque, own.forces, own.shaking)])
        torque_by, forces_by, shaking_by = (np.stack(part, axis=1) for part in zip(*parts, strict=True))
        return replace(whole, torque_by=torque_by, forces_by=forces_by, shaking_by=shaking_by)

    yield from _measured(solver, circuit, slopes, only)


def _are_wanted(circuit: Circuit, only: Sequence[str] | None) -> bool:
    """Whether a circuit has any measure of those wanted."""
    return circuit.goes_round and (
        only is None or any(name.partition(":")[0] in WITH_SLOPES for name in only)
    )


def _solved(solver: ForceSolver, inputs: Floats, q: Floats, speed: float) -> _Slopes:
    """Torque [N m, or N] and forces [N] at constant speed; derivatives where the solver has them."""
    rates = np.broadcast_to([speed, 0.0], (len(q), 2))
    result = solver.solved(inputs, q, rates)
    size = solver.size
    unit = size**2 if solver.linkage.turns(solver.input) else size
    return _Slopes(
        unit * result.torque,
        size * result.wrenches[..., 3:],
        size * result.shaking[:, 3:],
        unit * result.torque_by,
        size * result.wrenches_by[..., 3:],
        size * result.shaking_by[..., 3:],
    )


def _measured(
    solver: ForceSolver,
    circuit: Circuit,
    slopes: Callable[[Floats, Floats], _Slopes],
    only: Sequence[str] | None,
) -> Iterator[MeasureSlopes]:
    """Each measure that is wanted at its own place, or over all rows."""

    def wanted(name: str) -> bool:
        return only is None or name in only

    result = circuit.forces().within_stops
    if result is None:
        return
    joints = {
        name: one
        for name, one in result.reactions.items()
        if one.determinate[3:].all() and wanted(f"peak_force:{name}")
    }
    loads = loads_of(replace(result, reactions=joints))
    if loads is None:
        return
    names = list(result.reactions)

    def peak_of(
        name: str, unit: str, peak: Peak, of: Callable[[_Slopes], tuple[Floats, Floats]]
    ) -> Iterator[MeasureSlopes]:
        """A peak and its derivatives where the quantity has its value; nothing where it has it nowhere.

        Nor at an end of a part between stops that moves with the dimensions.
        """
        if result.part is not None and result.part.moves(peak.input, result.driver):
            return
        q = poses_at(solver.loop, circuit, peak.input)
        values, by = of(slopes(q[:, solver.input], q))
        best = nearest(np.abs(values - peak.value), abs(peak.value))
        if best is not None:
            yield MeasureSlopes(name, unit, peak.value, by[best].copy())

    if wanted("peak_torque"):
        top = loads.peak_torque
        sign = math.copysign(1.0, top.value)
        yield from peak_of(
            "peak_torque",
            result.unit,
            replace(top, value=abs(top.value)),
            lambda here: (sign * here.torque, sign * here.torque_by),
        )
    if wanted("rms_torque") and loads.found == "series" and loads.rms_torque > 0:
        rows = slopes(circuit.input, solver.numbers.poses(circuit.q))
        if np.isfinite(rows.torque).all():
            mean = (rows.torque[:, None] * rows.torque_by).mean(axis=0)
            yield MeasureSlopes("rms_torque", result.unit, loads.rms_torque, mean / loads.rms_torque)
    if wanted("peak_power"):
        # no number changes the speed
        rate = circuit.speed * (LENGTHS[result.length_unit] if result.slides else 1.0)
        yield from peak_of(
            "peak_power", "W", loads.peak_power, lambda here: (rate * here.torque, rate * here.torque_by)
        )
    shaken = shaking_along(result) if wanted("peak_shaking") else None
    if shaken is not None and shaken.force.value > 0:
        yield from peak_of(
            "peak_shaking", "N", shaken.force, lambda here: _sizes(here.shaking, here.shaking_by)
        )
    for name in joints:
        peak = loads.bearing(name).force.peak
        yield from peak_of(f"peak_force:{name}", "N", peak, partial(_of_joint, names.index(name)))


def _of_joint(joint: int, here: _Slopes) -> tuple[Floats, Floats]:
    return _sizes(here.forces[:, joint], here.forces_by[:, :, joint])


def _sizes(force: Floats, by: Floats) -> tuple[Floats, Floats]:
    """The sizes (n,) of forces (n, 3), and their derivatives (n, k) by those of the forces (n, k, 3)."""
    sizes = np.linalg.norm(force, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return sizes, np.einsum("nj,nkj->nk", force, by) / sizes[:, None]
