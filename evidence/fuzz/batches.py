"""Linkages in batches of the core, their arrays looked at, a share of them held against their own motion."""

from __future__ import annotations

import numpy as np

import sevenbar as sb
from evidence.fuzz.checks import Broken, hold
from evidence.fuzz.rssrs import Floats, description
from sevenbar.description.forms import from_description
from sevenbar.kinematics.measures import MEASURES
from sevenbar.kinematics.solvers.batches import (
    CODES,
    INVALID,
    WORDS,
    Motions,
    loop_motions,
    rssr_motions,
    rssr_types,
)

#: One linkage in so many is held against its own motion.
RSSRS_CROSSED, LOOPS_CROSSED = 200, 25

#: Rows of a turn of general loops, and of the motions that batches are held against.
SAMPLES = 36

#: Limits [rad, or parts of the size] of a batch and of the motion may differ by so much.
SAME_LIMIT = 1e-6

#: The number of limits that goes with each motion type of an RSSR; a change point may have any.
LIMITS = {
    "crank-rocker": {0},
    "double-crank": {0},
    "cannot-assemble": {0},
    "rocker-crank": {2, 4},
    "double-rocker": {2, 4},
    "invalid": {0},
    "change-point": {0, 1, 2, 3, 4},
}

#: Least transmission angle [deg] from which on the rates of an input that turns have extremes.
PASSING = 0.01


def of_rssrs(dimensions: Floats, side: str) -> list[str]:
    """The motion types of RSSRs (6, n) driven at one side, classified and measured."""
    codes, limits = rssr_types(dimensions, side, 1)
    words = WORDS[codes]
    counts = np.isfinite(limits).sum(axis=1)
    for place, (word, count, row) in enumerate(zip(words, counts, limits, strict=True)):
        _rising(row, count, f"linkage {place}")
        hold(count in LIMITS[word], f"{word} with {count} limits")
    speed = np.linspace(-2.0, 2.0, len(codes)) + 1e-3
    motions = rssr_motions(dimensions, side, speed, 1)
    hold((motions.types == words).all(), "classified otherwise than measured")
    hold((codes[~motions.clear] >= CODES.index("change-point")).all(), "not clear without a reason")
    kept = motions.clear[motions.linkage]
    _measured(motions, kept)
    turns = np.isin(motions.types[motions.linkage].astype(str), ("crank-rocker", "double-crank"))
    # branches that pass each other within rounding have rates without a digit
    columns = _columns(motions)
    passing = columns["transmission_lowest"] < PASSING
    for name in ("velocity_lowest", "velocity_highest", "acceleration_lowest", "jerk_highest"):
        finite = np.isfinite(columns[name])
        hold(
            ((finite == turns) | (turns & passing))[kept].all(),
            f"{name} is there where the input rocks, or not where it turns",
        )
    least, greatest = (
        columns["transmission_lowest"][kept],
        columns["transmission_highest"][kept],
    )
    hold(
        ((least >= 0) & (least <= greatest) & (greatest <= 90 + 1e-9)).all(),
        "transmission angles out of order",
    )
    return [str(word) for word in words]


def rssr_crossed(column: Floats, side: str) -> None:
    """One RSSR of a batch and its own motion have one type, one count of circuits, and limits alike."""
    codes, limits = rssr_types(column[:, None], side, 1)
    if codes[0] == INVALID:
        return
    motion = from_description(description(column)).motion(4, input=side)
    _alike(CODES[codes[0]], limits[0], motion)


def of_loops(linkages: list[sb.Linkage]) -> Motions:
    """What loops of one pattern come to at once."""
    first = linkages[0]
    ends = [first.columns.index(name) for name in (first.drive.joint, first.drive.output)]
    motions = loop_motions(linkages, *ends, SAMPLES, 1)
    for place, row in enumerate(motions.limits):
        _rising(row, int(np.isfinite(row).sum()), f"loop {place}", top=np.inf)
    kept = motions.clear[motions.linkage]
    _measured(motions, kept)
    return motions


def loop_crossed(linkage: sb.Linkage, motions: Motions, place: int) -> None:
    """One loop of a batch and its own motion agree."""
    motion = linkage.motion(SAMPLES, method="general")
    if not motions.clear[place]:
        hold(not motion.circuits, "a loop with circuits that the batch has not")
        return
    hold(len(motion.circuits) == motions.circuits[place], "another number of circuits than in the batch")
    _alike(str(motions.types[place]), motions.limits[place], motion)


def _alike(word: str, limits: Floats, motion: sb.Motion) -> None:
    hold(word == motion.motion_type, f"{word} in the batch, {motion.motion_type} alone")
    limits = limits[np.isfinite(limits)]
    hold(limits.size == motion.limits.size, f"{limits.size} limits in the batch, {motion.limits.size} alone")
    if limits.size:
        apart = np.abs(limits[:, None] - motion.limits)
        around = np.minimum(apart, np.abs(2 * np.pi - apart))
        size = max([1.0, *(circuit.size for circuit in motion)])
        hold((around.min(axis=1) < SAME_LIMIT * size).all(), "limits in the batch are others than alone")


def _rising(row: Floats, count: int, what: str, top: float = 2 * np.pi) -> None:
    hold(np.isnan(row[count:]).all(), f"{what}: a limit after one that is none")
    hold((np.diff(row[:count]) > 0).all(), f"{what}: limits do not rise")
    if top < np.inf:
        hold(((row[:count] >= 0) & (row[:count] < top)).all(), f"{what}: a limit outside a turn")


def _columns(motions: Motions) -> dict[str, np.ndarray]:
    """The measures (c,) of circuits that batches have, by name."""
    return {m.name: m.batch(motions) for m in MEASURES.values() if m.batch and m.per == "circuit"}


def _measured(motions: Motions, kept: np.ndarray) -> None:
    """Measures are finite or NaN, lowest and highest together."""
    columns = _columns(motions)
    for name, values in columns.items():
        if values.dtype == object:
            continue
        if np.isinf(values[kept]).any():
            raise Broken(f"{name} is infinite")
    for rate in ("velocity", "acceleration", "jerk"):
        low, high = (columns[f"{rate}_{end}"][kept] for end in ("lowest", "highest"))
        hold((np.isnan(low) == np.isnan(high)).all(), f"one end of {rate}")
        hold((~(low > high)).all(), f"{rate}: the lowest above the highest")
