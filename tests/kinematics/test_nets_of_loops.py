"""Blocks of nets that are single loops: against the loops one after the other, closed forms, and written in other ways."""

from __future__ import annotations

import numpy as np
import pytest
from test_nets_counted_over_parts import check as each_mode_is_passed_once

import sevenbar as sb

#: A planar four-bar, whose rocker drives another loop.
FOUR_BAR = [
    ("crank", "R", (0, 0, 0), (0, 0, 1), "frame", "crank"),
    ("a", "R", (10, 30, 0), (0, 0, 1), "crank", "coupler"),
    ("b", "R", (90, 70, 0), (0, 0, 1), "coupler", "rocker"),
    ("rocker", "R", (80, 0, 0), (0, 0, 1), "frame", "rocker"),
]

#: The loops that it drives: a spherical one about (80, 0, 50), and others in space.
DRIVEN = {
    "spherical": [
        ("s1", "R", (110, 40, 50), (30, 40, 0), "rocker", "arc"),
        ("s2", "R", (100, -30, 85), (20, -30, 35), "arc", "wiper"),
        ("last", "R", (120, -10, 40), (40, -10, -10), "frame", "wiper"),
    ],
    "RCCC": [
        ("c1", "C", (91, -18, 23), (1, -5, 3), "rocker", "one"),
        ("c2", "C", (88, 18, 63), (-9, -4, 0.3), "one", "two"),
        ("last", "C", (108, -37, 78), (-7, -5, -3), "two", "frame"),
    ],
    "RSRR": [
        ("e1", "R", (60, 10, 30), (1, 2, 0), "rocker", "one"),
        ("ball", "S", (80, 40, 60), None, "one", "two"),
        ("e2", "R", (110, 20, 50), (0, 1, 3), "two", "three"),
        ("last", "R", (120, 0, 10), (2, 0, 1), "three", "frame"),
    ],
    "RUSR": [
        ("cross", "U", (60, 10, 30), ((1, 0, 0), (0, 1, 0)), "rocker", "one"),
        ("ball", "S", (90, 40, 70), None, "one", "two"),
        ("last", "R", (120, 5, 20), (1, 1, 2), "two", "frame"),
    ],
    "RSPU": [
        ("ball", "S", (70, 20, 30), None, "rocker", "one"),
        ("slide", "P", (90, 40, 60), (1, 0, 1), "one", "two"),
        ("last", "U", (120, 5, 20), ((1, 1, 2), (1, -1, 0)), "two", "frame"),
    ],
    "RSPU, from the frame": [
        ("ball", "S", (70, 20, 30), None, "rocker", "one"),
        ("slide", "P", (90, 40, 60), (1, 0, 1), "one", "two"),
        ("back", "U", (120, 5, 20), ((1, -1, 0), (1, 1, 2)), "frame", "two"),
    ],
    "RRRSK": [
        ("r1", "R", (60, 10, 30), (1, 2, 0), "rocker", "one"),
        ("ball", "S", (70, 20, 30), None, "one", "two"),
        ("last", "K", (110, 5, 20), ((1, 2, 0), (2, -1, 3)), "two", "frame"),
    ],
    "RRRSK, from the frame": [
        ("r1", "R", (60, 10, 30), (1, 2, 0), "rocker", "one"),
        ("ball", "S", (70, 20, 30), None, "one", "two"),
        ("back", "K", (110, 5, 20), ((1, 2, 0), (2, -1, 3)), "frame", "two"),
    ],
    "RLSR": [
        ("pin", "L", (60, 10, 30), ((2, -1, 3), (1, 2, 0)), "rocker", "one"),
        ("ball", "S", (70, 20, 50), None, "one", "two"),
        ("last", "R", (110, 5, 20), (1, 2, 0), "two", "frame"),
    ],
    "RLSR, turned round": [
        ("back", "L", (60, 10, 30), ((2, -1, 3), (1, 2, 0)), "one", "rocker"),
        ("ball", "S", (70, 20, 50), None, "one", "two"),
        ("last", "R", (110, 5, 20), (1, 2, 0), "two", "frame"),
    ],
    "RESR": [
        ("plate", "E", (60, 10, 30), (1, 2, 0), "rocker", "one"),
        ("r2", "R", (100, 10, 40), (1, -2, 4), "one", "two"),
        ("r3", "R", (130, 40, 10), (1, -2, 0), "two", "three"),
        ("last", "R", (110, 5, 20), (1, 2, 7), "three", "frame"),
    ],
    "RRRRRRR": [
        ("r1", "R", (60, 10, 30), (1, 2, 0), "rocker", "one"),
        ("r2", "R", (70, 30, 40), (0, 1, 3), "one", "two"),
        ("r3", "R", (90, 40, 60), (2, 0, 1), "two", "three"),
        ("r4", "R", (110, 20, 50), (-1, 1, 0), "three", "four"),
        ("r5", "R", (120, 10, 30), (0, -1, 2), "four", "five"),
        ("last", "R", (110, -20, 10), (1, 1, -1), "five", "frame"),
    ],
}

