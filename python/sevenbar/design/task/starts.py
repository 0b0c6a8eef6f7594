"""Starts of a task: linkages all over the bounds, each with how its wants may begin on its circuits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.passes import InputPass, passes
from sevenbar.design.task.placing import STILL, Placing
from sevenbar.design.task.problem import TaskModel, TaskSeed
from sevenbar.design.task.wanted import TaskStart
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.sweep.sampling import sobol_points

#: Of the starts one in so many lies near the description's own numbers, within this part of the bounds.
NEAR_ONE_IN, NEAR = 4, 0.12

#: Two starts are one where no number differs by more, relative to its bounds, and no pose by more [rad].
SAME, SAME_POSE = 0.02, 0.2


def seeds(
    model: TaskModel, count: int, seed: int, step: Callable[[], None], given: Sequence[Floats] = ()
) -> list[TaskSeed]:
    """How the task may begin, best first: numbers `given`, the description's own, `count` within the bounds.

    A linkage gives some for each of its circuits. `step` is called after each linkage.
    """
    result: list[TaskSeed] = []
    for values in _numbers(model, count, seed, given):
        result += seeds_at(model, values)
        step()
    return sorted(result, key=lambda one: one.error)


def _numbers(model: TaskModel, count: int, seed: int, given: Sequence[Floats]) -> Iterator[Floats]:
    low, high = model.task.low, model.task.high
    own = model.loop.start
    yield from (np.clip(values, low, high) for values in given)
    yield np.clip(own, low, high)
    if not count:
        return
    random = np.random.default_rng([seed, 1])
    for i, share in enumerate(sobol_points(seed, len(own), 0, count).T):
        if i % NEAR_ONE_IN:
            yield low + share * (high - low)
        else:
            moved = own + NEAR * random.standard_normal(len(own)) * (high - low)
            yield np.clip(moved, low, high)


def seeds_at(model: TaskModel, values: Floats) -> list[TaskSeed]:
    """How the task may begin with a linkage of these numbers (k,)."""
    motion = model.loop.motion(values)
    result: list[TaskSeed] = []
    for circuit in () if motion is None else motion.circuits:
        if not model.wanted:
            result += _of_figures(model, values, circuit)
            continue
        for one in passes(circuit):
            result += _on_pass(model, values, one)
    return result


def _of_figures(model: TaskModel, values: Floats, circuit: Circuit) -> list[TaskSeed]:
    """A start of figures alone: any row of the circuit that is a pose."""
    good = np.flatnonzero(np.isfinite(circuit.q).all(axis=1))
    if not good.size:
        return []
    seed = TaskSeed(
        values, (), np.empty((0, circuit.q.shape[1])), circuit.q[good[0]], 0.0, circuit=circuit.index
    )
    return _with_figures(model, seed)


def _with_figures(model: TaskModel, seed: TaskSeed) -> list[TaskSeed]:
    if not model.figure_wants:
        return [seed]
    read = model.figures.at(seed.values, seed.anchor, slopes=False)
    if read is None:
        return []
    values = dict(zip(model.figures.names, read[0], strict=True))
    none = np.zeros(1)
    off = sum((w.weight * w.residual(values[w.name], none)[0]) ** 2 for w in model.figure_wants)
    return [replace(seed, error=seed.error + off)]


def _on_pass(model: TaskModel, values: Floats, one: InputPass) -> list[TaskSeed]:
    """The wants on one pass, each at its best; the first one, which places the linkage, in all its ways."""
    scaled = model.task.placement == "free with scale"
    order = sorted(range(len(model.wanted)), key=lambda i: not model.wanted[i].placeable)
    firsts = model.wanted[order[0]].starts(one, None if model.placed else STILL, scaled=scaled)
    result: list[TaskSeed] = []
    for first in firsts:
        placing = first.placing or STILL
        chosen = {order[0]: first}
        for i in order[1:]:
            ways = model.wanted[i].starts(one, placing, scaled=scaled)
            if not ways:
                break
            chosen[i] = ways[0]
        else:
            result += _seed(model, values, one, [chosen[i] for i in range(len(chosen))], placing)
    return result


def _seed(
    model: TaskModel, values: Floats, one: InputPass, starts: Sequence[TaskStart], placing: Placing
) -> list[TaskSeed]:
    rows = np.concatenate([own.rows for own in starts])
    q = one.circuit.q[one.rows[rows]]
    error = sum(want.weight**2 * own.error for want, own in zip(model.wanted, starts, strict=True))
    seed = TaskSeed(
        values,
        tuple(own.u for own in starts),
        model.loop.poses(values, q),
        q[0],
        error,
        placing,
        one.period,
        one.circuit.index,
    )
    return _with_figures(model, _scaled(model, seed) if placing.scale != 1.0 else seed)


def _scaled(model: TaskModel, seed: TaskSeed) -> TaskSeed:
    """The seed with its lengths, all of which are free, in the scale of its placing, within the bounds."""
    loop, scale = model.loop, seed.placing.scale
    kinds = [loop.dimensions[i].kind for i in loop.free]
    lengths = np.array([kind in ("length", "pitch") for kind in kinds])
    values = np.clip(np.where(lengths, scale * seed.values, seed.values), model.task.low, model.task.high)
    turns = loop.numbers.turns
    own = tuple(
        # unknowns of sliding inputs are lengths
        u if turns[loop.input] else scale * u
        for u in seed.own
    )
    placing = Placing(seed.placing.rotation, seed.placing.shift)
    poses, anchor = (np.where(turns, q, scale * q) for q in (seed.poses, seed.anchor))
    return replace(seed, values=values, own=own, poses=poses, anchor=anchor, placing=placing)


def apart(model: TaskModel, seeds: Sequence[TaskSeed], count: int) -> list[TaskSeed]:
    """The first `count` of the seeds that are not alike."""
    selected: list[TaskSeed] = []
    width = model.task.high - model.task.low
    for one in seeds:
        if len(selected) >= count:
            break
        near = (
            bool(np.abs((one.values - other.values) / width).max(initial=0.0) < SAME)
            and bool(np.abs(short_way(one.anchor - other.anchor)).max() < SAME_POSE)
            and all(
                np.abs(a - b).max(initial=0.0) < SAME_POSE for a, b in zip(one.own, other.own, strict=True)
            )
            for other in selected
        )
        if not any(near):
            selected.append(one)
    return selected
