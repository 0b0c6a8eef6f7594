"""Linkages of a part that the core measures all at once: RSSRs in the paper's layout, and general loops."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import SevenbarError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.solvers.batches import (
    INVALID,
    RSSR_ROWS,
    WORDS,
    Classified,
    Motions,
    loop_motions,
    rssr_motions,
    rssr_rows,
    rssr_types,
)
from sevenbar.kinematics.transmission.angle import coupling_of
from sevenbar.sweep.block import NO_CIRCUIT, Block
from sevenbar.sweep.plan import SweepPlan

#: Sizes [file's units] between which nothing is refused by the description; others are checked one by one.
LEAST, GREATEST = 1e-50, 1e50


def batched(plan: SweepPlan, values: Floats, threads: int) -> tuple[list[Block], Integers]:
    """The rows of linkages (axes, n) that the core measures, and which are left to be analysed one by one.

    Left are those that a description refuses or that do not move, which have a reason to report, change
    points of an RSSR, whose output must be followed, other loops whose transmission angle is measured,
    and all of a sweep of functions or with a closure error of its own.
    """
    count = values.shape[1]
    if not all(isinstance(measure, str) for measure in plan.measures):
        return [], np.arange(count)
    block = None
    if plan.draft.linkage.form == "rssr":
        block = _of_rssrs(plan, values, threads)
    elif plan.draft.linkage.followed_generally and plan.draft.agree is None:
        block = _of_loops(plan, values, threads)
    if block is None:
        return [], np.arange(count)
    rest = np.ones(count, dtype=bool)
    rest[block.linkage] = False
    return [block], np.flatnonzero(rest)


def _of_rssrs(plan: SweepPlan, values: Floats, threads: int) -> Block:
    """The rows of the RSSRs (axes, n) that are clear."""
    dimensions, speed = _dimensions(plan, values)
    sizes = np.abs([*dimensions, speed, *values])
    fits = (sizes <= GREATEST).all(axis=0) & (np.abs(speed) >= LEAST)
    # no length is negative
    fits &= (dimensions[[RSSR_ROWS.index(name) for name in ("L1", "L2", "L3")]] >= LEAST).all(axis=0)
    which = np.flatnonzero(fits)
    if all(measure.of_type for measure in plan.measured):
        block = _of_types(plan, dimensions[:, which], threads)
    else:
        motions = rssr_motions(dimensions[:, which], plan.input, speed[which], threads)
        block = _of_circuits(plan, motions)
    return replace(block, linkage=which[block.linkage])


def _of_loops(plan: SweepPlan, values: Floats, threads: int) -> Block | None:
    """The rows of the loops (axes, n) that are clear; `None` where no description makes one."""
    linkages: list[Linkage] = []
    which: list[int] = []
    first, last = (plan.draft.linkage.columns.index(name) for name in (plan.input, plan.output))
    # which the core's batches of general loops have not
    angles = any(measure.family == "transmission" for measure in plan.measured)
    for index, row in enumerate(values.T):
        try:
            linkage = plan.draft_of(row).linkage
        except SevenbarError:  # whose reason is reported where it is analysed by itself
            continue
        if angles and coupling_of(linkage, first, last) is not None:
            continue
        linkages.append(linkage)
        which.append(index)
    if not linkages:
        return None
    block = _of_circuits(plan, loop_motions(linkages, first, last, plan.samples, threads))
    return replace(block, linkage=np.array(which)[block.linkage])


def _dimensions(plan: SweepPlan, values: Floats) -> tuple[Floats, Floats]:
    """The core's rows (6, n) of dimensions, and the speed of the input (n,) [rad/s]."""
    linkage = plan.draft.linkage
    swept = {axis.dimension.place: row for axis, row in zip(plan.space.axes, values, strict=True)}
    own = {name: swept.get(("rssr", name), linkage.dimensions[name]) for name in RSSR_ROWS}
    follows = ("rssr", "L2") not in swept and "L2" not in plan.draft.raw["rssr"]
    speed = swept.get(("drive", "speed"), linkage.drive.speed)
    count = values.shape[1]
    return rssr_rows(own, count, follows=follows), np.broadcast_to(speed, count)


def _of_types(plan: SweepPlan, dimensions: Floats, threads: int) -> Block:
    """A row for each linkage, of what follows from its dimensions without its circuits."""
    codes, limits = rssr_types(dimensions, plan.input, threads)
    linkage = np.flatnonzero(codes != INVALID)
    columns = _of_linkages(plan, Classified(WORDS[codes], limits), linkage)
    return Block.measured(linkage, np.full(len(linkage), NO_CIRCUIT), columns)


def _of_circuits(plan: SweepPlan, motions: Motions) -> Block:
    """A row for each linkage, or for each of its circuits where one of the measures is of circuits."""
    if not plan.per_circuit:
        linkage = np.flatnonzero(motions.clear)
        return Block.measured(
            linkage, np.full(len(linkage), NO_CIRCUIT), _of_linkages(plan, motions, linkage)
        )
    without = np.flatnonzero(motions.clear & (motions.circuits == 0))
    selected = np.flatnonzero(motions.clear[motions.linkage])
    linkage = np.concatenate([motions.linkage[selected], without])
    circuit = np.concatenate([motions.circuit[selected], np.full(len(without), NO_CIRCUIT)])
    columns = _of_linkages(plan, motions, linkage)
    for measure in plan.measured:
        if measure.per == "circuit" and measure.batch:
            column = measure.batch(motions)[selected]
            missing = None if column.dtype == object else np.nan
            columns[measure.name] = np.concatenate([column, np.full(len(without), missing, column.dtype)])
    return Block.measured(linkage, circuit, columns)


def _of_linkages(plan: SweepPlan, motions: Classified, linkage: Integers) -> dict[str, npt.NDArray[Any]]:
    """Columns (r,) of the measures of the linkage of each row, and its limits."""
    columns: dict[str, npt.NDArray[Any]] = {
        measure.name: measure.batch(motions)[linkage]
        for measure in plan.measured
        if measure.per == "linkage" and measure.batch
    }
    for place, name in enumerate(plan.limit_names):
        columns[name] = np.degrees(motions.limits[linkage, place])
    return columns