#: As drawn.
STILL = np.eye(3)


def linkage(rows, drive="crank", turn=STILL, scale=1.0, rods=()):
    """The joints of rows, and rods, moved."""

    def moved(v):
        return (turn @ np.array(v, dtype=float)).tolist()

    joints = []
    for name, kind, at, axis, *between in rows:
        joint = {"name": name, "kind": kind, "at": moved(scale * np.array(at)), "between": between}
        # turns keep their sense in a mirror, so that slides of a cylinder change theirs
        sense = 1.0 if kind == "P" else np.linalg.det(turn)
        if kind in "UKL":
            joint["axes"] = [moved(sense * np.array(one)) for one in axis]
        elif axis is not None:
            joint["axis"] = moved(sense * np.array(axis))
        joints.append(joint)
    rods = [
        {"name": rod, "between": list(between), "at": [moved(scale * np.array(place)) for place in places]}
        for rod, between, places in rods
    ]
    return sb.from_axes(joints, rods=rods, ground="frame", drive=drive)


def same_modes(first, second, turning):
    """Whether modes (m, columns) are the same ones, angles up to whole turns."""
    off = first[:, None] - second[None]
    off = np.where(turning, (off + np.pi) % (2 * np.pi) - np.pi, off)
    near = np.abs(off).max(axis=2) < 1e-6
    return len(first) == len(second) and (near.sum(axis=0) == 1).all() and (near.sum(axis=1) == 1).all()


def one_after_the_other(four_bar, driven, value):
    """The modes of the four-bar and, for each, those of the loop that its rocker drives: values of all joints by name."""
    result = []
    for first in four_bar.assembly_modes(value).q:
        own = dict(zip(four_bar.columns, first, strict=True))
        for second in driven.assembly_modes(own["rocker"]).q:
            result.append(own | dict(zip(driven.columns, second, strict=True)))
    return result


@pytest.mark.parametrize("name", DRIVEN)
@pytest.mark.parametrize("drive", ["crank", "a"])
def test_a_loop_driven_by_a_four_bar_has_the_modes_of_both_one_after_the_other(name, drive):
    rows = FOUR_BAR + DRIVEN[name]
    net = linkage(rows, drive)
    assert [block.solver for block in net.order.blocks][-1] == "loop"
    four_bar, driven = linkage(FOUR_BAR, drive), linkage([FOUR_BAR[3], *DRIVEN[name]], "rocker")
    count = 0
    for value in (0.0, 0.7, -0.4, 2.1):
        modes = net.assembly_modes(value)
        assert modes.completeness == "algebraic"
        assert (modes.residual < 1e-10).all()
        known = one_after_the_other(four_bar, driven, value)
        # a plane joint has another x, and one that stands the other way round counts from the other link
        own = [k for k, column in enumerate(net.columns) if not column.startswith(("plate", "back"))]
        expected = np.array([[mode[net.columns[k]] for k in own] for mode in known])
        assert same_modes(modes.q[:, own], expected.reshape(-1, len(own)), net.turning[own]), value
        count += len(known)
    assert count > 2


