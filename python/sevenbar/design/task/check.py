"""A design as the ordinary analysis finds it: its written file is opened and its motion asked again."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import (
    CHECK_SAMPLES,
    Candidate,
    Claim,
    Refusal,
    checked,
    joint_differences,
    one_way,
    within_limits,
)
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.placing import Placing, moved, standing
from sevenbar.design.task.problem import TaskModel, pose_slacks
from sevenbar.design.task.solve import Solved
from sevenbar.design.task.task import MeasureMust, PoseMust, ResidualMust
from sevenbar.design.task.wanted import Wanted
from sevenbar.errors import DescriptionError, NotCoveredError, RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.law import Law

#: By how much errors may be greater in the analysis than was solved for, relative to them and to their unit:
#: more, and the solution lies on several passes.
TORN = 1e-6

#: Inputs over the used range at which musts are checked, and by how much one may be missed between those at
#: which it was held [rad, or relative to the size].
DENSE, MISSED = 361, 1e-4

#: A must missed between those by more is held tighter by as much, and solved again; by more than the second
#: it is missed for another reason.
TIGHT, NEAR = 1e-7, 1e-2

#: By how much a measure may miss its limit through rounding, relative to it.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Met:
    """How well a want is met: the greatest error and the root mean square [rad, or length]."""

    greatest: float
    rms: float
    unit: str

    @property
    def shown(self) -> tuple[str, float]:
        """The unit in which people read it, and what 1 is there: degrees for angles."""
        return ("deg", math.degrees(1.0)) if self.unit == "rad" else (self.unit, 1.0)


@dataclass(frozen=True, eq=False)
class TaskDesign:
    """A linkage that does what a task asks, with what the ordinary analysis says of it.

    `candidate` is that of the first want. `cost` is the root of the weighted mean squares, or the greatest
    weighted residual; `optimality` by how much the conditions of a local optimum are missed, relative;
    `met` how well each want is met at poses, `figures` the measures that are wanted or limited;
    `room` the least slack of a must (infinite where there is none); `placing` where the linkage is;
    `solution` what was solved for, with the inputs and own unknowns of each want.
    """

    candidate: Candidate
    cost: float
    optimality: float
    met: tuple[Met, ...]
    figures: Mapping[str, float]
    room: float
    placing: Placing
    values: Floats
    solution: Solved
    #: The least transmission angle of the whole circuit [rad]; `None` where the loop has none.
    transmission: float | None = None

    @property
    def draft(self) -> Draft:
        """Its description."""
        return self.candidate.draft

    def drafted(self, draft: Draft) -> TaskDesign:
        """The same with another description."""
        return replace(self, candidate=self.candidate.drafted(draft))


@dataclass(frozen=True, eq=False)
class _Way:
    """A pass of the analysis at the inputs of a want: poses (n, columns), and what it is off."""

    circuit: int
    branch: int
    poses: Floats
    outputs: Floats
    errors: Floats


def checked_design(model: TaskModel, solution: Solved) -> TaskDesign | Refusal:
    """The design with its errors found anew from what is written, or why it does not do what is asked."""
    draft = model.loop.drawn(solution.seed.values)
    try:
        linkage, ways = _opened(model, solution, draft)
        motion = linkage.motion(CHECK_SAMPLES)
    except (DescriptionError, RequestError, NotCoveredError) as error:
        return Refusal("assembly", str(error))
    candidate = _candidate(model, draft, solution, ways, motion)
    if isinstance(candidate, Refusal):
        return candidate
    figures = _figures(model, motion, motion.circuits[candidate.circuit])
    if isinstance(figures, Refusal):
        return figures
    slack = _slack(model, solution, ways, linkage)
    if isinstance(slack, Refusal):
        return slack
    met = tuple(
        Met(
            float(np.abs(w[0].errors).max()),
            float(np.sqrt((w[0].errors ** 2).mean())),
            "rad" if one.turns else linkage.length_unit,
        )
        for one, w in zip(model.wanted, ways, strict=True)
    )
    extremes = motion.circuits[candidate.circuit].transmission
    return TaskDesign(
        candidate,
        solution.cost,
        solution.optimality,
        met,
        figures,
        slack,
        solution.seed.placing,
        solution.seed.values,
        solution,
        None if extremes is None else extremes.lowest,
    )


def _opened(model: TaskModel, solution: Solved, draft: Draft) -> tuple[Linkage, list[list[_Way]]]:
    """The linkage as its file has it, and the ways of each want."""
    linkage = Draft.of(draft.toml(), "design", agree=draft.agree).linkage
    each = zip(model.wanted, solution.inputs, solution.seed.own, strict=True)
    return linkage, [_ways(one, linkage, inputs, u, solution.seed.placing) for one, inputs, u in each]


def _ways(one: Wanted, linkage: Linkage, inputs: Floats, u: Floats, placing: Placing) -> list[_Way]:
    """What each pass of the analysis makes of a want, best first; those that do not reach it are left out."""
    count = len(inputs)
    law = Law.of(np.arange(count, dtype=np.float64), inputs, 1.0, 0.0)
    result = []
    for circuit in linkage.motion(law=law).circuits:
        for begin in range(0, len(circuit.q), count):
            rows = slice(begin, begin + count)
            if not np.isfinite(circuit.q[rows]).all() or len(circuit.q[rows]) < count:
                continue
            errors = one.errors(circuit, rows, u, placing)
            result.append(_Way(circuit.index, begin // count, circuit.q[rows], circuit.output[rows], errors))
    return sorted(result, key=lambda way: float((way.errors**2).sum()))


def _candidate(
    model: TaskModel, draft: Draft, solution: Solved, ways: list[list[_Way]], motion: Motion
) -> Candidate | Refusal:
    limits, linkage = model.task.limits, model.loop.linkage
    if not model.wanted:
        return _of_figures(model, draft, solution, motion)
    result: list[Candidate] = []
    for number, (one, own) in enumerate(zip(model.wanted, ways, strict=True)):
        if not own:
            return Refusal(
                "dead centre", "no pass reaches the inputs of a want without a dead centre between"
            )
        refused = _torn(model, number, solution, own) or _short(model, number, solution)
        if refused is not None:
            return refused
        placed = one.placeable and model.placed
        figures = standing(solution.seed.placing, linkage.length_unit) if placed else {}
        if placed and linkage.form == "drawn":
            draft, figures = moved(draft, solution.seed.placing), {}
        unit = "deg" if one.turns else linkage.length_unit
        claim = Claim(solution.inputs[number], own[0].outputs, own[0].errors, unit, figures)
        candidate = checked(draft, claim, limits, poses=own[0].poses, motion=motion)
        if isinstance(candidate, Refusal):
            return candidate
        result.append(candidate)
        if one.stations.round and not motion.circuits[candidate.circuit].goes_round:
            return Refusal(
                "dead centre",
                "the path is closed, and a dead centre lies between its last point and its first",
            )
    other = next(
        (one for one in result if (one.circuit, one.branch) != (result[0].circuit, result[0].branch)), None
    )
    if other is not None:
        return Refusal(
            "circuit",
            f"wants lie on circuits {result[0].circuit} and {other.circuit}, or on two passes of one",
        )
    return result[0]


def _torn(model: TaskModel, number: int, solution: Solved, own: list[_Way]) -> Refusal | None:
    """Why no pass holds all poses that were solved for, each of which some pass comes near."""
    loop, poses = model.loop, solution.poses_of(number)
    one = model.wanted[number]
    here = loop.here(solution.seed.values, poses)
    off = one.missed(here.along(one.stations.by), solution.seed.own[number], solution.seed.placing)
    count = len(own[0].errors)
    best, expected = (float(np.linalg.norm(each)) / math.sqrt(count) for each in (own[0].errors, off))
    if best <= 2 * expected * (1 + TORN) + TORN * one.unit:
        return None
    nearest = np.argmin([np.abs(way.errors).reshape(len(poses), -1).max(axis=1) for way in own], axis=0)
    circuits, branches = (np.array([[way.circuit, way.branch] for way in own])[nearest, k] for k in (0, 1))
    return one_way(circuits, branches) or Refusal(
        "circuit", "no pass goes through all the poses that were solved for: it must be taken apart"
    )


def _short(model: TaskModel, number: int, solution: Solved) -> Refusal | None:
    """What a want requires and the poses solved for miss, if anything."""
    one = model.wanted[number]
    here = model.loop.here(solution.seed.values, solution.poses_of(number))
    bound = one.bound(here.along(one.stations.by))
    fault = model.task.sampled[number][1].fault
    return Refusal(fault, bound.missed) if bound is not None and bound.slack.min() < -TORN else None


def _of_figures(model: TaskModel, draft: Draft, solution: Solved, motion: Motion) -> Candidate | Refusal:
    """The candidate of a task about figures alone."""
    result = model.figures.circuit(solution.seed.values, solution.seed.anchor)
    if result is None:
        return Refusal("assembly", "its circuit is lost")
    circuit, values = result[1].index, model.figures.read(*result)
    if not np.isfinite(list(values.values())).all() or circuit >= len(motion.circuits):
        return Refusal("figure", "a measure has no value there")
    wanted = [want for want in model.figure_wants if not isinstance(want.value, str)]
    errors = np.array([want.residual(values[want.name], np.zeros(1))[0] for want in wanted] or [0.0])
    lowest = motion.circuits[circuit].transmission
    claim = Claim(np.empty(0), np.empty(0), errors, "", {}, whole_turn=True)
    least = None if lowest is None else lowest.lowest
    candidate = Candidate(draft, claim, motion.motion_type, least, circuit, 0, np.empty(0))
    return within_limits(candidate, model.task.limits)


def _figures(model: TaskModel, motion: Motion, circuit: Circuit) -> Mapping[str, float] | Refusal:
    """The measures as the analysis has them, or which misses its limit."""
    result = model.figures.read(motion, circuit)
    for must in model.task.musts:
        if not isinstance(must, MeasureMust):
            continue
        value = result[must.name]
        slack = ROUNDING * max(abs(value), 1.0)
        for way, end, word in ((1, must.least, "at least"), (-1, must.most, "at most")):
            if end is not None and way * (value - end) < -slack:
                return Refusal("figure", f"{must.name} is {value:.6g}, {word} {end:g} is required")
    return result


def missed_between(model: TaskModel, solution: Solved) -> dict[int, float]:
    """By how much musts about poses, by their places, are missed between the poses at which they were held.

    Empty where none is, by more than rounding, or one for another reason.
    """
    try:
        linkage, ways = _opened(model, solution, model.loop.drawn(solution.seed.values))
    except (DescriptionError, RequestError, NotCoveredError):
        return {}
    if not all(ways):
        return {}
    missed = {place: -slack for place, slack in _used_slacks(model, solution, ways, linkage).items()}
    if not max(missed.values(), default=0.0) <= NEAR:
        return {}
    return {place: slack for place, slack in missed.items() if slack > TIGHT}


def _used_slacks(
    model: TaskModel, solution: Solved, ways: list[list[_Way]], linkage: Linkage
) -> dict[int, float]:
    """The least slack of each must about poses, by its place, over all that is used."""
    loop, values = model.loop, solution.seed.values
    slacks = pose_slacks(loop, model.task.musts)
    least: dict[int, float] = {}
    for one, own, inputs in zip(model.wanted, ways, solution.inputs, strict=True):
        if not slacks:
            break
        low, high = float(inputs.min()), float(inputs.max())
        dense = np.linspace(low, low + solution.seed.period if one.stations.round else high, DENSE)
        here = loop.here(values, loop.poses(values, _dense(loop, linkage, own[0], dense)))
        for place, slack in slacks:
            worst = float(slack(here)[0].min())
            # NaN is less than any
            least[place] = worst if not worst >= least.get(place, math.inf) else least[place]
    return least


def _slack(model: TaskModel, solution: Solved, ways: list[list[_Way]], linkage: Linkage) -> float | Refusal:
    """The least slack of the musts over all that is used, or which is missed."""
    loop, musts = model.loop, model.task.musts
    least = math.inf
    for place, worst in _used_slacks(model, solution, ways, linkage).items():
        if not worst >= -MISSED:
            must = musts[place]
            assert isinstance(must, PoseMust)
            unit, scale = must.slack_unit(loop)
            missed = f"{-worst * scale:.3g} {unit}"
            return Refusal(must.fault, f"{must.words(loop.linkage)}: missed by {missed}")
        least = min(least, worst)
    for must in musts:
        if isinstance(must, ResidualMust):
            number = model.sampled.index(must.want)
            one = model.wanted[number]
            errors = ways[number][0].errors[slice(None) if must.at is None else list(must.at)]
            worst = float(np.abs(errors).max())
            if worst > (must.most + TORN) * one.unit:
                result, asked = (
                    f"{math.degrees(x):.4g} deg" if one.turns else f"{x:.4g} {linkage.length_unit}"
                    for x in (worst, must.most * one.unit)
                )
                return Refusal("error", f"the greatest error is {result}, at most {asked} is asked")
            least = min(least, must.most - worst / one.unit)
    return least


def _dense(loop: TaskLoop, linkage: Linkage, way: _Way, dense: Floats) -> Floats:
    """The rows of the analysis at many inputs on the pass of a want."""
    law = Law.of(np.arange(len(dense), dtype=np.float64), dense, 1.0, 0.0)
    circuit = linkage.motion(law=law).circuits[way.circuit]
    best, least = circuit.q[: len(dense)], math.inf
    first = way.poses[int(np.argmin(way.poses[:, loop.input]))]
    columns = [c for c, ball in enumerate(loop.numbers.is_ball) if not ball and c != loop.input]
    for begin in range(0, len(circuit.q), len(dense)):
        rows = circuit.q[begin : begin + len(dense)]
        if np.isfinite(rows).all():
            apart = joint_differences(rows[0] - first, loop.numbers.turns, loop.size)[columns]
            off = float(np.abs(apart).max(initial=0.0))
            if off < least:
                best, least = rows, off
    return np.asarray(best)
