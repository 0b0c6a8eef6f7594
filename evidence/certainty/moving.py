"""Loops that are shaky and do not move, and overconstrained ones that do, by what is proved of each.

A pose with infinitesimal freedoms is rigid where no velocity makes all second-order forms zero. Source: the
theory of second-order rigidity; loops that move are those of Bennett, Sarrus, Bricard, planar and spherical.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from evidence.certainty import screw_loops
from evidence.certainty.changes import line_symmetric, plane_symmetric, turning
from evidence.certainty.family import Family, Judge
from evidence.fuzz import edges
from evidence.fuzz.checks import hold
from evidence.fuzz.random_linkages import random_rotation
from evidence.fuzz.random_loops import bennett, direction, planar_four_bar, spherical_four_bar
from sevenbar.description.forms import from_description

SHAKY, MOVING, SCREWS = "Shaky loops", "Loops that move", "Loops of screws"

#: Rows of a turn, few: only what the motion is counts.
ROWS = 24

#: Starts from which the least second-order form of a unit velocity is searched for.
STARTS = 12

#: Words of loops that have no motion.
STILL = {"rigid", "not-followed", "cannot-assemble", "two-inputs"}


def second_order(linkage: sb.Linkage) -> tuple[int, float]:
    """How many infinitesimal freedoms the drawn pose has, and the least second-order form of a unit velocity.

    Where it is above zero no velocity begins a motion, whatever the accelerations.
    """
    screws = Loop.of(linkage).jacobian(np.zeros((1, len(linkage.columns))))[0]
    _, free, forms = edges.second_order_forms(screws)
    if not len(free):
        return 0, 0.0

    def length(v: np.ndarray) -> float:
        values = np.einsum("kab,a,b->k", forms, v, v) / (v @ v)
        return float(values @ values)

    starts = np.random.default_rng(0).normal(size=(STARTS, len(free)))
    return len(free), math.sqrt(min(minimize(length, start).fun for start in starts))


def shaky(draw: Callable[[np.random.Generator], sb.Linkage]) -> Judge:
    """Judges loops with infinitesimal freedoms that the second order holds."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        while True:
            linkage = draw(rng)
            freedoms, form = second_order(linkage)
            if form > edges.CLEARLY:
                break
        seen[f"{freedoms} infinitesimal"] += 1
        motion, mobility = linkage.motion(ROWS), linkage.mobility()
        hold(motion.motion_type == "rigid", f"{motion.motion_type}, {freedoms} infinitesimal freedoms")
        hold(mobility.finite == 0, f"moves with {mobility.finite}, {freedoms} infinitesimal freedoms")

    return judge


def regulus(rng: np.random.Generator) -> sb.Linkage:
    """Four to six axes of one family of lines of a hyperboloid."""
    a, b, c = rng.uniform(0.5, 2, 3)
    turn = rng.uniform(0, math.tau, int(rng.integers(4, 7)))
    at = np.stack([a * np.cos(turn), b * np.sin(turn), 0 * turn], axis=1)
    along = np.stack([-a * np.sin(turn), b * np.cos(turn), c + 0 * turn], axis=1)
    return turning(zip(at, along, strict=True))


def in_line(rng: np.random.Generator) -> sb.Linkage:
    """Four to seven parallel axes in one plane, the longest link as long as the others together."""
    count = int(rng.integers(4, 8))
    rotation = random_rotation(rng)
    along = np.cumsum(rng.uniform(0.3, 1.0, count))
    return turning((rotation @ [x, 0.0, 0.0], rotation[:, 2]) for x in along)


def on_great_circle(rng: np.random.Generator) -> sb.Linkage:
    """Four to seven axes through one point, in one plane within less than half a turn."""
    turn = np.sort(rng.uniform(0, 0.8 * math.pi, int(rng.integers(4, 8))))
    rotation, centre = random_rotation(rng), rng.normal(size=3)
    axes = [rotation @ [math.cos(t), math.sin(t), 0.0] for t in turn]
    return turning((centre + rng.normal() * axis, axis) for axis in axes)


def moves(draw: Callable[[np.random.Generator], sb.Linkage]) -> Judge:
    """Judges loops that are known to move with one freedom."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        linkage = draw(rng)
        motion, mobility = linkage.motion(ROWS), linkage.mobility()
        hold(motion.circuits, f"{motion.motion_type} where it moves")
        hold(mobility.finite == 1, f"moves with {mobility.finite} where it moves with 1")
        seen["circuits"] += len(motion.circuits)

    return judge


def sarrus(rng: np.random.Generator) -> sb.Linkage:
    """Three parallel axes, and three others parallel."""
    axes = [direction(rng), direction(rng)]
    return turning((rng.normal(size=3), axes[k // 3]) for k in range(6))


def slider_crank(rng: np.random.Generator) -> sb.Linkage:
    """Three parallel axes and a slide across, anywhere in space."""
    rotation = random_rotation(rng)
    joints = [edges.joint_at("R", rng.normal(size=3), rotation[:, 2]) for _ in range(3)]
    slope = rng.uniform(0, math.tau)
    slide = rotation @ [math.cos(slope), math.sin(slope), 0.0]
    return sb.from_axes([*joints, edges.joint_at("P", rng.normal(size=3), slide)])


def screws(family: screw_loops.Draw, freedoms: int) -> Judge:
    """Judges loops of screws: each input has the verdict of `mobility`, which is known."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        linkage = sb.from_axes(family(rng, int(rng.choice([1, 2, 9]))))
        finite = linkage.mobility().finite
        verdicts = {column: screw_loops.moves(linkage, column) for column in linkage.drivable()}
        seen["inputs"] += len(verdicts)
        hold(finite == freedoms, f"moves with {finite} where it moves with {freedoms}")
        against = [column for column, verdict in verdicts.items() if verdict != bool(freedoms)]
        hold(not against, f"moves with {finite}, otherwise by {', '.join(against)}")

    return judge


FAMILIES = [
    Family(
        SHAKY, "axes that meet one or two lines", 150, shaky(lambda rng: from_description(edges.shaky(rng)))
    ),
    Family(SHAKY, "axes of one regulus", 150, shaky(regulus)),
    Family(SHAKY, "parallel axes in one plane", 100, shaky(in_line)),
    Family(SHAKY, "axes of one pencil", 100, shaky(on_great_circle)),
    Family(MOVING, "Bennett", 100, moves(lambda rng: bennett(rng).linkage())),
    Family(MOVING, "planar 4R", 80, moves(lambda rng: planar_four_bar(rng).linkage())),
    Family(MOVING, "spherical 4R", 80, moves(lambda rng: spherical_four_bar(rng).linkage())),
    Family(MOVING, "slider-crank", 60, moves(slider_crank)),
    Family(MOVING, "Sarrus", 60, moves(sarrus)),
    Family(MOVING, "Bricard, line-symmetric", 60, moves(line_symmetric)),
    Family(MOVING, "Bricard, plane-symmetric", 60, moves(plane_symmetric)),
    *(
        Family(
            SCREWS, "screws as " + family.__name__.replace("_", " "), 200, screws(family, freedoms), quick=1
        )
        for family, freedoms in screw_loops.FAMILIES.items()
    ),
]
