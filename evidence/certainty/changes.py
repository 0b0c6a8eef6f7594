"""Change points and what lies next to them: the word, every mode on a circuit, no circuit twice.

Where two limits are within 1e-6 rad is decided by `limits`, for a 7R with a node by the second-order form
of the pose.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

import sevenbar as sb
from evidence.certainty.family import Family, Judge
from evidence.certainty.limits import Limits, nearest, planar_limits, rssr_limits, spherical_limits
from evidence.certainty.narrow import moved, reach
from evidence.fuzz import edges, rssrs
from evidence.fuzz.checks import circuits_are_distinct, hold, off_circuits
from evidence.fuzz.random_loops import direction
from sevenbar.description.forms import from_description

PART, NEARBY = "Change points", "Near a change"

#: Rows of a turn; modes are found at every fourth of these inputs, from the third on.
ROWS, FIRST, EVERY = 96, 3, 4

#: A mode is on a circuit that is as near as this [rad, or relative to the size]: a fourth root of roundings.
ON_CIRCUIT = 1e-4

#: Two limits nearer than this [rad] make a change point, and from here on none; between it is left open.
NEAR, APART = 1e-6, 1.3e-6

#: Decades by which a number is off a change point, and by which a node is opened.
OFF, GAPS = (-13, -5), (-12, -3)

Description = dict[str, Any]


def whole(motion: sb.Motion, seen: Counter[str]) -> None:
    """Nothing is lost and nothing there twice."""
    linkage = motion.linkage
    inputs = math.tau * np.arange(FIRST, ROWS, EVERY) / ROWS
    modes = np.concatenate([linkage.assembly_modes(value).q for value in inputs])
    seen["modes"] += len(modes)
    seen["circuits"] += len(motion.circuits)
    seen["change points"] += len(motion.change_points)
    lost = int((off_circuits(motion, modes) > ON_CIRCUIT).sum())
    hold(not lost, f"{lost} of {len(modes)} modes lie on no circuit, {motion.motion_type}")
    circuits_are_distinct(motion)


def worded(motion: sb.Motion, limits: Limits, others: Limits, seen: Counter[str]) -> None:
    """Whether the type is `change-point` where limits of the input are near; near the output's it may."""
    (real, every), other = nearest(limits), nearest(others)[1]
    changing = motion.motion_type == "change-point"
    seen["change-point"] += changing
    if motion.motion_type == "rigid" and real < NEAR:
        # nothing moves but a circuit so narrow, and it is reported as an isolated pose
        hold(motion.change_points and all(p.isolated for p in motion.change_points), "a pose is not named")
        seen["isolated pose"] += 1
        return
    hold(changing or real > NEAR, f"{motion.motion_type} with limits {real:.3g} rad apart")
    nearer = min(every, other)
    hold(not changing or nearer < APART, f"change-point with limits {nearer:.3g} rad apart")


def four_bar(
    draw: Callable[[np.random.Generator], Description], *, spherical: bool = False, off: bool = False
) -> Judge:
    """Judges planar or spherical four-bars of a family, one number `off` by little where wanted."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        described = draw(rng)
        if off:
            link = described["link"][rng.integers(4)]
            link["twist" if spherical else "length"] += rng.choice([-1, 1]) * 10 ** rng.uniform(*OFF)
        if "link" in described:
            key = "twist" if spherical else "length"
            sides = np.array([link[key] for link in described["link"]])
        else:
            places = np.array([joint["at"] for joint in described["joint"]])
            sides = np.linalg.norm(np.roll(places, -1, axis=0) - places, axis=1)
        limits = spherical_limits if spherical else planar_limits
        sides = np.radians(sides) if spherical else sides
        motion = from_description(described).motion(ROWS)
        # the output is the input of the linkage read backwards
        worded(motion, limits(sides), limits(sides[[2, 1, 0, 3]]), seen)
        whole(motion, seen)

    return judge


def rssr(method: Any) -> Judge:
    """Judges RSSRs whose coupler is a stationary distance of both circles, or off it by little."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        dimensions = rssrs.change_points(rng, 1)[:, 0]
        motion = from_description(rssrs.description(dimensions)).motion(ROWS, method=method)
        worded(motion, *rssr_limits(dimensions), seen)
        whole(motion, seen)

    return judge


