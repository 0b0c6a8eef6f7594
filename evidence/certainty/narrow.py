"""Narrow circuits: their width by a walk along the loop, or in closed form, and whether they are found.

Joints of one linear complex have an isolated pose; a link moved by epsilon opens it to a circuit on the one
side, as wide as the root of epsilon, and to nothing on the other. A four-bar whose longest link is a little
shorter than the others together closes nearly stretched only.
"""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Callable

import numpy as np

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from evidence.certainty.family import Family, Judge
from evidence.certainty.limits import planar_limits, spherical_limits, widest
from evidence.fuzz.checks import hold
from evidence.fuzz.edges import SingularPose, singular_pose
from sevenbar.kinematics.loop.geometry import loop_frames

PART = "Narrow circuits"

#: Widths in the input [deg].
WIDTHS = (0.001, 5.0)

#: Kinds of joints, and how many linkages each.
KINDS = {
    "RRRRRRR": 24,
    "RRRPRRR": 12,
    "PRRRRRR": 12,
    "RCRRRR": 12,
    "RCCRR": 12,
    "RUURR": 12,
    "RSUR": 12,
    "RSCR": 12,
    "RRRSR": 12,
}

#: A link is moved by less than this, and joints turn by less, so that the lowest order gives the width.
MOST_MOVED, MOST_TURNED = 0.01, 0.1

#: Joints go no farther than so many times the velocity's own measure, on the circuit and from the pose to it.
FARTHEST = 6.0

#: Steps of the walk across a circuit, those of Newton's method to it, and where it has arrived.
ACROSS, NEWTON, CLOSED = 25, 30, 1e-12

#: The width of the walk and of the circuit agree to this part: its ends lie between two steps.
ALIKE = 0.01

#: The same of a width in closed form, and what the roundings of its dimensions are worth over the width.
EXACT, ROUNDING = 1e-6, 5e-15


def moved(pose: SingularPose, epsilon: float) -> sb.Linkage:
    """The joints in a singular pose, the fourth link moved along z; it is open where they are drawn."""
    linkage = sb.from_axes(pose.joints())
    frame = linkage.base.copy()
    links = linkage.links.copy()
    number = len(links) // 2
    for link in links[:number]:
        frame = frame @ link
    links[number][:3, 3] += epsilon * frame[2, :3]
    return dataclasses.replace(linkage, frames=loop_frames(linkage.base, links, linkage.ground))


def reach(pose: SingularPose) -> float:
    """Half the width in the input, squared, per epsilon, to the lowest order; negative on the other side."""
    return float(4 * pose.free[:, 0] @ np.linalg.solve(pose.form, pose.free[:, 0]))


def nearest_pose(loop: Loop, start: np.ndarray) -> np.ndarray | None:
    """A pose (m,) by Newton's method in all joints at once, `None` where there is none near."""
    q = start[None].copy()
    for _ in range(NEWTON):
        residual = loop.walk(q).residual(loop.size)[:, 0]
        if np.abs(residual).max() < CLOSED:
            return np.asarray(q[0])
        step = np.linalg.pinv(loop.jacobian(q)[0], rcond=1e-9) @ residual
        q = q - min(1.0, np.linalg.norm(start / loop.scales) / np.linalg.norm(step)) * step * loop.scales
    return None


def opened(kinds: str) -> Judge:
    """Judges a loop of these kinds on both sides of an isolated pose."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        width = math.radians(math.exp(rng.uniform(*np.log(WIDTHS))))
        while True:
            pose = singular_pose(rng, kinds)
            epsilon = (width / 2) ** 2 / abs(reach(pose))
            start = 2 * math.sqrt(epsilon / abs(pose.form[0, 0])) * pose.free[0]
            far = FARTHEST * np.abs(start).max()
            if epsilon < MOST_MOVED and far < FARTHEST * MOST_TURNED:
                break
        seen["loops"] += 1
        spans = []
        for side in (1, -1):
            linkage = moved(pose, side * epsilon)
            loop = Loop.of(linkage)
            near = nearest_pose(loop, start)
            motion = linkage.motion(24)
            hold(motion.completeness == "counted", f"{motion.completeness}, width {width:.2g}")
            narrow = [circuit for circuit in motion if stays_near(linkage, circuit, far)]
            if near is None or np.abs(near).max() > far:
                hold(not narrow, "a narrow circuit on the side on which the loop does not close")
                continue
            span = loop.span(near, 0, step=np.linalg.norm(start) / ACROSS)
            hold(len(narrow) == 1, f"{len(narrow)} circuits where the walk finds one {span:.3g} wide")
            low, high = narrow[0].input_range
            seen["walks that did not close"] += not math.isfinite(span)
            hold(
                not math.isfinite(span) or abs((high - low) / span - 1) < ALIKE,
                f"{high - low:.6g} wide, {span:.6g} by the walk",
            )
            spans.append(span)
        hold(len(spans) == 1, f"the walk finds a circuit on {len(spans)} sides")

    return judge


def stays_near(linkage: sb.Linkage, circuit: sb.Circuit, far: float) -> bool:
    """Whether no joint goes farther from where it was drawn."""
    turns = [kind == "turn" for kind in linkage.column_kinds]
    q = circuit.q[np.isfinite(circuit.q).all(axis=1)]
    around = np.where(turns, (q + math.pi) % math.tau - math.pi, q)
    return bool(np.abs(around).max(initial=0.0) < far)


def stretched(
    make: Callable[[np.ndarray], sb.Linkage], limits: Callable[[np.ndarray], list], unit: float
) -> Judge:
    """Judges a four-bar nearly stretched, by the limits of its input in closed form."""

    def judge(rng: np.random.Generator, seen: Counter[str]) -> None:
        wanted = math.radians(math.exp(rng.uniform(*np.log(WIDTHS))))
        short = unit * rng.uniform(0.2, 1.0, 3)
        at = int(rng.integers(4))

        def sides(epsilon: float) -> np.ndarray:
            return np.roll([short.sum() - epsilon, *short], at)

        epsilon = wanted**2 / 8 * unit
        for _ in range(3):
            epsilon *= (wanted / widest(limits(sides(epsilon)))) ** 2
        width = widest(limits(sides(epsilon)))
        motion = make(sides(epsilon)).motion(24)
        seen["loops"] += 1
        hold(motion.completeness == "counted", f"{motion.completeness}, width {width:.2g}")
        hold(
            len(motion.circuits) == 1, f"{len(motion.circuits)} circuits where there is one {width:.3g} wide"
        )
        low, high = motion[0].input_range
        hold(
            abs(high - low - width) < EXACT * width + ROUNDING / width,
            f"{high - low:.9g} wide, {width:.9g} in closed form",
        )

    return judge


def planar(length: np.ndarray) -> sb.Linkage:
    """A planar four-bar by its lengths, crank first."""
    return sb.from_dh("RRRR", length=length, twist=[0.0] * 4, offset=[0.0] * 4)


def spherical(side: np.ndarray) -> sb.Linkage:
    """A spherical four-bar by its sides [rad], crank first."""
    return sb.from_dh("RRRR", length=[0.0] * 4, twist=side, offset=[0.0] * 4)


FAMILIES = [
    *(Family(PART, f"{kinds}, narrow", count, opened(kinds)) for kinds, count in KINDS.items()),
    Family(PART, "planar 4R, nearly stretched", 30, stretched(planar, planar_limits, 1.0)),
    Family(PART, "spherical 4R, nearly stretched", 30, stretched(spherical, spherical_limits, 0.8)),
]
