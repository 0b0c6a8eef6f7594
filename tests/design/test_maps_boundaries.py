"""Boundaries of maps against the motion type computed at the very points, and against closed forms.

Sources: the ordinary analysis of a linkage, one at a time; Grashof's rule for planar four-bars; for square axes
in one plane (D = 0) the critical poses of the symmetric kind, in which both balls stand in the plane of the
axes; extreme distances of two circles by brute force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.maps import atlas
from sevenbar.design.maps.atlas import Map, motion_map
from sevenbar.design.maps.plane import Kind, LoopPlane
from sevenbar.design.maps.rssr_plane import NEARLY_REAL, critical_gaps
from sevenbar.design.maps.window import axes_of
from sevenbar.errors import RequestError


@dataclass(frozen=True)
class Case:
    dimensions: dict[str, float]
    over: dict[str, tuple[float, float]]
    input: str = "crank"
    follow: tuple[str, ...] = ()


PAPER = {"M": 700, "N": 700, "L1": 250, "L3": 550, "D": 0}
GENERAL = {"M": 700, "N": 700, "L1": 250, "L2": 1000, "L3": 550, "D": 100}

FAST = {
    "the paper's crank and rocker": Case(PAPER, {"L1": (100, 1400), "L3": (200, 1500)}, follow=("L2",)),
}
SLOW = {
    "crank and coupler": Case(GENERAL, {"L1": (50, 1800), "L2": (50, 3000)}),
    "the paper's axes": Case(PAPER, {"M": (-1000, 1400), "N": (-1000, 1500)}, follow=("L2",)),
    "the paper's axes, rocker driving": Case(
        PAPER, {"M": (-1000, 1400), "D": (-1000, 1500)}, "rocker", ("L2",)
    ),
    "a cusp on a symmetric map": Case(GENERAL, {"N": (-1500, 1500), "M": (-1800, 1800)}),
    "a narrow strip": Case(
        {"M": 300, "N": 200, "L1": 650, "L2": 600, "L3": 450, "D": 1}, {"L1": (50, 1800), "L3": (50, 3000)}
    ),
    "meeting axes": Case(
        {"M": 300, "N": 0, "L1": 650, "L2": 600, "L3": 450, "D": 0}, {"L1": (50, 1800), "L2": (50, 3000)}
    ),
    "double boundaries": Case(
        {"M": 300, "N": 0, "L1": 650, "L2": 600, "L3": 450, "D": 200}, {"L1": (50, 1800), "L2": (50, 3000)}
    ),
}

#: As exact as users have them; the others have chords ten times as far from their boundaries.
EXACT = ("the paper's crank and rocker", "crank and coupler", "the paper's axes")
COARSE = atlas.RSSR._replace(fine=200, tolerance=1e-5)

#: Maps are made once.
_MADE: dict[str, Map] = {}


def made(name: str) -> Map:
    case = (FAST | SLOW)[name]
    if name not in _MADE:
        with pytest.MonkeyPatch.context() as patch:
            if name not in EXACT:
                patch.setattr(atlas, "RSSR", COARSE)
            rssr = sb.rssr(**case.dimensions)
            _MADE[name] = motion_map(rssr, case.over, input=case.input, follow=case.follow)
    return _MADE[name]


def cases():
    return [*FAST, *(name for name in SLOW)]


def kind_of(dimensions: dict[str, float], input: str) -> Kind:
    motion = sb.rssr(**dimensions).motion(4, input=input)
    return Kind(motion.motion_type, len(motion.circuits))


def apart(of: Map, place: np.ndarray) -> float:
    """The distance of a place [shares] from the nearest drawn boundary."""
    nearest = np.inf
    for line in of.boundaries:
        start, along = line.places[:-1], np.diff(line.places, axis=0)
        length = np.maximum(np.sum(along**2, axis=1), 1e-300)
        part = np.clip(np.sum((place - start) * along, axis=1) / length, 0, 1)
        nearest = min(nearest, np.hypot(*(start + part[:, None] * along - place).T).min())
    return float(nearest)


@pytest.mark.parametrize("name", cases())
def test_three_thousand_points_have_the_motion_type_of_the_region_they_are_drawn_in(name):
    of = made(name)
    points = np.random.default_rng(7).uniform(0, 1, (3_000, 2))
    drawn, exact = of.numbers_at(points), of.plane.numbers_at(points)
    for index in np.flatnonzero(drawn != exact):
        assert apart(of, points[index]) <= 2 * of.tolerance, of.values(points[index][None])
    assert len(np.unique(drawn)) > 1


@pytest.mark.parametrize("name", cases())
def test_points_a_hair_beside_a_boundary_have_the_type_of_their_side_by_the_ordinary_analysis(name):
    of, case = made(name), (FAST | SLOW)[name]
    rng = np.random.default_rng(8)
    looked = 0
    for line in of.boundaries:
        for index in rng.integers(0, len(line.places) - 1, 12):
            start, end = line.places[index : index + 2]
            along = end - start
            if np.hypot(*along) < 100 * of.tolerance:
                continue
            left = np.array([-along[1], along[0]]) / np.hypot(*along)
            middle = (start + end) / 2
            for side, kind in ((2.0, line.left), (-2.0, line.right)):
                place = middle + side * of.tolerance * left
                if ((place < 0) | (place > 1)).any():
                    continue
                values = dict(zip(case.over, of.values(place[None])[0].tolist(), strict=True))
                assert kind_of(case.dimensions | values, case.input) == of.kinds[kind], values
                looked += 1
    assert looked > 10


def signed_area(loop):
    """The area within a closed loop (n, 2), negative where it runs clockwise."""
    x, y = loop.T
    return 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)


@pytest.mark.parametrize("name", cases())
def test_regions_fill_the_window_and_their_outlines_run_anticlockwise(name):
    of = made(name)
    assert sum(of.areas.values()) == pytest.approx(1.0, abs=1e-2 * of.tolerance)
    for region in of.regions:
        assert signed_area(region.outline) > 0
        assert all(signed_area(hole) < 0 for hole in region.holes)
        whole = signed_area(region.outline) + sum(map(signed_area, region.holes))
        assert region.area == pytest.approx(whole, abs=1e-12)


def test_with_axes_in_one_plane_the_crank_turns_where_n_l3_is_more_than_twice_m_l1():
    """hypot(M + L1, N - L3) = L2, the coupler of a left-out L2: the pose with both balls between the axes."""
    of = made("the paper's crank and rocker")
    (line,) = of.boundaries
    L1, L3 = of.values(line.places).T
    assert np.abs(700 * L3 - 2 * 700 * L1).max() < 1e-6 * 700
    assert of.areas[Kind("crank-rocker", 2)] == pytest.approx((1500 - 200) / 2 / 2 / 1300, abs=1e-12)


def test_a_rod_that_the_file_leaves_out_keeps_its_length():
    """hypot(M + L1, N - L3) = L2 with the rod of the file's pose, the hypotenuse of 450, 550 and 700."""
    of = motion_map(sb.load("rssr"), {"L1": (100, 400), "L3": (300, 800)})
    rod = math.sqrt(450**2 + 550**2 + 700**2)
    turns = {(s.axis.name, s.way): s.value for s in of.design.steps}
    crank, rocker = math.sqrt(rod**2 - 150**2) - 700, 700 - math.sqrt(rod**2 - 950**2)
    assert (crank - 250, rocker - 550) == pytest.approx((36.15, -154.14), abs=5e-3)
    assert turns["L1", "up"] == pytest.approx(crank, abs=1e-6)
    assert turns["L3", "down"] == pytest.approx(rocker, abs=1e-6)
    (line,) = of.boundaries
    L1, L3 = of.values(line.places).T
    assert np.abs(np.hypot(700 + L1, 700 - L3) - rod).max() < of.tolerance * 500
    assert of.linkage.dimensions["L2"] == rod


