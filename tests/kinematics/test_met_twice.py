"""A loop whose constraint is met twice over along its whole motion moves like any other.

A ball on a circle about one axis, and the axis of a cylindrical joint that turns about a parallel axis: the planes of both
are as far apart as the ball is from the cylinder's axis, so it must be square above that. In the plane that is a point
of a crank on a line that touches a circle about the other axis. Source: that plane figure alone.
"""

import pickle

import numpy as np
import pytest

import sevenbar as sb
from evidence.rewritten.__main__ import compared
from evidence.rewritten.families import families, lattice
from evidence.rewritten.ways import ways
from sevenbar.errors import RequestError
from sevenbar.reporting.facts import meaning
from textbook_loops import linkage

Y, Z = (0, 1, 0), (0, 0, 1)


def joint(name, kind, at, axis=None):
    return {"name": name, "kind": kind, "at": list(at), **({"axis": list(axis)} if axis else {})}


#: Crank of length 3 about (-2, 1) in the plane of x and z, and a line at distance 2 from (-1, -2).
DOUBLE = [
    joint("crank", "R", (-2, 2, 1), Y),
    joint("ball", "S", (1, 2, 1)),
    joint("slider", "C", (1, -1, -1), Z),
    joint("arm", "R", (-1, -2, -2), Y),
]


def ball(turn):
    """The ball from the arm's axis, in the plane of x and z, with three derivatives by the crank's turn."""
    c, s = 3 * np.cos(turn), 3 * np.sin(turn)
    x, z = [c - 1, -s, -c, s], [3 - s, -c, s, c]
    return x, z


def arm(turn, value):
    """What is left of `x cos p - z sin p = 2` at the arm's turn p, and p's derivatives by the crank's turn."""
    x, z = ball(turn)
    c, s = np.cos(value), np.sin(value)
    along = [c * a - s * b for a, b in zip(x, z, strict=True)]
    across = [-s * a - c * b for a, b in zip(x, z, strict=True)]
    v = -along[1] / across[0]
    a = -(-along[0] * v**2 + 2 * across[1] * v + along[2]) / across[0]
    third = -across[0] * v**3 - 3 * along[1] * v**2 + 3 * across[2] * v + along[3]
    j = -(3 * a * (across[1] - along[0] * v) + third) / across[0]
    return along[0] - 2, v, a, j


@pytest.mark.parametrize("ends", [("crank", "arm"), ("arm", "crank")])
@pytest.mark.parametrize("joints", [DOUBLE, DOUBLE[::-1]], ids=["drawn", "reversed"])
def test_positions_and_rates_are_those_of_the_plane_figure(joints, ends):
    motion = linkage(joints).motion(72, input=ends[0], output=ends[1])
    assert (motion.motion_type, motion.mobility.finite, motion.search.unfollowed) == ("double-rocker", 1, 0)
    (circuit,) = motion.circuits
    names = list(circuit.columns)
    turns = circuit.q[:, names.index("crank")]
    left, v, a, j = arm(turns, circuit.q[:, names.index("arm")])
    assert np.abs(left).max() < 1e-12
    assert circuit.residual.max() < 1e-12
    # away from where either joint turns back
    ok = (np.hypot(*(part[0] for part in ball(turns))) > 2.05) & (np.abs(v) > 0.05)
    v, a, j = v[ok], a[ok], j[ok]
    if ends[0] == "arm":
        v, a, j = 1 / v, -a / v**3, (3 * a**2 - v * j) / v**5
    output = names.index(ends[1])
    for rates, exact in ((circuit.dq, v), (circuit.ddq, a), (circuit.dddq, j)):
        assert np.abs(rates[ok, output] - exact).max() < 1e-9 * np.abs(exact).max()


def test_each_crank_angle_at_which_the_ball_is_far_enough_from_the_pivot_has_two_poses():
    motion = linkage(DOUBLE).motion(360, input="crank", output="arm")
    turns = np.radians(np.arange(360))
    x, z = ball(turns)
    far = np.hypot(x[0], z[0]) >= 2
    (circuit,) = motion.circuits
    ok = circuit.status == "ok"
    rows = np.round(np.degrees(circuit.q[ok, 0])).astype(int) % 360
    assert np.array_equal(np.bincount(rows, minlength=360), 2 * far)
    x, z = ball(motion.limits)
    assert motion.limits.size == 2
    assert np.abs(np.hypot(x[0], z[0]) - 2).max() < 1e-9


