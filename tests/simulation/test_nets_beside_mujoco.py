"""Poses and rates of nets against MuJoCo's own constraints of free bodies, made of the description alone.

Of Sevenbar there are the places of four points of each link and their rates, and nothing of how it finds them. MuJoCo
says whether joints hold there, how they would open, and what moves freely; rates of a higher order come from
differences of its rows along the motion.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import pytest

import sevenbar as sb
from free_bodies import FreeBodies

#: Rows of each circuit.
ROWS = 24

#: Points of joints apart, in sizes.
APART = 1e-12

#: What is left of velocities, of accelerations, of jerks, relative to the greatest component or term: of their rows, and
#: of the input's, which has its speed alone.
LEFT = (1e-12, 1e-9, 1e-6)

#: Of the links' velocities, what lies outside MuJoCo's free motion.
OUTSIDE = 1e-11

#: A singular value below this is zero, relative to the greatest; and how many times greater the next must be.
ZERO, GAP = 1e-10, 1e5

#: How far bodies are moved to differentiate once and twice, in sizes and radians.
STEPS = (1e-5, 2e-4)

#: A shaper with a pin in a slot either way, whose ram turns a flap by a ball and a sleeve; a table that slides in a plane.
KINDS = {
    "shaper": """
        format = 1
        ground = "frame"
        drive = { joint = "crank" }
        joint = [
            { name = "crank", kind = "R", at = [0, 30, 0], axis = [0, 0, 1], between = ["frame", "crank"] },
            { name = "one", kind = "L", at = [12, 36, 0], axes = [[0, 0, 1], [1, 3, 0]], between = ["crank", "lever"] },
            { name = "lever", kind = "R", at = [0, 0, 0], axis = [0, 0, 1], between = ["frame", "lever"] },
            { name = "two", kind = "K", at = [30, 90, 0], axes = [[0, 1, 0], [0, 0, 1]], between = ["ram", "lever"] },
            { name = "ram", kind = "P", at = [30, 90, 0], axis = [1, 0, 0], between = ["frame", "ram"] },
            { name = "ball", kind = "S", at = [50, 90, 10], between = ["ram", "link"] },
            { name = "sleeve", kind = "C", at = [80, 70, 40], axis = [1, 0.2, 0.3], between = ["link", "flap"] },
            { name = "flap", kind = "R", at = [110, 40, 60], axis = [0.2, 1, 0], between = ["frame", "flap"] },
        ]""",
    "table": """
        format = 1
        ground = "frame"
        drive = { joint = "crank" }
        joint = [
            { name = "crank", kind = "R", at = [0, 0, 0], axis = [0, 0.2, 1], between = ["frame", "crank"] },
            { name = "table", kind = "E", at = [90, 10, 20], axis = [0.1, 0.3, 1], between = ["frame", "table"] },
        ]
        rod = [
            { between = ["crank", "table"], at = [[15, 0, 0], [70, 10, 30]] },
            { between = ["frame", "table"], at = [[60, 80, 10], [70, 40, 25]] },
            { between = ["frame", "table"], at = [[120, 90, 0], [110, 30, 40]] },
        ]""",
}

#: Nets of the gallery that another joint may drive, which then are solved in another order.
DRIVEN = [
    ("stephenson", "lever"),
    ("watt", "lever"),
    ("klann", "long rocker"),
    ("double_wishbone", "upper arm"),
    ("rssr_ss", "rocker"),
]

SPATIAL = ("double_wishbone", "five_rod", "platform", "rssr_ss")


@dataclass(frozen=True, eq=False)
class Moving:
    """A link along a circuit: its rotation and its place, and its rates up to the jerk as MuJoCo counts velocities."""

    rotation: np.ndarray
    place: np.ndarray
    rates: tuple[np.ndarray, np.ndarray, np.ndarray]


def moving(circuit, number, size):
    """A link by its number, from the motions of four of its points."""
    origin, *ends = (circuit.point(number, at) for at in (np.zeros(3), *(size * np.eye(3))))
    names = ("position", "velocity", "acceleration", "jerk")
    places = [getattr(origin, name) for name in names]
    R, dR, ddR, dddR = (
        np.stack([getattr(end, name) - place for end in ends], axis=-1) / size
        for name, place in zip(names, places, strict=True)
    )

    def by(first, second):
        return np.swapaxes(first, -1, -2) @ second

    # the velocity of turning in the link's own axes, as a matrix, and its derivatives
    spins = (by(R, dR), by(dR, dR) + by(R, ddR), by(ddR, dR) + 2 * by(dR, ddR) + by(R, dddR))
    vectors = (np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=-1) for spin in spins)
    rates = tuple(np.hstack([place / size, own]) for place, own in zip(places[1:], vectors, strict=True))
    return Moving(R, places[0], rates)


def completed(J, columns, known, bent):
    """All rates of one order: those of the links as they are known, those of rods, crosses and slides from the rows."""
    others = np.setdiff1d(np.arange(J.shape[1]), columns)
    result = np.zeros(J.shape[1])
    result[columns] = known
    result[others] = np.linalg.lstsq(J[:, others], -(J @ result + bent), rcond=ZERO)[0]
    return result


def free_motions(J):
    """Motions (count, columns) that the rows leave free."""
    _, values, right = np.linalg.svd(J)
    rank = int((values > ZERO * values[0]).sum())
    assert values[rank - 1] > GAP * ZERO * values[0]
    return right[rank:]


def compared(bodies, links, row, speed):
    """What is left at one row of a circuit whose input has this speed, in the order of `check`."""
    q = bodies.place({name: (link.rotation[row], link.place[row]) for name, link in links.items()})
    known = [np.concatenate([link.rates[order][row] for link in links.values()]) for order in range(3)]
    apart, J = bodies.constraints(q)

    v = completed(J, bodies.columns, known[0], 0.0)
    first = np.abs(v).max()

    time = STEPS[0] / first
    after, before = (bodies.constraints(bodies.moved(q, v, t))[1] for t in (time, -time))
    dJ = (after - before) / (2 * time)
    a = completed(J, bodies.columns, known[1], dJ @ v)
    second = max(np.abs(a).max(), first**2)

    time = STEPS[1] / max(first, second**0.5)
    after, before = (bodies.constraints(bodies.moved(q, v + a * t / 2, t))[1] for t in (time, -time))
    bent = (after - 2 * J + before) / time**2 @ v + 2 * dJ @ a
    j = completed(J, bodies.columns, known[2], bent)
    third = max(np.abs(j).max(), first * second)

    free = free_motions(J)
    # rods spin, links do not: of the links there is one free motion
    directions, sizes, _ = np.linalg.svd(free[:, bodies.columns].T, full_matrices=False)
    assert (sizes > 1e-6).sum() == 1
    along = directions[:, 0] * (directions[:, 0] @ known[0])
    outside = np.linalg.norm(known[0] - along) / np.linalg.norm(known[0])
    left = (
        max(np.abs(rows).max(), abs(bodies.input(rates) - driven)) / scale
        for rows, rates, driven, scale in (
            (J @ v, v, speed, first),
            (dJ @ v + J @ a, a, 0.0, second),
            (bent + J @ j, j, 0.0, third),
        )
    )
    return len(free), (np.abs(apart).max(), *left, outside)


def compare(text):
    """All circuits of a net, at rows spread over each; the greatest differences."""
    linkage, bodies = sb.loads(text), FreeBodies(text)
    mobility, greatest = linkage.mobility(), np.zeros(5)
    motion = linkage.motion(2 * ROWS)
    assert motion.circuits
    for circuit in motion:
        links = {
            name: moving(circuit, linkage.link_names.index(name) + 1, bodies.size) for name in bodies.links
        }
        speed = circuit.speed / (1.0 if circuit.input_turns else bodies.size)
        good = np.flatnonzero(circuit.status == "ok")
        for row in np.unique(good[np.linspace(0, len(good) - 1, ROWS).astype(int)]):
            free, differences = compared(bodies, links, row, speed)
            # each rod spins
            assert free - len(bodies.rods) == mobility.gruebler + len(mobility.redundant) == 1
            greatest = np.maximum(greatest, differences)
    return greatest


def driven_at(joint, text):
    """The same net with another input."""
    result, count = re.subn(r"(?m)^\[drive\]\n(?:.+\n)+", f'[drive]\njoint = "{joint}"\n', text)
    assert count == 1
    return result


def check(text):
    apart, *left, outside = compare(text)
    assert apart < APART
    assert (np.array(left) < LEFT).all()
    assert outside < OUTSIDE


@pytest.mark.parametrize("name", [name for name in sb.gallery.nets() if name not in SPATIAL])
def test_planar_nets_move_as_mujoco_holds_free_bodies(name):
    check(sb.gallery.text(name))


@pytest.mark.parametrize("name", SPATIAL)
def test_nets_in_space_move_as_mujoco_holds_free_bodies(name):
    check(sb.gallery.text(name))


@pytest.mark.parametrize("name", KINDS)
def test_slots_sleeves_and_tables_move_as_mujoco_holds_free_bodies(name):
    check(KINDS[name])


@pytest.mark.parametrize(("name", "joint"), DRIVEN)
def test_nets_driven_at_another_joint_move_as_mujoco_holds_free_bodies(name, joint):
    check(driven_at(joint, sb.gallery.text(name)))