def test_a_file_that_gives_the_rod_means_the_same_map():
    over = {"L1": (100, 400), "L3": (300, 800)}
    left_out = motion_map(sb.load("rssr"), over, grid=9)
    rod = sb.load("rssr").dimensions["L2"]
    given = motion_map(sb.rssr(M=700, N=700, L1=250, L3=550, D=0, L2=rod), over, grid=9)
    assert left_out.areas == given.areas
    assert (left_out.held.text, given.held.text) == ("M, N, D, L2 (997.497 mm in the design)", "M, N, L2, D")


def test_a_loop_that_is_analysed_point_by_point_holds_the_rod_too():
    draft = Draft.of_linkage(sb.load("rssr")).holding()
    plane = LoopPlane(draft, axes_of(draft, {"L1": (100, 400), "L3": (300, 800)}), "crank", 8, None)
    (motion,) = plane.motions(np.array([[0.9, 0.1]]))
    assert motion.linkage.dimensions["L2"] == sb.load("rssr").dimensions["L2"]


@pytest.mark.parametrize(
    ("over", "follow", "message"),
    [
        ({"L1": (1, 2), "M": (1, 2)}, "N", "follow: 'N' is given, 700 mm, so it stays; give L2"),
        ({"L1": (1, 2), "M": (1, 2)}, "L9", "follow: 'L9' is not a dimension; give L2"),
        ({"L1": (1, 2), "L2": (1, 2)}, "L2", "follow: L2 is an axis of the map; leave one of the two out"),
    ],
)
def test_what_cannot_follow_is_refused(over, follow, message):
    with pytest.raises(RequestError) as refused:
        motion_map(sb.load("rssr"), over, follow=[follow])
    assert str(refused.value) == message


