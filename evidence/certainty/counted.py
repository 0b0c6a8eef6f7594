"""Whether the account of branch points closes, and a search at 720 inputs finds no mode off the circuits."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable

import numpy as np

import sevenbar as sb
from evidence.certainty.family import Family, Judge
from evidence.fuzz.checks import hold, off_circuits
from evidence.fuzz.random_linkages import assembled_square, skew
from evidence.fuzz.random_loops import drawn, general
from sevenbar.kinematics.loop.law import Law

PART = "Circuits counted"

#: Inputs of the search.
INPUTS = 720

#: A mode is on a circuit that is as near as this [rad, or relative to the size] at the same input.
ON_CIRCUIT = 1e-5

#: Slides are followed to 50 sizes, so modes are taken up to here, and a sliding input is driven as far.
FARTHEST, FAR_INPUT = 40.0, 3.0

KINDS = ("RRRSR", "RCSR", "PRRRRRR", "RCCC", "RPRRRPR", "RUURR", "RSUR", "RRRPRRR")


def searched(draw: Callable[[np.random.Generator], sb.Linkage]) -> Judge:
    """Judges all circuits of a linkage by the general way."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        linkage = draw(rng)
        motion, inputs = rows_and_inputs(linkage)
        modes = np.concatenate([linkage.assembly_modes(x, method="general").q for x in inputs])
        slides = [kind == "slide" for kind in linkage.column_kinds]
        near = np.abs(modes[:, slides]).max(axis=1, initial=0.0) < FARTHEST * linkage._general.size
        lost = int((off_circuits(motion, modes[near]) > ON_CIRCUIT).sum())
        seen["modes"] += len(modes)
        seen["circuits"] += len(motion.circuits)
        seen["dead centres of inputs"] += sum(d.kind == "input" for c in motion for d in c.dead_centres)
        count = motion.search.count
        seen["complex branch points"] += count.complex_branch_points if count else 0
        seen["poles"] += count.poles if count else 0
        seen["accounts from more than one circle"] += bool(count and count.circles > 1)
        hold(not lost, f"{lost} modes of the search lie on no circuit")
        hold(motion.completeness == "counted", f"{motion.completeness}: {left_open(motion)}")

    return judge


def rows_and_inputs(linkage: sb.Linkage) -> tuple[sb.Motion, np.ndarray]:
    """Every circuit with a row at each input of the search: all round a turn, or along a slide by a law."""
    if linkage.turns(linkage.drive.joint):
        return linkage.motion(INPUTS, method="general"), math.tau * np.arange(INPUTS) / INPUTS
    far = FAR_INPUT * linkage._general.size
    inputs = np.linspace(-far, far, INPUTS)
    law = Law.of(np.arange(INPUTS, dtype=np.float64), inputs, 1.0, 0.0)
    return linkage.motion(law=law, method="general"), inputs


def left_open(motion: sb.Motion) -> str:
    """The ranges that do not balance, in words."""
    count = motion.search.count
    if count is None:
        return str(motion.search.uncounted)
    return ", ".join(f"{r.start:.9g} to {r.end:.9g} ({r.missing})" for r in count.open)


FAMILIES = [
    Family(PART, "7R", 1000, searched(lambda rng: general(rng).linkage())),
    Family(PART, "RSSR, skew axes", 100, searched(lambda rng: skew(rng).linkage())),
    Family(PART, "RSSR, axes at right angles", 100, searched(lambda rng: assembled_square(rng).linkage())),
    *(
        Family(PART, kinds, 200, searched(lambda rng, kinds=kinds: drawn(rng, kinds).linkage()))
        for kinds in KINDS
    ),
]
