"""Starts for a wanted path: linkages all over the bounds, each with all its circuits and the best match."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats, Integers, short_way
from sevenbar.design.synthesis.path.task import PathTask
from sevenbar.design.task.match import STILL, Match, Placing, by_length, matched, placed
from sevenbar.errors import DescriptionError, MissingExtraError, NotCoveredError, RequestError
from sevenbar.kinematics.circuits import Circuit

#: Inputs of a turn at which a start's circuits are checked.
SAMPLES = 72

#: Of the starts one in so many lies near the description's own dimensions, within this part of the bounds.
NEAR_ONE_IN, NEAR = 4, 0.12

#: Starts of an input law that are tried in a turn.
PHASES = 36

#: Two starts are one where no dimension differs by more, relative to its bounds.
SAME = 0.02


@dataclass(frozen=True, eq=False)
class Seed:
    """A linkage with a rough match: `varied` (k,), inputs (n,) and poses (n, columns), mean square error.

    `phase` is what was added to the wanted inputs; `other` the same linkage matched by lengths along it.
    """

    varied: Floats
    inputs: Floats
    poses: Floats
    error: float
    phase: float = 0.0
    other: Seed | None = None


@dataclass(frozen=True, eq=False)
class Pass:
    """Rows of a circuit that the input goes through without a dead centre; `closed`: round and round."""

    circuit: Circuit
    rows: Integers
    curve: Floats
    closed: bool
    turns: bool

    @property
    def inputs(self) -> Floats:
        """The input along the rows."""
        return self.circuit.input[self.rows]

    @property
    def period(self) -> float:
        """What the input gains in one round, 0 where it does not go round."""
        return math.tau * self.circuit.turns if self.closed else 0.0


def seeds(task: PathTask, count: int, seed: int, step: Callable[[], None]) -> list[Seed]:
    """The best matches of the description itself and of `count` starts within the bounds, best first.

    A linkage gives one for each of its circuits. Starts are Sobol's points, a quarter of them near the
    description; `step` is called after each.
    """
    found: list[Seed] = []
    for varied in _starts(task, count, seed):
        found += [one for one in looked_at(task, varied) if math.isfinite(one.error)]
        step()
    return sorted(found, key=lambda one: one.error)


def apart(task: PathTask, found: list[Seed], count: int) -> list[Seed]:
    """The first `count` of the seeds that differ in their dimensions or by half the error of the best."""
    kept: list[Seed] = []
    for one in found:
        if len(kept) >= count:
            break
        near = (
            np.abs((one.varied - other.varied) / (task.high - task.low)).max() < SAME
            and np.abs(short_way(one.poses[0] - other.poses[0])).max() < 0.2
            for other in kept
        )
        if not any(near):
            kept.append(one)
    return kept


def _starts(task: PathTask, count: int, seed: int) -> Iterator[Floats]:
    """The description's own dimensions, then others within the bounds, (k,) each."""
    try:
        from scipy.stats import qmc
    except ImportError:
        raise MissingExtraError(
            "path generation needs scipy; install it with: pip install 'sevenbar[design]'"
        ) from None
    own = task.closure.start[list(task.varied)]
    yield own
    if not count:
        return
    sobol = qmc.Sobol(len(own), rng=np.random.default_rng(seed))
    random = np.random.default_rng([seed, 1])
    for i, share in enumerate(sobol.random_base2(math.ceil(math.log2(count)))[:count]):
        if i % NEAR_ONE_IN:
            yield task.low + share * (task.high - task.low)
        else:
            moved = own + NEAR * random.standard_normal(len(own)) * (task.high - task.low)
            yield np.clip(moved, task.low, task.high)


def passes(circuit: Circuit, curve: Floats, *, turns: bool) -> Iterator[Pass]:
    """The passes of a circuit with a point's path (rows, 3); rows without a pose are left out."""
    good = np.isfinite(np.column_stack([curve, circuit.q])).all(axis=1)
    if circuit.goes_round and good.all():
        yield Pass(circuit, np.arange(len(curve)), curve, True, turns)
        return
    for branch in np.unique(circuit.branch):
        rows = np.flatnonzero((circuit.branch == branch) & good)
        if len(rows) > 1:
            yield Pass(circuit, rows, curve[rows], False, turns)


