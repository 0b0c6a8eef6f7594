"""Ranges of joints, cones of balls and distances of links along circuits, against formulas and dense samples."""

import math
import pickle

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.curves.least_cone import least_axis
from sevenbar.curves.lipschitz import lowest
from sevenbar.errors import RequestError
from sevenbar.forces.cones import Bounds, least_greatest_size
from sevenbar.kinematics.loop.rods import nearest_shares, rod_distance
from sevenbar.kinematics.ranges.allowed import distances
from sevenbar.kinematics.ranges.ball_angle import ball_angle
from sevenbar.reporting.extents import extent_rows, span_rows


def degrees(found):
    return [math.degrees(end.value) for end in (found.low, found.high)]


def corner(a, b, c):
    """The angle [deg] of a triangle between its sides a and b, opposite to c."""
    return math.degrees(math.acos((a * a + b * b - c * c) / (2 * a * b)))


def test_the_rocker_of_a_four_bar_ranges_between_its_dead_centres():
    crank, coupler, rocker, ground = 40, 100, 80, 90
    circuit = sb.four_bar(crank=crank, coupler=coupler, rocker=rocker, ground=ground).motion().circuits[0]
    ranges = circuit.joint_ranges
    assert ranges["theta_1"].endless
    # the crank in line with the coupler, folded and stretched
    ends = [180 - corner(ground, rocker, coupler + way * crank) for way in (1, -1)]
    signed = [math.copysign(end, ranges["theta_4"].low.value) for end in ends]
    assert degrees(ranges["theta_4"]) == pytest.approx(sorted(signed), abs=1e-10)
    # between coupler and rocker: the crank in line with the ground
    between = [corner(coupler, rocker, ground + way * crank) for way in (1, -1)]
    assert math.degrees(ranges["theta_3"].extent) == pytest.approx(between[0] - between[1], abs=1e-10)
    assert circuit.angle.lowest == pytest.approx(ranges["theta_4"].low.value, abs=1e-13)
    assert circuit.angle.lowest_at == pytest.approx(ranges["theta_4"].low.input, abs=1e-7)


def test_the_slider_of_an_in_line_crank_goes_two_cranks_and_the_rod_swings_to_the_arcsine():
    crank, rod = 50.0, 120.0
    circuit = sb.slider_crank(crank=crank, rod=rod).motion().circuits[0]
    ranges = circuit.joint_ranges
    slider = circuit.columns[circuit.output_column]
    assert ranges[slider].extent == pytest.approx(2 * crank, abs=1e-10)
    swung = [r.extent for name, r in ranges.items() if name != slider and not r.endless]
    assert swung == pytest.approx([2 * math.asin(crank / rod)], abs=1e-12)


def test_every_joint_of_a_parallelogram_turns_on_and_on_through_its_change_points():
    motion = sb.four_bar(crank=40, coupler=100, rocker=40, ground=100).motion()
    assert motion.motion_type == "change-point"
    assert [[r.endless for r in ranges.values()] for ranges in motion.joint_ranges] == [[True] * 4] * 2
    # flat, with one crank towards the other: the ground less a crank
    flat = [circuit.clearances[0].distance.value for circuit in motion]
    assert flat == pytest.approx([60.0, 60.0], abs=1e-9)


def test_a_slow_circuit_of_two_turns_ranges_over_both():
    circuit = sb.load("bricard_trihedral").motion().circuits[0]
    dense = sb.load("bricard_trihedral").motion(3600).circuits[0].q
    for column, found in enumerate(circuit.joint_ranges.values()):
        if not found.endless:
            assert np.ptp(dense[:, column]) == pytest.approx(found.extent, abs=1e-6)


def test_with_square_axes_and_no_offset_the_stud_of_the_crank_runs_on_a_circular_cone():
    # |B| is constant, so A . (B - A) is: in the crank the coupler keeps its angle from the line to the origin
    M, N, L1, L3 = 700.0, 680.0, 250.0, 550.0
    linkage = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=0)
    cone = linkage.motion().circuits[0].ball_cones["ball_a"]
    coupler, reach = math.sqrt((L1 - M) ** 2 + L3**2 + N**2), math.hypot(L1, N)
    cosine = (M**2 + L3**2 - reach**2 - coupler**2) / (2 * coupler * reach)
    assert cone.spread == pytest.approx(math.acos(abs(cosine)), abs=1e-12)
    assert cone.least.value == pytest.approx(cone.greatest.value, abs=1e-12)
    np.testing.assert_allclose(cone.middle, np.array([-L1, 0, -N]) / reach, rtol=0, atol=1e-12)


