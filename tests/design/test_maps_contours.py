"""Contours of measures: on each point the measure has the contour's value, and no contour crosses a boundary.

Source: the ordinary analysis of the linkage at the point.
"""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.maps.atlas import motion_map
from sevenbar.design.maps.contours import EXACT, EXACT_FORCES, MOST_READ, Net, traced
from sevenbar.design.maps.figures import sheet
from sevenbar.design.maps.heights import measure_heights
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import MEASURES

DIMENSIONS = {"M": 700, "N": 700, "L1": 250, "L3": 550, "D": 0}
OVER = {"M": (-1000, 1400), "D": (-1000, 1500)}


@pytest.fixture(scope="module")
def of():
    return motion_map(sb.rssr(**DIMENSIONS, speed=10.0), OVER, grid=31, follow=["L2"])


def values_at(of, place, name):
    M, D = of.values(place[None])[0]
    motion = sb.rssr(**DIMENSIONS | {"M": M, "D": D}, speed=10.0).motion(8)
    return [MEASURES[name].value(circuit) for circuit in motion.circuits]


@pytest.mark.parametrize(
    ("name", "take"),
    [
        ("swing", "highest"),
        ("transmission_lowest", "lowest"),
        ("time_ratio", 1),
        ("velocity_highest", "lowest"),
        ("swing", 1),
    ],
)
def test_the_measure_has_the_value_of_the_contour_at_its_points(of, name, take):
    (heights,) = measure_heights(of, [name], take=take)
    step = min(np.diff(heights.levels))
    rng = np.random.default_rng(1)
    looked = 0
    assert heights.contours
    for line in heights.contours:
        for index in rng.integers(0, len(line.places), 4):
            found = values_at(of, line.places[index], name)
            if isinstance(take, int):
                found = [found[take]] if len(found) > take else []
            found = [value for value in found if value is not None]
            value = (min if take == "lowest" else max)(found)
            # false position ends after a few tries where the measure jumps
            looked += abs(value - line.level) <= 2 * EXACT * step
            assert abs(value - line.level) <= 0.5 * step
    assert looked >= 0.95 * 4 * len(heights.contours)