def test_the_joint_at_its_extreme_rests_and_others_drive():
    loop = linkage(DOUBLE)
    found = loop.motion(24, input="crank", output="slider.1")
    assert np.abs(found.circuits[0].output_range).max() < 1e-12
    assert found.mobility.rank == 5
    assert found.mobility.met_twice == 1
    assert "met twice over" in meaning(found)
    with pytest.raises(RequestError, match=r"stands still while others move.*crank, slider.2, arm"):
        loop.motion(24, input="slider.1", output="arm")
    for name in ("crank", "slider.2", "arm"):
        assert len(loop.motion(24, input=name, output="arm" if name != "arm" else "crank").circuits) == 1


def test_points_long_circuits_and_copies_know_which_joint_rests():
    loop = linkage(DOUBLE)
    motion = loop.motion(24, input="crank", output="arm")
    again = pickle.loads(pickle.dumps(motion)).circuits[0]
    long = loop.motion(40_000, input="crank", output="arm").circuits[0]
    for circuit in (motion.circuits[0], again, long):
        points = [circuit.point(link, (1, 2, 1)).position for link in (1, 2)]
        assert np.nanmax(np.abs(points[0] - points[1])) < 1e-9
    through = loop.circuit(motion.circuits[0].q[3])
    assert np.allclose(through.input_range, motion.circuits[0].input_range, atol=1e-9)


def test_the_answer_is_the_same_however_the_loop_is_written():
    found = compared(families()["doubly met constraint that moves"](), seed=7)
    assert found.moves
    assert not found.differences


@pytest.mark.parametrize("off", [1e-9, 1e-8, 1e-7])
def test_a_neighbour_within_rounding_moves_alike(off):
    joints = [*DOUBLE]
    joints[1] = joint("ball", "S", (1 + off, 2, 1))
    for order in (joints, joints[::-1]):
        motion = linkage(order).motion(24, input="crank", output="arm")
        assert (motion.motion_type, len(motion.circuits)) == ("double-rocker", 1)
        assert np.abs(np.sort(motion.limits) - [0.589987737, 1.908103808]).max() < 10 * off + 1e-8


@pytest.mark.parametrize("off", [1.0, 0.1, 0.01])
def test_a_neighbour_that_is_met_once_moves_on_two_circuits(off):
    joints = [*DOUBLE]
    joints[1] = joint("ball", "S", (1 + off, 2, 1))
    motion = linkage(joints).motion(24, input="crank", output="arm")
    assert (motion.motion_type, len(motion.circuits)) == ("double-rocker", 2)
    assert motion.mobility.rank == 6
    assert motion.mobility.met_twice == 0
    assert "twice" not in meaning(motion)


@pytest.mark.parametrize("name", ["as drawn", "turned 2"])
def test_a_joint_that_rests_along_one_motion_is_not_held_where_another_moves_it(name):
    # a kite on which the crank may turn with its coupler folded on it, and three joints that rest
    one = lattice(1095, seed=1)
    (way,) = (way for way in ways(one, np.random.default_rng(1)) if way.name == name)
    motion = way.linkage.motion(36, input=way.input, output=way.output)
    assert motion.motion_type == "change-point"
    assert [circuit.closed for circuit in motion] == [True, True]
    assert [point.circuits for point in motion.change_points] == [(0, 1), (0, 1)]


@pytest.mark.parametrize("index", [667, 1698])
def test_a_joint_that_rests_is_held_where_it_rests(index):
    # poses that close by a square: a step out of one comes back to where it closes to rounding only, 1e-6 off
    (way,) = (way for way in ways(lattice(index, seed=1), np.random.default_rng(1)) if way.name == "mirrored")
    motion = way.linkage.motion(36, input=way.input, output=way.output)
    assert [circuit.motion_type for circuit in motion] == ["change-point", "change-point"]
    assert all(abs(circuit["j3"]).max() < 1e-12 for circuit in motion)


def test_loops_that_are_overconstrained_meet_nothing_twice():
    for name in ("bennett", "spherical_4r", "planar_4r"):
        motion = sb.load(name).motion(24)
        assert motion.circuits
        assert motion.mobility.met_twice == 0


@pytest.mark.parametrize("name", ["as drawn", "turned 1", "from the other end"])
def test_a_structure_that_turns_as_one_body_has_both_its_poses(name):
    # each of them closes by a square at every input: paths to solutions that meet are lost by chance
    (way,) = (way for way in ways(lattice(520, seed=1), np.random.default_rng(1)) if way.name == name)
    motion = way.linkage.motion(24, input=way.input, output=way.output)
    slides = sorted(abs(circuit["j3"]).max() for circuit in motion)
    np.testing.assert_allclose(slides, [0.0, 4.0], atol=1e-9)
    assert motion.completeness == "searched"
    assert motion.search.unfollowed == 0