def node(rng: np.random.Generator, seen: Counter[str]) -> None:
    """A 7R in whose drawn pose two branches are crossing, opened by a gap or not at all."""
    pose = edges.singular_pose(rng, "RRRRRRR", crossing=True)
    gap = rng.choice([-1, 1]) * 10 ** rng.uniform(*GAPS) if rng.random() < 0.9 else 0.0
    motion = moved(pose, gap).motion(ROWS)
    changing = motion.motion_type == "change-point"
    seen["change-point"] += changing
    apart = 2 * math.sqrt(abs(gap * reach(pose)))
    # on one side the limits are real, on the other a complex pair; which is which is not worked out
    hold(changing or gap, f"{motion.motion_type} at the node itself")
    hold(not changing or apart < APART, f"change-point with limits {apart:.3g} rad apart")
    whole(motion, seen)


def line_symmetric(rng: np.random.Generator) -> sb.Linkage:
    """Bricard's, as drawn: three axes, and three that are these turned by half a turn about a line."""
    joints = [(rng.uniform(-1, 1, 3), direction(rng)) for _ in range(3)]
    half = np.array([-1.0, -1.0, 1.0])
    joints += [(half * at, half * axis) for at, axis in joints]
    return turning(joints)


def plane_symmetric(rng: np.random.Generator) -> sb.Linkage:
    """Bricard's, as drawn: axes 1 and 4 in a plane, 5 and 6 the mirror images of 3 and 2."""
    first, second, third, fourth = [(rng.uniform(-1, 1, 3), direction(rng)) for _ in range(4)]
    mirror, flat = np.array([1.0, 1.0, -1.0]), np.array([1.0, 1.0, 0.0])
    in_plane = [(at * flat, axis * flat / np.linalg.norm(axis * flat)) for at, axis in (first, fourth)]
    mirrored = [(at * mirror, axis * mirror) for at, axis in (third, second)]
    return turning([in_plane[0], second, third, in_plane[1], *mirrored])


def turning(axes: Iterable[tuple[np.ndarray, np.ndarray]]) -> sb.Linkage:
    """Axes of R joints as drawn."""
    return sb.from_axes([edges.joint_at("R", at, axis) for at, axis in axes])


def round_bricard(rng: np.random.Generator) -> sb.Linkage:
    """Bricard's line-symmetric one in rows of round numbers, three of them twice: branches meet in many."""
    while True:
        length, offset = rng.choice([0.5, 1.0, 2.0], 3), rng.choice([0.0, 0.0, -1.0, 1.0], 3)
        twist = np.radians(rng.choice([60.0, 90.0, -90.0, 120.0], 3))
        linkage = sb.from_dh("R" * 6, length=[*length] * 2, twist=[*twist] * 2, offset=[*offset] * 2)
        if linkage.motion(24).circuits:
            return linkage


def threefold(rng: np.random.Generator) -> sb.Linkage:
    """Bricard's of threefold symmetry: lengths 1, twists alpha and -alpha in turn, in whole degrees."""
    alpha = math.radians(float(rng.integers(60, 121)))
    if rng.random() < 0.3:
        alpha = math.radians(float(rng.choice([60.0, 90.0, 120.0])))
    return sb.from_dh("R" * 6, length=[1.0] * 6, twist=[alpha, -alpha] * 3, offset=[0.0] * 6)


def loops(draw: Callable[[np.random.Generator], sb.Linkage]) -> Judge:
    """Judges loops that move, whose limits have no closed form here."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        motion = draw(rng).motion(ROWS)
        seen["change-point"] += motion.motion_type == "change-point"
        hold(motion.circuits, motion.motion_type)
        whole(motion, seen)

    return judge


FAMILIES = [
    Family(
        PART, "four-bars, s + l = p + q, in tenths and hundredths", 2000, four_bar(edges.at_change), quick=4
    ),
    Family(PART, "parallelograms as drawn", 250, four_bar(edges.parallelogram)),
    Family(PART, "kites and rhombi as drawn", 250, four_bar(edges.kite)),
    Family(
        PART,
        "spherical four-bars in tens of degrees",
        250,
        four_bar(edges.spherical_at_change, spherical=True),
    ),
    Family(PART, "Bricard, three round rows twice", 100, loops(round_bricard)),
    Family(PART, "Bricard, threefold, whole degrees", 100, loops(threefold)),
    Family(PART, "7R with a node", 200, node),
    Family(NEARBY, "four-bars, a length off", 500, four_bar(edges.at_change, off=True)),
    Family(
        NEARBY,
        "spherical four-bars, a side off",
        250,
        four_bar(edges.spherical_at_change, spherical=True, off=True),
    ),
    Family(NEARBY, "RSSR, closed form", 125, rssr("auto")),
    Family(NEARBY, "RSSR, general way", 125, rssr("general")),
]
