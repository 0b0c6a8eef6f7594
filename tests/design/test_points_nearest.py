"""The point whose path is nearest a curve: a known point is found again, and what is between rows counts."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.points import nearest_path_point
from sevenbar.design.points.cycle import cycle_of
from sevenbar.design.points.nearest import _foot
from sevenbar.errors import RequestError

CUBE = [(-200.0, 200.0)] * 3
KNOWN = (-100.0, -90.0, -80.0)


@pytest.fixture(scope="module")
def seven_r():
    return sb.load("seven_r").motion()


@pytest.fixture(scope="module")
def odd_rows(seven_r):
    """The path of the paper's point at inputs that are no rows of any grid here."""
    circuit = seven_r.linkage.motion(47).circuits[0]
    return circuit.input, circuit.point(4, KNOWN).position


@pytest.mark.parametrize("measure", ["rms", "greatest"])
def test_with_inputs_a_known_point_is_found_again(seven_r, odd_rows, measure):
    inputs, places = odd_rows
    found = nearest_path_point(seven_r, 4, places, CUBE, inputs=inputs, measure=measure)
    assert found.at == pytest.approx(KNOWN, abs=1e-6)
    assert found.greatest < 1e-6
    assert found.bound is not None


@pytest.mark.parametrize(("name", "link", "at"), [("seven_r", 4, KNOWN), ("rssr", 2, (310.0, 40.0, -25.0))])
def test_without_inputs_a_known_point_is_found_again(name, link, at):
    linkage = sb.load(name)
    places = linkage.motion(41).circuits[0].point(link, at).position
    box = [(value - 90.0, value + 130.0) for value in at]
    found = nearest_path_point(linkage.motion(), link, places, box)
    assert found.at == pytest.approx(at, abs=1e-5)
    assert found.greatest < 1e-6
    assert found.bound is None
    assert found.starts == 27
    assert 1 <= found.agreeing <= 27


def test_with_inputs_no_point_of_the_box_is_nearer_than_the_bound(seven_r, odd_rows):
    inputs, places = odd_rows
    random = np.random.default_rng(3)
    bent = places + random.normal(scale=4.0, size=places.shape)
    circuit = seven_r.linkage.motion(47).circuits[0]
    for measure in ("rms", "greatest"):
        found = nearest_path_point(seven_r, 4, bent, CUBE, inputs=inputs, measure=measure)
        value = getattr(found, measure)
        assert value == pytest.approx(found.bound, rel=1e-7)
        assert value > 1
        near = found.at + random.normal(size=(200, 3)) * np.logspace(-3, 2, 200)[:, None]
        for at in np.clip(near, -200, 200):
            distance = np.linalg.norm(circuit.point(4, tuple(at)).position - bent, axis=1)
            other = np.sqrt((distance**2).mean()) if measure == "rms" else distance.max()
            assert other >= found.bound * (1 - 1e-12)


def test_without_inputs_small_moves_of_the_point_bring_its_path_no_nearer(seven_r, odd_rows):
    _, places = odd_rows
    random = np.random.default_rng(4)
    bent = places + random.normal(scale=3.0, size=places.shape)
    found = nearest_path_point(seven_r, 4, bent, CUBE)
    fine = seven_r.linkage.motion(7200).circuits[0]

    def value(at):
        # each place with the nearest of 7200 rows: brute force
        path = fine.point(4, tuple(at)).position
        apart = np.linalg.norm(bent[:, None] - path[None], axis=2).min(axis=1)
        return np.sqrt((apart**2).mean())

    assert value(found.at) == pytest.approx(found.rms, rel=1e-4)
    for step in np.concatenate([np.eye(3), -np.eye(3)]) * 0.5:
        assert value(found.at + step) > found.rms


@pytest.mark.parametrize(("unit", "size"), [("mm", 1.0), ("m", 1e-3)])
def test_nearest_places_between_rows_are_where_the_path_goes_across(unit, size):
    lengths = {"crank": 50 * size, "coupler": 90 * size, "rocker": 80 * size, "ground": 100 * size}
    cycle = cycle_of(sb.four_bar(**lengths, length_unit=unit).motion(), 2, order="position", rows=90)
    random = np.random.default_rng(1)
    at = np.array([60.0, 40.0, 0.0]) * size
    path = cycle.rates.of("position", at)
    wanted = path[random.integers(0, 90, 200)] + random.normal(size=(200, 3)) * [60 * size, 60 * size, 0]
    rates = cycle.at(_foot(cycle, wanted, at))
    away, velocity = rates.of("position", at) - wanted, rates.of("velocity", at)
    lengths = np.linalg.norm(away, axis=1) * np.linalg.norm(velocity, axis=1)
    assert abs((away * velocity).sum(axis=1) / lengths).max() < 1e-11
    to_rows = np.linalg.norm(path[:, None] - wanted, axis=2).min(axis=0)
    assert (np.linalg.norm(away, axis=1) <= to_rows * (1 + 1e-12)).all()


