"""The motion of nets: their circuits, rates and points, against codes that share nothing with the core."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from scipy.optimize import brentq
from test_nets import KLANN, SLIDERS, STEPHENSON, WATT, carried, circles, net, pin, watt_by_hand

import sevenbar as sb
from sevenbar.drawing.animate import animate
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.circuits.poses import joint_frames, poses, poses_along, walk
from sevenbar.kinematics.loop.law import Law

#: Two cranks of a parallelogram, and a dyad on its coupler.
PARALLELOGRAM = [
    pin((0, 0), "frame", "one", name="crank"),
    pin((6, 10), "one", "coupler"),
    pin((40, 0), "frame", "two"),
    pin((46, 10), "two", "coupler"),
    pin((26, 30), "coupler", "link"),
    pin((60, 40), "link", "lever"),
    pin((70, 0), "lever", "frame", name="lever"),
]

WISHBONE = [
    {"name": "lower", "kind": "R", "at": [0, 300, 200], "axis": [1, 0, 0], "between": ["frame", "lower arm"]},
    {
        "name": "upper",
        "kind": "R",
        "at": [10, 350, 450],
        "axis": [1, 0.1, 0],
        "between": ["frame", "upper arm"],
    },
    {"name": "ball low", "kind": "S", "at": [0, 700, 190], "between": ["lower arm", "upright"]},
    {"name": "ball high", "kind": "S", "at": [-10, 660, 440], "between": ["upper arm", "upright"]},
]
TRACK_ROD = {"name": "track rod", "between": ["frame", "upright"], "at": [[120, 320, 250], [110, 690, 255]]}


def suspension():
    return sb.from_axes(WISHBONE, rods=[TRACK_ROD], ground="frame", drive="lower")


NETS = {
    "watt": lambda: net(WATT),
    "watt driven at the lever": lambda: net(WATT, drive="lever"),
    "klann": lambda: net(KLANN),
    "stephenson": lambda: net(STEPHENSON),
    "sliders": lambda: sb.from_axes(SLIDERS, ground="frame", drive="crank"),
    "a rail drives": lambda: sb.from_axes(SLIDERS, ground="frame", drive="rail"),
    "parallelogram": lambda: net(PARALLELOGRAM),
    "suspension": suspension,
}


@pytest.mark.parametrize("name", NETS)
def test_every_row_closes_every_joint_and_every_rod(name):
    linkage = NETS[name]()
    motion = linkage.motion(60)
    assert motion.circuits
    for circuit in motion:
        frames = poses_along(linkage, circuit, np.arange(len(circuit.time)))
        before, after = joint_frames(linkage, frames)
        for joint, own in enumerate(linkage.joints):
            moved = before[:, joint] @ own.motion(circuit.q[:, linkage.places[joint]])
            assert np.abs(moved - after[:, joint]).max() < 1e-9 * linkage.size
        for rod in linkage.rods:
            first, second = (
                frames[:, link - 1] @ (*end, 1) for link, end in zip(rod.between, rod.at, strict=True)
            )
            length = np.linalg.norm(first - second, axis=1)
            assert np.abs(length - math.dist(*rod.at)).max() < 1e-9 * linkage.size


@pytest.mark.parametrize("name", NETS)
def test_rows_at_other_inputs_are_those_of_a_circuit_that_is_followed_anew(name):
    linkage = NETS[name]()
    pose = linkage.motion(24).circuits[0].q[5]
    first = linkage.circuit(pose, 24)
    law = Law.of([0.0, 1.0, 2.0], np.quantile(first.input, [0.3, 0.5, 0.6]), 1.0, 0.5)
    for samples, given in ((90, None), (24, law), (36, None)):
        again, anew = (one.circuit(pose, samples, law=given) for one in (linkage, NETS[name]()))
        for array in ("q", "dq", "ddq", "dddq", "status", "branch", "residual", "condition"):
            np.testing.assert_array_equal(getattr(again, array), getattr(anew, array))
        assert again.dead_centres == anew.dead_centres
        jerks = (one.point(1, (3.0, -2.0, 5.0)).jerk for one in (again, anew))
        np.testing.assert_array_equal(*jerks)


@pytest.mark.parametrize("name", [name for name in NETS if name != "a rail drives"])
def test_each_mode_lies_on_exactly_one_circuit(name):
    linkage = NETS[name]()
    motion = linkage.motion(24)
    column = linkage.columns.index(motion.input)

    def rows_at(circuit, angle):
        return circuit.q[np.abs(np.exp(1j * circuit.q[:, column]) - np.exp(1j * angle)) < 1e-9]

    def same(one, other):
        turns = linkage.turning
        apart = np.where(
            turns, np.abs(np.exp(1j * one) - np.exp(1j * other)), np.abs(one - other) / linkage.size
        )
        return apart.max() < 1e-6

    modes = 0
    for angle in np.arange(24) * math.tau / 24:
        for mode in linkage.assembly_modes(angle).q:
            modes += 1
            assert sum(any(same(row, mode) for row in rows_at(c, angle)) for c in motion) == 1
    assert modes >= 12


def eighth_order(values, step):
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    last = len(values) - 4
    return (
        sum(w * (values[4 + k : last + k] - values[4 - k : last - k]) for k, w in enumerate(weights, 1))
        / step
    )


@pytest.mark.parametrize("name", ["watt", "sliders", "stephenson", "suspension"])
def test_rates_of_joints_and_points_are_differences_of_closed_poses(name):
    linkage = NETS[name]()
    samples = 1440
    circuit = linkage.motion(samples).circuits[0]
    # away from dead centres, on one pass
    inside = circuit.branch == 0
    for dead_centre in circuit.dead_centres:
        if dead_centre.kind == "input":
            inside &= np.abs(circuit.input - dead_centre.input) > 0.3
    first, last = np.flatnonzero(inside)[[0, -1]]
    assert inside[first : last + 1].all()
    rows = slice(first, last + 1)
    direction = math.copysign(math.tau / samples, circuit.input[last] - circuit.input[first])
    tables = [[circuit.q, circuit.dq, circuit.ddq, circuit.dddq]]
    for link in linkage.graph.moving:
        trace = circuit.point(link, at=(10, 20, 5))
        tables.append([trace.position, trace.velocity, trace.acceleration, trace.jerk])
    for table in tables:
        for lower, upper in zip(table, table[1:], strict=False):
            slope = eighth_order(lower[rows], abs(direction))
            if direction < 0:
                slope = -slope
            want = upper[rows][4:-4]
            assert np.abs(slope - want).max() < 1e-7 * max(1.0, np.abs(want).max())


@pytest.mark.parametrize("angle", np.linspace(0.1, 6.1, 7))
def test_circuits_of_watt_pass_the_modes_of_circles_by_hand(angle):
    linkage = net(WATT)
    lever = linkage.link_names.index("lever")
    ends = []
    for mode in linkage.assembly_modes(angle).q:
        circuit = linkage.circuit(mode)
        place = int(np.argmin(np.abs(np.exp(1j * circuit.input) - np.exp(1j * angle))))
        assert circuit.closed
        ends.append((poses(linkage, mode[None])[0, lever] @ [220, 70, 0, 1])[:2])
        assert np.isfinite(circuit.q[place]).all()
    want = watt_by_hand(angle)
    assert len(ends) == len(want)
    for end in want:
        assert np.abs(ends - end).max(axis=1).min(initial=1) < 1e-10


def stephenson_by_hand(angle, steps=1500):
    """The end of the upper link on the right one in every mode: the left link's turn is the one unknown."""
    at = [np.array(one["at"], dtype=float) for one in STEPHENSON]
    turned = complex(*at[1]) * complex(math.cos(angle), math.sin(angle))
    knee = np.array([turned.real, turned.imag])

    def places(turn, side):
        def on_left(place):
            z = complex(*(place - at[1])) * complex(math.cos(turn), math.sin(turn))
            return knee + np.array([z.real, z.imag])

        upper, lower = on_left(at[3]), on_left(at[5])
        found = circles(upper, at[2], math.dist(at[3], at[4]), math.dist(at[2], at[4]))
        if not found:
            return None
        end = found[side]
        other = carried(at[6], at[2], at[4], at[2], end)
        return end, math.dist(lower, other) - math.dist(at[5], at[6])

    result = []
    turns = np.linspace(-math.pi, math.pi, steps)
    for side in (0, 1):
        values = [places(turn, side) for turn in turns]
        for k in range(steps - 1):
            if values[k] and values[k + 1] and values[k][1] * values[k + 1][1] <= 0:
                root = brentq(lambda turn, side=side: places(turn, side)[1], *turns[k : k + 2], xtol=1e-14)
                result.append(places(root, side)[0])
    return np.array(result)


