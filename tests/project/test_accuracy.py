"""The page on accuracy: quantiles of known errors, its references against each other, the way from rows to text."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy import __main__ as command
from evidence.accuracy import (
    closed_forms,
    dead_centres,
    extremes,
    figures,
    finite_differences,
    gallery_rows,
    page,
    published,
    run,
)
from evidence.accuracy.forty_digits import joint_errors, reference
from evidence.accuracy.quantiles import QUANTITIES, ROUNDING, Row, quantiles, summary
from evidence.accuracy.series import Series, acos, asin, atan2, cos_sin, sqrt
from places import ROOT
from sevenbar.description import gallery

#: Everything at a handful of rows.
HANDFUL = run.Budget(gallery_rows.Amount(random=3, worst=2, grid=36), 5, 360, 1, (1e-2, 1e-6), 1)


# Quantiles


def test_quantiles_of_a_thousand_known_errors_are_those_errors() -> None:
    errors = np.random.default_rng(1).permutation(np.arange(1, 1001)) * 1e-16
    found = quantiles(errors)
    want = {"median": 500e-16, "90 %": 900e-16, "99 %": 990e-16, "greatest": 1000e-16}
    assert found == pytest.approx(want, rel=1e-12)


def test_few_errors_give_no_quantile_that_did_not_occur() -> None:
    assert set(quantiles([1.0, 100.0, 3.0]).values()) <= {1.0, 3.0, 100.0}
    assert quantiles([7.0]) == {"median": 7.0, "90 %": 7.0, "99 %": 7.0, "greatest": 7.0}


@pytest.mark.parametrize("errors", [[], [1.0, math.nan], [math.inf]])
def test_quantiles_of_nothing_or_of_no_numbers_are_refused(errors: list[float]) -> None:
    with pytest.raises(ValueError, match="errors"):
        quantiles(errors)


def test_the_worst_row_is_told_by_where_it_is_and_roundings_by_its_condition() -> None:
    rows = [
        Row("some", 0, 0.5, 10.0, math.inf, {"joints": [1e-16, 4e-15, 3e-15, 1e-15]}),
        Row("some", 1, 1.5, 1000.0, math.inf, {"joints": [2e-16, 3e-15, 5e-15, 2e-15]}),
    ]
    found = summary(rows, "joints")
    assert found["velocity"]["worst"] == {"circuit": 0, "input": 0.5, "condition": 10.0, "error": 4e-15}
    assert found["acceleration"]["worst"]["circuit"] == 1
    assert found["velocity"]["roundings"]["greatest"] == pytest.approx(4e-15 / (10 * ROUNDING))


# Scales


def test_an_error_that_is_put_in_comes_out_in_its_scale() -> None:
    exact = [[mp.mpf(x) for x in numbers] for numbers in ((1, 2, -8, 0), (3, 1, 4, 0))]
    got = np.array([[float(x) for x in moments] for moments in exact]).T
    got[0, 0] += 1e-9 + 2 * math.pi
    got[1, 1] += 4e-9
    got[2, 0] -= 8e-9
    got[3, 1] += 1e-9
    found = joint_errors(got, exact, np.array([1.0, 2.0]), 0.5, np.array([True, False]))
    # a whole turn is none; the velocity's scale is 2, the acceleration's 8, the jerk's the input's 0.5 ** 3
    assert found == pytest.approx([1e-9, 2e-9 / 2, 8e-9 / 8, 0.5e-9 / 0.125], rel=1e-5)


# Series


def test_series_have_the_derivatives_that_mpmath_finds() -> None:
    with mp.workdps(30):
        x = Series.of("0.3", "0.7", "-0.2", "0.4")

        def angle(t: mp.mpf) -> mp.mpf:
            return mp.mpf("0.3") + mp.mpf("0.7") * t - mp.mpf("0.1") * t**2 + mp.mpf("0.4") / 6 * t**3

        c, s = cos_sin(x)
        cases = {
            "quotient": ((1 + c) / (2 - s * x), lambda t: (1 + mp.cos(t)) / (2 - mp.sin(t) * t)),
            "root": (sqrt(2 + s), lambda t: mp.sqrt(2 + mp.sin(t))),
            "atan2": (atan2(s - 2, c * 3), lambda t: mp.atan2(mp.sin(t) - 2, 3 * mp.cos(t))),
            "acos": (acos(c * 0.5), lambda t: mp.acos(mp.cos(t) / 2)),
            "asin": (asin(-s), lambda t: mp.asin(-mp.sin(t))),
        }
        for name, (series, function) in cases.items():
            for order, value in enumerate(series.derivatives):
                want = mp.diff(lambda t, f=function: f(angle(t)), 0, order)
                assert abs(value - want) < mp.mpf(10) ** -18, (name, order)


# References against each other


def test_the_references_of_an_rssr_agree_with_eq_8_to_sixteen_digits() -> None:
    linkage = sb.load("rssr")
    against = reference(linkage, 0)
    q = linkage.motion(samples=7).circuits[0].q[3]
    with mp.workdps(against.digits):
        joints, _ = against.exact(q, (10.0, 0.0, 0.0), 1, (0.0, 0.0, 0.0))
        formula = closed_forms.rssr(Series.of(float(q[0]), 10.0))[0].derivatives
        # the coupler's length is rounded to a double
        assert [float(x) for x in joints[7]] == pytest.approx([float(x) for x in formula], rel=1e-14)


def test_exact_places_of_dead_centres_are_those_of_the_law_of_cosines() -> None:
    """A planar crank-rocker stands still where crank and coupler are in line: sides 100 - 40 or 100 + 40, 80, 90."""
    linkage = sb.load("planar_4r")
    found = set()
    for circuit in linkage.motion(samples=36):
        loop = reference(linkage, 0).loop
        for dead in circuit.dead_centres:
            exact = dead_centres.exact_place(linkage, loop, circuit, dead)
            assert exact is not None
            found.add(round(abs((float(exact[0]) + math.pi) % (2 * math.pi) - math.pi), 12))
    want = set()
    for side, turn in ((140.0, 0.0), (60.0, math.pi)):
        inner = math.acos((side**2 + 90**2 - 80**2) / (2 * side * 90))
        want.add(round(abs((math.pi - inner + turn + math.pi) % (2 * math.pi) - math.pi), 12))
    assert found == want


def test_the_extreme_of_a_universal_joints_speed_is_that_of_cardans_law() -> None:
    """The output runs between cos and 1 / cos of the angle of the shafts times the input's speed."""
    linkage = sb.load("universal_joint")
    circuit = linkage.motion(samples=36).circuits[0]
    loop = reference(linkage, 0).loop
    speed = linkage.drive.speed
    ends = circuit.velocity
    assert ends is not None
    for at, factor in ((ends.lowest_at, 4 / 5), (ends.highest_at, 5 / 4)):
        exact, place = extremes.exact_extreme(loop, circuit, 1, at=at, speed=speed)
        assert float(exact) == pytest.approx(factor * speed, rel=1e-14)
        assert place < 1e-6


