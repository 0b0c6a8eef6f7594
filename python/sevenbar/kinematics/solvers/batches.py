"""Many linkages at once by the core: batches of given ones, and surveys, which it draws by their index."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

import sevenbar._core as _core
from sevenbar.arrays import Booleans, Floats, Integers
from sevenbar.kinematics.circuits.from_core import merged
from sevenbar.kinematics.loop.geometry import Loop, following_coupler
from sevenbar.kinematics.solvers.general import expanded
from sevenbar.text.printing import Printed

#: The core's codes of motion types, and of dimensions that make no linkage.
CODES = (
    "crank-rocker",
    "rocker-crank",
    "double-crank",
    "double-rocker",
    "change-point",
    "cannot-assemble",
    "invalid",
)

CHANGE_POINT, INVALID = CODES.index("change-point"), CODES.index("invalid")

#: The codes' words, as objects of a column.
WORDS = np.array(CODES, dtype=object)

#: The dimensions of an RSSR in the order of the core's rows.
RSSR_ROWS = ("M", "N", "L1", "L2", "L3", "D")

#: The core's word for a loop that its input drives.
DRIVEN = 0

#: Words of the motion types of linkages or circuits.
MotionTypes = npt.NDArray[np.object_]


def rssr_rows(own: Mapping[str, Floats | float], count: int, *, follows: bool) -> Floats:
    """The dimensions (6, n) of n RSSRs, in the order of `RSSR_ROWS`, from numbers or arrays (n,) by name.

    `follows`: L2 follows from the others, as where a file leaves it out.
    """
    rows = dict(own)
    if follows:
        rows["L2"] = following_coupler(rows["M"], rows["N"], rows["L1"], rows["L3"])
    return np.array([np.broadcast_to(rows[name], count) for name in RSSR_ROWS], dtype=np.float64)


@dataclass(frozen=True, eq=False, repr=False)
class Classified(Printed):
    """What n linkages can do: `types` (n,) are words; `limits` (n, m) [rad, or length] rise, then NaN."""

    types: MotionTypes
    limits: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Motions(Classified):
    """The results of the motions of n linkages.

    `clear` (n,) says which are classified here; of the others, that have a reason to give or must be followed
    further, nothing else means anything. `linkage` (c,) has the linkage of each circuit, `circuit` (c,) its
    number there, `circuit_types` (c,) its own type; `raw` is what the core measures of it. Measures by name
    are made of it by their rows: `measures.Measure.batch`.
    """

    clear: Booleans
    circuits: Integers
    linkage: Integers
    circuit: Integers
    circuit_types: MotionTypes
    raw: _core.RawMeasures
    output_turns: bool = True


def simd_level() -> str:
    """The vector unit that the core uses on this machine: results agree bit by bit within one level."""
    return _core.simd_level()


def rssr_types(dimensions: Floats, side: str, threads: int) -> tuple[npt.NDArray[np.uint8], Floats]:
    """Codes of motion types (n,) and limits (n, 4) [rad] of RSSRs.

    `dimensions` (6, n) has the rows `RSSR_ROWS` of the paper's layout; `side` "crank" or "rocker" drives.

    Source: docs/theory_many.md, (1) to (6).
    """
    return _core.classify_rssr(dimensions, side, threads)


def rssr_motions(dimensions: Floats, side: str, speed: Floats, threads: int) -> Motions:
    """Measures of the motions of RSSRs, the input of each moving at its `speed` (n,) [rad/s].

    The output range of a change point is not among it: that takes following. As `rssr_types` for the rest.
    """
    raw = _core.measure_rssr(dimensions, side, np.asarray(speed, np.float64), threads)
    codes, limits, counts = raw.codes, raw.limits, raw.circuits
    linkage, circuit = _numbered(counts)
    clear = (codes != INVALID) & (codes != CHANGE_POINT)
    types = WORDS[codes]
    # a circuit of an RSSR has the type of all of them
    return Motions(types, limits, clear, counts, linkage, circuit, types[linkage], raw.measures)


def loop_motions(linkages: Sequence[Loop], input: int, output: int, samples: int, threads: int) -> Motions:
    """Measures of the motions of loops of one pattern of joints, each at the speed of its drive.

    `input` and `output` are places of columns, `samples` inputs in a turn. Not clear are loops that the input
    does not drive, and those without a circuit, whose reason must be looked for.
    """
    parts = [expanded(linkage) for linkage in linkages]
    drawn = np.stack([linkage.drawn_pose for linkage in linkages])
    raw = _core.measure_loops(
        parts[0].letters,
        np.array([part.advances for part in parts]),
        np.stack([part.base for part in parts]),
        np.stack([part.ground for part in parts]),
        np.stack([np.array(part.links) for part in parts]),
        input,
        output,
        samples,
        np.array([linkage.speed_of(input) for linkage in linkages], dtype=np.float64),
        threads,
        drawn if drawn.any() else None,
    )
    linkage, circuit = _numbered(raw.circuits)
    types = np.array(raw.motion_types, dtype=object)
    own = np.array(raw.circuit_types, dtype=object)
    clear = (raw.status == DRIVEN) & (raw.circuits > 0)
    limits = _limits(raw, linkage, linkages, turns=linkages[0].turns(input))
    turns = linkages[0].turns(output)
    return Motions(types, limits, clear, raw.circuits, linkage, circuit, own, raw.measures, turns)


def _numbered(counts: Integers) -> tuple[Integers, Integers]:
    """The linkage of each circuit and its number there, from the circuits of each linkage."""
    linkage = np.repeat(np.arange(len(counts)), counts)
    firsts = np.cumsum(counts) - counts
    return linkage, np.arange(len(linkage)) - firsts[linkage]


def _limits(raw: _core.LoopBatch, linkage: Integers, linkages: Sequence[Loop], *, turns: bool) -> Floats:
    """The limits (n, m) of loops, from the input dead centres of their circuits."""
    count = len(linkages)
    owner = np.repeat(linkage, raw.limit_counts)
    inputs = raw.limits
    bounds = np.searchsorted(owner, np.arange(count + 1))
    result = [
        merged(inputs[first:last], turns=turns, size=1.0 if turns else loop.size)
        for loop, (first, last) in zip(linkages, pairwise(bounds), strict=True)
    ]
    limits = np.full((count, max(map(len, result), default=0)), np.nan)
    for row, values in zip(limits, result, strict=True):
        row[: len(values)] = values
    return limits


#: The numbers of an RSSR with axes at any angle, in the order of the core's rows.
NUMBERS = ("M", "N", "L1", "L2", "L3", "D", "angle")

#: Verdicts in the core's order; the first is that a linkage does what is wanted.
VERDICTS = (
    "found",
    "size",
    "assembly",
    "change point",
    "motion type",
    "dead centre",
    "transmission",
    "error",
    "ball angle",
)

#: The core's survey and the tally of a part of it.
CoreSurvey = _core.Survey
RawTally = _core.RawTally


def core_survey(bounds: Floats, seed: int, **wish: Any) -> CoreSurvey:
    """The core's survey of linkages between bounds (7, 2) [parts of a length, rad]; `wish` as it takes it."""
    return _core.Survey(np.asarray(bounds, np.float64), seed, **wish)
