"""Paths of known linkages are made again; known straight lines; limits; what is asked wrongly."""

import math
from itertools import combinations

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.limits import Limits
from sevenbar.design.synthesis.path.generation import path_generation
from sevenbar.design.task.match import in_order
from sevenbar.design.task.placing import placed
from sevenbar.errors import RequestError


def turned(seed):
    """A rotation (3, 3) at random."""
    q, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    return q * np.linalg.det(q)


def moved_off(draft, names, share, seed):
    """A draft whose dimensions are off by up to a share of each, at random."""
    random = np.random.default_rng(seed)
    return draft.with_values(
        {n: draft.dimension(n).value * (1 + share * random.uniform(-1, 1)) for n in names}
    )


RSSR = Draft.of_linkage(sb.load("rssr")).with_values({"L2": 1000.0}).with_point("Q", 2, (300.0, 120.0, -80.0))
OF_RSSR = ("M", "N", "L1", "L2", "L3", "Q.x", "Q.y", "Q.z")


@pytest.mark.parametrize("share", [0.05, 0.1, 0.2])
def test_the_path_of_an_rssr_gives_its_dimensions_back_from_a_start_that_is_off(share):
    path = RSSR.linkage.motion(15).circuits[0].point(2, (300.0, 120.0, -80.0)).position
    (found,) = path_generation(moved_off(RSSR, OF_RSSR, share, 1), path, "Q", count=1, starts=0)
    assert found.error_greatest < 1e-8
    for name in (*OF_RSSR, "D"):
        assert found.draft.dimension(name).value == pytest.approx(RSSR.dimension(name).value, abs=1e-6)
    assert found.motion_type == RSSR.linkage.motion().motion_type


@pytest.mark.parametrize("place", [False, True])
def test_timed_points_come_at_their_inputs(place):
    circuit = RSSR.linkage.motion(24).circuits[0]
    path, inputs = circuit.point(2, (300.0, 120.0, -80.0)).position[4:16], circuit.input[4:16]
    turn = turned(2)
    wanted = path @ turn.T + [10.0, -20.0, 30.0] if place else path
    start = moved_off(RSSR, OF_RSSR, 0.08, 3)
    (found,) = path_generation(start, wanted, "Q", timing=inputs, place=place, count=1, starts=0)
    assert found.error_greatest < 1e-8
    assert found.claim.inputs == pytest.approx(inputs, abs=0)
    (free,) = path_generation(
        start, wanted, "Q", timing=inputs - 0.3, phase=True, place=place, count=1, starts=0
    )
    assert free.error_greatest < 1e-8
    assert np.diff(free.claim.inputs) == pytest.approx(np.diff(inputs), abs=1e-12)


def test_the_path_of_the_papers_7r_point_is_made_again_from_a_start_that_is_off():
    draft = Draft.of_linkage(sb.load("seven_r"))
    point = next(p for p in draft.linkage.points if p.name == "P")
    path = draft.linkage.motion(30).circuits[2].point(point.link, point.at).position
    names = [d.name for d in draft.dimensions if d.name.startswith(("length", "P."))]
    start = moved_off(draft, names, 0.1, 1)
    (found,) = path_generation(start, path, "P", vary=["length_*", "P.*"], count=1, starts=0)
    assert found.error_greatest < 1e-8
    for name in names:
        assert found.draft.dimension(name).value == pytest.approx(draft.dimension(name).value, abs=1e-6)


def test_a_drawn_linkage_that_may_stand_anywhere_is_written_where_its_path_is_wanted():
    draft = Draft.of_linkage(sb.load("rsur")).with_point("Q", 2, (300.0, 120.0, 80.0))
    circuit = draft.linkage.motion(16).circuits[0]
    path = circuit.point(2, (300.0, 120.0, 80.0)).position
    wanted = path @ turned(5).T + [100.0, 50.0, -20.0]
    names = ["ball.x", "ball.z", "cross.y", "Q.x", "Q.y", "Q.z"]
    start = moved_off(draft, names, 0.05, 1)
    (found,) = path_generation(
        start, wanted, "Q", vary=names, timing=circuit.input, place=True, count=1, starts=0
    )
    assert found.error_greatest < 1e-8
    linkage = found.draft.linkage
    point = linkage.points[-1]
    law = sb.Law.of(np.arange(16), found.claim.inputs, 1.0, 0.0)
    again = min(
        np.abs(c.point(point.link, point.at).position - wanted).max()
        for c in linkage.motion(law=law).circuits
    )
    assert again < 1e-8


