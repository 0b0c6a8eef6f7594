"""Drawn loops at other places."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from evidence.fuzz.random_loops import (
    Drawn,
    compound,
    drawn,
    planar_four_bar,
    spherical_four_bar,
)

Joints = list[dict[str, Any]]


#: Patterns of joints that come with every geometry: turning, sliding, compound, overconstrained.
KINDS = ("RRRRRRR", "RCCC", "RSSP", "RRSRR", "RUURR", "RSSR", "RPRRRRR", "PSUR")


def joints_of(seed: int) -> Joints:
    """A drawn loop, from C's and balls to four parallel axes."""
    rng = np.random.default_rng([31, seed])
    special: tuple[Callable[[np.random.Generator], Drawn], ...] = (
        compound,
        planar_four_bar,
        spherical_four_bar,
    )
    place = seed % (len(KINDS) + len(special))
    case = drawn(rng, KINDS[place]) if place < len(KINDS) else special[place - len(KINDS)](rng)
    return [{**joint, "name": f"j{i}"} for i, joint in enumerate(case.joints)]


def changed(
    joints: Joints, place: Callable[[np.ndarray], np.ndarray], axis: Callable[[str, np.ndarray], np.ndarray]
) -> Joints:
    """Each joint at another place, its axes by their kind of freedom: "turn" or "slide"."""
    made = []
    for joint in joints:
        new = {**joint, "at": place(np.asarray(joint["at"], float))}
        if "axis" in joint:
            new["axis"] = axis("slide" if joint["kind"] == "P" else "turn", np.asarray(joint["axis"], float))
        if "axes" in joint:
            new["axes"] = [axis("turn", np.asarray(a, float)) for a in joint["axes"]]
        made.append(new)
    return made