@pytest.mark.parametrize("angle", [-1.5, -0.8, -0.2])
def test_monodromy_finds_the_modes_of_stephenson_that_an_own_scan_finds(angle):
    linkage = net(STEPHENSON)
    modes = linkage.assembly_modes(angle)
    assert modes.completeness == "algebraic"
    right = linkage.link_names.index("right")
    ends = (poses(linkage, modes.q)[:, right] @ [95, 85, 0, 1])[:, :2]
    want = stephenson_by_hand(angle)
    assert len(ends) == len(want)
    for end in want:
        assert np.abs(ends - end).max(axis=1).min() < 1e-8


def test_two_four_bars_on_one_crank_move_as_each_does_alone():
    first = [WATT[0], WATT[1], WATT[2], WATT[3]]
    second = [
        WATT[0],
        pin((-8, 30), "crank", "arm"),
        pin((-90, 60), "arm", "lever"),
        pin((-80, 0), "lever", "frame", name="lever"),
    ]
    both = net([*first, *second[1:]])
    for pins, column in ((first, "rocker"), (second, "lever")):
        alone = sb.from_pins(pins, ground="frame", drive="crank")
        assert alone.net is None
        single = alone.motion(72, output=column)
        joined = both.motion(72, output=column)
        ranges = {tuple(np.round(np.unwrap([0, *c.output_range])[1:], 9)) for c in single}
        assert {tuple(np.round(np.unwrap([0, *c.output_range])[1:], 9)) for c in joined} == ranges
        for circuit in joined:
            (twin,) = (c for c in single if abs(c.output_range[0] - circuit.output_range[0]) < 1e-9)
            assert np.abs(np.exp(1j * circuit[column]) - np.exp(1j * twin[column])).max() < 1e-10
            for rate in ("dq", "ddq", "dddq"):
                mine = getattr(circuit, rate)[:, both.columns.index(column)]
                theirs = getattr(twin, rate)[:, alone.columns.index(column)]
                assert np.abs(mine - theirs).max() < 1e-9 * max(1.0, np.abs(theirs).max())
            for name in ("velocity", "acceleration", "jerk"):
                mine, theirs = getattr(circuit, name), getattr(twin, name)
                assert mine.highest == pytest.approx(theirs.highest, rel=1e-9)
                assert mine.lowest == pytest.approx(theirs.lowest, rel=1e-9)


