"""RSSRs of which a ball passes the other axis at the coupler's distance: that side is free there, and rests or moves on."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.kinematics.circuits.from_core import change_points_from

Z = (0.0, 0.0, 1.0)


def drawn(turn: np.ndarray[Any, Any], scale: float, *, backwards: bool) -> sb.Linkage:
    """Crank 3 about z and rocker 4 about x through the origin, the coupler 5; turned, scaled, from either end."""
    places = [(0, 0, 0), (0, 3, 0), (0, 0, 4), (0, 0, 0)]
    kinds = [{"kind": "R", "axis": Z}, {"kind": "S"}, {"kind": "S"}, {"kind": "R", "axis": (1.0, 0.0, 0.0)}]
    names = ("crank", "a", "b", "rocker")
    joints = [
        kind | {"name": name, "at": (scale * turn @ np.array(at)).tolist()}
        for kind, name, at in zip(kinds, names, places, strict=True)
    ]
    for joint in joints:
        if "axis" in joint:
            joint["axis"] = (turn @ np.array(joint["axis"])).tolist()
    return sb.from_axes(joints[::-1] if backwards else joints)


def frames() -> list[tuple[np.ndarray[Any, Any], float]]:
    rng = np.random.default_rng(4)
    turns = [np.eye(3), *(np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(3))]
    return list(zip(turns, (1.0, 1e-6, 1 / 3, 1e6), strict=True))


@pytest.mark.parametrize("backwards", [False, True])
def test_crank_and_rocker_through_one_point_leave_the_other_at_rest_in_every_frame(backwards):
    """`sin(alpha) cos(beta) = 0`: one side rests at a right angle while the other turns."""
    for turn, scale in frames():
        linkage = drawn(turn, scale, backwards=backwards)
        for ends in (("crank", "rocker"), ("rocker", "crank")):
            motion = linkage.motion(36, input=ends[0], output=ends[1])
            assert [(c.turns, len(c.q)) for c in motion] == [(1, 36)] * 2
            assert max(c.swing for c in motion) < 1e-9
            poses = np.array([point.q[[0, -1]] for point in motion.change_points])
            assert [point.ways for point in motion.change_points] == [4] * 4
            # each pose once, though rounding puts some a hair below 0 or pi
            near = np.abs(np.sin((poses[:, None] - poses[None]) / 2)).max(axis=2)
            assert near[~np.eye(4, dtype=bool)].min() > 0.5


@pytest.mark.parametrize(
    ("dimensions", "swings"),
    [
        # the ball touches the axis where the rocker is free: the rocker rests at cos(beta) = -D / L3
        ({"L1": 1, "L2": 2, "L3": 2, "M": 0, "N": 0, "D": 1}, [0, 0]),
        ({"L1": 1, "L2": 3, "L3": 3, "M": 0, "N": 0, "D": 1}, [0, 0]),
        ({"L1": 3, "L2": 5, "L3": 4, "M": 0, "N": 0, "D": 0}, [0, 0]),
    ],
)
def test_both_ways_of_solution_tell_the_same(dimensions, swings):
    linkage = sb.rssr(**dimensions)
    motions = [linkage.motion(36, method=method) for method in ("auto", "general")]
    for motion in motions:
        assert motion.motion_type == "change-point"
        assert [c.swing for c in motion] == pytest.approx(swings, abs=1e-9)
    ways = [[(p.circuits, p.ways) for p in m.change_points] for m in motions]
    assert ways[0] == ways[1]
    beta = [c.q[5, -1] for c in motions[0]]
    want = -dimensions["D"] / dimensions["L3"]
    assert np.cos(beta) == pytest.approx([want, want], abs=1e-12)


def test_a_side_that_is_free_along_a_circuit_of_its_own_makes_no_change_point():
    """`(1 - sin alpha)(1 + 2 cos beta) + cos alpha = 0`: alpha rests at 90 degrees, or never comes there."""
    motion = sb.rssr(L1=1, L2=math.sqrt(5), L3=2, M=-1, N=0, D=1).motion(72)
    assert not motion.change_points
    (circuit,) = motion
    alpha, beta = circuit.q[:, 0], circuit.q[:, -1]
    assert np.abs((1 - np.sin(alpha)) * (1 + 2 * np.cos(beta)) + np.cos(alpha)).max() < 1e-12
    assert np.sin(alpha).max() < 1


@pytest.mark.parametrize(("near", "way"), [(0.0, "algebraic"), (1e-12, "algebraic"), (1e-7, "closed-form")])
def test_the_closed_form_answers_beside_such_a_place(near, way):
    assert sb.rssr(L1=3, L2=5 + near, L3=4, M=0, N=0, D=0).motion(24).completeness == way


def test_a_change_point_a_hair_below_zero_comes_first():
    for raw in (-2e-30, -1e-17, 0.0, 2e-30):
        points = change_points_from(
            SimpleNamespace(change_points=[([x], [0], 4, 1) for x in (math.pi, raw)]), 0
        )
        assert [point.input for point in points] == [raw, math.pi]
