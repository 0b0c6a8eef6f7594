"""Worst case, Monte Carlo and tolerances for a wanted error: against the ordinary analysis and statistics."""

import contextlib
import io
import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.tolerance.inverse import tolerances_for
from sevenbar.design.tolerance.linear import linear_estimate
from sevenbar.design.tolerance.report import Findings, tolerance_report
from sevenbar.design.tolerance.samples import LEVELS, monte_carlo
from sevenbar.design.tolerance.sensitivities import sensitivities
from sevenbar.design.tolerance.tolerances import (
    CLASSES,
    DEVIATIONS,
    general_tolerance,
    parsed_tolerances,
    tolerances,
)
from sevenbar.design.tolerance.worst import worst_case
from sevenbar.errors import RequestError

#: Statistical errors that chance brings about once in 400 times.
SURE = 3.0


def made(linkage, **changes):
    """An RSSR with some of its dimensions changed."""
    return sb.rssr(**(dict(linkage.dimensions) | changes), speed=linkage.drive.speed)


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rscr", "planar_4r"])
@pytest.mark.parametrize("distribution", ["normal", "uniform", "triangular"])
def test_monte_carlo_agrees_with_the_linear_estimate_for_small_tolerances(name, distribution):
    found = sensitivities(sb.load(name), samples=24)
    exact = monte_carlo(found, {"*": 0.001}, 400, seed=1, distribution=distribution)
    assert exact.lost == 0
    assert abs(exact.ratio - 1) <= SURE * exact.ratio_error
    assert exact.ratio_error < 1e-3
    assert exact.holds is True
    # and without the help of the same errors in the linear estimate, as far as 400 samples tell
    # but where it does not deviate: a drawn pose is at zero whatever its dimensions
    told = exact.linear.deviation > 1e-3 * exact.linear.deviation.max()
    plain = exact.deviation[told] / exact.linear.deviation[told]
    assert np.abs(plain - 1).max() < SURE * 1.5 / math.sqrt(2 * 400)


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_rates_agree_too(quantity):
    found = sensitivities(sb.load("rssr"), samples=24)
    exact = monte_carlo(found, {"*": 0.01}, 400, quantity=quantity)
    assert abs(exact.ratio - 1) <= SURE * exact.ratio_error
    assert exact.linear.unit == {"velocity": "rad/s", "acceleration": "rad/s^2"}[quantity]