def test_a_motion_is_the_same_however_a_net_is_written():
    plain = net(WATT).motion(72, output="lever")
    turn = complex(math.cos(1.1), math.sin(1.1))
    other = []
    for one in WATT[::-1]:
        at = 2.5 * turn * complex(*one["at"]) + complex(300, -70)
        other.append({**one, "at": (at.real, at.imag), "links": [f"L {link}" for link in one["links"]]})
    again = sb.from_pins(other, ground="L frame", drive="crank").motion(72, output="lever")
    assert again.limits == pytest.approx(plain.limits, abs=1e-10)

    def seen(motion):
        names = [motion.linkage.columns.index(name) for name in ("crank", "rocker", "lever")]
        return sorted(
            # of one that turns back either pass may be the first
            (
                (c.motion_type, c.closed, c.turns, *np.round(c.q[0, names], 8))
                + (tuple(np.round(c.dq[3, names], 8)) if c.turns else ())
            )
            for c in motion
        )

    assert seen(plain) == seen(again)


def test_three_equal_cranks_move_as_one_parallelogram_drawn_bent_or_flat():
    for height in (10, 0, 1e-7):
        pins = []
        for k, x in enumerate((0, 20, 50)):
            pins += [pin((x, 0), "frame", f"crank {k}", name=f"pivot {k}")]
            pins += [pin((x + 6, height), f"crank {k}", "coupler")]
        motion = net(pins, drive="pivot 0").motion(36)
        (circuit,) = motion
        assert circuit.turns == 1
        # a second solution of the rows that do not repeat others opens the third crank
        for other in ("pivot 1", "pivot 2"):
            assert np.abs(np.exp(1j * (circuit["pivot 0"] - circuit[other])) - 1).max() < 1e-9