# What is found when something is wrong


def test_an_error_in_a_row_is_seen() -> None:
    linkage = sb.load("bennett")
    circuit = linkage.motion(samples=12).circuits[0]
    against = reference(linkage, 0)
    compare = gallery_rows.Comparison(linkage, circuit, against, rng=np.random.default_rng(1))
    clean = compare.errors(5, (1.0, 0.0, 0.0))
    assert max(clean["joints"] + clean["points"]) < 1e-12
    ddq = circuit.ddq.copy()
    ddq[5] *= 1 + 1e-8
    wrong = gallery_rows.Comparison(linkage, replace(circuit, ddq=ddq), against, rng=np.random.default_rng(1))
    spoilt = wrong.errors(5, (1.0, 0.0, 0.0))["joints"]
    assert 1e-9 < spoilt[2] < 2e-8
    assert spoilt[0] == clean["joints"][0]


def test_rows_beside_a_dead_centre_are_counted_apart() -> None:
    linkage = sb.load("rscr")
    rows = [row for _, row in gallery_rows.compared(linkage, "rscr", gallery_rows.Amount(8, 2, 720))]
    assert min(row.apart for row in rows) > gallery_rows.NEAR
    assert min(row.apart for row in rows) < 0.1
    near = list(dead_centres.towards("rscr", "crank", (1e-3, 1e-6), 1))
    assert {round(math.log10(row.apart)) for row in near} == {-3, -6}
    assert max(row.condition for row in near) > 1e3


# Differences


def test_forward_differences_are_of_the_first_order_and_central_ones_of_the_second() -> None:
    found = finite_differences.errors_by_step()
    steps = list(finite_differences.STEPS)
    first, second = steps.index(1e-1), steps.index(1e-2)
    for scheme, order in (("forward", 1), ("central", 2)):
        for errors in found[scheme]:
            fall = math.log10(errors[first] / errors[second])
            assert fall == pytest.approx(order, abs=0.2), scheme
    assert max(found["exact rates"]) < 1e-12 < min(min(errors) for errors in found["central"])


def test_the_last_of_closed_samples_has_no_velocity_at_all() -> None:
    trace = sb.load("seven_r").motion(samples=360).circuits[0].point(published.LINK, published.POINT)
    speeds = np.linalg.norm(trace.velocity, axis=1)
    assert finite_differences.last_sample(sb.load("seven_r"), 361) == pytest.approx(speeds[0] / speeds.max())


# Published


def test_the_papers_rates_agree_with_mended_signs_only() -> None:
    for row in published.formulas_of_rates():
        assert row["mended"] < 1e-13
        assert row["printed"] > 0.1


# The page


@pytest.fixture(scope="module")
def small() -> dict[str, object]:
    """One linkage through the whole, without simulators."""
    found = {}
    for task in run.tasks(["planar_4r"]):
        if task.section not in ("exudyn", "mujoco"):
            found.setdefault(task.section, {})[task.name] = run.done(task, HANDFUL)
    whole = command.shortened(run.framed(found, ["planar_4r"], HANDFUL, 1.0))
    return json.loads(command.as_json(whole))


