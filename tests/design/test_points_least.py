"""The point of least acceleration: against dense searches, closed forms, and bounds that a test works out anew."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.points import (
    least_acceleration_point,
    least_point,
)
from sevenbar.errors import MissingExtraError, RequestError

CUBE = [(-200.0, 200.0)] * 3


@pytest.fixture(scope="module")
def seven_r():
    return sb.load("seven_r").motion(720)


def greatest(circuit, link, at, of="acceleration"):
    """The greatest over the rows, from the circuit alone."""
    return float(np.linalg.norm(getattr(circuit.point(link, tuple(at)), of), axis=1).max())


def dense_search(motion, link, box, *, of="acceleration", per_side=17, rounds=10):
    """The least over a grid of points, again and again on finer grids round the best: no gradients, no cones.

    Rates of a rigid link are affine in the point, so four points of the circuit tell those of all.
    """
    circuit = motion.circuits[0]
    origin, *ends = (
        getattr(circuit.point(link, at), of)
        for at in ((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (0.0, 100.0, 0.0), (0.0, 0.0, 100.0))
    )
    slopes = np.stack([(end - origin) / 100.0 for end in ends])
    low, high = np.array(box, dtype=float).T
    best, where = np.inf, (low + high) / 2
    middle, half = (low + high) / 2, (high - low) / 2
    for _ in range(rounds):
        axes = [
            np.clip(np.linspace(m - h, m + h, per_side), a, b)
            for m, h, a, b in zip(middle, half, low, high, strict=True)
        ]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        squares = np.zeros(len(points))
        for row in range(len(origin)):
            value = origin[row] + points @ slopes[:, row]
            np.maximum(squares, np.einsum("ij,ij->i", value, value), out=squares)
        k = int(squares.argmin())
        if squares[k] < best**2:
            best, where = float(np.sqrt(squares[k])), points[k]
        middle, half = where, half / 3
    return best, where


@pytest.mark.parametrize(("name", "link"), [("seven_r", 4), ("rssr", 2)])
def test_a_dense_search_never_beats_the_point_of_least_acceleration_and_comes_near_it(name, link):
    motion = sb.load(name).motion(720)
    found = least_acceleration_point(motion, link, CUBE)
    searched, where = dense_search(motion, link, CUBE)
    # rows half a degree apart miss the greatest by a hundred-thousandth at most
    assert searched >= found.bound * (1 - 1e-4)
    assert searched == pytest.approx(found.value, rel=1e-4)
    assert greatest(motion.circuits[0], link, where) >= found.value * (1 - 1e-4)
    # the point itself, by the circuit's own rows
    assert greatest(motion.circuits[0], link, found.at) == pytest.approx(found.value, rel=1e-4)
    assert greatest(motion.circuits[0], link, found.at) <= found.value * (1 + 1e-12)


def test_the_paper_s_link_4_has_less_than_a_third_of_its_point_s_acceleration_elsewhere(seven_r):
    found = least_acceleration_point(seven_r, 4, CUBE)
    assert (found.before[0].name, found.before[0].value) == ("P", pytest.approx(269.7631395, rel=1e-8))
    assert found.value < found.before[0].value / 3
    assert found.sides == ()


@pytest.mark.parametrize("of", ["velocity", "acceleration", "jerk"])
@pytest.mark.parametrize("side", [200.0, 50.0, 5.0])
@pytest.mark.parametrize(
    ("name", "link"), [("seven_r", 4), ("rssr", 2), ("rscr", 2), ("goldberg_5r", 2), ("planar_4r", 2)]
)
def test_the_gap_between_value_and_bound_is_nothing(name, link, side, of):
    found = least_point(sb.load(name).motion(), link, [(-side, side)] * 3, of=of)
    assert found.bound <= found.value
    assert found.relative_gap < 1e-9
    assert found.optimal


def test_the_bound_holds_at_random_points_of_the_box(seven_r):
    circuit, random = seven_r.circuits[0], np.random.default_rng(5)
    for of in ("velocity", "acceleration", "jerk"):
        found = least_point(seven_r, 4, CUBE, of=of)
        near = found.at + random.normal(size=(100, 3)) * np.logspace(-3, 2, 100)[:, None]
        for at in [*random.uniform(-200, 200, (100, 3)), *np.clip(near, -200, 200)]:
            assert greatest(circuit, 4, at, of) >= found.bound * (1 - 1e-4)


def test_the_bound_follows_from_the_inputs_and_weights_that_are_told(seven_r):
    # sum w_i |a_i|, lessened by what the slope could give anywhere in the box
    found = least_acceleration_point(seven_r, 4, CUBE)
    law = sb.Law.of(np.arange(len(found.inputs)), found.inputs, seven_r.speed, 0.0)
    pose = seven_r.circuits[0].q[0]
    circuit = seven_r.linkage.circuit(pose, law=law)
    centre = np.zeros(3)
    units = np.eye(3) * 100
    vectors = circuit.point(4, tuple(found.at)).acceleration
    dual = found.weights[:, None] * vectors / np.linalg.norm(vectors, axis=1)[:, None]
    base = circuit.point(4, tuple(centre)).acceleration
    slope = [float((dual * (circuit.point(4, tuple(u)).acceleration - base)).sum()) / 100 for u in units]
    bound = float((dual * base).sum()) - 200 * np.abs(slope).sum()
    assert found.weights.sum() == pytest.approx(1.0)
    assert bound == pytest.approx(found.value, rel=1e-7)


def test_the_greatest_is_sought_between_the_rows(seven_r):
    found = least_acceleration_point(seven_r, 4, CUBE)
    fine = seven_r.linkage.motion(36_000).circuits[0]
    assert greatest(fine, 4, found.at) == pytest.approx(found.value, rel=1e-7)
    assert greatest(fine, 4, found.at) <= found.value * (1 + 1e-12)
    sizes = np.linalg.norm(fine.point(4, tuple(found.at)).acceleration, axis=1)
    at_them = np.interp(found.inputs, fine.input, sizes)
    assert at_them == pytest.approx(np.full(len(at_them), found.value), rel=1e-6)


def test_a_box_that_is_in_the_way_is_named_and_a_larger_one_gives_less(seven_r):
    small = least_acceleration_point(seven_r, 4, [(-50, 50)] * 3)
    large = least_acceleration_point(seven_r, 4, CUBE)
    assert small.sides == ("v lowest", "w lowest")
    assert small.value > large.value
    larger = least_acceleration_point(seven_r, 4, [(-2000, 2000)] * 3)
    assert larger.value == pytest.approx(large.value, rel=1e-12)
    assert larger.at == pytest.approx(large.at, abs=1e-5)


def test_a_coordinate_can_be_given(seven_r):
    found = least_acceleration_point(seven_r, 4, [(-200, 200), (-200, 200), (-80, -80)])
    assert found.at[2] == -80
    assert found.sides == ("w given",)
    assert found.relative_gap < 1e-9
    assert found.value > least_acceleration_point(seven_r, 4, CUBE).value


def test_the_axis_of_a_planar_crank_has_no_acceleration():
    motion = sb.load("planar_4r").motion()
    found = least_acceleration_point(motion, 1, [(-20, 10), (-5, 60), (-7, 90)])
    # u runs along the axis, along which nothing changes: the middle of the box is taken
    assert found.value == pytest.approx(0, abs=1e-10)
    assert found.at == pytest.approx([-5, 0, 0], abs=1e-9)
    assert np.abs(found.free) == pytest.approx(np.array([[1.0, 0, 0]]), abs=1e-12)
    assert found.optimal


def test_a_crank_s_point_off_the_axis_has_r_omega_squared():
    motion = sb.load("planar_4r").motion(speed=3.0)
    found = least_acceleration_point(motion, 1, [(0, 0), (12, 30), (5, 30)])
    assert found.value == pytest.approx(13 * 9, rel=1e-12)
    assert least_point(motion, 1, [(0, 0), (12, 30), (5, 30)], of="velocity").value == pytest.approx(
        13 * 3, rel=1e-12
    )
    assert least_point(motion, 1, [(0, 0), (12, 30), (5, 30)], of="jerk").value == pytest.approx(
        13 * 27, rel=1e-12
    )


def test_speed_scales_value_and_bound_and_keeps_the_point():
    linkage = sb.load("seven_r")
    slow, quick = (least_acceleration_point(linkage.motion(speed=s), 4, CUBE) for s in (1.0, -4.0))
    assert quick.value == pytest.approx(16 * slow.value, rel=1e-10)
    assert quick.at == pytest.approx(slow.at, abs=1e-5)


def test_the_least_root_mean_square_is_the_zero_of_its_gradient_by_differences(seven_r):
    fine = seven_r.circuits[0]

    def square(at):
        return float((fine.point(4, tuple(at)).acceleration ** 2).sum(axis=1).mean())

    found = least_point(seven_r, 4, CUBE, measure="rms")
    assert found.sides == ()
    assert found.value == pytest.approx(np.sqrt(square(found.at)), rel=1e-12)
    slopes = [square(found.at + step) - square(found.at - step) for step in np.eye(3)]
    assert slopes == pytest.approx(np.zeros(3), abs=1e-6 * found.value**2)
    assert found.relative_gap < 1e-12
    bounded = least_point(seven_r, 4, [(-50, 50)] * 3, measure="rms")
    assert bounded.sides == ("v lowest", "w lowest")
    random = np.random.default_rng(2)
    assert min(np.sqrt(square(at)) for at in random.uniform(-50, 50, (200, 3))) >= bounded.bound


def test_the_idle_spin_of_a_coupler_makes_no_difference_to_points_on_its_line():
    motion = sb.load("rssr").motion()
    on_line = [(0, 600), (0, 0), (0, 0)]
    found = least_acceleration_point(motion, 2, on_line)
    general = least_acceleration_point(sb.load("rssr").motion(method="general"), 2, on_line)
    assert general.value == pytest.approx(found.value, rel=1e-9)
    assert dense_search(motion, 2, on_line)[0] == pytest.approx(found.value, rel=1e-4)


def test_a_law_off_the_limits_lets_a_circuit_that_rocks_have_an_answer():
    linkage = sb.load("rscr")
    t = np.linspace(0, 2 * np.pi, 181)
    middle, swing = 1.3, 1.2
    law = sb.Law.of(t, middle - swing * np.cos(t), swing * np.sin(t), swing * np.cos(t), -swing * np.sin(t))
    motion = linkage.motion(law=law)
    rocking = next(c for c in motion if c.input_range is not None)
    values = []
    for branch in (0, 1):
        found = least_acceleration_point(motion, 2, CUBE, circuit=rocking.index, branch=branch)
        assert found.optimal
        rows = rocking.branch == branch
        rates = np.linalg.norm(rocking.point(2, tuple(found.at)).acceleration[rows], axis=1)
        assert rates.max() == pytest.approx(found.value, rel=1e-12)
        values.append(found.value)
    assert values[0] != pytest.approx(values[1], rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            (4, [(1, -1), (0, 1), (0, 1)]),
            "box: empty along u: lowest 1 above highest -1; give the lower first",
        ),
        ((4, [(0, 1), (0, 1)]), "box: [(0, 1), (0, 1)] is no box; give three pairs, lowest and highest"),
        ((4, "wide"), "box: 'wide' is no box; give three pairs, lowest and highest"),
        ((4, [(0, np.nan), (0, 1), (0, 1)]), "box[1]: nan is not a finite number; give a finite one"),
        ((7, CUBE), "link: 7 is the ground, which stands still; give 1 to 6"),
        ((0, CUBE), "link: 0 is not a link; give 1 to 6"),
        ((True, CUBE), "link: True is not a link; give 1 to 6"),
        ((9, CUBE), "link: 9 is not a link; give 1 to 6"),
    ],
)
def test_what_is_said_of_a_link_or_box_that_does_not_fit(seven_r, arguments, message):
    with pytest.raises(RequestError) as caught:
        least_acceleration_point(seven_r, *arguments)
    assert str(caught.value) == message


def test_what_is_said_of_circuits_passes_and_quantities_that_do_not_fit(seven_r):
    for options, message in (
        ({"circuit": 8}, "circuit: 8 is not a circuit of this motion; give 0 to 7"),
        ({"branch": 1}, "branch: 1 is not a pass of circuit 0; give 0"),
        ({"of": "snap"}, "of: 'snap' is not offered; give velocity, acceleration or jerk"),
        ({"measure": "mean"}, "measure: 'mean' is not offered; give greatest or rms"),
    ):
        with pytest.raises(RequestError) as caught:
            least_point(seven_r, 4, CUBE, **options)
        assert str(caught.value) == message


def test_a_circuit_that_rocks_at_constant_speed_is_refused_with_a_way_out():
    motion = sb.load("rscr").motion()
    rocking = next(c for c in motion if c.input_range is not None)
    with pytest.raises(RequestError) as caught:
        least_acceleration_point(motion, 2, CUBE, circuit=rocking.index)
    assert str(caught.value) == (
        f"circuit: circuit {rocking.index} rocks: at constant speed of crank its rates grow without bound at "
        "the limits; give a law that stays off them, or a circuit whose input goes round: 0, 2"
    )


def test_a_law_that_leaves_the_range_is_refused():
    linkage = sb.load("rscr")
    t = np.linspace(0, 1, 20)
    motion = linkage.motion(law=sb.Law.of(t, 6 * t, 6.0, 0.0))
    rocking = next(c for c in motion if c.input_range is not None)
    with pytest.raises(
        RequestError, match=r"law: circuit \d has no rates at \d+ of 20 rows, the first at crank"
    ):
        least_acceleration_point(motion, 2, CUBE, circuit=rocking.index)


def test_without_clarabel_the_extra_is_named(seven_r, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "clarabel", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'sevenbar\[design\]'"):
        least_acceleration_point(seven_r, 4, CUBE)