def test_from_the_axis_of_the_crank_the_bend_is_greatest_where_the_rocker_is_lowest():
    M, N, L1, L3 = 700.0, 700.0, 250.0, 550.0
    circuit = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=0).motion().circuits[0]
    cone = circuit.ball_cone("ball_a", seat=(0, 0, -1))
    coupler = math.sqrt((L1 - M) ** 2 + L3**2 + N**2)
    rocker = circuit.joint_ranges["rocker"]
    ends = [math.acos((N - L3 * math.sin(end.value)) / coupler) for end in (rocker.low, rocker.high)]
    assert cone.greatest.value == pytest.approx(max(ends), abs=1e-12)
    assert cone.least.value == pytest.approx(min(ends), abs=1e-12)
    assert cone.seat == (0.0, 0.0, -1.0)
    assert cone.spread < cone.greatest.value


def cap(directions):
    """Half the smallest cap about unit vectors within half a space, from the smallest ball about them."""
    count = len(directions)
    free = Bounds(np.vstack([np.eye(3), -np.eye(3)]), np.full(6, 2.0), 6)
    found = least_greatest_size(-directions, np.broadcast_to(np.eye(3), (count, 3, 3)), free, who="the test")
    return math.asin(min(1.0, np.linalg.norm(directions - found.x, axis=1).max()))


@pytest.mark.parametrize(
    ("name", "samples"), [("rssr", 720), ("rscr", 1440), ("rssp", 720), ("rsur", 720), ("swash_plate", 720)]
)
def test_extremes_are_never_passed_by_samples_and_these_come_near_by_the_square_of_their_step(name, samples):
    linkage = sb.load(name)
    few, dense = linkage.motion(90), linkage.motion(samples)
    for circuit, rows in zip(few, dense, strict=True):
        near = 40 * (2 * math.pi / samples) ** 2
        for column, found in zip(
            range(rows.q.shape[1]), map(circuit.joint_ranges.get, rows.columns), strict=True
        ):
            if found is None or found.endless:
                continue
            values = rows.q[:, column]
            size = circuit.size if linkage.unit_of(column) != "rad" else 1.0
            gap = (found.extent - np.nanmax(values) + np.nanmin(values)) / size
            assert -1e-12 < gap < near
        for joint, cone in circuit.ball_cones.items():
            bend = ball_angle(linkage, joint, cone.seat, cone.stud)
            bent = bend.at(rows.q)
            assert -1e-12 < cone.greatest.value - bent.max() < near
            assert -1e-12 < bent.min() - cone.least.value < near
            assert cone.greatest.value == pytest.approx(cone.spread, abs=1e-12)
            studs = bend.studs(rows.q)
            if cone.middle_of == "stud":
                studs = np.einsum("nji,j->ni", bend.rotation(rows.q), bend.seat)
            assert cone.spread == pytest.approx(cap(studs), abs=max(near, 1e-6))
        for one in circuit.clearances:
            least = distances(linkage, rows, one.links).min()
            assert -1e-9 < (least - one.distance.value) / circuit.size < near


def test_the_smallest_cone_of_a_few_directions_is_that_of_a_search():
    rng = np.random.default_rng(5)
    for _ in range(20):
        few = rng.normal(size=(6, 3)) + np.array([0, 0, 2.5])
        few /= np.linalg.norm(few, axis=1)[:, None]
        axis = least_axis(few)
        assert math.acos((few @ axis).min()) == pytest.approx(cap(few), abs=1e-7)


def test_the_nearest_points_of_two_rods_are_those_of_a_grid():
    rng = np.random.default_rng(2)
    ends = rng.normal(size=(4, 200, 3))
    ends[3, :40] = ends[2, :40] + ends[1, :40] - ends[0, :40]  # parallel
    ends[1, 40:60] = ends[0, 40:60]  # a point
    ends[3, 50:70] = ends[2, 50:70]
    found = rod_distance(*ends)
    t = np.linspace(0, 1, 101)
    first = ends[0][:, None] + t[None, :, None] * (ends[1] - ends[0])[:, None]
    second = ends[2][:, None] + t[None, :, None] * (ends[3] - ends[2])[:, None]
    grid = np.linalg.norm(first[:, :, None] - second[:, None], axis=-1).min(axis=(1, 2))
    assert (found <= grid + 1e-12).all()
    lengths = np.linalg.norm(ends[1] - ends[0], axis=1) + np.linalg.norm(ends[3] - ends[2], axis=1)
    assert (grid - found <= 0.011 * lengths).all()
    for share in nearest_shares(*ends):
        assert ((share >= 0) & (share <= 1)).all()


