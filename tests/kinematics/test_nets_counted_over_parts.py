"""Circuits of nets of several blocks of any kind are counted: each mode at 720 inputs lies on one of them.

Each net here has a circuit that lies between two of the 24 inputs at which modes are found.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_nets_counted import TURN, passes

import sevenbar as sb
from sevenbar.errors import RequestError


class Chain:
    """A crank, and blocks one after the other, each at the last link of the one before and at the ground."""

    def __init__(self, seed):
        self.random = np.random.default_rng([seed, 99])
        self.joints = [self.pin("crank", (0, 0), "g", "crank")]
        self.rods = []
        self.last = "crank"
        # the first place that was drawn is not in use
        self.place(2)

    @staticmethod
    def pin(name, at, a, b):
        return {"name": name, "kind": "R", "at": [*at, 0.0], "axis": [0, 0, 1], "between": [a, b]}

    def place(self, count=3):
        return list(np.round(self.random.uniform(-1, 1, count), 2))

    def direction(self):
        v = self.random.normal(size=3)
        return list(v / np.linalg.norm(v))

    def dyad(self, n):
        a, c, q = self.place(2), self.place(2), self.place(2)
        self.joints.append(self.pin(f"d{n}a", a, self.last, f"c{n}"))
        self.joints.append(self.pin(f"d{n}b", c, f"c{n}", f"k{n}"))
        self.joints.append(self.pin(f"d{n}c", q, f"k{n}", "g"))
        self.last = f"k{n}"

    def block(self, n):
        """A plate on three links."""
        for k, link in enumerate([self.last, "g", "g"]):
            self.joints.append(self.pin(f"b{n}{k}a", self.place(2), link, f"b{n}{k}"))
            self.joints.append(self.pin(f"b{n}{k}b", self.place(2), f"b{n}{k}", f"t{n}"))
        self.last = f"t{n}"

    def on_rod(self, n, kind):
        """A link on a joint at the ground and a rod."""
        own = {"name": f"r{n}", "kind": kind, "at": self.place(), "axis": self.direction()}
        self.joints.append(own | {"between": ["g", f"r{n}"]})
        between = [self.last, f"r{n}"]
        self.rods.append({"name": f"rod{n}", "between": between, "at": [self.place(), self.place()]})
        self.last = f"r{n}"

    def rocker(self, n):
        self.on_rod(n, "R")

    def slider(self, n):
        self.on_rod(n, "P")

    def linkage(self):
        return sb.from_axes(self.joints, rods=self.rods, ground="g", drive="crank")


def chain(blocks, seed):
    made = Chain(seed)
    for n, block in enumerate(blocks.split(), start=1):
        getattr(made, block)(n)
    return made.linkage()


def dead_centres(motion):
    return [d.input for circuit in motion for d in circuit.dead_centres if d.kind == "input"]


def check(linkage, motion):
    ends = dead_centres(motion)
    for angle in (0.001 + TURN * k / 720 for k in range(720)):
        if all(abs((angle - end + math.pi) % TURN - math.pi) > 2e-3 for end in ends):
            on_circuits = sum(passes(circuit, angle) for circuit in motion)
            assert on_circuits == len(linkage.assembly_modes(angle)), angle


CASES = [
    ("dyad block", 70, 6),
    ("dyad block", 38, 6),
    ("block dyad", 60, 8),
    ("block dyad", 83, 3),
    ("dyad rocker", 117, 4),
    ("dyad rocker", 45, 3),
    ("rocker rocker", 92, 4),
    ("rocker rocker", 9, 4),
    ("block rocker", 112, 8),
    ("block rocker", 26, 2),
    ("dyad rocker slider", 39, 4),
    ("dyad rocker slider", 108, 8),
]


@pytest.mark.parametrize(("blocks", "seed", "circuits"), CASES)
def test_no_circuit_is_missing(blocks, seed, circuits):
    linkage = chain(blocks, seed)
    motion = linkage.motion(720)
    assert (motion.completeness, motion.search.count.open, len(motion)) == ("counted", (), circuits)
    check(linkage, motion)


def unit(v):
    return v / np.linalg.norm(v)


def on_universal_legs(seed):
    """A link on a driven rod, three rods and two legs on universal joints that lean to their balls: these do not reach all round."""
    random = np.random.default_rng(seed)
    joints = [{"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": list(unit(random.normal(size=3)))}]
    joints[0]["between"] = ["g", "crank"]

    def own():
        return list(np.add(random.uniform(-1, 1, 3), [0, 0, 3]))

    def known():
        return list(random.uniform(-2, 2, 3))

    rods = []
    for k in range(4):
        at = known() if k else list(unit(random.normal(size=3)) * 0.5)
        between = ["g" if k else "crank", "body"]
        rods.append({"name": f"rod{k}", "between": between, "at": [at, own()]})
    for k in range(2):
        foot, ball = known(), own()
        second = unit(unit(np.subtract(ball, foot)) + 0.5 * random.normal(size=3))
        axes = [list(unit(np.cross(second, random.normal(size=3)))), list(second)]
        foot_joint = {"name": f"u{k}", "kind": "U", "at": foot, "axes": axes}
        joints.append(foot_joint | {"between": ["g", f"leg{k}"]})
        joints.append({"name": f"s{k}", "kind": "S", "at": ball, "between": [f"leg{k}", "body"]})
    return sb.from_axes(joints, rods=rods, ground="g", drive="crank")


@pytest.mark.parametrize(("seed", "circuits"), [(139, 2), (125, 10), (244, 8)])
def test_a_circuit_may_end_where_a_leg_reaches_no_farther(seed, circuits):
    # one circuit of each lies between two of 24 inputs
    motion = on_universal_legs(seed).motion(36)
    assert (motion.completeness, motion.search.count.open, len(motion)) == ("counted", (), circuits)
    # more than the branch points of the link alone, without its legs
    assert motion.search.count.dead_centres >= len({round(end % TURN, 6) for end in dead_centres(motion)})


@pytest.mark.parametrize("how", ["turned", "mirrored", "scaled"])
@pytest.mark.parametrize(("blocks", "seed", "circuits"), [CASES[0], CASES[7]])
def test_the_count_is_the_same_however_a_net_is_written(blocks, seed, circuits, how):
    turn = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]]) / 3
    by = {"turned": turn * np.sign(np.linalg.det(turn)), "mirrored": np.diag([1.0, -1.0, 1.0])}.get(
        how, np.eye(3)
    )
    size = 137.0 if how == "scaled" else 1.0
    made = Chain(seed)
    for n, block in enumerate(blocks.split(), start=1):
        getattr(made, block)(n)
    for table in made.joints:
        table["at"] = list(size * (by @ table["at"]))
        table["axis"] = list(by @ table["axis"])
    for rod in made.rods:
        rod["at"] = [list(size * (by @ at)) for at in rod["at"]]
    motion = made.linkage().motion(36)
    assert (motion.completeness, len(motion)) == ("counted", circuits)


def test_a_block_that_closes_nowhere_at_a_general_input_is_not_counted():
    made = Chain(38)
    made.block(1)
    made.dyad(2)
    # the plate turns about a place of the ground, and two links hold it
    same = {joint["name"]: joint for joint in made.joints}
    same["b11b"]["at"] = same["b11a"]["at"]
    with pytest.raises(RequestError, match="joint 'crank' stands still while others move"):
        made.linkage().motion(36)
