"""The linkages of a sweep are what was asked for, and any part of them is made from the index alone."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.sweep.axes import axis_from_text, grid, span
from sevenbar.sweep.space import MOST_LINKAGES, Space

DRAFT = Draft.of_linkage(sb.load("rssr"))
SPANS = {"L1": span(200, 300), "M": span(600, 800), "D": span(-50, 50)}


def sampled(method: str, count: int, seed: int = 7) -> Space:
    return Space.of(DRAFT, SPANS, method, count, seed)


def unit(space: Space, first: int, stop: int) -> np.ndarray:
    """Points of the unit cube that a space of spans comes from."""
    ends = np.array([[axis.low, axis.high] for axis in space.axes])
    return (space.values(first, stop) - ends[:, :1]) / (ends[:, 1:] - ends[:, :1])


def test_a_grid_is_the_product_of_its_axes_the_last_one_running_fastest() -> None:
    space = Space.of(DRAFT, {"L1": grid(200, 300, 7), "L3": [500, 400, 450], "M": grid(-1, 1, 3)})
    product = itertools.product(np.linspace(200, 300, 7), [500, 400, 450], np.linspace(-1, 1, 3))
    assert space.count == 63
    assert pytest.approx(np.array(list(product)), rel=1e-15, abs=1e-15) == space.values(0, 63).T
    assert space.values(0, 63)[0, -1] == 300


@pytest.mark.parametrize("method", ["random", "sobol"])
@pytest.mark.parametrize(("first", "stop"), [(0, 1), (1, 2), (37, 90), (64, 100), (99, 100)])
def test_a_part_of_a_sample_is_that_part_of_the_whole(method: str, first: int, stop: int) -> None:
    space = sampled(method, 100)
    assert np.array_equal(space.values(first, stop), space.values(0, 100)[:, first:stop])


def test_a_sobol_sample_is_scipys() -> None:
    expected = qmc.Sobol(3, scramble=True, seed=np.random.default_rng(7)).random(64).T
    assert unit(sampled("sobol", 64), 0, 64) == pytest.approx(expected, abs=1e-14)


def test_a_random_sample_is_even_and_each_seed_has_its_own() -> None:
    points = unit(sampled("random", 20_000), 0, 20_000)
    for axis in points:
        assert stats.kstest(axis, "uniform").pvalue > 1e-4
    for one, other in itertools.combinations(points, 2):
        assert abs(np.corrcoef(one, other)[0, 1]) < 4 / math.sqrt(20_000)
    assert not np.isin(unit(sampled("random", 50, seed=8), 0, 50), points[:, :50]).any()


def test_the_last_of_a_thousand_million_million_is_made_at_once() -> None:
    last = unit(sampled("random", MOST_LINKAGES), MOST_LINKAGES - 3, MOST_LINKAGES)
    assert last.shape == (3, 3)
    assert ((last >= 0) & (last < 1)).all()
    counted = Space.of(DRAFT, {name: grid(1, 2, 10**5) for name in ("L1", "L2", "L3")})
    assert counted.values(counted.count - 1, counted.count).tolist() == [[2.0]] * 3


def test_samples_of_lists_and_grids_take_their_values_evenly() -> None:
    space = Space.of(DRAFT, {"L1": [250, 260], "L3": grid(500, 600, 3)}, "sobol", 600)
    first, second = space.values(0, 600)
    assert {value: int((first == value).sum()) for value in set(first)} == {250: 300, 260: 300}
    assert all(abs(int((second == value).sum()) - 200) <= 4 for value in (500, 550, 600))


def test_values_are_in_the_files_units_or_say_theirs() -> None:
    space = Space.of(DRAFT, dict(map(axis_from_text, ["L1=20cm:0.3m:3", "L3=500,0.55m", "speed=60rpm"])))
    assert pytest.approx(np.array([[200, 500, math.tau], [200, 550, math.tau]])) == space.values(0, 2).T
    seven = Space.of(Draft.of_linkage(sb.load("seven_r")), {"link[1].twist": ["0.5rad"]})
    assert seven.values(0, 1)[0, 0] == pytest.approx(math.degrees(0.5))


def test_each_form_of_values_is_read() -> None:
    assert axis_from_text("L1=200:300:51") == ("L1", grid("200", "300", 51))
    assert axis_from_text(" P.x = -1.5 .. 2e1 ") == ("P.x", span("-1.5", "2e1"))
    assert axis_from_text("L3=400, 450") == ("L3", ["400", "450"])


@pytest.mark.parametrize(
    ("axes", "asked", "message"),
    [
        ({}, {}, "over: no dimension is given; give one or more, as in L1=200:300:51"),
        ({"L9": [1]}, {}, "dimension: 'L9' is not a dimension of 'RSSR of Sun and Zhou'; "),
        ({"L1": [1], "rssr.L1": [2]}, {}, "over: dimension 'L1' is given twice; leave one out"),
        (
            {"L1": grid(300, 200, 3)},
            {},
            "L1: 300 to 200 is an empty range; give a low end below the high one",
        ),
        ({"L1": span(5, 5)}, {"count": 3}, "L1: 5 to 5 is an empty range"),
        ({"L1": span(-1e308, 1e308)}, {"count": 3}, "L1: -1e+308 to 1e+308 is too wide"),
        ({"L1": grid(1, 2, 1)}, {}, "L1: 1 is not a count of values; give 2 to 1000000000000"),
        ({"L1": []}, {}, "L1: no values are listed; give 1 to 1000000, or a grid"),
        ({"L1": 250.0}, {}, "L1: 250.0 is not what a dimension takes; give grid(low, high, count), "),
        ({"L1": "250"}, {}, "L1: '250' is not what a dimension takes"),
        ({"L1": [math.nan]}, {}, "L1: nan is not a finite number; give a finite one"),
        ({"L1": [None]}, {}, "L1: None is not a number; give a number or a text as '25 cm'"),
        ({"L1": ["25 kg"]}, {}, "over: L1: '25 kg' is not a finite length; give 250 or 250mm"),
        ({"L1": span(1, 2)}, {"method": "grid"}, "L1: 1 to 2 is a span, which a grid does not walk; give "),
        ({"L1": span(1, 2)}, {}, "count: missing; a sobol sample needs one, as in 1000"),
        ({"L1": span(1, 2)}, {"count": 0}, "count: 0 is not a count; give 1 to 1073741824, or the method"),
        (
            {"L1": span(1, 2)},
            {"count": 2**30 + 1},
            "count: 1073741825 is not a count; give 1 to 1073741824, or",
        ),
        (
            {"L1": [1]},
            {"method": "sobl", "count": 2},
            "method: 'sobl' is not a way to choose linkages; did you",
        ),
        ({"L1": [1, 2]}, {"count": 3}, "count: 3, where the grid has 2; leave it out, or give a method"),
        ({"L1": [1, 2]}, {"seed": 3}, "seed: 3 is given, and a grid draws nothing; leave it out"),
        (
            {"L1": span(1, 2)},
            {"count": 3, "seed": -1},
            "seed: -1 is not a seed; give 0 to 9223372036854775807",
        ),
        (
            {name: grid(1, 2, 10**6) for name in ("L1", "L2", "L3")},
            {},
            "over: 1000000 x 1000000 x 1000000 = 1000000000000000000 linkages are too many; give at most 1e+15",
        ),
    ],
)
def test_wishes_that_cannot_be_met_are_told(axes: dict, asked: dict, message: str) -> None:
    with pytest.raises(RequestError) as caught:
        Space.of(DRAFT, axes, **asked)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["L1", "L1=", "=5", "L1=1:2", "L1=1:2:x", "L1=1:2:3:4", "L1=..5", "L1=1,,2"])
def test_values_of_no_form_are_told_with_the_forms(text: str) -> None:
    with pytest.raises(RequestError, match=r"over: .*LOW:HIGH:COUNT, a list V1,V2,V3, or LOW\.\.HIGH"):
        axis_from_text(text)
