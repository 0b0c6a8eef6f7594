"""General loops drawn as descriptions: families of the tests, shuffled kinds, worn galleries."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from evidence.fuzz import random_loops
from sevenbar.description.gallery import loops, text
from sevenbar.kinematics.loop.joints import KINDS

Description = dict[str, Any]
Draw = Callable[[np.random.Generator], Description]

#: Joints of a shuffled loop at least and at most, and the freedoms with which it is kept.
FEWEST, MOST = 3, 9
FREEDOMS_KEPT = range(4, 9)

#: Directions, places and numbers that people draw with.
DIRECTIONS = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (1, 1, 0), (1, 1, 1), (3, 4, 0))
ROUND = (0.0, 0.0, 1.0, -1.0, 2.0, 0.5, 10.0)
TWISTS = (0.0, 90.0, 180.0, -90.0, 45.0, 1e-9, 89.9999999)

#: Decades of a common scale, and of how far numbers of the gallery are worn off.
SCALE, WORN = 12, (-15, -1)


def _of_case(draw: Callable[[np.random.Generator], random_loops.Case]) -> Draw:
    return lambda rng: dict(draw(rng).linkage().description)


def shuffled(rng: np.random.Generator) -> Description:
    """Any kinds in any order; half the places and axes from a few that coincide, meet or are parallel."""
    while True:
        kinds = "".join(rng.choice(list("RRRRPPCUSSH"), rng.integers(FEWEST, MOST)))
        if "H" in kinds and rng.random() < 0.9:
            continue
        if sum(len(KINDS[kind].freedoms) for kind in kinds) in FREEDOMS_KEPT:
            break
    tidy = rng.random() < 0.7
    joints = [
        _tidied(rng, random_loops.place(rng, kind)) if tidy else random_loops.place(rng, kind)
        for kind in kinds
    ]
    scale = 10 ** rng.uniform(-SCALE, SCALE) if rng.random() < 0.2 else 1.0
    for joint in joints:
        joint["at"] = [float(scale * x) for x in joint["at"]]
        joint |= {key: np.asarray(joint[key], float).tolist() for key in ("axis", "axes") if key in joint}
    return {"format": 1, "joint": joints}


def _tidied(rng: np.random.Generator, joint: dict[str, Any]) -> dict[str, Any]:
    """A joint as drawn by people, or of a careless program."""
    joint["at"] = rng.choice(ROUND, 3)
    if "axis" in joint:
        joint["axis"] = DIRECTIONS[rng.integers(len(DIRECTIONS))]
    if "axes" in joint:
        joint["axes"] = [DIRECTIONS[k] for k in rng.choice(len(DIRECTIONS), 2, replace=False)]
    if "pitch" in joint:
        joint["pitch"] = float(rng.choice([0.0, 1.0, -2.5, 1e-9]))
    return joint


def rows(rng: np.random.Generator) -> Description:
    """Any kinds in any order; most places and axes from a few that coincide, meet or are parallel."""
    count = int(rng.integers(3, 9))
    links = []
    for kind in rng.choice(list("RRRRRP"), count):
        row: dict[str, Any] = {
            "joint": str(kind),
            "length": float(rng.choice(ROUND)),
            "twist": float(rng.choice(TWISTS)),
        }
        row["angle" if kind == "P" else "offset"] = float(rng.choice(TWISTS if kind == "P" else ROUND))
        links.append(row)
    if rng.random() < 0.3:
        # a link that is repeated, as in symmetric loops
        links = links[: count // 2 + 1] * 2
    return {"format": 1, "link": links[:8]}


def worn(rng: np.random.Generator) -> Description:
    """Denavit-Hartenberg rows of round numbers, three to eight; most are overconstrained or still."""
    import tomllib

    off = 10 ** rng.uniform(*WORN)
    chosen = str(rng.choice([name for name in loops() if not name.startswith("screw")]))

    def changed(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {
                key: v if key in ("link", "format") and isinstance(v, int) else changed(v)
                for key, v in value.items()
            }
        if isinstance(value, list):
            return [changed(v) for v in value]
        number = isinstance(value, int | float) and not isinstance(value, bool)
        return value * (1 + off * float(rng.normal())) if number else value

    return dict(changed(tomllib.loads(text(chosen))))


FAMILIES: dict[str, Draw] = {
    "general": _of_case(random_loops.general),
    "drawn": _of_case(random_loops.drawn),
    **{name: _of_case(draw) for name, draw in random_loops.SPECIAL.items()},
    **{name: _of_case(draw) for name, draw in random_loops.OVERCONSTRAINED.items()},
    "shuffled kinds": shuffled,
    "round rows": rows,
    "worn gallery": worn,
    "planar joints": _of_case(random_loops.planar),
}

SCREWS: dict[str, Draw] = {"screws": _of_case(random_loops.screws)}

#: Patterns of the batches: each goes through the core as one call.
PATTERNS = ("RRRRRRR", "RCCC", "RSCR", "RSSP", "RRSRR", "RUURR", "PRRRRRR", "RRRR", "RSPRR", "RSUR", "RERC")


def of_pattern(rng: np.random.Generator, kinds: str) -> Description:
    """Joints of these kinds anywhere, one in twenty placed roundly: these are dear."""
    joints = [random_loops.place(rng, kind) for kind in kinds]
    if rng.random() < 0.05:
        joints = [_tidied(rng, joint) for joint in joints]
    for joint in joints:
        joint |= {
            key: np.asarray(joint[key], float).tolist() for key in ("at", "axis", "axes") if key in joint
        }
    return {"format": 1, "joint": joints}
