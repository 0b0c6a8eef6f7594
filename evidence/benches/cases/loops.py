"""Loops of seven turning joints: of no special geometry, with planted ones, and two known from papers."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import sevenbar as sb
from evidence import ROOT

#: Seed of all drawn loops.
SEED = 1

#: How far [rad] from the drawn pose the input is held, at most.
OFF = 0.3


@dataclass(frozen=True, eq=False)
class Problem:
    """A linkage, the input [rad] of which all modes are wanted, and poses (k, 7) known from elsewhere."""

    linkage: sb.Linkage
    theta: float
    known: np.ndarray


def drawn(rng: np.random.Generator, parallel: tuple[int, ...] = (), meeting: tuple[int, ...] = ()) -> Problem:
    """Seven axes anywhere, of which those counted (from 1) are parallel, or meet in one point."""
    at, axis = rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    for k in parallel[1:]:
        axis[k - 1] = axis[parallel[0] - 1]
    for k in meeting[1:]:
        at[k - 1] = at[meeting[0] - 1]
    joints = [{"kind": "R", "at": p, "axis": z} for p, z in zip(at, axis, strict=True)]
    return Problem(sb.from_axes(joints), float(rng.uniform(-OFF, OFF)), np.empty((0, 7)))


def sixteen() -> Problem:
    """The loop with sixteen real modes, all of them known: Liu and Zhu's arm closed by a seventh link."""
    raw = json.loads((ROOT / "tests/references/seven_r_sixteen_modes.json").read_text(encoding="utf-8"))
    loop = raw["loop"]
    linkage = sb.from_dh(
        "RRRRRRR", length=loop["length"], twist=np.radians(loop["twist_deg"]), offset=loop["offset"]
    )
    return Problem(linkage, float(np.radians(loop["theta1_deg"])), np.radians(raw["modes_deg"]))


def paper() -> Iterator[Problem]:
    """The 7R paper's linkage at the inputs at which its modes are known in 40 digits."""
    raw = json.loads((ROOT / "tests/references/seven_r_modes.json").read_text(encoding="utf-8"))
    poses = np.array([mode["theta"] for mode in raw["modes"]], dtype=np.float64)
    for theta in np.unique(poses[:, 0]):
        yield Problem(sb.load("seven_r"), float(theta), poses[poses[:, 0] == theta])


def families(general: int, planted: int) -> Iterator[tuple[str, list[Problem]]]:
    """So many loops of each kind, by name."""
    rng = np.random.default_rng(SEED)
    yield "no special geometry", [drawn(rng) for _ in range(general)]
    kinds: dict[str, dict[str, tuple[int, ...]]] = {
        "two parallel axes (3, 4)": {"parallel": (3, 4)},
        "two axes that meet (6, 7)": {"meeting": (6, 7)},
        "three parallel axes (3, 4, 5)": {"parallel": (3, 4, 5)},
        "three axes in a point (5, 6, 7)": {"meeting": (5, 6, 7)},
    }
    for name, geometry in kinds.items():
        yield name, [drawn(rng, **geometry) for _ in range(planted)]
    yield "the 7R paper's linkage", list(paper())
    yield "sixteen real modes", [sixteen()]