def test_a_place_beyond_the_centre_of_curvature_has_no_farthest_place_for_its_nearest():
    motion = sb.four_bar(crank=50, coupler=90, rocker=80, ground=100).motion()
    at = np.array([60.0, 40.0, 0.0])
    fine = cycle_of(motion, 2, order="acceleration").rates
    velocity, bend = fine.of("velocity", at), fine.of("acceleration", at)
    square = (velocity**2).sum(axis=1, keepdims=True)
    across = bend - velocity * (bend * velocity).sum(axis=1, keepdims=True) / square
    radius = square * across / (across**2).sum(axis=1, keepdims=True)
    wanted = fine.of("position", at) + 1.05 * radius
    cycle = cycle_of(motion, 2, order="position", rows=90)
    rates = cycle.at(_foot(cycle, wanted, at))
    away = rates.of("position", at) - wanted
    # half the second derivative of the squared distance by time
    curved = (rates.of("velocity", at) ** 2 + away * rates.of("acceleration", at)).sum(axis=1)
    assert curved.min() > 0


def test_a_box_in_the_way_is_kept(seven_r, odd_rows):
    inputs, places = odd_rows
    box = [(-80.0, 200.0), (-200.0, 200.0), (-200.0, 200.0)]
    for options in ({"inputs": inputs}, {}):
        found = nearest_path_point(seven_r, 4, places, box, **options)
        assert found.at[0] == pytest.approx(-80, abs=1e-6)
        assert found.rms > 1


def test_a_circuit_that_rocks_has_paths_too():
    motion = sb.load("rscr").motion()
    rocking = next(c for c in motion if c.input_range is not None)
    at = (20.0, 10.0, -5.0)
    rows = np.flatnonzero((rocking.branch == 0) & (rocking.status == "ok"))[5:-5:9]
    places = rocking.point(2, at).position[rows]
    box = [(-60.0, 60.0)] * 3
    timed = nearest_path_point(motion, 2, places, box, inputs=rocking.input[rows], circuit=rocking.index)
    assert timed.at == pytest.approx(at, abs=1e-6)
    free = nearest_path_point(motion, 2, places, box, circuit=rocking.index)
    assert free.at == pytest.approx(at, abs=1e-5)


@pytest.mark.parametrize(
    ("curve", "options", "message"),
    [
        ([[0, 0, 0]], {}, "curve: an array of shape (1, 3) is no curve; give three places (m, 3) or more"),
        ("line", {}, "curve: an array of shape (0,) is no curve; give three places (m, 3) or more"),
        (
            [[0, 0, 0], [1, np.nan, 0], [0, 1, 1]],
            {},
            "curve[1]: [1.0, nan, 0.0] is not a place; give finite numbers",
        ),
        (
            np.eye(3),
            {"inputs": [0, 1]},
            "inputs: 2 values where the curve has 3 places; give one for each",
        ),
        (np.eye(3), {"inputs": [0, 1, np.inf]}, "inputs[2]: inf is not a finite number; give a finite one"),
        (
            np.eye(3),
            {"measure": "greatest"},
            "measure: greatest needs the input of each place; give inputs, or measure rms",
        ),
        (np.eye(3), {"measure": "area"}, "measure: 'area' is not offered; give rms or greatest"),
    ],
)
def test_what_is_said_of_a_curve_that_does_not_fit(seven_r, curve, options, message):
    with pytest.raises(RequestError) as caught:
        nearest_path_point(seven_r, 4, curve, CUBE, **options)
    assert str(caught.value) == message


def test_inputs_without_a_pose_are_told():
    motion = sb.load("rscr").motion()
    rocking = next(c for c in motion if c.input_range is not None)
    with pytest.raises(RequestError, match=rf"inputs\[1\]: circuit {rocking.index} has no pose at 270 deg"):
        nearest_path_point(motion, 2, np.eye(3), CUBE, inputs=[1.0, 1.5 * np.pi, 1.2], circuit=rocking.index)