def test_points_round_a_sharp_turn_are_told_apart_by_lengths_along_the_path():
    draft = Draft.of_linkage(sb.load("rsur")).with_point("Q", 2, (300.0, 120.0, 80.0))
    path = draft.linkage.motion(16).circuits[0].point(2, (300.0, 120.0, 80.0)).position
    names = ["ball.x", "ball.z", "cross.y", "Q.x", "Q.y", "Q.z"]
    # the points 9 to 11 stand on both sides of a turn that is narrower than what is left of the match
    (found,) = path_generation(moved_off(draft, names, 0.05, 1), path, "Q", vary=names, count=1, starts=0)
    assert found.error_greatest < 1e-8


FAR_FROM_IT = {"length_1": 60.0, "length_2": 150.0, "length_3": 120.0, "length_4": 130.0}


def test_a_planar_path_is_found_from_scratch_with_the_linkages_of_roberts():
    known = sb.load("planar_4r")
    path = known.motion(16).circuits[0].point(2, (0.0, -60.0, 30.0)).position
    start = Draft.of_linkage(known).with_values(FAR_FROM_IT)
    wanted = 2.5 * np.concatenate([path, path[:1]]) @ turned(3).T + [10.0, 20.0, 30.0]
    found = path_generation(
        start,
        wanted,
        (2, (0.0, -20.0, 10.0)),
        vary=["length_*", "P.v", "P.w"],
        place=True,
        count=3,
        starts=128,
    )
    exact = [one for one in found if one.error_greatest < 1e-8]
    assert exact
    for one in exact:
        # the theorem of Roberts: other four-bars that make the curve have sides in the same ratios
        sides = np.sort([one.draft.dimension(f"length_{k}").value for k in (1, 2, 3, 4)])
        assert sides / sides[0] == pytest.approx(np.array([40.0, 80.0, 90.0, 100.0]) / 40.0, rel=1e-7)


def test_a_path_of_an_rssr_is_found_from_scratch():
    path = RSSR.linkage.motion(15).circuits[0].point(3, (60.0, 90.0, 40.0)).position
    start = Draft.of_linkage(sb.rssr(M=500, N=450, L1=150, L3=350, D=0, L2=800)).with_point(
        "Q", 3, (0.0, 0.0, 0.0)
    )
    bounds = {"M": (300, 1000), "N": (300, 1000), "L1": (100, 400), "L2": (600, 1400), "L3": (300, 900)}
    bounds |= {"D": (-200, 200), "Q.*": (-150, 150)}
    (found, *_) = path_generation(start, path, "Q", bounds=bounds, count=2, starts=128)
    assert found.error_greatest < 1e-8


def hoecken(theta):
    """Height of Hoecken's coupler point over its ground link: crank 1, ground 2, coupler and rocker 2.5.

    A = (cos, sin), O = (2, 0); B is as far from A as from O, and P lies beyond B as far again, so that A, O
    and P are on one circle about B and the angle at O is a right one.
    """
    a = np.stack([np.cos(theta), np.sin(theta)])
    from_o = a - np.array([[2.0], [0.0]])
    long = np.linalg.norm(from_o, axis=0)
    across = np.stack([from_o[1], -from_o[0]]) / long
    return np.array([[2.0], [0.0]]) + across * np.sqrt(25.0 - long**2)