def test_where_the_file_leaves_nothing_out_nothing_can_follow():
    given = sb.rssr(M=700, N=700, L1=250, L3=550, D=0, L2=1000)
    with pytest.raises(RequestError, match="'L2' is given, 1000 mm, so it stays; the file leaves none out"):
        motion_map(given, {"L1": (1, 2), "M": (1, 2)}, follow=["L2"])


def test_the_same_rule_bounds_the_wedges_over_both_axes():
    of = made("the paper's axes")
    places = np.concatenate([line.places for line in of.boundaries])
    M, N = of.values(places).T
    off = np.abs(np.abs(N) - 2 * np.abs(M) * 250 / 550)
    # at M = N = 0 all boundaries meet, and with them the line N = 0 on which it is a change point
    assert off.max() < of.tolerance * 2400
    assert off[np.abs(M) > 0.1].max() < 1e-6


def test_the_loop_fails_to_close_where_the_coupler_is_the_least_or_the_greatest_distance_of_the_circles():
    of = made("crank and coupler")
    number = of.kinds.index(Kind("cannot-assemble", 0))
    rng = np.random.default_rng(3)
    lines = [line for line in of.boundaries if number in (line.left, line.right)]
    assert len(lines) == 2
    for line in lines:
        for L1, L2 in of.values(line.places[rng.integers(0, len(line.places), 15)]):
            ends = extreme_distances({**GENERAL, "L1": L1})
            assert min(abs(L2 - end) for end in ends) < 1e-8, (L1, L2, ends)


def distance(d: dict[str, float], a: np.ndarray, b: np.ndarray) -> np.ndarray:
    x = d["L1"] * np.cos(a) - d["M"]
    y = d["L1"] * np.sin(a) - d["D"] - d["L3"] * np.cos(b)
    return np.sqrt(x**2 + y**2 + (d["N"] - d["L3"] * np.sin(b)) ** 2)


def extreme_distances(d: dict[str, float]) -> tuple[float, float]:
    """The least and the greatest distance of the balls, by grids that close in."""
    found = []
    for sign in (1, -1):
        middle, width = np.array([np.pi, np.pi]), np.pi
        for _ in range(24):
            ticks = np.linspace(-width, width, 81)
            a, b = np.meshgrid(middle[0] + ticks, middle[1] + ticks)
            values = sign * distance(d, a, b)
            best = np.unravel_index(values.argmin(), values.shape)
            middle, width = np.array([a[best], b[best]]), width * 0.25
        found.append(sign * values.min())
    return found[0], found[1]


def test_regions_do_not_depend_on_the_grid():
    linkage, over = sb.rssr(**GENERAL), {"L1": (50, 1800), "L2": (50, 3000)}
    coarse, fine = motion_map(linkage, over, grid=6), made("crank and coupler")
    assert coarse.areas.keys() == fine.areas.keys()
    for kind, share in coarse.areas.items():
        assert share == pytest.approx(fine.areas[kind], abs=2e-6)
    # a sliver with a cusp, two thousandths of the map, between two lines of a grid
    assert 1e-3 < coarse.areas[Kind("double-rocker", 2)] < 2e-3


def test_critical_distances_are_those_that_a_search_from_many_starts_finds():
    rng = np.random.default_rng(5)
    found = 0
    for _ in range(60):
        d = dict(zip(("M", "N", "L1", "L2", "L3", "D"), rng.uniform(50, 800, 6).tolist(), strict=True))
        d["D"] -= 400
        own = critical_gaps(np.array([[d[key]] for key in d]), np.array([NEARLY_REAL]))[0] + d["L2"]
        for _ in range(6):
            value = stationary_distance(d, rng.uniform(0, 2 * np.pi, 2))
            if value is not None:
                assert np.nanmin(np.abs(own - value)) < 1e-6
                found += 1
    assert found > 200