@pytest.mark.parametrize(
    "name", ["RSPU", "RSPU, from the frame", "RRRSK", "RRRSK, from the frame", "RLSR, turned round"]
)
def test_a_loop_by_its_links_is_the_same_one_as_in_order(name):
    rows = [FOUR_BAR[3], *DRIVEN[name]]
    by_links = linkage(rows, "rocker")
    joints = []
    for joint_name, kind, at, axis, *_ in rows:
        # each joint's axes from the link before it to that after it
        turned = joint_name == "back"
        joint = {
            "name": joint_name,
            "kind": {"K": "L", "L": "K"}.get(kind, kind) if turned else kind,
            "at": at,
        }
        if kind in "UKL":
            joint["axes"] = axis[::-1] if turned else axis
        elif axis is not None:
            joint["axis"] = axis
        joints.append(joint)
    in_order = sb.from_axes(joints)
    own = [k for k, column in enumerate(in_order.columns) if not column.startswith(("back", "last"))]
    count = 0
    for value in (0.0, 0.1, 0.3, -0.7):
        first, second = by_links.assembly_modes(value), in_order.assembly_modes(value)
        assert same_modes(first.q[:, own], second.q[:, own], in_order.turning[own])
        count += len(first)
    assert count >= 2


#: A turn about an axis that is no other one's.
TURN = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3.0


@pytest.mark.parametrize("name", ["spherical", "RCCC", "RUSR", "RSPU"])
@pytest.mark.parametrize(
    ("turn", "scale"), [(TURN, 1.0), (np.diag([1.0, 1.0, -1.0]), 1.0), (STILL, 1e-3), (-TURN, 40.0)]
)
def test_the_same_net_elsewhere_has_the_same_modes(name, turn, scale):
    rows = FOUR_BAR + DRIVEN[name]
    net, other = linkage(rows), linkage(rows, turn=turn, scale=scale)
    own = [k for k, column in enumerate(net.columns) if not column.startswith("ball")]
    for value in (0.0, 0.7, 2.1):
        modes, moved = net.assembly_modes(value), other.assembly_modes(value)
        assert modes.completeness == moved.completeness == "algebraic"
        q = moved.q / np.where(net.turning, 1.0, scale * (np.linalg.det(turn) if name == "RCCC" else 1.0))
        assert same_modes(modes.q[:, own], q[:, own], net.turning[own])


@pytest.mark.parametrize("name", DRIVEN)
@pytest.mark.parametrize("drive", ["crank", "a"])
def test_each_mode_is_on_one_circuit(name, drive):
    net = linkage(FOUR_BAR + DRIVEN[name], drive)
    motion = net.motion(360)
    assert (motion.completeness, motion.search.count.open) == ("counted", ())
    own = [k for k, column in enumerate(net.columns) if not column.startswith("ball")]
    for row in range(0, 360, 15):
        value = 2 * np.pi * row / 360
        modes = net.assembly_modes(value)
        found = []
        for circuit in motion:
            off = (circuit.q[:, circuit.input_column] - value + np.pi) % (2 * np.pi) - np.pi
            found += list(circuit.q[np.abs(off) < 1e-9])
        assert same_modes(
            modes.q[:, own], np.array(found).reshape(-1, len(net.columns))[:, own], net.turning[own]
        )