def test_a_straight_line_is_made_no_worse_than_hoeckens_linkage_makes_it():
    theta = np.linspace(math.pi - 1.2, math.pi + 1.2, 41)
    curve = 40 * hoecken(theta)
    # the highest and lowest of the curve over the stroke are as far from the line between them
    line = (curve[1].max() + curve[1].min()) / 2
    known = float(np.ptp(curve[1]) / 2)
    ends = curve[0][[0, -1]]
    wanted = np.column_stack([np.linspace(*ends, 15), np.full(15, line), np.zeros(15)])
    draft = Draft.of_linkage(
        sb.from_dh("RRRR", length=[42.0, 96.0, 104.0, 83.0], twist=[0.0] * 4, offset=[0.0] * 4)
    )
    found = path_generation(
        draft, wanted, (2, (0.0, 97.0, 4.0)), vary=["length_*", "P.v", "P.w"], place=True, count=1, starts=0
    )
    assert found[0].error_rms < known
    assert np.ptp(ends) > 100  # a long stroke
    assert known < 0.02 * np.ptp(ends)


def test_a_circle_is_made_by_the_pin_of_a_crank():
    angle = np.linspace(0, math.tau, 21)
    wanted = np.column_stack([np.zeros(21), 20 * np.cos(angle), 20 * np.sin(angle)])
    found = path_generation(
        sb.load("planar_4r"), wanted, (1, (0.0, 3.0, 4.0)), vary=["P.*"], count=1, place=True, starts=0
    )
    assert found[0].error_greatest < 1e-8
    v, w = (found[0].draft.dimension(f"P.{key}").value for key in "vw")
    assert math.hypot(v, w) == pytest.approx(20.0, abs=1e-8)


def test_limits_are_held_by_each_design():
    path = RSSR.linkage.motion(12).circuits[0].point(2, (300.0, 120.0, -80.0)).position[:7]
    limits = Limits(math.radians(35.0), (100.0, 1500.0), "crank-rocker")
    found = path_generation(moved_off(RSSR, OF_RSSR, 0.05, 1), path, "Q", limits=limits, count=2, starts=16)
    for one in found:
        motion = one.draft.linkage.motion()
        assert motion.motion_type == "crank-rocker"
        assert one.transmission_lowest >= math.radians(35.0) - 1e-9
        lengths = [abs(d.value) for d in one.draft.dimensions if d.kind == "length"]
        assert max(lengths) <= 1500.0 * (1 + 1e-9)
        assert min(one.draft.dimension(k).value for k in ("L1", "L2", "L3")) >= 100.0 * (1 - 1e-9)
        for name, (low, high) in {"L1": (100.0, 1500.0)}.items():
            assert low <= one.draft.dimension(name).value <= high


def test_the_same_seed_gives_the_same_designs():
    path = RSSR.linkage.motion(12).circuits[0].point(1, (250.0, 30.0, 0.0)).position[:6]
    start = moved_off(RSSR, OF_RSSR, 0.05, 1)
    first, second = (
        path_generation(start, path, (1, (200.0, 0.0, 0.0)), vary=["L1", "P.*"], count=1, starts=4, seed=4)
        for _ in range(2)
    )
    assert [one.draft.raw for one in first] == [one.draft.raw for one in second]


def test_a_placing_is_the_best_of_all_turns_about_it():
    random = np.random.default_rng(0)
    found, wanted = random.standard_normal((2, 9, 3))
    best = placed(wanted, found)
    assert np.linalg.det(best.rotation) == pytest.approx(1.0)
    least = ((best.put(found) - wanted) ** 2).sum()
    for k in range(200):
        vector = 0.3 * random.standard_normal(3)
        angle = np.linalg.norm(vector)
        x, y, z = vector / angle
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
        other = (best.put(found) - wanted.mean(axis=0)) @ turn.T + wanted.mean(axis=0)
        assert ((other - wanted) ** 2).sum() >= least
        assert k < 200


def test_the_order_keeping_match_is_that_of_all_choices():
    random = np.random.default_rng(1)
    curve, wanted = random.standard_normal((9, 3)), random.standard_normal((4, 3))
    rows, error = in_order(curve, wanted, closed=False)
    every = [c for chosen in combinations(range(9), 4) for c in (chosen, chosen[::-1])]
    costs = [((curve[list(c)] - wanted) ** 2).sum() / 4 for c in every]
    assert error == pytest.approx(min(costs))
    assert tuple(rows) == every[int(np.argmin(costs))]


PATH = RSSR.linkage.motion(12).circuits[0].point(2, (300.0, 120.0, -80.0)).position