def looked_at(task: PathTask, varied: Floats) -> Iterator[Seed]:
    """The best match of each circuit of a linkage, of infinite error where it has none."""
    try:
        linkage = task.drawn(varied).linkage
        motion = linkage.motion(SAMPLES)
    except (DescriptionError, RequestError, NotCoveredError):
        return
    point = next(p for p in linkage.points if p.name == task.point.name)
    turns = linkage.turns(task.closure.input)
    for circuit in motion.circuits:
        curve = circuit.point(point.link, point.at).position
        best: Seed | None = None
        for one in passes(circuit, curve, turns=turns):
            seed = _timed(task, one, varied) if task.timing is not None else _untimed(task, one, varied)
            if seed is not None and (best is None or seed.error < best.error):
                best = seed
        yield best or Seed(varied, np.empty(0), np.empty(0), math.inf)


def _untimed(task: PathTask, one: Pass, varied: Floats) -> Seed | None:
    if task.closed and not one.closed:
        return None
    match = matched(
        one.curve,
        task.wanted,
        curve_closed=one.closed,
        closed=task.closed,
        place=task.place,
        scaled=task.scale_free,
    )
    if match is None:
        return None
    own = _seed(task, one, varied, match)
    rows = by_length(match.placing.put(one.curve), task.wanted, curve_closed=one.closed, closed=task.closed)
    if rows is None:
        return own
    return replace(own, other=_seed(task, one, varied, replace(match, rows=rows)))


def _seed(task: PathTask, one: Pass, varied: Floats, match: Match) -> Seed:
    rows = one.rows[match.rows]
    inputs = one.inputs[match.rows].copy()
    if one.closed:
        steps = np.diff(match.rows)
        way = 1.0 if (steps > 0).sum() >= (steps < 0).sum() else -1.0
        inputs[1:] += way * one.period * np.cumsum(way * steps < 0)
    poses = task.closure.poses(task.values(varied), one.circuit.q[rows])
    return _scaled(task, Seed(varied, inputs, poses, match.error), match.placing)


def _scaled(task: PathTask, seed: Seed, placing: Placing) -> Seed:
    """The seed with its lengths in the scale of the placing, within the bounds."""
    if not task.scale_free or placing.scale == 1.0:
        return seed
    lengths = np.array([d.kind in ("length", "pitch") for d in task.dimensions])
    varied = np.clip(np.where(lengths, placing.scale * seed.varied, seed.varied), task.low, task.high)
    slides = ~task.draft.linkage.turning
    poses = np.where(slides, placing.scale * seed.poses, seed.poses)
    inputs = seed.inputs * (placing.scale if slides[task.closure.input] else 1.0)
    return Seed(varied, inputs, poses, seed.error, seed.phase)


def _timed(task: PathTask, one: Pass, varied: Floats) -> Seed | None:
    """The pass at the wanted inputs, from the best of several starts where that is free."""
    assert task.timing is not None
    own = one.inputs
    best: Seed | None = None
    for phase in _phases(task, one):
        inputs = task.timing + phase
        if one.closed:
            at = own[0] + (inputs - own[0]) % one.period
            gap = np.abs((at[:, None] - own + one.period / 2) % one.period - one.period / 2)
        elif inputs.min() < own.min() or inputs.max() > own.max():
            continue
        else:
            gap = np.abs(inputs[:, None] - own)
        rows = gap.argmin(axis=1)
        curve = one.curve[rows]
        placing = placed(task.wanted, curve) if task.place else STILL
        error = float(((placing.put(curve) - task.wanted) ** 2).sum(axis=1).mean())
        if best is None or error < best.error:
            poses = task.closure.poses(task.values(varied), one.circuit.q[one.rows[rows]])
            best = Seed(varied, inputs, poses, error, phase if task.phase else 0.0)
    return best


def _phases(task: PathTask, one: Pass) -> Iterator[float]:
    """What may be added to the wanted inputs so that they lie within a pass."""
    assert task.timing is not None
    own = one.inputs
    if task.phase:
        if one.closed:
            yield from (own[0] - task.timing[0] + one.period * k / PHASES for k in range(PHASES))
            return
        room = float(np.ptp(own) - np.ptp(task.timing))
        if room >= 0:
            yield from own.min() - task.timing.min() + np.linspace(0.0, room, PHASES)
        return
    if not one.turns:
        yield 0.0
        return
    if one.closed:
        yield from (math.tau * k for k in range(max(one.circuit.turns, 1)))
        return
    nearest = round(float(own.mean() - task.timing.mean()) / math.tau)
    yield from (math.tau * k for k in (nearest - 1, nearest, nearest + 1))