def test_a_net_at_its_change_point_goes_on_in_each_branch():
    motion = net(PARALLELOGRAM).motion(36)
    assert motion.motion_type == "change-point"
    assert [point.ways for point in motion.change_points] == [4, 4, 4, 4]
    # parallel cranks, and crossed ones, each with the dyad on either side
    parallel = [np.abs(np.exp(1j * (c["crank"] - c["pin_3"])) - 1).max() < 1e-9 for c in motion]
    assert sorted(parallel) == [False, False, True, True]


def two_rhombi(x):
    """Two rhombi on one crank, the ends of the second joined to the first's; of change points, two come together at x = -0.3."""
    first = [pin((0.3, -0.1), "frame", "crank", name="crank"), pin((-0.3, 0.7), "crank", "b")]
    first += [pin((-0.3, 1.7), "b", "c"), pin((-0.3, 0.7), "c", "frame")]
    return net([*first, pin((-0.3, 0.7), "crank", "d"), pin((-0.3, 1.7), "d", "e"), pin((x, -0.3), "e", "c")])


@pytest.mark.parametrize("x", [0.0, -0.28, -0.29, -0.295, -0.299, -0.301, -0.305, -0.31])
def test_change_points_near_each_other_are_told_apart(x):
    motion = two_rhombi(x).motion(72)
    assert (len(motion), motion.search.unfollowed, len(motion.change_points)) == (4, 0, 10)
    assert all(circuit.goes_round and len(circuit.q) == 72 for circuit in motion)
    assert [point.ways for point in motion.change_points] == [4] * 10


@pytest.mark.parametrize("x", [-0.3, -0.29999999, -0.299999, -0.29999, -0.2999, -0.3001, -0.300001])
def test_change_points_too_near_to_each_other_are_said_not_to_be_followed(x):
    motion = two_rhombi(x).motion(72)
    assert motion.search.unfollowed


def test_a_circuit_of_a_net_is_pickled_with_its_points():
    linkage = suspension()
    circuit = linkage.motion(24).circuits[0]
    again = pickle.loads(pickle.dumps(circuit))
    mine, theirs = (one.point(2, at=(1, 2, 3)) for one in (circuit, again))
    assert np.array_equal(mine.acceleration, theirs.acceleration, equal_nan=True)


def test_a_slide_drives_and_a_law_drives():
    slides = NETS["a rail drives"]()
    assert {c.motion_type for c in slides.motion(24)} == {"slider-rocker"}
    linkage = net(WATT)
    t = np.linspace(0, 2, 9)
    law = sb.Law.of(t, 0.3 * t, 0.3 + 0 * t, 0 * t)
    circuit = linkage.motion(law=law).circuits[0]
    twin = linkage.motion(speed=0.3).circuits[0]
    assert circuit.input == pytest.approx(0.3 * t)
    assert circuit["lever"][0] == pytest.approx(twin["lever"][0], abs=1e-12)
    assert circuit.dq[0] == pytest.approx(twin.dq[0], abs=1e-12)


def test_a_net_of_two_freedoms_or_none_has_no_motion():
    two = [*WATT[:6], pin((220, 70), "lever", "arm"), pin((200, 0), "arm", "frame")]
    two[5] = pin((190, 90), "link", "lever")
    with pytest.raises(NotCoveredError, match="one input moves; here it has 2 freedoms"):
        net(two).motion()
    held = net([*WATT, pin((160, 40), "rocker", "brace"), pin((40, 10), "brace", "frame")])
    with pytest.raises(NotCoveredError, match="here it has 0 freedoms"):
        held.motion()


def test_a_link_between_two_balls_moves_as_a_rod_and_says_so():
    ends = [
        {"name": f"end {k}", "kind": "S", "at": at, "between": [link, "track rod"]}
        for k, (link, at) in enumerate(zip(TRACK_ROD["between"], TRACK_ROD["at"], strict=True))
    ]
    drawn = sb.from_axes([*WISHBONE, *ends], ground="frame", drive="lower")
    with pytest.raises(NotCoveredError, match="'track rod' spins idly between two balls; write it as a rod"):
        drawn.motion()


def test_a_film_shows_every_row_of_a_platform_on_rods(tmp_path):
    linkage = suspension()
    motion = linkage.motion(24)
    frames = poses_along(linkage, motion[0], walk(motion[0]).rows)
    assert np.isfinite(frames).all()
    sb.plot.configuration(motion)
    animate(motion, tmp_path / "film.html", seconds=1)
    assert (tmp_path / "film.html").stat().st_size > 1000