@pytest.mark.parametrize(
    ("points", "more", "told"),
    [
        (PATH[:2], {}, "points: 2 given; a path needs at least 3"),
        (PATH[[0, 1, 2, 0]] * [1, 1, math.nan], {}, "points: z of point 1 is not a finite number"),
        (PATH[:, :2], {}, "points: an array of shape (12, 2) does not fit"),
        (PATH[[0, 1, 1, 2]], {}, "points: 2 and 3 are one place"),
        (np.ones((4, 3)), {}, "points: all are one place"),
        (PATH, {"point": "Z"}, "point: no point 'Z'"),
        (PATH, {"point": (4, (0, 0, 0))}, "point: 4 is not a moving link; give 1 to 3, link 4 is the ground"),
        (PATH, {"point": (2, (0, 0))}, "at: 2 numbers; give three"),
        (PATH, {"vary": []}, "vary: no dimension may change"),
        (PATH, {"vary": ["L9"]}, "vary: 'L9' is not a dimension here; give some of M, N, L1"),
        (PATH, {"bounds": {"L1": (300, 400)}}, "bounds: L1 begins at 250 mm, outside 300:400"),
        (PATH, {"bounds": {"L1": (400, 300)}}, "bounds: (400, 300) of L1 are no bounds"),
        (PATH, {"bounds": {"L1": (-5, 300)}}, "bounds: -5 of L1: a link needs a length"),
        (PATH, {"bounds": {"X": (1, 2)}}, "bounds: 'X' is not a dimension that varies"),
        (PATH, {"timing": [1, 2]}, "timing: 2 inputs for 12 points"),
        (PATH[:3], {"timing": [0, 2, 1]}, "timing: the input of point 3 turns back"),
        (PATH, {"phase": True}, "phase: the path has no inputs"),
        (
            PATH * 1000,
            {"vary": ["L1"], "bounds": {"L1": (100, 400)}},
            "mm from the origin, and the linkage reaches",
        ),
        (
            PATH * 1000,
            {"place": True, "vary": ["L1"], "bounds": {"L1": (100, 400)}},
            "mm across, and the linkage reaches",
        ),
        (PATH, {"count": 0}, "designs: 0 is not a count; give 1 to 50"),
        (PATH, {"starts": -1}, "starts: -1 is not a count"),
    ],
)
def test_a_wrong_request_is_told_in_one_message(points, more, told):
    more = dict(more)
    with pytest.raises(RequestError) as raised:
        path_generation(RSSR, points, more.pop("point", "Q"), **more)
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_loop_that_any_change_of_a_length_opens_is_told_of():
    path = sb.load("bennett").motion(8).circuits[0].point(1, (0.0, 1.0, 1.0)).position
    with pytest.raises(RequestError, match=r"length_1.* cannot change alone without opening the loop"):
        path_generation(sb.load("bennett"), path, (1, (0.0, 1.0, 1.0)), vary=["length_*"])
    # where the point is on its link can be found all the same
    (found,) = path_generation(sb.load("bennett"), path, (1, (0.0, 1.1, 0.9)), count=1, starts=0)
    assert found.error_greatest < 1e-8


def test_a_named_point_of_the_ground_has_no_path():
    draft = RSSR.with_point("G", 4, (1.0, 2.0, 3.0))
    with pytest.raises(RequestError, match="point: 'G' is on link 4, the ground, which stands still"):
        path_generation(draft, PATH, "G")


def test_a_start_that_cannot_be_assembled_is_told_of():
    with pytest.raises(
        RequestError, match="linkage: cannot-assemble, the loop moves nowhere as it is described"
    ):
        path_generation(sb.rssr(M=700, N=700, L1=250, L3=550, D=0, L2=3000), PATH, (2, (0.0, 0.0, 0.0)))


def test_a_transmission_angle_is_asked_of_an_rssr_only():
    path = sb.load("planar_4r").motion(8).circuits[0].point(2, (0.0, 10.0, 5.0)).position
    with pytest.raises(
        RequestError, match="transmission: its angle is that of an RSSR given by its dimensions"
    ):
        path_generation(sb.load("planar_4r"), path, (2, (0.0, 0.0, 0.0)), limits=Limits(0.5))