#: Nets with a loop whose circuits two of the 24 inputs, at which modes were found before, leave out: rows, rods (name, links, places) and how many
#: circuits there are. The leg of the last two ends at pairs of modes that meet together.
NARROW = {
    "four-bar and RSRR": (
        [
            ("crank", "R", (0, 0, 0), (0, 0, 1), "frame", "crank"),
            ("a", "R", (-0.37, 0, 0), (0, 0, 1), "crank", "coupler"),
            ("b", "R", (0.95, -0.44, 0), (0, 0, 1), "coupler", "rocker"),
            ("rocker", "R", (0.89, -0.28, 0), (0, 0, 1), "rocker", "frame"),
            ("r1", "R", (0.67, 0.39, 0.18), (3, -1, 0), "rocker", "one"),
            ("ball", "S", (-0.87, 0.78, -0.11), None, "one", "two"),
            ("r2", "R", (0.5, 0.49, 0.78), (-3, -2, -1), "two", "three"),
            ("last", "R", (0.55, 0.83, 0.04), (-3, 2, 1), "frame", "three"),
        ],
        [],
        4,
    ),
    "RSSR and USR": (
        [
            ("crank", "R", (0, 0, 0), (0, 0, 1), "frame", "crank"),
            ("rocker", "R", (-0.51, -0.57, 0.32), (0.74, -0.51, 0.44), "frame", "rocker"),
            ("cross", "U", (-0.25, 0.03, 0.82), ((-1, 1, 0), (-4, -4, -7)), "rocker", "one"),
            ("ball", "S", (-0.3, -0.16, -0.93), None, "one", "two"),
            ("last", "R", (0.1, -0.82, -0.67), (-3, 3, -2), "two", "frame"),
        ],
        [("rod", ("crank", "rocker"), ((-0.93, -0.24, 0.39), (0.61, 0.35, -0.42)))],
        6,
    ),
    "SPU and RSSR": (
        [
            ("crank", "R", (0, 0, 0), (0, 0, 1), "frame", "crank"),
            ("ball", "S", (0.86, -0.42, 0.07), None, "one", "crank"),
            ("slide", "P", (0.08, 0.23, 0.26), (2, -2, 2), "one", "two"),
            ("cross", "U", (-0.92, -0.11, -0.51), ((1, 3, -2), (14, -12, -11)), "two", "frame"),
            ("rocker", "R", (-0.01, -0.6, -0.48), (-0.04, 0.94, 0.34), "frame", "rocker"),
        ],
        [("rod", ("two", "rocker"), ((0.93, -0.25, 0.4), (-0.22, -0.99, -0.72)))],
        5,
    ),
}


@pytest.mark.parametrize("how", ["as drawn", "turned", "mirrored", "scaled"])
@pytest.mark.parametrize("name", NARROW)
def test_no_circuit_of_a_loop_is_missing(name, how):
    rows, rods, circuits = NARROW[name]
    turn = np.array([[2.0, -2.0, 1.0], [1.0, 2.0, 2.0], [2.0, 1.0, -2.0]]) / 3
    by = {"turned": -turn, "mirrored": np.diag([1.0, -1.0, 1.0])}.get(how, STILL)
    net = linkage(rows, "crank", by, 137.0 if how == "scaled" else 1.0, rods)
    motion = net.motion(360)
    assert (motion.completeness, motion.search.count.open, len(motion)) == ("counted", (), circuits)
    if how == "as drawn":
        each_mode_is_passed_once(net, motion)


#: The angle [rad] between the shafts of two universal joints in a row.
BENT = np.arctan2(3.0, 4.0)


def shafts(second_forks, *, crosses=False):
    """Three shafts with a universal joint between each two; with its cross as a link of its own."""
    along, up = [4.0, 3.0, 0.0], [0.0, 0.0, 1.0]
    rows = [("in", "R", (-50, 0, 0), (1, 0, 0), "frame", "first")]
    for name, at, axes, between in [
        ("one", (0, 0, 0), ((0, 1, 0), up), ("first", "middle")),
        ("two", (80, 60, 0), second_forks, ("middle", "last")),
    ]:
        if crosses:
            rows.append((f"{name}.1", "R", at, axes[0], between[0], f"cross {name}"))
            rows.append((f"{name}.2", "R", at, axes[1], f"cross {name}", between[1]))
        else:
            rows.append((name, "U", at, axes, *between))
    rows.append(("middle", "R", (40, 30, 0), along, "frame", "middle"))
    rows.append(("out", "R", (130, 60, 0), (1, 0, 0), "frame", "last"))
    return linkage(rows, "in")