def stationary_distance(d: dict[str, float], start: np.ndarray) -> float | None:
    """Newton's method on the slope of the squared distance, both by complex steps and differences of them."""

    def slope(a: float, b: float) -> np.ndarray:
        step = 1e-30j
        return np.array([(distance(d, a + step, b) ** 2).imag, (distance(d, a, b + step) ** 2).imag]) / 1e-30

    at = start
    for _ in range(50):
        h = 1e-6
        own = slope(*at)
        matrix = np.column_stack([(slope(*(at + h * e)) - slope(*(at - h * e))) / (2 * h) for e in np.eye(2)])
        at = at - np.linalg.lstsq(matrix, own, rcond=None)[0]
    scale = d["L1"] * d["L3"]
    return float(distance(d, *at)) if np.abs(slope(*at)).max() < 1e-7 * scale else None


def test_where_no_critical_distance_is_near_the_coupler_the_type_is_one_all_over_a_square():
    of = made("crank and coupler")
    rng = np.random.default_rng(11)
    certain = 0
    for width in (0.2, 0.05, 0.01):
        corners = rng.uniform(0, 1 - width, (400, 2))
        widths = np.full(len(corners), width)
        gaps = of.plane.gaps(corners + width / 2, widths)
        clear = ~(np.abs(gaps) <= of.plane.reach(widths)[:, None]).any(axis=1)
        for corner in corners[clear]:
            inside = corner + width * rng.uniform(0, 1, (50, 2))
            assert len(np.unique(of.plane.numbers_at(inside))) == 1
            certain += 1
    assert certain > 300


def test_the_design_stands_on_the_map_with_its_distances_to_the_next_types():
    of = motion_map(sb.load("rssr"), {"L1": (100, 400), "L3": "30 cm : 80 cm"}, follow=["L2"])
    design = of.design
    assert (design.x, design.y, design.inside, design.kind) == (250, 550, True, Kind("crank-rocker", 2))
    told = [(step.axis.name, step.way, step.value, step.kind) for step in design.steps]
    other = Kind("double-rocker", 1)
    # N L3 = 2 M L1, with M = N
    assert told == [
        ("L1", "down", None, None),
        ("L1", "up", pytest.approx(275, abs=1e-7), other),
        ("L3", "down", pytest.approx(500, abs=1e-7), other),
        ("L3", "up", None, None),
    ]
    off = motion_map(sb.load("rssr"), {"L1": (300, 400), "L3": (300, 800)}).design
    assert (off.inside, off.steps, off.kind) == (False, (), design.kind)


def test_all_four_sides_of_a_design_are_told_the_type_beyond():
    of = motion_map(sb.load("rssr"), {"M": (-1000, 1400), "D": (-1000, 1500)}, grid=11, follow=["L2"])
    assert [step.kind for step in of.design.steps] == [Kind("double-rocker", 1)] * 4
    assert [step.value for step in of.design.steps[:2]] == pytest.approx([-770, 770], abs=1e-6)


def test_the_speed_changes_no_motion_type():
    of = motion_map(sb.load("rssr"), {"speed": (1, 20), "M": (600, 800)}, follow=["L2"])
    assert of.areas[Kind("crank-rocker", 2)] == pytest.approx(170 / 200, abs=1e-9)


def test_a_planar_four_bar_of_the_general_way_follows_grashof():
    of = motion_map(sb.load("planar_4r"), {"length_1": (10, 150), "length_3": (10, 200)}, grid=9)
    points = np.random.default_rng(2).uniform(0, 1, (3_000, 2))
    crank, rocker = of.values(points).T
    sides = np.stack([crank, np.full_like(crank, 100.0), rocker, np.full_like(crank, 90.0)])
    ranked = np.sort(sides, axis=0)
    turns = ranked[0] + ranked[3] < ranked[1] + ranked[2]
    by_shortest = np.array(["crank-rocker", "double-rocker", "rocker-crank", "double-crank"])
    expected = np.where(turns, by_shortest[sides.argmin(axis=0)], "double-rocker")
    drawn = np.array([of.kinds[n].motion_type for n in of.numbers_at(points)])
    for index in np.flatnonzero(drawn != expected):
        assert apart(of, points[index]) <= 3 * of.tolerance
    assert set(drawn) == {"crank-rocker", "rocker-crank", "double-crank", "double-rocker"}
    told = {(s.axis.name, s.way): s.value for s in of.design.steps}
    # 40 + 100 < 80 + 90: until the crank has 70, the rocker 50, and with 150 the rocker is the longest
    assert told["length_1", "up"] == pytest.approx(70, abs=1e-3)
    assert told["length_3", "down"] == pytest.approx(50, abs=1e-3)
    assert told["length_3", "up"] == pytest.approx(150, abs=1e-3)
