"""Curves along a cycle: extremes between the rows, means and integrals, with jumps and without, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sevenbar.curves.along import Along
from sevenbar.curves.curve import greatest, mean
from sevenbar.curves.cycle_series import ENOUGH, CycleSeries, cycle_series
from sevenbar.curves.pieces import Pieces, pieces
from sevenbar.curves.stationary import highest_between, zeros_between
from sevenbar.curves.timed_rows import TimedRows, shares_of


def grid(count, first=0.0, period=math.tau):
    return first + period * np.arange(count) / count


def smooth(x):
    return 20 * np.exp(np.sin(x + 0.3)) - 3 * np.cos(7 * x) + 1


@pytest.mark.parametrize("count", [96, 97, 360])
@pytest.mark.parametrize("period", [math.tau, -math.tau, 2 * math.tau])
def test_a_series_is_the_function_between_its_rows(count, period):
    series = CycleSeries(smooth(grid(count, 0.2, period)), 0.2, period)
    x = np.linspace(-3, 9, 50)
    assert series.at(x) == pytest.approx(smooth(x), abs=1e-11)
    slope = 20 * np.cos(x + 0.3) * np.exp(np.sin(x + 0.3)) + 21 * np.sin(7 * x)
    assert series.at(x, 1) == pytest.approx(slope, abs=1e-10)
    assert series.finer(3) == pytest.approx(smooth(grid(3 * count, 0.2, period)), abs=1e-11)
    assert series.tail < 1e-13


@pytest.mark.parametrize("count", [8, 9])
def test_a_series_passes_through_any_rows(count):
    rows = np.random.default_rng(3).normal(size=(count, 2))
    series = CycleSeries(rows, 1.0, 2.0)
    assert series.at(grid(count, 1.0, 2.0)) == pytest.approx(rows, abs=1e-14)
    assert series.finer(2)[::2] == pytest.approx(rows, abs=1e-14)
    # white noise is told as rows that are too few
    assert series.tail > ENOUGH


def test_extremes_lie_between_the_rows_and_none_is_missed():
    # cos x + a cos 2x: at 0, pi, and arccos(-1 / (4 a)) for a > 1/4; just above two extremes are close to pi
    for a in (0.1, 0.2500001, 0.3, 1.0):
        inputs, values = CycleSeries(
            np.cos(grid(40, 0.1)) + a * np.cos(2 * grid(40, 0.1)), 0.1, math.tau
        ).extremes()
        expected = [math.pi, math.tau]
        if a > 0.25:
            side = math.acos(-1 / (4 * a))
            expected = [side, math.pi, math.tau - side, math.tau]
        assert inputs == pytest.approx(expected, abs=1e-9)
        assert values == pytest.approx(np.cos(inputs) + a * np.cos(2 * inputs), abs=1e-14)


@pytest.mark.parametrize("wave", [1, 5, 11])
def test_places_of_extremes_are_right_to_1e_12(wave):
    inputs, values = CycleSeries(3 + 2 * np.sin(wave * grid(36) + 0.7), 0.0, math.tau).extremes()
    places = (math.pi / 2 - 0.7 + math.pi * np.arange(2 * wave)) / wave % math.tau
    assert inputs == pytest.approx(np.sort(places), abs=1e-12)
    assert np.sort(values) == pytest.approx(np.repeat([1.0, 5.0], wave), abs=1e-13)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=1, max_size=9),
    st.floats(-10, 10),
    st.integers(40, 61),
)
def test_extremes_of_a_trigonometric_polynomial_are_the_roots_of_its_derivative(waves, first, count):
    def value(x):
        x = np.asarray(x)[..., None]
        k = np.arange(1, len(waves) + 1)
        return np.cos(k * x) @ [a for a, _ in waves] + np.sin(k * x) @ [b for _, b in waves]

    size = max(abs(np.array(waves)).max(), 1e-300)
    series = CycleSeries(value(grid(count, first)), first, math.tau)
    inputs, values = series.extremes()
    # independent: a thousand times the rows
    dense = value(np.linspace(0, math.tau, 60001))
    assert values.max() >= dense.max() - 1e-12 * size
    assert values.min() <= dense.min() + 1e-12 * size
    assert values == pytest.approx(value(inputs), abs=1e-12 * size)
    assert series.highest().value == pytest.approx(values.max(), abs=1e-14 * size)
    assert series.lowest().value == pytest.approx(values.min(), abs=1e-14 * size)
    # highest and lowest take turns
    if len(inputs) > 1:
        assert len(inputs) % 2 == 0


def test_a_constant_has_its_first_row_for_highest_and_lowest():
    for rows in (np.full(12, 4.0), np.zeros(12), 4 + 1e-15 * np.arange(12)):
        series = CycleSeries(rows, 0.5, math.tau)
        assert series.highest().value == series.lowest().value == rows[0]
        assert series.highest().input == 0.5


@pytest.mark.parametrize("noise", [0.0, 1e-16])
@pytest.mark.parametrize("value", [0.0, 0.1, -0.3, 1e-17])
def test_constant_pieces_have_their_value_as_highest_and_lowest(value, noise):
    rng = np.random.default_rng(2)

    def evaluate(x):
        return value + noise * rng.normal(size=len(x))

    curve = pieces(evaluate, np.full(8, value), 0.0, math.tau, (1.0, 2.0))
    assert [curve.highest().value, curve.lowest().value] == pytest.approx([value] * 2, abs=1e-14)


def test_a_piece_that_is_highest_at_its_end_is_not_lost_by_rounding():
    # with positive terms the value there is their sum, which two ways of adding give differently
    rng = np.random.default_rng(4)
    ends = np.array([0.0, 1.0])
    for _ in range(50):
        terms = rng.uniform(size=(1, 16, 1))
        top = Pieces(np.zeros(4), Along(ends, terms), 0.0, 1.0, breaks=ends[:1]).highest()
        assert (top.value, top.input) == pytest.approx((terms.sum(), 1.0))


def test_the_peak_of_a_sine_of_three_rows_is_right_and_of_two_is_not_claimed():
    series = CycleSeries(np.sin(grid(3) + 0.2), 0.0, math.tau)
    assert series.highest().value == pytest.approx(1.0, abs=1e-15)
    assert series.tail > ENOUGH


def test_the_running_integral_is_the_integral_less_the_mean():
    series = CycleSeries(5 + 2 * np.sin(3 * grid(50, 0.4)), 0.4, math.tau)
    running = series.running()
    x = np.linspace(0, 6, 20)
    assert running.at(x) == pytest.approx(-2 / 3 * np.cos(3 * x), abs=1e-13)
    assert running.highest().value == pytest.approx(2 / 3, abs=1e-14)
    assert running.at(x, 1) == pytest.approx(series.at(x) - 5, abs=1e-12)


def test_rows_are_doubled_until_they_are_enough():
    def sharp(x):
        return 1 / (1.05 - np.cos(x - 1))

    few = CycleSeries(sharp(grid(36)), 0.0, math.tau)
    assert few.tail > ENOUGH
    series = cycle_series(sharp, few.rows, 0.0, math.tau)
    assert len(series.rows) == 36 * 8
    assert series.tail < 1e-12
    assert series.highest().value == pytest.approx(20.0, rel=1e-12)
    assert series.highest().input == pytest.approx(1.0, abs=1e-12)
    # a jump is not resolved by any number of rows, and said so
    assert (
        cycle_series(lambda x: np.sign(np.sin(x)), np.sign(np.sin(grid(36, 0.1))), 0.1, math.tau).tail > 1e-5
    )


def stepped(x):
    inside = ((x - 1.0) % math.tau) < 1.5
    return smooth(x) + 30.0 * inside


@pytest.mark.parametrize("period", [math.tau, -math.tau])
@pytest.mark.parametrize("breaks", [(1.0, 2.5), (1.0 + math.tau, 2.5 - math.tau, 1.0)])
def test_a_jump_has_its_limits_from_both_sides(period, breaks):
    x = grid(360, 0.2, period)
    curve = pieces(stepped, stepped(x), 0.2, period, breaks)
    inputs, values = curve.extremes()
    for place in (1.0, 2.5):
        here = np.abs((inputs - place + 1) % math.tau - 1) < 1e-12
        assert np.sort(values[here]) == pytest.approx(smooth(place) + np.array([0.0, 30.0]), abs=1e-11)
    dense = np.linspace(1.0 + 1e-9, 2.5, 200001)
    assert curve.highest().value == pytest.approx(stepped(dense).max(), abs=1e-8)
    assert curve.highest().value >= stepped(dense).max() - 1e-12
    assert mean(curve) == pytest.approx(
        CycleSeries(smooth(x), 0.2, period).rows.mean() + 45 / math.tau, abs=1e-11
    )
    assert curve.tail < 1e-12


def test_the_running_integral_of_a_step_is_a_saw():
    curve = pieces(lambda x: 1.0 * (x % math.tau < 1.0), np.zeros(8), 0.0, math.tau, (0.0, 1.0))
    running = curve.running()
    share = 1 / math.tau
    assert mean(curve) == pytest.approx(share, abs=1e-15)
    assert running.highest().value - running.lowest().value == pytest.approx(1 - share, abs=1e-14)
    assert running.highest().input % math.tau == pytest.approx(1.0, abs=1e-12)
    assert running.lowest().input % math.tau == pytest.approx(0.0, abs=1e-12)


def test_pieces_and_series_agree_where_nothing_jumps():
    x = grid(360)
    series, curve = CycleSeries(smooth(x), 0.0, math.tau), pieces(smooth, smooth(x), 0.0, math.tau)
    assert curve.extremes()[0] == pytest.approx(series.extremes()[0], abs=1e-11)
    assert curve.extremes()[1] == pytest.approx(series.extremes()[1], abs=1e-11)
    both = [greatest(c.squared()) for c in (series, curve)]
    assert both[0].value == pytest.approx(both[1].value, rel=1e-13)
    assert curve.mean_of(np.square) == pytest.approx(series.mean_of(np.square), rel=1e-13)


def test_an_extreme_on_the_edge_of_a_piece_is_found_once():
    # twelve pieces: edges at multiples of pi / 6, as are the extremes of cos 2x
    inputs, values = pieces(lambda x: np.cos(2 * x), np.zeros(4), 0.0, math.tau).extremes()
    assert len(inputs) in (4, 5)
    assert np.unique(np.round(inputs % math.tau, 9) % round(math.tau, 9)) == pytest.approx(
        math.pi / 2 * np.arange(4)
    )
    assert np.abs(values) == pytest.approx(1.0, abs=1e-13)


def test_the_squared_length_of_a_turning_vector_is_constant():
    x = grid(60)
    turning = np.column_stack([3 * np.cos(x), 3 * np.sin(x), np.full(60, 4.0)])
    for curve in (
        CycleSeries(turning, 0.0, math.tau),
        pieces(
            lambda x: np.column_stack([3 * np.cos(x), 3 * np.sin(x), np.full(len(x), 4.0)]),
            turning,
            0.0,
            math.tau,
        ),
        TimedRows(turning, x, x),
    ):
        squared = curve.squared()
        assert squared.highest().value == pytest.approx(25.0, rel=1e-13)
        assert squared.lowest().value == pytest.approx(25.0, rel=1e-13)
        assert mean(squared) == pytest.approx(25.0, rel=1e-13)
        assert curve.part(2).highest().value == pytest.approx(4.0, rel=1e-13)


def test_the_mean_of_a_cubed_sine_is_that_of_its_closed_form():
    squares = CycleSeries(np.sin(grid(360)), 0.0, math.tau).squared()
    cubes = squares.mean_of(lambda values: np.maximum(values, 0) ** 1.5)
    assert cubes == pytest.approx(4 / (3 * math.pi), rel=1e-9)


def test_rows_in_time_have_trapezoids_and_nothing_between():
    time = np.array([0.0, 1.0, 3.0])
    curve = TimedRows(np.array([0.0, 2.0, 4.0]), np.array([5.0, 6.0, 7.0]), time)
    assert shares_of(time) @ curve.rows == mean(curve) == pytest.approx((1 + 6) / 3)
    assert curve.highest().input == 7.0
    assert math.isnan(curve.tail)
    assert curve.running().rows[-1] == pytest.approx(0.0, abs=1e-15)
    assert shares_of(np.array([2.0])).tolist() == [1.0]


def test_a_highest_place_in_a_bracket_is_found_by_sixteen_values():
    asked = []

    def function(x):
        asked.append(len(x))
        return np.cos(x - 0.123)

    places, values = highest_between(function, np.array([-0.5]), np.array([0.5]))
    assert places == pytest.approx([0.123], abs=1e-12)
    assert values == pytest.approx([1.0], abs=1e-15)
    assert asked == [16, 1]


def test_zeros_are_found_from_either_sign():
    found = zeros_between(
        lambda x: (np.sin(x), np.cos(x)),
        np.array([2.0, 6.0, -1.0, 1e-9]),
        np.array([4.0, 7.0, 1.5, 1.0]),
        np.array([True, False, False, False]),
    )
    # the last lies just outside, where rounding would have the caller see it inside: then it is the end
    assert found == pytest.approx([math.pi, math.tau, 0.0, 1e-9], abs=1e-14)