def test_contours_of_forces_are_right_to_their_part_of_the_step():
    of = motion_map(sb.load("rssr_press"), {"L1": (230, 280), "L3": (500, 600)}, grid=5)
    (heights,) = measure_heights(of, ["peak_torque"], levels=[500.0, 1000.0, 1500.0])
    assert {line.level for line in heights.contours} == {500.0, 1000.0, 1500.0}
    for line in heights.contours:
        places = line.places[:: max(1, len(line.places) // 4)]
        (values,) = of.plane.values_at(places, [heights.measure], "highest").T
        assert np.abs(values - line.level).max() <= 2 * EXACT_FORCES * 500


def crossed(of, low, high, levels):
    """Contours of a function of x on one square, and at how many places it is read between."""
    nodes = np.array([[low, 0.0], [high, 0.0], [high, 1.0], [low, 1.0]])
    net = Net(nodes, np.zeros(4, dtype=int), np.array([[0, 1, 2], [0, 2, 3]]))
    read = []

    def value(places):
        read.extend(places.tolist())
        return of(places[:, 0])

    return list(traced(net, of(nodes[:, 0]), levels, value)), len(read)


def test_what_is_read_for_one_level_serves_the_others():
    def steep(x):
        return 100 / np.sqrt(x)

    levels = list(np.arange(200.0, 1000.0, 100.0))
    lines, count = crossed(steep, 0.01, 1.0, levels)
    assert [line.level for line in lines] == levels
    for line in lines:
        assert np.abs(steep(line.places[:, 0]) - line.level).max() <= EXACT * 100
    # three sides that every level crosses
    assert count <= 6


@pytest.mark.parametrize(
    "of", [lambda x: np.where(x < 0.3, 0.0, 9.0), lambda x: np.where(x < 0.3, 9, np.nan)]
)
def test_a_contour_ends_its_search_where_the_measure_jumps_or_has_no_value(of):
    lines, count = crossed(lambda x: np.where(x == 1.0, 0.0, of(x)), 0.0, 1.0, [2.0, 4.0])
    assert count <= 3 * 2 * MOST_READ
    assert all(((line.places >= 0) & (line.places <= 1)).all() for line in lines)


@pytest.mark.parametrize("name", ["swing", "transmission_lowest"])
def test_no_contour_leaves_the_region_of_its_kind(of, name):
    (heights,) = measure_heights(of, [name])
    assert heights.contours
    for line in heights.contours:
        assert set(of.numbers_at(line.places)) == {line.kind}
        between = (line.places[1:] + line.places[:-1]) / 2
        outside = of.numbers_at(between) != line.kind
        assert outside.mean() < 0.02
    unassembled = {n for n, kind in enumerate(of.kinds) if not kind.circuits}
    assert not unassembled & {line.kind for line in heights.contours}


def test_a_measure_that_some_types_have_not_is_drawn_in_the_others_only(of):
    (heights,) = measure_heights(of, ["time_ratio"])
    assert {of.kinds[line.kind].motion_type for line in heights.contours} == {"crank-rocker"}


def test_higher_values_stand_on_the_left_of_a_contour(of):
    (heights,) = measure_heights(of, ["transmission_lowest"], levels=[30.0])
    assert {line.level for line in heights.contours} == {30.0}
    line = max(heights.contours, key=lambda contour: len(contour.places))
    start, end = line.places[len(line.places) // 2 : len(line.places) // 2 + 2]
    left = np.array([-(end - start)[1], (end - start)[0]]) / np.hypot(*(end - start))
    higher, lower = (
        max(values_at(of, (start + end) / 2 + side * left, "transmission_lowest")) for side in (5e-3, -5e-3)
    )
    assert higher > 30.0 > lower


def test_the_value_of_the_design_is_that_of_its_motion(of):
    names = ["swing", "velocity_highest"]
    swing, velocity = measure_heights(of, names)
    circuits = sb.rssr(**DIMENSIONS, speed=10.0).motion(8).circuits
    assert swing.here == pytest.approx(max(np.degrees(c.swing) for c in circuits), rel=1e-12)
    assert velocity.here == pytest.approx(max(c.velocity.highest for c in circuits), rel=1e-12)
    assert (swing.unit, velocity.unit) == ("deg", "rad_s")


def test_a_function_of_the_motion_has_contours_too():
    def branches(motion):
        """limits of the input, apart"""
        return float(np.ptp(motion.limits)) if motion.limits.size else None

    of = motion_map(sb.load("rssr"), {"L1": (100, 400), "L3": (300, 800)}, grid=9)
    (heights,) = measure_heights(of, [branches])
    assert {of.kinds[line.kind].motion_type for line in heights.contours} == {"double-rocker"}
    assert heights.measure.title == "limits of the input, apart"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((["motion_type"],), "measure: motion_type is a word, which has no contours; give some of swing, "),
        ((["circuits"],), "measure: circuits is a count, which has no contours; give some of swing, "),
        ((["swing"], {"take": "best"}), "take: 'best' is not offered; give highest, lowest, or the index"),
        ((["swing"], {"take": -1}), "take: -1 is not offered; give highest, lowest, or the index"),
        ((["swing"], {"levels": []}), r"levels: \[\] are not finite numbers; give some, as in 20,40,60"),
        (
            (["swing"], {"levels": ["x"]}),
            r"levels: \['x'\] are not finite numbers; give some, as in 20,40,60",
        ),
        ((["swing"], {"levels": [np.nan]}), r"levels: \[nan\] are not finite numbers"),
    ],
)
def test_what_has_no_contours_is_refused_with_what_has(of, arguments, message):
    names, options = (*arguments, {})[:2]
    with pytest.raises(RequestError, match=f"^{message}"):
        measure_heights(of, names, **options)


def test_a_size_that_is_no_text_is_no_sheet() -> None:
    with pytest.raises(RequestError, match="size: 3 is not a sheet; give A4, A3, A2 or A1"):
        sheet(3)  # type: ignore[arg-type]
