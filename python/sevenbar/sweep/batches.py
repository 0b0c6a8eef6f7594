"""Linkages of a part that the core measures all at once: RSSRs in the paper's layout."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.many import CHANGE_POINT, CODES, INVALID, RSSR_ROWS, rssr_motions, rssr_types
from sevenbar.motion import Floats, Integers
from sevenbar.sweep.block import NO_CIRCUIT, OK, Block, limit_names
from sevenbar.sweep.plan import OF_TYPES, Plan

#: The words of the core's codes, as objects of a column.
WORDS = np.array(CODES, dtype=object)

#: Sizes [file's units] between which nothing is refused by the description; others are left to be looked at.
LEAST, GREATEST = 1e-50, 1e50


def batched(plan: Plan, values: Floats, threads: int) -> tuple[list[Block], Integers]:
    """The rows of linkages (axes, n) that the core measures, and which are left to be analysed one by one.

    Left are those that a description refuses, which have their reason to tell, change points, whose output
    must be followed, and all where the sweep is of other linkages or of functions.
    """
    count = values.shape[1]
    if "rssr" not in plan.draft.raw or not all(isinstance(measure, str) for measure in plan.measures):
        return [], np.arange(count)
    dimensions, speed = _dimensions(plan, values)
    sizes = np.abs([*dimensions, speed, *values])
    fits = (sizes <= GREATEST).all(axis=0) & (np.abs(speed) >= LEAST)
    # no length is negative
    fits &= (dimensions[[RSSR_ROWS.index(name) for name in ("L1", "L2", "L3")]] >= LEAST).all(axis=0)
    which = np.flatnonzero(fits)
    if OF_TYPES.issuperset(plan.measures):
        block = _of_types(plan, dimensions[:, which], threads)
    else:
        block = _of_circuits(plan, dimensions[:, which], speed[which], threads)
    linkage = which[block.linkage]
    rest = np.ones(count, dtype=bool)
    rest[linkage] = False
    return [Block(linkage, block.circuit, block.status, block.columns)], np.flatnonzero(rest)


def _dimensions(plan: Plan, values: Floats) -> tuple[Floats, Floats]:
    """The core's rows (6, n) of dimensions, and the speed of the input (n,) [rad/s]."""
    linkage = plan.draft.linkage
    swept = {axis.dimension.place: row for axis, row in zip(plan.space.axes, values, strict=True)}
    own = {name: swept.get(("rssr", name), linkage.dimensions[name]) for name in RSSR_ROWS}
    if ("rssr", "L2") not in swept and "L2" not in plan.draft.raw["rssr"]:
        own["L2"] = np.sqrt((own["L1"] - own["M"]) ** 2 + own["L3"] ** 2 + own["N"] ** 2)
    speed = swept.get(("drive", "speed"), linkage.drive.speed)
    shape = values.shape[1:]
    return np.stack([np.broadcast_to(own[name], shape) for name in RSSR_ROWS]), np.broadcast_to(speed, shape)


def _of_types(plan: Plan, dimensions: Floats, threads: int) -> Block:
    """A row for each linkage, of what its dimensions tell without its circuits."""
    codes, limits = rssr_types(dimensions, plan.input, threads)
    linkage = np.flatnonzero(codes != INVALID)
    columns = _of_linkages(plan, linkage, codes, limits)
    return Block(linkage, np.full(len(linkage), NO_CIRCUIT), _ok(linkage), columns)


def _of_circuits(plan: Plan, dimensions: Floats, speed: Floats, threads: int) -> Block:
    """A row for each linkage, or for each of its circuits where one of the measures is of circuits."""
    motions = rssr_motions(dimensions, plan.input, speed, threads)
    clear = (motions.codes != INVALID) & (motions.codes != CHANGE_POINT)
    own = [measure for measure in plan.measured if measure.per == "circuit"]
    if not own:
        linkage = np.flatnonzero(clear)
        circuit = np.full(len(linkage), NO_CIRCUIT)
    else:
        without = np.flatnonzero(clear & (motions.circuits == 0))
        kept = np.flatnonzero(clear[motions.linkage])
        linkage = np.concatenate([motions.linkage[kept], without])
        circuit = np.concatenate([motions.circuit[kept], np.full(len(without), NO_CIRCUIT)])
    columns = _of_linkages(plan, linkage, motions.codes, motions.limits)
    if "circuits" in plan.measures:
        columns["circuits"] = motions.circuits[linkage].astype(np.float64)
    for measure in own:
        if measure.name == "circuit_type":
            # a circuit of an RSSR has the type of all of them
            words = WORDS[motions.codes[linkage]]
            words[circuit == NO_CIRCUIT] = None
            columns[measure.name] = words
        else:
            missing = np.full(len(without), np.nan)
            columns[measure.name] = np.concatenate([motions.columns[measure.name][kept], missing])
    return Block(linkage, circuit, _ok(linkage), columns)


def _of_linkages(
    plan: Plan, linkage: Integers, codes: npt.NDArray[np.uint8], limits: Floats
) -> dict[str, npt.NDArray[Any]]:
    """Columns (r,) of motion type and limits, of the linkage of each row."""
    columns: dict[str, npt.NDArray[Any]] = {}
    if "motion_type" in plan.measures:
        columns["motion_type"] = WORDS[codes[linkage]]
    if "limits" in plan.measures:
        columns["limits"] = np.isfinite(limits).sum(axis=1)[linkage].astype(np.float64)
    for place, name in enumerate(limit_names(plan)):
        columns[name] = np.degrees(limits[linkage, place])
    return columns


def _ok(linkage: Integers) -> npt.NDArray[np.object_]:
    return np.full(len(linkage), OK, dtype=object)
