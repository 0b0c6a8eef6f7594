"""Many RSSRs at once by the core's batches: motion types, limits and what circuits are told by, as arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar import _core
from sevenbar.motion import Floats, Integers

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

#: The dimensions of an RSSR in the order of the core's rows.
RSSR_ROWS = ("M", "N", "L1", "L2", "L3", "D")

#: Rates of the output, by the order of their derivative.
RATES = {"velocity": 1, "acceleration": 2, "jerk": 3}


@dataclass(frozen=True, eq=False)
class Motions:
    """What the motions of n linkages come to.

    `codes` (n,) index `CODES`; `limits` (n, 4) [rad] rise, NaN after the last. `linkage` (c,) has the
    linkage of each circuit, `circuit` (c,) its number there; `columns` (c,) its measures by name as
    `measures.MEASURES` has them, NaN where there is none.
    """

    codes: npt.NDArray[np.uint8]
    limits: Floats
    circuits: Integers
    linkage: Integers
    circuit: Integers
    columns: Mapping[str, Floats]


def simd_level() -> str:
    """The vector unit that the core uses on this machine: results agree bit by bit within one level."""
    return _core.simd_level()


def rssr_types(dimensions: Floats, side: str, threads: int) -> tuple[npt.NDArray[np.uint8], Floats]:
    """Codes of motion types (n,) and limits (n, 4) [rad] of RSSRs.

    `dimensions` (6, n) has the rows `RSSR_ROWS` of the paper's layout; `side` "crank" or "rocker" drives.
    """
    return _core.classify_rssr(np.ascontiguousarray(dimensions), side, threads)


def rssr_motions(dimensions: Floats, side: str, speed: Floats, threads: int) -> Motions:
    """What the motions of RSSRs come to, the input of each moving at its `speed` (n,) [rad/s].

    The output range of a change point is not among it: that takes following. As `rssr_types` for the rest.
    """
    raw = _core.measure_rssr(np.ascontiguousarray(dimensions), side, threads)
    counts = raw["circuits"]
    linkage = np.repeat(np.arange(len(counts)), counts)
    firsts = np.cumsum(counts) - counts
    return Motions(
        codes=raw["motion_type"],
        limits=raw["limits"],
        circuits=counts,
        linkage=linkage,
        circuit=np.arange(len(linkage)) - firsts[linkage],
        columns=_columns(raw, speed[linkage]),
    )


def _columns(raw: Mapping[str, Any], speed: Floats) -> dict[str, Floats]:
    """Measures (c,) of circuits from the core's arrays, at an input speed of each."""
    transmission = np.degrees(raw["transmission"])
    columns = {
        "turns": raw["turns"].astype(np.float64),
        "swing": np.degrees(raw["output_range"][:, 1] - raw["output_range"][:, 0]),
        "time_ratio": _time_ratio(raw),
        "transmission_lowest": transmission[:, 0],
        "transmission_highest": transmission[:, 2],
    }
    for name, order in RATES.items():
        ends = raw[name][:, [0, 2]] * (speed**order)[:, None]
        columns[f"{name}_lowest"], columns[f"{name}_highest"] = ends.min(axis=1), ends.max(axis=1)
    return columns


def _time_ratio(raw: Mapping[str, Any]) -> Floats:
    """The slower stroke over the quicker, of a full turn of the input with a rocking output."""
    rocks = np.isfinite(raw["output_range"]).all(axis=1) & np.isnan(raw["input_range"][:, 0])
    ends = raw["output_dead_centres"][rocks]
    stroke = (ends[:, 3] - ends[:, 1]) % math.tau
    ratio = np.full(len(rocks), np.nan)
    ratio[rocks] = np.maximum(stroke, math.tau - stroke) / np.minimum(stroke, math.tau - stroke)
    return ratio