def test_a_search_that_ends_at_its_limit_says_what_it_may_have_missed():
    edges, bounds = np.linspace(0, 10, 81), np.full(80, 10.0)
    place, value, missed = lowest(lambda s: np.full(len(s), 1.0), edges, bounds, 1e-7, floor=0.0)
    assert (place, value) == (0.0, 1.0)
    assert 1e-7 < missed < 1e-2
    # nothing lies below the floor
    assert lowest(np.zeros_like, edges, bounds, 1e-7, floor=0.0) == (0.0, 0.0, 0.0)
    place, value, missed = lowest(lambda s: (s - 3.3) ** 2, edges, bounds, 1e-7, floor=-math.inf)
    assert place == pytest.approx(3.3, abs=1e-3)
    assert value - missed <= 0 <= value <= 1e-7


@pytest.mark.parametrize("angle", [1e-3, 1e-5, 1e-6, 9e-7, 1e-7, 1e-9, 1e-12, 1e-16, 0.0])
def test_rods_that_cross_at_any_angle_meet(angle):
    ends = np.array([[[-1.0, 0, 0]], [[1, 0, 0]], [[-1, -0.4 * angle, 0.1]], [[1, 1.6 * angle, 0.1]]])
    assert rod_distance(*ends)[0] == pytest.approx(0.1, abs=1e-16)
    ends[2:, :, 2] = 0.0
    assert rod_distance(*ends)[0] < 1e-12


STOPS = {
    "ranges": {"rocker": ("-20 deg", "25 deg")},
    "cones": {"ball_a": sb.Cone(math.radians(60), seat=(0, 0, -1)), "ball_b": "20 deg"},
    "radii": {1: 400, 3: 380},
}


@pytest.mark.parametrize("kept", [("ranges",), ("cones",), ("radii",), ("ranges", "cones", "radii")])
def test_spans_end_where_rows_begin_to_be_forbidden(kept):
    linkage = sb.load("rssr").stopped(**{key: STOPS[key] for key in kept})
    circuit = linkage.motion(3600).circuits[0]
    found = circuit.allowed
    assert 0 < found.share < 1
    edges = np.flatnonzero(found.within != np.roll(found.within, 1))
    ends = sorted(end % math.tau for span in found.spans for end in (span.start, span.end))
    assert len(ends) == len(edges)
    np.testing.assert_allclose(np.sort(circuit.input[edges] % math.tau), ends, atol=math.tau / 3600 * 1.01)
    for span in found.spans:
        for stop in (span.first_stop, span.last_stop):
            assert stop in set(found.stopped_by.tolist())


def test_a_circuit_without_stops_is_whole_and_one_that_stops_forbid_has_no_span():
    circuit = sb.load("rssr").motion(72).circuits[0]
    assert circuit.allowed.whole
    assert circuit.allowed.share == 1.0
    assert circuit.allowed.within.all()
    none = sb.load("rssr").stopped(ranges={"rocker": ("100 deg", "120 deg")}).motion(72).circuits[0].allowed
    assert none.spans == ()
    assert none.share == 0.0
    assert set(none.stopped_by.tolist()) == {"range of rocker"}


def test_every_stop_that_forbids_a_circuit_is_named():
    ranges, cones = {"rocker": ("100 deg", "120 deg")}, {"ball_a": sb.Cone(math.radians(1), seat=(0, 0, 1))}
    motion = sb.load("rssr").stopped(ranges=ranges, cones=cones).motion(72)
    allowed = motion.circuits[0].allowed
    assert set(allowed.stopped_by.tolist()) == {"range of rocker, cone of ball_a"}
    assert not allowed.within.any()
    assert span_rows(motion)[1][0][-1] == "cone of ball_a; range of rocker"