def test_each_sample_is_the_output_of_its_own_linkage():
    linkage = sb.load("rssr")
    found = sensitivities(linkage, samples=12)
    given = tolerances(found.dimensions, {"*": 5.0}, length_unit="mm")
    exact = monte_carlo(found, given, 50, seed=7, distribution="uniform")
    errors = given.drawn(50, "uniform", np.random.default_rng(7))
    by_hand = []
    for column in errors.T:
        changes = dict(zip(found.loop.numbers.names, found.loop.numbers.nominal + column, strict=True))
        circuit = made(linkage, **changes).motion(12).circuits[found.circuit.index]
        by_hand.append(circuit.output - found.circuit.output)
    by_hand = np.remainder(np.array(by_hand) + np.pi, math.tau) - np.pi
    np.testing.assert_allclose(exact.mean, by_hand.mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(exact.quantiles, np.quantile(by_hand, LEVELS, axis=0), atol=1e-12)
    assert exact.greatest == pytest.approx(np.abs(by_hand).max(), abs=1e-12)


def without_its_rod(dimensions, **changes):
    """An RSSR whose coupler follows from its other dimensions, as of a file that leaves it out."""
    own = {name: value for name, value in dimensions.items() if name != "L2"} | changes
    return sb.rssr(**own, speed=10.0)


def test_a_rod_that_follows_has_no_tolerance_and_its_length_is_that_of_each_design():
    linkage = sb.load("rssr")
    found = sensitivities(linkage, samples=12, follow=["L2"])
    given = tolerances(found.dimensions, {"*": 5.0}, length_unit="mm", following=found.followers)
    assert given.widths.tolist() == [5, 5, 5, 0, 5, 5]
    exact = monte_carlo(found, given, 50, seed=7, distribution="uniform")
    errors = given.drawn(50, "uniform", np.random.default_rng(7))
    by_hand = []
    for column in errors.T:
        changes = dict(zip(found.loop.numbers.names, found.loop.numbers.nominal + column, strict=True))
        circuit = without_its_rod(changes).motion(12).circuits[found.circuit.index]
        by_hand.append(circuit.output - found.circuit.output)
    by_hand = np.remainder(np.array(by_hand) + np.pi, math.tau) - np.pi
    np.testing.assert_allclose(exact.mean, by_hand.mean(axis=0), atol=1e-12)


def test_derivatives_where_the_rod_follows_are_those_of_differences():
    linkage = sb.load("rssr")
    found = sensitivities(linkage, samples=12, follow=["L2"])
    rows = found.of()
    swing = found.measure("swing")
    assert np.abs(rows[:, found.loop.numbers.names.index("L2")]).max() == 0
    for place, name in enumerate(found.loop.numbers.names):
        if name == "L2":
            continue
        up, down = (
            without_its_rod(linkage.dimensions, **{name: linkage.dimensions[name] + step})
            .motion(12)
            .circuits[0]
            for step in (1e-3, -1e-3)
        )
        assert rows[:, place] == pytest.approx((up.output - down.output) / 2e-3, abs=1e-10)
        by_swing = math.degrees(up.swing - down.swing) / 2e-3
        assert swing.slopes[place] == pytest.approx(by_swing, abs=1e-7)


def test_a_rod_is_held_where_nothing_else_is_said():
    held = sensitivities(sb.load("rssr"), samples=8)
    assert linear_estimate(held, {"L1": 0.5}).held.text == "M, N, L3, D, L2 (997.497 mm in the design)"
    assert linear_estimate(held, {"L*": 0.5}).held.text == "M, N, D"
    follows = sensitivities(sb.load("rssr"), samples=8, follow=["L2"])
    told = linear_estimate(follows, {"*": 0.5})
    assert told.held.text == "L2 follows (997.497 mm in the design)"
    assert "L2" not in [effect.dimension.name for effect in told.effects]
    with pytest.raises(RequestError, match="L2 follows from the others; leave its tolerance or follow out"):
        linear_estimate(follows, {"L2": 0.5})
    assert tolerances_for(follows, 0.01).tolerances.widths[3] == 0


def near_a_change_point(coupler):
    """The paper's mechanism with a shorter coupler: below 961 mm its crank no longer turns fully."""
    return sb.rssr(M=700, N=700, L1=250, L3=550, D=0, L2=coupler)


def test_near_a_change_point_it_says_that_the_linear_estimate_does_not_hold():
    linkage = near_a_change_point(964)
    exact = monte_carlo(linkage, {"L2": 5.0}, 300, seed=3)
    assert exact.holds is False
    assert set(exact.reasons) == {"became double-rocker"}
    assert "the linear estimate does not hold, because" in exact.verdict
    assert "of the samples do not go round" in exact.verdict
    # as many are lost as have no full turn by the ordinary analysis
    errors = exact.linear.tolerances.drawn(300, "normal", np.random.default_rng(3))[3]
    rocking = sum(near_a_change_point(964 + e).motion(8).motion_type != "crank-rocker" for e in errors)
    assert exact.lost == rocking > 0
    smaller = monte_carlo(linkage, {"L2": 0.01}, 300, seed=3)
    assert smaller.holds is True


def test_designs_whose_crank_stops_between_two_rows_are_seen():
    # rows at 176 and 184 degrees, between which the crank of some designs stops
    found = sensitivities(near_a_change_point(962.5), samples=45)
    exact = monte_carlo(found, {"L2": 1.5}, 300, seed=3, distribution="uniform")
    errors = exact.linear.tolerances.drawn(300, "uniform", np.random.default_rng(3))[3]
    motions = [near_a_change_point(962.5 + e).motion(8) for e in errors]
    ranges = [np.degrees(np.ptp(m.limits)) for m in motions if m.motion_type == "double-rocker"]
    assert exact.lost == len(ranges)
    assert 0 < sum(width < 8 for width in ranges) < len(ranges)


def test_a_bend_of_the_output_is_told_though_all_samples_go_round():
    exact = monte_carlo(near_a_change_point(967), {"L2": 4.0}, 300, seed=3, distribution="uniform")
    assert exact.lost == 0
    assert exact.holds is False
    assert exact.verdict.startswith("the linear estimate does not hold, because the mean is off by 0.3")


def test_too_few_samples_tell_nothing():
    exact = monte_carlo(near_a_change_point(970), {"L2": 6.0}, 4, seed=3, distribution="uniform")
    assert (exact.lost, exact.holds) == (0, None)
    assert exact.verdict == "whether the linear estimate holds cannot be decided with 4 samples; take more"


def test_the_same_seed_gives_the_same_samples():
    found = sensitivities(sb.load("planar_4r"), samples=12)
    one, again, other = (monte_carlo(found, {"length_*": 0.2}, 50, seed=seed) for seed in (5, 5, 6))
    assert np.array_equal(one.quantiles, again.quantiles)
    assert not np.array_equal(one.quantiles, other.quantiles)


@pytest.mark.parametrize("distribution", list(DEVIATIONS))
def test_errors_spread_as_they_are_told_to(distribution):
    found = sensitivities(sb.load("rssr"), samples=8)
    given = tolerances(found.dimensions, {"L1": 2.0, "L2": "0.1 cm"}, length_unit="mm")
    errors = given.drawn(200_000, distribution, np.random.default_rng(0))
    assert np.abs(errors[2]).max() <= 2.0
    assert np.abs(errors[3]).max() <= 1.0
    assert not errors[0].any()
    assert errors[2].std() == pytest.approx(given.deviations(distribution)[2], rel=6e-3)
    assert abs(np.corrcoef(errors[2], errors[3])[0, 1]) < 0.01


def test_the_worst_case_is_reached_at_the_corner_that_it_names():
    linkage = sb.load("rssr")
    worst = worst_case(sensitivities(linkage, samples=24), {"*": 0.5})
    row = int(worst.linear.rows[worst.at])
    circuit = made(linkage, **worst.corner).motion(24).circuits[0]
    nominal = linkage.motion(24).circuits[0]
    deviation = circuit.output[row] - nominal.output[row]
    assert worst.high[worst.at] == pytest.approx(deviation, abs=1e-12)
    assert deviation == pytest.approx(worst.linear.worst[worst.at], rel=0.02)
    # no other of the 64 corners deviates more there
    names = list(worst.corner)
    for corner in np.ndindex(*(2,) * len(names)):
        values = {n: linkage.dimensions[n] + (0.5, -0.5)[c] for n, c in zip(names, corner, strict=True)}
        other = made(linkage, **values).motion(24).circuits[0].output[row] - nominal.output[row]
        assert other <= deviation + 1e-12


def test_all_corners_of_up_to_eight_dimensions_are_computed():
    """The two worst corners on every row are those of the ordinary analysis of all 64 designs."""
    linkage = sb.load("rssr")
    worst = worst_case(sensitivities(linkage, samples=12), {"*": 8.0})
    assert (worst.tried, worst.corners, worst.open) == (64, 64, 0)
    nominal = linkage.motion(12).circuits[0].output
    outputs = []
    for corner in np.ndindex(*(2,) * 6):
        ends = zip(linkage.dimensions, corner, strict=True)
        changes = {name: linkage.dimensions[name] + (8.0, -8.0)[end] for name, end in ends}
        outputs.append(made(linkage, **changes).motion(12).circuits[0].output - nominal)
    by_hand = np.remainder(np.array(outputs) + np.pi, math.tau) - np.pi
    np.testing.assert_allclose(worst.high, by_hand.max(axis=0), atol=1e-11)
    np.testing.assert_allclose(worst.low, by_hand.min(axis=0), atol=1e-11)
    # and with tolerances as great as these the derivatives name another one on some rows
    signs = np.sign(worst.linear.slopes) * 8.0
    named = [worst.deviations[(worst.changes == s).all(axis=1), k] for k, s in enumerate(signs)]
    assert all(n.size == 1 for n in named)
    assert (worst.high >= np.concatenate(named) - 1e-15).all()


def test_of_more_than_eight_dimensions_it_is_reported_how_many_corners_were_not_tried():
    worst = worst_case(sensitivities(sb.load("seven_r"), samples=12), {"*": 0.01})
    own = int((worst.linear.tolerances.widths > 0).sum())
    assert own > 8
    assert worst.corners == 2**own
    assert 2 <= worst.tried <= 2 * len(worst.linear.rows)
    page = capture(lambda: tolerance_report().print(Findings(worst.linear, worst, None)))
    assert f"of the {worst.tried} designs with every dimension at an end of its tolerance that the" in page
    assert f"derivatives name; the other {worst.corners - worst.tried:,} were not tried" in page


def capture(print_it):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        print_it()
    return " ".join(out.getvalue().split())


def test_the_difference_from_the_true_corner_grows_with_the_tolerances():
    found = sensitivities(sb.load("rssr"))
    differences = [worst_case(found, {"*": width}).difference for width in (0.01, 0.1, 1.0)]
    assert differences == sorted(differences)
    assert differences[1] == pytest.approx(10 * differences[0], rel=0.05)


def test_a_corner_that_does_not_close_is_no_number():
    worst = worst_case(sb.load("rssr"), {"L*": 50.0})
    assert np.isnan(worst.high[worst.at])
    assert np.isnan(worst.low[worst.at])
    assert 0 < worst.open < 8
    # the design that is named has no pose at that input
    named = made(sb.load("rssr"), **{**sb.load("rssr").dimensions, **worst.corner})
    at = worst.linear.input[worst.at]
    assert np.isnan(named.output([at]).position).all()
    page = capture(lambda: tolerance_report().print(Findings(worst.linear, worst, None)))
    assert f"{worst.open} of 8 designs with every dimension at an end of its tolerance do not close" in page


def test_shares_are_those_of_the_variance():
    linear = linear_estimate(sb.load("rssr"), {"*": "ISO 2768-m"})
    assert sum(effect.share for effect in linear.effects) == pytest.approx(1)
    assert [effect.dimension.name for effect in linear.effects][:2] == ["L2", "M"]
    one = linear_estimate(sb.load("rssr"), {"L3": 0.5})
    assert [effect.share for effect in one.effects] == [pytest.approx(1)]
    assert linear.left_out() == ("D: no length that ISO 2768-m has a tolerance for; taken for exact",)


def test_near_dead_centres_rows_are_left_out_and_said_to_be():
    found = sensitivities(sb.load("rssr"), input="rocker", samples=360)
    linear = linear_estimate(found, {"*": 2.0})
    assert {"dead-centre", "near-dead-centre", "ok"} == set(linear.status)
    assert any("without bound" in note for note in linear.left_out())
    near = found.input[linear.status == "near-dead-centre"]
    limits = [m.value * m.scale for m in found.measures if m.name.startswith("limit_")]
    assert max(min(abs(x - limit) for limit in limits) for x in near) < 0.15
    assert np.isfinite(linear.worst).all()
    exact = monte_carlo(found, linear, 200)
    assert (exact.lost, exact.holds) == (0, True)


def test_all_of_a_cycle_can_be_too_near_to_a_dead_centre():
    found = sensitivities(sb.load("rssr"), input="rocker", samples=90)
    with pytest.raises(
        RequestError, match="so great that the dead centres of the input may move past every row"
    ):
        linear_estimate(found, {"M": 90.0, "L2": 90.0})


def test_a_wanted_error_is_met_where_ever_more_rows_are_too_near_to_dead_centres():
    found = sensitivities(sb.load("planar_4r"), samples=3600, input="theta_4")
    linear = tolerances_for(found, 0.05, sum="statistical")
    assert np.linalg.norm(linear.slopes * linear.tolerances.widths, axis=1).max() == pytest.approx(0.05)
    assert len(linear.rows) < len(found.rows)


@pytest.mark.parametrize(("sum", "total"), [("worst", 1.0), ("statistical", 2.0)])
def test_tolerances_for_a_wanted_error_have_equal_effects_and_meet_it(sum, total):
    linear = tolerances_for(sb.load("rssr"), 0.01, sum=sum)
    effects = [effect.greatest for effect in linear.effects]
    assert effects == pytest.approx([effects[0]] * 6)
    terms = (np.abs(linear.slopes) * linear.tolerances.widths) ** total
    assert (terms.sum(axis=1) ** (1 / total)).max() == pytest.approx(0.01)


def test_dimensions_without_effect_get_no_tolerance():
    linear = tolerances_for(sb.load("seven_r"), 0.01, names=["length_*"])
    told = {effect.dimension.name for effect in linear.effects}
    assert "length_1" in told
    # across the three parallel axes nothing shows at theta_7
    assert not told & {"length_3", "length_4"}


def test_general_tolerances_are_the_standard_s():
    assert [
        general_tolerance(size, "m") for size in (0.4, 0.5, 3, 3.1, 30, 120, 250, 400, 1000, 4000, 4001)
    ] == [
        *(None, 0.1, 0.1, 0.1, 0.2, 0.3, 0.5, 0.5, 0.8, 2.0, None),
    ]
    assert general_tolerance(2, "v") is None
    assert general_tolerance(3000, "f") is None
    assert general_tolerance(999, "c") == 2.0
    for finer, coarser in zip("fmc", "mcv", strict=True):
        pairs = zip(CLASSES[finer], CLASSES[coarser], strict=True)
        assert all(a < b for a, b in pairs if a is not None and b is not None)


def test_classes_count_in_millimetres_whatever_the_unit():
    linkage = sb.rssr(M=28, N=28, L1=10, L3=22, D=0, L2=40, length_unit="in")
    found = sensitivities(linkage, samples=8)
    given = tolerances(found.dimensions, {"*": "ISO 2768-m"}, length_unit="in", opening=found.opening)
    assert given.widths[2] == pytest.approx(0.5 / 25.4)
    assert given.widths[3] == pytest.approx(1.2 / 25.4)


def test_a_name_counts_before_a_pattern_and_the_later_pattern_before_the_earlier():
    found = sensitivities(sb.load("seven_r"), samples=8)
    given = tolerances(
        found.dimensions,
        parsed_tolerances(["length_2=0.3", "*=1", "twist_*=0.1deg", "length_*=0.2", "link[3].length=0.7"]),
        length_unit="mm",
    )
    widths = dict(zip(found.loop.numbers.names, given.widths, strict=True))
    assert (widths["length_1"], widths["length_2"], widths["length_3"]) == (0.2, 0.3, 0.7)
    assert (widths["twist_1"], widths["offset_1"]) == (0.1, 1.0)


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        ("rssr", {}, "tolerance: none given; give one as in 'L1=0.5', 'twist_*=0.1deg' or '*=ISO 2768-m'"),
        ("rssr", {"L4": 1}, "no dimension 'L4'; this linkage has M, N, L1, L2, L3, D"),
        ("rssr", {"L1": -0.5}, "L1=-0.5: a half width of -0.5 is not allowed; give one that is not negative"),
        ("rssr", {"L1": math.nan}, "a half width of nan is not allowed"),
        ("rssr", {"L1": "1deg"}, "L1=1deg: not a half width for L1; give one as in '0.1' or '0.1mm'"),
        ("rssr", {"L1": 250}, "L1=250: as great as the length itself, 250 mm; give a smaller one"),
        ("rssr", {"L1": 0}, "tolerance: no dimension has any; give one as in 'M=0.5'"),
        (
            "rssr",
            {"D": "ISO 2768-m"},
            "no dimension has any (D: no length that ISO 2768-m has a tolerance for",
        ),
        ("rssr", {"*": "ISO 2768-k"}, "'k' is no class of ISO 2768-1; give one of f, m, c, v"),
        ("planar_4r", {"twist_2": "1deg"}, "tolerance: twist_2: an error of it alone would open this"),
        ("bennett", {"*": 0.1}, "offset_4 or twist_4 alone would open this overconstrained loop"),
    ],
)
def test_a_wrong_tolerance_is_told(name, given, message):
    found = sensitivities(sb.load(name), samples=8)
    with pytest.raises(RequestError) as error:
        tolerances(found.dimensions, given, length_unit="mm", opening=found.opening)
    assert message in str(error.value)