def test_one_linkage_goes_through_the_whole(small: dict) -> None:
    rows = small["rows"]["planar_4r"]
    assert rows["circuits"] == 2
    assert rows["random"]["joints"]["jerk"]["rows"] == 2 * 3
    assert rows["worst"]["joints"]["jerk"]["rows"] == 2 * 2
    for chosen in ("random", "worst"):
        for what in ("joints", "points"):
            for quantity in QUANTITIES:
                assert 0 <= rows[chosen][what][quantity]["errors"]["greatest"] < 1e-12
    (driven,) = small["dead_centres"]["planar_4r"]["driven"]
    assert driven["input"] == "theta_4"
    assert [step["apart"] for step in driven["steps"]] == [1e-2, 1e-6]
    near, far = driven["steps"][1], driven["steps"][0]
    assert near["condition"] == pytest.approx(100 * far["condition"], rel=0.1)
    assert [told["count"] for told in small["dead_centres"]["planar_4r"]["places"]] == [4, 4]
    assert small["extremes"]["planar_4r"]["count"] == 6
    assert small["closed_forms"]["planar_4r"]["output"]["jerk"]["errors"]["greatest"] < 1e-12


def test_the_page_holds_each_number_of_the_results(small: dict) -> None:
    text = page.text(small)
    assert "**A part only:**" in text
    for quantity in QUANTITIES:
        for value in small["rows"]["planar_4r"]["random"]["joints"][quantity]["errors"].values():
            assert page.number(value) in text
    assert small["made"]["date"] in text
    assert f"commit {small['made']['commit']}" in text
    for line in text.splitlines():
        assert len(line) <= page.WIDTH or line.startswith(("|", "!"))
    for block in text.split("\n\n"):
        if block.startswith("|"):
            assert len({line.count("|") for line in block.splitlines()}) == 1, block
    assert "nan" not in text.lower().replace("nan with", "")


def test_the_page_says_what_misses_and_what_keeps_the_digits_asked_for(small: dict) -> None:
    assert "Kept in every one of the 10 rows" in " ".join(page.text(small).split())
    spoilt = json.loads(json.dumps(small))
    spoilt["rows"]["planar_4r"]["worst"]["points"]["velocity"]["errors"]["greatest"] = 2e-10
    text = " ".join(page.text(spoilt).split())
    assert "**Missed** by planar_4r (velocity of points: 2.0e-10)" in text


def test_an_engine_that_is_missing_is_told_once(small: dict) -> None:
    run_of_none = {"engine": "exudyn", "missing": "needs exudyn"}
    text = page.text(small | {"exudyn": {"planar_4r": run_of_none, "rssr": run_of_none}})
    assert text.count("needs exudyn") == 1
    assert "Without exudyn of planar_4r, rssr: needs exudyn." in text


def test_figures_are_small_and_the_same_each_time(small: dict, tmp_path: Path) -> None:
    first = {path.name: path.read_bytes() for path in figures.write(small, tmp_path / "one")}
    again = {path.name: path.read_bytes() for path in figures.write(small, tmp_path / "two")}
    assert first == again
    assert sorted(first) == sorted(f"accuracy_{name}.svg" for name in figures.FIGURES)
    assert all(b"<svg" in image and len(image) < 100_000 for image in first.values())


def test_wrong_words_are_told_what_is_allowed(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "list.json").write_text("[]", encoding="utf-8")
    for arguments, said in (
        (["--only", "benett"], "no linkage 'benett' in the gallery; give one of bennett, "),
        (["--processes", "0"], "--processes: 0 is no number of processes; give 1 or more"),
        (["--page", str(tmp_path / "none.json")], "No such file or directory"),
        (["--page", str(tmp_path / "list.json")], "no results; give a results.json of this command"),
    ):
        with pytest.raises(SystemExit):
            command.main(arguments)
        assert said in capsys.readouterr().err


def test_the_page_of_kept_results_goes_where_it_is_asked_for(small: dict, tmp_path: Path) -> None:
    kept = tmp_path / "kept.json"
    kept.write_text(command.as_json(small), encoding="utf-8")
    assert command.main(["--page", str(kept), "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "accuracy.md").read_text(encoding="utf-8") == page.text(small)
    assert json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8")) == small


def test_the_kept_page_is_the_one_that_the_kept_results_give() -> None:
    kept = ROOT / "evidence" / "accuracy" / "results.json"
    results = json.loads(kept.read_text(encoding="utf-8"))
    assert kept.stat().st_size < 200_000
    assert sorted(results["rows"]) == sorted(gallery.loops())
    assert (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8") == page.text(results)
    for name in figures.FIGURES:
        assert (ROOT / "docs" / "images" / f"accuracy_{name}.svg").stat().st_size < 100_000