@pytest.mark.parametrize("crosses", [False, True])
@pytest.mark.parametrize(
    ("forks", "range_of_ratio"),
    [
        # both forks of the middle shaft in one plane: it turns evenly
        (((0, 0, 1), (0, 1, 0)), (1.0, 1.0)),
        # across each other: the ratios of both joints multiply
        (((-3, 4, 0), (0, 0, 1)), (np.cos(BENT) ** 2, np.cos(BENT) ** -2)),
    ],
)
def test_two_universal_joints_in_a_row(forks, range_of_ratio, crosses):
    net = shafts(forks, crosses=crosses)
    assert [block.group for block in net.order.blocks] == ["spherical", "spherical"]
    motion = net.motion(output="out")
    assert motion.completeness == "counted"
    assert len(motion) == 4
    for circuit in motion:
        assert circuit.velocity.lowest == pytest.approx(range_of_ratio[0], abs=1e-9)
        assert circuit.velocity.highest == pytest.approx(range_of_ratio[1], abs=1e-9)


#: A spherical loop about (4, 0, 2) that the rocker of a four-bar drives.
SPHERICAL = [
    ("crank", "R", (0, 0, 0), (0, 0, 1), "frame", "crank"),
    ("a", "R", (1, 0, 0), (0, 0, 1), "crank", "coupler"),
    ("b", "R", (4, 3, 0), (0, 0, 1), "coupler", "rocker"),
    ("rocker", "R", (4, 0, 0), (0, 0, 1), "frame", "rocker"),
    ("s1", "R", (4, 5.2, 2.2), (0, 2.6, 0.1), "rocker", "arc"),
    ("s2", "R", (3, -1, 2), (1, 1, 0), "arc", "wiper"),
    ("last", "R", (5, 0, 3), (1, 0, 1), "frame", "wiper"),
]


@pytest.mark.parametrize("places", [range(7), (4, 2, 1, 0, 5, 3, 6)])
def test_circuits_do_not_depend_on_the_order_of_joints(places):
    # where the four-bar's rows came after those of the loop that hangs on it, one circuit was lost
    motion = linkage([SPHERICAL[place] for place in places]).motion(24, output="last")
    assert motion.completeness == "counted"
    ranges = np.degrees([circuit.input_range for circuit in motion])
    assert sorted(np.round(ranges % 360.0, 3).tolist()) == [[212.567, 58.278], [301.722, 147.433]]


@pytest.mark.parametrize("output", ["last", "rocker"])
@pytest.mark.parametrize("off", [0.0, 1e-4, 3e-4, 1e-3, 0.1])
def test_a_circuit_has_its_whole_range_where_a_dead_centre_is_nearly_of_fourth_order(off, output):
    rows = [
        ("crank", "R", (0, 0, 0), (0, 0, 1), "frame", "crank"),
        ("a", "R", (1, 0, 0), (0, 0, 1), "crank", "coupler"),
        ("b", "R", (4, 3, 0), (0, 0, 1), "coupler", "rocker"),
        ("rocker", "R", (4, 0, 0), (0, 0, 1), "frame", "rocker"),
        ("cross", "U", (4, 0, 2), ((3, 4, 0), (0, 1, off)), "rocker", "wiper"),
        ("last", "R", (5, 1, 2), (1, 1, 0), "frame", "wiper"),
    ]
    (circuit,) = linkage(rows, "b").motion(output=output)
    assert np.degrees(circuit.input_range) == pytest.approx([0.0, 40.494], abs=1e-3)