def test_a_pattern_leaves_out_what_opens_the_loop_and_says_so():
    linear = linear_estimate(sb.load("planar_4r"), {"*": 0.1})
    assert {effect.dimension.name for effect in linear.effects} == {f"length_{i}" for i in range(1, 5)}
    (note,) = linear.left_out()
    assert note.startswith("offset_1, twist_1, offset_2")
    assert note.endswith("an error of one alone would open this overconstrained loop, so that play or bending "
                         "must take it up; left out")  # fmt: skip


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"count": 0}, "count: 0 is not a number of samples; give 2 to 1000000"),
        ({"count": 1}, "count: 1 is not a number of samples"),
        ({"seed": -1}, "seed: -1 is not a seed"),
        ({"distribution": "unifrom"}, "distribution: 'unifrom' is not offered; did you mean 'uniform'?"),
        ({"output": "ball_b.1"}, "output: ball_b.1 takes part in an idle motion"),
    ],
)
def test_a_wrong_argument_of_monte_carlo_is_told(options, message):
    found = sensitivities(sb.load("rssr"), samples=8)
    with pytest.raises(RequestError) as error:
        monte_carlo(found, {"L1": 0.1}, **options)
    assert message in str(error.value)


def test_a_wanted_error_must_be_one():
    with pytest.raises(RequestError, match="wanted: 0 is not an error; give one greater than 0"):
        tolerances_for(sb.load("rssr"), 0)
    with pytest.raises(RequestError, match="sum: 'rms' is not offered; give worst or statistical"):
        tolerances_for(sb.load("rssr"), 0.1, sum="rms")
