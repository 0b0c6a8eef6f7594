"""Measures of ranges, balls, distances and stops: their values, units, and derivatives against differences."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import gradient, measures_named, rows_of

LOOPS = {
    "rssr": (sb.rssr(M=640, N=-710, L1=210, L3=500, D=130, L2=900), ["rocker"], ["ball_a", "ball_b"]),
    "rsur": (sb.load("rsur"), ["rocker"], ["cross"]),
    "rssp": (sb.load("rssp"), ["slider"], ["ball_a"]),
    "five_bar": (sb.load("five_bar"), [], ["ball"]),
}


@pytest.mark.parametrize("name", LOOPS)
def test_derivatives_of_ranges_bends_and_distances_are_those_of_differences(name):
    linkage, joints, balls = LOOPS[name]
    names = [*(f"range:{j}" for j in joints), *(f"ball_angle:{j}" for j in balls)]
    # where two pairs of rods, or both ways of one without length, are as near the distance has a kink
    names += ["clearance"] if linkage.kind in ("RSSR", "RSUR") else []
    motion, measures = linkage.motion(), measures_named(names)
    found, values = gradient(motion, only=names), rows_of(motion, measures)[0]
    draft = Draft.of_linkage(linkage)
    sensitivity = motion.circuits[0].sensitivity()
    for one in names:
        assert found[one].value == pytest.approx(values[one], abs=1e-9)
        assert np.isfinite(found[one].slopes).any()
    # a few numbers of each loop
    for k in range(0, len(sensitivity.names), max(1, len(sensitivity.names) // 5)):
        number = sensitivity.names[k]
        by = 1e-3 if sensitivity.units[k] else 1e-5
        value = draft.dimension(number).value
        high, low = (
            rows_of(draft.with_values({number: value + way * by}).linkage.motion(), measures)[0]
            for way in (1, -1)
        )
        for one in names:
            slope = (high[one] - low[one]) / (2 * by)
            size = np.nanmax(np.abs(found[one].slopes))
            assert found[one].slopes[k] == pytest.approx(slope, abs=2e-6 * size), (one, number)


def test_a_given_seat_has_the_derivatives_of_its_greatest_angle():
    linkage = LOOPS["rssr"][0].stopped(cones={"ball_a": sb.Cone(1.0, seat=(0, 0, 1))}, radii={1: 10})
    motion = linkage.motion()
    found = gradient(motion)
    assert {"ball_angle:ball_a", "clearance"} <= set(found)
    measures = measures_named(["ball_angle:ball_a"])
    draft = Draft.of_linkage(linkage)
    for k, number in enumerate(motion.circuits[0].sensitivity().names):
        value = draft.dimension(number).value
        ends = [
            rows_of(draft.with_values({number: value + way * 1e-3}).linkage.motion(), measures)[0]
            for way in (1, -1)
        ]
        slope = (ends[0]["ball_angle:ball_a"] - ends[1]["ball_angle:ball_a"]) / 2e-3
        assert found["ball_angle:ball_a"].slopes[k] == pytest.approx(slope, abs=1e-7)


def test_a_stud_that_runs_on_a_circular_cone_has_a_kink_there():
    found = gradient(sb.load("rssr").motion(), only=["ball_angle:ball_a"])["ball_angle:ball_a"]
    assert np.isnan(found.slopes).all()


def test_measures_of_ranges_have_their_joint_s_unit_and_none_where_it_is_endless():
    motion = sb.slider_crank(crank=50, rod=120).motion(72)
    slider, crank = motion.output, motion.input
    measures = measures_named([f"range:{slider}", f"range:{crank}", "clearance", "usable"])
    linkage = motion.linkage
    columns = [m.column(linkage, motion.output) for m in measures]
    assert columns == [f"range:{slider}_mm", f"range:{crank}_deg", "clearance_mm", "usable"]
    row = rows_of(motion, measures)[0]
    assert row[f"range:{slider}"] == pytest.approx(100.0, abs=1e-10)
    assert row[f"range:{crank}"] is None
    assert row["usable"] == 1.0


def test_a_clearance_counts_radii_and_the_part_within_them():
    linkage = sb.load("rssr").stopped(radii={1: 400, 3: 380})
    row = rows_of(linkage.motion(72), measures_named(["clearance", "usable"]))[0]
    assert row["clearance"] == pytest.approx(753.5495422536 - 780, abs=1e-8)
    assert 0 < row["usable"] < 1


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("range:ball_a", "measure: joint 'ball_a' is a ball, which has no range; give ball_angle:ball_a"),
        ("range:crnk", "measure: no joint 'crnk'; did you mean 'crank'"),
        ("ball_angle:crank", "measure: 'crank' is not a joint S or U"),
    ],
)
def test_a_measure_of_a_joint_that_has_none_is_refused(name, message):
    with pytest.raises(RequestError, match=message):
        rows_of(sb.load("rssr").motion(24), measures_named([name]))


def test_a_sweep_over_a_dimension_has_them():
    measures = ["ball_angle:ball_b", "usable", "range:rocker"]
    rows = sb.sweep.run(sb.load("rssr"), {"L1": [200.0, 250.0]}, measures=measures).table().to_pylist()
    at_250 = next(row for row in rows if row["L1_mm"] == 250.0 and row["circuit"] == 0)
    assert at_250["ball_angle:ball_b_deg"] == pytest.approx(27.025381110622295, abs=1e-9)
    assert at_250["range:rocker_deg"] == pytest.approx(75.147, abs=1e-3)
    assert {row["usable"] for row in rows} == {1.0}