def test_a_range_that_ends_at_the_joint_s_own_extremes_stops_nothing():
    linkage = sb.load("planar_4r")
    own = linkage.motion(72).circuits[0].joint_ranges["theta_4"]
    for turn in (0.0, math.tau):
        ends = (own.low.value + turn, own.high.value + turn)
        assert linkage.stopped(ranges={"theta_4": ends}).motion(72).circuits[0].allowed.whole


def test_an_input_that_rocks_is_stopped_on_both_of_its_ways():
    linkage = sb.load("rssr").stopped(ranges={"rocker": ("-10 deg", "10 deg")})
    for circuit in linkage.motion(360, input="rocker"):
        found = circuit.allowed
        if found.share:
            assert {span.first_stop for span in found.spans} == {"range of rocker"}
            ends = [math.degrees(end) % 360 for span in found.spans for end in (span.start, span.end)]
            # over the dead centre at -7 degrees and back
            assert {round(end, 9) for end in ends} == {10.0}
            assert [span.dead_centres for span in found.spans] == [1]


def test_rows_of_a_law_have_the_ranges_of_the_whole_circuit():
    linkage = sb.load("rssr")
    law = sb.Law.of(np.linspace(0, 1, 5), np.linspace(0, 0.1, 5), 0.1, 0.0)
    circuit = linkage.motion(law=law).circuits[0]
    whole = linkage.motion().circuits[0]
    assert circuit.joint_ranges["rocker"].extent == pytest.approx(
        whole.joint_ranges["rocker"].extent, abs=1e-12
    )


def test_a_circuit_with_ranges_can_be_pickled():
    circuit = sb.load("rscr").stopped(cones={"ball": "70 deg"}).motion(24).circuits[0]
    share = circuit.allowed.share
    again = pickle.loads(pickle.dumps(circuit))
    assert again.allowed.share == share
    assert again.joint_ranges == circuit.joint_ranges


def test_a_seat_that_an_idle_spin_moves_is_refused():
    circuit = sb.load("rssr").motion(24).circuits[0]
    with pytest.raises(
        RequestError, match=r"stud: \[0.0, 1.0, 0.0\] of ball_a is not along link 2, which spins idly"
    ):
        circuit.ball_cone("ball_a", stud=(0, 1, 0))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"ranges": {"rocker": (1.0, 0.0)}}, "the low end is not below the high end"),
        ({"ranges": {"rocker": ("0 deg", "400 deg")}}, "400 deg is more than a turn"),
        ({"ranges": {"rocker": 3.0}}, "is not a range; give two values, low and high"),
        ({"ranges": {"ball_a": (0.0, 1.0)}}, "joint 'ball_a' is a ball"),
        ({"cones": {"crank": 0.2}}, "'crank' is not a joint S or U, which a cone is of; give one of ball_a"),
        ({"cones": {"ball_a": 0.0}}, "0 deg is no cone; give an angle above 0, up to 180 deg"),
        ({"cones": {"ball_a": "15"}}, "is not a number with a unit that fits"),
        ({"radii": {5: 3.0}}, "link 5 is not a link; give 1 to 4, the last is the ground"),
        ({"radii": {1: -3.0}}, "-3.0 is not a radius; give a number > 0"),
    ],
)
def test_stops_that_do_not_fit_are_refused(given, message):
    with pytest.raises(RequestError, match=message):
        sb.load("rssr").stopped(**given)


def test_what_is_rounding_or_stays_is_reported_once():
    plane = {"axis": (0, 0, 1)}
    slider = sb.from_axes(
        [
            {"name": "crank", "kind": "R", "at": (0, 0, 0), **plane},
            {"kind": "R", "at": (10, 0, 0), **plane},
            {"kind": "R", "at": (40, 0, 0), **plane},
            {"name": "slide", "kind": "P", "at": (40, 0, 0), "axis": (1, 0, 0)},
        ]
    )
    rows = {row[1]: row for row in extent_rows(slider.motion(36))[1] if row[0] == "0"}
    # between the dead centres the slide goes from 20 below where it is drawn to there
    assert [cell.partition(" @")[0] for cell in rows["slide"][2:5]] == ["-20 mm", "0 mm", "20 mm"]
    rows = {row[1]: row for row in extent_rows(sb.load("rssr").motion(36))[1] if row[0] == "0"}
    assert rows["bend of ball_a"][2:4] == ("59.393\u00b0", "59.393\u00b0")
